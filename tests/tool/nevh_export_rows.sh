#!/bin/sh
# Programs that nevh export writes, of all schemes that have one: they compile
# without a warning under gcc and clang, and their energy row has the digits of
# nevh compare.  make check takes a scheme or two of each family,
# SLOW=yes all of them.

. "${srcdir:-.}/tests/support/nevh_support.sh"

flags='-std=c11 -O2 -Wall -Wextra -Wpedantic -Werror -ffp-contract=off'
compilers=
for cc in gcc clang; do
    command -v $cc >/dev/null 2>&1 && compilers="$compilers $cc"
done
test -n "$compilers" || { echo 'no gcc and no clang'; exit 77; }

# The columns of a row that a program prints, by name.
columns() {
    awk -F, '/^#/ { next }
        !names { for (i = 1; i <= NF; i++) at[$i] = i; names = 1; next }
        {
            printf "%s", $at["steps"]
            n = split("max_energy_error rms_energy_error final_energy_error " \
                      "energy_drift sweeps", name, " ")
            for (i = 1; i <= n; i++) printf ",%s", $at[name[i]]
            print ""
        }'
}

# agrees SCENE SCHEME GRADIENT DT T_END COMPILER...
agrees() {
    run="$1 --integrators $2 --gradient $3 --dt $4 --t-end $5"
    case $2 in dopri5 | dop853 | dprkn12) run="$run --tolerance 1e-7" ;; esac
    shift 5
    exits 0 export $run -o $work/prog.c
    test $code = 0 || return
    exits 0 compare $run --native never --format csv --quiet
    columns <$work/out >$work/expected
    test $(wc -l <$work/expected) = 1 || { fails 'prints no row'; return; }
    for cc; do
        command="export $run, $cc"
        $cc $flags -o $work/prog $work/prog.c -lm 2>$work/err ||
            { fails 'does not compile'; cat $work/err; continue; }
        $limit $work/prog energy >$work/row 2>$work/err ||
            { fails 'the program fails'; cat $work/err; continue; }
        columns <$work/row | cmp -s - $work/expected || {
            fails 'prints other digits than nevh compare'
            columns <$work/row | diff - $work/expected
        }
    done
}


separable=$("$nevh" list integrators --all | awk '
    /integrator +native/ { native = 1; next }
    !native && / T\(p\)/ { print $1 }')
is_separable() {
    echo "$separable" | grep -qx -e "$1"
}

# The programs of a scheme for all scenes that it fits.
all_scenes() {
    scheme=$1
    shift
    for scene in 'pendulum 0.05 2' 'double-pendulum 0.01 0.4' \
        'kepler 0.02 1' 'fput 0.1 2'; do
        set -- $scene
        test $1 = double-pendulum && is_separable $scheme && continue
        for gradient in $gradients; do
            agrees $1 $scheme $gradient $2 $3 $compilers
        done
    done
}

if test "$SLOW" = yes; then
    schemes=$("$nevh" list integrators --all | awk '
        /integrator +native/ { native = 1; next }
        native && $2 == "yes" && NF == 2 && $1 !~ /taylor/ { print $1 }')
    test $(echo "$schemes" | wc -l) -gt 35 || fails 'lists too few schemes'
    for scheme in $schemes; do
        gradients=exact
        case $scheme in verlet | rk4 | tao2 | dopri5 | dprkn12 | rkn11b | gauss4 | lobatto4)
            gradients='exact central2 central4 complex-step' ;;
        esac
        all_scenes $scheme
    done
else
    set -- $compilers
    one=$1
    agrees pendulum gauss6 exact 0.05 2 $compilers
    agrees kepler gauss12 exact 0.02 1 $compilers
    agrees double-pendulum lobatto4 central2 0.01 0.4 $one
    agrees kepler verlet complex-step 0.02 1 $compilers
    agrees fput rkn11b exact 0.1 2 $one
    agrees double-pendulum midpoint complex-step 0.01 0.4 $one
    agrees double-pendulum rk4 exact 0.01 0.4 $one
    agrees double-pendulum tao4 exact 0.01 0.4 $compilers
    agrees kepler tao2 central2 0.02 1 $one
    agrees kepler dopri5 exact 0.1 2 $compilers
    agrees double-pendulum dop853 central4 0.1 0.4 $one
    agrees henon-heiles dprkn12 exact 0.5 4 $one
    agrees pendulum blanes-moan4 central4 0.05 2 $one
    agrees kepler implicit-euler exact 0.02 1 $one
    agrees kepler adaptive-verlet central4 0.03 1 $compilers
    agrees pendulum rk4 exact 0.03 1 $one
    agrees fput-1000 verlet central4 0.1 2 $compilers
fi

# Coordinates named as what steps under a tolerance define.
cat >$work/named.nevh <<'END'
[coordinates]
KEEPS = 1
substeps = 0.5, 0.1
rule = 0.2
first = 0.1
[effects]
T = (p_KEEPS^2 + p_substeps^2 + p_rule^2 + p_first^2)/2
V = (KEEPS^2 + substeps^2 + rule^2*KEEPS + first^4)/2
END
agrees $work/named.nevh dopri5 exact 0.1 1 ${compilers##* }

# Where Newton's iteration takes over, the program ends and says so.
exits 0 export pendulum --integrators gauss4 --dt 3 --t-end 30 -o $work/prog.c
${compilers##* } $flags -o $work/prog $work/prog.c -lm 2>$work/err || cat $work/err
$limit $work/prog energy >$work/out 2>$work/err &&
    fails 'takes steps that nevh leaves to Newton'
says 'the step from t = 0 cannot be taken: fixed-point iteration'

exit $status

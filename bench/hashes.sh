#!/bin/sh
# hashes.sh NEVH [SCENE...]: are the states of a run the same bits, however they are made?
# Runs SCENEs (those that ship) for STEPS (10000) steps of their first dt, a tenth of these
# from 10 degrees of freedom on, a hundredth from 100, and schemes with a tolerance at 1e-9 until
# the same time, with each scheme of SCHEMES and gradient of GRADIENTS, in each form of FORMS,
# and compares the last state with that of a run without compiled steps, one orbit alone:
#
#   portable              terms state by state
#   gcc clang             compiled steps
#   old old-gcc           a processor without AVX and FMA, by qemu-x86_64
#   one eight             members of a sweep, one by one and eight side by side
#   eight-gcc eight-clang eight side by side, compiled
#   export-gcc            exported programs, by gcc -march=x86-64
#   export-native export-clang by gcc and clang -march=native
#   export-arm            for aarch64, by aarch64-linux-gnu-gcc and qemu-aarch64
#
# Prints for each scene the steps, how many of the states are equal, and the first that
# differs or fails.  Forms that a scheme does not have, and compilers that are not here, are
# not counted; nor schemes that refuse the scene.  All hashes go to the file HASHES.

nevh=$1
shift
NEVH_SCENES=${NEVH_SCENES:-$(dirname "$0")/../scenes}
export NEVH_SCENES
test $# -gt 0 || set -- $("$nevh" list scenes --format csv --quiet | sed '1d; s/,.*//')
schemes=${SCHEMES:-symplectic-euler-a verlet forest-ruth rkn11b midpoint gauss4 gauss8 lobatto4 tao2 rk4 dopri5 taylor}
forms=${FORMS:-portable gcc clang old old-gcc one eight eight-gcc eight-clang
    export-gcc export-native export-clang export-arm}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
on=
XDG_CACHE_HOME=$work
export XDG_CACHE_HOME

have() { command -v "$1" >/dev/null; }
# What follows prints a hash, exits with 77 where there is no such form, or fails.
# The last row of the file out, as t, coordinates and momenta of 17 digits.
hash() { # FIRST: the number of the first column to take
    awk -F, -v first=$1 -v n=$((2*freedom)) '!/^#/ { line = $0 } END {
        if (split(line, x) < first + n - 1) exit
        for (i = first; i < first + n; i++) printf "%.17g,", x[i] }' $work/out |
        cksum | cut -d ' ' -f 1
}
run() { # OPTION...
    $on "$nevh" run $scene $options --every $steps "$@" >$work/out 2>$work/err || return 1
    hash 2
}
compiled() { # CC OPTION...
    have "${1%% *}" && export CC="$1" || return 77
    shift
    "$@" --native always || return
    grep -q '^# native: steps are' $work/out || return 77
}
emulated() { # COMMAND...
    folder=$(dirname "$nevh")
    test ! -x "$folder/.libs/nevh" || { # nevh is a script of libtool
        nevh=$folder/.libs/nevh LD_LIBRARY_PATH=$folder/../.libs
        export LD_LIBRARY_PATH
    }
    have qemu-x86_64 || return 77
    on='qemu-x86_64 -cpu core2duo' && "$@"
}
sweep() { # WIDTH OPTION...
    width=$1
    shift
    "$nevh" sweep $scene $options --width $width --threads 1 --outcomes state \
        --vary "$name=range($start,$start,8)" "$@" >$work/out 2>$work/err || return 77
    awk -F, '/^[0-9]/ { $1 = ""; print }' $work/out | uniq | wc -l | grep -qx 1 &&
        hash 4 || echo differ
}
exported() { # RUNNER COMPILER...
    runner=$1
    shift
    have $1 && { test -z "$runner" || have $runner; } || return 77
    test -s $work/prog.c || return 77
    "$@" -O2 -ffp-contract=off -o $work/prog $work/prog.c -lm 2>$work/err &&
        $runner $work/prog >$work/out && hash 2
}
state_of() { # FORM
    case $1 in
    portable) run --native never --portable ;;
    gcc | clang) compiled $1 run ;;
    old) emulated run --native never ;;
    old-gcc) emulated compiled gcc run ;;
    one) sweep 1 --native never ;;
    eight) sweep 8 --native never ;;
    eight-*) compiled ${1#eight-} sweep 8 ;;
    export-gcc) exported '' gcc -march=x86-64 ;;
    export-native) exported '' gcc -march=native ;;
    export-clang) exported '' clang -march=native ;;
    export-arm) exported qemu-aarch64 aarch64-linux-gnu-gcc -static ;;
    esac
}

printf '%-26s %6s %11s  %s\n' scene steps equal 'first difference'
for each; do
    scene=$work/$each.nevh # varies nothing of its own
    awk '/^\[/ { leave = /^\[ensemble\]/ } !leave' $NEVH_SCENES/$each.nevh >$scene
    dt=$(sed -n 's/^dt *= *\([^,# ]*\).*/\1/p' $scene)
    freedom=$("$nevh" list scenes --format csv --quiet |
        awk -F, -v scene=$each '$1 == scene { print $2 }')
    steps=${STEPS:-10000} equal=0 total=0 first=
    test $freedom -lt 10 || steps=$((steps/10))
    test $freedom -lt 100 || steps=$((steps/10))
    for scheme in $schemes; do
        for gradient in ${GRADIENTS:-exact central4}; do
            options="--integrators $scheme --gradient $gradient --dt $dt --t-end $steps*($dt)"
            case $scheme in
            dopri5 | dop853 | dprkn12 | taylor) options="$options --tolerance 1e-9" ;;
            esac
            due=$(run --native never) || continue
            name=$(sed -n 's/^t,\([^,]*\),.*/\1/p' $work/out)
            start=$(sed -n '/^t,/{n;s/^[^,]*,\([^,]*\),.*/\1/p}' $work/out)
            rm -f $work/prog.c
            "$nevh" export $scene $options --every $steps -o $work/prog.c 2>$work/err
            for form in $forms; do
                is=$(state_of $form)
                case $? in
                77) continue ;;
                0) ;;
                *) is=fails ;;
                esac
                test -z "$HASHES" || echo "$each $scheme $gradient $form $is $due" >>"$HASHES"
                total=$((total + 1))
                if test "$is" = "$due"; then
                    equal=$((equal + 1))
                else
                    first="${first:-$scheme $gradient $form}"
                fi
            done
        done
    done
    printf '%-26s %6d %5d/%-5d  %s\n' $each $steps $equal $total "${first:--}"
done

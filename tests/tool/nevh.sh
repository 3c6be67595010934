#!/bin/sh
# The command: exit statuses, columns, files, messages, and every scene.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# Usage.
exits 0 --help
has 'compare'
exits 0 --version
has '^nevh [0-9]'
exits 2
exits 2 comapre pendulum
says 'comapre; did you mean compare'
exits 2 compare pendulum --integratorz verlet
says 'integratorz; did you mean --integrators'
exits 2 compare
exits 2 compare pendulum kepler
exits 2 compare pendulm
says 'did you mean pendulum'
exits 2 compare pendulum --integrators verlat
says 'verlat; did you mean verlet'
exits 2 compare pendulum --gradient centrall4
says 'did you mean central4'
exits 2 compare pendulum --dt 0
exits 2 compare pendulum --dt 0.1,x
says '^nevh: --dt: '
exits 2 compare pendulum --dt 0.1 --t-end 0
exits 2 compare pendulum --t-end -1
says 'before it begins'
exits 2 compare pendulum --format xml
exits 2 compare pendulum --without gravitation
says 'gravitation'
exits 2 compare pendulum --set mm=1
says 'mm'
exits 2 list pendulums
exits 2 list int
says 'did you mean integrators'
exits 2 list models --dt 1
says 'no option of nevh list'

# Errors of a scene have a position.
cat >$work/wrong.nevh <<'END'
[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
spring = y^2/2
[run]
t_end = 1
dt = 0.1
END
exits 2 compare $work/wrong.nevh -o $work/never.csv
says 'wrong.nevh:5:10: error: '
says '^ *\^'
test -e $work/never.csv && fails "wrote a file in spite of an error"

# What the pendulum teaches.
exits 0 compare pendulum --dt 0.1 --t-end 1000
has '^ verlet +2 +yes +0\.1 +6\.4e-02 .*bounded$'
has '^ rk4 +4 +no +0\.1 +2\.2e-01 +-2\.2e-01 .*drifts$'
has '^ euler .*unstable$'
has "rk4 at dt = 0.1 s loses energy steadily"
has "it passed verlet's 6\.4e-02 near t ="
has '(=|^) +29[34]\.[0-9] s\.$'
has 'effects on: kinetic, gravity'
exits 0 compare pendulum --dt 0.1 --t-end 5 --without gravity
has 'off: gravity \(never evaluated\)'

# CSV: the columns, as many in each row.
columns=scene,integrator,order,symplectic,gradient,dt,steps,status,\
max_energy_error,rms_energy_error,final_energy_error,energy_drift,state_error,\
hamiltonian_evals,gradient_evals,sweeps,seconds,verdict,observed_order,seconds_spread,native,tolerance
exits 0 compare pendulum --integrators verlet,rk4,euler --format csv \
    --dt 0.1,0.05 --t-end 10.03
test "$(grep -v '^#' $work/out | head -n 1)" = "$columns" ||
    fails "has other columns"
grep -v '^#' $work/out | awk -F, 'NF != 22 { print; wrong = 1 }
    END { exit wrong || NR != 7 }' || fails "has other rows"
has '^# energy_scale: '
has '^pendulum,verlet,2,yes,central4,0\.1,101,ok,'
has '^pendulum,euler,.*,unstable: since t = 0\.7,.*,unstable,,'
awk -F, '$2 == "verlet" && $6 == 0.05 { found = $19 > 1.8 && $19 < 2.2 }
    END { exit !found }' $work/out || fails "observes another order"

# Refusals are rows, with their reason quoted.
exits 0 compare double-pendulum --integrators verlet,gauss4 --dt 0.02 \
    --t-end 1 --format csv
has ',0\.02,,"refused: verlet needs H = T\(p\) \+ V\(q\), but term ""kinetic"" '
has '^double-pendulum,gauss4,4,yes,central4,0\.02,50,ok,'
exits 0 compare pendulum --t-end 5 --gradient central2,exact --format csv
has ',central2,'
has ',exact,.*,ok,'

# A row that fails numerically.
cat >$work/fails.nevh <<'END'
[coordinates]
x = 1, -10
[effects]
kinetic = p_x^2/2
wall = -sqrt(x)
[run]
t_end = 1
dt = 0.01
integrators = rk4
END
exits 1 compare $work/fails.nevh --format csv
has ',rk4,4,no,central4,0\.01,,"?failed: '

# Files are there when they are whole; JSON is JSON; no locale matters.
exits 2 compare pendulum --t-end 1 -o $work/nowhere/out.csv
says 'cannot be written'
exits 0 compare pendulum --t-end 1 --format csv -o $work/out.csv
test -s $work/out.csv || fails "wrote nothing"
test "$(echo $work/out.csv*)" = $work/out.csv || fails "left other files"
ln -s out.csv $work/link.csv
exits 0 list models -o $work/link.csv
test -L $work/link.csv || fails "replaced a symbolic link"
grep -q elastic $work/out.csv || fails "wrote elsewhere"
exits 2 compare pendulm -o $work/out.csv
grep -q elastic $work/out.csv || fails "touched a file in spite of an error"
if test -c /dev/full; then
    exits 2 list models -o /dev/full
    says 'cannot be written'
fi
exits 0 compare pendulum --t-end 1 --format json
if command -v python3 >/dev/null 2>&1; then
    python3 -m json.tool $work/out >/dev/null || fails "is no JSON"
fi
exits 0 compare pendulum --integrators verlet --t-end 1 --quiet
lacks '^#|effects|bounded:'

# A scale of the scene's own: 10 of 0.5, so that errors are 20 times smaller.
sed 's/^t_end .*/&\nenergy_scale = 10*k/' "$srcdir/scenes/oscillator.nevh" \
    >$work/scaled.nevh
for scene in oscillator $work/scaled.nevh; do
    exits 0 compare $scene --integrators verlet --dt 0.1 --format csv
    grep -v '^#' $work/out | awk -F, 'NR == 2 { print $9, $12 }' >>$work/scales
done
awk 'NR == 1 { max = $1; drift = $2 }
     NR == 2 { wrong = $1 * 20 / max - 1; wrong += $2 * 20 / drift - 1 }
     END { exit !(NR == 2 && wrong < 1e-9 && wrong > -1e-9) }' $work/scales ||
    { fails "takes another scale"; cat $work/scales; }

# Steps that follow the orbit.
sed -e 's/^dt .*/dt = 2*pi\/50\ntransform = (x^2 + y^2)^(3\/4)/' \
    -e 's/^x = .*/x = 1 + e/; s/^p_y = .*/p_y = sqrt((1 - e)\/(1 + e))/' \
    "$srcdir/scenes/kepler-0.9.nevh" >$work/comet.nevh
exits 0 compare $work/comet.nevh --t-end 20 \
    --gradient exact --integrators gauss8,gauss8+transform,adaptive-verlet
has '^ gauss8 .* [0-9.]+e[-+]0[01] '
has '^ gauss8\+transform .* [0-9.]+e-(09|1[0-9]) .*bounded$'
has '^ adaptive-verlet .*bounded$'
exits 2 compare kepler --integrators gauss8+transform
says 'has no transform'

# The other commands.
exits 0 list integrators
has '^ verlet +2 '
exits 0 list integrators --all --format csv
has '^gauss16,16,yes,yes,no,no,no,,any,yes,'
has '^gonzalez,2,no,yes,no,yes,no,,any,no,'
exits 0 list gradients
has '^ central4 +4 '
exits 0 list models --format csv
has '^pendulum,1,'
exits 0 list scenes
has '^ double-pendulum +2 '
exits 0 check double-pendulum --all
has 'separable +no'
has '^ verlet +2 +no$'
has 'dprkn12: needs H'
has 'mixes coordinates'
has '^ gauss4 +4 +yes'
exits 0 effects pendulum --t-end 1
has '^ kinetic +on +momenta '
has '^ gravity +on +coordinates '

# Every scene is in the list and is compared in little time.
count=0
for scene in "$srcdir"/scenes/*.nevh; do
    name=$(basename "$scene" .nevh)
    end=0.5
    test "$name" = outer-solar-system && end=500 # days
    exits 0 compare "$name" --t-end $end --format csv
    lacks ',failed'
    grep -q "/$name\.nevh" "$srcdir/scenes/local.mk" ||
        fails "is not in scenes/local.mk"
    count=$((count + 1))
done
test $count -ge 17 || { echo "only $count scenes"; status=1; }
exit $status

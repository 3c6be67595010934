#!/bin/sh
# nevh compare: state errors, equal work, transforms, diagnostics, the verdict.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# field NAME: of CSV, the column's values, row by row; no field before the
# status may hold a comma.
field() {
    grep -v '^#' $work/out | awk -F, -v name="$1" '
        NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) column = i; next }
        { print $column }'
}
# A condition on the values of a column: $1, $2, ... are the rows.
holds() {
    field "$1" | tr '\n' ' ' | awk "{ exit !($2) }" ||
        { fails "$1: not $2"; cat $work/out; }
}

# The reference is named; the table says what is out of step.
exits 0 compare pendulum --dt 0.1,0.05 --integrators verlet,gauss4,rk4 \
    --gradient exact
has '^state error: largest difference from the exact solution \(Jacobi sn\)'
has '^ verlet +2 +yes +0\.1 .* > 50 % .*bounded$'
has '^ gauss4 +4 +yes +0\.05 .* 4e-04 +4\.0 .*bounded$'
has 'Bounded energy does not mean an accurate orbit: the phase of verlet is wrong'
has 'loses energy steadily.*'
has 'slope'
has 'R\^2 = '
exits 0 compare pendulum --dt 0.1,0.05 --integrators verlet,gauss4,rk4 \
    --format csv --gradient exact
has '^# state error: largest difference from the exact solution \(Jacobi sn\)'
holds state_error '$1 > 0.5 && $2 > 5e-3 && $2 < 7e-3 && $5 > 3e-4 && $5 < 5e-4'
# Errors far below 1e-9 have an order; dt does not limit what the tolerance does.
exits 0 compare kepler --t-end 15 --integrators yoshida6 --gradient exact \
    --dt 0.01,0.005 --format csv
holds observed_order '$1 > 5.9 && $1 < 6.1'
# Nor does the rounding that differences may make hide the slope of a scheme's order.
exits 0 compare kepler --t-end 20 --integrators yoshida6 --gradient central4 \
    --dt 0.03,0.015,0.0075 --format csv
holds observed_order '$1 > 5.9 && $1 < 6.1 && $2 > 5.9 && $2 < 6.1'
# The drift over the run is no larger than the largest error of the same row.
printf '[coordinates]\nx = 5, -1\n[effects]\nkinetic = p_x^2/2\nV = -20/cosh(5*x)^2
[run]\nt_end = 12\ndt = 0.1\nintegrators = verlet, yoshida4, blanes-moan4\n' >$work/well.nevh
exits 0 compare $work/well.nevh
awk '$NF == "unstable" { if ($6 * $6 > 1.0001 * $5 * $5) exit 1; n++ } END { exit n != 3 }' \
    $work/out || { fails "a drift above the largest error"; cat $work/out; }
# A slope that no neighbour agrees with is none.
exits 0 compare kepler --integrators rkn6b --dt 0.1,0.07,0.05,0.035,0.025 --t-end 7 \
    --format csv
test "$(field observed_order | awk '{ printf "%s", ($1 > 3 && $1 < 4 ? "y" : $1 + 0) }')" = 000yy ||
    { fails "tells orders"; field observed_order; }
exits 0 compare kepler --t-end 15 --integrators dopri5 --tolerance 1e-3 --dt 0.1 \
    --format csv
holds dt '$1 > 0.2'
exits 0 compare kepler --t-end 20 --integrators gauss8 --dt 0.02 --format csv
has "exact solution \(Kepler's equation\)"
holds state_error '$1 > 0 && $1 < 1e-9'

# No exact solution: a run, whose own error is told.
exits 0 compare henon-heiles --t-end 30 --integrators gauss8 --dt 0.1 \
    --format csv
has '^# state error: largest difference from taylor in [0-9]+ bits, own error [0-9]e-1[0-9]'
holds state_error '$1 > 0 && $1 < 1e-7'

# A named one, by the scene.
sed 's/^t_end .*/&\nreference = gauss16/' "$srcdir/scenes/pendulum.nevh" \
    >$work/named.nevh
exits 0 compare $work/named.nevh --t-end 30 --integrators verlet
has '^state error: largest difference from gauss16 at dt = '
sed 's/^t_end .*/&\nreference = exact/' "$srcdir/scenes/henon-heiles.nevh" \
    >$work/unknown.nevh
exits 0 compare $work/unknown.nevh --t-end 30 --integrators verlet --format csv
has '^# no state errors: no exact solution of this H is known'
holds state_error '$1 == ""'
sed 's/^t_end .*/&\nreference = gauss8+transform/' \
    "$srcdir/scenes/kepler.nevh" >$work/wrong.nevh
exits 2 compare $work/wrong.nevh
says 'without \+transform'

# Chaos: no number after the horizon.
exits 0 compare double-pendulum-chaotic --t-end 60 --integrators gauss4 \
    --dt 0.02
has '^predictability horizon t = (3[0-9]|4[0-4])'
has '^ gauss4 .* chaos '
exits 0 compare double-pendulum-chaotic --t-end 60 --integrators gauss4 \
    --dt 0.02 --format csv
holds state_error '$1 == ""'
exits 0 compare double-pendulum-chaotic --t-end 4 --integrators gauss6 \
    --dt 0.01 --format csv
holds state_error '$1 > 0 && $1 < 1e-3'

# At equal numbers of gradients verlet beats rk4 over a long run.
exits 0 compare pendulum --match work --dt 0.025 --t-end 1000 \
    --integrators verlet,midpoint,blanes-moan4,rk4 --format csv
has '^# match = work: '
holds dt '$1 == 0.025 && $2 > 0.4 && $2 < 0.5 && $3 > 0.1499 && $4 == 0.1'
holds gradient_evals '$2 > 0.93 * $1 && $2 < 1.07 * $1'
holds gradient_evals '$3 > 0.99 * $1 && $3 < 1.01 * $1 && $4 == 40000'
holds max_energy_error '$1 > 3.5e-3 && $1 < 4.5e-3 && $4 > 0.19 && $4 < 0.25'
holds verdict '$1 == "bounded" && $4 == "drifts"'
sed 's/^t_end .*/&\nmatch = work/' "$srcdir/scenes/pendulum.nevh" \
    >$work/matched.nevh
exits 0 compare $work/matched.nevh --dt 0.025 --t-end 5 --format csv \
    --integrators verlet,rk4
holds dt '$1 == 0.025 && $2 == 0.1'
exits 0 compare $work/matched.nevh --dt 0.025 --t-end 5 --format csv \
    --match steps --integrators verlet,rk4
holds dt '$1 == 0.025 && $2 == 0.025'
exits 0 compare pendulum --match work --dt 0.025 --t-end 5 \
    --integrators itoh-abe
has 'keep the dt given'
exits 2 compare pendulum --match wok
says 'steps or work'

# A transform from the command line: rows beside those without.
exits 0 compare kepler-0.9 --t-end 10 --dt 0.02 --integrators gauss4,verlet \
    --transform '(x^2 + y^2)^(3/4)' --format csv --gradient exact
holds integrator \
    '$1 == "gauss4" && $2 == "verlet" && $3 == "gauss4+transform"'
holds state_error '$3 < $1 && $1 > 0'
# Instead of the scene's.
sed 's/^t_end .*/&\ntransform = 1 + x^2/' "$srcdir/scenes/kepler-0.9.nevh" \
    >$work/other.nevh
for scene in kepler-0.9 $work/other.nevh; do
    exits 0 compare $scene --t-end 10 --dt 0.02 --gradient exact --format csv \
        --integrators gauss4 --transform '(x^2 + y^2)^(3/4)'
    field state_error | tail -n 1 >>$work/transformed
done
test "$(sort -u $work/transformed | wc -l)" -eq 1 ||
    { fails "takes the scene's transform"; cat $work/transformed; }
exits 2 compare kepler --t-end 10 --transform '(x^2 + z^2)^(3/4)'
says '^nevh: --transform: the name z is not known'
says '^\(x\^2 \+ z\^2\)'
for option in '--with foo' '--without foo' '--set foo=1'; do
    exits 2 compare kepler $option
    says "^nevh: ${option% *}: there is no (effect|parameter) foo"
done
exits 2 compare pendulum --set l=2 --set 'm=2*mm'
says '^nevh: --set: .*mm'
says '^m=2\*mm$'
exits 2 compare kepler --t-end 10 --transform 't*x'
exits 2 compare kepler --t-end 10 --transform ''

# Errors of an observable stand beside those of the state: that of a coordinate
# is its own part of them.  Late on the clock they are what they are at t = 0.
cat >$work/late.nevh <<'EOF'
[coordinates]
x = 1
[effects]
K = p_x^2/2
V = x^2/2 + x^4/4
[run]
dt = 0.05
integrators = gauss8, verlet
gradient = exact
EOF
for start in 0 1e9; do
    sed "s/^dt/t_start = $start\nt_end = $start + 10\ndt/" $work/late.nevh \
        >$work/clock.nevh
    exits 0 compare $work/clock.nevh --observable x --format csv
    holds observable_error '$1 > 0 && $1 < 1e-13 && $2 > 1e-4 && $2 < 1e-2'
done
exits 0 compare kepler --t-end 10 --integrators verlet --observable 'x*x + y'
has '^observable: x\*x \+ y; its errors are divided by its range, [0-9.]+$'
has '^ integrator .* state +observable +order'
exits 0 compare double-pendulum-chaotic --t-end 60 --integrators midpoint \
    --dt 0.02 --observable phi1
has '^ midpoint .* chaos +chaos '
exits 1 compare pendulum --t-end 5 --observable 'log(phi)'
says 'log\(phi\) has no value at t = '
exits 2 compare pendulum --observable foo
says '^nevh: --observable: the name foo is not known'

# What a step does to phase space, and what became of invariants.
exits 0 compare kepler --t-end 10 --dt 0.02 --integrators gauss4,rk4 \
    --diagnostics --format csv --gradient exact
holds symplecticity_error '$1 < 1e-11 && $2 > 1e-9'
holds reversal_error '$1 < 1e-12 && $2 > 1e-8'
holds newtons '$1 == 0 && $2 == 0'
holds change_momentum '$1 < 1e-12 && $2 > 1e-8'
holds straightness '$1 >= 0 && $1 <= 1'
exits 0 compare kepler --t-end 10 --dt 0.02 --integrators gauss4 --diagnostics
has '^changes of invariants are absolute'
has 'symplecticity'
has 'change of'
# What steps keep instead of H: of a shadow, which falls with dt^4.
exits 0 compare pendulum --t-end 50 --dt 0.5,0.1,0.05 --diagnostics --format csv \
    --integrators midpoint,rk4
holds max_energy_error '$3 / $5 > 3.8 && $3 / $5 < 4.2'
holds shadow_error '$2 / $3 > 15 && $2 / $3 < 17 && $2 < 3e-4 && $1 > 0.1'
field shadow_error | awk 'NR % 2 == 0 && NF { exit 1 }' || fails "has one of rk4"
exits 0 compare pendulum --t-end 50 --dt 0.5,0.1,0.05 --diagnostics \
    --integrators midpoint,rk4
has '^ midpoint +0\.5 .* breaks down'
has '^midpoint at dt = 0.05 follows a shadow of H, which changes 3[0-9]0 times'
has '^The shadow of H breaks down for midpoint at dt = 0.5: such steps are too long'
exits 0 compare damped-driven-pendulum --t-end 5 --integrators midpoint \
    --diagnostics
lacks 'shadow of H'
# What the total energy does not show: the Moon is lost, which is light.  Short
# steps keep it, and a run that is only late on its orbit loses nothing.
exits 0 compare sun-earth-moon --dt 0.25,0.0125 --integrators rkn14a \
    --gradient exact --diagnostics --format csv
holds max_energy_error '$1 < 1e-4 && $2 < 1e-10'
holds energy_error_moon '$1 > 0.5 && $1 < 2 && $2 < 1e-3'
holds energy_error_sun '$1 < 1e-3 && $2 < 1e-6'
holds body_energy_error '$1 > 5e-3 && $2 < 1e-5'
field worst_body | grep -q Moon || fails "names another body"
exits 0 compare sun-earth-moon --dt 0.25,0.0125 --integrators rkn14a \
    --gradient exact --diagnostics
has '^ integrator .*energy of +energy of +which$'
test "$(grep -c 'The energy of moon is off by' $work/out)" -eq 1 ||
    { fails "tells not one of two runs"; cat $work/out; }
exits 0 compare kepler --dt 0.03 --integrators midpoint --diagnostics \
    --format csv
holds state_error '$1 > 0.5'
holds energy_error_gravity '$1 < 0.02'
lacks worst_body
exits 0 compare sun-earth-moon --dt 0.25 --integrators rkn14a --gradient exact \
    --format csv
lacks 'energy_error_moon'
# As text no wider than 100 columns: what is more goes below, row by row.
exits 0 compare sun-earth-moon --t-end 0.1 --dt 0.01,0.005 --diagnostics \
    --integrators verlet,gauss4 --gradient exact,central2
awk 'length($0) > 100 { exit 1 }' $work/out || fails "is wider than 100 columns"
has '^ integrator +gradient +dt/year +symplecticity .*change of'
has '^ gauss4 +central2 +0\.005 .*[0-9]e-[0-9]+$'
test "$(grep -c '^ verlet ' $work/out)" -ge 8 || fails "does not show rows again"
exits 0 compare sun-earth-moon --t-end 0.1 --dt 0.01 --integrators verlet
lacks 'symplecticity|^ integrator +dt'

# A dt that decides the verdict.
exits 0 compare pendulum --integrators euler,rk4 --dt 0.5,0.05
has 'Warning: a smaller dt changes the verdict of rk4: unstable at dt = 0.5'
lacks 'verdict of euler'


# Where processor time is limited, too, as it is in queues of clusters.
(ulimit -t 60 && $nevh compare pendulum --integrators verlet,gauss4 --dt 0.1 \
    --t-end 20 --repeat 1 --format csv) >$work/out
holds seconds '$1 > 0 && $1 < 2e-3 && $2 > $1'

# Of a long run a part is timed, with --repeat the whole: nothing else differs.
for repeat in '' '--repeat 2'; do
    exits 0 compare pendulum --integrators verlet,gauss4,dopri5 --dt 0.02 \
        --t-end 2000 --tolerance 1e-6 --format csv $repeat
    holds seconds '$1 > 0 && $2 > 0 && $3 > 0'
    grep -v '^#' $work/out | cut -d, -f 1-16,18,19 >>$work/timed
done
test "$(sort -u $work/timed | wc -l)" -eq 4 ||
    { fails "has other rows where all is timed"; cat $work/timed; }

# Where the scene says stop: rows end there, the timed runs too.
sed 's/^t_end .*/&\nstop = phi < 0.3/' "$srcdir/scenes/pendulum.nevh" \
    >$work/stop.nevh
exits 0 compare $work/stop.nevh --integrators verlet,gauss4 --dt 0.1 \
    --format csv
has '^# t = 0 \.\.\. 1000 s, or until phi < 0\.3$'
has '^# 2 of 2 runs stopped where phi < 0\.3: t = 0\.7 \(verlet, dt = 0\.1\)$'
has ',verlet,2,yes,central4,0\.1,7,ok,'
has ',verlet,.*,8,0,[^,]*,[a-z-]*,'
exits 0 compare $work/stop.nevh --integrators verlet,euler --dt 0.1,0.05 \
    --quiet --set l=1.1
exits 0 compare $work/stop.nevh --integrators dopri5 --format csv
has '^# 3 of 3 runs stopped'
lacks ',(failed|refused)'
# Their state errors are of the whole time, as those of a run that ends there.
sed 's/^t_end .*/t_end = 1000\nstop = t > 20/' "$srcdir/scenes/oscillator.nevh" \
    >$work/late.nevh
exits 0 compare $work/late.nevh --integrators verlet --dt 0.1 --format csv --quiet
late=$(sed -n 2p $work/out | cut -d, -f 13)
exits 0 compare oscillator --integrators verlet --dt 0.1 --t-end 20.1 \
    --format csv --quiet
awk -F, -v late="$late" 'NR == 2 { good = late > 0.8 * $13 && late < 1.25 * $13 }
    END { exit !good }' $work/out || fails "has a state error of $late"
# Neither the reference nor the pilots of equal work go beyond: of 1e6 s of chaos
# two, of a ball only until it is about to fall through a hole.
sed 's/^t_end .*/t_end = 1e6\nstop = t > 2/' \
    "$srcdir/scenes/double-pendulum-chaotic.nevh" >$work/soon.nevh
exits 0 compare $work/soon.nevh --integrators gauss4,gauss6 --dt 0.02
has '^state error: largest difference from taylor in'
lacks 'predictability horizon|chaos .*bounded'
cat >$work/hole.nevh <<'END'
[coordinates]
x = 1, -10
[effects]
kinetic = p_x^2/2
wall = -sqrt(x)
[run]
t_end = 1
dt = 0.002
stop = x < 0.5
END
exits 0 compare $work/hole.nevh --integrators verlet,gauss4 --match work \
    --format csv
has ',verlet,2,yes,central4,0\.002,26,ok,'
has ',gauss4,4,yes,central4,0\.0[1-9][0-9]*,[3-5],ok,'
exits 0 gradients $work/stop.nevh --gradient central2
has '13 steps, t = 0 \.\.\. 0\.65'
exits 0 effects $work/stop.nevh
has '^the run stopped at t = 0\.7$'
exits 0 effects $work/stop.nevh --impact
has '^With gravity the run stops at t = 0\.7\.$'
exits 0 check $work/stop.nevh
has 'Highest frequency: omega = (2\.[89][0-9]?|3\.0[0-6]?) '

# The energy scale is that of the motion until it stops: 60 J of a ball that would fall
# to 149 kJ.
cat >$work/ball.nevh <<'END'
[parameters]
m = 0.145
[coordinates]
x = 0
y = 1.5
v_x = 20
v_y = 20
[effects]
kinetic = (p_x^2 + p_y^2)/(2*m)
gravity = m*9.81*y
[friction]
air = all: 0.2
[run]
t_end = 10
dt = 0.1
stop = y < 0
END
exits 0 compare $work/ball.nevh --integrators verlet
has '^energy_scale: 60\.1'
sed '/^stop/d' $work/ball.nevh >$work/falls.nevh
exits 0 compare $work/falls.nevh --integrators verlet
has '^energy_scale: [0-9]{5}'

# Several gradients: verdicts that are alike are said once, others name theirs.
exits 0 compare pendulum --integrators verlet,rk4 --gradient central2,exact \
    --dt 0.5,0.1 --t-end 200
test $(grep -c '^verlet keeps the energy bounded at dt = 0\.1\.$' $work/out) = 1 ||
    fails "says the same twice"
has '^rk4 with the exact gradient at dt = 0\.1 s loses energy steadily'
has '^Warning: a smaller dt changes the verdict of verlet: '
test $(grep -c '^Warning' $work/out) = 1 || fails "warns twice"
exits 0 compare damped-driven-pendulum --integrators rk4 --t-end 500
has 'gains energy steadily against the balance'

# An orbit that has grown beyond numbers, and not H near it, is what fails.
printf '%s\n' '[coordinates]' 'x = 1' '[effects]' 'K = 1e300*p_x^2/2' \
    'V = 1e300*x^2/2' '[run]' 't_end = 1' 'dt = 0.1' 'integrators = verlet' \
    >$work/vast.nevh
exits 1 compare $work/vast.nevh
has '^verlet failed: the orbit has grown beyond all numbers: '
lacks 'reaches|= inf|= -?nan'
exits 1 compare $work/vast.nevh --format csv
has 'grown beyond all numbers: .*: end the run before, or take a smaller step'

# Steps that take hundreds of thousands of substeps one after another are given up.
printf '%s\n' '[coordinates]' 'x = 1' '[effects]' 'K = p_x^2/2' \
    'V = x^2/2 + 1e-3*sin(1e15*x)' '[run]' 't_end = 2' 'dt = 0.1' \
    'integrators = dopri5' 'tolerance = 1e-12' >$work/noisy.nevh
exits 1 compare $work/noisy.nevh
# However its lines are broken.
tr -s '\n ' '  ' <$work/out | grep -Eq 'dopri5 failed: dopri5 gave up at t = [^ ]*: the step of 0\.1 takes more than 100000 substeps' ||
    fails 'does not say why dopri5 gave up'
# At an unstable equilibrium what moves is rounding: no phase is wrong.  Contrast: starts
# beside it.
for start in pi pi-1e-6 3; do
    test $start = pi && t_end=20 || t_end=2000
    printf '[coordinates]\nx = %s\n[effects]\nK = p_x^2/2\nV = -cos(x)\n[run]\nt_end = %s
dt = 0.5\nintegrators = verlet\n' $start $t_end >$work/upright.nevh
    exits 0 compare $work/upright.nevh
    has '^ verlet .* > 50 %'
    if test $start = pi; then
        has 'starts at rest at an unstable equilibrium'
        lacks 'State error > 50|(is|are) wrong'
    else
        has 'State error > 50'
        lacks 'starts at rest'
    fi
done
exit $status

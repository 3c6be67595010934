#!/bin/sh
# nevh compare: verdicts that a longer run, or theory, bears out.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# verdicts NAME=VERDICT...: what the last table says of each integrator.
verdicts() {
    for expected; do
        grep -Eq "^[^#,]*,${expected%=*},.*,${expected#*=}," $work/out ||
            { fails "is not $expected"; cat $work/out; }
    done
}
compares() {
    exits 0 compare "$@" --format csv --repeat 1
}

# A beat of step and period, or another modulation, slower than the run.
compares double-pendulum-regular --integrators tao2,gauss8,rk4 --dt 0.0438 \
    --t-end 60
verdicts tao2=bounded gauss8=bounded rk4=drifts
compares pendulum --integrators gauss16,gauss20 --dt 0.8 --t-end 100
verdicts gauss16=bounded gauss20=bounded
compares pendulum --integrators gauss16,rk4 --dt 0.4 --t-end 100
verdicts gauss16=bounded rk4=unstable
compares coupled-pendulums --integrators gauss4 --dt 0.48632 --t-end 240
verdicts gauss4=bounded
compares magnetic --integrators gauss6,rk4 --dt 1.641 --t-end 772.8
verdicts gauss6=bounded rk4=drifts

# Passages of the pericentre; energy that goes from mode to mode; chaos.  Of the
# first two the largest error of a run ten times as long is 2.3 and 2.9 times as
# large.
compares earth-halley --dt 0.05 --t-end 1355.4 \
    --integrators lobatto4,mclachlan-atela4,blanes-moan4,gauss6,rk4
verdicts 'lobatto4=(bounded|random-walk)' \
    'mclachlan-atela4=(bounded|random-walk)' \
    blanes-moan4=bounded gauss6=bounded rk4=unstable
compares fput --integrators midpoint,rk4 --dt 0.78431 --t-end 198
verdicts midpoint=bounded rk4=drifts
compares fput-1000 --integrators midpoint --dt 0.23041 --t-end 50
verdicts midpoint=bounded
# Of the chaotic one 480 lengths have an error 85 times as large, which grows.
compares double-pendulum-chaotic --integrators gauss8,rk4 --dt 0.0451 \
    --t-end 60
verdicts 'gauss8=(random-walk|undecided)' rk4=drifts

# Next to no energy is no measure of the error.
scene() {
    printf '[coordinates]\n%b\n[effects]\n%b\n[run]\n%b\n' "$1" "$2" "$3" \
        >$work/$4.nevh
}
scene 'x = 1\ny = 0\np_y = sqrt(2)*(1 - 3e-6)' \
    'K = (p_x^2+p_y^2)/2\nV = -1/sqrt(x^2+y^2)' 't_end = 20\ndt = 0.01' escape
compares $work/escape.nevh --integrators verlet
verdicts verlet=bounded

# A loss that is less than twofold from the first fifth to the last: of half the
# energy at once, and of a line below its ripple.
scene 'x = 1\ny = 0.01' 'K = (p_x^2+p_y^2)/2\nV = x^2/2+5e3*y^2+10*x^2*y^2' \
    't_end = 10\ndt = 0.01' fast
compares $work/fast.nevh --integrators rk4,gauss8 --gradient exact
verdicts rk4=drifts gauss8=bounded
scene 'x = 3' 'K = sqrt(1+p_x^2)\nV = x^2/2' 't_end = 100\ndt = 0.1' ripple
compares $work/ripple.nevh --integrators rk4,gauss4 --gradient exact
verdicts rk4=drifts gauss4=bounded

# Rounding of energies that are met, not of those at the start.
scene 'x = 0' 'K = p_x^2/2\nV = x^2/2\nD = -0.1*x*cos(t)' \
    't_end = 200\ndt = 0.1' driven
compares $work/driven.nevh --integrators gauss8 --gradient exact
verdicts 'gauss8=(bounded|random-walk)'
scene 'x = 1' 'K = p_x^2/2\nV = -x^2/2' 't_end = 60\ndt = 0.1' away
compares $work/away.nevh --integrators gauss8 --gradient exact
verdicts gauss8=undecided
compares $work/away.nevh --integrators gauss8 --gradient exact --t-end 10
verdicts 'gauss8=(bounded|random-walk)'
exits 0 compare $work/away.nevh --integrators gauss4,rk4 --gradient exact
has '^gauss4 at dt = 0\.1: the error, up to .* times the energy scale, is rounding:'
lacks 'take a shorter step'

# A drift over the run is no larger than the errors of the run, whose verdict a
# longer one gives.
compares pendulum --integrators rk4 --dt 0.05 --t-end 3
most=$(grep -v '^[#s]' $work/out | cut -d, -f9)
exits 0 compare pendulum --integrators rk4 --dt 0.05 --t-end 3
awk -v most="$most" '$1 == "rk4" && $3 == "no" { found++
        bad += $6 > 2 * most || $6 < -2 * most }
    END { exit bad || !found }' $work/out || { fails "drifts more than it errs"; cat $work/out; }

# What a longer run meets says nothing of a good run: energy that a drive adds, and
# bodies that come close.
scene 'x = 0.01' 'K = p_x^2/2\nV = (1 + 0.3*cos(2*t))*x^2/2' \
    't_end = 60\ndt = 0.1' tongue
compares $work/tongue.nevh --integrators verlet,gauss4,gauss8
grep -q ',unstable,' $work/out && { fails "calls resonance unstable"; cat $work/out; }
scene 'x[1..3] = 1, -0.5, -0.5\ny[1..3] = 0, sqrt(3)/2, -sqrt(3)/2
p_x[1..3] = 0, -0.6, 0.6\np_y[1..3] = 0.7, -0.35, -0.35' \
    'K = sum(i = 1..3, (p_x[i]^2 + p_y[i]^2)/2)
V = -sum(i = 1..2, sum(j = i+1..3, 1/sqrt((x[i] - x[j])^2 + (y[i] - y[j])^2)))' \
    't_end = 30\ndt = 0.005' three
exits 0 compare $work/three.nevh --integrators gauss8 --repeat 1
tr '\n' ' ' <$work/out | tr -s ' ' | grep -Eq \
    'gauss8 at dt = 0\.005: the energy error is at most [0-9.]+e-1[0-2] in the run, but' ||
    { fails "says nothing of the run itself"; cat $work/out; }
lacks 'is unstable|below 1 %'

# A run that breaks off is compared no further than it came, and says so.
scene 'x = 1' 'K = p_x^2/2\nV = -exp(t)*x^2' 't_end = 10\ndt = 0.1' bursting
exits 0 compare $work/bursting.nevh --integrators rk4
has '^rk4 is unstable'
has '^rk4 at dt = 0\.1 has no state error: it broke off after t = [1-9]'
compares $work/bursting.nevh --integrators rk4
grep -v '^[#s]' $work/out | cut -d, -f13 | grep -q . &&
    fails "has a state error of a part of the run"

# Level over the run, and not beyond it: an escape over a saddle, chaos with a drive,
# long steps; a motion that a drive makes grow, and the error with it.
textbook=${srcdir:-.}/bench/textbook
compares $textbook/tilted-quartic.nevh --integrators midpoint --dt 0.25 \
    --t-end 26
verdicts midpoint=undecided
exits 0 compare $textbook/tilted-quartic.nevh --integrators midpoint --dt 0.25 \
    --t-end 26
has '^midpoint at dt = 0\.25: the energy error is at most 3\.3e-03 in the run, but'
# To infinity, where nothing but the error ends the run.
compares $textbook/tilted-quartic.nevh --integrators position-verlet --dt 0.25 \
    --t-end 31.5
verdicts 'position-verlet=(undecided|unstable)'
compares $textbook/driven-duffing.nevh --integrators gauss8,rkn14a --dt 0.336451 \
    --t-end 28.57
verdicts 'gauss8=(undecided|random-walk)'
compares $textbook/phi-four.nevh --integrators verlet --dt 0.36697 --t-end 500
verdicts 'verlet=(undecided|unstable)'
compares $textbook/mathieu-tongue.nevh --integrators rkn11b --dt 1.1429 \
    --t-end 31
verdicts rkn11b=undecided
exits 0 compare $textbook/mathieu-tongue.nevh --integrators rkn11b --dt 1.1429 \
    --t-end 31
has '^rkn11b at dt = 1\.143: the energies of the motion grow until t = '
# And of like orbits those that stay so.
compares $textbook/mathieu-stable.nevh --integrators verlet,gauss4 --dt 0.1 --t-end 60
verdicts verlet=bounded gauss4=bounded
compares $textbook/henon-heiles-edge.nevh --integrators blanes-moan4 --dt 0.1 \
    --t-end 100
verdicts blanes-moan4=bounded

# An orbit that `stop` ends, on its way out, is judged by what it did before.
blind=${srcdir:-.}/bench/blind
compares $blind/hh-escape.nevh --integrators pefrl,blanes-moan4,rk4 \
    --gradient exact --dt 0.088 --t-end 33.5
verdicts pefrl=bounded blanes-moan4=bounded rk4=drifts
exits 0 compare $blind/hh-escape.nevh --integrators pefrl --gradient exact \
    --dt 0.088 --t-end 33.5
has 'is continued until t = .*, where its energies are far larger'
compares $blind/hh-escape.nevh --integrators symplectic-euler-b --gradient exact \
    --dt 0.70588 --t-end 33.18
verdicts 'symplectic-euler-b=(undecided|unstable)'
# Rounding that is alike at each step, of a matrix that is the exact flow of all of H.
compares oscillator --integrators aba864 --gradient central4 --dt 5 --t-end 315
verdicts aba864=undecided

# Potentials with kinks keep no modified energy: errors that are level for some
# periods grow tenfold later, and implicit equations fail.  Level ones stay so.
scene 'x = 1\np_x = 0.4' 'K = p_x^2/2\nV = abs(x)' 't_end = 30\ndt = 0.15' wedge
compares $work/wedge.nevh --integrators rkn14a,verlet --gradient exact
verdicts 'rkn14a=(undecided|unstable)' verlet=bounded
scene 'x = 1\ny = 0.3' 'K = (p_x^2+p_y^2)/2\nV = abs(x)+abs(y)+(x-y)^2/2' \
    't_end = 60\ndt = 0.15' wedges
compares $work/wedges.nevh --integrators gauss6,gauss8 --gradient exact
verdicts gauss6=undecided gauss8=undecided
# Also where no name shows them.
# With dt = 0.05 gauss8 is between the two.
scene 'x = 1\np_x = 0.3' 'K = p_x^2/2\nV = sqrt(sin(x)^2)' 't_end = 20\ndt = 0.052' \
    root
compares $work/root.nevh --integrators gauss4,gauss8 --gradient central4
verdicts gauss4=unstable gauss8=undecided

# In a resonance the error grows with the square of the time, as the energies do.
scene 'x = 1\ny = 0' \
    'K = (p_x^2+p_y^2)/2\nV = (x^2+y^2)/2\nD = -0.1*x*cos(t)+0.1*y*sin(t)' \
    't_end = 100\ndt = 0.1' resonance
exits 0 compare $work/resonance.nevh --integrators pefrl,gauss4 --gradient exact
has '^ pefrl .* undecided$'
has '^ gauss4 .* undecided$'
has '^pefrl at dt = 0\.1: the energies of the motion grow until t = '
# Off the resonance by the error of the step the energies swing, thousands of times as
# large as in the run.
scene 'x = 0' 'K = p_x^2/2\nV = x^2/2\nD = -0.1*x*cos(t)' 't_end = 31.2\ndt = 1.2' swing
compares $work/swing.nevh --integrators mclachlan-sb3a5 --gradient central4
verdicts mclachlan-sb3a5=undecided
scene 'x = 1' 'K = p_x^2/2\nV = x^2/2\nD = -0.1*x*cos(2.5*t)' 't_end = 31.2\ndt = 1.2' forced
compares $work/forced.nevh --integrators mclachlan-sb3a5 --gradient central4
verdicts mclachlan-sb3a5=bounded

# A pulse that shorter runs did not meet: none foretells the steps that it takes.
scene 'x = 1' 'K = p_x^2/2\nV = x^2/2\nD = -5*x*exp(-((t-500)/0.5)^2)' \
    't_end = 1000\ndt = 0.1' pulse
exits 0 compare $work/pulse.nevh --integrators euler --gradient exact
lacks 'would keep its error'

# A drift below the noise of differences.
compares kepler --integrators rk4 --dt 0.002 --t-end 20
verdicts rk4=undecided
exits 0 compare kepler --integrators rk4 --dt 0.002 --t-end 20
has '^rk4 at dt = 0\.002: the error is that of rounding in the gradient'
compares kepler --integrators rk4 --dt 0.002 --t-end 20 --gradient exact
verdicts rk4=drifts

# Hundreds of times the energy.
compares pendulum --integrators verlet --dt 0.6,0.5193 --t-end 190
test "$(grep -c ',unstable,' $work/out)" = 2 || fails "leaves it open"

# A run of no steps shows nothing.
scene 'x = 1' 'K = p_x^2/2\nV = x^2/2' 't_end = 10\ndt = 0.1\nstop = x > 0' still
exits 0 compare $work/still.nevh --integrators verlet
has '^verlet at dt = 0\.1: it stopped at t = 0, too early for a verdict'
lacks 'keeps the energy bounded'

# Schemes that choose their steps are told by the tolerance.
exits 0 compare pendulum --integrators dopri5 --tolerance 1e-6 --t-end 100
has '^dopri5 at tolerance = 1e-06 (loses|gains) energy'

# Steps that are advised are confirmed by the next run, and are not far too
# short.
error_at() {
    exits 0 compare pendulum --integrators $1 --dt $2 --t-end $3 --format csv \
        --repeat 1
    grep -v '^#' $work/out | tail -n 1 | cut -d, -f9
}
for scheme in verlet rk4 euler; do
    end=20
    test $scheme = euler && end=1
    exits 0 compare pendulum --integrators $scheme --dt 0.5 --t-end $end
    dt=$(tr '\n' ' ' <$work/out |
        sed -n 's/.*below 1 % until t = [0-9]* s  *take dt =  *\([0-9.e-]*\)  *s.*/\1/p')
    longer=$(awk "BEGIN { print 1.5 * ${dt:-0} }")
    { test -n "$dt" && error_at $scheme $dt $end && error_at $scheme $longer $end; } \
        >$work/errors || fails "advises no dt"
    awk 'NR == 1 && $1 > 0.01 || NR == 2 && $1 < 0.01 { exit 1 }
        END { exit NR != 2 }' $work/errors ||
        { fails "advises dt = $dt"; cat $work/errors; }
done
# Of a thousand seconds of euler that cannot be tried.
exits 0 compare pendulum --integrators euler --dt 0.1,0.05
tr '\n' ' ' <$work/out | grep -Eq \
    'euler gains energy at every dt, and +would .* only with +dt below about +[5-7]e-07 s' ||
    { fails "has no dt for euler"; cat $work/out; }
lacks 'stable up to 0\.00'
has 'omega dt = '
lacks 'h w'

# Orders are not read from rounding.
exits 0 compare pendulum --integrators gauss8 --dt 0.02,0.01 --t-end 100 \
    --format csv --repeat 1
grep -v '^#' $work/out | tail -n 1 | cut -d, -f19 | grep -q . &&
    fails "sees an order in rounding"

# What a longer run is needed for is said, and that a short one is followed.
exits 0 compare pendulum --integrators gauss16 --dt 0.8 --t-end 100
has '^100 s is too short to judge gauss16: its verdict is from runs to t = '
has '^gauss16 keeps the energy bounded'
exits 0 compare pendulum --integrators rk4 --dt 0.05 --t-end 10
lacks 'keeps? the energy bounded'
has 'rk4 at dt = 0\.05 s (loses|gains) energy'

# Where a drift passes another scheme's error is foretold, and not sooner than the
# first step.
exits 0 compare pendulum --integrators verlet,rk4 --dt 0.1 --t-end 200
passes=$(tr '\n' ' ' <$work/out | tr -s ' ' | sed -n \
    "s/.*still below verlet's [^,]*, which it would pass near t = \([0-9.]*\) s.*/\1/p")
errors_at() {
    exits 0 compare pendulum --integrators rk4,verlet --dt 0.1 \
        --t-end "$passes*$1" --format csv --repeat 1
    grep -v '^[#s]' $work/out | cut -d, -f9 | tr '\n' ' '
}
errors_at 0.97 | awk '!($1 < $2) { exit 1 }' || fails "passes before t = $passes"
errors_at 1.03 | awk '!($1 > $2) { exit 1 }' || fails "is below after t = $passes"
exits 0 compare pendulum --integrators gauss16,rk4 --dt 0.1 --t-end 200
tr '\n' ' ' <$work/out | tr -s ' ' |
    grep -q "above gauss16's [^ ]* from the first step on" ||
    { fails "passes before the first step"; cat $work/out; }
# A line that errors do not follow says nothing of first steps.
exits 0 compare fput --integrators blanes-moan4,rk4
tr '\n' ' ' <$work/out | tr -s ' ' |
    grep -q "rk4 .* at the end it is far above blanes-moan4's" ||
    { fails "tells of first steps by the whole run"; cat $work/out; }

# A run that is told unstable by what follows it says so.
exits 0 compare double-pendulum --integrators tao4 --dt 0.03 --t-end 1 --format csv
has ',unstable: after t = 1,'

# Rounding above all energies of the start hides the scheme; a drive that pulls the
# pendulum along makes its energies grow, and the error of no scheme larger than they;
# a large error, level for sixteen lengths and a hundred times as large thereafter.
scene 'x = 1' 'K = p_x^2/2\nV = -x^2/2' 't_end = 20\ndt = 0.1' saddle
compares $work/saddle.nevh --integrators itoh-abe-symmetric --gradient central4 --dt 0.4 --t-end 60
verdicts itoh-abe-symmetric=undecided
compares damped-driven-pendulum --integrators symplectic-euler-b,euler --gradient central4 \
    --dt 0.8 --t-end 471.2
verdicts symplectic-euler-b=undecided euler=unstable
scene 'x = 3' 'K = sqrt(1 + p_x^2)\nV = x^2/2' 't_end = 100\ndt = 0.1' fast-mass
compares $work/fast-mass.nevh --integrators lobatto4,gauss4 --gradient central4 --dt 1.2 --t-end 699.6
verdicts 'lobatto4=(unstable|undecided)' gauss4=bounded

# Strong friction, which rk4 follows up to gamma dt = 2.78.
printf '%s\n' '[coordinates]' 'x = 1' '[effects]' 'kinetic = p_x^2/2' \
    'spring = x^2/2' '[friction]' 'drag = x: 50' '[run]' 'dt = 0.1' 't_end = 100' >$work/drag.nevh
exits 0 compare $work/drag.nevh --integrators rk4
tr '\n' ' ' <$work/out | tr -s ' ' |
    grep -q 'omega dt = 0\.1 that is soon large, or dt is too long for a rate of friction' ||
    { fails "blames omega dt"; cat $work/out; }

# What exceeds all energies later is not level until then.
scene 'x = 1, 0' 'H = p_x^2/2 + x^2/2*(1 + 1e-3*exp(t - 80))' 't_end = 40\ndt = 0.02' late
exits 0 compare $work/late.nevh --integrators gauss4 --gradient exact
tr '\n' ' ' <$work/out | tr -s ' ' >$work/all
grep -q 'grows past every energy the system started with when' $work/all || fails "tells nothing of the growth"
grep -q 'level over the run, and up to' $work/all && fails "is level and exceeds"

# A large error that is level in the longer run is not called unlimited.
scene 'x = 1\np_x = 0.1' 'K = p_x^2/2\nV = x^4/4\nD = -2*x*cos(1.3*t)' 't_end = 1800\ndt = 0.6' \
    quartic
exits 0 compare $work/quartic.nevh --integrators gauss4 --gradient exact
tr '\n' ' ' <$work/out | tr -s ' ' >$work/all
grep -q 'keeps the energy bounded' $work/all && grep -q 'grows past every energy the system started with when' $work/all &&
    fails "is bounded and exceeds"

# Errors of a balance add up, which is a drift while the motion does not grow: verlet
# loses 5 times H at the start, on the attractor.  Motion that grows is unstable.
cat >$work/duffing.nevh <<'END'
[coordinates]
x = 0.1, 0
[effects]
kinetic = p_x^2/2
well = x^4/4 - x^2/2
drive = -0.3*cos(t)*x
[friction]
drag = x: 0.25
[run]
t_end = 1885
dt = 0.1
END
compares $work/duffing.nevh --integrators verlet,gauss4,rk4
verdicts verlet=drifts gauss4=drifts rk4=drifts
compares $work/duffing.nevh --integrators euler
verdicts euler=unstable

# A start near a saddle, where H is small by chance: errors are relative to the energies
# of the motion, 0.26.
for start in '1e-4 1e-3' '1e-6 1e-3' '1e-3 0' '1e-8 1e-6'; do
    scene "x = ${start#* }\np_x = ${start% *}" 'K = p_x^2/2\nV = x^4/4 - x^2/2' \
        't_end = 100\ndt = 0.1' saddle
    compares $work/saddle.nevh --integrators verlet,rk4
    verdicts verlet=bounded 'rk4=(drifts|undecided)'
    has '^# energy_scale: 0\.2[56]'
done

# In uniform gravity heun and rk4 are exact, and the error is the rounding of differences;
# at rest and in free flight there is none.  Elsewhere they drift.
scene 'x = 0, 3\ny = 0, 4' 'K = (p_x^2 + p_y^2)/2\nV = 9.81*y' 't_end = 10\ndt = 0.1' gravity
compares $work/gravity.nevh --integrators verlet,heun,rk4,euler
verdicts verlet=bounded heun=undecided rk4=undecided euler=unstable
scene 'x = 0, 3\ny = 0, 4' 'K = (p_x^2 + p_y^2)/2\nV = 9.81*y + y^4/1e3' \
    't_end = 10\ndt = 0.1' bent
compares $work/bent.nevh --integrators heun,rk4
verdicts heun=drifts rk4=drifts
scene 'x = 1' 'K = p_x^2/2\nV = x^4/4 - x^2/2' 't_end = 100\ndt = 0.1' still
exits 0 compare $work/still.nevh --integrators rk4
has 'rk4 at dt = 0.1: the energy error is 0 throughout'
lacks 'hidden|drift that'
exits 0 recommend $work/still.nevh --energy-error 1e-8
has 'Take '
has 'the shortest period of the orbit, at the start'
lacks 'energy drifts|too short|The verdict on its'
exits 0 recommend pendulum --energy-error 1e-3 --integrators rk4
has 'Its energy drifts'
has 'the shortest period of the orbit, at t = [1-9]'
# A motion that a drive makes grow, beside which the loss of rk4 is small, and one that
# euler makes grow.
scene 'x = 1' 'K = p_x^2/2\nV = (1 - 0.2*cos(2*t))*x^2/2' 't_end = 400\ndt = 0.05' raised
compares $work/raised.nevh --integrators rk4,euler
verdicts rk4=undecided euler=unstable

# Losses of a close encounter, at a time when steps are short beside most of the orbit, are
# not those of each step; contrast: those of euler.
scene 'x = 0.4, -0.8660254\ny = 0.8660254, 0.4' 'K = (p_x^2 + p_y^2)/2\nR = p_x*y - p_y*x
V = -0.9/hypot(x + 0.1, y) - 0.1/hypot(x - 0.9, y)' 't_end = 200\ndt = 0.01' trojan
exits 0 compare $work/trojan.nevh --integrators rk4
has '^rk4 is unstable'
lacks 'soon large'
exits 0 compare $work/trojan.nevh --integrators euler
has 'soon large'

# A fall for ever: level in the run alone, and the verdict is said to be of no other run.
# Contrast: a driven pendulum, whose verdict is of the longer run.
scene 'x = 2' 'K = p_x^2/2\nV = max(x - 2, 0)^2*50 + 9.8*x' 't_end = 3\ndt = 0.01' falls
exits 0 compare $work/falls.nevh --integrators verlet
has 'when the run is continued'
lacks 'too short to judge'
scene 'x = 1' 'K = p_x^2/2\nV = -cos(x) - 1.1*x*cos(0.67*t)' 't_end = 225\ndt = 0.1' swings
exits 0 compare $work/swings.nevh --integrators gauss4
has 'too short to judge gauss4'
exit $status

#!/bin/sh
# nevh chaos: rows, words, history, and what it refuses.

. "${srcdir:-.}/tests/support/nevh_support.sh"

rows() { grep -v '^#' $work/out | tail -n +2; }
holds() {
    rows | awk -F, "function abs(x) { return x < 0 ? -x : x }
        !($1) { print; wrong = 1 } END { exit wrong || NR == 0 }" ||
        fails "does not hold: $1"
}
start='y=-0.25,p_x=0.42081,p_y=0'

# Chaos and order, with words; a run goes on until it is clear which.
exits 0 chaos henon-heiles --start $start
has '^ scene +integrator +dt +t +exponent +value +error +sali +megno +verdict'
has 'chaotic: nearby orbits separate e-fold every [12][0-9.]+ '
# 0.045 of long runs; short ones from here are in the midst of chaos, and above it.
exits 0 chaos henon-heiles --start $start --t-end 50000 --starts 16 --format csv
tail -n 1 $work/out | awk -F, '{ exit !($6 > 0.040 && $6 < 0.052) }' ||
    { fails 'has another exponent'; cat $work/out; }
exits 0 chaos henon-heiles --format csv
test "$(grep -v '^#' $work/out | head -n 1)" = \
    scene,integrator,dt,t,exponent,value,error,sali,megno,verdict ||
    fails "has other columns"
holds '$1 == "henon-heiles" && $2 == "verlet" && $3 == 0.2 && $4 >= 1000 &&
       $5 == 1 && abs($6) < 2*$7 && abs($9 - 2) < 0.5 && $10 == "regular"'
test "$(rows | wc -l)" -eq 1 || fails "has not one row"

# What is unstable is told from chaos.
exits 0 chaos pendulum --start phi=pi --t-end 8 --format csv
holds '$6 > 1 && $10 == "unstable"'
exits 0 chaos pendulum --start phi=pi --t-end 8
has 'unstable, not chaotic: nearby orbits separate e-fold every'

# Chaos of the steps is not that of H: Kepler's orbit at a step that is too long.  What is
# chaotic is so by finer steps, too.
exits 0 chaos kepler --set e=0.97 --integrators gauss8 --dt 0.0062 --t-end 300 \
    --starts 2 --format csv
holds '$6 > 3*$7 && $10 == "unresolved"'
exits 0 chaos kepler --set e=0.97 --integrators gauss8 --dt 0.0062 --t-end 300 --starts 2
has 'The steps of gauss8 at dt = 0.0062 are chaotic; finer ones'
exits 0 chaos henon-heiles --start $start --t-end 3000 --samples 2 --format csv
holds '$10 == "chaotic" || NR == 1'
# Steps of 0.01 over corners of 0.001: half of them have half of the exponent.
cat >$work/sheets.nevh <<'END'
[coordinates]
a = 0, 0.7
b = 0.5, -1
c = 1.3, 0.3
[effects]
kinetic = (p_a^2 + p_b^2 + p_c^2)/2
attraction = hypot(a - b, 1e-3) + hypot(b - c, 1e-3) + hypot(a - c, 1e-3)
[run]
t_end = 2000
dt = 0.01
integrators = blanes-moan4
END
exits 0 chaos $work/sheets.nevh --format csv
holds '$6 > 0.3 && $10 == "unresolved"'
exits 0 chaos kepler --set e=0.97 --integrators gauss8 --dt 0.0062 --t-end 300 \
    --starts 2 --samples 3 --format csv
holds '$10 != "chaotic"'

# A budget that is spent ends the run where the scene ends it.
sed 's/^t_end *=.*/t_end = 40/' "$NEVH_SCENES/henon-heiles.nevh" >$work/short.nevh
exits 0 chaos $work/short.nevh --format csv --starts 1
holds '$4 > 40 && $10 == "regular"'
exits 0 chaos $work/short.nevh --format csv --starts 1 --budget 1e-9
holds '$4 == 40 && $10 == "early"'
exits 2 chaos henon-heiles --budget 0
says 'above 0'

# All exponents, in pairs; of each integrator and step that is named.
exits 0 chaos henon-heiles --start $start --integrators verlet,gauss4 \
    --dt 0.2,0.1 --t-end 200 --exponents all --starts 2 --format csv
test "$(rows | wc -l)" -eq 16 || fails "has not 16 rows"
rows | awk -F, '{ sum += $6 } $5 == 4 { if (sum > 1e-8 || sum < -1e-8) {
        print; wrong = 1 } sum = 0; n++ } END { exit wrong || n != 4 }' ||
    fails "has exponents that are no pairs"
exits 0 chaos double-pendulum-chaotic --t-end 20 --exponents 3 --starts 1 \
    --integrators midpoint --format csv
test "$(rows | wc -l)" -eq 3 || fails "has not 3 rows"
holds '$10 != "regular"'

# The history: the end is that of a run without, and what is too early.
exits 0 chaos henon-heiles --t-end 40 --samples 4 --format csv
holds '$4 == 10*NR && $10 == "early"'
rows | tail -n 1 >$work/last
exits 0 chaos henon-heiles --t-end 40 --format csv
rows | cmp -s - $work/last || fails "depends on who looks"
exits 0 chaos henon-heiles --t-end 40
has 'too early to say'
exits 0 chaos henon-heiles --t-end 40 --gali 4 --format json
has 'GALI_4 = '
has '"verdict": "early"'

# Schemes that are no derivatives of themselves.
exits 0 chaos henon-heiles --t-end 20 --integrators gonzalez,tao4 --starts 1
has 'gonzalez: displacements are differences of orbits near by'
has 'tao4: displacements are differences'

# A run that fails says when, and leaves what there was.
printf '%s\n' '[coordinates]' 'x = 1' '[effects]' 'K = p_x^2/2' 'V = -x^4' \
    '[run]' 't_end = 10' 'dt = 0.01' >$work/falls.nevh
exits 1 chaos $work/falls.nevh --format csv
has '^# failed: verlet, dt = 0\.01: '

# What is no use.
exits 2 chaos henon-heiles --exponents 5
says '\-\-exponents 5: there are 4'
exits 2 chaos henon-heiles --exponents none
exits 2 chaos henon-heiles --gali 1
says 'takes 2 to 4 displacements'
exits 2 chaos henon-heiles --integrators taylor
says 'tolerance'
exits 2 chaos kepler-0.9 --integrators adaptive-verlet
says 'depend on the state|chooses its steps'
exits 2 chaos henon-heiles --integrators verlett
# An orbit that loses its energy is not one of H.
lacks 'does not keep the energy'
exits 0 chaos double-pendulum --integrators rk4 --dt 0.1 --t-end 1000
has 'rk4 at dt = 0.1 does not keep the energy .error [0-9.]+ of its scale.: the'
exits 0 chaos double-pendulum --integrators rk4 --dt 0.1 --t-end 1000 --format csv
has '^# rk4 at dt = 0.1 does not keep the energy'
exits 0 chaos damped-driven-pendulum --t-end 300
has 'starts near by agree'
exits 0 chaos double-pendulum --integrators rk4 --dt 0.01 --t-end 10
lacks 'does not keep the energy'

exits 2 chaos henon-heiles --dt 0
exits 2 chaos henon-heiles --plot x.svg
says 'no option of nevh chaos'
exits 2 chaos no-such-scene
# Under friction neighbours come together: exp(-g t/2) of a damped oscillator.
printf '%s\n' '[coordinates]' 'x = 1' '[effects]' 'kinetic = p_x^2/2' \
    'spring = x^2/2' '[friction]' 'drag = x: 0.1' '[run]' 'dt = 0.1' 't_end = 100' \
    >$work/damped.nevh
exits 0 chaos $work/damped.nevh
has 'regular: nearby orbits approach e-fold every (19|20|21)'
# Where the force jumps, displacements say nothing: four sheets of mass, which are
# chaotic.  Where its slope alone does, they do.
cat >$work/sheets.nevh <<'END'
[coordinates]
x[1..4] = 0, 0.31, -0.42, 1.03
p_x[1..4] = 0.3, -0.5, 0.1, 0.1
[effects]
k = sum(i = 1..4, p_x[i]^2/2)
v = sum(i = 1..4, j = i+1..4, abs(x[i] - x[j]))
[run]
t_end = 1000
dt = 0.01
END
exits 0 chaos $work/sheets.nevh --integrators verlet
has 'not resolved: the force jumps'
lacks 'regular:'
exits 0 check $work/sheets.nevh
lacks '^Regular'
sed 's/abs(x.i. - x.j.)/sqrt((x[i] - x[j])^2 + 4e-4)/' $work/sheets.nevh >$work/soft.nevh
exits 0 chaos $work/soft.nevh --integrators verlet
has ': chaotic: nearby orbits separate'
for v in 'max(abs(x) - 1, 0)^2 + y^2/2' 'abs(x)^3 + y^2/2' 'max(x, 0)^3 + x^2 + y^2 + x*y'; do
    printf '%s\n' '[coordinates]' 'x = 1.5, 0.3' 'y = 0.2, 0.7' '[effects]' \
        'k = (p_x^2 + p_y^2)/2' "v = $v" '[run]' 't_end = 1000' 'dt = 0.03' >$work/play.nevh
    exits 0 chaos $work/play.nevh --integrators verlet
    has ': regular: the largest exponent is below 0\.[0-9]'
done
# With friction steps may have an attractor of their own: that of H has 0.0225, -0.053
# and, after a transient of thousands of units of time, -0.042.
# driven NAME V DRIVE RATE DT
driven() {
    printf '%s\n' '[coordinates]' 'x = 0.3' '[effects]' 'K = p_x^2/2' "V = $2" \
        "D = $3" '[friction]' "f = all: $4" '[run]' 't_end = 500' "dt = $5" \
        'integrators = verlet' >$work/$1.nevh
}
driven chaos '-cos(x)' '-1.0845*x*sin(0.6667*t)' 0.5 0.05
exits 0 chaos $work/chaos.nevh --format csv
holds '$6 < $7 && $6 + 2*$7 > 0.0225 && $10 == "unresolved"'
exits 0 chaos $work/chaos.nevh --dt 0.0125 --t-end 4000 --format csv
holds '$6 > 0.018 && $6 < 0.027 && $10 == "chaotic"'
driven well '-x^2/2 + x^4/4' '-0.37*x*cos(1.2*t)' 0.3 0.1
exits 0 chaos $work/well.nevh --format csv
holds 'abs($6 + 0.053) < 2*$7 && $10 == "regular"'
exits 0 chaos $work/well.nevh --dt 0.0125 --t-end 4000 --format csv
holds 'abs($6 + 0.053) < 2*$7 && $7 < 0.003 && $10 == "regular"'
driven late '-cos(x)' '-1.1*x*sin(0.6667*t)' 0.5 0.05
exits 0 chaos $work/late.nevh --format csv
holds '$6 > 0.05 && $10 == "unresolved"'
exits 0 chaos $work/late.nevh --integrators gauss4 --t-end 20000 --format csv
holds 'abs($6 + 0.042) < 2*$7 && $10 == "regular"'
# Steps of several orbits side by side that fail name no lane.
printf '[coordinates]\nx = 0.1\ny = 0.2, 0.3\n[effects]\nK = (p_x^2 + p_y^2)/2
R = p_x*y - p_y*x\nV = -x^2 + y^2/2 - 1/hypot(x, y)\n[run]\nt_end = 1\ndt = 0.001
integrators = gauss4\n' >$work/hill.nevh
exits 1 chaos $work/hill.nevh
says 'stage equations of gauss4 were not solved'
lacks 'lane'
grep -q 'lane' $work/err && fails "names a lane"
exit $status

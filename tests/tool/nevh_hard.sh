#!/bin/sh
# nevh hard: no combination without a verdict, and what some of them must be.

. "${srcdir:-.}/tests/support/nevh_support.sh"

exits 2 hard pendulum
says 'unknown case pendulum'
exits 2 hard --integrators verlat
says 'did you mean verlet'
exits 2 hard --gradient exakt
says 'did you mean exact'
exits 2 hard --dt 1
says 'no option of nevh hard'

# Every case with a few schemes: no crash, no hang, no row without a verdict.
exits 0 hard --integrators verlet,gauss4,gonzalez,rk4,adaptive-verlet \
    --gradient central6 --format csv
has '; 0 on a wrong orbit, 0 without a verdict'
columns=case,integrator,gradient,asked,h_omega,stable_below,steps,\
max_energy_error,bound,state_error,state_bound,happened,verdict
test "$(grep -v '^#' $work/out | head -n 1)" = "$columns" ||
    fails "has other columns"
lacks ',none$'
lacks ',[-+]?(nan|inf)[,"]'

# What theory says of some.
has '^Kepler e = 0.6,verlet,.*,bounded$'
has '^Kepler e = 0.6,rk4,.*,drifts$'
has '^"stiff spring 1e2, resolved",verlet,.*,bounded$'
has '^"stiff spring 1e2, stepped over",verlet,.*stable up to 2.*,(unstable|failed)$'
has '^"double pendulum, regular",verlet,.*needs H = T.*,refused$'
has '^H ends on the way,gauss4,.*,failed$'
has '^resonance omega dt = sqrt\(3\),verlet,.*,(unstable|failed)$'
has '^"1e9 steps, one output",verlet,.*stopped by the budget.*,bounded$'
has '^dt = 1e300,rk4,.*,(failed|unstable)$'
has '^dt = 1e-300,verlet,.*,bounded$'

# What is not symplectic is bounded only within rounding.
grep ',rk4,.*,bounded$' $work/out | sed 's/"[^"]*"//g' |
    awk -F, '$8 > 1e-8 && !/kink/ { print; wrong = 1 } END { exit wrong }' ||
    fails "calls rk4 bounded"

# compare names the cause, and a step to take.
exits 0 compare "$srcdir/scenes/hard/elastic-pendulum.nevh" --dt 0.025 \
    --t-end 2 --integrators verlet,midpoint
has '^verlet at dt = 0.025: omega dt = 2\.5 near'
has 'stable up to 2'
lacks '^midpoint at dt = 0.025:'

# For people: the counts, and one line a case and verdict.
exits 0 hard 'Kepler e = 0.6' 'H changes from call to call' \
    --integrators verlet,euler,gauss4
has '^2 cases x 3 schemes x 3 gradients: 18 combinations'
has '^ Kepler e = 0.6 .*bounded'
has '^ H changes from call to call .*refused'
exit $status

#!/bin/sh
# What accuracy costs: nevh cost, nevh recommend, nevh gradients.

. "${srcdir:-.}/tests/support/nevh_support.sh"

records() {
    grep -v '^#' $work/out
}

# Usage.
exits 2 cost pendulum --repeat 0
says 'repeat takes numbers above 0'
exits 2 cost pendulum --repeat 1.5
exits 2 cost pendulum --budget 0
says 'budget takes numbers above 0'
exits 2 recommend pendulum --energy-error 1e-3 --budget 1
says 'no option of nevh recommend'
exits 2 cost pendulum --by speed
exits 2 cost pendulum --integrators verlat
exits 2 cost double-pendulum --integrators verlet
says 'verlet needs H = T\(p\) \+ V\(q\), but term'
exits 2 compare pendulum --by state
says 'no option of nevh compare'
exits 2 recommend pendulum
says 'needs --energy-error X or --state-error X'
exits 2 recommend pendulum --energy-error 1e-3 --state-error 1e-3
says 'not both'
for x in 0 -1 nan inf 1e-3x; do
    exits 2 recommend pendulum --energy-error $x
    exits 2 recommend pendulum --state-error $x
done
exits 2 gradients pendulum --gradient centrall4
exits 2 gradients double-pendulum --integrators verlet
exits 2 cost pendulum --t-end 1 --dt 0.1 --integrators verlet \
    -o $work/nowhere/out.csv

# Without seconds nothing is tried, which is said.
exits 0 cost pendulum --t-end 10 --integrators verlet,taylor
lacks 'friction'
exits 0 cost pendulum --budget 1e-9
has 'were not tried, for lack of time'

# Given steps, and no others; all but the seconds is the same on every run.
for run in 1 2; do
    exits 0 cost pendulum --t-end 10 --dt 0.025,0.1,0.05 \
        --integrators verlet,blanes-moan4,gauss4 --format csv
    records | cut -d, -f 1-16,18,19 >$work/run.$run
done
cmp -s $work/run.1 $work/run.2 || fails "differs from run to run"
has '^# state error: largest difference from the exact solution'
records | awk -F, -v order=verlet:2,blanes-moan4:4,gauss4:4 'BEGIN {
        split(order, pair, ",")
        for (i in pair) { split(pair[i], word, ":"); p[word[1]] = word[2] } }
    NR > 1 { n++; if ($6 != (n % 3 == 1 ? 0.1 : n % 3 == 2 ? 0.05 : 0.025) ||
             !($17 > 0) || !($20 >= 0) || !($13 > 0) || NF != 22) exit 1 }
    NR > 1 && n % 3 != 1 { if ($19 < p[$2] - 0.2 || $19 > p[$2] + 0.2) exit 1 }
    END { if (n != 9) exit 1 }' || { fails "has other rows"; cat $work/out; }
exits 0 cost pendulum --t-end 1 --dt 0.1 --integrators verlet --repeat 3 \
    --format json
if command -v python3 >/dev/null 2>&1; then
    python3 -m json.tool $work/out >/dev/null || fails "is no JSON"
fi

# The steps: at least eight steps, errors that fall as the order says, and
# beside each target the step that is one place coarser on the grid, too.
exits 0 cost pendulum --t-end 3 --integrators blanes-moan4,gauss8,gauss18 \
    --format csv
records | awk -F, 'NR > 1 { n[$2]++; dt[$2, n[$2]] = $6; e[$2, n[$2]] = $9 }
    END {
        order["blanes-moan4"] = 4; order["gauss8"] = 8
        if (n["gauss18"] < 8) exit 1
        for (name in order) {
            if (n[name] < 8) exit 1
            for (i = 2; i <= n[name]; i++) {
                if (dt[name, i] >= dt[name, i - 1]) exit 2
                for (j = i - 1; j > 1 && dt[name, j] < 1.5 * dt[name, i];) j--
                if (e[name, j] < 5e-8 && e[name, i] > 1e-12) {
                    orders++
                    found = log(e[name, j] / e[name, i]) / \
                        log(dt[name, j] / dt[name, i])
                    if (found < order[name] - 0.5 || found > order[name] + 1)
                        exit 3
                }
                for (target = 1e-2; target > 1e-11; target /= 100)
                    if (e[name, i] <= target && e[name, i - 1] > target &&
                        dt[name, i - 1] > 1.3 * dt[name, i]) exit 4
            }
        }
        if (orders < 5) exit 5
    }' || { fails "has no sequence of steps ($?)"; cat $work/out; }

# The same steps where the machine has other things to do: work, not seconds,
# says which steps are tried.
records | cut -d, -f 1-16,18 >$work/run.1
(while :; do :; done) & busy=$!
trap 'kill $busy; exit 1' HUP INT TERM
exits 0 cost pendulum --t-end 3 --integrators blanes-moan4,gauss8,gauss18 \
    --format csv
kill $busy
trap 'exit 1' HUP INT TERM
wait $busy 2>/dev/null
records | cut -d, -f 1-16,18 | cmp -s - $work/run.1 ||
    fails "has other rows where it takes longer"

# The table, by energy and by state.
for by in energy state; do
    exits 0 cost kepler --t-end 7 --by $by \
        --integrators blanes-moan6,gauss8,dop853 --gradient exact
    has '^ integrator +1e-2 +1e-4 +1e-6 +1e-8 +1e-10 +1e-12$'
    has "largest $by error"
    has '^ gauss8 .* [0-9.]+ \(0\.[0-9]+\)'
    has '^ dop853'
    has '^ one more digit +time +evaluations +steps '
    has '^ blanes-moan6 +x 1\.[3-6]'
    has '^price of the gradient \(.*: exact 1, central2'
    has '^For .*digits take (gauss8|blanes-moan6)'
    has '^Times were measured on'
    awk '/^ integrator/ { on = 1 } /^$/ { on = on > 1 ? 0 : on }
         on { for (i = 1; i <= NF; i++) stars += $i == "*" }
         END { exit stars < 4 }' $work/out || fails "has no stars"
done
# Tolerances that outputs are too close for are no floor.
exits 0 cost kepler --t-end 50 --integrators dprkn12,gauss8 --gradient exact
has '^ dprkn12, drifts .* [0-9.]+ \(0\.1[0-9]*\)$'
lacks '^ dprkn12.*floor'
# A flow that is exact, too, has a row where it is named, but no place in the ranking.
exits 0 cost kepler --t-end 2 --integrators gonzalez,gauss8,wisdom-holman
has '^wisdom-holman: the parts solve this H exactly'
lacks '^ wisdom-holman .*[*]|take wisdom-holman'
has '^ gonzalez +- +- '
has '^ wisdom-holman +(\* )?[0-9]'
has '^gonzalez: the energy is conserved exactly at any step'
exits 0 cost kepler --t-end 2 --integrators gauss8,gauss10 --quiet
lacks 'digit|^kepler|price'

# What is recommended keeps its word when compare runs it.
for target in 'energy-error 1e-6 9 blanes-moan6,gauss8,dop853' \
    'state-error 1e-3 13 verlet,position-verlet'; do
    set -- $target
    exits 0 recommend kepler --$1 $2 --t-end 7 --integrators $4
    has '^ cheapest '
    has '^ runner-up '
    has '^  integrators = '
    line=$(sed -n 's/^  nevh //p' $work/out)
    sed -n '/^  \[run\]/,$s/^  //p' $work/out >$work/lines
    exits 0 $line --format csv
    records | awk -F, -v most=$2 -v column=$3 \
        'NR == 2 { kept = $column > 0 && $column <= most } END { exit !kept }' ||
        { fails "does not keep $1 $2"; cat $work/out; }
    sed '/^\[run\]/,$d' "$srcdir/scenes/kepler.nevh" >$work/again.nevh
    sed 's/^\[run\]$/&\nt_end = 7/' $work/lines >>$work/again.nevh
    records | cut -d, -f 2-16 >$work/first
    exits 0 compare $work/again.nevh --format csv
    records | cut -d, -f 2-16 | cmp -s - $work/first ||
        fails "differs from the command line recommended"
done
exits 0 recommend pendulum --energy-error 1e-4 --t-end 2 --gradient central2 \
    --integrators verlet,gauss4 --set l=2 --format csv
records | awk -F, 'NR > 1 && ($9 > 1e-4 || $5 != "central2") { exit 1 }' ||
    fails "has other rows"

# A run that keeps several digits stands there once.  One digit more never
# costs less: steps that are both longer and dearer do not count.
exits 0 cost pendulum --t-end 2 --integrators gauss18,gauss20
lacks ' $'
has '^ gauss(18|20) .* =( |$)'
has '^=: the same run as for the digits to its left'
lacks '^ gauss.* x 0\.'
# Digits that the reference does not have make no column: the constants of this
# exact solution are fitted to values of H, as a Bessel function has no series here.
sed 's|^gravity .*|gravity = -1/sqrt(x^2 + y^2) + 0*bessel_j0(x)|' \
    "$srcdir/scenes/kepler-0.9.nevh" >$work/coarse.nevh
exits 0 cost $work/coarse.nevh --by state --integrators gauss16,gauss20
digits=$(sed -n 's/^\([0-9]*\) digits and more are not resolved: the error of the ref.*/\1/p' \
    $work/out)
test "${digits:-0}" -eq 10 || test "${digits:-0}" -eq 12 || fails "tells too much"
has "^ integrator +1e-2 .* 1e-$((${digits:-0} - 2))\$"
lacks '^floor: '
exits 0 cost pendulum --t-end 5 --integrators dop853
has '^dt of adaptive schemes is their mean step$'
lacks 'row for each tolerance'

# What cannot be reached, and why.
exits 1 recommend pendulum --energy-error 1e-30 --t-end 2 \
    --integrators gauss12,gauss14 --gradient exact
says 'nothing keeps the energy error below 1e-30.* for rounding$'
exits 1 recommend pendulum --energy-error 1e-12 --t-end 2 \
    --integrators gauss10,gauss12 --gradient central2 --gradient-step 0.01
says "for the gradient's own error"
exits 1 recommend pendulum --energy-error 1e-9 --t-end 2 --dt 0.1 \
    --integrators verlet
says 'these steps do not reach it'
exits 1 recommend pendulum --state-error 1e-30 --t-end 2 --integrators gauss8
says 'is not resolved'

# Gradients: against the exact one, with what was expected of them.
exits 0 gradients pendulum --t-end 10 --integrators gauss4 --dt 0.1 --format csv
records | awk -F, 'NR == 1 { next }
    $1 == "exact" { exact = $3 == 0 && $6 == 0 && $9 == 0 }
    $1 == "central4" && $2 == "auto" {
        auto = $3 < 1e-11 && $4 > 0 && $5 > 0 && $7 > 0 &&
            $3 < 20 * ($4 + $5) && $9 < 1e-9 }
    $1 == "central4" && $2 == 0.1 { wide = $3; wide_in = $9 }
    $1 == "central4" && $2 == 0.01 { if (wide) fall = wide / $3
        fall_in = wide_in / $9 }
    $1 == "central2" && $2 < 1e-5 && $2 != "auto" && !($9 < 30 * $10) {
        exit 1 }
    END { exit !(exact && auto && fall > 5e3 && fall < 2e4 &&
                 fall_in > 5e3 && fall_in < 2e4) }' ||
    { fails "has other errors"; cat $work/out; }
# With a scheme that makes no error to speak of, what is measured is the
# gradient's part, of the difference or of rounding.
exits 0 gradients pendulum --t-end 50 --integrators gauss12 --dt 0.05 \
    --gradient central4 --format csv
records | awk -F, 'NR == 1 || $2 == "auto" { next }
    $2 > 5e-3 { n++; if ($8 < 0.9 * $9 || $8 > 1.1 * $9) bad = 1 }
    $2 < 5e-4 { n++; if ($8 > 4 * $10 || $8 < $10 / 10 || $8 > 4 * $9 ||
                        $8 < $9 / 10) bad = 1 }
    END { exit bad || n != 4 }' || { fails "has other parts"; cat $work/out; }
exits 0 gradients double-pendulum --t-end 1 --gradient central4 \
    --gradient-step 0.02
has '^ central4 +0\.02 '
lacks 'auto'
has 'itself makes an energy error'
# A difference that meets the centre is told with its half-spread and the reason.
exits 0 gradients kepler --gradient central8
has '^central8, half-spread 0.1: a difference by x'


# Near the edge of the domain of H stages have no solution: a scheme that fails with
# all steps ends the command with 1 beside others that run.
cat >$work/edge.nevh <<'END'
[coordinates]
x = 1
[effects]
T = p_x^2/2
V = 4*sqrt(x - 1 + 1e-12) + 1e-9/(x - 1 + 1e-9)
[run]
t_end = 1
dt = 0.1
integrators = verlet
END
exits 0 cost $work/edge.nevh --integrators verlet,euler
exits 1 cost $work/edge.nevh --integrators verlet,gauss4
says 'gauss4 .* failed: '
# One that the command chose itself is a row, and no failure of the command.
exits 0 cost $work/edge.nevh --budget 0.5
has '^ midpoint( +fails)+$'
# Nor has a flow that is exact a place in the ranking where it is not named.
svg=$work/cost.svg
exits 0 cost kepler --budget 1 --plot $svg
test -s $work/err && { fails "says something"; cat $work/err; }
lacks '^ (respa|wisdom-holman|saba2) |take (respa|wisdom-holman|saba|aba)|not solved'
tr '\n' ' ' <$work/out | tr -s ' ' | grep -Eq ' respa, .*: the parts solve this H exactly' ||
    { fails "does not say what is exact"; cat $work/out; }
texts | grep -Eqx 'respa|wisdom-holman|implicit-euler' && fails "draws what has no errors"
texts | grep -qx verlet || fails "draws no verlet"
exits 1 cost kepler --integrators implicit-euler,verlet --dt 0.0314159 --t-end 20
says 'implicit-euler .*failed: '
exits 2 cost kepler --integrators respa --t-end 2 --plot $svg
says 'nothing to plot'
# Two counts that are not those of gradients.
exits 0 cost coupled-oscillators --integrators respa,verlet,taylor --budget 0.2
has '^taylor: a series counts as one evaluation'
has '^respa: exact steps of parts are not counted as evaluations'
# Outcomes of the run: the period of a pendulum, 4 K(sin(1))/sqrt(g), by an order of 2
# and of 4.
exits 0 compare pendulum --observable period --integrators verlet,gauss4 --dt 0.1,0.05 \
    --t-end 20 --format csv
has '^# observable: period, 2\.66723073427 of gauss16'
grep -v '^#' $work/out | awk -F, '{ e[$2, $6] = $21 } END { v = e["verlet", 0.1]/e["verlet", 0.05]
    g = e["gauss4", 0.1]/e["gauss4", 0.05]
    exit !(v > 3.8 && v < 4.2 && g > 15 && g < 17 && e["verlet", 0.1] > 1e-3) }' ||
    fails 'has other errors of the period'
exits 0 cost pendulum --observable 'frequency(phi)' --integrators verlet,gauss4 --t-end 20 \
    --dt 0.1,0.05 --format csv
grep -v '^#' $work/out | awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    { e[$at["integrator"], $at["dt"]] = $at["observable_error"] }
    END { v = e["verlet", 0.1]/e["verlet", 0.05]
    exit !(v > 3.5 && v < 4.5 && e["gauss4", 0.1] < e["verlet", 0.1]/100) }' ||
    { fails 'has other errors of the frequency'; cat $work/out; }
exits 1 compare pendulum --observable 'first(phi < -5)' --dt 0.1 --t-end 20
says 'what it waits for does not happen'
exits 1 compare pendulum --observable state --dt 0.1 --t-end 20
says 'there are 2 outcomes, not 1'
exits 2 recommend pendulum --observable period --error 1e-6
says 'is an outcome of a run'
exits 2 cost pendulum --against length --observable period --t-end 20
says 'is an outcome of a whole run'
exits 2 compare pendulum --observable perod
says 'the name perod is not known'
exit $status

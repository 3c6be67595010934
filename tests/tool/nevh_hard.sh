#!/bin/sh
# nevh hard: the rows of nevh compare on every hard case.

. "${srcdir:-.}/tests/support/nevh_support.sh"

exits 2 hard pendulum
says 'unknown case pendulum'
exits 2 hard --integrators verlat
says 'did you mean verlet'
exits 2 hard --gradient exakt
says 'did you mean exact'
exits 2 hard --dt 1
says 'no option of nevh hard'

# The verdict of one row: what CASE INTEGRATOR.
verdict() {
    grep -v '^#' $work/all.csv | sed 's/"[^"]*"/&/' |
        awk -F, -v name="$1" -v scheme="$2" '
            index($0, name) && index($0, "," scheme ",") { print $NF; exit }'
}

# Every case: no crash, no hang, a verdict for each row.
exits 0 hard --integrators verlet,gauss4,rk4 --gradient central6 \
    --format csv -o $work/all.csv
columns=case,repeat,integrator,gradient,dt,t_end,steps,max_energy_error,\
state_error,status,verdict
test "$(grep -v '^#' $work/all.csv | head -n 1)" = "$columns" ||
    fails "has other columns"
test "$(grep -vc '^#' $work/all.csv)" = 148 || fails "has not 49 x 3 rows"
grep -E ',$|[-+,](nan|inf)' $work/all.csv && fails "has rows without a verdict"

# One row is that of the command in its second column.
for one in 'Kepler e = 0.6' 'double pendulum, chaotic' 'Kapitza, stable'; do
    repeat=$(grep -F "$one" $work/all.csv | head -n 1 |
        sed 's/^"[^"]*",//; s/^[^,]*,\(compare\)/\1/; s/,.*//')
    set -f
    exits 0 $repeat --integrators gauss4 --gradient central6 --native never \
        --format csv -o $work/one.csv
    set +f
    wanted=$(grep -v '^#' $work/one.csv | awk -F, 'NR == 2 { print $9 }')
    test -n "$wanted" &&
        grep -F "$one" $work/all.csv | grep -q ",gauss4,.*,$wanted," ||
        fails "has another error than $repeat"
done

# What theory says of some.
while read -r scheme wanted name; do
    found=$(verdict "$name" $scheme)
    echo "$found" | grep -Eqx "$wanted" ||
        fails "calls $scheme on $name $found, not $wanted"
done <<EOF
verlet bounded Kepler e = 0.6
rk4 drifts Kepler e = 0.6
verlet bounded stiff spring 1e2, resolved
verlet unstable|failed stiff spring 1e2, stepped over
verlet refused double pendulum, regular
gauss4 failed H ends on the way
verlet unstable|failed resonance omega dt = sqrt(3)
verlet stopped 1e9 steps, one output
rk4 failed|unstable dt = 1e300
verlet bounded|undecided dt = 1e-300
EOF

# Scenes of hard cases are found by every command; compare names the cause.
exits 0 compare hard/elastic-pendulum --dt 0.025 \
    --t-end 2 --integrators verlet,midpoint
has '^verlet at dt = 0.025: omega dt = 2\.5 near'
has 'stable up to 2'
lacks '^midpoint at dt = 0.025:'

# For people: the counts, and one line a case and verdict.
exits 0 hard 'Kepler e = 0.6' 'double pendulum, regular' \
    --integrators verlet,euler,gauss4
has '^2 cases, 18 rows: '
has '^ Kepler e = 0.6 .*bounded'
has '^ double pendulum, regular .*refused'
exit $status

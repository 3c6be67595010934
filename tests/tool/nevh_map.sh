#!/bin/sh
# nevh sweep --picture: maps and lines, what has no value, and what it refuses.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# refuses WORDS ARGUMENT...
refuses() {
    words=$1
    shift
    exits 2 sweep "$@"
    says "$words"
    test -s $work/out && fails "prints to stdout"
}
refuses 'draws one outcome, and here are 3' pendulum-periods \
    --outcomes state,energy_error --picture $work/a.svg
refuses 'a verdict is none' pendulum-periods --outcomes verdict \
    --picture $work/a.svg
refuses '--picture takes FILE.svg, FILE.png or FILE.pdf, not' pendulum-periods \
    --outcomes period --picture $work/a.doc
refuses 'takes FILE.svg, FILE.png or FILE.pdf' pendulum-periods \
    --outcomes period --picture -
refuses 'is of --picture' pendulum-periods --keep-plot-script $work/gp
exits 2 run pendulum --picture $work/a.svg
says 'it is for sweep$'
refuses 'over one direction, or two' pendulum --outcomes t \
    --vary 'phi = normal(1, 0.1)' --vary 'p_phi = normal(1, 0.1)' \
    --vary 'count = 1' --picture $work/a.svg --t-end 1
test -e $work/a.svg && fails "leaves a picture"

# A map: which start is where, what has none is left out and told.
set -- pendulum --vary 'phi = range(0, 3, 4)' --vary 'p_phi = range(0, 8, 3)' \
    --dt 0.05 --t-end 1 --picture $work/map.svg --keep-plot-script $work/gp
exits 0 sweep "$@" --outcomes 'first(phi > 3.5)'
has '^.*map.svg: 12 members; -o FILE writes them$'
test -s $work/map.svg || fails "draws nothing"
awk '/^\$map/ { on = 1; next } /^EOD/ { on = 0 } on' $work/gp >$work/values
test "$(wc -l <$work/values)" -eq 12 || fails "has not 12 values"
awk '{ print $1, $2 }' $work/values >$work/places
for y in 0 4 8; do for x in 0 1 2 3; do echo $x $y; done; done |
    cmp -s - $work/places || fails "has other places"
exits 0 sweep pendulum --vary 'phi = range(0, 3, 4)' --dt 0.05 --t-end 1 \
    --vary 'p_phi = range(0, 8, 3)' --outcomes 'first(phi > 3.5)' --quiet
# Members go phi by phi, the map row by row: the same values.
tail -n +2 $work/out | awk -F, '{ printf "%g %g %s\n", $3, $4,
    $5 == "" ? "NaN" : sprintf("%.6g", $5) }' | sort >$work/rows
awk '{ printf "%g %g %s\n", $1, $2, $3 == "NaN" ? $3 : sprintf("%.6g", $3) }' \
    $work/values | sort | cmp -s - $work/rows ||
    fails "draws other values than nevh sweep prints"
missing=$(grep -c NaN $work/values)
test "$missing" -gt 2 || fails "has a value everywhere"
grep -q "12 orbits, $missing without a value (hatched)" $work/gp ||
    fails "does not say what is hatched"
grep -q "set cblabel \"first(phi > 3.5) (s)\"" $work/gp || fails "has no label"
# A frequency is an angle per time, whatever it is the frequency of.
exits 0 sweep pendulum --vary 'phi = range(0.5, 1, 3)' --dt 0.1 --t-end 20 \
    --outcomes 'frequency(phi)' --picture $work/line.svg --keep-plot-script $work/gp1
grep -q '"frequency(phi) (rad/s)"' $work/gp1 || fails "has no rad/s"
# From an array, too.
exits 0 sweep "$@" --outcomes 'first(phi > 3.5)' -o $work/map.npy
awk '/^\$map/ { on = 1; next } /^EOD/ { on = 0 } on' $work/gp |
    cmp -s - $work/values || fails "draws other values from an array"

# Steps that are not equal: cells that meet half way, none where no value is.
exits 0 sweep pendulum --vary 'phi = 0, 1, 3' --vary 'p_phi = 0, 8, 9' \
    --dt 0.05 --t-end 1 --picture $work/cells.svg --keep-plot-script $work/gp \
    --outcomes 'first(phi > 3.5)'
awk '/^\$map/ { on = 1; next } /^EOD/ { on = 0 }
    on { print $1, $2, $4, $5, $6, $7 }' $work/gp >$work/cells
grep -qx '1 8 0.5 2 4 8.5' $work/cells || fails "has another cell in the middle"
grep -qx '3 9 2 4 8.5 9.5' $work/cells || fails "has another cell at the end"
test "$(wc -l <$work/cells)" -lt 9 || fails "fills cells without a value"
grep -q 'boxxyerror' $work/gp || fails "draws no cells"

# A line, in order of what is varied, with rows where -o is given.
exits 0 sweep pendulum --vary 'phi = 2, 1, 0.5' --outcomes 'max(p_phi)' \
    --dt 0.05 --t-end 3 --picture $work/line.svg --keep-plot-script $work/gp \
    -o $work/rows.csv
test "$(grep -c ',ok,' $work/rows.csv)" -eq 3 || fails "has not 3 rows"
awk '/^\$series1/ { on = 1; next } /^EOD/ { on = 0 } on { print $1 }' $work/gp |
    tr '\n' ' ' | grep -qx '0.5 1 2 ' || fails "is not in order"
exits 2 sweep pendulum --vary 'phi = 1, 2' --outcomes 'first(phi > 9)' \
    --dt 0.05 --t-end 1 --picture $work/none.svg
says 'no member has a value'
printf 't,phi\n0,2\n1,-1.5\n' >$work/other.csv
exits 2 sweep pendulum --vary 'phi = range(0.5, 2.5, 3)' --outcomes period \
    --t-end 10 --picture $work/none.svg --data $work/other.csv
says 'the picture takes columns phi and period$'
exit $status

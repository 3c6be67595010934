#!/bin/sh
# Each example exits with 0, prints a table, and no number in it is not one; and
# what some of them teach is there.

srcdir=${srcdir:-.}
limit=
command -v timeout >/dev/null 2>&1 &&
    limit="timeout ${CK_DEFAULT_TIMEOUT:-600}"

work=examples.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1

status=0
fails() {
    echo "$example: $1"
    status=1
}

# A line that matches; no row of a table for which awk's condition holds.
has() {
    grep -Eq "$1" $work/out || fails "lacks a line '$1'"
}
no_row() {
    awk "$1"' { print; found = 1 } END { exit found }' $work/out ||
        fails "has a row where $1"
}

look_closer() {
    case $example in
    */integrators)
        has '^ gauss6 +6 +3 3 a sweep +any +yes +yes +no +no +fixed$'
        has '^ naive-adaptive-verlet .* no +no +yes +no +its own$'
        no_row '$1 == "verlet" && $2 != 2'
        "./$example" leapfrog >$work/out || fails "does not know leapfrog"
        has '^ verlet +2 '
        has 'Stoermer-Verlet'
        "./$example" --sources >$work/out || fails "has no sources"
        has '^    .*Fehlberg'
        no_row 'length > 79'
        "./$example" leapfog >$work/out 2>&1 && fails "knows leapfog"
        ;;
    */steps_that_follow)
        has '^ verlet +fixed .* bounded$'
        has '^ adaptive-verlet +r.1\.5 .* bounded$'
        has '^ naive-adaptive-verlet +r.1\.5 .* drifts$'
        has '^ gauss4 +r.1 .* bounded$'
        has '^ gauss8 +r.1\.5 .* bounded$'
        no_row '$2 ~ /^r/ && $5 + 0 > 20'
        no_row '$1 == "gauss4" && $6 > 1e-5'
        no_row '$1 == "gauss8" && $6 > 1e-6'
        ;;
    */conservation)
        has '^ midpoint .* no .* yes .* yes$'
        has '^ rk4 .* no .* no .* no$'
        no_row '$4 == "yes" && $3 > 1e-9'
        no_row '$4 == "no" && $3 < 1e-13'
        no_row '$6 == "yes" && $5 > 1e-11'
        no_row '$6 == "no" && $5 < 3e-13'
        no_row '$8 == "yes" && $7 > 1e-11'
        no_row '$8 == "no" && $7 < 1e-10'
        ;;
    */catalogue)
        has '^ symplectic-euler-a +1 '
        has '^ gsl-rk8pd +8 '
        no_row '$1 == "verlet" && ($4 > 1e-3 || $7 > 1e-4)'
        no_row '$2 ~ /^[0-9]+$/ && $7 > $4'
        ;;
    */own_kernel)
        has '^ my-euler .* bounded$'
        has '^ euler .* unstable$'
        test "$(sed -n 's/^ my-euler *//p' $work/out)" = \
            "$(sed -n 's/^ symplectic-euler-a *//p' $work/out)" ||
            fails "my-euler is not symplectic-euler-a"
        ;;
    */flip_map)
        has '^flips where the energy forbids them: 0$'
        has '^ +4 +4[345]\.'
        no_row 'NF == 1 && /[?]/'
        ;;
    */chaos_share)
        has '^ 0\.0833 .* [01]\.[0-9]$'
        has '^ 0\.1250 .* (4[5-9]|5[0-6])\.[0-9]$'
        has '^ 0\.1667 .* 9[0-9]\.[0-9]$'
        ;;
    */nevh_cost)
        has '^ by hand .* 1\.00 '
        has '^ order 4, blocks of values '
        no_row '$NF ~ /e-/ && $NF > 1e-2'
        ;;
    esac
}

test -n "$EXAMPLES" || { echo "EXAMPLES is empty"; exit 1; }
for example in $EXAMPLES; do
    $limit "./$example" >$work/out 2>$work/err </dev/null
    code=$?
    test $code = 0 || { fails "exit status $code"; cat $work/err; }
    if grep -Eiw '[-+]?(nan|inf|infinity)' $work/out; then
        fails "prints a number that is not finite"
    fi
    # A row of a table holds at least two numbers.
    rows=$(awk '{ n = 0
                  for (i = 1; i <= NF; i++)
                      n += $i ~ /^[-+]?[0-9]*\.?[0-9]+([eE][-+]?[0-9]+)?%?$/
                  rows += n >= 2 }
                END { print rows + 0 }' $work/out)
    test "$rows" -ge 2 || fails "prints no table"
    echo "$example: $rows rows"
    look_closer

    # Only installed headers, and what examples share.
    if grep -E '#[[:space:]]*include[[:space:]]*"' "$srcdir/$example.c" |
        grep -Ev '"(energy_table|gradient_systems)\.h"'; then
        fails "includes more than installed headers"
    fi
done
exit $status

#!/bin/sh
# Each example exits with 0, prints a table, and no number in it is not one.

srcdir=${srcdir:-.}
limit=
command -v timeout >/dev/null 2>&1 && limit="timeout 300"

work=examples.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1

status=0
fails() {
    echo "$example: $1"
    status=1
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

    # Only installed headers, and what examples share.
    if grep -E '#[[:space:]]*include[[:space:]]*"' "$srcdir/$example.c" |
        grep -Ev '"(energy_table|gradient_systems)\.h"'; then
        fails "includes more than installed headers"
    fi
done
exit $status

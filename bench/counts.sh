#!/bin/sh
# Instructions that callgrind counts for an orbit-step of each scheme with each
# gradient, on one orbit and on 32 side by side; see counts.c.  Counts do not
# depend on load, so that two tables can be compared by themselves.  valgrind
# knows no AVX-512: what is counted is the AVX2 version of vector code.
# Usage: counts.sh COUNTS RESULT.csv [EARLIER.csv [SCHEME...]]; with EARLIER
# prints the rows that rose by more than 2 %, and fails where there are any.
set -e
counts=${1:?} result=${2:?} earlier=$3
shift 2
test $# -eq 0 || shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

valgrind --tool=callgrind --toggle-collect=take_steps \
    --dump-after=take_steps --callgrind-out-file="$work/out" \
    "$counts" "$@" >"$work/runs" 2>"$work/log" || {
    cat "$work/log" >&2
    exit 1
}
i=0
while read -r run; do
    i=$((i + 1))
    echo "$run,$(sed -n 's/^totals: //p' "$work/out.$i")"
done <"$work/runs" >"$work/totals"
{
    echo scheme,gradient,system,orbits,instructions
    awk -F, '{ printf "%s,%s,%s,%s,%.1f\n", $1, $2, $3, $4, $6 / ($4 * $5) }' \
        "$work/totals"
} >"$result"
test -z "$earlier" || awk -F, 'FNR == 1 { next }
    { row = $1 "," $2 "," $3 "," $4 }
    NR == FNR { before[row] = $5; next }
    row in before && $5 > 1.02 * before[row] {
        printf "%s: %s, was %s (%+.1f %%)\n", row, $5, before[row],
            100 * ($5 / before[row] - 1)
        rose++ }
    row in before && $5 < 0.98 * before[row] { fell++ }
    { rows++ }
    END { printf "%d of %d rows rose by more than 2 %%, %d fell\n", rose, rows,
        fell; exit rose > 0 }' "$earlier" "$result"

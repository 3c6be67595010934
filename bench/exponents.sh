#!/bin/sh
# Largest Lyapunov exponents that nevh chaos prints, against those of bench/exponents.
#
#     bench/exponents.sh NEVH [EVERY]
#
# EVERY: takes only each so many systems; all of them take some ten minutes.  Prints those
# that are farther than two errors, both added in quadrature; the exit status is 1 where
# that holds for more than 6 %, or where a system has no exponent.
# SPDX-License-Identifier: GPL-3.0-or-later

nevh=$1
every=${2:-1}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

# found FILE: the exponent, its error and the verdict, of CSV.
found() {
    awk -F, '/^#/ { next }
        !rows++ { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { print $at["value"], $at["error"], $at["verdict"] }' "$1"
}

number=0
grep -v '^#' "$(dirname "$0")/exponents" |
    while IFS='|' read -r name start effects t_end dt scheme exponent error source; do
        number=$((number + 1))
        test $((number % every)) -eq 0 || continue
        printf '[coordinates]\n%s\n[effects]\n%s\n' "$start" "$effects" |
            sed 's/; /\n/g' >"$work/one.nevh"
        printf '[run]\nt_end = %s\ndt = %s\nintegrators = %s\n' $t_end $dt $scheme \
            >>"$work/one.nevh"
        "$nevh" chaos "$work/one.nevh" --format csv >"$work/out" 2>"$work/err"
        echo "$name|$(found "$work/out")|$exponent|$error|$source"
    done >"$work/all"
awk -F'|' '{
    count++
    if (split($2, x, " ") < 3) { print "no exponent: " $1; none++; next }
    error = sqrt(x[2]^2 + $4^2); far = x[1] - $3; far = far < 0 ? -far : far
    if (far <= 2*error) { held++; next }
    printf "%s: %.4g +- %.2g (%s), but %.4g +- %.2g by %s\n", \
        $1, x[1], x[2], x[3], $3, $4, $5
} END {
    printf "exponents: %d, of which %d within two errors (%.1f %%), %d without\n", \
        count, held, 100*held/count, none
    exit none > 0 || held < 0.94*count
}' "$work/all"

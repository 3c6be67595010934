#!/bin/sh
# What steps by parts save in near-integrable problems.
#
#     bench/parts.sh NEVH [ERROR...]
#
# For each scene of bench/parts, penning-trap and solar-system, and each error of the state
# (1e-4 1e-7 1e-10): what nevh recommend takes, the best scheme without parts, and the ratio
# of their seconds.
# SPDX-License-Identifier: GPL-3.0-or-later

nevh=$1
shift
test $# -gt 0 || set -- 1e-4 1e-7 1e-10
others=$("$nevh" list integrators --format csv |
    awk -F, '!/^#/ && rows++ && $1 !~ /^(wisdom-holman|saba|aba|respa)/ {
        printf "%s%s", comma, $1; comma = "," }')

# best SCENE ERROR [OPTION...]: the scheme, its step and the seconds, or nothing.
best() {
    scene=$1 error=$2
    shift 2
    "$nevh" recommend "$scene" --state-error "$error" --format csv "$@" 2>/dev/null |
        awk -F, '/^#/ { next }
            !rows++ { for (i = 1; i <= NF; i++) at[$i] = i; next }
            rows == 2 { print $at["integrator"], $at["dt"], $at["seconds"] }'
}

for scene in "$(dirname "$0")"/parts/*.nevh penning-trap solar-system; do
    for error; do
        all=$(best "$scene" "$error")
        without=$(best "$scene" "$error" --integrators "$others")
        echo "$(basename "$scene" .nevh) $error $all $without"
    done
done | awk '{
    if (NF < 8) { printf "%-18s %5s  none found: %s\n", $1, $2, $0; next }
    ratio = $8/$5
    printf "%-18s %5s  %-16s %8.4g %9.3g s  %-16s %8.4g %9.3g s  %6.2f\n",
        $1, $2, $3, $4, $5, $6, $7, $8, ratio
    count++; three += ratio >= 3; dearer += ratio < 1/1.05
} END { printf "%d cases, %d at least 3 times cheaper, %d dearer by more than 5 %%\n",
    count, three, dearer }'

# Counts verdicts of nevh hard --all --format csv, a line a case.
# Fields are quoted as in RFC 4180: the case is the first, the verdict the last.
/^#/ { next }
/^case,/ {
    split("bounded,drifts,unstable,refused,failed", kinds, ",")
    printf "%-32s %8s %8s %8s %8s %8s %8s\n", "", "bounded", "drifts",
        "unstable", "refused", "failed", "none"
    next
}
{
    name = $0
    if (name ~ /^"/) {
        sub(/^"/, "", name)
        sub(/",.*/, "", name)
    } else
        sub(/,.*/, "", name)
    verdict = $0
    sub(/.*,/, "", verdict)
    if (!(name in seen)) {
        seen[name] = 1
        order[++cases] = name
    }
    known = 0
    for (k = 1; k <= 5; k++)
        if (verdict == kinds[k]) {
            count[name, k]++
            total[k]++
            known = 1
        }
    if (!known) {
        count[name, 6]++
        total[6]++
    }
}
function line(label, from, by, k) {
    printf "%-32s", label
    for (k = 1; k <= 6; k++)
        printf " %8d", by ? count[from, k] : total[k]
    print ""
}
END {
    for (i = 1; i <= cases; i++)
        line(order[i], order[i], 1)
    line("all", "", 0)
}

# Counts verdicts of nevh hard --all --format csv, a line a case.
# Fields are quoted as in RFC 4180: the case is the first, the verdict the last.
BEGIN {
    kinds = split("bounded,random-walk,drifts,unstable,undecided,stopped," \
        "refused,failed", kind, ",")
    split("bounded,walk,drifts,unstable,open,stopped,refused,failed", heading,
        ",")
    printf "%-31s", ""
    for (k = 1; k <= kinds; k++)
        printf " %s", heading[k]
    print ""
}
/^(#|case,)/ { next }
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
    count[name, verdict]++
    count["all", verdict]++
}
function line(name, k) {
    printf "%-31s", name
    for (k = 1; k <= kinds; k++)
        printf " %" length(heading[k]) "d", count[name, kind[k]]
    print ""
}
END {
    for (i = 1; i <= cases; i++)
        line(order[i])
    line("all")
}

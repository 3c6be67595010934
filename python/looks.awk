# python/nevh/_looks.py from the table of tools/plot/looks.h.
BEGIN {
    print "\"\"\"Colours and marks of integrators: made by looks.awk of tools/plot/looks.h.\n"
    print "SPDX-License-Identifier: GPL-3.0-or-later\n\"\"\"\n"
}
/^#define NEVH_(COLOURS|MARKS|LOOKS)\(X\)/ {
    table = tolower(substr($2, 6)); sub(/\(x\).*/, "", table)
    print table " = ("
    next
}
/^ *X\(/ {
    count = split($0, part, "\"")
    value = part[2]
    if (table == "marks")
        value = part[4]
    print "    \"" value "\","
    if ($0 !~ /\\$/)
        print ")"
}

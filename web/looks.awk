# Scripts of the live page from the table of tools/plot/looks.h: colours on white and on
# black, marks, and the names of integrators.
BEGIN { print "\"use strict\";" }
/^#define NEVH_(COLOURS|MARKS|LOOKS)\(X\)/ {
    table = substr($2, 1, index($2, "(") - 1)
    printf "const %s = [", table
    next
}
/^ *X\(/ {
    split($0, part, "\"")
    if (table == "NEVH_COLOURS")
        printf "[\"%s\",\"%s\"],", part[2], part[4]
    else
        printf "\"%s\",", part[2]
    if ($0 !~ /\\$/)
        print "];"
}

#!/bin/sh
# sheets.sh SRCDIR NEVH EXAMPLES check|write [SHEET...]: runs the commands that the
# numbers of the worksheets come from, and all that the sheets show, and compares
# the numbers with doc/sheets/numbers.texi, or writes them there.

srcdir=$(cd "$1" && pwd) nevh=$(cd "$(dirname "$2")" && pwd)/$(basename "$2")
examples=$(cd "$3" && pwd) what=$4
NEVH_SCENES=$srcdir/scenes
export NEVH_SCENES
sheets=$srcdir/doc/sheets
work=${TMPDIR:-/tmp}/sheets.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work && cd $work || exit 1
cp "$sheets"/*.nevh .
status=0

nevh() { "$nevh" "$@"; }
example() { "$examples/$1"; }

# One command is run once, whatever it is asked for.
output_of() {
    name=$(echo "$1" | cksum | tr -d ' ')
    test -f "$name" || eval "$1" >"$name" 2>"$name.err" ||
        { cat "$name.err" >&2; echo "fails: $1" >&2; return 1; }
    grep -v '^#' "$name"
}
measure() { # COMMAND AWK FORMAT
    output_of "$1" >output || return 1
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i } '"$2" output |
        head -n 1
}

# A file with the quantities of its sheets, which sheets.texi sets.
expanded() {
    awk '
        /^@node Sheet / { sheet = $3 }
        /^# [0-9]+: / { sheet = $2 + 0 }
        NR == FNR { if ($1 == "@set") {
                value = $0; sub(/^@set [^ ]+ /, "", value); set[sheet, $2] = value }
            next }
        { made = ""
            while (match($0, /@value[{][A-Za-z-]+[}]/)) {
                name = substr($0, RSTART + 7, RLENGTH - 8)
                made = made substr($0, 1, RSTART - 1) set[sheet, name]
                $0 = substr($0, RSTART + RLENGTH) }
            print made $0 }' "$sheets/sheets.texi" "$1"
}
expanded "$sheets/numbers.list" | grep -v '^#' | grep . >list
numbers=0
while IFS='|' read -r key tolerance format command program; do
    number=$(measure "$command" "$program") && test -n "$number" ||
        { echo "$key: no number from $command"; status=1; continue; }
    shown=$(printf "$format" "$number")
    numbers=$((numbers + 1))
    if test "$what" = write; then
        echo "@set $key $shown"
        continue
    fi
    said=$(sed -n "s/^@set $key //p" "$sheets/numbers.texi")
    awk -v a="$said" -v b="$shown" -v n="$number" -v t="$tolerance" '
        function abs(x) { return x < 0 ? -x : x }
        BEGIN { exit !(a != "" && (a == b || abs(a - n) <= t*abs(n))) }' ||
        { echo "$key: the sheets say '$said', and it is $shown ($command)"; status=1; }
done <list >numbers
if test "$what" = write; then
    { echo "@c Made by doc/sheets/sheets.sh; see numbers.list."; cat numbers; } \
        >"$sheets/numbers.texi"
    exit $status
fi
cat numbers
grep -q : numbers && status=1

# Each number that is shown is one of the list.
tr '@' '\n' <"$sheets/answers.texi" |
    sed -n 's/^value{\([a-z-]*\)}.*/\1/p' | sort -u |
    while read -r key; do
        cut -d'|' -f1 list | grep -qx -e "$key" || echo "$key is shown, and not measured"
    done >unknown
test -s unknown && { cat unknown; status=1; }
cut -d'|' -f1 list | while read -r key; do
    grep -q "@value{$key}" "$sheets/answers.texi" || echo "$key is measured, and not shown"
done >unknown
test -s unknown && { cat unknown; status=1; }

# All that stands in examples and begins with nevh is a command that runs.
expanded "$sheets/sheets.texi" | awk '/^@example/ { in_it = 1 } /^@end example/ { in_it = 0 }
    in_it && /^(nevh |    --)/ {
        more = sub(/ \\$/, ""); printf "%s%s", $0, more ? " " : "\n"
    }' >commands
commands=0
while read -r command; do
    commands=$((commands + 1))
    (eval "$command") >out 2>err </dev/null ||
        { echo "exit status $?: $command"; cat err; status=1; }
done <commands
echo "$commands commands ran; $(wc -l <list) numbers"
exit $status

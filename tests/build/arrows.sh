#!/bin/sh
# Folders of the source stand in one order, and what a file includes, or an
# object refers to, is defined in its own folder or an earlier one.  No two
# files of the library have the same name, and what one file alone uses is static.

srcdir=${srcdir:-.}
order='elementary system expression taylor gradient work implicit integrators native run diagnose
    ensemble scene models
    tools/cli tools/experiment tools/plot tools/orbit tools/inspect tools/search
    tools/compare tools/hard tools/report tools'
work=arrows.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1
status=0

# From lines USER USED REASON, folders by name: those that point upward.
upward() {
    awk -v order="$order" '
        BEGIN { n = split(order, name); while (n > 0) { level[name[n]] = n; n-- } }
        level[$1] == "" || level[$2] == "" {
            print "not in the order of folders:", $0; next }
        level[$2] > level[$1] { print $1, "must not use", $2 ":", $3, $4 }'
}
echo 'gradient run contrast' | upward | grep -q 'must not use' || {
    echo "an arrow that points upward was not found"
    exit 1
}
test -z "$(echo 'run gradient contrast' | upward)" || exit 1

# From the words of tests, and lines FILE: NAME TYPE, names of which no other file
# and no test has use.  Those with one underscore are public; one form of a text
# that is compiled for several types may be without use.
alone() {
    awk -F': ' '
        FNR == NR { tested[$1] = 1; next }
        { split($2, word, " "); name = word[1]; sub(/\.libs\//, "", $1) }
        name ~ /^_?nevh_[a-z]/ || name ~ /^_ZGV/ || name == "main" { next }
        { plain = name; sub(/_(dd|quad|long|double)$/, "", plain) }
        word[2] ~ /^[TDBR]$/ { in_file[name] = $1; form[name] = plain; next }
        word[2] == "U" { used[plain] = 1 }
        END { for (name in in_file)
            if (!used[form[name]] && !tested[name]) print in_file[name], name }
        ' "$1" "$2"
}
echo tried >$work/tested
printf '%s\n' 'a.o: tried T' 'a.o: seen T' 'b.o: seen U' 'a.o: hidden T' \
    >$work/all
test "$(alone $work/tested $work/all)" = 'a.o hidden' || {
    echo "a name that only its file uses was not found"
    exit 1
}

# lib/ROOM/..., tools/ROOM/..., or the first folder.  Three rooms of tools use each
# other: an orbit shows measured points, a fit runs orbits, a section has members.
folder_of='function folder(path, part, n) {
    n = split(path, part, "/")
    if (part[1] == "tools" && n > 2)
        return part[2] ~ /^(fit|ensemble)$/ ? "tools/orbit" : "tools/" part[2]
    return part[1] == "lib" ? part[2] : part[1] }'
test "$(echo tools/fit/a.c | awk "$folder_of"'{ print folder($0) }')" = tools/orbit ||
    exit 1

# Headers in include/nevh belong to the folder that implements them.
(cd "$srcdir" && grep -E '^#include ["<]' /dev/null \
    $(find lib integrators models tools -name '*.[ch]')) |
    awk -F'[:"<>]' "$folder_of"'
    BEGIN {
        of["status"] = of["system"] = of["body"] = "system"
        of["simd"] = "elementary"
        of["transform"] = "system"; of["timing"] = "expression"
        of["gradient"] = of["gsl"] = of["probe"] = "gradient"
        of["integrator"] = of["extend"] = of["run"] = "work"
        of["section"] = "run"; of["diagnose"] = of["reference"] = of["loop"] = of["frequencies"] = "diagnose"
        of["chaos"] = "diagnose"; of["confirm"] = "diagnose"; of["shadow"] = "diagnose"; of["certain"] = "taylor"
        of["ensemble"] = "ensemble"; of["sweep"] = "scene"
        of["scene"] = of["binding"] = "scene"; of["models"] = "models"; of["nevh"] = "models"
    }
    $3 ~ /^nevh\// { name = substr($3, 6); sub(/\.h$/, "", name)
        print folder($1), of[name] == "" ? "unknown" : of[name], $1, $3; next }
    $2 ~ /^#include / && $3 ~ /\// && $0 ~ /"/ {
        split($3, part, "/"); room = part[1] == "kernels" ? "integrators" : part[1]
        if ($1 ~ /^tools\//)
            room = folder("tools/" $3)
        print folder($1), room, $1, $3 }' >$work/includes
upward <$work/includes >$work/wrong
test -s $work/includes || { echo "no include was found"; status=1; }

nm=${NM:-nm}
# Those of files that are there: a tree that was built before may hold others.
find lib integrators models tools -name '*.o' 2>/dev/null |
    sed 'h; s,\.libs/,,; s,nevh-,,; s,\.o$,.c,; G; s/\n/ /' |
    while read -r source object; do
        test ! -f "$srcdir/$source" || echo "$object"
    done >$work/objects
objects=$(cat $work/objects)
if test -n "$objects" && $nm --version >/dev/null 2>&1; then
    # Unquoted: $NM may bring options of its own.
    $nm -A -P $objects 2>/dev/null | sed 's/\[[^]]*\]: */: /' >$work/all
    awk -F': ' "$folder_of"'
        { split($2, word, " ") }
        word[1] !~ /^_?nevh_|^_?tool_/ && $1 !~ /^tools/ { next }
        word[2] ~ /^[TDBRCVWi]$/ { of[word[1]] = folder($1); next }
        word[2] == "U" && folder($1) != "" {
            user[++n] = folder($1); used[n] = word[1]; file[n] = $1 }
        END { for (i = 1; i <= n; i++)
            if (used[i] in of) print user[i], of[used[i]], file[i], used[i] }
        ' $work/all >$work/symbols
    upward <$work/symbols >>$work/wrong
    test -s $work/symbols || { echo "no symbol was found"; status=1; }
    (cd "$srcdir" && cat $(find tests bench -name '*.c')) |
        tr -cs 'A-Za-z0-9_' '\n' | sort -u >$work/tested
    alone $work/tested $work/all >$work/alone
    if test -s $work/alone; then
        echo "one file alone uses what is not static:"
        cat $work/alone
        status=1
    fi
fi

if test -s $work/wrong; then
    sort -u $work/wrong
    status=1
fi
find "$srcdir/lib" "$srcdir/integrators" -name '*.[ch]' | sed 's,.*/,,' |
    sort | uniq -d >$work/twice
if test -s $work/twice; then
    echo "names of files that stand twice:"
    cat $work/twice
    status=1
fi
echo "$(wc -l <$work/includes) includes, $(wc -l <$work/symbols) symbols"
exit $status

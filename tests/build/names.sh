#!/bin/sh
# Private names are the standard terms.  No two names differ by underscores
# alone, no type is defined twice, no two files of the library, tools or tests
# have one name, and metaphors that were renamed do not come back.  Comments
# begin with a subject or a verb.

srcdir=${srcdir:-.}
work=names.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1
status=0
folders='include lib integrators models tools bench examples tests'

(cd "$srcdir" && find $folders -name '*.[ch]' ! -path '*/.*' | LC_ALL=C sort) \
    >$work/files
# The code, without comments and strings.
(cd "$srcdir" && sed -e 's,"[^"]*",,g; s,/\*.*\*/,,g; s,//.*,,' \
    -e ':more
        /\/\*/{ N
        s,/\*.*\*/,, 
        b more
    }' $(grep -v '^tests/' "$OLDPWD/$work/files")) >$work/code

# From names, one a line, those that differ by underscores alone.
pairs() {
    sort -u | awk '{ plain = $0; gsub(/_/, "", plain) }
        plain in seen { print seen[plain], $0 } { seen[plain] = $0 }'
}
test "$(printf 'nevh_a_b\nnevh__a_b\nnevh_c\n' | pairs)" = \
    'nevh__a_b nevh_a_b' || { echo "a pair was not found"; exit 1; }
grep -oE '\bnevh_[a-z0-9_]*[a-z0-9]\b' $work/code | pairs >$work/pairs
if test -s $work/pairs; then
    echo "names that differ by underscores alone:"
    cat $work/pairs
    status=1
fi

# Types: `} nevh__name;` at the margin ends one.
sed -n 's/^} \(nevh__*[a-z0-9_]*\);.*/\1/p' $work/code | sort | uniq -d \
    >$work/types
if test -s $work/types; then
    echo "types that are defined twice:"
    cat $work/types
    status=1
fi

# The library is in three folders.
sed -n -e 's,^\(integrators\|models\)/,lib/,' \
    -e 's,^\(lib\|tools\|tests\)/\(.*/\)*\([^/]*\)$,\1 \3,p' $work/files |
    sort | uniq -d >$work/twice
if test -s $work/twice; then
    echo "files of one name:"
    cat $work/twice
    status=1
fi

# The word, or a part of a name between underscores.
words='lean|rub|wiring|shelf|shelve|ladder|ladders|rung|rungs|climb|preflight|flown|explorer
    |unplan|damp|damps|obey'
words=$(echo $words | tr -d ' ')
banned() {
    awk -v word="(^|[^A-Za-z])($words)([^A-Za-z]|\$)" '{ gsub(/"[^"]*"/, "") }
        $0 ~ word { print FILENAME ":" FNR ": " $0; found = 1 }
        END { exit !found }' "$@"
}
echo 'x = shelf_new();' | banned >/dev/null || exit 1
echo 'clean = step;' | banned >/dev/null && exit 1
files=$(cat $work/files)
(cd "$srcdir" && banned $files) >$work/words
if test -s $work/words; then
    echo "words that have a standard term:"
    cat $work/words
    status=1
fi
# Names of what is planned, and of the state of a step, in the library.
grep -nE '\b(nevh__call(ed)?(_[a-z_]*)?|nevh__[a-z_]*_(lean|repeats)|lack|lane_walk)\b' \
    $work/code >$work/terms || :
if test -s $work/terms; then
    echo "names that have a standard term:"
    cat $work/terms
    status=1
fi

# Comments that begin with another word, in the folders that have none.
plain='include integrators lib models tools'
inverted() {
    awk -v words='(Of|What|Whether|Where|Those|That|How|By|Who|Whose|Whoever)' \
        '{ gsub(/"[^"]*"/, "") }
        $0 ~ "/\\* *" words "([^A-Za-z]|$)" { print FILENAME ":" FNR ": " $0; found = 1 }
        END { exit !found }' "$@"
}
echo 'x = 1; /* What follows. */' | inverted >/dev/null || exit 1
echo '/* Whatever follows; what is 1. */' | inverted >/dev/null && exit 1
(cd "$srcdir" && inverted $(find $plain -name '*.[ch]')) >$work/comments
if test -s $work/comments; then
    echo "comments that begin with no subject or verb:"
    cat $work/comments
    status=1
fi
echo "$(wc -l <$work/files) files"
test -s $work/files && exit $status
exit 1

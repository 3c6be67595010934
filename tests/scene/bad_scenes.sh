#!/bin/sh
# Scenes that are wrong: each has one message, with its place, and a caret where
# there is a line to point at; and no output.

. "${srcdir:-.}/tests/support/nevh_support.sh"
bad=$srcdir/tests/scene/bad

# LINE:COLUMN, or - for what no line says.
count=0
while read -r file place words; do
    exits 2 compare "$bad/$file" -o $work/never.csv
    test -e $work/never.csv && fails "wrote a file in spite of an error"
    if [ "$place" = - ]; then
        expected="nevh: $bad/$file: $words"
    else
        expected="$bad/$file:$place: error: $words"
        says '^ *\^~*$'
    fi
    found=$(sed -n 1p $work/err)
    test "$found" = "$expected" || fails "says '$found', not '$expected'"
    count=$((count + 1))
done <"$bad/expected.txt"
test $count = "$(ls "$bad" | grep -c '\.nevh$')" ||
    fails "does not expect all of $bad"

# What is too large, or no text, to be kept in a file.
spring='[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
'
{ echo "$spring"; awk 'BEGIN { printf "V = "
    for (i = 0; i < 10000; i++) printf "("; print "x" }'; } >$work/nested.nevh
exits 2 compare $work/nested.nevh
says 'nested.nevh:6:[0-9]+: error: '
{ echo "$spring"; awk 'BEGIN { printf "V = 1"
    for (i = 0; i < 25000000; i++) printf " + x"; print "" }'; } \
    >$work/long.nevh
exits 2 compare $work/long.nevh
says 'long.nevh:?.* error: '
rm $work/long.nevh
head -c 100000 /bin/sh >$work/binary.nevh
exits 2 compare $work/binary.nevh
says 'binary.nevh:[0-9]+:[0-9]+: error: '
mkdir $work/folder.nevh
exits 2 compare $work/folder.nevh
says folder
echo "$spring" >$work/closed.nevh
chmod 0 $work/closed.nevh
test -r $work/closed.nevh || exits 2 compare $work/closed.nevh

# Where nothing can be written.
good="compare oscillator --t-end 3 --dt 0.1 --format csv"
exits 2 $good -o $work/no/such/folder.csv
says 'cannot be written'
if [ -e /dev/full ]; then
    exits 2 $good -o /dev/full
    says 'cannot be written: No space'
fi
mkdir $work/locked
echo precious >$work/locked/table.csv
(
    ulimit -f 0
    trap '' XFSZ
    "$nevh" $good -o $work/locked/table.csv 2>/dev/null
) && fails "does not notice a full disk"
test "$(cat $work/locked/table.csv)" = precious ||
    fails "spoils the file that was there"
test "$(ls $work/locked)" = table.csv || fails "leaves an unfinished file"
exit $status

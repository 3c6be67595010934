#!/bin/sh
# The worksheets: each command runs, and each number is what its command prints.

srcdir=${srcdir:-.}
. "$srcdir/tests/support/nevh_command.sh"
work=sheets-test.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir -p $work/doc/sheets || exit 1
sh "$srcdir/doc/sheets/sheets.sh" "$srcdir" "$nevh" examples check || exit 1

# Where TeX is, nothing is wider than the page.
if command -v texi2pdf >/dev/null 2>&1 && command -v pdftex >/dev/null 2>&1; then
    top=$(cd "$srcdir" && pwd)
    for name in sheets answers; do
        (cd $work && texi2pdf --batch --quiet -I "$top/doc/sheets" \
            -I "$top/build-aux" "$top/doc/sheets/$name.texi") >$work/out 2>&1 ||
            { cat $work/out; exit 1; }
        grep -A 1 Overfull $work/$name.log && exit 1
    done
    # A title, and a page a sheet: each can be handed out.
    grep -q 'Output written on sheets.pdf (10 pages' $work/sheets.log ||
        { grep 'Output written' $work/sheets.log; exit 1; }
fi

# A number that is wrong is found.
cp "$srcdir"/doc/sheets/* $work/doc/sheets/
grep -e '^# 1:' -e '^rk-twenty|' "$srcdir/doc/sheets/numbers.list" >$work/doc/sheets/numbers.list
sed 's/^\(@set rk-twenty\) .*/\1 1.6e-04/' "$srcdir/doc/sheets/numbers.texi" \
    >$work/doc/sheets/numbers.texi
printf '@node Sheet 1\n@set pendulum pendulum\n@set dt 0.05\n@example\nnevh list scenes\n@end example\n' >$work/doc/sheets/sheets.texi
printf '@value{rk-twenty} and @value{first-p}; @value{rk-twenty}\n' \
    >$work/doc/sheets/answers.texi
ln -s "$(cd "$srcdir" && pwd)/scenes" $work/scenes
sh "$srcdir/doc/sheets/sheets.sh" $work "$nevh" examples check >$work/out &&
    { echo "a wrong number was not found"; exit 1; }
grep -q "rk-twenty: the sheets say '1.6e-04'" $work/out || exit 1
grep -q "first-p is shown, and not measured" $work/out || exit 1

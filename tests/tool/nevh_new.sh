#!/bin/sh
# nevh new: a scene that works, and nothing overwritten.

. "${srcdir:-.}/tests/support/nevh_support.sh"

mine=$work/mine.nevh
exits 0 new $mine
has 'nevh compare .*mine\.nevh'
for section in scene parameters coordinates definitions effects friction \
    invariants observables picture sections labels run; do
    grep -q "^\[$section\]" $mine || fails "lacks [$section]"
done
exits 0 compare $mine --t-end 20 --format csv
lacks ',(failed|refused)'
exits 0 compare $mine --t-end 20 --format csv --with drive --with drag
lacks ',(failed|refused)'
exits 0 check $mine

# What is there stays.
echo mine >$work/there.nevh
exits 2 new $work/there.nevh
says 'is there already'
exits 2 new $work/there.nevh --from kepler
test "$(cat $work/there.nevh)" = mine || fails "overwrote a file"

# From another scene, changed: the same rows as the changed scene itself.
exits 0 new $work/weak.nevh --from coupled-pendulums --set k=0.25 --without coupling
rows() { grep -v '^#' $work/out | cut -d, -f2-16,18,19; }
exits 0 compare $work/weak.nevh --t-end 20 --format csv
rows >$work/copy
exits 0 compare coupled-pendulums --set k=0.25 --without coupling --t-end 20 --format csv
rows >$work/original
cmp -s $work/copy $work/original || fails "is another scene"
grep -q '^k = 0\.25 .*# N m/rad' $work/weak.nevh || fails "lost a comment"

# Usage.
exits 2 new
exits 2 new $work/a.nevh $work/b.nevh
exits 0 new $work/hoop
has 'hoop\.nevh is made\. .*nevh compare .*hoop\.nevh$'
exits 0 compare $work/hoop.nevh --t-end 1 --quiet
exits 2 new $work/hoop
says 'hoop\.nevh is there already'
exits 0 new $work/loud.NEVH
test -e $work/loud.NEVH || fails "makes another file"
# Names that are none: no hidden file, no file beside a device.
mkdir $work/empty
mkfifo $work/empty/pipe
for name in . .. ... .nevh "" pipe; do
    exits 2 new "$work/empty/$name"
done
test "$(ls -A $work/empty)" = pipe || fails "makes hidden files"
exits 2 new $work/nowhere/a.nevh
says 'cannot be written'
exits 2 new $work/a.nevh --from pendulm
says 'did you mean pendulum'
exits 2 new $work/a.nevh --from pendulum --set q=1
exits 2 new $work/a.nevh --set g=1
says '--from'
exits 2 new $work/a.nevh --dt 1
says 'no option of nevh new'
test -e $work/a.nevh && fails "left a file"
exit $status

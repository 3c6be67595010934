#!/bin/sh
# nevh sweep -o FILE.npy: records, parts, what is left when it is killed, and
# what it refuses.

. "${srcdir:-.}/tests/support/nevh_support.sh"
. "$srcdir/tests/support/nevh_interrupt.sh"

scene=$work/mixed.nevh
cat >$scene <<'END'
[parameters]
a = 1
[coordinates]
φ = 1
[effects]
kinetic = p_φ^2/2
well = -log(φ)
[run]
t_end = 1
dt = 0.01
integrators = verlet
[ensemble]
φ = range(-0.1, 2, 150)
p_φ = 0, -2
outcomes = first(p_φ > 0), last(φ)
END
same() { # FILE: has the bytes of the whole sweep
    cmp -s $work/whole.npy "$1" || fails "$1 has other bytes"
    cmp -s $work/whole.npy.txt "$1.txt" || fails "$1.txt has other bytes"
}

# A header, and records of 8 + 8 columns.
exits 1 sweep $scene -o $work/whole.npy
says 'of 300 members 1 failed and 16 have no start: see .*whole\.npy\.txt'
test "$(od -A n -t x1 -N 8 $work/whole.npy)" = ' 93 4e 55 4d 50 59 02 00' ||
    fails "is no array of NumPy"
grep -a -q "('status', '|u1'), ('', '|V7'), ('.u03c6', '<f8')" \
    $work/whole.npy || fails "has other fields"
grep -a -q "'shape': (300,), }" $work/whole.npy || fails "has another shape"
bytes=$(wc -c <$work/whole.npy)
header=$((bytes - 300 * 40))
test $((header % 64)) = 0 || fails "is not aligned"
status_of() { # MEMBER
    od -A n -t u1 -j $((header + $1 * 40)) -N 1 $work/whole.npy | tr -d ' '
}
test "$(status_of 0)$(status_of 15)$(status_of 16)$(status_of 299)" = 3311 ||
    fails "has other statuses"
test "$(od -A n -t f8 -j $((header + 299 * 40 + 8)) -N 16 $work/whole.npy |
    tr -s ' ')" = ' 2 -2' || fails "has other numbers"
grep -q '^15: well is not finite in the initial state$' $work/whole.npy.txt ||
    fails "does not tell why"
exits 1 sweep $scene -o $work/other.npy --width 1 --threads 2
same $work/other.npy
exits 1 sweep $scene -o $work/other.npy --width 8 --threads 1
same $work/other.npy
# A row of CSV has the same digits.
exits 1 sweep $scene --quiet
grep -q '^299,ok,2,-2,,' $work/out || fails "has another last row"

# Parts, joined.
for parts in 1 3 16; do
    part=1
    while test $part -le $parts; do
        "$nevh" sweep $scene -o $work/parts.npy --task $part/$parts 2>/dev/null
        part=$((part + 1))
    done
    exits 1 sweep $scene -o $work/parts.npy --join
    same $work/parts.npy
    rm $work/parts.*
done
exits 2 sweep $scene -o $work/parts.npy --join
says 'nothing to join'
"$nevh" sweep $scene -o $work/parts.npy --task 1/2 2>/dev/null
exits 2 sweep $scene -o $work/parts.npy --join
says 'parts.2-of-2.npy: No such file'
"$nevh" sweep $scene -o $work/parts.npy --task 2/2 --set a=2 2>/dev/null
exits 2 sweep $scene -o $work/parts.npy --join
says 'parts.2-of-2.npy is of another scene, or of other parameters'
test ! -e $work/parts.npy || fails "left a file"
"$nevh" sweep $scene -o $work/parts.npy --task 2/2 --dt 0.02 2>/dev/null
exits 2 sweep $scene -o $work/parts.npy --join
says 'it has "dt: 0.02", this one "dt: 0"'

# What a resumed sweep must be.
cp $work/whole.npy $work/cut.npy
cp $work/whole.npy.txt $work/cut.npy.txt
exits 1 sweep $scene --resume $work/cut.npy
same $work/cut.npy
exits 2 sweep $scene --resume $work/cut.npy --vary 'φ = 1'
says 'another scene, or of other parameters, effects, variations or outcomes'
printf x >>$work/cut.npy
exits 2 sweep $scene --resume $work/cut.npy
says 'it was cut, or added to'
dd if=$work/whole.npy of=$work/cut.npy bs=1000 count=2 2>/dev/null
exits 2 sweep $scene --resume $work/cut.npy
says 'has 2000 bytes instead of'
echo 'this is no array, but a text that is as long as its header would be, and
longer, so that it is not taken for a sweep that was killed at its beginning:
nothing of it must be changed or lost' >$work/cut.npy
cat $work/cut.npy $work/cut.npy >$work/long.npy
cp $work/whole.npy.txt $work/long.npy.txt
cp $work/long.npy $work/kept
exits 2 sweep $scene --resume $work/long.npy
says 'its header is another'
cmp -s $work/long.npy $work/kept || fails "changed a foreign file"
rm $work/cut.npy.txt
exits 2 sweep $scene --resume $work/cut.npy
says 'there is nothing to resume'
exits 2 sweep $scene --resume $work/nowhere.npy
says 'there is nothing to resume'
exits 2 sweep $scene -o $work/no/such/folder.npy
says 'cannot be written'
mkdir $work/folder.npy
exits 2 sweep $scene -o $work/folder.npy
says 'cannot be written'
exits 2 sweep $scene -o $work/x.csv --stop-after 1h
says 'take a FILE\.npy'
# Calls that are shorter than a member would repeat themselves for ever.
for width in '' '--width 1'; do
    exits 1 sweep pendulum --vary 'phi = range(0.5, 2, 4)' --outcomes energy_error \
        --t-end 1e12 --stop-after 0.3s $width -o $work/late.npy
    says 'none of the 4 members that are left ended in the 0.3 s of --stop-after'
    test -n "$width" || says 'or --width 1, which runs one after the other'
    exits 1 sweep pendulum --vary 'phi = range(0.5, 2, 4)' --outcomes energy_error \
        --t-end 1e12 --stop-after 0.3s $width --resume $work/late.npy
    rm $work/late.npy $work/late.npy.txt
done
exits 2 sweep $scene -o $work/x.npy --task 4/3
says 'there are 3'
exits 2 sweep $scene -o $work/x.npy --task 4
says 'written 3/16'
exits 2 sweep $scene -o $work/x.npy --retry
says 'give --resume'
test ! -e $work/x.npy || fails "made a file that was refused"
if command -v flock >/dev/null 2>&1; then
    : >$work/x.npy
    (flock 9 && exits 2 sweep $scene -o $work/x.npy &&
        says 'another sweep is writing it' && exit $status) 9<>$work/x.npy ||
        status=1
fi

# Where nothing can be written, or by two at once.
exits 2 sweep $scene -o /dev/full
says '^nevh: /dev/full cannot be written: No space left on device$'
"$nevh" sweep $scene >/dev/full 2>$work/err
test $? = 2 || fails "does not end with 2 where stdout is full"
says 'the output cannot be written: (No space left|writing stopped before)'
ln -s /dev/full $work/full.npy
exits 2 sweep $scene -o $work/full.npy
says 'is no file on a disk'
mkdir $work/locked
chmod 555 $work/locked
if ! touch $work/locked/x 2>/dev/null; then
    for file in x.csv x.npy; do
        exits 2 sweep $scene -o $work/locked/$file
        says "$file cannot be written: Permission denied"
    done
fi
chmod 755 $work/locked
cp $work/whole.npy $work/cut.npy
cp $work/whole.npy.txt $work/cut.npy.txt
chmod 444 $work/cut.npy
if ! test -w $work/cut.npy; then
    exits 2 sweep $scene --resume $work/cut.npy --retry
    says 'cut.npy: Permission denied'
fi
rm -f $work/cut.npy*
"$nevh" sweep $scene -o $work/twice.npy --width 1 --dt 5e-5 --threads 1 \
    2>$work/first &
first=$!
until test -s $work/twice.npy; do kill -0 $first || break; done
exits 2 sweep $scene -o $work/twice.npy --dt 5e-5
says 'twice.npy: another sweep is writing it'
exits 2 sweep $scene --resume $work/twice.npy --dt 5e-5
says 'twice.npy: another sweep is writing it'
wait $first
test $? = 1 || fails "is disturbed by another sweep"
grep -q 'of 300 members 0 failed and 16 have no start' $work/first ||
    fails "loses members to another sweep"
rm -f $work/twice.npy*

# What was there stays until the new one can be written: the array, its side file, a
# join of parts.
cp $work/whole.npy $work/cut.npy
mkdir $work/cut.npy.txt
exits 2 sweep $scene -o $work/cut.npy --dt 0.02
says 'cut.npy.txt cannot be written'
cmp -s $work/whole.npy $work/cut.npy || fails "emptied what was there"
rmdir $work/cut.npy.txt
ln -s nowhere/side $work/cut.npy.txt
exits 2 sweep $scene -o $work/cut.npy --dt 0.02
cmp -s $work/whole.npy $work/cut.npy || fails "emptied what was there"
rm $work/cut.npy.txt
cp $work/whole.npy.txt $work/cut.npy.txt
(
    ulimit -f 8
    exits 2 sweep $scene -o $work/cut.npy --dt 0.02
    says 'cut.npy cannot be written: File too large'
    exits 2 sweep $scene -o $work/none.npy
    exit $status
) || status=1
same $work/cut.npy
exits 2 sweep $scene -o $work/cut.npy --join
same $work/cut.npy
"$nevh" sweep $scene -o $work/cut.npy --task 1/2 2>/dev/null
exits 2 sweep $scene -o $work/cut.npy --join
says 'cut.2-of-2.npy: No such file'
same $work/cut.npy
mkdir $work/none.npy.txt
exits 2 sweep $scene -o $work/none.npy
rmdir $work/none.npy.txt
test ! -e $work/none.npy || fails "left an empty array"
rm -f $work/cut*
test "$(echo $work/*.??????)" = "$work/*.??????" || fails "left a temporary file"

# A record with any bit turned is not there, and its member is run again.
flip() { # FILE BYTE BIT
    flipped=$(od -A n -t u1 -j $2 -N 1 "$1" | tr -d ' ')
    flipped=$(((flipped / (1 << $3) % 2 ? -1 : 1) * (1 << $3) + flipped))
    printf "\\$(printf %o $flipped)" |
        dd of="$1" bs=1 seek=$2 conv=notrunc 2>/dev/null
}
for at in "0 7" "16 2" "16 3" "16 6" "17 0" "17 5" "18 1" "300 2" "301 4" "307 1" \
    "311 7" "160 1" "165 0" "11999 6" "11961 3"; do
    cp $work/whole.npy $work/cut.npy
    cp $work/whole.npy.txt $work/cut.npy.txt
    flip $work/cut.npy $((header + ${at% *})) ${at#* }
    cmp -s $work/whole.npy $work/cut.npy && fails "was not damaged"
    exits 1 sweep $scene --resume $work/cut.npy
    says '1 records were damaged|of 300 members'
    same $work/cut.npy
done
rm -f $work/cut*

# Killed in a write, or before it; the file is then gone on with.
can_stop || exits_whole
goes_on() {
    exits 1 sweep $scene --resume $work/killed.npy "$@"
    same $work/killed.npy
    rm -f $work/killed.npy*
}
# Before there are records nothing is there to go on with, and nothing is in the way.
must_stop $KILL INTERRUPT_PWRITE=1 sweep $scene -o $work/killed.npy
exits 2 sweep $scene --resume $work/killed.npy
says 'there is nothing to resume'
exits 1 sweep $scene -o $work/killed.npy
same $work/killed.npy
rm -f $work/killed.npy*
for at in 2 3 8 -8 41 42 99 -100 163 204 -205 301 450 516 599 -601; do
    must_stop $KILL INTERRUPT_PWRITE=$at sweep $scene -o $work/killed.npy \
        --threads 2
    goes_on --threads $((1 + (at & 1)))
done
# In the record that goes over the end of a page, of which a part is written.
torn=$(((4096 - header) / 40))
must_stop $KILL INTERRUPT_PWRITE=$((2 * torn + 2)) sweep $scene \
    -o $work/killed.npy --threads 1 --width 1
test "$(od -A n -t u1 -j $((header + torn * 40)) -N 1 $work/killed.npy |
    tr -d ' ')" = 0 || fails "leaves half a record as one that is done"
goes_on
# Killed twice.
must_stop $KILL INTERRUPT_PWRITE=77 sweep $scene -o $work/killed.npy
exits 2 sweep $scene -o $work/killed.npy
says 'is an unfinished sweep: go on with --resume'
must_stop $KILL INTERRUPT_PWRITE=-120 sweep $scene --resume $work/killed.npy
goes_on
# A part is gone on with by its own name.
must_stop $KILL INTERRUPT_PWRITE=50 sweep $scene -o $work/parts.npy --task 2/2
mv $work/parts.2-of-2.npy $work/killed.2-of-2.npy
mv $work/parts.2-of-2.npy.txt $work/killed.2-of-2.npy.txt
exits 2 sweep $scene -o $work/killed.npy --join
"$nevh" sweep $scene -o $work/killed.npy --task 1/2 2>/dev/null
exits 2 sweep $scene -o $work/killed.npy --join
says 'of its 150 members: go on with --resume'
exits 0 sweep $scene --resume $work/killed.2-of-2.npy
exits 1 sweep $scene -o $work/killed.npy --join
same $work/killed.npy
rm -f $work/killed*
# Asked to end, it leaves what is under way.
(
    LD_PRELOAD=$PWD/$work/interrupt.so
    INTERRUPT_SIGNAL=$TERM
    INTERRUPT_PWRITE=100
    ASAN_OPTIONS=$ASAN_OPTIONS:verify_asan_link_order=0
    export LD_PRELOAD INTERRUPT_SIGNAL INTERRUPT_PWRITE ASAN_OPTIONS
    "$nevh" sweep $scene -o $work/killed.npy --threads 1 --width 8 2>$work/err
    test $? = 143
) || fails "does not end with 143"
says 'stopped before [0-9]+ of 300 members: go on with --resume'
goes_on
# A full disk.
(
    LD_PRELOAD=$PWD/$work/interrupt.so
    INTERRUPT_FULL=100
    ASAN_OPTIONS=$ASAN_OPTIONS:verify_asan_link_order=0
    export LD_PRELOAD INTERRUPT_FULL ASAN_OPTIONS
    "$nevh" sweep $scene -o $work/killed.npy 2>$work/err
    test $? = 3
) || fails "does not end with 3"
says 'No space left on device; what is there stays'
goes_on

exit $status

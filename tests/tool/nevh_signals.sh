#!/bin/sh
# Signals end a command soon, and leave no temporary file and no child behind; closed
# files, the order of operands, titles that XML does not take and side files without an
# end harm nothing.

. "${srcdir:-.}/tests/support/nevh_support.sh"
. "$srcdir/tests/support/nevh_interrupt.sh"

XDG_CACHE_HOME=$PWD/$work/cache
TMPDIR=$PWD/$work/tmp
export XDG_CACHE_HOME TMPDIR
mkdir $TMPDIR $work/bin $work/folder

alive() { # FILE: whether the process whose number it has is there
    ps -o stat= -p "$(cat $1)" 2>/dev/null | grep -qv '^Z'
}
dies() {
    for i in 1 2 3 4 5 6 7 8 9 10; do
        alive $1 || return
        sleep 0.5
    done
    fails "leaves its child $1"
}

# gnuplot that takes its time: a picture is open meanwhile.
cat >$work/bin/gnuplot <<'END_OF_GNUPLOT'
#!/bin/sh
test "$1" != --version || exit 0
echo $$ >"$SIGN"
exec sleep 100
END_OF_GNUPLOT
chmod +x $work/bin/gnuplot
for name in TERM HUP XCPU USR1 USR2 ALRM PIPE VTALRM PROF ABRT; do
    SIGN=$PWD/$work/sign
    rm -f $SIGN
    command="run --plot ($name)"
    SIGN=$SIGN PATH=$PWD/$work/bin:$PATH "$nevh" run pendulum --t-end 5 \
        --plot $work/folder/p.png >/dev/null 2>$work/err </dev/null &
    process=$!
    until test -s $SIGN; do sleep 0.05; done
    kill -s $name $process
    wait $process 2>/dev/null
    test $? -gt 128 || fails "goes on after a signal"
    test "$(ls -A $work/folder)" = '' || fails "leaves $(ls -A $work/folder)"
    dies $SIGN
done

# One that never ends, and ignores signals, is ended with what it started: when it took
# too long by a clock that looks move on by 10 s, and when a signal ends the command.
cat >$work/bin/gnuplot <<'END_OF_GNUPLOT'
#!/bin/sh
test "$1" != "$PASSES" || exit 0
trap '' TERM
echo $$ >"$SIGN"
sleep 1000 &
echo $! >"$SIGN.child"
wait
sleep 1000
END_OF_GNUPLOT
for name in clock-version clock TERM; do
    PASSES=--version
    test $name != clock-version || PASSES=
    SIGN=$PWD/$work/sign
    rm -f $SIGN $SIGN.child
    command="run --plot (gnuplot without an end, $name)"
    test $name = TERM || can_stop || { echo "clocks were not tested: $why"; continue; }
    (
        PATH=$PWD/$work/bin:$PATH
        export SIGN PATH PASSES
        test $name = TERM || {
            INTERRUPT_CLOCK=10000
            LD_PRELOAD=$PWD/$work/interrupt.so
            ASAN_OPTIONS=$ASAN_OPTIONS:verify_asan_link_order=0
            export INTERRUPT_CLOCK LD_PRELOAD ASAN_OPTIONS
        }
        exec $limit "$nevh" run pendulum --t-end 5 --native never \
            --plot $work/folder/p.png
    ) >/dev/null 2>$work/err </dev/null &
    process=$!
    test $name != TERM || {
        until test -s $SIGN.child; do sleep 0.05; done
        kill -s TERM $process
    }
    wait $process 2>/dev/null
    code=$?
    if test $name = TERM; then
        test $code = 143 || fails "exit status $code"
    else
        test $code = 2 || fails "exit status $code"
        says 'gnuplot .* 120 s'
    fi
    test "$(ls -A $work/folder)" = '' || fails "leaves $(ls -A $work/folder)"
    for file in $SIGN $SIGN.child; do
        test ! -s $file || dies $file
    done
done

# A compiler at work, too.
cat >$work/compiler <<'END_OF_COMPILER'
#!/bin/sh
echo $$ >"$SIGN"
sleep 100
END_OF_COMPILER
chmod +x $work/compiler
for name in TERM XCPU KILL; do
    SIGN=$PWD/$work/sign
    rm -f $SIGN
    command="run ($name)"
    SIGN=$SIGN CC=$PWD/$work/compiler "$nevh" run pendulum --t-end 1e8 --dt 0.01 \
        --samples 2 >/dev/null 2>&1 </dev/null &
    process=$!
    until test -s $SIGN; do sleep 0.05; done
    kill -s $name $process
    wait $process 2>/dev/null
    dies $SIGN
    for i in 1 2 3 4 5 6; do
        test "$(find $XDG_CACHE_HOME -name '*.so.*' -type d)" != '' || break
        sleep 0.5
    done
    test "$(find $XDG_CACHE_HOME -name '*.so.*' -type d)" = '' ||
        fails "leaves $(find $XDG_CACHE_HOME)"
done

# interrupts SIGNAL STATUS WHEN ARGUMENT...: the signal comes when WHEN succeeds.
interrupts() {
    signal=$1
    expected=$2
    when=$3
    shift 3
    command="$* ($signal)"
    rm -f $work/pid $work/over $work/folder/*
    { until test -s $work/pid && $when || test -e $work/over; do sleep 0.05; done
      kill -s $signal "$(cat $work/pid)"; } 2>/dev/null &
    ${limit:+timeout -s KILL 60} sh -c 'echo $$ >"$0" && exec "$@"' $work/pid "$nevh" "$@" \
        >/dev/null 2>$work/err </dev/null
    code=$?
    touch $work/over
    wait
    test $code = $expected ||
        { fails "exit status $code instead of $expected"; cat $work/err; }
}
leaves() { # FILE...
    test "$(ls -A $work/folder | tr '\n' ' ')" = "$*${1:+ }" ||
        fails "leaves $(ls -A $work/folder)"
}
begun() { test -s $work/folder/x.npy.txt; }
# The last of the records has 24 bytes, the first of which says that it is done.
last_done() { test "$(tail -c 24 $work/folder/x.npy | head -c 1 | tr '\001' y)" = y; }
saved() { test -s $work/folder/x.csv.state; }
opened() { test "$(ls -A $work/folder)" != ''; }
int='INT 130'
sh -c 'kill -s INT $$; sleep 0.1; exit 0' && int='TERM 143' # it is ignored here
sweep="--t-end 1e12 --threads 2 -o $work/folder/x.npy"
outcome='first(phi > 1)'
for signal in "$int" 'TERM 143' 'XCPU 152' 'HUP 129'; do
    interrupts $signal last_done sweep pendulum --vary 'phi = range(0.5, 2, 4)' \
        --outcomes "$outcome" $sweep
    leaves x.npy x.npy.txt
    says 'stopped before 2 of 4 members: go on with --resume .*/x.npy$'
done
cp $work/folder/* $work
# The command has the file; on slow machines a signal was too early for it before.
again() {
    test -d /proc/self/fd || sleep 1
    test ! -d /proc/self/fd ||
        ls -l "/proc/$(cat $work/pid)/fd" 2>/dev/null | grep -q 'x\.npy'
}
interrupts $int again sweep pendulum --vary 'phi = range(0.5, 2, 4)' \
    --outcomes "$outcome" --t-end 1e12 --resume $work/x.npy
says 'stopped before 2 of 4 members'
# Displacements, parameters side by side and apart, one orbit after the other.
for outcome in lyapunov energy_error; do
    for varied in 'phi = range(1, 2, 4)' 'g = range(9, 10, 20)' 'g = range(9, 10, 2)'; do
        interrupts $int begun sweep pendulum --vary "$varied" \
            --outcomes "$outcome" --native never $sweep
        says 'go on with --resume'
    done
done
interrupts $int begun sweep pendulum --vary 'phi = range(1, 2, 4)' \
    --outcomes energy_error --width 1 $sweep
says 'go on with --resume'
# Steps of a million substeps: the second signal does not wait for them.
long='--integrators dop853 --tolerance 1e-12 --dt 1e7'
interrupts $int begun sweep pendulum --vary 'phi = range(1, 2, 4)' \
    --outcomes energy_error $sweep $long
says 'go on with --resume'
twice() { begun && sleep 0.2 && kill -s TERM "$(cat $work/pid)"; }
interrupts HUP 129 twice sweep pendulum --vary 'phi = range(1, 2, 4)' \
    --outcomes energy_error $sweep $long
interrupts $int saved run pendulum --t-end 1e12 $long -o $work/folder/x.csv
says 'to go on: --resume .*/x.csv$'
leaves x.csv x.csv.state
interrupts $int opened sweep pendulum --vary 'phi = range(0.5, 2, 4)' --t-end 1e12 \
    -o $work/folder/x.csv
leaves
rm -f $work/x.npy*

# Operands and options in any order, whatever the environment.
exits 0 run pendulum --t-end 1 --samples 2
cp $work/out $work/before
POSIXLY_CORRECT=1
export POSIXLY_CORRECT
exits 0 run pendulum --t-end 1 --samples 2
cmp -s $work/out $work/before || fails "prints something else"
exits 0 run --t-end 1 pendulum --samples 2
cmp -s $work/out $work/before || fails "prints something else"
exits 0 run --t-end 1 --samples 2 -- pendulum
cmp -s $work/out $work/before || fails "prints something else"
unset POSIXLY_CORRECT

command='run --plot, without standard input'
"$nevh" run pendulum --t-end 5 --plot $work/p.svg <&- >/dev/null 2>$work/err ||
    fails "fails: $(cat $work/err)"
grep -q '</svg>' $work/p.svg || fails "draws nothing"
printf '[scene]\ntitle = a ]]> b ]]]>\n[coordinates]\nx = 1\n[effects]\n' \
    >$work/odd.nevh
printf 'T = p_x^2/2\nV = x^2/2\n[run]\nt_end = 5\ndt = 0.1\n' >>$work/odd.nevh
printf 'integrators = verlet\n' >>$work/odd.nevh
exits 0 run $work/odd.nevh --plot $work/odd.svg
grep -q 'a ]]&gt; b ]]]&gt;' $work/odd.svg || fails "lacks its title"
grep '<text' $work/odd.svg | grep -q ']]>' && fails "is no XML"

# Side files that never end, and sweeps of which next to nothing is there.
exits 0 run pendulum --t-end 5 --samples 3 -o $work/rows.csv
ln -s /dev/zero $work/rows.csv.state
exits 2 run pendulum --t-end 5 --samples 3 --resume $work/rows.csv
rm $work/rows.csv.state
mkfifo $work/rows.csv.state
exits 2 run pendulum --t-end 5 --samples 3 --resume $work/rows.csv
exits 3 sweep pendulum --vary 'phi = range(0.1, 3, 100000000)' --t-end 1 \
    --outcomes energy_error -o $work/x.npy --stop-after 1s
says 'stopped before [0-9]+ of 100000000 members'
rm $work/x.npy.txt
ln -s /dev/zero $work/x.npy.txt
exits 2 sweep pendulum --vary 'phi = range(0.1, 3, 100000000)' --t-end 1 \
    --outcomes energy_error --resume $work/x.npy --stop-after 0.2s
exit $status

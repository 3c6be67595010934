#!/bin/sh
# nevh run: rows and their times, ends, and what interruptions leave.

. "${srcdir:-.}/tests/support/nevh_support.sh"
. "$srcdir/tests/support/nevh_interrupt.sh"

# rows OF: what a file has without remarks and header.
rows() {
    grep -v '^#' "$1" | sed 1d
}
# columns N: that each row of the output has as many.
columns() {
    grep -v '^#' $work/out | awk -F, -v n="$1" 'NF != n { exit 1 }' ||
        fails "has other columns"
}
# at_times T...: those of the rows of the output.
at_times() {
    test "$(rows $work/out | cut -d, -f1 | tr '\n' ' ')" = "$* " ||
        { fails "has other times than $*"; cat $work/out; }
}
last() {
    tail -n 1 "$1"
}

# Usage.
exits 2 run pendulum --every 2 --samples 3
says 'only one of them'
exits 2 run pendulum --samples 1
exits 2 run pendulum --every 0
exits 2 run pendulum --every 1.5
exits 2 run pendulum --t-end 5 --at 1,6
says 'at 6: the run is from t = 0 to 5'
exits 2 run pendulum --at 1,-0.5
exits 2 run pendulum --at
exits 2 run pendulum --integrators gauss4+transform
exits 2 run double-pendulum --integrators verlet
says 'mixes|H = T'
exits 2 run pendulum -o $work/nowhere/out.csv
says 'cannot be written'
exits 2 run pendulum --resume $work/never.csv
says 'nothing to resume: .*never.csv.state'
exits 2 run pendulum --resume $work/never.csv -o $work/out.csv
exits 2 run pendulum --resume $work/never.csv --format json
test -e $work/never.csv && fails "made a file that was not there"
exits 0 run --help
has 'resume FILE'

# Columns and rows: by steps, at equal times, at given times.
exits 0 run pendulum --t-end 0.5
has '^t,phi,p_phi,x,y,energy$'
has '^0,2,0,0\.909297426825681'
has '^# integrator: verlet, dt = 0\.1 .*first that fits'
has '^# effects on: kinetic, gravity'
has '^# rows: after every step'
columns 6
test "$(rows $work/out | wc -l)" -eq 6 || fails "has other than 6 rows"
exits 0 run pendulum --t-end 1 --dt 0.125 --every 3
at_times 0 0.375 0.75 1
exits 0 run pendulum --t-end 1 --dt 0.125 --samples 3
at_times 0 0.5 1
exits 0 run pendulum --t-end 1 --dt 0.375 --at 0.625,0.25,0.25,0.375
at_times 0.25 0.375 0.625
exits 0 run pendulum --t-end 1 --dt 0.75 --every 1
at_times 0 0.75 1
exits 0 run pendulum --t-end 0.1 --dt 0.05 --every 1
at_times 0 0.05 0.1
exits 0 run pendulum --t-end 100
test "$(rows $work/out | wc -l)" -eq 1001 || fails "has other than 1001 rows"
exits 0 run pendulum --t-end 200
has '^# rows: 1001 at equal times; see --every'
test "$(rows $work/out | wc -l)" -eq 1001 || fails "has other than 1001 rows"
exits 0 run figure-eight --t-end 0.05
has '^t,x\[1\],x\[2\],x\[3\],y\[1\],.*,p_x\[1\],.*,p_y\[3\],energy$'
columns 14
exits 0 run pendulum --t-end 1 --set l=2 --without gravity
has '^# set: l=2'
has 'off: gravity'
exits 0 run pendulum --t-end 1 --samples 3 --format table
has '^ +t +phi +p_phi +x +y +energy$'
has '^ *0\.5 +0\.[0-9]{7,10} '
exits 0 run pendulum --t-end 1 --samples 3 --format json
has '^    \{"t": 0\.5, "phi": '
if command -v python3 >/dev/null 2>&1; then
    python3 -m json.tool $work/out >/dev/null || fails "is no JSON"
fi

# Rows between steps leave the orbit alone; schemes that remember, friction,
# and steps of their own length.
sed -e 's/^dt .*/dt = 2*pi\/50\ntransform = (x^2 + y^2)^(3\/4)/' \
    -e 's/^x = .*/x = 1 + e/; s/^p_y = .*/p_y = sqrt((1 - e)\/(1 + e))/' \
    "$srcdir/scenes/kepler-0.9.nevh" >$work/comet.nevh
for run in 'double-pendulum --integrators gauss4 --dt 0.02' \
    'damped-driven-pendulum --integrators verlet --dt 0.01' \
    'pendulum --integrators rkn14a --gradient exact' \
    "$work/comet.nevh --integrators gauss8+transform" \
    "$work/comet.nevh --integrators adaptive-verlet"; do
    exits 0 run $run --t-end 7.123 --every 50
    rows $work/out >$work/steps
    exits 0 run $run --t-end 7.123 --samples 123
    rows $work/out >$work/samples
    cmp -s $work/samples $work/steps && fails "has rows of steps"
    test "$(last $work/samples)" = "$(last $work/steps)" ||
        { fails "ends elsewhere"; tail -n 1 $work/samples $work/steps; }
    at=$(sed 1d $work/steps | cut -d, -f1 | tr '\n' ,)
    exits 0 run $run --t-end 7.123 --at "0.01,${at}2.5,3.3333"
    rows $work/out | grep -Fxf - $work/steps | sed 1d >$work/same
    sed '1,2d' $work/steps | cmp - $work/same >$work/cmp ||
        { fails "depends on its rows"; cat $work/cmp; }
done

# The orbit is that of compare, also where the step is stretched to end on time:
# errors of the energy agree.
for end in 5.000000002 7.123; do
    exits 0 run pendulum --t-end $end --integrators verlet --every 1
    rows $work/out | awk -F, 'NR == 1 { first = $6 }
        END { printf "%.17g\n", ($6 - first)/first }' >$work/errors
    exits 0 compare pendulum --t-end $end --integrators verlet --dt 0.1 \
        --format csv
    awk -F, '$2 == "verlet" { print $11 }' $work/out >>$work/errors
    awk '{ e[NR] = $1 } END { exit !(NR == 2 && e[1] != 0 &&
        (e[1]/e[2] - 1)^2 < 1e-24) }' $work/errors ||
        { fails "ends with another energy"; cat $work/errors; }
done

# A transform: named by an integrator, or for all that it fits.
exits 0 run kepler --integrators gauss4 --t-end 1 --transform '1 + x^2'
has '^# integrator: gauss4\+transform, '
exits 0 section henon-heiles --integrators gauss4,gauss4+transform --t-end 10 --transform 2
has '^# integrator: gauss4, '
exits 0 run kepler --integrators dopri5 --tolerance 1e-3 --t-end 1
cp $work/out $work/loose
exits 0 run kepler --integrators dopri5 --tolerance 1e-9 --t-end 1
cmp -s $work/out $work/loose && fails "ignores --tolerance"

# What a scene wants to stop at.
sed 's/^t_end .*/&\nstop = cos(phi) > 1 - 1e-3/' "$srcdir/scenes/pendulum.nevh" \
    >$work/stop.nevh
exits 0 run $work/stop.nevh --every 3
test "$(last $work/out)" = "# stopped at t = 2: cos(phi) > 1 - 1e-3" ||
    { fails "stops elsewhere"; tail -n 3 $work/out; }
tail -n 2 $work/out | grep -q '^2,0' || fails "does not show where it stops"

# A failure in the middle: whole lines, a message, nothing to resume.
cat >$work/fails.nevh <<'END'
[coordinates]
x = 1, -10
[effects]
kinetic = p_x^2/2
wall = -sqrt(x)
[run]
t_end = 1
dt = 0.01
integrators = rk4
END
exits 1 run $work/fails.nevh -o $work/failed.csv
says 'rk4 failed after t = 0\.1:'
grep -q '^# failed after t = 0\.1:' $work/failed.csv || fails "hides a failure"
test "$(rows $work/failed.csv | grep -c '^0.*,.*,.*,.')" -ge 10 ||
    fails "lost rows"
test "$(echo $work/failed.csv*)" = $work/failed.csv || fails "left other files"

# Nothing depends on the locale; a finished run leaves its file alone.
exits 0 run pendulum --t-end 1 -o $work/plain.csv
for locale in $(locale -a 2>/dev/null | grep -i '^de_DE.utf'); do
    LC_ALL=$locale "$nevh" run pendulum --t-end 1 -o $work/other.csv
    cmp -s $work/plain.csv $work/other.csv || fails "depends on the locale"
done
test "$(echo $work/plain.csv*)" = $work/plain.csv || fails "left other files"
exits 2 run pendulum --t-end 1 --resume $work/plain.csv
says 'nothing to resume'

# No space: whole lines, and a message.
if test -c /dev/full; then
    exits 2 run pendulum -o /dev/full
    says 'cannot be written'
fi
(
    ulimit -f 40 # of 512 or 1024 bytes
    "$nevh" run pendulum --every 1 -o $work/full.csv 2>$work/err
    test $? -eq 2 || exit 1
) || fails "does not mind a full disk"
says 'full.csv cannot be written'
test -s $work/full.csv || fails "wrote nothing"
exits 0 run pendulum --every 1 -o $work/whole.csv
# part FILE OF: whether a file is the beginning of another, in whole lines.
part() {
    count=$(wc -c <"$1")
    test "$(tail -c 1 "$1" | od -An -c | tr -d ' ')" = '\n' &&
        head -c "$count" "$2" | cmp -s - "$1"
}
part $work/full.csv $work/whole.csv || fails "left a broken line"
exits 0 run pendulum --every 1 --resume $work/full.csv
cmp -s $work/full.csv $work/whole.csv || fails "does not go on as it was"

can_stop || exits_whole
seed=1
random() { # random N: $number from 1 to N
    seed=$(((seed * 1103515245 + 12345) % 2147483648))
    number=$((seed / 65536 % $1 + 1))
}

# Interruptions anywhere: the same file in the end.  Schemes that remember the
# last step, times between steps, friction, and steps of their own length.
# again NAME STEPS ARGUMENT...: STEPS is no more than the run takes.
again() {
    name=$1
    steps=$2
    shift 2
    exits 0 run "$@" -o $work/$name.whole
    random $((steps / 9))
    must_stop $TERM INTERRUPT_STEP=$number run "$@" -o $work/$name
    for i in 1 2 3 4 5 6 7; do
        part $work/$name $work/$name.whole || fails "left a broken line"
        test -e $work/$name.state || fails "left no state"
        random $((steps / 9))
        must_stop $TERM INTERRUPT_STEP=$number \
            run "$@" --resume $work/$name
        says 'interrupted; to go on: --resume '
    done
    exits 0 run "$@" --resume $work/$name
    cmp $work/$name $work/$name.whole >$work/cmp ||
        { fails "is another run when interrupted"; cat $work/cmp; }
    test -e $work/$name.state && fails "left its state"
}
again a 40000 double-pendulum --dt 0.001 --every 100 --t-end 40
again b 200000 damped-driven-pendulum --dt 0.0003 --samples 300 --t-end 60
again c 5000 $work/comet.nevh --integrators gauss8+transform --t-end 700 \
    --samples 200
again e 10000 pendulum --every 1
again d 1000 figure-eight --integrators gauss8 --t-end 50 \
    --at 1,2.5,20.1,33,49.999

# A signal that comes at the last state: the run is whole.
for dt in 0.5 0.3; do
    exits 0 run pendulum --dt $dt --t-end 10 -o $work/last.whole
    count=$(rows $work/last.whole | wc -l)
    stop $TERM INTERRUPT_STEP=$count run pendulum --dt $dt --t-end 10 \
        -o $work/last.csv && fails "is interrupted when it is done"
    cmp $work/last.csv $work/last.whole || fails "is not whole at its end"
    test -e $work/last.csv.state && fails "left its state"
done

# Ends that ask nobody, before a write and in it.  Linux may cut a line that goes
# over the end of a page there.
cut() {
    count=$(wc -c <"$1")
    test $((count % 4096)) -eq 0 && head -c "$count" "$2" | cmp -s - "$1"
}
run='pendulum --every 1'
for write in 1 -1 2 -2 3 -3 4 -4 5 -5 8 -9 20 -21 30 -31 40 -41 50 -51; do
    rm -f $work/killed.csv*
    must_stop $KILL INTERRUPT_WRITE=$write run $run -o $work/killed.csv
    part $work/killed.csv $work/whole.csv ||
        cut $work/killed.csv $work/whole.csv || test ! -s $work/killed.csv ||
        fails "left a broken line when killed"
    test -e $work/killed.csv.state || case $write in
    1 | -1 | 2 | -2) continue ;; # the first one was not yet there
    *) fails "left no state" ;;
    esac
    exits 0 run $run --resume $work/killed.csv
    cmp -s $work/killed.csv $work/whole.csv || fails "does not go on"
done

# What is saved along the way, by a clock that looks move on.
run='double-pendulum --dt 0.001 --every 100 --t-end 40'
INTERRUPT_CLOCK=
export INTERRUPT_CLOCK
must_stop $KILL INTERRUPT_STEP=35000 run $run -o $work/long.csv
unset INTERRUPT_CLOCK
test $(rows $work/long.csv | wc -l) -gt 340 || fails "saved nothing on its way"
exits 0 run $run --resume $work/long.csv
cmp -s $work/long.csv $work/a.whole || fails "goes on in another way"

# States that are not those of the run are refused, and nothing is touched.
run='double-pendulum --dt 0.001 --every 100 --t-end 40'
must_stop $TERM INTERRUPT_STEP=5000 run $run -o $work/x.csv
says 'interrupted; to go on: --resume .*x.csv'
cp $work/x.csv $work/x.kept
cp $work/x.csv.state $work/x.state
untouched() {
    cmp -s $work/x.csv $work/x.kept || fails "touched a file that it refused"
}
exits 2 run $run --set m=2 --resume $work/x.csv
says 'another scene, or to other parameters'
exits 2 run $run --without gravity --resume $work/x.csv
exits 2 run $run --dt 0.002 --resume $work/x.csv
says 'a run with dt = 0\.001.*, not dt = 0\.002'
exits 2 run $run --integrators gauss6 --resume $work/x.csv
says 'with integrator = midpoint, not integrator = gauss6'
exits 2 run $run --gradient exact --resume $work/x.csv
exits 2 run $run --every 50 --resume $work/x.csv
exits 2 run $run --t-end 41 --resume $work/x.csv
exits 2 run $run --transform '1 + phi1^2' --resume $work/x.csv
says 'another scene|with transform'
exits 2 run pendulum --resume $work/x.csv
untouched

# Functions have the same digits by native code, and by C terms taken by value.
exits 0 run pendulum --t-end 40 --portable --native never
grep -v '^#' $work/out >$work/other
exits 0 run pendulum --t-end 40 --native always
grep -v '^#' $work/out | cmp - $work/other ||
    fails "differs between --portable and native steps"
sed 's/0/1/2' $work/x.kept >$work/x.csv
exits 2 run $run --resume $work/x.csv
says 'not as the interrupted run left it'
head -c 100 $work/x.kept >$work/x.csv
exits 2 run $run --resume $work/x.csv
cp $work/x.kept $work/x.csv

size=$(wc -c <$work/x.state)
i=0
while test $i -lt 200; do
    i=$((i + 1))
    random 32768
    at=$(((number * 37 + i) % size))
    if test $((i % 2)) -eq 0; then
        head -c $at $work/x.state >$work/x.csv.state
    else
        cp $work/x.state $work/x.csv.state
        old=$(od -An -tu1 -j $at -N 1 $work/x.state | tr -d ' ')
        random 246
        new=$(((old + number) % 256))
        printf "\\$(printf %03o $new)" |
            dd of=$work/x.csv.state bs=1 seek=$at conv=notrunc 2>/dev/null
    fi
    "$nevh" run $run --resume $work/x.csv >/dev/null 2>$work/err
    test $? -eq 2 || fails "takes a damaged state (change $i at $at)"
done
says 'damaged'
untouched

# Whole states that no run leaves: numbers that rows and steps are looked up
# with.  forged MESSAGE NAME=VALUE...
forged() {
    message=$1
    shift
    cp $work/x.state $work/x.csv.state
    "${FORGE:-./tests/support/forge}" $work/x.csv.state "$@" ||
        { echo "cannot forge $*"; status=1; }
    exits 2 run $run --resume $work/x.csv
    says "$message"
    untouched
}
never='where this run never is'
forged "row 18446744073709551615 at .*$never" row=18446744073709551615
forged "step 40001 .*$never" step=40001 row=40001 t=40.001
forged "$never" step=18446744073709551615
forged "t = 1e\+300, $never" t=1e300
forged "$never" t=nan
forged "$never" t=-1
forged "$never" step=1000 t=1 row=999
forged "$never" step=1000 t=1 row=1101
forged 'not as the interrupted run left it' bytes=18446744073709551615
forged 'not as the interrupted run left it' step=1000 t=1 row=1100 bytes=9999999
cp $work/x.state $work/x.csv.state
exits 0 run $run --resume $work/x.csv
cmp -s $work/x.csv $work/a.whole || fails "does not go on"

# The same where the times of rows are kept in an array, and where steps have
# their own time.
for run in "pendulum --integrators gauss8 --dt 0.001 --t-end 100 --at 0.5,1,99" \
    "$work/comet.nevh --integrators gauss8+transform --t-end 20000 --at 0.5,1,9999"; do
    must_stop $TERM INTERRUPT_STEP=3000 run $run -o $work/x.csv
    cp $work/x.csv $work/x.kept
    cp $work/x.csv.state $work/x.state
    forged "row 3 .*$never" step=2000 t=2 row=3
    forged "row 10000000000 .*$never" step=2000 t=2 row=10000000000
    forged "row 1 .*$never" step=2000 t=2 row=1
    forged "t = -1, $never" t=-1
    forged "t = 20001, $never" t=20001
    cp $work/x.state $work/x.csv.state
    exits 0 run $run --resume $work/x.csv
done

# Where the state outgrows the steps of differences, the run ends before digits are
# lost; steps that are too long for the orbit are another thing.
printf '[coordinates]\nx = 1\n[effects]\nH = p_x^2/2 - x^2/2\n[run]\nt_end = 40\n%s' \
    'dt = 0.1' >$work/growth.nevh
# right LEAST MOST: x of all rows is cosh t; how many there are.
right() {
    rows $work/out | awk -F, -v least=$1 -v most=$2 '
        function abs(x) { return x < 0 ? -x : x }
        { x = (exp($1) + exp(-$1)) / 2 }
        abs($2 - x) > 1e-6 * x { exit 1 }
        END { exit NR < least || NR > most }' ||
        { fails "has wrong digits, or $1 to $2 rows"; tail -2 $work/out; }
}
growth="$work/growth.nevh --integrators gauss8"
for gradient in central2 central4 central6; do
    exits 1 run $growth --gradient $gradient
    says 'rounding is more than 1e-6 of the gradient'
    right 150 260
done
exits 1 run $growth --samples 41
right 20 26
exits 0 run $growth --gradient exact
right 401 401
sed 's/- x/+ x/; s/0\.1/2.5/' $work/growth.nevh >$work/unstable.nevh
exits 0 run $work/unstable.nevh --integrators verlet
says 'too long for verlet'

# A compiler that was started in the background holds no file of a run that ends.
printf '#!/bin/sh\nsleep 9\n' >$work/slow-cc
chmod +x $work/slow-cc
XDG_CACHE_HOME=$work/empty CC=$work/slow-cc
export XDG_CACHE_HOME CC
run='pendulum --integrators gauss8 --dt 0.001 --t-end 100'
must_stop $KILL INTERRUPT_STEP=60000 run $run -o $work/x.csv
exits 0 run $run --resume $work/x.csv
exit $status

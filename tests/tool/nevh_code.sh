#!/bin/sh
# Effects that are C code: refused unless allowed, compiled, quoted where they
# do not compile, and cleaned up.

. "${srcdir:-.}/tests/support/nevh_support.sh"
. "$srcdir/tests/support/nevh_interrupt.sh"

mkdir $work/tmp "$work/a b"
TMPDIR=$PWD/$work/tmp
export TMPDIR
clean() {
    test -z "$(ls -A $work/tmp)" || { fails "leaves $(ls $work/tmp)"; }
}
table() {
    grep -v '^#' $work/out |
        awk -F, '{ print $2, $6, $7, $8, sprintf("%.3e", $9), $18 }'
}

# scene FILE EFFECT: a pendulum whose gravity is that.
scene() {
    cat >"$1" <<END
[scene]
effects = kinetic, gravity
[parameters]
m = 1
l[1..2] = 1, 7
g = 9.8
[coordinates]
phi = 2
v_phi = 0.5
[effects]
kinetic = p_phi^2/(2*m*l[1]^2)
gravity = $2
[run]
t_end = 20
dt = 0.05
integrators = verlet, gauss4
END
}
scene $work/text.nevh '-m*g*l[1]*cos(phi)'
scene $work/code.nevh 'file("term.c", phi, m, l, g)'
scene $work/off.nevh 'file("term.c", phi, m, l, g)'
sed -i.old 's/^effects = .*/effects = kinetic/' $work/off.nevh

# Not allowed; not even looked for.
exits 2 compare $work/code.nevh
says 'code.nevh:12:17: error: term\.c is code.*--allow-code$'
says '^                \^~~~~~$'
exits 0 compare $work/off.nevh
exits 2 compare $work/off.nevh --with gravity
says 'off.nevh:12:17: error: .*--allow-code'
exits 0 compare $work/code.nevh --without gravity
exits 0 compare $work/code.nevh --with gravity --without gravity
exits 2 compare $work/code.nevh --without gravity --with gravity
says 'code.nevh:12:17: error: .*--allow-code'
exits 2 compare $work/code.nevh --without graviti
says 'did you mean gravity'
exits 2 compare $work/code.nevh --allow-code
says 'code.nevh:12:17: error: .*term\.c cannot be read'
exits 0 compare $work/off.nevh --allow-code

cat >$work/term.c <<END
#include <math.h>
double value(double t, const double q[], const double p[], const double c[]);
double value(double t, const double q[], const double p[], const double c[])
{
    return t != 0 ? NAN : -c[0]*c[3]*c[1]*cos(q[0]);
}
END
CC=/nowhere/cc exits 2 compare $work/code.nevh --allow-code
says 'code.nevh:12:17: error: term\.c needs a C compiler, and there is none'
clean
command -v ${CC:-cc} >/dev/null 2>&1 || {
    echo "no C compiler"
    test $status = 0 || exit $status
    exit 77
}

# The same rows as of text; parameters follow.
for set in g=9.8 g=1.62 l=0.5; do
    exits 0 compare $work/text.nevh --set $set --format csv
    table >$work/rows
    exits 0 compare $work/code.nevh --set $set --format csv --allow-code
    table >$work/other
    clean
    cmp -s $work/rows $work/other ||
        { fails "has other rows"; diff $work/rows $work/other; }
done
exits 0 compare $work/off.nevh --with gravity --format csv --allow-code
has ',verlet,.*,ok,'
exits 0 effects $work/off.nevh --allow-code
has '^ gravity +off +coordinates +1 '
exits 0 effects $work/off.nevh --impact
has 'gravity cannot be switched on'
exits 0 effects $work/off.nevh --impact --allow-code
has '^ gravity +off +verlet +[0-9]'
clean

# A copy in another folder finds the same code; one beside it keeps the name.
mkdir $work/copies
exits 0 new $work/copies/copy.nevh --from $work/code.nevh --allow-code
exits 0 compare $work/copies/copy.nevh --allow-code
exits 0 new $work/beside.nevh --from $work/code.nevh --allow-code
grep -q '^gravity = file("term.c", phi, m, l, g)$' $work/beside.nevh ||
    fails "changes a name that is right"
exits 0 new $work/copies/off.nevh --from $work/off.nevh --set g=2
exits 0 compare $work/copies/off.nevh --with gravity --allow-code

# Neither another text of the code nor another transform is the same run.
can_stop && stops=yes || stops=no
if test $stops = yes; then
    must_stop $TERM INTERRUPT_STEP=1000 run $work/code.nevh --allow-code \
        --t-end 1e3 --every 1000 -o $work/x.csv
    cp $work/term.c $work/term.kept
    echo '/* */' >>$work/term.c
    exits 2 run $work/code.nevh --allow-code --t-end 1e3 --every 1000 \
        --resume $work/x.csv
    says 'or code'
    mv $work/term.kept $work/term.c
    exits 0 run $work/code.nevh --allow-code --t-end 1e3 --every 1000 \
        --resume $work/x.csv
fi

# A signal while the compiler runs: it ends with nevh, and leaves nothing; also
# where the compiler does not mind.
cat >$work/compiler <<'END'
#!/bin/sh
test -z "$DEAF" || trap '' TERM HUP
exec 9>"$HELD"
touch "$TMPDIR/temporary" "$SIGN"
while :; do
    sleep 1
done
END
chmod +x $work/compiler
SIGN=$PWD/$work/compiling
HELD=$PWD/$work/held # whose reader ends when no compiler does any more
export SIGN HELD
mkfifo $HELD
signals='TERM HUP DEAF'
sh -c 'kill -HUP $$' && signals='TERM DEAF' # who started this ignores HUP
for signal in $signals; do
    command="compare code.nevh ($signal)"
    rm -f $SIGN
    $limit cat $HELD &
    reader=$!
    DEAF=
    test $signal = DEAF && signal=TERM DEAF=yes
    DEAF=$DEAF CC=$PWD/$work/compiler "$nevh" compare $work/code.nevh \
        --allow-code >$work/out 2>$work/err </dev/null &
    compiling=$!
    until test -e $SIGN; do
        kill -0 $compiling 2>/dev/null || { fails "does not compile"; break; }
        sleep 1
    done
    kill -s $signal $compiling
    wait $compiling 2>/dev/null
    test $? -gt 128 || fails "goes on after a signal"
    clean
    wait $reader || fails "leaves its compiler"
done

# One element of an array; velocities by differences of code.
scene $work/element.nevh 'file("term.c", phi, m, l[2], l[1], g)'
sed -i.old -e 's/c\[3\]\*c\[1\]/c[3]*c[2]\/7*c[1]/' $work/term.c
sed -i.old -e 's/^kinetic = .*/kinetic = file("kinetic.c", p_phi)/' \
    $work/element.nevh
cat >$work/kinetic.c <<END
double value(double t, const double q[], const double p[], const double c[])
{
    return p[0]*p[0]/2;
}
END
exits 0 compare $work/text.nevh --format csv
table >$work/rows
exits 0 compare $work/element.nevh --format csv --allow-code
table >$work/other
cmp -s $work/rows $work/other ||
    { fails "has other rows"; diff $work/rows $work/other; }
mv $work/term.c.old $work/term.c
clean

# Derivatives of its own.
exits 0 compare $work/code.nevh --allow-code --gradient exact --format csv
has 'refused: .*gravity'
cat >>$work/term.c <<END
void gradient(double t, const double q[], const double p[], const double c[],
              double dh_dq[], double dh_dp[])
{
    dh_dq[0] = c[0]*c[3]*c[1]*sin(q[0]);
}
END
exits 0 compare $work/code.nevh --allow-code --gradient exact --format csv
lacks 'refused'
exits 0 compare $work/off.nevh --with gravity --allow-code --gradient exact \
    --format csv
lacks 'refused'
sed 's/dh_dq\[0\] = /&1.001*/' $work/term.c >$work/wrong.c
scene $work/wrong.nevh 'file("wrong.c", phi, m, l, g)'
exits 0 compare $work/wrong.nevh --allow-code --gradient exact --format csv
has 'refused: .*gravity'

# Everything, probed; the time where it is listed; other folders and names.
cat >"$work/a b/it's.c" <<END
double value(double t, const double q[], const double p[], const double c[])
{
    return (p[0]*p[0] + q[0]*q[0])/2 + t*q[0];
}
END
scene "$work/a b/all.nevh" 'file("it'"'"'s.c")'
exits 0 check "$work/a b/all.nevh" --allow-code
has 'according to its values'
has 'autonomous +yes'
scene "$work/a b/timed.nevh" 'file("it'"'"'s.c", t, phi, p_phi)'
exits 0 check "$work/a b/timed.nevh" --allow-code
has 'autonomous +no'
clean

# A compiler's errors, and code without a function.
sed 's/return/retrun/' $work/term.c >$work/wrong.c
exits 2 compare $work/wrong.nevh --allow-code -o $work/never
says 'wrong.nevh:12:17: error: wrong\.c does not compile:$'
says 'retrun'
echo 'int none;' >$work/wrong.c
exits 2 compare $work/wrong.nevh --allow-code
says 'wrong\.c defines no function double value\(double t, const double q'
sed 's/cos(/nocosine(/' $work/term.c >$work/wrong.c
exits 2 compare $work/wrong.nevh --allow-code
says 'wrong.nevh:12:17: error: wrong\.c (cannot be loaded|does not compile):$'
says 'nocosine'
clean
test -e $work/never && fails "wrote a file in spite of an error"

# What it reads.
for wrong in '"term.c", psi' '"term.c", phi, phi' '"term.c" phi' '"term.c' \
    'term.c' '""' '"term.c", l[3]' '"term.c", l[1..2]' '"term.c", m[1]' \
    '"term.c", v_phi' '"term.c",'; do
    scene $work/list.nevh "file($wrong)"
    exits 2 compare $work/list.nevh --allow-code
    says 'list.nevh:12:[0-9]+: error: '
done
clean
test $stops = yes || exits_whole
exit $status

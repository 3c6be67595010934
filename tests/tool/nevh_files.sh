#!/bin/sh
# Files that the command writes: never those it reads, with the mode they had,
# and all or nothing.

. "${srcdir:-.}/tests/support/nevh_support.sh"

scene() {
    cat >$work/my.nevh <<'END'
[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
spring = x^2/2
[run]
t_end = 2
dt = 0.1
integrators = verlet
END
}
scene
cp $work/my.nevh $work/kept
mkdir $work/folder
ln -s ../my.nevh $work/folder/link
ln $work/my.nevh $work/hard
untouched() {
    cmp -s $work/my.nevh $work/kept || { fails "changed the scene"; scene; }
}

# The scene, by whatever name.
for name in $work/my.nevh ./$work/my.nevh $PWD/$work/folder/../my.nevh \
    $work/folder/link $work/hard; do
    for run in 'compare' 'run' 'cost' 'check' 'effects' 'gradients' \
        'recommend --energy-error 1e-2'; do
        exits 2 ${run%% *} $work/my.nevh ${run#"${run%% *}"} -o $name
        says 'would be written over the scene itself; nothing was changed$'
        untouched
    done
    exits 2 compare $work/my.nevh --keep-plot-script $name
    says '^nevh: --keep-plot-script .* over the scene itself'
    untouched
done
cp $work/my.nevh $work/my.svg
exits 2 compare $work/my.svg --plot $work/my.svg
says '^nevh: --plot .* over the scene itself'
cmp -s $work/my.svg $work/kept || fails "changed the scene"
exits 2 run $work/my.nevh --resume $work/my.nevh
untouched
# A copy is another file.
cp $work/my.nevh $work/copy
exits 0 compare $work/my.nevh -o $work/copy
cmp -s $work/copy $work/kept && fails "wrote nothing"

# Its C code, also of effects that are off.
echo 'code = file("my.c", x)' >$work/line
sed -e "/^spring/r $work/line" -e '1i [scene]\neffects = kinetic, spring' \
    $work/kept >$work/code.nevh
echo 'double value(double t, const double q[], const double p[],' \
    'const double c[]) { return 0*q[0]; }' >$work/my.c
cp $work/my.c $work/my.c.kept
exits 2 compare $work/code.nevh -o $work/folder/../my.c
says "over the scene's own C code"
cmp -s $work/my.c $work/my.c.kept || fails "changed the code"

# Two outputs, whether they are there or not.
for names in 'a.svg ./a.svg' 'a.svg folder/../a.svg'; do
    for there in no yes; do
        rm -f $work/a.svg
        test $there = no || : >$work/a.svg
        exits 2 compare $work/my.nevh --plot $work/${names% *} \
            -o $work/${names#* }
        says 'two outputs would have the same name'
    done
done

# Measured points, the picture of a sweep, and what is written beside a file.
printf 't,x\n0,0.1\n1,0.2\n2,0.1\n' >$work/points.csv
cp $work/points.csv $work/points.kept
for run in 'fit --vary k --sigma 0.1' 'run'; do
    exits 2 ${run%% *} $work/my.nevh ${run#"${run%% *}"} \
        --data $work/points.csv -o $work/folder/../points.csv
    says 'over the measured points of --data; nothing was changed$'
    cmp -s $work/points.csv $work/points.kept || fails "changed the points"
done
cp $work/kept $work/my.npy.txt
cp $work/kept $work/my.csv.state
exits 2 sweep $work/my.svg --vary k=1,2 --outcomes energy_error \
    --picture $work/my.svg
says '^nevh: --picture .* over the scene itself'
exits 2 sweep $work/my.npy.txt --vary k=1,2 -o $work/my.npy
says 'my.npy.txt would be written over the scene itself'
exits 2 run $work/my.csv.state -o $work/my.csv
says 'my.csv.state would be written over the scene itself'
exits 2 sweep $work/my.nevh --vary k=1,2 -o $work/a.npy \
    --outcomes energy_error --picture $work/a.svg \
    --keep-plot-script $work/a.npy.txt
says 'two outputs would have the same name'
for name in my.svg my.npy.txt my.csv.state; do
    cmp -s $work/$name $work/kept || fails "changed the scene $name"
done

# Points that are found beside the scenes, by any name of theirs; and the scenes, which
# a list of them reads.
mkdir $work/scenes
cp $work/points.kept $work/scenes/beside.csv
cp $work/kept $work/scenes/mine.nevh
ln -s scenes/beside.csv $work/soft.csv
ln $work/scenes/beside.csv $work/hard.csv
for name in $work/scenes/beside.csv ./$work/folder/../scenes/beside.csv \
    $PWD/$work/scenes//beside.csv $work/soft.csv $work/hard.csv; do
    for run in 'fit --vary k --sigma 0.1' 'run' 'run --plot-kind time'; do
        (
            NEVH_SCENES=$work/scenes
            exits 2 ${run%% *} $work/my.nevh ${run#"${run%% *}"} --data beside.csv \
                -o $name
            says 'over the measured points of --data; nothing was changed$'
            exits 2 run $work/my.nevh --data beside.csv --keep-plot-script $name
            says '^nevh: --keep-plot-script .* over the measured points'
            exit $status
        ) || status=1
    done
done
(
    NEVH_SCENES=$work/scenes
    exits 2 list scenes -o $work/folder/../scenes/mine.nevh
    says 'over the scene itself'
    exits 0 list scenes -o $work/scenes.txt
    exit $status
) || status=1
cmp -s $work/scenes/beside.csv $work/points.kept || fails "changed the points"
cmp -s $work/scenes/mine.nevh $work/kept || fails "changed the scene"
# Links to one file that is not there yet; the parts of a sweep.
ln -s coming.gp $work/link1
ln -s folder/../coming.gp $work/link2
exits 2 compare $work/my.nevh -o $work/link1 --keep-plot-script $work/link2
says 'two outputs would have the same name'
exits 2 compare $work/my.nevh -o $work/link1 --keep-plot-script $work/coming.gp
says 'two outputs would have the same name'
cp $work/kept $work/part.2-of-3.npy.txt
cp $work/kept $work/part.2-of-3.npy
for name in part.2-of-3.npy.txt part.2-of-3.npy; do
    exits 2 sweep $work/$name --vary k=1,2,3 --outcomes energy_error \
        -o $work/part.npy --task 2/3
    says 'over the scene itself'
    cmp -s $work/$name $work/kept || fails "changed the scene $name"
done

# The mode of a file that was there; of one that was not that of the umask.
for run in 'compare' 'check' 'effects' 'run'; do
    : >$work/private
    chmod 600 $work/private
    exits 0 $run $work/my.nevh -o $work/private
    test "$(ls -l $work/private | cut -c 1-10)" = -rw------- ||
        fails "made a private file public"
    rm -f $work/new
    (umask 027; exits 0 $run $work/my.nevh -o $work/new; exit $status) || status=1
    test "$(ls -l $work/new | cut -c 1-10)" = -rw-r----- ||
        fails "minds no umask"
done

# Links: what they stand for is written; a loop is refused and left alone.
ln -s there $work/dangling
exits 0 compare $work/my.nevh -o $work/dangling
test -L $work/dangling && test -s $work/there || fails "replaced a link"
ln -s loop $work/loop
exits 2 compare $work/my.nevh -o $work/loop
test -L $work/loop || fails "replaced a loop of links"

# Names as long as the system takes; what cannot be written is told at once.
long=$(printf 'n%.0s' 1 2 3 4 5)
long=$long$long$long$long$long
long=$long$long$long$long$long$long$long$long$long$long
exits 0 compare $work/my.nevh -o $work/$long
test -s $work/$long || fails "wrote nothing"
for run in check effects gradients compare; do
    exits 2 $run $work/my.nevh -o $work/nowhere/out
    says 'nowhere/out cannot be written'
    test -s $work/out && fails "worked before it looked"
done
exits 2 compare $work/my.nevh -o -
says 'takes a file'
test -e ./- && fails "made a file -"

# No space for help, and none for files: nothing is left.
if test -c /dev/full; then
    for help in --help --version 'compare --help' help 'list integrators'; do
        command=$help
        "$nevh" $help >/dev/full 2>$work/err
        test $? = 2 || fails "does not mind a full disk"
        says 'cannot be written'
    done
fi
# Nobody reads: the status is that of an output that cannot be written, without messages,
# too, and messages alone are no output.
for command in 'run pendulum --t-end 1' 'compare pendulum --t-end 1 --dt 0.1' \
    'list scenes' sheet "sheet 1 -o $work/closed --format json"; do
    case $command in sheet*) "$nevh" sheet >/dev/null 2>&1 || continue ;; esac # Python
    "$nevh" $command >&- 2>&-
    test $? = 2 || fails "does not mind that all is closed"
    "$nevh" $command >&-
    test $? = 2 || fails "does not mind that its output is closed"
    "$nevh" $command 2>&- >/dev/null || fails "minds that messages are closed"
    test ! -c /dev/full || "$nevh" $command >/dev/full 2>/dev/full
    test $? = 2 || test ! -c /dev/full || fails "does not mind a full disk"
done 2>/dev/null
(
    ulimit -f 1 # of 512 or 1024 bytes
    "$nevh" compare $work/my.nevh --t-end 20 --format csv --dt 0.1,0.2,0.3,0.4 \
        --integrators verlet,gauss4,gauss6,gauss8,rk4 \
        -o $work/limited >/dev/null 2>$work/err
    test $? = 2
) || fails "does not mind a limit of size"
says 'limited cannot be written'
test "$(echo $work/limited*)" = "$work/limited*" || fails "left a part"

# Little stack, as threads have it in some places.
if test -z "$SANITIZE_FLAGS"; then
    (
        ulimit -s 64 && "$nevh" compare $work/my.nevh --t-end 20 \
            --integrators verlet,gauss4,rk4 >/dev/null 2>$work/err
    ) || fails "needs more than 64 kB of stack"
fi

# Names that are no UTF-8, or of two lines: JSON stays JSON, rows stay rows.
bytes=$(printf '%s/a\377b.nevh' $work)
cp $work/my.nevh "$bytes"
exits 0 compare "$bytes" --format json
has 'a\\ufffdb'
LC_ALL=C grep -q "$(printf '\377')" $work/out && fails "is no UTF-8"
lines=$(printf '%s/a\nb.nevh' $work)
cp $work/my.nevh "$lines"
exits 0 run "$lines" --t-end 0.2
test "$(grep -vc '^#' $work/out)" = 4 || { fails "has other rows"; cat $work/out; }

# Messages about words as long as files are short, and do not control the terminal.
long=$(awk 'BEGIN { for (i = 0; i < 12000; i++) printf("phi^2/2+") }')
for word in $long "$(printf 'a\033[2Jb')"; do
    for arguments in "$word" "run $word" "run pendulum --$word" "new none/$word" \
        "run pendulum --samples $word" "run pendulum -o none/$word" "list $word"; do
        exits 2 $arguments
        test $(wc -c <$work/err) -lt 1100 || fails "says $(wc -c <$work/err) bytes"
        test $(tr -d '\n[:print:]' <$work/err | wc -c) = 0 || fails "controls the terminal"
    done
done

# What a spreadsheet would compute is a text, and a number stays one.
mkdir $work/formulas
for name in '=1+1' '+1+1' '-1+1' '@SUM(1)' '=cmd,"x"'; do
    rm -f $work/formulas/*
    cp $work/kept "$work/formulas/$name.nevh"
    (
        NEVH_SCENES=$work/formulas
        exits 0 list scenes --format csv --quiet
        test "$(sed -n 2p $work/out | tr -d '"' | cut -c 1-2)" = \
            "'$(printf %.1s "$name")" || { fails "begins a formula"; cat $work/out; }
        exit $status
    ) || status=1
done
exits 0 compare $work/my.nevh --format csv --quiet
grep -q "'" $work/out && fails "quotes what is no formula"

# What has no end is no state, and no code.
: >$work/z.csv
ln -s /dev/zero $work/z.csv.state
exits 2 run $work/my.nevh --resume $work/z.csv
says 'is no state of a run'
ln -s /dev/zero $work/zero.c
sed 's/my\.c/zero.c/; s/^effects.*/effects = kinetic, code/' $work/code.nevh \
    >$work/zero.nevh
exits 2 compare $work/zero.nevh --allow-code
says 'is no regular file'
exit $status

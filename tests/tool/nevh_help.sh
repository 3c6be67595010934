#!/bin/sh
# Help, the page for man, --quiet, and what reaches a terminal.

. "${srcdir:-.}/tests/support/nevh_support.sh"

narrow() {
    awk 'length($0) > 80 { print; wide = 1 } END { exit wide }' $work/out ||
        fails "is wider than 80 columns"
}
exits 0 help --format json
commands=$(sed -n 's/^ *{"name": "\([a-z]*\)", "operand": .*/\1/p' $work/out)
test "$commands" || fails "lists no commands"

exits 0 --help
narrow
cp $work/out $work/help
exits 0 help
cmp -s $work/out $work/help || fails "differs from --help"
exits 2
grep -q '^  compare  *[a-z]' $work/err || fails "does not help"
test "$(wc -l <$work/err)" -lt 32 || fails "is longer than a screen"
test -s $work/out && fails "prints to stdout"
for one in $commands; do
    grep -q "^  nevh $one" $work/help || fails "lacks $one"
    exits 0 help $one
    narrow
    has "^Usage: nevh $one "
    cp $work/out $work/one
    exits 0 $one --help
    cmp -s $work/out $work/one || fails "differs from nevh help $one"
done
# The examples of a command, each as a person would type it.  A page needs a kit.
scenes=$(cd "$NEVH_SCENES" && pwd -P)
absolute=$(cd "$(dirname "$nevh")" && pwd -P)/$(basename "$nevh")
for one in $commands; do
    exits 0 help $one
    sed -n '/^Examples:/,/^Options:/p' $work/out |
        sed -e :a -e '/\\$/N; s/\\\n *//; ta' | sed -n 's/^  nevh //p' >$work/examples
    test "$(wc -l <$work/examples)" = 2 || fails "help $one has no two examples"
    case $one in
    page | hard | mark) continue ;; # a kit, half a minute, a file of answers
    sheet) "$nevh" sheet >/dev/null 2>&1 || continue ;; # Python
    esac
    while read -r example; do
        (cd $work && eval "NEVH_SCENES='$scenes' \"$absolute\" $example") >$work/out 2>$work/err </dev/null
        code=$?
        test $code = 0 || fails "exit status $code of the example $example"
    done <$work/examples
done
# The topic has lines to paste, which run.
exits 0 help integrators
narrow
sed -n '/^cat >mine.nevh/,$p' $work/out >$work/pasted
(cd $work && nevh() { NEVH_SCENES=$scenes "$absolute" "$@"; } && . ./pasted) >$work/out 2>$work/err ||
    fails "the lines of the topic fail"
has '^  triple: order 4, symmetric, symplectic'
has '^  triple: order 2, symmetric, symplectic'
has '^ ralston-of-mine  *2  no '
exits 2 help integrators --format json
exits 0 help run
has '^  --samples N '
lacks '--impact'
exits 2 help compair
says 'compair; did you mean compare'

# In the page, each command and option is the head of a paragraph.
if help2man --version >/dev/null 2>&1; then
    case $nevh in
    */*) program=$nevh ;;
    esac
    help2man --name 'a page' "$program" >$work/page || fails "makes no page"
    for one in 'nevh compare SCENE' 'nevh hard' 'nevh help COMMAND' \
        '\\fB\\-\\-with\\fR A,B' '\\fB\\-o\\fR, \\fB\\-\\-output\\fR FILE'; do
        sed -n '/^\.TP$/{n;p;}' $work/page | grep -q "^$one\$" ||
            { fails "tears '$one' apart"; grep -A2 -e "$one" $work/page; }
    done
fi

# --quiet: a table begins with its header, and nothing follows it.
bare() {
    exits 0 "$@" --quiet
    head -n 1 $work/out | grep -q '^  *[a-z]' || fails 'is not a table alone'
    lacks '^[A-Za-z]'
}
bare chaos pendulum --t-end 30 --starts 2
bare compare pendulum --t-end 3
bare frequencies pendulum --integrators verlet --t-end 100
bare flow pendulum --integrators verlet --at 1

# --quiet: CSV that begins with its header.
quiet() {
    exits 0 "$@" --quiet --format csv
    lacks '^#'
    head -n 1 $work/out | grep -q '^[a-z_]*,[a-z_,]*' || fails "lacks a header"
}
quiet compare pendulum --t-end 1
quiet run pendulum --t-end 1
quiet section pendulum --t-end 20
quiet cost oscillator --t-end 10 --integrators verlet,gauss4
quiet recommend oscillator --t-end 10 --energy-error 1e-3 --integrators verlet
quiet gradients pendulum --t-end 1
quiet check pendulum --t-end 1
quiet effects pendulum --t-end 1
quiet effects pendulum --t-end 1 --impact
exits 0 run pendulum --t-end 1 --quiet -o $work/orbit.csv
grep -q '^#' $work/orbit.csv && fails "writes # lines"
exits 0 run pendulum --t-end 1 -o $work/orbit.csv
grep -q '^# Pendulum' $work/orbit.csv || fails "says nothing"
if python3 -c 'import numpy' 2>/dev/null; then
    exits 0 compare pendulum --t-end 1 --quiet --format csv
    python3 -c 'import sys, numpy
rows = numpy.genfromtxt(sys.argv[1], delimiter=",", names=True, dtype=None, encoding="utf-8")
assert len(rows) == 14 and rows["steps"][0] == 10
assert rows["hamiltonian_evals"].dtype.kind == "i"' $work/out ||
        fails "is not for genfromtxt"
fi
# Counts are whole numbers, also of schemes that see H in parts.
exits 0 compare sun-earth-moon --t-end 0.1 --quiet --format csv
awk -F, 'NR > 1 && $14 !~ /^[0-9]*$/ { print; wrong = 1 } END { exit wrong }' \
    $work/out || fails "counts parts of evaluations"

# No control character of a scene reaches a terminal.
escape=$(printf '\033')
printf '[scene]\ntitle = %s[31mred\n[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\n' \
    "$escape" >$work/red.nevh
exits 2 check $work/red.nevh
says 'red\.nevh:2:9: error: a control character'
cat $work/out $work/err | grep -q "$escape" && fails "prints an escape"
cp "$srcdir/scenes/pendulum.nevh" "$work/a${escape}[31m.nevh"
exits 0 compare "$work/a${escape}[31m.nevh" --t-end 1
grep -q "$escape" $work/out && fails "prints an escape"

# Names that others use.
exits 0 compare pendulum --integrators euler-cromer,rk45 --t-end 1 --dt 0.1 \
    --format csv
has '^pendulum,symplectic-euler-a,|^pendulum,euler-cromer,'

# Names that stand for something else.
scene() {
    printf '[coordinates]\n%s\n[effects]\nK = p_x^2/2\n[observables]\n%s\n' \
        "$1" "$2" >$work/odd.nevh
}
scene 'x = 1' 'energy = 2*x'
exits 2 check $work/odd.nevh
says ':6:1: error: energy is the value of H'
scene 'x = 1
energy = 2' 'y = 2*x'
exits 2 check $work/odd.nevh
says ':3:1: error: energy is the value of H'
scene 'x = 0.3 rad' 'y = x'
exits 2 check $work/odd.nevh
says ':2:5: error: units are not read: put rad behind a #'
scene 'x = 1 ; period 2*pi ; period 3' 'y = x'
exits 2 check $work/odd.nevh
says 'a period is given already'
exits 2 compare /
says '/ is a folder'
exit $status

#!/bin/sh
# Each command four times at once over one empty cache, one folder and one output: all
# end with the same bytes, but for times, and whole files; also where one of them is
# killed, and where the compiler fails, hangs or leaves a child.

. "${srcdir:-.}/tests/support/nevh_support.sh"

XDG_CACHE_HOME=$PWD/$work/cache
TMPDIR=$PWD/$work/tmp
export XDG_CACHE_HOME TMPDIR
mkdir $TMPDIR
short='--t-end 200 --gradient exact --integrators verlet --dt 0.1'
compiled="$short --native always"

# four PROCESS ARGUMENT...: PROCESS: who is killed (1), or 0.
tried=
four() {
    killed=$1
    shift
    tried="$tried $1"
    command="four times $*"
    rm -rf $XDG_CACHE_HOME
    for k in 1 2 3 4; do
        (
            timeout 300 "$nevh" "$@" >$work/out.$k 2>$work/err.$k </dev/null &
            echo $! >$work/process.$k
            wait $!
            echo $? >$work/code.$k
        ) 2>/dev/null &
    done
    if test $killed = 1; then
        sleep 0.1
        kill -s KILL $(cat $work/process.1) 2>/dev/null
    fi
    wait
    for k in $(test $killed = 1 || echo 1) 2 3 4; do
        code=$(cat $work/code.$k)
        test $code = 0 || fails "exit status $code: $(cat $work/err.$k)"
        # Times of this machine, in columns of CSV, are not compared.
        sed -e 's/[0-9.e+-]* \(ns\|ms\|s\)\>//g' $work/out.$k >$work/text.$k
    done
    case $1 in
    compare | cost | recommend | gradients | effects) ;; # have times in columns
    *)
        cmp -s $work/text.2 $work/text.3 && cmp -s $work/text.3 $work/text.4 ||
            fails "prints other bytes"
        ;;
    esac
    test -z "$(find $XDG_CACHE_HOME -mindepth 2 -name '*.so.*' -type d 2>/dev/null)" ||
        test $killed = 1 || fails "leaves a folder in the cache"
}

# Whole files: whoever was last.
same_file() {
    test -s $work/o || fails "wrote nothing"
    for k in 1 2 3; do
        cmp -s $work/o $work/first || fails "wrote another file"
    done
    test "$(ls $work | grep -c '^o\.')" = 0 || fails "leaves temporary files"
}

csv() { # ARGUMENT...: with one output
    "$nevh" "$@" -o $work/o 2>$work/err </dev/null
    mv $work/o $work/first
    four 0 "$@" -o $work/o
    same_file
}

kept() {
    test "$(find $XDG_CACHE_HOME -name '*.so' | wc -l)" -ge 1 || fails "compiles nothing"
}
four 0 run pendulum $short --samples 2
four 0 run pendulum $compiled --samples 2
kept
four 0 compare pendulum $compiled
kept
four 0 cost pendulum $compiled --dt 0.1,0.2
kept
four 0 recommend pendulum $compiled --energy-error 0.1
kept
four 0 gradients pendulum --t-end 5
four 0 effects pendulum
four 0 check pendulum --t-end 5
four 0 chaos henon-heiles --t-end 100
four 0 frequencies pendulum --t-end 200
four 0 reference pendulum --t-end 5
four 0 list scenes
four 0 list integrators
four 0 list gradients
four 0 list models
four 0 help
four 0 help compare
four 0 hard 'pendulum at rest' --integrators verlet,gauss4
csv export pendulum --integrators verlet --dt 0.1
csv section henon-heiles --t-end 300
csv sweep pendulum --vary 'phi = range(0.1, 3, 8)' --t-end 500 --outcomes energy_error
csv fit pendulum-filmed --data pendulum-filmed.csv --vary l

# One of four makes a new scene, whole; the others leave it alone.
command='four times new'
for k in 1 2 3 4; do
    (
        "$nevh" new $work/new.nevh --from pendulum >/dev/null 2>$work/err.$k
        echo $? >$work/code.$k
    ) &
done
wait
test "$(cat $work/code.? | sort | tr '\n' ' ')" = '0 2 2 2 ' ||
    fails "exit statuses $(cat $work/code.?)"
test "$(cat $work/err.? | grep -c 'is there already')" = 3 || fails "does not say why"
"$nevh" new $work/alone.nevh --from pendulum >/dev/null
grep -v '^#' $work/new.nevh >$work/text.1
grep -v '^#' $work/alone.nevh >$work/text.2
cmp -s $work/text.1 $work/text.2 || fails "makes another file"

# Pages have times of this machine.
whole_page() {
    test "$(tail -n 1 $work/o)" = '</html>' || fails "a page without an end"
    test "$(ls $work | grep -c '^o\.')" = 0 || fails "leaves temporary files"
    test -z "$(ls -A $TMPDIR)" || fails "leaves $(ls -A $TMPDIR)"
    rm -f $work/o
}
four 0 report oscillator --t-end 1 --dt 0.1 --integrators verlet -o $work/o
whole_page
if test -f web/kit.html || test -f "$srcdir/web/kit.html"; then
    four 0 page pendulum -o $work/o
    whole_page
fi
four 0 run pendulum --t-end 5 --samples 3 --plot $work/p.svg
four 0 portrait pendulum --t-end 10 --plot $work/p.svg
four 0 flow pendulum --t-end 5 --plot $work/p.svg

# Worksheets, into one folder, and their answers.
if (. "$srcdir/tests/python/find_python.sh") >/dev/null; then
    . "$srcdir/tests/python/find_python.sh"
    PYTHON=$python
    export PYTHON
    "$nevh" sheet 1 --for Ada --key 7 -o $work/once >/dev/null
    four 0 sheet 1 --for Ada --key 7 -o $work/sheets
    diff -r $work/sheets $work/once >/dev/null || fails "makes other sheets"
    "$nevh" sheet 1 --for Ada --key 7 --answers --format csv |
        cut -d, -f1-3 | sed '1s/.*/name,task,answer/' >$work/answers.csv
    four 0 mark $work/answers.csv --key 7
else
    tried='sheet mark'
fi

four 1 run pendulum $compiled --samples 2
four 1 compare pendulum $compiled

# Compilers: one that fails, one that hangs, one that leaves a child with the pipe.
compiler() {
    printf '#!/bin/sh\n: >"$CALLED"\n%s\n' "$1" >$work/compiler
    chmod +x $work/compiler
    CC=$PWD/$work/compiler
    export CC
}
failing() { # what the compiler does, ARGUMENT...
    rm -f $CALLED
    compiler "$1"
    shift
    four 0 run pendulum "$@" --samples 2 --quiet
    test -e $CALLED || fails "asks no compiler"
}
C_COMPILER=${CC:-cc} CALLED=$PWD/$work/called
export C_COMPILER CALLED
failing 'exit 1' $compiled
failing 'sleep 20 & exec $C_COMPILER "$@"' $compiled
failing 'while :; do sleep 1; done' --t-end 30000 --gradient exact --integrators gauss8 \
    --dt 0.1
# No command is left out.
command='four times'
for name in $("$nevh" help | sed -n 's/^  nevh \([a-z]*\).*/\1/p'); do
    case " new $tried " in
    *" $name "*) ;;
    *) test "$name" = page || fails "$name is not tried" ;;
    esac
done
if test "$SLOW" = yes; then
    four 0 compare pendulum --t-end 20000 --gradient exact
    four 0 sweep pendulum --vary 'phi = range(0.1, 3, 8)' --t-end 50000
    four 1 sweep pendulum --vary 'phi = range(0.1, 3, 8)' --t-end 50000
fi
exit $status

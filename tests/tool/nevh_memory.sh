#!/bin/sh
# Every command where memory runs out: at one allocation, or from one on.  It
# never crashes or hangs, says so, leaves no file that is begun, and what it does
# print is right.  sheet and mark are Python's.  SLOW=yes: at twenty times as many
# allocations, or at each.

. "${srcdir:-.}/tests/support/nevh_support.sh"
. "$srcdir/tests/support/nevh_interrupt.sh"

exits_untested() {
    test $status = 0 || exit $status
    echo "memory that runs out was not tested: $1"
    exit 77
}
test -z "$SANITIZE_FLAGS" ||
    exits_untested "sanitizers bring an allocator of their own"
command -v ${CC:-cc} >/dev/null 2>&1 || exits_untested "there is no C compiler"
${CC:-cc} -shared -fPIC -o $work/starve.so "$srcdir/tests/support/starve.c" -ldl \
    2>$work/err || exits_untested "tests/support/starve.c does not compile"

# starve AT ON ARGUMENT...: runs nevh where allocation AT fails, and where ON is
# not empty all after it.
starve() {
    starve_at=$1
    starve_on=$2
    shift 2
    command="$* (allocation $starve_at${starve_on:+ and all after it} fails)"
    $limit env LD_PRELOAD=$PWD/$work/starve.so STARVE_AT=$starve_at \
        ${starve_on:+STARVE_ON=1} "$nevh" "$@" >$work/out 2>$work/err </dev/null
    code=$?
}
# Without what takes another time each time.
steady() {
    sed -e 's/[0-9.e-]* *ms//g' "$1"
}

STARVE_COUNT=1
export STARVE_COUNT
starve 0 '' list integrators
unset STARVE_COUNT
grep -q '^[0-9][0-9]*$' $work/err ||
    exits_untested "allocations of nevh do not pass through LD_PRELOAD"

# starves PLACES ARGUMENT...: at so many places, from the first, or from percentage
# $from, to the last.
from=0
starves() {
    places=$1
    shift
    rm -f $work/made*
    STARVE_COUNT=1
    export STARVE_COUNT
    starve 0 '' "$@"
    unset STARVE_COUNT
    test $code -le 1 || fails "does not work where there is memory ($code)"
    count=$(tail -n 1 $work/err)
    case $count in
    *[!0-9]* | '') # as of another program, which takes the place of nevh
        fails "has no count of allocations"
        return
        ;;
    esac
    test "$SLOW" = yes && places=$((20 * places))
    steady $work/out >$work/right
    made=$(ls $work/made* 2>/dev/null | head -n 1)
    test -z "$made" || steady $made >$work/whole
    at=$((1 + from*count/100))
    places=$((places*100/(100 - from)))
    while test $at -le $count; do
        for on in '' on; do
            rm -f $work/made*
            starve $at "$on" "$@"
            case $code in
            0) steady $work/out | cmp -s - $work/right || test -z "$same" ||
                fails "prints something else"
                test -z "$same" || test -z "$made" || steady $made |
                    cmp -s - $work/whole || fails "writes something else" ;;
            1 | 2) grep -q '^out of memory' $work/err && fails "does not say who"
                cat $work/out $work/err | grep -Eiq 'memory|cannot' ||
                { fails "does not say why (exit status $code)"
                  cat $work/err; } ;;
            *) fails "crashes (exit status $code)" ;;
            esac
            for file in $work/made.*.??????; do
                test -e "$file" && fails "leaves $file"
            done
        done
        at=$((at + count / places + 1))
    done
}
same=yes
starves 12 run pendulum --t-end 1
starves 8 run figure-eight --t-end 1 --samples 5 --format json -o $work/made.json
starves 36 run pendulum --t-end 1 --samples 3 --plot $work/made.svg
starves 6 section henon-heiles --t-end 20
starves 6 new $work/made.nevh --from pendulum
starves 5 list integrators
starves 3 list gradients
starves 3 list models --format json
starves 4 help compare
starves 4 help integrators
starves 3 list scenes --format json
starves 12 flow pendulum --t-end 1
starves 8 sweep pendulum --vary 'phi=range(0.1,3,6)' --t-end 10 --threads 1 \
    --outcomes period,energy_error,verdict
starves 2 sweep pendulum --vary 'phi=range(0.1,3,6)' --t-end 5 --threads 1 \
    --outcomes energy_error -o $work/made.npy
head -n 30 "$srcdir/scenes/pendulum-filmed.csv" >$work/data.csv
starves 2 fit pendulum-filmed --data $work/data.csv --vary l --format csv
from=90
starves 60 fit pendulum-filmed --data $work/data.csv --vary l --format csv
from=0
starves 4 reference double-pendulum --t-end 1
starves 4 chaos henon-heiles --t-end 20
starves 4 frequencies henon-heiles --t-end 100
starves 4 export kepler --integrators gauss4 --dt 0.1 -o $work/made.c
starves 5 check pendulum --t-end 0.5
same= # times are measured
starves 12 compare pendulum --t-end 1 --diagnostics \
    --integrators verlet,gauss4,gsl-rk8pd,dopri5,tao4,gonzalez
starves 5 compare double-pendulum --t-end 0.5 --integrators gauss4,itoh-abe \
    -o $work/made.txt
starves 3 portrait pendulum --t-end 1 --vary phi=0.5,1 \
    --keep-plot-script $work/made.gp
starves 5 effects pendulum --impact --t-end 0.5
starves 4 gradients pendulum --t-end 0.5
starves 4 cost pendulum --t-end 0.5 --integrators verlet,gauss4
starves 4 recommend pendulum --t-end 0.5 --integrators verlet,gauss8 \
    --energy-error 1e-3
TMPDIR=$work
export TMPDIR
starves 2 report pendulum --t-end 0.5 -o $work/made.html
ls $work | grep '^nevh\.' && fails "leaves its folder"
starves 3 hard 'pendulum at rest' --integrators verlet,gauss4,dop853
starves 4 run pendulum --t-end 2 --plot $work/made.svg --plot-kind energy
starves 3 run double-pendulum --t-end 1 --at 0.3,0.7
starves 3 section henon-heiles --t-end 20 --plot $work/made.svg
starves 2 cost pendulum --t-end 0.5 --by state --integrators verlet,wisdom-holman
starves 2 compare pendulum --t-end 0.5 --plot $work/made.svg --plot-kind order \
    --integrators verlet
starves 2 portrait pendulum --t-end 1 --vary phi=0.5,1 --plot $work/made.svg

starves 2 flow pendulum --t-end 1 --plot $work/made.svg
exit $status

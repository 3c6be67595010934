#!/bin/sh
# Whether nevh recommend answers: each scene, errors of the energy and of the
# state, targets from 1e-2 to 1e-12.  What it advises is run again by nevh
# compare, over the same span and over one three times as long.  Prints a row a
# question as CSV:
#
#   scene,by,target,exit,seconds,advice,error,error3,holds,says
#
# error is that of the run advised, error3 that of three times its length
# (neither where there is no state error then), holds the time until which the
# answer says that it keeps the target, says the message where there is no
# answer.  seconds are of processor time, so that what else the machine does
# counts little.  Each target is asked of all scenes before the next one, in an
# order that soon covers their range.  At the end, as lines that begin with #:
# how many were answered, how many promises were broken, and the slowest.
# Usage: answers.sh NEVH [SCENE...]; TARGETS and BY in the environment.

nevh=${1:?}
shift
scenes=${NEVH_SCENES:?}
test $# -gt 0 || set -- $(cd "$scenes" && ls *.nevh | sed 's/\.nevh$//')
TARGETS=${TARGETS:-1e-4 1e-8 1e-12 1e-2 1e-6 1e-10 1e-3 1e-5 1e-7 1e-9 1e-11}
BY=${BY:-energy state}
work=${TMPDIR:-/tmp}/answers.$$
trap 'rm -f $work $work.*' EXIT

# The error of the row that those options make; empty where there is none.
error_of() { # energy|state, and options
    column=9
    test "$1" = state && column=13
    shift
    (ulimit -t 120 && "$nevh" compare "$@" --format csv 2>/dev/null) |
        awk -F, -v c=$column '!/^#/ && $1 != "scene" { print $c }'
}
ask() { # SCENE energy|state TARGET
    (
        ulimit -t 120
        "$nevh" recommend "$1" --$2-error "$3" >$work 2>$work.err
        code=$?
        times >$work.times
        exit $code
    )
    code=$?
    seconds=$(awk -F'[ms ]+' 'NR == 2 {
        printf "%.1f", 60 * ($1 + $3) + $2 + $4 }' $work.times)
    line=$(sed -n 's/^  nevh compare //p' $work)
    error= error3= holds= says=
    if test $code = 0; then
        end=$(sed -n 's/^t = \([^ ]*\) \.\.\. \([^ ]*\).*/\1 \2/p' $work |
            awk 'NR == 1 { printf "%.12g", $1 + 3 * ($2 - $1) }')
        holds=$(sed -n 's/^.*holds until t = \([0-9.e+-]*[0-9]\).*/\1/p' $work |
            head -n 1)
        error=$(error_of $2 $line)
        error3=$(error_of $2 $line --t-end $end)
    else
        says=$(tr ',\n' '; ' <$work.err)
    fi
    echo "$1,$2,$3,$code,$seconds,$line,$error,$error3,$holds,$says" |
        sed 's/--integrators \([^ ]*\)/\1/; s/--gradient \([^ ]*\)/\1/'
}

echo scene,by,target,exit,seconds,advice,error,error3,holds,says
for target in $TARGETS; do
    for by in $BY; do
        for scene; do
            ask "$scene" $by $target
        done
    done
done | tee $work.all
awk -F, '{ n++; answered += $4 == 0; late += $5 > 60
        if ($5 > worst) { worst = $5; which = $1 " " $2 " " $3 } }
    $4 == 0 && $7 != "" && $7 > $3 * 1.0000001 { broken++ }
    $4 == 0 && $8 != "" { longer++
        if ($8 <= $3 * 1.0000001) kept++; else if ($9 != "") told++ }
    END {
        printf "# %d questions: %d answered, %d told why not\n", n, answered,
            n - answered
        printf "# slowest %.1f s (%s), %d above 60 s\n", worst, which, late
        printf "# %d answers do not keep their target over the run itself\n",
            broken
        printf "# three times as long: %d kept, %d told how long, %d neither, " \
            "of %d that can be measured\n", kept, told, longer - kept - told,
            longer }' $work.all

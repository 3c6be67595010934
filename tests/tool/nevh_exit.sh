#!/bin/sh
# The exit status of each command of nevh help, as the manual's table has it: of what
# is done, what ends early, and wrong input.  What fails says why on
# stderr.

. "${srcdir:-.}/tests/support/nevh_support.sh"

XDG_CACHE_HOME=$PWD/$work/cache
export XDG_CACHE_HOME

# scene NAME H T_END
scene() {
    cat >$work/$1.nevh <<END
[parameters]
a = 1
[coordinates]
x = 1, -0.1
[effects]
T = p_x^2/2
V = $2
[sections]
s = when p_x = -0.5, rising: x, p_x
[run]
t_end = ${3:-5}
dt = 0.01
integrators = verlet
[ensemble]
x = 1, 1.1
outcomes = energy_error
END
}
scene good 'a*x^2/2'
scene bad 'a*x^2/2' 'b*2'
scene ends 'a*x*log(x)'  # H is not finite from x = 0 on
scene infinite '-a*x^4'  # x grows without bound in a finite time
printf 't,x\n0,1\n1,0.5\n2,-0.4\n3,-1\n' >$work/t.csv

"$nevh" help --format json >$work/help
commands=$(sed -n 's/^ *{"name": "\([a-z]*\)", "operand": .*/\1/p' $work/help)
operand_of() {
    sed -n "s/^ *{\"name\": \"$1\", \"operand\": \"\([A-Z.]*\)\".*/\1/p" $work/help
}
takes() { # COMMAND OPTION
    sed -n "/^ *{\"name\": \"$1\", \"operand\"/,/\"options\"/p" $work/help |
        grep -q "\"options\": .*\"$2\""
}
# What a command needs besides its operand, as far as a scene is one; a command that
# needs nothing is not named here.
needs() {
    case $1 in
    portrait) echo --plot $work/portrait.svg ;;
    fit) echo --data $work/t.csv --vary a ;;
    cost) echo --budget 0.5 --integrators verlet ;;
    recommend) echo --energy-error 1e-2 --integrators verlet ;;
    chaos) echo --t-end 20 ;;
    frequencies) echo --t-end 20 ;;
    effects) test "$2" != ends || echo --impact ;;
    report | page) echo -o $work/made.html ;;
    help) echo run ;;
    list) echo scenes ;;
    new) rm -f $work/made.nevh && echo $work/made.nevh ;;
    mark)
        printf 'name,task,answer\nAda,8.1,19\n' >$work/answers.csv
        echo $work/answers.csv
        ;;
    hard) echo --integrators rk4 --gradient exact ;;
    esac
}
missing_here() { # COMMAND: what it needs that is not installed
    case $1 in
    page) "$nevh" page $work/good.nevh -o $work/kit.html 2>&1 | grep -q 'without the live page' ;;
    sheet | mark) ! "$nevh" sheet >/dev/null 2>&1 ;; # Python
    *) false ;;
    esac
}
# The table in the manual, of a command and a case.
expected() {
    case $1-$2 in
    # The scene is read and written, not run.
    export-ends | export-infinite | page-ends | page-infinite | check-ends | \
        check-infinite) echo 0 ;;
    # The rows say that runs become unstable, and have numbers.
    compare-infinite | report-infinite) echo 0 ;;
    *-good) echo 0 ;;
    *-ends | *-infinite) echo 1 ;;
    *) echo 2 ;;
    esac
}
tried=0
# tries COMMAND CASE ARGUMENT...
tries() {
    one=$1 case=$2
    shift 2
    tried=$((tried + 1))
    code=$(expected $one $case)
    exits $code "$@"
    test $code = 0 || test -s $work/err || fails "says nothing on stderr"
    test $code != 0 || ! grep -q '^nevh: .*fail' $work/err ||
        fails "fails with status 0"
}

for one in $commands; do
    missing_here $one && continue
    case $(operand_of $one) in
    SCENE*)
        for case in good bad ends infinite; do
            tries $one $case $one $work/$case.nevh $(needs $one $case)
        done
        tries $one missing $one $work/nowhere.nevh $(needs $one)
        tries $one option $one $work/good.nevh $(needs $one) --no-such-option
        tries $one value $one $work/good.nevh $(needs $one) --set a=nothing
        takes $one output &&
            tries $one unwritable $one $work/good.nevh $(needs $one) \
                -o $work/none/x
        ;;
    *)
        tries $one good $one $(needs $one)
        tries $one option $one $(needs $one) --no-such-option
        takes $one output &&
            tries $one unwritable $one $(needs $one) -o $work/none/x
        ;;
    esac
done
command='help --format json'
test $tried -ge 120 || fails "has few commands: $tried cases were tried"
for one in new help list; do
    tries $one missing $one $work/none/x
done
exits 2
exits 2 none
exits 0 --version

# Rows that are refused, or unstable, are rows; what a scheme is not for is not.
exits 0 compare $work/good.nevh --integrators verlet,rkn6b --dt 0.01,3
exits 1 compare $work/ends.nevh --plot $work/none.svg
exits 1 report $work/ends.nevh -o $work/none.html
test ! -e $work/none.html || fails "leaves a page"
exits 1 sweep $work/good.nevh --vary 'x = 1, 2' --set a=1 --outcomes 'last(x)' \
    --vary 'p_x = solve(H = -1, from 0.1)'
says 'no start'

exit $status

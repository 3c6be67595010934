#!/bin/sh
# nevh cost --against length: errors of orbits grow as t where the energy is kept, and as
# t^2 where it is not.

. "${srcdir:-.}/tests/support/nevh_support.sh"

records() {
    grep -v '^#' $work/out
}
# column NAME SCHEME: its numbers, one a line, those that are there.
column() {
    records | awk -F, -v name="$1" -v scheme="$2" '
        NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i; next }
        $2 == scheme && $c != "" { print $c }'
}

exits 2 cost pendulum --against time
says 'against is work or length'
exits 0 cost pendulum --against length --t-end 400 --native never \
    --integrators verlet,rk4,gauss4 --format csv
for row in 'verlet 0.9 1.1' 'gauss4 0.9 1.1' 'rk4 1.8 2.2'; do
    set -- $row
    column error_exponent $1 | awk -v low=$2 -v high=$3 '
        { n++; bad += !($1 >= low && $1 <= high) } END { exit !(n == 1 && !bad) }' ||
        fails "errors of $1 grow as t^$(column error_exponent $1)"
    column t_end $1 | awk '{ n++ } n > 1 && $1 / last != 4 { bad = 1 } { last = $1 }
        END { exit !(n == 5 && last == 400 && !bad) }' || fails "lengths of $1"
    column state_error $1 | awk 'n++ && !($1 > last) { bad = 1 } { last = $1 }
        END { exit bad || n != 5 }' || fails "errors of $1 do not grow"
done
# At equal work.
for scheme in verlet rk4 gauss4; do
    column gradient_evals $scheme | tail -n 1
done | awk 'NR == 1 { first = $1 } { bad += $1 / first > 1.1 || $1 / first < 0.9 }
    END { exit NR != 3 || bad }' || fails "schemes do not work alike"
# The energy: level in one, as t in the other.
exits 0 cost pendulum --against length --by energy --t-end 400 --native never \
    --integrators verlet,rk4 --format csv
column error_exponent verlet | awk '{ exit !($1 > -0.1 && $1 < 0.1) }' ||
    fails "the energy error of verlet grows as t^$(column error_exponent verlet)"
column error_exponent rk4 | awk '{ exit !($1 > 0.8 && $1 < 1.2) }' ||
    fails "the energy error of rk4 grows as t^$(column error_exponent rk4)"

# The length at which they part is that at which their errors are alike.
exits 0 cost pendulum --against length --t-end 500 --integrators verlet,rk4
t=$(sed -n 's/^rk4 errs less than verlet up to t = \([0-9.e+]*\),.*/\1/p' $work/out)
exits 0 compare pendulum --match work --dt 0.00625 --t-end "$t" --integrators verlet,rk4 \
    --format csv
column state_error verlet >$work/errors
column state_error rk4 >>$work/errors
awk 'NR == 1 { v = $1 } NR == 2 { exit !($1 / v < 1.2 && $1 / v > 0.8) }' $work/errors ||
    fails "at t = $t errors are $(tr '\n' ' ' <$work/errors)"

# Any two schemes may cross, each pair once; a run that the budget shortens says so.
exits 0 cost pendulum --against length --t-end 400 --integrators rk4,ralston,ralston,gauss6
test "$(grep -c '^rk4 errs less than gauss6 ' $work/out)" = 1 || fails "rk4 and gauss6"
lacks 'shortened|ralston errs less than ralston'
exits 0 cost pendulum --against length --integrators verlet,rk4 --budget 0.001
has '^shortened, .*--t-end 1000 '
exits 2 cost pendulum --against length --by energy --observable phi

exits 0 cost pendulum --against length --t-end 100 --integrators verlet,rk4 \
    --plot $work/length.svg
grep -q 'end of the run' $work/length.svg || fails "the picture does not name its axis"

# Parts that solve H have no order: they are in no picture, and lead nowhere.
exits 0 cost kepler --against length --t-end 20 --integrators verlet,wisdom-holman,rk4 \
    --plot $work/exact.svg
has '^ wisdom-holman .* exact .* -  '
lacks '[*].*exact|wisdom-holman errs less'
grep -q rk4 $work/exact.svg && ! grep -q wisdom $work/exact.svg || fails "draws exact steps"
exit $status

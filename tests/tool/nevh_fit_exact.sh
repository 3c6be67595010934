#!/bin/sh
# nevh fit: data that the scheme itself made, without noise, from the exact values and
# from near; and first values that are the minimum of data with noise.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# A row for each of NUMBERS, by this scheme, whose interval holds the truth and is not
# longer than that.
holds() { # INTEGRATOR NUMBERS [LONGEST]
    grep -v '^#' $work/out | awk -F, -v scheme="$1" -v numbers="$2" -v longest="${3:-1e-7}" '
        BEGIN { count = split(numbers, pair, ",")
            for (k = 1; k <= count; k++) {
                split(pair[k], part, "="); truth[part[1]] = part[2] } }
        NR == 1 { next }
        { x = truth[$4]; found += $2 == scheme && $7 > 0 && $8 <= x && x <= $9 &&
            $9 - $8 < longest*(1 + $9) }
        END { exit found != count }' ||
        fails "intervals do not hold $2 of $1"
}

# Numbers are those of the scene, from which the first fit begins; the second begins
# NEAR.
own() { # SCENE INTEGRATOR DT T_END NUMBERS COLUMNS NEAR...
    scene=$1 integrator=${by:-$2} numbers=$5 columns=$6
    names=$(echo "$5" | sed 's/=[^,]*//g')
    how="--integrators $2 --dt $3 --t-end $4"
    shift 6
    exits 0 run $scene $how --samples 51 --quiet -o $work/own.csv
    exits 0 fit $scene $how --data $work/own.csv --vary $names --columns $columns --format csv
    holds $integrator $numbers $longest
    exits 0 fit $scene $how --data $work/own.csv --vary $names --columns $columns \
        --format csv "$@"
    holds $integrator $numbers $longest
}

own oscillator verlet 0.1 10 k=1 x,p_x --set k=1.01
own oscillator gauss8 0.1 10 k=1 x,p_x --set k=0.97
own oscillator midpoint 0.1 10 k=1,x=1 x,speed --set k=1.01
own oscillator dop853 0.1 10 k=1 x --set k=1.01
own coupled-oscillators verlet 0.1 10 k=0.1,k1=1 x1,x2 --set k=0.11
own pendulum taylor 0.05 10 g=9.8 phi --set g=9.7
own pendulum verlet 0.05 10 g=9.8 phi --set g=9.7
own pendulum rk4 0.02 5 l=1,g=9.8 x --set g=9.75
own pendulum-filmed verlet 0.02 8 l=1,g=9.8 x,y --set g=9.75
own henon-heiles verlet 0.05 10 x=0 x,y --start x=0.01
# Near the separatrix the gradients of H alone, differences or exact ones, make orbits
# that are farther apart than rounding is elsewhere.
own pendulum-separatrix verlet 0.1 150 g=9.8 phi --set g=9.801
own magnetic midpoint 0.05 8 B=1 x,y --set B=1.01
own kapitza verlet 0.005 2 g=9.8 phi --set g=9.75
own kepler gauss4 0.02 6 x=0.4,p_y=2 x,y --start x=0.401

# A scheme of another frequency is as good as a stiffer spring: the interval holds both.
by=dop853 longest=1e-2
own oscillator verlet 0.1 10 k=1 x --set k=1.01
own oscillator midpoint 0.1 10 k=1,m=1 x,p_x --set k=1.01,m=1.02
by= longest=

# Rounding alone changes a chaotic orbit by as much as there is: there is no interval.
exits 0 run damped-driven-pendulum --integrators verlet --dt 0.1 --t-end 500 --samples 251 \
    --quiet -o $work/chaos.csv
exits 1 fit damped-driven-pendulum --integrators verlet --dt 0.1 --data $work/chaos.csv \
    --vary q --columns phi
says 'chaotic, and rounding alone changes it by [0-9.]+ of the spread'
exits 0 fit damped-driven-pendulum --integrators verlet --dt 0.1 --data $work/chaos.csv \
    --vary q --columns phi --t-end 30 --format csv
holds verlet q=2

in_a_line() {
    tr -s ' \n' ' ' <$work/out >$work/line
    mv $work/line $work/out
}
says_own='made the data'
# The words: what made the data, and where the errors are from.
exits 0 run oscillator --integrators verlet --dt 0.1 --t-end 10 --samples 51 --quiet \
    -o $work/own.csv
exits 0 fit oscillator --integrators verlet --dt 0.1 --t-end 10 --data $work/own.csv --vary k
in_a_line
has "verlet with dt = 0\.1 $says_own"
has 'the residuals are rounding: errors are by'
lacks '[ -](nan|inf) '
exits 0 fit oscillator --integrators verlet --dt 0.1 --t-end 10 --data $work/own.csv --vary k \
    --columns x
in_a_line
lacks "$says_own"
has 'do not tell their orbits apart'
# Known deviations make the interval, in it the truth, of the same scheme.
exits 0 fit oscillator --integrators verlet --dt 0.1 --t-end 10 --data $work/own.csv \
    --vary k --sigma 1e-3 --format csv
grep -v '^#' $work/out | awk -F, 'NR == 2 { exit !($2 == "verlet" &&
    $8 < 1 && $9 > 1 && $9 - $8 > 1e-5) }' || fails "sigma does not make the interval"

# Data of an exact orbit are not those of verlet, whatever is first.
exits 0 run oscillator --integrators taylor --dt 0.1 --t-end 10 --samples 51 --quiet \
    -o $work/exact.csv
exits 0 fit oscillator --integrators verlet --dt 0.1 --t-end 10 --data $work/exact.csv \
    --vary k --format csv
holds dop853 k=1
exits 0 fit oscillator --integrators verlet --dt 0.1 --t-end 10 --data $work/exact.csv --vary k
in_a_line
lacks "$says_own"
lacks 'do not tell their orbits apart'

# What a fit to points with noise found is where the next one ends.
./examples/add_noise 0.01 1 x <$work/exact.csv >$work/noise.csv
fit_noise() {
    exits 0 fit oscillator --integrators gauss8 --dt 0.1 --t-end 10 \
        --data $work/noise.csv --columns x --vary k --format csv "$@"
    grep -v '^#' $work/out | awk -F, 'NR == 2 { print $6, $7 }'
}
first=$(fit_noise --set k=1.05)
again=$(fit_noise --set k=${first% *})
echo "$first $again" | awk '{ d = $1 - $3; e = 1e-4*$2
    exit !($2 > 1e-4 && d < e && d > -e) }' || fails "moves away from the minimum"
exit $status

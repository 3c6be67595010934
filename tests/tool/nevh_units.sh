#!/bin/sh
# A scene in other units is the same scene: energy errors do not change.

. "${srcdir:-.}/tests/support/nevh_support.sh"

errors() { grep -v '^#' $work/out | awk -F, 'NR > 1 { print $2, $9 }'; }
# same TOLERANCE: the errors of $work/a and $work/b.
same() {
    paste -d ' ' $work/a $work/b | awk -v most="$1" '
        $1 != $3 || NF != 4 { wrong = 1 }
        { d = $2/$4 - 1; if (d < -most || d > most) wrong = 1 }
        END { exit wrong || NR < 2 }' ||
        { fails "has other errors"; paste $work/a $work/b; }
}

# AU, solar masses and years; then metres, kilograms and seconds.
au=149597870700
year=31557600
sun=1.98841e30
exits 0 compare sun-earth-moon --integrators verlet,rk4 --dt 0.002 --t-end 2 \
    --format csv
errors >$work/a
exits 0 compare sun-earth-moon --integrators verlet,rk4 \
    --set "G=4*pi^2*$au^3/$year^2/$sun" \
    --set "m=$sun, $sun/332946.05, 0.01230002*$sun/332946.05" \
    --set "a_earth=1.00000011*$au" --set "a_moon=384400000" \
    --dt $(awk "BEGIN { print 0.002*$year }") \
    --t-end $(awk "BEGIN { print 2*$year }") --format csv
errors >$work/b
same 1e-3

# A pendulum of 1 kg and 1 m; of a gram and a millimetre.
exits 0 compare pendulum --integrators verlet,gauss4,rk4 --dt 0.05 --t-end 20 \
    --format csv
errors >$work/a
exits 0 compare pendulum --integrators verlet,gauss4,rk4 --set m=1e-3 \
    --set l=1e-3 --dt $(awk 'BEGIN { printf "%.17g", 0.05*sqrt(1e-3) }') \
    --t-end $(awk 'BEGIN { printf "%.17g", 20*sqrt(1e-3) }') --format csv
errors >$work/b
same 1e-3
exit $status

#!/bin/sh
# Kinds of pictures: slopes, animations.

. "${srcdir:-.}/tests/support/nevh_support.sh"

svg=$work/out.svg
# slope NAME PANEL: as the legend has it.
slope() {
    texts | sed -n "s/^$1: slopes* //p" | cut -d , -f $2
}
between() {
    echo "$1 $2 $3" | awk '{ exit !($2 < $1 && $1 < $3) }' || fails "has $4 of $1"
}

# The state errors of a harmonic oscillator have the scheme's order, and the
# energy errors too; that of rk4 drifts, which takes one more.
exits 0 compare oscillator --integrators verlet,rk4,gauss4,dopri5 --t-end 10 \
    --dt 0.1,0.05,0.025,0.0125,0.00625 --plot-kind order --plot $svg
between "$(slope verlet 1)" 1.95 2.05 "a slope of verlet's energy error"
between "$(slope verlet 2)" 1.95 2.05 "a slope of verlet's state error"
between "$(slope rk4 1)" 4.95 5.05 "a slope of rk4's energy error"
between "$(slope rk4 2)" 3.9 4.1 "a slope of rk4's state error"
texts | grep -q 'dopri5' && fails "draws a scheme that chooses its steps"
texts | grep -q 'choose their steps are left out' || fails "does not say so"
# Rounding has no slope: midpoint keeps a quadratic H.
exits 0 compare oscillator --integrators verlet,midpoint --t-end 10 \
    --dt 0.1,0.05,0.025,0.0125,0.00625 --plot-kind order --plot $svg
texts | grep -q '^midpoint: slopes -, 2.0' ||
    fails "has another slope of midpoint's: $(texts | grep ^midpoint)"
# Where no steps are given there are five; with fewer no slope is fitted, and none to
# state errors that are as large as the orbit.
exits 0 compare oscillator --integrators verlet --plot-kind order --plot $svg
between "$(slope verlet 2)" 1.9 2.1 "by default a slope of verlet's state error"
exits 0 compare oscillator --integrators verlet --t-end 10 --dt 0.1,0.05,0.025,0.0125 \
    --plot-kind order --plot $svg
texts | grep -q 'a slope needs five steps' || fails "does not say what a slope needs"
texts | grep -q 'verlet: slope' && fails "fits a slope to four steps"
exits 0 compare oscillator --integrators verlet --t-end 1000 --dt 0.2,0.16,0.12,0.09,0.08 \
    --plot-kind order --plot $svg
texts | grep -q '^verlet: slopes [12].[0-9]*, -$' ||
    fails "fits a slope to saturated errors: $(texts | grep ^verlet)"
# Nor where an error changes its sign: the slopes of pairs of steps differ, and the table
# shows none of them as an order.  A slope before rounding stays.
exits 0 compare pendulum --integrators rk4,gauss6 --plot-kind order --plot $svg
between "$(slope rk4 1)" 4.6 5 "a slope of rk4's energy error"
test "$(slope rk4 2)" = " -" || fails "has a slope over a knee: $(slope rk4 2)"
between "$(slope gauss6 2)" 5.8 6.1 "a slope of gauss6's state error"
exits 0 cost oscillator --integrators verlet,rk4 --plot-kind order --plot $svg
between "$(slope verlet 1)" 1.9 2.1 "a slope of verlet's in cost"
exits 2 compare oscillator --dt 0.1 --plot-kind order --plot $svg
says 'needs two steps or more'
exits 2 run oscillator --plot-kind order --plot $svg
says 'is for nevh compare and nevh cost'
exits 2 compare oscillator --plot-kind phase --plot $svg
says 'is order, or not given'

# The energy of steps that adapt is that of their tolerance.
for tolerance in 1e-3 1e-9; do
    exits 0 run kepler --integrator dopri5 --tolerance $tolerance --plot-kind energy \
        --t-end 20 --plot $svg
    grep "fill='none' stroke='#" $svg >$work/curve$tolerance
done
test -s $work/curve1e-3 || fails "draws no curve"
cmp -s $work/curve1e-3 $work/curve1e-9 &&
    fails "draws the energy error of fixed steps for dopri5 under a tolerance"

# Bins are a period or longer where the run has ten: those of verlet, which keeps the
# energy bounded, are level, and their words have their length.
for kind in 'compare pendulum --dt 0.1,0.05' 'run pendulum --plot-kind energy'; do
    exits 0 $kind --integrators verlet --t-end 100 --plot $svg --keep-plot-script $work/out.gp
    awk '/^[$]series/ { here = 1; n = 0; next } /^EOD/ { here = 0; if (n < 10 || high > 1.1*low) bad = 1 }
        here { n++; low = n == 1 || $2 < low ? $2 : low; high = n == 1 || $2 > high ? $2 : high }
        END { exit bad }' $work/out.gp || fails "draws a band"
    length=$(texts | sed -n 's/.*the largest in each \([0-9.]*\) s$/\1/p')
    between "$length" 2.6 4 "bins"
done
exits 0 run pendulum --integrators verlet --plot-kind energy --t-end 20 --dt 0.01 --plot $svg
texts | grep -q 'the largest in each 0.067 s$' || fails "has other bins of seven periods"

# All integrators have a look, each one of its own.
sed -n 's/^    X("\([a-z0-9-]*\)") *\\*$/\1/p' "$srcdir/tools/plot/looks.h" | sort >$work/looks
exits 0 list integrators --format csv
sed -n '/^[a-z]/s/,.*//p' $work/out | sed 1d | sort >$work/names
cmp -s $work/looks $work/names || { fails "integrators and looks differ"; diff $work/looks $work/names; }

# An integrator has one colour in all pictures, whatever stands beside it; eight that
# are often compared have eight.
colour() { # NAME
    awk -v name="<title>$1<" 'index($0, name) { found = 1 }
        found && match($0, /#[0-9A-F]+/) { print substr($0, RSTART, RLENGTH); exit }' $svg
}
often=verlet,rk4,gauss4,midpoint,euler,blanes-moan4,gauss6,gauss8
exits 0 compare oscillator --t-end 10 --dt 0.1 --integrators $often --plot $svg
for name in $(echo $often | tr , ' '); do
    colour $name
done >$work/colours
test "$(sort -u $work/colours | grep -c '#')" = 8 || fails "has other colours: $(cat $work/colours)"
rk4=$(sed -n 2p $work/colours)
# So do those that implicit-euler stands beside.
beside=implicit-euler,verlet,rk4,gauss4,midpoint,euler
exits 0 compare oscillator --t-end 10 --dt 0.1 --integrators $beside --plot $svg
test "$(for name in $(echo $beside | tr , ' '); do colour $name; done | sort -u | wc -l)" = 6 ||
    fails "draws implicit-euler in $(colour implicit-euler)"
for kind in 'compare oscillator --t-end 10 --dt 0.1,0.05' \
    'run oscillator --t-end 10 --plot-kind time' 'run oscillator --t-end 10 --plot-kind energy' \
    'cost oscillator --t-end 10 --budget 1'; do
    exits 0 $kind --integrators gauss4,rk4 --plot $svg
    test "$(colour rk4)" = "$rk4" || fails "draws rk4 in $(colour rk4), not $rk4"
done
# Another step of the same one differs in dashes and marks.
exits 0 run oscillator --t-end 10 --integrators rk4 --dt 0.1,0.05 --plot-kind energy --plot $svg
test "$(colour 'dt = 0.1 s') $(colour 'dt = 0.05 s')" = "$rk4 $rk4" || fails "has other colours"

# Each axis has two numbers or more, also where panels are low.
exits 0 run henon-heiles --plot-kind time --t-end 100 --keep-plot-script $work/out.gp
test "$(grep -c '^set ytics' $work/out.gp)" = 5 || fails "has other panels"
awk '/^set [xy]tics/ && split($0, a, "\"") < 5 { few = 1 } END { exit few }' \
    $work/out.gp || { fails "has a single number at an axis"; grep '^set ytics' $work/out.gp; }
# A level error is a level line in the middle of its axis.
exits 0 run pendulum --plot-kind energy --keep-plot-script $work/out.gp
awk '/^set yrange/ { gsub("[^0-9.e-]", " "); low = $(NF - 1); high = $NF }
    END { middle = sqrt(low * high)
          exit !(high / low > 10 && middle > 0.04 && middle < 0.1) }' $work/out.gp ||
    { fails "has another axis"; grep '^set yrange' $work/out.gp; }
# What is beyond the times that are shown does not stretch the other axis.
exits 0 effects kepler --impact --keep-plot-script $work/out.gp
awk '/^set xrange/ { gsub("[^0-9.e-]", " "); t = $NF }
    /^set yrange/ { gsub("[^0-9.e-]", " "); far = $NF > 2.2*t ? 1 : far }
    END { exit far }' $work/out.gp ||
    { fails "shows what is later"; grep '^set [xy]range' $work/out.gp; }

exits 2 run kepler --plot-kind animation --plot $svg
says 'animation takes --plot FILE.gif'
exits 2 run kepler --plot $work/out.gif
says 'gif is for nevh run --plot-kind animation'
exits 2 run henon-heiles --plot-kind animation --plot $work/out.gif
says 'no .picture. to plot'

command -v gnuplot >/dev/null 2>&1 || { echo "no gnuplot draws a .gif"; exit $((status ? 1 : 77)); }

# An animation: frames of two orbits, each with its time; both begin alike, and at
# the end the one that is not symplectic is elsewhere.
exits 0 run kepler --integrators verlet,rk4 --dt 0.15 --t-end 30 \
    --plot-kind animation --plot $work/out.gif --keep-plot-script $work/out.gp
test "$(head -c 6 $work/out.gif)" = GIF89a || fails "draws no GIF"
test "$(grep -c '^unset multiplot' $work/out.gp)" = 85 ||
    fails "has $(grep -c '^unset multiplot' $work/out.gp) frames"
for t in 0.0 15.0 30.0; do
    grep -q "t = $t" $work/out.gp || fails "has no frame of t = $t"
done
# The bodies are the third and the ninth series of a frame: tracks, bobs and names, and
# the centre's.
awk '/^\$series/ { n = $1 } /^EOD/ { n = "" }
    n == "$series3" && NF == 2 { a = $1; b = $2 }
    n == "$series9" && NF == 2 { frame++; d = sqrt((a - $1)^2 + (b - $2)^2)
        if (frame == 1) first = d }
    END { exit !(frame == 85 && first == 0 && d > 0.3) }' $work/out.gp ||
    fails "draws other orbits"
# Of many turns a few; a run that fails stands still, and is said to.
exits 0 run kepler --plot-kind animation --plot $work/out.gif --quiet
exits 1 run double-pendulum --integrators rk4,midpoint --dt 0.1 --t-end 5 \
    --plot-kind animation --plot $work/out.gif --keep-plot-script $work/out.gp
grep -q 'midpoint, ended at t = [0-9]' $work/out.gp || fails "does not say that it ended"


# Names stand near what they name, and letters can be read at a width of 480 pixels.
exits 0 run outer-solar-system --plot-kind configuration --plot $work/planets.svg
sed -n "s/^<path stroke='#999999' stroke-width='.8' d='M\(.*\) \(.*\)L\(.*\) \(.*\)'.*/\1 \2 \3 \4/p" \
    $work/planets.svg >$work/far
awk '{ d = sqrt(($1 - $3)^2 + ($2 - $4)^2); if (d > 40) exit 1 }' $work/far ||
    fails "puts the name of a planet far from it"
test "$(grep -c '>Jupiter</text>' $work/planets.svg)" = 2 || fails "names no planet"
awk 'NR == 1 { match($0, /viewBox=.0 0 [0-9]+/); width = substr($0, RSTART + 13, RLENGTH - 13) }
    /^<text.*fill=.#444444/ { match($0, /font-size=.[0-9.]+/)
        size = RLENGTH > 0 ? substr($0, RSTART + 11, RLENGTH - 11) : 14
        if (480/width*size < 5.9) bad = 1; notes++ }
    END { exit bad || !notes }' $work/planets.svg || fails "has a note of small letters"
exit $status

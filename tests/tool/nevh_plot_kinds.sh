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
    --dt 0.1,0.05,0.025,0.0125 --plot-kind order --plot $svg
between "$(slope verlet 1)" 1.95 2.05 "a slope of verlet's energy error"
between "$(slope verlet 2)" 1.95 2.05 "a slope of verlet's state error"
between "$(slope rk4 1)" 4.95 5.05 "a slope of rk4's energy error"
between "$(slope rk4 2)" 3.9 4.1 "a slope of rk4's state error"
texts | grep -q 'dopri5' && fails "draws a scheme that chooses its steps"
texts | grep -q 'choose their steps are left out' || fails "does not say so"
# Rounding has no slope: midpoint keeps a quadratic H.
exits 0 compare oscillator --integrators verlet,midpoint --t-end 10 \
    --dt 0.1,0.05,0.025 --plot-kind order --plot $svg
texts | grep -q '^midpoint: slopes -, 2.0' ||
    fails "has another slope of midpoint's: $(texts | grep ^midpoint)"
exits 0 cost oscillator --integrators verlet,rk4 --plot-kind order --plot $svg
between "$(slope verlet 1)" 1.9 2.1 "a slope of verlet's in cost"
exits 2 compare oscillator --dt 0.1 --plot-kind order --plot $svg
says 'needs two steps or more'
exits 2 run oscillator --plot-kind order --plot $svg
says 'is for nevh compare and nevh cost'
exits 2 compare oscillator --plot-kind phase --plot $svg
says 'is order, or not given'

# Each axis has two numbers or more, also where panels are low.
exits 0 run henon-heiles --plot-kind time --t-end 100 --keep-plot-script $work/out.gp
test "$(grep -c '^set ytics' $work/out.gp)" = 5 || fails "has other panels"
awk '/^set [xy]tics/ && split($0, a, "\"") < 5 { few = 1 } END { exit few }' \
    $work/out.gp || { fails "has a single number at an axis"; grep '^set ytics' $work/out.gp; }
# A narrow range of errors is in the middle of its axis.
exits 0 run pendulum --plot-kind energy --keep-plot-script $work/out.gp
awk '/^set yrange/ { gsub("[^0-9.e-]", " "); low = $(NF - 1); high = $NF }
    END { exit !(low > 0.055 && high < 0.073 && high > 0.068) }' $work/out.gp ||
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
test "$(grep -c '^unset multiplot' $work/out.gp)" = 101 ||
    fails "has $(grep -c '^unset multiplot' $work/out.gp) frames"
for t in 0.0 15.0 30.0; do
    grep -q "t = $t" $work/out.gp || fails "has no frame of t = $t"
done
# The bodies are the third and the seventh series of a frame: tracks and bobs, and the
# centre's.
awk '/^\$series/ { n = $1 } /^EOD/ { n = "" }
    n == "$series3" && NF == 2 { a = $1; b = $2 }
    n == "$series7" && NF == 2 { frame++; d = sqrt((a - $1)^2 + (b - $2)^2)
        if (frame == 1) first = d }
    END { exit !(frame == 101 && first == 0 && d > 0.3) }' $work/out.gp ||
    fails "draws other orbits"
# Of many turns a few; a run that fails stands still, and is said to.
exits 0 run kepler --plot-kind animation --plot $work/out.gif --quiet
exits 1 run double-pendulum --integrators rk4,midpoint --dt 0.1 --t-end 5 \
    --plot-kind animation --plot $work/out.gif --keep-plot-script $work/out.gp
grep -q 'midpoint, ended at t = [0-9]' $work/out.gp || fails "does not say that it ended"

exit $status

#!/bin/sh
# Plots: what is in them, and what is said when they cannot be drawn.

. "${srcdir:-.}/tests/support/nevh_support.sh"

gnuplot=
command -v gnuplot >/dev/null 2>&1 && gnuplot=yes
case $nevh in
/*) ;;
*) nevh=$(pwd)/$nevh ;;
esac

draws() {
    exits 0 "$@"
    test -s $work/err && { fails "says something"; cat $work/err; }
}
svg=$work/out.svg
shows() {
    texts | grep -Fqx -e "$1" || { fails "does not show '$1'"; texts; }
}
# series NAME: the drawing of that series.
series() {
    sed -n "/<title>$1<\/title>/,/<\/g>/p" $svg
}

# points N: how many of the series N the script that was kept last has.
points() {
    awk -v name="\$series$1" '$1 == name && $2 == "<<" { on = 1 } /^EOD/ { on = 0 }
        on && NF == 2 { n++ } END { print n + 0 }' $work/out.gp
}

# The errors of two integrators, each at two dt: two panels of one legend.
draws compare pendulum --integrators verlet,rk4,euler --dt 0.1,0.05 \
    --t-end 1000 --plot $svg --keep-plot-script $work/out.gp
has '^ verlet .*bounded$'
shows 'Pendulum released at rest from 2 rad'
shows 'dt = 0.1 s'
shows 'dt = 0.05 s'
shows 't (s)'
shows 'largest |energy error| per bin'
shows 'gradient central4; t = 0 ... 1000 s; errors relative to 4.078 J, the largest in each 3.3 s'
for name in verlet rk4 euler; do
    test "$(texts | grep -cx $name)" = 1 ||
        fails "does not have $name in the legend once"
    test "$(series $name | grep -c '<title>')" = 2 ||
        fails "does not draw $name in both panels"
    test "$(series $name | grep -c '<path ')" = 4 ||
        fails "draws no line of $name, or no marks"
done
# Decades, on one axis of each panel; a legend beside what is drawn.
for decade in -4 -2 0; do
    test "$(texts | grep -cx "10$decade")" = 2 || fails "lacks 10^$decade"
done
shows 1000
if command -v xmllint >/dev/null 2>&1; then
    xmllint --noout $svg || fails "is no XML"
fi
# The largest errors of each while, as the table has them: level for verlet,
# and what rk4 has lost at the end.
awk '/^\$series/ { n++ } n == 1 && NF == 2 { if ($2 > max) max = $2
        if (!min || $2 < min) min = $2 }
    n == 2 && NF == 2 && $1 > 990 { last = $2 } /^EOD/ && n == 2 { exit }
    END { exit !(max > 6.3e-2 && max < 6.5e-2 && min > 0.9 * max &&
        last > 0.21 && last < 0.22) }' $work/out.gp || fails "draws other errors"
test "$(wc -l <$work/out.gp)" -lt 2200 || fails "draws too many points"

# The script draws the same again, from its own data.
if test -n "$gnuplot"; then
    draws compare pendulum --integrators verlet,rk4 --t-end 10 --plot $work/out.png \
        --keep-plot-script $work/again.gp
    mv $work/out.png $work/first.png
    gnuplot $work/again.gp >$work/again 2>&1 || { fails "keeps a script that fails";
        cat $work/again; }
    cmp $work/out.png $work/first.png || fails "keeps a script that draws something else"
    # Many lines: fewer pixels.
    draws run fput --plot $work/many.png --keep-plot-script $work/many.gp
    bytes=$(wc -c <$work/many.png)
    test "$bytes" -le 400000 || fails "draws a picture of $bytes bytes"
    mv $work/many.png $work/first.png
    gnuplot $work/many.gp
    cmp $work/many.png $work/first.png || fails "keeps the script of another size"
    draws compare oscillator --t-end 9 --dt 0.1 --keep-plot-script $work/alone.gp
    gnuplot -e "set terminal dumb" $work/alone.gp | grep -q verlet ||
        fails "keeps a script that draws nothing"
fi

# Narrow: panels one below the other, as high letters within 400 pixels.
draws compare pendulum --t-end 2 --dt 0.1,0.05 --integrators verlet,rk4 --plot-narrow --plot $svg
size=$(sed -n "s/.*viewBox='0 0 \([0-9]*\)[0-9.]* \([0-9]*\).*/\1 \2/p" $svg)
test "${size% *}" -le 400 && test "${size#* }" -gt 600 || fails "draws narrow in $size"
grep -q "font-size='14'" $svg || fails "draws narrow with other letters"
exits 2 compare pendulum --plot-narrow --plot $work/none.png

# A legend has a row for each series, also where a panel is not as high.
draws compare pendulum --t-end 2 --dt 0.1,0.05 --plot $svg --integrators \
    verlet,midpoint,gauss4,gauss6,gauss8,gauss10,gauss12,rk4,euler,pefrl,ruth3,forest-ruth,suzuki4,blanes-moan4,yoshida6,tao2,tao4,dopri5
for name in verlet euler yoshida6 tao4 'dopri5, 1e-12'; do
    test "$(texts | grep -cx "$name")" = 1 ||
        fails "does not have $name in the legend once"
done

# Sections, and work and precision.
draws section damped-driven-pendulum --t-end 4000 --plot $svg \
    --keep-plot-script $work/out.gp -o $work/points.csv
test -s $work/out && fails "prints"
shows 'strobe: every 9.42478'
shows 'phi (rad)'
shows p_phi
shows 'verlet, dt = 0.1; gradient central4; t = 0 ... 4000; H = -1.28007 at the start'
test "$(points 1)" = "$(grep -c '^strobe,' $work/points.csv)" ||
    fails "does not draw each point"
# Larger where they are few.
size() { sed -n 's/.*\$series1 .* pointsize \([0-9.]*\).*/\1/p' $work/out.gp; }
small=$(size)
sed '/^\[ensemble\]/,/^$/d' "$srcdir/scenes/henon-heiles.nevh" >$work/single.nevh
draws section $work/single.nevh --t-end 100 --plot $svg --keep-plot-script $work/out.gp
test "$(cat $work/out)" = \
    "$svg: verlet, dt = 0.2, $(points 1) points; -o FILE writes the rows as CSV" ||
    fails "prints something else"
shows 'verlet, dt = 0.2; gradient central4; t = 0 ... 100; H = 0.125 at the start'
echo "$(size) $small" | awk '{ exit !($1 > 1.5 * $2) }' || fails "draws points of $(size), not above $small"
# The points of one orbit have the colour of its integrator.
grep -q "linetype 4 pointtype 7" $work/out.gp && fails "has the colour of midpoint"
draws section $work/single.nevh --integrators midpoint --t-end 100 --plot $svg \
    --keep-plot-script $work/out.gp
grep -q "linetype 4 pointtype 7" $work/out.gp || fails "has not the colour of midpoint"
# Orbits of an ensemble have a look each, and a key.
draws section henon-heiles --t-end 60 --plot $svg --keep-plot-script $work/out.gp
shows 'verlet, dt = 0.2; gradient central4; t = 0 ... 60; 16 orbits'
test "$(grep -c '^\$series' $work/out.gp)" = 16 || fails "has not 16 series"
test "$(sed -n 's/.* with points \(linetype [0-9]* pointtype [0-9]*\) .*/\1/p' $work/out.gp |
    sort -u | wc -l)" = 16 || fails "has not 16 looks"
for y in -0.4 0 0.2 0.6; do shows "start y = $y"; done
# Few starts: none in the black of a separatrix, and no name of one without a point.
printf '%s\n' '[coordinates]' 'x = 1' '[effects]' 'kinetic = p_x^2/2' \
    'well = x^4/4 - x^2/2' '[sections]' 'middle = when x = 0, rising: t, p_x' '[run]' \
    't_end = 60' 'dt = 0.1' 'integrators = verlet' >$work/well.nevh
draws section $work/well.nevh --vary 'p_x = 1.1, 1.2, 0.1, 1.3, 1.4, 1.5, 1.6' --plot $svg \
    --keep-plot-script $work/out.gp
test "$(texts | grep -c '^start p_x = ')" = 6 || fails "names starts without points"
texts | grep -q '^start p_x = 0\.1$' && fails "names a start without a point"
grep -q 'with points linetype 6' $work/out.gp || fails "draws no fifth start"
grep -q 'with points linetype 5' $work/out.gp && fails "draws a start in black"
draws portrait henon-heiles --integrators verlet,rk4 --t-end 60 --plot $svg
test "$(texts | grep -c '^start y = ')" = 16 || fails "has other starts in another panel"
# One degree of freedom: what crosses is 0 at all points, so time is across.
draws section pendulum --t-end 100 --plot $svg
for text in 'swing: phi = 0, rising' 't (s)' 'p_phi (J s)'; do shows "$text"; done
# A section without points says so, and a picture of none why.
cat >$work/far.nevh <<'END'
[coordinates]
theta = 1, 0
[effects]
kinetic = p_theta^2/2
V = (theta - 0.5)^2/2
[sections]
none = when theta = 2, rising: theta, p_theta
some = when theta = 0.5, rising: theta, p_theta
[labels]
theta = rad
[run]
t_end = 20
dt = 0.01
integrators = verlet
END
draws section $work/far.nevh --plot $svg
shows 'none: theta = 2, rising; no points'
exits 2 section $work/far.nevh --section none --plot $work/none.svg
says 'nothing to plot: section none: 0 points: theta stays in 0 \.\.\. 1 rad$|-[0-9.e-]* \.\.\. 1 rad$'
test -e $work/none.svg && fails "draws nothing to a file"
draws section $work/far.nevh
has '^# section none: 0 points: theta stays in .* 1 rad$'
# A run that fails says with which scheme, once.
cat >$work/fails.nevh <<'END'
[coordinates]
x = 1, 1
[effects]
kinetic = p_x^2/2
V = log(2 - x)
[sections]
s = when x = 5, rising: x, p_x
[run]
t_end = 20
dt = 0.1
integrators = rk4
END
for plot in '' "--plot $work/none.svg"; do
    exits 1 section $work/fails.nevh $plot
    says 'rk4 failed: '
    test "$(wc -l <$work/err)" = 1 || { fails "says more"; cat $work/err; }
done
exits 1 run $work/fails.nevh --plot $svg
says 'rk4 failed after t = '
test "$(wc -l <$work/err)" = 1 || { fails "says more"; cat $work/err; }
exits 1 run $work/fails.nevh --plot $svg --format csv
test "$(wc -l <$work/err)" = 1 || { fails "says more"; cat $work/err; }
# The axis of time ends where a stop ends all runs, and not where only some stop.
printf '%s\n' '[coordinates]' 'y = 1, 3' '[effects]' 'kinetic = p_y^2/2' 'gravity = y' '[run]' \
    't_end = 40' 'dt = 0.05' 'stop = y < 0' 'integrators = verlet, rk4' >$work/ball.nevh
draws compare $work/ball.nevh --plot $svg --keep-plot-script $work/out.gp
grep -q '^set xrange \[0:6\.3[0-9]*\]' $work/out.gp ||
    { fails "has an axis beyond the stop"; grep '^set xrange' $work/out.gp; }
texts | grep -q 't = 0 \.\.\. 6\.3' || fails "names another end"
# Who reads the rows may stop reading.
command="run | head"
for what in run section compare; do
    rm -f $svg
    $limit "$nevh" $what pendulum --t-end 1000 --dt 0.01 --integrators verlet \
        --format csv --plot $svg 2>$work/err | head -n 1 >$work/out
    test -s $svg || fails "lets the reader of $what end the picture"
done
draws cost pendulum --gradient central4 --integrators verlet,rk4 \
    --dt 0.2,0.1,0.05,0.025 --t-end 20 --plot $svg \
    --keep-plot-script $work/out.gp
shows 'CPU time (ms)'
shows 'evaluations of H'
shows 'largest energy error, relative'
shows verlet
test "$(points 1) $(points 4)" = "4 4" || fails "does not draw each run"
# An eighth of the step: 8 times as many H, and 8^4 to 8^5 times less error.
awk '/^\$series2 <</ { getline; t = $1 } /^\$series4 <</ { on = 1 } /^EOD/ { on = 0 }
    on && NF == 2 { if (++n == 1) { h = $1; e = $2 } else { x = $1 / h; y = e / $2 } }
    END { exit !(t != h && h == 1200 && x > 7.9 && x < 8.1 && y > 4e3 && y < 4e4) }' $work/out.gp ||
    fails "draws other numbers"
test "$(grep -c '^set logscale [xy]' $work/out.gp)" = 4 ||
    fails "has axes that are not logarithmic"
# Exact gradients take no H: both panels have all curves all the same, on axes
# that begin where these do, and the line of an order.
draws cost pendulum --integrators verlet,rk4,gauss4 --dt 0.2,0.1,0.05 \
    --t-end 20 --plot $svg --keep-plot-script $work/out.gp
shows 'evaluations of the gradient'
shows 'gradient exact; t = 0 ... 20 s; errors relative to the scale of the energy'
shows 'order 2'
shows 'order 4'
for k in 1 2 3 4 5 6; do
    test "$(points $k)" = 3 || fails "does not draw the series $k"
done
texts | grep -q 'left out' && fails "leaves out steps that evaluate less"
awk '/^\$series/ { panel = $1 > "$series3" } NF == 2 && /^[0-9]/ {
        if (!low[panel] || $1 < low[panel]) low[panel] = $1 }
    /^set xrange/ { sub(/.*\[/, ""); begin = $0 + 0; x = low[n++]
        bad += !(begin <= x && begin > x / 2.51) }
    END { exit bad || n != 2 }' $work/out.gp || fails "has axes that begin elsewhere"
# Without --integrators, too, where schemes that take H alone are not shown.
draws cost oscillator --t-end 5 --plot $svg
shows 'evaluations of the gradient'
# A step that costs as much as a shorter one, which errs less, is not drawn.
draws cost pendulum --integrators gauss4 --dt 1.25,0.8,0.5,0.4 --t-end 100 \
    --plot $svg --keep-plot-script $work/out.gp
test "$(points 2)" = 2 || fails "draws $(points 2) steps of 4"
texts | grep -q 'are left out$' || fails "does not say so"

# The V of truncation, order 2 or 4, and of rounding, order -1, over the step;
# the steps that nevh chooses are near its bottom.
draws gradients pendulum --t-end 10 --dt 0.1 --integrators verlet --plot $svg \
    --gradient central2,central4,complex-step --keep-plot-script $work/out.gp
has '^ central4 '
for text in central2 central4 'complex-step: below 1e-17' 'slope 2' 'slope 4' \
    'half-spread of the differences' 'largest error of the gradient'; do
    test "$(texts | grep -cxF -e "$text")" = 1 || { fails "lacks '$text'"; texts; }
done
texts | grep -q 'against the exact gradient' || fails "does not say against what"
curve() {
    k=$(sed -n "s/.*\$series\([0-9]*\) using 1:2 .* title \"$1\".*/\1/p" $work/out.gp)
    awk -v name="\$series$k" '$1 == name && $2 == "<<" { on = 1; next } /^EOD/ { on = 0 }
        on && NF == 2' $work/out.gp
}
for order in 2 4; do
    curve central$order >$work/curve
    awk -v order=$order '{ x[++n] = $1; e[n] = $2; if (!low || $2 < low) { low = $2; at = $1 } }
        function slope(a, b,  i, k) {
            for (i = 1; x[i] < a; i++); for (k = i; x[k] < b; k++)
            ; return log(e[k] / e[i]) / log(x[k] / x[i]) }
        END { up = slope(30 * at, 0.1); down = slope(1e-11, at / 30)
            exit !(up > order - 0.1 && up < order + 0.1 && down > -1.1 && down < -0.9) }' \
        $work/curve || fails "draws another curve of central$order"
done
# Rounding does not show what is exact: quadratic functions.
draws gradients oscillator --gradient central2 --plot $svg --keep-plot-script $work/out.gp
texts | grep -q slope && fails "draws a slope where there is none"
exits 2 gradients oscillator --gradient complex-step --plot $svg
says 'nothing to plot: all values are 0'
exits 2 effects pendulum --plot $svg
says 'nevh effects draws with --impact --plot '

# Orbits: an angle that goes round stays within its period, lines end there.
# Where there is a picture rows are for files, and the picture says what it is.
draws run pendulum-rotating --t-end 50 --dt 0.05 --every 1 --plot $svg \
    --keep-plot-script $work/out.gp -o $work/rows.csv
test -s $work/out && fails "prints"
shows 'phi (rad)'
shows 'p_phi (J s)'
shows 'verlet, dt = 0.05 s; gradient central4; t = 0 ... 50 s; circle: the start; H = 22.2 J at the start'
grep -q '^set xrange \[-3.14159265359:3.14159265359\]' $work/out.gp ||
    fails "shows another range"
rounds=$(awk -F, '/^[0-9]/ { t = int(($2 + 3.14159265) / 6.2831853)
    n += t != last; last = t } END { print n }' $work/rows.csv)
breaks=$(awk '/^\$series2 <</ { on = 1 } /^EOD/ { on = 0 } on && NF == 0 { n++ }
    END { print n }' $work/out.gp)
test $rounds -gt 40 || fails "goes round $rounds times"
test "$rounds" = "$breaks" || fails "wraps $breaks times, not $rounds"
test "$(points 3)" = 1 || fails "does not show the start"
test "$(points 1)" -gt 5000 || fails "does not draw the reference"
draws run kepler --t-end 5 --dt 0.05 --plot-kind energy --plot $svg
shows '|energy error|, relative'
test "$(cat $work/out)" = "$svg: verlet, dt = 0.05; -o FILE writes the rows as CSV" ||
    fails "prints something else"
draws run kepler --t-end 50 --dt 0.05 --plot-kind energy --plot $svg --quiet
test -s $work/out && fails "is not quiet"
shows 'largest |energy error| per bin'
texts | grep -q '; errors relative to 0.5, the largest in each 0.17$' ||
    fails "does not say what a point is"
draws run pendulum --t-end 5 --plot $svg --format csv
has '^t,phi,p_phi,'
draws run fput --plot-kind time --t-end 2000 --plot $svg
for text in mode1 mode2 mode3 mode4; do shows "$text"; done
draws run fput --t-end 5 --plot $svg
texts | grep -q '; the first 4 of 32 coordinates: --columns chooses others$' ||
    fails "does not say what is left out"
test "$(texts | grep -c '^p_x\[')" = 8 || fails "has other panels"
draws run fput --t-end 5 --plot $svg --columns 'x[7],x[1]:x[2]'
for text in 'x[7]' 'p_x[7]' 'x[1]' 'x[2]'; do shows "$text"; done
exits 2 run fput --t-end 5 --plot $svg --columns 'x[1]:x[2]:x[3]'
says 'takes --columns A:B'

# Against time: each column its panel, joined ones share it; a curve for each
# scheme, and the exact solution where there is one.
draws run oscillator-paper --plot-kind time --columns x,p_x,energy --plot $svg \
    --keep-plot-script $work/out.gp --integrators verlet,rk4
for text in 'x (m)' 'p_x (J s/m)' 'energy (J)' 't (s)' 'exact solution' \
    verlet rk4 'dt = 0.02 s; gradient central2; t = 0 ... 3 s'; do
    test "$(texts | grep -cxF -e "$text")" = 1 || { fails "lacks '$text'"; texts; }
done
# cos and sin of the paper's Figure 2, in all three series of both panels.
awk 'function near(a, b, by) { return a - b < by && b - a < by }
    /^\$series[0-9]+ <</ { k = substr($1, 8) + 0; next } /^EOD/ { k = 0 }
    k && k < 7 && NF == 2 { n[k]++; w = 6.283185307179586; by = k % 3 == 2 ? 0.02 : k % 3 == 1 ? 1e-9 : 1e-4
        bad += !near($2, k < 4 ? cos(w * $1) : -w * sin(w * $1), (k < 4 ? 1 : w) * by) }
    k > 6 && NF == 2 { bad += !near($2, 19.7392088, 0.1); n[k]++ }
    END { for (k = 1; k < 10; k++) bad += n[k] < 150; exit bad > 0 }' $work/out.gp ||
    fails "draws other curves"
draws run oscillator-paper --plot-kind time --columns x:p_x --samples 31 \
    --plot $svg --keep-plot-script $work/out.gp
shows 'x (m), p_x (J s/m)'
test "$(points 3) $(points 4)" = "31 31" || fails "draws other rows"
awk '/series[34] using/ { n += / with points linetype [12] / } END { exit n != 2 }' \
    $work/out.gp || fails "does not draw points"
# What has no curve, ended early, or is outside, is told; the energy from its start.
tells() {
    text=$1
    shift
    "$nevh" "$@" --plot $svg >$work/out 2>$work/err
    command=$*
    texts | grep -Fq -e "$text" || { fails "does not tell '$text'"; texts; }
}
tells 'failed: tao4, dt = 0.02' compare double-pendulum-chaotic --dt 0.02 --t-end 5 \
    --integrators tao4,gauss4
tells 'verlet ended at t = 3.8' run henon-heiles --start p_x=2 --plot-kind time
tells 'outside: verlet, Halley' run earth-halley --plot-kind configuration
tells 'energy change' run fput --plot-kind time
tells 'sum of areas' flow henon-heiles --t-end 10 --integrators verlet
# Curves of one colour differ by their dashes.
draws run kepler --integrators rk4,pefrl --dt 0.1 --t-end 6 --plot-kind time --plot $svg
test "$(grep -c 'stroke-dasharray' $svg)" -ge 5 || fails "draws rk4 and pefrl alike"

# A run of 375 swings is cut, and says so; unless its end is asked for.
draws run pendulum --plot-kind time --plot $svg
shows 'verlet, dt = 0.1 s; gradient central4; t = 0 ... 20 s; a part of the run: --t-end 1000 shows all'
for text in 'phi (rad)' 'p_phi (J s)' 'energy (J)'; do shows "$text"; done
draws run pendulum --plot-kind time --plot $svg --t-end 1000 --columns phi
shows 'verlet, dt = 0.1 s; gradient central4; t = 0 ... 1000 s'
# So is a phase plane of more steps than are kept: of some it has lines.
draws run kepler-0.9 --plot $svg --keep-plot-script $work/out.gp
texts | tr '\n' ' ' | grep -q 't = 0 ... 50; .*a part of the run: --t-end 628.319 shows all' ||
    { fails "does not cut the run"; texts; }
grep -q '^ *\$series2 using 1:2 with lines\|plot \$series2 using 1:2 with lines' $work/out.gp ||
    fails "draws dots"
# What the scene shows, where there are many coordinates.
draws run sun-earth-moon --plot-kind time --plot $svg --t-end 1 --without moon

shows 'height'
texts | grep -q '^distance (10.* km)$' || fails "does not show the distance"
shows 'verlet, dt = 0.002 year; gradient central4; t = 0 ... 1 year'
texts | grep -q 'but without moon' || fails "does not say what is off"
# Elements of an array have the names of their bodies.
draws run sun-earth-moon --plot-kind time --columns x[2],p_x[2] --plot $svg --t-end 1
texts | grep -q '^x\[2\], Earth (AU)$' || { fails "does not name the Earth"; texts; }
texts | grep -q '^p_x\[2\] (' || fails "names a momentum after a body"
# What steps keep beside what they do not, of the schemes of which it is known.
draws run pendulum --plot-kind time --t-end 5 --plot $svg --integrators verlet,rk4 \
    --columns energy_error,shadow_error --keep-plot-script $work/out.gp
texts | grep -q '^error of shadow H' || fails "does not name the shadow"
exits 0 run pendulum --plot-kind time --t-end 5 --plot $svg --integrators verlet \
    --columns energy_error:shadow_error --keep-plot-script $work/out.gp
awk '/^\$series[0-9]+ <</ { k++; on = 1; next } /^EOD/ { on = 0 }
    on && NF == 2 { v = $2 < 0 ? -$2 : $2 + 0; if (v > most[k]) most[k] = v }
    END { exit !(k == 3 && most[2] > 0.05 && most[3] < 0.002 && most[3] > 1e-4) }' \
    $work/out.gp || fails "draws another shadow"
exits 2 run pendulum --plot-kind time --t-end 5 --integrators rk4 --plot $svg \
    --columns shadow_error
says 'shadow H: its series is known for .*, not for rk4$'
exits 2 run pendulum --plot-kind time --columns phj --plot $svg
says 'unknown column phj; did you mean phi'
exits 2 run damped-driven-pendulum --plot-kind time --columns energy_error --plot $svg
says 'plot-kind energy'
exits 2 run pendulum --columns phi --plot-kind energy --plot $svg
says 'columns is for'
test -s $work/out && fails "runs before it looks at the columns"

# Rods and bobs are where the last row says; between steps there are points.
draws run double-pendulum --t-end 5 --dt 0.02 --plot-kind configuration \
    --plot $svg --keep-plot-script $work/out.gp -o $work/rows.csv
for text in 'bob 1' 'bob 2' 'x (m)' 'y (m)'; do shows "$text"; done
texts | grep -q 't = 0 ... 5 s; circles: the start; discs: t = 5 s$' ||
    fails "does not say when"
test "$(points 1)" -gt 2000 || fails "does not draw the reference"
test "$(points 10)" -gt 2000 || fails "does not draw the trail"
# Circles about the pivot, chords of which do not show.
awk '/^\$series(1|10) <</ { on = 1; n = 0; next } /^EOD/ { on = 0 }
    on { r = $1 * $1 + $2 * $2; bad += r < 0.99999 || r > 1.00001
        d = ($1 - x) ^ 2 + ($2 - y) ^ 2; bad += n++ && d > 0.01; x = $1; y = $2 }
    END { exit bad > 0 }' $work/out.gp || fails "draws chords"
awk '/ using 1:2 with lines/ && !/dashtype solid/ { bad++ } END { exit bad > 0 }' \
    $work/out.gp || fails "draws dashed trails"
awk -F, '/^t,/ { for (i = 1; i <= NF; i++) if ($i == "x1") k = i }
    /^[0-9]/ { for (i = 0; i < 4; i++) last[i] = $(k + i) }
    END { printf("%.6f %.6f\n%.6f %.6f\n", last[0], last[1], last[2], last[3]) }
    ' $work/rows.csv >$work/rows
awk '/^\$series1[79] <</ { getline; printf("%.6f %.6f\n", $1, $2) }' \
    $work/out.gp >$work/drawn
cmp $work/rows $work/drawn || fails "draws bobs elsewhere"
awk '/^\$series1[23] <</ { getline; print }' $work/out.gp >$work/drawn
printf '1 -6.12323399573677e-17\n1 -1\n' | cmp - $work/drawn ||
    { fails "draws starts elsewhere"; cat $work/drawn; }
# Bobs have the colour of the integrator that moves them; those of the reference, and the
# fixed centre, are grey.
draws run kepler --t-end 5 --plot-kind configuration --integrators gauss4 --plot $svg
for colour in '1 #009E73' '3 #999999'; do
    test "$(grep -c "stroke='${colour#* }'.*stroke-linecap='round'" $svg)" = ${colour% *} ||
        fails "draws not ${colour% *} bodies in ${colour#* }"
done
grep -q '#0072B2' $svg && fails "has a colour that is no integrator's here"
# Names of bobs, and axes by what places them.
draws run sun-earth-moon --t-end 1 --plot-kind configuration --plot $svg
for text in Sun Earth Moon 'x (AU)' 'y (AU)'; do shows "$text"; done
sed 's/^bob = x\[\(.\)\], y.*/bob = x[\1], z[\1]/' $NEVH_SCENES/sun-earth-moon.nevh \
    >$work/side.nevh
draws run $work/side.nevh --t-end 1 --plot-kind configuration --plot $svg
for text in 'body 3' 'x (AU)'; do shows "$text"; done
texts | grep -q '^z (.*AU)$' || fails "names another axis"
# A unit is as long on both axes, also where the picture is wide.
draws run figure-eight --t-end 7 --dt 0.05 --plot-kind configuration \
    --plot $svg --keep-plot-script $work/out.gp
awk '/^set [xy]range/ { gsub("[^0-9.e xyrange-]", " "); l[substr($2, 1, 1)] = $4 - $3 }
    /^set [lrbt]margin/ { m[substr($2, 1, 1)] = $5 }
    /^set terminal/ { split($5, size, ",") }
    END { x = l["x"] / (m["r"] - m["l"]) / size[1]
          y = l["y"] / (m["t"] - m["b"]) / size[2]
          exit !(x / y > 0.999 && x / y < 1.001) }' $work/out.gp ||
    fails "distorts the picture"
# A panel for the reference and each scheme, which have the same range.
draws run kepler --t-end 20 --integrators verlet,rk4 --plot-kind configuration \
    --plot $svg --keep-plot-script $work/out.gp
for text in 'exact solution' verlet rk4; do shows "$text"; done
test "$(grep '^set [xy]range' $work/out.gp | sort | uniq -c | awk '{ print $1 }' | tr '\n' ' ')" = '3 3 ' ||
    fails "has other ranges"
draws run henon-heiles --t-end 20 --integrators verlet,rk4 --plot $svg
for text in reference verlet rk4; do shows "$text"; done
test "$(grep -c "stroke='#dddddd'" $svg)" = 6 || fails "has other panels"
exits 2 run henon-heiles --plot-kind configuration --plot $svg
says 'no \[picture\]'
test -s $work/out && fails "runs before it looks for a picture"
exits 2 run pendulum --plot-kind portrait --plot $svg
says 'phase, time, energy, configuration, animation or order'
exits 2 run pendulum --plot - --format csv
says 'with -o'

if test -n "$gnuplot"; then # other media; files are there when they are whole
    exits 0 run pendulum --t-end 5 --plot -
    has 'p_phi'
    exits 0 run pendulum -o $work/rows.csv --t-end 5 --plot -
    has 'p_phi'

    for medium in png pdf; do
        draws compare oscillator --t-end 9 --dt 0.1 --plot $work/x.$medium
        head -c 4 $work/x.$medium | tr -d '\211' |
            grep -aqi "^%\{0,1\}$medium" || fails "draws no $medium"
    done
    test "$(echo $work/x.p*)" = "$work/x.pdf $work/x.png" ||
        fails "leaves other files"
    # gnuplot does not notice a full device.
    for medium in png pdf svg; do
        test -c /dev/full || break
        ln -s /dev/full $work/full.$medium
        exits 2 compare oscillator --t-end 9 --dt 0.1 --plot $work/full.$medium
        says "full.$medium|/dev/full cannot be written"
    done
    draws compare oscillator --t-end 9 --dt 0.1 --quiet --plot -
    has '^ +1e-16 '
    has '\*verlet *$'
    lacks '^.{81}.*[*#|]'
    lacks "$(printf '\f')"
    COLUMNS=120 draws compare oscillator --t-end 9 --dt 0.1 --quiet --plot -
    has '^.{105,120}$'
    lacks '^.{121}.*[*#|]'
fi

# Texts are no more than texts.
cat >$work/weird.nevh <<'END'
[scene]
title = '' it's y'' `touch HERE` "$(touch HERE)" {/S a}_b^2 %d \n <b>&ACUTE @x \
[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
spring = x^2/2
[labels]
t = ''y'_r''\
[run]
t_end = 1
dt = 0.1
integrators = verlet
END
acute=$(printf '\303\251') # in UTF-8
sed -i.old "s/ACUTE/$acute/" $work/weird.nevh
line=$(printf 'two\nlines.svg')
for name in "it's.svg" "''.svg" "$line" '|touch touched;.svg' '$(touch touched) `touch touched`.svg'; do
    (cd $work && NEVH_SCENES= && "$nevh" compare weird.nevh --plot "$name" \
        --keep-plot-script weird.gp >out 2>err) || { fails "fails at $name";
        cat $work/err; }
    test -s "$work/$name" || fails "does not draw $name"
    svg=$work/drawn.svg
    mv "$work/$name" $svg
    shows "'' it's y'' \`touch HERE\` &quot;\$(touch HERE)&quot; {/S a}_b^2 %d \\n &lt;b&gt;&amp;$acute @x \\"
    shows "t (''y'_r''\\)"
    test -n "$gnuplot" || continue
    (cd $work && gnuplot weird.gp 2>err) || fails "keeps a script that fails"
    test -s "$work/$name" || fails "keeps a script that draws elsewhere"
done
test -e $work/HERE && fails "ran a title"
test -e $work/touched && fails "ran the name of a file"

# A long title has a second line.
sed "s/^title *= .*/title = $(printf 'word%s ' 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18)/" \
    $NEVH_SCENES/oscillator.nevh >$work/words.nevh
svg=$work/out.svg
draws run $work/words.nevh --t-end 9 --plot $svg
test "$(texts | grep '^word' | tr '\n' ' ')" = \
    "$(printf 'word%s ' 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18)" ||
    { fails "cuts the title"; texts; }

# Wrong use is told before anything runs.
before=$(ls $work)
for name in plot.gif plot svg ''; do
    exits 2 compare pendulum --plot "$name"
    says 'FILE\.svg'
done
exits 2 compare pendulum --plot $work/nowhere/x.svg
says 'nowhere/x\.svg cannot be written: No such file'
test -s $work/out && fails "runs before it looks at the file"
exits 2 compare pendulum --keep-plot-script $work/nowhere/x.gp
says 'nowhere/x\.gp cannot be written'
test -s $work/out && fails "runs before it looks at the script's file"
mkdir $work/folder.svg
exits 2 compare pendulum --plot $work/folder.svg
says 'folder\.svg cannot be written'
rmdir $work/folder.svg
exits 2 compare pendulum --plot $work/x.svg -o $work/x.svg
says 'same name'
exits 2 compare pendulum --plot $work/x.svg --keep-plot-script $work/x.svg
says 'same name'
exits 2 compare pendulum --plot - --format csv
says 'with -o'
exits 2 check pendulum --plot $work/x.svg
says 'no option of nevh check'
test "$(ls $work)" = "$before" || fails "leaves files: $(ls $work)"
exits 2 compare double-pendulum --integrators verlet --t-end 1 --plot $work/x.svg
says 'nothing to plot'
exits 2 compare pendulum --without gravity --t-end 1 --plot $work/x.svg
says 'nothing to plot: all values are 0'
has '^ verlet '
test -e $work/x.svg && fails "draws nothing to a file"

# gnuplot is missing, or fails, at once or at the end.
mkdir $work/bin
fake() {
    printf '#!/bin/sh\n%s\n' "$1" >$work/bin/gnuplot
    chmod +x $work/bin/gnuplot
}
fakes() {
    command="compare with a gnuplot that does: $1"
    PATH=$(pwd)/$work/bin $limit "$nevh" compare oscillator --t-end 9 \
        --dt 0.1 --plot $work/fake.png >$work/out 2>$work/err </dev/null
    code=$?
    test $code = 2 || { fails "exit status $code"; cat $work/err; }
    test "$(wc -l <$work/err)" = 1 || { fails "says more"; cat $work/err; }
    test "$(echo $work/fake*)" = "$work/fake*" || fails "leaves a file"
}
limit= # is not in that PATH
# In the build tree nevh may be a script of libtool's, which needs these.
for tool in sh sed ls cat expr basename dirname uname mv rm mkdir chmod printf; do
    found=$(command -v $tool) && test -x "$found" &&
        ln -s "$found" $work/bin/$tool
done
fakes 'not exist'
says 'gnuplot-nox'
test -s $work/out && fails "runs before it looks for gnuplot"
fake 'echo "  what is" >&2; echo this? >&2; exit 1'
fakes 'exit 1'
says 'gnuplot failed \(exit status 1\): what is this\?$'
test -s $work/out && fails "runs before it tries gnuplot"
fake 'exec <&-; test "$1" = --version'
fakes 'not read'
says 'gnuplot failed \(exit status 1\)$'
has 'verlet'
fake 'exit 0'
fakes 'draw nothing'
says 'gnuplot drew nothing'
fake 'test "$1" = --version || echo "PNG"'
fakes 'draw a part, as where the disk is full'
says 'gnuplot drew nothing, or a part'
fake 'test "$1" = --version || kill -9 $$'
fakes 'die'
says 'signal 9'
fake 'test "$1" = --version && exit; while read x; do echo $x >&2; done; exit 3'
fakes 'talk much'
says 'exit status 3\): set terminal pngcairo'
# A name that is too long for its axis is cut, its factor is not.
cat >$work/long.nevh <<'END'
[coordinates]
displacement_of_the_first_mass_from_rest = 1e-9, 0
displacement_of_the_second_mass_from_rest = 2e12, 0
[effects]
kinetic = p_displacement_of_the_first_mass_from_rest^2/2 + p_displacement_of_the_second_mass_from_rest^2/2
springs = displacement_of_the_first_mass_from_rest^2/2 + displacement_of_the_second_mass_from_rest^2/2
[labels]
displacement_of_the_first_mass_from_rest = furlong per fortnight
[run]
t_end = 10
dt = 0.1
END
draws run $work/long.nevh --plot-kind time --keep-plot-script $work/out.gp
for label in 'displ[a-z_]*\.\.\. (10⁻⁹ furl' 'displacement[a-z_]*\.\.\. (10¹²)'; do
    grep -q "^set ylabel \"$label" $work/out.gp ||
        { fails "has no label $label"; grep '^set ylabel' $work/out.gp; }
done

# The reference has its peaks, however narrow they are: p_y = sqrt(1.99/0.01) at the
# pericentre.  The third series is p_y of the reference.
draws run kepler --set e=0.99 --integrators gauss8 --dt 0.001 --t-end 13 \
    --plot-kind time --columns x,p_y --plot $svg --keep-plot-script $work/out.gp
awk '/^\$series/ { n++; most = 0 } /^EOD/ { if (n == 3) peak = most }
    NF == 2 && $1 > 1 && $2 > most { most = $2 }
    END { exit !(peak > 14.1) }' $work/out.gp || fails "cuts the peaks of the reference"

# It begins with short steps, too, where the run is of hundreds of periods, and it ends
# where the scene's stop says.
printf '%s\n' '[coordinates]' 'x = -0.3' '[effects]' 'kinetic = p_x^2/2' \
    'morse = 4.6*(1 - exp(-1.9*x))^2' '[run]' 't_end = 300' 'dt = 0.05' >$work/morse.nevh
draws run $work/morse.nevh --integrators gauss4 --plot $svg --keep-plot-script $work/out.gp
awk '/^\$series/ { n = 0 } /^-?[0-9]/ && n++ == 1 && ($2 > 0.5 || $2 < -0.5) { exit 1 }' \
    $work/out.gp || fails "begins with a chord"
printf '%s\n' '[coordinates]' 'y = 1.5' 'v_y = 20' '[effects]' 'kinetic = p_y^2/2' \
    'gravity = 9.81*y' '[run]' 't_end = 10' 'dt = 0.1' 'stop = y < 0' >$work/ball.nevh
draws run $work/ball.nevh --integrators gauss4 --plot-kind time --columns y --plot $svg \
    --keep-plot-script $work/out.gp
awk 'NF == 2 && $2 < -2 { exit 1 }' $work/out.gp || fails "goes on after the stop"

# An energy that changes with the time or friction is labelled so; momenta have units.
draws run damped-driven-pendulum --plot-kind time --plot $svg --t-end 20
shows 'energy, not conserved'
draws run pendulum --plot-kind time --plot $svg --t-end 20
shows 'energy (J)'
draws run sun-earth-moon --plot-kind time --columns p_x[1] --plot $svg --t-end 1
texts | grep -q '^p_x\[1\] (.*solar mass AU/year)$' || fails "has no unit of p_x[1]"

exit $status

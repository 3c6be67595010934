#!/bin/sh
# --data: measured points as rows with residuals, and over pictures.

. "${srcdir:-.}/tests/support/nevh_support.sh"

truth='l=0.874,g=9.812,gamma=0.035,start=1.13'
exits 0 run pendulum-filmed --set $truth --data pendulum-filmed.csv
has '^# measured: 121 points of x, y in pendulum-filmed.csv'
has '^t,phi,p_phi,x,y,energy,x_residual,y_residual$'
test "$(grep -c '^[0-9]' $work/out)" = 121 || fails "has not a row a point"
has '^# rms of the residuals of x: 0\.0040?[0-9]* m \(121 points\)$'
# Residuals are what is measured less the orbit; the rms is theirs.
cp $work/out $work/rows
awk -F, '/^#/ { next } FILENAME ~ /filmed.csv/ && $1 != "t" { x[n++] = $2; next }
    /^[0-9]/ { d = x[m++] - $4 - $7; if (d*d > 1e-20) exit 1; s += $7*$7 }
    END { r = sqrt(s/m); if (m != 121 || r < 0.003 || r > 0.005) exit 1 }' \
    "$srcdir/scenes/pendulum-filmed.csv" $work/rows || fails "has other residuals"
# A wrong length is seen in them.
exits 0 run pendulum-filmed --set l=0.9,g=9.812,gamma=0.035,start=1.13 \
    --data pendulum-filmed.csv
has '^# rms of the residuals of x: 0\.[1-9]'
# So is a time after the end.
exits 0 run pendulum-filmed --set $truth --data pendulum-filmed.csv --t-end 4
has '^# left out, after the end: 60 points'
exits 0 run pendulum-filmed --set $truth --data pendulum-filmed.csv --format json
has '"x_residual"'
has 'rms of the residuals of y'
# Columns that the scene does not know are told, and left out.
printf 't,x,frame\n0,0.8,1\n1,0,2\n' >$work/frames.csv
exits 0 run pendulum-filmed --data $work/frames.csv
has '^# left out, the scene has none of that name: frame$'
has 'energy,x_residual$'

# held FILE: how many of the measured points of a script are within the axes.  They have a
# mark, and a colour, that no integrator has.
held() {
    awk 'NR == FNR && /^set [xy]range/ {
            split($3, r, ":"); low[$2] = substr(r[1], 2) + 0; high[$2] = r[2] + 0 }
        NR == FNR && /title "measured"/ && /pointtype 1 / && /rgb .#000000/ {
            match($0, /[$]series[0-9]+/)
            name = substr($0, RSTART, RLENGTH) }
        NR == FNR { next }
        /^[$]series/ { here = $1 == name; next }
        /^EOD/ { here = 0 }
        here && $1 >= low["xrange"] && $1 <= high["xrange"] &&
            $2 >= low["yrange"] && $2 <= high["yrange"] { n++ }
        END { print n + 0 }' "$1" "$1"
}
exits 0 run pendulum-filmed --set $truth --data pendulum-filmed.csv \
    --plot-kind time --plot $work/time.svg --keep-plot-script $work/time.gp
grep -q 'measured' $work/time.gp || fails "draws no points"
test "$(grep -c '0.787520\|0\.78752' $work/time.gp)" -ge 1 ||
    fails "draws other points"
exits 0 run pendulum-filmed --set $truth --data pendulum-filmed.csv \
    --plot-kind phase --columns x:y --keep-plot-script $work/phase.gp
grep -q 'measured' $work/phase.gp || fails "draws no points"
# Those of a wrong length are beyond the curve, and none is cut off.
exits 0 run pendulum-filmed --data pendulum-filmed.csv \
    --plot-kind phase --columns x:y --keep-plot-script $work/phase.gp
test "$(held $work/phase.gp)" = 121 || fails "cuts points off: $(held $work/phase.gp) of 121"
# One that is far off does not stretch the axes, and is counted.
awk -F, -v OFS=, 'NR == 30 { $2 = 25 } { print }' "$srcdir/scenes/pendulum-filmed.csv" \
    >$work/outlier.csv
for kind in 'phase --columns x:y' time; do
    exits 0 run pendulum-filmed --data $work/outlier.csv --plot-kind $kind \
        --keep-plot-script $work/outlier.gp
    awk '/^set [xy]range/ { split($3, r, ":"); if ($2 == "yrange" || !time)
            if (r[2] + 0 > most) most = r[2] + 0 }
        END { exit !(most > 0 && most < 2) }' time=$(test "$kind" = time && echo 1 || echo 0) \
        $work/outlier.gp || fails "stretches an axis of $kind to an outlier"
    grep -q 'measured outliers are outside' $work/outlier.gp || fails "does not say so"
done
exits 2 run pendulum-filmed --data pendulum-filmed.csv --plot-kind phase \
    --keep-plot-script $work/none.gp
says 'plot-kind phase draws over each other'
printf 't,phi,p_phi\n0,1,0.1\n1,0.5,-2.1\n' >$work/plane.csv
exits 0 portrait pendulum-small --data $work/plane.csv \
    --keep-plot-script $work/portrait.gp
test "$(held $work/portrait.gp)" = 2 || fails "cuts points off"
exits 2 portrait pendulum-small --data $work/frames.csv \
    --keep-plot-script $work/none.gp
says 'no column is one of the scene|takes columns phi and p_phi'
printf 'start,period(swing)\n0.5,2.04\n1,2.14\n1.5,2.33\n' >$work/periods.csv
exits 0 sweep pendulum --vary 'start = range(0.2, 2, 10)' --dt 0.02 --t-end 20 \
    --outcomes 'period(swing)' --data $work/periods.csv \
    --picture $work/periods.svg --keep-plot-script $work/periods.gp
grep -q 'measured' $work/periods.gp || fails "draws no points"
grep -q 'rms of the residuals: 0\.00' $work/periods.gp ||
    fails "does not say how far the points are"
sed 's/2.33/2.5/' $work/periods.csv >$work/wrong.csv
exits 0 sweep pendulum --vary 'start = range(0.2, 2, 10)' --dt 0.02 --t-end 20 \
    --outcomes 'period(swing)' --data $work/wrong.csv \
    --picture $work/periods.svg --keep-plot-script $work/periods.gp
grep -q 'rms of the residuals: 0\.\(09\|1\)' $work/periods.gp ||
    fails "does not see a point that is far off"
exits 2 sweep pendulum --vary 'start = range(0.2, 2, 10)' --dt 0.02 --t-end 20 \
    --outcomes 'period(swing)' --data $work/frames.csv --picture $work/x.svg
says 'no column is one of these: start, period'
exits 2 sweep pendulum --vary 'start = 1, 2' --data $work/frames.csv
says 'over a --picture'
exits 2 run pendulum-filmed --data pendulum-filmed.csv --samples 5
says 'leave out --every'
exits 2 run pendulum-filmed --data pendulum-filmed.csv --plot-kind energy \
    --keep-plot-script $work/none.gp
says 'time or phase'
exits 2 run pendulum-filmed --data $work/missing.csv
says 'cannot be read'
exit $status

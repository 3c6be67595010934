#!/bin/sh
# nevh fit: numbers found from points with noise, their errors, and what it
# refuses.

. "${srcdir:-.}/tests/support/nevh_support.sh"

rows() { grep -v '^#' $work/out | tail -n +2; }
near() { # COLUMN NAME VALUE MOST
    rows | awk -F, -v c="$1" -v name="$2" -v x="$3" -v most="$4" '
        $4 == name { d = $c - x; found = d < most && d > -most }
        END { exit !found }' || fails "$2 is not $3 within $4"
}

# Numbers whose squares overflow, and angles without digits, had residuals of 0.
printf 't,p_phi\n0,1\n1,1e308\n2,1\n' >$work/large.csv
exits 2 fit pendulum --data $work/large.csv --vary g --dt 0.05
says 'large.csv:3: column p_phi: the square of 1e308 overflows'
printf 't,phi\n0,1\n1,1e308\n2,1\n' >$work/large.csv
exits 2 fit pendulum --data $work/large.csv --vary g --dt 0.05
says 'large.csv:3: column phi: 1e308 is so many turns'

# What the manual says, from the points that ship; they are what makes them.
sh "$srcdir/examples/filmed.sh" "$nevh" ./examples/add_noise >$work/made.csv ||
    fails "filmed.sh fails"
paste -d, "$srcdir/scenes/pendulum-filmed.csv" $work/made.csv |
    awk -F, '/^[0-9]/ { for (i = 1; i <= 3; i++) {
        d = $i - $(i + 3); if (d*d > 1e-11) wrong = 1 } n++ }
        END { exit wrong || n != 121 }' || fails "the points are others"
exits 0 fit pendulum-filmed --data pendulum-filmed.csv --vary l,g,gamma,start \
    --format csv
near 6 l 0.874 0.001
near 6 g 9.812 0.012
near 6 gamma 0.035 0.0012
near 6 start 1.13 0.003
# Within four errors, which are those that the noise makes.
rows | awk -F, 'BEGIN { t["l"] = 0.874; t["g"] = 9.812; t["gamma"] = 0.035
        t["start"] = 1.13 }
    { z = ($6 - t[$4])/$7; if (z*z > 16 || $8 > $6 || $9 < $6) exit 1 }' ||
    fails "is not within its errors"
test "$(grep -v '^#' $work/out | head -n 1)" = \
    scene,integrator,dt,parameter,start,value,error,low,high,residuals,degrees_of_freedom,chi_square,reduced_chi_square,correlation_l,correlation_g,correlation_gamma,correlation_start,tolerance,scheme_error ||
    fails "has other columns"
exits 0 fit pendulum-filmed --data pendulum-filmed.csv --vary l,g,gamma,start \
    --sigma 0.004
has '242 residuals, 238 degrees of freedom: chi-square 2[0-9][0-9]'
has '^ g +9\.81'
lacks 'as large as sigma says'

# A lack of an effect is seen in chi-square; so is a sigma that is too large.
exits 0 fit pendulum-filmed --data pendulum-filmed.csv --vary l,g,start \
    --sigma 0.004 --without drag
has 'times as large as sigma says'
exits 0 fit pendulum-filmed --data pendulum-filmed.csv --vary l,g,start,gamma \
    --sigma 0.1
has 'sigma is too large'

# Points without noise: all digits, whatever is first; far away a turn ahead
# would be a minimum of its own.
"$nevh" run pendulum --dt 0.05 --t-end 20 --samples 101 --integrators gauss8 \
    --quiet >$work/angle.csv
exits 0 fit pendulum --data $work/angle.csv --columns phi --vary g,start --dt 0.05 \
    --integrators gauss8 --set g=6.5 --format csv
near 6 g 9.8 1e-8
near 6 start 2 1e-8
# From afar: the minimum that explains the data is found, or the exit status says that
# none was; the same model without its force explains nothing.
for g in 40 100; do
    exits 0 fit pendulum --data $work/angle.csv --columns phi --vary g --dt 0.05 \
        --integrators gauss8 --set g=$g --format csv
    near 6 g 9.8 1e-6
done
exits 1 fit pendulum --data $work/angle.csv --columns phi --vary phi --dt 0.05 \
    --integrators gauss8 --without gravity
says 'the fit does not explain the data: its residuals have [0-9]+ % of their spread'
has '^ phi '
# Points that have nothing to do with the model: a word, which as much noise beside a
# signal does not get.
noise() {
    awk -v signal="$1" 'BEGIN { print "t,x"; s = 42
        for (i = 0; i < 40; i++) { s = s*16807 % 2147483647
            printf "%g,%.6f\n", i/4, s/1073741824 - 1 + signal*cos(i/4) } }' >$work/noise.csv
}
printf '[parameters]\nk = 1.05\n[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = k*x^2/2
[run]\nt_end = 10\ndt = 0.01\n' >$work/spring.nevh
for signal in 0 1; do
    noise $signal
    exits 0 fit $work/spring.nevh --data $work/noise.csv --vary k,x,p_x
    test "$(grep -c 'no better than their mean' $work/out)" -eq $((1 - signal)) ||
        { fails "words on a signal of $signal"; cat $work/out; }
done
# Angles are compared modulo their period.
awk -F, '/^#/ { next } /^t/ { print "t,phi"; next }
    { printf "%s,%.17g\n", $1, $2 + 6.283185307179586*(NR % 3) }' $work/angle.csv >$work/turned.csv
exits 0 fit pendulum --data $work/turned.csv --vary g --dt 0.05 \
    --integrators gauss8 --set g=9 --format csv
near 6 g 9.8 1e-8
sed '/^#/d' $work/out >$work/turned
# Rows come in any order, after the mark that spreadsheets put before UTF-8.
{ printf '\357\273\277t,phi\n'; sed 1d $work/turned.csv | sort -t , -k 1,1 -nr; } >$work/sorted.csv
exits 0 fit pendulum --data $work/sorted.csv --vary g --dt 0.05 \
    --integrators gauss8 --set g=9 --format csv
sed '/^#/d' $work/out | cmp -s - $work/turned || fails "depends on the order"
# Starts: an angle, a momentum, a velocity.
exits 0 fit pendulum --data $work/angle.csv --vary phi,v_phi --dt 0.05 --columns phi,x \
    --integrators gauss8 --start phi=1.8,v_phi=0.2 --format csv
near 6 phi 2 1e-8
near 6 v_phi 0 1e-8
# Deviations of each point: those that lie far off do not count.
awk -F, '/^#/ { next } /^t/ { print "t,phi,sigma_phi"; next }
    NR % 7 == 0 { print $1 ",5,1e9"; next } { print $1 "," $2 ",1e-3" }' \
    $work/angle.csv >$work/weights.csv
exits 0 fit pendulum --data $work/weights.csv --vary g --dt 0.05 \
    --integrators gauss8 --set g=9.5 --format csv
near 6 g 9.8 1e-6
sed 's/1e9/1e-3/' $work/weights.csv >$work/even.csv
exits 0 fit pendulum --data $work/even.csv --vary g --dt 0.05 --integrators gauss8 \
    --format csv
rows | awk -F, '{ d = $6 - 9.8; exit d*d < 1e-6 }' ||
    fails "finds g among points that lie far off"

# The angle of a plain pendulum knows g/l alone.  As the manual has it:
exits 0 run pendulum --dt 0.05 --t-end 20 --samples 101 --integrators gauss8 \
    --quiet -o $work/angle.csv
exits 1 fit pendulum --data $work/angle.csv --columns phi --vary l,g --dt 0.05
says 'not determined by these data: l, g: where they change together, l by 1 % and g by 1 %, nothing that was measured changes'
exits 1 fit pendulum --data $work/angle.csv --columns phi --vary g,m --dt 0.05
says 'not determined by these data: m, which changes nothing'
# The place of its bob knows both.
exits 0 fit pendulum --data $work/angle.csv --columns x --vary l,g --dt 0.05
exits 0 fit pendulum --data $work/angle.csv --columns x --vary l,g --dt 0.05 \
    --set l=0.9,g=9.3 --integrators gauss8 --format csv
near 6 l 1 1e-8
near 6 g 9.8 1e-7

# The intervals of 20 draws; bench/fit.sh takes 400, of more systems.  The scheme of
# the second is of order 2, and its error is 40 times that of the noise.
for case in 'filmed 4e-3' 'anharmonic 1e-4'; do
    sh "$srcdir/bench/fit.sh" "$nevh" ./examples/add_noise 20 $case >$work/out ||
        { command="fit.sh"; fails "intervals do not hold the truth"; cat $work/out; }
done

# Much noise: k and F of a driven spring lie along a curved valley, with other minima
# far away, also where the drive is too fast for these points; the first draw has the
# lowest sum at k = 3.7, the second at w = 2e5.
sh "$srcdir/bench/fit.sh" scene driven >$work/driven.nevh || fails "there is no scene"
"$nevh" run $work/driven.nevh --samples 61 --integrators gauss8 --quiet >$work/driven.csv
for seed in 24 36; do
    ./examples/add_noise 0.1 $seed x <$work/driven.csv | sed 2d >$work/draw.csv
    exits 0 fit $work/driven.nevh --data $work/draw.csv --vary k,F,w --set k=0.98,F=0.28,w=0.61 \
        --format csv
    rows | awk -F, 'BEGIN { t["k"] = 1; t["F"] = 0.3; t["w"] = 0.6 }
        { x = t[$4]; n += ($8 == "" || $8 <= x) && ($9 == "" || x <= $9) }
        END { exit n != 3 }' || fails "seed $seed: intervals do not hold the truth"
done
# Ends are where the least sum of squares, with that number held, has risen by what the
# quantile of Student's distribution makes of its variance: 2.0025^2/57 of itself.
./examples/add_noise 0.1 1 x <$work/driven.csv | sed 2d >$work/draw.csv
exits 0 fit $work/driven.nevh --data $work/draw.csv --vary k,F,w --format csv
rows >$work/whole
for column in 8 9; do
    end=$(awk -F, -v c=$column '$4 == "k" { print $c }' $work/whole)
    exits 0 fit $work/driven.nevh --data $work/draw.csv --vary F,w --set k=$end --format csv
    { head -n 1 $work/whole; rows; } | awk -F, 'NR == 1 { least = $12 }
        NR == 2 { d = ($12/least - 1)*57/2.0025^2 - 1; exit !(d < 0.03 && d > -0.03) }' ||
        fails "k = $end is no end"
done
exits 0 fit $work/driven.nevh --data $work/draw.csv --vary k,F,w
has 'ends are where it has'

# A scheme whose error is small beside the noise is kept, and a note says so; where it
# is not, what is to be typed next has the finer one.
"$nevh" run pendulum --integrators gauss8 --samples 61 --dt 0.05 --t-end 6 --quiet |
    ./examples/add_noise 0.01 1 phi >$work/noise.csv
exits 0 fit pendulum --data $work/noise.csv --vary g --set g=9.5 --dt 0.01 --integrators gauss4
has '^integrator: gauss4, dt = 0.01$'
has 'error of gauss4 with dt = 0.01 changes g by [0-9.e-]+ of its error'
exits 0 fit pendulum --data $work/noise.csv --vary g --set g=9.5 --dt 0.1 --integrators verlet
has '^integrator: dop853'
has 'error of verlet with dt = 0.1 would change g by [0-9.e+]+ of its errors'
has '--integrators dop853 --dt 1.6 --tolerance 1e-12'
lacks 'residuals of phi are alike'
# Residuals that are no noise are told where sigma is unknown, too.
exits 0 fit pendulum-filmed --data pendulum-filmed.csv --vary l,g,start --without drag
has 'residuals of x are alike'

refuses() { # WHAT TEXT, options
    printf "$2" >$work/bad.csv
    what=$1
    shift 2
    exits 2 fit pendulum --data $work/bad.csv --vary g "$@"
    says "$what"
}
refuses 'is empty' ''
refuses 'has no rows' 't,phi\n'
refuses 'bad.csv:1: there is no column t' 'phi\n1\n'
refuses 'no column is one of the scene' 't,psi\n0,1\n'
refuses 'has no column x' 't,phi\n0,2\n1,1\n' --columns x
refuses 'the scene has no psi' 't,psi\n0,2\n1,1\n' --columns psi
refuses 'bad.csv:3: column phi: a value is missing' 't,phi\n0,2\n1,\n'
refuses 'bad.csv:3: column phi: "two" is no number' 't,phi\n0,2\n1,two\n'
refuses 'bad.csv:3: column phi: "nan" is no number' 't,phi\n0,2\n1,nan\n'
refuses 'bad.csv:3: 1 values, and there are 2 columns' 't,phi\n0,2\n1\n'
refuses 'there are two columns phi' 't,phi,phi\n0,2,2\n'
refuses 'a standard deviation is above 0' 't,phi,sigma\n0,2,0\n'
refuses 'no standard deviation' 't,phi,x,sigma_x\n0,2,1,1\n'
refuses 'sigma_y: there is no column y' 't,phi,sigma_y\n0,2,1\n'
refuses 'before the run begins' 't,phi\n-1,2\n1,2\n'
refuses 'too few' 't,phi\n0,2\n'
refuses 'no point is after the start' 't,phi\n0,2\n0,2.1\n'
refuses 'standard deviations of its own' 't,phi,sigma\n0,2,1\n1,1,1\n' --sigma 1
exits 2 fit pendulum --data $work/none.csv --vary g
says 'cannot be read: No such file'
exits 2 fit pendulum --data /dev/zero --vary g
says '/dev/zero cannot be read: it is no text'
exits 2 fit pendulum --vary g
says 'takes --data'
exits 2 fit pendulum --data $work/angle.csv --vary g=1
says 'takes names alone'
exits 2 fit pendulum --data $work/angle.csv --vary g,q
says 'q'
exits 2 fit pendulum --data $work/angle.csv --vary g,g
says 'stands there twice'
exits 2 fit pendulum --data $work/angle.csv --vary g --sigma -1
says 'above 0'
# No orbit: a length below 0 under a root.
cat >$work/root.nevh <<'END'
[parameters]
l = 1
[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
spring = x^2/2*sqrt(l - 2)^2
[run]
t_end = 5
dt = 0.05
END
exits 2 fit $work/root.nevh --data $work/angle.csv --vary l
says 'spring'
# A number that runs away: the message says where to.
printf 't,x\n1,0\n2,0\n3,0\n' >$work/nothing.csv
printf '[parameters]\nk = 1\n[coordinates]\nx = 0\n[effects]\nK = p_x^2/2\n%s\n' \
    'V = x/log(3 + k^2)
[run]
t_end = 3
dt = 0.05
integrators = verlet' >$work/away.nevh
exits 1 fit $work/away.nevh --data $work/nothing.csv --vary k --sigma 1e-3
says 'does not converge: after 100 iterations it is at k = [0-9.]+e\+[0-9]+ \(from 1\), with residuals of rms [0-9.]+ standard deviations; begin nearer'

# Each number is assigned where it begins, which changes the scene: a velocity
# that depends on time is that at the start all the same.  glibc fills freed
# memory with this byte.
cat >$work/push.nevh <<'END'
[parameters]
k = 1
[coordinates]
x = 0.5
p_x = 0.25
[effects]
kinetic = (p_x - sin(t))^2/2
spring = k*x^2/2
[run]
t_start = 2
t_end = 9
dt = 0.05
END
exits 0 run $work/push.nevh --samples 20 --format csv --quiet
cut -d, -f 1,2 $work/out >$work/push.csv
MALLOC_PERTURB_=165
GLIBC_TUNABLES=glibc.malloc.tcache_count=0
export MALLOC_PERTURB_ GLIBC_TUNABLES
exits 0 fit $work/push.nevh --data $work/push.csv --vary x,v_x --format csv --quiet
unset MALLOC_PERTURB_ GLIBC_TUNABLES
awk -F, '$4 == "v_x" { exit !(($5 - (0.25 - sin(2)))^2 < 1e-20) }' $work/out ||
    fails 'does not begin with the velocity at the start'

# What is to be typed next runs what was fitted, also where a shell would read
# names otherwise.
cp $srcdir/scenes/pendulum.nevh "$work/it's a scene.nevh"
exits 0 run pendulum --set m=2,g=9.5 --dt 0.05 --t-end 4 --samples 30 --format csv --quiet
cut -d, -f 1,2 $work/out >"$work/some data.csv"
exits 0 fit "$work/it's a scene.nevh" --data "$work/some data.csv" --vary g --set m=2 \
    --integrators blanes-moan4 --dt 0.01 --t-end 5
next=$(sed -n '/^Next:$/{ n; s/^  nevh //; s/ --plot-kind time --plot -$//p; }' $work/out)
eval "exits 0 $next --format csv"
has '^# integrator: blanes-moan4'
has '^# .*dt = 0\.01'
has '^# .*m=2, g=9\.5'
has '^4,'

# Points that lie farther apart than half a period, 0.497 here, do not tell one
# frequency from another.
printf '%s\n' '[parameters]' 'k = 40' '[coordinates]' 'x = 1' '[effects]' 'K = p_x^2/2' \
    'V = k*x^2/2' '[run]' 't_end = 20' 'dt = 0.02' 'integrators = gauss8' >$work/swing.nevh
for gap in 0.45 0.55; do
    exits 0 run $work/swing.nevh --at "$(awk "BEGIN {
        for (t = $gap; t < 20; t += $gap) printf \"%s%.6g\", n++ ? \",\" : \"\", t }")" \
        --format csv --quiet
    cut -d, -f 1,2 $work/out >$work/swing.csv
    exits 0 fit $work/swing.nevh --data $work/swing.csv --vary k --set k=39.8
    cp $work/out $work/gap.$gap
done
grep -q 'half a period' $work/gap.0.55 || fails "does not say that points are too few"
grep -q 'half a period' $work/gap.0.45 && fails "says that enough points are too few"
exit $status

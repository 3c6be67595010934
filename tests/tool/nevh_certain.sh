#!/bin/sh
# nevh reference: digits that are certain.

. "${srcdir:-.}/tests/support/nevh_support.sh"

exits 0 reference pendulum --at 1
if test $status != 0; then
    says 'libquadmath'
    exit 77
fi

# states T SCENE LINES...: what a Gauss method of order 16 found in arithmetic of 113
# bits, without nevh's code, from starts that are these doubles.
states() {
    t=$1 scene=$2
    shift 2
    exits 0 reference $work/$scene.nevh --at $t --format csv --quiet
    sed 1d $work/out | cut -d, -f 3 >$work/found
    printf '%s\n' "$@" >$work/known
    # Those are rounded after 25 digits, which trailing zeros may hide.
    awk 'NR == FNR { known[FNR] = $1; next }
        { x = known[FNR]; y = $1
          sub(/^-/, "", x); sub(/^-/, "", y)
          if (substr(x, 1, 23) != substr(y, 1, 23)) { print x, y; bad = 1 } }
        END { exit bad || FNR != length(known) }' $work/known $work/found ||
        fails 'has other digits'
}
scene() {
    printf '[coordinates]\n%b\n[effects]\nH = %s\n' "$2" "$3" >$work/$1.nevh
}
scene pend 'q = 2' 'p_q^2/2 - cos(q)'
states 100 pend 1.982325653157030515982941 0.1796407425909401978724921
scene dpend 'q1 = 1.5707963267948966\nq2 = 0' '(p_q1^2 + 2*p_q2^2 - 2*p_q1*p_q2*cos(q1 - q2))/(2*(1 + sin(q1 - q2)^2)) - 9.8*(2*cos(q1) + cos(q2))'
states 10 dpend 0.1137118256716568201221664 -2.223609077492791711139523 \
    -3.802044137210631439898684 1.721351498235191875262862
scene kep06 'x = 0.4\ny = 0\np_y = 2' '(p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)'
states 100 kep06 -0.1041832044342322840550464 -0.6947417155679742850149844 \
    1.23617776268706369627367 0.564623251085780902059137
scene hh 'x = 0\ny = 0.1\np_x = 0.49057789051960615' \
    '(p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3'
states 100 hh 0.1329957183343852788967454 0.3760189573811590740470609 \
    0.2953954457827294417819349 -0.1606396034768338961890406

# Numbers that follow from parameters have all their digits, too: products of
# masses, and functions that have no series but are of numbers.
cat >$work/oss.nevh <<'END'
[parameters]
G = 2.95912208286e-4
m[1..6] = 1.00000597682, 0.000954786104043, 0.000285583733151, 0.0000437273164546, 0.0000517759138449, 7.692307692307693e-09
[coordinates]
x[1..6] = 0, -3.5023653, 9.0755314, 8.3101420, 11.4707666, -15.5387357
y[1..6] = 0, -3.8169847, -3.0458353, -16.2901086, -25.7294829, -25.2225594
z[1..6] = 0, -1.5507963, -1.6483708, -7.2521278, -10.8169456, -3.1902382
p_x[1..6] = 0.0, 5.398637520229294e-06, 4.806888279651002e-07, 1.548725348725732e-07, 1.4959614787206956e-07, 2.1286538461538464e-11
p_y[1..6] = 0.0, -3.938397200566971e-06, 1.3808687457183727e-06, 5.995102540558569e-08, 5.9297400849148624e-08, -1.3130923076923078e-11
p_z[1..6] = 0.0, -1.8197172878345132e-06, 5.496401644970776e-07, 2.4062704971801837e-08, 2.0543129336240974e-08, -1.0500307692307693e-11
[effects]
T = sum(i = 1..6, (p_x[i]^2 + p_y[i]^2 + p_z[i]^2)/(2*m[i]))
V = -G*sum(i = 1..5, j = i+1..6, m[i]*m[j]/sqrt((x[i] - x[j])^2 + (y[i] - y[j])^2 + (z[i] - z[j])^2))
END
states 100000 oss \
    0.6197224011858143216272708 -0.6106288694610207692516514 \
    0.4154657294164806136767304 19.28017600753897417753974 \
    -29.32441074107549684618195 14.12135343202440494682271 \
    -0.2483636156271377760225118 -5.007131633628507869589254 \
    8.072758790294459409242097 6.371859337367577259512124 \
    3.35566363371025127398574 -28.71152633143566508547563 \
    -0.1245068149012286598375582 -2.133588958789222417679572 \
    3.325166069868792064696923 2.511511051876684488211745 \
    2.096386578642025867813791 -13.07958855928588184700005 \
    1.01749079352602288319858e-06 6.929673621889382917505871e-06 \
    -1.6779076233638732187307e-06 -6.234320287395418551160788e-08 \
    -2.31200469481360437981481e-08 2.277524805648961117674917e-11 \
    -1.200251470970392554919066e-06 -1.16435159852500525247491e-06 \
    -6.469943797736365656328389e-08 1.393273026014214002240993e-07 \
    -1.483247854426252022274806e-07 6.830797024223976618475534e-12 \
    -6.067627579910039099424878e-07 -6.665994325864636938858454e-07 \
    4.613166587113910613817603e-08 6.1890815527705011017908e-08 \
    -6.013736049178447400991621e-08 -4.719666677169497642915039e-12
# cos(100 sqrt(2*0.1*0.7)) of the doubles 0.1 and 0.7.
scene numbers 'x = 1' 'p_x^2/(2*m) + abs(-k)*(l*m)*x^2*sqrt(4)/2 + 0*min(k, l)*floor(2.5)'
sed -i '1i [parameters]\nm = 0.9\nk = 0.1\nl = 0.7' $work/numbers.nevh
exits 0 reference $work/numbers.nevh --at 100 --digits 30 --format csv --quiet
has '^100,x,0\.9603509600125637737820292029'

# One series from rest; and a damped orbit, whose rate is a formula, beside that of
# a scheme.
exits 0 reference oscillator --at 2 --digits 16 --format csv --quiet
has '^2,x,-0\.4161468365471424,16'
exits 0 reference damped-driven-pendulum --at 2 --digits 16 --format csv --quiet
phi=$(awk -F, '$2 == "phi" { print $3 }' $work/out)
exits 0 run damped-driven-pendulum --integrators taylor --tolerance 1e-15 --at 2 \
    --t-end 2 --format csv --quiet
tail -n 1 $work/out | awk -F, -v phi=$phi '{ d = $2 - phi; exit !(d * d < 1e-26) }' ||
    { fails "phi is not $phi"; cat $work/out; }

# A momentum whose series begins at a zero and is asked for at the next has no
# digits there; the coordinate has all.
exits 0 reference oscillator --set k=1 --at pi --digits 30 --format csv --quiet
has '^3.14159265358979323846264338328,x,-1\.0*,30,'
has '^3.14159265358979323846264338328,p_x,,0,'

# Fewer digits of a chaotic orbit, and it says so.
exits 0 reference double-pendulum-chaotic --at 2,40
has 'From t = 40 on at least [0-9]* digits are certain, not all '
exits 0 reference double-pendulum-chaotic --at 40 --format csv --quiet
awk -F, 'NR > 1 && $4 < 20 { fewer++ } END { exit fewer != 4 }' $work/out ||
    fails 'claims digits of chaos'

exits 0 reference kepler --at 1 --digits 5 --format csv --quiet
awk -F, 'NR > 1 && length($3) > 9 { exit 1 }' $work/out || fails 'has more digits'

# At an equilibrium steps round nothing: the rounding of the start alone grows.
scene upright 'x = pi' 'p_x^2/2 - cos(x)'
exits 0 reference $work/upright.nevh --at 1,60 --format csv --quiet
has '^1,x,3.14159265358979323846264,24,'
has '^60,p_x,,0,'
awk -F, '$1 == 60 && $2 == "x" && $4 <= 8 { found = 1 } END { exit !found }' $work/out ||
    fails 'is certain of rounding'

# Numbers that nearly cancel have no more digits than rounding leaves of them: where
# they start an orbit, and where they are in H, before jumps too.  (sqrt(2)^2 - 2)*1e30 is
# 0 in truth.
digits() { awk -F, 'NR > 1 { print $4 }' $work/out | xargs; }
# certain SCENE T VARIABLE LEAST MOST WHAT: has so many digits of the variable, or else is
# certain of WHAT.
certain() {
    exits 0 reference $work/$1.nevh --at $2 --format csv --quiet
    awk -F, -v name=$3 -v least=$4 -v most=$5 '$2 == name { n++; bad = $4 < least || $4 > most }
        END { exit bad || n != 1 }' $work/out || { fails "is certain of $6"; cat $work/out; }
}
scene start 'x = (sqrt(2)^2 - 2)*1e30, 1' 'p_x^2/2 + x^2/2'
certain start 3 x 0 4 'what cancels'
exits 0 reference $work/start.nevh --at 3
has 'difference of nearly equal numbers in the scene'
for factor in 'log(1 + 1e-30)*1e30' '1 + (1 + 1e-34)^1e34' '1 + sin(1e30*pi)' \
    '2 + sign(sin(pi))' '1 + max(0, sin(pi))*1e35' '1 + floor(1 - 1e-40)' \
    '1e40 + 1 - 1e40 + 1' 'mod(3*(1/3), 1)' '1 + exp(50) - exp(50)*(1 + 1e-34)'; do
    scene factor 'x = 0.3, 0' "p_x^2/2 + x^2/2*($factor)"
    certain factor 3 x 0 12 "$factor"
done
# By a parameter, and by one made of another.
scene indirect 'x = 0.3, 0' 'p_x^2/2 + x^2/2*floor(a)'
sed -i '1i [parameters]\nb = 1e-40\na = 1 - b' $work/indirect.nevh
exits 0 reference $work/indirect.nevh --at 3 --format csv --quiet
test "$(digits)" = '0 0' || fails 'is certain of a parameter that is rounded'
# Contrast: what does not matter, or does not cancel, costs no digits.
for factor in '1 + cos(pi/2)' '(sqrt(2) + 1/3)^2' 'floor(2.5)' '1 - 2^-40' 'sqrt(4) - 1' \
    'mod(3, 2)' 'sign(-pi)*-1'; do
    scene factor 'x = 0.3, 0' "p_x^2/2 + x^2/2*($factor)"
    exits 0 reference $work/factor.nevh --at 3 --format csv --quiet
    test "$(digits)" = '24 24' || fails "has too few digits of $factor"
done
scene start 'x = sin(pi), 1' 'p_x^2/2 + x^2/2'
exits 0 reference $work/start.nevh --at 3 --format csv --quiet
has '^3,x,0\.141120008059867222100745,24,'
exits 2 reference $work/start.nevh --at '(sqrt(2)^2 - 2)*1e34'
says 'nearly equal numbers leaves too few digits'

# Poles of even order in time, which a rounding turns into 1/((t - 1)^2 + 1e-26), have
# nothing behind them, however many digits are asked for.
for pole in '-2*(t - 1)*p_x*x^2' '-4*(t - 1)^3*p_x*x^2'; do
    scene pole 'x = 1, 0.5' "$pole"
    for digits in 3 10 20 24 30; do
        exits 1 reference $work/pole.nevh --at 3 --digits $digits
        says 'the solution itself ends at t = 1, '
    done
    certain pole 0.75 x 24 24 'less than there is'
done
# Contrast: the same, 1e-12 higher.
scene pole 'x = 1/(1 + 2^-40), 0' '-2*(t - 1)*p_x*x^2'
exits 0 reference $work/pole.nevh --at 3 --digits 24 --format csv --quiet
has '^3,x,0\.2499999999999432,16,'

# A force that is below all doubles where the orbit starts: x^12 from 0, in other units
# (1e5*x)^12; and one that stays below them.
scene twelve 'x = 0, 1e-30' 'p_x^2/2 + x^12'
exits 0 reference $work/twelve.nevh --at 1e27 --format csv --quiet
has '^1e\+?27,x,-6\.765622356903'
scene scaled 'x = 0, 1' 'p_x^2/2 + (1e5*x)^12'
exits 0 reference $work/scaled.nevh --at 1e-3 --format csv --quiet
has '^0\.001[0-9]*,x,-6\.765622356903'
scene sixty 'x = 0, 1e-30' 'p_x^2/2 + x^60'
exits 0 reference $work/sixty.nevh --at 3e30 --digits 25 --format csv --quiet
has ',x,0\.0335048317381948'
scene free 'x = 0, 1e-65' 'p_x^2/2 + x^6/6'
exits 0 reference $work/free.nevh --at 1e23 --format csv --quiet
has ',x,9\.9999999999999983925[0-9]*e-43,24,'
scene tiny 'x = 1e-307, 0' 'p_x^2/2 + x^2/2'
exits 0 reference $work/tiny.nevh --at 3
has 'numbers below 1e-308 have lost theirs'
exits 0 reference $work/tiny.nevh --at 3 --format csv --quiet
test "$(digits)" = '0 0' || fails 'is certain of what underflows'
scene tiny 'x = 1e-200, 0' 'p_x^2/2 + x^4/4'
exits 0 reference $work/tiny.nevh --at 1e201 --format csv --quiet
test "$(digits)" = '0 0' || fails 'is certain of what underflows'
scene tiny 'x = 1\ny = 800\nz = 700' 'p_x^2/2 + x*exp(-y)*exp(z)'
certain tiny 1 p_x 0 0 'what underflows'
# Contrast: what underflows beside it does not matter.
scene tiny 'x = 1e-200, 0' 'p_x^2/2 + x^2/2 + x^4/4'
exits 0 reference $work/tiny.nevh --at 3 --format csv --quiet
has '^3,x,-9\.899924966004454[0-9]*e-201,24,'
scene pulse 'x = 0' 'p_x^2/2 - x*exp(-(t - 20)^2)'
exits 0 reference $work/pulse.nevh --at 40 --format csv --quiet
has '^40,p_x,1\.772453850905516027298[0-9]*,24,'

# Numbers that differ, though their roundings are alike: sqrt(2) and sqrt(2 + 1e-15).
printf '%s\n' '[parameters]' 'a = sqrt(2)' 'b = sqrt(2.000000000000001)' '[coordinates]' \
    'x = 1' '[effects]' 'H = p_x^2/2 + a*x - b*x' >$work/alike.nevh
certain alike 1 p_x 14 19 'a difference'
has '^1,p_x,3\.140184917367549[78][0-9]*e-16,'
# Jumps and extremes that lie between the ends of what rounding leaves.
for start in 'mod(exp(80), 1)' 'cos(2*pi*mod(2^114*pi, 1))' 'exp(-(1e36*(sqrt(2)^2 - 2))^2)' \
    '1/cosh(1e37*(sqrt(2)^2 - 2))'; do
    scene hidden "x = $start" 'p_x^2/2'
    certain hidden 1 x 0 0 "$start"
done
# Rounding within H of the first series, which both runs would share: exp(x) - 1 - x is
# 5e-29 of 1, and 1^11 - 1 none at rest.  No digit but those of the leading terms.
scene first 'x = 1e-14, 0' 'p_x^2/2 + exp(x) - x - x^2/2'
certain first 1 p_x 2 5 'rounding in H'
scene first 'x = 1, 0' 'p_x^2/2 + x^12/12 - x'
certain first 1 p_x 0 0 'rounding at rest'
certain first 1 x 23 24 'too little at rest'
# Fields that nearly cancel: a tidal force, two logarithms.
scene first 'x = 1, 0\ny = 0.5, 0' '(p_x^2 + p_y^2)/2 - 1e36*(1/hypot(x - 1e12, y) - x/1e12^2)'
certain first 1 x 17 22 'a tidal force'
has '^1,x,2\.17818355661084072[0-9]*,'
scene first 'x = 1, 0' 'p_x^2/2 - 1e12*(log(x + 3) - log(x + 3 + 1e-12))'
certain first 1 p_x 16 22 'two logarithms'
has '^1,p_x,0\.062177249273262034[0-9]*,'
# A pericentre of 5e-13: pairs of doubles end there, and quad precision goes on.
scene near 'x = 1, 0\ny = 0, 1e-6' '(p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)'
certain near 1.12 x 11 24 'too little after a close pericentre'
# Momenta of velocities that differ by many powers of ten, and that hardly depend on them.
scene speeds 'x = 0\ny = 0\nv_x = 1\nv_y = 1e-17' 'p_x^2/2 + 3*p_y^2/2'
exits 0 reference $work/speeds.nevh --at 1 --format csv --quiet
has '^1,p_y,3\.33333333333333357180808e-18,24,'
scene fast 'x = 0\nv_x = 0.99999999999999' 'sqrt(1 + p_x^2)'
certain fast 1 p_x 17 21 'a steep momentum'
has '^1,p_x,7073895\.38088254651'
# A node that is rounding takes no digits from the rest; two times that are one double.
scene node 'x = 1, 0\ny = sin(pi), 0' 'p_x^2/2 + p_y^2/2 + x^2/2 + y^2/2'
exits 0 reference $work/node.nevh --at 1 --format csv --quiet
has '^1,x,0\.54030230586813971740093[67],24,'
scene free 'x = 0, 1e10' 'p_x^2/2'
exits 0 reference $work/free.nevh --at '1/3,1/3+1e-18' --format csv --quiet
has ',x,3333333333\.33333333333333,'
has ',x,3333333333\.33333334333333,'
# One number for all: a range that doubles and more digits give differently is refused.
printf '%s\n' '[parameters]' 'N = floor(0.7*10)' '[coordinates]' 'x = 1' '[effects]' \
    'H = p_x^2/2 + sum(i = 1..N, x^2)/2' >$work/range.nevh
exits 2 reference $work/range.nevh --at 1
says '7 as a double and 6 with more digits'
# A force that jumps in time ends no solution.
scene jumps 'x = 1, 0' 'p_x^2/2 + x*floor(t + 0.5)'
exits 1 reference $work/jumps.nevh --at 1
grep -q 'solution itself' $work/err && fails 'ends a solution at a jump'

# What is refused.
exits 2 reference pendulum --digits 31
says '1 to 30'
exits 2 reference pendulum --at -1
says 'before it begins'
exits 2 reference pendulum --dt
for option in '--dt 0.1' '--integrators verlet' '--gradient exact' --portable; do
    exits 2 reference pendulum --at 1 $option
    says 'is no option of nevh reference'
done
# Digits up to the kink, which the orbit meets at t = sqrt(2), and none behind it.
scene wall 'x = 1' 'p_x^2/2 + abs(x)'
exits 0 reference $work/wall.nevh --at 1
has '^ *1 +x +0\.5'
exits 1 reference $work/wall.nevh --at 1.5
says 'abs'
scene fall 'x = 1' 'p_x^2/2 - 1/x'
exits 1 reference $work/fall.nevh --at 3
says 'no reference at t = 3'

# What would take too long is refused early, with how long; the parts that an
# orbit is gone in do not change it.
exits 1 reference pendulum --at 1,1e12 --stop-after 0.5
says 't = 1e\+12 takes about [0-9.]+e\+0?[6-9] s .* more than the 0.5 s of --stop-after'
exits 1 reference pendulum --at 1e300 --stop-after 0.5
says 't = 1e\+300 takes about'
exits 0 reference pendulum --at 0,7,20 --format csv --quiet
has '^0,phi,2\.0+,24,'
grep '^20,' $work/out >$work/parts
exits 0 reference pendulum --at 20 --format csv --quiet
sed 1d $work/out | cmp -s - $work/parts || fails 'depends on times before'

# Values without a certain digit are not shown, and no advice is given that the
# next run would break.
exits 0 reference double-pendulum-chaotic --at 20,80
has '^ 80  phi1 +0  '
has '^--digits 30 carries more of them'
exits 0 reference double-pendulum-chaotic --at 80
has 'At t = 80 no digit is left'
lacks '--digits 30'
exits 0 reference henon-heiles-chaotic --at 120 --digits 3
has 'no digit is left'
has '^--digits 30 carries more of them'
sed 's/^t_end .*/&\nstop = phi < 0/' "$srcdir/scenes/pendulum.nevh" >$work/stops.nevh
exits 0 reference $work/stops.nevh --at 2
has '^the stop of .run. is left aside$'
# At an equilibrium the momentum is rounding, which two runs need not share; the
# coordinate has its digits all the same.
scene rest 'x = 1' 'p_x^2/2 - cos(2*pi*x)/3'
exits 0 reference $work/rest.nevh --at 10 --format csv --quiet
awk -F, '$2 == "x" && $4 >= 20 { found = 1 } END { exit !found }' $work/out ||
    fails 'has no digits of what rests'
exit $status

#!/bin/sh
# nevh reference: digits that are certain.

. "${srcdir:-.}/tests/support/nevh_support.sh"

exits 0 reference pendulum --at 1
if test $status != 0; then
    says 'libquadmath'
    exit 77
fi

# states T DIGITS SCENE LINES...: what a Gauss method of order 16 found in
# arithmetic of 113 bits, without nevh's code.
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
scene dpend 'q1 = pi/2\nq2 = 0' '(p_q1^2 + 2*p_q2^2 - 2*p_q1*p_q2*cos(q1 - q2))/(2*(1 + sin(q1 - q2)^2)) - 9.8*(2*cos(q1) + cos(q2))'
states 10 dpend 0.1137118256716568201221664 -2.223609077492791711139523 \
    -3.802044137210631439898684 1.721351498235191875262862
scene kep06 'x = 0.4\ny = 0\np_y = 2' '(p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)'
states 100 kep06 -0.1041832044342322840550464 -0.6947417155679742850149844 \
    1.23617776268706369627367 0.564623251085780902059137
scene hh 'x = 0\ny = 0.1\np_x = 0.49057789051960615' \
    '(p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3'
states 100 hh 0.1329957183343852788967454 0.3760189573811590740470609 \
    0.2953954457827294417819349 -0.1606396034768338961890406

# Fewer digits of a chaotic orbit, and it says so.
exits 0 reference double-pendulum-chaotic --at 2,40
has 'From t = 40 on not all digits'
exits 0 reference double-pendulum-chaotic --at 40 --format csv --quiet
awk -F, 'NR > 1 && $4 < 20 { fewer++ } END { exit fewer != 4 }' $work/out ||
    fails 'claims digits of chaos'

exits 0 reference kepler --at 1 --digits 5 --format csv --quiet
awk -F, 'NR > 1 && length($3) > 9 { exit 1 }' $work/out || fails 'has more digits'

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
scene wall 'x = 1' 'p_x^2/2 + abs(x)'
exits 2 reference $work/wall.nevh --at 1
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
exit $status

#!/bin/sh
# nevh compare: what is said of the reference, and where there is none.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# scene V [COORDINATE [RUN]]: of one mass, in $work/x.nevh.
scene() {
    printf '[coordinates]\n%b\n[effects]\nK = p_x^2/2\nV = %s\n[run]\n%b\n' \
        "${2:-x = 1}" "$1" \
        "t_end = 10\ndt = 0.1\nintegrators = gauss4\n${3:-}" >$work/x.nevh
}
# The state error of the first row, in CSV, as a condition on $1.
error() {
    exits 0 compare $work/x.nevh --gradient exact --format csv
    grep -v '^#' $work/out | awk -F, -v OFS= '
        NR == 1 { for (i = 1; i <= NF; i++) if ($i == "state_error") at = i }
        NR == 2 { print $at }' | awk "{ exit !($1) }" ||
        { fails "state_error: not $1"; cat $work/out; }
}

# A barrier that the rows see, a mass turns round at, and steps of the whole run
# would miss: at four places, of three widths.
for barrier in '20 0.01' '20 0.03' '33.1 0.1' '7.7 0.02'; do
    set -- $barrier
    scene "2*exp(-((x-$1)/$2)^2)" 'x = -1.05, 1' \
        't_end = 40\ndt = 0.001\nintegrators = blanes-moan4'
    sed -i '/^t_end = 10$/d; /^dt = 0.1$/d; /^integrators = gauss4$/d' \
        $work/x.nevh
    error '$1 > 0 && $1 < 1e-6'
    has '^# state error: .* taylor in [0-9]+ bits, own error'
done

# A jump: no reference, and where; a steep slope of the same height that steps
# follow has one.
scene 'sign(x)' 'x = -1, 3'
error '$1 == ""'
has '^# no state errors: H jumps by 2 near t = 0\.33333.*, in effect "V"'
scene 'tanh(x/0.05)' 'x = -1, 3'
error '$1 > 0 && $1 < 0.5'
# Elsewhere it is a harmonic spring, whose solution is known; a jump has its height.
scene 'x^2/2 + 0.3*tanh((x-0.3)*1e4)'
error '$1 > 0.01 && $1 < 1'
lacks 'H jumps|exact solution'
scene 'x^2/2 + 0.3*sign(x-0.2)'
error '$1 == ""'
has '^# no state errors: H jumps by -0\.6 near t = 1\.369'
# A jump above rounding, in one effect of several.
printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = x^2/2 + x^4/8
step = 1e-5*floor(3*x)\n[run]\nt_end = 5\ndt = 0.1\nintegrators = gauss4\n' \
    >$work/x.nevh
error '$1 == ""'
has '^# no state errors: H jumps by [0-9.e-]+ near t = .*, in effect "step"'

# The word chaos: not where a scheme is poor, at a pole, where all grows, or
# where shear separates orbits; there is an exponent where it is said.
none() {
    exits "$1" compare $work/x.nevh --gradient exact
    lacks 'chaos'
}
scene 'x^2/2 + x^4/4' 'x = 1' 'reference = euler'
none 0
has '^state error: largest difference from euler at dt = .*, own error [0-9]e-0'
scene 'x/(t - 4.73)'
none 0
has '^no state errors after t = 4\.[67]'
has '^ gauss4 .* unknown'
scene '-exp(t)*x^2'
none 0
has 'taylor in [0-9]+ bits, own'
scene '-x^2/2' 'x = 1' 
none 0
has 'own error [0-9]e-1[0-9]'
scene 'x^4/4' 'x = 1'
sed -i 's/^t_end.*/t_end = 2000/; s/^integr.*/integrators = gauss8/' $work/x.nevh
none 0
has 'own error [0-9]e-1[0-9]'
exits 0 compare double-pendulum-chaotic --t-end 60 --integrators gauss6 \
    --dt 0.02
has '^predictability horizon t = (3[0-9]|4[0-4]).*: the motion is chaotic'
has 'e-fold every (0\.[0-9]+|1\.[0-9]+)[ .]'
has '^ gauss6 .* chaos '

# Elements of an array share a range; it is said.
exits 0 compare fput --t-end 100 --integrators gauss4
has 'elements of an array share'
exits 0 compare pendulum --integrators verlet
lacks 'elements of an array'
has '^State error > 50 %: the computed position no longer has to do'

# H that begins with the run: the balance is kept where a run is possible.
for V in 'x^2/2 + x*t^1.5' 'x^2/2 + x*sqrt(t)'; do
    for scheme in verlet midpoint gauss4 rk4 gonzalez dopri5; do
        scene "$V"
        exits 0 run $work/x.nevh --integrators $scheme
        exits 0 compare $work/x.nevh --integrators $scheme --gradient exact
        lacks 'failed|nan'
    done
done
scene 'x^2/2 + x*t^1.5'
exits 0 compare $work/x.nevh --integrators gauss4 --dt 0.01 --gradient exact
has '^ gauss4 .* [0-9.]+e-0[5-9] .* bounded'

# A difference that crosses the edge of the domain of H says so, and how far it
# reached; one that need not cross it has no message.
scene 'x^2/2 - 0.1*log(x)' 'x = 0.01, 0'
sed -i 's/^integr.*/integrators = verlet/' $work/x.nevh
exits 1 compare $work/x.nevh --gradient central4 --gradient-step 0.02
has 'a difference by x reaches 0\.0[0-9]* from the orbit'
exits 0 compare $work/x.nevh --gradient central4 --dt 0.001

# Where the orbit itself ends at the edge of the domain, no difference is at fault.
scene 'log(x)' 'x = 0.01, -1'
sed -i 's/^integr.*/integrators = rk4/' $work/x.nevh
exits 1 compare $work/x.nevh --gradient central4 --dt 0.1
tr '\n' ' ' <$work/out | tr -s ' ' | grep -q 'the solution itself ends at t = 0\.0065' ||
    { fails "says nothing of the orbit"; cat $work/out; }
lacks 'a difference by|-nan'

# Variables that are rounded, being small beside their offset, are no jump.
printf '[coordinates]\nx = 1e8 + 1\n[effects]\nK = p_x^2/2\nV = (x - 1e8)^2/2
[run]\nt_end = 100\ndt = 0.1\nintegrators = verlet, gauss4\n' >$work/offset.nevh
exits 0 compare $work/offset.nevh
lacks 'jumps'
has '^ gauss4 .* [0-9]e-06 '

# Late on the clock.
printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = x^2/2 + x^4/4
[run]\nt_start = 1e9\nt_end = 1e9 + 10\ndt = 0.05\nintegrators = gauss8\n' \
    >$work/x.nevh
error '$1 > 0 && $1 < 1e-13'

# Series that get ever shorter end with the time allowed.
printf '%s\n' '[coordinates]' 'x = 0.5, -2' '[effects]' 'k = p_x^2/2' \
    'v = x^2/4 + x^4*sin(1/x)' '[run]' 't_end = 0.5' 'dt = 0.01' >$work/ever.nevh
exits 1 reference $work/ever.nevh --stop-after 1s
says 'takes more than the 1 s of --stop-after, stopped at t = 0.24'
exit $status

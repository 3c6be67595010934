#!/bin/sh
# H that changes with time faster than steps, jumps in time, and solutions that
# end: what each command says of them.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# make NAME COORDINATES EFFECTS RUN
make_scene() {
    printf '[coordinates]\n%b\n[effects]\n%b\n[run]\n%b\n' "$2" "$3" "$4" \
        >$work/$1.nevh
}
spring='K = p_x^2/2\nV = x^2/2'
twenty='t_end = 20\ndt = 0.1\nintegrators = verlet, gauss4'

# field NAME: that column of CSV.
field() {
    grep -v '^#' | awk -F, -v name=$1 'NR == 1 { for (i = 1; i <= NF; i++)
        if ($i == name) at = i; next } { print $at }'
}
# state NAME DT: the state error of verlet.
state() {
    $nevh compare $work/$1.nevh --integrators verlet --dt $2 --format csv |
        field state_error
}
# A reference that has seen all converges with the rows; a blind one does not.
converges() {
    state $1 $2 >$work/coarse
    state $1 $3 >$work/fine
    awk -v a=$(cat $work/coarse) -v b=$(cat $work/fine) \
        'BEGIN { exit !(a > 1e-3 && b < a / 20) }' ||
        fails "$1: $(cat $work/coarse) at $2, $(cat $work/fine) at $3"
}

make_scene peak 'x = 1' "$spring\nD = -100*x*exp(-((t-7.77)/0.001)^2)" "$twenty"
exits 0 compare $work/peak.nevh
has '^D changes within 0\.00[0-9]+ near t = 7\.7[67]'
has ' verlet .* 9e-02 '
converges peak 0.1 0.00025
exits 0 check $work/peak.nevh
has '^D changes within 0\.00[0-9]+ near t = 7\.7[67]'

# Steps within dt that saw a change have the balance of their own.
make_scene pulse 'x = 1' "$spring\nD = -10*x*exp(-((t-12.567)/0.02)^2)" \
    't_end = 60\ndt = 0.1'
# errors NAME INTEGRATORS TOLERANCE: of the energy.
errors() {
    $nevh compare $work/$1.nevh --integrators $2 --tolerance $3 --format csv |
        field max_energy_error
}
errors pulse dopri5,dop853,dprkn12,taylor 1e-9 >$work/error
awk '!($1 < 1e-6) { exit 1 } END { exit NR != 4 }' $work/error ||
    fails "balances of own steps: $(cat $work/error)"
errors pulse dop853 1e-12 >$work/error
awk '!($1 < 1e-9) { exit 1 }' $work/error || fails "dop853: $(cat $work/error)"
errors peak dop853,dprkn12 1e-6 >$work/error
awk '!($1 > 0.3) { exit 1 } END { exit NR != 2 }' $work/error ||
    fails "steps that pass over the peak: $(cat $work/error)"
exits 0 compare $work/pulse.nevh --integrators verlet,rk4,dop853 --tolerance 1e-9
has ' verlet .* 6\.6e-03 .* undecided'
has ' rk4 .* 2\.1e-03 .* undecided'
has '^D changes within 0\.015 near'
has '\(verlet, rk4\)'

make_scene box 'x = 1' "$spring\nD = -10*x*(sign(t-4)-sign(t-4.001))" "$twenty"
converges box 0.1 0.0001

make_scene drive 'x = 1' "$spring\nD = -0.3*x*cos(50*t)" "$twenty"
exits 0 check $work/drive.nevh
has '^Highest frequency: omega = 50, of D with time; omega dt = 5 at dt = 0\.1'
has '^ verlet +2 +yes +2 +5 +not resolved'
exits 0 check $work/drive.nevh --dt 0.01
has 'omega dt = 0\.5 at dt = 0\.01'
lacks 'changes within'

# The balance of the energy counts a jump.
make_scene jump 'x = 1' "$spring\nD = -0.3*x*sign(t-5)" "$twenty"
exits 0 compare $work/jump.nevh --integrators dop853 --tolerance 1e-9
has '^H jumps in time at t = 5 \(D\): '
exits 0 compare $work/jump.nevh --integrators dop853 --tolerance 1e-9 --format csv
field max_energy_error <$work/out >$work/error
awk '!($1 < 1e-7) { exit 1 }' $work/error || fails "balance lacks the jump"
converges jump 0.07 0.0007
make_scene lens 'x = 0.1' 'K = p_x^2/2\nlens = x^2/2*(sign(t-5) + 1)/2' "$twenty"
exits 0 compare $work/lens.nevh
has '^H jumps in time at t = 5 \(lens\): '
# Nothing of this is said of others.
exits 0 compare pendulum --t-end 5
lacks 'jumps in time|changes within|itself ends|pole'

# Solutions that end at a finite time.
make_scene cubic 'x = -1' 'H = p_x^2/2 - x^3/3' "$twenty"
make_scene quartic 'x = 1' 'H = p_x^2/2 - x^4' "$twenty"
make_scene fall 'x = 1' 'H = p_x^2/2 - 1/x' "$twenty"
make_scene collide 'x[1..2] = 0, 1' \
    'K = sum(i = 1..2, p_x[i]^2/2)\nV = -1/abs(x[1] - x[2])' "$twenty"
for scene in cubic:5.15195 quartic:0.927037 fall:1.11072; do
    ends="the solution itself ends at t = ${scene#*:}"
    scene=$work/${scene%:*}.nevh
    $nevh compare $scene >$work/out 2>&1
    has "$(echo "$ends" | cut -c1-30)"
    lacks 'not symplectic|errors add up|smaller step|for rounding'
    for command in 'recommend --state-error 1e-3' 'recommend --energy-error 1e-3' \
        cost; do
        exits 1 ${command%% *} $scene $(echo "$command" | sed 's/^[a-z]*//')
        says "$ends"
        grep -Eq 'for rounding|smaller step' $work/err && fails 'blames steps'
    done
    $nevh run $scene >$work/out 2>$work/err
    grep -q "$ends" $work/err || fails "run $scene does not say that it ends"
done
exits 1 chaos $work/cubic.nevh
says 'itself ends at t = 5\.15195'
# Close to an end is none.
make_scene near 'x = 1\ny = 0, 0.01' \
    'H = (p_x^2+p_y^2)/2 - 1/sqrt(x^2+y^2)' 't_end = 3\ndt = 0.01'
make_scene growth 'x = 1' 'H = p_x^2/2 - x^2/2' 't_end = 100\ndt = 0.1'
make_scene branch 'x = 1' 'H = p_x^2/2 + (x^2)^(2/3)' 't_end = 10\ndt = 0.1'
for scene in near growth branch; do
    $nevh compare $work/$scene.nevh >$work/out 2>&1
    lacks 'itself ends'
    $nevh run $work/$scene.nevh >$work/out 2>&1
    lacks 'itself ends'
done

# A step past a pole.
make_scene wall 'x = 1, -3' 'H = p_x^2/2 + 1e-3/x' 't_end = 1\ndt = 0.05'
exits 0 compare $work/wall.nevh --integrators verlet
has 'passes a pole of H'
make_scene steep 'x = 1, -3' 'H = p_x^2/2 + 1/x' 't_end = 10\ndt = 0.5'
exits 0 run $work/steep.nevh --integrators verlet
says 'passes a pole of H'
exits 0 compare $work/wall.nevh --integrators verlet --dt 1e-6
lacks 'passes a pole'

# A row has what it takes to repeat it.
exits 0 compare $work/drive.nevh --integrators verlet,dop853 --tolerance 1e-4,1e-8 --format csv
grep -v '^#' $work/out | sed 's/.*,//' | tr '\n' ' ' >$work/last
test "$(cat $work/last)" = 'tolerance  0.0001 1e-08 ' ||
    fails "tolerances are $(cat $work/last)"

exit $status

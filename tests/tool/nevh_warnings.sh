#!/bin/sh
# Warnings of nevh check, compare and run: runs that pass a saddle by an error, and steps
# that are too long for a place of the orbit.  Each is held against the run itself.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# farthest: the largest |value| of the second column.
farthest() {
    awk -F, '/^#/ { next } !titles++ { next }
        { x = $2 < 0 ? -$2 : $2; if (x > most) most = x } END { print most + 0 }' $work/out
}
# column NAME SCHEME: of the row of that scheme.
column() {
    awk -F, -v name=$1 -v scheme=$2 '/^#/ { next }
        !titles++ { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["integrator"] == scheme { print $at[name] }' $work/out
}
is() { awk "BEGIN { exit !($1) }" || fails "$1 does not hold"; }

# A pendulum that swings up to 0.069 J below its top: verlet at 0.05 goes over it, and at
# the step that is named it does not.  Contrast: gauss4, whose errors are far smaller; and
# friction, with which energies are no bound.
near='--start phi=0,p_phi=6.25 --t-end 60'
exits 0 check pendulum $near --dt 0.05 --integrators verlet,gauss4 --format csv
has '^# Warning: verlet at dt = 0\.05 s passes the saddle at phi = 3\.14159 '
lacks '^# Warning: gauss4 .* saddle '
dt=$(sed -n 's/.*saddle.*; dt = \([0-9.]*\) s does not\.$/\1/p' $work/out)
is "\"$dt\" > 0 && \"$dt\" < 0.05"
exits 0 run pendulum $near --dt 0.05 --integrators verlet --every 1
says 'warning: verlet at dt = 0\.05 s passes the saddle'
is "$(farthest) > 3.1416"
exits 0 run pendulum $near --dt 0.05 --integrators gauss4 --every 1
is "$(farthest) < 3.1415"
exits 0 run pendulum $near --dt $dt --integrators verlet --every 1
is "$(farthest) < 3.1415"
grep -q 'saddle' $work/err && fails "warns of a step that holds"
exits 0 compare pendulum $near --dt 0.05 --integrators verlet,gauss4 --format csv
has '^# Warning: verlet at dt = 0\.05 s passes the saddle'
lacks '^# Warning: gauss4 .* saddle '
sed 's/^\[run\]/[friction]\ndrag = phi: 0.01\n[run]/' "$srcdir/scenes/pendulum.nevh" >$work/drag.nevh
exits 0 check $work/drag.nevh $near --dt 0.05 --integrators verlet --format csv
lacks 'saddle'

# An error that is larger than the gap is none beside the saddle, where the run starts:
# no warning, and the run does not go over.
exits 0 compare pendulum-separatrix --t-end 100 --dt 0.1 --integrators verlet --format csv
lacks 'saddle'
error=$(column max_energy_error verlet)
is "$error*9.76 > 0.039"
exits 0 run pendulum-separatrix --t-end 100 --dt 0.1 --integrators verlet --every 1
is "$(farthest) < 3.1416"

# Turns on top of a barrier that the orbit passes, in a double well; contrast: half a step.
printf '[coordinates]\nx = 1, 0.7073\n[effects]\nK = p_x^2/2\nV = x^4/4 - x^2/2\n[run]
t_end = 100\ndt = 0.4\nintegrators = midpoint\n' >$work/wells.nevh
exits 0 check $work/wells.nevh --format csv
has '^# Warning: midpoint at dt = 0\.4 turns back at the saddle at x = 0 '
exits 0 check $work/wells.nevh --dt 0.01 --format csv
lacks 'saddle'

# A close approach: those are named whose energy error in the run is above a tenth, and the
# step that is given keeps it small.
for dt in 0.05 0.02 0.005; do
    exits 0 check kepler-0.9 --t-end 20 --dt $dt --integrators verlet,blanes-moan4,gauss8 \
        --format csv
    cp $work/out $work/check
    exits 0 compare kepler-0.9 --t-end 20 --dt $dt --repeat 1 \
        --integrators verlet,blanes-moan4,gauss8 --format csv
    for scheme in verlet blanes-moan4 gauss8; do
        large=$(column max_energy_error $scheme)
        named=$(grep -Ec "^# Warning: .* too long for [^:]*$scheme[,:]" $work/check)
        is "$named == ($large > 0.1)"
    done
done
exits 0 run kepler-0.9 --t-end 20 --dt 0.02 --integrators verlet
says 'warning: dt = 0\.02 is too long for verlet: '
exits 0 run kepler-0.9 --t-end 20 --dt 0.002 --integrators verlet
grep -q 'too long' $work/err && fails "warns of short steps"
exits 0 check kepler-0.9 --t-end 20 --dt 0.02 --integrators verlet --format csv
dt=$(sed -n 's/^# Warning: dt.*; dt = \([0-9.]*\) keeps it below 1 %\.$/\1/p' $work/out)
is "\"$dt\" > 0 && \"$dt\" < 0.02"
exits 0 compare kepler-0.9 --t-end 20 --dt $dt --repeat 1 --integrators verlet --format csv
is "$(column max_energy_error verlet) < 0.02"

# An approach that lies between samples of the orbit: its rate, within a tenth, is that of
# much finer samples about it.
scene="$srcdir/bench/textbook/kepler-quadrupole.nevh"
exits 0 check "$scene" --t-end 15 --dt 0.008 --integrators verlet --format csv
rate=$(sed -n 's/^# Warning: .* at a rate of \([0-9.]*\) near .*/\1/p' $work/out)
exits 0 check "$scene" --t-end 8.5 --dt 0.008 --integrators verlet --format csv
finer=$(sed -n 's/^# Warning: .* at a rate of \([0-9.]*\) near .*/\1/p' $work/out)
is "\"$rate\" > 0.9*\"$finer\" && \"$finer\" > 0.9*\"$rate\" && \"$rate\" > 0"

# A drive that is faster than the steps.  Contrast: short steps.
exits 0 check kapitza --t-end 20 --dt 0.1 --integrators verlet --format csv
has '^# Warning: dt = 0\.1 s is too long for verlet: shaking changes .* 0\.63 steps a period'
exits 0 check kapitza --t-end 20 --dt 0.001 --integrators verlet --format csv
lacks '^# Warning'

# A resonance, whose energies grow by many powers of ten: errors there are small beside
# them.  Contrast: steps that are long for the drive.
printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = (1 - 0.2*cos(2*t))*x^2/2\n[run]
t_end = 300\ndt = 0.05\nintegrators = verlet, gauss4\n' >$work/mathieu.nevh
exits 0 check $work/mathieu.nevh --gradient exact --format csv
lacks '^# Warning'
exits 0 check $work/mathieu.nevh --gradient exact --dt 1.5 --format csv
has '^# Warning: dt = 1\.5 is too long for verlet, gauss4: V changes with time'

exit $status

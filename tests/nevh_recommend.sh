#!/bin/sh
# What nevh recommend answers, and what it says where there is no answer.

. "${srcdir:-.}/tests/nevh_support.sh"

records() {
    grep -v '^#' $work/out
}
# A scene of one coordinate: FILE POTENTIAL, lines of [run].
scene() {
    printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = %s\n[run]\n%b\n' \
        "$2" "$3" >$work/$1
}

# The first row of an answer keeps the error that was asked for.
keeps() { # TARGET COLUMN
    records | awk -F, -v most="$1" -v column="$2" \
        'NR == 2 { kept = $column != "" && $column <= most + 0 }
         END { exit !kept }' || { fails "keeps no $1"; cat $work/out; }
}
# Schemes that need few steps are not taken for such as keep the energy at any.
for scene in pendulum kapitza pendulum-rotating; do
    exits 0 recommend $scene --energy-error 1e-8 --format csv
    keeps 1e-8 9
done
# Over runs so short that a few steps are enough for all digits.
exits 0 recommend kepler --energy-error 1e-8 --t-end 2 \
    --integrators gauss20 --gradient exact
for t_end in 0.5 2 8; do
    exits 0 cost kepler --t-end $t_end --integrators gauss20,verlet \
        --gradient exact
    lacks 'keep the energy at any step'
done
# Where H is quadratic Gauss's methods do keep it, however long the steps are.
exits 0 cost oscillator --t-end 10 --integrators gauss4,gauss20,verlet
has '^gauss4, gauss20: keep the energy at any step'

# Every shipped scene has an answer.
for file in "$srcdir"/scenes/*.nevh; do
    scene=${file##*/}
    scene=${scene%.nevh}
    exits 0 recommend $scene --energy-error 1e-6 --gradient exact \
        --integrators blanes-moan4,gauss8,dop853,dprkn12 --format csv
    keeps 1e-6 9
done

# What fails in its first step is given up after a few that are shorter.
scene edge.nevh 'acos(x)' 't_end = 2\ndt = 0.1'
for name in rk4 verlet gauss4; do
    exits 1 cost $work/edge.nevh --integrators $name --format csv
    says "$name with exact at dt = .* failed: .* is -inf at t = 0"
    test "$(records | wc -l)" -le 8 || fails "tries $(records | wc -l) steps"
done
exits 1 cost $work/edge.nevh
has '^ verlet +fails +fails'
has '^symplectic-euler-a with exact at dt = 0.1 failed: '
has '^[0-9]+ others fail as well'
lacks 'keep the energy at any step'
exits 1 recommend $work/edge.nevh --energy-error 1e-6
says 'no integrator comes to the end: .* failed: .* is -inf at t = 0'
# Given steps that fail are explained, too.
printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = atan2(x, p_x)\n%s' \
    '[run]
t_end = 2
' >$work/kink.nevh
exits 1 cost $work/kink.nevh --integrators rk4,gauss4 --dt 0.1,0.05
says 'kink.nevh: .* with exact at dt = 0.05 failed'

# A run that is to stop where it starts.
scene still.nevh 'x^2/2' 't_end = 10\ndt = 0.1\nstop = x > 0'
for command in cost 'recommend --energy-error 1e-3'; do
    exits 1 $command $work/still.nevh
    says 'the run stops at its start, where x > 0 holds already'
done
exits 0 compare $work/still.nevh --integrators verlet
lacks 'nan'
exit $status

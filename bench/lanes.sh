#!/bin/sh
# lanes.sh NEVH: what members of a sweep cost that differ in a constant of H,
# the length l of a pendulum, against members that differ in where they start.
# ROUNDS (5) sweeps of MEMBERS (200), to T_END (300), of each in turn, for each scheme of SCHEMES
# and gradient of GRADIENTS; prints the medians of processor time and their ratio.
# NATIVE=always or never: compiled steps, or none.
#
# lanes.sh NEVH outcomes [OTHER]: what outcomes cost, ns an orbit and step, of Henon and
# Heiles by Verlet, and of Taylor series ms an orbit until t = 1000 at 1e-12; beside
# those of OTHER, another nevh, in turn.  What ROUNDS (5) sweeps of MEMBERS (320) take
# longer than such of a tenth of the time: medians.

nevh=$1 rounds=${ROUNDS:-5} members=${MEMBERS:-200}
work=${TMPDIR:-/tmp}/lanes.$$
trap 'rm -f $work.*' EXIT
trap 'exit 1' HUP INT TERM

sweep() { # NAME VARY: the processor time that it takes is added to the file of NAME
    rm -f $work.npy $work.npy.txt
    ( "$nevh" sweep pendulum --vary "$2" --t-end ${T_END:-300} \
        --integrators $scheme --gradient $gradient ${NATIVE:+--native $NATIVE} \
        --outcomes state --threads 1 -o $work.npy --quiet >$work.out 2>&1 ||
        cat $work.out >&2
      times >$work.times )
    awk 'END { split($1, x, /[ms]/); print 60*x[1] + x[2] }' $work.times \
        >>$work.$1
}
median() {
    sort -n $work.$1 | awk '{ x[NR] = $1 } END { print x[int((NR + 1)/2)] }'
}

outcome() { # NEVH SCHEME T_END OUTCOMES OPTION...: processor seconds
    rm -f $work.npy $work.npy.txt
    ( "$1" sweep henon-heiles --vary "y=range(-0.3,0.3,${MEMBERS:-320})" \
        --vary p_x=0.3 --integrators $2 --dt 0.05 --t-end $3 --outcomes "$4" \
        --gradient exact --native always --threads 1 -o $work.npy --quiet \
        >$work.out 2>&1 || cat $work.out >&2
      times >$work.times )
    awk 'END { split($1, x, /[ms]/); print 60*x[1] + x[2] }' $work.times
}
outcomes() { # SCHEME T_END OUTCOMES UNIT
    rm -f $work.0 $work.1
    i=0
    while test $i -lt $rounds; do
        i=$((i + 1)) of=0
        for each in "$nevh" $other; do
            long=$(outcome "$each" $1 $2 "$3")
            short=$(outcome "$each" $1 $(($2 / 10)) "$3")
            awk -v a=$long -v b=$short -v unit=$4 -v n=${MEMBERS:-320} \
                'BEGIN { print (a - b)/0.9/n*unit }' >>$work.$of
            of=1
        done
    done
    printf ' %-10s %-16s %9.3g' $1 "$3" $(median 0)
    test -z "$other" || printf ' %9.3g' $(median 1)
    echo
}
if test "$2" = outcomes; then
    other=$3
    for what in state energy_error 'max(x)' 'min(x)' 'mean(x)' 'first(x>2)' \
        lyapunov sali megno verdict 'frequency(x)'; do
        outcomes verlet ${T_END:-1000} "$what" $(awk -v t=${T_END:-1000} \
            'BEGIN { print 1e9/(t/0.05) }')
    done
    outcomes taylor 1000 state 1e3
    exit
fi

printf ' %-12s %-9s %8s %8s %7s\n' scheme gradient 'phi [s]' 'l [s]' ratio
for scheme in ${SCHEMES:-verlet blanes-moan4 rk4 dop853 dprkn12 midpoint gauss4 gauss12 lobatto4}; do
    for gradient in ${GRADIENTS:-exact central4}; do
        rm -f $work.phi $work.l
        i=0
        while test $i -lt $rounds; do
            i=$((i + 1))
            sweep phi "phi=range(0.5,2,$members)"
            sweep l "l=range(0.5,2,$members)"
        done
        printf '%s %s\n' $(median phi) $(median l) |
            awk -v s=$scheme -v g=$gradient '{
                printf " %-12s %-9s %8.3f %8.3f %7.2f\n", s, g, $1, $2, $2/$1 }'
    done
done

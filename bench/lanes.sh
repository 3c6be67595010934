#!/bin/sh
# lanes.sh NEVH: what members of a sweep cost that differ in a constant of H,
# the length l of a pendulum, against members that differ in where they start.
# ROUNDS (5) sweeps of MEMBERS (200), to T_END (300), of each in turn, for each scheme of SCHEMES
# and gradient of GRADIENTS; prints the medians of processor time and their ratio.
# NATIVE=always or never: compiled steps, or none.

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

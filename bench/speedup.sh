#!/bin/sh
# speedup.sh NEVH [NEVH-MPI]: how much faster a sweep is by two threads than by one,
# and by two ranks than by one.  The same double pendulums each time, in turn, ROUNDS
# (5) of each; prints the medians and their ratios, and fails where one is below 1.8.
# For a machine of two cores or more that does nothing else.

nevh=$1 mpi=$2 rounds=${ROUNDS:-5} members=${MEMBERS:-20000}
work=${TMPDIR:-/tmp}/speedup.$$
trap 'rm -f $work.*' EXIT
trap 'exit 1' HUP INT TERM
OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM

seconds() { # NAME COMMAND...: the time that it takes is added to the file of NAME
    name=$1
    shift
    rm -f $work.npy $work.npy.txt
    from=$(date +%s.%N)
    "$@" sweep double-pendulum --vary "phi1=range(-3,3,$members)" --t-end 20 \
        --integrators gauss4 --dt 0.02 --gradient exact --outcomes state \
        $threads -o $work.npy --quiet >$work.out 2>&1 ||
        { cat $work.out; exit 1; }
    date +%s.%N | awk -v from="$from" '{ print $1 - from }' >>$work.$name
}
median() {
    sort -n $work.$1 | awk '{ x[NR] = $1 } END { print x[int((NR + 1)/2)] }'
}
status=0
compare() { # WHAT ONE TWO
    one=$(median $2) two=$(median $3)
    awk -v what="$1" -v one="$one" -v two="$two" 'BEGIN {
        printf " %-8s %8.2f s %8.2f s %7.2f\n", what, one, two, one/two
        exit one/two < 1.8 }' || status=1
}

i=0
while test $i -lt $rounds; do
    i=$((i + 1))
    threads='--threads 1' && seconds t1 "$nevh"
    threads='--threads 2' && seconds t2 "$nevh"
    test "$mpi" || continue
    threads='--threads 1' && seconds r1 mpirun -n 1 "$mpi"
    threads='--threads 1' && seconds r2 mpirun -n 2 "$mpi"
done
echo " of           one        two   ratio"
compare threads t1 t2
test "$mpi" && compare ranks r1 r2
exit $status

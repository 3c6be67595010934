#!/bin/sh
# Slow: sweeps killed at random moments, alone and in a rank of MPI, are gone on
# with to the same bytes; the memory of a million members is that of a thousand.

. "${srcdir:-.}/tests/support/nevh_support.sh"

KILLS=${KILLS:-30}
OMPI_ALLOW_RUN_AS_ROOT=1
OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM
export OMPI_MCA_rmaps_base_oversubscribe
ranks=
test -e tools/nevh-mpi && mpirun -n 2 true >/dev/null 2>&1 && ranks=2

set -- sweep double-pendulum --vary 'phi1 = range(-3, 3, 60)' \
    --vary 'phi2 = range(-3, 3, 60)' --integrators rk4 --gradient exact \
    --dt 0.02 --t-end 40 --outcomes 'first(abs(phi2) > pi), energy_error'
exits 0 "$@" -o $work/whole.npy --threads 2

# The command is a child whose number is known, and no group of processes.
cat >$work/child.sh <<'END'
echo $$ >$1.new
mv $1.new $1
shift
exec "$@"
END
kills=0
middle=0
while test $kills -lt $KILLS; do
    kills=$((kills + 1))
    rm -f $work/killed.npy* $work/pid
    width=$((kills % 3 * 8 + 8))
    if test -n "$ranks" && test $((kills % 3)) = 0; then
        mpirun -n $ranks sh $work/child.sh $work/pid "$nevh" "$@" \
            -o $work/killed.npy --threads 1 >/dev/null 2>&1 </dev/null &
    else
        sh $work/child.sh $work/pid "$nevh" "$@" -o $work/killed.npy \
            --threads $((1 + kills % 2)) --width $width >/dev/null 2>&1 \
            </dev/null &
    fi
    started=$!
    # Awk's seed is the number: other moments each time, the same in each run.
    sleep "$(awk "BEGIN { srand($kills); print 0.05 + 1.2*rand() }")"
    kill -KILL "$(cat $work/pid 2>/dev/null)" 2>/dev/null && middle=$((middle + 1))
    wait $started 2>/dev/null
    if test -s $work/killed.npy; then
        "$nevh" "$@" --resume $work/killed.npy --threads 1 2>/dev/null
    else
        "$nevh" "$@" -o $work/killed.npy 2>/dev/null
    fi
    cmp -s $work/whole.npy $work/killed.npy &&
        cmp -s $work/whole.npy.txt $work/killed.npy.txt ||
        fails "leaves other bytes after kill $kills"
done
echo "killed $kills times, $middle of them before the end"

# The largest memory that the system tells of, of a process under way.
memory() { # MEMBERS
    rm -f $work/pid $work/many.npy*
    sh $work/child.sh $work/pid "$nevh" sweep pendulum --gradient exact \
        --integrators verlet --t-end 0.1 --dt 0.05 --outcomes 'last(phi)' \
        --vary "phi = range(-3, 3, $1)" -o $work/many.npy 2>/dev/null &
    started=$!
    most=0
    while kill -0 $started 2>/dev/null; do
        now=$(sed -n 's/^VmHWM:[^0-9]*\([0-9]*\).*/\1/p' \
            "/proc/$started/status" 2>/dev/null)
        test "${now:-0}" -gt $most && most=$now
        sleep 0.01
    done
    wait $started
    echo "$1 members: $most kB"
}
if test -r /proc/self/status && test -z "$SANITIZE_FLAGS"; then
    command="sweep of 1e6 members"
    memory 1000000
    test $most -lt 12000 || fails "takes $most kB"
    test "$(wc -c <$work/many.npy)" -lt 64000000 || fails "writes too much"
fi
exit $status

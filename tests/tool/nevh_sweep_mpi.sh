#!/bin/sh
# nevh sweep under mpirun: the same bytes for any number of ranks, of which one is
# stopped for a while, or is killed; what is refused.

. "${srcdir:-.}/tests/support/nevh_support.sh"

if ! command -v mpirun >/dev/null 2>&1; then
    echo "skipped: there is no mpirun"
    exit 77
fi
if ! test -e tools/nevh-mpi; then
    echo "skipped: nevh was built without MPI"
    exit 77
fi
# Open MPI starts no more processes than processors, and nothing for root.
OMPI_ALLOW_RUN_AS_ROOT=1
OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM
export OMPI_MCA_rmaps_base_oversubscribe
if ! $limit mpirun -n 2 true >/dev/null 2>&1; then
    echo "skipped: mpirun starts nothing here"
    exit 77
fi

scene=$work/mixed.nevh
cat >$scene <<'END'
[coordinates]
phi = 1
[effects]
kinetic = p_phi^2/2
well = -log(phi)
[run]
t_end = 1
dt = 0.01
integrators = verlet
[ensemble]
phi = range(-0.1, 2, 150)
p_phi = 0, -2
outcomes = first(p_phi > 0), last(phi)
END
ranks() { # STATUS RANKS ARGUMENT...
    expected=$1
    count=$2
    shift 2
    command="$* (with $count ranks)"
    $limit mpirun -n $count "$nevh" "$@" >$work/out 2>$work/err </dev/null
    code=$?
    test $code = $expected ||
        { fails "exit status $code instead of $expected"; cat $work/err; }
}
same() { # FILE: has the bytes of the whole sweep
    cmp -s $work/whole.npy "$1" || fails "$1 has other bytes"
    cmp -s $work/whole.npy.txt "$1.txt" || fails "$1.txt has other bytes"
}

exits 1 sweep $scene -o $work/whole.npy --threads 1
for count in 1 2 3; do
    ranks 1 $count sweep $scene -o $work/ranks.npy
    test $count = 1 || says 'of 300 members 1 failed and 16 have no start'
    test "$(grep -c 'have no start' $work/err)" = 1 || fails "says it twice"
    same $work/ranks.npy
    rm $work/ranks.npy*
done
ranks 2 2 sweep $scene
says 'share one array'
test "$(grep -c "^nevh" $work/err)" = 1 || fails "says it twice"
ranks 2 2 sweep $scene -o $work/ranks.npy --join
says 'share one array'
ranks 2 2 sweep $scene -o $work/no/such/folder.npy
says 'cannot be written'
ranks 2 2 sweep $work/nowhere.nevh -o $work/ranks.npy
says 'there is no file'
ranks 2 2 sweep $scene --resume $work/ranks.npy
says 'there is nothing to resume'
ranks 1 2 sweep $scene -o $work/ranks.npy
ranks 2 2 sweep $scene --resume $work/ranks.npy --vary 'phi = 1'
says 'another scene'
ranks 1 2 sweep $scene --resume $work/ranks.npy
same $work/ranks.npy
# Each with its own part needs no MPI.
cat >$work/part.sh <<'END'
number=${PMI_RANK:-$OMPI_COMM_WORLD_RANK}
exec "$@" --task $((number + 1))/2
END
$limit mpirun -n 2 sh $work/part.sh "$nevh" sweep $scene -o $work/parts.npy \
    2>/dev/null </dev/null
exits 1 sweep $scene -o $work/parts.npy --join
same $work/parts.npy
# Without nevh-mpi beside it nevh does not let all ranks do the same.
cp "$(find tools/.libs -name nevh 2>/dev/null)" $work/nevh 2>/dev/null && (
    LD_LIBRARY_PATH=$PWD/.libs PMI_SIZE=2 $work/nevh sweep $scene \
        -o $work/x.npy 2>$work/err
    test $? = 2 && grep -q 'built without MPI' $work/err &&
        test ! -e $work/x.npy || exit 1
) || test ! -e $work/nevh || fails "lets all ranks do the same"

# Long enough to be interrupted; one of three ranks stops for two seconds, and
# others take over what it would have done.
sed 's/t_end = 1$/t_end = 250/; s/150)/900)/' $scene >$work/long.nevh
"$nevh" sweep $work/long.nevh -o $work/whole.npy --threads 1 2>/dev/null
cat >$work/rank.sh <<'END'
number=${PMI_RANK:-$OMPI_COMM_WORLD_RANK}
echo $$ >$1.$number.new
mv $1.$number.new $1.$number
shift
exec "$@"
END
start() { # STATUS of the shell's: three ranks, in the background
    rm -f $work/pid.*
    command="$* (three ranks)"
    $limit mpirun -n 3 sh $work/rank.sh $work/pid "$nevh" "$@" \
        >/dev/null 2>$work/err </dev/null &
    started=$!
    for tenth in 1 2 3 4 5 6 7 8 9 10 20 30 40 50 60 70 80 90 100; do
        test -e $work/pid.0 && test -e $work/pid.1 && test -e $work/pid.2 &&
            test -s $work/ranks.npy && break
        sleep 0.1
    done
    echo $tenth >/dev/null
}
for victim in 0 2; do
    rm -f $work/ranks.npy*
    start sweep $work/long.nevh -o $work/ranks.npy --threads 1
    kill -STOP "$(cat $work/pid.$victim)" 2>/dev/null
    sleep 2
    kill -CONT "$(cat $work/pid.$victim)" 2>/dev/null
    wait $started
    test $? = 1 || { fails "is not done"; cat $work/err; }
    same $work/ranks.npy
done
# A rank is killed, and with it all: the sweep is gone on with.
rm -f $work/ranks.npy*
start sweep $work/long.nevh -o $work/ranks.npy --threads 1
kill -KILL "$(cat $work/pid.1)" 2>/dev/null
wait $started
ranks 1 2 sweep $work/long.nevh --resume $work/ranks.npy --threads 1
same $work/ranks.npy

# The example counts the same members for any number of processes.
if test -e examples/sweep_mpi; then
    command=examples/sweep_mpi
    for count in 1 2 3; do
        $limit mpirun -n $count examples/sweep_mpi >$work/out 2>$work/err ||
            fails "fails with $count processes"
        has '^members 40000, turned over [1-9][0-9]{4}, the last one at t = [0-9.]+; processes'
        sed 's/; .*//' $work/out >$work/now
        test $count = 1 && cp $work/now $work/first
        cmp -s $work/now $work/first || fails "counts others"
    done
fi

exit $status

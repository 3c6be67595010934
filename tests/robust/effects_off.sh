#!/bin/sh
# Effects that are off cost nothing: a scene with ten expensive ones takes as
# many instructions a step as the same scene without them, within 0.1 %.

test -z "$SANITIZE_FLAGS" || { echo "sanitizers are on"; exit 77; }
command -v valgrind >/dev/null 2>&1 || { echo "no valgrind"; exit 77; }

work=effects_off.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1

scene() {
    cat <<END
[scene]
effects = kinetic, springs, cubic$1
[coordinates]
x[i = 1..8] = 0.1*i
[effects]
kinetic = sum(i = 1..8, p_x[i]^2/2)
springs = sum(i = 1..7, (x[i+1] - x[i])^2/2)
END
    for k in 1 2 3 4 5; do
        test -n "$2" && cat <<END
dear$k = sum(i = 1..8, j = 1..8, exp(-$k*(x[i] - x[j])^2)*sin(x[i] + p_x[j]))
END
    done
    echo 'cubic = sum(i = 1..7, (x[i+1] - x[i])^3/3)'
    for k in 6 7 8 9 10; do
        test -n "$2" && echo "dear$k = sqrt(1 + $k*sum(i = 1..8, x[i]*p_x[i]))"
    done
}
scene '' '' >$work/less.nevh
scene '' more >$work/off.nevh
scene ', dear1' more >$work/on.nevh

# instructions SCENE INTEGRATOR STEPS: prints how many.
instructions() {
    ${LIBTOOL:?} --mode=execute valgrind --tool=callgrind \
        --callgrind-out-file=/dev/null --log-file="$PWD/$work/log" \
        ./tests/support/steps_of "$work/$1.nevh" "$2" "$3" >$work/out 2>&1 || {
        echo "tests/support/steps_of $1 $2 $3 fails under valgrind" >&2
        cat $work/out $work/log >&2
        return 1
    }
    sed -n 's/.*Collected : \([0-9]*\).*/\1/p' $work/log
}

# each SCENE INTEGRATOR: those of a step.
each() {
    few=$(instructions "$1" "$2" 10) && many=$(instructions "$1" "$2" 40) &&
        test -n "$few" && test -n "$many" && echo $(((many - few) / 30))
}

status=0
for integrator in verlet gauss4; do
    less=$(each less $integrator) && off=$(each off $integrator) || exit 1
    echo "$integrator: $less instructions a step, $off with ten effects off"
    awk "BEGIN { d = $off - $less; exit !(d * d <= 1e-6 * $less * $less) }" ||
        status=1
done
on=$(each on gauss4) || exit 1
echo "gauss4 with one of them on: $on"
awk "BEGIN { exit !($on > 1.5 * $less) }" || status=1
exit $status

#!/bin/sh
# Stepping allocates nothing: tests/support/steps N makes a stepper of every scheme
# and takes N steps, with as many allocations for 50 as for 5.  No leaks.

test -z "$SANITIZE_FLAGS" || { echo "sanitizers are on"; exit 77; }
command -v valgrind >/dev/null 2>&1 || { echo "no valgrind"; exit 77; }

work=valgrind.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1

# allocations N: prints how many.  $LIBTOOL is a command with options.
allocations() {
    ${LIBTOOL:?} --mode=execute valgrind --leak-check=full \
        --show-leak-kinds=all --errors-for-leak-kinds=all \
        --error-exitcode=9 --log-file="$PWD/$work/log" \
        ./tests/support/steps "$1" >$work/out 2>&1 || {
        echo "tests/support/steps $1 fails under valgrind" >&2
        cat $work/out $work/log >&2
        return 1
    }
    sed -n 's/.*total heap usage: \([0-9,]*\) allocs.*/\1/p' $work/log |
        tr -d ,
}

few=$(allocations 5) || exit 1
many=$(allocations 50) || exit 1
echo "allocations: $few for 5 steps, $many for 50"
if test -z "$few" || test "$few" = 0; then
    echo "tests/support/steps allocates nothing at all, so this tests nothing"
    exit 1
fi
test "$few" = "$many"

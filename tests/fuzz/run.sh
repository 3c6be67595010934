#!/bin/sh
# run.sh SECONDS: fuzzes the reader of scenes, formulas included, under
# sanitizers, from the scenes that ship and those that are wrong.
# Needs clang with libFuzzer; what is found is left in the current folder.

srcdir=${srcdir:-.}
clang=$(command -v clang || command -v clang-14) ||
    { echo "fuzz: there is no clang"; exit 77; }
work=fuzz.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir -p $work/corpus || exit 1

# GSL_CFLAGS and the like may be lists.
# shellcheck disable=SC2086
"$clang" -std=c11 -O1 -g -fsanitize=fuzzer,address,undefined \
    -fno-sanitize-recover=undefined -DNEVH_PORTABLE \
    -I"$srcdir/include" -I"$srcdir/lib" -I"$srcdir/integrators" ${GSL_CFLAGS} \
    "$srcdir"/tests/fuzz/fuzz_scene.c "$srcdir"/lib/*/*.c \
    "$srcdir"/integrators/*.c ${GSL_LIBS:--lgsl -lgslcblas} -lm -ldl \
    -o $work/fuzz_scene >$work/log 2>&1 ||
    { echo "fuzz: libFuzzer does not work here"; exit 77; }
cp "$srcdir"/scenes/*.nevh "$srcdir"/tests/bad/*.nevh $work/corpus/
rm -f $work/corpus/fput-1000.nevh # slow
$work/fuzz_scene -max_total_time="${1:-60}" -timeout=20 -rss_limit_mb=4096 \
    -max_len=4096 -dict="$srcdir/tests/fuzz/scene.dict" -print_final_stats=1 \
    $work/corpus >$work/log 2>&1
status=$?
[ $status = 0 ] || cat $work/log
sed -n '/^stat::number_of_executed_units/p; /^Done/p' $work/log
exit $status

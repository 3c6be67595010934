#!/bin/sh
# run.sh [SECONDS [TARGET...]]: fuzzes the readers of scenes, of states to resume
# and of the command line, in turn, each so long, under sanitizers; or only the
# targets named: scene, resume, arguments.  Needs clang with libFuzzer; the inputs
# that fail are left in the current folder.

srcdir=${srcdir:-.}
seconds=${1:-60}
test $# -eq 0 || shift
test $# -gt 0 || set -- scene resume arguments
clang=$(command -v clang || command -v clang-14) ||
    { echo "fuzz: there is no clang"; exit 77; }
work=fuzz.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir -p $work/scene $work/resume $work/arguments || exit 1
FUZZ_FOLDER=$work
export FUZZ_FOLDER

sanitized="-fsanitize=address,undefined -fno-sanitize-recover=undefined"
flags="-std=c11 -O1 -g -D_GNU_SOURCE -DNEVH_PORTABLE -I. -I$srcdir/include
    -I$srcdir/lib -I$srcdir/integrators -I$srcdir/tools ${GSL_CFLAGS}"
# Flags are lists.
# shellcheck disable=SC2086
compile() {
    for file in "$srcdir"/lib/*/*.c "$srcdir"/lib/*/*/*.c lib/native/kernel_texts.c \
        "$srcdir"/integrators/*.c "$srcdir"/integrators/kernels/*.c; do
        name=$(basename "$(dirname "$file")")_$(basename "$file" .c)
        "$clang" $flags $sanitized -fsanitize=fuzzer-no-link \
            -c "$file" -o $work/"$name".o || return 1
    done
}
# parts: the files of the command, all but main and MPI, as an archive.
# shellcheck disable=SC2086
parts() {
    mkdir $work/tools || return 1
    for file in "$srcdir"/tools/*.c "$srcdir"/tools/*/*.c; do
        case $file in
        */nevh.c | *_mpi.c) continue ;;
        esac
        "$clang" $flags $sanitized -fsanitize=fuzzer-no-link '-DNEVH_SCENES="/nowhere"' \
            '-DNEVH_PAGE="/nowhere"' '-DNEVH_PACKAGE="/nowhere"' \
            -c "$file" -o $work/tools/"$(basename "$file" .c)".o || return 1
    done
    ar rc $work/parts.a $work/tools/*.o
}
# shellcheck disable=SC2086
link() {
    "$clang" $flags $sanitized -fsanitize=fuzzer \
        "$srcdir/tests/robust/fuzz/fuzz_$1.c" $work/parts.a $work/*.o \
        ${GSL_LIBS:--lgsl -lgslcblas} -lm -ldl -o "$work/fuzz_$1"
}
libfuzzer_works() {
    echo 'int LLVMFuzzerTestOneInput(const char *x, long n) { return !x && n; }' \
        >$work/works.c
    "$clang" $sanitized -fsanitize=fuzzer $work/works.c -o $work/works
}
# row ROW HOW: a state after 10 steps, as fuzz_resume.c takes it.
# shellcheck disable=SC2059
row() {
    printf "r$2"
    head -c 16 /dev/zero
    printf '\012'
    head -c 7 /dev/zero
    printf "$1"
    head -c 23 /dev/zero
}
seeds() {
    cp "$srcdir"/scenes/*.nevh "$srcdir"/tests/scene/bad/*.nevh $work/scene/
    rm -f $work/scene/fput-1000.nevh # slow
    for name in pendulum kapitza fput; do
        { cat "$srcdir/scenes/$name.nevh"; printf '\0g = 2*m'; } \
            >$work/scene/set-$name
    done
    printf 's\001\002\003nevh = 1\n' >$work/resume/short
    printf 's\002\030\000s%056dnevh = 1\nscene = 01\n' 0 >$work/resume/long
    for how in '\004 \014' '\005 \003' '\006 \004' '\014 \014' '\016 \004'; do
        row "${how#* }" "${how% *}" >$work/resume/row-"$(echo "$how" | tr -d ' \\')"
    done
    printf -- '--dt\n0.1,0.2\n--integrators\nverlet,gauss4+transform' \
        >$work/arguments/lists
    printf -- '--set\nk=3\n--without\nspring\n--gradient=exact\n-o\nx' \
        >$work/arguments/changes
    sed -n 's/^    {"\([a-z-]*\)", .*/"--\1"/p' "$srcdir/tools/cli/options.c" \
        >$work/arguments.dict
    printf '%s\n' '"\x0a"' '"="' '","' '"1e300"' '"nan"' '"+transform"' \
        >>$work/arguments.dict
    cp "$srcdir/tests/robust/fuzz/scene.dict" $work/
    printf '%s\n' '"nevh = 1\x0a"' >$work/resume.dict
}

libfuzzer_works >$work/log 2>&1 ||
    { echo "fuzz: libFuzzer does not work here"; exit 77; }
{ compile && parts; } >$work/log 2>&1 ||
    { cat $work/log; exit 1; }
seeds
result=0
for target; do
    if ! link "$target" >$work/log 2>&1; then
        cat $work/log
        exit 1
    fi
    # stderr has all messages of what is wrong
    $work/fuzz_"$target" -max_total_time="$seconds" -timeout=20 \
        -rss_limit_mb=4096 -max_len=4096 -dict=$work/"$target".dict \
        -close_fd_mask=2 -print_final_stats=1 $work/"$target" \
        >$work/log 2>&1
    status=$?
    test $status = 0 || { cat $work/log; result=$status; }
    echo "$target:"
    sed -n '/^stat::number_of_executed_units/p; /^Done/p' $work/log
done
exit $result

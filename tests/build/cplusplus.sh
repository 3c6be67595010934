#!/bin/sh
# Each header stands on its own, as C11 and, where there is a C++ compiler,
# as C++11, without a warning.

srcdir=${srcdir:-.}
work=cplusplus.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1

cxx=
for name in $CXX c++ g++ clang++; do
    if command -v "$name" >/dev/null 2>&1; then
        cxx=$name
        break
    fi
done
test -n "$cxx" || echo "no C++ compiler: checked as C alone"

status=0
# compiles LANGUAGE COMPILER FLAGS...
compiles() {
    language=$1
    shift
    # GSL's headers are not ours to keep free of warnings.
    # shellcheck disable=SC2086
    "$@" -fsyntax-only -Wall -Wextra -pedantic -Wconversion -Wsign-conversion -Wundef \
        -Werror -I"$srcdir/include" $isystem $work/file.$language || {
        echo "$header does not compile: $*"
        status=1
    }
}

isystem=
for flag in $GSL_CFLAGS; do
    case $flag in
    -I*) isystem="$isystem -isystem ${flag#-I}" ;;
    *) isystem="$isystem $flag" ;;
    esac
done
for path in "$srcdir"/include/nevh/*.h; do
    header=nevh/${path##*/}
    echo "#include <$header>" >$work/file.c
    echo "extern int unused;" >>$work/file.c
    cp $work/file.c $work/file.cc
    # Unquoted: $CC may be a compiler with options.
    # shellcheck disable=SC2086
    compiles c ${CC:-cc} -std=c11
    test -z "$cxx" || compiles cc "$cxx" -std=c++11
done

# Without glibc, as far as that can be shown with it.
header=nevh/body.h
printf '%s\n' '#include <limits.h>' '#undef __GLIBC__' '#undef __GLIBC_PREREQ' \
    '#include <nevh/body.h>' >$work/file.c
compiles c ${CC:-cc} -std=c11
exit $status

#!/bin/sh
# Headers of compiled steps are C as they stand: as a scene's steps are compiled,
# and as programs have them.

srcdir=${srcdir:-.}
cc=${CC:-cc}
status=0
work=step_headers.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1
$cc --version >/dev/null 2>&1 || { echo "no C compiler"; exit 77; }

# compiles CC FAMILY HEADER [DEFINITION...]
compiles() {
    compiler=$1 family=$2 header=$3
    shift 3
    $compiler -std=c11 -fsyntax-only -Wall -Wextra -Werror -Wno-unknown-pragmas \
        -Wno-psabi -Wno-unused-function -Wno-unused-const-variable \
        -DFAMILY_$family -DHEADER="\"$header\"" "$@" -I"$srcdir/include" \
        -I"$srcdir/lib" -I"$srcdir/integrators" -Iinclude -Ilib \
        "$srcdir/tests/native/step_header.c" 2>$work/err && return
    echo "$header does not compile by $compiler $*:"
    head -n 20 $work/err
    status=1
}

for compiler in "$cc" clang; do
    $compiler --version >/dev/null 2>&1 || continue
    for way in -DNEVH__COMPILE -DNEVH__FOR_READERS; do
        compiles $compiler ADAPTIVE native/steps/adaptive_driver.h $way
        compiles $compiler ADAPTIVE_VERLET native/steps/adaptive_verlet_driver.h $way
        compiles $compiler ADAPTIVE_VERLET native/steps/adaptive_verlet_driver.h \
            $way -DNEVH__REVERSIBLE
        compiles $compiler TAO native/steps/tao_driver.h $way
        compiles $compiler IMPLICIT native/steps/implicit_orbit.h $way
        compiles $compiler IMPLICIT native/steps/implicit_orbit.h $way \
            -DNEVH__DIFFERENCES
    done
    compiles $compiler IMPLICIT native/steps/implicit_lanes.h
    compiles $compiler IMPLICIT native/steps/implicit_lanes.h -DNEVH__FOUR_TOGETHER
    wide='-DNEVH__SIDE_BY_SIDE -DNEVH__WIDE'
    for forms in '' "$wide" "$wide -DNEVH__GROUPS" -DNEVH__LOOPS \
        "$wide -DNEVH__FOUR_TOGETHER"; do
        compiles $compiler DRIVER native/steps/block_driver.h $forms
    done
    compiles $compiler DRIVER native/steps/long_driver.h $wide -DNEVH__LOOPS
    for forms in '' "$wide" "$wide -DNEVH__LOOPS" "-DNEVH__FOR_READERS -DNEVH__KEEPS" \
        "-DNEVH__FOR_READERS -DNEVH__KEEPS -DNEVH__LOOPS"; do
        compiles $compiler SPLITTING native/steps/splitting_whole.h -DNEVH__FINITE $forms
    done
    for forms in '' "$wide" "$wide -DNEVH__LOOPS"; do
        compiles $compiler PARTS native/steps/parts_driver.h $forms
    done
    for forms in '' -DNEVH__FOR_READERS -DNEVH__ADAPTS \
        '-DNEVH__ADAPTS -DNEVH__FOR_READERS'; do
        compiles $compiler NYSTROM native/steps/nystrom_driver.h -DNEVH__SUMS $forms
        compiles $compiler RUNGE_KUTTA native/steps/runge_kutta_driver.h -DNEVH__SUMS \
            -DNEVH__FRICTION $forms
    done
    for forms in "$wide" "$wide -DNEVH__LOOPS" '-DNEVH__FOR_READERS -DNEVH__LOOPS'; do
        compiles $compiler RUNGE_KUTTA native/steps/runge_kutta_driver.h -DNEVH__SUMS \
            -DNEVH__FRICTION $forms
    done
    compiles $compiler SPLITTING native/steps/splitting_parts.h $wide -DNEVH__LOOPS
    compiles $compiler SPLITTING native/steps/splitting_groups.h $wide -DNEVH__LOOPS \
        -DNEVH__TAKES_STEPS
    compiles $compiler DRIVER native/steps/compiled_needs.h \
        -DNEVH__SIDE_BY_SIDE -DNEVH__STAGES
    for forms in '' -DNEVH__TWO_ORDERS; do
        compiles $compiler FORMULAS native/steps/series_sums.h $forms -DTOGETHER=8
        compiles $compiler FORMULAS native/steps/series_sums.h $forms -DTOGETHER=4
    done
    compiles $compiler FORMULAS native/steps/formula_needs.h -DNEVH__FOR_READERS
    compiles $compiler FORMULAS native/steps/loop_needs.h -DNEVH__LOOPS
    for forms in '' -DNEVH__OWN_TIME -DNEVH__WHOLE_STEPS '-DNEVH__WHOLE_STEPS -DNEVH__STAGES'; do
        compiles $compiler FORMULAS native/steps/program_main.h -DNEVH__FOR_READERS \
            -DNEVH__ENERGY $forms
    done
    for forms in -DNEVH__KEEPS '-DNEVH__KEEPS -DNEVH__LOOPS -DNEVH__FINITE' \
        '-DNEVH__KEEPS -DNEVH__SUMS -DNEVH__STAGES'; do
        compiles $compiler DRIVER native/steps/block_driver.h \
            -DNEVH__FOR_READERS $forms
    done
done

# What NEVH__COMPILED stands for ends in its line.
awk '{ rest = $0
       while (match(rest, /NEVH__COMPILED\(/)) {
           rest = substr(rest, RSTART + RLENGTH)
           open = 1
           for (i = 1; i <= length(rest) && open > 0; i++) {
               c = substr(rest, i, 1)
               open += (c == "(") - (c == ")")
           }
           if (open > 0) { print FILENAME ":" FNR ": " $0; found = 1 }
       } }
     END { exit !found }' "$srcdir"/lib/native/steps/*.h && status=1

# Each header is tried, and a wrong one is found.
for header in "$srcdir"/lib/native/steps/*.h; do
    grep -q "native/steps/${header##*/}" "$0" "$srcdir/tests/native/step_header.c" \
        "$srcdir"/lib/native/steps/*.h || { echo "$header is not tried"; status=1; }
done
sed 's/size_t done = 0;/size_t done = t;/' \
    "$srcdir/lib/native/steps/adaptive_driver.h" >$work/wrong.h
(compiles "$cc" ADAPTIVE "$PWD/$work/wrong.h" >/dev/null; exit $status) &&
    { echo "a wrong header compiles"; status=1; }
exit $status

#!/bin/sh
# Targets of make fuzz, which needs clang and time, at least compile and link,
# and take no input for an answer.

srcdir=${srcdir:-.}
work=fuzz_compiles.$$
trap 'rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1
FUZZ_FOLDER=$work
export FUZZ_FOLDER
cat >$work/main.c <<'EOF'
#include <stddef.h>
#include <stdint.h>
int LLVMFuzzerTestOneInput(const uint8_t *, size_t);
int main(void) {
    static const uint8_t none[1];
    return LLVMFuzzerTestOneInput(none, 0);
}
EOF
# Flags are lists.
# shellcheck disable=SC2086
compile() {
    ${CC:-cc} -std=c11 $SANITIZE_FLAGS -Wall -Wextra -Werror -D_GNU_SOURCE -DNEVH_PORTABLE \
        '-DNEVH_SCENES="/nowhere"' '-DNEVH_PAGE="/nowhere"' '-DNEVH_PACKAGE="/nowhere"' -I"$srcdir/include" -I"$srcdir/lib" \
        -I"$srcdir/tools" $GSL_CFLAGS "$@"
}

# the parts of the command as they were built, all but main
# shellcheck disable=SC2046
ar rc $work/parts.a $(find tools -name 'nevh-*.o' ! -name nevh-nevh.o) || exit 1
# shellcheck disable=SC2086
for target in "$srcdir"/tests/robust/fuzz/*.c; do
    compile "$target" $work/main.c $work/parts.a .libs/libnevh_core.a \
        ${GSL_LIBS:--lgsl -lgslcblas} $QUADMATH_LIBS -lm -ldl \
        -o $work/target || exit 1
    $work/target || exit 1
done

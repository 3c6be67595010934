#!/bin/sh
# Targets of make fuzz, which needs clang and time, at least compile.

srcdir=${srcdir:-.}
# Flags are lists.
# shellcheck disable=SC2086
for target in "$srcdir"/tests/fuzz/*.c; do
    ${CC:-cc} -std=c11 -fsyntax-only -Wall -Wextra -Werror -D_GNU_SOURCE -DNEVH_PORTABLE \
        -I"$srcdir/include" -I"$srcdir/lib" -I"$srcdir/tools" $GSL_CFLAGS \
        "$target" || exit 1
done

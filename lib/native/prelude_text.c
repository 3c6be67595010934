/* nevh: what formulas as C text need before them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/writer_private.h"
#include <nevh/simd.h>

const nevh__lane_words nevh__eight = {"wide", "ALL", "EACH_LANE", "wide_"};
const nevh__lane_words nevh__four = {"few", "ALL_FOUR", "EACH_OF_FOUR", "few_"};

int nevh__vector_lanes(void) {
#ifdef NEVH__VECTORS
    __builtin_cpu_init();
    if (__builtin_cpu_supports("x86-64-v4"))
        return 8;
    return __builtin_cpu_supports("x86-64-v3") ? 4 : 2;
#else
    return 1;
#endif
}

void nevh__write_prelude(nevh__writer *w) {
    int lanes = nevh__vector_lanes();
    nevh__write_lines(w, nevh__compiled_formulas_text);
    nevh__write_lines(w, nevh__formula_needs_text);
    if (lanes == 8)
        nevh__write(w, "#ifndef __AVX512F__\n#error no vectors of eight\n"
                       "#endif\n");
    if (lanes == 4)
        nevh__write(w, "#ifndef __AVX2__\n#error no vectors of four\n#endif\n");
}

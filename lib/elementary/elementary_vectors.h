/* nevh: elementary functions of vectors of one instruction set, exported under the names
   that GCC calls.  The includer, elementary.c, defines TARGET, that set; VECTOR, the type;
   ABI(rest) and NAME(f), names of what is exported and of what is called; and what
   elementary_lanes.h asks for.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ELEMENTARY_VECTORS_H /* never defined */
#include "elementary/elementary_lanes.h"

#define ONE(name, f, family)                                                   \
    TARGET NEVH_API VECTOR ABI(v_nevh_simd_##name)(VECTOR);                    \
    TARGET VECTOR ABI(v_nevh_simd_##name)(VECTOR x) {                          \
        return NAME(f)(x);                                                     \
    }
#define TWO(name, f, family)                                                   \
    TARGET NEVH_API VECTOR ABI(vv_nevh_simd_##name)(VECTOR, VECTOR);           \
    TARGET VECTOR ABI(vv_nevh_simd_##name)(VECTOR x, VECTOR y) {               \
        return NAME(f)(x, y);                                                  \
    }
NEVH__EACH_ONE(ONE)
NEVH__EACH_TWO(TWO)
#undef ONE
#undef TWO
#undef TARGET
#undef VECTOR
#undef ABI
#undef NAME
#endif

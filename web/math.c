/* nevh: functions of <math.h> in the live page's module are the library's elementary
   ones, so that it carries one set of them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "elementary/elementary_list.h"
#include <nevh/simd.h>

#define ONE(name, f, family)                                                   \
    double f(double x) {                                                       \
        return nevh_simd_##name(x);                                            \
    }
#define TWO(name, f, family)                                                   \
    double f(double x, double y) {                                             \
        return nevh_simd_##name(x, y);                                         \
    }
NEVH__EACH_ONE(ONE)
NEVH__EACH_TWO(TWO)

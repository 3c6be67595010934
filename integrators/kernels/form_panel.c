/* nevh: products of the matrices of a quadratic form's flow with a state.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "form_panel_private.h"
#include <nevh/simd.h>

#ifdef __GNUC__
#define ZERO                                                                   \
    { 0 }
#define VECTOR(side)                                                           \
    __attribute__((vector_size(8 * (side)), aligned(8), may_alias))
#else
#define ZERO 0
#endif

/* A panel's sums stay in registers while its columns pass. */
#define PANELS(name, target, number, side)                                     \
    target static void name(size_t m, const double panels[],                   \
                            const size_t ends[], const double z[],             \
                            double sum[]) {                                    \
        enum { COUNT = NEVH__PANEL / (side) };                                 \
        const number *from = (const number *)panels;                           \
        for (size_t k = 0; k < nevh__panel_count(m); k++, ends += 2) {         \
            number high[COUNT] = {ZERO}, low[COUNT] = {ZERO};                  \
            for (size_t j = ends[0]; j < ends[1]; j++) {                       \
                const number *x = from + 2 * COUNT * (k * (m + 1) + j);        \
                NEVH_UNROLL                                                    \
                for (size_t i = 0; i < COUNT; i++) {                           \
                    high[i] += x[i] * z[j];                                    \
                    low[i] += x[COUNT + i] * z[j];                             \
                }                                                              \
            }                                                                  \
            NEVH_UNROLL                                                        \
            for (size_t i = 0; i < COUNT; i++)                                 \
                ((number *)sum)[k * COUNT + i] = high[i] + low[i];             \
        }                                                                      \
    }

#ifdef __GNUC__
typedef double couple VECTOR(2);
PANELS(by_two, , couple, 2)
#else
PANELS(by_two, , double, 1)
#endif

#if defined __GNUC__ && defined __x86_64__
typedef double four VECTOR(4);
typedef double eight VECTOR(8);
PANELS(by_four, __attribute__((target("avx2"))), four, 4)
PANELS(by_eight, __attribute__((target("avx512f,avx512dq"))), eight, 8)

nevh__panels_fn *nevh__panels_choose(size_t side) {
    __builtin_cpu_init();
    if (side >= 8 && __builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512dq"))
        return by_eight;
    return side >= 4 && __builtin_cpu_supports("avx2") ? by_four : by_two;
}
#else
nevh__panels_fn *nevh__panels_choose(size_t side) {
    (void)side;
    return by_two;
}
#endif

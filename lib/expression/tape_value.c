/* nevh: a tape for one state.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "expression/tape_operations_private.h"

#define CASE(kind, identifier, name, arity, value, by_a, by_b, ...)            \
    case NEVH__##identifier:                                                   \
        return value;
/* also: out, the cosine where the sine is returned. */
NEVH__INLINE double apply(unsigned operation, double a, double b,
                          double *also) {
    switch (operation) {
        NEVH__OPERATIONS(CASE)
    case NEVH__SINCOS:
        *also = nevh_simd_cos(a);
        return nevh_simd_sin(a);
    default:
        return NAN;
    }
}
#undef CASE

double nevh__operation_value(nevh__tape_operation operation, double a,
                             double b) {
    return apply(operation, a, b, NULL);
}

double nevh__tape_value(double t, const double q[], const double p[],
                        const double c[], const void *tape) {
    const struct nevh__tape *of = tape;
    double slots[NEVH__TAPE_LIVE];
    const double *const base[NEVH__KINDS] = {&t, q, p, c, slots, of->numbers};
    const nevh__instruction *end = of->code + of->length;
    for (const nevh__instruction *i = of->code; i < end; i++)
        slots[i->to] = apply(i->operation, base[i->a.kind][i->a.at],
                             base[i->b.kind][i->b.at], &slots[i->also]);
    return base[of->result.kind][of->result.at];
}

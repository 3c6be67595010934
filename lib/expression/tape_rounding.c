/* nevh: how far rounding may move the value of a tape: a bound that runs along
   with the operations [J. H. Wilkinson, "Error analysis revisited", IMA Bulletin
   22 (1986) 192-200].
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "expression/tape_operations_private.h"
#include <float.h>
#include <math.h>

/* Each operation's own roundings are below that, relative to its result. */
static const double own = 2 * DBL_EPSILON;

typedef struct {
    double value, error;
} number;

/* The errors of the arguments, which may be of any sign, times the derivatives
   by them. */
#define CASE(kind, identifier, name, arity, formula, by_a, by_b, ...)          \
    case NEVH__##identifier: {                                                 \
        y = formula;                                                           \
        g = u.error;                                                           \
        double from_a = g == 0 ? 0 : fabs((double)(by_a));                     \
        g = v.error;                                                           \
        return (number){y, from_a + (g == 0 ? 0 : fabs((double)(by_b)))};      \
    }
NEVH__INLINE number apply(unsigned operation, number u, number v,
                          number *also) {
    double a = u.value, b = v.value, y, g;
    switch (operation) {
        NEVH__OPERATIONS(CASE)
    case NEVH__SINCOS:
        y = nevh_simd_sin(a);
        *also = (number){nevh_simd_cos(a), fabs(y) * u.error};
        also->error += own * fabs(also->value);
        return (number){y, fabs(also->value) * u.error};
    default:
        return (number){NAN, NAN};
    }
}
#undef CASE

double nevh__tape_rounding(double t, const double q[], const double p[],
                           const double c[], const void *tape) {
    const struct nevh__tape *of = tape;
    number slots[NEVH__TAPE_LIVE];
    const double *const base[NEVH__KINDS] = {&t, q, p, c, NULL, of->numbers};
    const nevh__instruction *end = of->code + of->length;
    for (const nevh__instruction *i = of->code; i < end; i++) {
        number arguments[2];
        for (int k = 0; k < 2; k++) {
            const nevh__tape_operand *o = k ? &i->b : &i->a;
            arguments[k] = o->kind == NEVH__SLOT
                               ? slots[o->at]
                               : (number){base[o->kind][o->at], 0};
        }
        number y =
            apply(i->operation, arguments[0], arguments[1], &slots[i->also]);
        if (!nevh__operation_of(i->operation)->exact)
            y.error += own * fabs(y.value);
        slots[i->to] = y;
    }
    return of->result.kind == NEVH__SLOT ? slots[of->result.at].error : 0;
}

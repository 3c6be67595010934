/* nevh: a tape for one state over complex numbers of tiny imaginary part:
   f(a + ib) = f(a) + ib f'(a), so that nothing cancels and the real part is
   the scalar value to the bit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "expression/tape_operations_private.h"
#include <string.h>

#define NEVH__F(f) f

/* What is real stays real, also where f' is infinite or is not. */
#define TIMES(slope, imaginary)                                                \
    ((imaginary) == 0 ? 0 : nevh__chain(slope, imaginary))
#define CASE(identifier, value, slope_a, slope_b)                              \
    case NEVH__##identifier:                                                   \
        y = value;                                                             \
        h[1] = TIMES(slope_a, x[1]) + TIMES(slope_b, z[1]);                    \
        break;
static void apply(const nevh__instruction *i, const double x[2],
                  const double z[2], double h[2]) {
    double a = x[0], b = z[0], y = NAN;
    switch (i->operation) {
        NEVH__FORMULAS(CASE)
    default:
        break;
    }
    h[0] = y;
}
#undef CASE

typedef struct {
    const double (*variables[2])[2]; /* q, p */
    const double *reals[NEVH__KINDS];
    const double (*slots)[2];
} state;

static void fetch(const state *s, nevh__operand o, double x[2]) {
    const double(*from)[2] = o.kind == NEVH__Q   ? s->variables[0]
                             : o.kind == NEVH__P ? s->variables[1]
                                                 : s->slots;
    if (o.kind == NEVH__Q || o.kind == NEVH__P || o.kind == NEVH__SLOT) {
        memcpy(x, from[o.at], 2 * sizeof *x);
    } else {
        x[0] = s->reals[o.kind][o.at];
        x[1] = 0;
    }
}

void nevh__tape_complex(double t, const double q[][2], const double p[][2],
                        const double c[], const void *tape, double h[2]) {
    const struct nevh__tape *of = tape;
    double slots[NEVH__TAPE_LIVE][2], a[2], b[2];
    const state s = {
        .variables = {q, p},
        .reals = {[NEVH__T] = &t, [NEVH__C] = c, [NEVH__NUMBER] = of->numbers},
        .slots = (const double(*)[2])slots};
    const nevh__instruction *end = of->code + of->length;
    for (const nevh__instruction *i = of->code; i < end; i++) {
        fetch(&s, i->a, a);
        fetch(&s, i->b, b);
        apply(i, a, b, slots[i->to]);
    }
    fetch(&s, of->result, h);
}

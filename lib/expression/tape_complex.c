/* nevh: a tape for one state over complex numbers of tiny imaginary part:
   f(a + ib) = f(a) + ib f'(a), so that nothing cancels and the real part is
   the scalar value to the bit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "expression/tape_operations_private.h"

typedef struct {
    double re, im;
} number;

/* A real argument gives a real result, even if the derivative is not finite. */
#define CASE(kind, identifier, name, arity, value, by_a, by_b, ...)            \
    case NEVH__##identifier: {                                                 \
        double y = value, g = u.im, im = g == 0 ? 0 : by_a;                    \
        g = v.im;                                                              \
        return (number){y, g == 0 ? im : im + by_b};                           \
    }
NEVH__INLINE number apply(unsigned operation, number u, number v,
                          number *also) {
    double a = u.re, b = v.re;
    switch (operation) {
        NEVH__OPERATIONS(CASE)
    case NEVH__SINCOS: {
        double sine = nevh_simd_sin(a), cosine = nevh_simd_cos(a);
        *also = (number){cosine, -sine * u.im};
        return (number){sine, cosine * u.im};
    }
    default:
        return (number){NAN, NAN};
    }
}
#undef CASE

/* Real and imaginary parts of each kind of operand, and their distances. */
typedef struct {
    const double *re[NEVH__KINDS], *im[NEVH__KINDS];
} parts;
static const size_t re_pitch[] = {1, 2, 2, 1, 2, 1};
static const size_t im_pitch[] = {0, 2, 2, 0, 2, 0};
_Static_assert(sizeof re_pitch / sizeof *re_pitch == NEVH__KINDS &&
                   sizeof im_pitch / sizeof *im_pitch == NEVH__KINDS,
               "each kind of operand");

static inline number fetch(const parts *s, nevh__tape_operand o) {
    return (number){s->re[o.kind][o.at * re_pitch[o.kind]],
                    s->im[o.kind][o.at * im_pitch[o.kind]]};
}

void nevh__tape_complex(double t, const double q[][2], const double p[][2],
                        const double c[], const void *tape, double h[2]) {
    static const double none = 0;
    const struct nevh__tape *of = tape;
    number slots[NEVH__TAPE_LIVE];
    const double *re_q = q ? q[0] : NULL, *re_p = p ? p[0] : NULL;
    const parts s = {{&t, re_q, re_p, c, &slots->re, of->numbers},
                     {&none, q ? re_q + 1 : NULL, p ? re_p + 1 : NULL, &none,
                      &slots->im, &none}};
    const nevh__instruction *end = of->code + of->length;
    for (const nevh__instruction *i = of->code; i < end; i++)
        slots[i->to] = apply(i->operation, fetch(&s, i->a), fetch(&s, i->b),
                             &slots[i->also]);
    number result = fetch(&s, of->result);
    h[0] = result.re;
    h[1] = result.im;
}

/* nevh: Lobatto IIIA-IIIB coefficients for any number of stages.

   Nodes are the ends and the zeros of P'_{s-1}, by Newton's method in long
   double, with (1 - x^2) P'' = 2 x P' - (s-1) s P; the weights on [0, 1] are
   1 / (s (s-1) P_{s-1}(x)^2).
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tableau_private.h"
#include <math.h>

enum { ROUNDS = 8 };

/* Fills node i counted from above, and its mirror image. */
static void find_node(nevh__rule *r, size_t i) {
    size_t s = r->stages;
    long double m = (long double)((s - 1) * s), value = 1, slope = 0;
    long double x = cos(acos(-1.0) * (double)i / (double)(s - 1));
    for (int k = 0; i > 0 && k < ROUNDS; k++) {
        value = nevh__legendre(s - 1, x, &slope);
        x -= slope * (1 - x * x) / (2 * x * slope - m * value);
    }
    if (i > 0)
        value = nevh__legendre(s - 1, x, &slope);
    r->c[i] = (1 - x) / 2;
    r->c[s - 1 - i] = (1 + x) / 2;
    r->b[i] = r->b[s - 1 - i] = 1 / (m * value * value);
}

nevh__tableau *nevh__lobatto_new(size_t stages) {
    nevh__rule r = {stages, {0}, {0}};
    for (size_t i = 0; 2 * i < stages; i++)
        find_node(&r, i);
    if (stages % 2)
        r.c[stages / 2] = 0.5L;
    return nevh__tableau_new(&r, false);
}

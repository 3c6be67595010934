/* nevh: Gauss-Legendre rules for any number of stages.

   Nodes are the zeros of the Legendre polynomial P_s, by Newton's method in
   long double.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tableau_private.h"
#include <math.h>

enum { ROUNDS = 8 };

long double nevh__legendre(size_t s, long double x, long double *slope) {
    long double before = 1, value = x;
    for (size_t k = 2; k <= s; k++) {
        long double next = ((long double)(2 * k - 1) * x * value -
                            (long double)(k - 1) * before) /
                           (long double)k;
        before = value;
        value = next;
    }
    *slope = (long double)s * (before - x * value) / (1 - x * x);
    return value;
}

void nevh__gauss_rule(size_t s, nevh__rule *r) {
    r->stages = s;
    for (size_t i = 0; i < s; i++) {
        long double x =
            cos(acos(-1.0) * ((double)i + 0.75) / ((double)s + 0.5));
        long double slope = 1;
        for (int k = 0; k < ROUNDS; k++)
            x -= nevh__legendre(s, x, &slope) / slope;
        nevh__legendre(s, x, &slope);
        r->c[s - 1 - i] = (1 + x) / 2;
        r->b[s - 1 - i] = 1 / ((1 - x * x) * slope * slope);
    }
}

nevh__tableau *nevh__gauss_new(size_t stages) {
    nevh__rule r;
    nevh__gauss_rule(stages, &r);
    return nevh__tableau_new(&r, true);
}

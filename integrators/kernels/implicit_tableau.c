/* nevh: tableaus of implicit methods that are given as numbers.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tableau_private.h"
#include <math.h>

/* Continues the slopes of one step by a polynomial of low degree: nodes may stand
   anywhere, and together. */
static void guess_plain(const nevh__rule *r, double guess[]) {
    enum { MOST_DEGREE = 4 };
    static const long double together = 1e-6L;
    long double weights[NEVH__MOST_STAGES];
    size_t apart = 0;
    for (size_t i = 0; i < r->stages; i++) {
        bool first = true;
        for (size_t j = 0; j < i; j++)
            first &= fabsl(r->c[i] - r->c[j]) > together;
        apart += first;
    }
    size_t degree = apart - 1 < MOST_DEGREE ? apart - 1 : MOST_DEGREE;
    for (size_t i = 0; i < r->stages; i++) {
        nevh__guess_fit(r->stages, r->c, degree, 1 + r->c[i], weights);
        for (size_t j = 0; j < r->stages; j++)
            guess[j * r->stages + i] = (double)weights[j];
    }
}

/* Slopes of a stage without a weight lead to other stages, and to the new state with
   a part that is far below rounding. */
static long double weight_of(const nevh__implicit_table *x, size_t i) {
    static const long double none = 0x1p-300L;
    return x->b[i] != 0 ? x->b[i] : none;
}

/* mu_ij and mu_ji of a symplectic method add up to 1 exactly. */
static double mu_of(const nevh__implicit_table *x, size_t i, size_t j) {
    size_t s = x->stages;
    long double mu = x->a[i * s + j] / weight_of(x, j);
    long double across = x->a[j * s + i] / weight_of(x, i);
    if (!x->symplectic)
        return (double)mu;
    if (i == j)
        return 0.5;
    bool first = mu > across || (mu == across && i < j);
    return first ? (double)mu : 1 - (double)across;
}

nevh__tableau *nevh__implicit_new(const nevh__implicit_table *x) {
    size_t s = x->stages;
    nevh__tableau *a = nevh__tableau_reserve(s, 1);
    nevh__rule r = {s, {0}, {0}};
    for (size_t i = 0; a && i < s; i++) {
        a->c[i] = (double)x->c[i];
        a->b[i] = (double)weight_of(x, i);
        r.c[i] = x->c[i];
        for (size_t j = 0; j < s; j++) {
            size_t m = j * s + i;
            a->mu_q[m] = a->mu_p[m] = mu_of(x, i, j);
            a->a_q[m] = a->a_p[m] = a->mu_q[m] * (double)weight_of(x, j);
        }
    }
    if (a) {
        guess_plain(&r, a->guess);
        nevh__tableau_sort(a);
    }
    return a;
}

/* nevh: coefficients from nodes.

   a_ij is the integral from 0 to c_i of Lagrange polynomial j, for which the
   Gauss rule with as many nodes, shrunk to (0, c_i), is exact; in long double.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tableau_private.h"
#include "system/system_private.h"
#include <math.h>
#include <stdlib.h>

/* Lagrange polynomial j on the nodes. */
static long double lagrange(const nevh__rule *r, size_t j, long double x) {
    long double value = 1;
    for (size_t k = 0; k < r->stages; k++)
        if (k != j)
            value *= (x - r->c[k]) / (r->c[j] - r->c[k]);
    return value;
}

static long double ratio(const nevh__rule *r, const nevh__rule *gauss, size_t i,
                         size_t j) {
    long double sum = 0;
    for (size_t k = 0; k < r->stages; k++)
        sum += gauss->b[k] * lagrange(r, j, r->c[i] * gauss->c[k]);
    return r->c[i] * sum / r->b[j];
}

/* One mu_q,ij of at least 1/2, and what follows from it. */
static void mirror(nevh__tableau *a, size_t i, size_t j, double mu) {
    size_t s = a->stages, across_i = s - 1 - i, across_j = s - 1 - j;
    a->mu_q[j * s + i] = a->mu_p[across_i * s + across_j] = mu;
    a->mu_p[i * s + j] = a->mu_q[across_j * s + across_i] = 1 - mu;
}

static void fill_matrices(nevh__tableau *a, const nevh__rule *r, bool alike) {
    const long double half = 0.5L - 1e-12L; /* 1/2 itself may have come less */
    size_t s = a->stages;
    nevh__rule gauss;
    nevh__gauss_rule(s, &gauss);
    for (size_t i = 0; i < s; i++)
        for (size_t j = 0; j < s; j++) {
            long double mu = alike && i == j ? 0.5L : ratio(r, &gauss, i, j);
            if (mu >= half)
                mirror(a, i, j, (double)mu);
            if (mu >= half && alike)
                mirror(a, s - 1 - j, s - 1 - i, (double)mu);
        }
    for (size_t m = 0; m < s * s; m++) {
        a->a_q[m] = a->mu_q[m] * a->b[m / s];
        a->a_p[m] = a->mu_p[m] * a->b[m / s];
    }
}

void nevh__tableau_sort(nevh__tableau *a) {
    for (size_t i = 0; i < a->stages; i++) {
        size_t at = i;
        for (; at > 0 && fabs(a->b[a->order[at - 1]]) > fabs(a->b[i]); at--)
            a->order[at] = a->order[at - 1];
        a->order[at] = i;
    }
}

static void fill(nevh__tableau *a, const nevh__rule *r, bool alike) {
    size_t s = a->stages;
    for (size_t i = 0; i < s; i++) {
        a->c[i] = (double)r->c[i];
        a->b[i] = (double)r->b[i < s - 1 - i ? i : s - 1 - i];
        for (size_t j = 0; j < s; j++)
            a->guess[j * s + i] = (double)lagrange(r, j, 1 + r->c[i]);
    }
    if (a->steps > 1)
        nevh__guess_weights(r, a->long_guess);
    fill_matrices(a, r, alike);
    nevh__tableau_sort(a);
}

nevh__tableau *nevh__tableau_reserve(size_t s, size_t steps) {
    nevh__tableau *a = nevh__array(1, sizeof *a);
    double *all = nevh__array(s * ((5 + steps) * s + 2), sizeof *all);
    size_t *order = nevh__array(s, sizeof *order);
    if (!a || !all || !order) {
        free(a);
        free(all);
        free(order);
        return NULL;
    }
    *a = (nevh__tableau){s, all, all + s, .steps = steps, .order = order};
    a->mu_q = a->b + s;
    a->mu_p = a->mu_q + s * s;
    a->a_q = a->mu_p + s * s;
    a->a_p = a->a_q + s * s;
    a->guess = a->a_p + s * s;
    a->long_guess = steps > 1 ? a->guess + s * s : a->guess;
    return a;
}

nevh__tableau *nevh__tableau_new(const nevh__rule *r, bool alike) {
    nevh__tableau *a =
        nevh__tableau_reserve(r->stages, nevh__guess_steps(r->stages));
    if (a)
        fill(a, r, alike);
    return a;
}

nevh__tableau *nevh__implicit_euler_new(size_t stages) {
    nevh__tableau *a = stages == 1 ? nevh__gauss_new(1) : NULL;
    if (a)
        *a->c = *a->mu_q = *a->mu_p = *a->a_q = *a->a_p = 1;
    return a;
}

void nevh__tableau_free(nevh__tableau *a) {
    if (!a)
        return;
    free(a->c); /* and all other numbers */
    free(a->order);
    free(a);
}

/* nevh: Gauss-Legendre coefficients for any number of stages.

   Nodes are the zeros of the shifted Legendre polynomial, by Newton's method
   in long double; a_ij is the integral from 0 to c_i of Lagrange polynomial j,
   for which the Gauss rule itself, shrunk to (0, c_i), is exact.

   A method is symplectic if b_i a_ij + b_j a_ji = b_i b_j, which for
   mu_ij = a_ij / b_j reads mu_ij + mu_ji = 1.  Rounding a and b breaks that and
   lets the energy drift by about 1e-18 a step.  So mu is rounded below the
   diagonal, where it lies in (1/2, 2), and mirrored as 1 - mu, which is exact;
   the rounded method is then symplectic to the last bit [Antonana, Makazaga,
   Murua, Numer. Algorithms (2017), sec. 3].  Its time symmetry,
   mu_{s+1-i, s+1-j} = mu_ji, is kept exactly as well.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gauss_private.h"
#include "system/system_private.h"
#include <math.h>
#include <stdlib.h>

typedef struct {
    size_t stages;
    long double c[NEVH__MOST_STAGES], b[NEVH__MOST_STAGES];
} rule;

/* P_s(x) and, by reference, its derivative; |x| < 1. */
static long double legendre(size_t s, long double x, long double *slope) {
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

static void find_rule(size_t s, rule *r) {
    r->stages = s;
    for (size_t i = 0; i < s; i++) {
        long double x = cosl(acosl(-1.0L) * ((long double)i + 0.75L) /
                             ((long double)s + 0.5L));
        long double slope = 1;
        for (int k = 0; k < 8; k++)
            x -= legendre(s, x, &slope) / slope;
        legendre(s, x, &slope);
        r->c[s - 1 - i] = (1 + x) / 2;
        r->b[s - 1 - i] = 1 / ((1 - x * x) * slope * slope);
    }
}

/* Lagrange polynomial j on the nodes. */
static long double lagrange(const rule *r, size_t j, long double x) {
    long double value = 1;
    for (size_t k = 0; k < r->stages; k++)
        if (k != j)
            value *= (x - r->c[k]) / (r->c[j] - r->c[k]);
    return value;
}

static long double ratio(const rule *r, size_t i, size_t j) {
    long double sum = 0;
    for (size_t k = 0; k < r->stages; k++)
        sum += r->b[k] * lagrange(r, j, r->c[i] * r->c[k]);
    return r->c[i] * sum / r->b[j];
}

/* mu_ij, i > j, decides mu_ji and the two across the middle. */
static void fill_mu(nevh__gauss *g, const rule *r) {
    size_t s = g->stages;
    for (size_t i = 0; i < s; i++) {
        g->mu[i * s + i] = 0.5;
        for (size_t j = 0; j < i; j++) {
            size_t across_i = s - 1 - i, across_j = s - 1 - j;
            double mu = (double)ratio(r, i, j);
            g->mu[j * s + i] = g->mu[across_i * s + across_j] = mu;
            g->mu[i * s + j] = g->mu[across_j * s + across_i] = 1 - mu;
        }
    }
}

static void fill_order(nevh__gauss *g) {
    for (size_t i = 0; i < g->stages; i++) {
        size_t at = i;
        for (; at > 0 && g->b[g->order[at - 1]] > g->b[i]; at--)
            g->order[at] = g->order[at - 1];
        g->order[at] = i;
    }
}

static void fill(nevh__gauss *g) {
    rule r;
    size_t s = g->stages;
    find_rule(s, &r);
    fill_mu(g, &r);
    for (size_t i = 0; i < s; i++) {
        g->c[i] = (double)r.c[i];
        g->b[i] = (double)r.b[i < s - 1 - i ? i : s - 1 - i];
        for (size_t j = 0; j < s; j++)
            g->guess[j * s + i] = (double)lagrange(&r, j, 1 + r.c[i]);
    }
    fill_order(g);
}

nevh__gauss *nevh__gauss_new(size_t stages) {
    nevh__gauss *g = nevh__array(1, sizeof *g);
    if (!g)
        return NULL;
    g->stages = stages;
    g->c = nevh__array(stages, sizeof *g->c);
    g->b = nevh__array(stages, sizeof *g->b);
    g->mu = nevh__array(stages * stages, sizeof *g->mu);
    g->guess = nevh__array(stages * stages, sizeof *g->guess);
    g->order = nevh__array(stages, sizeof *g->order);
    if (g->c && g->b && g->mu && g->guess && g->order) {
        fill(g);
        return g;
    }
    nevh__gauss_free(g);
    return NULL;
}

void nevh__gauss_free(nevh__gauss *g) {
    if (!g)
        return;
    free(g->c);
    free(g->b);
    free(g->mu);
    free(g->guess);
    free(g->order);
    free(g);
}

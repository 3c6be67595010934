/* nevh: first guesses for the slopes of an implicit step.

   They continue what the last steps' slopes were at the nodes, in units of h from
   the start of the last step:

   - The polynomial of degree s + 2 that fits 2s slopes of the last two steps by
     least squares, G, leads on to the next nodes.  Of all weights that are exact
     up to a degree these multiply rounding by the least; of this degree about as
     much as the last step's polynomial does.
   - Slopes of a method of low order are not of one smooth function of time,
     those at one node are: so is the error of G at each node, from step to
     step, which is continued by differences of order m,

         guess_n+1 = G_n+1 + e_n + (e_n - e_n-1) + ...,   e_n = F_n - G_n.

   Up to sixteen slopes take part.  Compared with the polynomial of the last step
   alone [E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration,
   VIII.6.1] that saves 34 sweeps in a hundred of the midpoint rule, 20 of gauss4
   and 13 of gauss8, in all of check_implicit's four systems.  From six stages on
   it is that polynomial: two steps would save 5 of gauss16, which they cost.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tableau_private.h"

/* Slopes that take part, and steps. */
enum { SLOPES = 16, MOST_STEPS = 9, FITTED = 2, FEW_STAGES = 5 };

size_t nevh__guess_steps(size_t stages) {
    size_t steps = SLOPES / stages;
    return stages > FEW_STAGES ? 1 : steps < MOST_STEPS ? steps : MOST_STEPS;
}

/* The degree for s derivatives a step; nodes at the ends belong to two steps. */
static size_t degree_of(const nevh__rule *r) {
    size_t s = r->stages, most = r->c[0] > 0 ? 2 * s - 1 : 2 * s - 2;
    return s + 2 < most ? s + 2 : most;
}

/* Sums of polynomials that are orthogonal on x, one degree after the other. */
void nevh__guess_fit(size_t count, const long double x[], size_t degree,
                     long double to, long double weights[]) {
    long double last[FITTED * NEVH__MOST_STAGES];
    long double now[FITTED * NEVH__MOST_STAGES];
    long double last_to = 0, now_to = 1, last_norm = 1,
                norm = (long double)count;
    for (size_t j = 0; j < count; j++) {
        weights[j] = last[j] = 0;
        now[j] = 1;
    }
    for (size_t k = 0;; k++) {
        long double centre = 0, ratio = k ? norm / last_norm : 0, next_norm = 0;
        for (size_t j = 0; j < count; j++) {
            weights[j] += now_to * now[j] / norm;
            centre += x[j] * now[j] * now[j] / norm;
        }
        if (k == degree)
            return;
        for (size_t j = 0; j < count; j++) {
            long double next = (x[j] - centre) * now[j] - ratio * last[j];
            last[j] = now[j];
            now[j] = next;
            next_norm += next * next;
        }
        long double next_to = (to - centre) * now_to - ratio * last_to;
        last_to = now_to;
        now_to = next_to;
        last_norm = norm;
        norm = next_norm;
    }
}

/* Stage i of a rule: its fit, and differences of that's error. */
static void find_weights(const nevh__rule *r, const long double x[], size_t i,
                         double guess[]) {
    const size_t s = r->stages, fitted = FITTED * s;
    const size_t order = nevh__guess_steps(s) - FITTED;
    long double fits[FITTED * NEVH__MOST_STAGES], part = -1;
    long double sums[SLOPES + FITTED * NEVH__MOST_STAGES] = {0};
    nevh__guess_fit(fitted, x, degree_of(r), 1 + r->c[i], fits);
    for (size_t j = 0; j < fitted; j++)
        sums[j] = fits[j];
    for (size_t k = 1; k <= order; k++) {
        part *= -(long double)(order - k + 1) / (long double)k;
        sums[(k - 1) * s + i] += part;
        for (size_t j = 0; j < fitted; j++)
            sums[k * s + j] -= part * fits[j];
    }
    for (size_t j = 0; j < nevh__guess_steps(s) * s; j++)
        guess[j * s + i] = (double)sums[j];
}

void nevh__guess_weights(const nevh__rule *r, double guess[]) {
    long double x[FITTED * NEVH__MOST_STAGES];
    for (size_t j = 0; j < FITTED * r->stages; j++)
        x[j] = r->c[j % r->stages] - (long double)(j / r->stages);
    for (size_t i = 0; i < r->stages; i++)
        find_weights(r, x, i, guess);
}

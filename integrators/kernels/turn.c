/* nevh: kicks of steps by parts that turn oscillators, H = V((s q^2 + p^2/s)/2, ...).
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "turn_private.h"
#include "system/parts_private.h"
#include <math.h>
#include <stdlib.h>

struct nevh__turns {
    size_t n;
    double scale[]; /* n */
};

static bool turns_term(const nevh__planned *term) {
    return term->part == NEVH__KICK && term->term->decl.np;
}

static int turns_find(const nevh_field *f, nevh__turns *x) {
    for (size_t i = 0; i < f->n_terms; i++) {
        const nevh__planned *term = &f->terms[i];
        size_t nq = term->nq;
        double *room =
            turns_term(term)
                ? nevh__array(nevh__form_room(&term->term->decl) + nq,
                              sizeof *room)
                : NULL;
        if (turns_term(term) && !room)
            return NEVH_ENOMEM;
        for (size_t k = 0; room && k < term->term->decl.count; k++) {
            nevh__turn_find(term->term, k, room, room + nq);
            for (size_t j = 0; j < nq; j++)
                x->scale[nevh__index(term, k, j)] = room[j];
        }
        free(room);
    }
    return NEVH_OK;
}

int nevh__turns_new(const nevh_field *f, nevh__turns **turns) {
    bool any = false;
    for (size_t i = 0; i < f->n_terms; i++)
        any |= turns_term(&f->terms[i]);
    *turns = NULL;
    if (!any)
        return NEVH_OK;
    nevh__turns *x = nevh__array(1, sizeof *x + f->n * sizeof *x->scale);
    if (!x)
        return NEVH_ENOMEM;
    x->n = f->n;
    *turns = x;
    return turns_find(f, x);
}

void nevh__turns_free(nevh__turns *x) {
    free(x);
}

/* The angle is h (q dV/dq + p dV/dp) / (s q^2 + p^2/s); u and v are of about 1, and
   nothing overflows. */
NEVH__INLINE void turn(double s, double h, double q, double p, double slope_q,
                       double slope_p, double *dq, double *dp) {
    double size = fabs(q) > fabs(p) / s ? fabs(q) : fabs(p) / s;
    double whole = size > 0 ? size : 1, u = q / whole, v = p / (s * whole);
    double action = s * whole * (u * u + v * v);
    double half =
        0.5 * h * (u * slope_q + s * v * slope_p) / (action > 0 ? action : 1);
    double c = nevh_simd_cos(half), d = nevh_simd_sin(half);
    *dq += 2 * d * (c * p / s - d * q);
    *dp -= 2 * d * (c * s * q + d * p);
}

NEVH_SIMD static void turn_all(const nevh__turns *x, size_t width, double h,
                               const double q[], const double p[],
                               const double slope_q[], const double slope_p[],
                               double dq[], double dp[]) {
    for (size_t k = 0; k < x->n; k++)
        for (size_t i = k * width; i < (k + 1) * width; i++)
            if (x->scale[k] > 0)
                turn(x->scale[k], h, q[i], p[i], slope_q[i], slope_p[i], &dq[i],
                     &dp[i]);
            else
                dp[i] -= h * slope_q[i];
}

void nevh__turns_add(const nevh__turns *x, size_t width, double h,
                     const double q[], const double p[], const double slope_q[],
                     const double slope_p[], double dq[], double dp[]) {
    turn_all(x, width, h, q, p, slope_q, slope_p, dq, dp);
}

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
        if (!turns_term(term))
            continue;
        double *s = nevh__array(term->nq + 1, sizeof *s);
        size_t *of = nevh__array(term->nq + 1, sizeof *of);
        bool room = s && of;
        for (size_t k = 0; room && k < term->term->decl.count; k++) {
            nevh__turn_find(term->term, k, of, s);
            for (size_t j = 0; j < term->nq; j++)
                if (s[j] > 0)
                    x->scale[nevh__index(term, k, j)] = s[j];
        }
        free(s);
        free(of);
        if (!room)
            return NEVH_ENOMEM;
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

/* Rows of numbers at each coordinate, of which some are beside one another. */
typedef struct {
    const double *q, *p, *slope_q, *slope_p;
    double *dq, *dp;
} rows;

NEVH__INLINE void turn_at(const rows *x, double s, double h, size_t i) {
    turn(s, h, x->q[i], x->p[i], x->slope_q[i], x->slope_p[i], &x->dq[i],
         &x->dp[i]);
}

/* Coordinates in turn, of one orbit. */
NEVH_SIMD static void turn_some(const double scale[], size_t from, size_t to,
                                double h, rows x) {
    size_t whole = (to - from) / 8 * 8;
    NEVH_LANES(i, whole) {
        turn_at(&x, scale[from + i], h, from + i);
    }
    for (size_t i = from + whole; i < to; i++)
        turn_at(&x, scale[i], h, i);
}

/* A coordinate of orbits side by side. */
NEVH_SIMD static void turn_lanes(double s, size_t from, size_t width, double h,
                                 rows x) {
    size_t whole = width / 8 * 8;
    NEVH_LANES(i, whole) {
        turn_at(&x, s, h, from + i);
    }
    for (size_t i = from + whole; i < from + width; i++)
        turn_at(&x, s, h, i);
}

void nevh__turns_add(const nevh__turns *x, size_t width, double h,
                     const double q[], const double p[], const double slope_q[],
                     const double slope_p[], double dq[], double dp[]) {
    const rows all = {q, p, slope_q, slope_p, dq, dp};
    for (size_t k = 0, to = 0; k < x->n; k = to) {
        bool turned = x->scale[k] > 0;
        while (to < x->n && (x->scale[to] > 0) == turned)
            to++;
        for (size_t i = k * width; !turned && i < to * width; i++)
            dp[i] -= h * slope_q[i];
        if (turned && width == 1)
            turn_some(x->scale, k, to, h, all);
        for (size_t i = k; turned && width > 1 && i < to; i++)
            turn_lanes(x->scale[i], i * width, width, h, all);
    }
}

/* nevh: central differences of any order.

   The derivative with respect to variable x of a term h is a weighted sum of
   the slopes of chords,

       dh/dx = sum_j w_j (h(x+_j) - h(x-_j)) / (x+_j - x-_j),
       x+-_j = x +- j delta,  j = 1 ... order/2,

   divided by the difference of the arguments as they were rounded.  All points
   of many variables, instances and lanes go through one block evaluation.
   Error: c delta^order times the (order+1)-th derivative, plus rounding of
   about epsilon |h| / delta.  The step delta is fixed for the life of a
   field: one that followed the state would break time reversal.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <math.h>

/* The differenced variables of each instance, and the points on each side. */
typedef struct {
    const size_t *vars;
    size_t count, pairs;
} selection;

/* Columns of one group come in pairs, + before -, nearest first. */
static void perturb(double *row, size_t pairs, size_t lanes, double delta) {
    for (size_t j = 0; j < pairs; j++) {
        double shift = (double)(j + 1) * delta;
        double *plus = row + 2 * j * lanes, *minus = plus + lanes;
        for (size_t lane = 0; lane < lanes; lane++) {
            plus[lane] += shift;
            minus[lane] -= shift;
        }
    }
}

/* Adds the weighted chord slopes of one group to `out`, a value a lane.
   Returns whether all are finite. */
static bool add_slopes(const nevh_gradient *g, size_t lanes, const double *x,
                       const double *h, double *out) {
    double check = 0;
    for (size_t lane = 0; lane < lanes; lane++) {
        double slope = 0;
        for (size_t j = 0; j < g->offsets; j++) {
            size_t plus = 2 * j * lanes + lane, minus = plus + lanes;
            slope +=
                g->weights[j] * ((h[plus] - h[minus]) / (x[plus] - x[minus]));
        }
        out[lane] += slope;
        check += slope - slope;
    }
    return check == 0;
}

static int fail_slope(nevh_field *f, const nevh__planned *term,
                      const nevh__block *b, size_t instance, size_t k) {
    const nevh_term *is = &term->term->is;
    return nevh__fail(
        &f->report, NEVH_EDOM,
        "the derivative of term \"%s\" of effect \"%s\" with respect to "
        "%c[%zu] is not finite at t = %.9g: its step of %g is lost in a value "
        "too large, or too small for the values of H; give a gradient step",
        is->name, is->effect, k < term->nq ? 'q' : 'p',
        nevh__index(term, instance, k), b->t[b->lane],
        term->delta[instance * term->nv + k]);
}

static int difference_block(nevh_field *f, nevh__planned *term, nevh__block *b,
                            selection s, double dh_dq[], double dh_dp[]) {
    /* One pair is the difference of order 2, whatever the method. */
    const nevh_gradient *g = s.pairs == 1 ? nevh_central2 : f->gradient;
    size_t columns = b->copies * b->lanes;
    for (size_t group = 0; group < b->groups; group++) {
        size_t instance = (b->group + group) / s.count;
        size_t k = s.vars[(b->group + group) % s.count];
        perturb(f->rows + k * b->stride + group * columns, g->offsets, b->lanes,
                term->delta[instance * term->nv + k]);
    }
    int status = nevh__block_values(f, term, b);
    for (size_t group = 0; !status && group < b->groups; group++) {
        size_t instance = (b->group + group) / s.count;
        size_t k = s.vars[(b->group + group) % s.count];
        double *out = k < term->nq ? dh_dq : dh_dp;
        out += nevh__index(term, instance, k) * b->width + b->lane;
        if (!add_slopes(g, b->lanes, nevh__row(f, b, k) + group * columns,
                        f->h + group * columns, out))
            status = fail_slope(f, term, b, instance, k);
    }
    return status;
}

/* The part of a pass that is wanted. */
static selection select_vars(const nevh__planned *term, const nevh__pass *pass,
                             bool q, bool p) {
    size_t begin = q ? pass->begin : pass->first_p;
    size_t end = p ? pass->end : pass->first_p;
    return (selection){term->vars + begin, end - begin, pass->pairs};
}

int nevh__central(nevh_field *f, nevh__planned *term, size_t width,
                  const double t[], const double q[], const double p[],
                  double dh_dq[], double dh_dp[]) {
    int status = NEVH_OK;
    for (int i = 0; i < 2; i++) {
        selection s = select_vars(term, &term->pass[i], dh_dq, dh_dp);
        nevh__block b = nevh__block_over(width, t, q, p, 2 * s.pairs, s.count);
        while (!status && nevh__block_next(f, term, &b))
            status = difference_block(f, term, &b, s, dh_dq, dh_dp);
    }
    return status;
}

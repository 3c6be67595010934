/* nevh tests: a formula split into terms, beside the same formula in one piece.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_FORMULA_TERMS_H
#define NEVH_TESTS_FORMULA_TERMS_H

#include "formula.h"
#include <math.h>

static unsigned long long seed = 11;

static inline unsigned random_below(unsigned most) {
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (unsigned)(seed >> 33) % most;
}

static inline double uniform(double from, double to) {
    return from + (to - from) * random_below(1 << 24) / (1 << 24);
}

static inline formula_system made(const char *text, const nevh__names *names,
                                  size_t n) {
    formula_system s = system_of(text, names, n);
    ck_assert_msg(!s.error.status, "%s: column %zu: %s", text, s.error.column,
                  s.error.text);
    ck_assert_int_eq(nevh_system_status(s.system), NEVH_OK);
    return s;
}

/* Value and gradient (q, then p) of one instance, added up; `size` is what the
   values are without their signs. */
static inline void add_instance(const nevh_term *decl, size_t i, double t,
                                const double q[], const double p[], double *h,
                                double *size, double dq[], double dp[]) {
    enum { W = 8, MOST_READ = 64 };
    static double rows[5 * MOST_READ * W], one[3 * MOST_READ], ts[W];
    double *rows_p = rows + decl->nq * W, *rows_c = rows_p + decl->np * W,
           *out_q = rows_c + decl->nc * W, *out_p = out_q + decl->nq * W;
    double *one_p = one + decl->nq, *one_c = one_p + decl->np;
    ck_assert(decl->nq <= MOST_READ && decl->np <= MOST_READ);
    for (size_t k = 0; k < decl->nq; k++)
        one[k] = q[decl->q[i * decl->nq + k]];
    for (size_t k = 0; k < decl->np; k++)
        one_p[k] = p[decl->p[i * decl->np + k]];
    for (size_t k = 0; k < decl->nc; k++)
        one_c[k] = decl->c[i * decl->nc + k];
    for (size_t k = 0; k < (decl->nq + decl->np + decl->nc) * W; k++)
        rows[k] = one[k / W];
    for (size_t lane = 0; lane < W; lane++)
        ts[lane] = decl->time ? t : 0;
    double value = decl->value(ts[0], one, one_p, one_c, decl->params);
    *h += value;
    *size += fabs(value);
    decl->gradient(W, ts, rows, rows_p, rows_c, decl->params, out_q, out_p);
    for (size_t k = 0; k < decl->nq; k++)
        dq[decl->q[i * decl->nq + k]] += out_q[k * W];
    for (size_t k = 0; k < decl->np; k++)
        dp[decl->p[i * decl->np + k]] += out_p[k * W];
}

/* The same of a system; a field would refuse gradients that differences of a
   wild formula do not confirm. */
static inline double evaluate(const nevh_system *s, double t, const double q[],
                              const double p[], double *h, double slopes[]) {
    size_t n = nevh_system_dof(s);
    double size = 0;
    *h = 0;
    memset(slopes, 0, 2 * n * sizeof *slopes);
    for (size_t k = 0; k < s->n_terms; k++)
        for (size_t i = 0; i < s->terms[k]->decl.count; i++)
            add_instance(&s->terms[k]->decl, i, t, q, p, h, &size, slopes,
                         slopes + n);
    return size;
}

/* The same of the formula as one tape. */
static inline void evaluate_whole(const char *text, const nevh__names *names,
                                  size_t n, double t, const double q[],
                                  const double p[], double *h,
                                  double slopes[]) {
    enum { W = 8 };
    nevh__formula_error e;
    nevh__tree *tree = nevh__tree_parse(text, &e);
    nevh__tape *tape =
        nevh__tree_tape(tree, names, NEVH__READS_TIME | NEVH__READS_STATE, &e);
    ck_assert_msg(tape != NULL, "%s: %s", text, e.text);
    ck_assert_uint_ge(n, 1);
    *h = nevh__tape_value(t, q, p, NULL, tape);
    double *rows = calloc(4 * n * W, sizeof *rows), ts[W];
    for (size_t i = 0; i < n * W; i++) {
        rows[i] = q[i / W];
        rows[n * W + i] = p[i / W];
        ts[i % W] = t;
    }
    nevh__tape_block_gradient(W, ts, rows, rows + n * W, NULL, tape,
                              rows + 2 * n * W, rows + 3 * n * W);
    for (size_t k = 0; k < 2 * n; k++)
        slopes[k] = rows[(2 * n + k) * W];
    for (size_t k = 0; k < n; k++) {
        if (k >= nevh__tape_count(tape, NEVH__Q))
            slopes[k] = 0;
        if (k >= nevh__tape_count(tape, NEVH__P))
            slopes[n + k] = 0;
    }
    free(rows);
    nevh__tape_free(tape);
    nevh__tree_free(tree);
}

static inline void random_state(size_t n, double q[], double p[]) {
    for (size_t k = 0; k < n; k++) {
        q[k] = uniform(-1.5, 1.5);
        p[k] = uniform(-1.5, 1.5);
    }
}

enum { MOST = 64 };
static int compared; /* formulas that were not too wild */

/* Terms and tape of one formula agree in value and gradient, as far as its
   condition lets them. */
static inline void compare_with_whole(const char *text,
                                      const nevh__names *names, size_t n) {
    formula_system s = made(text, names, n);
    double q[MOST], p[MOST], h[2], slopes[2][2 * MOST] = {{0}};
    random_state(n, q, p);
    evaluate_whole(text, names, n, 0.7, q, p, &h[1], slopes[1]);
    double size = evaluate(s.system, 0.7, q, p, &h[0], slopes[0]);
    for (size_t k = 0; k < 2 * n; k++)
        size += fabs(slopes[1][k]);
    compared += size < 1e4;
    if (size < 1e4) {
        ck_assert_msg(fabs(h[0] - h[1]) <= 1e-12 * (1 + size),
                      "%s: %.17g, not %.17g", text, h[0], h[1]);
        for (size_t k = 0; k < 2 * n; k++)
            ck_assert_msg(fabs(slopes[0][k] - slopes[1][k]) <=
                              1e-12 * (1 + size * size),
                          "%s: slope %zu: %.17g, not %.17g", text, k,
                          slopes[0][k], slopes[1][k]);
    }
    system_done(&s);
}

#endif

/* nevh: simplified Newton for stages that fixed-point iteration does not reach.

   x <- x + M^-1 (G(x) - x) with M = 1 - K, where K is the derivative of G with
   that of the field, J, the same at all stages:

       K = h (a x J),        a = a_q or a_p by the variable differentiated by,
       K = -h^2 (a_q a_p x V'' T'')                     in the partitioned form,

   all in units of the state's scales.  J is a forward difference of gradients,
   taken at the start of the step; when the changes fall by less than REFRESH a
   sweep, again at the mean of the stages.  One lane at a time, from a standing
   start, since polynomials continued through stiff slopes lead far astray.

   The rule that ends it is that of fixed-point iteration, but progress is what
   halves the changes of more than a quarter of the unknowns: rounding in G,
   which M^-1 mixes, makes some improve by chance, and where it makes a stiff G
   a flight of stairs, M^-1 goes down by tiny steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include "implicit/implicit_private.h"
#include "system/system_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { MOST_SWEEPS = 50 };
static const double refresh = 0.3;
static const double part = 0x1p-16; /* of the scale: the difference's step */

struct nevh__newton {
    size_t points;         /* 1 + variables that are moved in one call */
    void *memory;          /* holds all that follow */
    double *mean;          /* 2n: where J is taken */
    double *times;         /* points */
    double *q, *p;         /* n x points */
    double *dq, *dp;       /* n x points */
    double *jacobian;      /* 2n x 2n, or V'' and T'', n x n each */
    double *product;       /* n x n: V'' T'' */
    double *stage_product; /* stages x stages: a_q a_p, as they */
    double *matrix;        /* rows x rows: factors of M */
    size_t *pivot;         /* rows */
    double *g, *out;       /* rows: G(x), the next x */
};

static void newton_lay_out(nevh__arena *a, void *solver) {
    const nevh__stage_solver *s = solver;
    struct nevh__newton *m = s->newton;
    size_t n = s->work->n, rows = s->rows, stages = s->stages;
    size_t each = sizeof(double), states = n * m->points;
    m->mean = nevh__arena_take(a, 2 * n, each);
    m->times = nevh__arena_take(a, m->points, each);
    m->q = nevh__arena_take(a, states, each);
    m->p = nevh__arena_take(a, states, each);
    m->dq = nevh__arena_take(a, states, each);
    m->dp = nevh__arena_take(a, states, each);
    m->jacobian = nevh__arena_take(a, 4 * n * n, each);
    m->product = nevh__arena_take(a, n * n, each);
    m->stage_product = nevh__arena_take(a, stages * stages, each);
    m->matrix = nevh__arena_take(a, rows * rows, each);
    m->pivot = nevh__arena_take(a, rows, sizeof *m->pivot);
    m->g = nevh__arena_take(a, rows, each);
    m->out = nevh__arena_take(a, rows, each);
}

static void multiply_stages(const nevh__stage_shape *a, double *product) {
    for (size_t j = 0; j < a->stages; j++)
        for (size_t i = 0; i < a->stages; i++)
            for (size_t m = 0; m < a->stages; m++)
                product[j * a->stages + i] +=
                    a->a_q[m * a->stages + i] * a->a_p[j * a->stages + m];
}

struct nevh__newton *nevh__newton_new(nevh__stage_solver *s) {
    struct nevh__newton *m = s->newton = nevh__array(1, sizeof *m);
    if (!m)
        return NULL;
    m->points = (s->shape.partitioned ? 1 : 2) * s->work->n + 1;
    m->memory = nevh__arena_new(newton_lay_out, s);
    if (m->memory && s->shape.partitioned)
        multiply_stages(&s->shape, m->stage_product);
    if (m->memory)
        return m;
    free(m);
    return NULL;
}

void nevh__newton_free(struct nevh__newton *m) {
    if (m)
        free(m->memory);
    free(m);
}

/* The states around the mean: variables `first` to `last` moved in turn. */
static void newton_spread(const nevh__stage_solver *s, size_t first,
                          size_t last) {
    const struct nevh__newton *m = s->newton;
    size_t n = s->work->n, points = m->points;
    for (size_t i = 0; i < points; i++) {
        m->times[i] = s->problem->t + s->problem->h / 2;
        for (size_t k = 0; k < n; k++) {
            m->q[k * points + i] = m->mean[k];
            m->p[k * points + i] = m->mean[n + k];
        }
    }
    for (size_t k = first; k < last; k++) {
        double *moved = (k < n ? m->q : m->p) + k % n * points + k - first + 1;
        *moved += fmax(part * s->typical[k], 0x1p-30 * fabs(*moved));
    }
}

/* The derivative of slope `row` by variable `k`, which was moved in point i,
   in units of the scales. */
static double newton_derivative(const nevh__stage_solver *s, size_t row,
                                size_t k, size_t i) {
    const struct nevh__newton *m = s->newton;
    size_t n = s->work->n, points = m->points;
    const double *x = (k < n ? m->q : m->p) + k % n * points;
    const double *f = (row < n ? m->dp : m->dq) + row % n * points;
    double slope = (f[i] - f[0]) / (x[i] - x[0]);
    slope *= s->typical[k] / s->typical[row];
    return row < n ? slope : -slope;
}

static int find_jacobian(nevh__stage_solver *s) {
    struct nevh__newton *m = s->newton;
    size_t all = 2 * s->work->n;
    newton_spread(s, 0, all);
    int status = nevh_work_gradient(s->work, m->points, m->times, m->q, m->p,
                                    m->dq, m->dp);
    for (size_t row = 0; !status && row < all; row++)
        for (size_t k = 0; k < all; k++)
            m->jacobian[row * all + k] = newton_derivative(s, row, k, k + 1);
    return status;
}

/* The slopes at the mean momenta move the mean coordinates, except at first. */
static int find_product(nevh__stage_solver *s, bool standing) {
    struct nevh__newton *m = s->newton;
    size_t n = s->work->n;
    double *force = m->jacobian, *mass = m->jacobian + n * n;
    newton_spread(s, n, 2 * n);
    int status = nevh_work_gradient(s->work, m->points, m->times, m->q, m->p,
                                    NULL, m->dp);
    for (size_t i = 0; !status && i < n * n; i++)
        mass[i] = newton_derivative(s, i / n, n + i % n, i % n + 1);
    for (size_t k = 0; !status && !standing && k < n; k++)
        m->mean[k] += s->problem->h / 2 * m->dp[k * m->points];
    newton_spread(s, 0, n);
    if (!status)
        status = nevh_work_gradient(s->work, m->points, m->times, m->q, m->p,
                                    m->dq, NULL);
    for (size_t i = 0; !status && i < n * n; i++)
        force[i] = newton_derivative(s, n + i / n, i % n, i % n + 1);
    for (size_t i = 0; !status && i < n * n; i++) {
        m->product[i] = 0;
        for (size_t j = 0; j < n; j++)
            m->product[i] += force[i / n * n + j] * mass[j * n + i % n];
    }
    return status;
}

/* The mean of the stages' states; where slopes of coordinates are unknown, of
   their momenta alone. */
static void find_mean(const nevh__stage_solver *s, size_t lane) {
    const nevh__stage_problem *e = s->problem;
    size_t n = s->work->n, width = s->work->width, stages = s->stages;
    for (size_t k = 0; k < n; k++) {
        s->newton->mean[k] = e->q[k * width + lane];
        s->newton->mean[n + k] = e->p[k * width + lane];
    }
    for (size_t row = 0; row < s->rows; row++) {
        size_t k = s->first + row / stages;
        const double *a = k < n ? s->shape.a_q : s->shape.a_p, *column;
        column = a + row % stages * stages;
        for (size_t i = 0; i < stages; i++)
            s->newton->mean[k] +=
                e->h * column[i] / (double)stages * e->x[row * width + lane];
    }
}

/* M, or what it has of K at unknowns r and c. */
static double newton_element(const nevh__stage_solver *s, size_t r, size_t c) {
    const struct nevh__newton *m = s->newton;
    size_t stages = s->stages, n = s->work->n, at = c % stages * stages;
    size_t k = r / stages, l = c / stages, i = r % stages;
    double h = s->problem->h;
    if (s->shape.partitioned)
        return h * h * m->stage_product[at + i] * m->product[k * n + l];
    const double *a = l < n ? s->shape.a_q : s->shape.a_p;
    return h * a[at + i] * m->jacobian[k * 2 * n + l];
}

/* NEVH_EDOM: there is none. */
static int find_matrix(nevh__stage_solver *s, size_t lane, bool standing) {
    struct nevh__newton *m = s->newton;
    find_mean(s, lane);
    int status =
        s->shape.partitioned ? find_product(s, standing) : find_jacobian(s);
    if (status)
        return status;
    for (size_t i = 0; i < s->rows * s->rows; i++) {
        size_t r = i / s->rows, c = i % s->rows;
        m->matrix[i] = (r == c) - newton_element(s, r, c);
    }
    return nevh__factor(s->rows, m->matrix, m->pivot) ? NEVH_OK : NEVH_EDOM;
}

/* The next x to `out`; NEVH_EDOM where there is none. */
static int improve(nevh__stage_solver *s, size_t lane) {
    const nevh__stage_problem *e = s->problem;
    struct nevh__newton *m = s->newton;
    const double *x = e->x + lane;
    size_t width = s->work->width;
    double check = 0;
    int status = e->map(e->data, 1, &lane, e->x, m->g);
    if (status)
        return status;
    s->work->sweeps++;
    for (size_t row = 0; row < s->rows; row++) {
        size_t k = s->first + row / s->stages;
        m->out[row] = (m->g[row] - x[row * width]) / s->typical[k];
    }
    nevh__solve(s->rows, m->matrix, m->pivot, m->out);
    for (size_t row = 0; row < s->rows; row++) {
        size_t k = s->first + row / s->stages;
        m->out[row] = x[row * width] + m->out[row] * s->typical[k];
        check += m->out[row] - m->out[row];
    }
    return check == 0 ? NEVH_OK : NEVH_EDOM;
}

/* Rounding of the stages' states, and of what the slopes are computed from,
   moves the slopes by epsilon times |J| |y|, or |V''| |q|, variable by
   variable; in units of scale.  Added to what differences bring. */
static void find_noise(nevh__stage_solver *s, size_t lane) {
    const struct nevh__newton *m = s->newton;
    const double *scale = s->typical;
    size_t n = s->work->n, all = s->shape.partitioned ? n : 2 * n;
    nevh__stage_noise(s, lane);
    for (size_t k = s->first; !s->status && k < 2 * n; k++) {
        double sum = s->noise[k] / scale[k];
        for (size_t l = 0; l < all; l++)
            sum += DBL_EPSILON * fabs(m->jacobian[(k - s->first) * all + l]) *
                   fabs(m->mean[l]) / scale[l];
        s->noise[k] = sum;
    }
}

/* True if the change is within the effect of such noise, of either sign, on the
   unknowns: it cannot be told from rounding. */
static bool no_more_than_noise(nevh__stage_solver *s, size_t lane,
                               double change) {
    struct nevh__newton *m = s->newton;
    double h = fabs(s->problem->h), most = 0;
    if (change <= NEVH__STAGE_TINY)
        return true;
    find_noise(s, lane);
    for (size_t row = 0; row < s->rows; row++) {
        double noise = s->noise[s->first + row / s->stages];
        m->g[row] = row * 5 % 7 < 3 ? noise : -noise;
    }
    nevh__solve(s->rows, m->matrix, m->pivot, m->g);
    for (size_t row = 0; row < s->rows; row++) {
        size_t k = s->first + row / s->stages;
        most = fmax(most, h * fabs(m->g[row]) * s->typical[k] /
                              s->scale[k * s->work->width + lane]);
    }
    return !s->status && change <= NEVH__STAGE_TINY + NEVH__STAGE_MARGIN * most;
}

/* NEVH_OK; NEVH_EMAXITER or NEVH_EDOM when it does not get there. */
static int newton_iterate(nevh__stage_solver *s, size_t lane) {
    struct nevh__newton *m = s->newton;
    const nevh__stage_lane *l = &s->lane[lane];
    const nevh__stage_rule rule = {0.5, s->rows / 4, no_more_than_noise};
    nevh__stage_begin(s, lane);
    for (size_t row = 0; row < s->rows; row++)
        s->problem->x[row * s->work->width + lane] = 0;
    int status = find_matrix(s, lane, true);
    for (int i = 0; !status && i < MOST_SWEEPS; i++) {
        status = improve(s, lane);
        if (status)
            return status;
        nevh__stage_progress made =
            nevh__stage_compare(s, lane, 1, m->out, &rule);
        nevh__stage_state state = nevh__stage_judge(s, lane, &made, &rule);
        nevh__stage_take(s, lane, 1, m->out);
        if (state != NEVH__GO_ON || s->status)
            return state == NEVH__DONE ? s->status : NEVH_EMAXITER;
        if (l->change > NEVH__STAGE_TINY && l->change > refresh * l->before)
            status = find_matrix(s, lane, false);
    }
    return status ? status : NEVH_EMAXITER;
}

/* Gradients and sizes are the lane's from now on. */
static void newton_choose(nevh__stage_solver *s, size_t lane) {
    nevh_field *f = s->work->field;
    if (f->lanes)
        nevh__field_choose(f, 1, &lane);
    s->typical = nevh__field_lane_scale(f, lane, s->one_scale);
}

int nevh__newton_lane(nevh__stage_solver *s, size_t lane) {
    const nevh__stage_problem *e = s->problem;
    int status = NEVH_EMAXITER;
    newton_choose(s, lane);
    if (s->newton) {
        s->work->newtons++;
        status = newton_iterate(s, lane);
    }
    if (s->status)
        return s->status;
    if (status == NEVH_EMAXITER || status == NEVH_EDOM)
        status = nevh__rescue_lane(s, lane);
    if (status || !s->shape.partitioned)
        return status;
    s->work->sweeps++; /* slopes of the coordinates, which go with x */
    return e->map(e->data, 1, &lane, e->x, s->newton->g);
}

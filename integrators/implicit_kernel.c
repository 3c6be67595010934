/* nevh: Gauss-Legendre methods and Lobatto IIIA-IIIB pairs, for any H.

   With slopes F_j at the stages and increments L_j = h b_j F_j,

       Y_i = y + (sum_j mu_ij L_j + e),   F_i = f(t + c_i h, Y_i),
       y  += sum_j L_j,

   where e is what earlier sums lost to rounding, the mu of coordinates and of
   momenta add up to 1 exactly across the diagonal, and the h b_j add up to h:
   the form of Antonana, Makazaga and Murua, in which rounding leaves
   the map symplectic.  The sum goes from small weights to large ones with
   compensation, the products' own rounding included.  First guess: the
   collocation polynomial of the previous step, continued.

   For H = T(p) + V(q) unknown are the slopes of the momenta alone: a sweep
   takes the momenta from them, the slopes of the coordinates at these momenta,
   the coordinates, and new slopes there.  That halves the number of sweeps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/extend.h>
#include "stage_rows_private.h"
#include "tableau_private.h"
#include "work_private.h"
#include "gradient/field_private.h"
#include "implicit/implicit_private.h"
#include "system/system_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    nevh__tableau *tableau; /* first, where tests look for it */
    nevh__stage_solver *solver;
    bool partitioned;
    size_t unknown; /* slopes of a lane that are solved for */
    double *hb;     /* h b_j of this step */
    size_t *lanes;  /* all of them */
    /* One orbit with exact gradients: rows are vectors; mu and guess as the
       tableau's, or with room behind them. */
    bool vectors;
    nevh__rows rows; /* of a half */
    double *padded;  /* NULL: no room is needed */
    const double *mu_q, *mu_p, *guess;
} family_plan;

/* One step under way. */
typedef struct {
    nevh_work *work;
    double t, h;
    const double *q, *p;
    double *slopes;     /* 2n x stages x width */
    double *unknown;    /* the part of the slopes that is solved for */
    double *increments; /* 2n x stages x width */
    double *points;     /* 2n x stages x width */
    double *times;      /* stages x width */
    double *sum;        /* 2n x width: the new state */
    double *lost;       /* 2n x width: what that lost */
    double *hold;       /* width; see nevh__stage_problem */
    nevh__call velocities, forces; /* of one orbit, where it can be called */
} family_step;

/* Memory: carry, slopes of the last step that were solved for, their h (0:
   there are none), and how long Newton's iteration goes first. */
typedef struct {
    double *carry, *slopes, *h, *hold;
} family_memory;

static family_memory recall(const nevh_work *w) {
    const family_plan *g = w->plan;
    family_memory m = {w->memory, .slopes = w->memory + 2 * w->size};
    m.h = m.slopes + g->unknown * w->width;
    m.hold = m.h + w->width;
    return m;
}

static void unplan(nevh_work *w) {
    family_plan *g = w->plan;
    if (!g)
        return;
    nevh__tableau_free(g->tableau);
    nevh__stage_solver_free(g->solver);
    free(g->hb);
    free(g->lanes);
    free(g->padded);
    free(g);
    w->plan = NULL;
}

static const double *pad(const nevh__rows *r, const double from[],
                         double to[]) {
    for (size_t i = 0; i < r->stages * r->stages; i++)
        to[i / r->stages * r->stride + i % r->stages] = from[i];
    return to;
}

static bool plan_rows(const nevh_work *w, family_plan *g) {
    const nevh__tableau *a = g->tableau;
    size_t stages = a->stages, stride = nevh__padded(stages);
    g->vectors = w->width == 1 && nevh__work_lean(w);
    g->rows = (nevh__rows){w->n, stages, g->vectors ? stride : stages};
    g->mu_q = a->mu_q;
    g->mu_p = a->mu_p;
    g->guess = a->guess;
    if (g->rows.stride == stages)
        return true;
    double *to = g->padded = nevh__array(3 * stages * stride, sizeof *to);
    if (!to)
        return false;
    g->mu_q = pad(&g->rows, a->mu_q, to);
    g->mu_p = pad(&g->rows, a->mu_p, to + stages * stride);
    g->guess = pad(&g->rows, a->guess, to + 2 * stages * stride);
    return true;
}

static bool plan_solver(nevh_work *w, family_plan *g) {
    nevh__tableau *a = g->tableau;
    if (!a)
        return false;
    g->partitioned =
        !w->transform && (nevh_system_traits(w->system) & NEVH_SEPARABLE);
    g->unknown = (g->partitioned ? 1 : 2) * w->n * a->stages;
    g->hb = nevh__array(a->stages, sizeof *g->hb);
    g->lanes = nevh__array(w->width, sizeof *g->lanes);
    g->solver = nevh__stage_solver_new(
        w, &(nevh__stage_shape){a->stages, g->partitioned, a->a_q, a->a_p});
    for (size_t lane = 0; g->lanes && lane < w->width; lane++)
        g->lanes[lane] = lane;
    return g->hb && g->lanes && g->solver && plan_rows(w, g);
}

/* Numbers from one row of points to the next. */
static size_t row_size(const family_plan *g, size_t active) {
    return g->rows.stride * active;
}

static int plan_on(nevh_work *w, size_t fewest,
                   nevh__tableau *(*make)(size_t stages)) {
    size_t stages = (size_t)w->integrator->stages;
    if (stages < fewest || stages > NEVH__MOST_STAGES)
        return nevh_work_fail(
            w, NEVH_EINVAL, "%s: %zu stages, where %zu to %d are possible",
            w->integrator->name, stages, fewest, NEVH__MOST_STAGES);
    family_plan *g = w->plan = nevh__array(1, sizeof *g);
    if (g)
        g->tableau = make(stages);
    if (!g || !plan_solver(w, g))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    w->memory_rows = 2 * w->n + g->unknown + 2;
    w->scratch_size = (6 * w->n + 1) * row_size(g, w->width) + w->width +
                      4 * w->size + NEVH__LANES;
    return NEVH_OK;
}

static int plan_gauss(nevh_work *w) {
    return plan_on(w, 1, nevh__gauss_new);
}

static int plan_lobatto(nevh_work *w) {
    return plan_on(w, 2, nevh__lobatto_new);
}

static family_step lay_out(nevh_work *w, double t, double h, const double q[],
                           const double p[]) {
    const family_plan *g = w->plan;
    size_t size = row_size(g, w->width), all = 2 * w->n * size;
    family_step s = {w, t, h, q, p, .slopes = nevh__aligned(w->scratch)};
    s.unknown =
        s.slopes + 2 * w->size * g->tableau->stages - g->unknown * w->width;
    s.increments = s.slopes + all;
    s.points = s.increments + all;
    s.times = s.points + all;
    s.sum = s.times + size;
    s.lost = s.sum + 2 * w->size;
    s.hold = s.lost + 2 * w->size;
    return s;
}

/* h b_j; the outer two share what the rounded others leave of h. */
static void weigh(family_plan *g, double h) {
    size_t s = g->tableau->stages;
    double rest = h;
    for (size_t j = 1; j + 1 < s; j++) {
        g->hb[j] = h * g->tableau->b[j];
        rest -= g->hb[j];
    }
    g->hb[0] = g->hb[s - 1] = s > 1 ? rest / 2 : rest;
}

/* out[i] = sum_j m[j*stages + i] x[j], for `active` lanes side by side. */
static void multiply(size_t stages, size_t active, const double m[],
                     const double x[], double out[]) {
    for (size_t i = 0; i < stages * active; i++)
        out[i] = 0;
    for (size_t j = 0; j < stages; j++, m += stages)
        for (size_t i = 0; i < stages; i++)
            for (size_t a = 0; a < active; a++)
                out[i * active + a] += m[i] * x[j * active + a];
}

/* The stage states of the half, or halves, from `first` to `last`, of one
   orbit. */
static void find_rows(const family_step *s, size_t first, size_t last) {
    const nevh_work *w = s->work;
    const family_plan *g = w->plan;
    size_t n = w->n, size = g->rows.stride;
    if (first < n)
        nevh__rows_combine(&g->rows, g->mu_q, g->hb, s->slopes, s->q, w->memory,
                           s->points);
    if (last > n)
        nevh__rows_combine(&g->rows, g->mu_p, g->hb,
                           s->slopes + n * g->rows.stages, s->p, w->memory + n,
                           s->points + n * size);
}

/* The stage states of variables from `first` to `last` at some lanes, to
   points. */
static void find_points(const family_step *s, size_t first, size_t last,
                        size_t active, const size_t lanes[]) {
    const nevh_work *w = s->work;
    const family_plan *g = w->plan;
    size_t stages = g->tableau->stages;
    if (g->vectors) {
        find_rows(s, first, last);
        return;
    }
    for (size_t k = first; k < last; k++) {
        const double *mu = k < w->n ? g->tableau->mu_q : g->tableau->mu_p;
        const double *slopes = s->slopes + k * stages * w->width;
        const double *y = (k < w->n ? s->q : s->p) + k % w->n * w->width;
        const double *carry = w->memory + k * w->width;
        double *points = s->points + k * stages * active;
        double *x = s->increments + k * stages * active;
        for (size_t j = 0; j < stages; j++)
            for (size_t a = 0; a < active; a++)
                x[j * active + a] = g->hb[j] * slopes[j * w->width + lanes[a]];
        multiply(stages, active, mu, x, points);
        for (size_t i = 0; i < stages; i++)
            for (size_t a = 0; a < active; a++) {
                double *point = points + i * active + a;
                *point = y[lanes[a]] + (*point + carry[lanes[a]]);
            }
    }
}

static void find_times(const family_step *s, size_t active) {
    const family_plan *g = s->work->plan;
    size_t stages = g->tableau->stages;
    for (size_t i = 0; i < row_size(g, active); i++)
        s->times[i] =
            s->t + g->tableau->c[i / active < stages ? i / active : 0] * s->h;
}

/* The gradient at the points. */
static int take_gradient(const family_step *s, size_t active, double dh_dq[],
                         double dh_dp[]) {
    nevh_work *w = s->work;
    const family_plan *g = w->plan;
    size_t size = row_size(g, active);
    return nevh__work_gradient(w, size, g->tableau->stages * active, s->times,
                               s->points, s->points + w->n * size, dh_dq,
                               dh_dp);
}

static void negate(const family_step *s, size_t active, double x[]) {
    const family_plan *g = s->work->plan;
    size_t size = g->rows.count * row_size(g, active);
    if (g->vectors)
        nevh__rows_negate(&g->rows, x);
    else
        for (size_t i = 0; i < size; i++)
            x[i] = -x[i];
}

static int map(void *data, size_t active, const size_t lanes[],
               const double slopes[], double out[]) {
    const family_step *s = data;
    const family_plan *g = s->work->plan;
    size_t half = g->rows.count * g->rows.stages * active;
    double *first = out, *second = out + half;
    (void)slopes; /* are s->unknown */
    if (g->padded) {
        first = s->increments;
        second = first + g->rows.count * g->rows.stride;
    }
    find_points(s, 0, 2 * s->work->n, active, lanes);
    if (!g->vectors)
        find_times(s, active);
    int status = take_gradient(s, active, second, first);
    negate(s, active, second);
    if (g->padded)
        nevh__rows_close(&g->rows, 2 * g->rows.count, s->increments, out);
    return status;
}

/* Where the slopes of coordinates are to be written: in place if they can. */
static double *velocities_of(const family_step *s) {
    const family_plan *g = s->work->plan;
    return g->vectors && !g->padded ? s->slopes : s->increments;
}

static void prepare_calls(family_step *s, double *forces) {
    nevh_work *w = s->work;
    size_t size = row_size(w->plan, 1);
    const double *p = s->points + w->n * size;
    s->velocities = nevh__lean_call(w->field, size, s->times, s->points, p,
                                    NULL, velocities_of(s));
    s->forces =
        nevh__lean_call(w->field, size, s->times, s->points, p, forces, NULL);
}

static bool call(const nevh__call *c, const family_plan *g) {
    return c->gradient && nevh__lean_take(c, g->rows.stages);
}

/* Slopes of the coordinates at the stages' momenta. */
static int find_velocities(const family_step *s, size_t active,
                           const size_t lanes[]) {
    nevh_work *w = s->work;
    const family_plan *g = w->plan;
    double *velocities = velocities_of(s);
    find_points(s, w->n, 2 * w->n, active, lanes);
    int status = call(&s->velocities, g)
                     ? NEVH_OK
                     : take_gradient(s, active, NULL, velocities);
    if (g->padded)
        nevh__rows_close(&g->rows, w->n, velocities, s->slopes);
    for (size_t row = 0; !g->vectors && row < w->n * g->rows.stages; row++)
        for (size_t a = 0; a < active; a++)
            s->slopes[row * w->width + lanes[a]] = velocities[row * active + a];
    return status;
}

static int map_momenta(void *data, size_t active, const size_t lanes[],
                       const double slopes[], double out[]) {
    family_step *s = data;
    const family_plan *g = s->work->plan;
    double *target = g->padded ? s->increments : out;
    (void)slopes;
    if (g->vectors && s->forces.out != target)
        prepare_calls(s, target);
    if (!g->vectors)
        find_times(s, active);
    int status = find_velocities(s, active, lanes);
    if (status)
        return status;
    find_points(s, 0, s->work->n, active, lanes);
    status =
        call(&s->forces, g) ? NEVH_OK : take_gradient(s, active, target, NULL);
    negate(s, active, target);
    if (g->padded)
        nevh__rows_close(&g->rows, g->rows.count, target, out);
    return status;
}

static void guess_rows(const family_step *s, const family_plan *g,
                       const family_memory *last) {
    nevh__rows rows = g->rows;
    double *target = g->padded ? s->increments : s->unknown;
    rows.count = g->unknown / rows.stages;
    if (*last->h != s->h) {
        memset(s->unknown, 0, g->unknown * sizeof *s->unknown);
        return;
    }
    nevh__rows_multiply(&rows, g->guess, last->slopes, target);
    if (g->padded)
        nevh__rows_close(&rows, rows.count, target, s->unknown);
}

/* Continues the last step's polynomial where there is one. */
static void guess(const family_step *s, const family_plan *g) {
    const nevh_work *w = s->work;
    size_t stages = g->tableau->stages, each = stages * w->width;
    family_memory last = recall(w);
    memcpy(s->hold, last.hold, w->width * sizeof *s->hold);
    if (g->vectors) {
        guess_rows(s, g, &last);
        return;
    }
    for (size_t row = 0; row < g->unknown; row += stages) {
        double *slopes = s->unknown + row * w->width;
        multiply(stages, w->width, g->tableau->guess,
                 last.slopes + row * w->width, slopes);
        for (size_t i = 0; i < each; i++)
            if (last.h[i % w->width] != s->h)
                slopes[i] = 0;
    }
}

/* The evaluations that moved the state: one a stage. */
static int account(const family_step *s, const family_plan *g) {
    nevh_work *w = s->work;
    size_t stages = g->tableau->stages, size = row_size(g, w->width);
    double *z = s->increments;
    int status = NEVH_OK;
    find_points(s, 0, 2 * w->n, w->width, g->lanes);
    find_times(s, w->width);
    for (size_t i = 0; !status && i < stages; i++) {
        for (size_t k = 0; k < 2 * w->n; k++)
            memcpy(z + k * w->width, s->points + k * size + i * w->width,
                   w->width * sizeof *z);
        status = nevh_work_account(w, NEVH_OF_Q | NEVH_OF_P, g->hb[i],
                                   s->times + i * w->width, z, z + w->size);
    }
    return status;
}

static int commit(const family_step *s, const family_plan *g, double q[],
                  double p[]) {
    nevh_work *w = s->work;
    size_t n = w->size;
    double check = 0;
    memcpy(s->sum, q, n * sizeof *q);
    memcpy(s->sum + n, p, n * sizeof *p);
    memcpy(s->lost, w->memory, 2 * n * sizeof *s->lost);
    nevh__rows_sum(g->tableau, 2 * n, w->width, g->hb, s->slopes, s->sum,
                   s->lost);
    for (size_t i = 0; i < 2 * n; i++)
        check += s->sum[i] - s->sum[i];
    if (check != 0)
        return nevh__fail_range(w, s->t, s->h);
    int status = w->accounts ? account(s, g) : NEVH_OK;
    if (status)
        return status;
    family_memory m = recall(w);
    memcpy(q, s->sum, n * sizeof *q);
    memcpy(p, s->sum + n, n * sizeof *p);
    memcpy(m.carry, s->lost, 2 * n * sizeof *m.carry);
    memcpy(m.slopes, s->unknown, g->unknown * w->width * sizeof *m.slopes);
    memcpy(m.hold, s->hold, w->width * sizeof *m.hold);
    for (size_t lane = 0; lane < w->width; lane++)
        m.h[lane] = s->h;
    return NEVH_OK;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    family_plan *g = w->plan;
    family_step s = lay_out(w, t, h, q, p);
    weigh(g, h);
    guess(&s, g);
    if (g->vectors)
        find_times(&s, 1);
    nevh__stage_problem problem = {.t = t,
                                   .h = h,
                                   .q = q,
                                   .p = p,
                                   .x = s.unknown,
                                   .map = g->partitioned ? map_momenta : map,
                                   .data = &s,
                                   .hold = s.hold};
    int status = nevh__stage_solve(g->solver, &problem);
    return status ? status : commit(&s, g, q, p);
}

/* What sums of momenta lost belongs to momenta; slopes are only a guess. */
static void damp(nevh_work *w, const double factor[]) {
    double *carry = recall(w).carry + w->size;
    for (size_t i = 0; i < w->size; i++)
        carry[i] *= factor[i / w->width];
}

const nevh_kernel nevh_gauss_kernel = {
    .plan = plan_gauss, .step = step, .unplan = unplan, .damp = damp};
const nevh_kernel nevh_lobatto_kernel = {
    .plan = plan_lobatto, .step = step, .unplan = unplan, .damp = damp};

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
#include "stage_sweeps_private.h"
#include "tableau_private.h"
#include "work/work_private.h"
#include "implicit/implicit_private.h"
#include "system/system_private.h"
#include <math.h>
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    nevh__tableau *tableau; /* first three, where tests look for them */
    nevh__sweeps *one;      /* sweeps of one orbit; NULL: there are none */
    nevh__sweeps *many;     /* the same of NEVH__LANES orbits */
    nevh__stage_solver *solver;
    bool partitioned;
    size_t unknown; /* slopes of a lane that are solved for */
    double *hb;     /* h b_j of this step */
    size_t *lanes;  /* all of them */
} family_plan;

/* One step under way. */
typedef struct {
    nevh_work *work;
    double t, h;
    const double *q, *p;
    double *slopes;      /* 2n x stages x width */
    double *unknown;     /* the part of the slopes that is solved for */
    double *increments;  /* 2n x stages x width */
    double *points;      /* 2n x stages x width */
    double *times;       /* stages x width */
    double *sum;         /* 2n x width: the new state */
    double *lost;        /* 2n x width: what that lost */
    double *hold;        /* width; see nevh__stage_problem */
    nevh__sweeps *group; /* under way, from this lane on */
    size_t first;
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

static void clear(nevh_work *w) {
    family_plan *g = w->plan;
    if (!g)
        return;
    nevh__tableau_free(g->tableau);
    nevh__stage_solver_free(g->solver);
    free(g->hb);
    free(g->lanes);
    nevh__sweeps_free(g->one);
    nevh__sweeps_free(g->many);
    free(g);
    w->plan = NULL;
}

/* Sweeps of `lanes` orbits, where these suit; false when memory is out. */
static bool plan_group(nevh_work *w, const family_plan *g, size_t lanes,
                       nevh__sweeps **sweeps) {
    const nevh__tableau *a = g->tableau;
    if (!nevh__sweeps_suit(w, a->stages, lanes))
        return true;
    *sweeps = nevh__sweeps_new(w, a, g->hb, g->partitioned, lanes);
    return *sweeps;
}

/* A few orbits that are left, or all where many do not go together, are swept
   one by one. */
static bool plan_sweeps(nevh_work *w, family_plan *g) {
    size_t rest = w->width % NEVH__LANES, fewest = NEVH__FEWEST_TOGETHER;
    if (w->width >= fewest && !plan_group(w, g, NEVH__LANES, &g->many))
        return false;
    return (g->many && (rest == 0 || rest >= fewest)) ||
           plan_group(w, g, 1, &g->one);
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
    return g->hb && g->lanes && g->solver && plan_sweeps(w, g);
}

static int plan_on(nevh_work *w, size_t fewest, size_t most,
                   nevh__tableau *(*make)(size_t stages)) {
    size_t stages = (size_t)w->integrator->stages;
    if (stages < fewest || stages > most)
        return nevh_work_fail(w, NEVH_EINVAL,
                              "%s: %zu stages, where %zu to %zu are possible",
                              w->integrator->name, stages, fewest, most);
    family_plan *g = w->plan = nevh__array(1, sizeof *g);
    if (g)
        g->tableau = make(stages);
    if (!g || !plan_solver(w, g))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    w->memory_rows = 2 * w->n + g->unknown + 2;
    w->scratch_size = ((6 * w->n + 1) * stages + 1 + 4 * w->n) * w->width;
    return NEVH_OK;
}

static int plan_gauss(nevh_work *w) {
    return plan_on(w, 1, NEVH__MOST_STAGES, nevh__gauss_new);
}

static int plan_lobatto(nevh_work *w) {
    return plan_on(w, 2, NEVH__MOST_STAGES, nevh__lobatto_new);
}

static int plan_implicit_euler(nevh_work *w) {
    return plan_on(w, 1, 1, nevh__implicit_euler_new);
}

static family_step lay_out(nevh_work *w, double t, double h, const double q[],
                           const double p[]) {
    const family_plan *g = w->plan;
    size_t size = g->tableau->stages * w->width, all = 2 * w->n * size;
    family_step s = {w, t, h, q, p, .slopes = w->scratch};
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

/* out[i] = sum_j m[j*stages + i] x[j], for `active` lanes side by side; the
   sums of even and odd j apart, as in stage_sweeps.c. */
static void multiply(size_t stages, size_t active, const double m[],
                     const double x[], double out[]) {
    for (size_t i = 0; i < stages * active; i++) {
        const double *weight = m + i / active, *slope = x + i % active;
        double sum[2] = {0, 0};
        for (size_t j = 0; j < stages; j++)
            sum[j % 2] += weight[j * stages] * slope[j * active];
        out[i] = sum[0] + sum[1];
    }
}

/* The stage states of variables from `first` to `last` at some lanes, to
   points. */
static void find_points(const family_step *s, size_t first, size_t last,
                        size_t active, const size_t lanes[]) {
    const nevh_work *w = s->work;
    const family_plan *g = w->plan;
    size_t stages = g->tableau->stages;
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
    const nevh__tableau *a = ((const family_plan *)s->work->plan)->tableau;
    for (size_t i = 0; i < a->stages * active; i++)
        s->times[i] = s->t + a->c[i / active] * s->h;
}

/* The gradient at the points. */
static int take_gradient(const family_step *s, size_t active, double dh_dq[],
                         double dh_dp[]) {
    nevh_work *w = s->work;
    const family_plan *g = w->plan;
    size_t points = g->tableau->stages * active;
    return nevh__work_gradient_padded(w, points, points, s->times, s->points,
                                      s->points + w->n * points, dh_dq, dh_dp);
}

static void negate(const family_step *s, size_t active, double x[]) {
    const family_plan *g = s->work->plan;
    for (size_t i = 0; i < s->work->n * g->tableau->stages * active; i++)
        x[i] = -x[i];
}

static int map(void *data, size_t active, const size_t lanes[],
               const double slopes[], double out[]) {
    const family_step *s = data;
    const family_plan *g = s->work->plan;
    double *forces = out + s->work->n * g->tableau->stages * active;
    (void)slopes; /* are s->unknown */
    find_points(s, 0, 2 * s->work->n, active, lanes);
    find_times(s, active);
    int status = take_gradient(s, active, forces, out);
    negate(s, active, forces);
    return status;
}

/* Slopes of the coordinates at the stages' momenta. */
static int find_velocities(const family_step *s, size_t active,
                           const size_t lanes[]) {
    const nevh_work *w = s->work;
    const family_plan *g = w->plan;
    double *velocities = s->increments;
    find_points(s, w->n, 2 * w->n, active, lanes);
    int status = take_gradient(s, active, NULL, velocities);
    for (size_t row = 0; row < w->n * g->tableau->stages; row++)
        for (size_t a = 0; a < active; a++)
            s->slopes[row * w->width + lanes[a]] = velocities[row * active + a];
    return status;
}

static int map_momenta(void *data, size_t active, const size_t lanes[],
                       const double slopes[], double out[]) {
    const family_step *s = data;
    (void)slopes;
    find_times(s, active);
    int status = find_velocities(s, active, lanes);
    if (status)
        return status;
    find_points(s, 0, s->work->n, active, lanes);
    status = take_gradient(s, active, out, NULL);
    negate(s, active, out);
    return status;
}

/* Continues the last step's polynomial where there is one. */
static void guess(void *data, size_t lane) {
    const family_step *s = data;
    const nevh_work *w = s->work;
    const family_plan *g = w->plan;
    family_memory last = recall(w);
    size_t stages = g->tableau->stages;
    double x[NEVH__MOST_STAGES], y[NEVH__MOST_STAGES];
    for (size_t row = 0; row < g->unknown; row += stages) {
        size_t at = row * w->width + lane;
        for (size_t j = 0; j < stages; j++)
            x[j] = last.slopes[at + j * w->width];
        multiply(stages, 1, g->tableau->guess, x, y);
        for (size_t j = 0; j < stages; j++)
            s->unknown[at + j * w->width] = last.h[lane] == s->h ? y[j] : 0;
    }
}

/* As many lanes as are worth while. */
static size_t begin_group(void *data, size_t first, const double unit[]) {
    family_step *s = data;
    const nevh_work *w = s->work;
    const family_plan *g = w->plan;
    family_memory last = recall(w);
    size_t rest = w->width - first;
    bool many = g->many && rest >= NEVH__FEWEST_TOGETHER;
    nevh__sweep_start start = {.width = w->width,
                               .first = first,
                               .count = many ? NEVH__LANES : 1,
                               .t = s->t,
                               .h = s->h,
                               .q = s->q,
                               .p = s->p,
                               .carry = last.carry,
                               .unit = unit,
                               .last = last.slopes,
                               .last_h = last.h};
    start.count = start.count < rest ? start.count : rest;
    s->group = many ? g->many : g->one;
    s->first = first;
    return s->group && nevh__sweeps_begin(s->group, &start) ? start.count : 0;
}

static int sweep_group(void *data, nevh__stage_progress made[]) {
    const family_step *s = data;
    return nevh__sweeps_sweep(s->group, made);
}

static void fetch(void *data, size_t lane, size_t sweeps) {
    const family_step *s = data;
    nevh__sweeps_count(s->group, sweeps);
    nevh__sweeps_fetch(s->group, lane, s->work->width,
                       s->slopes + s->first + lane);
}

static const nevh__stage_group groups = {begin_group, sweep_group, fetch,
                                         guess};

/* The evaluations that moved the state: one a stage. */
static int account(const family_step *s, const family_plan *g) {
    nevh_work *w = s->work;
    size_t stages = g->tableau->stages, size = stages * w->width;
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

/* sum + lost += h b x; what that loses is below the last bit of lost. */
NEVH__INLINE void add(double hb, double slope, double *sum, double *lost) {
    double x = hb * slope, next = *sum + x;
    *lost += nevh__roundoff(next, *sum, x) + fma(hb, slope, -x);
    *sum = next;
}

/* The new state and what it lost, small weights first, of `lanes` orbits. */
NEVH__INLINE void sum_row(const nevh__tableau *a, const double hb[],
                          size_t lanes, size_t width, const double x[],
                          double sum[], double lost[]) {
    double total[NEVH__LANES], rest[NEVH__LANES];
    for (size_t i = 0; i < lanes; i++) {
        total[i] = sum[i];
        rest[i] = lost[i];
    }
    for (const size_t *j = a->order; j < a->order + a->stages; j++)
        for (size_t i = 0; i < lanes; i++)
            add(hb[*j], x[*j * width + i], &total[i], &rest[i]);
    for (size_t i = 0; i < lanes; i++) {
        sum[i] = total[i] + rest[i];
        lost[i] = nevh__roundoff(sum[i], total[i], rest[i]);
    }
}

NEVH_SIMD static void sum_up(const family_step *s, const nevh__tableau *a,
                             const double hb[]) {
    size_t width = s->work->width, eight = NEVH__LANES;
    for (size_t k = 0; k < 2 * s->work->n; k++) {
        const double *x = s->slopes + k * a->stages * width;
        double *sum = s->sum + k * width, *lost = s->lost + k * width;
        size_t i = 0;
        for (; i + eight <= width; i += eight)
            sum_row(a, hb, eight, width, x + i, sum + i, lost + i);
        for (; i < width; i++)
            sum_row(a, hb, 1, width, x + i, sum + i, lost + i);
    }
}

static int commit(const family_step *s, const family_plan *g, double q[],
                  double p[]) {
    nevh_work *w = s->work;
    size_t n = w->size;
    double check = 0;
    memcpy(s->sum, q, n * sizeof *q);
    memcpy(s->sum + n, p, n * sizeof *p);
    memcpy(s->lost, w->memory, 2 * n * sizeof *s->lost);
    sum_up(s, g->tableau, g->hb);
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
    memcpy(s.hold, recall(w).hold, w->width * sizeof *s.hold);
    nevh__stage_problem problem = {.t = t,
                                   .h = h,
                                   .q = q,
                                   .p = p,
                                   .x = s.unknown,
                                   .map = g->partitioned ? map_momenta : map,
                                   .group = &groups,
                                   .data = &s,
                                   .hold = s.hold};
    int status = nevh__stage_solve(g->solver, &problem);
    return status ? status : commit(&s, g, q, p);
}

/* What sums of momenta lost belongs to momenta; slopes are only a guess. */
static void apply_friction(nevh_work *w, const double factor[]) {
    double *carry = recall(w).carry + w->size;
    for (size_t i = 0; i < w->size; i++)
        carry[i] *= factor[i / w->width];
}

const nevh_kernel nevh_gauss_kernel = {.plan = plan_gauss,
                                       .step = step,
                                       .clear = clear,
                                       .apply_friction = apply_friction};
const nevh_kernel nevh_lobatto_kernel = {.plan = plan_lobatto,
                                         .step = step,
                                         .clear = clear,
                                         .apply_friction = apply_friction};
const nevh_kernel nevh_implicit_euler_kernel = {.plan = plan_implicit_euler,
                                                .step = step,
                                                .clear = clear,
                                                .apply_friction =
                                                    apply_friction};

/* nevh: Gauss-Legendre methods and Lobatto IIIA-IIIB pairs, for any H.

   With slopes F_j at the stages and increments L_j = h b_j F_j,

       Y_i = y + (sum_j mu_ij L_j + e),   F_i = f(t + c_i h, Y_i),
       y  += sum_j L_j,

   where e is what earlier sums lost to rounding, the mu of coordinates and of
   momenta add up to 1 exactly across the diagonal, and the h b_j add up to h:
   the form of Antonana, Makazaga and Murua, in which rounding leaves
   the map symplectic.  The sum goes from small weights to large ones with
   compensation, the products' own rounding included.  First guess: what slopes
   of the last steps lead to, see stage_guess.c; of one step, its collocation
   polynomial, continued.

   For H = T(p) + V(q) unknown are the slopes of the momenta alone, which halves
   the number of sweeps.  A sweep is stage_step.h.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/extend.h>
#include "stage_sweeps_private.h"
#include "work/work_private.h"
#include "system/system_private.h"
#include <stdlib.h>
#include <string.h>

typedef struct {
    nevh__tableau *tableau; /* these two first, where tests look for them */
    nevh__stage_weights *weights;
    nevh__sweeps *one;   /* sweeps of one orbit; NULL: there are none */
    nevh__sweeps *eight; /* the same of NEVH__LANES orbits */
    nevh__sweeps *any;   /* of as many as are left over, or stuck */
    nevh__stage_solver *solver;
    nevh__stage_group groups;
    bool partitioned;
    size_t unknown; /* slopes of a lane that are solved for */
    size_t *lanes;  /* all of them */
} family_plan;

/* One step under way. */
typedef struct {
    nevh_work *work;
    double t, h;
    const double *q, *p;
    double *slopes;       /* 2n x stages x width */
    double *unknown;      /* the part of the slopes that is solved for */
    double *sum;          /* 2n x width: the new state */
    double *compensation; /* 2n x width: what rounding it lost */
    double *state;        /* 2n x width: that of a stage */
    double *hold;         /* width; see nevh__stage_problem */
    const double *unit;   /* 2n x width: |h| over scale */
    nevh__sweeps *group;  /* under way, from this lane on */
    size_t first, first_of_eight;
} family_step;

/* Memory: compensation, slopes of the last steps that were solved for, a variable
   after the other, the last step's first; their h and of how many steps they are,
   and how long Newton's iteration goes first. */
typedef struct {
    double *compensation, *slopes, *h, *steps, *hold;
} family_memory;

static family_memory recall(const nevh_work *w) {
    const family_plan *g = w->plan;
    family_memory m = {w->memory, .slopes = w->memory + 2 * w->size};
    m.h = m.slopes + g->tableau->steps * g->unknown * w->width;
    m.steps = m.h + w->width;
    m.hold = m.steps + w->width;
    return m;
}

static void clear(nevh_work *w) {
    family_plan *g = w->plan;
    if (!g)
        return;
    nevh__tableau_free(g->tableau);
    nevh__stage_solver_free(g->solver);
    nevh__sweeps_free(g->one);
    nevh__sweeps_free(g->eight);
    nevh__sweeps_free(g->any);
    nevh__stage_weights_free(g->weights);
    free(g->lanes);
    free(g);
    w->plan = NULL;
}

static family_step lay_out(nevh_work *w, double t, double h, const double q[],
                           const double p[]) {
    const family_plan *g = w->plan;
    size_t slopes = 2 * w->size * g->tableau->stages;
    family_step s = {w, t, h, q, p, .slopes = w->scratch};
    s.unknown = s.slopes + slopes - g->unknown * w->width;
    s.sum = s.slopes + slopes;
    s.compensation = s.sum + 2 * w->size;
    s.state = s.compensation + 2 * w->size;
    s.hold = s.state + 2 * w->size;
    return s;
}

/* The step of some lanes. */
static nevh__sweep_start start_of(const family_step *s, size_t count,
                                  const size_t lanes[]) {
    return (nevh__sweep_start){.width = s->work->width,
                               .count = count,
                               .lanes = lanes,
                               .t = s->t,
                               .h = s->h,
                               .q = s->q,
                               .p = s->p,
                               .compensation = recall(s->work).compensation};
}

static int map(void *data, size_t active, const size_t lanes[],
               const double slopes[], double out[]) {
    const family_step *s = data;
    const family_plan *g = s->work->plan;
    const nevh__sweep_start start = start_of(s, active, lanes);
    (void)slopes; /* are s->unknown */
    return nevh__sweeps_map(g->any, &start, s->slopes, out);
}

/* Continues the last steps where there are any. */
static void guess(void *data, size_t lane) {
    const family_step *s = data;
    const nevh_work *w = s->work;
    const family_plan *g = w->plan;
    family_memory last = recall(w);
    size_t stages = g->tableau->stages, steps = g->tableau->steps;
    double known = last.h[lane] == s->h ? last.steps[lane] : 0;
    for (size_t row = 0; row < g->unknown; row += stages) {
        const double *x = last.slopes + row * steps * w->width + lane;
        double *to = s->unknown + row * w->width + lane;
        for (size_t i = 0; i < stages; i++)
            to[i * w->width] =
                nevh__stage_continue(g->weights, i, w->width, known, x);
    }
}

/* As many lanes as are worth while. */
static size_t begin_group(void *data, size_t first, const double unit[]) {
    family_step *s = data;
    const nevh_work *w = s->work;
    const family_plan *g = w->plan;
    family_memory last = recall(w);
    size_t rest = w->width - first;
    bool many = g->eight && rest >= NEVH__FEWEST_TOGETHER;
    size_t most = many ? NEVH__LANES : 1, count = rest < most ? rest : most;
    nevh__sweep_start start = start_of(s, count, g->lanes + first);
    start.unit = unit;
    start.past = last.slopes;
    start.steps = last.steps;
    start.past_h = last.h;
    s->group = many ? g->eight : g->one;
    s->first = s->first_of_eight = first;
    s->unit = unit;
    return s->group && nevh__sweeps_begin(s->group, &start) ? count : 0;
}

static int sweep_group(void *data, nevh__stage_progress made[]) {
    const family_step *s = data;
    return nevh__sweeps_sweep(s->group, made);
}

static void leave(void *data, size_t lane) {
    family_step *s = data;
    const family_plan *g = s->work->plan;
    nevh__sweep_start start = start_of(s, 1, g->lanes + lane);
    start.unit = s->unit;
    nevh__sweeps_take_over(g->one, &start, g->eight, lane - s->first_of_eight);
    s->group = g->one;
    s->first = lane;
}

static void count(void *data, size_t sweeps) {
    const family_step *s = data;
    nevh__sweeps_count(s->group, sweeps);
}

static void fetch(void *data, size_t lane) {
    const family_step *s = data;
    nevh__sweeps_fetch(s->group, lane, s->work->width,
                       s->slopes + s->first + lane);
}

static const nevh__stage_group groups = {.begin = begin_group,
                                         .sweep = sweep_group,
                                         .count = count,
                                         .fetch = fetch,
                                         .leave = leave,
                                         .guess = guess};

/* Sweeps of some orbits, where these suit; false when memory is out. */
static bool plan_group(nevh_work *w, const family_plan *g, nevh__swept kind,
                       nevh__sweeps **sweeps) {
    if (!nevh__sweeps_suit(w, g->tableau->stages, kind))
        return true;
    *sweeps = nevh__sweeps_new(w, g->weights, g->partitioned, kind);
    return *sweeps;
}

/* A few orbits that are left over, or under way, are swept one by one. */
static bool plan_sweeps(nevh_work *w, family_plan *g) {
    bool many = w->width >= NEVH__FEWEST_TOGETHER;
    g->any = nevh__sweeps_new(w, g->weights, g->partitioned, NEVH__ORBITS);
    if (!g->any || !plan_group(w, g, NEVH__ONE_ORBIT, &g->one) ||
        (many && !plan_group(w, g, NEVH__EIGHT_ORBITS, &g->eight)))
        return false;
    g->groups = groups;
    if (g->one && g->weights->stages == g->weights->row)
        g->groups.few = NEVH__FEW_TOGETHER;
    return true;
}

static bool plan_solver(nevh_work *w, family_plan *g) {
    nevh__tableau *a = g->tableau;
    if (!a)
        return false;
    g->partitioned = nevh__stages_are_partitioned(w);
    g->unknown = (g->partitioned ? 1 : 2) * w->n * a->stages;
    g->weights = nevh__stage_weights_new(a);
    g->lanes = nevh__array(w->width, sizeof *g->lanes);
    g->solver = nevh__stage_solver_new(
        w, &(nevh__stage_shape){a->stages, g->partitioned, a->a_q, a->a_p});
    for (size_t lane = 0; g->lanes && lane < w->width; lane++)
        g->lanes[lane] = lane;
    return g->weights && g->lanes && g->solver && plan_sweeps(w, g);
}

static nevh__tableau *make_gauss(const nevh_integrator *scheme) {
    return nevh__gauss_new((size_t)scheme->stages);
}

static nevh__tableau *make_lobatto(const nevh_integrator *scheme) {
    return nevh__lobatto_new((size_t)scheme->stages);
}

static nevh__tableau *make_implicit_euler(const nevh_integrator *scheme) {
    return nevh__implicit_euler_new((size_t)scheme->stages);
}

static nevh__tableau *make_of_table(const nevh_integrator *scheme) {
    return nevh__implicit_new(scheme->table);
}

nevh__tableau *nevh__stage_tableau_new(const nevh_integrator *scheme) {
    return scheme->kernel == &nevh__implicit_kernel ? make_of_table(scheme)
           : scheme->kernel == &nevh_gauss_kernel   ? make_gauss(scheme)
           : scheme->kernel == &nevh_lobatto_kernel
               ? make_lobatto(scheme)
               : make_implicit_euler(scheme);
}

static int plan_on(nevh_work *w, size_t fewest, size_t most,
                   nevh__tableau *(*make)(const nevh_integrator *)) {
    size_t stages = (size_t)w->integrator->stages;
    if (stages < fewest || stages > most)
        return nevh_work_fail(w, NEVH_EINVAL,
                              "%s: %zu stages, where %zu to %zu are possible",
                              w->integrator->name, stages, fewest, most);
    int status = nevh_work_find_scale(w);
    if (status)
        return status;
    family_plan *g = w->plan = nevh__array(1, sizeof *g);
    if (g)
        g->tableau = make(w->integrator);
    if (!g || !plan_solver(w, g))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    w->memory_rows = 2 * w->n + g->tableau->steps * g->unknown + 3;
    w->scratch_size = (2 * w->n * stages + 6 * w->n + 1) * w->width;
    return NEVH_OK;
}

static int plan_gauss(nevh_work *w) {
    return plan_on(w, 1, NEVH__MOST_STAGES, make_gauss);
}

static int plan_lobatto(nevh_work *w) {
    return plan_on(w, 2, NEVH__MOST_STAGES, make_lobatto);
}

static int plan_implicit_euler(nevh_work *w) {
    return plan_on(w, 1, 1, make_implicit_euler);
}

static int plan_table(nevh_work *w) {
    return plan_on(w, 1, NEVH__MOST_STAGES, make_of_table);
}

/* The evaluations that moved the state: one a stage. */
static int account(const family_step *s, const family_plan *g) {
    nevh_work *w = s->work;
    const nevh__sweep_start start = start_of(s, w->width, g->lanes);
    int status = NEVH_OK;
    nevh__sweeps_place(g->any, &start, s->slopes);
    for (size_t i = 0; !status && i < g->tableau->stages; i++) {
        const double *times = nevh__sweeps_stage(g->any, i, s->state);
        status = nevh_work_account(w, NEVH_OF_Q | NEVH_OF_P, g->weights->hb[i],
                                   times, s->state, s->state + w->size);
    }
    return status;
}

/* Moves the derivatives of earlier steps on by one step. */
static void keep_slopes(const family_step *s, const family_plan *g,
                        const family_memory *m) {
    size_t width = s->work->width, step = g->tableau->stages * width;
    size_t steps = g->tableau->steps, row = steps * step;
    double *to = m->slopes;
    for (const double *x = s->unknown; x < s->unknown + g->unknown * width;
         x += step, to += row) {
        memmove(to + step, to, (row - step) * sizeof *to);
        memcpy(to, x, step * sizeof *to);
    }
    for (size_t lane = 0; lane < width; lane++) {
        double known = m->h[lane] == s->h ? m->steps[lane] : 0;
        m->steps[lane] = nevh__stage_remember(known, (double)steps,
                                              g->solver->lane[lane].first);
        m->h[lane] = s->h;
    }
}

static int commit(const family_step *s, const family_plan *g, double q[],
                  double p[]) {
    nevh_work *w = s->work;
    size_t n = w->size;
    double check = 0;
    memcpy(s->sum, q, n * sizeof *q);
    memcpy(s->sum + n, p, n * sizeof *p);
    memcpy(s->compensation, w->memory, 2 * n * sizeof *s->compensation);
    nevh__stages_advance(g->tableau, g->weights->hb, 2 * w->n, w->width,
                         s->slopes, s->sum, s->compensation);
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
    memcpy(m.compensation, s->compensation, 2 * n * sizeof *m.compensation);
    memcpy(m.hold, s->hold, w->width * sizeof *m.hold);
    keep_slopes(s, g, &m);
    return NEVH_OK;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    family_plan *g = w->plan;
    family_step s = lay_out(w, t, h, q, p);
    nevh__stage_weights_set(g->weights, g->tableau, h);
    memcpy(s.hold, recall(w).hold, w->width * sizeof *s.hold);
    nevh__stage_problem problem = {.t = t,
                                   .h = h,
                                   .q = q,
                                   .p = p,
                                   .x = s.unknown,
                                   .map = map,
                                   .group = &g->groups,
                                   .data = &s,
                                   .hold = s.hold};
    int status = nevh__stage_solve(g->solver, &problem);
    return status ? status : commit(&s, g, q, p);
}

/* Scales the compensations of momenta; derivatives are only a guess and stay. */
static void apply_friction(nevh_work *w, const double factor[]) {
    double *compensation = recall(w).compensation + w->size;
    for (size_t i = 0; i < w->size; i++)
        compensation[i] *= factor[i / w->width];
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
const nevh_kernel nevh__implicit_kernel = {.plan = plan_table,
                                           .step = step,
                                           .clear = clear,
                                           .apply_friction = apply_friction};

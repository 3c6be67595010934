/* nevh: explicit Runge-Kutta-Nystroem methods, for H = T(p) + V(q) with a T
   quadratic in p.

   Stages are kicks at

       q_i = q + h (T_p(c_i p - h sum_j a_ij D_j) + (c_i - 1) T_p(0)),
       D_j = dV/dq(t + c_j h, q_j),

   and a step is q += h T_p(p - h sum_i b_i D_i), p -= h sum_i b'_i D_i: for
   T = p^2/2 what E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary
   Differential Equations I (1993), II.14, write for y'' = f(t, y).  No stage
   needs momenta of its own, so there is half as much to sum up as of a method
   for any H.  T_p is always asked for momenta of the size of p: differences
   have their steps from there.  Where each term of T declares to read one
   momentum, T_p(p) - T_p(0) is W p with a diagonal W, and T_p has to be asked
   for once a step:

       q_i = q + h c_i T_p(p) - h^2 W sum_j a_ij D_j.

   The stages are nystrom_step.h.  Of one orbit of a small system gradients are
   planned: number by number, where its terms have point gradients, or else as
   eight equal orbits side by side.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "nystrom_step.h"
#include "gradient/evaluation_private.h"
#include "runge_kutta_private.h"
#include "system/probe_private.h"
#include "work/work_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sums besides those of the stages. */
enum { OF_Q, OF_P, ERROR_OF_Q, ERROR_OF_P, ENDS };

struct nevh__nystrom_state {
    nevh__nystrom_step x; /* its rows have as many lanes as there may be */
    nevh_work *work;
    const nevh_nystrom *table;
    size_t n;
    void *memory;    /* holds all arrays */
    double *time;    /* a row */
    size_t lanes;    /* of the next two: 1, or the field's */
    double *rest;    /* n rows: T_p(0) */
    double *inverse; /* n rows: W, if that is diagonal by declaration */
    double known_h;  /* that lanes of h are for */
    size_t planned;  /* lanes of planned gradients; 0: there are none */
    nevh__evaluation *kicks, drift;
    double *weights;
    size_t *offsets;
    nevh__sum *sums; /* those of the stages, and of the ends */
};

static nevh__nystrom_state *state_of(const nevh_work *w) {
    return ((const nevh__stages_plan *)w->plan)->nystrom;
}

/* A row of as many lanes as there may be. */
static size_t most_lanes(const nevh_work *w) {
    return w->width > NEVH__LANES ? w->width : NEVH__LANES;
}

static bool diagonal(const nevh_system *s) {
    for (size_t i = 0; i < s->n_terms; i++) {
        const nevh_term *decl = &s->terms[i]->decl;
        if (nevh__term_on(s, s->terms[i]) && decl->np &&
            (decl->np > 1 || decl->nq > 0))
            return false;
    }
    return true;
}

static void lay_out(nevh__arena *a, void *state) {
    nevh__nystrom_state *y = state;
    size_t half = y->x.stride, stages = y->table->stages, each = sizeof(double);
    size_t lists = (stages + ENDS) * stages;
    y->x.q = nevh__arena_take(a, half, each);
    y->x.p = nevh__arena_take(a, half, each);
    y->x.compensation = nevh__arena_take(a, 2 * half, each);
    y->x.h = nevh__arena_take(a, half, each);
    y->x.way = nevh__arena_take(a, half, each);
    y->x.gain = nevh__arena_take(a, half, each);
    y->x.at_rest = nevh__arena_take(a, half, each);
    y->x.momenta = nevh__arena_take(a, half, each);
    y->x.velocities = nevh__arena_take(a, half, each);
    y->x.points = nevh__arena_take(a, half, each);
    y->x.slopes = nevh__arena_take(a, stages * half, each);
    y->time = nevh__arena_take(a, most_lanes(y->work), each);
    y->rest = nevh__arena_take(a, y->n * y->lanes, each);
    y->inverse = nevh__arena_take(a, y->n * y->lanes, each);
    y->kicks = nevh__arena_take(a, stages, sizeof *y->kicks);
    y->weights = nevh__arena_take(a, lists, each);
    y->offsets = nevh__arena_take(a, lists, sizeof *y->offsets);
    y->sums = nevh__arena_take(a, stages + ENDS, sizeof *y->sums);
}

static void list_weights(nevh__nystrom_state *y) {
    const nevh_nystrom *table = y->table;
    const double *const ends[ENDS] = {table->bq, table->bp, table->error_q,
                                      table->error_p};
    size_t s = table->stages;
    for (size_t i = 0; i < s + ENDS; i++)
        y->sums[i] =
            nevh__sum_of(i < s ? table->a + i * s : ends[i - s], i < s ? i : s,
                         y->x.stride, y->weights + i * s, y->offsets + i * s);
}

static void plan_gradients(nevh__nystrom_state *y) {
    nevh_work *w = y->work;
    size_t lanes = nevh__work_lanes(w, false, true);
    if (w->width > 1 && lanes != w->width)
        return; /* columns are not copied to longer rows */
    y->planned = lanes;
    if (!lanes)
        return;
    y->drift = nevh__work_plan(w, lanes, y->time, y->x.points, y->x.momenta,
                               NULL, y->x.velocities);
    for (size_t i = 0; i < y->table->stages; i++)
        y->kicks[i] = nevh__work_plan(w, lanes, y->time, y->x.points, y->x.p,
                                      y->x.slopes + i * y->x.stride, NULL);
}

/* Lane 0 of the coordinates to plan at, at rest. */
static void take_origin(nevh__nystrom_state *y) {
    const nevh_options *o = y->work->options;
    for (size_t k = 0; k < y->n; k++) {
        y->x.points[k] = o->q ? o->q[k * y->work->width] : 0;
        y->x.momenta[k] = 0;
    }
}

/* Refuses a T that depends on time: there is no second-order equation. */
static int check_kinetic(nevh__nystrom_state *y) {
    nevh_work *w = y->work;
    const char *term;
    take_origin(y);
    if (nevh__system_probe_kinetic_time(w->system, w->options->t, y->x.points,
                                        NULL, w->scale, &term))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    if (!term)
        return NEVH_OK;
    return nevh_work_fail(w, NEVH_ESTRUCT,
                          "%s needs a T(p) that does not depend on time, but "
                          "term \"%s\" does; schemes that fit any H: gauss12, "
                          "dop853",
                          w->integrator->name, term);
}

static int check_friction(nevh_work *w) {
    if (!(w->options->tolerance > 0) || !nevh_system_friction(w->system, NULL))
        return NEVH_OK;
    return nevh_work_fail(w, NEVH_ESTRUCT,
                          "%s takes no friction under a tolerance: friction is "
                          "put around its steps, and they would be those of "
                          "the run; leave the tolerance out, or take dop853",
                          w->integrator->name);
}

static int ask(nevh__nystrom_state *y, double velocities[]) {
    nevh_work *w = y->work;
    int status = nevh_field_gradient(w->field, 1, &w->options->t, y->x.points,
                                     y->x.momenta, NULL, velocities);
    return status
               ? nevh_work_fail(w, status, "%s", nevh_field_message(w->field))
               : NEVH_OK;
}

/* Takes the evaluations of planning out of the counts. */
static void forget(nevh_field *f) {
    for (size_t i = 0; i < f->n_terms; i++)
        f->terms[i].values = 0;
    f->gradients = 0;
}

/* The size of momentum k.  Where steps of differences are given, a momentum that is
   0 has a guess for its size, and that of the largest one is taken. */
static double size_of_momentum(const nevh__nystrom_state *y, double largest,
                               size_t k) {
    const nevh_options *o = y->work->options;
    bool guessed = o->p && (o->gradient_steps || o->gradient_step > 0) &&
                   o->p[k * y->work->width] == 0;
    return guessed && largest > 0 ? largest : y->work->scale[y->n + k];
}

/* T_p(0), and W from momenta of the size of p: powers of two, so that nothing
   is rounded. */
static int find_kinetic(nevh__nystrom_state *y) {
    const double *p = y->work->options->p;
    double largest = 0;
    for (size_t k = 0; p && k < y->n; k++)
        largest = fmax(largest, fabs(p[k * y->work->width]));
    take_origin(y);
    int status = ask(y, y->rest);
    for (size_t k = 0; !status && k < y->n; k++) {
        y->x.moves |= y->rest[k] != 0;
        y->x.momenta[k] = exp2(round(log2(size_of_momentum(y, largest, k))));
    }
    if (!status && y->x.diagonal)
        status = ask(y, y->inverse);
    for (size_t k = 0; !status && y->x.diagonal && k < y->n; k++)
        y->inverse[k] = (y->inverse[k] - y->rest[k]) / y->x.momenta[k];
    for (size_t i = y->n * y->lanes; !status && y->lanes > 1 && i-- > 0;) {
        y->rest[i] = y->rest[i / y->lanes];
        y->inverse[i] = y->inverse[i / y->lanes];
    }
    forget(y->work->field);
    return status;
}

static int plan_nystrom(nevh_work *w, nevh__nystrom_state **nystrom) {
    nevh__nystrom_state *y = *nystrom = nevh__array(1, sizeof *y);
    if (!y)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    y->work = w;
    y->table = w->integrator->table;
    y->n = w->n;
    y->x.stride = w->n * most_lanes(w);
    y->lanes = w->field->lanes ? w->field->lanes : 1;
    y->known_h = NAN;
    y->memory = nevh__arena_new(lay_out, y);
    if (!y->memory)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    y->x.diagonal = diagonal(w->system);
    y->x.c = y->table->c;
    y->x.sums = y->sums;
    list_weights(y);
    plan_gradients(y);
    int status = check_kinetic(y);
    return status ? status : find_kinetic(y);
}

bool nevh__nystrom_lane_take(nevh_work *w, size_t lane, const nevh_work *own) {
    nevh__nystrom_state *y = state_of(w);
    const nevh__nystrom_state *from = state_of(own);
    if (y->x.moves != from->x.moves)
        return false;
    for (size_t k = 0; k < y->n; k++) {
        y->rest[k * y->lanes + lane] = from->rest[k];
        y->inverse[k * y->lanes + lane] = from->inverse[k];
    }
    return true;
}

void nevh__nystrom_lane_copy(nevh_work *w, size_t from, size_t to) {
    nevh__nystrom_state *y = state_of(w);
    for (size_t k = 0; k < y->n * y->lanes; k += y->lanes) {
        y->rest[k + to] = y->rest[k + from];
        y->inverse[k + to] = y->inverse[k + from];
    }
}

nevh__nystrom_kinetic nevh__nystrom_kinetic_of(const nevh_work *w) {
    const nevh__nystrom_state *y = state_of(w);
    return (nevh__nystrom_kinetic){y->x.diagonal, y->x.moves, y->rest,
                                   y->inverse};
}

/* The evaluation of gradients, a constant of inlined functions: planned, of so many
   lanes, or by nevh_work_gradient. */
enum { BY_WORK = 0 };

/* A step whose stages are being taken. */
struct nevh__nystrom_owner {
    const nevh__nystrom_state *state;
    const nevh__stages *stages;
};

/* Rows of columns. */
static void prepare_columns(nevh__nystrom_state *y, const nevh__stages *s) {
    size_t n = y->n, size = n * s->columns;
    y->x.lanes = s->columns;
    y->x.equal = 1;
    y->x.size = size;
    y->known_h = NAN;
    memcpy(y->x.q, s->q, size * sizeof *y->x.q);
    memcpy(y->x.p, s->p, size * sizeof *y->x.p);
    memcpy(y->x.compensation, s->compensation,
           2 * size * sizeof *y->x.compensation);
    for (size_t i = 0; i < size; i++) {
        y->x.h[i] = s->h[i % s->columns];
        size_t lane = nevh__lane_of(y->work->field, s->columns, i % s->columns);
        size_t at = i / s->columns * y->lanes + (y->lanes > 1 ? lane : 0);
        y->x.at_rest[i] = y->rest[at];
        if (y->x.diagonal)
            y->x.gain[i] = y->x.h[i] * y->x.h[i] * y->inverse[at];
    }
}

/* Rows of equal lanes. */
NEVH_SIMD static void prepare_lanes(nevh__nystrom_state *y,
                                    const nevh__stages *s) {
    size_t n = y->n;
    y->x.lanes = y->x.equal = y->planned;
    y->x.size = n * y->x.lanes;
    nevh__broadcast(n, s->q, y->x.q);
    nevh__broadcast(n, s->p, y->x.p);
    nevh__broadcast(2 * n, s->compensation, y->x.compensation);
    if (y->known_h == *s->h)
        return;
    nevh__broadcast(n, y->rest, y->x.at_rest);
    for (size_t k = 0; k < n; k++) {
        double h = *s->h, gain = y->x.diagonal ? h * h * y->inverse[k] : 0;
        nevh__broadcast(1, &h, y->x.h + k * y->x.lanes);
        nevh__broadcast(1, &gain, y->x.gain + k * y->x.lanes);
    }
    y->known_h = *s->h;
}

/* Also where T seems to read the time: its differences are those of H. */
NEVH__INLINE void nevh__nystrom_time(const nevh__nystrom_step *x, int way,
                                     double c) {
    const nevh__nystrom_state *y = x->owner->state;
    const nevh__stages *s = x->owner->stages;
    if (way != BY_WORK && !y->kicks->timed && !y->drift.timed)
        return;
    for (size_t i = 0; i < x->lanes; i++) {
        size_t column = s->columns > 1 ? i : 0;
        y->time[i] = s->t[column] + c * s->h[column];
    }
}

NEVH__INLINE int run(nevh_work *w, const nevh__evaluation *e, int way) {
    return way == 1 ? nevh__work_run_points(w, e) : nevh__work_run(w, e);
}

NEVH__INLINE int nevh__nystrom_drift(const nevh__nystrom_step *x, int way) {
    const nevh__nystrom_state *y = x->owner->state;
    if (way == BY_WORK)
        return nevh_work_gradient(y->work, x->lanes, y->time, x->points,
                                  x->momenta, NULL, x->velocities);
    return run(y->work, &y->drift, way);
}

NEVH__INLINE int nevh__nystrom_kick(const nevh__nystrom_step *x, int way,
                                    size_t stage) {
    const nevh__nystrom_state *y = x->owner->state;
    if (way == BY_WORK)
        return nevh_work_gradient(y->work, x->lanes, y->time, x->points, x->p,
                                  x->slopes + stage * x->stride, NULL);
    return run(y->work, &y->kicks[stage], way);
}

NEVH__ONE_BY_ONE static int take_points(const nevh__nystrom_step *x,
                                        size_t first, size_t until) {
    return nevh__nystrom_take(x, 1, true, first, until);
}

NEVH_SIMD static int take_vectors(const nevh__nystrom_step *x, size_t first,
                                  size_t until) {
    return nevh__nystrom_take(x, NEVH__LANES, true, first, until);
}

NEVH_SIMD static int take_columns(const nevh__nystrom_step *x, size_t first,
                                  size_t until) {
    return nevh__nystrom_take(x, BY_WORK, false, first, until);
}

/* As a slope of the state, T_p and D_0; and back. */
static void hand_first(const nevh__nystrom_state *y, const nevh__stages *s) {
    size_t n = y->n * s->columns, apart = y->x.lanes / s->columns;
    for (size_t i = 0; i < n; i++) {
        s->slope[i] = y->x.velocities[i * apart];
        s->slope[n + i] = y->x.slopes[i * apart];
    }
}

static void take_first(const nevh__nystrom_state *y, const nevh__stages *s) {
    size_t n = y->n * s->columns, apart = y->x.lanes / s->columns;
    for (size_t i = 0; i < n; i++)
        for (size_t lane = 0; lane < apart; lane++) {
            y->x.velocities[i * apart + lane] = s->slope[i];
            y->x.slopes[i * apart + lane] = s->slope[n + i];
        }
}

static int take_slopes(nevh__nystrom_state *y, const nevh__stages *s, int way,
                       size_t first, size_t until) {
    const struct nevh__nystrom_owner owner = {y, s};
    y->x.owner = &owner;
    if (way > 1 && s->columns == 1)
        prepare_lanes(y, s);
    else
        prepare_columns(y, s);
    if (first > 0)
        take_first(y, s);
    int status = way == 1         ? take_points(&y->x, first, until)
                 : way == BY_WORK ? take_columns(&y->x, first, until)
                                  : take_vectors(&y->x, first, until);
    if (!status && s->slope && until == 1)
        hand_first(y, s);
    return status == NEVH__NYSTROM_RANGE ? NEVH_EDOM : status;
}

static int take(nevh__stages *s, size_t first, size_t until) {
    nevh__nystrom_state *y = state_of(s->work);
    s->planned = nevh__work_as_planned(s->work, y->planned, s->columns);
    if (!s->planned)
        return take_slopes(y, s, BY_WORK, first, until);
    int status = take_slopes(y, s, (int)y->planned, first, until);
    if (!status)
        s->work->field->gradients += (until - first) * s->columns;
    return status;
}

/* The change of q, and -h sum_j weights[j] D_j, for each column. */
NEVH_SIMD static int sum_up(nevh__nystrom_state *y, const nevh__stages *s,
                            size_t of_q, size_t of_p, double c, double out[]) {
    const struct nevh__nystrom_owner owner = {y, s};
    const nevh__sum *ends = y->sums + y->table->stages;
    size_t apart = y->x.lanes / s->columns;
    int way = s->planned ? (int)y->x.lanes : BY_WORK;
    y->x.owner = &owner;
    nevh__nystrom_sum_kicks(&y->x, &ends[of_p], apart, out + y->n * s->columns);
    return nevh__nystrom_sum_drifts(&y->x, way, &ends[of_q], c, apart, out);
}

static int finish(const nevh__stages *s, double change[], double error[],
                  double coarse[]) {
    nevh__nystrom_state *y = state_of(s->work);
    (void)coarse;
    int status = sum_up(y, s, OF_Q, OF_P, 1, change);
    return status || !error ? status
                            : sum_up(y, s, ERROR_OF_Q, ERROR_OF_P, 0, error);
}

static int place_again(nevh__nystrom_state *y, const nevh__stages *s,
                       size_t stage) {
    const struct nevh__nystrom_owner owner = {y, s};
    y->x.owner = &owner;
    return nevh__nystrom_place(&y->x, BY_WORK, stage);
}

/* T does not read the time, so where momenta are does not matter. */
static int account(const nevh__stages *s) {
    nevh_work *w = s->work;
    nevh__nystrom_state *y = state_of(w);
    const nevh_nystrom *table = y->table;
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < table->stages; i++)
        if (table->bp[i] != 0) {
            status = place_again(y, s, i);
            if (!status)
                status = nevh_work_account(w, NEVH_OF_Q | NEVH_OF_P,
                                           table->bp[i] * s->h[0], y->time,
                                           y->x.points, y->x.p);
        }
    return status;
}

static int plan(nevh_work *w) {
    const nevh_nystrom *table = w->integrator->table;
    nevh__stages_plan *plan = w->plan = nevh__array(1, sizeof *plan);
    int status = plan ? check_friction(w)
                      : nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    if (!status)
        status = nevh_work_find_scale(w);
    if (!status)
        status = plan_nystrom(w, &plan->nystrom);
    if (status)
        return status;
    plan->family = (nevh__family){.stages = table->stages,
                                  .error_power = table->error_power,
                                  .take = take,
                                  .finish = finish,
                                  .account = account};
    if (table->error_p && w->options->tolerance > 0)
        return nevh__adaptive_plan(w);
    w->memory_rows = 2 * w->n;
    w->scratch_size = 2 * w->size + 2 * w->width;
    return NEVH_OK;
}

static void clear(nevh_work *w) {
    nevh__stages_plan *plan = w->plan;
    if (!plan)
        return;
    nevh__adaptive_clear(w);
    if (plan->nystrom)
        free(plan->nystrom->memory);
    free(plan->nystrom);
    free(plan);
    w->plan = NULL;
}

static void apply_friction(nevh_work *w, const double factor[]) {
    double *compensation = w->memory + w->size;
    for (size_t i = 0; i < w->size; i++)
        compensation[i] *= factor[i / w->width];
}

const nevh_kernel nevh_nystrom_kernel = {.plan = plan,
                                         .step = nevh__stages_step,
                                         .clear = clear,
                                         .apply_friction = apply_friction};

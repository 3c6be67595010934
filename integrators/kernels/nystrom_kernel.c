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
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "nystrom_private.h"
#include "system/probe_private.h"
#include "work/work_private.h"
#include <math.h>
#include <stdlib.h>

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
    size_t half = y->stride, stages = y->table->stages, each = sizeof(double);
    size_t lists = (stages + ENDS) * stages;
    y->q = nevh__arena_take(a, half, each);
    y->p = nevh__arena_take(a, half, each);
    y->carry = nevh__arena_take(a, 2 * half, each);
    y->h = nevh__arena_take(a, half, each);
    y->way = nevh__arena_take(a, half, each);
    y->gain = nevh__arena_take(a, half, each);
    y->at_rest = nevh__arena_take(a, half, each);
    y->momenta = nevh__arena_take(a, half, each);
    y->velocities = nevh__arena_take(a, half, each);
    y->points = nevh__arena_take(a, half, each);
    y->slopes = nevh__arena_take(a, stages * half, each);
    y->time = nevh__arena_take(a, most_lanes(y->work), each);
    y->rest = nevh__arena_take(a, y->n, each);
    y->inverse = nevh__arena_take(a, y->n, each);
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
                         y->stride, y->weights + i * s, y->offsets + i * s);
}

static bool plan_calls(nevh__nystrom_state *y, size_t lanes) {
    nevh_field *f = y->work->field;
    y->drift = nevh__call_plan(f, lanes, y->time, y->points, y->momenta, NULL,
                               y->velocities);
    for (size_t i = 0; i < y->table->stages; i++)
        y->kicks[i] = nevh__call_plan(f, lanes, y->time, y->points, y->p,
                                      y->slopes + i * y->stride, NULL);
    return y->drift.count && y->kicks[0].count;
}

static void find_calls(nevh__nystrom_state *y) {
    if (y->work->width > 1 || y->work->transform)
        return;
    if (plan_calls(y, 1))
        y->call_lanes = 1;
    else if (y->work->field->repeats && plan_calls(y, NEVH__LANES))
        y->call_lanes = NEVH__LANES;
}

/* Lane 0 of the coordinates to plan at, at rest. */
static void take_origin(nevh__nystrom_state *y) {
    const nevh_options *o = y->work->options;
    for (size_t k = 0; k < y->n; k++) {
        y->points[k] = o->q ? o->q[k * y->work->width] : 0;
        y->momenta[k] = 0;
    }
}

/* Where T depends on time there is no second-order equation. */
static int check_kinetic(nevh__nystrom_state *y) {
    nevh_work *w = y->work;
    const char *term;
    take_origin(y);
    if (nevh__system_probe_kinetic_time(w->system, w->options->t, y->points,
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
    int status = nevh_field_gradient(w->field, 1, &w->options->t, y->points,
                                     y->momenta, NULL, velocities);
    return status
               ? nevh_work_fail(w, status, "%s", nevh_field_message(w->field))
               : NEVH_OK;
}

/* What planning asked for does not count. */
static void forget(nevh_field *f) {
    for (size_t i = 0; i < f->n_terms; i++)
        f->terms[i].values = 0;
    f->gradients = 0;
}

/* T_p(0), and W from momenta of the size of p: powers of two, so that nothing
   is rounded. */
static int find_kinetic(nevh__nystrom_state *y) {
    const double *scale = y->work->scale + y->n;
    take_origin(y);
    int status = ask(y, y->rest);
    for (size_t k = 0; !status && k < y->n; k++) {
        y->moves |= y->rest[k] != 0;
        y->momenta[k] = exp2(round(log2(scale[k])));
    }
    if (!status && y->inverse)
        status = ask(y, y->inverse);
    for (size_t k = 0; !status && y->inverse && k < y->n; k++)
        y->inverse[k] = (y->inverse[k] - y->rest[k]) / y->momenta[k];
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
    y->stride = w->n * most_lanes(w);
    y->known_h = NAN;
    y->memory = nevh__arena_new(lay_out, y);
    if (!y->memory)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    if (!diagonal(w->system))
        y->inverse = NULL;
    list_weights(y);
    find_calls(y);
    int status = check_kinetic(y);
    return status ? status : find_kinetic(y);
}

/* T does not read the time, so where momenta are does not matter. */
static int account(const nevh__stages *s) {
    nevh_work *w = s->work;
    nevh__nystrom_state *y = nevh__nystrom_of(w);
    const nevh_nystrom *table = y->table;
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < table->stages; i++)
        if (table->bp[i] != 0) {
            status = nevh__nystrom_place(y, s, i);
            if (!status)
                status = nevh_work_account(w, NEVH_OF_Q | NEVH_OF_P,
                                           table->bp[i] * s->h[0], y->time,
                                           y->points, y->p);
        }
    return status;
}

static int plan(nevh_work *w) {
    const nevh_nystrom *table = w->integrator->table;
    nevh__stages_plan *plan = w->plan = nevh__array(1, sizeof *plan);
    int status = plan ? check_friction(w)
                      : nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    if (!status)
        status = plan_nystrom(w, &plan->nystrom);
    if (status)
        return status;
    plan->family = (nevh__family){.stages = table->stages,
                                  .error_power = table->error_power,
                                  .take = nevh__nystrom_take,
                                  .finish = nevh__nystrom_finish,
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
    double *carry = w->memory + w->size;
    for (size_t i = 0; i < w->size; i++)
        carry[i] *= factor[i / w->width];
}

const nevh_kernel nevh_nystrom_kernel = {.plan = plan,
                                         .step = nevh__stages_step,
                                         .clear = clear,
                                         .apply_friction = apply_friction};

/* nevh: Tao's symplectic splitting in a doubled phase space, for any H.

   A second copy (x, y) of (q, p) makes H explicit: in

       H(q, y) + H(x, p) + omega/2 sum_k (r_k (q_k - x_k)^2
                                          + (p_k - y_k)^2 / r_k)

   each of the three parts has a flow that can be written down,

       A: p -= h dH/dq(q, y), x += h dH/dp(q, y),
       B: y -= h dH/dq(x, p), q += h dH/dp(x, p),
       C: (x - q, y - p) turns by 2 omega h, q + x and p + y rest,

   and A(h/2) B(h/2) C(h) B(h/2) A(h/2) is a step of order 2 [M. Tao, Phys. Rev.
   E 94 (2016) 043303, sec. I], of which higher orders are composed.  The
   lengths of p over those of q, r_k, keep the user's units out of the binding;
   they and omega are chosen in tao_binding.c.

   The copies begin as one, and stay close: what is remembered of the second
   one is its small difference from the first.  The gradient of the last A is
   that of the next one, so a step of order 2 takes three.

   Time is that of the beginning of a step in its first A and B, and of its end
   in its last: C moves it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tao_step.h"
#include "tao_private.h"
#include "system/system_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct nevh__tao_owner {
    nevh_work *work;
    double *time; /* a row: of what was taken last */
};

static double *block(const nevh_work *w, int which) {
    return w->memory + (size_t)which * w->size;
}

static nevh__tao_group lay_out_group(size_t n, double *room) {
    return (nevh__tao_group){room, room + n, room + 2 * n, room + 3 * n};
}

static nevh__tao_step begin(nevh_work *w, double h, const double q[],
                            const double p[]) {
    size_t n = w->size;
    const nevh_splitting *table = w->integrator->table;
    nevh__binding *binding = w->plan;
    nevh__tao_step z = {.size = n,
                        .width = w->width,
                        .parts = 2 * table->count + 1,
                        .lengths = binding->lengths,
                        .ratio = binding->ratio,
                        .start_q = q,
                        .start_p = p,
                        .compensation = block(w, NEVH__TAO_COMPENSATION_Q),
                        .q = w->scratch,
                        .p = w->scratch + n,
                        .x = w->scratch + 2 * n,
                        .y = w->scratch + 3 * n,
                        .a = lay_out_group(n, w->scratch + 4 * n),
                        .b = lay_out_group(n, w->scratch + 8 * n)};
    if (binding->known_h != h)
        nevh__tao_prepare(table->count, binding->weights, binding->omega, h,
                          binding->lengths);
    binding->known_h = h;
    memset(z.q, 0, 2 * n * sizeof *z.q);
    memcpy(z.x, block(w, NEVH__TAO_X), 2 * n * sizeof *z.x);
    return z;
}

NEVH__INLINE int nevh__tao_slope(const nevh__tao_step *z,
                                 const nevh__tao_group *g, double t) {
    const struct nevh__tao_owner *o = z->owner;
    for (size_t lane = 0; lane < z->width; lane++)
        o->time[lane] = t;
    return nevh_work_gradient(o->work, z->width, o->time, g->q, g->p, g->dh_dq,
                              g->dh_dp);
}

NEVH__INLINE int nevh__tao_account(const nevh__tao_step *z,
                                   const nevh__tao_group *g, double h) {
    const struct nevh__tao_owner *o = z->owner;
    return o->work->accounts ? nevh_work_account(o->work, NEVH_OF_Q | NEVH_OF_P,
                                                 h, o->time, g->q, g->p)
                             : NEVH_OK;
}

/* The gradient at the start: kept, in the lanes that have one. */
static int recall(const nevh__tao_step *z, double t) {
    const nevh_work *w = z->owner->work;
    const double *kept = block(w, NEVH__TAO_DH_DQ);
    const double *has = block(w, NEVH__TAO_BLOCKS);
    size_t count = 0;
    for (size_t lane = 0; lane < w->width; lane++) {
        count += has[lane] != 0;
        z->owner->time[lane] = t;
    }
    nevh__tao_place(z, &z->a, z->q, z->y);
    int status = count < w->width ? nevh__tao_slope(z, &z->a, t) : NEVH_OK;
    for (size_t i = 0; !status && count && i < 2 * w->size; i++)
        if (has[i % w->width] != 0)
            z->a.dh_dq[i] = kept[i];
    return status;
}

/* Writes the step, if it is one of finite numbers. */
static int commit(const nevh__tao_step *z, double q[], double p[]) {
    nevh_work *w = z->owner->work;
    if (nevh__not_finite(1, w->size, z->x, z->y))
        return nevh_work_fail(w, NEVH_EDOM,
                              "the two copies of the state are no longer "
                              "finite numbers apart: take a smaller step");
    int status = nevh_work_commit(w, w->size, q, z->q, block(w, 0), p, z->p,
                                  block(w, NEVH__TAO_COMPENSATION_P));
    if (status)
        return status;
    memcpy(block(w, NEVH__TAO_X), z->x, 2 * w->size * sizeof *z->x);
    memcpy(block(w, NEVH__TAO_DH_DQ), z->a.dh_dq,
           2 * w->size * sizeof *z->a.dh_dq);
    for (size_t lane = 0; lane < w->width; lane++)
        block(w, NEVH__TAO_BLOCKS)[lane] = 1;
    return NEVH_OK;
}

static void list_weights(const nevh_splitting *c, double weights[]) {
    for (size_t i = 0; i < c->count; i++)
        weights[i] = (double)c->weights[i];
}

double nevh__composition_part(const nevh_splitting *c, size_t i, double h) {
    double weights[NEVH__TAO_MOST_WEIGHTS];
    list_weights(c, weights);
    return nevh__tao_part(c->count, weights, i, h);
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    nevh__tao_step z = begin(w, h, q, p);
    struct nevh__tao_owner owner = {w, w->scratch + 12 * w->size};
    z.owner = &owner;
    int status = recall(&z, t);
    if (!status)
        status = nevh__tao_take(&z, t);
    return status ? status : commit(&z, q, p);
}

static void apply_friction(nevh_work *w, const double factor[]) {
    double *compensation = block(w, NEVH__TAO_COMPENSATION_P),
           *y = block(w, NEVH__TAO_Y);
    for (size_t i = 0; i < w->size; i++) {
        compensation[i] *= factor[i / w->width];
        y[i] *= factor[i / w->width];
    }
    memset(block(w, NEVH__TAO_BLOCKS), 0, w->width * sizeof *y);
}

static void clear(nevh_work *w) {
    nevh__binding *binding = w->plan;
    free(binding->ratio);
    free(binding);
    w->plan = NULL;
}

static int plan(nevh_work *w) {
    nevh__binding *binding = w->plan = nevh__array(1, sizeof *binding);
    if (!binding || !(binding->ratio = nevh__array(w->n, sizeof(double))))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    w->memory_rows = NEVH__TAO_BLOCKS * w->n + 1;
    w->scratch_size = 12 * w->size + w->width;
    binding->known_h = NAN;
    list_weights(w->integrator->table, binding->weights);
    return nevh__binding_choose(w, binding);
}

const nevh_kernel nevh__tao_kernel = {.plan = plan,
                                      .step = step,
                                      .clear = clear,
                                      .apply_friction = apply_friction};

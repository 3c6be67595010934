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
#include "tao_private.h"
#include "system/system_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where a group of evaluations is taken, and their results. */
typedef struct {
    double *t, *q, *p, *dh_dq, *dh_dp;
} group;

/* One step under way: changes since its beginning, of the first copy's q and p
   and of x and y, those being counted from q and p there. */
typedef struct {
    nevh_work *work;
    const double *start_q, *start_p, *compensation_q, *compensation_p;
    double *q, *p, *x, *y;
    group a, b; /* at (q, y) and (x, p) */
} doubled;

static double *block(const nevh_work *w, int which) {
    return w->memory + (size_t)which * w->size;
}

static group lay_out_group(const nevh_work *w, double *room) {
    size_t n = w->size;
    return (group){room + 4 * n, room, room + n, room + 2 * n, room + 3 * n};
}

static doubled begin(nevh_work *w, const double q[], const double p[]) {
    size_t n = w->size, each = 4 * n + w->width;
    double *room = w->scratch + 4 * n;
    doubled z = {w,
                 q,
                 p,
                 block(w, NEVH__TAO_COMPENSATION_Q),
                 block(w, NEVH__TAO_COMPENSATION_P),
                 w->scratch,
                 w->scratch + n,
                 w->scratch + 2 * n,
                 w->scratch + 3 * n,
                 lay_out_group(w, room),
                 lay_out_group(w, room + each)};
    memset(z.q, 0, 2 * n * sizeof *z.q);
    memcpy(z.x, block(w, NEVH__TAO_X), 2 * n * sizeof *z.x);
    return z;
}

static void place(const doubled *z, const group *g, double t) {
    const double *q = g == &z->a ? z->q : z->x, *p = g == &z->a ? z->y : z->p;
    for (size_t i = 0; i < z->work->size; i++) {
        g->q[i] = z->start_q[i] + (q[i] + z->compensation_q[i]);
        g->p[i] = z->start_p[i] + (p[i] + z->compensation_p[i]);
    }
    for (size_t lane = 0; lane < z->work->width; lane++)
        g->t[lane] = t;
}

static int take(const doubled *z, const group *g, double t) {
    place(z, g, t);
    return nevh_work_gradient(z->work, z->work->width, g->t, g->q, g->p,
                              g->dh_dq, g->dh_dp);
}

/* The gradient at the start: kept, in the lanes that have one. */
static int recall(const doubled *z, double t) {
    const nevh_work *w = z->work;
    const double *kept = block(w, NEVH__TAO_DH_DQ);
    const double *has = block(w, NEVH__TAO_BLOCKS);
    size_t count = 0;
    for (size_t lane = 0; lane < w->width; lane++)
        count += has[lane] != 0;
    place(z, &z->a, t);
    int status = count < w->width ? take(z, &z->a, t) : NEVH_OK;
    for (size_t i = 0; !status && count && i < 2 * w->size; i++)
        if (has[i % w->width] != 0)
            z->a.dh_dq[i] = kept[i];
    return status;
}

/* Moves what the group does not read; H counts twice in the doubled one. */
static int move(const doubled *z, const group *g, double h) {
    double *p = g == &z->a ? z->p : z->y, *q = g == &z->a ? z->x : z->q;
    for (size_t i = 0; i < z->work->size; i++) {
        p[i] -= h * g->dh_dq[i];
        q[i] += h * g->dh_dp[i];
    }
    return z->work->accounts ? nevh_work_account(z->work, NEVH_OF_Q | NEVH_OF_P,
                                                 h / 2, g->t, g->q, g->p)
                             : NEVH_OK;
}

/* Turns (x - q, y - p) about the middle of the two. */
static void bind(const doubled *z, double h) {
    const nevh_work *w = z->work;
    const nevh__binding *binding = w->plan;
    double angle = 2 * binding->omega * h;
    double cosine = cos(angle), sine = sin(angle);
    if (angle == 0)
        return;
    for (size_t i = 0; i < w->size; i++) {
        double r = binding->ratio[i / w->width];
        double d = z->x[i] - z->q[i], e = z->y[i] - z->p[i];
        double half_d = (d - (cosine * d + sine * (e / r))) / 2;
        double half_e = (e - (cosine * e - sine * (d * r))) / 2;
        z->q[i] += half_d;
        z->x[i] -= half_d;
        z->p[i] += half_e;
        z->y[i] -= half_e;
    }
}

/* B C B, between two A. */
static int turn(const doubled *z, double t, double h) {
    int status = take(z, &z->b, t);
    if (!status)
        status = move(z, &z->b, h / 2);
    if (status)
        return status;
    bind(z, h);
    status = take(z, &z->b, t + h);
    return status ? status : move(z, &z->b, h / 2);
}

/* Writes the step, if it is one of finite numbers. */
static int commit(const doubled *z, double q[], double p[]) {
    nevh_work *w = z->work;
    double check = 0;
    for (size_t i = 0; i < w->size; i++) {
        z->x[i] -= z->q[i];
        z->y[i] -= z->p[i];
        check += (z->x[i] - z->x[i]) + (z->y[i] - z->y[i]);
    }
    if (check != 0)
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

double nevh__composition_part(const nevh_splitting *c, size_t i, double h) {
    if (i > c->count)
        i = 2 * c->count - i;
    if (i < c->count)
        return h * (double)c->weights[i];
    double rest = h;
    for (size_t k = 0; k < c->count; k++)
        rest -= 2 * (h * (double)c->weights[k]);
    return rest;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const nevh_splitting *table = w->integrator->table;
    doubled z = begin(w, q, p);
    double passed = 0, last = 0;
    int status = recall(&z, t);
    for (size_t i = 0; !status && i <= 2 * table->count; i++) {
        double part = nevh__composition_part(table, i, h);
        status = move(&z, &z.a, (last + part) / 2);
        if (!status)
            status = turn(&z, t + passed, part);
        passed += last = part;
        if (!status)
            status = take(&z, &z.a, t + passed);
    }
    if (!status)
        status = move(&z, &z.a, last / 2);
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
    w->scratch_size = 12 * w->size + 2 * w->width;
    return nevh__binding_choose(w, binding);
}

const nevh_kernel nevh__tao_kernel = {.plan = plan,
                                      .step = step,
                                      .clear = clear,
                                      .apply_friction = apply_friction};

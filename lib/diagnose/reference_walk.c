/* nevh: the states of a reference that is a run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/reference_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SLOTS = 1 << 15, FEWEST_SLOTS = 16 };

nevh_stepper *nevh__reference_stepper(const nevh_reference *r) {
    nevh_options o = {.gradient = nevh_exact,
                      .t = r->t0,
                      .q = r->start,
                      .p = r->start + r->n};
    if (nevh_integrator_needs_tolerance(r->integrator))
        o.tolerance = 1e-13;
    nevh_stepper *s = nevh_stepper_new(r->system, r->integrator, &o);
    if (nevh_stepper_status(s) != NEVH_ENOGRAD)
        return s;
    nevh_stepper_free(s);
    o.gradient = nevh_central8;
    return nevh_stepper_new(r->system, r->integrator, &o);
}

static bool memo_open(nevh__memo *m, size_t n) {
    m->slots = MOST_SLOTS;
    while (m->slots > FEWEST_SLOTS &&
           m->slots * 2 * n * sizeof *m->states > NEVH__MOST_MEMO)
        m->slots /= 2;
    if (!m->keys)
        m->keys = nevh__array(m->slots, sizeof *m->keys);
    if (!m->states)
        m->states = nevh__array(m->slots * 2 * n, sizeof *m->states);
    return m->keys && m->states;
}

static uint64_t key_of(double t) {
    uint64_t bits;
    t += 0.0; /* no negative zero */
    memcpy(&bits, &t, sizeof bits);
    return ~bits; /* 0 would be not a number */
}

/* The slot of a time, or a free one for it. */
static size_t reference_walk_slot_of(const nevh__memo *m, uint64_t key) {
    size_t i = (size_t)((key * 0x9e3779b97f4a7c15u) >> 32) & (m->slots - 1);
    while (m->keys[i] && m->keys[i] != key)
        i = (i + 1) & (m->slots - 1);
    return i;
}

static const double *recall(const nevh_reference *r, double t) {
    const nevh__memo *m = &r->memo;
    size_t i = reference_walk_slot_of(m, key_of(t));
    return m->keys[i] ? m->states + 2 * r->n * i : NULL;
}

static void remember(nevh_reference *r, double t, const double q[],
                     const double p[]) {
    nevh__memo *m = &r->memo;
    if (++m->used > m->slots / 4 * 3) {
        memset(m->keys, 0, m->slots * sizeof *m->keys);
        m->used = 1;
    }
    size_t i = reference_walk_slot_of(m, key_of(t));
    m->keys[i] = key_of(t);
    memcpy(m->states + 2 * r->n * i, q, r->n * sizeof *q);
    memcpy(m->states + (2 * i + 1) * r->n, p, r->n * sizeof *p);
}

static int open_walk(nevh_reference *r) {
    if (!r->walker)
        r->walker = nevh__reference_stepper(r);
    if (!r->branch)
        r->branch = nevh__reference_stepper(r);
    if (!r->walker || !r->branch || !memo_open(&r->memo, r->n))
        return nevh__no_memory(&r->report);
    return NEVH_OK;
}

static int reference_walk_take_step(nevh_reference *r, nevh_stepper *s,
                                    double t, double h, double q[],
                                    double p[]) {
    int status = nevh_stepper_apply(s, t, h, q, p);
    if (!status)
        return NEVH_OK;
    return nevh__fail(&r->report, status, "%s", nevh_stepper_message(s));
}

/* To the state after `steps` steps, from the last checkpoint or from where the
   last walk ended. */
static int walk_to(nevh_reference *r, size_t steps) {
    const nevh__reference_orbit *k = &r->orbit;
    size_t checkpoint = steps / k->every;
    if (checkpoint >= k->count)
        checkpoint = k->count - 1;
    if (!r->walking || r->steps > steps || r->steps < checkpoint * k->every) {
        memcpy(r->walked, k->states + 2 * r->n * checkpoint,
               2 * r->n * sizeof *r->walked);
        r->steps = checkpoint * k->every;
        nevh_stepper_reset(r->walker);
    }
    int status = NEVH_OK;
    for (; !status && r->steps < steps; r->steps += !status)
        status = reference_walk_take_step(r, r->walker,
                                          r->t0 + (double)r->steps * k->h, k->h,
                                          r->walked, r->walked + r->n);
    r->walking = !status;
    return status;
}

static int find_state(nevh_reference *r, double elapsed, double q[],
                      double p[]) {
    double h = r->orbit.h, steps = floor(elapsed / h);
    double remainder = elapsed - steps * h;
    int status = walk_to(r, (size_t)steps);
    if (status)
        return status;
    memcpy(q, r->walked, r->n * sizeof *q);
    memcpy(p, r->walked + r->n, r->n * sizeof *p);
    if (remainder == 0)
        return NEVH_OK;
    nevh_stepper_reset(r->branch);
    return reference_walk_take_step(r, r->branch, r->t0 + steps * h, remainder,
                                    q, p);
}

int nevh__reference_walk(nevh_reference *r, double elapsed, double q[],
                         double p[]) {
    int status = open_walk(r);
    if (status)
        return status;
    const double *known = recall(r, elapsed);
    if (known) {
        memcpy(q, known, r->n * sizeof *q);
        memcpy(p, known + r->n, r->n * sizeof *p);
        return NEVH_OK;
    }
    status = find_state(r, elapsed, q, p);
    if (!status)
        remember(r, elapsed, q, p);
    return status;
}

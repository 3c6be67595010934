/* nevh: how far a run is from its reference.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/reference_private.h"
#include "run/stepper_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { TIMES = 1024 };
/* So that times do not fall on the same phase of every period. */
static const double golden = 0.6180339887498949;

struct nevh_state_error {
    nevh_reference *reference;
    const nevh_stepper *followed; /* NULL: times are those observed */
    double h;                     /* of its steps; 0: none was seen */
    double worst;
    size_t next; /* the first of the wanted times that has not come */
    bool observed, unknown;
    nevh_pair_fn hand; /* NULL: nobody wants the pairs */
    void *hand_data;
    double *difference;  /* 2n: the largest so far */
    double *rounded;     /* 2n: the state of the reference */
    long double state[]; /* 2n: with the digits that it has; then all of that */
};

nevh_state_error *nevh_state_error_new(nevh_reference *r) {
    size_t n = r ? r->n : 0;
    size_t room = 2 * n * (sizeof(long double) + 2 * sizeof(double));
    nevh_state_error *e = r ? nevh__array(1, sizeof *e + room) : NULL;
    if (!e)
        return NULL;
    e->reference = r;
    e->difference = (double *)(e->state + 2 * n);
    e->rounded = e->difference + 2 * n;
    return e;
}

void nevh_state_error_free(nevh_state_error *e) {
    free(e);
}

/* The i-th time at which the orbits are to be compared, from 0 to 1. */
static double wanted(size_t i) {
    double turn = (double)i * golden;
    return i >= TIMES ? 1 : ((double)i + turn - floor(turn)) / TIMES;
}

static bool is_due(nevh_state_error *e, double t) {
    const nevh_reference *r = e->reference;
    double part = (t - r->t0) / (r->t1 - r->t0);
    if (e->next > TIMES || part < wanted(e->next))
        return false;
    while (e->next <= TIMES && part >= wanted(e->next))
        e->next++;
    return true;
}

void nevh_state_error_follow(nevh_state_error *e, const nevh_stepper *s) {
    if (!e)
        return;
    e->followed = s;
    e->h = 0;
}

void nevh_state_error_hand(nevh_state_error *e, nevh_pair_fn hand, void *data) {
    if (!e)
        return;
    e->hand = hand;
    e->hand_data = data;
}

/* The time since the start.  t is rounded; what the steps add up to is not, or
   less.  The last step may be another than the others. */
static double state_error_elapsed(nevh_state_error *e, size_t step, double t) {
    const nevh_stepper *s = e->followed;
    double t0 = e->reference->t0, passed = t - t0;
    double slack = 4 * DBL_EPSILON * fmax(fabs(t), fabs(t0));
    if (!s || step == 0)
        return passed;
    if (e->h == 0)
        e->h = s->last_h;
    double better = s->own_time ? passed + s->time_roundoff
                                : (double)(step - 1) * e->h + s->last_h;
    return fabs(better - passed) <= slack ? better : passed;
}

static void state_error_add(nevh_state_error *e, size_t k, double value) {
    double difference = (double)fabsl(value - e->state[k]);
    double error = difference / nevh_reference_range(e->reference, k);
    e->worst = fmax(e->worst, isfinite(error) ? error : INFINITY);
    e->difference[k] =
        fmax(e->difference[k], isfinite(difference) ? difference : INFINITY);
}

int nevh_state_error_observe(void *state_error, size_t step, double t,
                             const double q[], const double p[]) {
    if (!state_error)
        return NEVH_EINVAL;
    nevh_state_error *e = state_error;
    size_t n = e->reference->n;
    double passed = state_error_elapsed(e, step, t);
    if (e->unknown || !is_due(e, t))
        return NEVH_OK;
    e->observed = true;
    e->unknown = nevh__reference_find(e->reference, passed, e->state);
    for (size_t k = 0; !e->unknown && k < n; k++) {
        state_error_add(e, k, q[k]);
        state_error_add(e, n + k, p[k]);
    }
    for (size_t k = 0; k < 2 * n; k++)
        e->rounded[k] = (double)e->state[k];
    if (!e->unknown && e->hand)
        e->hand(e->hand_data, t, q, p, e->rounded);
    return NEVH_OK;
}

double nevh_state_error_result(const nevh_state_error *e) {
    return e && e->observed && !e->unknown ? e->worst : NAN;
}

double nevh_state_error_of(const nevh_state_error *e, size_t k) {
    return e && e->observed && !e->unknown && k < 2 * e->reference->n
               ? e->difference[k]
               : NAN;
}

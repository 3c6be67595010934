/* nevh: how far a run is from its reference.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/reference_private.h"
#include <math.h>
#include <stdlib.h>

enum { TIMES = 1024 };
/* So that times do not fall on the same phase of every period. */
static const double golden = 0.6180339887498949;

struct nevh_state_error {
    nevh_reference *reference;
    double worst;
    size_t next; /* the first of the wanted times that has not come */
    bool observed, unknown;
    double state[]; /* 2n */
};

nevh_state_error *nevh_state_error_new(nevh_reference *r) {
    size_t n = r ? r->n : 0;
    nevh_state_error *e =
        r ? nevh__array(1, sizeof *e + 2 * n * sizeof *e->state) : NULL;
    if (e)
        e->reference = r;
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

static void add(nevh_state_error *e, size_t k, double value) {
    double error =
        fabs(value - e->state[k]) / nevh_reference_range(e->reference, k);
    e->worst = fmax(e->worst, isfinite(error) ? error : INFINITY);
}

int nevh_state_error_observe(void *state_error, size_t step, double t,
                             const double q[], const double p[]) {
    nevh_state_error *e = state_error;
    size_t n = e->reference->n;
    (void)step;
    if (e->unknown || !is_due(e, t))
        return NEVH_OK;
    e->observed = true;
    e->unknown = nevh_reference_state(e->reference, t, e->state,
                                      e->state + n) != NEVH_OK;
    for (size_t k = 0; !e->unknown && k < n; k++) {
        add(e, k, q[k]);
        add(e, n + k, p[k]);
    }
    return NEVH_OK;
}

double nevh_state_error_result(const nevh_state_error *e) {
    return e && e->observed && !e->unknown ? e->worst : NAN;
}

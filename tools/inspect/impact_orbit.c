/* nevh effects --impact: orbits with and without an effect.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "impact_private.h"
#include <math.h>
#include <string.h>
#include <time.h>

enum { SAMPLES = 500, REPEATS = 5 };
static const double time_enough = 0.05; /* seconds */
static const double noticed = 0.01;     /* of the range */

static int keep(void *data, size_t step, double t, const double q[],
                const double p[]) {
    trace *o = data;
    size_t n = o->plan->n;
    o->t = t;
    memcpy(o->last, q, n * sizeof *q);
    memcpy(o->last + n, p, n * sizeof *p);
    for (size_t k = 0; k < 2 * n; k++) {
        o->low[k] = fmin(o->low[k], o->last[k]);
        o->high[k] = fmax(o->high[k], o->last[k]);
    }
    if (step % o->every == 0 && step / o->every < o->most) {
        memcpy(o->states + step / o->every * 2 * n, o->last, 2 * n * sizeof *q);
        o->kept = step / o->every + 1;
    }
    return 0;
}

static trace new_trace(const plan *p, size_t most) {
    size_t n = 2 * p->n;
    double steps = (p->t_end - p->run->t_start) / p->dt[0];
    trace o = {.plan = p,
               .most = most,
               .every = (size_t)(steps / (double)most) + 1,
               .states = tool_allocate(most * n, sizeof(double)),
               .last = tool_allocate(n, sizeof(double)),
               .low = tool_allocate(n, sizeof(double)),
               .high = tool_allocate(n, sizeof(double))};
    for (size_t k = 0; k < n; k++) {
        o.low[k] = INFINITY;
        o.high[k] = -INFINITY;
    }
    return o;
}

static int go(trace *o, nevh_stepper *s, const nevh_observer *observer) {
    const plan *p = o->plan;
    return plan_run(p, s, p->dt[0], observer, observer ? 1 : 0, &o->stopped);
}

/* The shortest of a few runs that nobody watches. */
static void measure(trace *o, nevh_stepper *s) {
    double sum = 0;
    o->seconds = INFINITY;
    for (int i = 0; i < REPEATS && sum < time_enough; i++) {
        nevh_counts before = nevh_stepper_counts(s);
        nevh_stepper_reset(s);
        double start = cpu_seconds();
        go(o, s, NULL);
        double spent = cpu_seconds() - start;
        o->seconds = fmin(o->seconds, spent);
        sum += spent;
        o->work = (double)(nevh_stepper_counts(s).values - before.values);
    }
}

trace trace_run(const plan *p, const char *integrator) {
    trace o = new_trace(p, SAMPLES);
    nevh_stepper *s = plan_stepper(p, integrator);
    o.status = go(&o, s, &(nevh_observer){keep, &o, 1});
    if (o.status)
        o.message = plan_why(p, nevh_stepper_message(s));
    else
        measure(&o, s);
    nevh_field *field = nevh_stepper_field(s);
    o.energy = NAN;
    nevh_field_value(field, 1, &o.t, o.last, o.last + p->n, &o.energy);
    nevh_stepper_free(s);
    return o;
}

trace trace_sampled(const plan *p, const char *integrator, size_t most) {
    trace o = new_trace(p, most);
    nevh_stepper *s = plan_stepper(p, integrator);
    o.status = go(&o, s, &(nevh_observer){keep, &o, 1});
    nevh_stepper_free(s);
    return o;
}

trace trace_dense(const plan *p, const char *integrator) {
    enum { NUMBERS = 4000000, MOST = 40000 };
    size_t most = NUMBERS / (2 * p->n);
    return trace_sampled(p, integrator, most < MOST ? most + 2 : MOST);
}

/* The larger of the ranges over both orbits; where a variable does not move,
   that of the others of its kind. */
static double range_of(const trace *a, const trace *b, size_t k) {
    size_t n = a->plan->n;
    double own = fmax(a->high[k] - a->low[k], b->high[k] - b->low[k]);
    for (size_t i = k < n ? 0 : n; !(own > 0) && i < (k < n ? n : 2 * n); i++)
        own = fmax(own, fmax(a->high[i] - a->low[i], b->high[i] - b->low[i]));
    return own;
}

static double apart(const trace *a, const trace *b, const double x[],
                    const double y[]) {
    double most = 0;
    for (size_t k = 0; k < 2 * a->plan->n; k++) {
        double gap = fabs(x[k] - y[k]);
        if (gap > 0)
            most = fmax(most, gap / range_of(a, b, k));
    }
    return most;
}

difference trace_difference(const trace *a, const trace *b) {
    size_t n = 2 * a->plan->n, kept = a->kept < b->kept ? a->kept : b->kept;
    difference d = {NAN, 0, NAN};
    if (a->t == b->t)
        d.at_end = apart(a, b, a->last, b->last);
    for (size_t i = 0; i < kept; i++) {
        double gap = apart(a, b, a->states + i * n, b->states + i * n);
        d.largest = fmax(d.largest, gap);
        if (gap > noticed && isnan(d.since))
            d.since =
                a->plan->run->t_start + (double)(i * a->every) * a->plan->dt[0];
    }
    d.largest = fmax(d.largest, d.at_end);
    return d;
}

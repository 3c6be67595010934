/* nevh: the energy that changes of H in time bring in, where steps do not see
   these: jumps, and what changes and is over within a step.  There the integral of
   dH/dt is the sum of differences of H over stretches of time, each at one state
   between those that the step begins and ends at.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/energy_book_private.h"
#include <nevh/simd.h>
#include <math.h>

typedef struct {
    const double *from, *q, *p; /* from: q, p, t */
    double t;
} step;

/* The state of the line between both, and H there at another time. */
static bool value_at(nevh__book *b, const step *s, double of, double t,
                     double damping, double *h) {
    double start = s->from[2 * b->n], part = (of - start) / (s->t - start);
    const double *rate = b->state + 2 * b->n;
    for (size_t k = 0; k < 2 * b->n; k++) {
        double to = k < b->n ? s->q[k] : s->p[k - b->n];
        b->state[k] = s->from[k] + (to - s->from[k]) * part;
        if (damping != 0 && k >= b->n)
            b->state[k] *= nevh_simd_exp(-damping * rate[k - b->n]);
    }
    return !nevh_field_value(b->field, 1, &t, b->state, b->state + b->n, h);
}

/* The change of H from one time to another, at the state of a third. */
static double energy_book_change(nevh__book *b, const step *s, double of,
                                 double t0, double t1) {
    double before, after;
    bool known =
        value_at(b, s, of, t0, 0, &before) && value_at(b, s, of, t1, 0, &after);
    return known ? after - before : 0;
}

/* The energy that a step loses by friction: momenta decay at H of its middle. */
static double friction_of(nevh__book *b, const step *s) {
    double start = s->from[2 * b->n], h = s->t - start, middle = start + h / 2;
    double before, after;
    bool known = b->friction &&
                 value_at(b, s, middle, middle, -h / 2, &before) &&
                 value_at(b, s, middle, middle, h / 2, &after);
    return known ? after - before : 0;
}

static const nevh_time_break *break_at(const nevh__book *b, double t) {
    const nevh_time_break *k = nevh__timing_next(b->timing, t, true);
    return k && k->before < t && t < k->after ? k : NULL;
}

/* A time inside a break stands for its side where the step comes from. */
static double side_of(const nevh__book *b, double t, bool forward) {
    const nevh_time_break *k = break_at(b, t);
    return !k || !k->jump ? t : forward ? k->before : k->after;
}

/* The integral of dH/dt along the line. */
static double integral(nevh__book *b, const step *s, bool first) {
    double start = s->from[2 * b->n], sum = 0;
    bool forward = s->t > start;
    double t = first ? start : side_of(b, start, forward);
    double end = side_of(b, s->t, forward);
    while (forward ? t < end : t > end) {
        double edge = nevh__timing_edge(b->timing, t, forward);
        double next = forward ? fmin(edge, end) : fmax(edge, end);
        sum += energy_book_change(b, s, t + (next - t) / 2, t, next);
        t = next;
    }
    return sum;
}

/* All jumps that a step passes. */
static double energy_book_jumps(nevh__book *b, const step *s, bool first) {
    double start = s->from[2 * b->n], sum = 0;
    bool forward = s->t > start;
    const nevh_time_break *k = nevh__timing_next(b->timing, start, forward);
    for (; k && (forward ? k->after <= s->t : k->before >= s->t);
         k = nevh__timing_next(b->timing, forward ? k->after : k->before,
                               forward)) {
        double t0 = forward ? k->before : k->after;
        double t1 = forward ? k->after : k->before;
        bool inside = first && k->before < start && start < k->after;
        if (k->jump) /* the value at the start is H0's */
            sum += energy_book_change(b, s, t0, inside ? start : t0, t1);
    }
    return sum;
}

double nevh__book_step(nevh__book *b, const double from[], bool first, double t,
                       const double q[], const double p[], double came) {
    step s = {from, q, p, t};
    double told = came - b->came;
    b->came = came;
    if (!b->timing || !isfinite(came))
        return 0;
    double jumped = energy_book_jumps(b, &s, first);
    if (!nevh__timing_is_fast(b->timing, from[2 * b->n], t) ||
        nevh__ledger_saw(b->told, b->timing, from[2 * b->n], t)) {
        b->booked += jumped;
        return 0;
    }
    double outside = integral(b, &s, first) + friction_of(b, &s);
    b->booked += outside - told;
    return fabs(outside - told - jumped);
}

void nevh__book_value(nevh__book *b, double from, double t, const double q[],
                      const double p[], double *h) {
    const nevh_time_break *k = b->timing ? break_at(b, t) : NULL;
    if (k && k->jump)
        nevh_field_value(b->field, 1, t > from ? &k->before : &k->after, q, p,
                         h);
}

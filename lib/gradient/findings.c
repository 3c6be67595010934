/* nevh: what can be known of H from its values.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/step_selection_private.h"
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <nevh/probe.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double roundings = 64 * DBL_EPSILON;
static const double smooth_limit = 1e-5;

struct nevh_probe {
    nevh_field *field;
    nevh__step_selection selection;
    nevh_options options;
    double *start; /* 2n: lane 0 of the state */
    double *state; /* 2n: a trial state */
    nevh_finding finding[NEVH_FINDINGS];
    size_t finite;    /* samples at which H is */
    char mirror[160]; /* what turns orbits back, where momenta alone do not */
    nevh__report report;
};

/* Keeps the largest violation. */
static void violate(nevh_probe *b, nevh_question question, double violation,
                    double size, size_t at) {
    nevh_finding *f = &b->finding[question];
    const nevh__samples *s = &b->selection.samples;
    size_t n = b->field->n;
    if (!isfinite(violation) || !(size > 0) || violation / size < f->evidence)
        return;
    f->evidence = violation / size;
    f->t = s->t[at];
    f->q = s->q + at * n;
    f->p = s->p + at * n;
}

/* H at sample `at`, with momenta times `factor` and time moved. */
static double energy(nevh_probe *b, size_t at, double factor, double later) {
    const nevh__samples *s = &b->selection.samples;
    size_t n = b->field->n;
    double t = s->t[at] + later, h;
    for (size_t k = 0; k < n; k++)
        b->state[k] = factor * s->p[at * n + k];
    return nevh_field_value(b->field, 1, &t, s->q + at * n, b->state, &h) ? NAN
                                                                          : h;
}

static void try_momenta(nevh_probe *b, size_t at) {
    const double none = energy(b, at, 0, 0), one = energy(b, at, 1, 0);
    const double two = energy(b, at, 2, 0), three = energy(b, at, 3, 0);
    b->finite += isfinite(one);
    violate(b, NEVH_IS_QUADRATIC, fabs((three - none) - 3 * (two - one)),
            fabs(three) + 3 * (fabs(two) + fabs(one)) + fabs(none), at);
}

/* Mirrors: some coordinates, and the momenta of the others, change their signs.  Of
   few coordinates all of them, the first of momenta alone; of many, those of every
   second or third one, as of bodies. */
enum { FEW = 6, OF_MANY = 12 };

static size_t mirrors(size_t n) {
    return n <= FEW ? (size_t)1 << n : OF_MANY;
}

static bool turns(size_t n, size_t mirror, size_t i) {
    if (n > FEW && mirror >= 8)
        return (mirror - 8) >> i % 2 & 1;
    return (mirror >> (n <= FEW ? i : i % 3)) & 1;
}

static double mirrored_energy(nevh_probe *b, size_t at, size_t mirror) {
    const nevh__samples *s = &b->selection.samples;
    size_t n = b->field->n;
    double *q = b->state, *p = q + n, h;
    for (size_t k = 0; k < n; k++) {
        bool turn = turns(n, mirror, k);
        q[k] = turn ? -s->q[at * n + k] : s->q[at * n + k];
        p[k] = turn ? s->p[at * n + k] : -s->p[at * n + k];
    }
    return nevh_field_value(b->field, 1, &s->t[at], q, p, &h) ? NAN : h;
}

/* "(y, p_x) -> -(y, p_x)", as far as there is room. */
static void name_mirror(nevh_probe *b, size_t mirror) {
    enum { SHOWN = 6 };
    size_t n = b->field->n, used = 0;
    char names[72] = "", one[NEVH__VARIABLE];
    for (size_t i = 0; i < n && i < SHOWN && used < sizeof names; i++) {
        nevh__variable_name(b->field->system, !turns(n, mirror, i), i, one);
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s",
                                 i ? ", " : "", one);
    }
    const char *more = n > SHOWN || used >= sizeof names ? ", ..." : "";
    snprintf(b->mirror, sizeof b->mirror, "(%s%s) -> -(%s%s)", names, more,
             names, more);
}

/* The mirror that leaves H most as it is. */
static void try_mirrors(nevh_probe *b) {
    nevh_finding best = {.evidence = INFINITY}, *f;
    size_t chosen = 0;
    f = &b->finding[NEVH_IS_REVERSIBLE];
    for (size_t m = 0; m < mirrors(b->field->n) && best.evidence > roundings;
         m++) {
        *f = (nevh_finding){0};
        for (size_t at = 0; at < b->selection.samples.count; at++) {
            double one = energy(b, at, 1, 0), other = mirrored_energy(b, at, m);
            violate(b, NEVH_IS_REVERSIBLE, fabs(one - other),
                    fabs(one) + fabs(other), at);
        }
        if (f->evidence < best.evidence) {
            best = *f;
            chosen = m;
        }
    }
    *f = best;
    f->limit = roundings;
    f->holds = f->evidence <= f->limit;
    if (f->holds && chosen > 0) {
        name_mirror(b, chosen);
        f->term = b->mirror;
    }
}

/* A time in which H moves the state by its lengths: a power of two. */
static double unit_of_time(nevh_probe *b, size_t at) {
    const double *length = b->selection.length;
    size_t n = b->field->n;
    double moved = fabs(energy(b, at, 1, 0) - energy(b, at, 0, 0)), most = 0;
    for (size_t k = 0; k < n; k++)
        most = fmax(most, length[k] * length[n + k]);
    double time = most / moved;
    return isfinite(time) && time > 0 ? ldexp(1, ilogb(time)) : 1;
}

/* Periods of the driving are not known: many spans, none a simple fraction of
   another. */
static void try_times(nevh_probe *b, size_t at) {
    double now = energy(b, at, 1, 0), unit = unit_of_time(b, at);
    for (int i = -10; i <= 10; i++) {
        double later = energy(b, at, 1, 1.618 * unit * exp2(2 * i));
        violate(b, NEVH_IS_AUTONOMOUS, fabs(later - now),
                fabs(later) + fabs(now), at);
    }
}

static void try_separable(nevh_probe *b) {
    nevh_separability s;
    nevh_finding *f = &b->finding[NEVH_IS_SEPARABLE];
    size_t n = b->field->n;
    nevh_system_probe(b->field->system, b->options.t, b->start, b->start + n,
                      b->selection.length, &s);
    f->holds = s.separable;
    f->evidence = s.mixed;
    f->term = s.term;
    f->limit = 16 * DBL_EPSILON;
    f->t = b->options.t;
    f->q = b->start;
    f->p = b->start + n;
}

static void try_smooth(nevh_probe *b) {
    nevh_finding *f = &b->finding[NEVH_IS_SMOOTH];
    for (size_t i = 0; i < nevh_field_step_count(b->field); i++) {
        nevh_step_report r = nevh_field_step_report(b->field, i);
        double error = r.truncation + r.rounding;
        if (r.blind || !(error / r.size >= f->evidence))
            continue;
        f->evidence = error / r.size;
        f->term = r.term;
    }
    f->limit = smooth_limit;
    f->holds = f->evidence <= f->limit;
    f->t = b->options.t;
    f->q = b->start;
    f->p = b->start + b->field->n;
}

static bool reads_time(const nevh_system *s) {
    return !(nevh_system_traits(s) & NEVH_AUTONOMOUS);
}

static int findings_ask(nevh_probe *b) {
    for (nevh_question i = 0; i < NEVH_FINDINGS; i++)
        b->finding[i].limit = roundings;
    for (size_t at = 0; at < b->selection.samples.count; at++) {
        try_momenta(b, at);
        if (reads_time(b->field->system))
            try_times(b, at);
    }
    for (nevh_question i = 0; i < NEVH_FINDINGS; i++)
        b->finding[i].holds = b->finding[i].evidence <= b->finding[i].limit;
    try_mirrors(b);
    try_separable(b);
    try_smooth(b);
    if (b->finite)
        return NEVH_OK;
    return nevh__fail(&b->report, NEVH_EDOM,
                      "H is not finite at any state around the one given");
}

static void take_start(nevh_probe *b) {
    const nevh_options *o = &b->options;
    size_t n = b->field->n, width = o->width ? o->width : 1;
    for (size_t k = 0; k < n; k++) {
        b->start[k] = o->q ? o->q[k * width] : 0;
        b->start[n + k] = o->p ? o->p[k * width] : 0;
    }
}

static int open_probe(nevh_probe *b, const nevh_system *s) {
    if (s->report.status)
        return nevh__fail_as(&b->report, &s->report);
    b->options.gradient = nevh_central4;
    b->options.gradient_step = 0;
    b->options.gradient_steps = NULL;
    b->field = nevh_field_new(s, &b->options);
    b->start = nevh__array(2 * s->n, sizeof *b->start);
    b->state = nevh__array(2 * s->n, sizeof *b->state);
    if (!b->field || !b->start || !b->state)
        return nevh__no_memory(&b->report);
    if (b->field->report.status)
        return nevh__fail_as(&b->report, &b->field->report);
    take_start(b);
    if (nevh__step_selection_init(&b->selection, b->field, &b->options) ||
        !nevh__find_samples(&b->selection))
        return nevh__no_memory(&b->report);
    return findings_ask(b);
}

nevh_probe *nevh_probe_new(const nevh_system *s, const nevh_options *options) {
    nevh_probe *b = s ? nevh__array(1, sizeof *b) : NULL;
    if (!b)
        return NULL;
    if (options)
        b->options = *options;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = open_probe(b, s);
    fesetenv(&own);
    if (status != NEVH_ENOMEM)
        return b;
    nevh_probe_free(b);
    return NULL;
}

void nevh_probe_free(nevh_probe *b) {
    if (!b)
        return;
    nevh__step_selection_clear(&b->selection);
    nevh_field_free(b->field);
    free(b->start);
    free(b->state);
    free(b);
}

NEVH__REPORTS(probe)

nevh_finding nevh_probe_finding(const nevh_probe *b, nevh_question question) {
    if (!b || question >= NEVH_FINDINGS)
        return (nevh_finding){0};
    return b->finding[question];
}

const char *nevh_question_name(nevh_question question) {
    static const char *const names[] = {"separable", "autonomous",
                                        "quadratic in the momenta",
                                        "reversible", "smooth"};
    _Static_assert(sizeof names / sizeof *names == NEVH_FINDINGS,
                   "each question");
    return question < NEVH_FINDINGS ? names[question] : "unknown";
}

const double *nevh_probe_lengths(const nevh_probe *b) {
    return b ? b->selection.length : NULL;
}

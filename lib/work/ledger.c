/* nevh: the account of the energy that comes in from outside.

   For H(t, q, p) with friction dH = (dH/dt - sum of rate p dH/dp) dt along an
   orbit.  A scheme integrates the first as the energy E conjugate to t, in the
   extended phase space where H + E is conserved: E changes with each kick and
   drift, by dV/dt and dT/dt at the very points that these take.  Where friction
   is put around a step, it takes the difference of H before and after.

   Everything is asked of a field of its own: the stepper's counts are the
   orbit's.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "work/ledger_private.h"
#include "gradient/field_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double incomplete = 1e-9; /* of a step, not accounted for */
enum { MOST_SEEN = 1 << 12 };

struct nevh_ledger {
    nevh_field *field;
    nevh__time_step *steps;     /* of the field's terms */
    double *t, *rate, *h;       /* width each; rate: of the gain */
    double *slope;              /* n x width: dH/dp, for friction */
    double *q, *p;              /* n x width: where the step began */
    double *pending, *roundoff; /* width each: of the step under way */
    double kicked, drifted;     /* parts of it that the kernel told */
    double *seen;               /* times of the step at which dH/dt was taken */
    size_t n_seen;
    bool driven, mixed, by_kernel; /* reads t; so does a term of q and p; the
                                      kernel has something to tell */
    bool watches;                  /* the scheme's own steps, by `seen` */
};

static int ledger_out_of_memory(nevh_work *w) {
    return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
}

static int ledger_allocate(nevh_work *w, struct nevh_ledger *l) {
    size_t width = w->width, size = w->size;
    l->t = nevh__array(width, sizeof(double));
    l->rate = nevh__array(width, sizeof(double));
    l->h = nevh__array(width, sizeof(double));
    l->pending = nevh__array(width, sizeof(double));
    l->roundoff = nevh__array(width, sizeof(double));
    l->slope = nevh__array(size, sizeof(double));
    l->q = nevh__array(size, sizeof(double));
    l->p = nevh__array(size, sizeof(double));
    l->steps = nevh__array(w->system->n_terms, sizeof *l->steps);
    l->seen = nevh__array(l->watches ? MOST_SEEN : 1, sizeof(double));
    bool all = l->t && l->rate && l->h && l->pending && l->roundoff &&
               l->slope && l->q && l->p && l->steps && l->seen;
    return all ? NEVH_OK : ledger_out_of_memory(w);
}

static int ledger_plan_field(nevh_work *w, struct nevh_ledger *l) {
    l->field = nevh_field_new(w->system, w->options);
    if (!l->field)
        return ledger_out_of_memory(w);
    int status = l->field->report.status;
    if (!status && l->driven)
        status = nevh__field_plan_time(l->field, w->options, l->steps);
    for (size_t i = 0; !status && i < l->field->n_terms; i++) {
        const nevh__planned *term = &l->field->terms[i];
        l->mixed |= term->term->decl.time && term->nq && term->np;
    }
    return status ? nevh__fail_as(w->report, &l->field->report) : NEVH_OK;
}

int nevh__ledger_plan(nevh_work *w, bool friction) {
    bool driven = !(nevh_system_traits(w->system) & NEVH_AUTONOMOUS);
    if (!w->options->balance || !(driven || friction))
        return NEVH_OK;
    if ((driven || w->friction) && w->integrator->kernel->opaque)
        return nevh_work_fail(
            w, NEVH_ESTRUCT,
            "%s cannot keep the balance of the energy where %s: "
            "its stages are out of reach",
            w->integrator->name, driven ? "H reads t" : "there is friction");
    struct nevh_ledger *l = w->ledger = nevh__array(1, sizeof *l);
    if (!l)
        return ledger_out_of_memory(w);
    l->driven = driven;
    l->by_kernel = driven || w->friction;
    l->watches = driven && w->options->tolerance > 0 &&
                 (w->integrator->adaptive || w->integrator->needs_tolerance);
    int status = ledger_allocate(w, l);
    return status ? status : ledger_plan_field(w, l);
}

void nevh__ledger_free(struct nevh_ledger *l) {
    if (!l)
        return;
    nevh_field_free(l->field);
    free(l->steps);
    free(l->t);
    free(l->rate);
    free(l->h);
    free(l->pending);
    free(l->roundoff);
    free(l->slope);
    free(l->q);
    free(l->p);
    free(l->seen);
    free(l);
}

void nevh__ledger_open(nevh_work *w, const double q[], const double p[]) {
    struct nevh_ledger *l = w->ledger;
    if (!l)
        return;
    l->kicked = l->drifted = 0;
    l->n_seen = 0;
    for (size_t lane = 0; lane < w->width; lane++)
        l->pending[lane] = l->roundoff[lane] = 0;
    if (!l->mixed)
        return;
    memcpy(l->q, q, w->size * sizeof *q);
    memcpy(l->p, p, w->size * sizeof *p);
}

/* sum + roundoff += x, whichever is larger. */
static void ledger_add(double *sum, double *roundoff, double x) {
    double next = *sum + x;
    *roundoff += nevh__roundoff(next, *sum, x);
    *sum = next;
}

static int ledger_fail(nevh_work *w, int status) {
    if (status)
        nevh_work_fail(w, status, "%s", nevh_field_message(w->ledger->field));
    return status;
}

int nevh__ledger_add(nevh_work *w, double sign, double t, const double q[],
                     const double p[]) {
    struct nevh_ledger *l = w->ledger;
    if (!l)
        return NEVH_OK;
    for (size_t lane = 0; lane < w->width; lane++)
        l->t[lane] = t;
    int status = nevh_field_value(l->field, w->width, l->t, q, p, l->h);
    for (size_t lane = 0; !status && lane < w->width; lane++)
        ledger_add(&l->pending[lane], &l->roundoff[lane], sign * l->h[lane]);
    return ledger_fail(w, status);
}

/* Adds the part of a term T(t, p) + V(t, q) that is one function: dV/dt + dT/dt(p0)
   with dH/dq, dT/dt(p) - dT/dt(p0) with dH/dp, where p0 is p at the start of the
   step. */
static int add_half(nevh_work *w, size_t i, bool kick, const double t[],
                    const double q[], const double p[]) {
    struct nevh_ledger *l = w->ledger;
    const nevh__time_step *step = &l->steps[i];
    if (kick)
        return nevh__field_time_slope(l->field, i, step, w->width, t, q, l->p,
                                      l->rate);
    for (size_t lane = 0; lane < w->width; lane++)
        l->h[lane] = 0;
    int status = nevh__field_time_slope(l->field, i, step, w->width, t, l->q,
                                        l->p, l->h);
    for (size_t lane = 0; lane < w->width; lane++)
        l->rate[lane] -= l->h[lane];
    return status ? status
                  : nevh__field_time_slope(l->field, i, step, w->width, t, l->q,
                                           p, l->rate);
}

/* Adds the share of `parts` in dH/dt of a term. */
static int ledger_add_term(nevh_work *w, size_t i, unsigned parts,
                           const double t[], const double q[],
                           const double p[]) {
    struct nevh_ledger *l = w->ledger;
    const nevh__planned *term = &l->field->terms[i];
    const unsigned both = NEVH_OF_Q | NEVH_OF_P;
    if (!l->steps[i].method)
        return NEVH_OK;
    if (term->nq && term->np && parts != both)
        return add_half(w, i, parts == NEVH_OF_Q, t, q, p);
    if (!(parts & (term->np && !term->nq ? NEVH_OF_P : NEVH_OF_Q)))
        return NEVH_OK;
    return nevh__field_time_slope(l->field, i, &l->steps[i], w->width, t, q, p,
                                  l->rate);
}

static int ledger_add_friction(nevh_work *w, const double t[], const double q[],
                               const double p[]) {
    struct nevh_ledger *l = w->ledger;
    int status =
        nevh_field_gradient(l->field, w->width, t, q, p, NULL, l->slope);
    for (size_t i = 0; !status && i < w->size; i++)
        l->rate[i % w->width] -= w->friction[i / w->width] * p[i] * l->slope[i];
    return status;
}

/* Keeps every other one where there are too many: what lies between is then seen less
   well than it was. */
static void see(struct nevh_ledger *l, double t) {
    if (l->n_seen == MOST_SEEN) {
        l->n_seen /= 2;
        for (size_t i = 0; i < l->n_seen; i++)
            l->seen[i] = l->seen[2 * i];
    }
    l->seen[l->n_seen++] = t;
}

static int compare_times(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bool nevh__ledger_saw(struct nevh_ledger *l, const nevh_timing *timing,
                      double from, double to) {
    double low = fmin(from, to), high = fmax(from, to);
    if (!l || !l->n_seen)
        return false;
    qsort(l->seen, l->n_seen, sizeof *l->seen, compare_times);
    for (size_t i = 0; i <= l->n_seen; i++) {
        double next = i < l->n_seen ? l->seen[i] : high;
        if (nevh__timing_is_fast(timing, low, next))
            return false;
        low = next;
    }
    return true;
}

int nevh__ledger_account(nevh_work *w, unsigned parts, double weight,
                         const double t[], const double q[], const double p[]) {
    struct nevh_ledger *l = w->ledger;
    if (!l || !l->by_kernel || weight == 0)
        return NEVH_OK;
    int status = NEVH_OK;
    if (l->watches)
        see(l, *t);
    l->kicked += parts & NEVH_OF_Q ? weight : 0;
    l->drifted += parts & NEVH_OF_P ? weight : 0;
    for (size_t lane = 0; lane < w->width; lane++)
        l->rate[lane] = 0;
    for (size_t i = 0; !status && i < l->field->n_terms; i++)
        status = ledger_add_term(w, i, parts, t, q, p);
    if (!status && w->friction && parts & NEVH_OF_P)
        status = ledger_add_friction(w, t, q, p);
    for (size_t lane = 0; !status && lane < w->width; lane++)
        ledger_add(&l->pending[lane], &l->roundoff[lane],
                   weight * l->rate[lane]);
    return ledger_fail(w, status);
}

void nevh__ledger_close(const nevh_work *w, double total[]) {
    const struct nevh_ledger *l = w->ledger;
    if (!l)
        return;
    double slack = incomplete * fabs(w->elapsed);
    bool complete = !l->by_kernel || (fabs(l->kicked - w->elapsed) <= slack &&
                                      fabs(l->drifted - w->elapsed) <= slack);
    for (size_t lane = 0; lane < w->width; lane++) {
        double *roundoff = total + w->width + lane;
        ledger_add(&total[lane], roundoff, complete ? l->pending[lane] : NAN);
        *roundoff += l->roundoff[lane];
    }
}

/* nevh: references: exact solutions and runs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/kinks_private.h"
#include "diagnose/reference_private.h"
#include "system/forest_private.h"
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <nevh/chaos.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TIMES = 4096, DOUBTED = 64 };
static const double golden = 0.6180339887498949;

void nevh__reference_widen(const nevh_reference *r, double low[], double high[],
                           const double state[]) {
    for (size_t k = 0; k < 2 * r->n; k++) {
        low[k] = fmin(low[k], state[k]);
        high[k] = fmax(high[k], state[k]);
    }
}

/* Variables of one kind share the widest range.  The first of them has no
   larger number than the others. */
static void reference_share(size_t n, const size_t kind[], double scale[]) {
    for (size_t k = 0; k < n; k++)
        scale[kind[k]] = fmax(scale[kind[k]], scale[k]);
    for (size_t k = 0; k < n; k++)
        scale[k] = scale[kind[k]];
}

/* Scales of the coordinates, or of the momenta.  What varies by rounding alone beside
   those that terms connect it to has the scale of these. */
static void scale_half(const nevh_reference *r, const double low[],
                       const double high[], double scale[]) {
    static const double rounding = 1e-12; /* of the largest value */
    double widest = 0, *near = r->beside, *largest = near + r->n;
    for (size_t k = 0; k < r->n; k++)
        near[k] = largest[k] = 0;
    for (size_t k = 0; k < r->n; k++) {
        size_t c = r->component[k];
        largest[c] = fmax(largest[c], fmax(fabs(low[k]), fabs(high[k])));
        scale[k] = high[k] - low[k];
        near[c] = fmax(near[c], scale[k]);
        widest = fmax(widest, scale[k]);
    }
    if (r->kind)
        reference_share(r->n, r->kind, scale);
    for (size_t k = 0; k < r->n; k++) {
        size_t c = r->component[k];
        if (scale[k] <= rounding * largest[c])
            scale[k] = near[c] > 0 ? near[c] : widest > 0 ? widest : 1;
    }
}

void nevh__reference_scale(const nevh_reference *r, const double low[],
                           const double high[], double scale[]) {
    scale_half(r, low, high, scale);
    scale_half(r, low + r->n, high + r->n, scale + r->n);
}

static nevh_chaos_verdict find_chaos(const nevh_reference *r, double until,
                                     nevh_chaos_finding *f) {
    nevh_options o = {.t = r->t0, .q = r->start, .p = r->start + r->n};
    bool found = !nevh_chaos_find(r->system, &o, r->t0, until, 0, f);
    return found ? f->report.verdict : NEVH_EARLY;
}

bool nevh__reference_is_chaotic(nevh_reference *r, double reached,
                                double *growth) {
    static const double longer = 8;
    bool room = r->n > 1 || !(nevh_system_traits(r->system) & NEVH_AUTONOMOUS);
    nevh_chaos_finding f = {0};
    double span = r->t1 - r->t0;
    if (growth) {
        find_chaos(r, r->t0 + reached, &f);
        *growth = exp(f.growth);
    }
    if (!room)
        return false;
    nevh_chaos_verdict verdict = find_chaos(r, r->t1, &f);
    bool whole = fabs(f.report.t - r->t1) < 1e-6 * fabs(span);
    if (verdict == NEVH_EARLY && whole) /* not short of time to compute */
        verdict = find_chaos(r, r->t0 + longer * span, &f);
    if (verdict == NEVH_CHAOTIC)
        r->exponent = f.exponent;
    return verdict == NEVH_CHAOTIC;
}

static int exact_state(const nevh_reference *r, const nevh__exact_solution *e,
                       double t, double state[]) {
    return nevh__exact_state(e, t, r->start, r->start + r->n, state,
                             state + r->n);
}

static double exact_time(const nevh_reference *r, size_t i) {
    double u = (double)i * golden;
    return nevh__exact_time(r->exact, r->t1 - r->t0, u - floor(u), r->start,
                            r->start + r->n);
}

static int exact_ranges(nevh_reference *r) {
    double state[2 * NEVH__EXACT_DOF];
    int status = exact_state(r, r->exact, r->t1 - r->t0, state);
    if (!status)
        nevh__reference_widen(r, r->low, r->high, state);
    for (size_t i = 0; !status && i < TIMES; i++) {
        status = exact_state(r, r->exact, exact_time(r, i), state);
        if (!status)
            nevh__reference_widen(r, r->low, r->high, state);
    }
    nevh__reference_scale(r, r->low, r->high, r->range);
    return status;
}

static double reference_distance(const nevh_reference *r, const double a[],
                                 const double b[]) {
    double most = 0;
    for (size_t k = 0; k < 2 * r->n; k++)
        most = fmax(most, fabs(a[k] - b[k]) / r->range[k]);
    return most;
}

/* The rounding of long double arithmetic, which may be that of double whatever
   LDBL_EPSILON says: under valgrind, or if the processor is set so. */
static double long_rounding(void) {
    volatile long double one = 1, next = one + LDBL_EPSILON;
    return next > one ? (double)LDBL_EPSILON : DBL_EPSILON;
}

/* The solution with one of its three constants off by `part`: a mass near a
   separatrix or on a narrow ellipse does more to the orbit than to the clock,
   unlike all constants at once. */
static nevh__exact_solution spoiled(const nevh_reference *r, int constant,
                                    double part) {
    nevh__exact_solution e = *r->exact;
    long double unit = e.kind == NEVH__PENDULUM ? 1 : r->range[0];
    if (constant == 0)
        e.a *= 1 + (long double)part;
    else if (constant == 1)
        e.b *= 1 + (long double)part;
    else if (e.kind != NEVH__KEPLER)
        e.c += part * (fabsl(e.c) + unit);
    return e;
}

/* The effect on the state of the uncertainty of the constants, and of rounding on
   the way from them to a phase; at least the rounding of the state itself. */
static double doubted(const nevh_reference *r) {
    static const double roundings = 4;
    double part = fmax(r->exact->doubt, roundings * long_rounding());
    double most = DBL_EPSILON, a[2 * NEVH__EXACT_DOF], b[2 * NEVH__EXACT_DOF];
    for (size_t i = 0; i <= DOUBTED; i++) {
        double t = i ? exact_time(r, i) : r->t1 - r->t0, sum = 0;
        bool known = !exact_state(r, r->exact, t, a);
        for (int constant = 0; constant < 3; constant++) {
            nevh__exact_solution other = spoiled(r, constant, part);
            if (known && !exact_state(r, &other, t, b))
                sum += reference_distance(r, a, b);
        }
        most = fmax(most, sum);
    }
    return most;
}

static int use_exact(nevh_reference *r, bool *kept) {
    *kept = true;
    if (exact_ranges(r))
        return nevh__fail(&r->report, NEVH_EFAILED,
                          "the exact solution (%s) loses its phase before "
                          "t = %.9g",
                          nevh__exact_name(r->exact), r->t1);
    r->error = doubted(r);
    int status = nevh__watch_exact(r, kept);
    if (status || !*kept)
        return status;
    snprintf(r->text, sizeof r->text, "exact solution (%s)",
             nevh__exact_name(r->exact));
    return NEVH_OK;
}

static void forget_ranges(nevh_reference *r) {
    memcpy(r->low, r->start, 2 * r->n * sizeof *r->low);
    memcpy(r->high, r->start, 2 * r->n * sizeof *r->high);
}

/* Series in place of an exact solution whose constants, or phase, have too few
   digits; the solution where series are no better, or cost too much.  Series may end
   earlier where the solution has less than six digits.  *kept is false where it does
   not keep H: it is that of other places than the orbit's, as on one side of a wall. */
static int use_exact_or_series(nevh_reference *r, bool *kept) {
    static const double poor = 1e-6;
    int status = use_exact(r, kept);
    if (status || !*kept ||
        r->error <= (r->finest ? nevh__reference_wanted : poor))
        return status;
    nevh__exact_solution *exact = r->exact;
    double error = r->error, whole = r->horizon;
    r->exact = NULL;
    forget_ranges(r);
    status = nevh__reference_series(r);
    if (!status && r->error < error && (r->horizon == whole || error > poor)) {
        nevh__exact_free(exact);
        return NEVH_OK;
    }
    nevh__reference_series_free(r->series);
    r->series = NULL;
    r->exact = exact;
    r->integrator = NULL;
    r->horizon = whole;
    r->end = NEVH_REFERENCE_WHOLE;
    r->exponent = r->growth = NAN;
    r->report = (nevh__report){0};
    forget_ranges(r);
    return status == NEVH_ENOMEM
               ? nevh__fail(&r->report, status, "out of memory")
               : use_exact(r, kept);
}

/* True if a run goes on after the end of the solution. */
static bool passes_end(const nevh_reference *r) {
    return (r->horizon - r->ends) * (r->t1 > r->t0 ? 1 : -1) > 0;
}

static int use_run(nevh_reference *r) {
    bool asked = r->integrator == nevh_taylor;
    int status =
        asked || !r->integrator ? nevh__reference_series(r) : NEVH_EFAILED;
    if (!status || asked || status == NEVH_ENOMEM)
        return status;
    nevh__report ended = r->report;
    bool dear = !r->integrator && strstr(r->report.text, "cost too much");
    if (ended.status == NEVH_EDOM && r->may_jump &&
        !nevh__conserves_energy(r->system))
        return ended.status; /* a step may pass two jumps that cancel */
    r->report = (nevh__report){0};
    if (!r->integrator)
        r->integrator =
            nevh_system_friction(r->system, NULL) ? nevh_dop853 : nevh_gauss12;
    status = nevh__reference_run(r);
    if (!status)
        status = nevh__reference_refuse_kink(r);
    if (isfinite(r->ends) && (status || passes_end(r))) {
        r->report = ended, status = ended.status;
        r->text[0] = '\0';
    }
    size_t used = strlen(r->text);
    if (!status && dear)
        snprintf(r->text + used, sizeof r->text - used,
                 " (Taylor series cost too much)");
    return status;
}

/* As far as is seen: solutions are recognised at some times alone. */
static bool changes_with_time(const nevh_reference *r) {
    return nevh_timing_breaks(r->timing) > 0 ||
           isfinite(nevh_timing_shortest(r->timing, NULL, NULL));
}

static int reference_check(nevh_reference *r) {
    int status = nevh_system_status(r->system);
    if (status)
        return nevh__fail(&r->report, status, "%s",
                          nevh_system_message(r->system));
    for (size_t k = 0; k < 2 * r->n; k++)
        if (!isfinite(r->start[k]))
            return nevh__fail(&r->report, NEVH_EINVAL,
                              "the start of the reference is not finite");
    if (!(r->longest >= 0))
        return nevh__fail(&r->report, NEVH_EINVAL,
                          "the longest step of the reference, %g, is not "
                          "positive",
                          r->longest);
    if (!isfinite(r->t0) || !isfinite(r->t1) || r->t0 == r->t1)
        return nevh__fail(&r->report, NEVH_EINVAL,
                          "a reference from t = %g to %g has no length", r->t0,
                          r->t1);
    return NEVH_OK;
}

static int reference_make(nevh_reference *r) {
    int status = reference_check(r);
    if (status)
        return status;
    if (!(nevh_system_traits(r->system) & NEVH_AUTONOMOUS)) {
        r->timing =
            nevh_timing_new(r->system, r->t0, r->t1, r->start, r->start + r->n);
        if (!r->timing)
            return nevh__no_memory(&r->report);
    }
    if (!r->integrator && !changes_with_time(r))
        status = nevh__exact_recognise(&r->exact, r->system, r->t0, r->t1,
                                       r->start, r->start + r->n);
    if (status)
        return nevh__fail(&r->report, status, "out of memory");
    if (!r->exact)
        return use_run(r);
    bool kept;
    status = use_exact_or_series(r, &kept);
    if (status || kept)
        return status;
    nevh__exact_free(r->exact);
    r->exact = NULL;
    forget_ranges(r);
    return use_run(r);
}

static bool reference_allocate(nevh_reference *r, const double q[],
                               const double p[]) {
    size_t n = r->n;
    r->start = nevh__array(14 * n, sizeof *r->start);
    r->state = nevh__array(2 * n, sizeof *r->state);
    r->component = nevh__components(r->system);
    if (!r->start || !r->state || !r->component)
        return false;
    r->low = r->start + 2 * n;
    r->high = r->low + 2 * n;
    r->range = r->high + 2 * n;
    r->walked = r->range + 2 * n;
    r->found = r->walked + 2 * n;
    r->beside = r->found + 2 * n;
    memcpy(r->start, q, n * sizeof *q);
    memcpy(r->start + n, p, n * sizeof *p);
    memcpy(r->low, r->start, 2 * n * sizeof *q);
    memcpy(r->high, r->start, 2 * n * sizeof *q);
    return true;
}

static size_t first(const size_t kind[], size_t k) {
    size_t i = 0;
    while (kind[i] != kind[k])
        i++;
    return i;
}

/* To each the first of its kind; false when memory is out. */
static bool take_kinds(nevh_reference *r, const size_t kind[]) {
    if (!kind)
        return true;
    r->kind = nevh__array(r->n, sizeof *r->kind);
    for (size_t k = 0; r->kind && k < r->n; k++)
        r->kind[k] =
            k > 0 && kind[k] == kind[k - 1] ? r->kind[k - 1] : first(kind, k);
    return r->kind != NULL;
}

nevh_reference *nevh_reference_new(const nevh_system *s,
                                   const nevh_integrator *integrator, double t0,
                                   double t1, const double q[],
                                   const double p[]) {
    nevh_reference_options o = {.integrator = integrator};
    return nevh_reference_with(s, &o, t0, t1, q, p);
}

nevh_reference *nevh_reference_with(const nevh_system *s,
                                    const nevh_reference_options *options,
                                    double t0, double t1, const double q[],
                                    const double p[]) {
    static const nevh_reference_options zeros;
    const nevh_reference_options *o = options ? options : &zeros;
    nevh_reference *r = s ? nevh__array(1, sizeof *r) : NULL;
    if (!r)
        return NULL;
    r->system = s;
    r->n = nevh_system_dof(s);
    r->t0 = t0;
    r->t1 = t1;
    r->horizon = copysign(INFINITY, t1 - t0);
    r->error = r->ends = NAN;
    r->exponent = r->growth = NAN;
    r->longest = o->longest;
    r->finest = o->finest;
    r->integrator = o->integrator;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    bool made = reference_allocate(r, q, p) && take_kinds(r, o->kind) &&
                reference_make(r) != NEVH_ENOMEM;
    fesetenv(&own);
    if (made)
        return r;
    nevh_reference_free(r);
    return NULL;
}

void nevh_reference_free(nevh_reference *r) {
    if (!r)
        return;
    nevh__exact_free(r->exact);
    nevh__reference_series_free(r->series);
    nevh_timing_free(r->timing);
    nevh_stepper_free(r->walker);
    nevh_stepper_free(r->branch);
    free(r->orbit.states);
    free(r->memo.keys);
    free(r->memo.states);
    free(r->start);
    free(r->state);
    free(r->kind);
    free(r->component);
    free(r);
}

NEVH__REPORTS(reference)

const char *nevh_reference_text(const nevh_reference *r) {
    return r ? r->text : "";
}

#define NUMBER(name)                                                           \
    double nevh_reference_##name(const nevh_reference *r) {                    \
        return r ? r->name : NAN;                                              \
    }
NUMBER(error)
NUMBER(horizon)
NUMBER(exponent)
NUMBER(growth)
NUMBER(ends)

nevh_reference_end nevh_reference_why(const nevh_reference *r) {
    return r ? r->end : NEVH_REFERENCE_COARSE;
}

double nevh_reference_range(const nevh_reference *r, size_t k) {
    if (!r)
        return NAN;
    return k < 2 * r->n ? r->range[k] : NAN;
}

double nevh_reference_own_range(const nevh_reference *r, size_t k) {
    if (!r)
        return NAN;
    return k < 2 * r->n ? r->high[k] - r->low[k] : NAN;
}

/* Refuses a time outside, apart from its rounding. */
static int reference_check_time(nevh_reference *r, double elapsed) {
    double forward = r->t1 > r->t0 ? 1 : -1, span = r->t1 - r->t0;
    double slack = 2 * DBL_EPSILON * fmax(fabs(r->t0), fabs(r->t1));
    if (!(elapsed * forward >= 0 && (elapsed - span) * forward <= slack))
        return nevh__fail(&r->report, NEVH_EINVAL,
                          "the reference goes from t = %.9g to %.9g, not to "
                          "%.9g",
                          r->t0, r->t1, r->t0 + elapsed);
    if ((elapsed - (r->horizon - r->t0)) * forward > slack)
        return nevh__fail(&r->report, NEVH_EDOM,
                          "the reference means nothing after t = %.9g%s",
                          r->horizon,
                          r->end == NEVH_REFERENCE_CHAOS ? ": chaos" : "");
    return NEVH_OK;
}

/* A reference that was not made keeps its status; others forget a failure. */
int nevh__reference_find(nevh_reference *r, long double elapsed,
                         long double state[]) {
    if (!r || !*r->text)
        return nevh_reference_status(r);
    r->report.status = NEVH_OK;
    r->report.text[0] = '\0';
    int status = reference_check_time(r, (double)elapsed);
    if (status)
        return status;
    if (r->series) {
        nevh__reference_series_state(r, elapsed, state);
        return NEVH_OK;
    }
    double *q = r->found, *p = r->found + r->n;
    status = r->exact ? nevh__exact_state(r->exact, elapsed, r->start,
                                          r->start + r->n, q, p)
                      : nevh__reference_walk(r, (double)elapsed, q, p);
    for (size_t k = 0; k < 2 * r->n; k++)
        state[k] = r->found[k];
    return status && r->exact
               ? nevh__fail(&r->report, status,
                            "the exact solution has no state at t = %.9g",
                            (double)(r->t0 + elapsed))
               : status;
}

static int find_state(nevh_reference *r, long double elapsed, double q[],
                      double p[]) {
    int status = nevh__reference_find(r, elapsed, r ? r->state : NULL);
    for (size_t k = 0; !status && k < r->n; k++) {
        q[k] = (double)r->state[k];
        p[k] = (double)r->state[r->n + k];
    }
    return status;
}

int nevh_reference_state(nevh_reference *r, double t, double q[], double p[]) {
    return find_state(r, r ? (long double)t - r->t0 : 0, q, p);
}

int nevh_reference_state_after(nevh_reference *r, double elapsed, double q[],
                               double p[]) {
    return find_state(r, elapsed, q, p);
}

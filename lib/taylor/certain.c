/* nevh: states to digits that are certain.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/orbit_private.h"
#include <math.h>
#include <nevh/certain.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_DIGITS = 30 };

#ifdef NEVH_QUADMATH
#include <quadmath.h>

/* Series of pairs of doubles, or of quad precision, which take some ten times as
   long. */
typedef struct {
    bool pairs;
    nevh__orbit_dd dd;
    nevh__orbit_quad quad;
} orbit;

struct nevh_certain {
    nevh__report report;
    size_t n;
    int digits;
    nevh__recurrence *recurrence;
    orbit fine, coarse; /* both of pairs, or neither */
    bool parted;        /* both, by now */
    double t0, *rates;
    nevh__wide *start;
};

/* So many digits pairs may do for. */
enum { DIGITS_OF_PAIRS = 24 };
/* Rounding alone, of a series: inner sums have 106 bits, pairs 104 or so. */
static const double rounding = 1e-32, rounding_of_pairs = 1e-31;

static void clear(orbit *o) {
    nevh__orbit_clear_dd(&o->dd);
    nevh__orbit_clear_quad(&o->quad);
}

static int start(nevh_certain *c, orbit *o, bool pairs, double tolerance) {
    clear(o);
    o->pairs = pairs;
    bool fine = o->pairs
                    ? nevh__orbit_init_dd(&o->dd, c->recurrence, tolerance)
                    : nevh__orbit_init_quad(&o->quad, c->recurrence, tolerance);
    return !fine ? nevh__fail(&c->report, NEVH_ENOMEM, "out of memory")
           : o->pairs
               ? nevh__orbit_start_dd(&o->dd, c->t0, c->start, &c->report)
               : nevh__orbit_start_quad(&o->quad, c->t0, c->start, &c->report);
}

static int go(nevh_certain *c, orbit *o, double t) {
    return o->pairs ? nevh__orbit_go_dd(&o->dd, t, &c->report)
                    : nevh__orbit_go_quad(&o->quad, t, &c->report);
}

static nevh__wide state(const orbit *o, size_t k) {
    return o->pairs ? o->dd.state[k] : o->quad.state[k];
}

/* Of a variable so far: where series begin, and now. */
static double most(const orbit *o, size_t k) {
    double begun = o->pairs ? o->dd.most[k] : o->quad.most[k];
    return fmax(begun, fabs((double)state(o, k)));
}

static size_t count(const orbit *o) {
    return o->pairs ? o->dd.count : o->quad.count;
}

static int start_both(nevh_certain *c, bool pairs) {
    /* Errors of some hundred series add up. */
    double tolerance = pow(10, -c->digits - 4), finest = 2e-33;
    int status = start(c, &c->coarse, pairs, fmax(tolerance, 10 * finest));
    return status ? status
                  : start(c, &c->fine, pairs, fmax(tolerance / 30, finest));
}

static int plan(nevh_certain *c, const nevh_system *system) {
    bool damped = nevh_system_friction(system, c->rates);
    c->recurrence =
        nevh__recurrence_new(system, damped ? c->rates : NULL, &c->report);
    return c->recurrence ? start_both(c, c->digits <= DIGITS_OF_PAIRS)
                         : c->report.status;
}

static int make(nevh_certain *c, const nevh_system *system, double t0,
                const double q[], const double p[]) {
    size_t n = system->n;
    if (system->report.status)
        return nevh__fail_as(&c->report, &system->report);
    if (!q || !p || !isfinite(t0))
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "an orbit needs a time and a state to start from");
    if (c->digits < 1 || c->digits > MOST_DIGITS)
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "%d digits: there are 1 to %d", c->digits,
                          MOST_DIGITS);
    c->n = n;
    c->rates = nevh__array(n, sizeof *c->rates);
    c->start = nevh__array(2 * n, sizeof *c->start);
    if (!c->rates || !c->start)
        return nevh__fail(&c->report, NEVH_ENOMEM, "out of memory");
    for (size_t k = 0; k < n; k++) {
        c->start[k] = q[k];
        c->start[n + k] = p[k];
    }
    c->t0 = t0;
    return plan(c, system);
}

nevh_certain *nevh_certain_new(const nevh_system *system, double t0,
                               const double q[], const double p[], int digits) {
    nevh_certain *c = system ? nevh__array(1, sizeof *c) : NULL;
    if (!c)
        return NULL;
    c->digits = digits;
    if (make(c, system, t0, q, p) != NEVH_ENOMEM)
        return c;
    nevh_certain_free(c);
    return NULL;
}

void nevh_certain_free(nevh_certain *c) {
    if (!c)
        return;
    clear(&c->fine);
    clear(&c->coarse);
    nevh__recurrence_free(c->recurrence);
    free(c->rates);
    free(c->start);
    free(c);
}

static double apart(const nevh_certain *c, size_t k) {
    return fabs((double)(state(&c->fine, k) - state(&c->coarse, k)));
}

/* Then what digits a variable has in common is chance. */
static bool have_parted(const nevh_certain *c) {
    static const double far = 0.05; /* of what a variable was at most */
    bool parted = false;
    for (size_t k = 0; k < 2 * c->n; k++)
        parted = parted || apart(c, k) > far * most(&c->fine, k);
    return parted;
}

static int go_both(nevh_certain *c, double t) {
    int status = go(c, &c->coarse, t);
    if (!status)
        status = go(c, &c->fine, t);
    c->parted = !status && have_parted(c);
    return status;
}

/* Whether a variable's error is above the digits that were asked for, of the
   largest that it was. */
static bool lacks_digits(const nevh_certain *c) {
    bool lacks = false;
    for (size_t k = 0; k < 2 * c->n; k++)
        lacks = lacks || nevh_certain_error(c, k) >
                             0.5 * pow(10, -c->digits) * most(&c->fine, k);
    return lacks;
}

int nevh_certain_go(nevh_certain *c, double t) {
    if (!c || !count(&c->fine))
        return nevh_certain_status(c);
    c->report = (nevh__report){0};
    if (!isfinite(t))
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "the time %g is not a finite number", t);
    int status = go_both(c, t);
    if (status || !c->fine.pairs || !lacks_digits(c))
        return status;
    status = start_both(c, false);
    return status ? status : go_both(c, t);
}

size_t nevh_certain_series(const nevh_certain *c) {
    return c ? count(&c->fine) + count(&c->coarse) : 0;
}

static bool has(const nevh_certain *c, size_t k) {
    return c && count(&c->fine) && k < 2 * c->n;
}

double nevh_certain_value(const nevh_certain *c, size_t k) {
    return has(c, k) ? (double)state(&c->fine, k) : NAN;
}

double nevh_certain_error(const nevh_certain *c, size_t k) {
    if (!has(c, k))
        return NAN;
    double once = c->fine.pairs ? rounding_of_pairs : rounding;
    double floor = once * sqrt((double)count(&c->fine)) * most(&c->fine, k);
    if (c->parted)
        floor = 2 * most(&c->fine, k);
    return fmax(2 * apart(c, k), floor);
}

double nevh_certain_size(const nevh_certain *c, size_t k) {
    return has(c, k) ? most(&c->fine, k) : NAN;
}

int nevh_certain_digits(const nevh_certain *c, size_t k) {
    double value = fabs(nevh_certain_value(c, k));
    double error = nevh_certain_error(c, k);
    if (!(value > error))
        return 0;
    if (error == 0)
        return c->digits;
    double digits = floor(log10(value / error) - log10(0.5));
    digits = digits < 0 ? 0 : digits;
    return digits < c->digits ? (int)digits : c->digits;
}

char *nevh_certain_text(const nevh_certain *c, size_t k) {
    enum { ROOM = 60 };
    char *text = has(c, k) ? nevh__array(ROOM, 1) : NULL;
    int digits = nevh_certain_digits(c, k);
    if (text)
        strcpy(text, "0");
    if (text && digits > 0)
        quadmath_snprintf(text, ROOM, digits > 1 ? "%#.*Qg" : "%.*Qg", digits,
                          state(&c->fine, k));
    return text;
}

#else

struct nevh_certain {
    nevh__report report;
};

nevh_certain *nevh_certain_new(const nevh_system *system, double t0,
                               const double q[], const double p[], int digits) {
    nevh_certain *c = system ? nevh__array(1, sizeof *c) : NULL;
    (void)t0, (void)q, (void)p, (void)digits;
    if (c)
        nevh__fail(&c->report, NEVH_ESTRUCT,
                   "this nevh was built without libquadmath, which comes with "
                   "GCC, and has no digits beyond those of doubles");
    return c;
}

void nevh_certain_free(nevh_certain *c) {
    free(c);
}

int nevh_certain_go(nevh_certain *c, double t) {
    (void)t;
    return nevh_certain_status(c);
}

size_t nevh_certain_series(const nevh_certain *c) {
    (void)c;
    return 0;
}

double nevh_certain_value(const nevh_certain *c, size_t k) {
    (void)c, (void)k;
    return NAN;
}

double nevh_certain_error(const nevh_certain *c, size_t k) {
    (void)c, (void)k;
    return NAN;
}

double nevh_certain_size(const nevh_certain *c, size_t k) {
    (void)c, (void)k;
    return NAN;
}

int nevh_certain_digits(const nevh_certain *c, size_t k) {
    (void)c, (void)k;
    return 0;
}

char *nevh_certain_text(const nevh_certain *c, size_t k) {
    (void)c, (void)k;
    return NULL;
}
#endif

int nevh_certain_status(const nevh_certain *c) {
    return c ? c->report.status : NEVH_ENOMEM;
}

const char *nevh_certain_message(const nevh_certain *c) {
    return c ? c->report.text : "out of memory";
}

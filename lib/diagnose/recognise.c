/* nevh: is the motion of this Hamiltonian known?

   Its gradient is taken at many states, the constants of a candidate are fitted
   to it, and from them the region that the orbit stays in; that is repeated
   there.  What is left over must be rounding at every state.  Where H has a
   Taylor series, its first coefficients are a gradient with more digits than a
   double: the constants are fitted to that again.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/exact_private.h"
#include "taylor/orbit_private.h"
#include <float.h>
#include <nevh/simd.h>
#include <math.h>
#include <nevh/gradient.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.141592653589793238462643383279502884

enum { STATES = 1024, PASSES = 3, MOST_INSTANCES = 10000 };

/* Bounds of the residual, in units of the size of the gradient there. */
static const double exact_rounding = 64 * DBL_EPSILON;
static const double difference_rounding = 1e-10;
static const double margin = 1.25; /* around the region of the orbit */
/* Pericentre over semi-major axis, below which an ellipse is a line. */
static const double narrowest = 1e-7;

typedef struct {
    const nevh_system *system;
    nevh_field *field;
    size_t n;
    double t0, t1;
    const double *q0, *p0;
    double rounding;
    double least_doubt; /* of the constants */
    uint64_t random;
    double *t;            /* STATES */
    double *q, *p;        /* n x STATES */
    double *taken;        /* the gradient there, 2n x STATES, in doubles */
    long double *dq, *dp; /* the same, or with more digits */
} trial;

/* The region of the sampled states: for n = 1, q around `middle` and, every other
   one, between low and high; else |q| between low and high. */
typedef struct {
    double middle, half, low, high, p;
} region;

static nevh_field *make_field(const nevh_system *s, const trial *b) {
    nevh_options o = {.gradient = nevh_exact,
                      .t = b->t0,
                      .q = b->q0,
                      .p = b->p0,
                      .portable = true};
    nevh_field *field = nevh_field_new(s, &o);
    if (nevh_field_status(field) != NEVH_ENOGRAD)
        return field;
    nevh_field_free(field);
    o.gradient = nevh_central8;
    return nevh_field_new(s, &o);
}

static double random_between(trial *b, double low, double high) {
    return low + (nevh__random(&b->random) + 1) / 2 * (high - low);
}

/* A random vector of a length up to (or, of a ball's surface, at) `most`. */
static void random_vector(trial *b, double length, double *to) {
    double square = 0;
    while (square == 0 || square > 1) {
        square = 0;
        for (size_t k = 0; k < b->n; k++) {
            to[k * STATES] = nevh__random(&b->random);
            square += to[k * STATES] * to[k * STATES];
        }
    }
    for (size_t k = 0; k < b->n; k++)
        to[k * STATES] *= length / sqrt(square);
}

static bool recognise_sample(trial *b, const region *r) {
    for (size_t i = 0; i < STATES; i++) {
        b->t[i] = random_between(b, b->t0, b->t1);
        random_vector(b, r->p * random_between(b, 0, 1), b->p + i);
        if (b->n > 1)
            random_vector(
                b, r->low * pow(r->high / r->low, random_between(b, 0, 1)),
                b->q + i);
        else if (i % 2 == 0)
            b->q[i] = r->middle + r->half * nevh__random(&b->random);
        else
            b->q[i] = random_between(b, r->low, r->high);
    }
    if (nevh_field_gradient(b->field, STATES, b->t, b->q, b->p, b->taken,
                            b->taken + b->n * STATES))
        return false;
    for (size_t i = 0; i < 2 * b->n * STATES; i++)
        b->dq[i] = b->taken[i];
    return true;
}

/* The residual, its root mean square in units of `size`. */
typedef struct {
    double most, squares;
    size_t count;
} residual;

static void add_residual(residual *r, double left, double size) {
    double part = fabs(left) / size;
    r->most = part >= 0 && r->most <= part ? part : r->most;
    if (!(part >= 0))
        r->most = INFINITY;
    r->squares += part * part;
    r->count++;
}

static bool is_rounding(const residual *r, double rounding,
                        nevh__exact_solution *e) {
    if (!(r->most <= rounding))
        return false;
    e->doubt = fmax(e->doubt, sqrt(r->squares / (double)r->count));
    return true;
}

static void fit_mass(const trial *b, nevh__exact_solution *e) {
    long double pp = 0, pv = 0;
    for (size_t i = 0; i < b->n * STATES; i++) {
        pp += (long double)b->p[i] * b->p[i];
        pv += (long double)b->p[i] * b->dp[i];
    }
    e->a = pv / pp;
}

static bool mass_fits(const trial *b, nevh__exact_solution *e,
                      const region *r) {
    residual left = {0};
    for (size_t i = 0; i < b->n * STATES; i++)
        add_residual(&left, (double)(b->dp[i] - e->a * b->p[i]),
                     (double)e->a * r->p);
    return is_rounding(&left, b->rounding, e);
}

/* dV/dq = B sin q + C cos q, least squares near the start. */
static void fit_pendulum(const trial *b, nevh__exact_solution *e) {
    long double ss = 0, sc = 0, cc = 0, sd = 0, cd = 0;
    for (size_t i = 0; i < STATES; i += 2) {
        long double s = sinl(b->q[i]), c = cosl(b->q[i]);
        ss += s * s, sc += s * c, cc += c * c;
        sd += s * b->dq[i], cd += c * b->dq[i];
    }
    long double det = ss * cc - sc * sc;
    long double B = (cc * sd - sc * cd) / det, C = (ss * cd - sc * sd) / det;
    e->b = hypotl(B, C);
    e->c = atan2l(-C, B);
}

static bool pendulum_fits(const trial *b, nevh__exact_solution *e,
                          const region *r) {
    residual left = {0};
    (void)r;
    for (size_t i = 0; i < STATES; i++)
        add_residual(&left, (double)(b->dq[i] - e->b * sinl(b->q[i] - e->c)),
                     (double)e->b * (1 + fabs(b->q[i])));
    return is_rounding(&left, b->rounding, e);
}

/* The whole circle, and where it turns over all that it comes through. */
static region pendulum_region(const trial *b, const nevh__exact_solution *e) {
    double q0 = b->q0[0], p0 = b->p0[0], A = (double)e->b, a = (double)e->a;
    double p = sqrt(p0 * p0 + 4 * A / a);
    region r = {q0, PI, q0 - PI, q0 + PI, margin * p};
    double way = a * p * (b->t1 - b->t0) * (p0 < 0 ? -1 : 1);
    if (a * p0 * p0 / 2 - A * cos(q0 - (double)e->c) < A * (1 - 1e-6))
        return r;
    r.low += fmin(way, 0);
    r.high += fmax(way, 0);
    return r;
}

/* dV/dq = b q - b c. */
static void fit_oscillator(const trial *b, nevh__exact_solution *e) {
    long double q = 0, d = 0, qq = 0, qd = 0;
    for (size_t i = 0; i < STATES; i++)
        q += b->q[i] / (long double)STATES, d += b->dq[i] / (long double)STATES;
    for (size_t i = 0; i < STATES; i++) {
        qq += (b->q[i] - q) * (b->q[i] - q);
        qd += (b->q[i] - q) * (b->dq[i] - d);
    }
    e->b = qd / qq;
    e->c = q - d / e->b;
}

static bool oscillator_fits(const trial *b, nevh__exact_solution *e,
                            const region *r) {
    residual left = {0};
    double size = fmax(fabs(r->low), fabs(r->high)) + fabs((double)e->c);
    for (size_t i = 0; i < STATES; i++)
        add_residual(&left, (double)(b->dq[i] - e->b * (b->q[i] - e->c)),
                     (double)e->b * size);
    return is_rounding(&left, b->rounding, e);
}

static region oscillator_region(const trial *b, const nevh__exact_solution *e) {
    double ratio = sqrt((double)(e->a / e->b)), c = (double)e->c;
    double most = margin * nevh_simd_hypot(b->q0[0] - c, b->p0[0] * ratio);
    if (most == 0) /* at rest */
        most = fmax(fabs(c), DBL_MIN / DBL_EPSILON);
    return (region){c, most, c - most, c + most, most / ratio};
}

static long double recognise_length(const trial *b, const double *v,
                                    size_t stride) {
    long double square = 0;
    for (size_t k = 0; k < b->n; k++)
        square += (long double)v[k * stride] * v[k * stride];
    return sqrtl(square);
}

/* dV/dq = b q/|q|^3. */
static void fit_kepler(const trial *b, nevh__exact_solution *e) {
    e->b = 0;
    for (size_t i = 0; i < STATES; i++) {
        long double r = recognise_length(b, b->q + i, STATES);
        for (size_t k = 0; k < b->n; k++)
            e->b += r * b->q[k * STATES + i] * b->dq[k * STATES + i] / STATES;
    }
}

static bool kepler_fits(const trial *b, nevh__exact_solution *e,
                        const region *where) {
    residual left = {0};
    (void)where;
    for (size_t i = 0; i < STATES; i++) {
        long double r = recognise_length(b, b->q + i, STATES),
                    force = e->b / (r * r);
        for (size_t k = 0; k < b->n; k++)
            add_residual(&left,
                         (double)(b->dq[k * STATES + i] -
                                  force * b->q[k * STATES + i] / r),
                         (double)force);
    }
    return is_rounding(&left, b->rounding, e);
}

/* low is 0 where there is no ellipse. */
static region kepler_region(const trial *b, const nevh__exact_solution *e) {
    long double rr = 0, pp = 0, rp = 0;
    for (size_t k = 0; k < b->n; k++) {
        rr += (long double)b->q0[k] * b->q0[k];
        pp += (long double)b->p0[k] * b->p0[k];
        rp += (long double)b->q0[k] * b->p0[k];
    }
    long double energy = e->a * pp / 2 - e->b / sqrtl(rr);
    long double L2 = rr * pp - rp * rp, axis = -e->b / (2 * energy);
    long double ecc =
        sqrtl(fmaxl(0, 1 + 2 * energy * L2 * e->a / (e->b * e->b)));
    long double low = L2 * e->a / (e->b * (1 + ecc));
    if (!(energy < 0 && L2 > 0 && low > narrowest * axis))
        return (region){0};
    return (region){.low = (double)low / margin,
                    .high = (double)(axis * (1 + ecc)) * margin,
                    .p = margin *
                         (double)sqrtl(2 / e->a * (energy + e->b / low))};
}

/* Functions for each kind of motion. */
static const struct {
    void (*fit)(const trial *, nevh__exact_solution *);
    bool (*fits)(const trial *, nevh__exact_solution *, const region *);
    region (*region)(const trial *, const nevh__exact_solution *);
} kinds[NEVH__EXACT_KINDS] = {
    [NEVH__PENDULUM] = {fit_pendulum, pendulum_fits, pendulum_region},
    [NEVH__OSCILLATOR] = {fit_oscillator, oscillator_fits, oscillator_region},
    [NEVH__KEPLER] = {fit_kepler, kepler_fits, kepler_region}};

static void recognise_fit(const trial *b, nevh__exact_solution *e) {
    fit_mass(b, e);
    kinds[e->kind].fit(b, e);
}

static bool recognise_fits(const trial *b, nevh__exact_solution *e,
                           const region *r) {
    e->doubt = b->least_doubt;
    return mass_fits(b, e, r) && kinds[e->kind].fits(b, e, r);
}

static double longest_step(const trial *b, bool momentum) {
    double most = 0;
    for (size_t i = 0; i < nevh_field_step_count(b->field); i++) {
        nevh_step_report r = nevh_field_step_report(b->field, i);
        if (r.momentum == momentum)
            most = fmax(most, r.step);
    }
    return most;
}

/* Lengths to begin with: of the start, or those that differences see. */
static region first_region(const trial *b, const nevh__exact_solution *e) {
    double q0 = b->q0[0];
    double r = (double)recognise_length(b, b->q0, 1),
           p = (double)recognise_length(b, b->p0, 1);
    double half =
        e->kind == NEVH__PENDULUM ? PI : fmax(r, 64 * longest_step(b, false));
    p = fmax(p, 64 * longest_step(b, true));
    p = p > 0 ? p : 1;
    half = half > 0 ? half : 1;
    if (b->n > 1)
        return (region){.low = r / 2, .high = 2 * r, .p = p};
    return (region){q0, half, q0 - half, q0 + half, p};
}

static bool is_usable(const region *r) {
    return isfinite(r->low) && isfinite(r->high) && r->p > 0 &&
           isfinite(r->p) && r->low < r->high;
}

/* dp = dq/dt and dq = -dp/dt from series of an order as low as can be. */
static bool take_series(trial *b, NEVH__FINE(nevh__series_orbit) * orbit) {
    size_t n = b->n;
    nevh__wide state[2 * NEVH__EXACT_DOF];
    long double *rows = nevh__array(2 * n * (orbit->order + 1), sizeof *rows);
    nevh__report ignored = {0};
    bool taken = rows != NULL;
    for (size_t i = 0; taken && i < STATES; i++) {
        for (size_t k = 0; k < n; k++) {
            state[k] = b->q[k * STATES + i];
            state[n + k] = b->p[k * STATES + i];
        }
        taken = !NEVH__FINE(nevh__series_orbit_start)(orbit, b->t[i], state,
                                                      &ignored);
        if (!taken)
            break;
        NEVH__FINE(nevh__series_orbit_rows)(orbit, rows);
        for (size_t k = 0; k < n; k++) {
            b->dp[k * STATES + i] = rows[2 * n + k];
            b->dq[k * STATES + i] = -rows[3 * n + k];
        }
    }
    free(rows);
    return taken;
}

/* The constants with the digits of long double, at the states of the last pass;
   what there was stays where that cannot be. */
static void recognise_refine(trial *b, nevh__exact_solution *e,
                             const region *r) {
    static const double tolerance = 0.1;
    nevh__exact_solution finer = *e;
    NEVH__FINE(nevh__series_orbit) orbit = {0};
    nevh__report ignored = {0};
    nevh__recurrence *series =
        nevh__recurrence_new(b->system, NULL, false, &ignored);
    if (series &&
        NEVH__FINE(nevh__series_orbit_init)(&orbit, series, tolerance) &&
        take_series(b, &orbit)) {
        recognise_fit(b, &finer);
        b->least_doubt = 0;
        if (recognise_fits(b, &finer, r) && finer.doubt < e->doubt)
            *e = finer;
    }
    NEVH__FINE(nevh__series_orbit_clear)(&orbit);
    nevh__recurrence_free(series);
}

static bool recognise(trial *b, nevh__exact_solution *e) {
    region r = first_region(b, e);
    for (int pass = 0; pass < PASSES; pass++) {
        if (!is_usable(&r) || !recognise_sample(b, &r))
            return false;
        recognise_fit(b, e);
        if (!(e->a > 0 && e->b > 0 && isfinite((double)e->a) &&
              isfinite((double)e->b)))
            return false;
        if (pass == PASSES - 1) {
            bool found = recognise_fits(b, e, &r);
            if (found)
                recognise_refine(b, e, &r);
            return found;
        }
        r = kinds[e->kind].region(b, e);
    }
    return false;
}

/* GSL aborts where memory is out: ask first for more than it takes. */
static gsl_root_fsolver *make_solver(void) {
    void *memory = nevh__array(64, sizeof(double));
    free(memory);
    return memory ? gsl_root_fsolver_alloc(gsl_root_fsolver_brent) : NULL;
}

/* True if a term that is on is known to be no polynomial of degree 2. */
static bool is_curved(const nevh_system *s) {
    for (size_t i = 0; i < s->n_terms; i++)
        if (nevh__term_on(s, s->terms[i]) && s->terms[i]->decl.curved)
            return true;
    return false;
}

static bool try_kinds(trial *b, nevh__exact_solution *e) {
    e->n = b->n;
    if (b->n > 1) {
        e->kind = NEVH__KEPLER;
        return recognise(b, e);
    }
    e->kind = NEVH__PENDULUM;
    if (recognise(b, e))
        return true;
    e->kind = NEVH__OSCILLATOR;
    return !is_curved(b->system) && recognise(b, e);
}

static void recognise_divide(trial *b, double *memory, long double *gradient) {
    b->t = memory;
    b->q = memory + STATES;
    b->p = b->q + b->n * STATES;
    b->taken = b->p + b->n * STATES;
    b->dq = gradient;
    b->dp = gradient + b->n * STATES;
}

static int try_all(trial *b, nevh__exact_solution **exact) {
    double *memory = nevh__array((1 + 4 * b->n) * STATES, sizeof *memory);
    long double *gradient = nevh__array(2 * b->n * STATES, sizeof *gradient);
    nevh__exact_solution *e = nevh__array(1, sizeof *e);
    int status = memory && gradient && e ? NEVH_OK : NEVH_ENOMEM;
    if (!status)
        recognise_divide(b, memory, gradient);
    bool found = !status && try_kinds(b, e);
    if (found && e->kind == NEVH__KEPLER && !(e->solver = make_solver()))
        status = NEVH_ENOMEM;
    if (found && !status)
        *exact = e;
    else
        nevh__exact_free(e);
    free(gradient);
    free(memory);
    return status;
}

/* A search takes thousands of gradients: longer than most runs where H is a sum
   of very many. */
static bool is_too_long(const nevh_system *s) {
    size_t instances = 0;
    for (size_t i = 0; i < s->n_terms; i++)
        if (nevh__term_on(s, s->terms[i]))
            instances += s->terms[i]->decl.count;
    return instances > MOST_INSTANCES;
}

int nevh__exact_recognise(nevh__exact_solution **exact, const nevh_system *s,
                          double t0, double t1, const double q[],
                          const double p[]) {
    trial b = {.system = s,
               .n = s->n,
               .t0 = t0,
               .t1 = t1,
               .q0 = q,
               .p0 = p,
               .least_doubt = DBL_EPSILON / 8,
               .random = 1};
    *exact = NULL;
    if (s->n > NEVH__EXACT_DOF || nevh_system_friction(s, NULL) ||
        is_too_long(s))
        return NEVH_OK;
    b.field = make_field(s, &b);
    int status = b.field ? NEVH_OK : NEVH_ENOMEM;
    b.rounding = status || nevh_field_step_count(b.field) ? difference_rounding
                                                          : exact_rounding;
    if (!status && !nevh_field_status(b.field))
        status = try_all(&b, exact);
    nevh_field_free(b.field);
    return status;
}

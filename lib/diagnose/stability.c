/* nevh: up to which steps a scheme is stable on an oscillator.

   On H = (p^2 + q^2)/2 a step of a scheme is a matrix, read off from two steps;
   orbits stay bounded where its eigenvalues stay on or within the unit circle
   [S. Blanes, F. Casas, A. Murua, On the linear stability of splitting methods,
   Found. Comput. Math. 8 (2008) 357-393].
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"
#include <nevh/simd.h>
#include <math.h>
#include <nevh/diagnose.h>
#include <nevh/extend.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
/* Beyond that many radians a step no scheme is asked; the grid there.  */
static const double farthest = 16, spacing = 1. / 64;
/* The growth in a step that is instability: for a matrix of determinant 1, the root
   of a difference that rounds; for others, far above the rounding. */
static const double growing_kept = 1e-5, growing_lost = 1e-11;

typedef struct {
    nevh_system *system;
    nevh_stepper *stepper;
    bool symplectic, multistep;
    double growing;
} oscillator;

static double half_square(double t, const double q[], const double p[],
                          const double c[], const void *params) {
    double x = *(const bool *)params ? q[0] : p[0];
    (void)t, (void)c;
    return x * x / 2;
}

static void half_square_slope(size_t width, const double t[], const double q[],
                              const double p[], const double c[],
                              const void *params, double dq[], double dp[]) {
    const bool of_q = *(const bool *)params;
    const double *x = of_q ? q : p;
    double *slope = of_q ? dq : dp;
    (void)t, (void)c;
    for (size_t i = 0; slope && i < width; i++)
        slope[i] = x[i];
}

static nevh_system *new_system(void) {
    static const bool of_p = false, of_q = true;
    nevh_term kinetic = {.effect = "kinetic",
                         .np = 1,
                         .value = half_square,
                         .gradient = half_square_slope,
                         .params = &of_p};
    nevh_term spring = {.effect = "spring",
                        .nq = 1,
                        .value = half_square,
                        .gradient = half_square_slope,
                        .params = &of_q};
    nevh_system *s = nevh_system_new(1);
    if (s && !nevh_system_add(s, &kinetic))
        nevh_system_add(s, &spring);
    return s;
}

static oscillator stability_begin(const nevh_integrator *scheme) {
    static const double q[2] = {1, 0}, p[2] = {0, 1};
    nevh_options options = {.gradient = nevh_exact, .width = 2, .q = q, .p = p};
    nevh_system *s = new_system();
    bool symplectic = nevh_integrator_symplectic(scheme) == NEVH_YES;
    bool keeps = symplectic || scheme->preserves_energy == NEVH_YES;
    return (oscillator){s, nevh_stepper_new(s, scheme, &options), symplectic,
                        scheme->multistep, keeps ? growing_kept : growing_lost};
}

static void stability_end(const oscillator *o) {
    nevh_stepper_free(o->stepper);
    nevh_system_free(o->system);
}

/* For a multistep method: one more step, after so many that the effect of the
   starting procedure has decayed. */
static bool step_late(const oscillator *o, double x, double q[2], double p[2]) {
    enum { EARLY = 64 };
    double a[2], b[2];
    for (int i = 0; i <= EARLY; i++) {
        memcpy(a, q, sizeof a);
        memcpy(b, p, sizeof b);
        if (nevh_stepper_apply(o->stepper, i * x, x, q, p))
            return false;
    }
    double area = a[0] * b[1] - a[1] * b[0];
    double q0 = (q[0] * b[1] - q[1] * b[0]) / area;
    double p0 = (p[0] * b[1] - p[1] * b[0]) / area;
    q[1] = (a[0] * q[1] - a[1] * q[0]) / area;
    p[1] = (a[0] * p[1] - a[1] * p[0]) / area;
    q[0] = q0;
    p[0] = p0;
    return true;
}

/* The matrix of a step of x: the columns (q[0], p[0]) and (q[1], p[1]). */
static bool take_matrix(const oscillator *o, double x, double q[2],
                        double p[2]) {
    q[0] = p[1] = 1;
    q[1] = p[0] = 0;
    nevh_stepper_reset(o->stepper);
    return o->multistep ? step_late(o, x, q, p)
                        : !nevh_stepper_apply(o->stepper, 0, x, q, p);
}

/* The spectral radius of a step of x, less 1; INFINITY where no step is. */
static double stability_excess(const oscillator *o, double x) {
    double q[2], p[2];
    if (!take_matrix(o, x, q, p))
        return INFINITY;
    double determinant = o->symplectic ? 1 : q[0] * p[1] - q[1] * p[0];
    double half = fabs(q[0] + p[1]) / 2,
           discriminant = half * half - determinant;
    if (isnan(discriminant))
        return INFINITY;
    return discriminant < 0 ? sqrt(determinant) - 1
                            : half + sqrt(discriminant) - 1;
}

/* Half the trace's distance to 1 from below, which the tips of narrow unstable
   windows between points of the grid reach through. */
static double stability_closeness(const oscillator *o, double x) {
    double q[2], p[2];
    if (!take_matrix(o, x, q, p))
        return INFINITY;
    return fabs(q[0] + p[1]) / 2 - 1;
}

/* The largest closeness between a and b, by trisection. */
static double tip(const oscillator *o, double a, double b) {
    for (int i = 0; i < 60; i++) {
        double c = a + (b - a) / 3, d = b - (b - a) / 3;
        if (stability_closeness(o, c) > stability_closeness(o, d))
            b = d;
        else
            a = c;
    }
    return (a + b) / 2;
}

/* The onset of growth between a, which is stable, and b; next to 0 it is 0. */
static double bisect(const oscillator *o, double a, double b) {
    enum { HALVINGS = 64 };
    for (int i = 0; i < HALVINGS && b - a > 1e-9 * b; i++) {
        double middle = (a + b) / 2;
        if (stability_excess(o, middle) > o->growing)
            b = middle;
        else
            a = middle;
    }
    return a;
}

/* True if growth seen from x on sets in as a power of the step, so that every step
   has some: beyond a limit it grows far faster. */
static bool grows_from_nothing(const oscillator *o, double x) {
    static const double beyond = 1.1, faster = 10; /* above its 20th power */
    return stability_excess(o, beyond * x) < faster * o->growing;
}

static double stability_search(const oscillator *o) {
    double before[2] = {-1, -1};
    for (double x = spacing; x <= farthest; x += spacing) {
        double near = stability_closeness(o, x);
        if (stability_excess(o, x) > o->growing)
            return bisect(o, x - spacing, x);
        if (o->symplectic && before[1] > -0.1 && before[1] >= before[0] &&
            before[1] >= near) {
            double top = tip(o, x - 2 * spacing, x);
            if (stability_excess(o, top) > o->growing)
                return bisect(o, x - 2 * spacing, top);
        }
        before[0] = before[1];
        before[1] = near;
    }
    return INFINITY;
}

/* For methods with a space of their own: the largest point of an orbit in it. */
static double stability_longest(const oscillator *o, double x) {
    enum { STEPS = 500 };
    double q[2] = {1, 0}, p[2] = {0, 1}, most = 0;
    nevh_stepper_reset(o->stepper);
    for (int i = 0; i < STEPS && most < 100; i++) {
        if (nevh_stepper_apply(o->stepper, i * x, x, q, p))
            return INFINITY;
        most = fmax(most, fmax(nevh_simd_hypot(q[0], p[0]),
                               nevh_simd_hypot(q[1], p[1])));
    }
    return most;
}

static double search_extended(const oscillator *o) {
    for (double x = 2 * spacing; x <= 2; x += 2 * spacing)
        if (stability_longest(o, x) >= 100)
            return x - 2 * spacing;
    return INFINITY;
}

/* True if the scheme's steps of one oscillator are matrices, which tell what it bears:
   of substeps the limit is a resonance between two groups of effects. */
static bool is_linear(const nevh_integrator *scheme) {
    return scheme && !nevh_integrator_needs_tolerance(scheme) &&
           !scheme->kernel->has_substeps && !nevh_integrator_own_time(scheme) &&
           nevh_integrator_symplectic(scheme) != NEVH_EXTENDED;
}

double nevh_stability_limit(const nevh_integrator *scheme) {
    bool extended = scheme &&
                    nevh_integrator_symplectic(scheme) == NEVH_EXTENDED &&
                    !nevh_integrator_own_time(scheme);
    if (!extended && !is_linear(scheme))
        return NAN;
    oscillator o = stability_begin(scheme);
    double limit = nevh_stepper_status(o.stepper) ? NAN
                   : extended                     ? search_extended(&o)
                                                  : stability_search(&o);
    if (is_linear(scheme) && isfinite(limit) && !o.symplectic &&
        grows_from_nothing(&o, limit))
        limit = 0;
    stability_end(&o);
    return limit;
}

double nevh_stability_growth(const nevh_integrator *scheme, double x) {
    if (!is_linear(scheme) || !(x > 0))
        return NAN;
    oscillator o = stability_begin(scheme);
    double most =
        nevh_stepper_status(o.stepper) ? NAN : stability_excess(&o, x);
    stability_end(&o);
    return most > o.growing ? pow(1 + most, 2 * pi / x) : isnan(most) ? NAN : 1;
}

double nevh_stability_angle(const nevh_integrator *scheme, double x) {
    double q[2] = {1, 0}, p[2] = {0, 1};
    if (!is_linear(scheme))
        return NAN;
    oscillator o = stability_begin(scheme);
    int status = nevh_stepper_apply(o.stepper, 0, x, q, p);
    stability_end(&o);
    double determinant = q[0] * p[1] - q[1] * p[0];
    return status ? NAN : acos((q[0] + p[1]) / 2 / sqrt(determinant));
}

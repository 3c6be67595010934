/* nevh tests: difference steps that nobody gave are good ones.
   SPDX-License-Identifier: GPL-3.0-or-later

   The yardstick is the best of all powers of two, for all states of an orbit;
   the error is the largest of any component of the gradient over the largest
   component, in the units of the problem. */
#include "support.h"
#include <float.h>
#include <math.h>
#include <stdio.h>

#define EACH(lane) for (size_t lane = 0; lane < width; lane++)

enum { STATES = 40, SHORTEST = -42, LONGEST = 0 };

/* A problem in units of length L and mass M; the unit of time stays. */
typedef struct {
    const char *name;
    size_t n;
    nevh_system *(*make)(double L, double M);
    bool length[2];    /* which coordinates are; the others are angles */
    double q[2], p[2]; /* where an orbit starts, in units of 1 */
} example;

static nevh_system *make_pendulum(double L, double M) {
    static nevh_pendulum params;
    params = (nevh_pendulum){M, L, 9.8 * L};
    return nevh_pendulum_model->system(&params);
}

static nevh_system *make_double_pendulum(double L, double M) {
    static nevh_double_pendulum params;
    params = (nevh_double_pendulum){M, L, 9.8 * L};
    return nevh_double_pendulum_model->system(&params);
}

static nevh_system *make_elastic(double L, double M) {
    static nevh_elastic_pendulum params;
    params = (nevh_elastic_pendulum){M, 40 * M, L, 9.8 * L};
    return nevh_elastic_pendulum_model->system(&params);
}

static nevh_system *in_plane(double mass, const nevh_term *potential) {
    nevh_system *s = nevh_system_new(2);
    add_kinetic(s, 2, (const double[]){mass, mass});
    nevh_system_add(s, potential);
    return s;
}

static nevh_system *make_kepler(double L, double M) {
    return in_plane(M, &(nevh_term){.effect = "potential",
                                    .nq = 2,
                                    .nc = 1,
                                    .c = (const double[]){M * L * L * L},
                                    .value = gravity_value,
                                    .gradient = gravity_gradient});
}

static double henon(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    double x = q[0] / c[1], y = q[1] / c[1];
    (void)t, (void)p, (void)params;
    return c[0] * ((x * x + y * y) / 2 + x * x * y - y * y * y / 3);
}

static void henon_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    if (dq)
        EACH(i) {
            double L = c[width + i], x = q[i] / L, y = q[width + i] / L;
            dq[i] = c[i] / L * (x + 2 * x * y);
            dq[width + i] = c[i] / L * (y + x * x - y * y);
        }
}

static nevh_system *make_henon_heiles(double L, double M) {
    return in_plane(M, &(nevh_term){.effect = "potential",
                                    .nq = 2,
                                    .nc = 2,
                                    .c = (const double[]){M * L * L, L},
                                    .value = henon,
                                    .gradient = henon_gradient});
}

static const example pendulum = {"pendulum", 1, make_pendulum, {0}, {2}, {0}};
static const example twofold = {
    "double pendulum", 2, make_double_pendulum, {0, 0}, {1.5707963, 0}, {0, 0}};
static const example kepler6 = {"Kepler", 2,        make_kepler,
                                {1, 1},   {0.4, 0}, {0, 2}};
static const example henon_h = {"Henon-Heiles", 2,        make_henon_heiles,
                                {1, 1},         {0, 0.1}, {0.4905, 0}};
static const example elastic = {"elastic pendulum", 2,     make_elastic, {1, 0},
                                {1.5, 1},           {0, 0}};

/* Where to plan.  In equilibrium H does not say how far the orbit will go;
   nowhere means around zero, so not where H is singular. */
typedef struct {
    const example *of;
    const char *where;
    enum { MOVING, STILL, NOWHERE } how;
    double q[2], p[2];
} plan;

static const plan plans[] = {
    {&pendulum, "turning", MOVING, {2}, {0}},
    {&pendulum, "at the bottom", MOVING, {0}, {6}},
    {&pendulum, "hanging", STILL, {0}, {0}},
    {&pendulum, "nowhere", NOWHERE, {0}, {0}},
    {&twofold, "turning", MOVING, {1.5707963, 0}, {0, 0}},
    {&twofold, "at the bottom", MOVING, {0, 0}, {7, 3}},
    {&twofold, "hanging", STILL, {0, 0}, {0, 0}},
    {&twofold, "nowhere", NOWHERE, {0, 0}, {0, 0}},
    {&kepler6, "at pericentre", MOVING, {0.4, 0}, {0, 2}},
    {&kepler6, "at apocentre", MOVING, {1.6, 0}, {0, 0.5}},
    {&henon_h, "at its start", MOVING, {0, 0.1}, {0.4905, 0}},
    {&henon_h, "turning", MOVING, {0.3, 0.4}, {0, 0}},
    {&henon_h, "at its minimum", STILL, {0, 0}, {0, 0}},
    {&henon_h, "nowhere", NOWHERE, {0, 0}, {0, 0}},
    {&elastic, "turning", MOVING, {1.5, 1}, {0, 0}},
    {&elastic, "hanging", STILL, {1.245, 0}, {0, 0}},
};
enum { PLANS = sizeof plans / sizeof *plans };

/* An example in some units: the states of an orbit, and exact gradients. */
typedef struct {
    size_t n;
    double unit[4]; /* 2n */
    double q[STATES][2], p[STATES][2], exact[STATES][4];
} orbit;

static const double now = 0;

static orbit orbit_of(const example *b, double L, double M) {
    const nevh_options o = {.gradient = nevh_exact};
    orbit z = {.n = b->n};
    nevh_system *one = b->make(1, 1), *s = b->make(L, M);
    nevh_stepper *stepper = nevh_stepper_new(one, nevh_gauss8, &o);
    nevh_field *f = nevh_field_new(s, &o);
    double q[2] = {b->q[0], b->q[1]}, p[2] = {b->p[0], b->p[1]};
    for (size_t k = 0; k < b->n; k++) {
        z.unit[k] = b->length[k] ? L : 1;
        z.unit[b->n + k] = M * L * L / z.unit[k];
    }
    for (size_t i = 0; i < STATES; i++) {
        for (size_t k = 0; k < b->n; k++) {
            z.q[i][k] = q[k] * z.unit[k];
            z.p[i][k] = p[k] * z.unit[b->n + k];
        }
        ck_assert(!nevh_field_gradient(f, 1, &now, z.q[i], z.p[i], z.exact[i],
                                       z.exact[i] + b->n));
        ck_assert(!nevh_run(stepper, 0, 0.0137, 23, q, p, NULL, 0));
    }
    nevh_field_free(f);
    nevh_stepper_free(stepper);
    nevh_system_free(one);
    nevh_system_free(s);
    return z;
}

/* The worst relative error over the orbit of a field with these options. */
static double error_of(const nevh_system *s, const orbit *z,
                       const nevh_options *o) {
    nevh_field *f = nevh_field_new(s, o);
    double worst = 0, d[4];
    ck_assert_msg(!nevh_field_status(f), "%s", nevh_field_message(f));
    for (size_t i = 0; i < STATES; i++) {
        double error = 0, size = 0;
        if (nevh_field_gradient(f, 1, &now, z->q[i], z->p[i], d, d + z->n))
            error = INFINITY;
        for (size_t k = 0; k < 2 * z->n; k++) {
            error = fmax(error, fabs(d[k] - z->exact[i][k]) * z->unit[k]);
            size = fmax(size, fabs(z->exact[i][k]) * z->unit[k]);
        }
        worst = fmax(worst, error / size);
    }
    nevh_field_free(f);
    return worst;
}

static double best_error(const nevh_system *s, const orbit *z,
                         const nevh_gradient *g) {
    double best = INFINITY, steps[4];
    const nevh_options o = {.gradient = g, .gradient_steps = steps};
    for (int power = SHORTEST; power <= LONGEST; power++) {
        for (size_t k = 0; k < 2 * z->n; k++)
            steps[k] = ldexp(z->unit[k], power);
        best = fmin(best, error_of(s, z, &o));
    }
    return best;
}

static double chosen_error(const nevh_system *s, const orbit *z,
                           const nevh_gradient *g, const plan *at) {
    double q[2], p[2];
    for (size_t k = 0; k < z->n; k++) {
        q[k] = at->q[k] * z->unit[k];
        p[k] = at->p[k] * z->unit[z->n + k];
    }
    return error_of(s, z,
                    &(nevh_options){.gradient = g,
                                    .q = at->how == NOWHERE ? NULL : q,
                                    .p = at->how == NOWHERE ? NULL : p});
}

static const double lengths[] = {1, 1e-10, 1e11, 1e-10, 1e11};
static const double masses[] = {1, 1e-27, 1e30, 1e30, 1e-27};
enum { UNITS = sizeof lengths / sizeof *lengths };

static void assert_good(const char *what, const plan *at,
                        const nevh_gradient *g, double chosen, double best) {
    double factor = at->how == STILL ? 30 : 10;
    ck_assert_msg(chosen <= factor * best,
                  "%s%s, planned %s, %s: error %.1e, best %.1e", what,
                  at->of->name, at->where, nevh_gradient_name(g), chosen, best);
}

TEST_EACH(near_the_best, PLANS *UNITS) {
    const plan *at = &plans[_i % PLANS];
    double L = lengths[_i / PLANS], M = masses[_i / PLANS];
    orbit z = orbit_of(at->of, L, M);
    nevh_system *s = at->of->make(L, M);
    char units[40];
    snprintf(units, sizeof units, "in %g, %g: ", L, M);
    for (int i = 0; i < 4; i++) {
        const nevh_gradient *g = nevh_gradients()[i];
        assert_good(units, at, g, chosen_error(s, &z, g, at),
                    best_error(s, &z, g));
    }
    nevh_system_free(s);
}

/* H as one function, with a constant added. */
typedef struct {
    nevh_field *terms;
    double constant;
} shifted;

static double whole(double t, const double q[], const double p[],
                    const void *params) {
    const shifted *h = params;
    double value = NAN;
    nevh_field_value(h->terms, 1, &t, q, p, &value);
    return value + h->constant;
}

/* The error may grow as theory says: as the power m/(m+1) of the rounding of
   values, for order m.  The pericentre takes most of the factor. */
TEST_EACH(constant_in_h, PLANS) {
    const plan *at = &plans[_i];
    orbit z = orbit_of(at->of, 1, 1);
    nevh_system *terms = at->of->make(1, 1);
    shifted h = {nevh_field_new(terms, NULL), 0};
    nevh_system *s = nevh_system_from(z.n, whole, &h);
    for (int i = 0; i < 4; i++) {
        const nevh_gradient *g = nevh_gradients()[i];
        double m = nevh_gradient_order(g);
        h.constant = 0;
        assert_good("whole ", at, g, chosen_error(s, &z, g, at),
                    best_error(s, &z, g));
        h.constant = 1e6;
        double error = chosen_error(s, &z, g, at);
        assert_good("shifted ", at, g, error, best_error(s, &z, g));
        ck_assert(error < 20 * pow(1e6 * DBL_EPSILON, m / (m + 1)));
    }
    nevh_system_free(s);
    nevh_field_free(h.terms);
    nevh_system_free(terms);
}

/* Steps that are whole periods would see no slope anywhere. */
static double lattice(double t, const double q[], const double p[],
                      const void *params) {
    (void)t;
    return p[0] * p[0] / 2 + cos(2 * acos(-1) * q[0] / *(const double *)params);
}

TEST_EACH(no_whole_periods, 16) {
    double period = ldexp(1, _i - 8), wave = 2 * acos(-1) / period, t = 0;
    nevh_system *s = nevh_system_from(1, lattice, &period);
    for (int i = 0; i < 4; i++) {
        double start = i, p = 0.3, dq;
        nevh_options o = {
            .gradient = nevh_gradients()[_i % 4], .q = &start, .p = &p};
        nevh_field *f = nevh_field_new(s, &o);
        for (double x = 0.1; x < 3; x += 0.31) {
            double q = x * period;
            nevh_field_gradient(f, 1, &t, &q, &p, &dq, NULL);
            ck_assert_msg(fabs(dq / wave + sin(2 * acos(-1) * x)) < 1e-4,
                          "period %g, from %g: %g", period, start, dq / wave);
        }
        nevh_field_free(f);
    }
    nevh_system_free(s);
}

/* A power of a variable has no length of its own where it is 0: that of others
   must do. */
static double cubic(double t, const double q[], const double p[],
                    const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2 + q[0] * q[0] * q[0];
}

static double level(double t, const double q[], const double p[],
                    const void *params) {
    return cubic(t, q, p, params) + p[1] * p[1] / 2 + cos(q[1]);
}

TEST_EACH(powers_at_zero, 4) {
    nevh_system *s = nevh_system_from(2, _i % 2 ? level : cubic, NULL);
    double q[] = {0, 0.5}, p[] = {0.1, 0.2}, t = 0, dq[2];
    for (int g = 0; g < 4; g++) {
        nevh_options o = {.gradient = nevh_gradients()[g]};
        if (_i / 2)
            o.q = q, o.p = p;
        nevh_field *f = nevh_field_new(s, &o);
        ck_assert_double_gt(nevh_field_step(f, "H", 0, 0), 1e-9);
        double away[] = {0.3, 0.5};
        ck_assert_int_eq(nevh_field_gradient(f, 1, &t, away, p, dq, NULL), 0);
        ck_assert_double_eq_tol(dq[0], 0.27, g ? 1e-9 : 1e-5);
        nevh_field_free(f);
    }
    nevh_system_free(s);
}

/* What is not given is a power of two, and the same each time. */
TEST_EACH(powers_of_two, PLANS) {
    const plan *at = &plans[_i];
    nevh_system *s = at->of->make(1, 1);
    nevh_options o = {.q = at->q, .p = at->p};
    nevh_field *f = nevh_field_new(s, &o), *again = nevh_field_new(s, &o);
    for (size_t i = 0; i < nevh_field_step_count(f); i++) {
        nevh_step_report a = nevh_field_step_report(f, i);
        nevh_step_report b = nevh_field_step_report(again, i);
        size_t var = a.index + (a.momentum ? at->of->n : 0);
        int power;
        ck_assert(!a.given && frexp(a.step, &power) == 0.5);
        ck_assert_double_eq(a.step,
                            nevh_field_step(f, a.term, a.instance, var));
        ck_assert(a.step == b.step && a.order == b.order);
        ck_assert(a.truncation == b.truncation && a.rounding == b.rounding);
    }
    nevh_field_free(f);
    nevh_field_free(again);
    nevh_system_free(s);
}

/* One variable's step is given; then all are. */
TEST_EACH(given_steps_win, PLANS) {
    const plan *at = &plans[_i];
    size_t n = at->of->n;
    nevh_system *s = at->of->make(1, 1);
    for (size_t k = 0; k <= 2 * n; k++) {
        double steps[4] = {0};
        nevh_options o = {.gradient_steps = steps, .q = at->q, .p = at->p};
        *(k < 2 * n ? &steps[k] : &o.gradient_step) = 0.0123;
        nevh_field *f = nevh_field_new(s, &o);
        for (size_t i = 0; i < nevh_field_step_count(f); i++) {
            nevh_step_report r = nevh_field_step_report(f, i);
            size_t var = r.index + (r.momentum ? n : 0);
            bool given = k == 2 * n || var == k;
            ck_assert(r.given == given && (r.step == 0.0123) == given);
            ck_assert(nevh_field_step(f, r.term, r.instance, var) == r.step);
        }
        nevh_field_free(f);
    }
    nevh_system_free(s);
}

/* Circles, one of them much smaller than the others: its lane decides. */
enum { WIDEST = 20 };
static const double small = 1e-3;
static double inner_error(const nevh_system *s, size_t width, size_t inner) {
    double q[2 * WIDEST] = {0}, p[2 * WIDEST] = {0}, d[4] = {0};
    for (size_t lane = 0; lane < width; lane++) {
        q[lane] = lane == inner ? small : 1;
        p[width + lane] = 1 / sqrt(q[lane]);
    }
    const nevh_options o = {.q = q, .p = p, .width = width};
    nevh_field *f = nevh_field_new(s, &o);
    const double at[] = {0.6 * small, 0.8 * small};
    int status = nevh_field_gradient(f, 1, &now, at, at, d, d + 2);
    double error =
        hypot(d[0] * small * small - 0.6, d[1] * small * small - 0.8);
    nevh_field_free(f);
    return status ? INFINITY : error;
}

TEST_RANGE(all_lanes_are_seen, 2, WIDEST + 1) {
    size_t width = (size_t)_i;
    nevh_system *s = make_kepler(1, 1);
    ck_assert_double_lt(inner_error(s, 1, 0), 1e-11);
    ck_assert_double_gt(inner_error(s, width, width), 1e-4);
    for (size_t lane = 0; lane < width; lane++)
        ck_assert_msg(inner_error(s, width, lane) < 1e-11,
                      "lane %zu of %zu is not seen", lane, width);
    nevh_system_free(s);
}

/* A hill of width 1, with the particle far outside: V is 7e-44 there, and T 0.5. */
static double hill(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return 0.3 * exp(-q[0] * q[0] - q[1] * q[1]);
}

static double hill_energy(const double q[], const double p[]) {
    return (p[0] * p[0] + p[1] * p[1]) / 2 + hill(0, q, p, NULL, NULL);
}

TEST_RANGE(a_distant_force_does_not_scale_momenta, 3, 12) {
    double q[] = {-_i, 0.3}, p[] = {1, 0}, start = hill_energy(q, p);
    nevh_system *s =
        in_plane(1, &(nevh_term){.effect = "hill", .nq = 2, .value = hill});
    nevh_options o = {.gradient = nevh_central4, .q = q, .p = p};
    nevh_stepper *m = nevh_stepper_new(s, nevh_gauss8, &o);
    int status = nevh_run(m, 0, 0.05, 40 * (size_t)_i, q, p, NULL, 0);
    ck_assert_msg(status == 0, "%s", nevh_stepper_message(m));
    ck_assert_double_gt(q[0], 0);
    ck_assert_double_lt(fabs(hill_energy(q, p) - start), 1e-9);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Ripples of a wide well, or of a slope, of 2 to 20 percent of its force: longer
   steps agree with each other that there are none. */
typedef struct {
    double x, quadratic, linear, ripple, wave;
} rippled;
static const rippled ripples[] = {
    {5.001, 1, 0, 1e-3, 100}, {5.001, 1, 0, 1e-4, 1e3},
    {5.001, 0, 1, 1e-3, 100}, {5.001, 0, 1, 1e-4, 1e3},
    {5.001, 1, 0, 1e-2, 100}, {5.001, 1, 0, 1e-4, 100},
    {30.3, 1, 0, 1e-2, 1e3},  {1.3, 1, 0, 1e-3, 300},
};
enum { RIPPLES = sizeof ripples / sizeof *ripples };

static double rippled_value(double t, const double q[], const double p[],
                            const double c[], const void *params) {
    const rippled *r = params;
    (void)t, (void)p, (void)c;
    return r->quadratic * q[0] * q[0] / 2 + r->linear * q[0] -
           r->ripple * cos(r->wave * q[0]);
}

TEST_EACH(ripples_are_not_stepped_over, RIPPLES) {
    const rippled *r = &ripples[_i];
    nevh_system *s = nevh_system_new(1);
    add_kinetic(s, 1, (const double[]){1});
    nevh_system_add(s, &(nevh_term){.effect = "rippled",
                                    .nq = 1,
                                    .value = rippled_value,
                                    .params = r});
    for (int g = 0; g < 4; g++) {
        nevh_options o = {.gradient = nevh_gradients()[g],
                          .q = &r->x,
                          .p = (const double[]){0}};
        nevh_field *f = nevh_field_new(s, &o);
        for (double x = r->x - 1; x < r->x + 0.1; x += 0.0137) {
            double dq, p = 0;
            double slope = r->quadratic * x + r->linear;
            double whole = slope + r->ripple * r->wave * sin(r->wave * x);
            ck_assert_int_eq(nevh_field_gradient(f, 1, &now, &x, &p, &dq, NULL),
                             0);
            ck_assert_double_lt(fabs(dq - whole), 1e-6 * slope);
        }
        nevh_field_free(f);
    }
    nevh_system_free(s);
}

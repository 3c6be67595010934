/* nevh tests: Tao's schemes in their doubled phase space.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/tao_private.h"
#include "run/stepper_private.h"
#include "support.h"
#include <float.h>
#include <math.h>
#include <string.h>

static const nevh_integrator *const *const schemes[] = {&nevh_tao2, &nevh_tao4,
                                                        &nevh_tao6};

static nevh_stepper *stepper_on(const nevh_system *s,
                                const nevh_integrator *scheme,
                                const nevh_options *o) {
    nevh_stepper *m = nevh_stepper_new(s, scheme, o);
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    return m;
}

static const nevh__binding *binding_of(const nevh_stepper *m) {
    return m->work.plan;
}

/* (q, p) and the second copy less it, of one lane. */
enum { MOST = 4 * MOST_DOF };
typedef struct {
    double q[MOST_DOF], p[MOST_DOF], x[MOST_DOF], y[MOST_DOF];
} pair;

/* One step from there, with nothing else remembered. */
static pair step_of(nevh_stepper *m, double t, double h, pair z) {
    nevh_work *w = &m->work;
    size_t bytes = w->n * sizeof(double);
    double *x = w->memory + NEVH__TAO_X * w->n;
    double *y = w->memory + NEVH__TAO_Y * w->n;
    memset(w->memory, 0, w->memory_rows * sizeof(double));
    memcpy(x, z.x, bytes);
    memcpy(y, z.y, bytes);
    ck_assert_int_eq(nevh__advance(m, t, h, z.q, z.p), NEVH_OK);
    memcpy(z.x, x, bytes);
    memcpy(z.y, y, bytes);
    return z;
}

/* Canonical coordinates: (q, x, p, y); 4n numbers. */
static void to_canonical(const pair *z, size_t n, double c[]) {
    for (size_t k = 0; k < n; k++) {
        c[k] = z->q[k];
        c[n + k] = z->q[k] + z->x[k];
        c[2 * n + k] = z->p[k];
        c[3 * n + k] = z->p[k] + z->y[k];
    }
}

static pair from_canonical(const double c[], size_t n) {
    pair z = {0};
    for (size_t k = 0; k < n; k++) {
        z.q[k] = c[k];
        z.x[k] = c[n + k] - c[k];
        z.p[k] = c[2 * n + k];
        z.y[k] = c[3 * n + k] - c[2 * n + k];
    }
    return z;
}

/* Column j of the step's Jacobian, by differences of order 6; the step is
   followed by one that moves the copies apart by the part `spoil`. */
static void find_column(nevh_stepper *m, double t, double h, const pair *at,
                        double spoil, size_t j, double column[]) {
    static const double weights[] = {1.5, -0.6, 0.1};
    size_t n = m->work.n;
    memset(column, 0, 4 * n * sizeof *column);
    for (int i = 0; i < 6; i++) {
        double c[MOST], move = (i / 2 + 1) * 0x1p-8 * (i % 2 ? -1 : 1);
        to_canonical(at, n, c);
        c[j] += move;
        pair z = step_of(m, t, h, from_canonical(c, n));
        for (size_t k = 0; k < n; k++)
            z.x[k] *= 1 + spoil;
        to_canonical(&z, n, c);
        for (size_t k = 0; k < 4 * n; k++)
            column[k] += weights[i / 2] * c[k] / (2 * move);
    }
}

/* The largest element of M^T J M - J. */
static double defect_of(nevh_stepper *m, double t, double h, const pair *at,
                        double spoil) {
    size_t half = 2 * m->work.n;
    double columns[MOST][MOST], most = 0;
    for (size_t j = 0; j < 2 * half; j++)
        find_column(m, t, h, at, spoil, j, columns[j]);
    for (size_t i = 0; i < 2 * half; i++)
        for (size_t j = 0; j < 2 * half; j++) {
            double sum = i + half == j ? -1 : j + half == i ? 1 : 0;
            for (size_t k = 0; k < half; k++)
                sum += columns[i][k] * columns[j][half + k] -
                       columns[i][half + k] * columns[j][k];
            most = fmax(most, fabs(sum));
        }
    return most;
}

/* A state of a problem whose copies are a little apart. */
static pair apart(const problem *b) {
    pair z;
    for (size_t k = 0; k < MOST_DOF; k++) {
        z.q[k] = b->q[k];
        z.p[k] = b->p[k];
        z.x[k] = 0.011 * (double)(k + 1);
        z.y[k] = 0.017 - 0.03 * (double)k;
    }
    return z;
}

TEST_EACH(doubled_step_is_symplectic, 15) {
    const problem *b = problems[_i % 5];
    nevh_system *s = b->make();
    nevh_stepper *m = planned(s, b, *schemes[_i / 5], nevh_exact);
    pair z = apart(b);
    double h = b == &double_pendulum ? 0.04 : 0.1;
    double found = defect_of(m, b->t0, h, &z, 0);
    ck_assert_msg(found < 1e-11, "%s: %.2e", b->name, found);
    ck_assert_double_gt(defect_of(m, b->t0, h, &z, 1e-6), 1e-7);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* The contrast: of (q, p) alone it is not, where H is not separable. */
TEST_EACH(one_copy_is_not_symplectic, 3) {
    nevh_system *s = double_pendulum.make();
    nevh_stepper *m = planned(s, &double_pendulum, *schemes[_i], nevh_exact);
    double found = 0;
    ck_assert_int_eq(nevh_symplecticity_defect(m, 0, 0.08, double_pendulum.q,
                                               double_pendulum.p, NULL, &found),
                     NEVH_OK);
    ck_assert_msg(found > 1e-4, "%s: %.2e", nevh_integrator_name(*schemes[_i]),
                  found);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* How far the copies move apart on a regular orbit of the double pendulum. */
static double distance_of_copies(const nevh_integrator *scheme, double binding,
                                 double h, size_t steps) {
    static const double q0[] = {1.1, 0}, p0[] = {0, 2.7746};
    nevh_system *s = nevh_double_pendulum_model->system(
        nevh_double_pendulum_model->defaults);
    nevh_options o = {
        .gradient = nevh_exact, .binding = binding, .q = q0, .p = p0};
    nevh_stepper *m = stepper_on(s, scheme, &o);
    double q[] = {q0[0], q0[1]}, p[] = {p0[0], p0[1]}, most = 0;
    for (size_t i = 0; i < steps && most < 1; i++) {
        ck_assert_int_eq(nevh_stepper_apply(m, (double)i * h, h, q, p), 0);
        for (size_t k = 0; k < 4; k++)
            most = fmax(most, fabs(m->work.memory[NEVH__TAO_X * 2 + k]));
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
    return most;
}

TEST_EACH(copies_stay_together, 3) {
    static const double largest[] = {0.15, 0.05, 0.01};
    const nevh_integrator *scheme = *schemes[_i];
    double found = distance_of_copies(scheme, 0, 0.01, 100000);
    ck_assert_msg(found < largest[_i], "%s: %.2e", nevh_integrator_name(scheme),
                  found);
    /* The contrast: next to no binding. */
    ck_assert_double_ge(distance_of_copies(scheme, DBL_MIN, 0.01, 100000), 1);
}

/* Tao's problem in other units, of q, p and H: params. */
static double tao(double t, const double q[], const double p[],
                  const void *params) {
    const double *unit = params, x = q[0] / unit[0], y = p[0] / unit[1];
    (void)t;
    return unit[2] * ((x * x + 1) * (y * y + 1) / 2);
}

typedef struct {
    double q, p, binding; /* the latter times the unit of time */
} outcome;

/* The end of an orbit, in the first units. */
static outcome orbit_in(const double unit[3], const nevh_integrator *scheme,
                        const double scale[2]) {
    double start[] = {-3 * unit[0], 0.25 * unit[1]};
    double second = unit[0] * unit[1] / unit[2];
    nevh_system *s = nevh_system_from(1, tao, unit);
    nevh_options o = {
        .gradient = nevh_central8, .scale = scale, .q = start, .p = start + 1};
    nevh_stepper *m = stepper_on(s, scheme, &o);
    double z[] = {start[0], start[1]};
    int status = nevh_run(m, 0, 0.01 * second, 1000, z, z + 1, NULL, 0);
    outcome end = {NAN, NAN, binding_of(m)->omega * second};
    if (!status)
        end = (outcome){z[0] / unit[0], z[1] / unit[1], end.binding};
    nevh_stepper_free(m);
    nevh_system_free(s);
    return end;
}

static double difference(const outcome *a, const outcome *b) {
    return fabs(a->q - b->q) + fabs(a->p - b->p) +
           fabs(a->binding / b->binding - 1);
}

static const double ones[] = {1, 1, 1};

TEST_EACH(units_do_not_matter, 3) {
    static const double given[] = {2.5, 1.5};
    static const double odd[] = {3.7e-21, 1.9e17, 0.37};
    static const double even[] = {0x1p-70, 0x1p33, 0x1p-9};
    const double odd_given[] = {2.5 * odd[0], 1.5 * odd[1]};
    const nevh_integrator *scheme = *schemes[_i];
    outcome a = orbit_in(ones, scheme, given);
    outcome b = orbit_in(odd, scheme, odd_given);
    ck_assert_msg(difference(&a, &b) < 1e-8, "given scales: %.2e",
                  difference(&a, &b));
    a = orbit_in(ones, scheme, NULL);
    b = orbit_in(even, scheme, NULL);
    ck_assert_msg(difference(&a, &b) < 1e-9, "found scales: %.2e",
                  difference(&a, &b));
    /* The contrast: a binding that takes the units as they come. */
    a = orbit_in(ones, scheme, ones);
    b = orbit_in((const double[]){0.3, 7, 1}, scheme, ones);
    ck_assert(!(difference(&a, &b) < 1e-4));
}

static double nothing(double t, const double q[], const double p[],
                      const void *params) {
    (void)t, (void)q, (void)p, (void)params;
    return 0;
}

/* Without H a step is the binding's turn by 2 omega h. */
TEST_EACH(binding_turns, 3) {
    static const double scale[] = {2, 10}, omega = 3, r = 5;
    nevh_system *s = nevh_system_from(1, nothing, NULL);
    nevh_options o = {.scale = scale, .binding = omega};
    nevh_stepper *m = stepper_on(s, *schemes[_i], &o);
    pair at = {{0.4}, {-1.3}, {0.2}, {0.7}};
    for (double h = -0.9; h < 1; h += 0.3) {
        pair z = step_of(m, 0, h, at);
        double c = cos(2 * omega * h), sine = sin(2 * omega * h);
        double x = at.x[0], y = at.y[0];
        ck_assert_double_eq_tol(z.x[0], c * x + sine * y / r, 1e-14);
        ck_assert_double_eq_tol(z.y[0], c * y - sine * x * r, 1e-14);
        ck_assert_double_eq_tol(r * z.x[0] * z.x[0] + z.y[0] * z.y[0] / r,
                                r * x * x + y * y / r, 1e-14);
        ck_assert_double_eq_tol(2 * z.q[0] + z.x[0], 1, 1e-15);
        ck_assert_double_eq_tol(2 * z.p[0] + z.y[0], -1.9, 2e-15);
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
}

static double oscillator(double t, const double q[], const double p[],
                         const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / (2 * 7e-3) + 50 * q[0] * q[0] / 2;
}

/* r and omega of an oscillator are those of the books, to what they are rounded
   to, from anywhere. */
TEST_EACH(binding_of_an_oscillator, 4) {
    const double q = _i % 2 ? 0.3 : 0, p = _i / 2 ? 0.02 : 0;
    nevh_system *s = nevh_system_from(1, oscillator, NULL);
    nevh_stepper *m =
        stepper_on(s, nevh_tao2, &(nevh_options){.q = &q, .p = &p});
    const nevh__binding *b = binding_of(m);
    ck_assert_double_eq_tol(b->ratio[0] / sqrt(50 * 7e-3), 1, 0.05);
    ck_assert_double_eq_tol(b->omega / sqrt(50 / 7e-3), 3, 0.15);
    nevh_stepper_free(m);
    m = stepper_on(
        s, nevh_tao2,
        &(nevh_options){
            .q = &q, .p = &p, .scale = (double[]){2, 3}, .binding = 17});
    ck_assert_double_eq(binding_of(m)->ratio[0], 1.5);
    ck_assert_double_eq(binding_of(m)->omega, 17);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* A charge in a field along z: H does not depend on y, which rests on what
   bends x. */
static double charge(double t, const double q[], const double p[],
                     const void *params) {
    double v = p[1] - 200 * q[0];
    (void)t, (void)params;
    return (p[0] * p[0] + v * v) / 0.2;
}

TEST_EACH(binding_of_a_free_coordinate, 3) {
    static const double q[] = {0.3, 7}, p[] = {5, 90};
    nevh_system *s = nevh_system_from(2, charge, NULL);
    nevh_stepper *m =
        stepper_on(s, *schemes[_i], &(nevh_options){.q = q, .p = p});
    const nevh__binding *b = binding_of(m);
    ck_assert_double_eq_tol(b->ratio[0] / 200, 1, 0.3);
    ck_assert_double_eq_tol(b->ratio[1] / 200, 1, 0.3);
    ck_assert(b->omega > 3 * 2000 * 0.9 && b->omega < 3 * 4000 * 1.5);
    double z[] = {q[0], q[1], p[0], p[1]}, start = charge(0, q, p, NULL);
    ck_assert_int_eq(nevh_run(m, 0, 1e-5, 10000, z, z + 2, NULL, 0), NEVH_OK);
    ck_assert_double_eq_tol(charge(0, z, z + 2, NULL) / start, 1, 1e-2);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST_EACH(refused_bindings, 3) {
    static const double bindings[] = {-1, NAN, INFINITY};
    nevh_system *s = nevh_system_from(1, oscillator, NULL);
    nevh_options o = {.binding = bindings[_i]};
    nevh_stepper *m = nevh_stepper_new(s, nevh_tao4, &o);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    ck_assert(strstr(nevh_stepper_message(m), "binding"));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Sums of powers over the parts: 1, then 0 for odd powers below the order. */
TEST_EACH(compositions, 3) {
    const nevh_integrator *scheme = *schemes[_i];
    const nevh_splitting *c = scheme->table;
    size_t count = 2 * c->count + 1;
    ck_assert_int_eq(scheme->stages, (int)count);
    ck_assert_int_eq(scheme->gradients, 3 * (int)count);
    for (int power = 1; power < scheme->order; power += 2) {
        double sum = power == 1 ? -1 : 0;
        for (size_t i = 0; i < count; i++) {
            double part = nevh__composition_part(c, i, 1);
            ck_assert(part == nevh__composition_part(c, count - 1 - i, 1));
            ck_assert(-part == nevh__composition_part(c, i, -1));
            sum += pow(part, power);
        }
        ck_assert_double_eq_tol(sum, 0, 4e-15);
    }
}

/* How far a run ends from where gauss12 does, on separable H. */
static double error_of(const problem *b, const nevh_integrator *scheme,
                       double h, size_t steps) {
    double q[2][MOST_DOF], p[2][MOST_DOF], sum = 0;
    for (int i = 0; i < 2; i++) {
        nevh_system *s = b->make();
        nevh_stepper *m = planned(s, b, i ? nevh_gauss12 : scheme, nevh_exact);
        memcpy(q[i], b->q, sizeof b->q);
        memcpy(p[i], b->p, sizeof b->p);
        ck_assert_int_eq(nevh_run(m, b->t0, h, steps, q[i], p[i], NULL, 0), 0);
        nevh_stepper_free(m);
        nevh_system_free(s);
    }
    for (size_t k = 0; k < b->n; k++)
        sum += fabs(q[0][k] - q[1][k]) + fabs(p[0][k] - p[1][k]);
    return sum;
}

TEST_EACH(agrees_with_gauss, 3) {
    const nevh_integrator *scheme = *schemes[_i];
    const problem *b = &henon_heiles;
    double coarse = error_of(b, scheme, 0.05, 160);
    double fine = error_of(b, scheme, 0.025, 320);
    double ratio = exp2(nevh_integrator_order(scheme));
    ck_assert_msg(fine < 2e-3 && coarse / fine > 0.8 * ratio &&
                      coarse / fine < 1.25 * ratio,
                  "%s: %.2e, %.2e", nevh_integrator_name(scheme), coarse, fine);
}

/* Tao's own problem, q = -3, p = 0, over 1e5 steps: energy within bounds that
   shrink as h^order. */
TEST_EACH(energy_on_taos_problem, 3) {
    static const double most[][2] = {
        {4e-3, 1e-3}, {1.2e-4, 8e-6}, {3e-6, 6e-8}};
    static const double q0 = -3, p0 = 0;
    for (int half = 0; half < 2; half++) {
        double h = half ? 0.005 : 0.01, q = q0, p = p0;
        nevh_system *s = nevh_system_from(1, tao, ones);
        nevh_options o = {.gradient = nevh_central6, .q = &q0, .p = &p0};
        nevh_stepper *m = stepper_on(s, *schemes[_i], &o);
        nevh_energy *e = nevh_energy_new(s, NULL);
        nevh_observer watch = {nevh_energy_observe, e, 1};
        ck_assert_int_eq(nevh_run(m, 0, h, 100000, &q, &p, &watch, 1), NEVH_OK);
        nevh_energy_report r = nevh_energy_result(e, 0);
        ck_assert_msg(r.verdict == NEVH_BOUNDED && r.max < most[_i][half],
                      "%s, h = %g: max %.2e, drift %.2e",
                      nevh_integrator_name(*schemes[_i]), h, r.max, r.drift);
        nevh_energy_free(e);
        nevh_stepper_free(m);
        nevh_system_free(s);
    }
}

/* A lane goes on from the gradient it has kept, whatever others do. */
TEST_EACH(neighbours_gradients_are_kept, 3) {
    const problem *b = &henon_heiles;
    nevh_system *s = b->make();
    nevh_options o = {.gradient = nevh_exact, .binding = 5, .width = 2};
    nevh_stepper *quiet = stepper_on(s, *schemes[_i], &o);
    nevh_stepper *jumpy = stepper_on(s, *schemes[_i], &o);
    double z[] = {b->q[0], 0, b->q[1], 0, b->p[0], 0, b->p[1], 0}, y[8];
    memcpy(y, z, sizeof z);
    for (int i = 0; i < 3000; i++) {
        y[1] = 1e-5 * i;
        ck_assert_int_eq(nevh_stepper_apply(quiet, i * 0.1, 0.1, z, z + 4), 0);
        ck_assert_int_eq(nevh_stepper_apply(jumpy, i * 0.1, 0.1, y, y + 4), 0);
        for (int k = 0; k < 8; k += 2)
            ck_assert_msg(z[k] == y[k], "step %d", i);
    }
    nevh_stepper_free(quiet);
    nevh_stepper_free(jumpy);
    nevh_system_free(s);
}

/* Friction shortens p and y alike, and the gradient kept is no longer that of
   the state; q and x stay. */
TEST_EACH(friction_scales_the_memory, 3) {
    const problem *b = &double_pendulum;
    static const double factor[] = {0.5, 0.25};
    nevh_system *s = b->make();
    nevh_stepper *m = planned(s, b, *schemes[_i], nevh_exact);
    double q[] = {b->q[0], b->q[1]}, p[] = {b->p[0], b->p[1]}, before[13];
    const double *now = m->work.memory;
    ck_assert_int_eq(nevh_run(m, 0, 0.02, 7, q, p, NULL, 0), NEVH_OK);
    memcpy(before, now, sizeof before);
    m->work.integrator->kernel->apply_friction(&m->work, factor);
    for (size_t i = 0; i < 8; i++) {
        bool momentum =
            i / 2 == NEVH__TAO_COMPENSATION_P || i / 2 == NEVH__TAO_Y;
        ck_assert(now[i] == before[i] * (momentum ? factor[i % 2] : 1));
    }
    ck_assert(before[6] != 0 && before[12] == 1 && now[12] == 0);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

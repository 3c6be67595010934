/* What a numerical gradient costs against one written by hand: the double
   pendulum for t = 0 ... 20 by Dormand and Prince's method, as in the paper,
   which measured 4 times in Python (Amoreira & Amoreira, Numerical Evolution
   from the Hamiltonian).  All take turns, the best of which counts; the
   energy error shows what the price buys.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <nevh/nevh.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 9, RUNS = 20, STEPS = 500, METHODS = 5 };

/* As a student writes it. */
static double hamiltonian(double t, const double q[], const double p[],
                          const void *params) {
    double d = q[0] - q[1], s = sin(d);
    (void)t, (void)params;
    return (p[0] * p[0] + 2 * p[1] * p[1] - 2 * p[0] * p[1] * cos(d)) /
               (2 * (1 + s * s)) -
           9.8 * (2 * cos(q[0]) + cos(q[1]));
}

/* Blocks, complex step and derivatives by hand are those of nevh's model. */
static const struct {
    const char *name;
    const nevh_gradient *const *gradient;
    bool student;
} methods[METHODS] = {
    {"by hand", &nevh_exact, false},
    {"order 2, values one by one", &nevh_central2, true},
    {"order 2, blocks of values", &nevh_central2, false},
    {"order 4, blocks of values", &nevh_central4, false},
    {"complex step", &nevh_complex_step, false},
};

typedef struct {
    nevh_system *system;
    nevh_stepper *stepper;
    double seconds, error; /* CPU seconds of the best turn */
} contender;

static contender enter(size_t i) {
    const nevh_model *model = nevh_double_pendulum_model;
    contender c = {.seconds = INFINITY,
                   .system = methods[i].student
                                 ? nevh_system_from(2, hamiltonian, NULL)
                                 : model->system(model->defaults)};
    nevh_options options = {
        .gradient = *methods[i].gradient, .q = model->q, .p = model->p};
    c.stepper = nevh_stepper_new(c.system, nevh_dopri5, &options);
    return c;
}

static int take_turn(contender *c) {
    const nevh_model *model = nevh_double_pendulum_model;
    double q[2], p[2], before, after, t = 0;
    nevh_field *field = nevh_stepper_field(c->stepper);
    int status = nevh_field_value(field, 1, &t, model->q, model->p, &before);
    clock_t start = clock();
    for (int i = 0; !status && i < RUNS; i++) {
        memcpy(q, model->q, sizeof q);
        memcpy(p, model->p, sizeof p);
        status = nevh_run(c->stepper, 0, 20. / STEPS, STEPS, q, p, NULL, 0);
    }
    c->seconds =
        fmin(c->seconds, (double)(clock() - start) / CLOCKS_PER_SEC / RUNS);
    if (!status)
        status = nevh_field_value(field, 1, &t, q, p, &after);
    c->error = status ? NAN : fabs(after / before - 1);
    return status;
}

int main(void) {
    contender c[METHODS];
    int status = NEVH_OK;
    for (size_t i = 0; i < METHODS; i++)
        c[i] = enter(i);
    for (int round = 0; round < ROUNDS; round++)
        for (size_t i = 0; !status && i < METHODS; i++) {
            if ((status = take_turn(&c[i])))
                fprintf(stderr, "%s\n", nevh_stepper_message(c[i].stepper));
        }
    puts(" gradient                     ms    times   |dH/H|");
    for (size_t i = 0; !status && i < METHODS; i++)
        printf(" %-26s %6.3f %7.2f %9.1e\n", methods[i].name,
               1000 * c[i].seconds, c[i].seconds / c[0].seconds, c[i].error);
    puts(" the paper, in Python               4");
    for (size_t i = 0; i < METHODS; i++) {
        nevh_stepper_free(c[i].stepper);
        nevh_system_free(c[i].system);
    }
    return status != NEVH_OK;
}

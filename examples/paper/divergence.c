/* The paper's third figure, and how long the agreement lasts: the double
   pendulum with gradients from H and from formulas, by the same steps.

   The paper's spread of 0.02 is delta = 0.01.  The error of a difference of order
   r changes H by about delta^r, which chaos multiplies by e every 1/lambda: so the
   time until the angles part by 0.1 rad grows by r/lambda when delta falls by e.
   Look at the slope over ln(delta^r), and at 1/lambda from displacements.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <nevh/chaos.h>
#include <nevh/nevh.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double h = 0.01, apart = 0.1;

/* Two steppers of one system, alike but for their gradients. */
typedef struct {
    nevh_stepper *stepper[2];
    double q[2][2], p[2][2];
} twins;

static void stop(const char *message) {
    fprintf(stderr, "%s\n", message);
    exit(EXIT_FAILURE);
}

static twins begin(const nevh_system *system, const nevh_model *model,
                   const nevh_gradient *method, double delta) {
    twins both;
    for (int i = 0; i < 2; i++) {
        nevh_options o = {i ? nevh_exact : method, i ? 0 : delta, .q = model->q,
                          .p = model->p};
        both.stepper[i] =
            nevh_stepper_new(system, nevh_integrator_named("gauss8"), &o);
        memcpy(both.q[i], model->q, sizeof both.q[i]);
        memcpy(both.p[i], model->p, sizeof both.p[i]);
    }
    return both;
}

static void step(twins *both, int k) {
    for (int i = 0; i < 2; i++)
        if (nevh_stepper_apply(both->stepper[i], k * h, h, both->q[i],
                               both->p[i]))
            stop(nevh_stepper_message(both->stepper[i]));
}

static void end(twins *both) {
    nevh_stepper_free(both->stepper[0]);
    nevh_stepper_free(both->stepper[1]);
}

/* As the figure shows it. */
static void figure(const nevh_system *system, const nevh_model *model) {
    twins both = begin(system, model, nevh_central2, 0.01);
    puts("  t    phi1        phi2        difference: phi1      phi2");
    for (int k = 0; k <= 2000; k++) {
        if (k % 200 == 0)
            printf("%4.0f %10.6f %11.6f %18.1e %9.1e\n", k * h, both.q[1][0],
                   both.q[1][1], both.q[0][0] - both.q[1][0],
                   both.q[0][1] - both.q[1][1]);
        step(&both, k);
    }
    end(&both);
}

/* The time at which the angles have parted. */
static double delay(const nevh_system *system, const nevh_model *model,
                    const nevh_gradient *method, double delta) {
    twins both = begin(system, model, method, delta);
    int k = 0;
    while (k * h < 300 && fmax(fabs(both.q[0][0] - both.q[1][0]),
                               fabs(both.q[0][1] - both.q[1][1])) < apart)
        step(&both, k++);
    end(&both);
    return k * h;
}

static void delays(const nevh_system *system, const nevh_model *model) {
    const nevh_gradient *const method[] = {nevh_central2, nevh_central4,
                                           nevh_central6};
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    puts(
        "\n delta    order 2   order 4   order 6: time until they differ by 0.1");
    for (double delta = 0.1; delta > 1.1e-4; delta /= sqrt(sqrt(10))) {
        printf("%.1e", delta);
        for (int i = 0; i < 3; i++) {
            int order = nevh_gradient_order(method[i]);
            double change = order * log(delta);
            if (change < log(1e-11))
                continue;
            double t = delay(system, model, method[i], delta);
            printf("%9.2f", t);
            n++, x += change, y += t, xx += change * change, xy += change * t;
        }
        puts("");
    }
    printf("slope over ln delta^order %9.2f\n",
           (n * xy - x * y) / (n * xx - x * x));
}

/* The exponent of so many orbits near by, until then. */
static void exponent(const nevh_system *system, const nevh_model *model,
                     double until, size_t starts) {
    nevh_options o = {.q = model->q, .p = model->p};
    nevh_chaos_options how = {.integrator = nevh_integrator_named("gauss8"),
                              .options = &o,
                              .dt = h,
                              .starts = starts};
    nevh_chaos *c = nevh_chaos_new(system, &how);
    double error, value;
    if (nevh_chaos_run(c, until))
        stop(nevh_chaos_message(c));
    value = nevh_chaos_exponent(c, 0, &error);
    printf("-1/lambda until t = %3.0f     %8.2f, lambda = %.3f within %.3f\n",
           until, -1 / value, value, error);
    nevh_chaos_free(c);
}

int main(void) {
    const nevh_model *const model[] = {nevh_double_pendulum_model,
                                       nevh_double_pendulum_as_printed_model};
    for (int i = 0; i < 2; i++) {
        nevh_system *system = model[i]->system(model[i]->defaults);
        printf("%s%s\n", i ? "\n" : "",
               i ? "H as printed, p1^2 + p2^2"
                 : "H from the Lagrangian, p1^2 + 2 p2^2");
        figure(system, model[i]);
        delays(system, model[i]);
        exponent(system, model[i], i ? 50 : 150, 1);
        /* Of H as printed most orbits leave by t = 300: more orbits, for less time. */
        exponent(system, model[i], i ? 50 : 300, i ? 16 : 4);
        nevh_system_free(system);
    }
    return 0;
}

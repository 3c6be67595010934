/* A kernel and a scheme of your own, with public headers alone: the symplectic
   Euler method p' = p - h dV/dq(q), q' = q + h dT/dp(p').  nevh_stepper_new
   takes the descriptor as it is.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/extend.h>
#include <nevh/nevh.h>
#include <stdio.h>

/* Once, before the first step: what a step needs.  The memory holds the rounding
   errors of q and p, which the next step adds again; scratch holds the time of
   each orbit, the increments, and the momenta p'. */
static int plan(nevh_work *w) {
    w->memory_rows = 2 * w->n;
    w->scratch_size = w->width + 3 * w->size;
    return NEVH_OK;
}

/* nevh_work_commit writes q and p only if all new numbers are finite. */
static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    double *time = w->scratch, *dq = time + w->width, *dp = dq + w->size;
    double *p_new = dp + w->size;
    for (size_t i = 0; i < w->width; i++)
        time[i] = t;
    int status = nevh_work_gradient(w, w->width, time, q, p, dp, NULL);
    for (size_t i = 0; !status && i < w->size; i++) {
        dp[i] *= -h;
        p_new[i] = p[i] + dp[i];
    }
    if (!status)
        status = nevh_work_gradient(w, w->width, time, q, p_new, NULL, dq);
    for (size_t i = 0; !status && i < w->size; i++)
        dq[i] *= h;
    return status ? status
                  : nevh_work_commit(w, w->size, q, dq, w->memory, p, dp,
                                     w->memory + w->size);
}

static const nevh_kernel kernel = {.plan = plan, .step = step};
static const nevh_integrator mine = {
    .name = "my-euler",
    .source = "R. de Vogelaere, report, University of Notre Dame (1956)",
    .order = 1,
    .stages = 1,
    .gradients = 1,
    .symplectic = NEVH_YES,
    .explicit_form = NEVH_YES,
    .needs = NEVH_SEPARABLE,
    .kernel = &kernel,
};

static int report(const nevh_integrator *scheme) {
    const nevh_model *model = nevh_pendulum_model;
    nevh_system *system = model->system(model->defaults);
    double q[] = {model->q[0]}, p[] = {model->p[0]};
    nevh_stepper *stepper = nevh_stepper_new(system, scheme, NULL);
    nevh_energy *energy = nevh_energy_new(system, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    int status = nevh_run(stepper, 0, 0.02, 50000, q, p, &watch, 1);
    nevh_energy_report found = nevh_energy_result(energy, 0);
    if (status)
        printf("%s\n", nevh_stepper_message(stepper));
    else
        printf(" %-18s %8.1e %12.6f %10.6f  %s\n", nevh_integrator_name(scheme),
               found.max, q[0], p[0], nevh_verdict_name(found.verdict));
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    nevh_system_free(system);
    return status;
}

int main(void) {
    puts("Pendulum, 1000 s, dt = 0.02, from values of H alone\n\n"
         " integrator            error       q(end)     p(end)  energy");
    return report(&mine) || report(nevh_symplectic_euler_a) ||
           report(nevh_symplectic_euler_b) || report(nevh_euler);
}

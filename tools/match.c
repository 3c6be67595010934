/* nevh: steps of equal work.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of an implicit scheme the work of a step depends on its length: after how
   many pilots it is found, each of how many steps. */
enum { PILOTS = 6, PILOT_STEPS = 64 };
static const double settled = 0.01;

/* Gradients in a step of dt, on the average; NAN where it fails. */
static double work_of_step(const plan *p, const row *r, double dt) {
    size_t size = p->n * sizeof(double), steps = PILOT_STEPS;
    double *q = tool_allocate(2 * p->n, sizeof *q);
    nevh_stepper *s = row_stepper(p, r, false);
    nevh_counts before = nevh_stepper_counts(s);
    double most = floor((p->t_end - p->run->t_start) / dt);
    if (most < PILOT_STEPS)
        steps = most < 1 ? 1 : (size_t)most;
    memcpy(q, p->q, size);
    memcpy(q + p->n, p->p, size);
    int status = nevh_run(s, p->run->t_start, dt, steps, q, q + p->n, NULL, 0);
    nevh_counts after = nevh_stepper_counts(s);
    nevh_stepper_free(s);
    free(q);
    return status
               ? NAN
               : (double)(after.gradients - before.gradients) / (double)steps;
}

/* The dt at which a step costs as many gradients as verlet takes in that time:
   one a step of `each`. */
static double piloted(const plan *p, const row *r, double each) {
    double dt = each, span = p->t_end - p->run->t_start;
    for (int i = 0; i < PILOTS; i++) {
        double work = work_of_step(p, r, dt);
        if (!(work > 0))
            return i ? dt / 2 : each;
        double next = fmin(each * work, span);
        bool near = fabs(next - dt) < settled * dt;
        dt = next;
        if (near)
            break;
    }
    return dt;
}

/* Whether its work is gradients at all. */
static bool takes_gradients(const row *r) {
    return nevh_integrator_gradients(r->scheme) > 0 ||
           nevh_integrator_sweep_gradients(r->scheme) > 0;
}

bool match_unmatched(const plan *p, const row *r) {
    return p->match_work && r->tolerance == 0 && !takes_gradients(r);
}

void match_row(const plan *p, row *r) {
    int gradients = nevh_integrator_gradients(r->scheme);
    if (!p->match_work || r->tolerance > 0 || !takes_gradients(r))
        return;
    nevh_stepper *s = row_stepper(p, r, false);
    bool refused = nevh_stepper_status(s) != NEVH_OK;
    nevh_stepper_free(s);
    if (refused)
        return;
    r->dt = gradients > 0 ? r->dt * gradients : piloted(p, r, r->dt);
}

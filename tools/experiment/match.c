/* nevh: steps of equal work.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>

/* The work of an implicit step depends on its length, which is found by pilots of
   so many steps. */
enum { PILOT_STEPS = 64, BISECTIONS = 5 };
static const double longer = 1.5;
static const double hopeless = 1.3; /* a price above the least met */

/* Gradients in a step of dt, on the average, until the scene wants to stop; NAN
   where it fails. */
static double work_of_step(const plan *p, const row *r, double dt) {
    size_t steps = PILOT_STEPS;
    double *q = plan_state(p);
    nevh_stepper *s = row_stepper(p, r, false);
    nevh_counts before = nevh_stepper_counts(s);
    double most = floor((p->t_end - p->run->t_start) / dt);
    if (most < PILOT_STEPS)
        steps = most < 1 ? 1 : (size_t)most;
    stop end = {.scene = p->scene};
    int status = nevh_run(s, p->run->t_start, dt, steps, q, q + p->n,
                          &(nevh_observer){stop_observe, &end, 1},
                          nevh_scene_stops(p->scene));
    nevh_counts after = nevh_stepper_counts(s);
    double taken = (double)nevh_stepper_taken(s);
    row_stepper_keep(p, r, false, s);
    return (status && !end.reached) || taken == 0
               ? NAN
               : (double)(after.gradients - before.gradients) / taken;
}

/* Gradients at dt for one of verlet at `each`, over the same time. */
static double price(const plan *p, const row *r, double each, double dt) {
    return work_of_step(p, r, dt) * each / dt;
}

/* Between two steps, of which the longer is cheap enough. */
static double bisect(const plan *p, const row *r, double each, double low,
                     double high) {
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = sqrt(low * high);
        if (price(p, r, each, middle) <= 1)
            high = middle;
        else
            low = middle;
    }
    return high;
}

/* The dt at which a step costs as many gradients as verlet takes in that time:
   one a step of `each`.  Longer steps need more iterations: where no dt makes
   the scheme as cheap, the cheapest that was met. */
static double piloted(const plan *p, const row *r, double each) {
    double cheapest = each, least = price(p, r, each, each), dt = each;
    double span = p->t_end - p->run->t_start;
    while (least > 1 && dt * longer <= span) {
        double now = price(p, r, each, dt * longer);
        if (now <= 1)
            return bisect(p, r, each, dt, dt * longer);
        if (!(now < hopeless * least))
            break;
        dt *= longer;
        cheapest = now < least ? dt : cheapest;
        least = fmin(least, now);
    }
    return cheapest;
}

/* True if its work is counted in gradients. */
static bool takes_gradients(const row *r) {
    return nevh_integrator_gradients(r->scheme) > 0 ||
           nevh_integrator_sweep_gradients(r->scheme) > 0;
}

bool match_unmatched(const plan *p, const row *r) {
    return p->match_work && r->tolerance == 0 && !takes_gradients(r);
}

bool match_dearer(const plan *p, const row *r) {
    double steps = (r->t_end - p->run->t_start) / r->nominal_dt;
    return p->match_work && r->ran && r->tolerance == 0 &&
           nevh_integrator_explicit(r->scheme) == NEVH_NO &&
           (double)r->counts.gradients > 1.1 * steps + 1;
}

void match_row(const plan *p, row *r) {
    r->nominal_dt = r->dt;
    int gradients = nevh_integrator_gradients(r->scheme);
    if (!p->match_work || r->tolerance > 0 || !takes_gradients(r))
        return;
    nevh_stepper *s = row_stepper(p, r, false);
    bool refused = nevh_stepper_status(s) != NEVH_OK;
    row_stepper_keep(p, r, false, s);
    if (refused)
        return;
    r->dt = gradients > 0 ? r->dt * gradients : piloted(p, r, r->dt);
}

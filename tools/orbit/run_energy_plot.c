/* nevh run --plot-kind energy: errors of the energy.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/energy_plot.h"
#include "run_plot_private.h"
#include <stdlib.h>

static nevh_stepper *new_stepper(const plan *p, const char *integrator) {
    const nevh_integrator *scheme;
    nevh_options o =
        plan_scheme_options(p, integrator, p->gradients.item[0], &scheme);
    o.balance = p->balance;
    return nevh_stepper_new(p->system, scheme, &o);
}

static nevh_energy *new_energy(const plan *p, const nevh_stepper *s) {
    nevh_options planned = plan_options(p, p->gradients.item[0]);
    nevh_energy *energy = nevh_energy_new(p->system, &planned);
    if (p->balance)
        nevh_energy_follow(energy, s);
    plan_set_scale(p, energy);
    return energy;
}

static void draw_energy(plot *to, const run_picture *picture, double turns,
                        const orbit *o) {
    const plan *p = &o->plan;
    nevh_stepper *s = new_stepper(p, o->integrator);
    nevh_energy *energy = new_energy(p, s);
    energy_trace trace = {envelope_new(p->run->t_start, p->t_end), energy};
    nevh_observer observers[] = {{nevh_energy_observe, energy, 1},
                                 {energy_trace_observe, &trace, 1}};
    double stopped;
    if (plan_run(p, s, p->dt[0], observers, 2, &stopped) && !picture->quiet)
        tool_refuse("%s: %s failed: %s", p->name, o->integrator,
                    nevh_stepper_message(s));
    energy_plot_add(to, &picture->plan, turns,
                    picture->orbits.count > 1 ? o->name : NULL, o->integrator,
                    trace.envelope);
    nevh_energy_free(energy);
    nevh_stepper_free(s);
}

plot *plot_energy(run_picture *picture) {
    double turns = orbit_turns_of(&picture->plan);
    plot *to = energy_plot_new(&picture->plan, picture->plan.title, NULL);
    for (size_t i = 0; i < picture->orbits.count; i++)
        draw_energy(to, picture, turns, &picture->orbits.item[i]);
    picture_note(picture, to, energy_plot_words(&picture->plan, turns));
    return to;
}

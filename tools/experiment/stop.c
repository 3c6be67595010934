/* nevh: runs that end early, where the scene's `stop` says.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>
#include <string.h>

int stop_observe(void *data, size_t step, double t, const double q[],
                 const double p[]) {
    stop *s = data;
    bool reached;
    s->t = t;
    s->step = step;
    int status = nevh_scene_stop_reached(s->scene, t, q, p, &reached);
    s->reached = !status && reached;
    return s->reached ? (int)NEVH_STOPPED : status;
}

int plan_run_from(const plan *p, nevh_stepper *stepper, double q[], double m[],
                  const nevh_observer observers[], size_t count,
                  double *stopped) {
    nevh_observer *all = tool_allocate(count + 1, sizeof *all);
    stop s = {.scene = p->scene};
    if (count)
        memcpy(all, observers, count * sizeof *all);
    all[count] = (nevh_observer){stop_observe, &s, 1};
    int status = nevh_run_until(stepper, p->run->t_start, p->dt[0], p->t_end, q,
                                m, all, count + nevh_scene_stops(p->scene));
    tool_release(all);
    *stopped = s.reached ? s.t : NAN;
    return s.reached ? NEVH_OK : status;
}

int plan_run(const plan *p, nevh_stepper *stepper, double dt,
             const nevh_observer observers[], size_t count, double *stopped) {
    plan by = *p;
    double *state = plan_state(p);
    by.dt = &dt;
    int status = plan_run_from(&by, stepper, state, state + p->n, observers,
                               count, stopped);
    tool_release(state);
    return status;
}

char *stop_words(const plan *p, double t) {
    return text_print("stopped at t = %.9g: %s", t,
                      nevh_scene_stop_text(p->scene));
}

/* The row that stopped first, or last; NULL: none stopped. */
static const row *outermost(const row rows[], size_t count, bool last) {
    const row *found = NULL;
    for (size_t i = 0; i < count; i++)
        if (isfinite(rows[i].stopped) &&
            (!found || (last ? rows[i].stopped > found->stopped
                             : rows[i].stopped < found->stopped)))
            found = &rows[i];
    return found;
}

void stop_notes(const plan *p, const row rows[], size_t count, list *notes) {
    const row *first = outermost(rows, count, false),
              *last = outermost(rows, count, true);
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        found += isfinite(rows[i].stopped);
    if (!first)
        return;
    char *until = last->stopped > first->stopped
                      ? text_print(" ... %.9g (%s, dt = %.4g)", last->stopped,
                                   last->integrator, last->dt)
                      : text_print("%s", "");
    list_print(notes,
               "%zu of %zu runs stopped where %s: t = %.9g (%s, dt = %.4g)%s",
               found, count, nevh_scene_stop_text(p->scene), first->stopped,
               first->integrator, first->dt, until);
}

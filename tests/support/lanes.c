/* nevh tests: orbits side by side are what each is alone.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "lanes.h"
#include <stdlib.h>

enum { MOST_WIDTH = 16 };

static nevh_stepper *plan(const many_orbits *x, size_t width, const double q[],
                          const double p[]) {
    nevh_options o = *x->options;
    o.width = width;
    o.t = x->t;
    o.q = q;
    o.p = p;
    nevh_stepper *m = nevh_stepper_new(x->system, x->scheme, &o);
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    return m;
}

/* Steps from `from` to `until`, one by one or as a run. */
static void go(const many_orbits *x, nevh_stepper *m, bool run, size_t from,
               size_t until, double q[], double p[]) {
    double t = x->t + x->h * (double)from;
    if (run)
        ck_assert_msg(!nevh_run(m, t, x->h, until - from, q, p, NULL, 0), "%s",
                      nevh_stepper_message(m));
    for (size_t i = from; i < until && !run; i++)
        ck_assert_msg(
            !nevh_stepper_apply(m, x->t + x->h * (double)i, x->h, q, p), "%s",
            nevh_stepper_message(m));
}

nevh_counts many_orbits_run(const many_orbits *x, double q[], double p[]) {
    nevh_stepper *m = plan(x, x->width, x->q, x->p);
    size_t size = x->n * x->width * sizeof *q;
    if (x->planned)
        x->planned();
    memcpy(q, x->q, size);
    memcpy(p, x->p, size);
    go(x, m, true, 0, x->steps / 2, q, p);
    if (x->jumps)
        q[x->width - 1] += 0.125;
    go(x, m, true, x->steps / 2, x->steps, q, p);
    nevh_counts counts = nevh_stepper_counts(m);
    nevh_stepper_free(m);
    return counts;
}

void many_orbits_run_one(const many_orbits *x, size_t lane, double q[],
                         double p[]) {
    double start[2 * MOST_DOF];
    for (size_t k = 0; k < x->n; k++) {
        start[k] = q[k] = x->q[k * x->width + lane];
        start[x->n + k] = p[k] = x->p[k * x->width + lane];
    }
    nevh_stepper *first = plan(x, 1, start, start + x->n);
    nevh_stepper *second = plan(x, 1, start, start + x->n);
    size_t size = nevh_stepper_save_size(first);
    void *saved = malloc(size);
    if (x->planned)
        x->planned();
    go(x, first, false, 0, x->steps / 2, q, p);
    nevh_stepper_save(first, saved);
    ck_assert(!nevh_stepper_load(second, saved, size));
    go(x, second, true, x->steps / 2, x->steps, q, p);
    free(saved);
    nevh_stepper_free(first);
    nevh_stepper_free(second);
}

void assert_alone(const many_orbits *x, size_t lane, const double q[],
                  const double p[]) {
    double one_q[MOST_DOF], one_p[MOST_DOF];
    many_orbits_run_one(x, lane, one_q, one_p);
    for (size_t k = 0; k < x->n; k++) {
        size_t i = k * x->width + lane;
        ck_assert_msg(q[i] == one_q[k] && p[i] == one_p[k],
                      "%s, lane %zu of %zu: (%a, %a), alone (%a, %a)",
                      nevh_integrator_name(x->scheme), lane, x->width, q[i],
                      p[i], one_q[k], one_p[k]);
    }
}

nevh_counts assert_lanes_are_alone(const many_orbits *x) {
    double q[MOST_DOF * MOST_WIDTH], p[MOST_DOF * MOST_WIDTH];
    ck_assert_uint_le(x->width, MOST_WIDTH);
    nevh_counts counts = many_orbits_run(x, q, p);
    for (size_t lane = 0; lane + x->jumps < x->width; lane++)
        assert_alone(x, lane, q, p);
    return counts;
}

/* nevh: what kernels share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_WORK_PRIVATE_H
#define NEVH_WORK_PRIVATE_H

#include "gradient/evaluation_private.h"
#include "work/pace.h"
#include <nevh/extend.h>

/* NEVH_EDOM: the new state is not finite. */
int nevh__fail_range(nevh_work *, double t, double h);
/* A careful first length, without sign, of substeps whose error falls with
   `power`: a part of the time in which y, 2n apart by `stride`, changes by
   max(|y|, scale). */
double nevh__first_substep(const nevh_work *, int power, double h,
                           size_t stride, const double y[],
                           const double slopes[]);

/* nevh__pace_count, and why another one should not be tried. */
enum { NEVH__WHY = 120 };
bool nevh__too_many(nevh__pace *, double length, double done,
                    char why[NEVH__WHY]);

/* As nevh__field_noise, of H or of K where time is transformed; a failure is
   recorded. */
int nevh__work_noise(nevh_work *, double t, const double q[], const double p[],
                     double noise_q[], double noise_p[]);

/* nevh_work_gradient, where only `used` points count: others fill vectors. */
int nevh__work_gradient_padded(nevh_work *, size_t used, const nevh__places *);

/* nevh__field_inner_gradient; a failure is recorded. */
int nevh__work_inner_gradient(nevh_work *, const nevh__places *);

/* Planned gradients of H.  How a kernel's rows hold them is decided here alone.

   The numbers of a row of so many points: whole vectors, which other points
   fill where they cost little; 0: the points do not fill vectors. */
size_t nevh__work_row(const nevh_work *, size_t points);
/* The lanes of rows of the work's orbits: 1, of one orbit alone, where `numbers`
   will do; whole vectors, over which one orbit is broadcast, or in which others
   repeat the first; 0: nothing can be planned, and nevh_work_gradient takes any
   width.  whole: dH/dq and dH/dp are taken together, else apart.  Says so in
   w->planned. */
size_t nevh__work_lanes(nevh_work *, bool whole, bool numbers);
/* True if gradients of so many orbits are taken as planned; `lanes` is
   nevh__work_lanes of all orbits. */
static inline bool nevh__work_as_planned(const nevh_work *w, size_t lanes,
                                         size_t columns) {
    return w->planned && lanes && columns == w->width;
}
/* The field's message becomes that of the step; returns its status. */
int nevh__work_fail_field(nevh_work *, int status);
/* A step for which the field must be prepared first. */
int nevh__work_step_ready(nevh_work *, double t, double h, double q[],
                          double p[]);
/* A step that failed without a message, again. */
int nevh__work_step_again(nevh_work *, double t, double h, double q[],
                          double p[]);
/* The kernel's step.  One with planned gradients, at which nothing looks, may
   fail without a message: it is taken again with nevh_work_gradient, which
   gives one. */
static inline int nevh__work_step(nevh_work *w, double t, double h, double q[],
                                  double p[]) {
    if (!nevh__field_at_hand(w->field))
        return nevh__work_step_ready(w, t, h, q, p);
    w->report->status = NEVH_OK;
    int status = w->integrator->kernel->step(w, t, h, q, p);
    return status && !w->report->status && w->planned
               ? nevh__work_step_again(w, t, h, q, p)
               : status;
}
/* A gradient at states that stay where they are: nevh__evaluation_plan, or none
   where time is transformed. */
nevh__evaluation nevh__work_plan(const nevh_work *, size_t lanes,
                                 const double t[], const double q[],
                                 const double p[], double dh_dq[],
                                 double dh_dp[]);

/* Runs it: an exact one looks at no result and counts nothing, others
   count values, and fail as nevh_work_gradient does. */
NEVH__INLINE int nevh__work_run_values(nevh_work *w,
                                       const nevh__evaluation *e) {
    int status = e->stencil ? nevh__central_stencil_run(e)
                            : nevh__field_terms(e->field, &e->at);
    return status ? nevh__work_fail_field(w, status) : NEVH_OK;
}
NEVH__INLINE int nevh__work_run(nevh_work *w, const nevh__evaluation *c) {
    if (!c->exact)
        return nevh__work_run_values(w, c);
    nevh__evaluation_run(c);
    return NEVH_OK;
}
NEVH__INLINE int nevh__work_run_points(nevh_work *w,
                                       const nevh__evaluation *c) {
    if (!c->exact)
        return nevh__work_run_values(w, c);
    nevh__evaluation_run_points(c);
    return NEVH_OK;
}

/* True if whole steps fill the span of a run of fixed steps; h is then adjusted to
   it. steps: all of them, or the whole ones before the rest. */
bool nevh__whole_steps(double span, double *h, double *steps);

#endif

/* nevh: the tools of a kernel.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "work/work_private.h"
#include "gradient/field_private.h"
#include "system/system_private.h"
#include "work/ledger_private.h"
#include "work/transform_private.h"
#include <math.h>

int nevh_work_fail(nevh_work *w, int status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    nevh__vfail(w->report, status, format, arguments);
    va_end(arguments);
    return status;
}

int nevh__fail_range(nevh_work *w, double t, double h) {
    return nevh_work_fail(w, NEVH_EDOM,
                          "the step from t = %.9g by h = %g leaves the range "
                          "of numbers: take a smaller one",
                          t, h);
}

int nevh__work_fail_field(nevh_work *w, int status) {
    return nevh_work_fail(w, status, "%s", nevh_field_message(w->field));
}

int nevh_work_find_scale(nevh_work *w) {
    int status =
        w->scale ? NEVH_OK : nevh__field_find_scale(w->field, w->options);
    if (status)
        return nevh__work_fail_field(w, status);
    w->scale = w->field->scale;
    return NEVH_OK;
}

size_t nevh__work_row(const nevh_work *w, size_t points) {
    size_t row = nevh__padded(points);
    if (w->transform)
        return 0; /* gradients are not those of H */
    if (w->field->gradient != nevh_exact && row != points)
        return 0; /* differences at points that do not count take as long */
    return row;
}

/* True if rows of so many lanes can be planned, at any addresses. */
static bool has_plan(const nevh_work *w, size_t lanes, bool whole) {
    double *at = w->field->slopes;
    nevh__evaluation q = nevh__work_plan(w, lanes, at, at, at, at, NULL);
    nevh__evaluation p = nevh__work_plan(w, lanes, at, at, at, NULL, at);
    nevh__evaluation both = nevh__work_plan(w, lanes, at, at, at, at, at);
    return whole ? both.count : q.count && p.count;
}

static size_t find_lanes(const nevh_work *w, bool whole, bool numbers) {
    size_t row = nevh__work_row(w, w->width);
    if (w->accounts)
        return 0; /* each gradient is accounted for in rows of the width */
    if (w->width > 1)
        return row && has_plan(w, row, whole) ? row : 0;
    if (numbers && has_plan(w, 1, whole))
        return 1;
    return w->field->broadcasts && has_plan(w, NEVH__LANES, whole) ? NEVH__LANES
                                                                   : 0;
}

size_t nevh__work_lanes(nevh_work *w, bool whole, bool numbers) {
    size_t lanes = find_lanes(w, whole, numbers);
    w->planned = lanes > 0;
    return lanes;
}

int nevh__work_step_ready(nevh_work *w, double t, double h, double q[],
                          double p[]) {
    return nevh__field_ready(w->field)
               ? nevh__work_fail_field(w, w->field->report.status)
               : nevh__work_step(w, t, h, q, p);
}

int nevh__work_step_again(nevh_work *w, double t, double h, double q[],
                          double p[]) {
    w->planned = false;
    int status = w->integrator->kernel->step(w, t, h, q, p);
    w->planned = true;
    return status;
}

nevh__evaluation nevh__work_plan(const nevh_work *w, size_t lanes,
                                 const double t[], const double q[],
                                 const double p[], double dh_dq[],
                                 double dh_dp[]) {
    if (w->transform)
        return (nevh__evaluation){0};
    return nevh__evaluation_plan(w->field, lanes, t, q, p, dh_dq, dh_dp);
}

int nevh_work_gradient(nevh_work *w, size_t points, const double t[],
                       const double q[], const double p[], double dh_dq[],
                       double dh_dp[]) {
    return nevh__work_gradient_padded(
        w, points, &(nevh__places){points, t, q, p, dh_dq, dh_dp});
}

int nevh__work_gradient_padded(nevh_work *w, size_t used,
                               const nevh__places *at) {
    int status = nevh__field_gradient_padded(w->field, used, at);
    if (status)
        return nevh__work_fail_field(w, status);
    return w->transform ? nevh__transform_gradient(w, at->width, at->t, at->q,
                                                   at->p, at->dh_dq, at->dh_dp)
                        : NEVH_OK;
}

int nevh__work_inner_gradient(nevh_work *w, const nevh__places *at) {
    int status = nevh__field_inner_gradient(w->field, at);
    return status ? nevh__work_fail_field(w, status) : NEVH_OK;
}

int nevh_work_value(nevh_work *w, size_t points, const double t[],
                    const double q[], const double p[], double h[]) {
    if (w->transform)
        return nevh__transform_value(w, points, t, q, p, h);
    int status = nevh_field_value(w->field, points, t, q, p, h);
    return status ? nevh__work_fail_field(w, status) : NEVH_OK;
}

int nevh_work_account(nevh_work *w, unsigned parts, double weight,
                      const double t[], const double q[], const double p[]) {
    int status =
        w->transform ? nevh__transform_pass(w, weight, t, q, p) : NEVH_OK;
    return status ? status : nevh__ledger_account(w, parts, weight, t, q, p);
}

int nevh__work_noise(nevh_work *w, double t, const double q[], const double p[],
                     double noise_q[], double noise_p[]) {
    int status = nevh__field_noise(w->field, t, q, p, noise_q, noise_p);
    if (status)
        return nevh__work_fail_field(w, status);
    return w->transform ? nevh__transform_noise(w, t, q, p, noise_q, noise_p)
                        : NEVH_OK;
}

/* The sum of x - x over the new values: 0 if all are finite, NaN otherwise. */
static double work_check(size_t count, const double y[], const double d[],
                         const double compensation[]) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double next = y[i] + (d[i] + compensation[i]);
        sum += next - next;
    }
    return sum;
}

/* The rounding error of d + compensation is dropped: it is below the last bit of
   the compensation.  The sum with y is exact in two parts, whichever is larger. */
static void work_add(size_t count, double y[], const double d[],
                     double compensation[]) {
    for (size_t i = 0; i < count; i++) {
        double x = d[i] + compensation[i], next = y[i] + x;
        compensation[i] = nevh__roundoff(next, y[i], x);
        y[i] = next;
    }
}

int nevh_work_commit(nevh_work *w, size_t count, double q[], const double dq[],
                     double compensation_q[], double p[], const double dp[],
                     double compensation_p[]) {
    if (work_check(count, q, dq, compensation_q) +
            work_check(count, p, dp, compensation_p) !=
        0)
        return nevh_work_fail(w, NEVH_EDOM,
                              "the new state is not a finite number: take a "
                              "smaller step");
    work_add(count, q, dq, compensation_q);
    work_add(count, p, dp, compensation_p);
    return NEVH_OK;
}

bool nevh__whole_steps(double span, double *h, double *steps) {
    static const double near = 1e-9; /* to a whole number, as a part of it */
    *steps = round(span / *h);
    if (span == 0)
        return true;
    if (*steps > 0 && fabs(span / *h - *steps) <= near * *steps) {
        *h = span / *steps;
        return true;
    }
    *steps = floor(span / *h);
    return false;
}

/* nevh: a coordinate or momentum found so that a formula has a value.

   The search walks away from where it begins, to both sides, in steps that grow,
   until the difference of the two sides changes its sign; false position then
   goes to rounding.  So the solution is the one that is met first, as a rule the
   nearest.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sweep_private.h"
#include <math.h>

enum { MOST_STEPS = 120, MOST_TRIALS = 200 };
static const double first_step = 1e-4, growth = 1.2; /* 1.2^120 = 3e9 */

typedef struct {
    const nevh__variant *variant;
    const nevh_quantity *sides;
    bool energy;
    double t, *q, *p, *x; /* x: in q or p */
} equation;

static double solve_difference(const equation *e, double at) {
    enum { LANES = NEVH__LANES };
    double t[LANES], h[LANES], energy = 0;
    size_t n = e->variant->model->n;
    double *q = e->variant->padded, *p = q + n * LANES;
    *e->x = at;
    for (size_t i = 0; i < LANES; i++)
        t[i] = e->t;
    for (size_t i = 0; i < n * LANES; i++) {
        q[i] = e->q[i / LANES];
        p[i] = e->p[i / LANES];
    }
    e->sides->value(e->sides->data, LANES, t, q, p, NULL, h);
    if (!e->energy)
        return h[0];
    int status =
        nevh_field_value(e->variant->energy, 1, t, e->q, e->p, &energy);
    return status ? NAN : energy - h[0];
}

/* Between a and b, where the differences have other signs: by the rule of false
   position with halves (Illinois), which always encloses. */
static double solve_enclose(const equation *e, double a, double at_a, double b,
                            double at_b) {
    for (int i = 0; i < MOST_TRIALS && at_b != 0; i++) {
        double x = b - at_b * (b - a) / (at_b - at_a);
        if (!(x > fmin(a, b) && x < fmax(a, b)) || i % 8 == 7)
            x = a + (b - a) / 2;
        if (x == a || x == b)
            break;
        double y = solve_difference(e, x);
        if (isnan(y))
            return NAN;
        if ((y > 0) != (at_b > 0)) {
            a = b;
            at_a = at_b;
        } else {
            at_a /= 2;
        }
        b = x;
        at_b = y;
    }
    return b;
}

bool nevh__variant_solve(const nevh_sweep *s, const nevh__variant *x, size_t i,
                         double q[], double p[]) {
    const nevh__varied *v = &s->ensemble->varied[i];
    double *to = v->is == NEVH__MOMENTUM ? &p[v->index] : &q[v->index];
    equation e = {x, &x->sides[i], v->energy, x->model->run.t_start, q, p, to};
    double begin = v->a, step = first_step * fmax(fabs(begin), 1);
    double at[2] = {begin, begin}, value[2];
    value[0] = value[1] = solve_difference(&e, begin);
    if (value[0] == 0)
        return true;
    for (int k = 0; k < MOST_STEPS; k++, step *= growth)
        for (int side = 0; side < 2; side++) {
            double to_there = begin + (side ? -step : step);
            double there = solve_difference(&e, to_there);
            if (!isnan(there) && !isnan(value[side]) &&
                (there > 0) != (value[side] > 0)) {
                double found =
                    solve_enclose(&e, at[side], value[side], to_there, there);
                double left = solve_difference(&e, found);
                return isfinite(left) &&
                       fabs(left) <= fabs(there - value[side]);
            }
            at[side] = to_there;
            value[side] = there;
        }
    return false;
}

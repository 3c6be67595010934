/* nevh: the outcome first(A > B): when a condition holds for the first time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"
#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_TRIALS = 100, MOST_DIGS = 12 };
static const double certain = 4 * DBL_EPSILON; /* part of a step */
static const double doubt = 3;     /* factor on what a parabola's turn adds */
static const double inside = 1e-6; /* turns keep off the ends by that part */

/* A step from a snapshot, at the parts of which the quantity is asked for. */
typedef struct {
    nevh_ensemble *e;
    const nevh__snapshot *from;
    size_t lane, outcome;
    double a, at_a, b, at_b; /* parts, and values there */
    double ratio;            /* of the last two steps' lengths */
    double t;                /* after the last one tried */
    nevh__report failed;
} search;

static double first_sample(search *s, double part) {
    nevh_ensemble *e = s->e;
    const nevh__snapshot *from = s->from;
    nevh__lane_to_narrow(e, from->q, from->p, from->memory, s->lane);
    double t = from->t[s->lane], h = from->h[s->lane];
    if (nevh__narrow_step(e, t, part * h)) {
        s->failed = e->narrow->report;
        return NAN;
    }
    s->t = e->narrow->last_t;
    return nevh__narrow_value(e, s->outcome, s->t);
}

/* Finite whatever happens, since GSL aborts otherwise; the ends are known. */
static double first_height(double part, void *data) {
    search *s = data;
    if (part == s->a || s->failed.status)
        return s->at_a;
    if (part == s->b)
        return s->at_b;
    double value = first_sample(s, part);
    return isfinite(value) ? value : s->at_a;
}

/* Between part a, where the value is not above 0, and b, where it is. */
static double first_find(search *s) {
    gsl_root_fsolver *root = s->e->root;
    gsl_function f = {first_height, s};
    if (!(s->at_a <= 0) || !isfinite(s->at_a))
        s->at_a = -1; /* it was not a number: only its side counts */
    if (!isfinite(s->at_b))
        s->at_b = 1;
    double part = s->b;
    int status = s->at_a == 0 ? 1 : gsl_root_fsolver_set(root, &f, s->a, s->b);
    if (s->at_a == 0)
        part = s->a;
    for (int i = 0; !status && !s->failed.status && i < MOST_TRIALS; i++) {
        status = gsl_root_fsolver_iterate(root);
        part = gsl_root_fsolver_root(root);
        if (gsl_root_fsolver_x_upper(root) - gsl_root_fsolver_x_lower(root) <=
            certain)
            break;
    }
    if (part == 0)
        return s->from->t[s->lane];
    first_sample(s, part);
    return s->t;
}

static double result(search *s, double t) {
    if (!s->failed.status)
        return t;
    nevh__ensemble_fail(s->e, s->lane, &s->failed);
    return NAN;
}

/* The time at which the value first is above 0 between the snapshot and `until`, a
   part of the step from it, where it is above 0. */
static double first_locate(nevh_ensemble *e, const nevh__snapshot *from,
                           size_t lane, size_t o, double until,
                           double value_until) {
    search s = {.e = e, .from = from, .lane = lane, .outcome = o};
    s.at_a = from->value[o * e->stride + lane];
    s.b = until;
    s.at_b = value_until;
    return result(&s, first_find(&s));
}

/* The maximum of the parabola through three points, and its place; false if it has
   none. */
static bool first_turn(const double t[3], const double g[3], double *at,
                       double *most) {
    double left = t[1] - t[0], right = t[2] - t[1];
    double up = (g[1] - g[0]) / left, down = (g[2] - g[1]) / right;
    double curve = (down - up) / (left + right);
    double slope = (up * right + down * left) / (left + right);
    if (!(curve < 0))
        return false;
    *at = t[1] - slope / (2 * curve);
    *most = g[1] - slope * slope / (4 * curve);
    return *at > t[0] && *at < t[2];
}

/* A time in units of the first of the two steps, as a part of the one that it
   is in, whose snapshot is s->from. */
static double part_of(search *s, double at) {
    s->from = at < 1 ? &s->e->ago2 : &s->e->ago1;
    return at < 1 ? at : (at - 1) / s->ratio;
}

/* Goes up to the maximum, or until the value is above 0. */
static bool find_maximum(search *s, double t[3], double g[3], double *at,
                         double *value) {
    for (int i = 0; i < MOST_DIGS; i++) {
        double top;
        if (!first_turn(t, g, at, &top) || !(g[1] + doubt * (top - g[1]) > 0))
            return false;
        *at = fmin(fmax(*at, t[0] + inside), t[2] - inside);
        if (fabs(*at - t[1]) < inside)
            *at = t[1] + (t[2] - t[1] > t[1] - t[0] ? inside : -inside);
        *value = first_sample(s, part_of(s, *at));
        if (s->failed.status || !isfinite(*value) || *value > 0)
            return !s->failed.status && *value > 0;
        size_t end = (*at > t[1]) == (*value > g[1]) ? 0 : 2;
        double *side_t = &t[end], *side_g = &g[end];
        if (*value > g[1]) { /* the new middle; the old one is an end */
            *side_t = t[1];
            *side_g = g[1];
            t[1] = *at;
            g[1] = *value;
        } else {
            *side_t = *at;
            *side_g = *value;
        }
    }
    return false;
}

/* True if the second of three values, the times between which have that ratio, may be
   beside a maximum above 0. */
static bool may_graze(const double g[3], double ratio) {
    double t[3] = {0, 1, 1 + ratio}, at, top;
    return g[1] >= g[0] && g[1] >= g[2] && g[0] > -INFINITY &&
           g[2] > -INFINITY && first_turn(t, g, &at, &top) &&
           g[1] + doubt * (top - g[1]) > 0;
}

/* The time at which it first is between the last three states, none of which is
   above 0; NAN where it is not, as far as parabolas tell. */
static double graze(nevh_ensemble *e, size_t lane, size_t o) {
    size_t i = o * e->stride + lane;
    double g[3] = {e->ago2.value[i], e->ago1.value[i], e->now.value[i]};
    double ratio = e->ago1.h[lane] / e->ago2.h[lane];
    if (!may_graze(g, ratio))
        return NAN;
    double t[3] = {0, 1, 1 + ratio}, at, value;
    search s = {.e = e, .lane = lane, .outcome = o, .ratio = ratio};
    if (!find_maximum(&s, t, g, &at, &value)) {
        result(&s, NAN);
        return NAN;
    }
    double part = part_of(&s, at);
    return first_locate(e, s.from, lane, o, part, value);
}

static void first_begin(const nevh__observation *at, void *record) {
    *(double *)record = at->value > 0 ? at->t : NAN;
}

static bool known(const void *record) {
    return !isnan(*(const double *)record);
}

static void step(const nevh__observation *at, void *record) {
    nevh_ensemble *e = at->ensemble;
    if (known(record) || at->count > 1)
        return;
    if (at->value > 0)
        *(double *)record =
            first_locate(e, &e->ago1, at->lane, at->outcome, 1, at->value);
    else if (at->step > 1)
        *(double *)record = graze(e, at->lane, at->outcome);
}

/* Until its value is above 0, or may have been between steps. */
static size_t quiet(const nevh__observation *at, const void *record) {
    double a = at->value_earlier, b = at->value_before;
    size_t i = known(record) ? at->count : 0;
    for (; i < at->count; i++) {
        double c = nevh__observed(at, i);
        bool turns = b >= a && b >= c && nevh__observed_step(at, i) > 1;
        if (c > 0 || (turns && may_graze((const double[]){a, b, c}, 1)))
            break;
        a = b;
        b = c;
    }
    return i;
}

static void first_end(const nevh__observation *at, const void *record,
                      double result[]) {
    (void)at;
    *result = *(const double *)record;
}

const nevh__outcome_type nevh__outcome_first = {
    .info = {.name = "first",
             .takes = NEVH_OUTCOME_TAKES_CONDITION,
             .unit = NEVH_UNIT_TIME,
             .help = "the first time at which a condition holds"},
    .branches = true,
    .size = sizeof(double),
    .begin = first_begin,
    .step = step,
    .quiet = quiet,
    .known = known,
    .end = first_end,
};

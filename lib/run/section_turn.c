/* nevh: where a section's value turns within a step.

   A cubic with the values and slopes at both ends (Hermite's) tells where to
   look; what counts is found by shorter steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/section_private.h"
#include <gsl/gsl_poly.h>
#include <math.h>

enum { MOST_NARROWINGS = 14, MOST_TRIALS = 40 };
static const double beyond = 0.1;  /* the model's turns this far off count */
static const double inside = 0.02; /* first guesses keep off the ends */
static const double doubt = 3;     /* factor on what a turn adds to the range */
static const double slack = 1e-3;  /* of the range */
static const double narrow = 1e-9; /* part of a step: rounding, in a minimum */

typedef struct {
    double a, b, c, d; /* a s^3 + b s^2 + c s + d */
} cubic;

static cubic model_of(const nevh_sections *x, const nevh__track *k) {
    double span = x->t_after - x->t, change = k->value_after - k->value;
    double c = k->slope * span, end = k->slope_after * span;
    return (cubic){c + end - 2 * change, 3 * change - 2 * c - end, c, k->value};
}

static double at(const cubic *m, double s) {
    return ((m->a * s + m->b) * s + m->c) * s + m->d;
}

static bool level_within(const nevh__track *k, double low, double high) {
    if (k->is.period == 0)
        return low <= 0 && 0 <= high;
    return nevh__section_index(k, high) * k->is.period >= low;
}

/* Whether there is a level that the value, which turns near `turn` instead of
   going straight, may pass. */
static bool matters(const nevh__track *k, double turn) {
    double low = fmin(k->value, k->value_after);
    double high = fmax(k->value, k->value_after);
    double more = slack * (high - low);
    double top = turn >= high ? turn + doubt * (turn - high) + more : high;
    double bottom = turn <= low ? turn - doubt * (low - turn) - more : low;
    return level_within(k, bottom, top);
}

typedef struct {
    nevh_sections *x;
    nevh__track *k;
    double sign; /* times the value has a minimum */
    nevh__node low, least, high;
} dip;

static bool same_side(const dip *d, double value) {
    return nevh__section_index(d->k, value) ==
           nevh__section_index(d->k, d->least.value);
}

/* Where the minimum is next to an end, closes in on it until there is a point
   below both ends, or beyond the level. */
static int enclose(dip *d) {
    nevh__node *low = &d->low, *least = &d->least, *high = &d->high;
    for (int i = 0; i < MOST_NARROWINGS; i++) {
        double below = d->sign * (low->value - least->value);
        double above = d->sign * (high->value - least->value);
        if ((below > 0 && above > 0) || (below <= 0 && above <= 0))
            return NEVH_OK;
        nevh__node *end = below > 0 ? high : low;
        nevh__node next = {least->s + 0.75 * (end->s - least->s), 0};
        if (nevh__section_sample(d->x, d->k, next.s, &next.value))
            return d->x->report.status;
        *(below > 0 ? low : high) = *least;
        bool through = !same_side(d, next.value);
        *least = next;
        if (through)
            return NEVH_OK;
    }
    return NEVH_OK;
}

static double height(double s, void *data) {
    dip *d = data;
    double value;
    if (d->x->report.status || nevh__section_sample(d->x, d->k, s, &value))
        return d->sign * d->least.value;
    return d->sign * value;
}

/* Goes down until the level is passed, or to the minimum. */
static int descend(dip *d) {
    gsl_min_fminimizer *m = d->x->least;
    gsl_function f = {height, d};
    if (!(d->sign * d->least.value < d->sign * d->low.value &&
          d->sign * d->least.value < d->sign * d->high.value))
        return NEVH_OK;
    int status = gsl_min_fminimizer_set_with_values(
        m, &f, d->least.s, d->sign * d->least.value, d->low.s,
        d->sign * d->low.value, d->high.s, d->sign * d->high.value);
    for (int i = 0; !status && !d->x->report.status && i < MOST_TRIALS; i++) {
        status = gsl_min_fminimizer_iterate(m);
        double lowest = d->sign * gsl_min_fminimizer_f_minimum(m);
        bool through = !same_side(d, lowest);
        d->least = (nevh__node){gsl_min_fminimizer_x_minimum(m), lowest};
        if (through ||
            gsl_min_fminimizer_x_upper(m) - gsl_min_fminimizer_x_lower(m) <=
                narrow)
            break;
    }
    return d->x->report.status;
}

/* Moves the node to where the value turns, if all about it are on one side. */
static int dig(nevh_sections *x, nevh__track *k, size_t i, double sign) {
    dip d = {x, k, sign, k->nodes[i - 1], k->nodes[i], k->nodes[i + 1]};
    if (!same_side(&d, d.low.value) || !same_side(&d, d.high.value))
        return NEVH_OK;
    nevh__node before = d.least;
    int status = enclose(&d);
    if (!status && same_side(&d, before.value))
        status = descend(&d);
    k->nodes[i] = d.least;
    return status;
}

/* Puts a node where the model turns. */
static int add_node(nevh_sections *x, nevh__track *k, double s) {
    nevh__node node = {fmin(fmax(s, inside), 1 - inside), 0};
    if (node.s <= k->nodes[k->n_nodes - 1].s)
        return NEVH_OK;
    int status = nevh__section_sample(x, k, node.s, &node.value);
    if (!status)
        k->nodes[k->n_nodes++] = node;
    return status;
}

int nevh__section_nodes(nevh_sections *x, nevh__track *k) {
    cubic m = model_of(x, k);
    double turn[2], sign[NEVH__MOST_NODES];
    int status = NEVH_OK, turns = 0;
    k->nodes[0] = (nevh__node){0, k->value};
    k->n_nodes = 1;
    if (isfinite(m.a) && isfinite(m.b) && isfinite(m.c))
        turns =
            gsl_poly_solve_quadratic(3 * m.a, 2 * m.b, m.c, &turn[0], &turn[1]);
    for (int i = 0; !status && i < turns; i++)
        if (turn[i] >= -beyond && turn[i] <= 1 + beyond &&
            matters(k, at(&m, fmin(fmax(turn[i], 0), 1)))) {
            sign[k->n_nodes] = 6 * m.a * turn[i] + 2 * m.b < 0 ? -1 : 1;
            status = add_node(x, k, turn[i]);
        }
    k->nodes[k->n_nodes++] = (nevh__node){1, k->value_after};
    for (size_t i = 1; !status && i + 1 < k->n_nodes; i++)
        status = dig(x, k, i, sign[i]);
    return status;
}

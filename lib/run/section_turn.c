/* nevh: where a section's value turns within a step.

   A cubic with the values and slopes at both ends (Hermite's) tells where to
   look; what counts is found by shorter steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/section_private.h"
#include <gsl/gsl_poly.h>
#include <math.h>

enum { MOST_TRIALS = 40 };
/* The slope of a straight line between the ends times this much, at both ends:
   the value does not turn (it cannot from 0 to 3, for a cubic). */
static const double least_slope = 0.5, most_slope = 2;
static const double beyond = 0.1;  /* the model's turns this far off count */
static const double doubt = 3;     /* factor on what a turn adds to the range */
static const double inside = 0.02; /* first guesses keep off the ends */
static const double close = 1e-6;  /* to an end, */
static const double behind = 1e-4; /* for a slope, */
static const double narrow = 1e-9; /* rounding in a minimum: parts of a step */

typedef struct {
    double a, b, c, d; /* a s^3 + b s^2 + c s + d */
} cubic;

static cubic model_of(double begin, double end, double slope_at_begin,
                      double slope_at_end) {
    double change = end - begin;
    return (cubic){slope_at_begin + slope_at_end - 2 * change,
                   3 * change - 2 * slope_at_begin - slope_at_end,
                   slope_at_begin, begin};
}

static double section_turn_at(const cubic *m, double s) {
    return ((m->a * s + m->b) * s + m->c) * s + m->d;
}

static bool level_within(const nevh__section_state *k, double low,
                         double high) {
    if (k->decl.period == 0)
        return low <= 0 && 0 <= high;
    return nevh__section_index(k, high) * k->decl.period >= low;
}

/* True if the value, which turns near `turn`, may pass a level that a straight line
   would not. */
static bool matters(const nevh__section_state *k, double turn) {
    double low = fmin(k->value, k->value_after);
    double high = fmax(k->value, k->value_after);
    double top = turn >= high ? turn + doubt * (turn - high) : high;
    double bottom = turn <= low ? turn - doubt * (low - turn) : low;
    return level_within(k, bottom, top);
}

/* True if the flow at both ends lets the value turn near a level. */
static bool may_turn(const nevh__section_state *k, double begin, double end) {
    double change = k->value_after - k->value;
    double reach = (fabs(begin) + fabs(end)) / 4;
    double low = fmin(k->value, k->value_after) - reach;
    double high = fmax(k->value, k->value_after) + reach;
    bool straight = begin / change > least_slope &&
                    begin / change < most_slope && end / change > least_slope &&
                    end / change < most_slope;
    return !straight && level_within(k, low, high);
}

typedef struct {
    nevh_sections *x;
    nevh__section_state *k;
    double sign; /* times the value has a minimum */
    nevh__section_node low, least, high;
} dip;

static bool same_side(const dip *d, double value) {
    return nevh__section_index(d->k, value) ==
           nevh__section_index(d->k, d->least.value);
}

/* Makes `least` smaller than both neighbours: if the minimum is next to an end, by
   a point very close to that end.  Otherwise there is no minimum. */
static int section_turn_enclose(dip *d) {
    double below = d->sign * (d->low.value - d->least.value);
    double above = d->sign * (d->high.value - d->least.value);
    if ((below > 0) == (above > 0))
        return NEVH_OK;
    nevh__section_node end = below > 0 ? d->high : d->low;
    nevh__section_node next = {end.s + (below > 0 ? -close : close), 0};
    *(below > 0 ? &d->low : &d->high) = d->least;
    d->least = next;
    return nevh__section_sample(d->x, d->k, next.s, &d->least.value);
}

static double section_turn_height(double s, void *data) {
    dip *d = data;
    double value;
    if (d->x->report.status || nevh__section_sample(d->x, d->k, s, &value))
        return d->sign * d->least.value;
    return d->sign * value;
}

/* Goes down until the level is passed, or to the minimum. */
static int descend(dip *d) {
    gsl_min_fminimizer *m = d->x->least;
    gsl_function f = {section_turn_height, d};
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
        d->least =
            (nevh__section_node){gsl_min_fminimizer_x_minimum(m), lowest};
        if (through ||
            gsl_min_fminimizer_x_upper(m) - gsl_min_fminimizer_x_lower(m) <=
                narrow)
            break;
    }
    return d->x->report.status;
}

/* Moves the node to where the value turns, if all about it are on one side. */
static int dig(nevh_sections *x, nevh__section_state *k, size_t i,
               double sign) {
    dip d = {x, k, sign, k->nodes[i - 1], k->nodes[i], k->nodes[i + 1]};
    if (!same_side(&d, d.low.value) || !same_side(&d, d.high.value))
        return NEVH_OK;
    double before = d.least.value;
    int status = section_turn_enclose(&d);
    if (!status && same_side(&d, before))
        status = descend(&d);
    k->nodes[i] = d.least;
    return status;
}

/* Puts a node where the model turns. */
static int add_node(nevh_sections *x, nevh__section_state *k, double s) {
    nevh__section_node node = {fmin(fmax(s, inside), 1 - inside), 0};
    if (node.s <= k->nodes[k->n_nodes - 1].s)
        return NEVH_OK;
    int status = nevh__section_sample(x, k, node.s, &node.value);
    if (!status)
        k->nodes[k->n_nodes++] = node;
    return status;
}

/* Nodes within the step, and what makes each a minimum. */
static int add_nodes(nevh_sections *x, nevh__section_state *k, const cubic *m,
                     double sign[]) {
    double turn[2];
    int status = NEVH_OK;
    int turns =
        gsl_poly_solve_quadratic(3 * m->a, 2 * m->b, m->c, &turn[0], &turn[1]);
    for (int i = 0; !status && i < turns; i++)
        if (turn[i] >= -beyond && turn[i] <= 1 + beyond &&
            matters(k, section_turn_at(m, fmin(fmax(turn[i], 0), 1)))) {
            sign[k->n_nodes] = 6 * m->a * turn[i] + 2 * m->b < 0 ? -1 : 1;
            status = add_node(x, k, turn[i]);
        }
    return status;
}

/* At its end the step's own slope is taken: the flow's is that of the next
   step, from which it differs by the scheme's error. */
static int look_for_turns(nevh_sections *x, nevh__section_state *k,
                          double begin) {
    double sign[NEVH__MOST_NODES], before;
    int status = nevh__section_sample(x, k, 1 - behind, &before);
    if (status)
        return status;
    cubic m = model_of(k->value, k->value_after, begin,
                       (k->value_after - before) / behind);
    status = add_nodes(x, k, &m, sign);
    k->nodes[k->n_nodes++] = (nevh__section_node){1, k->value_after};
    for (size_t i = 1; !status && i + 1 < k->n_nodes; i++)
        status = dig(x, k, i, sign[i]);
    return status;
}

bool nevh__section_near(const nevh_sections *x, const nevh__section_state *k) {
    double span = x->t_after - x->t;
    double begin = k->slope * span, end = k->slope_after * span;
    double low = fmin(k->value, k->value_after);
    double high = fmax(k->value, k->value_after);
    return level_within(k, low, high) ||
           (isfinite(begin) && isfinite(end) && may_turn(k, begin, end));
}

int nevh__section_nodes(nevh_sections *x, nevh__section_state *k) {
    double span = x->t_after - x->t;
    double begin = k->slope * span, end = k->slope_after * span;
    k->nodes[0] = (nevh__section_node){0, k->value};
    k->n_nodes = 1;
    if (isfinite(begin) && isfinite(end) && may_turn(k, begin, end))
        return look_for_turns(x, k, begin);
    k->nodes[k->n_nodes++] = (nevh__section_node){1, k->value_after};
    return NEVH_OK;
}

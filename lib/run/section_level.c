/* nevh: which levels a section's value passes within a step, in order.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/section_private.h"
#include <float.h>
#include <math.h>

static const double most_levels = 1e4; /* within one step */
/* Part of the first step within which a point is the start, to rounding. */
static const double at_start = 1e-10;
static const double met = 1e-9; /* part of a step */

double nevh__section_index(const nevh__section_state *k, double value) {
    double period = k->decl.period;
    if (period == 0)
        return value >= 0 ? 0 : -1;
    double index = floor(value / period);
    if (index * period > value)
        return index - 1;
    return (index + 1) * period <= value ? index + 1 : index;
}

static bool on_level(const nevh__section_state *k, double value) {
    return value == nevh__section_index(k, value) * k->decl.period;
}

static int sign_of(double x) {
    return (x > 0) - (x < 0);
}

/* Finds the levels of the next piece.  One at its beginning counts when the
   value came from the other side; one at its end is left for later, but at the
   end of the step where the slope tells that the value will go on. */
static int open_piece(nevh_sections *x, nevh__section_state *k) {
    nevh__section_node a = k->nodes[k->piece], b = k->nodes[k->piece + 1];
    double from = nevh__section_index(k, a.value);
    double to = nevh__section_index(k, b.value);
    bool on_a = on_level(k, a.value), on_b = on_level(k, b.value);
    int way = sign_of(b.value - a.value);
    bool take_a = on_a && k->came == -way;
    bool take_b = on_b && b.s == 1 && sign_of(k->slope_after * x->h) == way;
    bool skip_a = on_a && !take_a, skip_b = on_b && !take_b;
    double last;
    k->opened = true;
    k->way = way;
    k->left = 0;
    if (way == 0)
        return NEVH_OK;
    if (way > 0) {
        k->level = take_a ? from : from + 1;
        last = skip_b ? to - 1 : to;
    } else {
        k->level = skip_a ? from - 1 : from;
        last = take_b ? to : to + 1;
    }
    k->left = fmax((last - k->level) * way + 1, 0);
    k->came = skip_b ? -way : 0;
    if (k->left <= most_levels)
        return NEVH_OK;
    return nevh__fail(&x->report, NEVH_EFAILED,
                      "a section's value passes %g periods within one step: "
                      "take a smaller one",
                      k->left);
}

/* The point at the next level of the open piece. */
static int section_level_locate(nevh_sections *x, nevh__section_state *k) {
    nevh__section_node a = k->nodes[k->piece], b = k->nodes[k->piece + 1];
    double level = k->level * k->decl.period;
    int status;
    if (a.value == level)
        status = nevh__section_take(x, k, a.s * x->h);
    else if (b.value == level)
        status = nevh__section_take(x, k, b.s * x->h);
    else
        status = nevh__section_search(x, k, a, b, level);
    if (x->first && k->s <= at_start)
        k->found = false;
    return status;
}

static int next_crossing(nevh_sections *x, nevh__section_state *k) {
    int status = NEVH_OK, forward = x->h < 0 ? -1 : 1;
    while (!status && !k->found && k->piece + 1 < k->n_nodes) {
        if (!k->opened)
            status = open_piece(x, k);
        k->direction = k->way * forward;
        if (!status && k->left > 0) {
            if (k->decl.direction != -k->direction)
                status = section_level_locate(x, k);
            k->level += k->way;
            k->left--;
        } else {
            k->piece++;
            k->opened = false;
        }
    }
    return status;
}

/* A time that is due, but not met by a step, is met by a shorter one; where the
   scheme chooses the times, that one is searched for. */
static int meet(nevh_sections *x, nevh__section_state *k, double due) {
    nevh__section_node a = {0, x->t - due}, b = {1, x->t_after - due};
    if (!x->branch->own_time)
        return nevh__section_take(x, k, due - x->t);
    int status = nevh__section_search(x, k, a, b, 0);
    if (status || fabs(k->t - due) <= met * fabs(b.value - a.value))
        return status;
    return nevh__fail(&x->report, NEVH_EMAXITER,
                      "no part of the step of %g from t = %.9g ends at %.9g: "
                      "take a smaller one",
                      x->h, x->t, due);
}

static int next_strobe(nevh_sections *x, nevh__section_state *k) {
    double due = nevh__section_due(x, k), forward = x->h < 0 ? -1 : 1;
    double near = 8 * DBL_EPSILON * (fabs(x->t_after) + fabs(x->origin));
    double past = (x->t_after - due) * forward;
    if (past < -near)
        return NEVH_OK;
    int status =
        past <= near ? nevh__section_take(x, k, x->h) : meet(x, k, due);
    k->t = due;
    k->direction = 0;
    k->points++;
    return status;
}

int nevh__section_next(nevh_sections *x, nevh__section_state *k) {
    k->found = false;
    return k->decl.value ? next_crossing(x, k) : next_strobe(x, k);
}

/* nevh: a panel of a loop: what becomes of it, and the area under it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/loop_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    TAIL = 3, /* coefficients whose size tells the error */
    HALF = NEVH__NODES / 2
};
static const double tolerance = 1e-11; /* of a panel, of the area's unit */

void nevh__loop_expand(const nevh_loop *l, const double value[], double from,
                       double coefficient[]) {
    for (int k = 0; k < NEVH__NODES; k++) {
        coefficient[k] = 0;
        for (int j = 0; j < NEVH__NODES; j++)
            coefficient[k] += l->legendre[k][j] * (value[j] - from);
    }
}

static double loop_panel_largest(const double coefficient[], int from, int to) {
    double most = 0;
    for (int k = from; k < to; k++)
        most = fmax(most, fabs(coefficient[k]));
    return most;
}

/* Coefficients that fell to a level, far below the first ones, and fall no more:
   noise, of rounding or of differences, which no shorter panel has less of. */
static bool is_noise(const double coefficient[]) {
    static const double little = 1e-5, same = 0.1;
    double level =
        loop_panel_largest(coefficient, NEVH__NODES - TAIL, NEVH__NODES);
    return level <= little * loop_panel_largest(coefficient, 1, NEVH__NODES) &&
           level >= same * loop_panel_largest(coefficient,
                                              NEVH__NODES - 2 * TAIL,
                                              NEVH__NODES - TAIL);
}

/* Leaves out what is noise at the end. */
static int loop_panel_length_of(const double coefficient[]) {
    double level =
        2 * loop_panel_largest(coefficient, NEVH__NODES - TAIL, NEVH__NODES);
    int length = NEVH__NODES;
    while (length > 2 && fabs(coefficient[length - 1]) <= level)
        length--;
    return length;
}

/* The integral of q dp of two series: that of P_a P_b' is 2 where b - a is odd
   and positive, else 0. */
static double loop_panel_product(const double a[], int na, const double b[],
                                 int nb) {
    double sum = 0;
    for (int j = 1; j < nb; j++)
        for (int i = j - 1; i >= 0; i -= 2)
            sum += i < na ? 2 * a[i] * b[j] : 0;
    return sum;
}

/* The errors of the integral that come from those of the series, of levels `of_a` and
   `of_b`, through coefficients from `first` on. */
static double carried_by(double of_a, double of_b, const double a[],
                         const double b[], int first) {
    double sum_a = 0, sum_b = 0;
    for (int k = first; k < NEVH__NODES; k++) {
        sum_a += fabs(a[k]);
        sum_b += fabs(b[k]);
    }
    return 2 * (of_a * sum_b + of_b * sum_a);
}

/* The panel's integral of one q dp, and its errors.  Nodes include the ends, so that
   the series of neighbours meet, and sums over the nodes are exact to degree
   2 NEVH__NODES - 3: what a series leaves out meets only the upper half of the
   other one. */
static void loop_panel_add(nevh_loop *l, size_t time, size_t k) {
    double a[NEVH__NODES], b[NEVH__NODES];
    const double *level = l->level + (time * l->n + k) * 2;
    nevh__loop_expand(l, l->q + k * NEVH__NODES, l->centre[time * l->n + k], a);
    nevh__loop_expand(l, l->p + k * NEVH__NODES, 0, b);
    double of_a = loop_panel_largest(a, NEVH__NODES - TAIL, NEVH__NODES);
    double of_b = loop_panel_largest(b, NEVH__NODES - TAIL, NEVH__NODES);
    if (is_noise(a) && is_noise(b)) {
        l->taken_area[time] += loop_panel_product(a, loop_panel_length_of(a), b,
                                                  loop_panel_length_of(b));
        l->taken_noise[time] += carried_by(of_a, of_b, a, b, 1);
        return;
    }
    l->taken_area[time] += loop_panel_product(a, NEVH__NODES, b, NEVH__NODES);
    l->taken_error[time] += carried_by(of_a, of_b, a, b, HALF);
    l->taken_noise[time] +=
        carried_by(fmin(of_a, level[0]), fmin(of_b, level[1]), a, b, 1);
}

/* The panel as it is. */
static void loop_panel_integrate(nevh_loop *l, size_t time) {
    l->taken_area[time] = l->taken_error[time] = l->taken_noise[time] = 0;
    for (size_t k = 0; k < l->n; k++)
        loop_panel_add(l, time, k);
}

bool nevh__loop_listen(nevh_loop *l, size_t time) {
    static const double margin = 4;
    for (size_t i = 0; i < 2 * l->n; i++) {
        double c[NEVH__NODES], *level = l->level + time * 2 * l->n + i;
        const double *from = (i % 2 ? l->p : l->q) + i / 2 * NEVH__NODES;
        nevh__loop_expand(l, from, from[0], c);
        *level =
            fmax(*level, margin * loop_panel_largest(c, HALF, NEVH__NODES));
    }
    return true;
}

int nevh__loop_place(nevh_loop *l, const nevh__panel *at) {
    double s[NEVH__NODES];
    for (int j = 0; j < NEVH__NODES; j++) {
        s[j] = at->from + (at->to - at->from) * (l->node[j] + 1) / 2;
        s[j] = s[j] >= 1 ? s[j] - 1 : s[j];
    }
    return l->options.curve(l->options.data, NEVH__NODES, s, l->q, l->p)
               ? nevh__fail(&l->report, NEVH_EFAILED,
                            "the curve of starts ended the run")
               : NEVH_OK;
}

static int loop_panel_advance(nevh_loop *l, size_t time) {
    size_t from = time ? l->steps[time - 1] : 0;
    if (l->steps[time] == from)
        return NEVH_OK;
    return nevh_run(l->stepper, l->options.t0 + (double)from * l->options.h,
                    l->options.h, l->steps[time] - from, l->q, l->p, NULL, 0);
}

/* From then on there is no area. */
static void end_at(nevh_loop *l, size_t time, int status) {
    double t = l->options.t0 + (double)l->steps[time] * l->options.h;
    l->reach = time;
    nevh__fail(&l->report, status,
               "a point of the curve failed before t = %g: %s", t,
               nevh_stepper_message(l->stepper));
}

static int loop_panel_begin(nevh_loop *l, nevh__panel *at) {
    size_t size = l->n * NEVH__NODES;
    if (l->keeps && !at->states)
        at->states = nevh__array(2 * size * l->options.times, sizeof(double));
    if (l->keeps && !at->states)
        return nevh__no_memory(&l->report);
    at->kept = 0;
    nevh_stepper_reset(l->stepper);
    return nevh__loop_place(l, at);
}

/* Stores the states of the nodes, or restores them. */
static void loop_panel_copy(nevh_loop *l, nevh__panel *at, size_t time,
                            bool stored) {
    size_t size = l->n * NEVH__NODES;
    double *q = at->states + 2 * size * time, *p = q + size;
    memcpy(stored ? l->q : q, stored ? q : l->q, size * sizeof(double));
    memcpy(stored ? l->p : p, stored ? p : l->p, size * sizeof(double));
}

/* Calls `look` after each of the times, as long as it says so.  Returns a status
   that ends all. */
int nevh__loop_follow(nevh_loop *l, nevh__panel *at, nevh__loop_look look) {
    bool stored = at->kept >= l->reach;
    int status = stored ? NEVH_OK : loop_panel_begin(l, at);
    if (status)
        return status;
    for (size_t i = 0; i < l->reach; i++) {
        status = stored ? NEVH_OK : loop_panel_advance(l, i);
        if (status) {
            end_at(l, i, status);
            break;
        }
        if (at->states) {
            loop_panel_copy(l, at, i, stored);
            at->kept = stored ? at->kept : i + 1;
        }
        if (!look(l, i))
            break;
    }
    return NEVH_OK;
}

static void loop_panel_widen(double *low, double *high, double x) {
    *low = fmin(*low, x);
    *high = fmax(*high, x);
}

/* Measures the extent of the curve. */
bool nevh__loop_measure(nevh_loop *l, size_t time) {
    for (size_t k = 0; k < l->n; k++)
        for (size_t j = 0; j < NEVH__NODES; j++) {
            size_t i = (time * l->n + k) * 2;
            loop_panel_widen(&l->low[i], &l->high[i],
                             l->q[k * NEVH__NODES + j]);
            loop_panel_widen(&l->low[i + 1], &l->high[i + 1],
                             l->p[k * NEVH__NODES + j]);
        }
    loop_panel_integrate(l, time);
    l->area[time] += l->taken_area[time];
    return true;
}

bool nevh__loop_integrate(nevh_loop *l, size_t time) {
    loop_panel_integrate(l, time);
    return true;
}

static bool is_smooth(const nevh_loop *l, size_t time) {
    return l->taken_error[time] <= tolerance * l->unit[time];
}

/* Up to the first time at which it must be cut. */
bool nevh__loop_integrate_smooth(nevh_loop *l, size_t time) {
    loop_panel_integrate(l, time);
    l->taken_times += is_smooth(l, time);
    return is_smooth(l, time);
}

/* The parts that have errors small enough, at least `parts`, where those of halves
   are `halved` times as large. */
static size_t parts_for(const nevh_loop *l, double certain, double halved,
                        size_t parts) {
    enum { MOST = 16 };
    double error = l->taken_error[l->taken_times];
    double most = certain * l->unit[l->taken_times];
    for (size_t done = 1; done < parts; done *= 2)
        error *= halved;
    for (; parts < MOST && error > most; error *= halved)
        parts *= 2;
    return parts;
}

/* Halves of what is resolved well have errors that are 2^-11 of those of the whole in
   the one series, and 2^-7 in the other. */
size_t nevh__loop_parts(const nevh_loop *l) {
    return parts_for(l, tolerance, 0x1p-18, 2);
}

/* Panels of large errors have series that hardly fall yet, and halves that gain
   less. */
size_t nevh__loop_least_parts(const nevh_loop *l) {
    return parts_for(l, NEVH__LOOP_CERTAIN, 0x1p-14, 1);
}

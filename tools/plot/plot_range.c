/* nevh: plots: what axes show.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double room = 0.04;       /* of a linear axis, at either end */
static const double few_digits = 1e-9; /* what is less counts as level */

typedef double coordinate(const pair *);
static double x_of(const pair *p) {
    return p->x;
}
static double y_of(const pair *p) {
    return p->y;
}

static void widen(range *r, double value) {
    r->low = fmin(r->low, value);
    r->high = fmax(r->high, value);
}

/* The range of the points that a panel shows, in its own span; empty if there are
   none. */
static range own_extent(const plot *p, size_t number, range seen,
                        coordinate *of) {
    range r = {INFINITY, -INFINITY};
    if (!(seen.low < seen.high))
        seen = (range){-INFINITY, INFINITY};
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        for (size_t k = 0; k < s->count && s->panel == number; k++)
            if (s->point[k].x >= seen.low && s->point[k].x <= seen.high)
                widen(&r, of(&s->point[k]));
    }
    return r;
}

static bool are_alike(const panel *a, const panel *b) {
    return strcmp(a->x, b->x) == 0 && strcmp(a->y, b->y) == 0;
}

/* The median length of the ranges of the panels with the same axes. */
static double usual_length(const plot *p, size_t number, coordinate *of) {
    double *length = tool_allocate(p->panels, sizeof *length), usual = 0;
    size_t count = 0;
    for (size_t i = 0; i < p->panels; i++) {
        range r = own_extent(p, i, p->panel[number].span_x, of);
        if (r.low <= r.high && are_alike(&p->panel[number], &p->panel[i]))
            length[count++] = r.high - r.low;
    }
    if (count) {
        numbers_sort(length, count);
        usual = length[(count - 1) / 2];
    }
    return usual;
}

/* Its own range, or that of all panels of the same axes that share it. */
static range extent(const plot *p, size_t number, coordinate *of) {
    const panel *on = &p->panel[number];
    range r = own_extent(p, number, on->span_x, of), all = r;
    if (p->same_ranges == 0)
        return r;
    double most = isinf(p->same_ranges)
                      ? INFINITY
                      : p->same_ranges * usual_length(p, number, of);
    if (r.high - r.low > most)
        return r;
    for (size_t i = 0; i < p->panels; i++) {
        range other = own_extent(p, i, on->span_x, of);
        if (other.low <= other.high && other.high - other.low <= most &&
            are_alike(on, &p->panel[i])) {
            widen(&all, other.low);
            widen(&all, other.high);
        }
    }
    return all;
}

static const double digits[] = {1, 1.5, 2, 3, 4, 5, 6, 8, 10};

/* The nearest of a few round numbers that is not above, or not below. */
static double round_below(double value) {
    double power = pow(10, floor(log10(value) + few_digits));
    int i = 7;
    while (i > 0 && digits[i] * power > value * (1 + few_digits))
        i--;
    return digits[i] * power;
}

static double round_above(double value) {
    double power = pow(10, floor(log10(value) + few_digits));
    int i = 0;
    while (i < 8 && digits[i] * power < value * (1 - few_digits))
        i++;
    return digits[i] * power;
}

/* Finds the range of a logarithmic axis: round numbers, so that no point lies on the
   frame, or, if they would be far from a narrow range, an equal margin on either
   side, of a quarter at least. */
static range decades(range r) {
    static const double margin = 1.15;
    if (r.low > r.high)
        return (range){0.1, 10};
    if (r.high >= 2 * r.low)
        return (range){round_below(r.low / margin),
                       round_above(r.high * margin)};
    double middle = sqrt(r.low) * sqrt(r.high);
    double half = sqrt(fmax(pow(r.high / r.low, 1 + 2 * room), 1.25));
    return (range){middle / half, middle * half};
}

static range with_room(range r) {
    if (r.low > r.high)
        return (range){-1, 1};
    double more = room * (r.high - r.low);
    if (more <= few_digits * fmax(fabs(r.low), fabs(r.high)))
        more = fmax(0.1 * fabs(r.low), 1e-300);
    if (r.low == 0 && r.high == 0)
        more = 1;
    return (range){r.low - more, r.high + more};
}

range plot_range_x(const plot *p, size_t number) {
    const panel *on = &p->panel[number];
    if (on->span_x.low < on->span_x.high)
        return on->span_x;
    range r = extent(p, number, x_of);
    return on->log_x ? decades(r) : with_room(r);
}

range plot_range_y(const plot *p, size_t number) {
    const panel *on = &p->panel[number];
    if (on->span_y.low < on->span_y.high)
        return on->span_y;
    range r = extent(p, number, y_of);
    if (r.low <= r.high) {
        r.low = fmin(fmax(r.low, on->limit_y.low), on->limit_y.high);
        r.high = fmax(fmin(r.high, on->limit_y.high), on->limit_y.low);
    }
    if (r.low > 0 && r.high < on->least_y * r.low) {
        double middle = sqrt(r.low * r.high);
        r = (range){middle / sqrt(on->least_y), middle * sqrt(on->least_y)};
    }
    return on->log_y ? decades(r) : with_room(r);
}

static void lengthen(range *r, double length) {
    double middle = (r->low + r->high) / 2;
    *r = (range){middle - length / 2, middle + length / 2};
}

void plot_range_equal(range *x, range *y, double width, double height) {
    double unit = fmax((x->high - x->low) / width, (y->high - y->low) / height);
    lengthen(x, unit * width);
    lengthen(y, unit * height);
}

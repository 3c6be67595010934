/* nevh: kinks and jumps of H where an orbit goes.

   Of functions in C, and of formulas such as sqrt(x^2), nothing but values tells.
   A line between two states of the orbit is halved again and again, always to the
   half with the larger third difference.  Of a smooth H these become 8 times smaller
   each time, of one whose second derivative jumps 4 times, and 2 times at a kink.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/kinks_private.h"
#include "diagnose/energy_private.h"
#include "expression/tape_private.h"
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_HALVES = 36, COMPARED = 4, POINTS = 7 };
/* Third differences, over those COMPARED halves before: between 2^-12 and 2^-8. */
static const double smooth = 0x1p-10;
static const double resolved = 0x1p10; /* units of rounding */

bool nevh__theory_doubts(const nevh_system *s) {
    for (size_t i = 0; i < s->n_terms; i++) {
        const nevh_term *term = &s->terms[i]->decl;
        if (nevh__term_on(s, s->terms[i]) && (term->block != nevh__tape_block ||
                                              nevh__tape_touches(term->params)))
            return true;
    }
    return false;
}

typedef struct {
    nevh_field *field;
    double t, *state; /* 2n */
    const double *from, *to;
    double value[POINTS],
        size;        /* the sum of the terms' |values|: the largest */
    double rounding; /* of values, and of places */
} line;

/* H without constants; NaN: not finite. */
static double value_at(line *l, double part) {
    size_t n = l->field->n;
    double h, roundoff, size;
    for (size_t k = 0; k < 2 * n; k++)
        l->state[k] = l->from[k] + part * (l->to[k] - l->from[k]);
    if (nevh__field_moving_values(l->field, 1, &l->t, l->state, l->state + n,
                                  &h, &roundoff, &size))
        return NAN;
    l->size = fmax(l->size, size);
    return h;
}

/* The largest of n values, over the largest difference. */
static double farness(size_t n, const double from[], const double to[]) {
    double most = 0, apart = 0;
    for (size_t k = 0; k < n; k++) {
        most = fmax(most, fmax(fabs(from[k]), fabs(to[k])));
        apart = fmax(apart, fabs(to[k] - from[k]));
    }
    return apart > 0 ? most / apart : 0;
}

static double line_rounding(const line *l) {
    size_t n = l->field->n;
    double change = 0;
    for (int i = 1; i < POINTS; i++)
        change =
            fmax(change, (POINTS - 1) * fabs(l->value[i] - l->value[i - 1]));
    double places =
        farness(n, l->from, l->to) + farness(n, l->from + n, l->to + n);
    return DBL_EPSILON * (l->size + places * change);
}

static double third_difference(const double v[]) {
    return fabs(v[3] - v[0] - 3 * (v[2] - v[1]));
}

/* Fills in the values at odd places, and cuts the line to the half with the larger
   third difference, which is returned. */
static double halve(line *l, double *begin, double *length) {
    double *v = l->value;
    for (int i = 1; i < POINTS; i += 2)
        v[i] = value_at(l, *begin + *length * i / (POINTS - 1));
    double left = third_difference(v), right = third_difference(v + 3);
    const double *half = right > left ? v + 3 : v;
    if (l->rounding == 0)
        l->rounding = line_rounding(l);
    *length /= 2;
    *begin += right > left ? *length : 0;
    double kept[] = {half[0], half[1], half[2], half[3]};
    for (int i = 0; i < 4; i++)
        v[2 * i] = kept[i];
    return left + right < INFINITY ? fmax(left, right) : NAN;
}

/* True if second differences around a place are in proportion to the step: where
   H'' alone jumps they are to its square. */
static bool jumps_in_slope(line *l, double place) {
    enum { STEPS = 3 };
    static const double shorter = 0x1p-4, first = 0x1p-8;
    double middle = value_at(l, place), before = 0, step = first;
    bool jumps = true;
    for (int i = 0; jumps && i < STEPS; i++, step *= shorter) {
        double met = fabs(value_at(l, place + step) - 2 * middle +
                          value_at(l, place - step));
        jumps = met > l->rounding && (!i || met > before * shorter / 2);
        before = met;
    }
    return jumps;
}

static bool has_kink(line *l, double largest, bool slopes) {
    double met[MOST_HALVES], begin = 0, length = 1;
    int i = 0;
    for (int k = 0; k < POINTS; k += 2)
        l->value[k] = value_at(l, (double)k / (POINTS - 1));
    do {
        l->size = i ? 0 : l->size; /* of the last places */
        met[i] = halve(l, &begin, &length);
    } while (met[i] > resolved * l->rounding && ++i < MOST_HALVES);
    i = i < MOST_HALVES ? i : MOST_HALVES - 1;
    bool kink = i >= COMPARED && met[i] > smooth * met[i - COMPARED] &&
                l->size <= largest;
    return kink && (!slopes || jumps_in_slope(l, begin + length / 2));
}

bool nevh__kink_between(nevh_field *f, double t, const double from[],
                        const double to[], double largest, bool slopes,
                        double room[]) {
    line l = {.field = f, .t = t, .state = room, .from = from, .to = to};
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    bool found = has_kink(&l, largest, slopes);
    fesetenv(&own);
    f->report = (nevh__report){0}; /* where H is not finite */
    return found;
}

/* H at a state of which one variable is off. */
static double value_off(line *l, const double z[], size_t k, double by) {
    double *off = l->state + 2 * l->field->n;
    memcpy(off, z, 2 * l->field->n * sizeof *off);
    off[k] += by;
    l->from = l->to = off;
    return value_at(l, 0);
}

/* Its size, or that of the largest of its half, or 1. */
static double scale_of(size_t n, size_t k, const double z[]) {
    const double *half = k < n ? z : z + n;
    double most = fabs(z[k]);
    for (size_t i = 0; z[k] == 0 && i < n; i++)
        most = fmax(most, fabs(half[i]));
    return most > 0 ? most : 1;
}

/* True if the second difference is in proportion to the step: of smooth functions it is
   to its square, and rounding is to none. */
static bool has_kink_at(line *l, const double z[], size_t k) {
    enum { STEPS = 3 };
    static const double shorter = 0x1p-4, first = 0x1p-9;
    double middle = value_off(l, z, k, 0), met[STEPS];
    double step = first * scale_of(l->field->n, k, z);
    for (int i = 0; i < STEPS; i++, step *= shorter)
        met[i] = fabs(value_off(l, z, k, step) - 2 * middle +
                      value_off(l, z, k, -step));
    double up = value_off(l, z, k, step) - middle;
    double down = middle - value_off(l, z, k, -step);
    bool leaves = k < l->field->n && up * down > 0; /* to one side */
    bool kink = met[STEPS - 1] > 0 && !leaves;
    for (int i = 1; i < STEPS; i++)
        kink = kink && met[i] > met[i - 1] * shorter / 2 &&
               met[i] < met[i - 1] * shorter * 2;
    return kink;
}

/* True if H is the same on both sides of the variable's conjugate: the variable rests,
   at least for a while. */
static bool rests(line *l, const double z[], size_t k) {
    static const double roundings = 16;
    size_t n = l->field->n, other = k < n ? n + k : k - n;
    double by = scale_of(n, other, z);
    double apart =
        fabs(value_off(l, z, other, by) - value_off(l, z, other, -by));
    return apart <= roundings * DBL_EPSILON * l->size;
}

bool nevh__kink_at_rest(nevh_field *f, double t, const double z[],
                        double room[]) {
    line l = {.field = f, .t = t, .state = room};
    bool found = false;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    for (size_t k = 0; k < 2 * f->n && !found; k++)
        found = rests(&l, z, k) && has_kink_at(&l, z, k);
    fesetenv(&own);
    f->report = (nevh__report){0}; /* where H is not finite */
    return found;
}

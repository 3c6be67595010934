/* nevh: how long series keep within the domains of what they are made of.

   Where the argument of a root touches 0, or that of atan2 crosses its cut, the
   series of an orbit may know nothing of it: sqrt(x^2) continues as x or as -x.
   So the polynomials of these arguments are bounded over a series.

   And what is too small to be seen where a series begins, as exp(-1000*x) or x^100,
   may be large where it ends, so that the coefficients say nothing of how long it
   holds.  Of exp(a) the terms fall from order N on while a changes by less than
   N/2; the arguments of such functions change by less within a series.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/series_private.h"
#include <float.h>
#include <math.h>
#include <stdio.h>

/* A polynomial: coefficients that far apart. */
typedef struct {
    const double *at;
    size_t apart, orders;
} polynomial;

/* The sum of the sizes of the terms from order 1 on, at h. */
static double domain_size_of(polynomial p, double h) {
    double sum = 0;
    for (size_t k = p.orders; --k > 0;)
        sum = sum * h + fabs(p.at[k * p.apart]);
    return sum * h;
}

static double domain_slope_of(polynomial p, double h) {
    double sum = 0;
    for (size_t k = p.orders; --k > 0;)
        sum = sum * h + (double)k * fabs(p.at[k * p.apart]);
    return sum;
}

static double domain_value_of(polynomial p, double since) {
    double sum = 0;
    for (size_t k = p.orders; k-- > 0;)
        sum = sum * since + p.at[k * p.apart];
    return sum;
}

static const double noise = 8 * DBL_EPSILON; /* of a polynomial */

/* True if the polynomial keeps its sign from 0 to h, or to -h: by steps, none
   longer than its slope allows. */
static bool keeps_on(polynomial p, double h, double size, double slope) {
    enum { MOST_STEPS = 40 };
    double sign = p.at[0] > 0 ? 1 : -1, t = 0;
    for (int i = 0; i < MOST_STEPS && t < fabs(h); i++) {
        double value = sign * domain_value_of(p, copysign(t, h));
        if (!(value > noise * size))
            return false;
        t += value / slope;
    }
    return t >= fabs(h);
}

static bool keeps_sign(polynomial p, double h) {
    double change = domain_size_of(p, h);
    if (fabs(p.at[0]) > change)
        return true;
    double size = fabs(p.at[0]) + change, slope = domain_slope_of(p, h);
    return keeps_on(p, h, size, slope) && keeps_on(p, -h, size, slope);
}

/* It may touch 0, but not be less. */
static bool is_not_negative(polynomial p, double h) {
    enum { PLACES = 8 };
    double least = -noise * (fabs(p.at[0]) + domain_size_of(p, h));
    bool not_less = true;
    for (int i = -PLACES; i <= PLACES; i++)
        not_less = not_less && domain_value_of(p, h * i / PLACES) >= least;
    return not_less;
}

/* The cut of atan2(y, x): y crosses 0 where x is not positive. */
static bool is_off_cut(polynomial y, polynomial x, double h) {
    return (x.at[0] > 0 && keeps_sign(x, h)) || keeps_sign(y, h);
}

/* Logarithms of what is negligible: of exp, where doubles end, and of powers. */
static const double negligible = -700, small_power = -300;

/* True if a^c is negligible from -h to h. */
static bool is_small_power(polynomial a, double c, double change) {
    double size = fabs(a.at[0]);
    if (c < 0)
        return size > change && c * log(size - change) < small_power;
    return size + change == 0 || c * log(size + change) < small_power;
}

/* True if the last terms of a polynomial, at h, are small beside all: else it does not
   tell what its function is there, such as 1/(x^2 + 1e-20) on the other side of 0. */
static bool is_convergent(polynomial p, double h) {
    static const double small = 1e-3;
    double size = fabs(p.at[0]) + domain_size_of(p, h), power = 1;
    if (p.orders < 3)
        return true;
    for (size_t k = 1; k + 2 < p.orders; k++)
        power *= h;
    double last = fabs(p.at[(p.orders - 2) * p.apart]) * power * h +
                  fabs(p.at[(p.orders - 1) * p.apart]) * power * h * h;
    return !(last > small * size);
}

/* True if the terms of a steep function decrease within -h to h, or the function is
   constant there. */
static bool is_resolved(const nevh__edge *e, polynomial a, double h) {
    static const double part = 1 / 3.0; /* of the order */
    static const double saturated = 50; /* tanh(50) = 1 - 7e-44 */
    double most = part * (double)a.orders, change = domain_size_of(a, h);
    double at = a.at[0];
    switch (e->function) {
    case NEVH__EXP:
        return change <= most || at + change < negligible;
    case NEVH__TANH:
        return 4 * change <= most || fabs(at) - change > saturated;
    case NEVH__POWER:
        return (change <= fabs(at) / 2 &&
                fabs(e->exponent) * change <= most * fabs(at)) ||
               is_small_power(a, e->exponent, change);
    default:
        return change <= most;
    }
}

static bool is_clear(const nevh__recurrence *r, const double rows[],
                     size_t orders, size_t i, double h) {
    const nevh__edge *e = &r->edges[i];
    polynomial a = {rows + i, r->n_watched, orders};
    polynomial b = {rows + e->also, r->n_watched, orders};
    return e->steep    ? is_convergent(a, h) && is_resolved(e, a, h)
           : e->also   ? is_off_cut(a, b, h)
           : e->strict ? keeps_sign(a, h)
                       : is_not_negative(a, h);
}

/* Out, which: the edge of a domain that was met last, if any. */
static double domain_shorten(const nevh__recurrence *r, const double rows[],
                             size_t orders, double reach, size_t *which) {
    enum { MOST_HALVINGS = 200 };
    static const double most =
        0x1p60; /* of series that end, and hold for ever */
    double h = fmin(reach, most);
    int left = MOST_HALVINGS;
    for (size_t i = 0; i < r->n_edges; i++)
        while (h > 0 && !is_clear(r, rows, orders, i, h)) {
            *which = r->edges[i].steep ? *which : i;
            h = left-- > 0 ? h / 2 : 0;
        }
    return h < fmin(reach, most) ? h : reach;
}

double nevh__domain_reach(const nevh__recurrence *r, const double rows[],
                          size_t orders, double reach) {
    size_t which = SIZE_MAX;
    return r->n_edges ? domain_shorten(r, rows, orders, reach, &which) : reach;
}

size_t nevh__domain_edge(const nevh__recurrence *r, const double rows[],
                         size_t orders, double reach) {
    static const double beyond = 16, least = 0x1p-130; /* of halvings */
    size_t which = SIZE_MAX, finite = 0;
    for (bool all = true; all && finite < orders; finite += all)
        for (size_t i = 0; i < r->n_watched; i++)
            all = all && isfinite(rows[finite * r->n_watched + i]);
    if (finite)
        domain_shorten(r, rows, finite, fmax(beyond * reach, least), &which);
    return which;
}

bool nevh__domain_is_closed(const nevh__recurrence *r, size_t edge) {
    if (edge == SIZE_MAX)
        return false;
    unsigned function = r->edges[edge].function;
    const nevh__operation_traits *o = nevh__operation_of(function);
    return function == NEVH__CBRT || (o->kind == NEVH__KIND_KINK && o->jumps);
}

size_t nevh__domain_kink(const nevh__recurrence *r) {
    for (size_t i = 0; i < r->n_edges; i++)
        if (nevh__operation_of(r->edges[i].function)->kind == NEVH__KIND_KINK)
            return i;
    return SIZE_MAX;
}

bool nevh__domain_may_jump(const nevh__recurrence *r) {
    bool jumps = false;
    for (size_t i = 0; i < r->n_edges; i++)
        jumps = jumps || nevh__operation_of(r->edges[i].function)->jumps;
    return jumps;
}

void nevh__domain_words(const nevh__recurrence *r, size_t edge, char text[],
                        size_t room) {
    const nevh__edge *e = &r->edges[edge];
    snprintf(text, room, "%s%s%s%s", nevh__operation_of(e->function)->at_edge,
             e->effect ? " in effect \"" : "", e->effect ? e->effect : "",
             e->effect ? "\"" : "");
}

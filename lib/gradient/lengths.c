/* nevh: over which lengths does H vary?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/explore_private.h"
#include <float.h>
#include <math.h>
#include <string.h>

/* A length is where this part of a variation is not that of a quadratic. */
static const double not_quadratic = 0.2;
enum { FARTHEST = 400, LEAP = 8 }; /* powers of two from the first guess */
enum { NEARER = 3, NEAREST = 24 }; /* below a distance that may be periods */
static const double as_much = 0.125;
static const double overflowing = 0x1p500;
enum { MOST_LANES = 4, TRIED_LANES = 64 };
/* Powers of two may be whole periods, over which nothing varies. */
static const double askew = 0.618;

void nevh__along(const nevh__explorer *e, const nevh__planned *term,
                 size_t instance, size_t k, size_t at, size_t count,
                 const double move[], double x[], double h[]) {
    nevh_field *f = e->field;
    const nevh_term *is = &term->term->is;
    size_t stride = nevh__padded(count), n = f->n;
    const double *q = e->samples.q + at * n, *p = e->samples.p + at * n;
    double *row = f->rows;
    for (size_t j = 0; j < term->nv + is->nc; j++, row += stride) {
        double value = j >= term->nv  ? is->c[instance * is->nc + j - term->nv]
                       : j < term->nq ? q[nevh__index(term, instance, j)]
                                      : p[nevh__index(term, instance, j)];
        for (size_t i = 0; i < stride; i++)
            row[i] = value + (j == k && i < count ? move[i] : 0);
    }
    for (size_t i = 0; i < stride; i++)
        f->times[i] =
            e->samples.t[at] + (k == NEVH__TIME && i < count ? move[i] : 0);
    double *rows_p = f->rows + term->nq * stride;
    nevh__term_values(term->term, f->portable, stride, count,
                      is->time ? f->times : f->zeros, f->rows, rows_p,
                      rows_p + term->np * stride, f->h, f->one);
    for (size_t i = 0; i < count; i++) {
        x[i] = k == NEVH__TIME ? f->times[i] : f->rows[k * stride + i];
        h[i] = f->h[i];
    }
}

/* How h varies within one distance: as a whole, what a quadratic through the
   half distance does not explain of it, and what may be rounding. */
typedef struct {
    double whole, rest, rounding;
} variation;

static variation vary(const nevh__explorer *e, const nevh__planned *term,
                      size_t instance, size_t k, double distance) {
    const double move[5] = {0, distance / 2, -distance / 2, distance,
                            -distance};
    double x[5], h[5], most = 0;
    nevh__along(e, term, instance, k, e->at, 5, move, x, h);
    for (int i = 0; i < 5; i++)
        most = fmax(most, fabs(h[i]));
    double even = (h[3] - h[0]) + (h[4] - h[0]), odd = h[3] - h[4];
    double near_even = (h[1] - h[0]) + (h[2] - h[0]), near_odd = h[1] - h[2];
    return (variation){
        fmax(fabs(h[3] - h[0]), fabs(h[4] - h[0])),
        fmax(fabs(even - 4 * near_even), fabs(odd - 2 * near_odd)),
        32 * DBL_EPSILON * most};
}

/* Beyond the length, or outside the domain. */
static bool too_far(const variation *v) {
    return !(v->rest <= not_quadratic * v->whole + v->rounding);
}

/* A power of the distance has no length: its parts stay the same. */
static bool alike(const variation *a, const variation *b) {
    double share = b->rest / b->whole, noise = b->rounding / b->whole;
    return fabs(a->rest / a->whole - share) <= 1e-9 * share + noise &&
           noise < 0.1;
}

/* Within a distance of many periods, five values may happen to be those of a
   quadratic.  Somewhere nearer they are not, although they vary as much; little
   ripples do not count.  Returns where, or else the distance. */
static double unfold(const nevh__explorer *e, const nevh__planned *term,
                     size_t instance, size_t k, double distance) {
    double whole = vary(e, term, instance, k, distance).whole;
    for (int down = NEARER; whole > 0 && down <= NEAREST; down += NEARER) {
        double nearer = ldexp(distance, -down);
        variation v = vary(e, term, instance, k, nearer);
        if (too_far(&v) && v.whole >= as_much * whole)
            return nearer;
    }
    return distance;
}

/* In leaps below `distance`, and how many; false where there is no length. */
static bool leap_down(const nevh__explorer *e, const nevh__planned *term,
                      size_t instance, size_t k, double *distance, int *leaps) {
    variation v = vary(e, term, instance, k, *distance);
    while (too_far(&v) && *leaps < FARTHEST / LEAP) {
        variation before = v;
        ++*leaps;
        *distance = ldexp(*distance, -LEAP);
        v = vary(e, term, instance, k, *distance);
        if (alike(&before, &v))
            return false;
    }
    return !too_far(&v);
}

double nevh__curve_length(const nevh__explorer *e, const nevh__planned *term,
                          size_t instance, size_t k, double guess) {
    variation v = vary(e, term, instance, k, guess);
    double distance = v.whole > v.rounding ? guess : askew * guess;
    int leaps = 0;
    double nearer = distance;
    do {
        distance = nearer;
        if (!leap_down(e, term, instance, k, &distance, &leaps))
            return NAN;
        nearer = unfold(e, term, instance, k, distance);
    } while (nearer < distance);
    v = vary(e, term, instance, k, distance);
    bool seen = false;
    for (int i = 0; i < (leaps ? LEAP : FARTHEST) && v.whole < overflowing;
         i++) {
        v = vary(e, term, instance, k, 2 * distance);
        seen |= v.whole > v.rounding;
        if (too_far(&v))
            return distance;
        distance *= 2;
    }
    return seen ? INFINITY : NAN;
}

/* The distance over which an instance varies by `energy`: in leaps below it,
   then up by twos. */
static double energy_length(const nevh__explorer *e, const nevh__planned *term,
                            size_t instance, size_t k, double guess,
                            double energy) {
    double distance = guess;
    for (int i = 0; i < FARTHEST / LEAP; i++) {
        if (!(vary(e, term, instance, k, distance).whole >= energy))
            break;
        distance = ldexp(distance, -LEAP);
    }
    for (int i = 0; i < FARTHEST; i++) {
        if (!(vary(e, term, instance, k, distance).whole < energy))
            break;
        distance *= 2;
    }
    return distance;
}

/* A first guess that only saves time: the variable's size, or 1. */
static double first_guess(const nevh__explorer *e, size_t i) {
    size_t n = e->field->n;
    const nevh__samples *s = &e->samples;
    double x = fabs(i < n ? s->q[e->at * n + i] : s->p[e->at * n + i - n]);
    if (e->options->scale)
        x = e->options->scale[i];
    return x > 0 && isfinite(x) ? exp2(floor(log2(x))) : 1;
}

typedef void (*visit_fn)(nevh__explorer *, const nevh__planned *,
                         size_t instance, size_t k, size_t i, double *energy);

static void visit_all(nevh__explorer *e, visit_fn visit, double *energy) {
    for (size_t j = 0; j < e->field->n_terms; j++) {
        const nevh__planned *term = &e->field->terms[j];
        size_t count = term->term->is.count, stride = nevh__stride(count);
        for (size_t instance = 0; instance < count; instance += stride)
            for (size_t k = 0; k < term->nv; k++) {
                size_t i = nevh__index(term, instance, k);
                if (nevh__probed(term, k) == k)
                    visit(e, term, instance, k,
                          k < term->nq ? i : e->field->n + i, energy);
            }
    }
}

/* Finite lengths, and the largest variation of H within them. */
static void find_curved(nevh__explorer *e, const nevh__planned *term,
                        size_t instance, size_t k, size_t i, double *energy) {
    double length = nevh__curve_length(e, term, instance, k, first_guess(e, i));
    if (!isfinite(length))
        return;
    *energy = fmax(*energy, vary(e, term, instance, k, length).whole);
    if (e->length[i] > 0 && e->length[i] <= length)
        return;
    e->length[i] = length;
    e->shortened = true;
}

/* Nothing is curved: variations over the variables' own sizes. */
static void find_energy(nevh__explorer *e, const nevh__planned *term,
                        size_t instance, size_t k, size_t i, double *energy) {
    size_t n = e->field->n;
    const nevh__samples *s = &e->samples;
    double x = i < n ? s->q[e->at * n + i] : s->p[e->at * n + i - n];
    double whole = vary(e, term, instance, k, fabs(x)).whole;
    *energy = fmax(*energy, isfinite(whole) ? whole : 0);
}

/* The rest: where H varies by that energy. */
static void find_straight(nevh__explorer *e, const nevh__planned *term,
                          size_t instance, size_t k, size_t i, double *energy) {
    double guess = first_guess(e, i), length = guess;
    bool curved = e->length[i] > 0;
    if (curved)
        return;
    if (*energy > 0)
        length = energy_length(e, term, instance, k, guess, *energy);
    e->length[i] = e->length[i] < 0 ? -fmin(-e->length[i], length) : -length;
}

/* Copies a lane of the states given to sample `at`. */
static void load(nevh__explorer *e, size_t lane, size_t at) {
    const nevh_options *o = e->options;
    size_t n = e->field->n, width = o->width ? o->width : 1;
    e->samples.t[at] = o->t;
    for (size_t k = 0; k < n; k++) {
        e->samples.q[at * n + k] = o->q ? o->q[k * width + lane] : 0;
        e->samples.p[at * n + k] = o->p ? o->p[k * width + lane] : 0;
    }
}

/* The first lane becomes a sample, and the last ones that have a shorter length
   than those before. */
static void find_over_lanes(nevh__explorer *e, double *energy) {
    size_t width = e->options->width ? e->options->width : 1;
    size_t stride = (width + TRIED_LANES - 1) / TRIED_LANES;
    for (size_t lane = 0; lane < width; lane += stride) {
        e->at = e->lanes;
        e->shortened = lane == 0;
        load(e, lane, e->at);
        visit_all(e, find_curved, energy);
        if (e->shortened && e->lanes < MOST_LANES - 1)
            e->lanes++;
        else if (e->shortened)
            load(e, lane, e->lanes - 1);
    }
    e->samples.count = e->lanes;
    e->at = 0;
}

/* What an instance adds to the changes of H, up and down by the length of each
   variable. */
static void add_changes(const nevh__explorer *e, const nevh__planned *term,
                        size_t instance, double changes[]) {
    double up = 0, down = 0;
    for (size_t k = 0; k < term->nv; k++) {
        size_t i = nevh__index(term, instance, k);
        i = k < term->nq ? i : e->field->n + i;
        if (nevh__probed(term, k) == k) {
            const double move[3] = {0, e->length[i], -e->length[i]};
            double x[3], h[3];
            nevh__along(e, term, instance, k, e->at, 3, move, x, h);
            up = h[1] - h[0];
            down = h[2] - h[0];
        }
        changes[2 * i] += up;
        changes[2 * i + 1] += down;
    }
}

void nevh__find_curvatures(nevh__explorer *e, double changes[],
                           double curvature[]) {
    const nevh_field *f = e->field;
    for (e->at = 0; e->at < e->samples.count; e->at++) {
        memset(changes, 0, 4 * f->n * sizeof *changes);
        for (size_t j = 0; j < f->n_terms; j++)
            for (size_t i = 0; i < f->terms[j].term->is.count; i++)
                add_changes(e, &f->terms[j], i, changes);
        for (size_t i = 0; i < 2 * f->n; i++) {
            double most = fmax(fabs(changes[2 * i]), fabs(changes[2 * i + 1]));
            double curved = most / (e->length[i] * e->length[i]);
            if (isfinite(curved))
                curvature[i] = fmax(curvature[i], curved);
        }
    }
    e->at = 0;
}

void nevh__find_lengths(nevh__explorer *e) {
    double energy = 0, last = 1;
    find_over_lanes(e, &energy);
    if (energy == 0)
        visit_all(e, find_energy, &energy);
    visit_all(e, find_straight, &energy); /* kept apart by their sign */
    for (size_t i = 0; i < 2 * e->field->n; i++) {
        last = e->length[i] != 0 ? fabs(e->length[i]) : last;
        e->length[i] = e->options->scale ? e->options->scale[i] : last;
    }
}

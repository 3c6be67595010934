/* nevh: what a term is: a quadratic form with constant coefficients, -k/|q|, -k/|a - b| or a
   function of actions.

   Forms are asked of the derivatives that a term brings, or of differences of its
   values, which are exact for such a form, unless the term is known to be none: it may
   differ from one between all states that are tried.  Those at unit vectors give the
   coefficients; at other states, near and far, the derivatives have to be the linear
   functions that follow.  Values of -k/|q| are as they should be at other states.
   Functions of actions are what terms say of themselves, as formulas do.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/parts_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TRIALS = 13 }; /* of eight states each */
static const double roundings = 256;

/* Rows of eight states of an instance. */
typedef struct {
    const nevh__term_entry *term;
    size_t nv;
    double *z, *c, *slope;        /* nv, nc and nv rows */
    double *beside, *t, *h, *one; /* nv rows, two rows, nv + nc numbers */
} trial;

size_t nevh__form_room(const nevh_term *decl) {
    size_t nv = decl->nq + decl->np;
    return NEVH__LANES * (3 * nv + decl->nc + 2) + nv + decl->nc;
}

static trial parts_lay_out(const nevh__term_entry *term, size_t instance,
                           double *room) {
    const nevh_term *decl = &term->decl;
    trial x = {.term = term, .nv = decl->nq + decl->np};
    size_t size = NEVH__LANES * x.nv;
    x.z = nevh__take(&room, size);
    x.c = nevh__take(&room, NEVH__LANES * decl->nc);
    x.slope = nevh__take(&room, size);
    x.beside = nevh__take(&room, size);
    x.t = nevh__take(&room, NEVH__LANES);
    x.h = nevh__take(&room, NEVH__LANES);
    x.one = room;
    for (size_t k = 0; k < NEVH__LANES * decl->nc; k++)
        x.c[k] = decl->c[instance * decl->nc + k / NEVH__LANES];
    for (size_t i = 0; i < NEVH__LANES; i++)
        x.t[i] = 0;
    for (size_t k = 0; k < size; k++)
        x.z[k] = 0;
    return x;
}

static void add_values(const trial *x, size_t k, double step, double sign) {
    const nevh_term *decl = &x->term->decl;
    for (size_t i = 0; i < NEVH__LANES * x->nv; i++)
        x->beside[i] = x->z[i] + (i / NEVH__LANES == k ? sign * step : 0);
    nevh__term_values(x->term, false, NEVH__LANES, NEVH__LANES, x->t, x->beside,
                      x->beside + NEVH__LANES * decl->nq, x->c, x->h, x->one);
    for (size_t i = 0; i < NEVH__LANES; i++)
        x->slope[k * NEVH__LANES + i] += sign * x->h[i] / (2 * step);
}

/* The derivatives at all eight states; differences over a step. */
static void take_slopes(const trial *x, double step) {
    const nevh_term *decl = &x->term->decl;
    size_t p = NEVH__LANES * decl->nq;
    for (size_t i = 0; i < NEVH__LANES * x->nv; i++)
        x->slope[i] = 0;
    if (decl->gradient)
        decl->gradient(NEVH__LANES, x->t, x->z, x->z + p, x->c, decl->params,
                       x->slope, x->slope + p);
    for (size_t k = 0; !decl->gradient && k < x->nv; k++) {
        add_values(x, k, step, 1);
        add_values(x, k, step, -1);
    }
}

/* States 0, e_j and -e_j. */
static void find_column(const trial *x, size_t j, double form[]) {
    double *row = x->z + j * NEVH__LANES;
    row[1] = 1;
    row[2] = -1;
    take_slopes(x, 1);
    row[1] = row[2] = 0;
    for (size_t i = 0; i < x->nv; i++) {
        const double *slope = x->slope + i * NEVH__LANES;
        form[i * (x->nv + 1) + j] = (slope[1] - slope[2]) / 2;
        form[i * (x->nv + 1) + x->nv] = slope[0];
    }
}

/* The derivative that follows from a row of the form, and the size of its parts. */
static double linear(const trial *x, size_t lane, const double row[],
                     double *size) {
    double sum = row[x->nv];
    *size = fabs(sum);
    for (size_t j = 0; j < x->nv; j++) {
        double part = row[j] * x->z[j * NEVH__LANES + lane];
        sum += part;
        *size += fabs(part);
    }
    return sum;
}

/* At one state; false, too, where something is not finite.  Differences over a step
   are rounded as the largest derivative that far away is. */
static bool follows(const trial *x, size_t lane, double step,
                    const double form[]) {
    double size, least = 0;
    for (size_t i = 0; !x->term->decl.gradient && i < x->nv * (x->nv + 1); i++)
        least += fabs(form[i]) * (i % (x->nv + 1) < x->nv ? step : 1);
    for (size_t i = 0; i < x->nv; i++) {
        double due = linear(x, lane, form + i * (x->nv + 1), &size);
        double off = fabs(x->slope[i * NEVH__LANES + lane] - due);
        if (!isfinite(off) || off > roundings * DBL_EPSILON * fmax(size, least))
            return false;
    }
    return true;
}

/* True if values at the states and at the first one, which is 0, differ as those of a
   form do.  A function that jumps may have the derivatives of a form at all states. */
static bool has_no_jumps(const trial *x, const double form[]) {
    size_t p = NEVH__LANES * x->term->decl.nq;
    nevh__term_values(x->term, false, NEVH__LANES, NEVH__LANES, x->t, x->z,
                      x->z + p, x->c, x->h, x->one);
    for (size_t i = 1; i < NEVH__LANES; i++) {
        double off = x->h[i] - x->h[0], part;
        double size = fabs(x->h[i]) + fabs(x->h[0]);
        for (size_t k = 0; k < x->nv; k++) {
            const double *row = form + k * (x->nv + 1);
            double z = x->z[k * NEVH__LANES + i];
            off -= z * (linear(x, i, row, &part) + row[x->nv]) / 2;
            size += fabs(z) * part;
        }
        if (isfinite(off) &&
            fabs(off) > roundings * DBL_EPSILON * size + DBL_MIN)
            return false;
    }
    return true;
}

bool nevh__form_find(const nevh__term_entry *term, size_t instance,
                     double form[], double room[]) {
    static const int powers[TRIALS] = {-30, -20, -14, -10, -8, -6, -4,
                                       -2,  0,   2,   4,   10, 45};
    trial x = parts_lay_out(term, instance, room);
    uint64_t random = 1;
    for (size_t j = 0; j < x.nv; j++)
        find_column(&x, j, form);
    for (size_t i = 0; i < TRIALS; i++) {
        double length = ldexp(1, powers[i]);
        for (size_t k = 0; k < NEVH__LANES * x.nv; k++)
            x.z[k] = k % NEVH__LANES ? length * nevh__random(&random) : 0;
        take_slopes(&x, length);
        for (size_t lane = 0; lane < NEVH__LANES; lane++)
            if (!follows(&x, lane, length, form))
                return false;
        if (!has_no_jumps(&x, form))
            return false;
    }
    return true;
}

/* Values at eight states and their distances from 0. */
static void take_values(const trial *x, double distance[]) {
    nevh__term_values(x->term, false, NEVH__LANES, NEVH__LANES, x->t, x->z,
                      x->z + NEVH__LANES * x->term->decl.nq, x->c, x->h,
                      x->one);
    for (size_t lane = 0; lane < NEVH__LANES; lane++) {
        distance[lane] = 0;
        for (size_t k = 0; k < x->nv; k++)
            distance[lane] =
                nevh_simd_hypot(distance[lane], x->z[k * NEVH__LANES + lane]);
    }
}

enum { TRIALS_FAR = 7 };
static const int far_powers[TRIALS_FAR] = {-200, -60, -20, 0, 20, 60, 200};

/* h is -k/distance. */
static bool is_inverse(double k, double h, double distance) {
    return fabs(h * distance + k) <= roundings * DBL_EPSILON * fabs(k);
}

/* Eight random states of that size. */
static void spread(const trial *x, int power, uint64_t *random) {
    for (size_t j = 0; j < NEVH__LANES * x->nv; j++)
        x->z[j] = ldexp(nevh__random(random), power);
}

bool nevh__centre_find(const nevh__term_entry *term, size_t instance, double *k,
                       double room[]) {
    double distance[NEVH__LANES];
    uint64_t random = 1;
    const nevh_term *decl = &term->decl;
    if (decl->nq < 2 || decl->nq > NEVH__SPACE || decl->np)
        return false;
    trial x = parts_lay_out(term, instance, room);
    x.z[0] = 1;
    take_values(&x, distance);
    *k = -x.h[0];
    for (size_t i = 0; i < TRIALS_FAR; i++) {
        spread(&x, far_powers[i], &random);
        take_values(&x, distance);
        for (size_t lane = 0; lane < NEVH__LANES; lane++)
            if (!is_inverse(*k, x.h[lane], distance[lane]))
                return false;
    }
    return *k != 0 && isfinite(*k);
}

/* At lane 0 all coordinates are apart by whole numbers; at lane 1 + j coordinates i and
   j are shifted. */
static void shift_two(const trial *x, size_t i) {
    for (size_t j = 0; j < x->nv; j++)
        for (size_t lane = 0; lane < NEVH__LANES; lane++) {
            bool shifted = lane && (j == i || j + 1 == lane);
            x->z[j * NEVH__LANES + lane] =
                (double)(3 * j + j * j % 3 + 1) + (shifted ? 0.5 : 0);
        }
}

/* Coordinates of two points are beside one another where H does not change if both
   are shifted. */
static bool find_beside(const trial *x, size_t beside[]) {
    double distance[NEVH__LANES];
    bool fine = true;
    for (size_t i = 0; i < x->nv; i++) {
        beside[i] = i;
        shift_two(x, i);
        take_values(x, distance);
        double most = roundings * DBL_EPSILON * fabs(x->h[0]);
        for (size_t j = 0; j < x->nv; j++)
            if (j != i && fabs(x->h[j + 1] - x->h[0]) <= most)
                beside[i] = j;
    }
    for (size_t i = 0; i < x->nv; i++)
        fine = fine && beside[i] != i && beside[beside[i]] == i;
    return fine;
}

/* True if all values are 0, as those of a charge that is 0. */
static bool is_nothing(const trial *x) {
    double distance[NEVH__LANES];
    uint64_t random = 7;
    for (size_t i = 0; i < TRIALS_FAR; i++) {
        spread(x, far_powers[i], &random);
        take_values(x, distance);
        for (size_t lane = 0; lane < NEVH__LANES; lane++)
            if (x->h[lane] != 0)
                return false;
    }
    return true;
}

/* Between two points in a lane. */
static double apart(const trial *x, const size_t beside[], size_t lane) {
    const double *z = x->z + lane;
    double sum = 0;
    for (size_t j = 0; j < x->nv; j++)
        if (beside[j] > j)
            sum = nevh_simd_hypot(sum, z[j * NEVH__LANES] -
                                           z[beside[j] * NEVH__LANES]);
    return sum;
}

bool nevh__pair_find(const nevh__term_entry *term, size_t instance, double *k,
                     size_t beside[NEVH__PAIR], double room[]) {
    double distance[NEVH__LANES];
    uint64_t random = 1;
    const nevh_term *decl = &term->decl;
    if ((decl->nq != 2 * NEVH__PLANE && decl->nq != 2 * NEVH__SPACE) ||
        decl->np || decl->time)
        return false;
    trial x = parts_lay_out(term, instance, room);
    *k = 0;
    if (is_nothing(&x))
        return true;
    if (!find_beside(&x, beside))
        return false;
    *k = NAN;
    for (size_t i = 0; i < TRIALS_FAR; i++) {
        spread(&x, far_powers[i], &random);
        take_values(&x, distance);
        if (!i)
            *k = -x.h[0] * apart(&x, beside, 0);
        for (size_t lane = 0; lane < NEVH__LANES; lane++)
            if (!is_inverse(*k, x.h[lane], apart(&x, beside, lane)))
                return false;
    }
    return *k != 0 && isfinite(*k);
}

bool nevh__turn_find(const nevh__term_entry *term, size_t instance, size_t of[],
                     double s[]) {
    const nevh_term *decl = &term->decl;
    const size_t *q = decl->q + instance * decl->nq;
    const size_t *p = decl->p + instance * decl->np;
    bool paired = decl->actions && decl->nq == decl->np && !decl->time;
    for (size_t k = 0; paired && k < decl->np; k++) {
        for (of[k] = 0; of[k] < decl->nq && q[of[k]] != p[k];)
            of[k]++;
        paired = of[k] < decl->nq;
    }
    return paired &&
           decl->actions(decl->nc ? decl->c + instance * decl->nc : NULL,
                         decl->params, of, s);
}

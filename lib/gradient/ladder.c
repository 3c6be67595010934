/* nevh: the difference step of each variable, by a ladder.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/explore_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rungs are powers of two times the variable's length. */
enum { LOWEST = -30, HIGHEST = 3, RUNGS = HIGHEST - LOWEST + 1, MOST = 8 };
/* At the best step the two errors balance, unless values are worse than
   rounded. */
static const double out_of_balance = 1e4;
static const double good = 0.1, no_good = 0.5; /* of the derivative */
static const double as_good = 2; /* order 2 is taken if it is, up to this */

/* Estimates on one rung, worst over the samples: how much the difference
   changed from half the step, and what rounding may do to it; both also over
   the derivative there, or the usual one where that is larger, so that a state
   far away, where all is large, does not decide for the others. */
typedef struct {
    double truncation, rounding, size;
    double share_truncation, share_rounding;
} estimate;

typedef struct {
    estimate two[RUNGS], full[RUNGS]; /* of order 2 and of the method's */
    double usual;                     /* size of the derivative */
} ladder;

/* The difference from values in pairs, + before -; its rounding to *noise. */
static double difference(const nevh_gradient *g, const double x[],
                         const double h[], double *noise) {
    double most = 0, reach = 0;
    for (size_t j = 0; j < g->offsets; j++) {
        double width = x[2 * j] - x[2 * j + 1];
        most = fmax(most, fmax(fabs(h[2 * j]), fabs(h[2 * j + 1])));
        reach += fabs(g->weights[j] / width);
    }
    *noise = 2 * DBL_EPSILON * most * reach;
    return nevh__chord_slope(g, 1, x, h);
}

static double finite_or_huge(double x) {
    return isfinite(x) ? x : INFINITY;
}

static void take(estimate *rung, double usual, double now, double before,
                 double noise) {
    double change = finite_or_huge(fabs(now - before));
    double size = fmax(usual, isfinite(now) ? fabs(now) : 0);
    noise = finite_or_huge(noise);
    rung->truncation = fmax(rung->truncation, change);
    rung->rounding = fmax(rung->rounding, noise);
    rung->size = fmax(rung->size, isfinite(now) ? fabs(now) : 0);
    if (size > 0) {
        rung->share_truncation = fmax(rung->share_truncation, change / size);
        rung->share_rounding = fmax(rung->share_rounding, noise / size);
    }
}

/* Climbs from the shortest step at one sample. */
static void climb_at(const nevh__explorer *e, const nevh_gradient *g,
                     const nevh__planned *term, size_t instance, size_t k,
                     size_t at, double unit, ladder *l) {
    double move[MOST], x[MOST], h[MOST], noise, two = 0, full = 0;
    for (int rung = -1; rung < RUNGS; rung++) {
        double delta = ldexp(unit, LOWEST + rung);
        for (size_t j = 0; j < g->offsets; j++) {
            move[2 * j] = (double)(j + 1) * delta;
            move[2 * j + 1] = -move[2 * j];
        }
        nevh__along(e, term, instance, k, at, 2 * g->offsets, move, x, h);
        double before = two;
        two = difference(nevh_central2, x, h, &noise);
        if (rung >= 0)
            take(&l->two[rung], l->usual, two, before, noise);
        before = full;
        full = difference(g, x, h, &noise);
        if (rung >= 0)
            take(&l->full[rung], l->usual, full, before, noise);
    }
}

static double worst(const estimate *e) {
    return e->share_truncation + e->share_rounding;
}

/* Truncation on other states of the orbit may be larger than on those tried:
   it is weighed as if steps were longer by the root of two. */
static double weighed(const estimate *e, int order) {
    return ldexp(e->share_truncation, order / 2) + e->share_rounding;
}

/* The rung of the least error, the longest step of equal ones.  Where steps
   were good and then are no good at all, longer ones are not looked at: they
   may be whole periods, and agree with each other that there is no slope. */
static int best_rung(const estimate rungs[RUNGS], int order) {
    int best = 0;
    for (int i = 1; i < RUNGS; i++) {
        if (weighed(&rungs[i], order) <= weighed(&rungs[best], order))
            best = i;
        if (rungs[i].share_truncation > no_good && worst(&rungs[best]) < good)
            break;
    }
    return best;
}

/* Of a smooth H, also near a singularity, the error of order 2 falls by no more
   than some 16 where steps are halved twice.  Where a kink comes out of their
   reach it falls at once.  Then the error is that of steps within reach. */
static double kink(const estimate two[RUNGS]) {
    for (int i = -2 - LOWEST; i >= 2; i--) {
        double far = two[i].truncation, near = two[i - 2].truncation;
        if (far < INFINITY && far > 1e5 * two[i].rounding && far > 200 * near)
            return far;
    }
    return 0;
}

/* Nothing varied, or nothing was finite: the rule for a smooth function. */
static bool blind(const estimate *best) {
    return !(worst(best) < INFINITY) || best->size == 0;
}

static nevh__step choose(const nevh_gradient *g, const ladder *l, double unit) {
    int two = best_rung(l->two, 2), full = best_rung(l->full, g->order);
    const estimate *best = &l->full[full];
    if (blind(best))
        return (nevh__step){
            .delta =
                exp2(round(log2(unit * pow(DBL_EPSILON, 1. / (g->order + 1))))),
            .blind = true};
    bool quadratic = worst(&l->two[two]) <= as_good * worst(best);
    if (quadratic) {
        best = &l->two[two];
        full = two;
    }
    return (nevh__step){.delta = ldexp(unit, LOWEST + full),
                        .quadratic = quadratic,
                        .noisy =
                            best->truncation > out_of_balance * best->rounding,
                        .truncation = fmax(best->truncation, kink(l->two)),
                        .rounding = best->rounding,
                        .size = best->size};
}

/* Values of a function of very many variables are dear. */
static size_t sample_stride(const nevh__planned *term) {
    return term->nv > NEVH__PROBED ? 4 : 1;
}

/* The median of the derivative's sizes at samples from `at` on. */
static double usual_slope(const nevh__explorer *e, const nevh__planned *term,
                          size_t instance, size_t k, double unit, size_t at) {
    const double move[2] = {ldexp(unit, -8), -ldexp(unit, -8)};
    double x[2], h[2], noise, sorted[NEVH__MOST_SAMPLES];
    size_t count = 0;
    for (; at < e->samples.count; at += sample_stride(term)) {
        nevh__along(e, term, instance, k, at, 2, move, x, h);
        double slope = fabs(difference(nevh_central2, x, h, &noise));
        size_t i = count;
        if (!isfinite(slope))
            continue;
        for (count++; i > 0 && sorted[i - 1] > slope; i--)
            sorted[i] = sorted[i - 1];
        sorted[i] = slope;
    }
    return count ? sorted[count / 2] : 0;
}

nevh__step nevh__climb_along(const nevh__explorer *e, const nevh_gradient *g,
                             const nevh__planned *term, size_t instance,
                             size_t k, double length) {
    double unit = exp2(round(log2(length)));
    ladder l;
    memset(&l, 0, sizeof l);
    /* The pilot may linger where symmetry makes the derivative vanish. */
    l.usual = fmax(usual_slope(e, term, instance, k, unit, 0),
                   usual_slope(e, term, instance, k, unit, e->neighbours));
    for (size_t at = 0; at < e->samples.count; at += sample_stride(term))
        climb_at(e, g, term, instance, k, at, unit, &l);
    return choose(g, &l, unit);
}

static nevh__step climb(const nevh__explorer *e, const nevh__planned *term,
                        size_t instance, size_t k) {
    size_t i = nevh__index(term, instance, k);
    double length = e->length[k < term->nq ? i : e->field->n + i];
    return nevh__climb_along(e, e->field->gradient, term, instance, k, length);
}

void nevh__climb(nevh__explorer *e, nevh__planned *term) {
    size_t count = term->term->is.count, stride = nevh__stride(count);
    for (size_t at = 0; at < count * term->nv; at++) {
        size_t instance = at / term->nv, k = at % term->nv;
        size_t from = nevh__probed(term, k);
        nevh__step *own = &term->steps[nevh__step_at(term, instance, k)];
        if (instance % stride == 0 && from == k)
            *own = climb(e, term, instance, k);
        else if (instance % stride == 0)
            *own = term->steps[nevh__step_at(term, instance, from)];
        term->delta[at] = own->delta;
    }
}

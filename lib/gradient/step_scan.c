/* nevh: the difference step of each variable, by a scan of powers of two.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_private.h"
#include "gradient/block_private.h"
#include "gradient/step_selection_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Levels are powers of two times the variable's length. */
enum { LOWEST = -30, HIGHEST = 3, LEVELS = HIGHEST - LOWEST + 1 };
enum { FEW = 16, ENOUGH = 8 }; /* variables; states for each */
enum { BUFFER = 2 * NEVH__MOST_OFFSETS * (LEVELS + 1) };
/* At the best step the two errors balance, unless values are worse than
   rounded. */
static const double out_of_balance = 1e4;
static const double good = 0.1, no_good = 0.5; /* of the derivative */
static const double far_worse = 1e3, consistent = 16;
enum { RISEN = 3 };              /* levels */
static const double as_good = 2; /* order 2 is taken if it is, up to this */

/* Estimates on one level, worst over the samples: how much the difference
   changed from half the step, and what rounding may do to it; both also over
   the derivative there, or the usual one where that is larger, so that a state
   far away, where all is large, does not decide for the others. */
typedef struct {
    double truncation, rounding, size;
    double share_truncation, share_rounding;
} estimate;

typedef struct {
    estimate two[LEVELS], full[LEVELS]; /* of order 2 and of the method's */
    double usual;                       /* size of the derivative */
} scan_result;

/* Differences at one sample, from half the lowest step on; rounding in them. */
typedef struct {
    double slope[LEVELS + 1], noise[LEVELS + 1];
} differences;

/* A number that is not one is no larger. */
static inline double step_scan_larger(double a, double b) {
    return b > a ? b : a;
}

/* Differences with `count` steps, whose values are `count` apart. */
static void step_scan_difference(const nevh_gradient *g, size_t count,
                                 const double *x, const double *h,
                                 double *slope, double *noise) {
    memset(slope, 0, count * sizeof *slope);
    nevh__add_slopes(g, count, count, x, h, slope);
    for (size_t i = 0; i < count; i++) {
        double most = 0, reach = 0;
        for (size_t j = 0; j < g->offsets; j++) {
            size_t plus = 2 * j * count + i, minus = plus + count;
            most = step_scan_larger(
                most, step_scan_larger(fabs(h[plus]), fabs(h[minus])));
            reach += fabs(g->weights[j] / (x[plus] - x[minus]));
        }
        noise[i] = 2 * DBL_EPSILON * most * reach;
    }
}

static double finite_or_huge(double x) {
    return isfinite(x) ? x : INFINITY;
}

static void step_scan_take(estimate *level, double usual, double now,
                           double before, double noise) {
    double change = finite_or_huge(fabs(now - before));
    double here = isfinite(now) ? fabs(now) : 0,
           size = step_scan_larger(usual, here);
    noise = finite_or_huge(noise);
    level->truncation = step_scan_larger(level->truncation, change);
    level->rounding = step_scan_larger(level->rounding, noise);
    level->size = step_scan_larger(level->size, here);
    if (size > 0) {
        level->share_truncation =
            step_scan_larger(level->share_truncation, change / size);
        level->share_rounding =
            step_scan_larger(level->share_rounding, noise / size);
    }
}

/* As many steps as there is room for, from `from` on; returns how many. */
static size_t try_steps(const nevh__axis *a, const nevh_gradient *g, size_t at,
                        double unit, size_t from, differences *two,
                        differences *full) {
    double move[BUFFER], x[BUFFER], h[BUFFER];
    size_t fit = a->e->field->capacity / (2 * g->offsets);
    size_t rest = LEVELS + 1 - from, count = rest < fit ? rest : fit;
    double power = ldexp(1, LOWEST - 1 + (int)from);
    for (size_t i = 0; i < count; i++, power *= 2) {
        double delta = power * unit;
        for (size_t j = 0; j < g->offsets; j++) {
            move[2 * j * count + i] = (double)(j + 1) * delta;
            move[(2 * j + 1) * count + i] = -(double)(j + 1) * delta;
        }
    }
    nevh__sample_line(a, at, 2 * g->offsets * count, move, x, h);
    step_scan_difference(nevh_central2, count, x, h, two->slope + from,
                         two->noise + from);
    step_scan_difference(g, count, x, h, full->slope + from,
                         full->noise + from);
    return count;
}

/* Scans from the shortest step at one sample. */
static void scan_at(const nevh__axis *a, const nevh_gradient *g, size_t at,
                    double unit, scan_result *l) {
    differences two, full;
    for (size_t from = 0; from <= LEVELS;)
        from += try_steps(a, g, at, unit, from, &two, &full);
    for (size_t i = 0; i < LEVELS; i++) {
        step_scan_take(&l->two[i], l->usual, two.slope[i + 1], two.slope[i],
                       two.noise[i + 1]);
        step_scan_take(&l->full[i], l->usual, full.slope[i + 1], full.slope[i],
                       full.noise[i + 1]);
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

/* True where steps up to level i leave no doubt that `best` is the level: they were
   good there and are no good at all now, or all of the last few are far worse, as
   over ripples of a wide well.  Its own error is that of the next shorter steps, by
   about the factor of rounding, and its derivatives have the usual size: those of
   values that cancel happen to agree over steps too short for them. */
static bool is_passed(const scan_result *l, const estimate levels[LEVELS],
                      int best, int i) {
    double error = worst(&levels[best]);
    if (levels[i].share_truncation > no_good && error < good)
        return true;
    if (i < best + RISEN || best == 0 || levels[best].size < l->usual / 2 ||
        worst(&levels[best - 1]) > consistent * error)
        return false;
    for (int k = i - RISEN + 1; k <= i; k++)
        if (!(levels[k].share_truncation > far_worse * error))
            return false;
    return true;
}

/* The level of the least error, the longest step of equal ones.  Longer ones than
   those passed are not looked at: they may be whole periods, and agree with each
   other that there is no slope. */
static int best_level(const scan_result *l, const estimate levels[LEVELS],
                      int order) {
    int best = 0;
    for (int i = 1; i < LEVELS && !is_passed(l, levels, best, i); i++)
        if (weighed(&levels[i], order) <= weighed(&levels[best], order))
            best = i;
    return best;
}

/* For a smooth H, also near a singularity, the error of order 2 falls by at most
   about 16 when steps are halved twice.  It falls at once when a kink leaves the
   reach of the steps; the error is then that of steps which reach the kink. */
static double kink(const estimate two[LEVELS]) {
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

/* Level of the step that differences take of a smooth function. */
static int usual_level(int order) {
    return (int)round(log2(DBL_EPSILON) / (order + 1)) - LOWEST;
}

/* True if kinks are operations of the term's formula: samples are seldom as near to
   one as long steps reach. */
static bool has_kinks(const nevh__planned *term) {
    const nevh_term *decl = &term->term->decl;
    return decl->block == nevh__tape_block && nevh__tape_breaks(decl->params);
}

static nevh__step step_scan_choose(const nevh_gradient *g, const scan_result *l,
                                   double unit, bool kinks) {
    int two = best_level(l, l->two, 2);
    if (kinks && two > usual_level(2))
        two = usual_level(2);
    int full = best_level(l, l->full, g->order);
    const estimate *best = &l->full[full];
    if (blind(best))
        return (nevh__step){.delta =
                                ldexp(unit, LOWEST + usual_level(g->order)),
                            .blind = true};
    bool quadratic = kinks || worst(&l->two[two]) <= as_good * worst(best);
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

/* Values of a function of very many variables are dear.  Where there are many
   variables of instances to be looked at, each is at fewer of the states, if
   these are many. */
static size_t sample_stride(const nevh__step_selection *e,
                            const nevh__planned *term) {
    size_t rows = nevh__step_rows(term), looked_at = 0;
    if (term->nv > NEVH__PROBED)
        return 4;
    for (size_t k = 0; k < term->nv; k++)
        looked_at += nevh__probed(term, k) == k ? rows : 0;
    size_t stride = 1 + looked_at / FEW, most = e->samples.count / ENOUGH;
    return stride < most ? stride : most > 1 ? most : 1;
}

/* The median of the derivative's sizes at samples from `at` on. */
static double usual_slope(const nevh__axis *a, double unit, size_t at) {
    const double move[2] = {ldexp(unit, -8), -ldexp(unit, -8)};
    double x[2], h[2], sorted[NEVH__MOST_SAMPLES];
    size_t count = 0;
    for (; at < a->e->samples.count; at += sample_stride(a->e, a->term)) {
        nevh__sample_line(a, at, 2, move, x, h);
        double slope = fabs(nevh__chord_slope(nevh_central2, 1, x, h));
        size_t i = count;
        if (!isfinite(slope))
            continue;
        for (count++; i > 0 && sorted[i - 1] > slope; i--)
            sorted[i] = sorted[i - 1];
        sorted[i] = slope;
    }
    return count ? sorted[count / 2] : 0;
}

nevh__step nevh__scan_line(const nevh__axis *a, const nevh_gradient *g,
                           double length) {
    double unit = exp2(round(log2(length)));
    scan_result l;
    memset(&l, 0, sizeof l);
    /* The pilot may linger where symmetry makes the derivative vanish. */
    l.usual =
        fmax(usual_slope(a, unit, 0), usual_slope(a, unit, a->e->neighbours));
    for (size_t at = 0; at < a->e->samples.count;
         at += sample_stride(a->e, a->term))
        scan_at(a, g, at, unit, &l);
    return step_scan_choose(g, &l, unit, has_kinks(a->term));
}

static nevh__step step_scan_scan(const nevh__axis *a) {
    size_t i = nevh__index(a->term, a->instance, a->k);
    double length = a->e->length[a->k < a->term->nq ? i : a->e->field->n + i];
    return nevh__scan_line(a, a->e->field->gradient, length);
}

void nevh__scan_steps(nevh__step_selection *e, nevh__planned *term) {
    size_t count = term->term->decl.count, stride = nevh__stride(count);
    for (size_t at = 0; at < count * term->nv; at++) {
        size_t instance = at / term->nv, k = at % term->nv;
        size_t from = nevh__probed(term, k);
        nevh__step *own = &term->steps[nevh__step_at(term, instance, k)];
        if (instance % stride == 0 && from == k)
            *own = step_scan_scan(&(nevh__axis){e, term, instance, k});
        else if (instance % stride == 0)
            *own = term->steps[nevh__step_at(term, instance, from)];
        term->delta[at] = own->delta;
    }
}

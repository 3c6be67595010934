/* nevh bench: what a long run says of a short one.

   Theory comes first: the energy error of a symplectic scheme with fixed steps
   swings [G. Benettin, A. Giorgilli, J. Stat. Phys. 74 (1994) 1117-1143] unless
   a run shows otherwise, that of a Runge-Kutta method drifts however it swings
   meanwhile.  What a run of 30 times the length leaves open is asked of runs of
   120 and 480 times, and where a verdict says otherwise of 1920 times.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "verdicts_private.h"
#include <math.h>
#include <string.h>

/* A line through means of blocks, each of WINDOWS / BLOCKS windows. */
enum { BLOCKS = 24 };

typedef struct {
    double largest;            /* |error| */
    double begin, first, last; /* that of a fifteenth, of the thirds */
    double nearest;            /* the least |error| in the last third */
    double own, own_nearest;   /* the largest in the row's own run, the least
                                  in its second half */
    double shift, certainty; /* along the line: over the run, over its error */
    double straightness;     /* share of the blocks that the line explains */
    double allowed;          /* of rounding, at the end */
    double own_allowed;      /* at the end of the row's own run */
} shape;

static double largest(const long_run *r, size_t from, size_t to) {
    double most = 0;
    for (size_t i = from; i < to; i++)
        most = fmax(most, fmax(r->window[i].most, -r->window[i].least));
    return most;
}

static double nearest(const long_run *r, size_t from, size_t to) {
    double least = INFINITY;
    for (size_t i = from; i < to; i++) {
        const window *w = &r->window[i];
        double at = w->least <= 0 && w->most >= 0
                        ? 0
                        : fmin(fabs(w->least), fabs(w->most));
        least = fmin(least, at);
    }
    return least;
}

static void fit(const long_run *r, shape *s) {
    double block[BLOCKS] = {0}, mean = 0, xx = 0, xy = 0, yy = 0;
    for (size_t i = 0; i < WINDOWS; i++)
        block[i * BLOCKS / WINDOWS] += r->window[i].mean * BLOCKS / WINDOWS;
    for (size_t i = 0; i < BLOCKS; i++)
        mean += block[i] / BLOCKS;
    for (size_t i = 0; i < BLOCKS; i++) {
        double x = ((double)i + 0.5) / BLOCKS - 0.5, y = block[i] - mean;
        xx += x * x, xy += x * y, yy += y * y;
    }
    double about = fmax(0, yy - xy * xy / xx);
    s->shift = xy / xx;
    s->straightness = yy > 0 ? 1 - about / yy : 0;
    s->certainty = fabs(s->shift) / sqrt(about / (BLOCKS - 2) / xx + 1e-300);
}

/* own  of the same row, the run whose windows end with the row's own */
static shape shape_of(const long_run *r, const long_run *own) {
    shape s = {.largest = largest(r, 0, WINDOWS)};
    s.begin = largest(r, 0, WINDOWS / 15);
    s.first = largest(r, 0, WINDOWS / 3);
    s.last = largest(r, 2 * WINDOWS / 3, WINDOWS);
    s.nearest = nearest(r, 2 * WINDOWS / 3, WINDOWS);
    size_t part = (size_t)(WINDOWS / own->length);
    s.own = largest(own, 0, part);
    s.own_nearest = nearest(own, part / 2, part);
    s.own_allowed = own->own_allowed > 0 ? (double)own->own_allowed
                                         : 16 * own->noise + 8 * own->wandering;
    s.allowed = 16 * r->noise + 8 * r->wandering * sqrt(r->length);
    fit(r, &s);
    return s;
}

/* Above the energy, and above all effects at the start. */
static double above(const long_run *r) {
    return fmax(1, r->effect);
}

/* That comes back to where it began, as far up as it ever went, in the row's
   own run and at the end, swings. */
static label of_large(const shape *s, const long_run *r, group g) {
    if (s->last > 1.25 * s->first)
        return s->own > above(r) && s->straightness < 0.95 ? IS_UNSTABLE
                                                           : WILL_BE_SO;
    if (g == RUNGE_KUTTA)
        return s->nearest < 0.3 * s->largest ? IS_OPEN : IS_SPENT;
    return s->own > 0.8 * s->largest && s->nearest < 0.3 && s->own_nearest < 0.3
               ? IS_BOUNDED
           : s->own > 0.3 * s->largest ? IS_LARGE
                                       : IS_OPEN;
}

/* Made early, and level since: a loss, or an orbit that went where nothing is
   left to be done wrong. */
static label of_level(const shape *s) {
    return s->largest < 0.1 ? IS_SETTLED : IS_SPENT;
}

static label of_symplectic(const shape *s) {
    bool grows = s->last > 1.4 * s->first && s->last > 2.5 * s->begin;
    bool line = s->straightness > 0.9 && fabs(s->shift) > 0.5 * s->largest;
    if (s->last <= s->allowed)
        return IS_ROUNDING;
    if (s->last <= 1.25 * s->first)
        return s->largest > 0.5 && s->nearest > 0.5 * s->largest ? IS_LARGE
                                                                 : IS_BOUNDED;
    if (s->last - s->first <= s->allowed)
        return IS_ROUNDING;
    return !grows ? IS_OPEN : line ? IS_DRIFTING : IS_WALKING;
}

static label of_runge_kutta(const shape *s) {
    if (s->last <= s->allowed)
        return IS_ROUNDING;
    if (s->nearest > 0.5 * s->largest && fabs(s->shift) < 0.1 * s->largest)
        return of_level(s);
    if (s->straightness > 0.8 && fabs(s->shift) > s->allowed)
        return s->straightness > 0.95 && s->largest < 0.3 ? IS_DRIFTING
                                                          : IS_GROWING;
    if (s->last > 1.4 * s->first)
        return IS_GROWING;
    return s->nearest > 0.5 * s->largest ? of_level(s) : IS_OPEN;
}

static label of_run(const long_run *r, const long_run *own, group g) {
    shape s = shape_of(r, own);
    if (r->reached < r->length * (1 - 1e-9))
        return s.own > above(r)             ? IS_UNSTABLE
               : s.largest > 0.5 * above(r) ? WILL_BE_SO
                                            : IS_OPEN;
    if (s.largest > above(r))
        return of_large(&s, r, g);
    return g == RUNGE_KUTTA ? of_runge_kutta(&s) : of_symplectic(&s);
}

group group_of(const subject *s) {
    const nevh_integrator *scheme = s->scheme;
    nevh_claim claim = nevh_integrator_symplectic(scheme);
    if (nevh_integrator_preserves_energy(scheme) == NEVH_YES)
        return s->plan->balance ? DRIVEN : KEEPING;
    if (claim == NEVH_YES || claim == NEVH_EXTENDED)
        return s->plan->balance ? DRIVEN : SYMPLECTIC;
    return claim == NEVH_NO && nevh_integrator_symmetric(scheme) == NEVH_NO
               ? RUNGE_KUTTA
               : OTHER;
}

/* Of what a run of 30 times the length says, that is to be asked again. */
static bool is_certain(label is, group g) {
    if (is == IS_OPEN || is == IS_LARGE)
        return false;
    return g == RUNGE_KUTTA || is == IS_BOUNDED || is == IS_ROUNDING ||
           is == IS_UNSTABLE;
}

/* What grows in the end has to grow in 30 times the run as well, and above
   rounding. */
static bool grows_at_once(const long_run *r) {
    shape s = shape_of(r, r);
    return s.largest > 3 * s.own && s.largest > 30 * s.allowed;
}

/* What the row's own run shows, whatever comes of it later. */
static bool is_rounding(const long_run *r) {
    shape s = shape_of(r, r);
    return s.own <= s.own_allowed && s.own < above(r) && s.own_allowed < 1e-3;
}

static bool grows(label is) {
    return is == IS_WALKING || is == IS_DRIFTING || is == WILL_BE_SO;
}

/* Theory is believed longer: modes of chains exchange energy in thousands of
   periods.  Friction and forces from outside leave nothing to believe. */
static bool is_long_enough(const truth *known, const subject *s) {
    return known->is == WILL_BE_SO || known->run->spans > 400 ||
           s->plan->balance;
}

/* Relative to the largest energies met so far, what grows with its motion is
   level, as far as the run goes. */
static bool is_carried(const long_run *r) {
    static const double grown = 100;
    size_t all = (size_t)(WINDOWS * fmin(1, r->reached / r->length));
    double met = r->window[0].met, first = 0, last = 0;
    for (size_t i = 0; i < all; i++) {
        met = fmax(met, r->window[i].met);
        double error = largest(r, i, i + 1) / met;
        if (3 * i < all)
            first = fmax(first, error);
        else if (3 * i >= 2 * all)
            last = fmax(last, error);
    }
    return met > grown * r->window[0].met && last <= 2 * first;
}

truth truth_of(const subject *s, double spans, double work, bool doubted) {
    group g = group_of(s);
    const long_run *shortest = long_run_of(s, spans, work);
    truth known = {of_run(shortest, shortest, g), shortest, shortest};
    double most = work * (doubted ? 40 : 4);
    int longer = doubted ? 3 : 2;
    for (int i = 0; i < longer && (doubted || !is_certain(known.is, g)); i++) {
        spans *= 4;
        const long_run *r = long_run_of(s, spans, most);
        if (!is_afforded(r, most))
            break;
        known = (truth){of_run(r, shortest, g), r, shortest};
    }
    if (g != RUNGE_KUTTA && grows(known.is) &&
        (!grows_at_once(shortest) || !is_long_enough(&known, s)))
        known.is = IS_OPEN;
    if (g != RUNGE_KUTTA && grows(known.is) && is_rounding(shortest))
        known.is = IS_ROUNDING;
    if (g != RUNGE_KUTTA && grows(known.is) && s->plan->balance &&
        is_carried(known.run))
        known.is = IS_CARRIED;
    return known;
}

char *truth_evidence(const truth *known) {
    shape s = shape_of(known->run, known->shortest);
    return text_print("error %.2g in the run; %.2g, %.2g in the first and last "
                      "third of %.4g times its length, least %.2g there; line "
                      "%+.2g, R^2 = %.2f; rounding %.1g",
                      s.own, s.first, s.last, known->run->reached, s.nearest,
                      s.shift, s.straightness, s.allowed);
}

const char *label_name(label is) {
    static const char *const names[] = {
        [IS_BOUNDED] = "bounded",    [IS_ROUNDING] = "rounding",
        [IS_LARGE] = "large, level", [IS_WALKING] = "random-walk",
        [IS_DRIFTING] = "drifts",    [IS_GROWING] = "grows",
        [IS_SPENT] = "spent, level", [IS_SETTLED] = "settled",
        [IS_UNSTABLE] = "unstable",  [WILL_BE_SO] = "later unst.",
        [IS_OPEN] = "open",          [IS_CARRIED] = "with motion"};
    return names[is];
}

bool is_right(label is, const char *verdict) {
    static const char *const right[] = {
        [IS_BOUNDED] = "bounded",
        [IS_ROUNDING] = "bounded random-walk",
        [IS_LARGE] = "bounded unstable random-walk",
        [IS_WALKING] = "random-walk",
        [IS_DRIFTING] = "drifts",
        [IS_GROWING] = "drifts random-walk unstable",
        [IS_SPENT] = "drifts random-walk unstable",
        [IS_SETTLED] = "bounded drifts random-walk",
        [IS_UNSTABLE] = "unstable",
        [WILL_BE_SO] = "drifts random-walk unstable",
        [IS_OPEN] = "bounded random-walk drifts unstable",
        [IS_CARRIED] = ""};
    return strcmp(verdict, "undecided") == 0 || strstr(right[is], verdict);
}

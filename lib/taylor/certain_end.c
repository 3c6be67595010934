/* nevh: the end of a solution, as far as two runs agree on it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/certain_inside_private.h"
#include <math.h>

#ifdef NEVH_QUADMATH
typedef nevh__certain_orbit orbit;

static bool has_ended(const orbit *o) {
    return o->pairs ? o->dd.ended : o->quad.ended;
}

static nevh__wide time_of(const orbit *o) {
    return o->pairs ? o->dd.t : o->quad.t;
}

static const nevh__narrow *narrow_of(const orbit *o) {
    return o->pairs ? &o->dd.narrow : &o->quad.narrow;
}

enum { DIGITS = 9 }; /* of the time, at most */

/* off  of the time */
static int fail_passed(nevh_certain *c, double t, double off) {
    double span = fabs(t - (double)c->t0);
    double digits = fmin(floor(log10(span / off)), DIGITS);
    c->passed = true;
    return nevh__fail(&c->report, NEVH_EFAILED,
                      "the solution itself ends at t = %.*g, as far as digits "
                      "tell: it changes without bound there",
                      digits > 1 ? (int)digits : 1, t);
}

int nevh__certain_passed(nevh_certain *c) {
    static const double series = 8;
    const nevh__narrow *fine = narrow_of(&c->fine);
    const nevh__narrow *coarse = narrow_of(&c->coarse);
    double off = fmax(fabs(fine->at - coarse->at), series * coarse->shortest);
    return nevh__narrow_unlike(fine, coarse) ? fail_passed(c, fine->at, off)
                                             : NEVH_OK;
}

/* True if a run that goes on has passed the other's end. */
static bool passes(const orbit *o, double end, double within) {
    static const double shorter = 1e4;
    const nevh__narrow *x = narrow_of(o);
    return !has_ended(o) && nevh__narrow_is(x, shorter) &&
           fabs(x->at - end) <= within;
}

/* Between the ends of both; INFINITY: the other goes on. */
static double between_ends(nevh_certain *c, orbit *other, nevh__wide end,
                           double most) {
    nevh__wide seen = c->seen, later = end + most * (end - c->t0);
    nevh__wide until = (later > seen) == (seen > c->t0) ? seen : later;
    bool timed = !(nevh_system_traits(c->system) & NEVH_AUTONOMOUS);
    nevh__certain_run(c, other, timed ? until : later);
    return has_ended(other) ? fabs((double)(time_of(other) - end)) : INFINITY;
}

/* Runs whose ends are off by a little part shortly before, as one of them is far
   nearer to its own; others that have parted end at times that are chance. */
int nevh__certain_end(nevh_certain *c, int status) {
    static const double most = 1e-4, shortly = 1e3;
    bool coarse = has_ended(&c->coarse);
    if (!status || !(coarse || has_ended(&c->fine)))
        return status;
    nevh__report words = c->report;
    nevh__wide end = time_of(coarse ? &c->coarse : &c->fine);
    double span = fabs((double)(end - c->t0));
    orbit *other = coarse ? &c->fine : &c->coarse;
    double off = between_ends(c, other, end, most);
    c->report = (nevh__report){0};
    if (passes(other, (double)end, most * span) && isinf(c->parted))
        return fail_passed(c, (double)end,
                           fabs(narrow_of(other)->at - (double)end));
    if (c->ending && *c->ending)
        return nevh__fail_as(&c->report, &words);
    if (!(off <= most * span) || span - c->parted > shortly * off)
        return nevh__fail(&c->report, NEVH_EFAILED,
                          "the orbit is not known that far: no digit is left "
                          "of it at t = %.3g, as where it is chaotic",
                          (double)c->t0 + copysign(fmin(c->parted, span),
                                                   (double)(end - c->t0)));
    int digits = off > 0 ? (int)floor(log10(span / off)) : DIGITS;
    if (digits >= DIGITS)
        return nevh__fail_as(&c->report, &words);
    return nevh__fail(&c->report, NEVH_EFAILED,
                      "the solution itself ends at t = %.*g: it changes "
                      "without bound there",
                      digits, (double)end);
}
#endif

/* nevh: exponents with their errors, and the word on an orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/chaos_private.h"
#include <fenv.h>
#include <nevh/simd.h>
#include <math.h>

/* Parts of the run: while displacements align; and while a damped motion, of which
   all may be chaotic at first, comes to its attractor. */
static const double aligning = 0.1, settling = 0.5;
static const double aligned = 1e-8, aligned_by_differences = 1e-6;
static const double significant = 3; /* errors of an exponent of chaos */
/* All growth of chaos, as a logarithm: starts near by, which are 1e-4 apart, have
   long left what is unstable and not chaotic. */
static const double grown = 30;
enum { BINS_A_BATCH = 4, TURNS = 100, CROSSINGS = 40 };

/* The exponent of one start. */
typedef struct {
    double rate, error; /* error: INFINITY where there are too few batches */
} estimate;

static double chaos_report_elapsed(const nevh_chaos *c, size_t start) {
    return c->start[start].clock.done * c->dt;
}

static double dropped(const nevh_chaos *c) {
    return nevh_system_friction(c->system, NULL) ? settling : aligning;
}

static size_t first_bin(const nevh_chaos *c, size_t start) {
    const nevh__chaos_clock *clock = &c->start[start].clock;
    double t = 0, from = dropped(c) * chaos_report_elapsed(c, start);
    size_t b = 0;
    while (b < clock->bin && t < from)
        t += clock->span[b++];
    return b;
}

static double batch_variance(const nevh__chaos_clock *clock, const double g[],
                             size_t first, double rate) {
    double sum = 0;
    size_t count = 0;
    for (size_t b = first; b + BINS_A_BATCH <= clock->bin; b += BINS_A_BATCH) {
        double growth = 0, time = 0;
        for (size_t k = 0; k < BINS_A_BATCH; k++) {
            growth += g[b + k];
            time += clock->span[b + k];
        }
        sum += pow(growth / time - rate, 2);
        count++;
    }
    return count > 2 ? sum / (double)((count - 1) * count) : INFINITY;
}

static estimate estimate_start(const nevh_chaos *c, size_t start, size_t log) {
    const nevh__chaos_clock *clock = &c->start[start].clock;
    const double *g = c->start[start].log + log * NEVH__BINS;
    double growth = 0, time = 0;
    size_t first = first_bin(c, start);
    for (size_t b = first; b <= clock->bin && b < NEVH__BINS; b++) {
        growth += g[b];
        time += clock->span[b];
    }
    double rate = growth / time;
    return (estimate){rate, sqrt(batch_variance(clock, g, first, rate))};
}

/* Adds the growth in the first half of a start's time, and in the second. */
static void add_halves(const nevh_chaos *c, size_t start, size_t log,
                       double growth[2], double time[2]) {
    const nevh__chaos_clock *clock = &c->start[start].clock;
    size_t first = first_bin(c, start);
    double t = 0, all = 0;
    for (size_t b = first; b <= clock->bin && b < NEVH__BINS; b++)
        all += clock->span[b];
    for (size_t b = first; b <= clock->bin && b < NEVH__BINS; b++) {
        bool second = t + clock->span[b] / 2 > all / 2;
        growth[second] += c->start[start].log[log * NEVH__BINS + b];
        time[second] += clock->span[b];
        t += clock->span[b];
    }
}

/* The exponent that linear growth leaves. */
static double resolution(const nevh_chaos *c, size_t start) {
    double part = dropped(c);
    return -log(part) / ((1 - part) * chaos_report_elapsed(c, start));
}

double nevh__chaos_rate(const nevh_chaos *c, size_t start, size_t i) {
    return chaos_report_elapsed(c, start) > 0 ? estimate_start(c, start, i).rate
                                              : NAN;
}

double nevh__chaos_megno(const nevh_chaos *c, size_t start) {
    double t = chaos_report_elapsed(c, start);
    return t > 0 ? c->start[start].area / t : 0;
}

double nevh__chaos_aligned(const nevh_chaos *c) {
    return c->tangent ? aligned : aligned_by_differences;
}

/* In a plane orbits do not mix. */
static bool has_room(const nevh_chaos *c) {
    return c->n > 1 || !(nevh_system_traits(c->system) & NEVH_AUTONOMOUS);
}

double nevh__chaos_growth(const nevh_chaos *c, size_t start) {
    const nevh__chaos_start *s = &c->start[start];
    double sum = 0;
    for (size_t b = 0; b <= s->clock.bin && b < NEVH__BINS; b++)
        sum += s->log[b];
    return sum;
}

/* True if the orbit itself keeps changing, as chaos requires: it neither rests nor
   escapes as fast as its neighbours. */
static bool wanders(const nevh_chaos *c, size_t start) {
    static const double at_rest = 1e-6; /* in lengths of H */
    double moved = c->start[start].moved;
    return moved > at_rest && log(moved) < nevh__chaos_growth(c, start) / 2;
}

/* The crossings of the pair of variables that has made the fewest, of those that
   move; INFINITY where none does. */
static double fewest_crossings(const nevh_chaos *c, size_t start) {
    static const double still = 1e-9; /* a range, in lengths of H */
    double fewest = INFINITY;
    for (size_t k = 0; k < c->n; k++) {
        const nevh__course *q = &c->start[start].course[k], *p = q + c->n;
        if (q->high - q->low > still && p->high - p->low > still)
            fewest = fmin(fewest, fmax(q->crossings, p->crossings));
    }
    return fewest;
}

/* The slowest pair of variables has gone to and fro often enough, or neighbours
   come together. */
static bool has_recurred(const nevh_chaos *c, size_t start, double rate,
                         double error) {
    return chaos_report_elapsed(c, start) >= TURNS * c->period &&
           (rate < -2 * error || fewest_crossings(c, start) >= CROSSINGS);
}

static nevh_chaos_verdict verdict_on(const nevh_chaos *c, size_t start) {
    double t = chaos_report_elapsed(c, start);
    if (!(t > 0))
        return NEVH_EARLY;
    estimate e = estimate_start(c, start, 0);
    double least = resolution(c, start),
           error = nevh_simd_hypot(e.error, least);
    double megno = nevh__chaos_megno(c, start);
    if (e.rate > significant * error && megno > 4 &&
        c->start[start].sali < nevh__chaos_aligned(c)) {
        if (!has_room(c) || !wanders(c, start))
            return NEVH_UNSTABLE_ORBIT;
        return nevh__chaos_growth(c, start) > grown ? NEVH_CHAOTIC : NEVH_EARLY;
    }
    if (e.rate < 2 * error && megno < 2.5 && isfinite(error) &&
        has_recurred(c, start, e.rate, error))
        return NEVH_REGULAR;
    return NEVH_EARLY;
}

/* The error is the largest of three: starts near by differ, and batches in time;
   and all of them may come from where chaos is stronger than it is elsewhere,
   which halves of the run tell. */
static double find_exponent(const nevh_chaos *c, size_t i, double *error) {
    double sum = 0, squares = 0, variance = 0, count = 0;
    double growth[2] = {0, 0}, time[2] = {0, 0};
    if (error)
        *error = INFINITY;
    if (!c || !c->planned || i >= c->exponents ||
        !(chaos_report_elapsed(c, 0) > 0))
        return NAN;
    nevh_chaos_verdict verdict = verdict_on(c, 0);
    for (size_t k = 0; k < c->starts; k++) {
        if (k && verdict_on(c, k) != verdict)
            continue;
        estimate e = estimate_start(c, k, i);
        sum += e.rate;
        squares += e.rate * e.rate;
        variance += e.error * e.error;
        add_halves(c, k, i, growth, time);
        count++;
    }
    double mean = sum / count;
    double between =
        count > 1 ? fmax(0, squares - sum * mean) / (count - 1) / count : 0;
    double within = variance / (count * count);
    double change = (growth[1] / time[1] - growth[0] / time[0]) / 2;
    double largest = fmax(fmax(between, within), change * change);
    if (error)
        *error = nevh_simd_hypot(sqrt(largest), resolution(c, 0));
    return mean;
}

double nevh_chaos_exponent(const nevh_chaos *c, size_t i, double *error) {
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    double mean = find_exponent(c, i, error);
    fesetenv(&own);
    return mean;
}

static size_t starts_of(const nevh_chaos *c, nevh_chaos_verdict verdict) {
    size_t count = 0;
    for (size_t k = 0; k < c->starts; k++)
        count += verdict_on(c, k) == verdict;
    return count;
}

/* An orbit that is the only chaotic one is an unstable one.  The mean exponent of
   all that agree must be significant, too. */
static nevh_chaos_verdict verdict_among_starts(const nevh_chaos *c) {
    static const size_t enough = 4; /* starts to judge by */
    nevh_chaos_verdict own = verdict_on(c, 0);
    if (own == NEVH_REGULAR && c->kinks)
        return NEVH_UNRESOLVED;
    if (own != NEVH_CHAOTIC)
        return own;
    double error, value = nevh_chaos_exponent(c, 0, &error);
    if (!(value > significant * error))
        return NEVH_EARLY;
    if (c->starts < enough || starts_of(c, NEVH_CHAOTIC) > 1)
        return own;
    size_t others =
        starts_of(c, NEVH_REGULAR) + starts_of(c, NEVH_UNSTABLE_ORBIT);
    return 2 * others > c->starts ? NEVH_UNSTABLE_ORBIT : NEVH_EARLY;
}

nevh_chaos_report nevh_chaos_result(const nevh_chaos *c) {
    nevh_chaos_report r = {0};
    if (!c || !c->planned)
        return r;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    r.t = c->t_start + c->way * chaos_report_elapsed(c, 0);
    r.verdict = verdict_among_starts(c);
    r.sali = c->start[0].sali;
    r.megno = nevh__chaos_megno(c, 0);
    r.kinks = c->kinks > 0;
    r.starts = c->starts;
    r.agreeing = starts_of(c, verdict_on(c, 0));
    fesetenv(&own);
    return r;
}

double nevh_chaos_gali(const nevh_chaos *c, size_t k) {
    return c && c->planned && k >= 2 && k <= c->deviations ? c->start[0].gali[k]
                                                           : NAN;
}

const char *nevh_chaos_verdict_name(nevh_chaos_verdict verdict) {
    static const char *const names[] = {"early", "chaotic", "regular",
                                        "unstable", "unresolved"};
    size_t i = (size_t)verdict;
    return i < sizeof names / sizeof *names ? names[i] : "unknown";
}

/* nevh: settings that are good enough, and what they cost.

   Each method is given the coarsest setting, on a sequence of eight levels for
   each doubling of steps (or tenfold tolerance), that keeps the state error
   below the target and whose next finer one does so, too: no lucky crossings.
   Then all take turns in every round, so that a machine that slows down does
   so for all.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _POSIX_C_SOURCE 200809L
#include "bench.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { LEVELS = 8, TOLERANCES = 17, FEWEST_STEPS = 4, DOUBLINGS = 24 };
const double targets[TARGETS] = {1e-3, 1e-6, 1e-9, 1e-12};
static const double least_time = 0.002; /* CPU seconds of a turn */

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool timed_run(const method *m, void *run, double y[], double *seconds) {
    double start = now(), own = -1;
    bool done = m->run(run, y, &own);
    *seconds = own >= 0 ? own : now() - start;
    return done;
}

double one_run(const library *l, const method *m, const problem *p,
               double setting, const double ranges[], double *seconds) {
    double y[2 * MOST_N];
    void *run = m->open(m, p, setting);
    (void)l;
    *seconds = INFINITY;
    if (!run)
        return INFINITY;
    bool done = timed_run(m, run, y, seconds);
    m->close(run);
    return done ? problem_error(p, ranges, y) : INFINITY;
}

static double setting_at(const method *m, int level) {
    return m->adaptive
               ? pow(10, -(double)level / LEVELS)
               : floor(FEWEST_STEPS * pow(2, (double)level / LEVELS) + 0.5);
}

static int last_level(const method *m) {
    return LEVELS * (m->adaptive ? TOLERANCES : DOUBLINGS);
}

/* A search under way. */
typedef struct {
    const library *library;
    const method *method;
    const problem *problem;
    const double *ranges;
    double longest; /* CPU seconds that a run may take, unless it fails, or a
                       coarser one took more; nevh's implicit schemes, which
                       struggle where steps are too long, may once */
    double target;
    double before; /* what the last run took */
    int slow;      /* runs that took too long, one after another */
} search;

static bool good(search *s, int level, double *error, bool *too_long) {
    double seconds;
    *error = one_run(s->library, s->method, s->problem,
                     setting_at(s->method, level), s->ranges, &seconds);
    bool slow =
        *error < INFINITY && seconds > s->longest && seconds > s->before;
    s->slow = slow ? s->slow + 1 : 0;
    *too_long = s->slow > (s->library->ahead ? 1 : 0);
    s->before = seconds;
    return *error <= s->target;
}

/* The level, or -1 where there is none, and its error. */
static int find_level(search *s, int from, double *error) {
    bool too_long = false;
    double finer;
    int level = from;
    while (!good(s, level, error, &too_long)) {
        level += LEVELS;
        if (too_long || level > last_level(s->method))
            return -1;
    }
    if (s->library->outside)
        return level;
    for (int i = level - LEVELS + 1; i < level; i++)
        if (i >= 0 && good(s, i, &finer, &too_long) &&
            (i + 1 == level || good(s, i + 1, error, &too_long))) {
            *error = finer;
            return i;
        }
    return level;
}

void find_entries(contest *c, const problem *p, const double ranges[],
                  double longest) {
    for (size_t i = 0; i < c->library_count; i++) {
        const library *l = c->libraries[i];
        for (const method *m = l->methods; m < l->methods + l->count; m++) {
            int level = 0;
            for (size_t k = 0; k < TARGETS && level >= 0; k++) {
                entry e = {
                    .problem = p, .library = l, .method = m, .target = k};
                search s = {l, m, p, ranges, longest, targets[k], INFINITY, 0};
                s.longest *= l->outside ? 5 : 1;
                level = find_level(&s, level, &e.error);
                e.setting = setting_at(m, level);
                if (level >= 0 && c->count < MOST_ENTRIES)
                    c->entries[c->count++] = e;
            }
        }
    }
}

static double take_turn(const entry *e, void *run) {
    double y[2 * MOST_N], sum = 0, seconds, start = now();
    for (size_t i = 0; i < e->runs; i++) {
        double own = -1;
        e->method->run(run, y, &own);
        sum += own;
    }
    seconds = e->library->outside ? sum : now() - start;
    return seconds / (double)e->runs;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double quantile(size_t count, const double from[], double part) {
    double sorted[MOST_ROUNDS];
    memcpy(sorted, from, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, by_size);
    return sorted[(size_t)(part * (double)(count - 1) + 0.5)];
}

/* Runs of a turn: enough for least_time.  What takes long is not repeated as
   often. */
static void calibrate(entry *e, void *run, size_t rounds) {
    e->runs = 1;
    double seconds = take_turn(e, run);
    e->rounds = seconds > 50 * least_time && rounds > 3 ? 3 : rounds;
    while (seconds * (double)e->runs < least_time) {
        e->runs *= 2;
        seconds = take_turn(e, run);
    }
}

void play(contest *c, const problem *p) {
    static void *runs[MOST_ENTRIES];
    for (size_t i = 0; i < c->count; i++)
        if (c->entries[i].problem == p) {
            entry *e = &c->entries[i];
            runs[i] = e->method->open(e->method, p, e->setting);
            calibrate(e, runs[i], c->rounds);
        }
    for (size_t round = 0; round < c->rounds; round++)
        for (entry *e = c->entries; e < c->entries + c->count; e++)
            if (e->problem == p && round < e->rounds)
                e->seconds[round] = take_turn(e, runs[e - c->entries]);
    for (entry *e = c->entries; e < c->entries + c->count; e++)
        if (e->problem == p) {
            e->method->close(runs[e - c->entries]);
            e->median = quantile(e->rounds, e->seconds, 0.5);
            e->spread = (quantile(e->rounds, e->seconds, 0.75) -
                         quantile(e->rounds, e->seconds, 0.25)) /
                        e->median;
        }
}

const entry *fastest(const contest *c, const library *l, const problem *p,
                     size_t target) {
    const entry *best = NULL;
    for (const entry *e = c->entries; e < c->entries + c->count; e++)
        if (e->problem == p && e->library == l && e->target == target &&
            (!best || e->median < best->median))
            best = e;
    return best;
}

const entry *fastest_peer(const contest *c, const problem *p, size_t target) {
    const entry *best = NULL;
    for (size_t i = 0; i < c->library_count; i++) {
        const library *l = c->libraries[i];
        const entry *e =
            l->ahead || l->outside ? NULL : fastest(c, l, p, target);
        if (e && (!best || e->median < best->median))
            best = e;
    }
    return best;
}

double ratio(const entry *a, const entry *b) {
    double ratios[MOST_ROUNDS];
    size_t rounds = a->rounds < b->rounds ? a->rounds : b->rounds;
    for (size_t i = 0; i < rounds; i++)
        ratios[i] = a->seconds[i] / b->seconds[i];
    return quantile(rounds, ratios, 0.5);
}

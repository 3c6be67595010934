/* nevh: what a search for steps may cost, and where it is.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "study.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static const double one_row =
    0.0125; /* of the budget, or more of few schemes */
static const double one_scheme = 0.16;
static const double most_seconds = 60;

static int coarse_to_fine(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

static double *ordered(const double numbers[], size_t count) {
    double *copy = tool_allocate(count, sizeof *copy);
    memcpy(copy, numbers, count * sizeof *copy);
    qsort(copy, count, sizeof *copy, coarse_to_fine);
    return copy;
}

/* CPU seconds of compilers that have ended. */
static double seconds_of_children(void) {
    struct rusage children;
    getrusage(RUSAGE_CHILDREN, &children);
    return (double)children.ru_utime.tv_sec +
           1e-6 * (double)children.ru_utime.tv_usec;
}

search search_begin(const plan *p, const options *o, double budget) {
    search s = {.plan = *p,
                .repeats = o->search.repeats,
                .quiet = o->quiet,
                .budget = budget,
                .seconds = o->search.budget > 0 ? budget : most_seconds,
                .started = cpu_seconds(),
                .compiled = seconds_of_children(),
                .unit = plan_longest_dt(p)};
    s.landing = grid_dt(8 * s.unit, 0);
    s.plan.screening = true;
    s.plan.by_state = o->search.by || o->observable;
    s.plan.work_limit =
        budget * fmax(one_row, one_scheme / (double)p->integrators.count);
    if (o->dt.count) {
        s.dt = ordered(p->dt, s.dts = p->dts);
        s.tolerance = ordered(p->tolerance, s.tolerances = p->tolerances);
        s.landing = s.unit;
    }
    return s;
}

const char *search_error(const search *s) {
    return !s->plan.by_state    ? "energy"
           : s->plan.observable ? "observable"
                                : "state";
}

bool search_out_of_time(const search *s, double share) {
    double passed = cpu_seconds() - s->started;
    return passed + seconds_of_children() - s->compiled > share * s->seconds;
}

/* True, too, on a machine so slow, or of schemes whose plans take so long, that the
   seconds end before the work does. */
bool search_is_over(const search *s, double share) {
    return s->spent > share * s->budget || search_out_of_time(s, share);
}

bool search_may_time(const search *s) {
    static const double enough = 0.8; /* of the budget */
    return cpu_seconds() - s->started < enough * s->budget;
}

static bool shows_progress(const search *s) {
    return !s->quiet && cpu_seconds() - s->started > 1 && isatty(STDERR_FILENO);
}

void search_progress(const search *s, const row *r) {
    if (!shows_progress(s))
        return;
    fprintf(stderr, "\r\033[K%zu runs: %s, %s, %s = %g", s->runs, r->integrator,
            r->gradient, r->tolerance > 0 ? "tolerance" : "dt",
            r->tolerance > 0 ? r->tolerance : r->dt);
    fflush(stderr);
}

void search_end(search *s) {
    if (shows_progress(s))
        fputs("\r\033[K", stderr);
}

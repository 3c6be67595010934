/* nevh: how long rows take that nobody watches.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>
#include <string.h>

static const double part = 0.002; /* seconds, of a row that takes longer */

typedef struct {
    const plan *plan;
    const row *row;
    nevh_stepper *stepper;
    double *q, *p;
    double share;    /* of the run that is timed */
    double *seconds; /* of the whole, by each time */
} stopwatch;

static stopwatch stopwatch_new(const plan *p, const row *r, size_t rounds) {
    stopwatch w = {.plan = p,
                   .row = r,
                   .stepper = row_stepper_to_time(p, r),
                   .q = tool_allocate(p->n, sizeof *w.q),
                   .p = tool_allocate(p->n, sizeof *w.p),
                   .share = 1,
                   .seconds = tool_allocate(rounds, sizeof *w.seconds)};
    return w;
}

static void stopwatch_free(stopwatch *w) {
    tool_release(w->q);
    tool_release(w->p);
    tool_release(w->seconds);
}

static int stop_after(void *data, size_t step, double t, const double q[],
                      const double p[]) {
    const size_t *steps = data;
    (void)t, (void)q, (void)p;
    return step < *steps ? NEVH_OK : NEVH_STOPPED;
}

/* Takes as many steps as the observed run, or the first of them. */
static void run(const stopwatch *w) {
    const plan *p = w->plan;
    const row *r = w->row;
    double start = p->run->t_start;
    double most = ceil((r->t_end - start) / r->step);
    double steps = fmax(1, round(w->share * most));
    bool whole = w->share >= 1 || steps >= most;
    double t_end = whole ? p->t_end : start + steps * r->step;
    size_t taken = r->steps;
    nevh_run_until(w->stepper, start, r->step, t_end, w->q, w->p,
                   &(nevh_observer){stop_after, &taken, taken},
                   whole && isfinite(r->stopped));
}

/* Seconds of the whole run, by the work of what was run of it. */
static double time_once(const stopwatch *w, double *spent) {
    const plan *p = w->plan;
    const row *r = w->row;
    nevh_counts before = nevh_stepper_counts(w->stepper);
    memcpy(w->q, p->q, p->n * sizeof *w->q);
    memcpy(w->p, p->p, p->n * sizeof *w->p);
    nevh_stepper_reset(w->stepper);
    double begin = cpu_seconds();
    run(w);
    *spent = cpu_seconds() - begin;
    nevh_counts c = row_counts(w->stepper, before);
    double work = nevh_counts_seconds(&c, p->n, r->scheme, r->order,
                                      nevh_stepper_taken(w->stepper));
    if (work == 0) /* it stopped at its start */
        return *spent;
    return *spent *
           nevh_counts_seconds(&r->counts, p->n, r->scheme, r->order,
                               r->steps) /
           work;
}

/* So much of the run as takes long enough, by what a short first try took. */
static void choose_share(stopwatch *w) {
    static const double tried = 0.25; /* of that */
    double spent;
    if (part >= w->row->observed_seconds)
        return;
    w->share = tried * part / w->row->observed_seconds;
    time_once(w, &spent);
    w->share = fmin(1, w->share * part / spent);
}

static void finish(const stopwatch *w, row *r, size_t rounds) {
    r->native = nevh_stepper_native(w->stepper, NULL);
    r->seconds = numbers_median(w->seconds, rounds);
    r->fastest = fmin(r->fastest, w->seconds[0]);
    r->spread = (w->seconds[3 * rounds / 4] - w->seconds[rounds / 4]) / 2;
}

void rows_time(const plan *p, row *const rows[], size_t count, size_t rounds,
               bool whole) {
    stopwatch *w = tool_allocate(count, sizeof *w);
    double spent;
    rows_choose_native(p, rows, count, false);
    for (size_t i = 0; i < count; i++) {
        w[i] = stopwatch_new(p, rows[i], rounds);
        if (!whole)
            choose_share(&w[i]);
    }
    for (size_t k = 0; k < rounds; k++)
        for (size_t i = 0; i < count; i++)
            w[i].seconds[k] = time_once(&w[i], &spent);
    for (size_t i = 0; i < count; i++) {
        finish(&w[i], rows[i], rounds);
        row_stepper_keep(p, rows[i], false, w[i].stepper);
        stopwatch_free(&w[i]);
    }
    tool_release(w);
}

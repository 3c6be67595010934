/* nevh: rows whose verdict their run leaves open, followed further.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Lengths of the run: the most, and what is worth it at least. */
static const double most = 32, least = 4;
/* What following may take, as row_work counts.  A run that leaves no room for
   the least is long as it is. */
static const double allowed = 8;

typedef struct {
    nevh_energy *energy;
    double start, span, times; /* at so many lengths the verdict is asked for */
    nevh_energy_report report;
    nevh_verdict verdict;
} follower;

static int ask(void *data, size_t step, double t, const double q[],
               const double p[]) {
    follower *f = data;
    int status = nevh_energy_observe(f->energy, step, t, q, p);
    if (status || t - f->start < f->times * f->span * (1 - 1e-9))
        return status;
    f->report = nevh_energy_result(f->energy, 0);
    f->verdict = nevh_energy_verdict(&f->report, f->times);
    f->times *= 2;
    return f->verdict == NEVH_UNDECIDED ? NEVH_OK : NEVH_STOPPED;
}

static double lengths(const plan *p, const row *r) {
    double once = row_work(p, r->scheme, r->order, &r->counts, r->steps);
    double work = p->follow > 0 ? p->follow : allowed;
    double times = once > 0 ? fmin(most, work / once) : most;
    return times < least ? 1 : exp2(floor(log2(times)));
}

/* From the start, since the orbit is the same again. */
static int run(const plan *p, const row *r, nevh_stepper *s, follower *f,
               double times) {
    double *q = tool_allocate(p->n, sizeof *q), stopped;
    double *m = tool_allocate(p->n, sizeof *m);
    plan longer = *p;
    longer.t_end = f->start + times * f->span;
    memcpy(q, p->q, p->n * sizeof *q);
    memcpy(m, p->p, p->n * sizeof *m);
    int status = plan_run(&longer, s, r->step, q, m,
                          &(nevh_observer){ask, f, 1}, 1, &stopped);
    free(q);
    free(m);
    return status;
}

/* What is left open is judged by as much as was seen: there is no more. */
static void end(follower *f, int status) {
    if (f->verdict != NEVH_UNDECIDED)
        return;
    f->report = nevh_energy_result(f->energy, 0);
    bool failed = status != NEVH_OK && status != NEVH_STOPPED;
    if (failed && !(f->report.max <= f->report.limit))
        f->verdict = NEVH_UNSTABLE;
    else
        f->verdict = nevh_energy_verdict(&f->report, INFINITY);
}

bool row_drifts(const row *r) {
    return r->energy.verdict == NEVH_DRIFTS ||
           (r->energy.verdict == NEVH_UNDECIDED &&
            r->energy.theory == NEVH_THEORY_LOSES);
}

void row_follow(const plan *p, row *r) {
    double start = p->run->t_start, times;
    if (!r->ran || r->energy.verdict != NEVH_UNDECIDED || isfinite(r->stopped))
        return;
    times = lengths(p, r);
    if (times < least) {
        r->energy.verdict = nevh_energy_verdict(&r->energy, INFINITY);
        return;
    }
    nevh_stepper *s = row_stepper(p, r, p->balance);
    follower f = {.energy = row_energy(p, r, s),
                  .start = start,
                  .span = r->t_end - start,
                  .times = 2,
                  .verdict = NEVH_UNDECIDED};
    end(&f, run(p, r, s, &f, times));
    r->energy.verdict = f.verdict;
    r->followed = f.report.span / f.span;
    r->longer = f.report;
    nevh_energy_free(f.energy);
    row_stepper_keep(p, r, p->balance, s);
}

/* nevh: the outcomes lyapunov, sali and megno, which tell chaos.

   They are of orbits of their own, with displacements, which nevh_chaos takes
   side by side.  Where other outcomes are asked for too, an orbit waits here,
   with these, until there are enough.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/chaos_private.h"
#include "ensemble/ensemble_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = 32, QUEUE = 256, MOST_NUMBERS = 1 << 14 };

/* An orbit whose other outcomes are known. */
typedef struct {
    uint64_t member;
    double until;
    double *start;  /* 2n */
    double *values; /* columns */
} waiting;

struct nevh__chaotic {
    nevh_chaos *chaos;
    nevh__chaos_jobs jobs;
    bool alone; /* no other outcome is asked for, and nothing stops an orbit */
    waiting *queue;
    size_t queued, taken;
    double *began; /* n rows of coordinates, then of momenta, of the lanes */
    double numbers[];
};

static double lyapunov(const nevh__chaos_member *found) {
    return found->exponent;
}

static double sali(const nevh__chaos_member *found) {
    return found->sali;
}

static double megno(const nevh__chaos_member *found) {
    return found->megno;
}

const nevh__outcome_type nevh__outcome_lyapunov = {
    .info = {.name = "lyapunov",
             .unit = NEVH_UNIT_RATE,
             .help = "the largest Lyapunov exponent"},
    .of_chaos = lyapunov,
};
const nevh__outcome_type nevh__outcome_sali = {
    .info = {.name = "sali",
             .help = "the alignment of two displacements; of chaos below 1e-8"},
    .of_chaos = sali,
};
const nevh__outcome_type nevh__outcome_megno = {
    .info = {.name = "megno",
             .help = "the mean growth of displacements; 2 of a regular orbit"},
    .of_chaos = megno,
};

/* The number of outcomes that are indicators of chaos. */
static size_t count_of_chaos(const nevh_ensemble *e) {
    size_t count = 0;
    for (size_t i = 0; i < e->n_outcomes; i++)
        count += e->outcomes[i].type->of_chaos != NULL;
    return count;
}

static bool asks(const nevh_ensemble *e, const nevh__outcome_type *type) {
    for (size_t i = 0; i < e->n_outcomes; i++)
        if (e->outcomes[i].type == type)
            return true;
    return false;
}

static size_t choose_starts(const nevh_ensemble *e, size_t deviations) {
    size_t own = e->options.width ? e->options.width : LANES / deviations;
    size_t starts = nevh__padded(own);
    while (!e->options.width && starts > NEVH__LANES &&
           8 * e->n * starts > MOST_NUMBERS)
        starts /= 2;
    return starts;
}

static int plan_chaos(nevh_ensemble *e, const nevh_options *options) {
    size_t deviations = asks(e, &nevh__outcome_sali) ? 2 : 1;
    nevh_chaos_options o = {.integrator = e->options.integrator,
                            .options = options,
                            .t_start = e->options.t_start,
                            .dt = e->options.dt,
                            .starts = choose_starts(e, deviations),
                            .deviations = deviations};
    nevh__chaotic *x = e->chaotic;
    if (!options->q || !options->p)
        return nevh__fail(&e->report, NEVH_EINVAL,
                          "chaos: lengths are those of H at the state to plan "
                          "at, and H is not finite there: choose another");
    x->chaos = nevh__chaos_of_members(e->system, &o);
    if (nevh_chaos_status(x->chaos))
        return nevh__fail(&e->report, nevh_chaos_status(x->chaos), "%s",
                          nevh_chaos_message(x->chaos));
    return nevh__chaos_batch_plan(x->chaos) ? NEVH_OK
                                            : nevh__no_memory(&e->report);
}

int nevh__chaotic_plan(nevh_ensemble *e) {
    size_t each = 2 * e->n + e->columns, lanes = 2 * e->n * e->width;
    size_t count = count_of_chaos(e);
    if (!count)
        return NEVH_OK;
    nevh__chaotic *x = e->chaotic =
        nevh__array(1, sizeof *x + (lanes + QUEUE * each) * sizeof(double));
    if (!x || !(x->queue = nevh__array(QUEUE, sizeof *x->queue)))
        return nevh__no_memory(&e->report);
    x->began = x->numbers;
    for (size_t i = 0; i < QUEUE; i++) {
        x->queue[i].start = x->numbers + lanes + i * each;
        x->queue[i].values = x->queue[i].start + 2 * e->n;
    }
    x->alone = count == e->n_outcomes && !e->options.stop.value;
    x->jobs = (nevh__chaos_jobs){
        .data = e,
        .sparse = !asks(e, &nevh__outcome_megno),
        .aligned =
            !asks(e, &nevh__outcome_megno) && !asks(e, &nevh__outcome_lyapunov),
        .together = e->together,
    };
    return plan_chaos(e, e->options.options);
}

void nevh__chaotic_free(nevh__chaotic *x) {
    if (!x)
        return;
    nevh_chaos_free(x->chaos);
    free(x->queue);
    free(x);
}

void nevh__chaotic_begin(nevh_ensemble *e, size_t lane) {
    double *to = e->chaotic->began + lane;
    for (size_t k = 0; k < e->n; k++) {
        to[k * e->width] = e->q1[k];
        to[(e->n + k) * e->width] = e->p1[k];
    }
}

/* Columns that tell chaos. */
static void fill_in(const nevh_ensemble *e, const nevh__chaos_member *found,
                    double values[]) {
    for (size_t i = 0; i < e->n_outcomes; i++) {
        const nevh__outcome_type *type = e->outcomes[i].type;
        if (type->of_chaos)
            *values = type->of_chaos(found);
        values += type->whole_state ? 2 * e->n : 1;
    }
}

static int chaotic_hand_on(nevh_ensemble *e, uint64_t member,
                           const nevh__chaos_member *found, double values[]) {
    for (size_t i = 0; found->status && i < e->columns; i++)
        values[i] = NAN;
    if (!found->status)
        fill_in(e, found, values);
    nevh_member_result result = {member, found->status, found->message, values};
    e->stopped = e->done(e->data, &result) != 0 || e->stopped;
    return e->stopped;
}

/* Orbits that wait. */

static bool next_waiting(void *ensemble, uint64_t *at, double q[], double p[],
                         double *until) {
    const nevh_ensemble *e = ensemble;
    nevh__chaotic *x = e->chaotic;
    if (x->taken == x->queued)
        return false;
    *at = x->taken++;
    memcpy(q, x->queue[*at].start, e->n * sizeof *q);
    memcpy(p, x->queue[*at].start + e->n, e->n * sizeof *p);
    *until = x->queue[*at].until;
    return true;
}

static int done_waiting(void *ensemble, const nevh__chaos_member *found) {
    nevh_ensemble *e = ensemble;
    const waiting *w = &e->chaotic->queue[found->member];
    return chaotic_hand_on(e, w->member, found, w->values);
}

static void run_jobs(nevh_ensemble *e, nevh__chaos_jobs jobs) {
    jobs.ending = e->ending;
    nevh__chaos_batch_run(e->chaotic->chaos, &jobs);
    e->stopped |= nevh__ensemble_ends(e);
}

static void run_waiting(nevh_ensemble *e) {
    nevh__chaotic *x = e->chaotic;
    nevh__chaos_jobs jobs = x->jobs;
    jobs.next = next_waiting;
    jobs.done = done_waiting;
    x->taken = 0;
    run_jobs(e, jobs);
    x->queued = 0;
}

void nevh__chaotic_queue(nevh_ensemble *e, size_t lane) {
    nevh__chaotic *x = e->chaotic;
    waiting *w = &x->queue[x->queued++];
    w->member = e->lanes[lane].member;
    w->until = e->lanes[lane].t;
    for (size_t i = 0; i < 2 * e->n; i++)
        w->start[i] = x->began[i * e->width + lane];
    memcpy(w->values, e->result, e->columns * sizeof *w->values);
    if (x->queued == QUEUE)
        run_waiting(e);
}

void nevh__chaotic_finish(nevh_ensemble *e) {
    if (!e->stopped && e->chaotic->queued)
        run_waiting(e);
    e->chaotic->queued = 0;
}

/* Orbits of which nothing else is asked. */

static bool next_alone(void *ensemble, uint64_t *member, double q[], double p[],
                       double *until) {
    const nevh_ensemble *e = ensemble;
    *until = e->options.t_end;
    return !e->stopped && e->next(e->data, member, q, p);
}

static int done_alone(void *ensemble, const nevh__chaos_member *found) {
    nevh_ensemble *e = ensemble;
    return chaotic_hand_on(e, found->member, found, e->result);
}

bool nevh__chaotic_run(nevh_ensemble *e) {
    if (!e->chaotic->alone)
        return false;
    nevh__chaos_jobs jobs = e->chaotic->jobs;
    jobs.next = next_alone;
    jobs.done = done_alone;
    run_jobs(e, jobs);
    return true;
}

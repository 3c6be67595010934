/* nevh: the explicit Adams method of two steps.

   With the slopes f at the last two states, which are the step h1 apart,

       y' = y + h ((1 + r/2) f(y) - r/2 f(y1)),   r = h/h1.

   A lane without a last state, or whose step is longer than the last one or goes
   back, takes a step of Heun's method.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "adams_bashforth_private.h"
#include <math.h>
#include <string.h>

/* Blocks of n rows in the memory, then the row of h1; 0: there is none.  The
   last state is kept for the balance of the energy. */
enum {
    COMPENSATION_Q,
    COMPENSATION_P,
    LAST_DQ,
    LAST_DP,
    LAST_Q,
    LAST_P,
    BLOCKS
};
/* In scratch: slopes at the state and at the end of Euler's step, which is in
   CHANGE_Q and CHANGE_P until they hold what the step adds; points of the balance
   of the energy. */
enum { DQ, DP, END_DQ, END_DP, CHANGE_Q, CHANGE_P, AT_Q, AT_P, SCRATCH };

static int plan(nevh_work *w) {
    w->memory_rows = BLOCKS * w->n + 1;
    w->scratch_size = SCRATCH * w->size + w->width;
    return NEVH_OK;
}

static double *block(double *from, const nevh_work *w, size_t which) {
    return from + which * w->size;
}

/* r of a lane; 0: it starts afresh. */
static double ratio(const nevh_work *w, double h, size_t lane) {
    double last = block(w->memory, w, BLOCKS)[lane];
    double r = last != 0 ? h / last : 0;
    return r > 0 && r <= 1 ? r : 0;
}

/* dq/dt and dp/dt. */
static int take_slopes(nevh_work *w, double t, const double q[],
                       const double p[], double dq[], double dp[]) {
    double *time = block(w->scratch, w, SCRATCH);
    for (size_t lane = 0; lane < w->width; lane++)
        time[lane] = t;
    int status = nevh_work_gradient(w, w->width, time, q, p, dp, dq);
    for (size_t i = 0; !status && i < w->size; i++)
        dp[i] = -dp[i] - (w->friction ? w->friction[i / w->width] * p[i] : 0);
    return status;
}

static int take_end(nevh_work *w, double t, double h, const double q[],
                    const double p[]) {
    double *at = w->scratch, *end_q = block(at, w, CHANGE_Q);
    double *end_p = block(at, w, CHANGE_P);
    for (size_t i = 0; i < w->size; i++) {
        bool fresh = ratio(w, h, i % w->width) == 0;
        end_q[i] = q[i] + (fresh ? h * block(at, w, DQ)[i] : 0);
        end_p[i] = p[i] + (fresh ? h * block(at, w, DP)[i] : 0);
    }
    return take_slopes(w, t + h, end_q, end_p, block(at, w, END_DQ),
                       block(at, w, END_DP));
}

/* Finds the changes of q and p together, whose blocks are consecutive. */
static void find_change(const nevh_work *w, double h) {
    const double *now = block(w->scratch, w, DQ);
    const double *end = block(w->scratch, w, END_DQ);
    const double *last = block(w->memory, w, LAST_DQ);
    double *change = block(w->scratch, w, CHANGE_Q);
    for (size_t i = 0; i < 2 * w->size; i++) {
        double r = ratio(w, h, i % w->width);
        change[i] = r == 0 ? h / 2 * now[i] + h / 2 * end[i]
                           : h * (now[i] + r / 2 * (now[i] - last[i]));
    }
}

/* The time of a group of derivatives. */
typedef enum { NOW, END, LAST } place;

/* A group of points: lanes that start afresh, and others, each at a place. */
static int account_at(nevh_work *w, double t, double h, const double q[],
                      const double p[], double weight, place fresh,
                      place other) {
    const double *end = block(w->scratch, w, CHANGE_Q);
    const double *last = block(w->memory, w, LAST_Q);
    double *at = block(w->scratch, w, AT_Q),
           *time = block(w->scratch, w, SCRATCH);
    for (size_t lane = 0; lane < w->width; lane++) {
        place is = ratio(w, h, lane) == 0 ? fresh : other;
        time[lane] = is == NOW   ? t
                     : is == END ? t + h
                                 : t - block(w->memory, w, BLOCKS)[lane];
        for (size_t i = lane; i < w->size; i += w->width) {
            at[i] = is == NOW ? q[i] : is == END ? end[i] : last[i];
            at[w->size + i] = is == NOW   ? p[i]
                              : is == END ? end[w->size + i]
                                          : last[w->size + i];
        }
    }
    return nevh_work_account(w, NEVH_OF_Q | NEVH_OF_P, weight, time, at,
                             at + w->size);
}

/* A lane is told the same points in the same order whatever others are; all that
   have a last state have one r, and a step whose r is not 1 is rare. */
static int account(nevh_work *w, double t, double h, const double q[],
                   const double p[]) {
    double r = 0;
    for (size_t lane = 0; lane < w->width; lane++)
        r = fmax(r, ratio(w, h, lane));
    bool usual = r == 0 || r == 1;
    int status = account_at(w, t, h, q, p, h, NOW, NOW);
    if (!status)
        status = account_at(w, t, h, q, p, h / 2, END, NOW);
    if (!status)
        status = account_at(w, t, h, q, p, -h / 2, NOW, usual ? LAST : NOW);
    if (!status && !usual)
        status = account_at(w, t, h, q, p, h * r / 2, NOW, NOW);
    if (!status && !usual)
        status = account_at(w, t, h, q, p, -h * r / 2, NOW, LAST);
    return status;
}

static void remember(nevh_work *w, double h, const double slopes[],
                     const double state[]) {
    memcpy(block(w->memory, w, LAST_DQ), slopes, 2 * w->size * sizeof *slopes);
    memcpy(block(w->memory, w, LAST_Q), state, 2 * w->size * sizeof *state);
    for (size_t lane = 0; lane < w->width; lane++)
        block(w->memory, w, BLOCKS)[lane] = h;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    double *slopes = w->scratch, *change = block(slopes, w, CHANGE_Q);
    double *compensation = w->memory, *state = block(slopes, w, END_DQ);
    bool any = false;
    for (size_t lane = 0; lane < w->width; lane++)
        any |= ratio(w, h, lane) == 0;
    int status = take_slopes(w, t, q, p, slopes, block(slopes, w, DP));
    if (!status && any)
        status = take_end(w, t, h, q, p);
    if (!status && w->accounts)
        status = account(w, t, h, q, p);
    if (status)
        return status;
    find_change(w, h);
    memcpy(state, q, w->size * sizeof *q); /* the ends are used up */
    memcpy(state + w->size, p, w->size * sizeof *p);
    status = nevh_work_commit(w, w->size, q, change, compensation, p,
                              change + w->size, compensation + w->size);
    if (!status)
        remember(w, h, slopes, state);
    return status;
}

const nevh_kernel nevh__adams_bashforth_kernel = {
    .plan = plan, .step = step, .has_friction = true};

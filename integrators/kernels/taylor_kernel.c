/* nevh: steps along Taylor series.

   An orbit is a chain of series, each of which holds as far as its last two
   coefficients say that the tolerance allows: no step h of the caller's cuts
   one short, and states between their ends are their values.  So the chain does
   not depend on h, unless that is very short.  The state at the beginning of a
   series is kept with the digits that its double lost.

   With a tolerance below rounding, and long doubles in the processor, the first
   coefficients, too, have the digits that doubles lose: they are those of the state
   with all its digits, taken in long double.  The others add so little to a step that
   their rounding is far below that of the state, so errors of steps are nearly those
   of long double.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor_private.h"
#include "taylor/series_private.h"
#include "work/work_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef nevh__taylor_plan taylor_plan;
typedef nevh__taylor_chain chain;

static chain chain_at(const nevh_work *w, double *from) {
    const taylor_plan *plan = w->plan;
    return (chain){.begun = from,
                   .since = from + 1,
                   .since_roundoff = from + 2,
                   .reach = from + 3,
                   .unit = from + 4,
                   .roundoff = from + NEVH__TAYLOR_HEAD,
                   .rows = from + NEVH__TAYLOR_HEAD + 2 * w->n,
                   .lost =
                       from + NEVH__TAYLOR_HEAD + 2 * w->n * (plan->order + 2)};
}

/* The size of order k, relative to the state; times a power of two. */
static double size_of(const nevh_work *w, const double rows[], size_t k,
                      int shift) {
    double most = 0;
    for (size_t i = 0; i < 2 * w->n; i++) {
        double x = fabs(rows[k * 2 * w->n + i]);
        double size = x / fmax(fabs(rows[i]), w->scale[i]);
        most = size > most ? size : most;
    }
    return ldexp(most, shift);
}

/* The length for which a series holds, in its unit.  Lengths are powers of two in
   units in which the state changes by itself in about 1, so that other units of
   time or length give the same digits. */
static double reach_of(const nevh_work *w, const double rows[]) {
    const taylor_plan *plan = w->plan;
    int exponent = 0;
    const double per_two = 1.4426950408889634; /* log2(e) */
    double tolerance = per_two * nevh_simd_log(w->options->tolerance);
    double reach = INFINITY;
    double rate = size_of(w, rows, 1, 0);
    if (rate > 0)
        frexp(rate, &exponent);
    for (size_t k = plan->order; k >= plan->order / 2; k--) {
        double size =
            per_two * nevh_simd_log(size_of(w, rows, k, -(int)k * exponent));
        reach =
            fmin(reach, nevh__series_reach(plan->order, tolerance, k, size));
    }
    return ldexp(nevh_simd_exp(reach / per_two), -exponent);
}

/* The state at a time since the beginning, in 2n; as its change, which is then
   added.  Odd and even powers are two sums, which do not wait for each other. */
static void change_at(const nevh_work *w, const chain *z, double since,
                      double change[]) {
    const taylor_plan *plan = w->plan;
    size_t each = 2 * w->n;
    size_t last = plan->order - (plan->order % 2 == 0); /* the last odd one */
    since /= *z->unit;
    double square = since * since;
    for (size_t i = 0; i < each; i++) {
        const double *row = z->rows + last * each + i;
        double odd = row[0], even = plan->order > last ? row[each] : 0;
        for (size_t k = last; k > 1; k -= 2) {
            row -= 2 * each;
            odd = odd * square + row[0];
            even = even * square + row[each];
        }
        change[i] = (odd + even * since) * since + z->roundoff[i];
    }
}

static void state_at(const nevh_work *w, const chain *z, double since,
                     double state[]) {
    change_at(w, z, since, state);
    for (size_t i = 0; i < 2 * w->n; i++)
        state[i] += z->rows[i];
}

/* A time since the beginning, so much later. */
static void pass(const chain *z, double time) {
    double sum = *z->since + time;
    *z->since_roundoff += nevh__roundoff(sum, *z->since, time);
    double whole = sum + *z->since_roundoff;
    *z->since_roundoff = nevh__roundoff(whole, sum, *z->since_roundoff);
    *z->since = whole;
}

/* Finds the rounding errors of the first coefficients, from the state with all its
   digits. */
static void find_lost(const nevh_work *w, const chain *z, double t) {
    const taylor_plan *plan = w->plan;
    size_t each = 2 * w->n;
    long double *rows = plan->first_rows,
                *state = rows + (NEVH__TAYLOR_FIRST + 1) * each;
    for (size_t i = 0; i < each; i++)
        state[i] = (long double)z->rows[i] + z->roundoff[i];
    nevh__series_in_long(plan->first, *z->unit);
    bool known = nevh__series_expand_long(plan->first, t, state, rows);
    for (size_t i = 0; i < NEVH__TAYLOR_FIRST * each; i++) {
        double x = z->rows[each + i];
        z->lost[i] = known ? (double)(rows[each + i] - x) : 0;
    }
}

static const double *watched_by(const taylor_plan *plan, const chain *z) {
    return plan->code && *z->unit == 1
               ? plan->watched
               : nevh__series_watched_double(plan->series);
}

/* Why there is no series at t that holds for long, where a domain has an edge. */
static int fail_at_edge(nevh_work *w, const chain *z, double t) {
    const taylor_plan *plan = w->plan;
    char why[200];
    size_t edge = nevh__domain_edge(plan->recurrence, watched_by(plan, z),
                                    plan->order, *z->reach / *z->unit);
    if (edge == SIZE_MAX)
        return NEVH_OK;
    nevh__domain_words(plan->recurrence, edge, why, sizeof why);
    return nevh_work_fail(w, NEVH_EDOM,
                          "%s ended near t = %.9g: " NEVH__SERIES_EDGE,
                          w->integrator->name, t, why);
}

/* The unit of compiled series, 1, unless coefficients might overflow or underflow. */
static double unit_for(const taylor_plan *plan, double h) {
    int exponent = h != 0 ? ilogb(h) : 0;
    return abs(exponent) * (int)plan->order > 512 ? ldexp(1, exponent) : 1;
}

/* The first of them are compared with those of the recurrence. */
static bool expand_compiled(taylor_plan *plan, size_t each, double t,
                            const double state[], double rows[]) {
    enum { COMPARED = 3 };
    size_t bytes = (plan->order + 1) * each * sizeof *rows;
    bool finite =
        plan->code && plan->code(plan->numbers, t, state, rows, plan->watched);
    double *coded = NULL;
    if (plan->code && plan->compared == COMPARED)
        return finite;
    if (plan->code && finite && (coded = malloc(bytes)))
        memcpy(coded, rows, bytes);
    finite = nevh__series_expand_double(plan->series, t, state, rows);
    if (coded && finite && memcmp(coded, rows, bytes) != 0) {
        plan->code = NULL;
        *plan->differs = true;
    }
    plan->compared += plan->code != NULL;
    free(coded);
    return finite;
}

static bool expand(taylor_plan *plan, size_t each, double t,
                   const double state[], const chain *z) {
    nevh__series_in_double(plan->series, *z->unit);
    return *z->unit == 1
               ? expand_compiled(plan, each, t, state, z->rows)
               : nevh__series_expand_double(plan->series, t, state, z->rows);
}

/* A series at the state in rows, for the time t. */
static int begin(nevh_work *w, const chain *z, double t, double h) {
    taylor_plan *plan = w->plan;
    size_t each = 2 * w->n;
    double *state = w->scratch + w->scratch_size - each;
    memcpy(state, z->rows, each * sizeof *state);
    w->field->gradients++;
    if (*z->begun == 0)
        *z->reach = fabs(h);
    *z->unit = unit_for(plan, h);
    bool finite = expand(plan, each, t, state, z);
    if (!finite && fail_at_edge(w, z, t))
        return NEVH_EDOM;
    if (!finite)
        return nevh_work_fail(w, NEVH_EDOM, NEVH__SERIES_NOT_FINITE, t);
    if (NEVH__TAYLOR_LONGER && plan->first)
        find_lost(w, z, t);
    double reach =
        fmin(reach_of(w, z->rows), plan->longest * fabs(h) / *z->unit);
    *z->reach =
        *z->unit * nevh__domain_reach(plan->recurrence, watched_by(plan, z),
                                      plan->order, reach);
    *z->begun = 1;
    return NEVH_OK;
}

/* The state `step` later, in rows and roundoff, with all digits: terms of low orders
   in long double. */
static void pass_finely(const nevh_work *w, const chain *z, double step) {
    const taylor_plan *plan = w->plan;
    size_t each = 2 * w->n;
    step /= *z->unit;
    for (size_t i = 0; i < each; i++) {
        const double *row = z->rows + i;
        double high = 0;
        for (size_t k = plan->order; k > NEVH__TAYLOR_FIRST; k--)
            high = high * step + row[k * each];
        long double sum = high;
        for (size_t k = NEVH__TAYLOR_FIRST; k > 0; k--)
            sum = sum * step +
                  ((long double)row[k * each] + z->lost[(k - 1) * each + i]);
        sum = sum * step + z->roundoff[i] + row[0];
        z->rows[i] = (double)sum;
        z->roundoff[i] = (double)(sum - z->rows[i]);
    }
}

static void pass_state(const nevh_work *w, const chain *z, double step) {
    size_t each = 2 * w->n;
    double *change = w->scratch + w->scratch_size - 2 * each;
    change_at(w, z, step, change);
    for (size_t i = 0; i < each; i++) {
        double sum = z->rows[i] + change[i];
        z->roundoff[i] = nevh__roundoff(sum, z->rows[i], change[i]);
        z->rows[i] = sum;
    }
}

/* The next series of the chain, `step` later. */
static int go_on(nevh_work *w, const chain *z, double step, double t,
                 double h) {
    const taylor_plan *plan = w->plan;
    if (NEVH__TAYLOR_LONGER && plan->first)
        pass_finely(w, z, step);
    else
        pass_state(w, z, step);
    pass(z, -step);
    return begin(w, z, t, h);
}

/* Gauss points and weights on -1 ... 1, for the balance of the energy. */
static const double points[] = {0.1834346424956498, 0.5255324099163290,
                                0.7966664774136267, 0.9602898564975363};
static const double weights[] = {0.3626837833783620, 0.3137066458778873,
                                 0.2223810344533745, 0.1012285362903763};

/* Accounts for the part of a series up to `until` since its beginning; `later`: the
   time then. */
static int account(nevh_work *w, const chain *z, double from, double until,
                   double later) {
    double *state = w->scratch + w->scratch_size - 2 * w->n;
    double half = (until - from) / 2, middle = from + half;
    int status = NEVH_OK;
    for (int i = 0; !status && i < 8 && half != 0; i++) {
        double since = middle + (i % 2 ? half : -half) * points[i / 2];
        double t = later - (until - since);
        state_at(w, z, since, state);
        status =
            nevh_work_account(w, NEVH_OF_Q | NEVH_OF_P, half * weights[i / 2],
                              &t, state, state + w->n);
    }
    return status;
}

static int give_up(const nevh_work *w, double t, double h, const char *why) {
    return nevh_work_fail((nevh_work *)w, NEVH_EFAILED,
                          "%s gave up at t = %.9g: the step of %g takes %s at "
                          "a tolerance of %g",
                          w->integrator->name, t, h, why,
                          w->options->tolerance);
}

/* Advances by h, to the time `end`. */
static int advance(nevh_work *w, const chain *z, double end, double h) {
    nevh__pace pace = {0};
    char why[NEVH__WHY];
    double from = *z->since;
    int status = NEVH_OK;
    pass(z, h);
    while (!status && fabs(*z->since) > *z->reach) {
        double step = copysign(*z->reach, *z->since);
        double left = fabs(*z->since) - *z->reach;
        double t = end - copysign(left, *z->since);
        bool ends = !(*z->reach > DBL_EPSILON * fabs(h) / 8) || t - step == t;
        if (ends && fail_at_edge(w, z, t - step))
            return NEVH_EDOM;
        if (ends)
            return give_up(w, t, h, "series too short to be taken");
        if (nevh__too_many(&pace, fabs(h), fmax(0, fabs(h) - left), why))
            return give_up(w, t, h, why);
        if (w->accounts)
            status = account(w, z, from, step, t);
        from = 0;
        if (!status)
            status = go_on(w, z, step, t, h);
    }
    if (!status && w->accounts)
        status = account(w, z, from, *z->since, end);
    return status;
}

/* True if the series at hand has the state after h. */
static bool reaches(const chain *z, double h) {
    return *z->begun != 0 && fabs(*z->since + h) < 0.999 * *z->reach;
}

/* One lane, whose chain is its own copy. */
static int take(nevh_work *w, const chain *z, double t, double h) {
    int status = *z->begun != 0 ? NEVH_OK : begin(w, z, t, h);
    return status ? status : advance(w, z, t + h, h);
}

static int step_one(nevh_work *w, double t, double h, double q[], double p[]) {
    chain z = chain_at(w, w->memory);
    size_t n = w->n,
           size = nevh__taylor_chain_size(w->n, w->plan) * sizeof(double);
    bool copied = !reaches(&z, h) || w->accounts;
    double *state = w->scratch + w->scratch_size - 2 * n;
    if (copied) {
        memcpy(w->scratch, w->memory, size);
        z = chain_at(w, w->scratch);
    }
    if (*z.begun == 0) {
        memcpy(z.rows, q, n * sizeof *q);
        memcpy(z.rows + n, p, n * sizeof *p);
    }
    int status = NEVH_OK;
    if (copied)
        status = take(w, &z, t, h);
    else
        pass(&z, h);
    if (status)
        return status;
    state_at(w, &z, *z.since, state);
    if (nevh__not_finite(1, n, state, state + n)) {
        if (!copied)
            pass(&z, -h);
        return nevh__fail_range(w, t, h);
    }
    if (copied)
        memcpy(w->memory, w->scratch, size);
    memcpy(q, state, n * sizeof *q);
    memcpy(p, state + n, n * sizeof *p);
    return NEVH_OK;
}

/* Steps of one lane, step i from t0 + i h; *steps: out, how many there are. */
static int take_some(nevh_work *w, const chain *z, double t0, double h,
                     size_t from, size_t *steps) {
    size_t done = 0;
    int status = NEVH_OK;
    while (done < *steps &&
           !(status = take(w, z, t0 + (double)(from + done) * h, h)))
        done++;
    *steps = done;
    return status;
}

/* Lanes one after the other, through copies of their columns. */
static int step_lanes(nevh_work *w, double t0, double h, size_t from,
                      size_t *steps, double q[], double p[]) {
    size_t n = w->n, width = w->width,
           size = nevh__taylor_chain_size(w->n, w->plan);
    double *state = w->scratch + w->scratch_size - 2 * n;
    int status = NEVH_OK;
    for (size_t lane = 0; !status && lane < width; lane++) {
        double *at = w->scratch + lane * size;
        chain z = chain_at(w, at);
        for (size_t i = 0; i < size; i++)
            at[i] = w->memory[i * width + lane];
        for (size_t k = 0; *z.begun == 0 && k < n; k++) {
            z.rows[k] = q[k * width + lane];
            z.rows[n + k] = p[k * width + lane];
        }
        status = take_some(w, &z, t0, h, from, steps);
        if (status)
            break;
        state_at(w, &z, *z.since, state);
        if (nevh__not_finite(1, n, state, state + n)) {
            *steps = 0;
            status = nevh__fail_range(w, t0 + (double)from * h, h);
        }
    }
    for (size_t lane = 0; !status && lane < width; lane++) {
        double *at = w->scratch + lane * size;
        chain z = chain_at(w, at);
        state_at(w, &z, *z.since, state);
        for (size_t k = 0; k < n; k++) {
            q[k * width + lane] = state[k];
            p[k * width + lane] = state[n + k];
        }
        for (size_t i = 0; i < size; i++)
            w->memory[i * width + lane] = at[i];
    }
    return status;
}

static bool holds(const nevh_work *w, const double memory[], double h) {
    chain z = chain_at(w, (double *)memory);
    return reaches(&z, h) && *z.since * (*z.since + h) >= 0;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    if (w->accounts && w->width > 1)
        return nevh_work_fail(w, NEVH_EINVAL,
                              "the balance of the energy under step control is "
                              "kept for one orbit, not for %zu side by side",
                              w->width);
    size_t one = 1;
    return w->width == 1 ? step_one(w, t, h, q, p)
                         : step_lanes(w, t, h, 0, &one, q, p);
}

size_t nevh__taylor_run(nevh_work *w, double t0, double h, size_t from,
                        size_t steps, double q[], double p[]) {
    size_t done = steps;
    while (done && step_lanes(w, t0, h, from, &done, q, p))
        ;
    return done;
}

const nevh_kernel nevh__taylor_kernel = {.plan = nevh__taylor_plan_new,
                                         .step = step,
                                         .clear = nevh__taylor_clear,
                                         .has_friction = true,
                                         .own_slopes = true,
                                         .holds = holds};

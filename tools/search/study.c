/* nevh: one integrator and gradient at many steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "study.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double rounding = 1e-13;
static const double usable_below = 0.5; /* of the scale of errors */

/* As much as a run that is watched costs. */
enum { RUNS_A_ROW = 2 };

study study_new(const plan *p, const char *integrator, const char *gradient) {
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(p, integrator, &transformed);
    return (study){.integrator = integrator,
                   .gradient = gradient,
                   .scheme = scheme,
                   .exact = plan_is_exact(p, scheme)};
}

study study_like(const study *l, const char *gradient) {
    return (study){.integrator = l->integrator,
                   .gradient = gradient,
                   .scheme = l->scheme,
                   .keeps = l->keeps,
                   .exact = l->exact};
}

double study_error(const row *r) {
    double error = !r->by_state    ? r->energy.max
                   : r->observable ? r->observable_error
                                   : r->state_error;
    return r->ran && isfinite(error) ? error : INFINITY;
}

/* The scene's own is 1. */
static double grid_step(const study *l, int k) {
    return nevh_integrator_adaptive(l->scheme) ? grid_tolerance(k)
                                               : grid_dt(1, k);
}

static void set_step(const search *s, row *r, int k) {
    if (nevh_integrator_adaptive(r->scheme)) {
        r->dt = s->landing;
        r->tolerance = s->dt ? s->tolerance[k] : grid_tolerance(k);
    } else {
        r->dt = s->dt ? s->dt[k] : grid_dt(s->unit, k);
    }
}

static size_t insert(study *l, size_t i, int k, row r) {
    size_t after = l->count - i;
    l->level = tool_grown(l->level, l->count, sizeof *l->level);
    l->k = tool_grown(l->k, l->count, sizeof *l->k);
    memmove(l->level + i + 1, l->level + i, after * sizeof *l->level);
    memmove(l->k + i + 1, l->k + i, after * sizeof *l->k);
    l->level[i] = r, l->k[i] = k;
    l->count++;
    return i;
}

static void forget(study *l, size_t i) {
    l->count--;
    memmove(l->level + i, l->level + i + 1, (l->count - i) * sizeof *l->level);
    memmove(l->k + i, l->k + i + 1, (l->count - i) * sizeof *l->k);
}

static void run_row(search *s, const plan *p, row *r) {
    search_progress(s, r);
    row_run(p, r);
    s->spent += RUNS_A_ROW * r->work;
    s->runs++;
}

size_t study_run(search *s, study *l, int k) {
    size_t i = 0;
    while (i < l->count && l->k[i] < k)
        i++;
    if (i < l->count && l->k[i] == k)
        return i;
    row r = {.integrator = l->integrator,
             .gradient = l->gradient,
             .scheme = l->scheme};
    set_step(s, &r, k);
    run_row(s, &s->plan, &r);
    return insert(l, i, k, r);
}

static bool is_usable(const study *l, size_t i) {
    return study_error(&l->level[i]) < usable_below;
}

bool study_fits_steps(const search *s, int k) {
    static const double least = 8;
    return grid_dt(s->unit, k) * least <= s->plan.t_end - s->plan.run->t_start;
}

/* To coarser ones, of which only those that are usable stay, as long as they
   save something: sweeps may cost more than steps save. */
static void ascend(search *s, study *l) {
    static const double saves = 0.9;
    enum { STRIDES = 6 };
    for (int i = 0; i < STRIDES && !search_is_over(s, 1); i++) {
        int k = l->k[0] - GRID_STRIDE;
        if (!study_fits_steps(s, k))
            return;
        study_run(s, l, k);
        if (!is_usable(l, 0)) {
            forget(l, 0);
            return;
        }
        if (l->level[0].work > saves * l->level[1].work)
            return;
    }
}

static void run_given(search *s, study *l) {
    size_t count = nevh_integrator_adaptive(l->scheme) ? s->tolerances : s->dts;
    for (size_t i = 0; i < count; i++)
        study_run(s, l, (int)i);
    l->end = STUDY_GIVEN;
}

/* True if the scheme is documented to keep the energy. */
static bool is_kept(const search *s, const study *l) {
    return !s->plan.by_state && !s->keeping &&
           nevh_integrator_preserves_energy(l->scheme) == NEVH_YES;
}

/* True if the energy is kept at steps so long that orbits are not: coarse steps run
   on past the end if it comes too soon. Schemes documented to do so are not tried;
   Gauss schemes do, too, for a quadratic H. */
static bool keeps_at_any_step(search *s, const study *l) {
    static const double kept = 1e-8, steps = 8;
    enum { DOUBLINGS = 7 };
    if (nevh_integrator_adaptive(l->scheme) || !l->count)
        return false;
    bool keeps = study_error(&l->level[0]) < kept;
    plan longer = s->plan;
    longer.reference = NULL;
    for (int i = 1; keeps && i <= DOUBLINGS && !search_is_over(s, 1); i++) {
        row r = {.integrator = l->integrator,
                 .gradient = l->gradient,
                 .scheme = l->scheme,
                 .dt = ldexp(l->level[0].dt, i)};
        longer.t_end = fmax(s->plan.t_end, s->plan.run->t_start + steps * r.dt);
        run_row(s, &longer, &r);
        keeps = study_error(&r) < kept;
    }
    return keeps;
}

/* The scene's dt is one for schemes of order 2 to 4. */
static int first_place(const search *s, const study *l) {
    int order = nevh_integrator_order(l->scheme);
    int k = 0;
    for (int coarser = order >= 8 ? 2 : order >= 6; coarser; coarser--)
        if (study_fits_steps(s, k - GRID_STRIDE))
            k -= GRID_STRIDE;
    return k;
}

static void find_out_whether_kept(search *s, study *l) {
    l->keeps = !s->plan.by_state && !plan_is_exact(&s->plan, l->scheme) &&
               (nevh_integrator_preserves_energy(l->scheme) == NEVH_YES ||
                keeps_at_any_step(s, l));
}

void study_begin(search *s, study *l) {
    enum { FIRST_TOLERANCE = 2 * GRID_STRIDE };
    bool adapts = nevh_integrator_adaptive(l->scheme);
    if (s->dt) {
        run_given(s, l);
        find_out_whether_kept(s, l);
        return;
    }
    if (search_is_over(s, 0.5) || search_out_of_time(s, 0.25)) {
        l->end = STUDY_LIMIT;
        return;
    }
    int k = adapts ? FIRST_TOLERANCE : first_place(s, l);
    size_t i = study_run(s, l, k);
    if (l->level[i].over_limit)
        l->end = STUDY_LIMIT;
    else if (!l->level[i].ran && !l->level[i].failed)
        l->end = STUDY_REFUSED;
    else if (!adapts && is_usable(l, i) && !is_kept(s, l))
        ascend(s, l);
    find_out_whether_kept(s, l);
    if (!s->plan.by_state && !s->keeping && study_keeps_energy(l))
        l->end = STUDY_FLOOR;
}

static double next_work(const study *l) {
    double stretch = nevh_integrator_adaptive(l->scheme)
                         ? pow(10, 1.0 / nevh_integrator_order(l->scheme))
                         : 2;
    return stretch * l->level[l->count - 1].work;
}

study *study_next(study studies[], size_t count) {
    study *next = NULL;
    for (size_t i = 0; i < count; i++)
        if (studies[i].end == STUDY_OPEN &&
            (!next || next_work(&studies[i]) < next_work(next)))
            next = &studies[i];
    return next;
}

/* Levels at the end that brought next to nothing.  Those of looser tolerances
   than the distance of outputs asks for are the same run. */
static size_t count_level(const study *l) {
    static const double flat = 0.7, same = 0.99;
    size_t count = 0;
    for (size_t i = l->count; i-- > 1; count++) {
        const row *fine = &l->level[i], *coarse = &l->level[i - 1];
        if (!(study_error(fine) > flat * study_error(coarse)) ||
            fine->dt > same * coarse->dt)
            break;
    }
    return count;
}

/* True if shorter steps do not help: after one of them near rounding, elsewhere
   after several, since errors of coarse steps may be level, too. */
static bool is_level(const study *l) {
    static const double small = 1e-11, usual = 1e-2;
    size_t count = count_level(l);
    size_t chance = l->level[0].tolerance > 0; /* as outputs cut its steps */
    double last = study_error(&l->level[l->count - 1]);
    double first = study_error(&l->level[0]);
    return last <= rounding || (count > chance && last < small) ||
           (count > 1 && last < 0.1 * first) || (count > 2 && last < usual);
}

bool study_ends_level(const study *l) {
    return l->count && !l->level[l->count - 1].over_limit && is_level(l);
}

/* Coarse levels were of no use once a finer one is of some. */
static void drop_useless(study *l) {
    while (l->count > 1 && !is_usable(l, 0) && is_usable(l, l->count - 1))
        forget(l, 0);
}

/* The level that took too long has no numbers. */
static void give_up(study *l) {
    l->end = STUDY_LIMIT;
    if (l->count > 1)
        forget(l, l->count - 1);
}

/* True if the first step failed at each of the last few lengths; shorter ones would
   fail, too. */
static bool cannot_begin(const study *l) {
    enum { TRIES = 6 };
    size_t count = 0;
    for (size_t i = l->count; i-- > 0 && count < TRIES; count++)
        if (!l->level[i].failed || l->level[i].over_limit ||
            l->level[i].steps > 0)
            break;
    return count == TRIES;
}

void study_descend(search *s, study *l) {
    const row *last = &l->level[l->count - 1];
    bool finest = l->level[0].tolerance > 0 && last->tolerance < 1e-13;
    if (cannot_begin(l)) {
        l->end = STUDY_FAILED;
    } else if (finest || is_level(l)) {
        l->end = STUDY_FLOOR;
    } else if (next_work(l) > s->plan.work_limit) {
        l->end = STUDY_LIMIT;
    } else {
        study_run(s, l, l->k[l->count - 1] + GRID_STRIDE);
        if (l->level[l->count - 1].over_limit)
            give_up(l);
        drop_useless(l);
    }
}

/* The factor by which the other study must work less. */
static double lead(const study *l, const study *other, bool useless) {
    static const double behind = 2, far_behind = 8;
    bool higher = nevh_integrator_order(other->scheme) >=
                  nevh_integrator_order(l->scheme);
    if (useless)
        return higher ? far_behind : INFINITY;
    return higher ? behind : far_behind;
}

bool study_is_behind(const search *s, const study *l, const study others[],
                     size_t count) {
    const row *last = &l->level[l->count - 1];
    double error = study_error(last);
    bool useless = error >= usable_below;
    for (size_t i = 0; i < count; i++) {
        const study *m = &others[i];
        double factor = lead(l, m, useless);
        for (size_t k = 0; k < m->count; k++)
            if (m->gradient == l->gradient && !m->exact &&
                (s->plan.by_state || !study_keeps_energy(m)) &&
                study_error(&m->level[k]) <= fmin(error, usable_below) &&
                factor * m->level[k].work < last->work)
                return true;
    }
    return false;
}

void study_time(const search *s, study *l, size_t i) {
    row *r = &l->level[i];
    if (!r->ran || isfinite(r->seconds))
        return;
    rows_time(&s->plan, &r, 1,
              s->repeats           ? s->repeats
              : search_may_time(s) ? ROUNDS
                                   : 1,
              s->repeats > 0);
}

/* The first level that keeps the target. */
static size_t first_below(const study *l, double target) {
    size_t i = 0;
    while (i < l->count && study_error(&l->level[i]) > target)
        i++;
    return i;
}

/* A place strictly between levels i - 1 and i: where the target is expected. */
static int place_between(const study *l, size_t i, double target) {
    double step[2], error[2];
    for (size_t j = 0; j < 2; j++) {
        step[j] = grid_step(l, l->k[i - 1 + j]);
        error[j] = study_error(&l->level[i - 1 + j]);
    }
    int k = l->k[i] - 1;
    if (isinf(error[0]))
        return k;
    double wanted = grid_between(step, error, target);
    while (k > l->k[i - 1] + 1 && grid_step(l, k) < wanted)
        k--;
    return k;
}

/* Adds levels up to the next stride when the coarsest level keeps the target; the
   stride itself was unusable or too long for the run. */
static void refine_top(search *s, study *l, double target, int gap) {
    int beyond = l->k[0] - GRID_STRIDE;
    while (study_error(&l->level[0]) <= target && l->k[0] - beyond > gap &&
           !search_is_over(s, 1)) {
        int middle = beyond + (l->k[0] - beyond) / 2;
        bool runs = study_fits_steps(s, middle);
        if (runs)
            study_run(s, l, middle);
        if (!runs || !is_usable(l, 0))
            beyond = middle;
        if (runs && !is_usable(l, 0))
            forget(l, 0);
    }
}

void study_refine(search *s, study *l, double target, int gap) {
    enum { SECANTS = 2 };
    if (l->end == STUDY_GIVEN || l->end == STUDY_REFUSED || !l->count)
        return;
    if (!nevh_integrator_adaptive(l->scheme) && (!l->topped || gap < l->topped))
        refine_top(s, l, target, gap), l->topped = gap;
    for (int runs = 0; !search_is_over(s, 1); runs++) {
        size_t i = first_below(l, target);
        if (i == 0 || i == l->count || l->k[i] - l->k[i - 1] <= gap)
            return;
        study_run(s, l,
                  runs < SECANTS ? place_between(l, i, target)
                                 : l->k[i] - (l->k[i] - l->k[i - 1]) / 2);
    }
}

static size_t widest_gap(const study *l) {
    size_t widest = 0;
    for (size_t i = 1; i < l->count; i++)
        if (!widest || l->k[i] - l->k[i - 1] > l->k[widest] - l->k[widest - 1])
            widest = i;
    return widest;
}

void study_fill(search *s, study *l, size_t count) {
    while (l->count && l->count < count && l->end < STUDY_GIVEN &&
           !search_is_over(s, 1)) {
        size_t i = widest_gap(l);
        int gap = i ? l->k[i] - l->k[i - 1] : 0;
        study_run(s, l,
                  gap > GRID_COARSE ? l->k[i] - gap / 2
                                    : l->k[l->count - 1] + GRID_COARSE);
    }
}

row *study_cheapest(const study *l, double target) {
    double *error = tool_allocate(l->count, sizeof *error);
    double *work = tool_allocate(l->count, sizeof *work);
    for (size_t i = 0; i < l->count; i++) {
        work[i] = l->level[i].work;
        error[i] = isnan(work[i]) ? INFINITY : study_error(&l->level[i]);
    }
    size_t i = grid_cheapest(error, work, l->count, target);
    tool_release(error);
    tool_release(work);
    return i < l->count ? &l->level[i] : NULL;
}

const row *study_failure(const study *l) {
    const row *failed = NULL;
    for (size_t i = 0; i < l->count; i++)
        if (l->level[i].ran)
            return NULL;
        else if (!failed && l->level[i].failed && !l->level[i].over_limit)
            failed = &l->level[i];
    return failed;
}

bool study_takes_gradients(const study *l) {
    return !nevh_integrator_needs_formulas(l->scheme);
}

bool study_keeps_energy(const study *l) {
    return l->keeps && !study_failure(l);
}

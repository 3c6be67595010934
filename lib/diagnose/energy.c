/* nevh: the energy observer.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include "diagnose/energy_state_private.h"
#include "diagnose/kinks_private.h"
#include "run/stepper_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Part of the energies met: an error that exceeds all energies at the start is not
   small. */
static const double of_met = 0.1;

static void energy_lay_out(nevh__arena *a, void *energy) {
    nevh_energy *e = energy;
    size_t n = e->n, width = e->width, effects = e->field->system->n_effects;
    double **const numbers[] = {
        &e->t,       &e->h,       &e->initial, &e->gained, &e->scale, &e->limit,
        &e->largest, &e->start_t, &e->typical, &e->seen,   &e->noise, &e->blur};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        *numbers[i] = nevh__arena_take(a, width, sizeof(double));
    e->start = nevh__arena_take(a, 2 * n * width, sizeof(double));
    e->trend = nevh__arena_take(a, width, sizeof *e->trend);
    e->steps = nevh__arena_take(a, width, sizeof *e->steps);
    e->next_look = nevh__arena_take(a, width, sizeof *e->next_look);
    e->started = nevh__arena_take(a, width, sizeof *e->started);
    e->sums = nevh__arena_take(a, 3 * width, sizeof(double));
    e->effects = nevh__arena_take(a, effects, sizeof(double));
    e->state = nevh__arena_take(a, 4 * n, sizeof(double));
    e->marked = nevh__arena_take(a, 2 * n * width, sizeof(double));
    e->mark = nevh__arena_take(a, width, sizeof *e->mark);
    e->kinks = nevh__arena_take(a, width, sizeof *e->kinks);
    e->booking = nevh__arena_take(a, 3 * n, sizeof(double));
}

static int energy_plan(nevh_energy *e, const nevh_system *s, bool portable) {
    e->n = s->n;
    nevh_options values = {.gradient = &nevh__no_gradient,
                           .width = e->width,
                           .portable = portable};
    e->field = nevh_field_new(s, &values);
    if (!e->field)
        return nevh__no_memory(&e->report);
    if (e->field->report.status)
        return nevh__fail_as(&e->report, &e->field->report);
    e->memory = nevh__arena_new(energy_lay_out, e);
    bool passes = e->width > 1 || nevh__passage_init(&e->passage, s);
    return e->memory && passes ? NEVH_OK : nevh__no_memory(&e->report);
}

nevh_energy *nevh_energy_new(const nevh_system *system,
                             const nevh_options *options) {
    nevh_energy *e = system ? nevh__array(1, sizeof *e) : NULL;
    if (!e)
        return NULL;
    e->width = options && options->width ? options->width : 1;
    if (energy_plan(e, system, options && options->portable) != NEVH_ENOMEM)
        return e;
    nevh_energy_free(e);
    return NULL;
}

void nevh_energy_free(nevh_energy *e) {
    if (!e)
        return;
    nevh_field_free(e->field);
    free(e->memory);
    nevh__passage_clear(&e->passage);
    free(e);
}

NEVH__REPORTS(energy)

/* Fails if the observer cannot use that stepper; told: "to follow" or "to expect". */
static int check_stepper(nevh_energy *e, const nevh_stepper *s,
                         const char *told) {
    if (e->report.status)
        return e->report.status;
    if (e->begun)
        return nevh__fail(&e->report, NEVH_EINVAL,
                          "the stepper %s is to be told before the first "
                          "observation",
                          told);
    if (nevh_stepper_status(s))
        return nevh__fail(&e->report, NEVH_EINVAL,
                          "the stepper %s was refused: %s", told,
                          nevh_stepper_message(s));
    if (s->work.system != e->field->system || s->work.width != e->width)
        return nevh__fail(&e->report, NEVH_EINVAL,
                          "the stepper %s is for another system or for %zu "
                          "orbits, where %zu are observed",
                          told, s->work.width, e->width);
    return NEVH_OK;
}

int nevh_energy_follow(nevh_energy *e, const nevh_stepper *s) {
    if (!e)
        return NEVH_EINVAL;
    int status = check_stepper(e, s, "to follow");
    if (status)
        return status;
    if (!nevh__balanced(s))
        return nevh__fail(&e->report, NEVH_EINVAL,
                          "the stepper to follow keeps no balance: ask for it "
                          "with nevh_options.balance");
    e->followed = s;
    return NEVH_OK;
}

/* noise: the rounding of derivatives by differences; blur: their distance from
   derivatives of any H, relative to them. */
static void find_blur(const nevh_field *f, double *noise, double *blur) {
    *noise = *blur = 0;
    for (size_t i = 0; f && i < nevh_field_step_count(f); i++) {
        nevh_step_report step = nevh_field_step_report(f, i);
        if (step.given)
            *blur = INFINITY;
        else if (step.size > 0) {
            double both = step.truncation + step.rounding;
            *noise = fmax(*noise, step.rounding / step.size);
            *blur = fmax(*blur, both / step.size);
        }
    }
}

static void expect_in(nevh_energy *e, size_t lane, const nevh_stepper *s) {
    if (!s->work.integrator->needs_formulas) /* those take no gradient */
        find_blur(s->work.field, &e->noise[lane], &e->blur[lane]);
}

int nevh_energy_expect(nevh_energy *e, const nevh_stepper *s) {
    if (!e)
        return NEVH_EINVAL;
    int status = check_stepper(e, s, "to expect");
    if (status)
        return status;
    e->theory = nevh__theory_of(s);
    e->searches =
        e->theory == NEVH_THEORY_KEEPS && nevh__theory_doubts(s->work.system);
    for (size_t lane = 0; lane < e->width; lane++)
        expect_in(e, lane, s);
    return NEVH_OK;
}

void nevh__energy_lane_take(nevh_energy *e, size_t lane,
                            const double *const c[], const nevh_stepper *s) {
    nevh__field_lane_take(e->field, lane, c, NULL);
    expect_in(e, lane, s);
}

void nevh__energy_lane_copy(nevh_energy *e, size_t from, size_t to) {
    nevh__field_lane_copy(e->field, from, to);
}

/* The energy from outside so far. */
static double gain(const nevh_energy *e, size_t lane) {
    return e->followed ? nevh_stepper_gain(e->followed, lane) : 0;
}

int nevh_energy_set_scale(nevh_energy *e, double scale) {
    if (!e)
        return NEVH_EINVAL;
    if (!(scale > 0 && isfinite(scale)))
        return nevh__fail(&e->report, NEVH_EINVAL,
                          "the scale of the energy, %g, is not a positive "
                          "number",
                          scale);
    e->given_scale = scale;
    return NEVH_OK;
}

static void energy_gather(nevh_energy *e, size_t lane, const double q[],
                          const double p[]) {
    if (e->field->lanes)
        nevh__field_alone(e->field, lane);
    for (size_t k = 0; k < e->n; k++) {
        e->state[k] = q[k * e->width + lane];
        e->state[e->n + k] = p[k * e->width + lane];
    }
}

static int energy_begin(nevh_energy *e, size_t lane, double t, const double q[],
                        const double p[]) {
    e->initial[lane] = e->h[lane];
    e->gained[lane] = gain(e, lane);
    energy_gather(e, lane, q, p);
    int status = nevh__energy_find_scale(e, lane, t);
    e->started[lane] = !status;
    e->begun |= !status;
    return status;
}

static void take_size(nevh_energy *e, size_t lane, double size) {
    e->largest[lane] = fmax(e->largest[lane], size);
    e->seen[lane] = fmax(e->seen[lane], fabs(nevh_energy_error(e, lane)));
}

/* The size of the energies that rounding is of: looked for from time to time,
   and where the error rises, which it does where they are large. */
static int energy_look(nevh_energy *e, size_t lane, double t, const double q[],
                       const double p[]) {
    double h, roundoff, size;
    energy_gather(e, lane, q, p);
    int status = nevh__field_moving_values(
        e->field, 1, &t, e->state, e->state + e->n, &h, &roundoff, &size);
    take_size(e, lane, status ? 0 : size);
    return status;
}

static bool is_time_to_look(nevh_energy *e, size_t lane) {
    return e->trend[lane].samples >= e->next_look[lane] ||
           fabs(nevh_energy_error(e, lane)) >
               nevh__energy_higher * e->seen[lane];
}

/* For kinks between this state and one an eighth of the time ago. */
static void search_kinks(nevh_energy *e, size_t lane, const double q[],
                         const double p[]) {
    size_t n = e->n, samples = e->trend[lane].samples;
    double *before = e->marked + 2 * n * lane;
    if (!e->searches || e->only_largest ||
        samples < e->mark[lane] + e->mark[lane] / 8)
        return;
    energy_gather(e, lane, q, p);
    if (e->mark[lane] &&
        nevh__kink_between(e->field, e->t[lane], before, e->state,
                           e->largest[lane], false, e->state + 2 * n))
        e->kinks[lane]++;
    memcpy(before, e->state, 2 * n * sizeof *before);
    e->mark[lane] = samples;
}

/* Some hundred times in a run of any length. */
static void look_again_later(nevh_energy *e, size_t lane, const double q[],
                             const double p[]) {
    size_t samples = e->trend[lane].samples;
    search_kinks(e, lane, q, p);
    if (samples >= e->next_look[lane])
        e->next_look[lane] = samples + samples / 64 + 1;
}

int nevh_energy_book(nevh_energy *e, const nevh_timing *timing) {
    if (!e)
        return NEVH_EINVAL;
    if (e->width > 1)
        return nevh__fail(&e->report, NEVH_EINVAL,
                          "jumps in time are booked of one orbit, not of %zu",
                          e->width);
    size_t n = e->n;
    e->book = (nevh__book){
        .field = e->field, .timing = timing, .n = n, .state = e->booking};
    e->book.friction =
        nevh_system_friction(e->field->system, e->booking + 2 * n);
    return NEVH_OK;
}

double nevh_energy_passed(const nevh_energy *e, const char **effect) {
    bool any = e && e->passage.found;
    if (any && effect)
        *effect = nevh_system_effect_name(e->field->system, e->passage.effect);
    return any ? e->passage.at : NAN;
}

/* The error at the current state. */
static double error_now(const nevh_energy *e, size_t lane) {
    double came = gain(e, lane) - e->gained[lane] + e->book.booked;
    return (e->h[lane] - e->initial[lane] - came) / e->scale[lane];
}

/* The energy from outside in the step from the last state to this one. */
static void book(nevh_energy *e, double t, const double q[], const double p[]) {
    double before = e->trend->last;
    e->book.told = e->followed->work.ledger;
    double wrong = nevh__book_step(&e->book, e->passage.before,
                                   e->trend->samples == 1, t, q, p, gain(e, 0));
    double change = fabs(error_now(e, 0) - before);
    e->missed += fmin(wrong, change * e->scale[0]);
}

/* Examines the interval between the last state and this one, of one orbit. */
static void look_back(nevh_energy *e, double t, const double q[],
                      const double p[]) {
    static const double large = 1e-3; /* of the scale */
    bool first = e->trend->samples == 0;
    if (!first)
        nevh__book_value(&e->book, e->passage.before[2 * e->n], t, q, p,
                         &e->h[0]);
    double change = fabs(error_now(e, 0) - e->trend->last);
    if (first)
        e->book.came = gain(e, 0);
    else if (e->followed)
        book(e, t, q, p);
    if (!first && (!(change <= large) || change > 2 * e->sudden))
        nevh__passage_look(&e->passage, t, q, p);
    e->sudden = fmax(e->sudden, change);
    nevh__passage_keep(&e->passage, t, q, p);
}

static int add_error(nevh_energy *e, size_t lane, double t) {
    if (!isfinite(gain(e, lane)))
        return nevh__fail(&e->report, NEVH_EDOM,
                          "the balance of the energy is not finite at t = "
                          "%.9g: %s does not account for whole steps",
                          t, e->followed->work.integrator->name);
    double error = error_now(e, lane);
    if (e->only_largest)
        nevh__trend_add_most(&e->trend[lane], 1, fabs(error), error);
    else
        nevh__trend_add(&e->trend[lane], t, error,
                        e->largest[lane] / e->scale[lane]);
    return NEVH_OK;
}

static int add_state(nevh_energy *e, size_t lane, size_t step, const double q[],
                     const double p[]) {
    double t = e->t[lane];
    int status = e->started[lane] ? NEVH_OK : energy_begin(e, lane, t, q, p);
    e->steps[lane] = step;
    if (!status && e->width == 1)
        look_back(e, t, q, p);
    return status ? status : add_error(e, lane, t);
}

static int observe_lane(nevh_energy *e, size_t lane, size_t step,
                        const double q[], const double p[]) {
    int status = add_state(e, lane, step, q, p);
    if (!status && is_time_to_look(e, lane))
        status = energy_look(e, lane, e->t[lane], q, p);
    look_again_later(e, lane, q, p);
    return status;
}

int nevh_energy_observe(void *energy, size_t step, double t, const double q[],
                        const double p[]) {
    if (!energy)
        return NEVH_EINVAL;
    nevh_energy *e = energy;
    if (e->report.status)
        return e->report.status;
    for (size_t lane = 0; lane < e->width; lane++)
        e->t[lane] = t;
    int status = nevh_field_value(e->field, e->width, e->t, q, p, e->h);
    for (size_t lane = 0; !status && lane < e->width; lane++)
        status = observe_lane(e, lane, step, q, p);
    if (status && !e->report.status)
        nevh__fail_as(&e->report, &e->field->report);
    return status;
}

/* Each lane alone, where one of them has no energy. */
static void value_of_lane(nevh_energy *e, size_t lane, const double q[],
                          const double p[]) {
    energy_gather(e, lane, q, p);
    if (nevh_field_value(e->field, 1, &e->t[lane], e->state, e->state + e->n,
                         &e->h[lane]))
        e->h[lane] = NAN;
}

/* All lanes whose turn it is, side by side. */
static void look_at_lanes(nevh_energy *e, bool on[], const double q[],
                          const double p[]) {
    double *h = e->sums, *roundoff = h + e->width, *size = roundoff + e->width;
    bool due = false;
    for (size_t lane = 0; !due && lane < e->width; lane++)
        due = on[lane] && is_time_to_look(e, lane);
    bool all = due && !nevh__field_moving_values(e->field, e->width, e->t, q, p,
                                                 h, roundoff, size);
    for (size_t lane = 0; due && lane < e->width; lane++) {
        if (!on[lane] || !is_time_to_look(e, lane))
            continue;
        if (all)
            take_size(e, lane, size[lane]);
        else
            on[lane] = !energy_look(e, lane, e->t[lane], q, p);
        look_again_later(e, lane, q, p);
    }
}

void nevh__energy_observe_lanes(nevh_energy *e, bool on[], const size_t step[],
                                const double t[], const double q[],
                                const double p[]) {
    size_t width = e->width;
    for (size_t lane = 0; lane < width; lane++)
        e->t[lane] = t[lane];
    if (nevh_field_value(e->field, width, e->t, q, p, e->h))
        for (size_t lane = 0; lane < width; lane++)
            value_of_lane(e, lane, q, p);
    for (size_t lane = 0; lane < width; lane++)
        if (on[lane])
            on[lane] =
                isfinite(e->h[lane]) && !add_state(e, lane, step[lane], q, p);
    look_at_lanes(e, on, q, p);
    e->report = (nevh__report){0}; /* the lane's that failed, alone */
}

void nevh__energy_restart(nevh_energy *e, size_t lane) {
    e->started[lane] = false;
    e->largest[lane] = e->seen[lane] = 0;
    e->steps[lane] = e->next_look[lane] = 0;
    e->mark[lane] = e->kinks[lane] = 0;
    e->trend[lane] = (nevh__trend){0};
    e->book.booked = e->book.came = e->missed = 0;
}

double nevh_energy_error(const nevh_energy *e, size_t lane) {
    return e && e->begun && lane < e->width ? e->trend[lane].last : 0;
}

/* The rounding of values, and of a random walk of the steps, whose gradients have
   that error or the noise of differences. */
static double rounding_of(const nevh_energy *e, size_t lane, double scale) {
    double each = fmax(DBL_EPSILON, e->noise[lane] / 16);
    double walk = 4 * each * sqrt((double)e->steps[lane]);
    return (16 * DBL_EPSILON + walk) * e->largest[lane] / scale +
           DBL_MIN / scale; /* products of which underflow */
}

nevh_energy_report nevh_energy_result(const nevh_energy *e, size_t lane) {
    nevh_energy_report report = {.verdict = NEVH_UNDECIDED};
    if (!e || !e->begun || lane >= e->width)
        return report;
    double scale = nevh__energy_scale(e, lane);
    nevh__trend trend = e->trend[lane];
    if (scale != e->scale[lane])
        nevh__trend_multiply(&trend, e->scale[lane] / scale);
    report.initial = e->initial[lane];
    report.scale = scale;
    report.theory = e->kinks[lane] > 1 ? NEVH_THEORY_ROUGH : e->theory;
    report.limit = fmax(1, e->limit[lane] / scale);
    report.met = e->largest[lane] / scale;
    if (e->theory == NEVH_THEORY_OPEN)
        report.limit = fmax(report.limit, of_met * report.met);
    report.rounding = rounding_of(e, lane, scale);
    report.gradient =
        e->blur[lane] * (double)e->steps[lane] * e->largest[lane] / scale;
    report.missed = e->missed / scale;
    nevh__trend_report(&trend, &report);
    report.verdict = nevh_energy_verdict(&report, 1);
    return report;
}

const char *nevh_verdict_name(nevh_verdict verdict) {
    static const char *const names[] = {"bounded", "random-walk", "drifts",
                                        "unstable", "undecided"};
    _Static_assert(sizeof names / sizeof *names == NEVH_UNDECIDED + 1,
                   "each verdict");
    return verdict <= NEVH_UNDECIDED ? names[verdict] : "unknown";
}

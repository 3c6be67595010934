/* nevh: a stepper is planned once and applied many times.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include "gradient/field_private.h"
#include "work/ledger_private.h"
#include "work/transform_private.h"
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool copy_array(const double **array, size_t count) {
    return !*array || (*array = nevh__copy(*array, count, sizeof **array));
}

/* All four are taken over first, so that none is left borrowed. */
static bool own_options(nevh_options *o, size_t n) {
    bool all = copy_array(&o->gradient_steps, 2 * n);
    all = copy_array(&o->scale, 2 * n) && all;
    all = copy_array(&o->q, n * o->width) && all;
    return copy_array(&o->p, n * o->width) && all;
}

static int stepper_plan_memory(nevh_stepper *s) {
    nevh_work *w = &s->work;
    s->fresh_rows = w->memory_rows + (s->friction ? w->n : 0) +
                    (w->transform ? NEVH__TRANSFORM_ROWS : 0);
    s->rows = s->fresh_rows + (w->ledger ? 2 : 0);
    s->buffer = nevh__array(s->rows * w->width + NEVH__LANES, sizeof(double));
    w->memory = s->buffer ? nevh__aligned(s->buffer) : NULL;
    w->scratch = nevh__array(w->scratch_size, sizeof(double));
    s->last_q = nevh__array(w->size, sizeof(double));
    s->last_p = nevh__array(w->size, sizeof(double));
    s->before = nevh__array(s->rows * w->width, sizeof(double));
    if (w->memory && w->scratch && s->last_q && s->last_p && s->before)
        return NEVH_OK;
    return nevh__no_memory(&s->report);
}

static int stepper_plan_field(nevh_stepper *s) {
    nevh_work *w = &s->work;
    if (w->integrator->needs_formulas) /* it takes no gradient */
        s->options.gradient = nevh__best_gradient(w->system);
    nevh__part_role *part = NULL;
    int status = nevh__choose_parts(s, &part);
    if (!status)
        w->field = nevh__field_of(w->system, &s->options, part);
    free(part);
    if (status)
        return status;
    if (!w->field)
        return nevh__no_memory(&s->report);
    return w->field->report.status
               ? nevh__fail_as(&s->report, &w->field->report)
               : NEVH_OK;
}

static int stepper_check_options(nevh_stepper *s,
                                 const nevh_integrator *integrator) {
    const nevh_work *w = &s->work;
    double tolerance = s->options.tolerance;
    if (!integrator)
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "the integrator is NULL: is its name spelt right?");
    if (!(tolerance >= 0 && tolerance <= DBL_MAX))
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "the tolerance %g is not a positive number",
                          tolerance);
    s->own_time = integrator->own_time || s->options.transform;
    s->holds_traps = s->own_time || !nevh_integrator_explicit(integrator);
    if (s->own_time && w->width > 1)
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "%s%s chooses its own times and takes one orbit, not "
                          "%zu side by side: make a stepper for each",
                          integrator->name,
                          s->options.transform ? " under a transform" : "",
                          w->width);
    return NEVH_OK;
}

/* Plans the parts besides the scheme that act on the state or keep account of it.
   The kernel's plan needs the first two; the others need the kernel's memory. */
static int plan_parts(nevh_stepper *s) {
    nevh_work *w = &s->work;
    const nevh_integrator *integrator = w->integrator;
    int status = NEVH_OK;
    if (s->options.transform && !integrator->own_time)
        status = nevh__transform_plan(w);
    if (!status)
        status = nevh__plan_friction(s);
    if (!status)
        status = nevh__ledger_plan(w, s->rates);
    w->accounts = w->transform || w->ledger;
    if (!status)
        status = integrator->kernel->plan(w);
    if (!status && w->field->starved)
        status = nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    if (!status)
        status = nevh__friction_step_plan(s);
    return status;
}

static int stepper_plan(nevh_stepper *s) {
    const nevh_work *w = &s->work;
    if (w->system->report.status)
        return nevh__fail_as(&s->report, &w->system->report);
    int status = stepper_check_options(s, w->integrator);
    if (!status)
        status = stepper_plan_field(s);
    if (!status)
        status = nevh__check_structure(s);
    if (!status)
        status = plan_parts(s);
    if (!status)
        status = stepper_plan_memory(s);
    if (!status)
        nevh__native_plan(&s->work, s->watched, s->why_native);
    return status;
}

nevh_stepper *nevh__stepper_watching(const nevh_system *system,
                                     const nevh_integrator *integrator,
                                     const nevh_options *options,
                                     const nevh__watched *watched) {
    bool fits =
        system && nevh__width_fits(system->report.status ? 0 : system->n,
                                   options ? options->width : 1);
    nevh_stepper *s = fits ? nevh__array(1, sizeof *s) : NULL;
    if (!s)
        return NULL;
    if (options)
        s->options = *options;
    s->options.width = s->options.width ? s->options.width : 1;
    s->watched = watched;
    size_t n = system->n, width = s->options.width;
    bool owned = own_options(&s->options, system->report.status ? 0 : n);
    s->work = (nevh_work){.integrator = integrator,
                          .system = system,
                          .options = &s->options,
                          .n = n,
                          .width = width,
                          .size = n * width,
                          .report = &s->report};
    fenv_t own; /* trial states may overflow: no exception is trapped */
    feholdexcept(&own);
    int status = owned ? stepper_plan(s) : NEVH_ENOMEM;
    fesetenv(&own);
    s->planned = status == NEVH_OK;
    s->revision = s->options.transform ? s->options.transform->revision : 0;
    s->watched = NULL;
    if (status != NEVH_ENOMEM)
        return s;
    nevh_stepper_free(s);
    return NULL;
}

nevh_stepper *nevh_stepper_new(const nevh_system *system,
                               const nevh_integrator *integrator,
                               const nevh_options *options) {
    return nevh__stepper_watching(system, integrator, options, NULL);
}

void nevh_stepper_free(nevh_stepper *s) {
    if (!s)
        return;
    if (s->work.plan && s->work.integrator->kernel->clear)
        s->work.integrator->kernel->clear(&s->work);
    nevh__native_free(s->work.native);
    nevh_field_free(s->work.field);
    nevh__transform_free(s->work.transform);
    free((double *)s->options.gradient_steps);
    free((double *)s->options.scale);
    free((double *)s->options.q);
    free((double *)s->options.p);
    nevh__friction_step_free(s->friction);
    nevh__ledger_free(s->work.ledger);
    free(s->rates);
    free(s->buffer);
    free(s->work.scratch);
    free(s->last_q);
    free(s->last_p);
    free(s->before);
    free(s);
}

NEVH__REPORTS(stepper)

static void forget_lane(nevh_stepper *s, size_t lane) {
    nevh_work *w = &s->work;
    for (size_t row = 0; row < s->fresh_rows; row++)
        w->memory[row * w->width + lane] = 0;
}

void nevh_stepper_reset(nevh_stepper *s) {
    if (!s)
        return;
    for (size_t lane = 0; s->planned && lane < s->work.width; lane++)
        forget_lane(s, lane);
    for (size_t i = s->fresh_rows * s->work.width;
         s->planned && i < s->rows * s->work.width; i++)
        s->work.memory[i] = 0;
    s->has_last = false;
}

static bool same_lane(const nevh_stepper *s, size_t lane, const double q[],
                      const double p[]) {
    size_t width = s->work.width;
    for (size_t i = lane; i < s->work.size; i += width)
        if (memcmp(&q[i], &s->last_q[i], sizeof *q) ||
            memcmp(&p[i], &s->last_p[i], sizeof *p))
            return false;
    return true;
}

/* t0 + i h and the sum of steps agree to a few roundings. */
static bool same_time(const nevh_stepper *s, double t, double h) {
    double slack = 8 * DBL_EPSILON * (fabs(t) + fabs(s->last_t) + fabs(h));
    return fabs(t - s->last_t) <= slack;
}

static size_t memory_size(const nevh_stepper *s) {
    return s->rows * s->work.width * sizeof *s->work.memory;
}

int nevh__begin(nevh_stepper *s, double t, double h, const double q[],
                const double p[]) {
    if (!s || !s->planned)
        return nevh_stepper_status(s);
    s->report.status = NEVH_OK;
    s->report.text[0] = '\0';
    s->forgot = false;
    if (!isfinite(t) || !isfinite(h))
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "time %g or step %g is not a finite number", t, h);
    if (s->options.transform && s->options.transform->revision != s->revision)
        return nevh__fail(&s->report, NEVH_ESTALE,
                          "effects of the transform were added or switched "
                          "since this was planned: make a new stepper");
    bool same = s->has_last && same_time(s, t, h);
    s->before_t = s->last_t;
    s->before_roundoff = s->time_roundoff;
    for (size_t lane = 0; lane < s->work.width; lane++)
        if (!same || !same_lane(s, lane, q, p)) {
            if (!s->forgot)
                memcpy(s->before, s->work.memory, memory_size(s));
            s->forgot = true;
            forget_lane(s, lane);
        }
    if (s->forgot)
        s->time_roundoff = 0;
    return NEVH_OK;
}

void nevh__undo(nevh_stepper *s) {
    if (s->forgot)
        memcpy(s->work.memory, s->before, memory_size(s));
    s->last_t = s->before_t;
    s->time_roundoff = s->before_roundoff;
}

static void pass_time(nevh_stepper *s, double t) {
    double passed = s->work.elapsed + (s->own_time ? s->time_roundoff : 0);
    s->last_t = t + passed;
    s->time_roundoff = nevh__roundoff(s->last_t, t, passed);
}

/* Two rows, where there is a ledger; see nevh__ledger_close. */
static double *gains(const nevh_stepper *s) {
    return s->work.memory + s->fresh_rows * s->work.width;
}

int nevh__advance(nevh_stepper *s, double t, double h, double q[], double p[]) {
    nevh_work *w = &s->work;
    s->last_h = h;
    w->elapsed = w->transform ? 0 : h;
    nevh__ledger_open(w, q, p);
    int status = NEVH_OK;
    if (w->transform)
        status = nevh__transform_begin(w, w->memory + w->memory_rows * w->width,
                                       t, q, p);
    if (!status)
        status = s->friction ? nevh__friction_step_apply(s, t, h, q, p)
                             : nevh__native_step(w, t, h, q, p);
    if (status)
        return status;
    nevh__ledger_close(w, gains(s));
    pass_time(s, t);
    s->report.status = NEVH_OK; /* a rescued step has failed before */
    s->report.text[0] = '\0';
    return NEVH_OK;
}

/* Called where the state leaves the library's hands. */
void nevh__remember(nevh_stepper *s, const double q[], const double p[]) {
    s->has_last = true;
    memcpy(s->last_q, q, s->work.size * sizeof *q);
    memcpy(s->last_p, p, s->work.size * sizeof *p);
}

int nevh_stepper_apply(nevh_stepper *s, double t, double h, double q[],
                       double p[]) {
    int status = nevh__begin(s, t, h, q, p);
    if (status)
        return status;
    fenv_t own;
    if (s->holds_traps)
        feholdexcept(&own);
    status = nevh__advance(s, t, h, q, p);
    if (s->holds_traps)
        fesetenv(&own);
    if (status)
        nevh__undo(s);
    else
        nevh__remember(s, q, p);
    return status;
}

nevh_counts nevh_stepper_counts(const nevh_stepper *s) {
    if (!s)
        return (nevh_counts){0};
    nevh_counts counts = {0};
    if (s->work.field)
        counts = nevh_field_counts(s->work.field);
    counts.sweeps = s->work.sweeps;
    counts.newtons = s->work.newtons;
    counts.rescues = s->work.rescues;
    return counts;
}

nevh_field *nevh_stepper_field(nevh_stepper *s) {
    return s ? s->work.field : NULL;
}

bool nevh_stepper_compiles(const nevh_stepper *s) {
    return s && s->work.native && s->work.native->compiler &&
           !nevh__background_is_done(s->work.native->compiler);
}

bool nevh_stepper_native(const nevh_stepper *s, const char **why) {
    nevh__native *x = s ? s->work.native : NULL;
    bool native = nevh__native_await(x);
    if (why)
        *why = !s ? "out of memory" : x ? x->why : s->why_native;
    return native;
}

bool nevh_stepper_foresee(nevh_stepper *s, double steps) {
    if (!s || !s->planned)
        return false;
    bool more = steps > s->options.steps_foreseen;
    bool tried = s->work.native || s->why_native[0];
    if (more)
        s->options.steps_foreseen = steps;
    if (more && !tried && s->options.native == NEVH_NATIVE_AUTO)
        nevh__native_plan(&s->work, s->watched, s->why_native);
    return nevh__native_pays(&s->work);
}

void nevh_steppers_foresee(nevh_stepper *const all[], size_t count,
                           double steps) {
    nevh_stepper **some = nevh__array(count, sizeof *some);
    nevh_work **works = nevh__array(count, sizeof *works);
    double *before = nevh__array(count, sizeof *before);
    char(*why)[NEVH__WHY_NATIVE] = nevh__array(count, sizeof *why);
    size_t ready = 0;
    for (size_t i = 0; some && works && before && why && i < count; i++)
        if (all[i] && all[i]->planned && !all[i]->why_native[0]) {
            some[ready] = all[i];
            works[ready] = &all[i]->work;
            before[ready++] = all[i]->options.steps_foreseen;
            all[i]->options.steps_foreseen = steps;
        }
    nevh__native_prepare(works, ready, why);
    for (size_t i = 0; i < ready; i++) {
        some[i]->options.steps_foreseen = before[i];
        memcpy(some[i]->why_native, why[i], sizeof why[i]);
    }
    free(some);
    free(works);
    free(before);
    free(why);
    for (size_t i = 0; i < count; i++)
        nevh_stepper_foresee(all[i], steps);
}

double nevh_stepper_native_saves(nevh_stepper *s, double steps) {
    if (!s || !s->planned)
        return NAN;
    double before = s->options.steps_foreseen;
    s->options.steps_foreseen = steps;
    double saved = nevh__native_saves(&s->work);
    s->options.steps_foreseen = before;
    return saved;
}

char *nevh_stepper_program(nevh_stepper *s, const nevh_program *as) {
    nevh__writer text = {0};
    if (!s || !s->planned || !as)
        return NULL;
    if (!s->options.q || !s->options.p || !as->every) {
        nevh__fail(&s->report, NEVH_EINVAL,
                   "a program needs a state to start from, and rows");
        return NULL;
    }
    if (!as->functions && nevh__span_check(s, s->options.t, as->h, as->t_end))
        return NULL;
    if (s->friction)
        text.refusal = "friction is put around its steps";
    else if (nevh__write_program(&text, &s->work, as)) {
        free(text.numbers);
        return text.text;
    }
    nevh__fail(&s->report, text.refusal ? NEVH_ESTRUCT : NEVH_ENOMEM,
               "there is no program of such steps: %s",
               text.refusal ? text.refusal : "out of memory");
    nevh__writer_free(&text);
    return NULL;
}

double nevh_stepper_time(const nevh_stepper *s) {
    return s ? s->last_t : NAN;
}

size_t nevh_stepper_taken(const nevh_stepper *s) {
    return s ? s->taken : 0;
}

double nevh_stepper_gain(const nevh_stepper *s, size_t lane) {
    if (!s)
        return NAN;
    if (!s->planned || !s->work.ledger || lane >= s->work.width)
        return 0;
    const double *total = gains(s);
    return total[lane] + total[s->work.width + lane];
}

bool nevh__balanced(const nevh_stepper *s) {
    return s->options.balance ||
           (!s->rates && nevh_system_traits(s->work.system) & NEVH_AUTONOMOUS);
}

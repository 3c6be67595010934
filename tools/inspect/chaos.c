/* nevh chaos: is the orbit of a scene chaotic, and on which time scale.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "experiment/plan.h"
#include <math.h>
#include <nevh/chaos.h>
#include <stdlib.h>
#include <string.h>

/* Limits of a run without --end: it goes on until the orbit is classified, up to so
   many steps, or to the scene's own end. */
static const double most_steps = 4e5, good_enough = 0.05;
/* Relative to the energy's scale: an orbit whose energy changes by more is not one
   of H. */
static const double lost = 0.1;

typedef struct {
    const plan *plan;
    const options *options;
    size_t exponents;
    page result;
    bool early;
    double started; /* seconds of processor time */
} chaos_job;

/* One integrator with one step. */
typedef struct {
    const char *integrator;
    double dt;
    nevh_chaos *chaos;
    nevh_chaos_confirmation confirmed;
} row;

/* The state of the estimates at one time. */
typedef struct {
    nevh_chaos_report now;
    double *value, *error; /* of each exponent */
} estimates;

static void put_number(const chaos_job *j, double x) {
    if (j->options->format == FORMAT_TABLE && isfinite(x))
        table_shown(j->result.table, "%.4g", x);
    else
        table_number(j->result.table, x);
}

static estimates estimates_new(const chaos_job *j, const row *r) {
    estimates l = {nevh_chaos_result(r->chaos),
                   tool_allocate(2 * j->exponents, sizeof *l.value), NULL};
    l.error = l.value + j->exponents;
    for (size_t i = 0; i < j->exponents; i++)
        l.value[i] = nevh_chaos_exponent(r->chaos, i, &l.error[i]);
    return l;
}

/* The error of the first exponent at the end is that of H, finer steps being known. */
static double error_at(const row *r, const estimates *l, size_t i) {
    bool last = i == 0 && l->now.t == nevh_chaos_result(r->chaos).t;
    return last && r->confirmed.how != NEVH_FINER_NONE ? r->confirmed.error
                                                       : l->error[i];
}

/* A verdict that finer steps contradict at the end is no better before it. */
static nevh_chaos_verdict verdict_at(const row *r, const estimates *l) {
    bool last = l->now.verdict == nevh_chaos_result(r->chaos).verdict;
    return last ? r->confirmed.verdict : l->now.verdict;
}

static void put_exponents(chaos_job *j, const row *r, estimates *l) {
    nevh_chaos_report now = l->now;
    for (size_t i = 0; i < j->exponents; i++) {
        table_text(j->result.table, j->plan->name);
        table_text(j->result.table, r->integrator);
        put_number(j, r->dt);
        put_number(j, now.t);
        table_shown(j->result.table, "%zu", i + 1);
        put_number(j, l->value[i]);
        put_number(j, error_at(r, l, i));
        put_number(j, now.sali);
        put_number(j, now.megno);
        table_text(j->result.table, nevh_chaos_verdict_name(verdict_at(r, l)));
    }
}

static int fail(chaos_job *j, const row *r, char *known) {
    char *why = text_print("%s, dt = %g: %s", r->integrator, r->dt, known);
    list_print(&j->result.before, "failed: %s", why);
    tool_refuse("%s: %s", j->plan->name, why);
    return TOOL_FAILED;
}

static char *why_of(const chaos_job *j, const row *r) {
    return plan_why(j->plan, nevh_chaos_message(r->chaos));
}

/* An exponent is clear where its error has been small twice: errors that are small
   by chance would end runs early. */
static bool is_clear(const row *r, int *times) {
    double error, value = nevh_chaos_exponent(r->chaos, 0, &error);
    nevh_chaos_verdict verdict = nevh_chaos_result(r->chaos).verdict;
    bool small = verdict != NEVH_EARLY && error < good_enough * value;
    *times = small ? *times + 1 : 0;
    return verdict == NEVH_REGULAR || verdict == NEVH_UNRESOLVED || *times > 1;
}

/* True if a run twice as long fits the budget. */
static bool may_double(const chaos_job *j) {
    double budget = j->options->search.budget;
    return budget == 0 || 2 * (cpu_seconds() - j->started) < budget;
}

static int run_until_clear(const chaos_job *j, const row *r) {
    double begin = j->plan->run->t_start, span = j->plan->t_end - begin;
    double most = fmax(span, most_steps * r->dt);
    int times = 0, status = nevh_chaos_run(r->chaos, begin + span);
    while (!status && !is_clear(r, &times) && span < most && may_double(j)) {
        span = fmin(2 * span, most);
        status = nevh_chaos_run(r->chaos, begin + span);
    }
    return status;
}

/* Confirms the verdict with finer steps; a run that failed has none. */
static void confirm(row *r, int status) {
    r->confirmed.verdict = nevh_chaos_result(r->chaos).verdict;
    if (!status && nevh_chaos_confirm(r->chaos, 0, &r->confirmed))
        r->confirmed.verdict = NEVH_UNRESOLVED;
}

static int run_history(chaos_job *j, row *r) {
    const plan *p = j->plan;
    size_t samples = j->options->samples, count = 0;
    int status = NEVH_OK;
    estimates *looks = tool_allocate(samples, sizeof *looks);
    for (size_t i = 1; !status && i <= samples; i++) {
        double part = (double)i / (double)samples;
        status = nevh_chaos_run(
            r->chaos, p->run->t_start + part * (p->t_end - p->run->t_start));
        if (!status)
            looks[count++] = estimates_new(j, r);
    }
    confirm(r, status);
    for (size_t i = 0; i < count; i++)
        put_exponents(j, r, &looks[i]);
    return status ? fail(j, r, why_of(j, r)) : TOOL_OK;
}

static int run_row(chaos_job *j, row *r) {
    if (j->options->samples)
        return run_history(j, r);
    int status = j->options->t_end ? nevh_chaos_run(r->chaos, j->plan->t_end)
                                   : run_until_clear(j, r);
    confirm(r, status);
    if (nevh_chaos_result(r->chaos).t > j->plan->run->t_start) {
        estimates l = estimates_new(j, r);
        put_exponents(j, r, &l);
    }
    return status ? fail(j, r, why_of(j, r)) : TOOL_OK;
}

static void note_row(chaos_job *j, const row *r) {
    const char *why;
    list *notes = &j->result.before;
    if (!nevh_chaos_is_tangent(r->chaos, &why))
        list_print(notes,
                   "%s: displacements are differences of orbits near by: %s",
                   r->integrator, why);
    for (size_t k = 2; k <= j->options->chaos.deviations; k++)
        list_print(notes, "%s, dt = %g: GALI_%zu = %.4g", r->integrator, r->dt,
                   k, nevh_chaos_gali(r->chaos, k));
}

/* Finer steps find another orbit, or leave open what it is. */
static void unresolved_words(chaos_job *j, const row *r) {
    const nevh_chaos_confirmation *c = &r->confirmed;
    nevh_chaos_verdict steps = nevh_chaos_result(r->chaos).verdict;
    nevh_chaos_verdict finer = c->found.report.verdict;
    char *what =
        c->how == NEVH_FINER_NONE ? text_print("no finer steps could be taken")
        : finer == NEVH_CHAOTIC
            ? text_print("finer ones (%s) are chaotic with an exponent of %.3g "
                         "+- %.1g: take a shorter dt",
                         c->text, c->found.exponent, c->found.error)
        : finer == NEVH_REGULAR
            ? text_print("finer ones (%s) are regular: take a shorter dt",
                         c->text)
            : text_print("finer ones (%s, until t = %.4g) do not confirm it: "
                         "take a shorter dt, or a longer run with --t-end",
                         c->text, c->found.report.t);
    list_print(&j->result.after, "The steps of %s at dt = %g are %s; %s.",
               r->integrator, r->dt, nevh_chaos_verdict_name(steps), what);
}

static void row_words(chaos_job *j, const row *r) {
    nevh_chaos_report now = nevh_chaos_result(r->chaos);
    if (now.verdict == NEVH_UNRESOLVED) {
        list_print(&j->result.after, "%s, dt = %g: %s", r->integrator, r->dt,
                   plan_kinks_text);
        return;
    }
    if (r->confirmed.verdict == NEVH_UNRESOLVED) {
        unresolved_words(j, r);
        return;
    }
    double error, value = nevh_chaos_exponent(r->chaos, 0, &error);
    if (r->confirmed.how != NEVH_FINER_NONE)
        error = r->confirmed.error;
    char *what =
        now.verdict == NEVH_CHAOTIC
            ? text_print("chaotic: nearby orbits separate e-fold every %.3g",
                         1 / value)
        : now.verdict == NEVH_UNSTABLE_ORBIT
            ? text_print("unstable, not chaotic: nearby orbits separate e-fold "
                         "every %.3g, as they do near an unstable "
                         "equilibrium or periodic orbit, or on an escape",
                         1 / value)
        : now.verdict == NEVH_REGULAR && value < -2 * error
            ? text_print("regular: nearby orbits approach e-fold every %.3g",
                         -1 / value)
        : now.verdict == NEVH_REGULAR
            ? text_print("regular: the largest exponent is below %.2g",
                         fabs(value) + error)
            : text_print("too early to say at t = %.6g; --t-end takes it "
                         "further",
                         now.t);
    list_print(&j->result.after,
               "%s, dt = %g: %s (%zu of %zu starts %s agree).", r->integrator,
               r->dt, what, now.agreeing, now.starts,
               j->plan->balance ? "near by" : "at this energy");
    if (now.verdict == NEVH_CHAOTIC && !r->confirmed.agrees)
        list_print(&j->result.after,
                   "%s, dt = %g: the exponent is that of these steps: finer "
                   "ones (%s) have %.3g +- %.1g.",
                   r->integrator, r->dt, r->confirmed.text,
                   r->confirmed.found.exponent, r->confirmed.found.error);
}

/* Notes a change of the energy: the exponents are those of the scheme's own map,
   whose orbits may keep no energy. */
static void note_energy(chaos_job *j, const row *r) {
    const plan *p = j->plan;
    nevh_options o = plan_options(p, p->gradients.item[0]);
    nevh_stepper *s = plan_stepper(p, r->integrator);
    nevh_energy *energy = tool_owned(nevh_energy_new(p->system, &o));
    double *q = plan_state(p);
    plan_set_scale(p, energy);
    nevh_run_until(s, p->run->t_start, r->dt, nevh_chaos_result(r->chaos).t, q,
                   q + p->n, &(nevh_observer){nevh_energy_observe, energy, 1},
                   1);
    double error = nevh_energy_result(energy, 0).max;
    /* Notes after a table are none of CSV. */
    list *notes =
        j->options->format == FORMAT_CSV ? &j->result.before : &j->result.after;
    if (error > lost)
        list_print(notes,
                   "%s at dt = %g does not keep the energy (error %.2g of "
                   "its scale): the result holds for these steps, not for H; "
                   "take a smaller dt.",
                   r->integrator, r->dt, error);
    nevh_energy_free(energy);
    nevh_stepper_free(s);
}

static int run_one(chaos_job *j, const char *integrator, double dt) {
    const plan *p = j->plan;
    bool transformed;
    nevh_options o = plan_options(p, p->gradients.item[0]);
    o.transform = plan_transform(p, integrator);
    nevh_chaos_options of = {.integrator =
                                 plan_scheme(p, integrator, &transformed),
                             .options = &o,
                             .t_start = p->run->t_start,
                             .dt = dt,
                             .starts = j->options->chaos.starts,
                             .exponents = j->exponents,
                             .deviations = j->options->chaos.deviations};
    row r = {.integrator = integrator,
             .dt = dt,
             .chaos = tool_owned(nevh_chaos_new(p->system, &of))};
    bool refused = nevh_chaos_status(r.chaos);
    char *doubts = refused ? NULL : plan_doubts_again(p, integrator, dt);
    int status =
        refused  ? tool_refuse("%s: %s", p->name, nevh_chaos_message(r.chaos))
        : doubts ? fail(j, &r, doubts)
                 : run_row(j, &r);
    if (status != TOOL_USAGE) {
        note_row(j, &r);
        table_group(j->result.table);
        if (!status)
            row_words(j, &r);
        if (!status && !p->balance)
            note_energy(j, &r);
    }
    nevh_chaos_free(r.chaos);
    return status;
}

/* All steps that were given, or the scene's first. */
static int run_steps(chaos_job *j, const char *integrator) {
    size_t count = j->options->dt.count ? j->plan->dts : 1;
    int worst = TOOL_OK;
    for (size_t i = 0; worst != TOOL_USAGE && i < count; i++) {
        int status = run_one(j, integrator, j->plan->dt[i]);
        worst = status > worst ? status : worst;
    }
    return worst;
}

/* All integrators that were given, or the scene's first of fixed steps. */
static const char *first_of(const plan *p) {
    for (size_t i = 0; i < p->integrators.count; i++) {
        const char *name = p->integrators.item[i];
        nevh_stepper *s = plan_stepper(p, name);
        bool transformed, fits = !nevh_stepper_status(s);
        const nevh_integrator *scheme = plan_scheme(p, name, &transformed);
        nevh_stepper_free(s);
        if (fits && !transformed && !nevh_integrator_own_time(scheme) &&
            !nevh_integrator_adaptive(scheme))
            return name;
    }
    return NULL;
}

static int run_all(chaos_job *j) {
    const plan *p = j->plan;
    int worst = TOOL_OK;
    if (!j->options->integrators.count) {
        const char *name = first_of(p);
        if (!name)
            return tool_refuse(
                "%s: none of the integrators has fixed steps and "
                "fits; name one with --integrators",
                p->name);
        list_print(&j->result.before, "integrator: %s, dt = %.9g%s", name,
                   p->dt[0],
                   p->integrators.count > 1 || p->dts > 1
                       ? ": the first of fixed steps that fits, and the first "
                         "dt"
                       : "");
        return run_steps(j, name);
    }
    for (size_t i = 0; worst != TOOL_USAGE && i < p->integrators.count; i++) {
        int status = run_steps(j, p->integrators.item[i]);
        worst = status > worst ? status : worst;
    }
    return worst;
}

static int check_numbers(chaos_job *j) {
    size_t most = 2 * j->plan->n;
    j->exponents = j->options->chaos.all         ? most
                   : j->options->chaos.exponents ? j->options->chaos.exponents
                                                 : 1;
    if (j->exponents > most)
        return tool_refuse("--exponents %zu: there are %zu", j->exponents,
                           most);
    if (j->options->chaos.deviations == 1 ||
        j->options->chaos.deviations > most)
        return tool_refuse("--gali %zu: it takes 2 to %zu displacements",
                           j->options->chaos.deviations, most);
    if (j->options->samples && !j->options->t_end && !isfinite(j->plan->t_end))
        return tool_refuse("--samples: no end: give --t-end");
    return TOOL_OK;
}

static int chaos_of(const options *o, const plan *p) {
    chaos_job j = {.plan = p,
                   .options = o,
                   .result = {.table = table_new()},
                   .started = cpu_seconds()};
    int status = check_numbers(&j);
    table_titles(j.result.table, chaos_command.columns);
    if (!status) {
        plan_notes(p, &j.result.before);
        settings_notes(o, &j.result.before);
        status = run_all(&j);
    }
    if (status != TOOL_USAGE)
        status = output_page(o, &j.result, status);
    return status;
}

static int chaos(const options *o) {
    plan p = {0};
    int status = plan_make(&p, o);
    if (!status && o->file)
        status = output_check(o->file);
    if (!status)
        status = chaos_of(o, &p);
    plan_free(&p);
    return status;
}

const command chaos_command = {
    .name = "chaos",
    .operand = "SCENE",
    .brief = "chaotic or regular, with Lyapunov exponents",
    .help =
        "whether the orbit is chaotic: Lyapunov exponents with errors, alignment indices, MEGNO",
    .examples = "chaos henon-heiles --t-end 1000\n"
                "chaos double-pendulum --t-end 50 --exponents all",
    .options = "SCENE STEPS TABLE budget samples exponents starts gali",
    .columns = "scene,integrator,dt,t,exponent,value,error,sali,megno,"
               "verdict",
    .run = chaos,
};

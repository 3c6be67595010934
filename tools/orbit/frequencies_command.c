/* nevh frequencies: the lines of a spectrum, by integrator and observable.

   Those of a run at half the step tell how much of a frequency is the scheme's, and of
   one by dop853 where H is not smooth, and errors are no powers of the step.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "experiment/trial_run.h"
#include "experiment/plan.h"
#include "frequencies_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LINES = 6, MOST_SAMPLES = 1 << 17, MOST_COORDINATES = 4 };

/* A coordinate, or a formula. */
typedef struct {
    char *name;
    size_t k;      /* of the coordinate */
    bool formula;  /* the scene's judged one */
    double period; /* an angle: its cosine is taken where it goes round */
    double length; /* over which H varies; 0: not known */
    nevh_spectral_samples *samples;
} observed;

/* The lines of one observed column in one run. */
typedef struct {
    char *name;
    nevh_spectral_line line[LINES];
    size_t found;
    double error[LINES]; /* with that of the scheme; NAN: not known */
} spectrum;

typedef struct {
    plan plan;
    observed *all;
    size_t count;
    double begin, end; /* of the run */
    size_t finer;      /* steps between two samples */
    bool smooth;       /* H is on its way, as far as is known */
    int failed;        /* a formula's status */
    table *table;
    list words;
    int worst;
} frequencies_job;

/* On the orbit, or round its start where H has no series. */
static bool is_smooth(const plan *p, const nevh_probe *probe) {
    char *why = NULL;
    smoothness on_way = smoothness_on_way(p, &why);
    return on_way == SMOOTHNESS_UNKNOWN && !nevh_probe_status(probe)
               ? nevh_probe_finding(probe, NEVH_IS_SMOOTH).holds
               : on_way != SMOOTHNESS_NONE;
}

/* Lengths are those of the coordinates that are observed. */
static void probe_all(frequencies_job *j) {
    const plan *p = &j->plan;
    nevh_options o = plan_options(p, p->gradients.item[0]);
    nevh_probe *probe = nevh_probe_new(p->system, &o);
    const double *length =
        nevh_probe_status(probe) ? NULL : nevh_probe_lengths(probe);
    for (size_t i = 0; length && i < j->count; i++)
        if (!j->all[i].formula)
            j->all[i].length = length[j->all[i].k];
    j->smooth = is_smooth(p, probe);
    nevh_probe_free(probe);
}

static int choose(frequencies_job *j, const options *o) {
    const plan *p = &j->plan;
    j->count = o->observable             ? 1
               : p->n < MOST_COORDINATES ? p->n
                                         : MOST_COORDINATES;
    j->all = tool_allocate(j->count, sizeof *j->all);
    for (size_t i = 0; i < j->count; i++)
        j->all[i] = (observed){
            .name = text_print("%s", o->observable
                                         ? o->observable
                                         : nevh_scene_coordinate(p->scene, i)),
            .k = i,
            .formula = o->observable != NULL,
            .period = o->observable ? 0 : nevh_scene_period(p->scene, i),
            .samples = nevh_spectral_samples_new(MOST_SAMPLES)};
    for (size_t i = 0; i < j->count; i++)
        if (!j->all[i].samples)
            return tool_refuse("out of memory");
    probe_all(j);
    return o->observable && nevh_scene_set_judged(p->scene, o->observable)
               ? scene_report(p->scene, o)
               : TOOL_OK;
}

static int take(void *data, size_t step, double t, const double q[],
                const double p[]) {
    frequencies_job *j = data;
    j->begin = step ? j->begin : t;
    j->end = t;
    if (step % j->finer)
        return 0;
    for (size_t i = 0; i < j->count; i++) {
        observed *a = &j->all[i];
        double x = q[a->k];
        if (a->formula)
            j->failed = nevh_scene_judged_value(j->plan.scene, t, q, p, &x);
        if (j->failed)
            return 1;
        nevh_spectral_samples_take(a->samples, step / j->finer, t, x);
    }
    return 0;
}

/* Samples along a run.
   dt       of its steps
   watch    of its energy; NULL: not looked at
   why      out: the reason
   returns  a status */
static int sample(frequencies_job *j, nevh_stepper *s, double dt,
                  nevh_energy *watch, char **why) {
    const plan *p = &j->plan;
    double stopped;
    nevh_observer observers[] = {{take, j, 1}, {nevh_energy_observe, watch, 1}};
    j->failed = 0;
    j->finer = (size_t)lround(p->dt[0] / dt);
    for (size_t i = 0; i < j->count; i++)
        nevh_spectral_samples_restart(j->all[i].samples);
    int status = plan_run(p, s, dt, observers, watch ? 2 : 1, &stopped);
    *why = status  ? plan_why(p, j->failed ? nevh_scene_message(p->scene)
                                           : nevh_stepper_message(s))
            : watch ? plan_doubts(p, watch, status)
                   : NULL;
    return *why && !status ? NEVH_EFAILED : status;
}

/* why      out: the reason
   returns  0; -1 refused; else a status */
static int run(frequencies_job *j, const char *integrator, char **why) {
    const plan *p = &j->plan;
    nevh_stepper *s = plan_stepper(p, integrator);
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(p, integrator, &transformed);
    bool own = transformed || nevh_integrator_own_time(scheme);
    nevh_energy *watch = plan_watch(p);
    int status = nevh_stepper_status(s);
    if (status || own) {
        *why = text_print("%s", status ? nevh_stepper_message(s)
                                       : "it chooses times of its own, and "
                                         "samples are at equal times");
        status = -1;
    } else
        status = sample(j, s, p->dt[0], watch, why);
    nevh_energy_free(watch);
    nevh_stepper_free(s);
    return status;
}

/* Makes an angle that goes round quasi-periodic; returns the name of the result. */
static char *straighten(const observed *a) {
    static const double turn = 6.283185307179586;
    if (!nevh_spectral_samples_straighten(a->samples, a->period))
        return text_print("%s", a->name);
    return a->period == turn
               ? text_print("cos(%s)", a->name)
               : text_print("cos(%.17g*%s)", turn / a->period, a->name);
}

static void add_row(frequencies_job *j, const options *o,
                    const char *integrator, const spectrum *of, size_t k) {
    const nevh_spectral_line *l = &of->line[k];
    const char *name = of->name;
    size_t rank = k + 1;
    double error = of->error[k];
    table *t = j->table;
    double period = 6.283185307179586 / l->frequency;
    if (o->format != FORMAT_TABLE) {
        table_text(t, j->plan.name);
        table_text(t, integrator);
        table_text(t, name);
        table_shown(t, "%zu", rank);
        table_number(t, l->frequency);
        table_number(t, error);
        table_number(t, l->amplitude);
        table_number(t, l->phase);
        table_number(t, l->drift);
        table_number(t, period);
        table_number(t, l->error);
        return;
    }
    table_text(t, integrator);
    table_text(t, name);
    table_shown(t, "%zu", rank);
    table_shown(t, "%.15g", l->frequency);
    if (isnan(error))
        table_text(t, "-");
    else
        table_shown(t, "%.0e", error);
    table_shown(t, "%.0e", l->error);
    if (isnan(l->drift))
        table_text(t, "-");
    else
        table_shown(t, "%.0e", l->drift);
    table_shown(t, "%.10g", period);
    table_shown(t, "%.6g", l->amplitude);
    table_shown(t, "%.4f", l->phase);
}

/* Lines of less than what rounding does over a length of H are left out. */
static void leave_out_rounding(const observed *a, spectrum *of) {
    static const double rounding = 1e-12;
    size_t kept = 0;
    for (size_t k = 0; k < of->found; k++)
        if (of->line[k].amplitude > rounding * a->length)
            of->line[kept++] = of->line[k];
    of->found = kept;
}

/* Analyses the last samples.
   returns  TOOL_OK, also if there is no line; TOOL_USAGE, with a message */
static int find_spectrum(frequencies_job *j, const char *integrator,
                         observed *a, bool reports, spectrum *of) {
    size_t count, words = j->words.count;
    double h;
    of->name = straighten(a);
    const double *values = nevh_spectral_samples_values(a->samples, &count, &h);
    int status =
        nevh_frequencies(h, count, values, LINES, of->line, &of->found);
    if (status == NEVH_EINVAL)
        return tool_refuse("%s: %zu samples are too few: 64 steps at least",
                           j->plan.name, count);
    if (status == NEVH_ENOMEM)
        return tool_refuse("out of memory");
    if (status == NEVH_EDOM && reports) {
        list_print(&j->words, "%s, %s failed: it is not finite", integrator,
                   of->name);
        tool_refuse("%s: %s, %s failed: it is not finite", j->plan.name,
                    integrator, of->name);
        j->worst = TOOL_FAILED;
    }
    leave_out_rounding(a, of);
    if (!status && !of->found && reports)
        list_print(&j->words, "%s, %s: it does not move.", integrator,
                   of->name);
    if (!of->found)
        return TOOL_OK;
    if (frequencies_line_words(&j->words, integrator, of->name, values, count,
                               h))
        of->found = 0;
    else if (reports)
        frequencies_drift_words(&j->words, integrator, of->name, &of->line[0]);
    if (reports)
        frequencies_length_words(&j->words, integrator, of->name,
                                 h * (double)(count - 1), j->end - j->begin);
    else
        j->words.count = words;
    return TOOL_OK;
}

/* The line of about that size that is nearest; NAN where there is none. */
static double nearest(const spectrum *of, const nevh_spectral_line *l) {
    static const double alike = 2;
    double best = NAN;
    for (size_t k = 0; k < of->found; k++) {
        double ratio = of->line[k].amplitude / l->amplitude;
        double apart = fabs(of->line[k].frequency - l->frequency);
        if (ratio < alike && ratio > 1 / alike &&
            !(apart >= fabs(best - l->frequency)))
            best = of->line[k].frequency;
    }
    return best;
}

/* part  of an error that the finer run does not have */
static void compare_lines(spectrum *of, const spectrum *finer, double part) {
    for (size_t k = 0; k < of->found; k++) {
        const nevh_spectral_line *l = &of->line[k];
        double changed = fabs(nearest(finer, l) - l->frequency) / part;
        double error = isnan(changed) ? NAN : hypot(changed, l->error);
        if (!(error < of->error[k]))
            of->error[k] = error;
    }
}

/* An error of h^order, or of a tolerance, is the change by the finer run, and a
   little more. */
static double part_of(nevh_finer *f, double shorter) {
    static const double tolerance = 1. / 16; /* as nevh_finer has it */
    if (nevh_finer_how(f) != NEVH_FINER_STEPS)
        return 1;
    int order = nevh_stepper_order(nevh_finer_stepper(f));
    return 1 - (shorter < 1 ? pow(shorter, order) : tolerance);
}

/* The errors of the lines that were found, by a finer run of that kind. */
static int confirm_by(frequencies_job *j, const char *integrator,
                      nevh_finer_kind kind, spectrum *all) {
    const plan *p = &j->plan;
    nevh_finer *f = plan_finer(p, integrator, kind);
    nevh_stepper *s = nevh_finer_stepper(f);
    double dt = fmin(nevh_finer_dt(f), p->dt[0]);
    double part = s ? part_of(f, dt / p->dt[0]) : 1;
    char *why = s ? NULL : text_print("%s", nevh_finer_message(f));
    bool ran = s && !sample(j, s, dt, NULL, &why);
    int status = TOOL_OK;
    if (s)
        tool_status(nevh_stepper_status(s));
    if (!ran)
        list_print(
            &j->words, "%s: errors are not known: %s it fails: %s", integrator,
            kind == NEVH_FINER_STEPS ? "with finer steps" : "by dop853", why);
    for (size_t i = 0; !status && i < j->count; i++) {
        spectrum finer = {0};
        if (ran)
            status = find_spectrum(j, integrator, &j->all[i], false, &finer);
        compare_lines(&all[i], &finer, part);
    }
    nevh_finer_free(f);
    return status;
}

static int confirm(frequencies_job *j, const char *integrator, spectrum *all) {
    int status = confirm_by(j, integrator, NEVH_FINER_STEPS, all);
    if (!status && !j->smooth)
        status = confirm_by(j, integrator, NEVH_FINER_ADAPTIVE, all);
    return status;
}

static int analyse(frequencies_job *j, const options *o,
                   const char *integrator) {
    spectrum *all = tool_allocate(j->count, sizeof *all);
    size_t lines = 0;
    int status = TOOL_OK;
    for (size_t i = 0; !status && i < j->count; i++) {
        status = find_spectrum(j, integrator, &j->all[i], true, &all[i]);
        lines += all[i].found;
    }
    if (!status && lines)
        status = confirm(j, integrator, all);
    for (size_t i = 0; !status && i < j->count; i++) {
        for (size_t k = 0; k < all[i].found; k++)
            add_row(j, o, integrator, &all[i], k);
        table_group(j->table);
    }
    return status;
}

/* Analyses the run of one integrator. */
static int run_and_analyse(frequencies_job *j, const options *o,
                           const char *integrator) {
    char *why = NULL;
    int status = run(j, integrator, &why);
    if (status)
        list_print(&j->words, "%s %s: %s", integrator,
                   status < 0 ? "refused" : "failed", why);
    if (status > 0) {
        tool_refuse("%s: %s failed: %s", j->plan.name, integrator, why);
        j->worst = TOOL_FAILED;
    }
    return status ? TOOL_OK : analyse(j, o, integrator);
}

static void make_table(frequencies_job *j, const options *o) {
    j->table = table_new();
    if (o->format == FORMAT_TABLE)
        table_titles(j->table, "integrator,observable,rank,frequency,error,"
                               "resolution,drift,period,amplitude,phase");
    else
        table_titles(j->table, frequencies_command.columns);
}

static void note(const frequencies_job *j, const options *o, list *notes) {
    const plan *p = &j->plan;
    plan_notes(p, notes);
    settings_notes(o, notes);
    list_print(notes, "frequency: radians a unit of time; dt = %.9g%s",
               p->dt[0], p->dts > 1 ? ", the first of the list" : "");
    list_print(notes, "gradient: %s%s", p->gradients.item[0],
               p->gradients.count > 1 ? ", the first of the list" : "");
    list_print(notes,
               "error: of the frequency, the scheme's own included, from a "
               "run at half the step, or at a sixteenth of the tolerance%s; "
               "resolution: without that",
               j->smooth ? "" : ", and one by dop853, as H is not smooth");
}

static int analyse_all(frequencies_job *j, const options *o) {
    page result = {0};
    int status = TOOL_OK;
    make_table(j, o);
    for (size_t i = 0; !status && i < j->plan.integrators.count; i++)
        status = run_and_analyse(j, o, j->plan.integrators.item[i]);
    result.table = j->table;
    result.after = j->words;
    j->words = (list){0};
    if (!(o->quiet && o->format == FORMAT_TABLE))
        note(j, o, &result.before);
    if (!status)
        status = output_page(o, &result, j->worst);
    return status;
}

static int frequencies(const options *o) {
    frequencies_job j = {.worst = TOOL_OK};
    int status = plan_make(&j.plan, o);
    if (!status)
        status = choose(&j, o);
    if (!status)
        status = analyse_all(&j, o);
    for (size_t i = 0; i < j.count; i++)
        nevh_spectral_samples_free(j.all[i].samples);
    plan_free(&j.plan);
    return status;
}

const command frequencies_command = {
    .name = "frequencies",
    .operand = "SCENE",
    .brief = "the frequencies in the orbit",
    .help =
        "the frequencies in the orbit by each integrator, with amplitudes, errors and drift",
    .examples = "frequencies pendulum\n"
                "frequencies coupled-pendulums --integrators gauss6",
    .options = "SCENE STEPS TABLE tolerance observable",
    .columns = "scene,integrator,observable,rank,frequency,error,"
               "amplitude,phase,drift,period,resolution",
    .run = frequencies,
};

/* nevh fit: parameters and starts from measured points.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "fit_private.h"
#include "plot/plot.h"
#include <math.h>
#include <string.h>

typedef struct {
    plan plan;
    measured data;
    fitting fit;
    bool poor; /* the numbers do not explain the data */
} job;

static int check_points(const job *j, const options *o) {
    const measured *m = &j->data;
    if (!o->fit.data || !o->vary.count)
        return tool_refuse(
            "nevh fit takes --data FILE.csv and --vary A,B: what "
            "was measured, and what is to be found");
    if (m->points * m->columns <= j->fit.count)
        return tool_refuse(
            "--data %s: %zu measured numbers are too few for the "
            "%zu of --vary",
            m->file, m->points * m->columns, j->fit.count);
    if (!(m->points && m->t[m->points - 1] > j->plan.run->t_start))
        return tool_refuse("--data %s: no point is after the start, t = %g",
                           m->file, j->plan.run->t_start);
    return TOOL_OK;
}

/* Numbers that the scene's own would take along when it changes. */
static void keep_steps(job *j) {
    plan *p = &j->plan;
    fit_scheme *now = &j->fit.now;
    now->dt = p->dt[0];
    now->tolerance = p->tolerances ? p->tolerance[0] : 0;
    j->fit.given = *now;
    p->dt = &now->dt;
    p->dts = 1;
    p->tolerance = &now->tolerance;
    p->tolerances = 1;
    p->native = NEVH_NATIVE_NEVER;
}

/* Spread of the data about the mean of each column, in units of their deviations. */
static double spread_of(const fitting *f) {
    const measured *m = f->data;
    double sum = 0;
    for (size_t k = 0; k < m->columns; k++) {
        double mean = 0, even = m->period[k] / sqrt(12); /* angles at random */
        for (size_t i = k; i < m->points * m->columns; i += m->columns)
            mean += m->value[i] / (double)m->points;
        for (size_t i = k; i < m->points * m->columns; i += m->columns) {
            double r = m->value[i] - mean;
            r = even > 0 && fabs(r) > even ? even : r;
            r /= m->sigma ? m->sigma[i] : f->sigma;
            sum += r * r;
        }
    }
    return sqrt(sum);
}

/* Exact derivatives, where H has them and none are asked for: the orbits are the
   same, and planning them anew takes no trial of difference steps. */
static void choose_gradient(job *j, const options *o) {
    list *names = &j->plan.gradients;
    list before = *names;
    if (o->gradients.count)
        return;
    *names = (list){0};
    list_add(names, "exact");
    nevh_stepper *s = plan_stepper(&j->plan, j->fit.now.integrator);
    bool fits = !nevh_stepper_status(s);
    nevh_stepper_free(s);
    if (fits)
        j->fit.asked = before;
    else
        *names = before;
}

static int begin(job *j, const options *o) {
    options plain = *o;
    plain.vary = (list){0}; /* names, no lines of [ensemble] */
    if (!o->fit.data || !o->vary.count)
        return check_points(j, o);
    if (plan_make(&j->plan, &plain) ||
        measured_read(&j->data, &j->plan, o, o->columns))
        return TOOL_USAGE;
    measured_bound(&j->data, &j->plan, o);
    keep_steps(j);
    nevh_stepper *s = plan_first(&j->plan, &j->fit.now.integrator);
    nevh_stepper_free(s);
    if (!s)
        return TOOL_USAGE;
    j->fit.given.integrator = j->fit.now.integrator;
    choose_gradient(j, o);
    j->fit.plan = &j->plan;
    j->fit.data = &j->data;
    j->fit.sigma = o->fit.sigma > 0 ? o->fit.sigma : 1;
    j->fit.sigma_known = o->fit.sigma > 0;
    j->fit.spread = spread_of(&j->fit);
    j->fit.tolerance = 1e-9;
    j->fit.difference = 6e-6; /* cube root of the rounding */
    if (o->fit.sigma > 0 && j->data.sigma)
        return tool_refuse("--sigma: %s has standard deviations of its own",
                           j->data.file);
    return fit_begin(&j->fit, o) ? TOOL_USAGE : check_points(j, o);
}

/* Output. */

static double reduced(const job *j) {
    return j->fit.chi_square / (double)(j->fit.residuals - j->fit.count);
}

static bool sigma_known(const job *j) {
    return j->fit.sigma_known || j->data.sigma;
}

static void add_columns(const job *j, table *t, bool is_table) {
    table_titles(t, is_table ? "parameter,value,error,95 % from,to,started at"
                             : fit_command.columns);
    for (size_t i = 0; i < j->fit.count; i++) {
        char *title = text_print(is_table ? "corr.\n%s" : "correlation_%s",
                                 j->fit.item[i].name);
        table_column(t, title);
    }
    if (!is_table) {
        table_column(t, "tolerance");
        table_column(t, "scheme_error");
    }
}

/* As many digits as the error leaves, and two. */
static void show_value(table *t, double value, double error) {
    double places = 1 - floor(log10(error));
    bool plain =
        error > 0 && isfinite(places) && fabs(value) < 1e6 && places <= 12;
    if (plain)
        table_shown(t, "%.*f", (int)fmax(places, 0), value);
    else
        table_shown(t, "%.10g", value);
}

/* An end of an interval; "-" where none was found. */
static void show_end(table *t, double value, double error) {
    if (isfinite(value))
        show_value(t, value, error);
    else
        table_text(t, "-");
}

static void add_row(const job *j, table *t, size_t k) {
    const varied *v = &j->fit.item[k];
    table_text(t, v->name);
    show_value(t, v->value, v->error);
    table_shown(t, "%.2g", v->error);
    show_end(t, v->low, v->error);
    show_end(t, v->high, v->error);
    table_shown(t, "%.6g", v->first);
    for (size_t i = 0; i < j->fit.count; i++)
        table_shown(t, "%.3f", j->fit.correlation[k * j->fit.count + i]);
}

static bool is_adaptive(const fitting *f) {
    return nevh_integrator_adaptive(
        plan_scheme(f->plan, f->now.integrator, &(bool){false}));
}

static void add_record(const job *j, table *t, size_t k) {
    const fitting *f = &j->fit;
    const varied *v = &f->item[k];
    const double numbers[] = {v->first, v->value, v->error, v->low, v->high};
    table_text(t, j->plan.name);
    table_text(t, f->now.integrator);
    table_number(t, f->now.dt);
    table_text(t, v->name);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (isfinite(numbers[i]))
            table_number(t, numbers[i]);
        else
            table_text(t, "");
    table_shown(t, "%zu", f->residuals);
    table_shown(t, "%zu", f->residuals - f->count);
    table_number(t, f->chi_square);
    table_number(t, reduced(j));
    for (size_t i = 0; i < f->count; i++)
        table_number(t, f->correlation[k * f->count + i]);
    if (is_adaptive(f))
        table_number(t, f->now.tolerance);
    else
        table_text(t, "");
    if (f->evidence == FIT_UNCHECKED)
        table_text(t, "");
    else
        table_number(t, fabs(v->moved));
}

static void judge(const job *j, list *words) {
    const fitting *f = &j->fit;
    static const double close = 0.999;
    double degrees = (double)(f->residuals - f->count), ratio = reduced(j);
    double spread = 4 * sqrt(2 / degrees); /* four standard deviations */
    if (sigma_known(j) && ratio > 1 + spread)
        list_print(
            words,
            "The residuals are %.2g times as large as sigma says: the "
            "scene lacks an effect, the fit is in another minimum (begin "
            "nearer: --set, --start), or sigma is too small.",
            sqrt(ratio));
    if (sigma_known(j) && ratio < 1 - spread)
        list_print(words,
                   "The residuals are %.2g times sigma: sigma is too large.",
                   sqrt(ratio));
    for (size_t k = 0; k < f->count; k++)
        for (size_t i = 0; i < k; i++)
            if (fabs(f->correlation[k * f->count + i]) > close)
                list_print(words,
                           "%s and %s are hardly told apart (correlation "
                           "%.5f): the data fix a combination of them better "
                           "than each.",
                           f->item[i].name, f->item[k].name,
                           f->correlation[k * f->count + i]);
}

/* Says where the sum of squares is hardly below that about the means: as many numbers
   would do that to noise. */
static void judge_spread(const job *j, list *words) {
    static const double of_noise =
        4; /* of a number, with a frequency to find */
    const fitting *f = &j->fit;
    double whole = f->spread * f->spread;
    double gained = (whole - f->chi_square) / (double)f->count;
    if (!j->poor && f->spread > 0 && gained < of_noise * reduced(j))
        list_print(words,
                   "The fit explains the data no better than their mean: its "
                   "residuals have %.0f %% of their spread about it, which "
                   "%zu number%s may do to noise.  The data do not show the "
                   "motion.",
                   100 * sqrt(f->chi_square / whole), f->count,
                   f->count == 1 ? "" : "s");
}

/* So that what is cut off is below a hundredth of the error. */
static int digits_of(double value, double error) {
    double digits = error > 0 ? log10(fabs(value) / error) + 3 : 0;
    return (int)fmin(fmax(digits, 7), 12);
}

/* With the values found, of parameters or of starts: "l=1,g=2". */
static char *add_values(char *line, const fitting *f, bool starts) {
    char *values = text_print("%s", "");
    for (size_t k = 0; k < f->count; k++) {
        if (f->item[k].start != starts)
            continue;
        double value = f->item[k].value;
        text_extend(&values, "%s%s=%.*g", *values ? "," : "", f->item[k].name,
                    digits_of(value, f->item[k].error), value);
    }
    if (*values)
        line = shell_option(line, starts ? "start" : "set", values);
    return line;
}

static char *add_scheme(char *line, const fitting *f, const options *o) {
    const fit_scheme *now = &f->now, *given = &f->given;
    bool other = strcmp(now->integrator, given->integrator) != 0;
    if (o->integrators.count || other)
        line = shell_option(line, "integrators", now->integrator);
    if (o->dt.count || now->dt != given->dt)
        line = shell_number(line, "dt", now->dt);
    if (is_adaptive(f) && (o->tolerances || other))
        line = shell_number(line, "tolerance", now->tolerance);
    return line;
}

/* The run of the values found, as they were fitted. */
static void add_next(const job *j, const options *o, list *words) {
    char *line = shell_line(o, "run", j->plan.name);
    line = add_values(line, &j->fit, false);
    line = add_values(line, &j->fit, true);
    line = add_scheme(line, &j->fit, o);
    if (o->t_end)
        line = shell_option(line, "t-end", o->t_end);
    line = shell_option(line, "data", o->fit.data);
    list_add(words, "Next:");
    list_print(words, "%s --plot-kind time --plot -", line);
}

/* The origin of the errors, in words. */
static char *note_errors(const job *j) {
    if (sigma_known(j))
        return text_print("%s", "");
    if (fit_is_rounding(&j->fit, j->fit.chi_square))
        return text_print(
            " (the residuals are rounding: errors are by residuals "
            "of %g of the spread of the data)",
            FIT_ROUNDING);
    return text_print("%s", " (sigma is unknown: errors are by the residuals "
                            "themselves)");
}

static void add_words(job *j, const options *o, list *words) {
    const fitting *f = &j->fit;
    char *errors = note_errors(j);
    list_print(
        words,
        "%zu residuals, %zu degrees of freedom: chi-square %.4g, reduced "
        "%.4g%s",
        f->residuals, f->residuals - f->count, f->chi_square, reduced(j),
        errors);
    for (size_t k = 0; k < j->data.columns; k++) {
        const char *name = j->data.names.item[k];
        const char *unit = nevh_scene_label(j->plan.scene, name);
        list_print(words, "rms of the residuals of %s: %.3g%s%s", name,
                   f->rms[k], *unit ? " " : "", unit);
    }
    fit_scheme_words(f, words);
    fit_interval_words(f, words);
    judge(j, words);
    bool alike = fit_residual_words(f, f->residual, words);
    fit_sparse_words(&j->fit, words);
    j->poor = fit_leaves(f, alike ? 0.5 : 1, f->chi_square);
    judge_spread(j, words);
    add_next(j, o, words);
}

static void note(const job *j, const options *o, list *notes) {
    plan_notes(&j->plan, notes);
    settings_notes(o, notes);
    measured_note(&j->data, notes);
    plan_note_first(&j->plan, j->fit.now.integrator, notes);
    list_print(notes, "sigma: %s",
               j->data.sigma        ? "of the data"
               : j->fit.sigma_known ? "of --sigma"
                                    : "unknown, the same for all");
}

/* The minimum is there, but not what was measured. */
static int tell_poor(const job *j) {
    tool_refuse("%s: the fit does not explain the data: its residuals have "
                "%.0f %% of their spread, so its numbers are not those of the "
                "data; begin nearer: --set, --start, with a "
                "shorter --t-end, or add the effect that is lacking",
                j->plan.name, 100 * sqrt(j->fit.chi_square) / j->fit.spread);
    return TOOL_FAILED;
}

static int print(job *j, const options *o) {
    page result = {.table = table_new()};
    bool is_table = o->format == FORMAT_TABLE;
    add_columns(j, result.table, is_table);
    for (size_t k = 0; k < j->fit.count; k++)
        if (is_table)
            add_row(j, result.table, k);
        else
            add_record(j, result.table, k);
    if (!(o->quiet && is_table))
        note(j, o, &result.before);
    add_words(j, o, &result.after);
    int status = output_page(o, &result, TOOL_OK);
    return !status && j->poor ? tell_poor(j) : status;
}

/* Numbers that have gone far off, or nowhere, are seen from where they are. */
static void report_divergence(const job *j) {
    const fitting *f = &j->fit;
    list items = {0};
    for (size_t k = 0; k < f->count; k++)
        list_print(&items, "%s = %.4g (from %.4g)", f->item[k].name,
                   f->item[k].value, f->item[k].first);
    char *all = list_joined(&items);
    bool known = f->sigma_known || f->data->sigma;
    tool_refuse("%s: the fit does not converge: after %zu iterations it is at "
                "%s, with residuals of rms %.3g%s; begin nearer: --set, "
                "--start, or with a shorter --t-end",
                j->plan.name, f->iterations, all,
                sqrt(f->chi_square / (double)f->residuals),
                known ? " standard deviations" : "");
}

/* Which numbers, and why. */
static int report_failure(const job *j) {
    const fitting *f = &j->fit;
    list names = {0};
    for (size_t k = 0; f->undetermined && k < f->count; k++)
        if (f->undetermined[k])
            list_add(&names, f->item[k].name);
    char *all = list_joined(&names);
    if (names.count == 1)
        tool_refuse("%s: not determined by these data: %s, which changes "
                    "nothing that was measured; leave it out of --vary",
                    j->plan.name, all);
    else if (names.count)
        tool_refuse("%s: not determined by these data: %s%s%s%s; leave one out "
                    "of --vary, or measure what tells them apart",
                    j->plan.name, all,
                    *f->direction ? ": where they change together, " : "",
                    f->direction,
                    *f->direction ? ", nothing that was measured changes" : "");
    else if (fit_is_chaotic(f))
        tool_refuse("%s: these data determine nothing: the orbit is chaotic, "
                    "and rounding alone changes it by %.2g of the spread of "
                    "the data; fit its beginning: --t-end",
                    j->plan.name, f->rounding / f->spread);
    else if (f->why)
        tool_refuse("%s: no fit: there is no orbit: %s", j->plan.name, f->why);
    else
        report_divergence(j);
    return TOOL_FAILED;
}

static void clear(job *j) {
    plan_free(&j->plan);
}

static int fit(const options *o) {
    job j = {0};
    int status = begin(&j, o);
    if (!status && fit_solve(&j.fit))
        status = report_failure(&j);
    if (!status)
        status = print(&j, o);
    clear(&j);
    return status;
}

const command fit_command = {
    .name = "fit",
    .operand = "SCENE",
    .brief = "parameters and starts from measured points",
    .help =
        "parameters and starts from measured points: least squares, with errors and correlations",
    .examples = "fit pendulum-filmed --data pendulum-filmed.csv --vary g\n"
                "fit pendulum-filmed --data pendulum-filmed.csv --vary g,phi",
    .options = "SCENE STEPS TABLE tolerance vary data sigma columns",
    .columns = "scene,integrator,dt,parameter,start,value,error,low,"
               "high,residuals,degrees_of_freedom,chi_square,"
               "reduced_chi_square",
    .run = fit,
};

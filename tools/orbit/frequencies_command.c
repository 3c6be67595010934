/* nevh frequencies: the lines of a spectrum, by integrator and observable.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/plan.h"
#include <math.h>
#include <nevh/frequencies.h>
#include <stdlib.h>
#include <string.h>

enum { LINES = 6, MOST_SAMPLES = 1 << 17, MOST_COORDINATES = 4 };

/* A coordinate, or a formula. */
typedef struct {
    char *name;
    size_t k;      /* of the coordinate */
    bool formula;  /* the scene's judged one */
    double period; /* an angle: its cosine is taken where it goes round */
    nevh_spectral_samples *samples;
} observed;

typedef struct {
    plan plan;
    observed *all;
    size_t count;
    double begin, end; /* of the run */
    int failed;        /* a formula's status */
    table *table;
    list words;
    int worst;
} job;

static int choose(job *j, const options *o) {
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
    return o->observable && nevh_scene_set_judged(p->scene, o->observable)
               ? scene_report(p->scene, o)
               : TOOL_OK;
}

static int take(void *data, size_t step, double t, const double q[],
                const double p[]) {
    job *j = data;
    j->begin = step ? j->begin : t;
    j->end = t;
    for (size_t i = 0; i < j->count; i++) {
        observed *a = &j->all[i];
        double x = q[a->k];
        if (a->formula)
            j->failed = nevh_scene_judged_value(j->plan.scene, t, q, p, &x);
        if (j->failed)
            return 1;
        nevh_spectral_samples_take(a->samples, step, t, x);
    }
    return 0;
}

/* returns  TOOL_OK; TOOL_FAILED with the reason in the words */
static int run(job *j, const char *integrator) {
    const plan *p = &j->plan;
    nevh_stepper *s = plan_stepper(p, integrator);
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(integrator, &transformed);
    bool own = transformed || nevh_integrator_own_time(scheme);
    double *q = tool_allocate(2 * p->n, sizeof *q), *m = q + p->n, stopped;
    nevh_observer observer = {take, j, 1};
    int status = nevh_stepper_status(s);
    j->failed = 0;
    for (size_t i = 0; i < j->count; i++)
        nevh_spectral_samples_restart(j->all[i].samples);
    memcpy(q, p->q, p->n * sizeof *q);
    memcpy(m, p->p, p->n * sizeof *q);
    if (status || own) {
        list_print(&j->words, "%s refused: %s", integrator,
                   status ? nevh_stepper_message(s)
                          : "it chooses times of its own, and samples are at "
                            "equal times");
        status = -1;
    } else {
        status = plan_run(p, s, p->dt[0], q, m, &observer, 1, &stopped);
        if (status)
            list_print(&j->words, "%s failed: %s", integrator,
                       j->failed ? nevh_scene_message(p->scene)
                                 : nevh_stepper_message(s));
    }
    if (status > 0)
        j->worst = TOOL_FAILED;
    free(q);
    nevh_stepper_free(s);
    return status ? TOOL_FAILED : TOOL_OK;
}

/* What of an angle that goes round is quasi-periodic. */
static char *straighten(const observed *a) {
    static const double turn = 6.283185307179586;
    if (!nevh_spectral_samples_straighten(a->samples, a->period))
        return text_print("%s", a->name);
    return a->period == turn
               ? text_print("cos(%s)", a->name)
               : text_print("cos(%.17g*%s)", turn / a->period, a->name);
}

static void add_row(job *j, const options *o, const char *integrator,
                    const char *name, size_t rank,
                    const nevh_spectral_line *l) {
    table *t = j->table;
    double period = 6.283185307179586 / l->frequency;
    if (o->format != FORMAT_TABLE) {
        table_text(t, j->plan.name);
        table_text(t, integrator);
        table_text(t, name);
        table_shown(t, "%zu", rank);
        table_number(t, l->frequency);
        table_number(t, l->error);
        table_number(t, l->amplitude);
        table_number(t, l->phase);
        table_number(t, l->drift);
        table_number(t, period);
        return;
    }
    table_text(t, integrator);
    table_text(t, name);
    table_shown(t, "%zu", rank);
    table_shown(t, "%.15g", l->frequency);
    table_shown(t, "%.0e", l->error);
    if (isnan(l->drift))
        table_text(t, "-");
    else
        table_shown(t, "%.0e", l->drift);
    table_shown(t, "%.10g", period);
    table_shown(t, "%.6g", l->amplitude);
    table_shown(t, "%.4f", l->phase);
}

/* What grows steadily is no sum of oscillations. */
static void judge_line(job *j, const char *integrator, const char *name,
                       const double x[], size_t count, double h) {
    static const double straight = 0.9;
    double n = (double)count, mean = 0, tt = 0, tx = 0, xx = 0;
    for (size_t k = 0; k < count; k++)
        mean += x[k] / n;
    for (size_t k = 0; k < count; k++) {
        double t = (double)k - (n - 1) / 2, d = x[k] - mean;
        tt += t * t, tx += t * d, xx += d * d;
    }
    if (xx > 0 && tx * tx > straight * tt * xx)
        list_print(&j->words,
                   "%s, %s: it changes along a straight line, by %.3g a unit "
                   "of time: it is not periodic, or the run is too short.",
                   integrator, name, tx / tt / h);
}

/* Where samples of the whole run have no room, those of its beginning tell. */
static void judge_length(job *j, const char *integrator, const char *name,
                         double length, double run) {
    if (length < 0.49 * run)
        list_print(&j->words,
                   "%s, %s: of the first %.6g of the run: there is no room for "
                   "more samples as dense as the fastest motion needs.",
                   integrator, name, length);
}

/* A frequency that moves is none. */
static void judge(job *j, const char *integrator, const char *name,
                  const nevh_spectral_line *l) {
    static const double moving = 1e-6;
    if (isnan(l->drift))
        list_print(&j->words,
                   "%s, %s: a half of the run does not show the first "
                   "frequency: the orbit is chaotic, loses energy, or the run "
                   "is too short to tell lines apart.",
                   integrator, name);
    else if (fabs(l->drift) > moving * l->frequency)
        list_print(&j->words,
                   "%s, %s: the first frequency moves by %.1e between the "
                   "halves of the run: the orbit is chaotic, loses energy, or "
                   "the run is too short to tell lines apart.",
                   integrator, name, l->drift);
}

static int analyse(job *j, const options *o, const char *integrator) {
    nevh_spectral_line lines[LINES];
    for (size_t i = 0; i < j->count; i++) {
        observed *a = &j->all[i];
        size_t found = 0, count;
        double h;
        char *name = straighten(a);
        const double *values =
            nevh_spectral_samples_values(a->samples, &count, &h);
        int status = nevh_frequencies(h, count, values, LINES, lines, &found);
        if (!status && !found)
            list_print(&j->words, "%s, %s: it does not move.", integrator,
                       name);
        for (size_t k = 0; !status && k < found; k++)
            add_row(j, o, integrator, name, k + 1, &lines[k]);
        if (!status && found) {
            judge(j, integrator, name, &lines[0]);
            judge_line(j, integrator, name, values, count, h);
            judge_length(j, integrator, name, h * (double)(count - 1),
                         j->end - j->begin);
        }
        if (status == NEVH_EDOM) {
            list_print(&j->words, "%s, %s failed: it is not finite", integrator,
                       name);
            j->worst = TOOL_FAILED;
        }
        free(name);
        if (status == NEVH_EINVAL)
            return tool_refuse("%s: %zu samples are too few: 64 steps at least",
                               j->plan.name, count);
        if (status == NEVH_ENOMEM)
            return tool_refuse("out of memory");
        table_group(j->table);
    }
    return TOOL_OK;
}

static void make_table(job *j, const options *o) {
    static const char *const csv[] = {
        "scene", "integrator", "observable", "rank",  "frequency",
        "error", "amplitude",  "phase",      "drift", "period"};
    static const char *const shown[] = {"integrator", "observable", "rank",
                                        "frequency",  "error",      "drift",
                                        "period",     "amplitude",  "phase"};
    j->table = table_new();
    if (o->format == FORMAT_TABLE)
        table_columns(j->table, shown, sizeof shown / sizeof *shown);
    else
        table_columns(j->table, csv, sizeof csv / sizeof *csv);
}

static void note(const job *j, const options *o, list *notes) {
    const plan *p = &j->plan;
    plan_notes(p, notes);
    settings_notes(o, notes);
    list_print(notes, "frequency: radians a unit of time; dt = %.9g%s",
               p->dt[0], p->dts > 1 ? ", the first of the list" : "");
    list_print(notes, "gradient: %s%s", p->gradients.item[0],
               p->gradients.count > 1 ? ", the first of the list" : "");
}

static int analyse_all(job *j, const options *o) {
    page result = {0};
    int status = TOOL_OK;
    make_table(j, o);
    for (size_t i = 0; !status && i < j->plan.integrators.count; i++)
        if (!run(j, j->plan.integrators.item[i]))
            status = analyse(j, o, j->plan.integrators.item[i]);
    result.table = j->table;
    result.after = j->words;
    j->words = (list){0};
    if (!(o->quiet && o->format == FORMAT_TABLE))
        note(j, o, &result.before);
    if (!status)
        status = output_page(o, &result, j->worst);
    page_free(&result);
    return status;
}

int frequencies_command(const options *o) {
    job j = {.worst = TOOL_OK};
    int status = plan_make(&j.plan, o);
    if (!status)
        status = choose(&j, o);
    if (!status)
        status = analyse_all(&j, o);
    for (size_t i = 0; i < j.count; i++) {
        free(j.all[i].name);
        nevh_spectral_samples_free(j.all[i].samples);
    }
    free(j.all);
    plan_free(&j.plan);
    return status;
}

/* nevh section: points of Poincare and stroboscopic sections.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "ensemble/members.h"
#include "portrait.h"
#include <float.h>
#include <math.h>
#include <nevh/section.h>
#include <stdlib.h>
#include <string.h>

/* A section of the scene and its points, of 2 + items numbers each: t,
   direction, items. */
typedef struct {
    nevh_scene *scene;
    size_t number, points;
    const nevh_scene_section *decl;
    double low, high; /* of what crosses, LEFT - RIGHT, at steps */
    double *periods;  /* of items that are coordinates; 0: none */
    double *numbers;
    size_t *members; /* whose point it is */
} series;

typedef struct {
    const plan *plan;
    series *all;
    size_t count;
    const char *integrator;
    members members; /* where they are: at the ends of their runs, too */
    list starts;     /* the key to them; may be none */
    double after;    /* earlier points are left out */
    size_t at;       /* the member that is run */
    size_t failed;   /* members */
    double stopped;  /* where the scene's `stop` said; NAN */
    char *ended;     /* how, where that was not at t_end; or NULL */
} section_job;

/* Into (-period/2, period/2], where rounding makes no other of half a period. */
static double wrapped(double x, double period) {
    static const double rounding = 1e-9;
    if (period == 0)
        return x;
    x = remainder(x, period);
    return x <= (rounding - 0.5) * period ? x + period : x;
}

static double *new_point(series *s) {
    size_t width = 2 + s->decl->items;
    s->numbers = tool_grown(s->numbers, s->points, width * sizeof *s->numbers);
    s->members = tool_grown(s->members, s->points, sizeof *s->members);
    return s->numbers + width * s->points++;
}

static int keep(void *data, const nevh_point *point) {
    section_job *j = data;
    series *s = &j->all[point->section];
    if (point->t < j->after)
        return 0;
    double *numbers = new_point(s), *items = numbers + 2;
    s->members[s->points - 1] = j->at;
    numbers[0] = point->t;
    numbers[1] = point->direction;
    if (nevh_scene_section_items(s->scene, s->number, point->t, point->q,
                                 point->p, items)) {
        s->points--;
        return 1;
    }
    for (size_t i = 0; i < s->decl->items; i++)
        items[i] = wrapped(items[i], s->periods[i]);
    return 0;
}

static int value(void *data, double t, const double q[], const double p[],
                 double *result) {
    series *s = data;
    int status = nevh_scene_section_cross(s->scene, s->number, t, q, p, result);
    if (!status) {
        s->low = fmin(s->low, *result);
        s->high = fmax(s->high, *result);
    }
    return status;
}

static void add_series(section_job *j, size_t number) {
    series *s = &j->all[j->count++];
    s->scene = j->plan->scene;
    s->number = number;
    s->low = INFINITY;
    s->high = -INFINITY;
    s->decl = nevh_scene_section_at(s->scene, number);
    s->periods = tool_allocate(s->decl->items, sizeof *s->periods);
    for (size_t i = 0; i < s->decl->items; i++)
        s->periods[i] = plan_period(j->plan, s->decl->item[i]);
}

static bool asked_for(const list *names, const char *name) {
    return names->count == 0 || list_has(names, name);
}

static int check_names(const plan *p, const list *names) {
    list known = {0};
    int status = TOOL_OK;
    size_t count = nevh_scene_section_count(p->scene);
    const char *shown = nevh_scene_coordinate(p->scene, 0);
    for (size_t i = 0; i < count; i++)
        list_add(&known, nevh_scene_section_at(p->scene, i)->name);
    for (size_t i = 0; !status && i < names->count; i++)
        if (!list_has(&known, names->item[i]))
            status = tool_unknown("section", names->item[i], &known);
    if (!status && count == 0)
        status = tool_refuse("%s: the scene has no [sections], as: plane = "
                             "when %s = 0, rising: %s, p_%s",
                             p->name, nevh_scene_coordinate(p->scene, p->n > 1),
                             shown, shown);
    return status;
}

/* Within the run, so that something is left. */
static int take_after(section_job *j, const plan *p, const options *o) {
    j->after = -INFINITY;
    if (!o->after)
        return TOOL_OK;
    if (scene_number(p->scene, o, o->after, &j->after))
        return TOOL_USAGE;
    if (!(j->after <= p->t_end))
        return tool_refuse("--after %s: the run is from t = %g to %g", o->after,
                           p->run->t_start, p->t_end);
    /* A multiple of a period, rounded another way, is not before it. */
    j->after -= 16 * DBL_EPSILON * fabs(j->after);
    return TOOL_OK;
}

static int choose(section_job *j, const plan *p, const options *o) {
    size_t count = nevh_scene_section_count(p->scene);
    j->plan = p;
    if (check_names(p, &o->sections) || take_after(j, p, o))
        return TOOL_USAGE;
    j->all = tool_allocate(count, sizeof *j->all);
    for (size_t i = 0; i < count; i++)
        if (asked_for(&o->sections, nevh_scene_section_at(p->scene, i)->name))
            add_series(j, i);
    return TOOL_OK;
}

static nevh_sections *watch(section_job *j, const nevh_stepper *s) {
    nevh_section *decl = tool_allocate(j->count, sizeof *decl);
    for (size_t i = 0; i < j->count; i++) {
        const nevh_scene_section *from = j->all[i].decl;
        decl[i] = from->every > 0
                      ? (nevh_section){.name = from->name, .every = from->every}
                      : (nevh_section){.name = from->name,
                                       .value = value,
                                       .data = &j->all[i],
                                       .direction = from->direction,
                                       .period = from->period};
    }
    return nevh_sections_new(s, decl, j->count, keep, j);
}

/* Explains the end of a run; of several runs that ended early only the first. */
static int explain(section_job *j, int status, const nevh_stepper *s,
                   const nevh_sections *x, const nevh_energy *energy) {
    const char *why = nevh_scene_message(j->plan->scene);
    int looking = nevh_sections_status(x);
    bool is_known = j->ended != NULL;
    if (isfinite(j->stopped) && !is_known)
        j->ended = stop_words(j->plan, j->stopped);
    char *doubts = status || is_known || j->members.several
                       ? NULL
                       : plan_doubts(j->plan, energy, status);
    if (doubts) {
        j->ended = text_print("warning: %s", doubts);
        tool_refuse("%s: %s", j->plan->name, j->ended);
    }
    if (!status)
        return TOOL_OK;
    if (j->failed++)
        return TOOL_FAILED;
    if (!*why)
        why = looking ? nevh_sections_message(x) : nevh_stepper_message(s);
    char *known = j->members.several
                      ? member_why(j->plan, j->members.number[j->at], why)
                      : plan_why(j->plan, why);
    j->ended = j->members.several ? text_print("member %zu failed: %s",
                                               j->members.number[j->at], known)
                                  : text_print("failed: %s", known);
    tool_refuse("%s: %s %s", j->plan->name, j->integrator, j->ended);
    return TOOL_FAILED;
}

static int run_member(section_job *j, nevh_stepper *s) {
    const plan *p = j->plan;
    nevh_sections *x = watch(j, s);
    nevh_energy *energy = plan_watch(p);
    nevh_observer observers[] = {{nevh_sections_observe, x, 1},
                                 {nevh_energy_observe, energy, 1}};
    int status = nevh_sections_status(x);
    double *q = j->members.q + j->at * p->n, *m = j->members.p + j->at * p->n;
    nevh_stepper_reset(s);
    j->stopped = NAN;
    if (!status)
        status = plan_run_from(p, s, q, m, observers,
                               j->members.several ? 1 : 2, &j->stopped);
    status = explain(j, status, s, x, energy);
    nevh_sections_free(x);
    nevh_energy_free(energy);
    return status;
}

static void name_starts(section_job *j) {
    for (size_t i = 0; i < j->members.count; i++) {
        char *name = members_start(&j->members, j->plan, i);
        if (name)
            list_add(&j->starts, name);
    }
}

static int run(section_job *j, nevh_stepper *s) {
    int worst = members_tell(&j->members, j->plan);
    name_starts(j);
    for (j->at = 0; j->at < j->members.count; j->at++)
        if (run_member(j, s))
            worst = TOOL_FAILED;
    return worst;
}

/* The columns that sections show, each once; t is there before. */
static void list_items(const section_job *j, list *items) {
    for (size_t i = 0; i < j->count; i++)
        for (size_t k = 0; k < j->all[i].decl->items; k++)
            if (strcmp(j->all[i].decl->item[k], "t") != 0 &&
                !list_has(items, j->all[i].decl->item[k]))
                list_add(items, j->all[i].decl->item[k]);
}

static double number_of(const series *s, const double *point,
                        const char *item) {
    for (size_t k = 0; k < s->decl->items; k++)
        if (strcmp(s->decl->item[k], item) == 0)
            return point[2 + k];
    return NAN;
}

static void fill(table *t, const section_job *j, const list *items) {
    for (size_t i = 0; i < j->count; i++, table_group(t)) {
        const series *s = &j->all[i];
        for (size_t k = 0; k < s->points; k++) {
            const double *point = s->numbers + k * (2 + s->decl->items);
            table_text(t, s->decl->name);
            table_number(t, point[0]);
            table_number(t, point[1]);
            for (size_t c = 0; c < items->count; c++)
                table_number(t, number_of(s, point, items->item[c]));
            if (j->members.several)
                table_shown(t, "%zu", j->members.number[s->members[k]]);
        }
    }
}

/* The left side of a crossing and its value: "theta", 0; "z - (x)", 0 if the right
   side is no number. */
static char *crossing_text(const nevh_scene_section *decl, double *at) {
    char *end;
    *at = strtod(decl->right, &end);
    if (!*end && end != decl->right)
        return text_print("%s", decl->left);
    *at = 0;
    return text_print("%s - (%s)", decl->left, decl->right);
}

/* Why there are no points. */
static char *reason(const section_job *j, const series *s) {
    const nevh_scene_section *decl = s->decl;
    const char *unit =
        decl->left ? nevh_scene_label(j->plan->scene, decl->left) : "";
    double at;
    if (decl->every > 0)
        return text_print("the run is shorter than %.4g", decl->every);
    if (!(s->low <= s->high))
        return text_print("no step was taken");
    char *what = crossing_text(decl, &at);
    bool passes = s->low < 0 && s->high > 0;
    return text_print("%s stays in %.3g ... %.3g%s%s%s", what, s->low + at,
                      s->high + at, *unit ? " " : "", unit,
                      passes && decl->direction > 0 ? " and does not rise there"
                      : passes && decl->direction < 0
                          ? " and does not fall there"
                          : "");
}

static void note_points(const section_job *j, const series *s, list *notes) {
    bool part = isfinite(j->after);
    char *why = s->points || part ? NULL : reason(j, s);
    char *from =
        part ? text_print(" after t = %g", j->after) : text_print("%s", "");
    list_print(notes, "section %s: %zu points%s%s%s", s->decl->name, s->points,
               from, why ? ": " : "", why ? why : "");
}

static void note(const section_job *j, const options *o, list *notes) {
    const plan *p = j->plan;
    plan_notes(p, notes);
    list_print(notes, "scene: %s", p->name);
    settings_notes(o, notes);
    plan_note_first(p, j->integrator, notes);
    members_note(&j->members, notes);
    members_note_energies(&j->members, p, notes);
    for (size_t i = 0; i < j->count; i++)
        note_points(j, &j->all[i], notes);
    if (j->ended)
        list_print(notes, "%s", j->ended);
}

/* Prints the reasons for an empty plot; a run that failed has printed its own. */
static int refuse_empty(const section_job *j) {
    list reasons = {0};
    for (size_t i = 0; i < j->count; i++)
        note_points(j, &j->all[i], &reasons);
    for (size_t i = 0; i < reasons.count; i++)
        tool_refuse("nothing to plot: %s", reasons.item[i]);
    return TOOL_USAGE;
}

static size_t count_points(const section_job *j) {
    size_t count = 0;
    for (size_t i = 0; i < j->count; i++)
        count += j->all[i].points;
    return count;
}

static void add_note(const section_job *j, plot *to) {
    char *energy = j->members.several
                       ? text_print("%zu orbits", j->members.count)
                       : plot_energy_at_start(j->plan);
    char *from = isfinite(j->after)
                     ? text_print("; points after t = %g", j->after)
                     : text_print("%s", "");
    char *more = text_print("%s%s%s%s", energy, from, j->ended ? "; " : "",
                            j->ended ? j->ended : "");
    plot_note_run(to, j->plan, plot_scheme(j->plan, j->integrator), more);
}

static void draw_series(const section_job *j, const series *s, plot **to,
                        const char *heading) {
    section_plot(to, j->plan, s->decl, s->points, s->numbers,
                 j->members.count > 1 ? s->members : NULL,
                 j->starts.count ? &j->starts : NULL, heading, j->integrator);
}

static int draw(const section_job *j, const options *o, int status) {
    plot *to = NULL;
    if (count_points(j) == 0)
        return status ? status : refuse_empty(j);
    for (size_t i = 0; i < j->count; i++)
        draw_series(j, &j->all[i], &to, NULL);
    add_note(j, to);
    int drawn = plot_write(to, o);
    if (!drawn)
        plot_written_report(o, j->plan, j->integrator, count_points(j));
    return drawn ? drawn : status;
}

static options with_format(const options *o) {
    options as = *o;
    as.format = option_given(o, "format") ? o->format
                : plot_replaces_rows(o)   ? FORMAT_TABLE
                                          : FORMAT_CSV;
    return as;
}

static int print(const section_job *j, const options *o, int status) {
    page result = {.table = table_new()};
    options as = with_format(o);
    list items = {0};
    if (as.format == FORMAT_TABLE)
        table_round(result.table);
    if (!(o->quiet && as.format == FORMAT_TABLE))
        note(j, o, &result.before);
    table_titles(result.table, section_command.columns);
    list_items(j, &items);
    for (size_t i = 0; i < items.count; i++)
        table_column(result.table, items.item[i]);
    if (j->members.several)
        table_column(result.table, "member");
    fill(result.table, j, &items);
    return output_page(&as, &result, status);
}

/* Shows the rows and the picture. The picture is written first if a reader of the
   rows that stops early would end the program. */
static int show(const section_job *j, const options *o, int status) {
    bool first = plot_goes_first(o);
    int drawn = first ? draw(j, o, status) : status;
    if (!plot_replaces_rows(o))
        status = print(j, o, status);
    if (plot_wanted(o) && !first && status != TOOL_USAGE)
        drawn = draw(j, o, status);
    return drawn > status ? drawn : status;
}

int section_panel(plot **to, const plan *p, const options *o,
                  const char *integrator) {
    section_job j = {.stopped = NAN, .integrator = integrator};
    nevh_stepper *s = plan_stepper(p, integrator);
    bool fits = !nevh_stepper_status(s);
    int status = fits ? choose(&j, p, o) : TOOL_OK;
    if (fits && !status)
        status = members_read(&j.members, p);
    if (fits && !status)
        status = run(&j, s);
    if (j.count && j.all[0].points && status != TOOL_USAGE)
        draw_series(&j, &j.all[0], to, integrator);
    if (*to)
        plot_same_ranges(*to, 1.5); /* a scheme that diverges has its own */
    nevh_stepper_free(s);
    return status;
}

static int section(const options *o) {
    plan p;
    section_job j = {.stopped = NAN};
    nevh_stepper *s = NULL;
    options as = with_format(o);
    int status = plan_make(&p, o);
    if (!status)
        status = members_check(&p, o);
    if (!status)
        status = choose(&j, &p, o);
    if (!status)
        status = members_read(&j.members, &p);
    if (!status)
        status = plot_check(&as);
    if (!status && !(s = plan_first(&p, &j.integrator)))
        status = TOOL_USAGE;
    if (!status)
        status = show(&j, o, run(&j, s));
    nevh_stepper_free(s);
    plan_free(&p);
    return status;
}

const command section_command = {
    .name = "section",
    .operand = "SCENE",
    .brief = "points of Poincare sections",
    .help = "points of Poincare and stroboscopic sections, as CSV",
    .examples = "section henon-heiles --t-end 200\n"
                "section henon-heiles --t-end 200 --plot section.svg",
    .options =
        "SCENE STEPS NATIVE TABLE PLOT tolerance vary transform section after",
    .columns = "section,t,direction",
    .run = section,
};

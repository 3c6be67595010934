/* nevh: an orbit, and its rows.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "trajectory.h"
#include "lost_digits.h"
#include "warnings.h"
#include "experiment/conserved.h"
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const double between_saves = 0.25;  /* seconds */
static const double share_of_saves = 0.05; /* of the time, at most */

enum { MOST_OBSERVERS = 2 };

/* Work between steps, a few times a second. */
typedef struct {
    double next, last; /* times of saves, of looks at the clock */
    size_t every;      /* steps between looks */
    const trajectory_watch *watch;
    bool shown;
} clockwork;

struct trajectory {
    const plan *plan;
    const char *integrator;
    nevh_stepper *stepper;
    row_times rows;
    row_output to;
    bool own_time, stops, finished;
    run_state now; /* q, p: of the run under way */
    double *observed, *more;
    size_t observables;
    double energy, changed; /* of the first row; by how much others differ */
    lost_digits digits;
    bool lost;
    double first[2],
        most[2]; /* largest coordinate and momentum: then, of all rows */
    nevh_observer observer[MOST_OBSERVERS];
    size_t observers;
    clockwork clock;
    int status;
};

static void reserve(trajectory *r) {
    size_t n = r->plan->n;
    run_state *s = &r->now;
    s->n = n;
    s->memory_size = nevh_stepper_save_size(r->stepper);
    s->memory = tool_allocate(s->memory_size, 1);
    s->q = tool_allocate(n, sizeof *s->q);
    s->p = tool_allocate(n, sizeof *s->p);
    r->observables = nevh_scene_shown_count(r->plan->scene, NEVH_OBSERVABLES);
    r->observed = tool_allocate(r->observables, sizeof *r->observed);
    r->more = tool_allocate(r->to.more ? r->to.more->titles.count : 0,
                            sizeof *r->more);
    memcpy(s->q, r->plan->q, n * sizeof *s->q);
    memcpy(s->p, r->plan->p, n * sizeof *s->p);
}

trajectory *trajectory_new(const plan *p, const char *integrator,
                           nevh_stepper *stepper, const row_times *rows,
                           row_output to) {
    trajectory *r = tool_allocate(1, sizeof *r);
    *r = (trajectory){.plan = p,
                      .integrator = integrator,
                      .stepper = stepper,
                      .rows = *rows,
                      .to = to,
                      .energy = NAN,
                      .now.at = {.t = p->run->t_start, .written = NAN}};
    r->own_time =
        nevh_integrator_own_time(plan_scheme(p, integrator, &(bool){false})) ||
        plan_transform(p, integrator);
    r->stops = nevh_scene_stops(p->scene);
    reserve(r);
    return r;
}

void trajectory_free(trajectory *r) {
    tool_release(r->now.memory);
    tool_release(r->now.q);
    tool_release(r->now.p);
    tool_release(r->observed);
    tool_release(r->more);
    tool_release(r);
}

/* Cells. */

static void add_title(trajectory *r, const char *prefix, const char *name) {
    char *title = text_print("%s%s", prefix, name);
    if (r->to.page)
        table_column(r->to.page->table, title);
    else
        lines_print(r->to.lines, "%s,", title);
}

static size_t more_count(const trajectory *r) {
    return r->to.more ? r->to.more->titles.count : 0;
}

void trajectory_header(trajectory *r) {
    const nevh_scene *s = r->plan->scene;
    add_title(r, "", "t");
    for (size_t k = 0; k < r->plan->n; k++)
        add_title(r, "", nevh_scene_coordinate(s, k));
    for (size_t k = 0; k < r->plan->n; k++)
        add_title(r, "p_", nevh_scene_coordinate(s, k));
    for (size_t i = 0; i < r->observables; i++)
        add_title(r, "", nevh_scene_shown_name(s, NEVH_OBSERVABLES, i));
    if (r->to.page)
        table_column(r->to.page->table, "energy");
    else
        lines_print(r->to.lines, "energy");
    for (size_t i = 0; i < more_count(r); i++)
        if (r->to.page)
            table_column(r->to.page->table, r->to.more->titles.item[i]);
        else
            lines_print(r->to.lines, ",%s", r->to.more->titles.item[i]);
    if (!r->to.page)
        lines_print(r->to.lines, "\n");
}

static void add_numbers(trajectory *r, const double numbers[], size_t count,
                        char end) {
    char text[NUMBER_SIZE];
    for (size_t i = 0; i < count; i++)
        if (r->to.page)
            table_number(r->to.page->table, numbers[i]);
        else if (isfinite(numbers[i]))
            lines_print(r->to.lines, "%s%c", number_text(text, numbers[i]),
                        end);
        else
            lines_print(r->to.lines, "%c", end);
}

static void note_size(trajectory *r, const double q[], const double p[]) {
    bool first = isnan(r->energy);
    for (size_t k = 0; k < r->plan->n; k++) {
        r->most[0] = fmax(r->most[0], fabs(q[k]));
        r->most[1] = fmax(r->most[1], fabs(p[k]));
    }
    if (first)
        memcpy(r->first, r->most, sizeof r->first);
}

/* True if the orbit grows so much that it may pass an end. */
static bool has_grown(const trajectory *r) {
    static const double much = 100;
    return (r->first[0] > 0 && r->most[0] > much * r->first[0]) ||
           (r->first[1] > 0 && r->most[1] > much * r->first[1]);
}

/* One row.  What is not finite is left empty. */
static int show(trajectory *r, double t, const double q[], const double p[]) {
    double energy;
    nevh_scene *scene = r->plan->scene;
    r->now.at.written = t;
    if (r->to.take)
        return r->to.take(r->to.data, t, q, p);
    if (nevh_scene_shown_values(scene, NEVH_OBSERVABLES, t, q, p, r->observed))
        return fprintf(stderr, "%s\n", nevh_scene_message(scene)), TOOL_USAGE;
    if (nevh_field_value(nevh_stepper_field(r->stepper), 1, &t, q, p, &energy))
        energy = NAN;
    note_size(r, q, p);
    r->energy = isnan(r->energy) ? energy : r->energy;
    r->changed = fmax(r->changed, fabs(energy - r->energy));
    add_numbers(r, &t, 1, ',');
    add_numbers(r, q, r->plan->n, ',');
    add_numbers(r, p, r->plan->n, ',');
    add_numbers(r, r->observed, r->observables, ',');
    size_t more = more_count(r);
    add_numbers(r, &energy, 1, more ? ',' : '\n');
    if (more) {
        r->to.more->fill(r->to.more->data, t, q, p, r->more);
        add_numbers(r, r->more, more - 1, ',');
        add_numbers(r, r->more + more - 1, 1, '\n');
    }
    return r->to.page ? TOOL_OK : lines_end(r->to.lines);
}

__attribute__((format(printf, 2, 3))) static void
remark(trajectory *r, const char *format, ...) {
    char text[1000];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (r->to.page)
        list_add(&r->to.page->after, text);
    else if (r->to.lines && !r->to.quiet)
        lines_print(r->to.lines, "# %s\n", text);
}

static int failed(trajectory *r, double t, const char *message) {
    char *why =
        r->to.mute ? text_print("%s", message) : plan_why(r->plan, message);
    remark(r, "failed after t = %.9g: %s", t, why);
    if (!r->to.mute)
        tool_refuse("%s: %s failed after t = %.9g: %s", r->plan->name,
                    r->integrator, t, why);
    return TOOL_FAILED;
}

static void warn(trajectory *r, const char *text) {
    remark(r, "warning: %s", text);
    fprintf(stderr, "nevh: %s: warning: %s\n", r->plan->name, text);
}

/* Warns of steps that are too long, where its energy shows errors. */
static void warn_of_steps(trajectory *r, double scale) {
    row_list rows = rows_of(r->plan);
    size_t i = 0;
    while (i < rows.count && strcmp(rows.row[i].integrator, r->integrator) != 0)
        i++;
    if (i == rows.count || r->plan->balance)
        return;
    row *own = &rows.row[i];
    own->ran = true;
    own->energy.max = r->changed / scale;
    own->energy.scale = scale;
    list found = warnings_of(r->plan, NULL, own, 1);
    for (i = 0; i < found.count; i++)
        warn(r, found.item[i]);
}

/* Warns of [invariants] that are not conserved, and of an orbit whose energy
   changes by a good part. */
static void doubt(trajectory *r) {
    static const double large = 0.1, all = 1; /* of the energy */
    static const double most_steps = 3e5;     /* of a second run */
    const plan *p = r->plan;
    bool shorter = fabs(p->t_end - p->run->t_start) <= most_steps * p->dt[0];
    list changed = {0};
    if (r->to.mute || r->to.take)
        return;
    double scale = plan_energy_scale(p);
    conserved_warn(p, &changed);
    for (size_t i = 0; i < changed.count; i++)
        warn(r, changed.item[i]);
    bool suspect = !p->balance && r->changed > large * scale;
    char *why = suspect && shorter
                    ? plan_doubts_again(p, r->integrator, p->dt[0])
                : p->balance && has_grown(r) ? ends_text(p, plan_ends(p))
                                             : NULL;
    bool known = why;
    if (suspect && !why && r->changed > all * scale)
        why = text_print("the energy changes by up to %.2g times its scale: "
                         "these steps are no measure of the orbit; take a "
                         "smaller dt, or another integrator",
                         r->changed / scale);
    if (why)
        warn(r, why);
    if (!known && shorter)
        warn_of_steps(r, scale);
}

/* When rows are due. */

static double time_of_row(const trajectory *r, uint64_t i) {
    double t0 = r->plan->run->t_start, t_end = r->plan->t_end;
    size_t others = r->rows.count - 1;
    if (r->rows.by == BY_TIMES)
        return r->rows.time[i];
    return i == others ? t_end
                       : t0 + (t_end - t0) * ((double)i / (double)others);
}

/* Times that only rounding makes different.  Nothing is close to infinity. */
static bool same(const trajectory *r, double a, double b) {
    double h = fabs(r->plan->dt[0]);
    return a == b || fabs(a - b) < 8 * DBL_EPSILON * (fabs(a) + fabs(b) + h);
}

static bool is_before(const trajectory *r, double a, double b) {
    return a < b && !same(r, a, b);
}

/* Observers and samples return whether the run is to end before t_end. */

static bool show_row(trajectory *r, double t, const double q[],
                     const double p[]) {
    r->lost = digits_are_lost(&r->digits, r->plan,
                              nevh_stepper_field(r->stepper), t, q, p);
    if (r->lost)
        return true;
    r->status = show(r, t, q, p);
    return r->status || (r->finished && t != r->plan->t_end);
}

static int take_step(void *data, size_t step, double t, const double q[],
                     const double p[]) {
    trajectory *r = data;
    if (step < r->now.at.row && t != r->plan->t_end)
        return false;
    r->now.at.row = step + r->rows.every;
    r->finished = t == r->plan->t_end;
    return show_row(r, t, q, p);
}

static int take_sample(void *data, size_t i, double t, const double q[],
                       const double p[]) {
    trajectory *r = data;
    r->now.at.row = i + 1;
    r->finished = i + 1 == r->rows.count;
    return show_row(r, t, q, p);
}

/* Ends a run at the state that the scene wants it to stop at. */
static int check_stop(trajectory *r, double t, const double q[],
                      const double p[]) {
    bool reached;
    nevh_scene *scene = r->plan->scene;
    if (nevh_scene_stop_reached(scene, t, q, p, &reached))
        return fprintf(stderr, "%s\n", nevh_scene_message(scene)), TOOL_USAGE;
    if (!reached)
        return TOOL_OK;
    r->finished = true;
    int status = r->now.at.written == t ? TOOL_OK : show(r, t, q, p);
    remark(r, "stopped at t = %.9g: %s", t, nevh_scene_stop_text(scene));
    return status;
}

/* Looks at the clock are rarer while steps are cheap, and at each step as soon as one
   is not. */
static void pace(clockwork *c, double now) {
    static const double brief = 1e-4, long_ago = 1e-3; /* seconds */
    static const size_t most = 64;
    if (now - c->last < brief && c->every < most)
        c->every *= 2;
    else if (now - c->last > long_ago)
        c->every = 1;
    c->last = now;
}

static int tick(trajectory *r) {
    clockwork *c = &r->clock;
    const trajectory_watch *w = c->watch;
    double now = wall_seconds();
    pace(c, now);
    if (now < c->next)
        return TOOL_OK;
    int status = w->save ? w->save(w->data) : TOOL_OK;
    double took = wall_seconds() - now;
    c->next = now + took + fmax(between_saves, took / share_of_saves);
    c->shown = w->progress;
    if (c->shown)
        fprintf(stderr, "\r\033[Kt = %.6g of %g", r->now.at.t, r->plan->t_end);
    return status;
}

/* Checks for the end of the run between steps: last of the observers. */
static int attend(void *data, size_t step, double t, const double q[],
                  const double p[]) {
    trajectory *r = data;
    if (r->finished)
        return false;
    r->now.at.step = step;
    r->now.at.t = t;
    if (r->stops)
        r->status = check_stop(r, t, q, p);
    if (!r->status && !r->finished)
        r->status = tick(r);
    r->observer[r->observers - 1].every = r->stops ? 1 : r->clock.every;
    return r->status || r->finished || *r->clock.watch->signal;
}

/* Saving and restoring. */

run_state *trajectory_state(trajectory *r) {
    nevh_stepper_save(r->stepper, r->now.memory);
    return &r->now;
}

static bool step_is_possible(const trajectory *r, const progress_of_run *at) {
    static const double adjusted = 2e-9; /* of the span, by which steps are */
    double t0 = r->plan->run->t_start, t_end = r->plan->t_end;
    double due = t0 + (double)at->step * r->plan->dt[0];
    bool within = (at->t >= t0 && at->t <= t_end) || same(r, at->t, t_end);
    return within && (r->own_time || same(r, at->t, due) ||
                      fabs(at->t - due) <= adjusted * fabs(t_end - t0));
}

/* The next row is not before the state, the last one not after it. */
static bool row_is_possible(const trajectory *r, const progress_of_run *at) {
    if (r->rows.by == BY_STEPS)
        return at->row >= at->step && at->row - at->step <= r->rows.every;
    return at->row < r->rows.count &&
           !is_before(r, time_of_row(r, at->row), at->t) &&
           (at->row == 0 || !is_before(r, at->t, time_of_row(r, at->row - 1)));
}

/* A file may be whole and of no run. */
int trajectory_restore(trajectory *r) {
    const progress_of_run *at = &r->now.at;
    if (!step_is_possible(r, at) || !row_is_possible(r, at))
        return tool_refuse("the saved state is of step %llu and row %llu at "
                           "t = %.9g, where this run never is",
                           (unsigned long long)at->step,
                           (unsigned long long)at->row, at->t);
    return nevh_stepper_load(r->stepper, r->now.memory, r->now.memory_size)
               ? tool_refuse("%s", nevh_stepper_message(r->stepper))
               : TOOL_OK;
}

bool trajectory_finished(const trajectory *r) {
    return r->finished;
}

/* Runs from the state that there is. */
static int run(trajectory *r) {
    const plan *p = r->plan;
    progress_of_run *at = &r->now.at;
    bool by_steps = r->rows.by == BY_STEPS;
    r->observers = 0;
    if (by_steps)
        r->observer[r->observers++] =
            (nevh_observer){take_step, r, r->rows.every};
    r->observer[r->observers++] = (nevh_observer){attend, r, 1};
    nevh_orbit orbit = {
        .t0 = p->run->t_start,
        .h = p->dt[0],
        .t_end = p->t_end,
        .observers = r->observer,
        .n_observers = r->observers,
        .times = r->rows.by == BY_TIMES ? r->rows.time : NULL,
        .n_times = by_steps ? 0 : r->rows.count,
        .sample = take_sample,
        .sample_data = r,
        .steps_before = at->step,
        .samples_before = by_steps ? 0 : at->row,
        .t_before = at->t,
    };
    int status = nevh_orbit_run(r->stepper, &orbit, r->now.q, r->now.p);
    if (status && nevh_stepper_taken(r->stepper) > at->step)
        at->t = nevh_stepper_time(r->stepper);
    at->step = nevh_stepper_taken(r->stepper);
    return status;
}

int trajectory_follow(trajectory *r, const trajectory_watch *watch) {
    double begin = wall_seconds();
    double last = fmax(fabs(r->plan->run->t_start), fabs(r->plan->t_end));
    r->clock = (clockwork){begin + between_saves, begin, 1, watch, false};
    if (!r->own_time && last + r->plan->dt[0] == last) {
        int shown = show(r, r->now.at.t, r->now.q, r->now.p);
        return shown ? shown
                     : failed(r, r->now.at.t, "no time passes in a step");
    }
    int status = run(r);
    if (r->clock.shown)
        fputs("\r\033[K", stderr);
    if (r->status)
        return r->status;
    if (r->lost)
        return failed(r, r->now.at.written, digits_lost_why);
    if (status && status != NEVH_STOPPED)
        return failed(r, r->now.at.t, nevh_stepper_message(r->stepper));
    r->finished |= !status;
    if (r->finished)
        doubt(r);
    return TOOL_OK;
}

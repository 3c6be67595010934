/* nevh: an orbit, and its rows.

   The steps of the main orbit are those of nevh_run_until.  A state between
   two of them is reached by a second stepper that takes over the memory of the
   first, so that no row changes the orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "trajectory.h"
#include "experiment/conserved.h"
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const double whole_steps = 1e-9;    /* as nevh_run_until */
static const double between_saves = 0.25;  /* seconds */
static const double share_of_saves = 0.05; /* of the time, at most */

struct trajectory {
    const plan *plan;
    const char *integrator;
    nevh_stepper *stepper, *branch;
    row_times rows;
    sink to;
    bool own_time, whole, finished;
    double h;
    uint64_t last; /* step of the main orbit, where times are not its own */
    run_state now;
    double kept_t, *kept_q, *kept_p; /* before the last step, with now.memory */
    double *q, *p;                   /* at the end of a branch */
    double *observed, *more;
    size_t observables;
    double energy, changed; /* of the first row; by how much others differ */
};

/* As nevh_run_until cuts the span. */
static void choose_steps(trajectory *r) {
    double span = r->plan->t_end - r->plan->run->t_start,
           steps = round(span / r->h);
    r->own_time =
        nevh_integrator_own_time(plan_scheme(r->integrator, &(bool){false})) ||
        plan_transform(r->plan, r->integrator);
    r->whole = !r->own_time && steps > 0 &&
               fabs(span / r->h - steps) <= whole_steps * steps;
    r->last = (uint64_t)(r->whole ? steps : floor(span / r->h));
    if (r->whole)
        r->h = span / steps;
}

static void reserve(trajectory *r) {
    size_t n = r->plan->n;
    run_state *s = &r->now;
    s->n = n;
    s->memory_size = nevh_stepper_save_size(r->stepper);
    s->memory = tool_allocate(s->memory_size, 1);
    s->q = tool_allocate(n, sizeof *s->q);
    s->p = tool_allocate(n, sizeof *s->p);
    r->kept_q = tool_allocate(n, sizeof *r->kept_q);
    r->kept_p = tool_allocate(n, sizeof *r->kept_p);
    r->q = tool_allocate(n, sizeof *r->q);
    r->p = tool_allocate(n, sizeof *r->p);
    r->observables = nevh_scene_shown_count(r->plan->scene, NEVH_OBSERVABLES);
    r->observed = tool_allocate(r->observables, sizeof *r->observed);
    r->more = tool_allocate(r->to.more ? r->to.more->titles.count : 0,
                            sizeof *r->more);
    memcpy(s->q, r->plan->q, n * sizeof *s->q);
    memcpy(s->p, r->plan->p, n * sizeof *s->p);
}

trajectory *trajectory_new(const plan *p, const char *integrator,
                           nevh_stepper *stepper, const row_times *rows,
                           sink to) {
    trajectory *r = tool_allocate(1, sizeof *r);
    *r = (trajectory){.plan = p,
                      .integrator = integrator,
                      .stepper = stepper,
                      .branch = nevh_stepper_copy(stepper),
                      .rows = *rows,
                      .to = to,
                      .h = p->dt[0],
                      .energy = NAN,
                      .now.at = {.t = p->run->t_start, .written = NAN}};
    reserve(r);
    choose_steps(r);
    return r;
}

void trajectory_free(trajectory *r) {
    nevh_stepper_free(r->branch);
    free(r->now.memory);
    free(r->now.q);
    free(r->now.p);
    free(r->kept_q);
    free(r->kept_p);
    free(r->q);
    free(r->p);
    free(r->observed);
    free(r->more);
    free(r);
}

/* Cells. */

static void add_title(trajectory *r, const char *prefix, const char *name) {
    char *title = text_print("%s%s", prefix, name);
    if (r->to.page)
        table_column(r->to.page->table, title);
    else
        lines_print(r->to.lines, "%s,", title);
    free(title);
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

/* One row.  What is not finite is left empty. */
static int show(trajectory *r, double t, const double q[], const double p[]) {
    double energy;
    nevh_scene *scene = r->plan->scene;
    r->now.at.written = t;
    if (r->to.take)
        return r->to.take(r->to.data, t, q, p);
    if (nevh_scene_shown_values(scene, NEVH_OBSERVABLES, t, q, p, r->observed))
        return fprintf(stderr, "%s\n", nevh_scene_message(scene)), TOOL_USAGE;
    if (nevh_field_value(nevh_stepper_field(r->branch), 1, &t, q, p, &energy))
        energy = NAN;
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
    free(why);
    return TOOL_FAILED;
}

static void warn(trajectory *r, const char *text) {
    remark(r, "warning: %s", text);
    fprintf(stderr, "nevh: %s: warning: %s\n", r->plan->name, text);
}

/* That invariants are none, and what is wrong with an orbit whose energy changes
   by a good part. */
static void doubt(trajectory *r) {
    static const double large = 0.1, all = 1; /* of the energy */
    static const double most_steps = 3e5;     /* of a second run */
    const plan *p = r->plan;
    double scale = plan_energy_scale(p);
    bool shorter = fabs(p->t_end - p->run->t_start) <= most_steps * p->dt[0];
    list changed = {0};
    if (r->to.mute || r->to.take)
        return;
    conserved_warn(p, &changed);
    for (size_t i = 0; i < changed.count; i++)
        warn(r, changed.item[i]);
    list_free(&changed);
    bool suspect = !p->balance && r->changed > large * scale;
    char *why = suspect && shorter
                    ? plan_doubts_again(p, r->integrator, p->dt[0])
                    : NULL;
    if (suspect && !why && r->changed > all * scale)
        why = text_print("the energy changes by up to %.2g times its scale: "
                         "these steps are no measure of the orbit; take a "
                         "smaller dt, or another integrator",
                         r->changed / scale);
    if (why)
        warn(r, why);
    free(why);
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

/* Of the next row, as far as it does not depend on steps. */
static double next_row(const trajectory *r) {
    return r->rows.by == BY_STEPS ? r->plan->t_end
                                  : time_of_row(r, r->now.at.row);
}

/* Times that only rounding makes different.  Nothing is close to infinity. */
static bool same(const trajectory *r, double a, double b) {
    return a == b || fabs(a - b) < 8 * DBL_EPSILON * (fabs(a) + fabs(b) + r->h);
}

static bool is_before(const trajectory *r, double a, double b) {
    return a < b && !same(r, a, b);
}

static double time_of_step(const trajectory *r, uint64_t step) {
    if (r->whole && step == r->last)
        return r->plan->t_end;
    return r->plan->run->t_start + (double)step * r->h;
}

static void count_row(trajectory *r) {
    if (r->rows.by == BY_STEPS)
        r->now.at.row = r->now.at.step + r->rows.every;
    else
        r->finished = ++r->now.at.row == r->rows.count;
}

/* The rows of the present state. */
static int show_here(trajectory *r) {
    const progress_of_run *at = &r->now.at;
    if (r->rows.by == BY_STEPS) {
        r->finished = same(r, at->t, r->plan->t_end);
        if (at->step < at->row && !r->finished)
            return TOOL_OK;
        count_row(r);
        return show(r, at->t, r->now.q, r->now.p);
    }
    int status = TOOL_OK;
    while (!status && !r->finished && same(r, next_row(r), at->t)) {
        double t = next_row(r);
        count_row(r);
        status = show(r, t, r->now.q, r->now.p);
    }
    return status;
}

static int branch_to(trajectory *r, double t) {
    size_t size = r->plan->n * sizeof *r->q;
    memcpy(r->q, r->kept_q, size);
    memcpy(r->p, r->kept_p, size);
    if (nevh_stepper_load(r->branch, r->now.memory, r->now.memory_size) ||
        nevh_run_until(r->branch, r->kept_t, r->h, t, r->q, r->p, NULL, 0))
        return failed(r, r->kept_t, nevh_stepper_message(r->branch));
    return show(r, t, r->q, r->p);
}

/* The rows from the state that was kept on, before that time. */
static int show_before(trajectory *r, double limit) {
    int status = TOOL_OK;
    while (!status && !r->finished && is_before(r, next_row(r), limit)) {
        status = branch_to(r, next_row(r));
        if (r->rows.by == BY_STEPS)
            r->finished = true;
        else
            count_row(r);
    }
    return status;
}

/* Steps. */

static int advance(trajectory *r) {
    progress_of_run *at = &r->now.at;
    double before = at->t;
    if (nevh_stepper_apply(r->stepper, at->t, r->h, r->now.q, r->now.p))
        return failed(r, before, nevh_stepper_message(r->stepper));
    at->step++;
    at->t =
        r->own_time ? nevh_stepper_time(r->stepper) : time_of_step(r, at->step);
    return at->t > before ? TOOL_OK
                          : failed(r, before, "no time passes in a step");
}

static int step(trajectory *r) {
    const progress_of_run *at = &r->now.at;
    bool last = !r->own_time && at->step == r->last;
    bool branches = last || r->own_time ||
                    is_before(r, next_row(r), time_of_step(r, at->step + 1));
    if (branches) {
        r->kept_t = at->t;
        memcpy(r->kept_q, r->now.q, r->plan->n * sizeof *r->q);
        memcpy(r->kept_p, r->now.p, r->plan->n * sizeof *r->p);
        nevh_stepper_save(r->stepper, r->now.memory);
    }
    int status = last ? TOOL_OK : advance(r);
    if (status || !branches)
        return status;
    return show_before(r, last ? INFINITY : at->t);
}

/* Ends a run at the state that the scene wants it to stop at. */
static int check_stop(trajectory *r) {
    bool reached;
    nevh_scene *scene = r->plan->scene;
    const progress_of_run *at = &r->now.at;
    if (nevh_scene_stop_reached(scene, at->t, r->now.q, r->now.p, &reached))
        return fprintf(stderr, "%s\n", nevh_scene_message(scene)), TOOL_USAGE;
    if (!reached)
        return TOOL_OK;
    r->finished = true;
    int status =
        at->written == at->t ? TOOL_OK : show(r, at->t, r->now.q, r->now.p);
    remark(r, "stopped at t = %.9g: %s", at->t, nevh_scene_stop_text(scene));
    return status;
}

/* What is saved. */

run_state *trajectory_state(trajectory *r) {
    nevh_stepper_save(r->stepper, r->now.memory);
    return &r->now;
}

static bool step_is_possible(const trajectory *r, const progress_of_run *at) {
    double t0 = r->plan->run->t_start, t_end = r->plan->t_end;
    if (!r->own_time)
        return at->step <= r->last && same(r, at->t, time_of_step(r, at->step));
    return (at->t >= t0 && at->t <= t_end) || same(r, at->t, t_end);
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

/* Work between steps, a few times a second. */
typedef struct {
    double next;
    const trajectory_watch *watch;
    bool shown;
} clockwork;

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int tick(const trajectory *r, clockwork *c) {
    const trajectory_watch *w = c->watch;
    double now = seconds();
    if (now < c->next)
        return TOOL_OK;
    int status = w->save ? w->save(w->data) : TOOL_OK;
    double took = seconds() - now;
    c->next = now + took + fmax(between_saves, took / share_of_saves);
    c->shown = w->progress;
    if (c->shown)
        fprintf(stderr, "\r\033[Kt = %.6g of %g", r->now.at.t, r->plan->t_end);
    return status;
}

int trajectory_follow(trajectory *r, const trajectory_watch *watch) {
    clockwork c = {seconds() + between_saves, watch, false};
    int status = TOOL_OK;
    while (!status) {
        status = show_here(r);
        if (!status && !r->finished)
            status = check_stop(r);
        if (!status && !r->finished)
            status = tick(r, &c);
        if (status || r->finished || *watch->signal)
            break;
        status = step(r);
        if (r->finished)
            break;
    }
    if (c.shown)
        fputs("\r\033[K", stderr);
    if (!status && r->finished)
        doubt(r);
    return status;
}

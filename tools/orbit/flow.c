/* nevh flow: what integrators do to the area of a shape of starts.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "flow.h"
#include "plot/plot.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { USUAL_STEPS = 1000, MOST_TIMES = 1000 };

bool flow_resolved(nevh_loop_area r) {
    static const double certain = 1e-6;
    return r.error <= certain * fabs(r.area);
}

/* Times that are not a whole step of the longest dt apart make the same row. */
static void drop_equal_times(flow_job *j, size_t dts) {
    double longest = 0;
    size_t kept = 1;
    for (size_t d = 0; d < dts; d++)
        longest = fmax(longest, j->plan.dt[d]);
    for (size_t i = 1; i < j->times; i++)
        if (llround((j->time[i] - j->time[0]) / longest) >
            llround((j->time[kept - 1] - j->time[0]) / longest))
            j->time[kept++] = j->time[i];
    j->times = kept;
}

/* When the area is asked for: where the options say, else at once, and after 10,
   30, 100 and 1000 steps, or such parts of the run where that is shorter. */
static int take_times(flow_job *j, const options *o) {
    static const double parts[] = {0, 0.01, 0.03, 0.1, 1};
    enum { USUAL_TIMES = sizeof parts / sizeof *parts };
    const plan *p = &j->plan;
    double begin = p->run->t_start, end = p->t_end;
    bool equal = o->samples > 0;
    j->times = p->ats ? p->ats + 1 : equal ? o->samples : USUAL_TIMES;
    if (j->times > MOST_TIMES)
        return tool_refuse("nevh flow takes %d times at most, not %zu",
                           MOST_TIMES, j->times);
    if (!o->t_end && !p->ats)
        end = fmin(end, begin + USUAL_STEPS * p->dt[0]);
    j->time = tool_allocate(j->times + 1, sizeof *j->time);
    j->time[0] = begin;
    for (size_t i = 1; i < j->times; i++) {
        double part =
            equal ? (double)i / (double)(j->times - 1) : parts[i % USUAL_TIMES];
        j->time[i] = p->ats ? p->at[i - 1] : begin + (end - begin) * part;
    }
    numbers_sort(j->time, j->times);
    if (p->ats && j->times > 1 && j->time[1] == begin)
        memmove(j->time + 1, j->time + 2, (--j->times - 1) * sizeof *j->time);
    if (!p->ats)
        drop_equal_times(j, o->dt.count ? p->dts : 1);
    return TOOL_OK;
}

/* A loop of the shape, at the first so many times.
   eye  0, or which one of the cat, which is drawn, but not measured */
static nevh_loop *new_loop(flow_job *j, const flow_row *r, int eye,
                           size_t times, bool shapes) {
    enum { EYE_POINTS = 512 };
    static const double panels = 300; /* about as many as are carried */
    const plan *p = &j->plan;
    double corner[FLOW_CORNERS];
    size_t *steps = tool_allocate(j->times, sizeof *steps);
    nevh_options o = plan_options(p, p->gradients.item[0]);
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(p, r->integrator, &transformed);
    o.transform = plan_transform(p, r->integrator);
    if (nevh_integrator_adaptive(scheme) && p->tolerances)
        o.tolerance = p->tolerance[0];
    for (size_t i = 0; i < j->times; i++)
        steps[i] = (size_t)llround((j->time[i] - j->time[0]) / r->dt);
    o.steps_foreseen = panels * (double)steps[times - 1];
    j->shape.eye = eye;
    nevh_loop_options is = {.curve = shape_curve,
                            .data = &j->shape,
                            .corners = corner,
                            .n_corners = shape_corners(&j->shape, corner),
                            .steps = steps,
                            .times = times,
                            .t0 = j->time[0],
                            .h = r->dt,
                            .most_points = eye        ? EYE_POINTS
                                           : p->n > 1 ? 2048
                                                      : 0,
                            .shapes = shapes};
    return tool_owned(nevh_loop_new(p->system, scheme, &o, &is));
}

/* The first time that the curve has not reached. */
static double failed_before(const flow_job *j, const flow_row *r) {
    size_t i = 0;
    while (i + 1 < j->times && !isnan(nevh_loop_result(r->loop, i).area))
        i++;
    return j->time[i];
}

/* Why the row failed: the message, or that the solution ends before, by the first of
   some points of the curve. */
static char *why_of(flow_job *j, const flow_row *r) {
    enum { POINTS = 8 };
    const plan *p = &j->plan;
    const char *message = nevh_loop_message(r->loop);
    double *q = tool_allocate(2 * p->n, sizeof *q), first = INFINITY,
           end = failed_before(j, r);
    for (size_t i = 0; i < POINTS; i++) {
        const double at = (double)i / POINTS;
        if (!shape_curve(&j->shape, 1, &at, q, q + p->n))
            first = fmin(first, nevh_solution_ends(p->system, p->run->t_start,
                                                   end, q, q + p->n));
    }
    char *ends = ends_text(p, first);
    return ends ? text_print("%.*s: from there %s", (int)strcspn(message, ":"),
                             message, ends)
                : text_print("%s", message);
}

/* returns  TOOL_OK, TOOL_FAILED where a step failed, or TOOL_USAGE */
static int run_row(flow_job *j, flow_row *r, const options *o) {
    bool shapes = plot_wanted(o);
    r->loop = new_loop(j, r, 0, j->times, shapes);
    if (nevh_loop_status(r->loop)) {
        r->status = text_print("refused: %s", nevh_loop_message(r->loop));
        return TOOL_OK;
    }
    int status = nevh_loop_carry(r->loop);
    if (j->shape.failed)
        return TOOL_USAGE;
    if (status == NEVH_EINVAL)
        return tool_refuse("--shape: %s", nevh_loop_message(r->loop));
    bool eyes = shapes && j->shape.kind == FLOW_CAT;
    size_t times = eyes ? flow_drawn_times(j, r) : 0;
    for (int i = 0; eyes && times && i < FLOW_EYES; i++) {
        r->eye[i] = new_loop(j, r, i + 1, times, true);
        nevh_loop_carry(r->eye[i]);
        j->shape.eye = 0;
    }
    if (!status)
        return TOOL_OK;
    r->status = text_print("failed: %s", why_of(j, r));
    tool_refuse("%s: %s at dt = %.4g %s", j->plan.name, r->integrator, r->dt,
                r->status);
    return TOOL_FAILED;
}

/* All integrators; the first dt, or those that --dt gives. */
static int run_rows(flow_job *j, const options *o) {
    const plan *p = &j->plan;
    size_t dts = o->dt.count ? p->dts : 1;
    int worst = TOOL_OK;
    j->row = tool_allocate(dts * p->integrators.count, sizeof *j->row);
    for (size_t d = 0; d < dts; d++)
        for (size_t i = 0; i < p->integrators.count; i++) {
            flow_row *r = &j->row[j->rows++];
            r->integrator = p->integrators.item[i];
            r->dt = p->dt[d];
            r->code = run_row(j, r, o);
            if (r->code == TOOL_USAGE)
                return TOOL_USAGE;
            worst = r->code ? r->code : worst;
        }
    return worst;
}

static char *status_of(const flow_row *r, nevh_loop_area at) {
    if (isnan(at.area))
        return text_print("%s", r->status);
    if (at.inside)
        return text_print("from inside: uncertain by %.1e",
                          at.error / fabs(at.area));
    return flow_resolved(at) ? text_print("ok")
                             : text_print("unresolved: uncertain by %.1e",
                                          at.error / fabs(at.area));
}

static const char *symplectic(const flow_job *j, const flow_row *r) {
    bool transformed;
    return nevh_claim_name(nevh_integrator_symplectic(
        plan_scheme(&j->plan, r->integrator, &transformed)));
}

static void add_records(table *t, const flow_job *j) {
    for (size_t k = 0; k < j->rows; k++) {
        const flow_row *r = &j->row[k];
        double first = nevh_loop_result(r->loop, 0).area;
        for (size_t i = 0; i < j->times; i++) {
            nevh_loop_area at = nevh_loop_result(r->loop, i);
            char *status = status_of(r, at);
            table_text(t, j->plan.name);
            table_text(t, r->integrator);
            table_text(t, symplectic(j, r));
            table_number(t, r->dt);
            table_number(t, at.t);
            table_number(t, at.area);
            table_number(t, at.area / first);
            if (at.points)
                table_shown(t, "%zu", at.points);
            else
                table_text(t, NULL);
            table_text(t, status);
            table_number(t, at.error);
        }
    }
}

static table *records(const flow_job *j) {
    table *t = table_new();
    table_titles(t, flow_command.columns);
    add_records(t, j);
    return t;
}

static void show_ratio(table *t, double ratio) {
    if (isnan(ratio))
        table_text(t, NULL);
    else
        table_shown(t, fabs(ratio - 1) < 0.5 ? "%.9f" : "%.6g", ratio);
}

static void show_row(table *t, const flow_job *j, const flow_row *r) {
    double first = nevh_loop_result(r->loop, 0).area;
    for (size_t i = 0; i < j->times; i++) {
        nevh_loop_area at = nevh_loop_result(r->loop, i);
        if (i == 0)
            table_group(t);
        table_text(t, r->integrator);
        table_text(t, symplectic(j, r));
        table_shown(t, "%.4g", r->dt);
        if (isnan(at.area)) {
            for (int c = 0; c < 4; c++)
                table_text(t, NULL);
            table_text(t, r->code ? "failed" : "refused");
            return;
        }
        table_shown(t, "%.6g", at.t);
        table_shown(t, "%.6g", at.area);
        show_ratio(t, at.area / first);
        table_shown(t, "%zu", at.points);
        table_text(t, status_of(r, at));
    }
}

static table *shown(const flow_job *j) {
    char *dt = text_print("dt%s", j->plan.per_unit);
    char *time = text_print("t%s", j->plan.per_unit);
    table *t = table_new();
    table_titles(t, "integrator,sympl.");
    table_column(t, dt);
    table_column(t, time);
    table_titles(t, "area,area over\nthe first,points,status");
    for (size_t i = 0; i < j->rows; i++)
        show_row(t, j, &j->row[i]);
    return t;
}

static void note(const flow_job *j, const options *o, list *notes) {
    const plan *p = &j->plan;
    plan_notes(p, notes);
    settings_notes(o, notes);
    list_print(notes, "shape: %s%s", j->shape.text,
               nevh_scene_members(p->scene)
                   ? "; the scene's [ensemble] is left aside"
                   : "");
    list_print(notes, "area: %s%s",
               p->n > 1 ? "the sum over coordinates x of the integral of x "
                          "dp_x round the edge"
                        : "what the edge encloses",
               "; at whole steps");
    list_print(notes, "gradient: %s%s", p->gradients.item[0],
               p->gradients.count > 1 ? ", the first of the list" : "");
    if (!o->dt.count && p->dts > 1)
        list_print(notes, "dt = %.9g: the first of the list", p->dt[0]);
}

/* Notes the change by a scheme of the area, which the exact flow of H keeps. */
static void change_words(const flow_row *r, double ratio, double t, list *to) {
    const char *way = ratio > 1 ? "grows" : "shrinks";
    if (fabs(ratio - 1) < 0.1)
        list_print(to, "%s, dt = %g: the area %s by %.2g %% until t = %.6g.",
                   r->integrator, r->dt, way, 100 * fabs(ratio - 1), t);
    else
        list_print(to,
                   "%s, dt = %g: the area %s to %.3g times its size "
                   "until t = %.6g.",
                   r->integrator, r->dt, way, ratio, t);
}

/* The largest |ratio - 1| of a row's areas; NAN: none is known.  `last`: the last
   area that is told. */
static double largest_change(const flow_job *j, const flow_row *r,
                             nevh_loop_area *last) {
    double first = nevh_loop_result(r->loop, 0).area, largest = NAN;
    *last = (nevh_loop_area){.area = NAN};
    for (size_t i = 1; i < j->times; i++) {
        nevh_loop_area at = nevh_loop_result(r->loop, i);
        if (isnan(at.area))
            continue;
        if (flow_resolved(at))
            largest = fmax(largest, fabs(at.area / first - 1));
        if (at.inside || flow_resolved(at))
            *last = at;
    }
    return largest;
}

/* The largest |ratio - 1| of symplectic rows, and what others do. */
static void words(const flow_job *j, list *to) {
    double worst = NAN;
    for (size_t k = 0; k < j->rows; k++) {
        const flow_row *r = &j->row[k];
        double first = nevh_loop_result(r->loop, 0).area;
        nevh_loop_area last;
        double change = largest_change(j, r, &last);
        if (strcmp(symplectic(j, r), "yes") == 0)
            worst = fmax(worst, change);
        else if (!isnan(last.area) && !j->plan.friction)
            change_words(r, last.area / first, last.t, to);
        if (r->status)
            list_print(to, "%s %s", r->integrator, r->status);
    }
    if (!isnan(worst) && !j->plan.friction)
        list_print(to,
                   "Symplectic integrators keep the area: ratios are 1 "
                   "within %.1e.",
                   worst);
    else if (!isnan(worst))
        list_add(to, "With friction the area shrinks, with symplectic "
                     "integrators by exp(-gamma t) where all rates are equal.");
}

static int print(const flow_job *j, const options *o, int status) {
    bool is_table = o->format == FORMAT_TABLE;
    page result = {.table = is_table ? shown(j) : records(j)};
    if (!(o->quiet && is_table)) {
        note(j, o, &result.before);
        words(j, &result.after);
    }
    return output_page(o, &result, status);
}

static int show(const flow_job *j, const options *o, int status) {
    bool first = plot_goes_first(o);
    int drawn = first ? flow_plot(j, o) : TOOL_OK;
    status = print(j, o, status);
    if (plot_wanted(o) && !first && status != TOOL_USAGE)
        drawn = flow_plot(j, o);
    return drawn > status ? drawn : status;
}

static void forget(flow_job *j) {
    for (size_t i = 0; i < j->rows; i++) {
        nevh_loop_free(j->row[i].loop);
        for (int k = 0; k < FLOW_EYES; k++)
            nevh_loop_free(j->row[i].eye[k]);
    }
    plan_free(&j->plan);
}

static int flow(const options *o) {
    flow_job j = {0};
    int status = plan_make(&j.plan, o);
    if (!status)
        status = shape_read(&j.shape, &j.plan, o, o->shape);
    if (!status)
        status = take_times(&j, o);
    if (!status)
        status = plot_check(o);
    if (!status)
        status = run_rows(&j, o);
    if (status != TOOL_USAGE && j.shape.text)
        status = show(&j, o, status);
    forget(&j);
    return status;
}

const command flow_command = {
    .name = "flow",
    .operand = "SCENE",
    .brief = "the area of a set of starts, carried along",
    .help =
        "the area of a disc, a rectangle or Arnold's cat of starts against time, for each integrator",
    .examples =
        "flow pendulum --t-end 5\n"
        "flow pendulum --t-end 5 --shape 'disc(phi = 1, p_phi = 0, 0.3)' --plot flow.svg",
    .options = "SCENE STEPS TABLE PLOT tolerance samples at shape",
    .instead = {"vary",
                "its starts are those of --shape; --set sets a parameter, for "
                "a run for each value"},
    .columns = "scene,integrator,symplectic,dt,t,area,ratio,points,"
               "status,error",
    .run = flow,
};

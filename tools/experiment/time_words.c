/* nevh: what is said of H that changes with time, and of solutions that end.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>
#include <nevh/sweep.h>
#include <stdlib.h>

static size_t count_jumps(const nevh_timing *timing) {
    size_t count = 0;
    for (size_t i = 0; i < nevh_timing_breaks(timing); i++)
        count += nevh_timing_break(timing, i).jump;
    return count;
}

/* True if the longest steps may pass over a change. */
static bool is_fast(const plan *p) {
    double shortest = nevh_timing_shortest(p->timing, NULL, NULL);
    return plan_longest_dt(p) > 2 * shortest;
}

/* Jumps, and what steps pass over, are booked as far as verdicts may follow a
   run. */
void plan_look_at_time(plan *p) {
    static const double followed = 2049; /* nevh_verdict_settle goes to 2048 */
    double start = p->run->t_start, end = p->t_end;
    if (!p->time)
        return;
    p->timing = nevh_timing_new(p->system, start, end, p->q, p->p);
    if (!p->timing)
        tool_owned(NULL);
    if (count_jumps(p->timing) || is_fast(p))
        p->jumps = nevh_timing_new(
            p->system, start, start + followed * (end - start), p->q, p->p);
}

double plan_drive(const plan *p, const char **effect) {
    return nevh_timing_frequency(p->timing, effect);
}

/* "5", "0.1, 0.2, 0.3 and 187 more" */
static char *jumps_text(const plan *p, size_t *count) {
    enum { SHOWN = 3 };
    char *text = text_print("%s", "");
    *count = 0;
    for (size_t i = 0; i < nevh_timing_breaks(p->timing); i++) {
        nevh_time_break b = nevh_timing_break(p->timing, i);
        bool inside = b.before > p->run->t_start && b.after < p->t_end;
        if (b.jump && inside && (*count)++ < SHOWN)
            text_extend(&text, "%s%.6g", *text ? ", " : "",
                        (b.before + b.after) / 2);
    }
    if (*count > SHOWN)
        text_extend(&text, " and %zu more", *count - SHOWN);
    return text;
}

/* The effects that jump. */
static char *jumping(const plan *p) {
    list names = {0};
    for (size_t i = 0; i < nevh_timing_breaks(p->timing); i++) {
        nevh_time_break b = nevh_timing_break(p->timing, i);
        if (b.jump && !list_has(&names, b.effect))
            list_add(&names, b.effect);
    }
    return list_joined(&names);
}

void time_notes(const plan *p, list *notes) {
    size_t count;
    char *times = jumps_text(p, &count);
    if (count)
        list_print(notes,
                   "H jumps in time at t = %s (%s): a step that contains a "
                   "jump has an error of low order%s",
                   times, jumping(p),
                   p->balance ? "; the balance counts the jump as energy from "
                                "outside"
                              : "");
    for (size_t i = 0; i < nevh_timing_breaks(p->timing); i++) {
        nevh_time_break b = nevh_timing_break(p->timing, i);
        if (b.pole)
            list_print(notes, "%s has a pole in time at t = %.6g", b.effect,
                       (b.before + b.after) / 2);
    }
    if (p->time && !nevh_timing_whole(p->timing))
        list_add(notes, "H may change with time between the times at which it "
                        "was looked at: it reads t in a function in C, or "
                        "jumps too often");
}

/* True if its own steps, shorter where H changes fast, pass over nothing. */
static bool own_steps_see(const plan *p, const row *r) {
    return r->tolerance > 0 && p->balance &&
           !nevh_energy_passes_over(&r->energy);
}

/* Rows whose steps are longer than the fastest change. */
static list too_long(const plan *p, const row rows[], size_t count,
                     double shortest, double *least) {
    list names = {0};
    *least = INFINITY;
    for (size_t i = 0; i < count; i++) {
        if (!rows[i].ran || !(rows[i].dt > shortest) ||
            own_steps_see(p, &rows[i]))
            continue;
        *least = fmin(*least, rows[i].dt);
        if (!list_has(&names, rows[i].integrator))
            list_add(&names, rows[i].integrator);
    }
    return names;
}

void time_words(const plan *p, const row rows[], size_t count, list *words) {
    const char *effect = "";
    double at = 0, least,
           shortest = nevh_timing_shortest(p->timing, &at, &effect);
    list names = too_long(p, rows, count, 2 * shortest, &least);
    if (names.count)
        list_print(words,
                   "%s changes within %.2g%s near t = %.6g%s: steps of "
                   "%.4g%s or longer pass over it (%s).",
                   effect, shortest, p->unit, at, p->unit, least, p->unit,
                   list_joined(&names));
}

double plan_ends(const plan *p) {
    return nevh_solution_ends(p->system, p->run->t_start, p->t_end, p->q, p->p);
}

char *ends_text(const plan *p, double t) {
    if (!isfinite(t))
        return NULL;
    return text_print("the solution itself ends at t = %.6g%s, where it "
                      "changes without bound: no scheme can continue",
                      t, p->unit);
}

char *why_until(const plan *p, double ends, const char *message) {
    if (isfinite(ends))
        return ends_text(p, ends);
    return isinf(ends)
               ? text_print("%s; the orbit is not known that far, as where it "
                            "is chaotic",
                            message)
               : text_print("%s", message);
}

int plan_refuse_end(const plan *p) {
    char *ends = ends_text(p, plan_ends(p));
    if (ends)
        tool_refuse("%s: %s; --t-end takes an earlier time", p->name, ends);
    return ends ? TOOL_FAILED : TOOL_OK;
}

char *plan_why(const plan *p, const char *message) {
    return why_until(p, plan_ends(p), message);
}

char *member_why(const plan *p, uint64_t member, const char *message) {
    double *q = tool_allocate(2 * p->n, sizeof *q), ends = NAN;
    if (!nevh_scene_member_start(p->scene, member, q, q + p->n))
        ends = nevh_solution_ends(p->system, p->run->t_start, p->t_end, q,
                                  q + p->n);
    return why_until(p, ends, message);
}

nevh_energy *plan_watch(const plan *p) {
    nevh_options o = plan_options(p, p->gradients.item[0]);
    nevh_energy *watch = nevh_energy_new(p->system, &o);
    plan_set_scale(p, watch);
    return watch;
}

char *plan_doubts(const plan *p, const nevh_energy *watch, int status) {
    static const double large = 0.1; /* of the energy */
    const char *effect;
    double passed = nevh_energy_passed(watch, &effect);
    double error = nevh_energy_result(watch, 0).max;
    if (!status && !isfinite(passed) && (p->balance || error <= large))
        return NULL;
    double ends = plan_ends(p);
    char *text = ends_text(p, ends);
    if (isinf(ends) && !isfinite(passed))
        text = text_print("its energy changes by %.2g times its size, and the "
                          "orbit is not known so far as to say whether it "
                          "ends, as where it is chaotic",
                          error);
    if (!text && isfinite(passed))
        text = text_print("a step before t = %.6g passes a pole of %s: what "
                          "follows is not the orbit of H",
                          passed, effect);
    return text;
}

char *plan_doubts_again(const plan *p, const char *integrator, double dt) {
    nevh_stepper *s = plan_stepper(p, integrator);
    nevh_energy *watch = plan_watch(p);
    double stopped;
    int status = nevh_stepper_status(s);
    if (!status)
        status =
            plan_run(p, s, dt, &(nevh_observer){nevh_energy_observe, watch, 1},
                     1, &stopped);
    char *text = plan_doubts(p, watch, status);
    nevh_stepper_free(s);
    nevh_energy_free(watch);
    return text;
}

void passed_words(const plan *p, const row rows[], size_t count, list *words) {
    for (size_t i = 0; i < count; i++) {
        const row *r = &rows[i];
        if (r->passed_effect)
            list_print(words,
                       "%s at %s = %.4g: a step before t = %.6g%s passes a "
                       "pole of %s: what follows is not the orbit of H.",
                       r->integrator, r->tolerance > 0 ? "tolerance" : "dt",
                       r->tolerance > 0 ? r->tolerance : r->dt, r->passed,
                       p->unit, r->passed_effect);
    }
}

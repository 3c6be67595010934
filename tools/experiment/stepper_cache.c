/* nevh: steppers that rows have used, for those that are planned alike: to plan
   one takes longer than many a row.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 256, MOST_DOF = 4096 };

typedef struct {
    const char *integrator, *gradient;
    double tolerance;
    bool balance;
    nevh_stepper *stepper; /* NULL: an empty place */
} place;

struct stepper_cache {
    place places[MOST];
    bool chosen, compiled; /* of rows that are timed: all that can be */
};

stepper_cache *stepper_cache_new(void) {
    return tool_allocate(1, sizeof(stepper_cache));
}

void stepper_cache_free(stepper_cache *s) {
    for (size_t i = 0; s && i < MOST; i++)
        nevh_stepper_free(s->places[i].stepper);
}

static bool is_alike(const place *at, const row *r, bool balance) {
    return at->stepper && strcmp(at->integrator, r->integrator) == 0 &&
           strcmp(at->gradient, r->gradient) == 0 &&
           at->tolerance == r->tolerance && at->balance == balance;
}

/* As many as nevh compare takes of rows with all dt: each is watched once, and what
   is timed of a long one is short, unless repeats are asked for. */
static double steps_compared(const plan *p) {
    double steps = 0;
    for (size_t i = 0; i < p->dts; i++)
        steps += plan_steps(p, p->dt[i]);
    return steps * (1 + (double)p->repeats);
}

static double steps_foreseen(const plan *p, const row *r) {
    if (p->screening)
        return plan_steps(p, r->dt);
    if (p->steppers->chosen)
        return p->steppers->compiled ? INFINITY : 0;
    return steps_compared(p);
}

static nevh_stepper *plan_new(const plan *p, const row *r, bool balance) {
    const nevh_integrator *scheme;
    nevh_options o =
        plan_scheme_options(p, r->integrator, r->gradient, &scheme);
    o.tolerance = r->tolerance;
    o.balance = balance;
    o.steps_foreseen = steps_foreseen(p, r);
    nevh_stepper *s = nevh_stepper_new(p->system, scheme, &o);
    plan_native_report(s);
    return s;
}

nevh_stepper *row_stepper(const plan *p, const row *r, bool balance) {
    for (size_t i = 0; i < MOST; i++) {
        place *at = &p->steppers->places[i];
        nevh_stepper *s = at->stepper;
        if (!is_alike(at, r, balance))
            continue;
        at->stepper = NULL;
        nevh_stepper_reset(s);
        nevh_stepper_foresee(s, steps_foreseen(p, r));
        return s;
    }
    return plan_new(p, r, balance);
}

/* Keeps the stepper; one that was refused or has failed is freed. */
void row_stepper_keep(const plan *p, const row *r, bool balance,
                      nevh_stepper *s) {
    size_t i = 0;
    while (i < MOST && p->steppers->places[i].stepper)
        i++;
    if (i < MOST && p->n <= MOST_DOF && !nevh_stepper_status(s))
        p->steppers->places[i] =
            (place){r->integrator, r->gradient, r->tolerance, balance, s};
    else
        nevh_stepper_free(s);
}

/* True if an earlier row has steps that are planned alike. */
static bool has_its_like(row *const rows[], size_t i) {
    const row *r = rows[i];
    for (size_t k = 0; k < i; k++)
        if (strcmp(rows[k]->integrator, r->integrator) == 0 &&
            strcmp(rows[k]->gradient, r->gradient) == 0 &&
            rows[k]->tolerance == r->tolerance)
            return true;
    return false;
}

/* Compilers work side by side. */
static void compile_all(const plan *p, row *const rows[], size_t count) {
    nevh_stepper **all = tool_allocate(count, sizeof *all);
    for (size_t i = 0; i < count; i++)
        if (!has_its_like(rows, i))
            all[i] = row_stepper(p, rows[i], false);
    nevh_steppers_foresee(all, count, INFINITY);
    for (size_t i = 0; i < count; i++)
        if (all[i])
            row_stepper_keep(p, rows[i], false, all[i]);
    tool_release(all);
}

void rows_choose_native(const plan *p, row *const rows[], size_t count,
                        bool alone) {
    stepper_cache *all = p->steppers;
    double sum = 0, most = -INFINITY;
    if (all->chosen || !count)
        return;
    all->chosen = true;
    for (size_t i = 0; i < count; i++) {
        if (!alone && has_its_like(rows, i))
            continue;
        nevh_stepper *s = row_stepper(p, rows[i], false);
        double saved = nevh_stepper_native_saves(
            s, alone ? plan_steps(p, rows[i]->dt) : steps_compared(p));
        sum += isfinite(saved) ? saved : 0;
        most = fmax(most, saved);
        row_stepper_keep(p, rows[i], false, s);
    }
    if ((alone ? most : sum) > 0 && p->n <= MOST_DOF)
        compile_all(p, rows, count);
    all->compiled = (alone ? most : sum) > 0;
}

nevh_stepper *row_stepper_to_time(const plan *p, const row *r) {
    nevh_stepper *s = row_stepper(p, r, false);
    if (p->steppers->compiled)
        nevh_stepper_foresee(s, INFINITY);
    else if (p->native == NEVH_NATIVE_AUTO && nevh_stepper_native(s, NULL)) {
        plan tape = *p;
        tape.native = NEVH_NATIVE_NEVER;
        nevh_stepper_free(s);
        s = plan_new(&tape, r, false);
    }
    plan_native_report(s);
    return s;
}

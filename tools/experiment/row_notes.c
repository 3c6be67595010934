/* nevh: what is said of rows before their table, and their order of
   convergence.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>
#include <string.h>

static bool measures_order(const row *r) {
    return r->ran && r->energy.verdict != NEVH_UNSTABLE && r->tolerance == 0 &&
           r->energy.max > 1e-13;
}

/* Above a bound of rounding that walks of four standard deviations keep. */
static bool is_clear(const row *r) {
    static const double above = 1.5;
    return r->energy.max > above * r->energy.rounding;
}

bool steps_are_close(double a, double b) {
    static const double apart = 1.2;
    return a != b && a < apart * b && b < apart * a;
}

bool orders_agree(double a, double b) {
    static const double near = 0.5;
    return fabs(a - b) <= near;
}

static bool is_same(const row *a, const row *b) {
    return a->integrator == b->integrator && a->gradient == b->gradient;
}

/* The slope from the row of the same scheme and the dt before; NAN where there is none.
   What rounding may have made is a slope only where it is that of the scheme's order:
   rounding does not fall with dt. */
static double slope_before(const row rows[], size_t i) {
    const row *b = &rows[i];
    for (size_t k = i; k-- > 0;) {
        const row *a = &rows[k];
        if (!is_same(a, b) || steps_are_close(a->dt, b->dt))
            continue;
        if (!measures_order(a) || !measures_order(b) || a->dt == b->dt)
            return NAN;
        double slope = log(a->energy.max / b->energy.max) / log(a->dt / b->dt);
        bool clear = is_clear(a) && is_clear(b);
        return clear || orders_agree(slope, b->order) ? slope : NAN;
    }
    return NAN;
}

/* The slope next to that of row i, of those of its scheme that have one. */
static double neighbour(const row rows[], const double slope[], size_t count,
                        size_t i, bool after) {
    for (size_t k = i; after ? ++k < count : k-- > 0;)
        if (is_same(&rows[k], &rows[i]) && isfinite(slope[k]))
            return slope[k];
    return NAN;
}

void observe_orders(row rows[], size_t count) {
    double *slope = tool_allocate(count, sizeof *slope);
    for (size_t i = 0; i < count; i++)
        slope[i] = slope_before(rows, i);
    for (size_t i = 0; i < count; i++) {
        double before = neighbour(rows, slope, count, i, false),
               after = neighbour(rows, slope, count, i, true);
        bool alone = isnan(before) && isnan(after);
        if (isfinite(slope[i]) && (alone || orders_agree(slope[i], before) ||
                                   orders_agree(slope[i], after)))
            rows[i].observed_order = slope[i];
    }
}

static void note_gradients(const plan *p, list *notes) {
    for (size_t i = 0; i < p->gradients.count; i++) {
        const char *name = p->gradients.item[i];
        const char *from = strcmp(name, "exact") == 0
                               ? "derived from the formulas of H"
                               : "from values of H alone";
        if (p->gradient_step > 0 && strncmp(name, "central", 7) == 0)
            list_print(notes, "gradient: %s, %s, half-spread %g", name, from,
                       p->gradient_step);
        else
            list_print(notes, "gradient: %s, %s", name, from);
    }
}

static void note_scale(const plan *p, const row rows[], size_t count,
                       list *notes) {
    for (size_t i = 0; i < count; i++)
        if (rows[i].ran) {
            list_print(notes,
                       "energy_scale: %.9g%s (errors are relative to "
                       "it; H at the start is %.9g)",
                       rows[i].energy.scale, p->energy_unit,
                       rows[i].energy.initial);
            return;
        }
}

static void note_balance(const plan *p, list *notes) {
    const char *why = !p->friction ? "H depends on time"
                      : p->time    ? "H depends on time, and there is friction"
                                   : "there is friction";
    if (p->balance)
        list_print(notes,
                   "%s: energy columns are the error of the balance H(t) - "
                   "H(0) - the energy from outside",
                   why);
}

static bool is_limited(const plan *p, const row *r) {
    return p->friction && r->order < nevh_integrator_order(r->scheme);
}

static bool has_nominal_steps(const plan *p, const row *r) {
    return plan_transform(p, r->integrator) ||
           nevh_integrator_own_time(r->scheme);
}

static bool has_tolerance(const plan *p, const row *r) {
    return r->tolerance > 0 && !p->screening;
}

/* True for adaptive rows of a search, which chose the tolerance itself. */
static bool has_mean_step(const plan *p, const row *r) {
    return r->tolerance > 0 && p->screening;
}

/* Adds each note that holds for some row. */
static void note_rows(const plan *p, const row rows[], size_t count,
                      list *notes) {
    static const struct {
        bool (*holds)(const plan *, const row *);
        const char *text;
    } note[] = {{is_limited, "friction is put around the steps of geometric "
                             "schemes, which limits them to order 2"},
                {has_nominal_steps, "dt is nominal where time is transformed, "
                                    "or the scheme chooses its own"},
                {match_unmatched, "schemes that take no gradients, but values "
                                  "of H alone, keep the dt given"},
                {match_dearer,
                 "some implicit schemes cost more at each dt tried: "
                 "they take the cheapest dt"},
                {has_tolerance, "adaptive schemes have a row for each "
                                "tolerance; dt is their mean step"},
                {has_mean_step, "dt of adaptive schemes is their mean step"}};
    for (size_t k = 0; k < sizeof note / sizeof *note; k++)
        for (size_t i = 0; i < count; i++)
            if (note[k].holds(p, &rows[i])) {
                list_add(notes, note[k].text);
                break;
            }
    if (p->match_work)
        list_add(notes, "match = work: rows of one dt cost as many gradients "
                        "as verlet with that dt; the column dt has their "
                        "steps");
}

/* Which integrators ran compiled steps, in all of their rows that were timed or in
   some. */
void native_notes(const plan *p, const row rows[], size_t count, list *notes) {
    list all = {0}, some = {0}, none = {0};
    for (size_t i = 0; i < count; i++)
        if (!rows[i].native && isfinite(rows[i].seconds))
            list_add(&none, rows[i].integrator);
    for (size_t i = 0; i < count; i++) {
        list *to = list_has(&none, rows[i].integrator) ? &some : &all;
        if (rows[i].native && isfinite(rows[i].seconds) &&
            !list_has(to, rows[i].integrator))
            list_add(to, rows[i].integrator);
    }
    char *names = list_joined(&all), *in_part = list_joined(&some);
    if (!none.count && *names)
        list_add(notes, "native: all steps are compiled");
    else if (*names)
        list_print(notes,
                   "native: steps of %s are compiled%s%s; others are "
                   "not",
                   names, *in_part ? ", in some rows those of " : "", in_part);
    else if (*in_part)
        list_print(notes,
                   "native: in some rows steps of %s are compiled; "
                   "others are not",
                   in_part);
    else if (p->native == NEVH_NATIVE_ALWAYS)
        list_add(notes, "native: no steps are compiled");
}

void row_notes(const options *o, const plan *p, const row rows[], size_t count,
               list *notes) {
    settings_notes(o, notes);
    note_gradients(p, notes);
    note_scale(p, rows, count, notes);
    note_balance(p, notes);
    note_rows(p, rows, count, notes);
    if (p->diagnostics && nevh_scene_shown_count(p->scene, NEVH_INVARIANTS) > 0)
        list_add(notes, "changes of invariants are absolute: the largest "
                        "|I(t) - I(0)|");
    stop_notes(p, rows, count, notes);
    native_notes(p, rows, count, notes);
}

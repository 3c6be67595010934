/* nevh: whether a run that is to be a reference keeps H.

   Runs with h and h/2 agree where neither sees what both step over: a jump of
   H, which no derivative knows of, or a wall thinner than a step.  But then H
   changes by more than the two differ.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/kinks_private.h"
#include "diagnose/reference_private.h"
#include "gradient/field_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double far_above = 100; /* what the runs differ by in H */
static const double rounding = 1e-8; /* of the effects: let alone what is less,
                                        which is in the own error */
enum { HALVINGS = 40 }; /* to a place that is between two numbers, not one */

int nevh__watch_init(nevh__watch *w, const nevh_reference *r) {
    size_t n = r->n, effects = nevh_system_effect_count(r->system);
    nevh_options o = {.gradient = &nevh__no_gradient};
    *w = (nevh__watch){.n = n,
                       .t = r->t0,
                       .start = r->start,
                       .constant = nevh__conserves_energy(r->system)};
    w->field = nevh_field_new(r->system, &o);
    w->before = nevh__array(6 * n + 2 * effects, sizeof *w->before);
    if (!w->field || !w->before)
        return NEVH_ENOMEM;
    w->between = w->before + 2 * n;
    w->after = w->between + 2 * n;
    w->effects = w->after + 2 * n;
    w->others = w->effects + effects;
    return nevh_field_status(w->field);
}

void nevh__watch_clear(nevh__watch *w) {
    nevh_field_free(w->field);
    free(w->before);
}

/* H without constants, and the sum of its terms' sizes; NAN where it has no
   value. */
static long double reference_watch_value(nevh__watch *w, const double z[],
                                         double *size) {
    double h = NAN, roundoff = 0;
    if (nevh__field_moving_values(w->field, 1, &w->t, z, z + w->n, &h,
                                  &roundoff, size))
        return NAN;
    return (long double)h + roundoff;
}

void nevh__watch_begin(nevh__watch *w) {
    w->changed = w->apart = w->size = 0;
    w->jump = (nevh__jump){0};
    memcpy(w->before, w->start, 2 * w->n * sizeof *w->before);
    w->h0 = reference_watch_value(w, w->start, &w->size);
}

static const double *between(nevh__watch *w, const double after[],
                             double part) {
    for (size_t k = 0; k < 2 * w->n; k++)
        w->between[k] = w->before[k] + part * (after[k] - w->before[k]);
    return w->between;
}

/* The effect that changes more than the others from `low` to `high`. */
static size_t find_effect(nevh__watch *w, const double after[], double low,
                          double high) {
    size_t count = nevh_system_effect_count(w->field->system), found = 0;
    double most = 0;
    const double *z = between(w, after, low);
    nevh__field_moving_effects(w->field, w->t, z, z + w->n, w->effects);
    between(w, after, high);
    nevh__field_moving_effects(w->field, w->t, z, z + w->n, w->others);
    for (size_t i = 0; i < count; i++) {
        double change = fabs(w->others[i] - w->effects[i]);
        found = change > most ? i : found;
        most = fmax(most, change);
    }
    return found;
}

/* A part of the step, and H at its ends. */
typedef struct {
    double low, high;
    long double h_low, h_high;
} stretch;

static stretch whole_step(nevh__watch *w, const double after[]) {
    stretch s = {0, 1, 0, 0};
    double size;
    s.h_low = reference_watch_value(w, between(w, after, 0), &size);
    s.h_high = reference_watch_value(w, between(w, after, 1), &size);
    return s;
}

static double change_in(const stretch *s) {
    return (double)fabsl(s->h_high - s->h_low);
}

/* Into the half over which H changes more. */
static void halve(nevh__watch *w, const double after[], stretch *s) {
    double middle = (s->low + s->high) / 2, size;
    long double h = reference_watch_value(w, between(w, after, middle), &size);
    bool upper = fabsl(s->h_high - h) >= fabsl(h - s->h_low);
    *(upper ? &s->low : &s->high) = middle;
    *(upper ? &s->h_low : &s->h_high) = h;
}

static void note_jump(nevh__watch *w, const double after[], const stretch *s,
                      bool found) {
    w->jump = (nevh__jump){
        .found = found,
        .by = (double)(s->h_high - s->h_low),
        .part = s->low,
        .effect = find_effect(w, after, s->low, s->high),
    };
}

/* Finds the jump of a constant H.  What is left of its change over ever shorter
   stretches is a jump, if it is no less than that of the whole run: after steps over a
   wall H may change by rounding alone. */
static void find_jump(nevh__watch *w, const double after[], double allowed) {
    static const double part = 0.25;
    stretch s = whole_step(w, after);
    double all = change_in(&s);
    for (int i = 0; i < HALVINGS; i++)
        halve(w, after, &s);
    note_jump(w, after, &s, change_in(&s) > part * fmax(all, allowed));
}

/* True if H, which is not constant, jumps: such a change does not fall over ever
   shorter stretches; or if 1/64 of its change, or more, is within 2^-14 of the step,
   where 2^-12 would be usual: shorter steps may follow that. */
static bool has_jumped(nevh__watch *w, const double after[]) {
    enum { SHORT = 14, SHORTER = 30 };
    static const double steep = 0x1p-6, part = 0.25;
    stretch s = whole_step(w, after), there = s;
    double most = change_in(&s), before = 0;
    bool within = false;
    for (int i = 1; i <= HALVINGS; i++) {
        halve(w, after, &s);
        double left = change_in(&s);
        most = fmax(most, left);
        if (i == SHORT && left > steep * most + rounding * w->size)
            within = true, there = s;
        before = i == SHORTER ? left : before;
    }
    double left = change_in(&s);
    bool jumps = left > part * before && left > rounding * w->size;
    if (jumps || within)
        note_jump(w, after, jumps ? &s : &there, jumps);
    w->changed = fabs(w->jump.by);
    return jumps || within;
}

/* The change of H by rounding each variable the other way: it is larger than the
   variable's digits suggest if the variable is small beside its own offset. */
static double find_rounding(nevh__watch *w, const double z[]) {
    double sum = 0, size;
    memcpy(w->between, z, 2 * w->n * sizeof *z);
    long double h = reference_watch_value(w, w->between, &size);
    for (size_t k = 0; k < 2 * w->n; k++) {
        double kept = w->between[k], most = 0;
        for (int side = -1; side <= 1; side += 2) {
            w->between[k] = nextafter(kept, side * HUGE_VAL);
            double change =
                (double)fabsl(reference_watch_value(w, w->between, &size) - h);
            most = fmax(most, change); /* that is not NaN */
        }
        w->between[k] = kept;
        sum += most;
    }
    return sum;
}

bool nevh__watch_step(nevh__watch *w, const double coarse[],
                      const double fine[]) {
    double size = 0;
    if (!w->constant) {
        reference_watch_value(w, fine, &size);
        w->size = fmax(w->size, size);
        bool jumped = has_jumped(w, fine);
        memcpy(w->before, fine, 2 * w->n * sizeof *fine);
        return !jumped;
    }
    long double a = reference_watch_value(w, coarse, &size),
                b = reference_watch_value(w, fine, &size);
    double change = (double)fabsl(b - w->h0);
    w->size = fmax(w->size, size);
    w->apart = fmax(w->apart, (double)fabsl(a - b));
    w->changed = fmax(w->changed, change);
    double allowed = far_above * w->apart + rounding * w->size;
    if (change > allowed && change > allowed + 2 * find_rounding(w, fine)) {
        find_jump(w, fine, allowed);
        return false;
    }
    memcpy(w->before, fine, 2 * w->n * sizeof *fine);
    return true;
}

double nevh__watch_error(const nevh__watch *w) {
    return w->size > 0 && w->changed > far_above * w->apart
               ? w->changed / w->size
               : 0;
}

int nevh__watch_fail(nevh_reference *r, const nevh__jump *j, double t) {
    return nevh__fail(&r->report, NEVH_EDOM,
                      "H jumps by %.3g near t = %.6g, in effect \"%s\", where "
                      "its derivative tells nothing of it: no scheme follows "
                      "that; make the jump a steep slope",
                      j->by, t, nevh_system_effect_name(r->system, j->effect));
}

static const double *exact_at(const nevh_reference *r, nevh__watch *w,
                              double elapsed) {
    nevh__exact_state(r->exact, elapsed, r->start, r->start + r->n, w->between,
                      w->between + r->n);
    return w->between;
}

int nevh__watch_exact(nevh_reference *r, bool *kept) {
    enum { TIMES = 4096 };
    nevh__watch w;
    *kept = true;
    int status = nevh__watch_init(&w, r);
    double part = (r->t1 - r->t0) / TIMES;
    if (!status)
        nevh__watch_begin(&w);
    for (int i = 1; !status && *kept && w.constant && i <= TIMES; i++) {
        memcpy(w.after, exact_at(r, &w, i * part), 2 * w.n * sizeof *w.after);
        *kept = nevh__watch_step(&w, w.after, w.after);
    }
    if (!status && *kept)
        r->error = fmax(r->error, nevh__watch_error(&w));
    if (status == NEVH_ENOMEM)
        nevh__fail(&r->report, status, "out of memory");
    nevh__watch_clear(&w);
    return status;
}

int nevh__reference_refuse_kink(nevh_reference *r) {
    nevh_options values = {.gradient = &nevh__no_gradient};
    nevh_field *f = nevh_field_new(r->system, &values);
    double *room = nevh__array(4 * r->n, sizeof *room);
    bool made = f && room;
    bool rests = made && !nevh_field_status(f) &&
                 nevh__kink_at_rest(f, r->t0, r->start, room);
    nevh_field_free(f);
    free(room);
    if (!made)
        return nevh__no_memory(&r->report);
    if (!rests)
        return NEVH_OK;
    r->text[0] = '\0';
    return nevh__fail(&r->report, NEVH_EDOM,
                      "the orbit starts at rest on a kink of H, from where "
                      "more than one orbit may go on");
}

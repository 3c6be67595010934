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
    if (!w->field)
        return;
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

/* Between two states: into the half over which H changes more, again and
   again.  What is left of the change is a jump, if it is no less than that of the
   whole run: after steps over a wall H may change by rounding alone. */
static void find_jump(nevh__watch *w, const double after[], double allowed) {
    static const double part = 0.25;
    double low = 0, high = 1, size;
    long double h_low = reference_watch_value(w, between(w, after, 0), &size);
    long double h_high = reference_watch_value(w, between(w, after, 1), &size);
    long double all = fabsl(h_high - h_low);
    for (int i = 0; i < HALVINGS; i++) {
        double middle = (low + high) / 2;
        long double h =
            reference_watch_value(w, between(w, after, middle), &size);
        bool lower = fabsl(h - h_low) > fabsl(h_high - h);
        *(lower ? &high : &low) = middle;
        *(lower ? &h_high : &h_low) = h;
    }
    w->jump = (nevh__jump){
        .found = fabsl(h_high - h_low) > part * fmaxl(all, allowed),
        .by = (double)(h_high - h_low),
        .part = low,
        .effect = find_effect(w, after, low, high),
    };
}

/* The same where H changes anyway: true if it changes by much within a small part of
   the step, or jumps. */
static bool has_jumped(nevh__watch *w, const double after[]) {
    enum { FEW = 14 };
    static const double steep = 0x1p-6, sudden = 0x1p-24;
    double low = 0, high = 1, size = 0, most = 0;
    long double h_low = reference_watch_value(w, between(w, after, 0), &size);
    long double h_high = reference_watch_value(w, between(w, after, 1), &size);
    bool found = false;
    for (int i = 1; i <= HALVINGS && !found; i++) {
        double middle = (low + high) / 2;
        long double h =
            reference_watch_value(w, between(w, after, middle), &size);
        most = fmax(most, (double)fmaxl(fabsl(h - h_low), fabsl(h_high - h)));
        bool lower = fabsl(h - h_low) > fabsl(h_high - h);
        *(lower ? &high : &low) = middle;
        *(lower ? &h_high : &h_low) = h;
        double left = (double)fabsl(h_high - h_low);
        found = (i == FEW && left > steep * most + rounding * size) ||
                (i == HALVINGS && left > sudden * most + rounding * size);
    }
    w->jump =
        (nevh__jump){.found = found,
                     .by = (double)(h_high - h_low),
                     .part = low,
                     .effect = found ? find_effect(w, after, low, high) : 0};
    return found;
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
    if (!w->field)
        return true;
    if (!w->constant) {
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
    for (int i = 1; !status && *kept && w.field && i <= TIMES; i++) {
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

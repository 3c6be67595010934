/* nevh bench: long runs, and the file that keeps them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "verdicts_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PROBES = 8 };  /* of rounding, a window */
enum { CHECKS = 64 }; /* of the work, in as much as the row runs */

static long_run **runs;
static size_t count, places;
static FILE *file;

uint64_t hash_of(uint64_t before, const void *data, size_t size) {
    const unsigned char *byte = data;
    uint64_t hash = before ? before : 0xcbf29ce484222325;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ byte[i]) * 0x100000001b3;
    return hash;
}

static void keep(long_run *r) {
    if (count == places) {
        places = 2 * places + 1024;
        runs = realloc(runs, places * sizeof *runs);
        if (!runs)
            exit(tool_refuse("out of memory"));
    }
    runs[count++] = r;
}

void runs_open(const char *name) {
    file = fopen(name, "a+b");
    if (!file)
        exit(tool_refuse("%s cannot be written", name));
    long_run *r = tool_allocate(1, sizeof *r);
    rewind(file);
    while (fread(r, sizeof *r, 1, file) == 1) {
        keep(r);
        r = tool_allocate(1, sizeof *r);
    }
    tool_release(r);
    fseek(file, 0, SEEK_END);
}

void runs_close(void) {
    for (size_t i = 0; i < count; i++)
        tool_release(runs[i]);
    free(runs);
    if (file)
        fclose(file);
}

typedef struct {
    const subject *of;
    long_run *run;
    nevh_field *field; /* exact derivatives, for estimates of rounding */
    double *q, *p, *dq, *dp, *effects;
    double h0, scale;
} trial;

/* What rounding of H and of the state makes of the energy. */
static void probe_noise(trial *f, double t, size_t place) {
    size_t n = f->of->plan->n,
           effects = nevh_system_effect_count(f->of->plan->system);
    double sum = 0;
    if (nevh_field_effects(f->field, t, f->q, f->p, f->effects) ||
        nevh_field_gradient(f->field, 1, &t, f->q, f->p, f->dq, f->dp))
        return;
    for (size_t i = 0; i < effects; i++)
        sum += fabs(f->effects[i]);
    window *w = &f->run->window[place];
    w->met = fmaxf(w->met, (float)(sum / f->scale));
    for (size_t k = 0; k < n; k++)
        sum += fabs(f->q[k] * f->dq[k]) + fabs(f->p[k] * f->dp[k]);
    f->run->noise = fmax(f->run->noise, DBL_EPSILON * sum / f->scale);
}

static void probe_wandering(trial *f, double t) {
    const subject *s = f->of;
    double most, start = s->plan->run->t_start;
    if (!nevh_field_energy_floor(nevh_stepper_field(s->stepper), t, f->q, f->p,
                                 s->dt, (size_t)((s->t_end - start) / s->dt),
                                 &most))
        f->run->wandering = fmax(f->run->wandering, most / f->scale);
}

/* As DESIGN says, found here afresh: of the start. */
static double scale_at_start(const subject *s, double effects[],
                             double *largest) {
    const plan *p = s->plan;
    size_t all = nevh_system_effect_count(p->system);
    double given = p->run->energy_scale, most = 0, sum = 0;
    nevh_field_effects(s->field, p->run->t_start, p->q, p->p, effects);
    for (size_t i = 0; i < all; i++) {
        most = fmax(most, fabs(effects[i]));
        sum += effects[i];
    }
    double scale = given > 0                  ? given
                   : fabs(sum) >= 1e-6 * most ? fabs(sum)
                                              : most;
    *largest = most;
    return scale == 0 ? 1 : scale;
}

static void find_scale(trial *f) {
    double largest;
    f->scale = scale_at_start(f->of, f->effects, &largest);
    f->run->effect = largest / f->scale;
}

static void add(long_run *r, size_t i, double e, size_t samples) {
    window *w = &r->window[i];
    if (samples == 0)
        *w = (window){(float)e, (float)e, 0, w->met};
    w->least = fminf(w->least, (float)e);
    w->most = fmaxf(w->most, (float)e);
    w->mean += ((float)e - w->mean) / (float)(samples + 1);
}

/* Work of that much of the run, in seconds of no machine in particular. */
static double work_of(const trial *f, nevh_counts before, size_t steps) {
    nevh_counts c = row_counts(f->of->stepper, before);
    double balance = f->of->plan->balance ? 8 : 1; /* which counts do not say */
    return balance * nevh_counts_seconds(&c, f->of->plan->n, f->of->scheme,
                                         nevh_stepper_order(f->of->stepper),
                                         steps);
}

/* Where the scene ends the orbit, the windows are those of the orbit. */
static bool is_ended(const trial *f, double t, size_t steps, size_t i) {
    stop here = {.scene = f->of->plan->scene};
    if (!nevh_scene_stops(here.scene) ||
        stop_observe(&here, i, t, f->q, f->p) != NEVH_STOPPED)
        return false;
    f->run->length = (double)i / (double)steps;
    return true;
}

/* Returns whether it ended, and is to be repeated so long. */
static bool integrate(trial *f, double work) {
    const subject *s = f->of;
    long_run *r = f->run;
    double start = s->plan->run->t_start, h;
    size_t steps = (size_t)llround((s->t_end - start) / s->dt);
    size_t all = (size_t)((double)steps * r->length + 0.5);
    size_t samples = 0, at = 0, every = all / WINDOWS / PROBES + 1;
    size_t check = steps < CHECKS ? 1 : steps / CHECKS;
    nevh_counts before = nevh_stepper_counts(s->stepper);
    for (size_t i = 0; i < all; i++) {
        double t = start + (double)i * s->dt, next = t + s->dt;
        if (i % every == 0)
            probe_noise(f, t, i * WINDOWS / all);
        if (i == 0 || i + 1 == steps ||
            (i % (every * PROBES * (WINDOWS / 8)) == 0 && s->plan->n < 100))
            probe_wandering(f, t);
        if (nevh_stepper_apply(s->stepper, t, s->dt, f->q, f->p) ||
            nevh_field_value(f->field, 1, &next, f->q, f->p, &h))
            return false;
        if (i + 1 < all && is_ended(f, next, steps, i + 1))
            return true;
        double e = (h - f->h0 - nevh_stepper_gain(s->stepper, 0)) / f->scale;
        if (!isfinite(e))
            return false;
        size_t place = i * WINDOWS / all;
        samples = place == at ? samples : 0;
        at = place;
        add(r, place, e, samples++);
        r->reached = (double)(i + 1) / (double)steps;
        if (i + 1 == steps)
            r->own_allowed = (float)(16 * r->noise + 8 * r->wandering);
        if (i < steps && (i + 1) % check == 0)
            r->work = work_of(f, before, i + 1);
        r->afforded = r->work * r->spans <= work;
        if (!r->afforded)
            return false;
    }
    return false;
}

static void begin(trial *f) {
    const subject *s = f->of;
    const plan *p = s->plan;
    double t = p->run->t_start;
    memcpy(f->q, p->q, p->n * sizeof *f->q);
    memcpy(f->p, p->p, p->n * sizeof *f->p);
    memset(f->run->window, 0, sizeof f->run->window);
    f->run->afforded = true;
    nevh_stepper_reset(s->stepper);
    find_scale(f);
    nevh_field_value(f->field, 1, &t, f->q, f->p, &f->h0);
}

static void make_run(const subject *s, long_run *r, double work) {
    const plan *p = s->plan;
    trial f = {.of = s, .run = r, .field = s->field};
    double *rows = tool_allocate(4 * p->n, sizeof *rows);
    f.q = rows, f.p = rows + p->n, f.dq = f.p + p->n, f.dp = f.dq + p->n;
    f.effects = tool_allocate(nevh_system_effect_count(p->system) + 1,
                              sizeof *f.effects);
    do
        begin(&f);
    while (integrate(&f, work));
    tool_release(f.effects);
    tool_release(rows);
}

/* Energies at the start that are small by chance are no scale: the row says so. */
static void rescale(const subject *s, long_run *r) {
    double *effects = tool_allocate(
        nevh_system_effect_count(s->plan->system) + 1, sizeof *effects);
    double largest, start = scale_at_start(s, effects, &largest);
    float factor = s->scale > 0 ? (float)(start / s->scale) : 1;
    tool_release(effects);
    if (fabsf(factor - 1) < 1e-6F)
        return;
    for (size_t i = 0; i < WINDOWS; i++) {
        r->window[i].least *= factor;
        r->window[i].most *= factor;
        r->window[i].mean *= factor;
        r->window[i].met *= factor;
    }
    r->effect *= factor, r->noise *= factor, r->wandering *= factor;
    r->own_allowed *= factor;
}

/* An orbit that the scene ends on its way to larger energies is judged by what
   it does before. */
static void cut_departure(const subject *s, long_run *r) {
    static const double larger = 4;
    size_t own = (size_t)(WINDOWS / r->length), end = own;
    double met = 0;
    for (size_t i = 0; i < own; i++)
        met = fmax(met, r->window[i].met);
    while (end < WINDOWS && r->window[end].met <= larger * met)
        end++;
    if (r->length >= r->spans || s->plan->balance || end == WINDOWS ||
        r->reached < r->length * (1 - 1e-9))
        return;
    long_run whole = *r;
    for (size_t i = 0; i < WINDOWS; i++)
        r->window[i] = whole.window[i * end / WINDOWS];
    r->length *= (double)end / WINDOWS;
    r->reached = r->length;
}

static uint64_t key_of(const subject *s, double spans) {
    const char *name = nevh_integrator_name(s->scheme);
    const char *gradient = s->plan->gradients.item[0];
    uint64_t key = hash_of(s->scene, name, strlen(name));
    key = hash_of(key, gradient, strlen(gradient));
    key = hash_of(key, &s->dt, sizeof s->dt);
    key = hash_of(key, &s->t_end, sizeof s->t_end);
    return hash_of(key, &spans, sizeof spans);
}

/* Once the scale of the row is known. */
static const long_run *prepared(const subject *s, long_run *r) {
    if (!r->prepared && s->scale > 0) {
        rescale(s, r);
        cut_departure(s, r);
        r->prepared = true;
    }
    return r;
}

bool is_afforded(const long_run *r, double work) {
    return r->afforded && r->work * r->spans <= work;
}

const long_run *long_run_of(const subject *s, double spans, double work) {
    uint64_t key = key_of(s, spans);
    for (size_t i = 0; i < count; i++)
        if (runs[i]->key == key &&
            (runs[i]->afforded || runs[i]->work * spans > work))
            return prepared(s, runs[i]);
    long_run *r = tool_allocate(1, sizeof *r);
    r->key = key, r->spans = r->length = spans;
    make_run(s, r, work);
    keep(r);
    if (file && (fwrite(r, sizeof *r, 1, file) != 1 || fflush(file)))
        exit(tool_refuse("long runs cannot be written"));
    return prepared(s, r);
}

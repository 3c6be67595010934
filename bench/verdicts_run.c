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
    free(r);
    fseek(file, 0, SEEK_END);
}

void runs_close(void) {
    for (size_t i = 0; i < count; i++)
        free(runs[i]);
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

/* As DESIGN says, found here afresh. */
static void find_scale(trial *f) {
    const plan *p = f->of->plan;
    size_t effects = nevh_system_effect_count(p->system);
    double given = p->run->energy_scale, most = 0, sum = 0;
    nevh_field_effects(f->field, p->run->t_start, f->q, f->p, f->effects);
    for (size_t i = 0; i < effects; i++) {
        most = fmax(most, fabs(f->effects[i]));
        sum += f->effects[i];
    }
    f->scale = given > 0 ? given : fabs(sum) >= 1e-6 * most ? fabs(sum) : most;
    if (f->scale == 0)
        f->scale = 1;
    f->run->effect = most / f->scale;
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

static void integrate(trial *f, double work) {
    const subject *s = f->of;
    long_run *r = f->run;
    double start = s->plan->run->t_start, h;
    size_t steps = (size_t)llround((s->t_end - start) / s->dt);
    size_t all = (size_t)((double)steps * r->spans);
    size_t samples = 0, at = 0, every = all / WINDOWS / PROBES + 1;
    size_t check = steps < CHECKS ? 1 : steps / CHECKS;
    nevh_counts before = nevh_stepper_counts(s->stepper);
    for (size_t i = 0; i < all; i++) {
        double t = start + (double)i * s->dt, next = t + s->dt;
        if (i % every == 0)
            probe_noise(f, t, i * WINDOWS / all);
        if (i == 0 ||
            (i % (every * PROBES * (WINDOWS / 8)) == 0 && s->plan->n < 100))
            probe_wandering(f, t);
        if (nevh_stepper_apply(s->stepper, t, s->dt, f->q, f->p) ||
            nevh_field_value(f->field, 1, &next, f->q, f->p, &h))
            return;
        double e = (h - f->h0 - nevh_stepper_gain(s->stepper, 0)) / f->scale;
        if (!isfinite(e))
            return;
        size_t place = i * WINDOWS / all;
        samples = place == at ? samples : 0;
        at = place;
        add(r, place, e, samples++);
        r->reached = (double)(i + 1) / (double)steps;
        if (i < steps && (i + 1) % check == 0)
            r->work = work_of(f, before, i + 1);
        r->afforded = r->work * r->spans <= work;
        if (!r->afforded)
            return;
    }
}

static void make_run(const subject *s, long_run *r, double work) {
    const plan *p = s->plan;
    trial f = {.of = s, .run = r, .field = s->field};
    double *rows = tool_allocate(4 * p->n, sizeof *rows);
    f.q = rows, f.p = rows + p->n, f.dq = f.p + p->n, f.dp = f.dq + p->n;
    f.effects = tool_allocate(nevh_system_effect_count(p->system) + 1,
                              sizeof *f.effects);
    memcpy(f.q, p->q, p->n * sizeof *f.q);
    memcpy(f.p, p->p, p->n * sizeof *f.p);
    double t = p->run->t_start;
    r->afforded = true;
    nevh_stepper_reset(s->stepper);
    find_scale(&f);
    if (!nevh_field_value(f.field, 1, &t, f.q, f.p, &f.h0))
        integrate(&f, work);
    free(f.effects);
    free(rows);
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

bool is_afforded(const long_run *r, double work) {
    return r->afforded && r->work * r->spans <= work;
}

const long_run *long_run_of(const subject *s, double spans, double work) {
    uint64_t key = key_of(s, spans);
    for (size_t i = 0; i < count; i++)
        if (runs[i]->key == key &&
            (runs[i]->afforded || runs[i]->work * spans > work))
            return runs[i];
    long_run *r = tool_allocate(1, sizeof *r);
    r->key = key, r->spans = spans;
    make_run(s, r, work);
    keep(r);
    if (file && (fwrite(r, sizeof *r, 1, file) != 1 || fflush(file)))
        exit(tool_refuse("long runs cannot be written"));
    return r;
}

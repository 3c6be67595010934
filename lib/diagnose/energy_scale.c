/* nevh: what are errors of the energy relative to?

   To |H0|; where all effects of the start are small by chance, to the energies of the
   motion.  Of a term that reads
   coordinates alone its range along the orbit is taken, and of one that reads
   momenta how far it is from its value at rest.  Of a drive, as F x cos(t), the range
   grows with the distance from x = 0, and is no energy of the motion.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/energy_state_private.h"
#include "gradient/field_private.h"
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Below this part of the largest effect, H0 is no measure of the energy. */
static const double cancelled = 1e-6;

/* Effects of the start are small by chance if all are below this part of the
   energies of the motion. */
static const double by_chance = 0.01;

/* Energies that are so many times as large in the second half of the time are those
   of growth without end: it outruns t^3. */
static const double growing = 8;

enum { MOST = 4096 }; /* states that are looked at */

/* Units of rounding of a coordinate: one that moves, but by less, was followed no
   further than rounding goes, such as a stiff spring at its natural length. */
static const double resolved = 1e5;

typedef struct {
    nevh_field *values;
    double *now, *rest, *low, *high; /* by term */
    double *still;                   /* 2n: the state, at rest */
    double *moved;                   /* n: how far coordinates were met */
    const double *from;              /* n: from there */
    double *until, *energy; /* by state: time, and the motion's so far */
    double kinetic, start;
    double h, size; /* at the start: H, and the sum of its terms' sizes */
    bool constant;  /* H does not change along an orbit */
    bool lost;      /* but it has changed */
    size_t count;
} motion;

static bool values_of(motion *m, double t, const double y[], double to[]) {
    nevh_field *f = m->values;
    return !nevh__field_moving_terms(f, t, y, y + f->n, to);
}

/* The kinetic energy: terms that read momenta, less their values at rest if finite. */
static double kinetic_of(motion *m, double t, const double y[]) {
    nevh_field *f = m->values;
    memcpy(m->still, y, f->n * sizeof *y);
    bool rests = values_of(m, t, m->still, m->rest);
    double most = 0;
    for (size_t i = 0; i < f->n_terms; i++) {
        double less = rests && isfinite(m->rest[i]) ? m->rest[i] : 0;
        if (f->terms[i].np)
            most = fmax(most, fabs(m->now[i] - less));
    }
    return most;
}

static double range_of(const motion *m) {
    double most = 0;
    for (size_t i = 0; i < m->values->n_terms; i++) {
        const nevh__planned *x = &m->values->terms[i];
        if (x->nq && !x->term->decl.time && m->high[i] > m->low[i])
            most = fmax(most, m->high[i] - m->low[i]);
    }
    return most;
}

/* True once H, which is constant, has changed by more than all energies before: it
   jumps, and what follows is no orbit. */
static bool loses_energy(motion *m) {
    double h = 0, size = 0;
    for (size_t i = 0; i < m->values->n_terms; i++) {
        h += m->now[i];
        size += fabs(m->now[i]);
    }
    if (m->count == 0) {
        m->h = h;
        m->size = size;
    }
    /* More than a scheme's error, of all terms; it is larger after the growth from a
       start near a saddle, of which no step is looked at. */
    static const double part = 0.1, of_growth = 0.5;
    bool first = m->count == 1;
    double most = m->count ? fmax(m->size, m->energy[m->count - 1]) : size;
    double allowed = fmax(most, (first ? of_growth : part) * size);
    m->lost = m->lost || (m->constant && fabs(h - m->h) > allowed);
    if (first && !m->lost)
        m->h = h;
    return m->lost;
}

static void energy_scale_look(void *context, double t, double h,
                              const double y[]) {
    motion *m = context;
    (void)h;
    if (m->count == MOST || !values_of(m, t, y, m->now) || loses_energy(m))
        return;
    for (size_t i = 0; i < m->values->n_terms; i++) {
        m->low[i] = m->count ? fmin(m->low[i], m->now[i]) : m->now[i];
        m->high[i] = m->count ? fmax(m->high[i], m->now[i]) : m->now[i];
    }
    for (size_t k = 0; k < m->values->n; k++)
        m->moved[k] = fmax(m->moved[k], fabs(y[k] - m->from[k]));
    m->kinetic = fmax(m->kinetic, kinetic_of(m, t, y));
    m->until[m->count] = t;
    m->energy[m->count++] = fmax(m->kinetic, range_of(m));
}

/* True if no coordinate moved, or if one moved by more than its rounding. */
static bool is_resolved(const motion *m) {
    bool moved = false;
    for (size_t k = 0; k < m->values->n; k++) {
        double rounding = resolved * DBL_EPSILON * fabs(m->from[k]);
        if (m->moved[k] > 0 && m->moved[k] >= rounding)
            return true;
        moved = moved || m->moved[k] > 0;
    }
    return !moved;
}

/* The energy of all states; 0 if it keeps growing. */
static double energy_of(const motion *m) {
    double last = m->count ? m->energy[m->count - 1] : 0, half = last;
    for (size_t i = m->count; i-- > 0;)
        if (m->until[i] - m->start >= (m->until[m->count - 1] - m->start) / 2)
            half = m->energy[i];
    return isfinite(last) && last <= growing * half ? last : 0;
}

static bool energy_scale_allocate(motion *m) {
    size_t terms = m->values->n_terms, n = m->values->n;
    m->now = nevh__array(4 * terms + 3 * n + 2 * MOST, sizeof *m->now);
    m->rest = m->now + terms;
    m->low = m->rest + terms;
    m->high = m->low + terms;
    m->still = m->high + terms;
    m->moved = m->still + 2 * n;
    m->until = m->moved + n;
    m->energy = m->until + MOST;
    return m->now;
}

static bool energy_scale_follow(motion *m, double t, const double q[],
                                const double p[], double start[]) {
    nevh_field *values = m->values;
    nevh_options o = {.gradient = nevh__best_gradient(values->system),
                      .t = t,
                      .q = q,
                      .p = p,
                      .portable = values->portable};
    bool differences = o.gradient != nevh_exact;
    nevh_field *own = differences ? nevh_field_new(values->system, &o) : NULL;
    bool fine = !differences || (own && !nevh_field_status(own));
    memcpy(start, q, values->n * sizeof *q);
    memcpy(start + values->n, p, values->n * sizeof *p);
    m->from = q;
    energy_scale_look(m, t, 0, start);
    double *sizes = start + 2 * values->n;
    fine = fine && nevh__follow_orbit(differences ? own : values, t, q, p,
                                      sizes, energy_scale_look, m);
    nevh_field_free(own);
    return fine;
}

/* The largest energy of the motion, of a term of a field for values, along the
   orbit from there on.  0 where the orbit cannot be followed, or grows without end. */
static double orbit_energy(nevh_field *values, double t, const double q[],
                           const double p[]) {
    motion m = {.values = values,
                .start = t,
                .constant = nevh__conserves_energy(values->system)};
    double *state = nevh__array(4 * values->n, sizeof *state);
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    bool fine = state && energy_scale_allocate(&m) &&
                energy_scale_follow(&m, t, q, p, state);
    double energy = fine && is_resolved(&m) ? energy_of(&m) : 0;
    fesetenv(&own);
    free(m.now);
    free(state);
    values->report = (nevh__report){0}; /* where values are not finite */
    return energy;
}

/* The energy of the orbit, which does not depend on the run. */
static double typical(const nevh_energy *e, size_t lane) {
    if (e->typical[lane] < 0) {
        const double *start = e->start + lane * 2 * e->n;
        if (e->field->lanes)
            nevh__field_alone(e->field, lane);
        e->typical[lane] =
            orbit_energy(e->field, e->start_t[lane], start, start + e->n);
    }
    return e->typical[lane];
}

int nevh__energy_find_scale(nevh_energy *e, size_t lane, double t) {
    double sum = 0, most = 0;
    int status = nevh__field_moving_effects(e->field, t, e->state,
                                            e->state + e->n, e->effects);
    for (size_t i = 0; !status && i < e->field->system->n_effects; i++) {
        sum += e->effects[i];
        most = fmax(most, fabs(e->effects[i]));
    }
    memcpy(e->start + lane * 2 * e->n, e->state, 2 * e->n * sizeof *e->state);
    e->start_t[lane] = t;
    e->typical[lane] = -1;
    e->limit[lane] = most;
    e->scale[lane] = e->given_scale                  ? e->given_scale
                     : fabs(sum) >= cancelled * most ? fabs(sum)
                                                     : most;
    if (!status && e->scale[lane] == 0)
        e->scale[lane] = typical(e, lane);
    if (e->scale[lane] == 0)
        e->scale[lane] = 1; /* until energies are met */
    return status;
}

double nevh__energy_scale(const nevh_energy *e, size_t lane) {
    double most = e->limit[lane], met = e->largest[lane];
    bool alone = e->trend[lane].samples == 1;
    if (e->given_scale > 0 || (!alone && most >= by_chance * met))
        return e->scale[lane];
    double orbit = typical(e, lane);
    if (most == 0 && orbit == 0)
        return met > 0 ? met : e->scale[lane];
    return most < by_chance * orbit ? orbit : e->scale[lane];
}

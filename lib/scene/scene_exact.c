/* nevh: a scene with all digits of its numbers.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include "taylor/certain_private.h"
#include "implicit/implicit_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

const nevh_system *nevh_scene_exact_system(nevh_scene *s) {
    const nevh__scene_model *m = s ? nevh__scene_exact(s) : NULL;
    return m ? m->system : NULL;
}

int nevh_scene_exact_number(nevh_scene *s, const char *formula, double *number,
                            long double *rest) {
    static const double few = 1024 * NEVH__WIDE_EPSILON;
    const nevh__scene_model *m = s ? nevh__scene_exact(s) : NULL;
    if (!m)
        return s ? s->status : NEVH_EINVAL;
    nevh__line line = {0, formula, formula ? strlen(formula) : 0};
    nevh__piece piece = {&line, formula, formula};
    nevh__rounded value = m->exact->t_end;
    if (formula && !nevh__piece_wide(s, m, &piece, &value))
        return s->status;
    if (formula && (double)value.off > few * fabs((double)value.value))
        return nevh__scene_fail(s, NEVH_EINVAL, &piece,
                                "a difference of nearly equal numbers leaves "
                                "too few digits of %.9g: write it as a number",
                                (double)value.value),
               s->status;
    *number = (double)value.value;
    *rest = (long double)(value.value - *number);
    return NEVH_OK;
}

static nevh__wide number_of(const nevh__scene_model *m, nevh__rounded x) {
    return m->exact->away ? nevh__rounded_away(x) : x.value;
}

#ifdef NEVH_QUADMATH
#include <quadmath.h>

/* Momenta that give the initial velocities, from those of doubles on. */
typedef struct {
    const nevh__scene_model *m;
    nevh__series_quad *series;
    nevh__wide *state, *rows; /* 2n, 3 times 2n */
    nevh__wide *off;          /* of the velocities that are sought */
    size_t *row, count;       /* which momenta these are of */
    double each;              /* how far these are, over themselves */
} search;
enum { ORDER = 2, ROUNDS = 6, MOST_ROWS = 500 };
static const double solved = 1e-32, enough = 1e-30;

/* The velocity that is sought: where the run is to differ by rounding, off by that of
   dH/dp, so that momenta differ by what this means for them. */
static nevh__wide sought(const search *s, size_t k) {
    nevh__rounded v = s->m->exact->v[k];
    v.off += 8 * fabsq(v.value) * NEVH__WIDE_EPSILON;
    return number_of(s->m, v);
}

/* The deviation of the velocities, over the largest of them; s->each: each over its
   own. */
static double scene_exact_measure(search *s) {
    size_t n = s->m->n;
    static const double least = 1e-30; /* of a velocity of 0 */
    double most = 0, size = 0;
    s->each = 0;
    if (!nevh__series_expand_quad(s->series,
                                  number_of(s->m, s->m->exact->t_start),
                                  s->state, s->rows))
        return s->each = INFINITY;
    for (size_t j = 0; j < s->count; j++) {
        nevh__wide v = sought(s, s->row[j]);
        s->off[j] = v - s->rows[2 * n + s->row[j]];
        double off = fabs((double)s->off[j]), own = fabs((double)v);
        most = fmax(most, off);
        size = fmax(size, own);
        s->each = fmax(s->each, off == 0 ? 0 : off / fmax(own, least));
    }
    return most > 0 ? most / (size > 0 ? size : 1) : 0;
}

/* Each momentum by its own velocity, which is in proportion to it. */
static double scene_exact_rescale(search *s) {
    size_t n = s->m->n;
    double off = scene_exact_measure(s), each = s->each;
    for (int i = 0; i < ROUNDS && each > solved; i++) {
        for (size_t j = 0; j < s->count; j++) {
            size_t k = s->row[j];
            nevh__wide has = s->rows[2 * n + k];
            if (has != 0)
                s->state[n + k] += s->off[j] * (s->state[n + k] / has);
        }
        off = scene_exact_measure(s);
        if (!(s->each < each))
            break;
        each = s->each;
    }
    return off;
}

/* The derivatives of velocities by momenta. */
static void scene_exact_find_slopes(search *s, double slope[],
                                    nevh__wide before[]) {
    size_t n = s->m->n;
    for (size_t i = 0; i < s->count; i++)
        before[i] = s->rows[2 * n + s->row[i]];
    for (size_t j = 0; j < s->count; j++) {
        nevh__wide *p = &s->state[n + s->row[j]], kept = *p;
        nevh__wide step = kept != 0 ? fabsq(kept) * 0x1p-56 : 0x1p-56;
        *p += step;
        scene_exact_measure(s);
        for (size_t i = 0; i < s->count; i++)
            slope[i * s->count + j] =
                (double)((s->rows[2 * n + s->row[i]] - before[i]) / step);
        *p = kept;
    }
    scene_exact_measure(s);
}

/* Newton's iteration with one matrix. */
static double scene_exact_iterate(search *s, double slope[], size_t pivot[],
                                  double x[]) {
    double off = scene_exact_measure(s);
    if (!nevh__factor(s->count, slope, pivot))
        return off;
    for (int i = 0; i < ROUNDS && s->each > solved; i++) {
        for (size_t j = 0; j < s->count; j++)
            x[j] = (double)s->off[j];
        nevh__solve(s->count, slope, pivot, x);
        for (size_t j = 0; j < s->count; j++)
            s->state[s->m->n + s->row[j]] += x[j];
        off = scene_exact_measure(s);
    }
    return off;
}

static int solve_together(search *s, double *off) {
    size_t n = s->count;
    double *slope = nevh__array(n * (n + 1), sizeof *slope);
    size_t *pivot = nevh__array(n, sizeof *pivot);
    nevh__wide *before = nevh__array(n, sizeof *before);
    bool fine = slope && pivot && before;
    if (fine) {
        scene_exact_find_slopes(s, slope, before);
        *off = scene_exact_iterate(s, slope, pivot, slope + n * n);
    }
    free(slope);
    free(pivot);
    free(before);
    return fine ? NEVH_OK : NEVH_ENOMEM;
}

static int scene_exact_solve(nevh_scene *scene, search *s) {
    double off = scene_exact_rescale(s);
    if (s->each > solved && s->count <= MOST_ROWS && solve_together(s, &off))
        return nevh__scene_no_memory(scene), NEVH_ENOMEM;
    if (off <= enough)
        return NEVH_OK;
    nevh__scene_fail(scene, NEVH_EMAXITER, &s->m->moving[s->row[0]]->key,
                     "no momenta were found that give the initial velocities "
                     "to more digits than those of doubles");
    return NEVH_EMAXITER;
}

/* p[k] of n: in, doubles; out, with all digits. */
static int find_momenta(nevh_scene *scene, const nevh__scene_model *m,
                        nevh__wide p[]) {
    nevh__report report = {0};
    size_t n = m->n;
    search s = {.m = m};
    nevh__recurrence *r = nevh__recurrence_new(m->system, NULL, false, &report);
    if (!r && report.status != NEVH_ENOMEM)
        return NEVH_OK; /* there is no orbit, which says why */
    s.series = r ? nevh__series_new_quad(r, ORDER) : NULL;
    s.state = nevh__array((2 + 2 * (ORDER + 1) + 1) * n, sizeof *s.state);
    s.row = nevh__array(n, sizeof *s.row);
    int status = NEVH_ENOMEM;
    if (s.series && s.state && s.row) {
        s.rows = s.state + 2 * n;
        s.off = s.rows + 2 * (ORDER + 1) * n;
        for (size_t k = 0; k < n; k++)
            s.state[k] = number_of(m, m->exact->q[k]);
        memcpy(s.state + n, p, n * sizeof *p);
        for (size_t k = 0; k < n; k++)
            if (m->by_velocity[k])
                s.row[s.count++] = k;
        status = scene_exact_solve(scene, &s);
        memcpy(p, s.state + n, n * sizeof *p);
    } else {
        nevh__scene_no_memory(scene);
    }
    nevh__series_free_quad(s.series);
    nevh__recurrence_free(r);
    free(s.state);
    free(s.row);
    return status;
}
#else
static int find_momenta(nevh_scene *scene, const nevh__scene_model *m,
                        nevh__wide p[]) {
    (void)scene, (void)m, (void)p;
    return NEVH_OK;
}
#endif

/* Momenta as they are given; of velocities as doubles have them. */
static int take_momenta(nevh_scene *s, const nevh__scene_model *m,
                        nevh__wide p[]) {
    double *state = nevh__array(2 * m->n, sizeof *state);
    bool any = false;
    if (!state)
        return nevh__scene_no_memory(s), NEVH_ENOMEM;
    int status = nevh_scene_start(s, state, state + m->n);
    for (size_t k = 0; !status && k < m->n; k++) {
        any = any || m->by_velocity[k];
        p[k] =
            m->by_velocity[k] ? state[m->n + k] : number_of(m, m->exact->p[k]);
    }
    free(state);
    return status || !any ? status : find_momenta(s, m, p);
}

/* Takes the start of the orbit of a model.
   room     3n
   returns  false: the scene knows why */
static bool start_certain(nevh_scene *s, const nevh__scene_model *m,
                          nevh__wide room[], nevh__certain_start *from) {
    size_t n = m->n;
    for (size_t k = 0; k < n; k++) {
        room[k] = number_of(m, m->exact->q[k]);
        room[2 * n + k] = number_of(m, m->exact->rates[k]);
    }
    *from = (nevh__certain_start){.system = m->system,
                                  .t = number_of(m, m->exact->t_start),
                                  .q = room,
                                  .p = room + n,
                                  .rates = room + 2 * n};
    return !take_momenta(s, m, room + n);
}

nevh_certain *nevh_scene_certain(nevh_scene *s, int digits) {
    const nevh__scene_model *m = s ? nevh__scene_exact(s) : NULL;
    const nevh__scene_model *away = m ? nevh__scene_away(s) : NULL;
    nevh__wide *room = away ? nevh__array(6 * m->n, sizeof *room) : NULL;
    nevh__certain_start from, other;
    nevh_certain *c = NULL;
    if (away && !room)
        nevh__scene_no_memory(s);
    if (room && start_certain(s, m, room, &from) &&
        start_certain(s, away, room + 3 * m->n, &other)) {
        c = nevh__certain_from(&from, &other, digits);
        if (!c)
            nevh__scene_no_memory(s);
    }
    free(room);
    return c;
}

/* nevh: bodies that move about one another, in Jacobi coordinates.

   Two groups of bodies, of masses M, M' and centres of mass X, X', have the relative
   coordinate X' - X, whose motion with -K/|X' - X| is about a centre; K is the sum of
   the k of all pairs between them.  Together they are a group.  This is a canonical
   change of coordinates in which T keeps its form [C. D. Murray, S. F. Dermott,
   Solar System Dynamics (1999), section 9.2; J. Wisdom, M. Holman, Symplectic maps for
   the n-body problem, Astron. J. 102 (1991) 1528-1538].
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hierarchy_inside_private.h"
#include "kepler_flow_private.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void nevh__hierarchy_free(nevh__hierarchy *h) {
    free(h);
}

/* The number of bodies if it is none of theirs. */
static size_t body_with(const nevh__hierarchy *h, size_t coordinate) {
    for (size_t i = 0; i < h->n_bodies; i++)
        for (size_t k = 0; k < h->space; k++)
            if (h->place[i][k] == coordinate)
                return i;
    return h->n_bodies;
}

bool nevh__hierarchy_moves(const nevh__hierarchy *h, size_t coordinate) {
    return body_with(h, coordinate) < h->n_bodies;
}

size_t nevh__hierarchy_body(const nevh__hierarchy *h, size_t coordinate) {
    size_t i = body_with(h, coordinate);
    return i < h->n_bodies ? h->place[i][0] : coordinate;
}

/* Centres of mass of all groups, from those of bodies. */
NEVH_SIMD static void find_centres(const nevh__hierarchy *h, point at[]) {
    for (size_t g = h->n_bodies; g < h->n_groups; g++) {
        const group *x = &h->groups[g];
        const point *a = &at[x->of[0]], *b = &at[x->of[1]];
        for (size_t k = 0; k < WIDE; k++)
            at[g].x[k] = x->share[0] * a->x[k] + x->share[1] * b->x[k];
    }
}

void nevh__hierarchy_centres(const nevh__hierarchy *h, point at[]) {
    find_centres(h, at);
}

/* The last pair is repeated. */
static const group *pair_of(const nevh__hierarchy *h, size_t i) {
    size_t g = h->n_bodies + i;
    return &h->groups[g < h->n_groups ? g : h->n_groups - 1];
}

/* Relative coordinates of eight pairs in rows. */
static void load_pairs(const nevh__hierarchy *h, const point at[], size_t first,
                       double rows[]) {
    for (size_t lane = 0; lane < NEVH__LANES; lane++) {
        const group *x = pair_of(h, first + lane);
        point r = between(at, x->of[0], x->of[1]);
        for (size_t k = 0; k < NEVH__SPACE; k++)
            rows[k * NEVH__LANES + lane] = r.x[k];
    }
}

/* A column of rows, times a factor. */
static inline point point_of(const double rows[], size_t lane, double factor) {
    const double *x = rows + lane;
    return (point){{factor * x[0], factor * x[NEVH__LANES],
                    factor * x[2 * NEVH__LANES], 0}};
}

enum { ROWS = NEVH__SPACE * NEVH__LANES };

/* k/|r|^3 of eight pairs. */
NEVH_SIMD static void take_pulls(const double k[], const double r[],
                                 double pull[]) {
    NEVH_LANES(i, NEVH__LANES) {
        double x = r[i], y = r[NEVH__LANES + i], z = r[2 * NEVH__LANES + i];
        double square = x * x + y * y + z * z;
        pull[i] = k[i] / (square * nevh_simd_sqrt(square));
    }
}

/* The slopes by the relative coordinates of pairs. */
static void find_pulls(const nevh__hierarchy *h, const point at[],
                       point pull[]) {
    size_t pairs = h->n_groups - h->n_bodies;
    double k[NEVH__LANES], r[ROWS], pulls[NEVH__LANES];
    for (size_t first = 0; first < pairs; first += NEVH__LANES) {
        load_pairs(h, at, first, r);
        for (size_t lane = 0; lane < NEVH__LANES; lane++)
            k[lane] = pair_of(h, first + lane)->k;
        take_pulls(k, r, pulls);
        for (size_t i = first; i < first + NEVH__LANES && i < pairs; i++)
            pull[i] = point_of(r, i - first, pulls[i - first]);
    }
}

/* Adds to the slopes of bodies those of the motion about one another, times sign. */
NEVH_SIMD static void add_slopes(const nevh__hierarchy *h, const point at[],
                                 double sign, point slope[]) {
    point of[MOST_GROUPS], pull[MOST_BODIES];
    find_pulls(h, at, pull);
    for (size_t g = h->n_groups; g-- > h->n_bodies;) {
        const group *x = &h->groups[g];
        point *a = &of[x->of[0]], *b = &of[x->of[1]];
        const point *own = &pull[g - h->n_bodies];
        for (size_t k = 0; k < WIDE; k++) {
            double all = x->inside ? of[g].x[k] : 0;
            a->x[k] = x->share[0] * all - own->x[k];
            b->x[k] = x->share[1] * all + own->x[k];
        }
    }
    for (size_t i = 0; i < h->n_bodies; i++)
        for (size_t k = 0; h->groups[i].inside && k < NEVH__SPACE; k++)
            slope[i].x[k] += sign * of[i].x[k];
}

void nevh__hierarchy_slopes(const nevh__hierarchy *h, const point at[],
                            double sign, point slope[]) {
    add_slopes(h, at, sign, slope);
}

/* States of groups, of which changes are made, and of pairs in rows. */
typedef struct {
    point centre[MOST_GROUPS], velocity[MOST_GROUPS];
    double r[ROWS], v[ROWS], dr[ROWS], dv[ROWS], mu[NEVH__LANES];
    point by[MOST_BODIES], faster[MOST_BODIES]; /* changes of pairs */
} motion;

/* One of eight pairs whose motion is found by itself. */
static void move_pair(motion *m, double t, size_t lane) {
    nevh__extended r[NEVH__SPACE], v[NEVH__SPACE];
    for (size_t k = 0; k < NEVH__SPACE; k++) {
        r[k] = m->r[k * NEVH__LANES + lane];
        v[k] = m->v[k * NEVH__LANES + lane];
    }
    nevh__kepler_flow(m->mu[lane], t, r, v);
    for (size_t k = 0; k < NEVH__SPACE; k++) {
        size_t at = k * NEVH__LANES + lane;
        m->dr[at] = (double)(r[k] - m->r[at]);
        m->dv[at] = (double)(v[k] - m->v[at]);
    }
}

/* From pair number `first` on. */
static void move_eight(const nevh__hierarchy *h, double t, size_t first,
                       motion *m) {
    size_t pairs = h->n_groups - h->n_bodies;
    double good[NEVH__LANES];
    load_pairs(h, m->centre, first, m->r);
    load_pairs(h, m->velocity, first, m->v);
    for (size_t lane = 0; lane < NEVH__LANES; lane++)
        m->mu[lane] = pair_of(h, first + lane)->mu;
    nevh__kepler_changes(m->mu, t, m->r, m->v, m->dr, m->dv, good);
    for (size_t i = first; i < first + NEVH__LANES && i < pairs; i++) {
        if (good[i - first] == 0)
            move_pair(m, t, i - first);
        m->by[i] = point_of(m->dr, i - first, 1);
        m->faster[i] = point_of(m->dv, i - first, 1);
    }
}

/* Replaces centres and velocities by their changes. */
NEVH_SIMD static void move_groups(const nevh__hierarchy *h, double t,
                                  motion *m) {
    for (size_t g = h->n_groups; g-- > 0;) {
        const group *x = &h->groups[g];
        point *r = &m->centre[g], *v = &m->velocity[g];
        for (size_t k = 0; !x->inside && k < WIDE; k++) {
            r->x[k] = t * v->x[k];
            v->x[k] = 0;
        }
        if (g < h->n_bodies)
            continue;
        const point *by = &m->by[g - h->n_bodies];
        const point *faster = &m->faster[g - h->n_bodies];
        for (int side = 0; side < 2; side++) {
            double part = side ? x->share[0] : -x->share[1];
            point *to = &m->centre[x->of[side]];
            point *speed = &m->velocity[x->of[side]];
            for (size_t k = 0; k < WIDE; k++) {
                to->x[k] = r->x[k] + part * by->x[k];
                speed->x[k] = v->x[k] + part * faster->x[k];
            }
        }
    }
}

/* Rows of a lane, times a number each, to points. */
static void load(const nevh__hierarchy *h, size_t width, size_t lane,
                 const double from[], bool by_mass, point to[]) {
    for (size_t i = 0; i < h->n_bodies; i++) {
        double factor = by_mass ? h->inverse_mass[i] : 1;
        to[i] = (point){{0}};
        for (size_t k = 0; k < h->space; k++)
            to[i].x[k] = from[h->place[i][k] * width + lane] * factor;
    }
}

static void store(const nevh__hierarchy *h, size_t width, size_t lane,
                  const point from[], bool by_mass, double to[]) {
    for (size_t i = 0; i < h->n_bodies; i++) {
        double factor = by_mass ? h->groups[i].mass : 1;
        for (size_t k = 0; k < h->space; k++)
            to[h->place[i][k] * width + lane] += from[i].x[k] * factor;
    }
}

void nevh__hierarchy_add(const nevh__hierarchy *h, double t, size_t width,
                         const double q[], const double p[], double dq[],
                         double dp[]) {
    motion m;
    for (size_t lane = 0; lane < width; lane++) {
        load(h, width, lane, q, false, m.centre);
        load(h, width, lane, p, true, m.velocity);
        find_centres(h, m.centre);
        find_centres(h, m.velocity);
        for (size_t i = 0; i < h->n_groups - h->n_bodies; i += NEVH__LANES)
            move_eight(h, t, i, &m);
        move_groups(h, t, &m);
        store(h, width, lane, m.centre, false, dq);
        store(h, width, lane, m.velocity, true, dp);
    }
}

void nevh__hierarchy_lessen(const nevh__hierarchy *h, size_t width,
                            const double q[], double dh_dq[]) {
    point at[MOST_GROUPS], slope[MOST_BODIES];
    for (size_t lane = 0; lane < width; lane++) {
        load(h, width, lane, q, false, at);
        find_centres(h, at);
        for (size_t i = 0; i < h->n_bodies; i++)
            slope[i] = (point){{0}};
        add_slopes(h, at, -1, slope);
        store(h, width, lane, slope, false, dh_dq);
    }
}

/* Appends to the text as far as there is room. */
static void put_words(char *text, size_t size, const char *word) {
    size_t at = strlen(text);
    snprintf(text + at, size - at, "%s", word);
}

static void put_group(const nevh__hierarchy *h, const nevh_system *s, size_t g,
                      char *text, size_t size) {
    char name[NEVH__VARIABLE];
    if (g < h->n_bodies) {
        put_words(text, size,
                  nevh__variable_name(s, false, h->place[g][0], name));
        return;
    }
    put_words(text, size, "(");
    put_group(h, s, h->groups[g].of[0], text, size);
    put_words(text, size, ", ");
    put_group(h, s, h->groups[g].of[1], text, size);
    put_words(text, size, ")");
}

bool nevh__hierarchy_is_whole(const nevh__hierarchy *h) {
    return h->whole;
}

size_t nevh__hierarchy_words(const nevh__hierarchy *h, const nevh_system *s,
                             char *text, size_t size) {
    if (size)
        *text = 0;
    for (size_t g = h->n_bodies; size && g < h->n_groups; g++)
        if (!h->groups[g].inside) {
            put_words(text, size, *text ? ", " : "");
            put_group(h, s, g, text, size);
        }
    return h->n_groups - h->n_bodies;
}

/* nevh: bodies that move about one another, in Jacobi coordinates.

   Two groups of bodies, of masses M, M' and centres of mass X, X', have the relative
   coordinate X' - X, whose motion with -K/|X' - X| is about a centre; K is the sum of
   the k of all pairs between them.  Together they are a group.  This is a canonical
   change of coordinates in which T keeps its form [C. D. Murray, S. F. Dermott,
   Solar System Dynamics (1999), section 9.2; J. Wisdom, M. Holman, Symplectic maps for
   the n-body problem, Astron. J. 102 (1991) 1528-1538].  The pairs are those of
   the shortest period at the state to plan at, one after another, so that moons
   move about planets and binaries about one another.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hierarchy_private.h"
#include "kepler_flow_private.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_BODIES = NEVH__MOST_BODIES, MOST_GROUPS = 2 * MOST_BODIES - 1 };

/* Bodies are the first groups; a pair of groups comes after both. */
typedef struct {
    size_t of[2];    /* the groups of a pair */
    double share[2]; /* of the mass that each of them has */
    double mass, k;  /* K of a pair */
    double mu;       /* of its motion: K by the reduced mass */
    bool inside;     /* it is part of a pair */
} group;

struct nevh__hierarchy {
    size_t space, n_bodies, n_groups;
    bool whole; /* B is 0: there are no other terms, and bodies are in twos */
    size_t place[MOST_BODIES][NEVH__SPACE]; /* of a body's coordinates */
    double inverse_mass[MOST_BODIES];
    group groups[MOST_GROUPS];
};

/* Padded with zeros to a vector. */
enum { WIDE = 4 };
typedef struct {
    double x[WIDE];
} point;

/* A search for bodies. */
typedef struct {
    nevh__hierarchy *h;
    const nevh_field *field;
    const double *inverse_mass;
    size_t *body; /* of each coordinate, and 1; 0: none */
    double k[MOST_BODIES][MOST_BODIES];
    bool others; /* terms of B that are no pairs */
    bool given;  /* an effect with such bodies is to be fast */
} finding;

void nevh__hierarchy_free(nevh__hierarchy *h) {
    free(h);
}

bool nevh__hierarchy_moves(const nevh__hierarchy *h, size_t coordinate) {
    for (size_t i = 0; i < h->n_bodies; i++)
        for (size_t k = 0; k < h->space; k++)
            if (h->place[i][k] == coordinate)
                return true;
    return false;
}

/* Up to rounding: of p_x^2/(2*m) + p_y^2/2/m, say. */
static bool is_same_mass(double a, double b) {
    return fabs(a - b) <= 4 * DBL_EPSILON * fabs(a);
}

/* The body that has these coordinates, which is added if all of them are free;
   MOST_BODIES: there is none. */
static size_t body_of(finding *f, const size_t place[]) {
    nevh__hierarchy *h = f->h;
    size_t is = f->body[place[0]];
    for (size_t k = 0; k < h->space; k++)
        if (f->body[place[k]] != is ||
            (is && h->place[is - 1][k] != place[k]) ||
            !(f->inverse_mass[place[k]] > 0) ||
            !is_same_mass(f->inverse_mass[place[k]], f->inverse_mass[place[0]]))
            return MOST_BODIES;
    if (is || h->n_bodies == MOST_BODIES)
        return is ? is - 1 : MOST_BODIES;
    for (size_t k = 0; k < h->space; k++) {
        h->place[h->n_bodies][k] = place[k];
        f->body[place[k]] = h->n_bodies + 1;
    }
    h->inverse_mass[h->n_bodies] = f->inverse_mass[place[0]];
    h->groups[h->n_bodies].mass = 1 / f->inverse_mass[place[0]];
    return h->n_bodies++;
}

/* Coordinates of both bodies, in the order of the first; masses tell which is whose,
   or else the order of the coordinates. */
static bool take_pair(finding *f, const nevh__planned *term, size_t instance,
                      double k, const size_t beside[]) {
    size_t place[2][NEVH__SPACE] = {{0}}, space = 0;
    for (size_t i = 0; i < term->nq; i++) {
        size_t a = nevh__index(term, instance, i);
        size_t b = nevh__index(term, instance, beside[i]);
        double mass = f->inverse_mass[a], first = f->inverse_mass[place[0][0]];
        if (a > b)
            continue;
        bool other = space && !is_same_mass(mass, first) &&
                     is_same_mass(f->inverse_mass[b], first);
        place[0][space] = other ? b : a;
        place[1][space++] = other ? a : b;
    }
    if (f->h->space && f->h->space != space)
        return false;
    f->h->space = space;
    size_t a = body_of(f, place[0]), b = body_of(f, place[1]);
    if (a == MOST_BODIES || b == MOST_BODIES || a == b)
        return false;
    f->k[a][b] += k;
    f->k[b][a] += k;
    return true;
}

/* False: its bodies are none that the hierarchy can have. */
static bool take_term(finding *f, const nevh__planned *term, double *room) {
    const nevh_system *s = f->field->system;
    size_t beside[NEVH__PAIR];
    double k;
    nevh_speed speed = s->effects[term->term->effect].speed;
    f->given = f->given || (term->part == NEVH__KICK && speed == NEVH_FAST);
    bool fits = term->part == NEVH__KICK && speed != NEVH_SLOW &&
                term->term->decl.count <= MOST_BODIES * (MOST_BODIES - 1) / 2;
    for (size_t i = 0; fits && i < term->term->decl.count; i++) {
        if (!nevh__pair_find(term->term, i, &k, beside, room)) {
            fits = false;
            if (i) /* some of its instances are pairs */
                return false;
            break;
        }
        if (!take_pair(f, term, i, k, beside))
            return false;
    }
    f->others = f->others || (!fits && term->part == NEVH__KICK);
    return true;
}

static int find_bodies(finding *f, bool *found) {
    *found = true;
    for (size_t i = 0; *found && i < f->field->n_terms; i++) {
        const nevh__planned *term = &f->field->terms[i];
        double *room =
            nevh__array(nevh__form_room(&term->term->decl), sizeof *room);
        if (!room)
            return NEVH_ENOMEM;
        *found = take_term(f, term, room);
        free(room);
    }
    *found = *found && f->h->n_bodies;
    return NEVH_OK;
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

static inline point between(const point at[], size_t a, size_t b) {
    point r;
    for (size_t k = 0; k < WIDE; k++)
        r.x[k] = at[b].x[k] - at[a].x[k];
    return r;
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

static double length(point r) {
    return hypot(hypot(r.x[0], r.x[1]), r.x[2]);
}

/* Groups that are no part of a pair yet, and k between them. */
typedef struct {
    size_t count, group[MOST_BODIES];
    double k[MOST_BODIES][MOST_BODIES];
} loose;

/* The square of the frequency of a circle. */
static double rate_of(const nevh__hierarchy *h, const loose *l,
                      const point at[], size_t i, size_t j) {
    const group *a = &h->groups[l->group[i]], *b = &h->groups[l->group[j]];
    double r = length(between(at, l->group[i], l->group[j]));
    return fabs(l->k[i][j]) * (1 / a->mass + 1 / b->mass) / (r * r * r);
}

/* Group i of the loose ones takes group j; the heavier one is the first. */
static void take_group(nevh__hierarchy *h, loose *l, size_t i, size_t j) {
    group *x = &h->groups[h->n_groups];
    size_t a = l->group[i], b = l->group[j];
    bool turned = h->groups[b].mass > h->groups[a].mass;
    *x = (group){.of = {turned ? b : a, turned ? a : b},
                 .mass = h->groups[a].mass + h->groups[b].mass,
                 .k = l->k[i][j]};
    for (int side = 0; side < 2; side++) {
        x->share[side] = h->groups[x->of[side]].mass / x->mass;
        h->groups[x->of[side]].inside = true;
        h->whole = h->whole && x->of[side] < h->n_bodies;
    }
    x->mu = x->k / x->mass / (x->share[0] * x->share[1]);
    l->group[i] = h->n_groups++;
    l->group[j] = l->group[--l->count];
    for (size_t c = 0; c <= l->count; c++)
        l->k[c][i] = l->k[i][c] += l->k[j][c];
    for (size_t c = 0; c < l->count; c++)
        l->k[c][j] = l->k[j][c] = l->k[l->count][c];
    l->k[i][i] = l->k[j][j] = 0;
}

/* Makes pairs until no group acts on another one; false where two are at one place. */
static bool pair_up(nevh__hierarchy *h, loose *l, point at[]) {
    h->n_groups = l->count;
    for (;;) {
        double most = 0;
        size_t i = 0, j = 0;
        for (size_t a = 0; a < l->count; a++)
            for (size_t b = a + 1; b < l->count; b++) {
                double rate = rate_of(h, l, at, a, b);
                if (!isfinite(rate))
                    return false;
                if (rate > most)
                    most = rate, i = a, j = b;
            }
        if (most == 0)
            return true;
        take_group(h, l, i, j);
        find_centres(h, at);
    }
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

/* True if B is smaller than half of A for each body. */
static bool helps(const finding *f, const point at[]) {
    const nevh__hierarchy *h = f->h;
    point of_a[MOST_BODIES] = {{{0}}};
    add_slopes(h, at, 1, of_a);
    for (size_t i = 0; i < h->n_bodies; i++) {
        point rest = of_a[i];
        for (size_t j = 0; j < h->n_bodies; j++) {
            point r = between(at, i, j);
            double d = length(r);
            for (size_t k = 0; j != i && k < h->space; k++)
                rest.x[k] += f->k[i][j] * r.x[k] / d / d / d;
        }
        if (!(length(rest) < length(of_a[i]) / 2))
            return false;
    }
    return true;
}

/* True if there is a hierarchy, and it helps or is asked for. */
static bool find_pairs(finding *f, const double q[], size_t width, loose *l) {
    point at[MOST_GROUPS] = {{{0}}};
    nevh__hierarchy *h = f->h;
    for (size_t i = 0; i < h->n_bodies; i++) {
        l->group[i] = i;
        for (size_t j = 0; j < h->n_bodies; j++)
            l->k[i][j] = f->k[i][j];
        for (size_t k = 0; k < h->space; k++)
            at[i].x[k] = q[h->place[i][k] * width];
    }
    l->count = h->n_bodies;
    h->whole = !f->others;
    return pair_up(h, l, at) && (f->given || helps(f, at));
}

int nevh__hierarchy_new(const nevh_field *field, const double inverse_mass[],
                        const double q[], size_t width,
                        nevh__hierarchy **found) {
    finding *f = nevh__array(1, sizeof *f);
    loose *l = nevh__array(1, sizeof *l);
    nevh__hierarchy *h = nevh__array(1, sizeof *h);
    size_t *body = nevh__array(field->n, sizeof *body);
    int status = f && l && h && body ? NEVH_OK : NEVH_ENOMEM;
    bool any = false;
    if (!status) {
        f->h = h;
        f->field = field;
        f->inverse_mass = inverse_mass;
        f->body = body;
        status = find_bodies(f, &any);
    }
    any = any && !status && q && find_pairs(f, q, width, l);
    *found = any ? h : NULL;
    if (!status && f->given && !any)
        status = NEVH_ESTRUCT;
    if (!any)
        free(h);
    free(f);
    free(l);
    free(body);
    return status;
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
    if (at + strlen(word) < size)
        strcpy(text + at, word);
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

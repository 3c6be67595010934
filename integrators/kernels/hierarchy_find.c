/* nevh: finds bodies that move about one another, and pairs them.

   The pairs are those of the shortest period at the state to plan at, one after another,
   so that moons move about planets and binaries about one another.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hierarchy_inside_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

/* A search for bodies. */
typedef struct {
    nevh__hierarchy *h;
    const nevh_field *field;
    const double *inverse_mass;
    size_t *body; /* of each coordinate, and 1; 0: none */
    double k[MOST_BODIES][MOST_BODIES];
    bool others;     /* terms of B that are no pairs */
    bool given;      /* an effect with such bodies is to be fast */
    const char *why; /* there is no hierarchy; NULL: nothing attracts */
} finding;

/* Up to rounding: of p_x^2/(2*m) + p_y^2/2/m, say. */
static bool is_same_mass(double a, double b) {
    return fabs(a - b) <= 4 * DBL_EPSILON * fabs(a);
}

/* NULL: the places are free and have one mass. */
static const char *unfit(const finding *f, const size_t place[]) {
    const double *inverse_mass = f->inverse_mass;
    size_t space = f->h->space;
    for (size_t k = 0; k < space; k++)
        if (!(inverse_mass[place[k]] > 0))
            return "other terms of A move their coordinates";
    for (size_t k = 1; k < space; k++)
        if (!is_same_mass(inverse_mass[place[k]], inverse_mass[place[0]]))
            return "a body has other masses in other directions";
    return NULL;
}

/* The body that has these coordinates, which is added if all of them are free;
   MOST_BODIES: there is none. */
static size_t body_of(finding *f, const size_t place[]) {
    nevh__hierarchy *h = f->h;
    size_t is = f->body[place[0]];
    f->why = unfit(f, place);
    for (size_t k = 0; !f->why && k < h->space; k++)
        if (f->body[place[k]] != is || (is && h->place[is - 1][k] != place[k]))
            f->why = "coordinates of bodies do not come in one order";
    if (!f->why && !is && h->n_bodies == MOST_BODIES)
        f->why = "there are more than 64 bodies";
    if (f->why || is)
        return f->why ? MOST_BODIES : is - 1;
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
    f->why = "bodies move in planes and in space";
    if (f->h->space && f->h->space != space)
        return false;
    f->h->space = space;
    size_t a = body_of(f, place[0]);
    size_t b = a == MOST_BODIES ? a : body_of(f, place[1]);
    if (b == MOST_BODIES || a == b)
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
    bool kicks = term->part == NEVH__KICK && term->nq;
    bool fits = kicks && speed != NEVH_SLOW &&
                term->term->decl.count <= MOST_BODIES * (MOST_BODIES - 1) / 2;
    f->given = f->given || (kicks && speed == NEVH_FAST);
    for (size_t i = 0; fits && i < term->term->decl.count; i++) {
        fits = nevh__pair_find(term->term, i, &k, beside, room);
        if (!fits && i) { /* some of its instances are pairs */
            f->why = "some terms of their effect are no attraction";
            return false;
        }
        if (fits && k != 0 && !take_pair(f, term, i, k, beside))
            return false;
    }
    f->others = f->others || (!fits && (kicks || term->part == NEVH__INNER));
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
        nevh__hierarchy_centres(h, at);
    }
}

/* True if B is smaller than half of A for each body. */
static bool helps(const finding *f, const point at[]) {
    const nevh__hierarchy *h = f->h;
    point of_a[MOST_BODIES] = {{{0}}};
    nevh__hierarchy_slopes(h, at, 1, of_a);
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

/* The nearest and farthest distances of the motion of a pair from that state. */
typedef struct {
    double nearest, farthest; /* farthest: INFINITY where it is not bound */
} span;

static span span_of(double mu, point r, point v) {
    double distance = length(r), square = 0, across = 0, slope = 0;
    for (size_t k = 0; k < NEVH__SPACE; k++) {
        square += v.x[k] * v.x[k];
        slope += r.x[k] * v.x[k];
    }
    across = fmax(0, distance * distance * square - slope * slope);
    double energy = square / 2 - mu / distance;
    double e = sqrt(fmax(0, 1 + 2 * energy * across / (mu * mu)));
    double nearest = across / (mu > 0 ? mu * (1 + e) : -mu * fmax(e - 1, 0));
    return (span){mu < 0 && !(e > 1) ? -mu / energy : nearest,
                  energy < 0 ? -mu / (2 * energy) * (1 + e) : INFINITY};
}

/* True if each group stays away from the centres of mass of others, where its attraction
   to their bodies is not that to their centre: beyond three times the mean distance of their
   masses from it. */
static bool stay_apart(const nevh__hierarchy *h, const point at[],
                       const point speed[]) {
    static const double least = 3;
    double spread[MOST_GROUPS] = {0}; /* the mean square of that distance */
    for (size_t g = h->n_bodies; g < h->n_groups; g++) {
        const group *x = &h->groups[g];
        size_t a = x->of[0], b = x->of[1];
        span r = span_of(x->mu, between(at, a, b), between(speed, a, b));
        double inner = spread[a] + spread[b];
        if (inner > 0 && !(r.nearest * r.nearest > least * least * inner))
            return false;
        spread[g] = x->share[0] * spread[a] + x->share[1] * spread[b] +
                    x->share[0] * x->share[1] * r.farthest * r.farthest;
    }
    return true;
}

/* True if pairs of bodies are all there is: each body is in one. */
static bool are_in_twos(const finding *f) {
    const nevh__hierarchy *h = f->h;
    size_t acting = 0;
    bool twos = true;
    for (size_t i = 0; i < h->n_bodies; i++)
        for (size_t j = 0; j < i; j++)
            acting += f->k[i][j] != 0;
    for (size_t g = h->n_bodies; g < h->n_groups; g++)
        twos = twos && h->groups[g].of[0] < h->n_bodies &&
               h->groups[g].of[1] < h->n_bodies;
    return twos && acting == h->n_groups - h->n_bodies;
}

/* True if there is a hierarchy, and it helps or is asked for.
   q, p  rows of width; p: NULL for zeros */
static bool find_pairs(finding *f, const double q[], const double p[],
                       size_t width, loose *l) {
    point at[MOST_GROUPS] = {{{0}}}, speed[MOST_GROUPS] = {{{0}}};
    nevh__hierarchy *h = f->h;
    for (size_t i = 0; i < h->n_bodies; i++) {
        l->group[i] = i;
        for (size_t j = 0; j < h->n_bodies; j++)
            l->k[i][j] = f->k[i][j];
        for (size_t k = 0; k < h->space; k++) {
            size_t place = h->place[i][k] * width;
            at[i].x[k] = q[place];
            speed[i].x[k] = p ? p[place] * h->inverse_mass[i] : 0;
        }
    }
    l->count = h->n_bodies;
    f->why = "two of them start at one place";
    if (!pair_up(h, l, at))
        return false;
    nevh__hierarchy_centres(h, speed);
    h->whole = !f->others && are_in_twos(f);
    f->why = !helps(f, at) ? "they differ by half and more from the motion of "
                             "pairs about one another"
             : stay_apart(h, at, speed)
                 ? NULL
                 : "some come near the centre of mass of others";
    return f->given || !f->why;
}

int nevh__hierarchy_new(const nevh_field *field, const double inverse_mass[],
                        const double q[], const double p[], size_t width,
                        nevh__hierarchy **found, const char **why) {
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
    any = any && !status && q && find_pairs(f, q, p, width, l);
    *found = any ? h : NULL;
    *why = f && !any ? f->why : NULL;
    if (!status && f->given && !any)
        status = NEVH_ESTRUCT;
    if (!any)
        free(h);
    free(f);
    free(l);
    free(body);
    return status;
}

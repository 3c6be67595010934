/* nevh: the flow of a quadratic form, and about centres.

   The form has a matrix for each block of variables that it connects; form_block.c
   makes it.  Variables of a block stand as q, p of one coordinate after the other, so
   that chains have banded matrices.  A block with -k/|q| has no matrix: kepler_flow.c
   moves it, and hierarchy.c moves bodies that attract one another.  Coordinates that
   are free, dq/dt = a p, are moved side by side.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "form_flow_private.h"
#include "form_block_private.h"
#include "hierarchy_private.h"
#include "system/forest_private.h"
#include "system/parts_private.h"
#include <tgmath.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_BLOCK = 128, SETS = 2 };

typedef nevh__form_block block;

/* Matrices of all blocks, for each part of a step. */
typedef struct {
    double h;
    bool made;
    double *panels;
    size_t *ends;
    double *free; /* n_times x 2 x n: D of free coordinates, and rests */
} set;

struct nevh__form_flow {
    size_t n, n_blocks, n_times, n_panels, n_ends; /* of a set for one time */
    size_t n_bound; /* blocks that are not free */
    block *blocks;  /* these are the first */
    size_t *index;
    nevh__extended *a, *room; /* all a; three matrices of the largest block */
    int *units;
    double *times;
    set sets[SETS];
    size_t now; /* the set in use */
    nevh__panels_fn *multiply;
    nevh__hierarchy *bodies; /* that are moved together, or NULL */
    const char *why;         /* attractions stay in B, or NULL */
};

void nevh__form_flow_free(nevh__form_flow *f) {
    if (!f)
        return;
    for (size_t i = 0; i < SETS; i++) {
        free(f->sets[i].panels);
        free(f->sets[i].ends);
        free(f->sets[i].free);
    }
    free(f->blocks);
    free(f->index);
    free(f->a);
    free(f->room);
    free(f->units);
    free(f->times);
    nevh__hierarchy_free(f->bodies);
    free(f);
}

/* Entries of K and g are handed to `visit`: variables are numbered from 0 to 2n,
   coordinates first; column 2n is g. */
typedef void (*entry_fn)(void *, size_t row, size_t column, double value);

/* Entries of -k/|q| have columns above 2n: k is at its first coordinate. */
static void visit_instance(const nevh_field *f, const nevh__planned *term,
                           size_t instance, double *room, entry_fn visit,
                           void *data) {
    size_t nv = term->nv, first = nevh__index(term, instance, 0);
    double k, *form = room + nevh__form_room(&term->term->decl);
    if (nevh__centre_find(term->term, instance, &k, room)) {
        for (size_t i = 0; i < nv; i++)
            visit(data, nevh__index(term, instance, i), 2 * f->n + 1 + first,
                  i ? 0 : k);
        return;
    }
    nevh__form_find(term->term, instance, form, room);
    for (size_t i = 0; i < nv; i++)
        for (size_t j = 0; j <= nv; j++) {
            size_t row = nevh__index(term, instance, i);
            size_t column = j < nv ? nevh__index(term, instance, j) : 0;
            row += i < term->nq ? 0 : f->n;
            column += j < term->nq ? 0 : j < nv ? f->n : 2 * f->n;
            visit(data, row, column, form[i * (nv + 1) + j]);
        }
}

static bool visit_entries(const nevh_field *f, entry_fn visit, void *data) {
    for (size_t i = 0; i < f->n_terms; i++) {
        const nevh__planned *term = &f->terms[i];
        size_t form = term->nv * (term->nv + 1);
        size_t room = nevh__form_room(&term->term->decl) + form;
        bool moves = term->part == NEVH__FORM || term->part == NEVH__CENTRE;
        double *own = moves ? nevh__array(room, sizeof *own) : NULL;
        if (moves && !own)
            return false;
        for (size_t k = 0; moves && k < term->term->decl.count; k++)
            visit_instance(f, term, k, own, visit, data);
        free(own);
    }
    return true;
}

/* Coordinates that are connected have one root. */
typedef struct {
    size_t n, *up;
} forest;

static void connect(void *data, size_t row, size_t column, double value) {
    const forest *x = data;
    bool central = column > 2 * x->n;
    if (central || (value != 0 && column != 2 * x->n))
        nevh__forest_join(x->up, row % x->n,
                          (central ? column - 1 : column) % x->n);
}

/* Places of coordinates: `block` of each, and which of its coordinates it is. */
typedef struct {
    nevh__form_flow *flow;
    size_t *block, *place;
} map;

static void put_entry(void *data, size_t row, size_t column, double value) {
    const map *x = data;
    size_t n = x->flow->n, k = row % n;
    block *b = &x->flow->blocks[x->block[k]];
    if (column > 2 * n) {
        b->k += value;
        return;
    }
    size_t m = 2 * b->count, to = 2 * x->place[k] + (row < n ? 1 : 0);
    size_t from =
        column == 2 * n ? m : 2 * x->place[column % n] + (column < n ? 0 : 1);
    if (value != 0)
        b->a[to * (m + 1) + from] += row < n ? -value : value;
}

/* The powers of two by which momenta of a block are divided. */
static void choose_units(block *b) {
    size_t m = 2 * b->count;
    for (size_t k = 0; k < b->count; k++) {
        nevh__extended drift = 0, kick = 0;
        for (size_t j = 0; j < b->count; j++) {
            drift = fmax(drift, fabs(b->a[2 * k * (m + 1) + 2 * j + 1]));
            kick = fmax(kick, fabs(b->a[(2 * k + 1) * (m + 1) + 2 * j]));
        }
        bool both = drift > 0 && kick > 0;
        b->units[2 * k + 1] = both ? ilogb(kick / drift) / 2 : 0;
    }
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j <= m; j++) {
            nevh__extended *x = &b->a[i * (m + 1) + j];
            *x = ldexp(*x, (j < m ? b->units[j] : 0) - b->units[i]);
        }
}

static bool plan_blocks(nevh__form_flow *f, map *x, const forest *trees) {
    size_t elements = 0, most = 0;
    for (size_t k = 0; k < f->n; k++)
        if (nevh__forest_root(trees->up, k) == k)
            x->block[k] = f->n_blocks++;
    f->blocks = nevh__array(f->n_blocks, sizeof *f->blocks);
    if (!f->blocks)
        return false;
    for (size_t k = 0; k < f->n; k++) {
        x->block[k] = x->block[nevh__forest_root(trees->up, k)];
        x->place[k] = f->blocks[x->block[k]].count++;
    }
    const size_t *index = f->index;
    for (block *b = f->blocks; b < f->blocks + f->n_blocks; b++) {
        size_t m = 2 * b->count;
        b->index = index;
        index += b->count;
        b->panels = f->n_panels;
        b->ends = f->n_ends;
        f->n_panels += nevh__panel_size(m);
        f->n_ends += 2 * nevh__panel_count(m);
        elements += m * (m + 1);
        most = m > most ? m : most;
    }
    for (size_t k = 0; k < f->n; k++) {
        const block *b = &f->blocks[x->block[k]];
        f->index[(size_t)(b->index - f->index) + x->place[k]] = k;
    }
    if (most > 2 * MOST_BLOCK)
        return true;
    f->a = nevh__array(elements, sizeof *f->a);
    f->units = nevh__array(2 * f->n, sizeof *f->units);
    f->room = nevh__array(3 * most * (most + 1), sizeof *f->room);
    nevh__extended *a = f->a;
    int *units = f->units;
    for (size_t i = 0; a && units && i < f->n_blocks; i++) {
        size_t m = 2 * f->blocks[i].count;
        f->blocks[i].a = a;
        f->blocks[i].units = units;
        a += m * (m + 1);
        units += m;
    }
    return f->a && f->units && f->room;
}

static bool plan_sets(nevh__form_flow *f) {
    bool all = true;
    for (set *x = f->sets; x < f->sets + SETS; x++) {
        x->panels = nevh__array(f->n_times * f->n_panels, sizeof *x->panels);
        x->ends = nevh__array(f->n_times * f->n_ends, sizeof *x->ends);
        x->free = nevh__array(f->n_times * 2 * f->n, sizeof *x->free);
        all = all && x->panels && x->ends && x->free;
    }
    return all;
}

static bool is_free(const block *b) {
    bool fine = b->count == 1 && b->k == 0;
    for (size_t i = 0; i < 6; i++)
        fine = fine && (i == 1 || b->a[i] == 0);
    return fine;
}

/* Blocks that are not free change places with the first. */
static void part_blocks(nevh__form_flow *f) {
    for (block *b = f->blocks; b < f->blocks + f->n_blocks; b++)
        if (!is_free(b)) {
            block bound = *b, *to = &f->blocks[f->n_bound++];
            *b = *to;
            *to = bound;
        }
}

static size_t largest_block(const nevh__form_flow *f) {
    size_t most = 0;
    for (size_t i = 0; i < f->n_blocks; i++)
        most = f->blocks[i].count > most ? f->blocks[i].count : most;
    return most;
}

static bool plan_flow(nevh__form_flow *f, const nevh_field *field) {
    forest trees = {f->n, nevh__array(f->n, sizeof *trees.up)};
    map x = {f, nevh__array(f->n, sizeof *x.block),
             nevh__array(f->n, sizeof *x.place)};
    f->index = nevh__array(f->n, sizeof *f->index);
    bool fine = trees.up && x.block && x.place && f->index;
    for (size_t k = 0; fine && k < f->n; k++)
        trees.up[k] = k;
    fine = fine && visit_entries(field, connect, &trees) &&
           plan_blocks(f, &x, &trees);
    if (fine && f->a) {
        fine = visit_entries(field, put_entry, &x) && plan_sets(f);
        for (size_t i = 0; fine && i < f->n_blocks; i++)
            choose_units(&f->blocks[i]);
        part_blocks(f);
    }
    free(trees.up);
    free(x.block);
    free(x.place);
    return fine;
}

/* Finds bodies among the coordinates that are free. */
static int plan_bodies(nevh__form_flow *f, nevh_work *w) {
    double *inverse_mass = nevh__array(f->n, sizeof *inverse_mass);
    for (size_t i = f->n_bound; inverse_mass && i < f->n_blocks; i++)
        inverse_mass[f->blocks[i].index[0]] = (double)f->blocks[i].a[1];
    int status =
        inverse_mass
            ? nevh__hierarchy_new(w->field, inverse_mass, w->options->q,
                                  w->options->p, w->width, &f->bodies, &f->why)
            : NEVH_ENOMEM;
    free(inverse_mass);
    return status;
}

static int flow_refuse(nevh_work *w, const nevh__form_flow *f, int status) {
    const char *name = w->integrator->name;
    if (status == NEVH_ENOMEM)
        return nevh_work_fail(w, status, "out of memory");
    if (f->a)
        return nevh_work_fail(
            w, status,
            "%s cannot move the bodies of fast effects about one another: each "
            "needs one mass, p^2/2m alone, a place of its own at the start and "
            "coordinates in one order, and there may be %d of them",
            name, NEVH__MOST_BODIES);
    return nevh_work_fail(
        w, status,
        "%s moves connected coordinates by one matrix of at most %d of them, "
        "but the form connects %zu",
        name, MOST_BLOCK, largest_block(f));
}

nevh__form_flow *nevh__form_flow_new(nevh_work *w, size_t count,
                                     const double times[]) {
    nevh__form_flow *f = nevh__array(1, sizeof *f);
    if (f) {
        f->n = w->n;
        f->n_times = count;
        f->multiply = nevh__panels_choose(NEVH__PANEL);
        f->times = nevh__copy(times, count, sizeof *times);
    }
    int status =
        f && f->times && plan_flow(f, w->field) ? NEVH_OK : NEVH_ENOMEM;
    if (!status)
        status = f->a ? plan_bodies(f, w) : NEVH_ESTRUCT;
    if (!status)
        return f;
    flow_refuse(w, f, status);
    nevh__form_flow_free(f);
    return NULL;
}

void nevh__form_flow_set(nevh__form_flow *f, double h) {
    for (size_t i = 0; i < SETS; i++)
        if (f->sets[i].made && f->sets[i].h == h) {
            f->now = i;
            return;
        }
    f->now = (f->now + 1) % SETS;
    set *x = &f->sets[f->now];
    x->h = h;
    x->made = true;
    for (size_t t = 0; t < f->n_times; t++)
        for (size_t i = 0; i < f->n_blocks; i++) {
            const block *b = &f->blocks[i];
            double *panels = x->panels + t * f->n_panels + b->panels;
            if (b->k == 0)
                nevh__form_block_store(b, f->times[t] * h, f->room, panels,
                                       x->ends + t * f->n_ends + b->ends);
            if (i < f->n_bound ||
                (f->bodies && nevh__hierarchy_moves(f->bodies, b->index[0])))
                continue;
            size_t drift = nevh__panel_place(2, 0, 1);
            x->free[2 * t * f->n + b->index[0]] = panels[drift];
            x->free[(2 * t + 1) * f->n + b->index[0]] = panels[drift + 2];
        }
}

/* A block of one, two or three coordinates, in lanes of `width` orbits. */
NEVH__INLINE void add_few(size_t count, const size_t index[],
                          const double panels[], size_t width, const double q[],
                          const double p[], double dq[], double dp[]) {
    size_t m = 2 * count;
    double z[7], high[6] = {0}, low[6] = {0};
    for (size_t k = 0; k < count; k++) {
        z[2 * k] = q[index[k] * width];
        z[2 * k + 1] = p[index[k] * width];
    }
    z[m] = 1;
    NEVH_UNROLL
    for (size_t j = 0; j <= m; j++)
        NEVH_UNROLL
    for (size_t i = 0; i < m; i++) {
        high[i] += panels[2 * m * j + i] * z[j];
        low[i] += panels[2 * m * j + m + i] * z[j];
    }
    for (size_t k = 0; k < count; k++) {
        dq[index[k] * width] += high[2 * k] + low[2 * k];
        dp[index[k] * width] += high[2 * k + 1] + low[2 * k + 1];
    }
}

static void add_many(const nevh__form_flow *f, const block *b,
                     const double panels[], const size_t ends[], size_t width,
                     const double q[], const double p[], double dq[],
                     double dp[]) {
    size_t m = 2 * b->count;
    double z[2 * MOST_BLOCK + 1], sum[2 * MOST_BLOCK + NEVH__PANEL];
    for (size_t k = 0; k < b->count; k++) {
        z[2 * k] = q[b->index[k] * width];
        z[2 * k + 1] = p[b->index[k] * width];
    }
    z[m] = 1;
    f->multiply(m, panels, ends, z, sum);
    for (size_t k = 0; k < b->count; k++) {
        dq[b->index[k] * width] += sum[2 * k];
        dp[b->index[k] * width] += sum[2 * k + 1];
    }
}

static void add_centre(const block *b, double t, size_t width, const double q[],
                       const double p[], double dq[], double dp[]) {
    nevh__extended r[NEVH__SPACE] = {0}, v[NEVH__SPACE] = {0};
    nevh__extended w = (nevh__extended)b->a[1];
    for (size_t k = 0; k < b->count; k++) {
        r[k] = q[b->index[k] * width];
        v[k] = p[b->index[k] * width] * w;
    }
    nevh__kepler_flow((double)(b->k * w), t, r, v);
    for (size_t k = 0; k < b->count; k++) {
        size_t at = b->index[k] * width;
        dq[at] += (double)(r[k] - q[at]);
        dp[at] += (double)(v[k] / w - p[at]);
    }
}

/* Numbers of other coordinates are 0. */
NEVH_SIMD static void add_free(const nevh__form_flow *f, size_t which,
                               size_t width, const double p[], double dq[]) {
    const double *high = f->sets[f->now].free + 2 * which * f->n;
    const double *low = high + f->n;
    for (size_t k = 0; width == 1 && k < f->n; k++)
        dq[k] += high[k] * p[k] + low[k] * p[k];
    for (size_t k = 0; width > 1 && k < f->n; k++)
        for (size_t i = k * width; i < (k + 1) * width; i++)
            dq[i] += high[k] * p[i] + low[k] * p[i];
}

NEVH_SIMD static void add_blocks(const nevh__form_flow *f, size_t which,
                                 size_t width, const double q[],
                                 const double p[], double dq[], double dp[]) {
    const set *x = &f->sets[f->now];
    for (const block *b = f->blocks; b < f->blocks + f->n_bound; b++) {
        const double *panels = x->panels + which * f->n_panels + b->panels;
        const size_t *ends = x->ends + which * f->n_ends + b->ends;
        for (size_t i = 0; i < width; i++)
            if (b->k != 0)
                add_centre(b, f->times[which] * x->h, width, q + i, p + i,
                           dq + i, dp + i);
            else if (b->count == 1)
                add_few(1, b->index, panels, width, q + i, p + i, dq + i,
                        dp + i);
            else if (b->count == 2)
                add_few(2, b->index, panels, width, q + i, p + i, dq + i,
                        dp + i);
            else if (b->count == 3)
                add_few(3, b->index, panels, width, q + i, p + i, dq + i,
                        dp + i);
            else
                add_many(f, b, panels, ends, width, q + i, p + i, dq + i,
                         dp + i);
    }
}

void nevh__form_flow_add(const nevh__form_flow *f, size_t which, size_t width,
                         const double q[], const double p[], double dq[],
                         double dp[]) {
    add_blocks(f, which, width, q, p, dq, dp);
    if (f->n_bound < f->n_blocks)
        add_free(f, which, width, p, dq);
    if (f->bodies)
        nevh__hierarchy_add(f->bodies, f->times[which] * f->sets[f->now].h,
                            width, q, p, dq, dp);
}

const nevh__hierarchy *nevh__form_flow_bodies(const nevh__form_flow *f) {
    return f->bodies;
}

const char *nevh__form_flow_why(const nevh__form_flow *f) {
    return f->why;
}

void nevh__form_flow_lessen(const nevh__form_flow *f, size_t width,
                            const double q[], double dh_dq[]) {
    nevh__hierarchy_lessen(f->bodies, width, q, dh_dq);
}

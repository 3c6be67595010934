/* nevh: the instances of a part of a formula become terms of a system.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include "system/pairs_private.h"
#include <stdlib.h>
#include <string.h>

enum { SHAPES = 1000 }; /* of one part */

/* Instances of one shape: rows of indices and constants. */
typedef struct {
    size_t *shape, n_shape;
    size_t nq, np, nc, count, capacity;
    size_t *q, *p;
    double *c;
} table;

typedef struct {
    nevh__adder *adder;
    const nevh__formula_part *part;
    size_t level; /* loops that are running */
    table *tables;
    size_t n, last; /* the one that an instance fitted last */
    double total;   /* of what reads nothing */
} part_tables;

static bool no_memory(const part_tables *p) {
    return nevh__formula_no_memory(p->adder->walk.scope.error);
}

static bool instance_fits(const table *t, const nevh__walk *w) {
    if (t->n_shape != w->n_shape || t->nc != w->n_constants)
        return false;
    size_t bytes = t->n_shape * sizeof *t->shape;
    return bytes == 0 || memcmp(t->shape, w->shape, bytes) == 0;
}

/* The table for the instance that was noted, or NULL. */
static table *table_for(part_tables *p) {
    const nevh__walk *w = &p->adder->walk;
    for (size_t i = 0; i < p->n; i++) {
        size_t k = (p->last + i) % p->n;
        if (instance_fits(&p->tables[k], w))
            return &p->tables[p->last = k];
    }
    if (p->n == SHAPES) {
        nevh__scope_fail(&p->adder->walk.scope, NEVH_EINVAL, p->part->loops[0],
                         "more than %d kinds of summands", SHAPES);
        return NULL;
    }
    table *tables = nevh__grow(p->tables, p->n + 1, sizeof *tables);
    if (!tables)
        return NULL;
    p->tables = tables;
    tables[p->n] = (table){.n_shape = w->n_shape,
                           .nq = w->n_read[0],
                           .np = w->n_read[1],
                           .nc = w->n_constants};
    tables[p->n].shape = nevh__copy(w->shape, w->n_shape, sizeof *w->shape);
    return &tables[p->last = p->n++];
}

static bool instance_grow(table *t) {
    size_t capacity = t->capacity ? 2 * t->capacity : 1;
    size_t *q = nevh__grow(t->q, capacity * t->nq + 1, sizeof *q);
    t->q = q ? q : t->q;
    size_t *p = nevh__grow(t->p, capacity * t->np + 1, sizeof *p);
    t->p = p ? p : t->p;
    double *c = nevh__grow(t->c, capacity * t->nc + 1, sizeof *c);
    t->c = c ? c : t->c;
    if (!q || !p || !c)
        return false;
    t->capacity = capacity;
    return true;
}

static void copy(void *to, const void *from, size_t count, size_t size) {
    if (count)
        memcpy(to, from, count * size);
}

static bool keep_instance(part_tables *p) {
    const nevh__walk *w = &p->adder->walk;
    table *t = table_for(p);
    if (!t || !t->shape || (t->count == t->capacity && !instance_grow(t)))
        return no_memory(p);
    copy(t->q + t->count * t->nq, w->read[0], t->nq, sizeof *t->q);
    copy(t->p + t->count * t->np, w->read[1], t->np, sizeof *t->p);
    copy(t->c + t->count * t->nc, w->constants, t->nc, sizeof *t->c);
    t->count++;
    return true;
}

/* The value of an instance that reads nothing. */
static bool add_value(part_tables *p) {
    nevh__scope *scope = &p->adder->walk.scope;
    for (size_t i = 0; i < p->part->n; i++) {
        const nevh__summand *s = &p->part->summands[i];
        double value = s->negative ? -1 : 1;
        for (size_t k = 0; k < s->n; k++) {
            double next = nevh__expression_value(scope, s->factors[k].of);
            value = s->factors[k].inverse ? value / next : value * next;
        }
        p->total += value;
        nevh__scope_finite(scope, p->total, s->factors[s->n - 1].of);
    }
    return !scope->error->status;
}

/* One instance, or all that the loops from this level on make. */
static bool visit(void *context) {
    part_tables *p = context;
    nevh__walk *w = &p->adder->walk;
    if (p->level < p->part->n_loops) {
        const nevh__expression *loop = p->part->loops[p->level++];
        bool fine = nevh__scope_loop(&w->scope, loop, visit, p);
        p->level--;
        return fine;
    }
    if (!p->part->reads)
        return add_value(p);
    if (p->adder->instances++ == NEVH__INSTANCES)
        return nevh__scope_fail(
            &w->scope, NEVH_EINVAL, p->part->summands[0].factors[0].of,
            "there are more than %d summands", NEVH__INSTANCES);
    return nevh__walk_note(w, p->part) && keep_instance(p);
}

/* Columns of constants: those that are the same in all instances are numbers,
   and of equal columns one is kept. */

static bool same_column(const table *t, size_t a, size_t b) {
    for (size_t i = 0; i < t->count; i++)
        if (memcmp(t->c + i * t->nc + a, t->c + i * t->nc + b, sizeof *t->c))
            return false;
    return true;
}

static bool one_number(const table *t, size_t k) {
    for (size_t i = 1; i < t->count; i++)
        if (memcmp(t->c + k, t->c + i * t->nc + k, sizeof *t->c))
            return false;
    return true;
}

/* Sets the slot of each column; returns how many there are. */
static size_t choose_columns(const table *t, int columns[]) {
    size_t count = 0;
    for (size_t k = 0; k < t->nc; k++) {
        size_t equal = 0;
        if (one_number(t, k)) {
            columns[k] = -1;
            continue;
        }
        while (equal < k && (columns[equal] < 0 || !same_column(t, equal, k)))
            equal++;
        columns[k] = equal < k ? columns[equal] : (int)count++;
    }
    return count;
}

/* Leaves only what was chosen. */
static void pack_columns(table *t, const int columns[], size_t count) {
    for (size_t i = 0; i < t->count; i++)
        for (size_t k = 0, kept = 0; k < t->nc; k++)
            if (columns[k] == (int)kept)
                t->c[i * count + kept++] = t->c[i * t->nc + k];
    t->nc = count;
}

/* Pairs. */

static bool move_rows(void *rows, size_t count, size_t size,
                      const size_t order[]) {
    char *from = size ? nevh__copy(rows, count, size) : NULL;
    for (size_t i = 0; from && i < count; i++)
        memcpy((char *)rows + i * size, from + order[i] * size, size);
    free(from);
    return from || !size;
}

/* Puts pairs of bodies in the order in which sums go by blocks; false when memory
   is out. */
static bool order_pairs(table *t) {
    nevh__pairs pairs;
    if (!nevh__pairs_find(&pairs, t->nq, t->np, t->count, t->q))
        return true;
    size_t *order = nevh__pairs_order(&pairs);
    bool fine = order &&
                move_rows(t->c, t->count, t->nc * sizeof *t->c, order) &&
                move_rows(t->q, t->count, t->nq * sizeof *t->q, order);
    free(order);
    return fine;
}

/* Terms. */

/* One of the latest tapes that does the same, or NULL. */
static nevh__tape *same_tape(const nevh__owned *owned, const nevh__tape *tape) {
    enum { LATEST = 8 };
    for (size_t i = owned->count; i > 0 && owned->count - i < LATEST; i--)
        if (nevh__tape_alike(owned->tapes[i - 1], tape) &&
            nevh__tape_same(owned->tapes[i - 1], tape))
            return owned->tapes[i - 1];
    return NULL;
}

/* Terms of one formula share a tape.  Returns it; NULL: memory is out. */
static nevh__tape *instance_own(nevh__adder *a, nevh__tape *tape) {
    nevh__owned *owned = a->owned;
    nevh__tape *shared = same_tape(owned, tape);
    if (shared) {
        nevh__tape_free(tape);
        return shared;
    }
    nevh__tape **tapes =
        nevh__grow(owned->tapes, owned->count + 1, sizeof *tapes);
    if (!tapes) {
        nevh__tape_free(tape);
        nevh__formula_no_memory(a->walk.scope.error);
        return NULL;
    }
    owned->tapes = tapes;
    return tapes[owned->count++] = tape;
}

static bool instance_add_term(nevh__adder *a, const table *t,
                              nevh__tape *tape) {
    nevh__formula_error *error = a->walk.scope.error;
    nevh_term term = {.effect = a->effect};
    nevh__tape_shape(&term, tape);
    term.q = t->q;
    term.p = t->p;
    term.c = t->c;
    term.count = t->count;
    int status = nevh_system_add(a->system, &term);
    if (status)
        return nevh__formula_fail(error, status, 0, 0, "%s",
                                  nevh_system_message(a->system));
    a->added++;
    return true;
}

/* One instance's notes are put back, for its tape to be made. */
static bool make_term(part_tables *p, table *t) {
    nevh__walk *w = &p->adder->walk;
    int *columns = nevh__array(t->nc, sizeof *columns);
    if (!columns)
        return no_memory(p);
    size_t count = choose_columns(t, columns);
    copy(w->shape, t->shape, t->n_shape, sizeof *w->shape);
    copy(w->constants, t->c, t->nc, sizeof *w->constants);
    w->columns = columns;
    nevh__tape *tape = nevh__walk_tape(w, p->part);
    w->columns = NULL;
    pack_columns(t, columns, count);
    free(columns);
    if (tape && !order_pairs(t)) {
        nevh__tape_free(tape);
        return no_memory(p);
    }
    tape = tape ? instance_own(p->adder, tape) : NULL;
    return tape && instance_add_term(p->adder, t, tape);
}

static bool add_constant(part_tables *p) {
    nevh__tape_builder *builder = nevh__tape_builder_new();
    int node = nevh__tape_number(builder, p->total);
    nevh__tape *tape = nevh__tape_finish(builder, node, NULL);
    table none = {.count = 1};
    if (!tape)
        return no_memory(p);
    tape = instance_own(p->adder, tape);
    return tape && instance_add_term(p->adder, &none, tape);
}

bool nevh__add_part(nevh__adder *adder, const nevh__formula_part *part) {
    part_tables p = {.adder = adder, .part = part};
    bool fine = visit(&p);
    if (fine && !part->reads)
        fine = add_constant(&p);
    for (size_t i = 0; fine && i < p.n; i++)
        fine = make_term(&p, &p.tables[i]);
    for (size_t i = 0; i < p.n; i++) {
        free(p.tables[i].shape);
        free(p.tables[i].q);
        free(p.tables[i].p);
        free(p.tables[i].c);
    }
    free(p.tables);
    return fine;
}

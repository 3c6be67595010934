/* nevh: neighbouring terms of one formula are evaluated together.

   Many effects that are written out one by one, such as the springs of a
   lattice, have one formula of other variables and numbers.  A gradient takes
   them as instances of one term, whose constants are the numbers that differ.
   Terms are neighbours if no term of a later formula adds, before the second of
   them, to the derivatives that this one adds to; and instances add in turn.  So
   sums have the same bits as those of the terms, one after another.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_private.h"
#include "gradient/evaluation_private.h"
#include <stdlib.h>
#include <string.h>

/* Evaluations of small systems have at most NEVH__MOST_PARTS terms. */
enum { FEWEST = NEVH__MOST_PARTS + 1 };

/* Terms that may be joined; members are linked by `next`. */
typedef struct {
    size_t first, last, count;
} run;

struct nevh__joint {
    nevh__planned plan; /* vars and passes are those of the first member */
    nevh__term_entry entry;
    nevh__tape *tape; /* with constants; NULL: the first one's */
    size_t *q, *p;
    double *c;
    size_t members[];
};

/* Differences go pass by pass through all instances. */
static bool has_one_pass(const nevh__planned *x) {
    return x->pass[0].begin == x->pass[0].end ||
           x->pass[1].begin == x->pass[1].end;
}

static bool is_differenced_alike(const nevh__planned *x,
                                 const nevh__planned *y) {
    return !x->vars ||
           (has_one_pass(x) && memcmp(x->pass, y->pass, sizeof x->pass) == 0 &&
            memcmp(x->vars, y->vars, x->nv * sizeof *x->vars) == 0);
}

static bool is_alike(const nevh__planned *x, const nevh__planned *y) {
    const nevh_term *a = &x->term->decl, *b = &y->term->decl;
    return a->count == 1 && b->count == 1 && x->part == y->part &&
           a->nq == b->nq && a->np == b->np && a->nc == b->nc &&
           a->time == b->time && a->value == b->value && a->block == b->block &&
           a->gradient == b->gradient && is_differenced_alike(x, y) &&
           (a->params == b->params || (a->value == nevh__tape_value &&
                                       nevh__tape_alike(a->params, b->params)));
}

/* Marks the numbers that differ; returns how many do. */
static size_t mark_numbers(const nevh_field *f, const nevh__joint *j,
                           bool opened[]) {
    const double *own, *first;
    size_t count = nevh__tape_numbers(j->entry.decl.params, &first), open = 0;
    for (size_t i = 1; i < j->entry.decl.count; i++) {
        nevh__tape_numbers(f->terms[j->members[i]].term->decl.params, &own);
        for (size_t k = 0; own != first && k < count; k++)
            opened[k] |= memcmp(&own[k], &first[k], sizeof *own) != 0;
    }
    for (size_t k = 0; k < count; k++)
        open += opened[k];
    return open;
}

/* False when memory is out. */
static bool open_numbers(const nevh_field *f, nevh__joint *j, bool **opened) {
    const double *numbers;
    nevh_term *decl = &j->entry.decl;
    if (decl->value != nevh__tape_value)
        return true;
    *opened =
        nevh__array(nevh__tape_numbers(decl->params, &numbers), sizeof(bool));
    size_t open = *opened ? mark_numbers(f, j, *opened) : 0;
    if (open)
        j->tape = nevh__tape_open(decl->params, *opened);
    if (j->tape)
        decl->params = j->tape;
    decl->nc += open;
    return *opened && (!open || j->tape);
}

/* There may be no array of no variables. */
static void copy(void *to, const void *from, size_t size) {
    if (size)
        memcpy(to, from, size);
}

static void take_member(const nevh_field *f, nevh__joint *j, size_t i,
                        const bool opened[]) {
    const nevh__planned *from = &f->terms[j->members[i]];
    const nevh_term *x = &from->term->decl;
    const double *numbers;
    copy(j->q + i * from->nq, x->q, from->nq * sizeof *j->q);
    copy(j->p + i * from->np, x->p, from->np * sizeof *j->p);
    if (from->delta)
        memcpy(j->plan.delta + i * from->nv, from->delta,
               from->nv * sizeof *from->delta);
    double *c = j->c + i * j->entry.decl.nc;
    copy(c, x->c, x->nc * sizeof *c);
    c += x->nc;
    size_t count = j->tape ? nevh__tape_numbers(x->params, &numbers) : 0;
    for (size_t k = 0; k < count; k++)
        if (opened[k])
            *c++ = numbers[k];
}

static bool joint_fill(const nevh_field *f, nevh__joint *j) {
    nevh_term *decl = &j->entry.decl;
    bool *opened = NULL, fine = open_numbers(f, j, &opened);
    decl->q = j->q = nevh__array(decl->count * decl->nq, sizeof *j->q);
    decl->p = j->p = nevh__array(decl->count * decl->np, sizeof *j->p);
    decl->c = j->c = nevh__array(decl->count * decl->nc, sizeof *j->c);
    if (j->plan.delta)
        j->plan.delta = nevh__array(decl->count * j->plan.nv, sizeof(double));
    fine = fine && j->q && j->p && j->c;
    fine = fine && (j->plan.delta || !f->gradient->offsets);
    for (size_t i = 0; fine && i < decl->count; i++)
        take_member(f, j, i, opened);
    free(opened);
    return fine;
}

/* False when memory is out. */
static bool joint_new(nevh_field *f, const run *r, const size_t next[]) {
    nevh__joint *j = nevh__array(1, sizeof *j + r->count * sizeof *j->members);
    if (!j)
        return false;
    const nevh__planned *first = &f->terms[r->first];
    j->entry = *first->term;
    j->entry.decl.count = r->count;
    j->plan = (nevh__planned){.term = &j->entry,
                              .nq = first->nq,
                              .np = first->np,
                              .nv = first->nv,
                              .part = first->part,
                              .delta = first->delta,
                              .vars = first->vars,
                              .pass = {first->pass[0], first->pass[1]},
                              .members = j};
    for (size_t i = 0, at = r->first; i < r->count; i++, at = next[at])
        j->members[i] = at;
    f->pieces[f->n_pieces++] = &j->plan;
    return joint_fill(f, j);
}

void nevh__joints_clear(nevh_field *f) {
    for (size_t i = 0; i < f->n_pieces; i++) {
        nevh__joint *j = f->pieces[i]->members;
        nevh__planned_clear(f->pieces[i]);
        if (!j)
            continue;
        nevh__tape_free(j->tape);
        free(j->plan.delta);
        free(j->q);
        free(j->p);
        free(j->c);
        free(j);
    }
    f->n_pieces = 0;
}

/* Runs that are tried for a term: the last ones that terms went to. */
enum { RECENT = 16 };

typedef struct {
    run *runs;
    size_t count, *next;
    size_t
        *runs_before; /* 2n: runs up to the last one that adds to a variable */
    size_t recent[RECENT], recents;
} joining;

/* The runs up to the last one that adds to what the term adds to. */
static size_t joining_before(const nevh_field *f, const joining *g, size_t i) {
    const nevh_term *x = &f->terms[i].term->decl;
    size_t most = 0;
    for (size_t k = 0; k < x->count * (x->nq + x->np); k++) {
        size_t v =
            k < x->count * x->nq ? x->q[k] : f->n + x->p[k - x->count * x->nq];
        most = g->runs_before[v] > most ? g->runs_before[v] : most;
    }
    return most;
}

/* The run that a term continues, or a new one. */
static size_t run_of(const nevh_field *f, const joining *g, size_t i) {
    const nevh__planned *x = &f->terms[i];
    size_t before = x->nv ? joining_before(f, g, i) : g->count + 1;
    for (size_t k = 0; k < g->recents; k++)
        if (g->recent[k] + 1 >= before &&
            is_alike(&f->terms[g->runs[g->recent[k]].first], x))
            return g->recent[k];
    return g->count;
}

/* The run becomes the most recent one. */
static void use_run(joining *g, size_t at) {
    size_t k = 0;
    while (k < g->recents && g->recent[k] != at)
        k++;
    if (k == g->recents && g->recents < RECENT)
        g->recents++;
    k = k < RECENT ? k : RECENT - 1;
    memmove(g->recent + 1, g->recent, k * sizeof *g->recent);
    g->recent[0] = at;
}

static void go_to_run(const nevh_field *f, joining *g, size_t i, size_t at) {
    const nevh_term *x = &f->terms[i].term->decl;
    if (at == g->count)
        g->runs[g->count++] = (run){i, i, 0};
    g->next[g->runs[at].last] = i;
    g->runs[at].last = i;
    g->runs[at].count++;
    for (size_t k = 0; k < x->count * x->nq; k++)
        g->runs_before[x->q[k]] = at + 1;
    for (size_t k = 0; k < x->count * x->np; k++)
        g->runs_before[f->n + x->p[k]] = at + 1;
    use_run(g, at);
}

static void find_runs(const nevh_field *f, joining *g) {
    bool joins = f->gradient->evaluate && !f->system->by_lane;
    for (size_t i = 0; i < f->n_terms; i++)
        go_to_run(f, g, i, joins ? run_of(f, g, i) : g->count);
}

bool nevh__field_join(nevh_field *f) {
    nevh__joints_clear(f);
    joining g = {.runs = nevh__array(f->n_terms, sizeof *g.runs),
                 .next = nevh__array(f->n_terms, sizeof *g.next),
                 .runs_before = nevh__array(2 * f->n, sizeof *g.runs_before)};
    bool fine = g.runs && g.next && g.runs_before;
    if (fine)
        find_runs(f, &g);
    for (const run *r = g.runs; fine && r < g.runs + g.count; r++)
        if (r->count >= FEWEST)
            fine = joint_new(f, r, g.next);
        else
            for (size_t i = 0, at = r->first; i < r->count;
                 i++, at = g.next[at])
                f->pieces[f->n_pieces++] = &f->terms[at];
    free(g.runs);
    free(g.next);
    free(g.runs_before);
    return fine;
}

void nevh__joint_count(nevh_field *f, nevh__planned *piece) {
    size_t count = piece->members ? piece->term->decl.count : 0;
    for (size_t i = 0; piece->values && i < count; i++)
        f->terms[piece->members->members[i]].values += piece->values / count;
    piece->values = count ? 0 : piece->values;
}

int nevh__joint_fail(nevh_field *f, const nevh__planned *piece,
                     const nevh__places *at, int status) {
    nevh__report told = f->report;
    size_t count = piece->members ? piece->term->decl.count : 0;
    for (size_t i = 0; i < count; i++) {
        f->report = (nevh__report){0};
        int own =
            f->gradient->evaluate(f, &f->terms[piece->members->members[i]], at);
        if (own)
            return own;
    }
    f->report = told;
    return status;
}

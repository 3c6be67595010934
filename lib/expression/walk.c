/* nevh: a walk through one instance of a part of a formula.
   SPDX-License-Identifier: GPL-3.0-or-later

   The first walk notes which variables are read, one after the other, and the
   constants.  Instances for which these fall into the same pattern have the
   same tape, which a second walk makes by following the notes. */
#include "expression/formula_inside_private.h"
#include <stdlib.h>

static int walk_walk(nevh__walk *, nevh__expression *);

static bool noting(const nevh__walk *w) {
    return !w->builder;
}

static bool failed(const nevh__walk *w) {
    return w->scope.error->status;
}

static int apply(nevh__walk *w, nevh__tape_operation operation, int a, int b) {
    return nevh__tape_apply(w->builder, operation, a, b);
}

static int walk_number(nevh__walk *w, double value) {
    return nevh__tape_number(w->builder, value);
}

/* Room for one more element; false when memory is out. */
static bool walk_reserve(nevh__walk *w, void *array, size_t count,
                         size_t *capacity, size_t size) {
    if (count < *capacity)
        return true;
    size_t more = *capacity ? 2 * *capacity : 32;
    void **place = array, *grown = nevh__grow(*place, more, size);
    if (!grown)
        return nevh__formula_no_memory(w->scope.error);
    *place = grown;
    *capacity = more;
    return true;
}

static void note_shape(nevh__walk *w, size_t what) {
    if (walk_reserve(w, &w->shape, w->n_shape, &w->shape_capacity,
                     sizeof *w->shape))
        w->shape[w->n_shape++] = what;
}

/* Constants. */

static void note_constant(nevh__walk *w, double value,
                          const nevh__expression *at) {
    nevh__scope_finite(&w->scope, value, at);
    if (walk_reserve(w, &w->constants, w->n_constants, &w->constants_capacity,
                     sizeof *w->constants))
        w->constants[w->n_constants++] = value;
}

/* A value that depends on indices. */
static int constant(nevh__walk *w, double value, const nevh__expression *at) {
    if (noting(w)) {
        note_constant(w, value, at);
        return -1;
    }
    size_t k = w->at_constant++;
    int column = w->columns ? w->columns[k] : -1;
    return column < 0
               ? walk_number(w, w->constants[k])
               : nevh__tape_variable(w->builder, NEVH__C, (size_t)column);
}

/* The parts of a constant, which is refused if it is too small to have them. */
static void split_constant(nevh__walk *w, nevh__rounded x,
                           const nevh__expression *at, double part[]) {
    nevh__wide value = w->away ? nevh__rounded_away(x) : x.value;
    nevh__wide_split(value, part);
    nevh__wide left = nevh__wide_left(value, part);
    if (left != 0 && (double)left == 0)
        nevh__scope_fail(&w->scope, NEVH_EDOM, at,
                         "this is too near to 0 for more digits than those of "
                         "doubles");
}

static int walk_parts(nevh__walk *w, const nevh__expression *e) {
    double part[NEVH__WIDE_PARTS];
    split_constant(w, e->wide_number, e, part);
    int node = walk_number(w, part[0]);
    for (int i = 1; i < NEVH__WIDE_PARTS && part[i] != 0; i++)
        node = apply(w, NEVH__ADD, node, walk_number(w, part[i]));
    return node;
}

/* The same in parts, each of which may differ between instances. */
static int wide_constant(nevh__walk *w, const nevh__expression *e) {
    double part[NEVH__WIDE_PARTS] = {0};
    if (noting(w))
        split_constant(w, nevh__expression_wide(&w->scope, e), e, part);
    int node = constant(w, part[0], e);
    for (int i = 1; i < NEVH__WIDE_PARTS && !failed(w); i++) {
        int next = constant(w, part[i], e);
        node = apply(w, NEVH__ADD, node, next);
    }
    return node;
}

static int walk_constant(nevh__walk *w, const nevh__expression *e) {
    if (e->form != NEVH__FORM_NUMBER && w->exact)
        return wide_constant(w, e);
    if (e->form != NEVH__FORM_NUMBER)
        return constant(w, noting(w) ? nevh__expression_value(&w->scope, e) : 0,
                        e);
    nevh__scope_finite(&w->scope, e->number, e);
    return w->exact ? walk_parts(w, e) : walk_number(w, e->number);
}

/* Variables. */

static size_t walk_slot_of(nevh__walk *w, nevh__variable kind, size_t index) {
    int k = kind == NEVH__P;
    if (w->whole)
        return index;
    if (w->seen[k][index] != w->stamp) {
        w->seen[k][index] = w->stamp;
        w->slot[k][index] = w->n_read[k];
        w->read[k][w->n_read[k]++] = index;
    }
    return w->slot[k][index];
}

static int walk_variable(nevh__walk *w, const nevh__expression *e) {
    size_t index;
    if (!noting(w))
        return nevh__tape_variable(w->builder, e->kind,
                                   w->shape[w->at_shape++]);
    if (nevh__expression_element(&w->scope, e, &index))
        note_shape(w, walk_slot_of(w, e->kind, index));
    return -1;
}

/* Products begin with what is constant, taken together. */

typedef struct {
    const nevh__expression_operand *factors;
    size_t n, used; /* factors taken by `value` */
    double value;
    bool numbers; /* of numbers alone, the same in all instances */
} prefix;

static prefix take_prefix(nevh__walk *w, bool negative,
                          const nevh__expression_operand *factors, size_t n) {
    prefix p = {factors, n, 0, 1, true};
    for (; p.used < n && !w->exact && !factors[p.used].of->reads; p.used++) {
        const nevh__expression *e = factors[p.used].of;
        p.numbers = p.numbers && e->form == NEVH__FORM_NUMBER;
        if (!noting(w) && !p.numbers)
            continue;
        double value = nevh__expression_value(&w->scope, e);
        p.value = factors[p.used].inverse ? p.value / value : p.value * value;
    }
    if (negative)
        p.value = -p.value;
    return p;
}

static int walk_product(nevh__walk *w, bool negative,
                        const nevh__expression_operand *factors, size_t n) {
    prefix p = take_prefix(w, negative, factors, n);
    size_t i = p.used;
    if (p.numbers && p.used)
        nevh__scope_finite(&w->scope, p.value, factors[i - 1].of);
    int node = -1;
    if (i == 0 && !factors[0].inverse)
        node = walk_walk(w, factors[i++].of);
    else if (p.numbers)
        node = walk_number(w, p.value);
    else
        node = constant(w, p.value, factors[i - 1].of);
    bool negate = negative && p.used == 0 && !factors[0].inverse;
    for (; i < n && !failed(w); i++) {
        int next = walk_walk(w, factors[i].of);
        node = apply(w, factors[i].inverse ? NEVH__DIVIDE : NEVH__MULTIPLY,
                     node, next);
    }
    return negate ? apply(w, NEVH__NEGATE, node, 0) : node;
}

static int walk_sum(nevh__walk *w, const nevh__expression *e) {
    int node = walk_walk(w, e->operands[0].of);
    for (size_t i = 1; i < e->n && !failed(w); i++) {
        int next = walk_walk(w, e->operands[i].of);
        node = apply(w, e->operands[i].inverse ? NEVH__SUBTRACT : NEVH__ADD,
                     node, next);
    }
    return node;
}

static int walk_apply(nevh__walk *w, const nevh__expression *e) {
    int a = walk_walk(w, e->operands[0].of);
    int b = e->n > 1 ? walk_walk(w, e->operands[1].of) : a;
    return apply(w, e->operation, a, b);
}

/* A sum(...) is written out. */

typedef struct {
    nevh__walk *walk;
    nevh__expression *body;
    size_t count;
    int node;
} unrolled;

static bool unroll(void *context) {
    unrolled *sum = context;
    nevh__walk *w = sum->walk;
    int next = walk_walk(w, sum->body);
    sum->node = sum->count ? apply(w, NEVH__ADD, sum->node, next) : next;
    sum->count++;
    return !failed(w);
}

static int walk_loop(nevh__walk *w, const nevh__expression *e) {
    unrolled sum = {w, e->operands[2].of, 0, -1};
    if (noting(w)) {
        size_t at = w->n_shape;
        note_shape(w, 0);
        if (nevh__scope_loop(&w->scope, e, unroll, &sum))
            w->shape[at] = sum.count;
        return -1;
    }
    size_t count = w->shape[w->at_shape++];
    while (sum.count < count && unroll(&sum))
        continue;
    return count ? sum.node : walk_number(w, 0);
}

static int walk_form(nevh__walk *w, const nevh__expression *e) {
    switch (e->form) {
    case NEVH__FORM_VARIABLE:
        return walk_variable(w, e);
    case NEVH__FORM_TIME:
        return nevh__tape_variable(w->builder, NEVH__T, 0);
    case NEVH__FORM_SUM:
        return walk_sum(w, e);
    case NEVH__FORM_PRODUCT:
        return walk_product(w, false, e->operands, e->n);
    case NEVH__FORM_APPLY:
        return walk_apply(w, e);
    case NEVH__FORM_LOOP:
        return walk_loop(w, e);
    case NEVH__FORM_NUMBER:
    case NEVH__FORM_INDEX:
    case NEVH__FORM_PARAMETER:
        break;
    }
    return walk_constant(w, e);
}

static int walk_walk(nevh__walk *w, nevh__expression *e) {
    if (failed(w))
        return -1;
    if (w->length++ == w->limit) {
        nevh__scope_fail(&w->scope, NEVH_EINVAL, e,
                         "with sums and definitions written out there are more "
                         "than %zu operations",
                         w->limit);
        return -1;
    }
    if (!e->reads)
        return walk_constant(w, e);
    if (e->shared && e->stamp == w->stamp)
        return e->node;
    int node = walk_form(w, e);
    if (e->shared) {
        e->stamp = w->stamp;
        e->node = node;
    }
    return node;
}

static int walk_part(nevh__walk *w, const nevh__formula_part *part) {
    int node = -1;
    for (size_t i = 0; i < part->n && !failed(w); i++) {
        const nevh__summand *s = &part->summands[i];
        int next = walk_product(w, s->negative, s->factors, s->n);
        node = i ? apply(w, NEVH__ADD, node, next) : next;
    }
    return node;
}

bool nevh__walk_init(nevh__walk *w, size_t extent, nevh__formula_error *error) {
    w->scope.error = error;
    bool made = true;
    for (int k = 0; k < 2 && !w->whole; k++) {
        w->read[k] = nevh__array(extent, sizeof *w->read[k]);
        w->slot[k] = nevh__array(extent, sizeof *w->slot[k]);
        w->seen[k] = nevh__array(extent, sizeof *w->seen[k]);
        made = made && w->read[k] && w->slot[k] && w->seen[k];
    }
    return made || nevh__formula_no_memory(error);
}

void nevh__walk_clear(nevh__walk *w) {
    for (int k = 0; k < 2; k++) {
        free(w->read[k]);
        free(w->slot[k]);
        free(w->seen[k]);
    }
    free(w->shape);
    free(w->constants);
}

bool nevh__walk_note(nevh__walk *w, const nevh__formula_part *part) {
    w->builder = NULL;
    w->length = w->n_shape = w->n_constants = 0;
    w->n_read[0] = w->n_read[1] = 0;
    w->stamp++;
    walk_part(w, part);
    return !failed(w);
}

nevh__tape *nevh__walk_tape(nevh__walk *w, const nevh__formula_part *part) {
    nevh__formula_error *error = w->scope.error;
    w->builder = nevh__tape_builder_new();
    if (!w->builder) {
        nevh__formula_no_memory(error);
        return NULL;
    }
    if (w->exact)
        nevh__tape_unfold(w->builder);
    w->length = w->at_shape = w->at_constant = 0;
    w->stamp++;
    int node = walk_part(w, part), status = NEVH_OK;
    nevh__tape *tape = nevh__tape_finish(w->builder, node, &status);
    w->builder = NULL;
    if (status == NEVH_ENOMEM)
        nevh__formula_no_memory(error);
    else if (status)
        nevh__scope_fail(&w->scope, status, part->summands[0].factors[0].of,
                         "this is too long, or holds too many values at once");
    return tape;
}

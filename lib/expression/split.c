/* nevh: a formula is split into parts.
   SPDX-License-Identifier: GPL-3.0-or-later

   Which products are split is said at nevh__tree_add_terms. */
#include "expression/formula_inside_private.h"
#include <stdlib.h>
#include <string.h>

/* The context of an expression that is split: signs, factors, and sums over
   indices.  Each link adds one around the last. */
typedef struct around {
    const struct around *outer;
    const nevh__expression_operand *left, *right; /* factors before and after */
    size_t n_left, n_right;
    const nevh__expression *loop; /* or NULL */
    bool negative;                /* all in all */
} around;

/* The factor of a product that is to be split; e->n when there is none. */
static size_t factor_to_split(const nevh__expression *e) {
    size_t reading = 0, reader = e->n, looping = 0, looper = e->n;
    for (size_t i = 0; i < e->n; i++) {
        const nevh__expression *of = e->operands[i].of;
        if (of->reads & ~(unsigned)NEVH__READS_TIME) {
            reading++;
            reader = i;
        }
        if (!e->operands[i].inverse && of->loops) {
            looping++;
            looper = i;
        }
    }
    if (reading == 1 && !e->operands[reader].inverse &&
        e->operands[reader].of->sums)
        return reader;
    return looping == 1 ? looper : e->n;
}

static size_t count_loops(const around *a) {
    size_t count = 0;
    for (; a; a = a->outer)
        count += a->loop != NULL;
    return count;
}

/* True if a part is over exactly these loops. */
static bool same_loops(const nevh__formula_part *part, const around *a) {
    size_t k = part->n_loops;
    for (; a; a = a->outer)
        if (a->loop && (k == 0 || part->loops[--k] != a->loop))
            return false;
    return k == 0;
}

static bool no_memory(nevh__parts *parts) {
    return nevh__formula_no_memory(parts->error);
}

static nevh__formula_part *new_part(nevh__parts *parts, const around *a) {
    if (parts->n == parts->capacity) {
        size_t capacity = parts->capacity ? 2 * parts->capacity : 16;
        nevh__formula_part *grown =
            nevh__grow(parts->parts, capacity, sizeof *grown);
        if (!grown)
            return NULL;
        parts->parts = grown;
        parts->capacity = capacity;
    }
    nevh__formula_part part = {.n_loops = count_loops(a)};
    part.loops = nevh__pool_take(parts->pool, part.n_loops, sizeof *part.loops);
    if (!part.loops)
        return NULL;
    for (size_t k = part.n_loops; a; a = a->outer)
        if (a->loop)
            part.loops[--k] = a->loop;
    parts->parts[parts->n] = part;
    return &parts->parts[parts->n++];
}

/* The part that reads the same over the same loops, or a new one.  The hash
   says so; `reads` makes sure that no accident of hashes joins T and V. */
static nevh__formula_part *part_for(nevh__parts *parts, const around *a,
                                    const nevh__summand *s) {
    unsigned reads = 0;
    uint64_t variables;
    for (size_t i = 0; i < s->n; i++)
        reads |= s->factors[i].of->reads;
    if (!nevh__variables_hash(parts, s, &variables))
        return NULL;
    for (size_t i = 0; i < parts->n; i++) {
        nevh__formula_part *part = &parts->parts[i];
        if (part->reads == reads && part->variables == variables &&
            same_loops(part, a))
            return part;
    }
    nevh__formula_part *part = new_part(parts, a);
    if (!part)
        return NULL;
    part->reads = reads;
    part->variables = variables;
    return part;
}

/* All factors from left to right; the core of several is a product. */
static bool take_factors(nevh__parts *parts, nevh__expression *core,
                         const around *a, nevh__summand *s) {
    bool product = core->form == NEVH__FORM_PRODUCT;
    nevh__expression_operand alone = {.of = core};
    const nevh__expression_operand *middle = product ? core->operands : &alone;
    size_t n_middle = product ? core->n : 1, n_left = 0;
    s->n = n_middle;
    for (const around *b = a; b; b = b->outer) {
        n_left += b->n_left;
        s->n += b->n_left + b->n_right;
    }
    s->factors = nevh__pool_take(parts->pool, s->n, sizeof *s->factors);
    if (!s->factors)
        return false;
    nevh__expression_operand *left = s->factors + n_left,
                             *right = left + n_middle;
    memcpy(left, middle, n_middle * sizeof *middle);
    for (; a; a = a->outer) {
        left -= a->n_left;
        if (a->n_left)
            memcpy(left, a->left, a->n_left * sizeof *left);
        if (a->n_right)
            memcpy(right, a->right, a->n_right * sizeof *right);
        right += a->n_right;
    }
    return true;
}

static bool split_append(nevh__parts *parts, nevh__formula_part *part,
                         const nevh__summand *s) {
    if (part->n == part->capacity) {
        size_t capacity = part->capacity ? 4 * part->capacity : 1;
        nevh__summand *grown =
            nevh__pool_take(parts->pool, capacity, sizeof *grown);
        if (!grown)
            return false;
        if (part->n)
            memcpy(grown, part->summands, part->n * sizeof *grown);
        part->summands = grown;
        part->capacity = capacity;
    }
    part->summands[part->n++] = *s;
    return true;
}

/* Makes a summand of an expression that is not split further. */
static bool emit(nevh__parts *parts, nevh__expression *core, const around *a) {
    nevh__summand s = {.negative = a && a->negative};
    if (parts->summands++ == NEVH__PARTS) {
        parts->error->definition = core->definition;
        return nevh__formula_fail(
            parts->error, NEVH_EINVAL, core->column, core->length,
            "the formula has more than %d summands", NEVH__PARTS);
    }
    if (!take_factors(parts, core, a, &s))
        return no_memory(parts);
    nevh__formula_part *part = part_for(parts, a, &s);
    return (part && split_append(parts, part, &s)) || no_memory(parts);
}

static bool split_split(nevh__parts *, nevh__expression *, const around *);

static bool split_sum(nevh__parts *parts, nevh__expression *e,
                      const around *a) {
    bool negative = a && a->negative, fine = true;
    for (size_t i = 0; fine && i < e->n; i++) {
        around sign = {.outer = a,
                       .negative = negative != e->operands[i].inverse};
        fine = split_split(parts, e->operands[i].of, &sign);
    }
    return fine;
}

static bool split_product(nevh__parts *parts, nevh__expression *e,
                          const around *a) {
    size_t k = factor_to_split(e);
    if (k == e->n)
        return emit(parts, e, a);
    around factors = {.outer = a,
                      .left = e->operands,
                      .n_left = k,
                      .right = e->operands + k + 1,
                      .n_right = e->n - k - 1,
                      .negative = a && a->negative};
    return split_split(parts, e->operands[k].of, &factors);
}

static bool split_split(nevh__parts *parts, nevh__expression *e,
                        const around *a) {
    bool negative = a && a->negative;
    around sign = {.outer = a, .negative = !negative};
    around loop = {.outer = a, .loop = e, .negative = negative};
    if (!e->reads)
        return emit(parts, e, a);
    switch (e->form) {
    case NEVH__FORM_SUM:
        return split_sum(parts, e, a);
    case NEVH__FORM_PRODUCT:
        return split_product(parts, e, a);
    case NEVH__FORM_LOOP:
        return split_split(parts, e->operands[2].of, &loop);
    case NEVH__FORM_APPLY:
        if (e->operation == NEVH__NEGATE)
            return split_split(parts, e->operands[0].of, &sign);
        break;
    default:
        break;
    }
    return emit(parts, e, a);
}

bool nevh__split(nevh__parts *parts, nevh__expression *e) {
    return split_split(parts, e, NULL);
}

/* nevh: what formulas are good for: numbers, tapes, terms.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <math.h>
#include <stdlib.h>

int nevh__tree_check(const nevh__tree *tree, const nevh__names *names,
                     unsigned allowed, unsigned *reads,
                     nevh__formula_error *error) {
    *error = (nevh__formula_error){0};
    nevh__pool pool = {0};
    nevh__expression *e =
        nevh__resolve(tree, names, NULL, allowed, &pool, error);
    if (e && reads)
        *reads = e->reads;
    nevh__pool_free(&pool);
    return error->status;
}

int nevh__tree_number(const nevh__tree *tree, const nevh__names *names,
                      const nevh__index *at, double *value,
                      nevh__formula_error *error) {
    *error = (nevh__formula_error){0};
    nevh__pool pool = {0};
    nevh__expression *e = nevh__resolve(tree, names, at, 0, &pool, error);
    nevh__scope scope = {.error = error};
    double number = e ? nevh__expression_value(&scope, e) : NAN;
    if (e && nevh__scope_finite(&scope, number, e))
        *value = number;
    nevh__pool_free(&pool);
    return error->status;
}

int nevh__tree_wide(const nevh__tree *tree, const nevh__names *names,
                    const nevh__index *at, nevh__rounded *value,
                    nevh__formula_error *error) {
    *error = (nevh__formula_error){0};
    nevh__pool pool = {0};
    nevh__expression *e = nevh__resolve(tree, names, at, 0, &pool, error);
    nevh__scope scope = {.error = error};
    nevh__rounded number = {0, 0};
    if (e)
        number = nevh__expression_wide(&scope, e);
    if (e && nevh__scope_finite(&scope, (double)number.value, e))
        *value = number;
    nevh__pool_free(&pool);
    return error->status;
}

int nevh__tree_integer(const nevh__tree *tree, const nevh__names *names,
                       const nevh__index *at, long *value,
                       nevh__formula_error *error) {
    double number;
    if (nevh__tree_number(tree, names, at, &number, error))
        return error->status;
    nevh__expression whole = {.form = NEVH__FORM_NUMBER,
                              .number = number,
                              .wide_number = {number, 0},
                              .column = tree->root->column,
                              .length = tree->root->length};
    nevh__scope scope = {.error = error};
    nevh__expression_integer(&scope, &whole, "the value", value);
    return error->status;
}

static nevh__tape *whole_tape(nevh__expression *e, nevh__formula_error *error) {
    nevh__expression_operand factor = {.of = e};
    nevh__summand summand = {.n = 1, .factors = &factor};
    nevh__formula_part part = {.n = 1, .summands = &summand};
    nevh__walk walk = {.whole = true, .limit = NEVH__WHOLE_LENGTH};
    nevh__tape *tape = NULL;
    if (nevh__walk_init(&walk, 0, error) && nevh__walk_note(&walk, &part))
        tape = nevh__walk_tape(&walk, &part);
    nevh__walk_clear(&walk);
    return tape;
}

nevh__tape *nevh__tree_tape(const nevh__tree *tree, const nevh__names *names,
                            unsigned allowed, nevh__formula_error *error) {
    *error = (nevh__formula_error){0};
    nevh__pool pool = {0};
    nevh__expression *e =
        nevh__resolve(tree, names, NULL, allowed, &pool, error);
    nevh__tape *tape = e ? whole_tape(e, error) : NULL;
    nevh__pool_free(&pool);
    return tape;
}

void nevh__owned_free(nevh__owned *owned) {
    for (size_t i = 0; i < owned->count; i++)
        nevh__tape_free(owned->tapes[i]);
    free(owned->tapes);
    *owned = (nevh__owned){0};
}

/* An effect without terms would not exist. */
static void add_zero(nevh__adder *adder) {
    nevh__expression zero = {.form = NEVH__FORM_NUMBER};
    nevh__expression_operand factor = {.of = &zero};
    nevh__summand summand = {.n = 1, .factors = &factor};
    nevh__formula_part part = {.n = 1, .summands = &summand};
    nevh__add_part(adder, &part);
}

static void add_parts(nevh__adder *adder, const nevh__names *names,
                      const nevh__parts *parts) {
    nevh__formula_error *error = parts->error;
    bool fine = nevh__walk_init(&adder->walk, nevh__names_extent(names), error);
    for (size_t i = 0; fine && i < parts->n; i++)
        fine = nevh__add_part(adder, &parts->parts[i]);
    if (fine && !adder->added)
        add_zero(adder);
    nevh__walk_clear(&adder->walk);
}

int nevh__tree_add_terms(const nevh__tree *tree, const nevh__names *names,
                         nevh_system *system, const char *effect,
                         nevh__owned *owned, nevh__formula_error *error) {
    *error = (nevh__formula_error){0};
    nevh__pool pool = {0};
    nevh__expression *e = nevh__resolve(
        tree, names, NULL, NEVH__READS_TIME | NEVH__READS_STATE, &pool, error);
    nevh__parts parts = {
        .pool = &pool, .error = error, .stamp = (uint64_t)1 << 63};
    nevh__adder adder = {.system = system, .effect = effect, .owned = owned};
    adder.walk.limit = NEVH__INSTANCE_LENGTH;
    adder.walk.exact = names->exact;
    adder.walk.away = names->away;
    if (e && nevh__split(&parts, e))
        add_parts(&adder, names, &parts);
    free(parts.parts);
    nevh__pool_free(&pool);
    return error->status;
}

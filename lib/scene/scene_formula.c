/* nevh: values of formulas over the whole state.

   Tapes are made when a value is first asked for: of most scenes most commands
   need none.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"

enum { ANYTHING = NEVH__READS_TIME | NEVH__READS_STATE | NEVH__READS_V };

bool nevh__formula_check(nevh_scene *s, const nevh__scene_model *m,
                         const nevh__piece *piece, nevh__formula *formula) {
    *formula = (nevh__formula){.piece = *piece};
    return nevh__piece_check(s, m, piece, ANYTHING);
}

nevh__formula *nevh__formula_list(nevh_scene *s, nevh__scene_model *m,
                                  const nevh__piece *value, size_t *count) {
    nevh__piece *list = nevh__piece_list(s, &m->pool, value, count);
    if (!list)
        return NULL;
    nevh__formula *all = nevh__pool_take(&m->pool, *count, sizeof *all);
    if (!all)
        nevh__scene_no_memory(s);
    for (size_t i = 0; all && i < *count; i++)
        if (!nevh__formula_check(s, m, &list[i], &all[i]))
            return NULL;
    return all;
}

/* The model frees the tape. */
static bool scene_formula_keep(nevh_scene *s, nevh__tape *tape) {
    nevh__owned *owned = &s->model->owned_shown;
    nevh__tape **tapes =
        nevh__grow(owned->tapes, owned->count + 1, sizeof *tapes);
    if (!tapes) {
        nevh__tape_free(tape);
        return nevh__scene_no_memory(s);
    }
    owned->tapes = tapes;
    tapes[owned->count++] = tape;
    return true;
}

static bool make_tape(nevh_scene *s, nevh__formula *formula) {
    nevh__formula_error error = {0};
    nevh__tree *tree = nevh__piece_tree(s, &formula->piece);
    if (!tree)
        return false;
    nevh__tape *tape = nevh__tree_tape(tree, s->model->names, ANYTHING, &error);
    nevh__tree_free(tree);
    if (!tape)
        return nevh__scene_fail_formula(s, &formula->piece, &error);
    if (!scene_formula_keep(s, tape))
        return false;
    formula->tape = tape;
    return true;
}

static bool scene_formula_reserve(nevh_scene *s) {
    nevh__scene_model *m = s->model;
    if (!m->velocities)
        m->velocities = nevh__array(m->n, sizeof *m->velocities);
    if (!m->velocity_buffer)
        m->velocity_buffer = nevh__velocity_buffer(m->system);
    return (m->velocities && m->velocity_buffer) || nevh__scene_no_memory(s);
}

bool nevh__formula_value(nevh_scene *s, nevh__formula *formula, nevh__state *at,
                         double *value) {
    nevh__scene_model *m = s->model;
    if (!formula->tape && !make_tape(s, formula))
        return false;
    if (!at->moving && nevh__tape_count(formula->tape, NEVH__C)) {
        if (!scene_formula_reserve(s))
            return false;
        nevh__velocities(m->system, at->t, at->q, at->p, m->velocity_buffer,
                         m->velocities);
        at->moving = true;
    }
    *value =
        nevh__tape_value(at->t, at->q, at->p, m->velocities, formula->tape);
    return true;
}

bool nevh__formula_values(nevh_scene *s, nevh__formula formulas[], size_t count,
                          nevh__state at, double values[]) {
    for (size_t i = 0; i < count; i++)
        if (!nevh__formula_value(s, &formulas[i], &at, &values[i]))
            return false;
    return true;
}

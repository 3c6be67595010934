/* nevh: outcomes of the members of an ensemble, as text.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_ensemble_private.h"
#include <string.h>

enum { ANYTHING = NEVH__READS_TIME | NEVH__READS_STATE | NEVH__READS_V };

/* FORMULA > FORMULA, or with < */
static bool take_condition(nevh_scene *s, nevh__scene_model *m,
                           const nevh__piece *inside, nevh__scene_outcome *o) {
    char stop;
    o->right = *inside;
    if (!nevh__piece_split(s, &m->pool, &o->right, "<>", &o->left, &stop))
        return false;
    if (!stop)
        return nevh__scene_fail(s, NEVH_EINVAL, inside,
                                "a condition is written FORMULA > FORMULA, or "
                                "with <");
    o->below = stop == '<';
    return nevh__piece_check(s, m, &o->left, ANYTHING) &&
           nevh__piece_check(s, m, &o->right, ANYTHING);
}

/* crossings, period: of the first section; crossings(NAME) */
static bool take_section(nevh_scene *s, nevh__scene_model *m,
                         const nevh__piece *inside, nevh__scene_outcome *o) {
    const char **known =
        nevh__pool_take(&m->pool, m->n_crossings + 1, sizeof *known);
    if (!known)
        return nevh__scene_no_memory(s);
    if (!m->n_crossings)
        return nevh__scene_fail(s, NEVH_EINVAL, &o->piece,
                                "%s needs a section: add [sections] to the "
                                "scene, or use frequency(FORMULA)",
                                o->piece.text);
    o->section = 0;
    for (size_t i = 0; i < m->n_crossings; i++)
        known[i] = m->crossings[i].decl.name;
    while (inside && o->section < m->n_crossings &&
           strcmp(known[o->section], inside->text) != 0)
        o->section++;
    if (o->section == m->n_crossings)
        return nevh__scene_fail_word(s, inside, "section", inside->text, known,
                                     m->n_crossings);
    return m->crossings[o->section].decl.every == 0 ||
           nevh__scene_fail(s, NEVH_EINVAL, inside ? inside : &o->piece,
                            "section %s is stroboscopic: its points are known "
                            "beforehand",
                            known[o->section]);
}

static bool take_inside(nevh_scene *s, nevh__scene_model *m,
                        const nevh__piece *inside, nevh__scene_outcome *o) {
    nevh_outcome_takes takes = o->type->info.takes;
    if (takes == NEVH_OUTCOME_TAKES_SECTION)
        return take_section(s, m, inside, o);
    if (takes == NEVH_OUTCOME_TAKES_NOTHING)
        return !inside ||
               nevh__scene_fail(s, NEVH_EINVAL, &o->piece,
                                "%s stands alone, without parentheses",
                                o->type->info.name);
    if (!inside)
        return nevh__scene_fail(s, NEVH_EINVAL, &o->piece,
                                "this is written %s(%s)", o->type->info.name,
                                takes == NEVH_OUTCOME_TAKES_CONDITION
                                    ? "FORMULA > FORMULA"
                                    : "FORMULA");
    if (takes == NEVH_OUTCOME_TAKES_CONDITION)
        return take_condition(s, m, inside, o);
    o->left = *inside;
    return nevh__piece_check(s, m, inside, ANYTHING);
}

static bool fail_kind(nevh_scene *s, const nevh__piece *piece,
                      const char *name) {
    const char *known[NEVH__OUTCOME_COUNT];
    for (size_t i = 0; i < NEVH__OUTCOME_COUNT; i++)
        known[i] = nevh_outcomes()[i]->name;
    return nevh__scene_fail_word(s, piece, "outcome", name, known,
                                 NEVH__OUTCOME_COUNT);
}

static bool take_outcome(nevh_scene *s, nevh__scene_model *m,
                         const nevh__piece *piece, nevh__scene_outcome *o) {
    nevh__piece name, inside;
    o->piece = *piece;
    const char *open = strchr(piece->text, '(');
    size_t from = (size_t)(piece->at - piece->line->text);
    size_t bytes = open ? (size_t)(open - piece->text) : strlen(piece->text);
    if (!nevh__piece_take(s, &m->pool, piece->line, from, from + bytes, &name))
        return false;
    if (!name.text[0])
        return nevh__scene_fail(s, NEVH_EINVAL, piece,
                                "an outcome is missing here");
    o->type = nevh__outcome_type_of(nevh_outcome_find(name.text));
    if (!o->type)
        return fail_kind(s, &name, name.text);
    if (!open)
        return take_inside(s, m, NULL, o);
    size_t end = bytes + 1 + nevh__formula_extent(open + 1, ")");
    if (end + 1 != strlen(piece->text))
        return nevh__scene_fail(s, NEVH_EINVAL, piece,
                                "an outcome ends with its parenthesis");
    return nevh__piece_take(s, &m->pool, piece->line, from + bytes + 1,
                            from + end, &inside) &&
           take_inside(s, m, &inside, o);
}

bool nevh__ensemble_outcomes(nevh_scene *s, nevh__scene_model *m,
                             const nevh__piece *list) {
    nevh__scene_ensemble *e = m->ensemble;
    size_t count;
    nevh__piece *parts = nevh__piece_list(s, &m->pool, list, &count);
    if (!parts)
        return false;
    e->outcomes = nevh__pool_take(&m->pool, count, sizeof *e->outcomes);
    if (!e->outcomes)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < count; i++) {
        if (!take_outcome(s, m, &parts[i], &e->outcomes[i]))
            return false;
        for (size_t k = 0; k < i; k++)
            if (strcmp(parts[k].text, parts[i].text) == 0)
                return nevh__scene_fail(s, NEVH_EINVAL, &parts[i],
                                        "this outcome is there already");
    }
    e->n_outcomes = count;
    return true;
}

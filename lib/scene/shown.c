/* nevh: definitions, and what is monitored, shown and drawn.

   Formulas that only some commands ask for are checked here all the same, so
   that a mistake shows when the scene is read.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <string.h>

static bool add_definition(nevh_scene *s, nevh__scene_model *m,
                           const nevh__statement *statement) {
    nevh__formula_error error = {0};
    if (!nevh__head_plain(s, statement))
        return false;
    nevh__tree *tree = nevh__piece_tree(s, &statement->value);
    return tree && (!nevh__names_add_definition(m->names, statement->head.name,
                                                tree, &error) ||
                    nevh__scene_fail_formula(s, &statement->key, &error));
}

static bool check_definition(nevh_scene *s, nevh__scene_model *m,
                             const nevh__statement *statement) {
    nevh__formula formula;
    return nevh__formula_check(s, m, &statement->value, &formula);
}

/* Room for one item more; NULL when memory is out. */
static nevh__item *add_item(nevh_scene *s, nevh__scene_model *m,
                            nevh_shown which,
                            const nevh__statement *statement) {
    nevh__items *all = &m->shown[which];
    if (!all->items)
        all->items =
            nevh__pool_take(&m->pool, s->n_statements, sizeof *all->items);
    if (!all->items) {
        nevh__scene_no_memory(s);
        return NULL;
    }
    all->items[all->count].name = statement->head.name;
    return &all->items[all->count++];
}

static bool add_observable(nevh_scene *s, nevh__scene_model *m,
                           const nevh__statement *statement) {
    nevh__item *item = nevh__head_column(s, statement)
                           ? add_item(s, m, NEVH_OBSERVABLES, statement)
                           : NULL;
    return item && nevh__formula_check(s, m, &statement->value, &item->formula);
}

bool nevh__model_definitions(nevh_scene *s, nevh__scene_model *m) {
    return nevh__scene_each(s, m, NEVH__DEFINITIONS, add_definition) &&
           nevh__scene_each(s, m, NEVH__OBSERVABLES, add_definition) &&
           nevh__scene_each(s, m, NEVH__DEFINITIONS, check_definition) &&
           nevh__scene_each(s, m, NEVH__OBSERVABLES, add_observable);
}

/* FORMULA, or FORMULA ; without EFFECT, EFFECT */
static bool take_without(nevh_scene *s, nevh__scene_model *m,
                         const nevh__piece *clause, nevh__item *item) {
    const size_t word = strlen("without");
    size_t at = (size_t)(clause->at - clause->line->text);
    nevh__piece names;
    if (strncmp(clause->text, "without", word) != 0 ||
        !strchr(" \t", clause->text[word]))
        return nevh__scene_fail(s, NEVH_EINVAL, clause,
                                "what may follow \";\" is: without EFFECT");
    if (!nevh__piece_take(s, &m->pool, clause->line, at + word,
                          at + strlen(clause->text), &names))
        return false;
    nevh__piece *list = nevh__piece_list(s, &m->pool, &names, &item->n_without);
    item->without = list;
    for (size_t i = 0; list && i < item->n_without; i++)
        if (!nevh__scene_effect(s, list[i].text))
            return nevh__scene_fail_effect(s, &list[i]);
    return list;
}

static bool add_invariant(nevh_scene *s, nevh__scene_model *m,
                          const nevh__statement *statement) {
    nevh__piece rest = statement->value, formula;
    char stop;
    if (!nevh__head_plain(s, statement))
        return false;
    nevh__item *item = add_item(s, m, NEVH_INVARIANTS, statement);
    return item &&
           nevh__piece_split(s, &m->pool, &rest, ";", &formula, &stop) &&
           nevh__formula_check(s, m, &formula, &item->formula) &&
           (!stop || take_without(s, m, &rest, item));
}

/* Room for one drawn shape more; NULL when memory is out. */
static nevh__drawn *shown_add_part(nevh_scene *s, nevh__scene_model *m) {
    if (!m->drawn)
        m->drawn = nevh__pool_take(&m->pool, s->n_statements, sizeof *m->drawn);
    if (!m->drawn)
        nevh__scene_no_memory(s);
    return m->drawn ? &m->drawn[m->n_drawn++] : NULL;
}

/* name TEXT */
static bool take_name(nevh_scene *s, nevh__scene_model *m,
                      const nevh__piece *clause, nevh__drawn *part) {
    const size_t word = strlen("name");
    size_t at = (size_t)(clause->at - clause->line->text);
    nevh__piece name;
    if (strncmp(clause->text, "name", word) != 0 || !clause->text[word] ||
        !strchr(" \t", clause->text[word]))
        return nevh__scene_fail(s, NEVH_EINVAL, clause,
                                "what may follow \";\" is: name TEXT");
    if (!nevh__piece_take(s, &m->pool, clause->line, at + word,
                          at + strlen(clause->text), &name))
        return false;
    part->decl.name = name.text;
    return true;
}

/* LIST, or LIST ; name TEXT */
static bool take_values(nevh_scene *s, nevh__scene_model *m,
                        const nevh__piece *value, nevh__drawn *part) {
    nevh__piece rest = *value, list;
    char stop;
    if (!nevh__piece_split(s, &m->pool, &rest, ";", &list, &stop))
        return false;
    part->values = nevh__formula_list(s, m, &list, &part->decl.count);
    if (!part->values)
        return false;
    const char **texts =
        nevh__pool_take(&m->pool, part->decl.count, sizeof *texts);
    if (!texts)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < part->decl.count; i++)
        texts[i] = part->values[i].piece.text;
    part->decl.item = texts;
    return !stop || take_name(s, m, &rest, part);
}

static bool add_drawn(nevh_scene *s, nevh__scene_model *m,
                      const nevh__statement *statement) {
    static const char *const known[] = {"rod", "bob"};
    static const size_t numbers[] = {4, 2};
    const char *name = statement->head.name;
    if (!nevh__head_plain(s, statement))
        return false;
    for (size_t i = 0; i < 2; i++) {
        if (strcmp(known[i], name) != 0)
            continue;
        nevh__drawn *part = shown_add_part(s, m);
        if (!part || !take_values(s, m, &statement->value, part))
            return false;
        part->decl.kind = name;
        return part->decl.count == numbers[i] ||
               nevh__scene_fail(s, NEVH_EINVAL, &statement->value,
                                "a %s takes %zu numbers, not %zu", name,
                                numbers[i], part->decl.count);
    }
    return nevh__scene_fail_word(s, &statement->key, "shape", name, known, 2);
}

bool nevh__model_shown(nevh_scene *s, nevh__scene_model *m) {
    return nevh__scene_each(s, m, NEVH__INVARIANTS, add_invariant) &&
           nevh__scene_each(s, m, NEVH__PICTURE, add_drawn) &&
           (!s->judged || nevh__formula_check(s, m, s->judged, &m->judged)) &&
           nevh__model_crossings(s, m);
}

/* True if the name is t, energy, or that of a value in a section. */
static bool is_shown(const nevh_scene *s, const nevh__scene_model *m,
                     const char *name) {
    for (size_t i = 0; i < s->n_statements; i++)
        if (s->statements[i].section == NEVH__INVARIANTS &&
            strcmp(s->statements[i].head.name, name) == 0)
            return true;
    return strcmp(name, "t") == 0 || strcmp(name, "energy") == 0 ||
           nevh__names_find(m->names, name, NULL, NULL) ||
           nevh__scene_effect(s, name);
}

static bool check_label(nevh_scene *s, nevh__scene_model *m,
                        const nevh__statement *statement) {
    const char *name = statement->head.name;
    if (is_shown(s, m, name))
        return true;
    const char **known =
        nevh__pool_take(&m->pool, m->n_coordinates + 2, sizeof *known);
    if (!known)
        return nevh__scene_no_memory(s);
    known[0] = "t";
    known[1] = "energy";
    for (size_t i = 0; i < m->n_coordinates; i++)
        known[i + 2] = m->coordinates[i].statement->head.name;
    return nevh__scene_fail_word(s, &statement->key, "name", name, known,
                                 m->n_coordinates + 2);
}

bool nevh__model_labels(nevh_scene *s, nevh__scene_model *m) {
    return nevh__scene_each(s, m, NEVH__LABELS, check_label);
}

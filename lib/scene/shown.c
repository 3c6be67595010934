/* nevh: definitions, and what is monitored, shown and drawn.

   Formulas that only some commands ask for are checked here all the same, so
   that a mistake shows when the scene is read.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <string.h>

enum { ANYTHING = NEVH__READS_TIME | NEVH__READS_STATE | NEVH__READS_V };

static bool add_definition(nevh_scene *s, nevh__model *m,
                           const nevh__statement *statement) {
    nevh__formula_error error = {0};
    if (!nevh__head_plain(s, statement))
        return false;
    nevh__tree *tree = nevh__piece_tree(s, &statement->value);
    return tree && (!nevh__names_add_definition(m->names, statement->head.name,
                                                tree, &error) ||
                    nevh__scene_fail_formula(s, &statement->key, &error));
}

static bool check_definition(nevh_scene *s, nevh__model *m,
                             const nevh__statement *statement) {
    return nevh__piece_check(s, m, &statement->value, ANYTHING);
}

bool nevh__model_definitions(nevh_scene *s, nevh__model *m) {
    return nevh__scene_each(s, m, NEVH__DEFINITIONS, add_definition) &&
           nevh__scene_each(s, m, NEVH__OBSERVABLES, add_definition) &&
           nevh__scene_each(s, m, NEVH__DEFINITIONS, check_definition) &&
           nevh__scene_each(s, m, NEVH__OBSERVABLES, check_definition);
}

/* FORMULA, or FORMULA ; without EFFECT, EFFECT */
static bool check_without(nevh_scene *s, nevh__model *m,
                          const nevh__piece *clause) {
    const size_t word = strlen("without");
    size_t at = (size_t)(clause->at - clause->line->text), count;
    nevh__piece names;
    if (strncmp(clause->text, "without", word) != 0 ||
        !strchr(" \t", clause->text[word]))
        return nevh__scene_fail(s, NEVH_EINVAL, clause,
                                "what may follow \";\" is: without EFFECT");
    if (!nevh__piece_take(s, &m->pool, clause->line, at + word,
                          at + strlen(clause->text), &names))
        return false;
    nevh__piece *list = nevh__piece_list(s, &m->pool, &names, &count);
    for (size_t i = 0; list && i < count; i++)
        if (!nevh__scene_effect(s, list[i].text))
            return nevh__scene_fail_effect(s, &list[i]);
    return list;
}

static bool check_invariant(nevh_scene *s, nevh__model *m,
                            const nevh__statement *statement) {
    nevh__piece rest = statement->value, formula;
    char stop;
    return nevh__head_plain(s, statement) &&
           nevh__piece_split(s, &m->pool, &rest, ";", &formula, &stop) &&
           nevh__piece_check(s, m, &formula, ANYTHING) &&
           (!stop || check_without(s, m, &rest));
}

/* Each of a list of formulas; returns how many, 0 when one is wrong. */
static size_t check_list(nevh_scene *s, nevh__model *m,
                         const nevh__piece *value) {
    size_t count;
    nevh__piece *list = nevh__piece_list(s, &m->pool, value, &count);
    for (size_t i = 0; list && i < count; i++)
        if (!nevh__piece_check(s, m, &list[i], ANYTHING))
            return 0;
    return list ? count : 0;
}

static bool check_drawn(nevh_scene *s, nevh__model *m,
                        const nevh__statement *statement) {
    static const char *const known[] = {"rod", "bob"};
    static const size_t numbers[] = {4, 2};
    const char *name = statement->head.name;
    if (!nevh__head_plain(s, statement))
        return false;
    for (size_t i = 0; i < 2; i++) {
        if (strcmp(known[i], name) != 0)
            continue;
        size_t count = check_list(s, m, &statement->value);
        return count && (count == numbers[i] ||
                         nevh__scene_fail(s, NEVH_EINVAL, &statement->value,
                                          "a %s takes %zu numbers, not %zu",
                                          name, numbers[i], count));
    }
    return nevh__scene_fail_word(s, &statement->key, "shape", name, known, 2);
}

/* FORMULA = FORMULA, rising */
static bool check_when(nevh_scene *s, nevh__model *m, nevh__piece *rest) {
    nevh__piece left, right;
    char stop;
    if (!nevh__piece_split(s, &m->pool, rest, "=", &left, &stop))
        return false;
    if (!stop)
        return nevh__scene_fail(s, NEVH_EINVAL, &left,
                                "\"=\" is missing: when FORMULA = VALUE, "
                                "rising: ...");
    if (!nevh__piece_split(s, &m->pool, rest, ",", &right, &stop) ||
        !nevh__piece_check(s, m, &left, ANYTHING) ||
        !nevh__piece_check(s, m, &right, ANYTHING))
        return false;
    return strcmp(rest->text, "rising") == 0 ||
           strcmp(rest->text, "falling") == 0 ||
           strcmp(rest->text, "both") == 0 ||
           nevh__scene_fail(s, NEVH_EINVAL, stop ? rest : &right,
                            "a section says rising, falling or both");
}

/* when FORMULA = FORMULA, rising: LIST, or every FORMULA: LIST */
static bool check_section(nevh_scene *s, nevh__model *m,
                          const nevh__statement *statement) {
    const nevh__piece *value = &statement->value;
    nevh__piece shown = *value, front, condition;
    char stop;
    if (!nevh__head_plain(s, statement) ||
        !nevh__piece_split(s, &m->pool, &shown, ":", &front, &stop))
        return false;
    size_t word = strcspn(front.text, " \t"),
           at = (size_t)(front.at - front.line->text);
    bool when = word == 4 && strncmp(front.text, "when", word) == 0;
    bool every = word == 5 && strncmp(front.text, "every", word) == 0;
    if (!stop || (!when && !every))
        return nevh__scene_fail(s, NEVH_EINVAL, value,
                                "a section is written when FORMULA = VALUE, "
                                "rising: ..., or every TIME: ...");
    double every_time;
    return nevh__piece_take(s, &m->pool, front.line, at + word,
                            at + strlen(front.text), &condition) &&
           (when ? check_when(s, m, &condition)
                 : nevh__piece_number(s, m, &condition, &every_time)) &&
           check_list(s, m, &shown);
}

bool nevh__model_shown(nevh_scene *s, nevh__model *m) {
    return nevh__scene_each(s, m, NEVH__INVARIANTS, check_invariant) &&
           nevh__scene_each(s, m, NEVH__PICTURE, check_drawn) &&
           nevh__scene_each(s, m, NEVH__SECTIONS, check_section);
}

/* Whether something has that name: t, energy, or what a section names. */
static bool is_shown(const nevh_scene *s, const nevh__model *m,
                     const char *name) {
    for (size_t i = 0; i < s->n_statements; i++)
        if (s->statements[i].section == NEVH__INVARIANTS &&
            strcmp(s->statements[i].head.name, name) == 0)
            return true;
    return strcmp(name, "t") == 0 || strcmp(name, "energy") == 0 ||
           nevh__names_find(m->names, name, NULL, NULL) ||
           nevh__scene_effect(s, name);
}

static bool check_label(nevh_scene *s, nevh__model *m,
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

bool nevh__model_labels(nevh_scene *s, nevh__model *m) {
    return nevh__scene_each(s, m, NEVH__LABELS, check_label);
}

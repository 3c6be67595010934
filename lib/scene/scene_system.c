/* nevh: effects: which are on, their terms, friction.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <string.h>

nevh__switch *nevh__scene_effect(const nevh_scene *s, const char *name) {
    size_t i = nevh__register_find(&s->effect_names, name);
    return i < s->n_effects ? &s->effects[i] : NULL;
}

bool nevh__scene_fail_effect(nevh_scene *s, const nevh__piece *piece) {
    const char **names = nevh__pool_take(&s->pool, s->n_effects, sizeof *names);
    if (!names)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < s->n_effects; i++)
        names[i] = s->effects[i].name;
    return nevh__scene_fail_word(s, piece, "effect", piece->text, names,
                                 s->n_effects);
}

nevh__switch *nevh__scene_find_effect(nevh_scene *s, const char *name) {
    nevh__switch *found = nevh__scene_effect(s, name);
    nevh__line line = {0, name, strlen(name)};
    if (!found)
        nevh__scene_fail_effect(s, &(nevh__piece){&line, name, name});
    return found;
}

/* An effect of terms and one of friction may have the same name. */
static bool add_switch(nevh_scene *s, nevh__scene_model *m,
                       const nevh__statement *statement) {
    (void)m;
    const char *name = statement->head.name;
    nevh__switch *effect = nevh__scene_effect(s, name);
    if (effect && effect->by->section == statement->section)
        return nevh__scene_fail(s, NEVH_EINVAL, &statement->key,
                                "%s is there already, in line %zu", name,
                                effect->by->key.line->number);
    if (strcmp(name, "all") == 0 || strcmp(name, "none") == 0)
        return nevh__scene_fail(s, NEVH_EINVAL, &statement->key,
                                "%s stands for %s effects", name,
                                name[0] == 'a' ? "all" : "no");
    if (!effect && !nevh__register_reserve(&s->effect_names))
        return nevh__scene_no_memory(s);
    if (!effect) {
        nevh__register_put(&s->effect_names, name, s->n_effects);
        effect = &s->effects[s->n_effects++];
        *effect = (nevh__switch){.name = name, .on = true};
    }
    effect->by = statement;
    return nevh__head_plain(s, statement);
}

static bool switch_on(nevh_scene *s, const nevh__piece *name) {
    if (!name->text[0])
        return nevh__scene_fail(s, NEVH_EINVAL, name,
                                "the name of an effect is missing");
    nevh__switch *effect = nevh__scene_effect(s, name->text);
    if (!effect)
        return nevh__scene_one_name(s, name) &&
               nevh__scene_fail_effect(s, name);
    effect->on = true;
    return true;
}

/* effects = NAME, NAME | all | none */
static bool scene_system_choose(nevh_scene *s, nevh__scene_model *m,
                                const nevh__statement *statement) {
    (void)m;
    size_t count;
    if (strcmp(statement->head.name, "effects") != 0 ||
        strcmp(statement->value.text, "all") == 0)
        return true;
    nevh__piece *names =
        nevh__piece_list(s, &s->pool, &statement->value, &count);
    for (size_t i = 0; names && i < s->n_effects; i++)
        s->effects[i].on = false;
    if (names && strcmp(statement->value.text, "none") == 0)
        return true;
    for (size_t i = 0; names && i < count; i++)
        if (!switch_on(s, &names[i]))
            return false;
    return names;
}

bool nevh__scene_effects(nevh_scene *s) {
    s->effects = nevh__pool_take(&s->pool, s->n_statements, sizeof *s->effects);
    if (!s->effects)
        return nevh__scene_no_memory(s);
    if (!nevh__scene_each(s, NULL, NEVH__EFFECTS, add_switch))
        return false;
    return nevh__scene_each(s, NULL, NEVH__FRICTION, add_switch) &&
           nevh__scene_each(s, NULL, NEVH__SCENE, scene_system_choose);
}

bool nevh__scene_switch(nevh_scene *s, const nevh_scene_options *o) {
    for (size_t i = 0; i < o->n_effects; i++) {
        const char *effect = o->effects ? o->effects[i] : NULL;
        nevh__switch *found =
            nevh__scene_find_effect(s, effect && *effect ? effect + 1 : "");
        if (!found)
            return false;
        found->on = o->effects[i][0] == '+';
        s->switched = true;
    }
    return true;
}

static bool add_terms(nevh_scene *s, nevh__scene_model *m,
                      const nevh__statement *statement) {
    const nevh__piece *value = &statement->value;
    nevh__formula_error error = {0};
    if (nevh__is_code(statement))
        return nevh__model_code(s, m, statement);
    nevh__tree *tree = nevh__piece_tree(s, value);
    if (!tree)
        return false;
    int status = nevh__tree_add_terms(tree, m->names, m->system,
                                      statement->head.name, &m->owned, &error);
    nevh__tree_free(tree);
    return !status || nevh__scene_fail_formula(s, value, &error);
}

bool nevh__model_terms(nevh_scene *s, nevh__scene_model *m) {
    if (!s->n_effects)
        return nevh__scene_fail_at(s, NEVH_EINVAL, &s->lines[s->n_lines - 1], 1,
                                   0, "there are no [effects]");
    m->system = nevh_system_new(m->n);
    if (!m->system)
        return nevh__scene_no_memory(s);
    m->system->names = (const char *const *)m->coordinate_names;
    if (!nevh__scene_each(s, m, NEVH__EFFECTS, add_terms) ||
        !nevh__model_friction(s, m) || !nevh__model_parts(s, m))
        return false;
    for (size_t i = 0; i < s->n_effects; i++)
        nevh_system_enable(m->system, s->effects[i].name, s->effects[i].on);
    return !nevh_system_status(m->system) || nevh__scene_no_memory(s);
}

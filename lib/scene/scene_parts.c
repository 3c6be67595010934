/* nevh: [parts]: fast = EFFECT, ... and slow = EFFECT, ...
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <string.h>

static const char *const keys[] = {"fast", "slow"};

static bool set_speed(nevh_scene *s, nevh__scene_model *m,
                      const nevh__piece *name, nevh_speed speed) {
    if (!nevh__scene_effect(s, name->text))
        return nevh__scene_one_name(s, name) &&
               nevh__scene_fail_effect(s, name);
    for (size_t i = 0; i < m->n_fast; i++)
        if (speed == NEVH_SLOW && strcmp(m->fast[i].text, name->text) == 0)
            return nevh__scene_fail(s, NEVH_EINVAL, name,
                                    "%s is fast and slow: it can be one",
                                    name->text);
    return !nevh_system_set_speed(m->system, name->text, speed) ||
           nevh__scene_no_memory(s);
}

/* Effects that are not named are slow where some are called fast. */
static bool take_others(nevh_scene *s, nevh__scene_model *m) {
    for (size_t i = 0; m->n_fast && i < s->n_effects; i++)
        nevh_system_set_speed(m->system, s->effects[i].name, NEVH_SLOW);
    for (size_t i = 0; i < m->n_fast; i++)
        if (!set_speed(s, m, &m->fast[i], NEVH_FAST))
            return false;
    return true;
}

static bool take_fast(nevh_scene *s, nevh__scene_model *m,
                      const nevh__statement *statement) {
    size_t key = nevh__statement_key(s, statement, keys, 2);
    if (key == 2)
        return false;
    if (key == 0)
        m->fast = nevh__piece_list(s, &m->pool, &statement->value, &m->n_fast);
    return key || (m->fast && take_others(s, m));
}

static bool take_slow(nevh_scene *s, nevh__scene_model *m,
                      const nevh__statement *statement) {
    size_t count = 0;
    if (strcmp(statement->head.name, "slow") != 0)
        return true;
    nevh__piece *names =
        nevh__piece_list(s, &m->pool, &statement->value, &count);
    for (size_t i = 0; names && i < count; i++)
        if (!set_speed(s, m, &names[i], NEVH_SLOW))
            return false;
    return names;
}

bool nevh__model_parts(nevh_scene *s, nevh__scene_model *m) {
    return nevh__scene_each(s, m, NEVH__SPEEDS, take_fast) &&
           nevh__scene_each(s, m, NEVH__SPEEDS, take_slow);
}

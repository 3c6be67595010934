/* nevh: friction: NAME = COORDINATE: RATE, ... or all: RATE.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <string.h>

typedef struct {
    double *rates;
    bool *given;
    bool on;             /* and of a model that is exact */
    nevh__statement one; /* COORDINATE: RATE */
} friction;

/* Which coordinates x, x[3], x[2..N], x[i = 1..N] or all are. */
static bool find_range(nevh_scene *s, const nevh__scene_model *m,
                       const nevh__statement *one, size_t *from, size_t *to) {
    const char *name = one->head.name;
    *from = 0;
    *to = m->n;
    if (strcmp(name, "all") == 0 && !one->head.from)
        return true;
    if (nevh__names_find(m->names, name, NULL, NULL) != NEVH__COORDINATE)
        return nevh__scene_fail(s, NEVH_EINVAL, &one->key,
                                "there is no coordinate %s", name);
    return nevh__head_range(s, m, one, from, to);
}

static bool set_rate(nevh_scene *s, nevh__scene_model *m, friction *d, size_t k,
                     const nevh__tree *tree, nevh__index at) {
    nevh__formula_error error = {0};
    if (d->given[k])
        return nevh__scene_fail(s, NEVH_EINVAL, &d->one.key,
                                "a rate of %s is given twice",
                                m->coordinate_names[k]);
    d->given[k] = true;
    const nevh__index *index = at.name ? &at : NULL;
    int status = nevh__tree_number(tree, m->names, index, &d->rates[k], &error);
    nevh__rounded rate = {0, 0};
    if (m->exact && !status)
        status = nevh__tree_wide(tree, m->names, index, &rate, &error);
    if (d->on && !status)
        m->exact->rates[k] =
            nevh__operation_rounded(NEVH__ADD, m->exact->rates[k], rate);
    return !status || nevh__scene_fail_formula(s, &d->one.value, &error);
}

static bool take_rates(nevh_scene *s, nevh__scene_model *m, friction *d) {
    size_t from = 0, to = 0, first = 0;
    const nevh__head *head = &d->one.head;
    if (!find_range(s, m, &d->one, &from, &to))
        return false;
    nevh__tree *tree = nevh__piece_tree(s, &d->one.value);
    size_t work = 0;
    nevh__names_find(m->names, head->name, NULL, &first);
    bool fine = tree;
    for (size_t k = from; fine && k < to; k++)
        fine =
            set_rate(s, m, d, k, tree,
                     (nevh__index){head->index, (long)(k - first) + 1, &work});
    nevh__tree_free(tree);
    return fine;
}

static bool scene_friction_take_part(nevh_scene *s, nevh__scene_model *m,
                                     friction *d, const nevh__piece *part) {
    char stop;
    nevh__formula_error error;
    d->one = (nevh__statement){.value = *part};
    if (!nevh__piece_split(s, &m->pool, &d->one.value, ":", &d->one.key, &stop))
        return false;
    if (!stop)
        return nevh__scene_fail(s, NEVH_EINVAL, part,
                                "friction is written COORDINATE: RATE, or all: "
                                "RATE");
    if (nevh__head_parse(d->one.key.text, &d->one.head, &error))
        return nevh__scene_fail_formula(s, &d->one.key, &error);
    bool fine = take_rates(s, m, d);
    nevh__head_free(&d->one.head);
    return fine;
}

static bool scene_friction_add_friction(nevh_scene *s, nevh__scene_model *m,
                                        const nevh__statement *statement) {
    size_t count;
    friction d = {.rates = nevh__pool_take(&m->pool, m->n, sizeof *d.rates),
                  .given = nevh__pool_take(&m->pool, m->n, sizeof *d.given)};
    if (!d.rates || !d.given)
        return nevh__scene_no_memory(s);
    d.on = m->exact && nevh__scene_effect(s, statement->head.name)->on;
    nevh__piece *parts =
        nevh__piece_list(s, &m->pool, &statement->value, &count);
    if (!parts)
        return false;
    for (size_t i = 0; i < count; i++)
        if (!scene_friction_take_part(s, m, &d, &parts[i]))
            return false;
    return !nevh_system_add_friction(m->system, statement->head.name,
                                     d.rates) ||
           nevh__scene_no_memory(s);
}

bool nevh__model_friction(nevh_scene *s, nevh__scene_model *m) {
    return nevh__scene_each(s, m, NEVH__FRICTION, scene_friction_add_friction);
}

/* nevh: numbers and arrays of numbers; parameters.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_ensemble_private.h"
#include <stdio.h>
#include <string.h>

enum { MOST_ELEMENTS = 1 << 22 };

bool nevh__head_bound(nevh_scene *s, const nevh__scene_model *m,
                      const nevh__piece *key, const nevh__tree *tree,
                      long *value) {
    nevh__formula_error error;
    return !nevh__tree_integer(tree, m->names, NULL, value, &error) ||
           nevh__scene_fail_formula(s, key, &error);
}

bool nevh__head_plain(nevh_scene *s, const nevh__statement *statement) {
    return !statement->head.from ||
           nevh__scene_fail(s, NEVH_EINVAL, &statement->key,
                            "a plain name belongs here, without an index");
}

bool nevh__head_column(nevh_scene *s, const nevh__statement *statement) {
    return strcmp(statement->head.name, "energy") != 0 ||
           nevh__scene_fail(s, NEVH_EINVAL, &statement->key,
                            "energy is the value of H in tables and [labels]: "
                            "take another name");
}

/* The index of NAME[i = 1..N] must be new. */
static bool check_index(nevh_scene *s, const nevh__scene_model *m,
                        const nevh__statement *statement) {
    const char *index = statement->head.index;
    bool taken =
        index && (strcmp(index, "t") == 0 || strcmp(index, "pi") == 0 ||
                  nevh__names_find(m->names, index, NULL, NULL));
    return !taken || nevh__scene_fail(s, NEVH_EINVAL, &statement->key,
                                      "%s already means something else: take "
                                      "another name for the index",
                                      index);
}

bool nevh__head_shape(nevh_scene *s, const nevh__scene_model *m,
                      const nevh__statement *statement, nevh__shape *shape) {
    const nevh__head *head = &statement->head;
    const nevh__piece *key = &statement->key;
    long from = 1, to = 1;
    *shape = (nevh__shape){head->from != NULL, 1};
    if (!head->from)
        return true;
    if (!head->to)
        return nevh__scene_fail(s, NEVH_EINVAL, key,
                                "all of %s is given at once: write %s[1..N] = "
                                "..., or %s[i = 1..N] = ...",
                                head->name, head->name, head->name);
    if (!nevh__head_bound(s, m, key, head->from, &from) ||
        !nevh__head_bound(s, m, key, head->to, &to) ||
        !check_index(s, m, statement))
        return false;
    if (from != 1)
        return nevh__scene_fail(s, NEVH_EINVAL, key,
                                "indices begin with 1, not with %ld", from);
    if (to < 1 || to > MOST_ELEMENTS)
        return nevh__scene_fail(s, NEVH_EINVAL, key,
                                "%s[1..%ld] has not between 1 and %d elements",
                                head->name, to, MOST_ELEMENTS);
    shape->count = (size_t)to;
    return true;
}

bool nevh__head_range(nevh_scene *s, const nevh__scene_model *m,
                      const nevh__statement *one, size_t *from, size_t *to) {
    const nevh__head *head = &one->head;
    size_t count = 0, first = 0;
    nevh__names_find(m->names, head->name, &count, &first);
    bool array = count > 0;
    long low = 1, high = array ? (long)count : 1;
    if (head->from && !nevh__head_bound(s, m, &one->key, head->from, &low))
        return false;
    if (head->from && !head->to)
        high = low;
    if (head->to && !nevh__head_bound(s, m, &one->key, head->to, &high))
        return false;
    if (low < 1 || high > (long)(array ? count : 1) || low > high ||
        (head->from && !array))
        return nevh__scene_fail(s, NEVH_EINVAL, &one->key,
                                "%s has no such elements", head->name);
    *from = first + (size_t)low - 1;
    *to = first + (size_t)high;
    return true;
}

/* Says for which index it was. */
static void add_index(nevh__formula_error *error, const nevh__index *index) {
    size_t used = strlen(error->text);
    snprintf(error->text + used, sizeof error->text - used, " (%s = %ld)",
             index->name, index->value);
}

bool nevh__scene_numbers_take(nevh_scene *s, nevh__scene_model *m, size_t count,
                              nevh__scene_numbers *to) {
    to->near = nevh__pool_take(&m->pool, count, sizeof *to->near);
    to->wide =
        m->exact ? nevh__pool_take(&m->pool, count, sizeof *to->wide) : NULL;
    return (to->near && (to->wide || !m->exact)) || nevh__scene_no_memory(s);
}

static bool values_by_index(nevh_scene *s, const nevh__scene_model *m,
                            const nevh__statement *statement,
                            const nevh__piece *value, size_t count,
                            nevh__scene_numbers to) {
    nevh__formula_error error = {0};
    nevh__tree *tree = nevh__piece_tree(s, value);
    int status = 0;
    size_t work = 0;
    for (size_t k = 0; tree && !status && k < count; k++) {
        nevh__index index = {statement->head.index, (long)k + 1, &work};
        status = nevh__tree_number(tree, m->names, &index, &to.near[k], &error);
        if (to.wide && !status)
            status =
                nevh__tree_wide(tree, m->names, &index, &to.wide[k], &error);
        if (status)
            add_index(&error, &index);
    }
    nevh__tree_free(tree);
    return tree && (!status || nevh__scene_fail_formula(s, value, &error));
}

bool nevh__head_values(nevh_scene *s, nevh__scene_model *m,
                       const nevh__statement *statement,
                       const nevh__piece *value, size_t count,
                       nevh__scene_numbers to) {
    size_t given;
    if (statement->head.index)
        return values_by_index(s, m, statement, value, count, to);
    nevh__piece *parts = nevh__piece_list(s, &m->pool, value, &given);
    if (!parts)
        return false;
    for (size_t k = 0; k < given && k < count; k++)
        if (!nevh__piece_number(s, m, &parts[k], &to.near[k]) ||
            (to.wide && !nevh__piece_wide(s, m, &parts[k], &to.wide[k])))
            return false;
    if (given != 1 && given != count)
        return nevh__scene_fail(
            s, NEVH_EINVAL, given > count ? &parts[count] : value,
            "%s takes %zu value%s, not %zu", statement->head.name, count,
            count == 1 ? "" : "s", given);
    for (size_t k = given; k < count; k++) {
        to.near[k] = to.near[0];
        if (to.wide)
            to.wide[k] = to.wide[0];
    }
    return true;
}

const nevh__statement *nevh__scene_assignment(const nevh_scene *s,
                                              const char *name) {
    for (size_t i = s->n_assignments; i-- > 0;)
        if (strcmp(s->assignments[i]->head.name, name) == 0)
            return s->assignments[i];
    return NULL;
}

static bool add_parameter(nevh_scene *s, nevh__scene_model *m,
                          const nevh__statement *statement) {
    nevh__shape shape;
    const char *name = statement->head.name;
    const nevh__statement *from = nevh__scene_assignment(s, name);
    from = from ? from : statement;
    if (!nevh__head_shape(s, m, statement, &shape))
        return false;
    nevh__scene_numbers values;
    if (!nevh__scene_numbers_take(s, m, shape.count, &values) ||
        !nevh__head_values(s, m, from, &from->value, shape.count, values))
        return false;
    nevh__override(s, name, values.near);
    nevh__formula_error error = {0};
    return !nevh__names_add_wide(m->names, name, shape.array ? shape.count : 0,
                                 values.near, values.wide, &error) ||
           nevh__scene_fail_formula(s, &statement->key, &error);
}

bool nevh__model_parameters(nevh_scene *s, nevh__scene_model *m) {
    return nevh__scene_each(s, m, NEVH__PARAMETERS, add_parameter);
}

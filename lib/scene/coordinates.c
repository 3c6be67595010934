/* nevh: coordinates: names, and the state to start from.

   Names and numbers of elements come first, since formulas of values may call
   definitions; values follow once those are known.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <stdlib.h>
#include <string.h>

/* True if a statement is p_NAME = ... or v_NAME = ... */
static bool is_motion(const nevh__statement *statement) {
    const char *name = statement->head.name;
    return (name[0] == 'p' || name[0] == 'v') && name[1] == '_' && name[2];
}

static bool add_coordinate(nevh_scene *s, nevh__scene_model *m,
                           const nevh__statement *statement) {
    nevh__shape shape;
    nevh__formula_error error = {0};
    if (is_motion(statement))
        return true;
    if (!nevh__head_column(s, statement))
        return false;
    if (!nevh__head_shape(s, m, statement, &shape))
        return false;
    if (nevh__names_add_coordinate(m->names, statement->head.name,
                                   shape.array ? shape.count : 0, m->n, &error))
        return nevh__scene_fail_formula(s, &statement->key, &error);
    m->coordinates[m->n_coordinates++] =
        (nevh__coordinate){statement, shape.array ? shape.count : 0, m->n};
    m->n += shape.count;
    return true;
}

static bool add_names(nevh_scene *s, nevh__scene_model *m,
                      const nevh__coordinate *c) {
    for (size_t k = 0; k < (c->count ? c->count : 1); k++)
        if (!(m->coordinate_names[c->first + k] = nevh__pool_keep(
                  &m->pool, nevh__text(c->count ? "%s[%zu]" : "%s",
                                       c->statement->head.name, k + 1))))
            return nevh__scene_no_memory(s);
    return true;
}

static bool reserve_exact(nevh__scene_model *m) {
    nevh__exact_numbers *e = m->exact;
    e->q = nevh__pool_take(&m->pool, 4 * m->n, sizeof *e->q);
    if (!e->q)
        return false;
    e->p = e->q + m->n;
    e->v = e->p + m->n;
    e->rates = e->v + m->n;
    return true;
}

static bool coordinates_reserve(nevh_scene *s, nevh__scene_model *m) {
    m->coordinate_names = nevh__pool_take(&m->pool, m->n, sizeof(char *));
    m->q = nevh__pool_take(&m->pool, m->n, sizeof *m->q);
    m->p = nevh__pool_take(&m->pool, m->n, sizeof *m->p);
    m->v = nevh__pool_take(&m->pool, m->n, sizeof *m->v);
    m->period = nevh__pool_take(&m->pool, m->n, sizeof *m->period);
    m->moving = nevh__pool_take(&m->pool, m->n, sizeof *m->moving);
    m->by_velocity = nevh__pool_take(&m->pool, m->n, sizeof *m->by_velocity);
    return (m->coordinate_names && m->q && m->p && m->v && m->period &&
            m->moving && m->by_velocity && (!m->exact || reserve_exact(m))) ||
           nevh__scene_no_memory(s);
}

bool nevh__model_coordinates(nevh_scene *s, nevh__scene_model *m) {
    m->coordinates =
        nevh__pool_take(&m->pool, s->n_statements, sizeof *m->coordinates);
    if (!m->coordinates)
        return nevh__scene_no_memory(s);
    if (!nevh__scene_each(s, m, NEVH__COORDINATES, add_coordinate))
        return false;
    if (!m->n)
        return nevh__scene_fail_at(s, NEVH_EINVAL, &s->lines[s->n_lines - 1], 1,
                                   0, "there are no [coordinates]");
    if (!coordinates_reserve(s, m))
        return false;
    for (size_t i = 0; i < m->n_coordinates; i++)
        if (!add_names(s, m, &m->coordinates[i]))
            return false;
    return true;
}

/* period FORMULA */
static bool take_period(nevh_scene *s, nevh__scene_model *m,
                        const nevh__coordinate *c, const nevh__piece *clause) {
    const char *text = clause->text;
    nevh__piece formula;
    size_t word = strcspn(text, " \t"),
           at = (size_t)(clause->at - clause->line->text);
    double period;
    if (word != 6 || strncmp(text, "period", 6) != 0)
        return nevh__scene_fail(s, NEVH_EINVAL, clause,
                                "what may follow \";\" is: period FORMULA");
    if (!nevh__piece_take(s, &m->pool, clause->line, at + word,
                          at + strlen(text), &formula) ||
        !nevh__piece_number(s, m, &formula, &period))
        return false;
    if (period <= 0)
        return nevh__scene_fail(s, NEVH_EINVAL, &formula,
                                "a period is greater than 0, not %g", period);
    if (m->period[c->first] > 0)
        return nevh__scene_fail(s, NEVH_EINVAL, clause,
                                "a period is given already");
    for (size_t k = 0; k < (c->count ? c->count : 1); k++)
        m->period[c->first + k] = period;
    return true;
}

/* Notes that momenta are given; they must not be twice. */
static bool claim(nevh_scene *s, nevh__scene_model *m, size_t first,
                  size_t count, const nevh__statement *by) {
    if (m->moving[first])
        return nevh__scene_fail(s, NEVH_EINVAL, &by->key,
                                "momentum or velocity of %s: given in line %zu "
                                "already",
                                m->coordinate_names[first],
                                m->moving[first]->key.line->number);
    for (size_t k = 0; k < count; k++)
        m->moving[first + k] = by;
    return true;
}

/* The start of element k on: of coordinates, momenta or velocities. */
static nevh__scene_numbers start_of(const nevh__scene_model *m,
                                    nevh__meaning is, size_t k) {
    const nevh__exact_numbers *e = m->exact;
    nevh__scene_numbers all =
        is == NEVH__COORDINATE ? (nevh__scene_numbers){m->q, e ? e->q : NULL}
        : is == NEVH__MOMENTUM ? (nevh__scene_numbers){m->p, e ? e->p : NULL}
                               : (nevh__scene_numbers){m->v, e ? e->v : NULL};
    return nevh__scene_numbers_from(all, k);
}

static bool take_value(nevh_scene *s, nevh__scene_model *m,
                       const nevh__piece *piece, nevh__scene_numbers to) {
    return nevh__piece_number(s, m, piece, to.near) &&
           (!to.wide || nevh__piece_wide(s, m, piece, to.wide));
}

/* VALUE or VALUE, MOMENTUM */
static bool take_pair(nevh_scene *s, nevh__scene_model *m,
                      const nevh__coordinate *c, const nevh__piece *value) {
    size_t given, k = c->first;
    nevh__piece *parts = nevh__piece_list(s, &m->pool, value, &given);
    if (!parts ||
        !take_value(s, m, &parts[0], start_of(m, NEVH__COORDINATE, k)))
        return false;
    if (given > 2)
        return nevh__scene_fail(s, NEVH_EINVAL, &parts[2],
                                "a coordinate takes VALUE, or VALUE, MOMENTUM");
    return given == 1 ||
           (take_value(s, m, &parts[1], start_of(m, NEVH__MOMENTUM, k)) &&
            claim(s, m, k, 1, c->statement));
}

/* A coordinate, or an array of them, with velocities. */
static bool take_elements(nevh_scene *s, nevh__scene_model *m,
                          const nevh__coordinate *c, const nevh__piece *value) {
    size_t count = c->count ? c->count : 1;
    if (!nevh__elements_values(s, m, c->statement, value, count,
                               start_of(m, NEVH__COORDINATE, c->first),
                               start_of(m, NEVH__VELOCITY, c->first)) ||
        !claim(s, m, c->first, count, c->statement))
        return false;
    for (size_t k = 0; k < count; k++)
        m->by_velocity[c->first + k] = true;
    return true;
}

static bool take_coordinate(nevh_scene *s, nevh__scene_model *m,
                            const nevh__coordinate *c) {
    nevh__piece rest = c->statement->value, value, clause;
    char stop;
    if (!nevh__piece_split(s, &m->pool, &rest, ";", &value, &stop))
        return false;
    bool elements = c->statement->group || nevh__is_elements(&value);
    bool fine = elements ? take_elements(s, m, c, &value)
                : c->count
                    ? nevh__head_values(s, m, c->statement, &value, c->count,
                                        start_of(m, NEVH__COORDINATE, c->first))
                    : take_pair(s, m, c, &value);
    while (fine && stop)
        fine = nevh__piece_split(s, &m->pool, &rest, ";", &clause, &stop) &&
               take_period(s, m, c, &clause);
    return fine;
}

/* p_NAME = ..., v_NAME = ... */
static bool take_motion(nevh_scene *s, nevh__scene_model *m,
                        const nevh__statement *statement) {
    size_t count, first;
    nevh__shape shape;
    const char *name = statement->head.name;
    if (!is_motion(statement))
        return true;
    nevh__meaning meaning = nevh__names_find(m->names, name, &count, &first);
    if (meaning != NEVH__MOMENTUM && meaning != NEVH__VELOCITY)
        return nevh__scene_fail(s, NEVH_EINVAL, &statement->key,
                                "there is no coordinate %s", name + 2);
    if (!nevh__head_shape(s, m, statement, &shape))
        return false;
    if (shape.array != (count > 0) || (count && shape.count != count))
        return nevh__scene_fail(s, NEVH_EINVAL, &statement->key,
                                count ? "%s is an array: write %s[1..%zu] = ..."
                                      : "%s has no index",
                                name + 2, name, count);
    if (!claim(s, m, first, shape.count, statement))
        return false;
    for (size_t k = 0; k < shape.count; k++)
        m->by_velocity[first + k] = meaning == NEVH__VELOCITY;
    return nevh__head_values(s, m, statement, &statement->value, shape.count,
                             start_of(m, meaning, first));
}

static bool fail_start(nevh_scene *s, nevh__scene_model *m,
                       const nevh__statement *one) {
    static const char *const prefix[] = {"", "p_", "v_"};
    const char **known =
        nevh__pool_take(&m->pool, 3 * m->n_coordinates, sizeof *known);
    size_t count = 0;
    if (!known)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < m->n_coordinates; i++)
        for (int k = 0; k < 3; k++)
            if (!(known[count++] = nevh__pool_keep(
                      &m->pool,
                      nevh__text("%s%s", prefix[k],
                                 m->coordinates[i].statement->head.name))))
                return nevh__scene_no_memory(s);
    return nevh__scene_fail_word(
        s, &one->key, "coordinate, momentum (p_NAME) or velocity (v_NAME)",
        one->head.name, known, count);
}

/* The name of an array without an index stands for all of it. */
static bool start_range(nevh_scene *s, const nevh__scene_model *m,
                        const nevh__statement *one, size_t *from, size_t *to) {
    size_t count, first;
    nevh__names_find(m->names, one->head.name, &count, &first);
    if (one->head.from || !count)
        return nevh__head_range(s, m, one, from, to);
    *from = first;
    *to = first + count;
    return true;
}

/* Notes that momenta are given from outside, or velocities. */
static void replace_motion(nevh__scene_model *m, const nevh__statement *by,
                           nevh__meaning is, size_t from, size_t to) {
    for (size_t k = from; is != NEVH__COORDINATE && k < to; k++) {
        m->moving[k] = by;
        m->by_velocity[k] = is == NEVH__VELOCITY;
        if (is == NEVH__VELOCITY)
            m->p[k] = 0; /* until it is found */
    }
}

/* A start from outside: of coordinates, momenta or velocities. */
static bool take_start(nevh_scene *s, nevh__scene_model *m,
                       const nevh__statement *one) {
    nevh__scene_numbers values;
    size_t from, to, first;
    nevh__meaning is = nevh__names_find(m->names, one->head.name, NULL, &first);
    if (is != NEVH__COORDINATE && is != NEVH__MOMENTUM && is != NEVH__VELOCITY)
        return fail_start(s, m, one);
    if (!start_range(s, m, one, &from, &to))
        return false;
    /* The formula of an index is of x[first], x[first + 1], ... */
    size_t skipped = one->head.index ? from - first : 0, count = to - from;
    if (!nevh__scene_numbers_take(s, m, skipped + count, &values) ||
        !nevh__head_values(s, m, one, &one->value, skipped + count, values))
        return false;
    nevh__scene_numbers all = start_of(m, is, from);
    memcpy(all.near, values.near + skipped, count * sizeof *all.near);
    if (all.wide)
        memcpy(all.wide, values.wide + skipped, count * sizeof *all.wide);
    replace_motion(m, one, is, from, to);
    return true;
}

bool nevh__model_values(nevh_scene *s, nevh__scene_model *m) {
    for (size_t i = 0; i < m->n_coordinates; i++)
        if (!take_coordinate(s, m, &m->coordinates[i]))
            return false;
    if (!nevh__scene_each(s, m, NEVH__COORDINATES, take_motion))
        return false;
    for (size_t i = 0; i < s->n_starts; i++)
        if (!take_start(s, m, s->starts[i]))
            return false;
    return true;
}

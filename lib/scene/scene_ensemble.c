/* nevh: [ensemble]: what is varied, and how.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_ensemble_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double most_members = 1e11;

static bool fail_arguments(nevh_scene *s, const nevh__piece *value,
                           const char *usage) {
    return nevh__scene_fail(s, NEVH_EINVAL, value, "this is written %s", usage);
}

/* A whole number of members. */
static bool take_count(nevh_scene *s, const nevh__scene_model *m,
                       const nevh__piece *piece, double least,
                       uint64_t *count) {
    double number;
    if (!nevh__piece_number(s, m, piece, &number))
        return false;
    if (!(number >= least && number <= most_members) || number != floor(number))
        return nevh__scene_fail(s, NEVH_EINVAL, piece,
                                "this must be a whole number from %g to %g, "
                                "not %.12g",
                                least, most_members, number);
    *count = (uint64_t)number;
    return true;
}

static bool take_range(nevh_scene *s, nevh__scene_model *m, nevh__varied *v,
                       const nevh__piece *arguments, size_t given) {
    if (given != 3)
        return fail_arguments(s, &v->statement->value, "range(A, B, N)");
    v->how = NEVH__VARY_RANGE;
    return nevh__piece_number(s, m, &arguments[0], &v->a) &&
           nevh__piece_number(s, m, &arguments[1], &v->b) &&
           take_count(s, m, &arguments[2], 2, &v->count);
}

static bool take_draw(nevh_scene *s, nevh__scene_model *m, nevh__varied *v,
                      const nevh__piece *arguments, size_t given) {
    bool normal = v->how == NEVH__VARY_NORMAL;
    if (given != 2)
        return fail_arguments(s, &v->statement->value,
                              normal ? "normal(MEAN, DEVIATION)"
                                     : "uniform(A, B)");
    v->count = 1;
    m->ensemble->draws = true;
    if (!nevh__piece_number(s, m, &arguments[0], &v->a) ||
        !nevh__piece_number(s, m, &arguments[1], &v->b))
        return false;
    if (normal && !(v->b >= 0))
        return nevh__scene_fail(s, NEVH_EINVAL, &arguments[1],
                                "a deviation is not below 0, as %g is", v->b);
    return normal || v->b > v->a ||
           nevh__scene_fail(s, NEVH_EINVAL, &arguments[1],
                            "uniform(A, B) has A below B, not %g and %g", v->a,
                            v->b);
}

static bool take_list(nevh_scene *s, nevh__scene_model *m, nevh__varied *v) {
    size_t count;
    nevh__piece *parts =
        nevh__piece_list(s, &m->pool, &v->statement->value, &count);
    if (!parts)
        return false;
    v->how = NEVH__VARY_LIST;
    v->count = count;
    v->values = nevh__pool_take(&m->pool, count, sizeof *v->values);
    if (!v->values)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < count; i++)
        if (!nevh__piece_number(s, m, &parts[i], &v->values[i]))
            return false;
    return true;
}

/* from FORMULA: where the search begins */
static bool take_guess(nevh_scene *s, nevh__scene_model *m, nevh__varied *v,
                       const nevh__piece *from) {
    size_t at = (size_t)(from->at - from->line->text);
    nevh__piece formula;
    return nevh__piece_take(s, &m->pool, from->line, at + 4,
                            at + strlen(from->text), &formula) &&
           nevh__piece_number(s, m, &formula, &v->a);
}

/* solve(LEFT = RIGHT), or with ", from FORMULA" */
static bool take_solve(nevh_scene *s, nevh__scene_model *m, nevh__varied *v,
                       const nevh__piece *arguments, size_t given) {
    enum { ANYTHING = NEVH__READS_TIME | NEVH__READS_STATE };
    const nevh__piece *from = given > 1 ? &arguments[1] : NULL;
    char stop;
    v->how = NEVH__VARY_SOLVE;
    v->count = 1;
    v->a = 1;
    v->right = arguments[0];
    m->ensemble->solves = true;
    if (!nevh__piece_split(s, &m->pool, &v->right, "=", &v->left, &stop))
        return false;
    if (!stop || given > 2 || (from && strncmp(from->text, "from", 4) != 0))
        return fail_arguments(s, &v->statement->value,
                              "solve(FORMULA = FORMULA, from NUMBER)");
    if (v->is != NEVH__COORDINATE && v->is != NEVH__MOMENTUM)
        return nevh__scene_fail(s, NEVH_EINVAL, &v->statement->key,
                                "what is solved for is a coordinate or a "
                                "momentum");
    v->energy = strcmp(v->left.text, "H") == 0 &&
                nevh__names_find(m->names, "H", NULL, NULL) == NEVH__UNKNOWN;
    if ((!v->energy && !nevh__piece_check(s, m, &v->left, ANYTHING)) ||
        !nevh__piece_check(s, m, &v->right, ANYTHING))
        return false;
    return !from || take_guess(s, m, v, from);
}

static bool take_what(nevh_scene *s, nevh__scene_model *m, nevh__varied *v) {
    static const struct {
        const char *name;
        nevh__variation how;
    } calls[] = {{"range", NEVH__VARY_RANGE},
                 {"normal", NEVH__VARY_NORMAL},
                 {"uniform", NEVH__VARY_UNIFORM},
                 {"solve", NEVH__VARY_SOLVE}};
    const nevh__piece *value = &v->statement->value;
    nevh__piece *arguments = NULL;
    size_t given;
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++) {
        if (!nevh__piece_call(s, &m->pool, value, calls[i].name, &arguments,
                              &given))
            return false;
        v->how = calls[i].how;
        if (given)
            return (v->how == NEVH__VARY_RANGE ? take_range
                    : v->how == NEVH__VARY_SOLVE
                        ? take_solve
                        : take_draw)(s, m, v, arguments, given);
    }
    return take_list(s, m, v);
}

/* The place of NAME or NAME[k]. */
static bool find_place(nevh_scene *s, nevh__scene_model *m, nevh__varied *v) {
    const nevh__head *head = &v->statement->head;
    const nevh__piece *key = &v->statement->key;
    size_t count = 0, first = 0;
    long at = 1;
    v->is = nevh__names_find(m->names, head->name, &count, &first);
    if (v->is == NEVH__UNKNOWN || v->is == NEVH__DEFINITION)
        return nevh__scene_fail(s, NEVH_EINVAL, key,
                                "%s is no coordinate, momentum (p_NAME), "
                                "velocity (v_NAME) or parameter, nor combine, "
                                "count, outcomes or seed",
                                head->name);
    if (head->to || (count > 0) != (head->from != NULL))
        return nevh__scene_fail(s, NEVH_EINVAL, key,
                                count ? "one element is varied by a line: "
                                        "write %s[1] = ..."
                                      : "%s has no elements",
                                head->name);
    if (head->from && !nevh__head_bound(s, m, key, head->from, &at))
        return false;
    if (at < 1 || (size_t)at > (count ? count : 1))
        return nevh__scene_fail(s, NEVH_EINVAL, key, "%s has no element %ld",
                                head->name, at);
    v->index = (v->is == NEVH__PARAMETER ? 0 : first) + (size_t)at - 1;
    v->name = nevh__pool_keep(
        &m->pool, nevh__text(count ? "%s[%ld]" : "%s", head->name, at));
    return v->name || nevh__scene_no_memory(s);
}

static bool is_setting(const nevh__statement *one) {
    static const char *const names[] = {"combine", "count", "outcomes", "seed"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(one->head.name, names[i]) == 0)
            return true;
    return false;
}

static bool take_setting(nevh_scene *s, nevh__scene_model *m,
                         const nevh__statement *one) {
    nevh__scene_ensemble *e = m->ensemble;
    const nevh__piece *value = &one->value;
    const char *name = one->head.name;
    if (!nevh__head_plain(s, one))
        return false;
    if (strcmp(name, "count") == 0) {
        e->counted = true;
        return take_count(s, m, value, 1, &e->each);
    }
    if (strcmp(name, "seed") == 0)
        return take_count(s, m, value, 0, &e->seed);
    if (strcmp(name, "outcomes") == 0) {
        e->where = value;
        return true;
    }
    e->zip = strcmp(value->text, "zip") == 0;
    return e->zip || strcmp(value->text, "product") == 0 ||
           nevh__scene_fail(s, NEVH_EINVAL, value, "combine is product or zip");
}

static bool same_place(const nevh__varied *a, const nevh__varied *b) {
    return a->is == b->is && a->index == b->index &&
           (a->is != NEVH__PARAMETER || strcmp(a->name, b->name) == 0);
}

/* A line from outside replaces the one of that name. */
static bool add_varied(nevh_scene *s, nevh__scene_model *m,
                       const nevh__statement *one, bool outside) {
    nevh__scene_ensemble *e = m->ensemble;
    nevh__varied v = {.statement = one};
    if (is_setting(one))
        return take_setting(s, m, one);
    if (!find_place(s, m, &v) || !take_what(s, m, &v))
        return false;
    for (size_t i = 0; i < e->n_varied; i++) {
        if (!same_place(&e->varied[i], &v))
            continue;
        if (!outside)
            return nevh__scene_fail(s, NEVH_EINVAL, &one->key,
                                    "%s is varied already, in line %zu", v.name,
                                    e->varied[i].statement->key.line->number);
        e->varied[i] = v;
        return true;
    }
    e->varied[e->n_varied++] = v;
    return true;
}

/* A momentum takes the place of a velocity, and the reverse. */
static bool claim_momenta(nevh_scene *s, nevh__scene_model *m) {
    nevh__scene_ensemble *e = m->ensemble;
    e->by_velocity = nevh__pool_take(&m->pool, m->n, sizeof *e->by_velocity);
    if (!e->by_velocity)
        return nevh__scene_no_memory(s);
    memcpy(e->by_velocity, m->by_velocity, m->n * sizeof *e->by_velocity);
    for (size_t i = 0; i < e->n_varied; i++) {
        const nevh__varied *v = &e->varied[i];
        e->parameters |= v->is == NEVH__PARAMETER;
        if (v->is == NEVH__MOMENTUM || v->is == NEVH__VELOCITY)
            e->by_velocity[v->index] = v->is == NEVH__VELOCITY;
        for (size_t k = 0; k < i; k++)
            if (v->is + e->varied[k].is == NEVH__MOMENTUM + NEVH__VELOCITY &&
                v->is != e->varied[k].is && v->index == e->varied[k].index)
                return nevh__scene_fail(s, NEVH_EINVAL, &v->statement->key,
                                        "momentum and velocity of one "
                                        "coordinate cannot both be varied");
    }
    return true;
}

static bool is_axis(const nevh__varied *v) {
    return v->how == NEVH__VARY_LIST || v->how == NEVH__VARY_RANGE;
}

/* Lists and ranges in step. */
static bool count_zipped(nevh_scene *s, nevh__scene_ensemble *e,
                         double *points) {
    const nevh__varied *first = NULL;
    for (size_t i = 0; i < e->n_varied; i++) {
        nevh__varied *v = &e->varied[i];
        if (!is_axis(v))
            continue;
        v->stride = 1;
        if (first && v->count != first->count)
            return nevh__scene_fail(
                s, NEVH_EINVAL, &v->statement->value,
                "%s has %llu values and %s has %llu: in step (combine = zip) "
                "they are equally many",
                v->name, (unsigned long long)v->count, first->name,
                (unsigned long long)first->count);
        first = first ? first : v;
    }
    *points = first ? (double)first->count : 1;
    return true;
}

/* All combinations, the last line's fastest. */
static void count_product(nevh__scene_ensemble *e, double *points) {
    *points = 1;
    for (size_t i = e->n_varied; i-- > 0;) {
        nevh__varied *v = &e->varied[i];
        v->stride = *points <= most_members ? (uint64_t)*points : 1;
        *points *= (double)v->count;
    }
}

static bool count_members(nevh_scene *s, nevh__scene_ensemble *e) {
    const nevh__piece *where = &e->varied[e->n_varied - 1].statement->key;
    double points = 1;
    if (e->counted && !e->draws)
        return nevh__scene_fail(s, NEVH_EINVAL, where,
                                "count is of draws, and nothing is drawn: "
                                "leave it out, or use normal or uniform");
    if (e->zip && !count_zipped(s, e, &points))
        return false;
    if (!e->zip)
        count_product(e, &points);
    if (e->draws && !e->counted && points == 1)
        return nevh__scene_fail(s, NEVH_EINVAL, where,
                                "how many are to be drawn? say count = 1000");
    if (points * (double)e->each > most_members)
        return nevh__scene_fail(s, NEVH_EINVAL, where,
                                "these are %g members; at most %g can be told "
                                "apart",
                                points * (double)e->each, most_members);
    e->members = (uint64_t)points * e->each;
    return true;
}

double nevh__varied_value(const nevh__scene_ensemble *e, const nevh__varied *v,
                          uint64_t member) {
    uint64_t i = member / e->each / (v->stride ? v->stride : 1) % v->count;
    switch (v->how) {
    case NEVH__VARY_RANGE:
        if (i + 1 == v->count)
            return v->b;
        return v->a + (v->b - v->a) * ((double)i / (double)(v->count - 1));
    case NEVH__VARY_NORMAL:
        return v->a + v->b * nevh_normal_at(e->seed, v->name, member);
    case NEVH__VARY_UNIFORM:
        return v->a + (v->b - v->a) * nevh_uniform_at(e->seed, v->name, member);
    case NEVH__VARY_SOLVE:
        return v->a; /* where the search begins */
    default:
        return v->values[i];
    }
}

void nevh__override(const nevh_scene *s, const char *parameter,
                    double values[]) {
    const struct nevh__overrides *o = s->overrides;
    for (size_t i = 0; o && i < o->of->n_varied; i++) {
        const nevh__varied *v = &o->of->varied[i];
        size_t bytes = strlen(parameter);
        if (v->is == NEVH__PARAMETER &&
            strncmp(v->name, parameter, bytes) == 0 &&
            (!v->name[bytes] || v->name[bytes] == '['))
            values[v->index] = o->value[i];
    }
}

static bool add_from_scene(nevh_scene *s, nevh__scene_model *m,
                           const nevh__statement *one) {
    return add_varied(s, m, one, false);
}

static bool scene_ensemble_begin(nevh_scene *s, nevh__scene_model *m) {
    nevh__scene_ensemble *e = nevh__pool_take(&m->pool, 1, sizeof *e);
    if (!e)
        return nevh__scene_no_memory(s);
    m->ensemble = e;
    e->each = 1;
    e->varied = nevh__pool_take(&m->pool, s->n_statements + s->n_varies,
                                sizeof *e->varied);
    return e->varied || nevh__scene_no_memory(s);
}

bool nevh__model_ensemble(nevh_scene *s, nevh__scene_model *m) {
    if (s->overrides)
        return true;
    if (!scene_ensemble_begin(s, m) ||
        !nevh__scene_each(s, m, NEVH__ENSEMBLE, add_from_scene))
        return false;
    for (size_t i = 0; i < s->n_varies; i++)
        if (!add_varied(s, m, s->varies[i], true))
            return false;
    nevh__scene_ensemble *e = m->ensemble;
    const nevh__piece *outcomes = s->outcomes ? s->outcomes : e->where;
    return claim_momenta(s, m) && (!e->n_varied || count_members(s, e)) &&
           (!outcomes || nevh__ensemble_outcomes(s, m, outcomes));
}

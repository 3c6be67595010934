/* nevh: the settings of [run] and the keys of [scene].
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <math.h>
#include <nevh/integrator.h>
#include <string.h>

static bool take_number(nevh_scene *s, const nevh__scene_model *m,
                        const nevh__piece *value, bool positive,
                        double *number) {
    if (!nevh__piece_number(s, m, value, number))
        return false;
    return !positive || *number > 0 ||
           nevh__scene_fail(s, NEVH_EINVAL, value,
                            "this must be greater than 0, not %g", *number);
}

/* A list of numbers greater than 0. */
static bool scene_run_take_numbers(nevh_scene *s, nevh__scene_model *m,
                                   const nevh__piece *value,
                                   const double **numbers, size_t *count) {
    nevh__piece *list = nevh__piece_list(s, &m->pool, value, count);
    if (!list)
        return false;
    double *all = nevh__pool_take(&m->pool, *count, sizeof *all);
    if (!all)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < *count; i++)
        if (!take_number(s, m, &list[i], true, &all[i]))
            return false;
    *numbers = all;
    return true;
}

static bool check_gradient(nevh_scene *s, const nevh__piece *name) {
    const nevh_gradient *const *all = nevh_gradients();
    const char *known[16];
    size_t count = 0;
    for (; all[count] && count < sizeof known / sizeof *known; count++)
        known[count] = nevh_gradient_name(all[count]);
    return nevh_gradient_named(name->text) ||
           nevh__scene_fail_word(s, name, "gradient", name->text, known, count);
}

bool nevh__scene_fail_integrator(nevh_scene *s, const nevh__piece *at,
                                 const char *name) {
    const char *known[128];
    size_t count = 0, most = sizeof known / sizeof *known;
    const nevh_integrator *const *all = nevh_integrators();
    for (size_t i = 0; i < s->n_titles && count < most; i++)
        known[count++] = s->titles[i].text;
    for (; *all && count < most; all++)
        known[count++] = nevh_integrator_name(*all);
    return nevh__scene_fail_word(s, at, "integrator", name, known, count);
}

static bool is_integrator(const nevh_scene *s, const char *name) {
    for (size_t i = 0; i < s->n_titles; i++)
        if (strcmp(s->titles[i].text, name) == 0)
            return true;
    return nevh_integrator_named(name);
}

/* NAME, NAME+transform or respa+SUBSTEPS */
static bool check_integrator(nevh_scene *s, const nevh__piece *name) {
    char plain[NEVH__NAME_LENGTH];
    size_t bytes = strcspn(name->text, "+");
    bytes = bytes < sizeof plain ? bytes : sizeof plain - 1;
    memcpy(plain, name->text, bytes);
    plain[bytes] = '\0';
    const char *tail = strchr(name->text, '+');
    return (is_integrator(s, plain) &&
            (!tail || strcmp(tail, "+transform") == 0 ||
             nevh_substeps_named(name->text))) ||
           nevh__scene_fail_integrator(s, name, plain);
}

typedef bool (*checker)(nevh_scene *, const nevh__piece *);

static bool take_names(nevh_scene *s, nevh__scene_model *m,
                       const nevh__piece *value, checker check,
                       const char *const **names, size_t *count) {
    nevh__piece *list = nevh__piece_list(s, &m->pool, value, count);
    if (!list)
        return false;
    const char **all = nevh__pool_take(&m->pool, *count, sizeof *all);
    if (!all)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < *count; i++) {
        if (!list[i].text[0])
            return nevh__scene_fail(s, NEVH_EINVAL, &list[i],
                                    "a name is missing here");
        if (!nevh__scene_one_name(s, &list[i]) || !check(s, &list[i]))
            return false;
        all[i] = list[i].text;
    }
    *names = all;
    return true;
}

static bool take_t_start(nevh_scene *s, nevh__scene_model *m,
                         const nevh__piece *v) {
    return take_number(s, m, v, false, &m->run.t_start) &&
           (!m->exact || nevh__piece_wide(s, m, v, &m->exact->t_start));
}

static bool take_t_end(nevh_scene *s, nevh__scene_model *m,
                       const nevh__piece *v) {
    return take_number(s, m, v, false, &m->run.t_end) &&
           (!m->exact || nevh__piece_wide(s, m, v, &m->exact->t_end));
}

static bool take_dt(nevh_scene *s, nevh__scene_model *m, const nevh__piece *v) {
    return scene_run_take_numbers(s, m, v, &m->run.dt, &m->run.dts);
}

static bool take_tolerance(nevh_scene *s, nevh__scene_model *m,
                           const nevh__piece *v) {
    return scene_run_take_numbers(s, m, v, &m->run.tolerance,
                                  &m->run.tolerances);
}

static bool take_integrators(nevh_scene *s, nevh__scene_model *m,
                             const nevh__piece *v) {
    return take_names(s, m, v, check_integrator, &m->run.integrator,
                      &m->run.integrators);
}

static bool take_gradient(nevh_scene *s, nevh__scene_model *m,
                          const nevh__piece *v) {
    return take_names(s, m, v, check_gradient, &m->run.gradient,
                      &m->run.gradients);
}

/* The step of one element, whose index is at. */
static bool set_step(nevh_scene *s, const nevh__scene_model *m,
                     const nevh__statement *one, const nevh__tree *tree,
                     nevh__index at, double *step) {
    nevh__formula_error error = {0};
    if (*step > 0)
        return nevh__scene_fail(s, NEVH_EINVAL, &one->key,
                                "a step of %s is given twice", one->head.name);
    if (nevh__tree_number(tree, m->names, at.name ? &at : NULL, step, &error))
        return nevh__scene_fail_formula(s, &one->value, &error);
    return *step > 0 ||
           nevh__scene_fail(s, NEVH_EINVAL, &one->value,
                            "this must be greater than 0, not %g", *step);
}

/* Steps of what a head names: of coordinates, or after those of momenta. */
static bool set_steps(nevh_scene *s, nevh__scene_model *m,
                      const nevh__statement *one, double steps[]) {
    size_t from, to, first;
    nevh__meaning meaning =
        nevh__names_find(m->names, one->head.name, NULL, &first);
    if (meaning != NEVH__COORDINATE && meaning != NEVH__MOMENTUM)
        return nevh__scene_fail(s, NEVH_EINVAL, &one->key,
                                "there is no coordinate or momentum %s",
                                one->head.name);
    if (!nevh__head_range(s, m, one, &from, &to))
        return false;
    nevh__tree *tree = nevh__piece_tree(s, &one->value);
    double *kind = steps + (meaning == NEVH__MOMENTUM ? m->n : 0);
    bool fine = tree;
    size_t work = 0;
    for (size_t k = from; fine && k < to; k++)
        fine = set_step(
            s, m, one, tree,
            (nevh__index){one->head.index, (long)(k - first) + 1, &work},
            &kind[k]);
    nevh__tree_free(tree);
    return fine;
}

/* NAME: STEP */
static bool take_named_step(nevh_scene *s, nevh__scene_model *m,
                            const nevh__piece *part, double steps[]) {
    char stop;
    nevh__formula_error error;
    nevh__statement one = {.value = *part};
    if (!nevh__piece_split(s, &m->pool, &one.value, ":", &one.key, &stop))
        return false;
    if (!stop)
        return nevh__scene_fail(s, NEVH_EINVAL, part,
                                "gradient_step is auto, a number for all, or "
                                "NAME: STEP, ...");
    if (nevh__head_parse(one.key.text, &one.head, &error))
        return nevh__scene_fail_formula(s, &one.key, &error);
    bool fine = set_steps(s, m, &one, steps);
    nevh__head_free(&one.head);
    return fine;
}

static bool take_gradient_step(nevh_scene *s, nevh__scene_model *m,
                               const nevh__piece *v) {
    size_t count;
    if (strcmp(v->text, "auto") == 0)
        return true;
    if (!v->text[nevh__formula_extent(v->text, ":,")])
        return take_number(s, m, v, true, &m->run.gradient_step);
    nevh__piece *parts = nevh__piece_list(s, &m->pool, v, &count);
    double *steps = nevh__pool_take(&m->pool, 2 * m->n, sizeof *steps);
    if (!parts || !steps)
        return nevh__scene_no_memory(s);
    m->run.gradient_steps = steps;
    for (size_t i = 0; i < count; i++)
        if (!take_named_step(s, m, &parts[i], steps))
            return false;
    return true;
}

static bool take_energy_scale(nevh_scene *s, nevh__scene_model *m,
                              const nevh__piece *v) {
    return take_number(s, m, v, true, &m->run.energy_scale);
}

static bool take_reference(nevh_scene *s, nevh__scene_model *m,
                           const nevh__piece *v) {
    m->run.reference = v->text;
    return strcmp(v->text, "exact") == 0 || check_integrator(s, v);
}

static bool take_match(nevh_scene *s, nevh__scene_model *m,
                       const nevh__piece *v) {
    m->run.match_work = strcmp(v->text, "work") == 0;
    return m->run.match_work || strcmp(v->text, "steps") == 0 ||
           nevh__scene_fail(s, NEVH_EINVAL, v, "match is steps or work");
}

static bool take_transform(nevh_scene *s, nevh__scene_model *m,
                           const nevh__piece *v) {
    nevh__formula_error error = {0};
    if (s->transform)
        v = s->transform;
    m->run.transform = v->text;
    if (!nevh__piece_check(s, m, v, NEVH__READS_STATE))
        return false;
    nevh__tree *tree = nevh__piece_tree(s, v);
    m->transform = nevh_system_new(m->n);
    if (!tree || !m->transform) {
        nevh__tree_free(tree);
        return nevh__scene_no_memory(s);
    }
    m->transform->names = (const char *const *)m->coordinate_names;
    int status = nevh__tree_add_terms(tree, m->names, m->transform, "transform",
                                      &m->owned_transform, &error);
    nevh__tree_free(tree);
    return !status || nevh__scene_fail_formula(s, v, &error);
}

/* FORMULA < VALUE, or with > */
static bool take_stop(nevh_scene *s, nevh__scene_model *m,
                      const nevh__piece *v) {
    nevh__piece rest = *v, formula;
    char stop;
    if (!nevh__piece_split(s, &m->pool, &rest, "<>", &formula, &stop))
        return false;
    if (!stop)
        return nevh__scene_fail(s, NEVH_EINVAL, v,
                                "stop is written FORMULA < VALUE, or with >");
    m->stop.text = v->text;
    m->stop.below = stop == '<';
    return nevh__formula_check(s, m, &formula, &m->stop.formula) &&
           nevh__piece_number(s, m, &rest, &m->stop.value);
}

static bool take_native(nevh_scene *s, nevh__scene_model *m,
                        const nevh__piece *v) {
    static const char *const words[] = {"auto", "always", "never"};
    for (size_t i = 0; i < 3; i++)
        if (strcmp(v->text, words[i]) == 0) {
            m->run.native = (nevh_native_use)i;
            return true;
        }
    return nevh__scene_fail_word(s, v, "setting of native", v->text, words, 3);
}

static bool take_substeps(nevh_scene *s, nevh__scene_model *m,
                          const nevh__piece *v) {
    double number;
    if (!nevh__piece_number(s, m, v, &number))
        return false;
    bool fits = number >= 1 && number <= 10000 && number == floor(number);
    m->run.substeps = fits ? (size_t)number : 0;
    return fits || nevh__scene_fail(s, NEVH_EINVAL, v,
                                    "this must be a whole number from 1 to "
                                    "10000, not %.9g",
                                    number);
}

#define RUN_KEYS(X)                                                            \
    X(t_start)                                                                 \
    X(t_end)                                                                   \
    X(dt)                                                                      \
    X(integrators)                                                             \
    X(gradient)                                                                \
    X(gradient_step)                                                           \
    X(reference)                                                               \
    X(transform)                                                               \
    X(match)                                                                   \
    X(tolerance)                                                               \
    X(energy_scale)                                                            \
    X(native)                                                                  \
    X(substeps)                                                                \
    X(stop)
#define RUN_NAME(key) #key,
#define RUN_TAKE(key) take_##key,
static const char *const run_keys[] = {RUN_KEYS(RUN_NAME)};
static bool (*const run_takers[])(nevh_scene *, nevh__scene_model *,
                                  const nevh__piece *) = {RUN_KEYS(RUN_TAKE)};
static const char *const scene_keys[] = {"title", "source", "effects"};

size_t nevh__statement_key(nevh_scene *s, const nevh__statement *statement,
                           const char *const keys[], size_t count) {
    const char *name = statement->head.name;
    size_t k = 0;
    if (!nevh__head_plain(s, statement))
        return count;
    for (const nevh__statement *one = s->statements; one < statement; one++)
        if (one->section == statement->section &&
            one->title == statement->title &&
            strcmp(one->head.name, name) == 0) {
            nevh__scene_fail(s, NEVH_EINVAL, &statement->key,
                             "%s is there already, in line %zu", name,
                             one->key.line->number);
            return count;
        }
    while (k < count && strcmp(keys[k], name) != 0)
        k++;
    if (k == count)
        nevh__scene_fail_word(s, &statement->key, "setting", name, keys, count);
    return k;
}

static bool take_setting(nevh_scene *s, nevh__scene_model *m,
                         const nevh__statement *statement) {
    const size_t count = sizeof run_keys / sizeof *run_keys;
    size_t k = nevh__statement_key(s, statement, run_keys, count);
    return k < count && run_takers[k](s, m, &statement->value);
}

static bool check_heading(nevh_scene *s, nevh__scene_model *m,
                          const nevh__statement *statement) {
    (void)m;
    return nevh__statement_key(s, statement, scene_keys, 3) < 3;
}

bool nevh__model_run(nevh_scene *s, nevh__scene_model *m) {
    static const double tolerances[] = {1e-6, 1e-9, 1e-12};
    static const char *const gradients[] = {"central4"};
    m->run = (nevh_scene_run){.t_end = NAN,
                              .gradients = 1,
                              .gradient = gradients,
                              .tolerances = 3,
                              .tolerance = tolerances};
    return nevh__scene_each(s, m, NEVH__SCENE, check_heading) &&
           nevh__scene_each(s, m, NEVH__RUN, take_setting) &&
           (!s->transform || m->transform ||
            take_transform(s, m, s->transform));
}

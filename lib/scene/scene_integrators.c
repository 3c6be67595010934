/* nevh: schemes that a scene brings, [integrator NAME].

   What was made of numbers is kept as long as the scene: a model that is made anew
   with the same numbers has the same schemes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <nevh/extend.h>
#include <math.h>
#include <string.h>

enum { KICK, DRIFT, A, B, C, STEP, LISTS };
static const char letters[LISTS + 1] = "kdabcs";
static const char *const keys[] = {"kick", "drift",   "a",    "b",
                                   "c",    "compose", "first"};
enum { FIRST = LISTS, KEYS };

/* Numbers of a line, and the text of each; of a its rows. */
typedef struct {
    const nevh__statement *from; /* NULL: not given */
    nevh__piece *parts;
    long double *numbers;
    size_t count, n_parts;
} list;

typedef struct {
    const nevh__piece *title;
    list lists[LISTS];
    const nevh__statement *any; /* the first line */
    nevh_scheme_table table;
    nevh__piece base;
} section;

struct nevh__scheme {
    struct nevh__scheme *next;
    const nevh__piece *title;
    const nevh_integrator *base;
    size_t count[LISTS];
    long double *numbers[LISTS];
    nevh_integrator *scheme;
};

void nevh__scene_forget_integrators(nevh_scene *s) {
    for (struct nevh__scheme *x = s->schemes; x; x = x->next)
        nevh_integrator_free(x->scheme);
    s->schemes = NULL;
}

static bool take_number(nevh_scene *s, const nevh__scene_model *m,
                        const nevh__piece *part, long double *to) {
    nevh__rounded value;
    if (!part->text[0])
        return nevh__scene_fail(s, NEVH_EINVAL, part,
                                "a number is missing here");
    if (!nevh__piece_wide(s, m, part, &value))
        return false;
    *to = (long double)value.value;
    return true;
}

static bool scene_integrators_take_numbers(nevh_scene *s, nevh__scene_model *m,
                                           const nevh__piece *value, list *to) {
    to->parts = nevh__piece_list(s, &m->pool, value, &to->count);
    if (!to->parts)
        return false;
    to->n_parts = to->count;
    to->numbers = nevh__pool_take(&m->pool, to->count, sizeof *to->numbers);
    if (!to->numbers)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < to->count; i++)
        if (!take_number(s, m, &to->parts[i], &to->numbers[i]))
            return false;
    return true;
}

/* The rows of a. */
static nevh__piece *cut_rows(nevh_scene *s, nevh__scene_model *m,
                             const nevh__piece *value, size_t *count) {
    nevh__piece rest = *value;
    size_t most = 1;
    char stop = ';';
    for (const char *at = value->text; *at; at++)
        most += *at == ';';
    nevh__piece *rows = nevh__pool_take(&m->pool, most, sizeof *rows);
    if (!rows)
        nevh__scene_no_memory(s);
    for (*count = 0; rows && stop && *count < most; ++*count)
        if (!nevh__piece_split(s, &m->pool, &rest, ";", &rows[*count], &stop))
            return NULL;
    return rows;
}

/* Rows have all stages, or those up to their own, or those before their own. */
static size_t length_due(const list rows[], size_t stages, size_t i) {
    bool before = rows[stages - 1].count + 1 == stages;
    if (before)
        return i > 0 ? i : rows[0].count > 0;
    return rows[0].count == stages ? stages : i + 1;
}

static bool take_row(nevh_scene *s, nevh__scene_model *m, const list *all,
                     size_t i, list *row) {
    const nevh__piece *part = &all->parts[i];
    return (!part->text[0] && i == 0 && all->n_parts > 1) ||
           scene_integrators_take_numbers(s, m, part, row);
}

static bool fill_rows(nevh_scene *s, const list rows[], list *to) {
    size_t stages = to->n_parts;
    for (size_t i = 0; i < stages; i++) {
        size_t due = length_due(rows, stages, i);
        if (rows[i].count != due)
            return nevh__scene_fail(s, NEVH_EINVAL, &to->parts[i],
                                    "row %zu of a has %zu number%s, not %zu",
                                    i + 1, rows[i].count,
                                    rows[i].count == 1 ? "" : "s", due);
        for (size_t j = 0; j < due; j++)
            to->numbers[i * stages + j] = rows[i].numbers[j];
    }
    return true;
}

static bool take_matrix(nevh_scene *s, nevh__scene_model *m, section *x) {
    list *to = &x->lists[A];
    to->parts = cut_rows(s, m, &to->from->value, &to->n_parts);
    if (!to->parts)
        return false;
    size_t stages = to->n_parts;
    if (stages > NEVH_MOST_STAGES)
        return nevh__scene_fail(s, NEVH_EINVAL, &to->from->value,
                                "%zu stages, where %d are possible", stages,
                                NEVH_MOST_STAGES);
    to->count = stages * stages;
    to->numbers = nevh__pool_take(&m->pool, to->count, sizeof *to->numbers);
    list *rows = nevh__pool_take(&m->pool, stages, sizeof *rows);
    if (!to->numbers || !rows)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < stages; i++)
        if (!take_row(s, m, to, i, &rows[i]))
            return false;
    return fill_rows(s, rows, to);
}

/* A scheme that stands further up, or one of nevh. */
static const nevh_integrator *scheme_before(const nevh_scene *s,
                                            const nevh__scene_model *m,
                                            const nevh__piece *title,
                                            const char *name) {
    for (size_t i = 0; i < s->n_titles && &s->titles[i] < title; i++)
        if (strcmp(s->titles[i].text, name) == 0)
            return m->schemes[i];
    return nevh_integrator_named(name);
}

/* BASE: w1, w2, ... */
static bool take_composition(nevh_scene *s, nevh__scene_model *m, section *x) {
    list *to = &x->lists[STEP];
    nevh__piece rest = to->from->value;
    char stop;
    if (!nevh__piece_split(s, &m->pool, &rest, ":", &x->base, &stop))
        return false;
    if (!stop)
        return nevh__scene_fail(s, NEVH_EINVAL, &to->from->value,
                                "compose is written INTEGRATOR: WEIGHT, "
                                "WEIGHT, ...");
    x->table.base = scheme_before(s, m, x->title, x->base.text);
    if (!x->table.base)
        return nevh__scene_fail_integrator(s, &x->base, x->base.text);
    return scene_integrators_take_numbers(s, m, &rest, to);
}

static bool scene_integrators_take_first(nevh_scene *s, section *x,
                                         const nevh__piece *value) {
    static const char *const words[] = {"kick", "drift"};
    for (size_t i = 0; i < 2; i++)
        if (strcmp(value->text, words[i]) == 0) {
            x->table.first = i ? NEVH_DRIFT : NEVH_KICK;
            return true;
        }
    return nevh__scene_fail_word(s, value, "setting of first", value->text,
                                 words, 2);
}

static bool take_line(nevh_scene *s, nevh__scene_model *m, section *x,
                      const nevh__statement *line) {
    size_t k = nevh__statement_key(s, line, keys, KEYS);
    if (!x->any)
        x->any = line;
    if (k >= KEYS)
        return false;
    if (k == FIRST)
        return scene_integrators_take_first(s, x, &line->value);
    x->lists[k].from = line;
    return k == A      ? take_matrix(s, m, x)
           : k == STEP ? take_composition(s, m, x)
                       : scene_integrators_take_numbers(s, m, &line->value,
                                                        &x->lists[k]);
}

/* As many as a has rows. */
static bool check_length(nevh_scene *s, const section *x, int k) {
    const list *one = &x->lists[k];
    size_t stages = x->lists[A].n_parts;
    return !one->from || one->count == stages ||
           nevh__scene_fail(s, NEVH_EINVAL, &one->from->value,
                            "%s has %zu number%s, where a has %zu row%s",
                            keys[k], one->count, one->count == 1 ? "" : "s",
                            stages, stages == 1 ? "" : "s");
}

static bool check_lists(nevh_scene *s, const section *x) {
    const list *a = &x->lists[A], *b = &x->lists[B], *c = &x->lists[C];
    if (a->from && b->from)
        return check_length(s, x, B) && check_length(s, x, C);
    if (!a->from && !b->from && !c->from)
        return true;
    return nevh__scene_fail(s, NEVH_EINVAL, &x->any->key,
                            "%s of [integrator %s] is missing: a Runge-Kutta "
                            "method has a and b",
                            a->from ? "b" : "a", x->title->text);
}

static void fill_table(section *x) {
    const list *of = x->lists;
    x->table.name = x->title->text;
    x->table.kicks = of[KICK].count;
    x->table.kick = of[KICK].numbers;
    x->table.drifts = of[DRIFT].count;
    x->table.drift = of[DRIFT].numbers;
    x->table.stages = of[A].n_parts;
    x->table.a = of[A].numbers;
    x->table.b = of[B].numbers;
    x->table.c = of[C].numbers;
    x->table.steps = of[STEP].count;
    x->table.step = of[STEP].numbers;
}

/* The text at fault. */
static const nevh__piece *
scene_integrators_place_of(const section *x, const nevh_table_error *error) {
    const char *letter = error->list ? strchr(letters, error->list) : NULL;
    const list *one = letter ? &x->lists[letter - letters] : NULL;
    if (one == &x->lists[C] && !one->from)
        one = &x->lists[A];
    if (one && one->from && error->index < one->n_parts)
        return &one->parts[error->index];
    if (one && one->from)
        return &one->from->value;
    return x->any ? &x->any->key : x->title;
}

static bool is_made_of(const struct nevh__scheme *made, const section *x) {
    bool same = made->title == x->title && made->base == x->table.base;
    for (size_t k = 0; same && k < LISTS; k++) {
        same = made->count[k] == x->lists[k].count;
        for (size_t i = 0; same && i < made->count[k]; i++)
            same = made->numbers[k][i] == x->lists[k].numbers[i];
    }
    return same;
}

/* Notes the numbers, without a scheme; NULL when memory is out. */
static struct nevh__scheme *note(nevh_scene *s, const section *x) {
    struct nevh__scheme *to = nevh__pool_take(&s->pool, 1, sizeof *to);
    for (size_t k = 0; to && k < LISTS; k++) {
        size_t count = to->count[k] = x->lists[k].count;
        to->numbers[k] =
            nevh__pool_take(&s->pool, count + 1, sizeof *to->numbers[k]);
        if (!to->numbers[k])
            return NULL;
        for (size_t i = 0; i < count; i++)
            to->numbers[k][i] = x->lists[k].numbers[i];
    }
    if (to) {
        to->title = x->title;
        to->base = x->table.base;
    }
    return to;
}

static const nevh_integrator *scene_integrators_make(nevh_scene *s,
                                                     const section *x) {
    nevh_table_error error = {0};
    for (const struct nevh__scheme *i = s->schemes; i; i = i->next)
        if (is_made_of(i, x))
            return i->scheme;
    struct nevh__scheme *made = note(s, x);
    nevh_integrator *scheme =
        made ? nevh_integrator_new(&x->table, &error) : NULL;
    if (!made || error.status == NEVH_ENOMEM)
        nevh__scene_no_memory(s);
    else if (!scheme)
        nevh__scene_fail(s, error.status, scene_integrators_place_of(x, &error),
                         "%s", error.text);
    if (!scheme)
        return NULL;
    made->scheme = scheme;
    made->next = s->schemes;
    s->schemes = made;
    return scheme;
}

static bool check_title(nevh_scene *s, const nevh__piece *title) {
    if (nevh_integrator_named(title->text) || strcmp(title->text, "exact") == 0)
        return nevh__scene_fail(s, NEVH_EINVAL, title,
                                "%s means something else already: take another "
                                "name",
                                title->text);
    for (const nevh__piece *one = s->titles; one < title; one++)
        if (strcmp(one->text, title->text) == 0)
            return nevh__scene_fail(
                s, NEVH_EINVAL, title,
                "[integrator %s] is there already, in line %zu", title->text,
                one->line->number);
    return true;
}

/* Members of an ensemble are run with one scheme. */
static bool check_same(nevh_scene *s, const section *x,
                       const nevh_integrator *before,
                       const nevh_integrator *now) {
    return !s->overrides || before == now ||
           nevh__scene_fail(s, NEVH_EINVAL, x->title,
                            "the weights of %s depend on a parameter that is "
                            "varied: all members take the same steps",
                            x->title->text);
}

static bool take_section(nevh_scene *s, nevh__scene_model *m, size_t i) {
    section x = {.title = &s->titles[i]};
    if (!check_title(s, x.title))
        return false;
    for (size_t k = 0; k < s->n_statements; k++)
        if (s->statements[k].title == x.title &&
            !take_line(s, m, &x, &s->statements[k]))
            return false;
    if (!check_lists(s, &x))
        return false;
    fill_table(&x);
    m->schemes[i] = scene_integrators_make(s, &x);
    return m->schemes[i] &&
           check_same(s, &x, s->model ? s->model->schemes[i] : NULL,
                      m->schemes[i]);
}

/* Weights have all digits, whatever terms have. */
bool nevh__model_integrators(nevh_scene *s, nevh__scene_model *m) {
    bool exact = m->names->exact, fine = true;
    m->schemes = nevh__pool_take(&m->pool, s->n_titles + 1, sizeof *m->schemes);
    if (!m->schemes)
        return nevh__scene_no_memory(s);
    m->names->exact = true;
    for (size_t i = 0; fine && i < s->n_titles; i++)
        fine = take_section(s, m, i);
    m->names->exact = exact;
    return fine;
}

const nevh_integrator *nevh_scene_integrator(const nevh_scene *s, size_t i) {
    return s && s->model && i < s->n_titles ? s->model->schemes[i] : NULL;
}

const nevh_integrator *nevh_scene_integrator_named(const nevh_scene *s,
                                                   const char *name) {
    for (size_t i = 0; name && nevh_scene_integrator(s, i); i++)
        if (strcmp(s->titles[i].text, name) == 0)
            return nevh_scene_integrator(s, i);
    return nevh_integrator_named(name);
}

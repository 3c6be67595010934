/* nevh: [sections].
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <string.h>

static bool is_direction(const char *word, int *direction) {
    static const char *const known[] = {"falling", "both", "rising"};
    for (int i = 0; i < 3; i++) {
        *direction = i - 1;
        if (strcmp(word, known[i]) == 0)
            return true;
    }
    return false;
}

/* FORMULA rising */
static bool has_comma(nevh_scene *s, const nevh__piece *value) {
    const char *blank = strrchr(value->text, ' ');
    int ignored;
    return !blank || !is_direction(blank + 1, &ignored) ||
           nevh__scene_fail(s, NEVH_EINVAL, value,
                            "a comma is missing before \"%s\"", blank + 1);
}

static bool take_direction(nevh_scene *s, const nevh__piece *word,
                           const nevh__piece *missing, int *direction) {
    if (is_direction(word->text, direction))
        return true;
    return nevh__scene_fail(s, NEVH_EINVAL, word->text[0] ? word : missing,
                            "a section says rising, falling or both");
}

/* The period of the coordinate that a text names, as x or x[3]; 0 when it is
   none.  False when memory is out. */
static bool find_period(nevh_scene *s, const nevh__scene_model *m,
                        const char *text, double *period) {
    nevh__formula_error error;
    nevh__head head;
    size_t count, first;
    long index = 1;
    int status = nevh__head_parse(text, &head, &error);
    *period = 0;
    if (status)
        return status != NEVH_ENOMEM || nevh__scene_no_memory(s);
    nevh__meaning meaning =
        nevh__names_find(m->names, head.name, &count, &first);
    bool element = head.from && !head.to;
    if (element)
        status = nevh__tree_integer(head.from, m->names, NULL, &index, &error);
    if (meaning == NEVH__COORDINATE && element == (count > 0) && !status)
        *period = m->period[first + (size_t)index - 1];
    nevh__head_free(&head);
    return status != NEVH_ENOMEM || nevh__scene_no_memory(s);
}

/* FORMULA = FORMULA, rising */
static bool take_when(nevh_scene *s, nevh__scene_model *m, nevh__piece *rest,
                      nevh__crossing *crossing) {
    nevh__piece left, right;
    char stop;
    if (!nevh__piece_split(s, &m->pool, rest, "=", &left, &stop))
        return false;
    if (!stop)
        return nevh__scene_fail(s, NEVH_EINVAL, &left,
                                "\"=\" is missing: when FORMULA = VALUE, "
                                "rising: ...");
    if (!nevh__piece_split(s, &m->pool, rest, ",", &right, &stop) ||
        !nevh__formula_check(s, m, &left, &crossing->left) ||
        !has_comma(s, &right) ||
        !nevh__formula_check(s, m, &right, &crossing->right))
        return false;
    crossing->decl.left = left.text;
    crossing->decl.right = right.text;
    return find_period(s, m, left.text, &crossing->decl.period) &&
           take_direction(s, rest, &right, &crossing->decl.direction);
}

static bool take_every(nevh_scene *s, nevh__scene_model *m,
                       const nevh__piece *value, nevh__crossing *crossing) {
    double *every = &crossing->decl.every;
    if (!nevh__piece_number(s, m, value, every))
        return false;
    crossing->decl.direction = 1;
    crossing->decl.period = *every;
    return *every > 0 ||
           nevh__scene_fail(s, NEVH_EINVAL, value,
                            "this must be greater than 0, not %g", *every);
}

/* The formulas after the colon, and their texts. */
static bool take_items(nevh_scene *s, nevh__scene_model *m,
                       const nevh__piece *list, nevh__crossing *crossing) {
    size_t count = 0;
    crossing->items = nevh__formula_list(s, m, list, &count);
    if (!crossing->items)
        return false;
    const char **texts = nevh__pool_take(&m->pool, count, sizeof *texts);
    if (!texts)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < count; i++) {
        texts[i] = crossing->items[i].piece.text;
        if (strcmp(texts[i], "section") == 0 ||
            strcmp(texts[i], "direction") == 0)
            return nevh__scene_fail(s, NEVH_EINVAL, &crossing->items[i].piece,
                                    "%s is a column of every section: write "
                                    "(%s)",
                                    texts[i], texts[i]);
    }
    crossing->decl.items = count;
    crossing->decl.item = texts;
    return true;
}

/* when FORMULA = FORMULA, rising: LIST, or every FORMULA: LIST */
static bool add_section(nevh_scene *s, nevh__scene_model *m,
                        const nevh__statement *statement) {
    nevh__crossing *crossing = &m->crossings[m->n_crossings++];
    nevh__piece shown = statement->value, front, condition;
    char stop;
    crossing->decl.name = statement->head.name;
    if (!nevh__head_plain(s, statement) ||
        !nevh__piece_split(s, &m->pool, &shown, ":", &front, &stop))
        return false;
    size_t word = strcspn(front.text, " \t"),
           at = (size_t)(front.at - front.line->text);
    bool when = word == 4 && strncmp(front.text, "when", word) == 0;
    bool every = word == 5 && strncmp(front.text, "every", word) == 0;
    if (!stop || (!when && !every))
        return nevh__scene_fail(s, NEVH_EINVAL, &statement->value,
                                "a section is written when FORMULA = VALUE, "
                                "rising: ..., or every TIME: ...");
    return nevh__piece_take(s, &m->pool, front.line, at + word,
                            at + strlen(front.text), &condition) &&
           (when ? take_when(s, m, &condition, crossing)
                 : take_every(s, m, &condition, crossing)) &&
           take_items(s, m, &shown, crossing);
}

bool nevh__model_crossings(nevh_scene *s, nevh__scene_model *m) {
    m->crossings =
        nevh__pool_take(&m->pool, s->n_statements, sizeof *m->crossings);
    return m->crossings ? nevh__scene_each(s, m, NEVH__SECTIONS, add_section)
                        : nevh__scene_no_memory(s);
}

size_t nevh_scene_section_count(const nevh_scene *s) {
    if (!s)
        return 0;
    return s->model ? s->model->n_crossings : 0;
}

const nevh_scene_section *nevh_scene_section_at(nevh_scene *s, size_t i) {
    if (!s)
        return NULL;
    return i < nevh_scene_section_count(s) ? &s->model->crossings[i].decl
                                           : NULL;
}

int nevh_scene_section_cross(nevh_scene *s, size_t i, double t,
                             const double q[], const double p[],
                             double *value) {
    if (!s)
        return NEVH_EINVAL;
    double left = t, right;
    nevh__state at = {t, q, p, false};
    if (!nevh__scene_begin(s))
        return s->status;
    if (i >= s->model->n_crossings)
        return NEVH_EINVAL;
    nevh__crossing *crossing = &s->model->crossings[i];
    if (crossing->decl.every > 0)
        right = s->model->run.t_start;
    else if (!nevh__formula_value(s, &crossing->left, &at, &left) ||
             !nevh__formula_value(s, &crossing->right, &at, &right))
        return s->status;
    *value = left - right;
    return NEVH_OK;
}

int nevh_scene_section_items(nevh_scene *s, size_t i, double t,
                             const double q[], const double p[],
                             double values[]) {
    if (!nevh__scene_begin(s))
        return nevh__scene_fault(s);
    if (i >= s->model->n_crossings)
        return NEVH_EINVAL;
    nevh__crossing *crossing = &s->model->crossings[i];
    nevh__formula_values(s, crossing->items, crossing->decl.items,
                         (nevh__state){t, q, p, false}, values);
    return s->status;
}

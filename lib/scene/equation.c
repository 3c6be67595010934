/* nevh: the lines of a scene that say what H is, and their formulas.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <stdlib.h>
#include <string.h>

static const char *section_of(const nevh__statement *one) {
    switch (one->section) {
    case NEVH__PARAMETERS:
        return "parameters";
    case NEVH__COORDINATES:
        return "coordinates";
    case NEVH__DEFINITIONS:
        return "definitions";
    case NEVH__EFFECTS:
        return "effects";
    case NEVH__FRICTION:
        return "friction";
    default:
        return NULL;
    }
}

/* The i-th statement that is one; NULL when i is out of range.  A line that
   several names share is one. */
static const nevh__statement *equation_find(const nevh_scene *s, size_t i) {
    size_t count = s ? s->n_statements : 0;
    for (size_t k = 0; k < count; k++)
        if (section_of(&s->statements[k]) && s->statements[k].member == 0 &&
            i-- == 0)
            return &s->statements[k];
    return NULL;
}

size_t nevh_scene_equation_count(const nevh_scene *s) {
    size_t i = 0;
    while (equation_find(s, i))
        i++;
    return i;
}

/* The statement of a value that was set, in place of the one written. */
static const nevh__statement *given(const nevh_scene *s,
                                    const nevh__statement *one) {
    const nevh__statement *set = one->section == NEVH__PARAMETERS
                                     ? nevh__scene_assignment(s, one->head.name)
                                     : NULL;
    return set ? set : one;
}

nevh_scene_equation nevh_scene_equation_at(const nevh_scene *s, size_t i) {
    const nevh__statement *one = equation_find(s, i);
    if (!one)
        return (nevh_scene_equation){0};
    bool switched =
        one->section == NEVH__EFFECTS || one->section == NEVH__FRICTION;
    const nevh__switch *effect =
        switched ? nevh__scene_effect(s, one->key.text) : NULL;
    return (nevh_scene_equation){.section = section_of(one),
                                 .name = one->key.text,
                                 .value = given(s, one)->value.text,
                                 .on = !effect || effect->on};
}

/* True if a text has a word, and then a parenthesis. */
static bool calls(const char *text, const char *word) {
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz"
                                  "ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
    size_t bytes = strlen(word);
    for (const char *at = text; (at = strstr(at, word)); at += bytes) {
        const char *after = at + bytes + strspn(at + bytes, " \t");
        bool begins = at == text || (!strchr(letters, at[-1]) &&
                                     (unsigned char)at[-1] < 0x80);
        if (begins && *after == '(')
            return true;
    }
    return false;
}

const char *nevh_scene_gsl_function(const nevh_scene *s, size_t i) {
    for (unsigned f = 0; f < NEVH__OPERATION_COUNT; f++) {
        const nevh__operation_traits *o = nevh__operation_of(f);
        bool called = false;
        for (size_t k = 0; o->kind == NEVH__KIND_GSL && !called; k++) {
            nevh_scene_equation line = nevh_scene_equation_at(s, k);
            if (!line.section)
                break;
            called = line.on && calls(line.value, o->name);
        }
        if (called && i-- == 0)
            return o->name;
    }
    return NULL;
}

/* One formula, after which nothing or a setting follows: "0 ; period 2*pi". */
static nevh__tree *parse(const nevh__statement *one) {
    const char *text = one->value.text;
    size_t bytes = nevh__formula_extent(text, ",;");
    nevh__formula_error error = {0};
    if (text[bytes] == ',' || strpbrk(text, "\":") || one->group > 1 ||
        strchr(one->key.text, '['))
        return NULL;
    char *formula = malloc(bytes + 1);
    if (!formula)
        return NULL;
    memcpy(formula, text, bytes);
    formula[bytes] = '\0';
    nevh__tree *tree = nevh__tree_parse(formula, &error);
    free(formula);
    return tree;
}

char *nevh_scene_equation_mathml(const nevh_scene *s, size_t i) {
    const nevh__statement *one = equation_find(s, i);
    nevh__tree *tree = one ? parse(given(s, one)) : NULL;
    char *text = tree ? nevh__equation_mathml(one->key.text, tree) : NULL;
    nevh__tree_free(tree);
    return text;
}

/* nevh: names that are not known, and what may have been meant.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <string.h>

enum { WORD = NEVH__NAME_LENGTH + 2 }; /* with p_ */

static int lower(char c) {
    return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c;
}

static size_t least(size_t a, size_t b) {
    return a < b ? a : b;
}

size_t nevh__words_apart(const char *from, const char *to) {
    size_t rows[3][WORD + 1], *before = rows[0], *above = rows[1],
                              *row = rows[2];
    size_t length = strlen(to);
    if (length > WORD || strlen(from) > WORD)
        return SIZE_MAX;
    for (size_t j = 0; j <= length; j++)
        above[j] = j;
    for (size_t i = 1; from[i - 1]; i++) {
        row[0] = i;
        for (size_t j = 1; j <= length; j++) {
            int a = lower(from[i - 1]), b = lower(to[j - 1]);
            row[j] = least(above[j], row[j - 1]) + 1;
            row[j] = least(row[j], above[j - 1] + (a != b));
            if (i > 1 && j > 1 && a == lower(to[j - 2]) &&
                b == lower(from[i - 2]))
                row[j] = least(row[j], before[j - 2] + 1);
        }
        size_t *free_row = before;
        before = above;
        above = row;
        row = free_row;
    }
    return above[length];
}

typedef struct {
    const char *word;
    char best[WORD + 1];
    size_t distance; /* of the best; only smaller ones are taken */
} search;

static void try_name(search *s, const char *prefix, const char *name) {
    char whole[WORD + 1] = "";
    if (strlen(prefix) + strlen(name) > WORD)
        return;
    strcat(strcat(whole, prefix), name);
    size_t far = nevh__words_apart(s->word, whole);
    if (far >= s->distance)
        return;
    s->distance = far;
    memcpy(s->best, whole, sizeof whole);
}

static void try_functions(search *s) {
    for (nevh__tape_operation i = NEVH__SIN; i < NEVH__OPERATION_COUNT; i++)
        try_name(s, "", nevh__operation_name(i));
    try_name(s, "", "sum");
}

static void try_names(search *s, const nevh__names *names,
                      const nevh__bound *bound) {
    for (size_t i = 0; i < names->count; i++) {
        const nevh__entry *entry = &names->entries[i];
        try_name(s, "", entry->name);
        if (entry->meaning == NEVH__COORDINATE)
            try_name(s, "p_", entry->name);
    }
    for (; bound; bound = bound->outer)
        try_name(s, "", bound->name);
    try_name(s, "", "pi");
    try_name(s, "", "t");
}

/* The coordinate whose momentum (px) or velocity was meant, or NULL. */
static const char *coordinate_of(const nevh__names *names, const char *word) {
    const char *only = NULL;
    size_t count = 0;
    for (size_t i = 0; i < names->count; i++) {
        if (names->entries[i].meaning != NEVH__COORDINATE)
            continue;
        only = names->entries[i].name;
        if (strcmp(only, word + 1) == 0)
            return only;
        count++;
    }
    return word[1] == '\0' && count == 1 ? only : NULL;
}

static bool suggest_fail(const nevh__syntax_node *node,
                         nevh__formula_error *error, const char *format,
                         const char *a, const char *b) {
    return nevh__formula_fail(error, NEVH_EINVAL, node->column,
                              nevh__characters(node->name), format, a, b);
}

static bool refuse_call(const nevh__names *names, const nevh__syntax_node *node,
                        search *s, nevh__formula_error *error) {
    nevh__meaning meaning;
    bool known = nevh__entry_named(names, node->name, &meaning) ||
                 strcmp(node->name, "t") == 0 || strcmp(node->name, "pi") == 0;
    if (known)
        return suggest_fail(
            node, error, "%s is not a function; for a product write %s*(...)",
            node->name, node->name);
    try_functions(s);
    return suggest_fail(node, error,
                        s->best[0] ? "there is no function %s; did you mean %s?"
                                   : "there is no function %s",
                        node->name, s->best);
}

/* The coordinate of p_x or v_x that does not exist. */
static bool refuse_prefixed(const nevh__syntax_node *node, const search *s,
                            nevh__formula_error *error) {
    return nevh__formula_fail(
        error, NEVH_EINVAL, node->column, nevh__characters(node->name),
        s->best[0] ? "there is no coordinate %s; did you mean %s?"
                   : "there is no coordinate %s, so %s is not known",
        node->name + 2, s->best[0] ? s->best : node->name);
}

bool nevh__refuse_name(const nevh__names *names, const nevh__bound *bound,
                       const nevh__syntax_node *node, bool in_index,
                       nevh__formula_error *error) {
    const char *name = node->name;
    size_t length = nevh__characters(name);
    search s = {.word = name};
    s.distance = length < 3 ? length : (length + 1) / 3 + 1;
    if (node->kind == NEVH__NODE_CALL)
        return refuse_call(names, node, &s, error);
    if (strcmp(name, "e") == 0)
        return suggest_fail(node, error,
                            "%s is not defined; for Euler's number write %s",
                            name, "exp(1)");
    bool moves = name[0] == 'p' || name[0] == 'v';
    const char *coordinate = moves ? coordinate_of(names, name) : NULL;
    if (coordinate)
        return suggest_fail(node, error,
                            name[0] == 'p' ? "the momentum of %s is p_%s"
                                           : "the velocity of %s is v_%s",
                            coordinate, coordinate);
    try_names(&s, names, bound);
    if (moves && name[1] == '_' && name[2])
        return refuse_prefixed(node, &s, error);
    if (strcmp(name, "\xCF\x80") == 0)
        strcpy(s.best, "pi");
    if (in_index && !s.best[0])
        return suggest_fail(node, error, "the index %s is not known%s", name,
                            "; indices come from sum(i = 1..N, ...)");
    return suggest_fail(node, error,
                        s.best[0] ? "the name %s is not known; did you mean %s?"
                                  : "the name %s is not known",
                        name, s.best);
}

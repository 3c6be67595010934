/* nevh: parts of lines, and the formulas in them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <string.h>

static bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

bool nevh__piece_take(nevh_scene *s, nevh__pool *pool, const nevh__line *line,
                      size_t from, size_t to, nevh__piece *piece) {
    while (from < to && is_space(line->text[from]))
        from++;
    while (from < to && is_space(line->text[to - 1]))
        to--;
    char *copy = nevh__pool_take(pool, to - from + 1, 1);
    if (!copy)
        return nevh__scene_no_memory(s);
    memcpy(copy, line->text + from, to - from);
    *piece = (nevh__piece){line, line->text + from, copy};
    return true;
}

bool nevh__piece_split(nevh_scene *s, nevh__pool *pool, nevh__piece *rest,
                       const char *stops, nevh__piece *part, char *stop) {
    const nevh__line *line = rest->line;
    size_t from = (size_t)(rest->at - line->text);
    size_t end = from + strlen(rest->text);
    size_t to = from + nevh__formula_extent(rest->text, stops);
    *stop = rest->text[to - from];
    return nevh__piece_take(s, pool, line, from, to, part) &&
           nevh__piece_take(s, pool, line, to + (to < end), end, rest);
}

static size_t count_commas(const char *text) {
    size_t count = 0;
    for (; *text; text++)
        count += *text == ',';
    return count;
}

nevh__piece *nevh__piece_list(nevh_scene *s, nevh__pool *pool,
                              const nevh__piece *value, size_t *count) {
    const char *text = value->text;
    size_t from = (size_t)(value->at - value->line->text), at = 0;
    nevh__piece *parts =
        nevh__pool_take(pool, count_commas(text) + 1, sizeof *parts);
    if (!parts)
        nevh__scene_no_memory(s);
    for (*count = 0; parts;) {
        size_t end = at + nevh__formula_extent(text + at, ",");
        if (!nevh__piece_take(s, pool, value->line, from + at, from + end,
                              &parts[(*count)++]))
            return NULL;
        if (!text[end])
            return parts;
        at = end + 1;
    }
    return NULL;
}

bool nevh__piece_call(nevh_scene *s, nevh__pool *pool, const nevh__piece *value,
                      const char *name, nevh__piece **arguments,
                      size_t *count) {
    size_t bytes = strlen(name), length = strlen(value->text);
    size_t from = (size_t)(value->at - value->line->text);
    const char *open = value->text + bytes;
    *count = 0;
    if (strncmp(value->text, name, bytes) != 0)
        return true;
    open += strspn(open, " \t");
    if (*open != '(')
        return true;
    size_t begin = (size_t)(open - value->text) + 1;
    size_t end = begin + nevh__formula_extent(open + 1, ")");
    if (end + 1 != length) /* range(...) + 1, or an open parenthesis */
        return true;
    nevh__piece inside;
    if (!nevh__piece_take(s, pool, value->line, from + begin, from + end,
                          &inside))
        return false;
    *arguments = nevh__piece_list(s, pool, &inside, count);
    return *arguments;
}

size_t nevh__piece_column(const nevh__piece *piece) {
    size_t column = 1;
    for (const char *at = piece->line->text; at < piece->at; at++)
        column += ((unsigned char)*at & 0xC0) != 0x80;
    return column;
}

nevh__tree *nevh__piece_tree(nevh_scene *s, const nevh__piece *piece) {
    nevh__formula_error error;
    nevh__tree *tree = nevh__tree_parse(piece->text, &error);
    if (!tree)
        nevh__scene_fail_formula(s, piece, &error);
    return tree;
}

bool nevh__piece_number(nevh_scene *s, const nevh__scene_model *m,
                        const nevh__piece *piece, double *value) {
    nevh__formula_error error = {0};
    nevh__tree *tree = nevh__piece_tree(s, piece);
    if (!tree)
        return false;
    int status = nevh__tree_number(tree, m->names, NULL, value, &error);
    nevh__tree_free(tree);
    return !status || nevh__scene_fail_formula(s, piece, &error);
}

bool nevh__piece_wide(nevh_scene *s, const nevh__scene_model *m,
                      const nevh__piece *piece, nevh__rounded *value) {
    nevh__formula_error error = {0};
    nevh__tree *tree = nevh__piece_tree(s, piece);
    if (!tree)
        return false;
    int status = nevh__tree_wide(tree, m->names, NULL, value, &error);
    nevh__tree_free(tree);
    return !status || nevh__scene_fail_formula(s, piece, &error);
}

bool nevh__piece_check(nevh_scene *s, const nevh__scene_model *m,
                       const nevh__piece *piece, unsigned allowed) {
    nevh__formula_error error = {0};
    nevh__tree *tree = nevh__piece_tree(s, piece);
    if (!tree)
        return false;
    int status = nevh__tree_check(tree, m->names, allowed, NULL, &error);
    nevh__tree_free(tree);
    return !status || nevh__scene_fail_formula(s, piece, &error);
}

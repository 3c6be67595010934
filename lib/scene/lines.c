/* nevh: text to lines, sections and statements.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <string.h>

static const char *const section_names[NEVH__SECTION_COUNT] = {
    "scene",    "parameters", "coordinates", "definitions", "effects",
    "friction", "invariants", "observables", "picture",     "sections",
    "labels",   "parts",      "ensemble",    "run",         "integrator"};

static size_t line_bytes(const char *text, size_t left) {
    const char *end = memchr(text, '\n', left);
    return end ? (size_t)(end - text) : left;
}

static size_t count_lines(const char *text, size_t bytes) {
    size_t count = 1;
    for (size_t i = 0; i < bytes; i++)
        count += text[i] == '\n';
    return count;
}

/* True for NUL, and for characters that move a terminal's cursor or change its
   colours.  A form feed separates pages in some files. */
static bool is_control(uint32_t code) {
    return (code < ' ' && code != '\t' && code != '\f') ||
           (code >= 0x7F && code < 0xA0);
}

/* Refuses what is not UTF-8, and control characters. */
static bool check_characters(nevh_scene *s, const nevh__line *line) {
    size_t column = 1;
    uint32_t code;
    for (size_t i = 0; i < line->bytes; column++) {
        size_t bytes = nevh__character(line->text + i, &code);
        bool whole = bytes && i + bytes <= line->bytes;
        if (!whole || is_control(code))
            return nevh__scene_fail_at(
                s, NEVH_EINVAL, line, column, 1,
                !whole  ? "this is not UTF-8"
                : !code ? "a NUL character: is this text?"
                        : "a control character: is this text?");
        i += bytes;
    }
    return true;
}

static bool cut_lines(nevh_scene *s, const char *text, size_t bytes) {
    char *copy = nevh__pool_take(&s->pool, bytes + 1, 1);
    s->lines =
        nevh__pool_take(&s->pool, count_lines(text, bytes), sizeof *s->lines);
    if (!copy || !s->lines)
        return nevh__scene_no_memory(s);
    memcpy(copy, text, bytes);
    bool more = true;
    for (size_t at = 0; more && !s->status;) {
        size_t length = line_bytes(copy + at, bytes - at);
        nevh__line *line = &s->lines[s->n_lines++];
        more = at + length + 1 < bytes;
        *line = (nevh__line){s->n_lines, copy + at, length};
        while (line->bytes && line->text[line->bytes - 1] == '\r')
            line->bytes--;
        check_characters(s, line);
        at += length + 1;
    }
    return !s->status;
}

/* NAME of [integrator NAME]. */
static bool cut_title(nevh_scene *s, const nevh__piece *name,
                      const nevh__piece *rest) {
    if (!rest->text[0])
        return nevh__scene_fail(s, NEVH_EINVAL, name,
                                "an integrator has a name: [integrator NAME]");
    s->titles[s->n_titles++] = *rest;
    return true;
}

/* [NAME], or [integrator NAME] */
static bool cut_section(nevh_scene *s, const nevh__piece *all,
                        nevh__section_kind *section) {
    size_t bytes = strlen(all->text),
           from = (size_t)(all->at - all->line->text);
    if (bytes < 2 || all->text[bytes - 1] != ']')
        return nevh__scene_fail(s, NEVH_EINVAL, all,
                                "a section is a line of its own: [NAME]");
    nevh__piece name, rest;
    char stop;
    if (!nevh__piece_take(s, &s->pool, all->line, from + 1, from + bytes - 1,
                          &rest))
        return false;
    name = rest;
    if (strncmp(rest.text, "integrator", 10) == 0 &&
        !nevh__piece_split(s, &s->pool, &rest, " \t", &name, &stop))
        return false;
    for (size_t i = 0; i < NEVH__SECTION_COUNT; i++)
        if (strcmp(section_names[i], name.text) == 0) {
            *section = (nevh__section_kind)i;
            return *section != NEVH__INTEGRATOR || cut_title(s, &name, &rest);
        }
    return nevh__scene_fail_word(s, &name, "section", name.text, section_names,
                                 NEVH__SECTION_COUNT);
}

/* A key whose bracket is not closed has no end but the first "=". */
static bool cut_open_key(nevh_scene *s, const nevh__piece *all,
                         nevh__piece *key) {
    const char *end = strchr(all->text, '=');
    size_t from = (size_t)(all->at - all->line->text);
    if (!end)
        return nevh__scene_fail(s, NEVH_EINVAL, all,
                                "this is neither NAME = VALUE nor [SECTION]");
    return nevh__piece_take(s, &s->pool, all->line, from,
                            from + (size_t)(end - all->text), key);
}

static bool cut_key(nevh_scene *s, const nevh__piece *all,
                    nevh__statement *statement) {
    char stop;
    statement->value = *all;
    if (!nevh__piece_split(s, &s->pool, &statement->value, "=", &statement->key,
                           &stop) ||
        (!stop && !cut_open_key(s, all, &statement->key)))
        return false;
    nevh__formula_error error;
    if (nevh__head_parse(statement->key.text, &statement->head, &error))
        return nevh__scene_fail_formula(s, &statement->key, &error);
    return stop || nevh__scene_fail(s, NEVH_EINVAL, all, "\"=\" is missing");
}

/* NAME, NAME, NAME = VALUE: a statement for each. */
static bool cut_keys(nevh_scene *s, const nevh__piece *all,
                     nevh__section_kind section) {
    nevh__piece value = *all, left;
    nevh__formula_error error;
    size_t count = 1;
    char stop;
    if (!nevh__piece_split(s, &s->pool, &value, "=", &left, &stop))
        return false;
    nevh__piece *keys = nevh__piece_list(s, &s->pool, &left, &count);
    if (!keys)
        return false;
    if (count > NEVH__GROUP)
        return nevh__scene_fail(s, NEVH_EINVAL, &keys[NEVH__GROUP],
                                "no more than %d names stand before a \"=\"",
                                NEVH__GROUP);
    for (size_t i = 0; i < count; i++) {
        nevh__statement *one = &s->statements[s->n_statements++];
        *one = (nevh__statement){.section = section,
                                 .key = keys[i],
                                 .value = value,
                                 .group = count,
                                 .member = i};
        if (nevh__head_parse(one->key.text, &one->head, &error))
            return nevh__scene_fail_formula(s, &one->key, &error);
    }
    return stop || nevh__scene_fail(s, NEVH_EINVAL, all, "\"=\" is missing");
}

/* A line without its comment. */
static bool cut_comment(nevh_scene *s, const nevh__line *line,
                        nevh__piece *all) {
    const char *comment = memchr(line->text, '#', line->bytes);
    size_t end = comment ? (size_t)(comment - line->text) : line->bytes;
    return nevh__piece_take(s, &s->pool, line, 0, end, all);
}

bool nevh__statement_parse(nevh_scene *s, const nevh__line *line,
                           nevh__statement *statement) {
    nevh__piece all;
    return cut_comment(s, line, &all) && cut_key(s, &all, statement);
}

static bool cut_line(nevh_scene *s, const nevh__line *line, bool *begun,
                     nevh__section_kind *section) {
    nevh__piece all;
    if (!cut_comment(s, line, &all) || !all.text[0])
        return !s->status;
    if (all.text[0] == '[') {
        *begun = true;
        return cut_section(s, &all, section);
    }
    if (!*begun)
        return nevh__scene_fail(s, NEVH_EINVAL, &all,
                                "a section must come first, such as "
                                "[parameters]");
    if (*section == NEVH__COORDINATES &&
        all.text[nevh__formula_extent(all.text, ",=")] == ',')
        return cut_keys(s, &all, *section);
    nevh__statement *statement = &s->statements[s->n_statements++];
    statement->section = *section;
    if (*section == NEVH__INTEGRATOR)
        statement->title = &s->titles[s->n_titles - 1];
    return cut_key(s, &all, statement);
}

bool nevh__scene_cut(nevh_scene *s, const char *text, size_t bytes) {
    bool mark = bytes >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0;
    if (!cut_lines(s, text + 3 * mark, bytes - 3 * mark))
        return false;
    s->statements = nevh__pool_take(&s->pool, NEVH__GROUP * s->n_lines,
                                    sizeof *s->statements);
    s->titles = nevh__pool_take(&s->pool, s->n_lines, sizeof *s->titles);
    if (!s->statements || !s->titles)
        return nevh__scene_no_memory(s);
    bool begun = false;
    nevh__section_kind section = NEVH__SCENE;
    for (size_t i = 0; i < s->n_lines; i++)
        if (!cut_line(s, &s->lines[i], &begun, &section))
            return false;
    return true;
}

bool nevh__scene_each(nevh_scene *s, nevh__scene_model *m,
                      nevh__section_kind section, nevh__visitor visit) {
    for (size_t i = 0; i < s->n_statements; i++)
        if (s->statements[i].section == section &&
            !visit(s, m, &s->statements[i]))
            return false;
    return true;
}

/* nevh: FILE:LINE:COLUMN: error: ..., the line, and a caret.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include "system/print_private.h"
#include <stdio.h>
#include <string.h>

enum { SHOWN = 120, BEFORE = 60, TEXT = 500 }; /* characters of a line */

typedef struct {
    char *text;
    size_t size, used;
} buffer;

static void message_append(buffer *b, const char *bytes, size_t count) {
    size_t left = b->size - b->used - 1;
    count = count < left ? count : left;
    memcpy(b->text + b->used, bytes, count);
    b->used += count;
    b->text[b->used] = '\0';
}

/* Bytes of the character at `text`; one of what is none. */
static size_t message_step(const char *text) {
    uint32_t code;
    size_t bytes = nevh__character(text, &code);
    return bytes ? bytes : 1;
}

/* The text to print for a character: "?" for one that is not safe. */
static const char *message_shown(const char *at) {
    uint32_t code;
    bool control = (unsigned char)*at < ' ' && *at != '\t';
    bool broken = nevh__character(at, &code) == 0;
    return control || broken || code == 0x7F ? "?" : at;
}

/* returns  where the text goes on after so many characters */
static const char *append_shown(buffer *b, const char *at, const char *end,
                                size_t most) {
    for (; most > 0 && at < end; most--, at += message_step(at))
        message_append(b, message_shown(at),
                       *message_shown(at) == '?' ? 1 : message_step(at));
    return at;
}

/* Below the characters from `at` to before `last`: a caret below number `place`,
   and marks below the rest of `length`. */
static void append_marks(buffer *b, const char *at, const char *last,
                         size_t place, size_t length) {
    for (; place > 0; place--) {
        message_append(b, at < last && *at == '\t' ? "\t" : " ", 1);
        at += at < last ? message_step(at) : 0;
    }
    message_append(b, "^", 1);
    at += at < last ? message_step(at) : 0;
    for (; length > 1 && at < last; length--, at += message_step(at))
        message_append(b, "~", 1);
}

/* The line around a column, then the same width of space and a caret. */
static void append_line(buffer *b, const nevh__line *line, size_t column,
                        size_t length) {
    const char *end = line->text + line->bytes, *at = line->text;
    size_t skip = column > SHOWN ? column - BEFORE : 0, here = 1;
    for (; here <= skip && at < end; here++)
        at += message_step(at);
    const char *from = at;
    message_append(b, "\n", 1);
    message_append(b, "...", skip ? 3 : 0);
    at = append_shown(b, at, end, SHOWN);
    message_append(b, "...", at < end ? 3 : 0);
    message_append(b, "\n", 1);
    message_append(b, "   ", skip ? 3 : 0);
    append_marks(b, from, at, column > here ? column - here : 0, length);
}

bool nevh__scene_fail_at(nevh_scene *s, int status, const nevh__line *line,
                         size_t column, size_t length, const char *text) {
    if (s->status)
        return false;
    s->status = status;
    buffer b = {s->message, sizeof s->message, 0};
    char place[64];
    snprintf(place, sizeof place,
             ":%zu:%zu: error: ", line->number ? line->number : 1, column);
    const char *name = line->number ? s->name : "assignment";
    append_shown(&b, name, name + strlen(name), TEXT);
    message_append(&b, place, strlen(place));
    append_shown(&b, text, text + strlen(text), TEXT);
    append_line(&b, line, column, length);
    return false;
}

void nevh__scene_quote(nevh_scene *s, const char *text) {
    buffer b = {s->message, sizeof s->message, strlen(s->message)};
    message_append(&b, "\n", 1);
    message_append(&b, text, strlen(text));
}

bool nevh__scene_fail(nevh_scene *s, int status, const nevh__piece *piece,
                      const char *format, ...) {
    char text[TEXT];
    va_list arguments;
    va_start(arguments, format);
    nevh__vprint(text, sizeof text, format, arguments);
    va_end(arguments);
    return nevh__scene_fail_at(s, status, piece->line,
                               nevh__piece_column(piece),
                               nevh__characters(piece->text), text);
}

bool nevh__scene_no_memory(nevh_scene *s) {
    if (!s->status)
        snprintf(s->message, sizeof s->message, "out of memory");
    s->status = s->status ? s->status : NEVH_ENOMEM;
    return false;
}

/* The formula that is a definition's or an observable's. */
static const nevh__piece *definition_of(const nevh_scene *s, const char *name) {
    for (size_t i = 0; i < s->n_statements; i++) {
        const nevh__statement *one = &s->statements[i];
        bool named = one->section == NEVH__DEFINITIONS ||
                     one->section == NEVH__OBSERVABLES;
        if (named && strcmp(one->head.name, name) == 0)
            return &one->value;
    }
    return NULL;
}

bool nevh__scene_fail_formula(nevh_scene *s, const nevh__piece *piece,
                              const nevh__formula_error *error) {
    if (error->status == NEVH_ENOMEM)
        return nevh__scene_no_memory(s);
    const nevh__piece *inside =
        error->definition ? definition_of(s, error->definition) : NULL;
    piece = inside ? inside : piece;
    size_t first = error->column ? error->column : 1;
    return nevh__scene_fail_at(s, error->status, piece->line,
                               nevh__piece_column(piece) + first - 1,
                               error->length, error->text);
}

bool nevh__scene_one_name(nevh_scene *s, const nevh__piece *name) {
    return !strpbrk(name->text, " \t") ||
           nevh__scene_fail(s, NEVH_EINVAL, name,
                            "names are separated by commas, not \"%s\"",
                            name->text);
}

/* "; there are A, B, C", or nothing where there is no room for all. */
static void list_known(const char *const known[], size_t count, char *text,
                       size_t room) {
    size_t used = 0;
    for (size_t i = 0; i < count && used < room; i++)
        used += (size_t)snprintf(text + used, room - used, "%s%s",
                                 i           ? ", "
                                 : count > 1 ? "; there are "
                                             : "; there is ",
                                 known[i]);
    if (used >= room)
        *text = '\0';
}

bool nevh__scene_fail_word(nevh_scene *s, const nevh__piece *at,
                           const char *what, const char *word,
                           const char *const known[], size_t count) {
    const char *best = NULL;
    char all[200] = "";
    size_t most = nevh__characters(word) / 3 + 2;
    for (size_t i = 0; i < count; i++) {
        size_t far = nevh__words_apart(word, known[i]);
        if (far < most) {
            most = far;
            best = known[i];
        }
    }
    if (!best)
        list_known(known, count, all, sizeof all);
    return nevh__scene_fail(s, NEVH_EINVAL, at, "there is no %s %s%s%s%s", what,
                            word, best ? "; did you mean " : all,
                            best ? best : "", best ? "?" : "");
}

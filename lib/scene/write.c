/* nevh: a scene as text: its own lines, in which values that were set and
   effects that were switched are replaced.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <stdlib.h>
#include <string.h>

typedef struct {
    char *text;
    size_t used, capacity;
    bool failed;
    char *folder; /* that names of C files are put after; NULL: none */
} writer;

static void write_put(writer *w, const char *bytes, size_t count) {
    if (w->failed)
        return;
    if (w->used + count >= w->capacity) {
        size_t capacity = 2 * (w->used + count) + 64;
        char *grown = nevh__grow(w->text, capacity, 1);
        w->failed = !grown;
        if (w->failed)
            return;
        w->text = grown;
        w->capacity = capacity;
    }
    memcpy(w->text + w->used, bytes, count);
    w->used += count;
    w->text[w->used] = '\0';
}

static void put_text(writer *w, const char *text) {
    write_put(w, text, strlen(text));
}

/* Puts a line, with other text in place of a piece and another value. */
static void put_changed(writer *w, const nevh__statement *one, const char *key,
                        const char *value) {
    const nevh__line *line = one->key.line;
    const char *after_key = one->key.at + strlen(one->key.text);
    const char *after = one->value.at + strlen(one->value.text);
    write_put(w, line->text, (size_t)(one->key.at - line->text));
    put_text(w, key);
    write_put(w, after_key, (size_t)(one->value.at - after_key));
    put_text(w, value);
    write_put(w, after, (size_t)(line->text + line->bytes - after));
}

/* A list or one value was set: NAME[i = 1..N] becomes NAME[1..N]. */
static void put_set(writer *w, const nevh__statement *one, const char *value) {
    const char *open = strchr(one->key.text, '['),
               *equals = one->head.index ? strchr(open, '=') : NULL;
    writer key = {0};
    if (equals) {
        write_put(&key, one->key.text, (size_t)(open - one->key.text) + 1);
        put_text(&key, equals + 1 + strspn(equals + 1, " \t"));
    }
    w->failed |= key.failed;
    put_changed(w, one, equals && !key.failed ? key.text : one->key.text,
                value);
    free(key.text);
}

/* file("NAME" ...), the name with its folder. */
static void put_code(writer *w, const nevh__statement *one) {
    const char *value = one->value.text, *name = strchr(value, '"') + 1;
    writer all = {0};
    write_put(&all, value, (size_t)(name - value));
    put_text(&all, w->folder);
    put_text(&all, "/");
    put_text(&all, name);
    w->failed |= all.failed;
    if (!all.failed)
        put_changed(w, one, one->key.text, all.text);
    free(all.text);
}

static bool write_moves(const writer *w, const nevh__statement *one) {
    const char *name = strchr(one->value.text, '"');
    return w->folder && nevh__is_code(one) && name && name[1] != '/';
}

/* The names of the effects that are on. */
static void put_effects(writer *w, const nevh_scene *s) {
    const char *comma = "";
    for (size_t i = 0; i < s->n_effects; i++) {
        if (!s->effects[i].on)
            continue;
        put_text(w, comma);
        put_text(w, s->effects[i].name);
        comma = ", ";
    }
    if (!*comma)
        put_text(w, "none");
}

static bool all_on(const nevh_scene *s) {
    for (size_t i = 0; i < s->n_effects; i++)
        if (!s->effects[i].on)
            return false;
    return true;
}

/* effects = ..., or NULL. */
static const nevh__statement *choice_of(const nevh_scene *s) {
    for (size_t i = 0; i < s->n_statements; i++)
        if (s->statements[i].section == NEVH__SCENE &&
            strcmp(s->statements[i].head.name, "effects") == 0)
            return &s->statements[i];
    return NULL;
}

static void put_choice(writer *w, const nevh_scene *s,
                       const nevh__statement *one) {
    writer names = {0};
    put_effects(&names, s);
    w->failed |= names.failed;
    if (!names.failed)
        put_changed(w, one, one->key.text, names.text);
    free(names.text);
}

/* The line after which effects = ... belongs: the last of [scene]; NULL where
   there is none. */
static const nevh__line *heading_of(const nevh_scene *s) {
    const nevh__line *last = NULL;
    for (size_t i = 0; i < s->n_statements; i++)
        if (s->statements[i].section == NEVH__SCENE)
            last = s->statements[i].key.line;
    return last;
}

static void put_new_choice(writer *w, const nevh_scene *s, const char *before,
                           const char *after) {
    put_text(w, before);
    put_text(w, "effects = ");
    put_effects(w, s);
    put_text(w, after);
}

static void put_statement(writer *w, const nevh_scene *s,
                          const nevh__statement *one) {
    const nevh__statement *from =
        one->section == NEVH__PARAMETERS
            ? nevh__scene_assignment(s, one->head.name)
            : NULL;
    if (from)
        put_set(w, one, from->value.text);
    else if (s->switched && one == choice_of(s))
        put_choice(w, s, one);
    else if (write_moves(w, one))
        put_code(w, one);
    else
        write_put(w, one->key.line->text, one->key.line->bytes);
}

static void put_lines(writer *w, const nevh_scene *s) {
    bool missing = s->switched && !choice_of(s) && !all_on(s);
    const nevh__line *heading = heading_of(s);
    const nevh__statement *next = s->statements, *end = next + s->n_statements;
    if (missing && !heading)
        put_new_choice(w, s, "[scene]\n", "\n\n");
    for (size_t i = 0; i < s->n_lines; i++) {
        const nevh__line *line = &s->lines[i];
        if (next < end && next->key.line == line) {
            put_statement(w, s, next);
            while (next < end && next->key.line == line)
                next++;
        } else
            write_put(w, line->text, line->bytes);
        put_text(w, "\n");
        if (missing && heading == line)
            put_new_choice(w, s, "", "\n");
    }
}

/* The scene's folder, where that is not the one of the path; else NULL. */
static char *other_folder(writer *w, const nevh_scene *s, const char *path) {
    char *here = NULL, *there = NULL;
    w->failed |=
        !nevh__folder_of(s->name, &here) || !nevh__folder_of(path, &there);
    bool other = here && there && strcmp(here, there) != 0;
    free(there);
    if (other)
        return here;
    free(here);
    return NULL;
}

char *nevh_scene_write(const nevh_scene *s, const char *path) {
    if (!s)
        return NULL;
    writer w = {0};
    if (path)
        w.folder = other_folder(&w, s, path);
    if (s->model)
        put_lines(&w, s);
    else
        w.failed = true;
    free(w.folder);
    if (!w.failed)
        return w.text;
    free(w.text);
    return NULL;
}

/* nevh: what a scene says.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <string.h>

/* The text of KEY = TEXT; "" if there is none. */
static const char *text_of(const nevh_scene *s, nevh__section_kind section,
                           const char *key) {
    for (size_t i = 0; i < s->n_statements; i++)
        if (s->statements[i].section == section &&
            strcmp(s->statements[i].key.text, key) == 0)
            return s->statements[i].value.text;
    return "";
}

const char *nevh_scene_title(const nevh_scene *s) {
    if (!s)
        return "";
    return text_of(s, NEVH__SCENE, "title");
}

const char *nevh_scene_source(const nevh_scene *s) {
    if (!s)
        return "";
    return text_of(s, NEVH__SCENE, "source");
}

size_t nevh_scene_dof(const nevh_scene *s) {
    if (!s)
        return 0;
    return s->model ? s->model->n : 0;
}

const char *nevh_scene_coordinate(const nevh_scene *s, size_t k) {
    if (!s)
        return "";
    return k < nevh_scene_dof(s) ? s->model->coordinate_names[k] : NULL;
}

size_t nevh_scene_array(const nevh_scene *s, size_t k) {
    size_t count = s && s->model ? s->model->n_coordinates : 0;
    for (size_t i = 0; i < count; i++) {
        const nevh__coordinate *c = &s->model->coordinates[i];
        if (k >= c->first && k < c->first + c->count)
            return c->first;
    }
    return k;
}

const char *nevh_scene_label(const nevh_scene *s, const char *name) {
    if (!s || !name)
        return "";
    char array[NEVH__NAME_LENGTH + 1];
    const char *text = text_of(s, NEVH__LABELS, name);
    size_t bytes = strcspn(name, "[");
    if (text[0] || !name[bytes] || bytes >= sizeof array)
        return text;
    memcpy(array, name, bytes);
    array[bytes] = '\0';
    return text_of(s, NEVH__LABELS, array);
}

/* A text and the zero at its end. */
static uint64_t digest_text(uint64_t digest, const char *text) {
    do
        digest = nevh__digest_byte(digest, (unsigned char)*text);
    while (*text++);
    return digest;
}

static uint64_t digest_statement(uint64_t digest,
                                 const nevh__statement *statement) {
    if (statement->title)
        digest = digest_text(digest, statement->title->text);
    return digest_text(digest_text(digest, statement->key.text),
                       statement->value.text);
}

uint64_t nevh_scene_digest(const nevh_scene *s) {
    if (!s)
        return 0;
    uint64_t digest = nevh__digest_begin;
    for (size_t i = 0; i < s->n_statements; i++)
        digest = digest_statement(digest ^ s->statements[i].section,
                                  &s->statements[i]);
    for (size_t i = 0; i < s->n_assignments; i++)
        digest = digest_statement(digest, s->assignments[i]);
    for (size_t i = 0; i < s->n_starts; i++)
        digest = digest_statement(digest_text(digest, "start"), s->starts[i]);
    for (size_t i = 0; i < s->n_varies; i++)
        digest = digest_statement(digest_text(digest, "vary"), s->varies[i]);
    if (s->outcomes)
        digest = digest_text(digest, s->outcomes->text);
    for (size_t i = 0; i < s->n_effects; i++)
        digest = digest_text(digest, s->effects[i].on ? "on" : "off");
    if (s->transform)
        digest = digest_text(digest, s->transform->text);
    return nevh__scene_digest_code(s, digest);
}

const nevh_system *nevh_scene_system(nevh_scene *s) {
    if (!s)
        return NULL;
    return s->model ? s->model->system : NULL;
}

const nevh_scene_run *nevh_scene_run_settings(nevh_scene *s) {
    if (!s)
        return NULL;
    return s->model ? &s->model->run : NULL;
}

const nevh_system *nevh_scene_transform(nevh_scene *s) {
    if (!s)
        return NULL;
    return s->model ? s->model->transform : NULL;
}

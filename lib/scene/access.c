/* nevh: what a scene says.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <string.h>

/* The text of KEY = TEXT; "" if there is none. */
static const char *text_of(const nevh_scene *s, nevh__section section,
                           const char *key) {
    for (size_t i = 0; i < s->n_statements; i++)
        if (s->statements[i].section == section &&
            strcmp(s->statements[i].key.text, key) == 0)
            return s->statements[i].value.text;
    return "";
}

const char *nevh_scene_title(const nevh_scene *s) {
    return text_of(s, NEVH__SCENE, "title");
}

const char *nevh_scene_source(const nevh_scene *s) {
    return text_of(s, NEVH__SCENE, "source");
}

size_t nevh_scene_dof(const nevh_scene *s) {
    return s->model ? s->model->n : 0;
}

const char *nevh_scene_coordinate(const nevh_scene *s, size_t k) {
    return k < nevh_scene_dof(s) ? s->model->coordinate_names[k] : NULL;
}

const char *nevh_scene_label(const nevh_scene *s, const char *name) {
    char array[NEVH__NAME_LENGTH + 1];
    const char *text = text_of(s, NEVH__LABELS, name);
    size_t bytes = strcspn(name, "[");
    if (text[0] || !name[bytes] || bytes >= sizeof array)
        return text;
    memcpy(array, name, bytes);
    array[bytes] = '\0';
    return text_of(s, NEVH__LABELS, array);
}

const nevh_system *nevh_scene_system(nevh_scene *s) {
    return s->model ? s->model->system : NULL;
}

const nevh_scene_run *nevh_scene_run_settings(nevh_scene *s) {
    return s->model ? &s->model->run : NULL;
}

const nevh_system *nevh_scene_transform(nevh_scene *s) {
    return s->model ? s->model->transform : NULL;
}

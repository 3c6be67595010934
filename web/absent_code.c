/* nevh: the live page's module has no compiler for effects in C, and no schemes of a
   scene's own.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/tableau_private.h"
#include "scene/code_private.h"
#include "scene/scene_private.h"

bool nevh__code_load(const char *path, nevh__code *code, const char **what) {
    (void)path, (void)code;
    *what = "a page cannot compile effects in C: %s";
    return false;
}

void nevh__code_unload(nevh__code *code) {
    (void)code;
}

/* Scenes may bring schemes of their own, and none is run here. */
bool nevh__model_integrators(nevh_scene *s, nevh__scene_model *m) {
    (void)s, (void)m;
    return true;
}

void nevh__scene_forget_integrators(nevh_scene *s) {
    (void)s;
}

nevh__tableau *nevh__implicit_new(const nevh__implicit_table *table) {
    (void)table;
    return NULL;
}

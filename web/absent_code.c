/* nevh: the live page's module has no compiler for effects in C.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/code_private.h"

bool nevh__code_load(const char *path, nevh__code *code, const char **what) {
    (void)path, (void)code;
    *what = "a page cannot compile effects in C: %s";
    return false;
}

void nevh__code_unload(nevh__code *code) {
    (void)code;
}

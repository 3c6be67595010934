/* nevh: that no output is written over what is read, or over another output.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Where a file is to be: its folder, and its name in it. */
static bool is_same_place(const char *a, const char *b) {
    struct stat folder[2];
    const char *name[2] = {a, b};
    for (int i = 0; i < 2; i++) {
        const char *slash = strrchr(name[i], '/');
        char *path =
            slash ? text_print("%.*s", (int)(slash - name[i]) + 1, name[i])
                  : text_print(".");
        bool found = stat(path, &folder[i]) == 0;
        free(path);
        if (!found)
            return strcmp(a, b) == 0;
        name[i] = slash ? slash + 1 : name[i];
    }
    return folder[0].st_dev == folder[1].st_dev &&
           folder[0].st_ino == folder[1].st_ino &&
           strcmp(name[0], name[1]) == 0;
}

bool file_is_same(const char *a, const char *b) {
    struct stat first, second;
    bool there = stat(a, &first) == 0;
    if (there != (stat(b, &second) == 0))
        return false;
    if (!there)
        return is_same_place(a, b);
    return S_ISREG(first.st_mode) && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

static int check_against(const options *o, const char *file, const char *what) {
    const struct {
        const char *option, *name;
    } outputs[] = {{"-o", o->file},
                   {"--plot", o->plot.file},
                   {"--keep-plot-script", o->plot.script},
                   {"--resume", o->resume}};
    for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++)
        if (outputs[i].name && file_is_same(outputs[i].name, file))
            return tool_refuse("%s %s would be written over %s; nothing was "
                               "changed",
                               outputs[i].option, outputs[i].name, what);
    return TOOL_OK;
}

int outputs_check(const options *o, const nevh_scene *scene, const char *file) {
    int status = check_against(o, file, "the scene itself");
    char *code;
    for (size_t i = 0; !status && (code = nevh_scene_code_path(scene, i));
         i++) {
        status = check_against(o, code, "the scene's own C code");
        free(code);
    }
    return status;
}

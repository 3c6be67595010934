/* nevh: that no output is written over what is read, or over another output.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <inttypes.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The file that writing through a dangling symbolic link would create. */
static char *follow(const char *file) {
    enum { MOST_LINKS = 40, MOST_BYTES = 4096 };
    char target[MOST_BYTES], *at = text_print("%s", file);
    for (int i = 0; i < MOST_LINKS; i++) {
        ssize_t length = readlink(at, target, sizeof target);
        if (length < 0 || length == sizeof target)
            break;
        const char *slash = strrchr(at, '/');
        int folder = slash && *target != '/' ? (int)(slash - at) + 1 : 0;
        char *next = text_print("%.*s%.*s", folder, at, (int)length, target);
        at = next;
    }
    return at;
}

/* True if both names have the same folder and the same name in it. */
static bool places_are_same(const char *a, const char *b) {
    struct stat folder[2];
    const char *name[2] = {a, b};
    for (int i = 0; i < 2; i++) {
        const char *slash = strrchr(name[i], '/');
        char *path =
            slash ? text_print("%.*s", (int)(slash - name[i]) + 1, name[i])
                  : text_print(".");
        bool found = stat(path, &folder[i]) == 0;
        if (!found)
            return strcmp(a, b) == 0;
        name[i] = slash ? slash + 1 : name[i];
    }
    return folder[0].st_dev == folder[1].st_dev &&
           folder[0].st_ino == folder[1].st_ino &&
           strcmp(name[0], name[1]) == 0;
}

static bool is_same_place(const char *a, const char *b) {
    return places_are_same(follow(a), follow(b));
}

/* True if two names belong to one regular file, or would create one. */
static bool file_is_same(const char *a, const char *b) {
    struct stat first, second;
    bool there = stat(a, &first) == 0;
    if (there != (stat(b, &second) == 0))
        return false;
    if (!there)
        return is_same_place(a, b);
    return S_ISREG(first.st_mode) && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

/* All that is written, an option and a file each: with what stands beside a
   file, its state or what an array was made from. */
typedef struct {
    list options, files;
} outputs;

static void outputs_add(outputs *all, const char *option, const char *file) {
    if (!file)
        return;
    list_add(&all->options, option);
    list_add(&all->files, file);
}

/* nevh run keeps a state beside its rows, nevh sweep a text beside an array. */
static const char *ending_beside(const options *o, const char *file) {
    const char *name = o->operands.count ? o->operands.item[0] : "";
    const char *ending = strrchr(file, '.');
    if (strcmp(name, "run") == 0)
        return STATE_ENDING;
    if (strcmp(name, "sweep") == 0 && ending && strcmp(ending, ".npy") == 0)
        return ARRAY_TEXT_ENDING;
    return NULL;
}

static void outputs_add_rows(outputs *all, const options *o, const char *option,
                             const char *file) {
    const char *ending = file ? ending_beside(o, file) : NULL;
    outputs_add(all, option, file);
    if (ending)
        outputs_add(all, option, text_print("%s%s", file, ending));
}

char *output_part(const char *file, uint64_t task, uint64_t tasks) {
    size_t length = strlen(file);
    if (!tasks)
        return text_print("%s", file);
    if (length > 4 && strcmp(file + length - 4, ".npy") == 0)
        length -= 4;
    return text_print("%.*s.%" PRIu64 "-of-%" PRIu64 ".npy", (int)length, file,
                      task, tasks);
}

static void outputs_list(outputs *all, const options *o) {
    char *part = o->file ? output_part(o->file, o->task, o->tasks) : NULL;
    *all = (outputs){0};
    outputs_add_rows(all, o, "-o", part);
    outputs_add(all, "--plot", o->plot.file);
    outputs_add(all, "--picture", o->picture);
    outputs_add(all, "--keep-plot-script", o->plot.script);
}

static int check_against(const outputs *all, const char *file,
                         const char *what) {
    for (size_t i = 0; file && i < all->files.count; i++)
        if (file_is_same(all->files.item[i], file))
            return tool_refuse("%s %s would be written over %s; nothing was "
                               "changed",
                               all->options.item[i], all->files.item[i], what);
    return TOOL_OK;
}

static int check_each_other(const outputs *all) {
    for (size_t i = 0; i < all->files.count; i++)
        for (size_t k = 0; k < i; k++)
            if (file_is_same(all->files.item[i], all->files.item[k]))
                return tool_refuse("two outputs would have the same name, %s",
                                   all->files.item[i]);
    return TOOL_OK;
}

static int check_inputs(const outputs *all, const options *o,
                        const nevh_scene *scene, const char *file) {
    int status = check_against(all, file, "the scene itself");
    char *code, *data = o->fit.data ? data_file(o->fit.data) : NULL;
    char *kit = page_kit();
    if (!status)
        status = check_against(all, data, "the measured points of --data");
    if (!status)
        status = check_against(all, kit, "the page without a scene");
    for (size_t i = 0;
         !status && (code = text_adopt(nevh_scene_code_path(scene, i))); i++)
        status = check_against(all, code, "the scene's own C code");
    return status;
}

int outputs_check(const options *o, const nevh_scene *scene, const char *file) {
    outputs all;
    outputs_list(&all, o);
    int status = check_each_other(&all);
    /* The file to resume may be that of -o. */
    outputs_add_rows(&all, o, "--resume", o->resume);
    if (!status)
        status = check_inputs(&all, o, scene, file);
    return status;
}

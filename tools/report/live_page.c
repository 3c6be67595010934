/* nevh page: a scene as a live page, which computes in the reader's browser.

   The page is made when nevh is built (web/kit.html); a line of it says where
   the scene goes, as JSON.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "lesson.h"
#include "report_private.h"
#include <errno.h>
#include <math.h>
#include <string.h>

enum { MOST_SCHEMES = 4, MOST_STEPS = 3000000 };
static const char mark[] = "@SCENE@\n";

/* A string of JSON that no end of an element can be in. */
static void put_string(FILE *f, const char *text) {
    fputc('"', f);
    for (; *text; text++)
        if ((unsigned char)*text < ' ' || strchr("\"\\<>&", *text))
            fprintf(f, "\\u%04x", (unsigned)(unsigned char)*text);
        else
            fputc(*text, f);
    fputc('"', f);
}

static void put_list(FILE *f, const char *name, const list *items) {
    if (!items->count)
        return;
    fprintf(f, ",\"%s\":[", name);
    for (size_t i = 0; i < items->count; i++) {
        fputs(i ? "," : "", f);
        put_string(f, items->item[i]);
    }
    fputc(']', f);
}

/* Parameters and effects are in the text; a start is not, and is set again. */
static void put_starts(FILE *f, const options *o) {
    bool first = true;
    fputs(",\"changes\":[", f);
    for (size_t i = 0; i < o->settings.count; i++)
        if (o->settings.item[i][0] == '@') {
            fputs(first ? "[\"@\"," : ",[\"@\",", f);
            put_string(f, o->settings.item[i] + 1);
            fputc(']', f);
            first = false;
        }
    fputc(']', f);
}

/* The step and the speed at which the schemes part, where none is given. */
static void put_lesson(FILE *f, const options *o, nevh_scene *scene) {
    const nevh_scene_run *run = nevh_scene_run_settings(scene);
    const list *names = &o->integrators;
    size_t n = nevh_scene_dof(scene);
    double *start = tool_allocate(2 * n, sizeof *start);
    char text[LESSON_TEXT];
    nevh_scene_start(scene, start, start + n);
    lesson_find(scene,
                names->count ? (const char *const *)names->item
                             : run->integrator,
                names->count ? names->count : run->integrators,
                o->gradients.count ? o->gradients.item[0] : NULL, start,
                lesson_usual(scene), MOST_STEPS / (n + 1), text);
    fprintf(f, ",\"lesson\":%s", text);
}

static void put_scene(FILE *f, const options *o, const char *name,
                      nevh_scene *scene, double dt) {
    char *text = text_adopt(tool_owned(nevh_scene_write(scene, NULL)));
    fputs("{\"name\":", f);
    put_string(f, name);
    fputs(",\"text\":", f);
    put_string(f, text);
    put_starts(f, o);
    put_list(f, "integrators", &o->integrators);
    put_list(f, "gradients", &o->gradients);
    if (o->dt.count)
        fprintf(f, ",\"dt\":%.17g", dt);
    else
        put_lesson(f, o, scene);
    fputc('}', f);
}

/* The page has neither GSL nor transforms of time. */
static int check_schemes(const options *o) {
    if (o->integrators.count > MOST_SCHEMES || o->gradients.count > 1 ||
        o->dt.count > 1)
        return tool_refuse("a page takes up to %d integrators, with one step "
                           "and one gradient",
                           MOST_SCHEMES);
    for (size_t i = 0; i < o->integrators.count; i++) {
        const char *name = o->integrators.item[i];
        if (!lesson_has(name))
            return tool_refuse("%s needs GSL, which a page does not have",
                               name);
        if (strchr(name, '+'))
            return tool_refuse("%s: a page has no transforms of time", name);
        if (!nevh_integrator_named(name))
            return tool_refuse(
                "unknown integrator %s; a page has those of nevh "
                "list integrators",
                name);
    }
    return TOOL_OK;
}

static int check_scene(nevh_scene *scene, const char *name, const options *o) {
    char *code = text_adopt(nevh_scene_code_path(scene, 0));
    size_t n = nevh_scene_dof(scene);
    double *start = tool_allocate(2 * n, sizeof *start);
    int status = TOOL_OK;
    if (code)
        status = tool_refuse("%s: a page cannot compile effects in C", name);
    else if (nevh_scene_start(scene, start, start + n))
        status = scene_report(scene, o);
    return status;
}

/* The page without a scene, cut at the mark. */
static int read_kit(char **head, char **tail) {
    char *name = page_kit();
    char *text = name ? text_read(name) : NULL;
    char *cut = text ? strstr(text, mark) : NULL;
    int status = TOOL_OK;
    if (!cut)
        status = tool_refuse(
            "this nevh was built without the live page; to "
            "add it on Debian or Ubuntu: apt-get install "
            "clang lld llvm wasi-libc libclang-rt-dev-wasm32 "
            "zopfli binaryen, then ./quickstart, or configure and make page");
    else {
        *cut = '\0';
        *head = text;
        *tail = cut + strlen(mark);
    }
    return status;
}

/* Adds a scene, as the page takes it. */
static int add_scene(FILE *f, const options *o, const char *name) {
    nevh_scene *scene;
    double dt = 0;
    int status = scene_open_named(&scene, name, o);
    if (!status)
        status = check_scene(scene, name, o);
    if (!status && o->dt.count)
        status = scene_number(scene, o, o->dt.item[0], &dt);
    if (!status && o->dt.count && !(dt > 0 && isfinite(dt)))
        status = tool_refuse("--dt: %s is no step", o->dt.item[0]);
    if (!status)
        put_scene(f, o, name, scene, dt);
    nevh_scene_free(scene);
    return status ? TOOL_USAGE : TOOL_OK;
}

/* Scenes as the page takes them; NULL after a message. */
static char *all_scenes(const options *o) {
    text_file text;
    FILE *f = text_open(&text);
    int status = TOOL_OK;
    for (size_t i = 1; !status && i < o->operands.count; i++) {
        fputs(i > 1 ? ",\n" : "[", f);
        status = add_scene(f, o, o->operands.item[i]);
    }
    fputs("]\n", f);
    char *all = text_close(&text);
    return status ? NULL : all;
}

static int live_page(const options *o) {
    char *head = NULL, *tail = NULL;
    output out;
    if (!o->file)
        return tool_refuse("nevh page needs a file: -o FILE.html");
    if (o->operands.count < 2)
        return tool_refuse("nevh page needs a scene: a file, or a name of nevh "
                           "list scenes");
    char *scenes = check_schemes(o) ? NULL : all_scenes(o);
    int status = !scenes || read_kit(&head, &tail) ? TOOL_USAGE : TOOL_OK;
    if (!status && !output_open(&out, o->file)) {
        fprintf(out.stream, "%s%s%s", head, scenes, tail);
        status = output_close(&out, TOOL_OK);
    } else
        status = TOOL_USAGE;
    return status;
}

const command page_command = {
    .name = "page",
    .operand = "SCENE...",
    .brief = "a live page that runs in a browser, offline",
    .help = "a live page in one file: the scene runs in a browser, offline",
    .examples = "page pendulum -o pendulum.html\n"
                "page pendulum kepler --dt 0.05 -o class.html",
    .options = "with without set start integrators dt gradient output",
    .run = live_page,
};

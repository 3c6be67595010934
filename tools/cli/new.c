/* nevh new: a scene to start from.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "commands.h"
#include "tool.h"
#include <errno.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* The text of a scene, changed as the options say; NULL with the message
   printed. */
static char *text_from(const options *o, const char *file) {
    nevh_scene *scene;
    if (scene_open_named(&scene, o->from, o))
        return NULL;
    char *text = text_adopt(tool_owned(nevh_scene_write(scene, file)));
    nevh_scene_free(scene);
    return text;
}

/* Writes a new file only; an incomplete one is removed. */
static int write_new(const char *file, const char *text) {
    FILE *f = fopen(file, "wxe");
    if (!f)
        return errno == EEXIST
                   ? tool_refuse(
                         "%s is there already; nevh new leaves it alone", file)
                   : tool_refuse("%s cannot be written: %s", file,
                                 strerror(errno));
    bool wrong = fputs(text, f) < 0;
    wrong |= fclose(f) != 0;
    if (!wrong)
        return TOOL_OK;
    remove(file);
    return tool_refuse("%s cannot be written: %s", file, strerror(errno));
}

/* The file to be made: its ending may be left out. */
static char *file_of(const char *name) {
    const char *end = strrchr(name, '.');
    return text_print("%s%s", name,
                      end && strcasecmp(end, ".nevh") == 0 ? "" : ".nevh");
}

/* Why a name is not one of a file: it has none, such as . or a/, or is a device. */
static const char *no_file(const char *name) {
    struct stat there;
    const char *last = strrchr(name, '/');
    last = last ? last + 1 : name;
    if (!last[strspn(last, ".")])
        return "has no name of a file";
    if (strcasecmp(last, ".nevh") == 0)
        return "has nothing before its ending";
    return stat(name, &there) == 0 && !S_ISREG(there.st_mode) &&
                   !S_ISDIR(there.st_mode)
               ? "is no regular file"
               : NULL;
}

static int make_file(const options *o, const char *file) {
    char *text = o->from ? text_from(o, file) : text_print("%s", scene_sample);
    int status = text ? write_new(file, text) : TOOL_USAGE;
    if (!status && !o->quiet)
        printf("%s is made.   Next: %s\n", file,
               shell_word(text_print("nevh compare"), file));
    return status;
}

static int new_scene(const options *o) {
    if (o->operands.count != 2)
        return tool_refuse("nevh new takes one file to be made: FILE.nevh");
    if (!o->from && o->settings.count)
        return tool_refuse("--set, --with and --without change the scene that "
                           "--from names");
    const char *name = o->operands.item[1], *why = no_file(name);
    if (why)
        return tool_refuse(
            "%s %s: nevh new takes one file to be made: FILE.nevh",
            *name ? name : "\"\"", why);
    char *file = file_of(name);
    return make_file(o, file);
}

const command new_command = {
    .name = "new",
    .operand = "FILE",
    .brief = "a commented scene to edit",
    .help = "makes a commented scene, FILE.nevh",
    .examples = "new mine.nevh\n"
                "new moon.nevh --from pendulum --set g=1.6",
    .options = "with without set from allow-code quiet",
    .run = new_scene,
};

/* nevh new: a scene to start from.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* The text of a scene, changed as the options say; NULL with the message
   printed. */
static char *text_from(const options *o) {
    nevh_scene *scene;
    if (scene_open_named(&scene, o->from, o))
        return NULL;
    char *text = nevh_scene_write(scene, o->operands.item[1]);
    if (!text)
        tool_refuse("out of memory");
    nevh_scene_free(scene);
    return text;
}

/* What is there is left alone; what could not be written whole is removed. */
static int write_new(const char *file, const char *text) {
    FILE *f = fopen(file, "wx");
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

static int check_name(const options *o) {
    const char *end =
        o->operands.count == 2 ? strrchr(o->operands.item[1], '.') : NULL;
    if (o->operands.count != 2)
        return tool_refuse("nevh new takes one file to be made: FILE.nevh");
    if (end && strcmp(end, ".nevh") == 0)
        return TOOL_OK;
    return tool_refuse("scenes are files that end in .nevh: %s.nevh",
                       o->operands.item[1]);
}

int new_scene(const options *o) {
    if (check_name(o))
        return TOOL_USAGE;
    if (!o->from && o->settings.count)
        return tool_refuse("--set, --with and --without change the scene that "
                           "--from names");
    const char *file = o->operands.item[1];
    char *text = o->from ? text_from(o) : text_print("%s", scene_sample);
    int status = text ? write_new(file, text) : TOOL_USAGE;
    free(text);
    if (!status && !o->quiet)
        printf("%s is made.   Next: nevh compare %s\n", file, file);
    return status;
}

/* nevh: scenes by file or name.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char ending[] = ".nevh";

/* Where scenes are, for tests and in the build tree given by the
   environment. */
static const char *folder(void) {
    const char *given = getenv("NEVH_SCENES");
    return given && *given ? given : NEVH_SCENES;
}

static int is_scene(const struct dirent *entry) {
    size_t length = strlen(entry->d_name), tail = sizeof ending - 1;
    return length > tail && entry->d_name[0] != '.' &&
           strcmp(entry->d_name + length - tail, ending) == 0;
}

void scenes_installed(list *names, list *files) {
    struct dirent **entry = NULL;
    int count = scandir(folder(), &entry, is_scene, alphasort);
    for (int i = 0; i < count; i++) {
        const char *file = entry[i]->d_name;
        list_print(names, "%.*s", (int)(strlen(file) - sizeof ending + 1),
                   file);
        if (files)
            list_print(files, "%s/%s", folder(), file);
        free(entry[i]);
    }
    free(entry);
}

static bool is_file(const char *name) {
    struct stat found;
    return stat(name, &found) == 0 && !S_ISDIR(found.st_mode);
}

static int not_found(const char *name) {
    list names = {0};
    scenes_installed(&names, NULL);
    const char *closest = list_closest(&names, name);
    int status =
        closest ? tool_refuse("there is no file and no scene %s; did you mean "
                              "%s?",
                              name, closest)
                : tool_refuse("there is no file and no scene %s; see nevh list "
                              "scenes",
                              name);
    list_free(&names);
    return status;
}

char *scene_file(const char *beside, const char *name) {
    char *file = text_print("%s%s%s/%s%s", folder(), *beside ? "/" : "", beside,
                            name, ending);
    if (is_file(file))
        return file;
    free(file);
    return NULL;
}

/* The file of a scene; NULL, with a message, when there is none. */
static char *find(const char *name) {
    if (is_file(name))
        return text_print("%s", name);
    char *file = strchr(name, '/') ? NULL : scene_file("", name);
    if (!file)
        not_found(name);
    return file;
}

/* The option that was given that text. */
static const char *option_of(const options *o, const char *text,
                             size_t length) {
    if (o->transform && strlen(o->transform) == length &&
        strncmp(o->transform, text, length) == 0)
        return "--transform";
    for (size_t i = 0; i < o->settings.count; i++) {
        const char *one = o->settings.item[i];
        if (strlen(one + 1) == length && strncmp(one + 1, text, length) == 0)
            return *one == '+' ? "--with" : *one == '-' ? "--without" : "--set";
    }
    return "--set";
}

/* The scene's own messages have file, line and column; the line and the caret
   come after that.  Of what was said by an option there is no file. */
int scene_report(const nevh_scene *scene, const options *o) {
    const char *message = nevh_scene_message(scene);
    const char *what = strstr(message, ": error: "),
               *line = strchr(message, '\n');
    if (strncmp(message, "assignment:", 11) != 0 || !what || !line)
        return fprintf(stderr, "%s\n", message), TOOL_USAGE;
    return tool_refuse("%s: %s",
                       option_of(o, line + 1, strcspn(line + 1, "\n")),
                       what + strlen(": error: "));
}

static int read(nevh_scene *scene, const options *o) {
    if (nevh_scene_status(scene))
        return scene_report(scene, o);
    for (size_t i = 0; i < o->settings.count; i++)
        if (o->settings.item[i][0] == '=' &&
            nevh_scene_set(scene, o->settings.item[i] + 1))
            return scene_report(scene, o);
    if (o->transform && nevh_scene_set_transform(scene, o->transform))
        return scene_report(scene, o);
    return nevh_scene_system(scene) ? TOOL_OK : scene_report(scene, o);
}

int scene_open(nevh_scene **scene, const options *o) {
    *scene = NULL;
    if (o->operands.count == 2)
        return scene_open_named(scene, o->operands.item[1], o);
    return tool_refuse("nevh %s takes one scene: a file, or a name of nevh "
                       "list scenes",
                       o->operands.item[0]);
}

/* Effects are switched first, so that code of those that are off is not asked
   for. */
static nevh_scene *read_switched(const char *file, const options *o) {
    const char **effects = tool_allocate(o->settings.count, sizeof *effects);
    nevh_scene_options how = {.allow_code = o->allow_code, .effects = effects};
    for (size_t i = 0; i < o->settings.count; i++)
        if (o->settings.item[i][0] != '=')
            effects[how.n_effects++] = o->settings.item[i];
    nevh_scene *scene = nevh_scene_read_with(file, &how);
    free(effects);
    return scene;
}

int scene_open_named(nevh_scene **scene, const char *name, const options *o) {
    *scene = NULL;
    char *file = find(name);
    if (!file)
        return TOOL_USAGE;
    *scene = read_switched(file, o);
    free(file);
    if (*scene && !read(*scene, o))
        return TOOL_OK;
    if (!*scene)
        tool_refuse("out of memory");
    nevh_scene_free(*scene);
    *scene = NULL;
    return TOOL_USAGE;
}

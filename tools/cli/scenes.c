/* nevh: scenes by file or name.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <nevh/sweep.h>
#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#ifdef __linux__
#include <sys/auxv.h>
#endif

static const char ending[] = ".nevh";

/* The folder that holds the program, without an end that libtool adds; NULL
   where the system does not tell. */
static char *program_folder(void) {
    char *program = text_adopt(realpath("/proc/self/exe", NULL));
#ifdef __linux__
    if (!program) /* without /proc, as in a plain chroot */
        program =
            text_adopt(realpath((const char *)getauxval(AT_EXECFN), NULL));
#endif
    char *slash = program ? strrchr(program, '/') : NULL;
    if (slash)
        *slash = '\0';
    slash = program ? strrchr(program, '/') : NULL;
    if (slash && strcmp(slash, "/.libs") == 0)
        *slash = '\0';
    return program;
}

static bool is_folder(const char *name) {
    struct stat found;
    return stat(name, &found) == 0 && S_ISDIR(found.st_mode);
}

/* Beside the program: in a build tree in tools/, or installed in bin/, also
   where the whole of what is installed was moved; NULL: neither. */
static char *path_beside(const char *built, const char *installed) {
    char *program = program_folder(), *found = NULL;
    const char *last = program ? strrchr(program, '/') : NULL;
    if (last && strcmp(last, "/tools") == 0)
        found = text_print("%.*s/%s", (int)(last - program), program, built);
    else if (last)
        found = text_print("%.*s/share/nevh/%s", (int)(last - program), program,
                           installed);
    return found;
}

static char *folder_beside(void) {
    char *found = path_beside("scenes", "scenes");
    return found && is_folder(found) ? found : NULL;
}

/* The folder of scenes that are given by name: NEVH_SCENES of the environment, else
   the folder that belongs to this program (in the build tree or beside bin/), else
   the one it was configured for. */
static const char *scenes_folder(void) {
    const char *given = getenv("NEVH_SCENES");
    if (given && *given)
        return given;
    const char *beside = folder_beside();
    return beside ? beside : NEVH_SCENES;
}

static int is_scene(const struct dirent *entry) {
    size_t length = strlen(entry->d_name), tail = sizeof ending - 1;
    return length > tail && entry->d_name[0] != '.' &&
           strcmp(entry->d_name + length - tail, ending) == 0;
}

static int by_name(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

void scenes_installed(list *names, list *files) {
    list found = {0};
    const char *path = scenes_folder();
    DIR *folder = opendir(path);
    if (!folder && errno == ENOMEM)
        tool_owned(NULL);
    for (struct dirent *entry; folder && (entry = readdir(folder));)
        if (is_scene(entry))
            list_add(&found, entry->d_name);
    if (folder)
        closedir(folder);
    if (found.count)
        qsort(found.item, found.count, sizeof *found.item, by_name);
    for (size_t i = 0; i < found.count; i++) {
        const char *file = found.item[i];
        list_print(names, "%.*s", (int)(strlen(file) - sizeof ending + 1),
                   file);
        if (files)
            list_print(files, "%s/%s", path, file);
    }
}

static bool is_there(const char *name) {
    struct stat found;
    return stat(name, &found) == 0 || errno != ENOENT;
}

static bool is_file(const char *name) {
    struct stat found;
    return stat(name, &found) == 0 && !S_ISDIR(found.st_mode);
}

char *data_file(const char *name) {
    char *file = text_print("%s/%s", scenes_folder(), name);
    if (!strchr(name, '/') && !is_there(name) && is_file(file))
        return file;
    return text_print("%s", name);
}

char *package_folder(void) {
    char *beside = path_beside("scenes/../python", "python");
    char *found = beside ? text_adopt(realpath(beside, NULL))
                         : NULL; /* scenes is a link */
    return found ? found : text_print("%s", NEVH_PACKAGE);
}

char *library_file(void) {
    char *beside = path_beside(".libs/libnevh.so.0", "../../lib/libnevh.so.0");
    return beside && is_file(beside) ? beside : NULL;
}

char *page_kit(void) {
    char *beside = path_beside("web/kit.html", "page.html");
    return beside && is_file(beside) ? beside : text_print("%s", NEVH_PAGE);
}

int scenes_missing(void) {
    return tool_refuse("there are no scenes in %s; set NEVH_SCENES to the "
                       "folder that holds them",
                       scenes_folder());
}

/* The file in this folder with the ending added, else the closest name of a scene. */
static char *suggestion(const char *name, const list *names) {
    char *file = text_print("%s%s", name, ending);
    if (is_file(file))
        return file;
    const char *closest = list_closest(names, name);
    return closest ? text_print("%s", closest) : NULL;
}

/* Refuses a name, with the folders searched and the likely name. */
static int not_found(const char *name) {
    list names = {0};
    bool path = strchr(name, '/');
    if (!path)
        scenes_installed(&names, NULL);
    char *meant = suggestion(name, &names);
    if (is_folder(name))
        tool_refuse("%s is a folder, not a scene", name);
    else if (path)
        tool_refuse("there is no file %s%s%s%s", name,
                    meant ? "; did you mean " : "", meant ? meant : "",
                    meant ? "?" : "");
    else if (meant)
        tool_refuse("there is no file %s, and no scene of that name in %s; did "
                    "you mean %s?",
                    name, scenes_folder(), meant);
    else if (names.count)
        tool_refuse("there is no file %s, and no scene of that name in %s; see "
                    "nevh list scenes",
                    name, scenes_folder());
    else
        tool_refuse("there is no file %s, and there are no scenes in %s; set "
                    "NEVH_SCENES to the folder that holds them",
                    name, scenes_folder());
    return TOOL_USAGE;
}

char *scene_file(const char *name) {
    char *file = text_print("%s/%s%s", scenes_folder(), name, ending);
    return is_file(file) ? file : NULL;
}

/* The file of a scene; NULL, with a message, when there is none. */
static char *find(const char *name) {
    if (is_file(name))
        return text_print("%s", name);
    bool hard = strncmp(name, "hard/", 5) == 0;
    char *file = strchr(name, '/') && !hard ? NULL : scene_file(name);
    if (!file)
        not_found(name);
    return file;
}

static bool is_text(const char *given, const char *text, size_t length) {
    return given && strlen(given) == length &&
           strncmp(given, text, length) == 0;
}

static bool is_one_of(const list *l, const char *text, size_t length) {
    for (size_t i = 0; i < l->count; i++)
        if (is_text(l->item[i], text, length))
            return true;
    return false;
}

static bool is_within(const char *given, const char *text, size_t length) {
    return given && strstr(given, text_print("%.*s", (int)length, text));
}

/* The option that was given that text. */
static const char *option_of(const options *o, const char *text,
                             size_t length) {
    if (is_text(o->transform, text, length))
        return "--transform";
    if (is_text(o->outcomes, text, length))
        return "--outcomes";
    if (is_one_of(&o->vary, text, length))
        return "--vary";
    if (is_text(o->observable, text, length))
        return "--observable";
    for (size_t i = 0; i < o->settings.count; i++) {
        const char *one = o->settings.item[i];
        if (is_text(one + 1, text, length))
            return *one == '+'   ? "--with"
                   : *one == '-' ? "--without"
                   : *one == '@' ? "--start"
                                 : "--set";
    }
    return is_text(o->t_end, text, length)     ? "--t-end"
           : is_text(o->after, text, length)   ? "--after"
           : is_one_of(&o->at, text, length)   ? "--at"
           : is_one_of(&o->dt, text, length)   ? "--dt"
           : is_within(o->shape, text, length) ? "--shape"
                                               : "--set";
}

/* The scene's own messages have file, line and column; the line and the caret
   come after that.  Of what was said by an option there is no file. */
int scene_report(const nevh_scene *scene, const options *o) {
    const char *message = nevh_scene_message(scene);
    const char *what = strstr(message, ": error: "),
               *line = strchr(message, '\n');
    nevh_scene_status(scene); /* where memory is out it ends here */
    if (strncmp(message, "assignment:", 11) != 0 || !what || !line)
        return fprintf(stderr, "%s\n", message), TOOL_USAGE;
    return tool_refuse("%s: %s",
                       option_of(o, line + 1, strcspn(line + 1, "\n")),
                       what + strlen(": error: "));
}

int scene_number(nevh_scene *scene, const options *o, const char *formula,
                 double *number) {
    return nevh_scene_number(scene, formula, number) ? scene_report(scene, o)
                                                     : TOOL_OK;
}

/* True if an assignment is to a coordinate, a momentum or a velocity. */
static bool is_start(const nevh_scene *scene, const char *assignment) {
    assignment += strspn(assignment, " ");
    if (strncmp(assignment, "p_", 2) == 0 || strncmp(assignment, "v_", 2) == 0)
        assignment += 2;
    size_t length = strcspn(assignment, " =[");
    for (size_t k = 0; k < nevh_scene_dof(scene); k++) {
        const char *name = nevh_scene_coordinate(scene, k);
        if (strcspn(name, "[") == length &&
            strncmp(name, assignment, length) == 0)
            return true;
    }
    return false;
}

static int assign(nevh_scene *scene, const options *o, const char *setting) {
    const char *text = setting + 1;
    if (*setting == '@')
        return nevh_scene_set_start(scene, text) ? scene_report(scene, o)
                                                 : TOOL_OK;
    if (*setting != '=' || !nevh_scene_set(scene, text))
        return TOOL_OK;
    if (is_start(scene, text))
        return tool_refuse("--set changes parameters; where the motion starts "
                           "is changed by --start %s",
                           text);
    return scene_report(scene, o);
}

bool outcome_named(const char *text) {
    char *name = text_print("%.*s", (int)strcspn(text, " ("), text);
    return nevh_outcome_find(name) >= 0;
}

/* Takes --observable: a formula along the orbit or, of commands that take these, an
   outcome of it. */
static int observe(nevh_scene *scene, const options *o) {
    const char *name = o->operands.item[0], *what = o->observable;
    bool takes_outcomes =
        strcmp(name, "cost") == 0 || strcmp(name, "compare") == 0;
    if (!what || !nevh_scene_set_judged(scene, what))
        return TOOL_OK;
    if (!outcome_named(what) || nevh_scene_set_outcomes(scene, what))
        return scene_report(scene, o);
    return takes_outcomes
               ? TOOL_OK
               : tool_refuse("--observable %s is an outcome of a run: %s takes "
                             "values along the orbit; cost and compare take "
                             "both",
                             what, name);
}

static int apply_options(nevh_scene *scene, const options *o) {
    if (nevh_scene_status(scene))
        return scene_report(scene, o);
    for (size_t i = 0; i < o->settings.count; i++)
        if (assign(scene, o, o->settings.item[i]))
            return TOOL_USAGE;
    if (nevh_scene_vary(scene, (const char *const *)o->vary.item,
                        o->vary.count))
        return scene_report(scene, o);
    if (o->outcomes && nevh_scene_set_outcomes(scene, o->outcomes))
        return scene_report(scene, o);
    if (o->transform && nevh_scene_set_transform(scene, o->transform))
        return scene_report(scene, o);
    if (observe(scene, o))
        return TOOL_USAGE;
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
        if (strchr("+-", o->settings.item[i][0]))
            effects[how.n_effects++] = o->settings.item[i];
    return nevh_scene_read_with(file, &how);
}

int scene_open_named(nevh_scene **scene, const char *name, const options *o) {
    *scene = NULL;
    char *file = find(name);
    if (!file)
        return TOOL_USAGE;
    *scene = read_switched(file, o);
    if (*scene && !outputs_check(o, *scene, file) && !apply_options(*scene, o))
        return TOOL_OK;
    if (!*scene)
        tool_refuse("out of memory");
    nevh_scene_free(*scene);
    *scene = NULL;
    return TOOL_USAGE;
}

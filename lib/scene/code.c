/* nevh: a file of C becomes functions: the system's compiler makes a shared
   object of it, in a folder of its own, which is gone once that is loaded.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700
#include "scene/code_private.h"
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST_OUTPUT = 1200, NO_COMMAND = 127 };

/* As a word for the shell; NULL when memory is out. */
static char *quote(const char *text) {
    char *word = malloc(4 * strlen(text) + 3), *to = word;
    if (!word)
        return NULL;
    *to++ = '\'';
    for (; *text; text++)
        if (*text == '\'')
            to += sprintf(to, "'\\''");
        else
            *to++ = *text;
    strcpy(to, "'");
    return word;
}

/* Runs a command; its exit status, or -1.  The beginning of what it says is
   kept. */
static int obey(const char *command, char output[MOST_OUTPUT + 1]) {
    char rest[512];
    FILE *pipe = popen(command, "r");
    if (!pipe)
        return -1;
    size_t used = fread(output, 1, MOST_OUTPUT, pipe);
    output[used] = '\0';
    while (fread(rest, 1, sizeof rest, pipe))
        ;
    int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The shell removes the folder when an interruption ends all of us. */
static int compile(const char *path, const char *folder,
                   char output[MOST_OUTPUT + 1]) {
    char *file = quote(path), *in = quote(folder);
    char *command =
        file && in
            ? nevh__text("d=%s; trap 'rm -rf \"$d\"; exit 1' HUP INT TERM; "
                         "${CC:-cc} -O2 -ffp-contract=off -fPIC -shared -o "
                         "\"$d/term.so\" %s -lm 2>&1",
                         in, file)
            : NULL;
    int status = command ? obey(command, output) : -1;
    free(file);
    free(in);
    free(command);
    return status;
}

static void keep_output(nevh__code *code, const char *output) {
    size_t bytes = strlen(output);
    while (bytes && output[bytes - 1] == '\n')
        bytes--;
    code->output = nevh__text("%.*s", (int)bytes, output);
}

/* The way from an object's address to a function's that POSIX names. */
static bool find_functions(nevh__code *code) {
    *(void **)&code->value = dlsym(code->library, "value");
    *(void **)&code->gradient = dlsym(code->library, "gradient");
    return code->value;
}

static const char *load(const char *path, const char *folder,
                        const char *object, nevh__code *code) {
    char output[MOST_OUTPUT + 1] = "";
    int status = compile(path, folder, output);
    if (status == NO_COMMAND)
        return "%s needs a C compiler, and there is none: install one, or name "
               "it in the environment, CC=...";
    if (status) {
        keep_output(code, output);
        return "%s does not compile:";
    }
    code->library = dlopen(object, RTLD_NOW | RTLD_LOCAL);
    if (!code->library) {
        const char *why = dlerror();
        keep_output(code, why ? why : "");
        return "%s cannot be loaded:";
    }
    return find_functions(code)
               ? NULL
               : "%s defines no function double value(double t, const double "
                 "q[], const double p[], const double c[])";
}

static char *new_folder(void) {
    const char *where = getenv("TMPDIR");
    char *folder =
        nevh__text("%s/nevh-XXXXXX", where && *where ? where : "/tmp");
    if (folder && mkdtemp(folder))
        return folder;
    free(folder);
    return NULL;
}

bool nevh__code_load(const char *path, nevh__code *code, const char **what) {
    char *folder = new_folder();
    char *object = folder ? nevh__text("%s/term.so", folder) : NULL;
    *code = (nevh__code){0};
    *what = object ? load(path, folder, object, code)
                   : "%s needs a folder to be compiled in, and none can be "
                     "made: TMPDIR=... may name one";
    if (object)
        unlink(object);
    if (folder)
        rmdir(folder);
    free(object);
    free(folder);
    return !*what;
}

bool nevh__folder_of(const char *path, char **folder) {
    const char *slash = strrchr(path, '/');
    char *given = slash ? nevh__text("%.*s", (int)(slash - path) + 1, path)
                        : nevh__text("%s", ".");
    errno = 0;
    *folder = given ? realpath(given, NULL) : NULL;
    bool starved = !given || (!*folder && errno == ENOMEM);
    free(given);
    return !starved;
}

void nevh__code_unload(nevh__code *code) {
    if (code->library)
        dlclose(code->library);
    free(code->output);
    *code = (nevh__code){0};
}

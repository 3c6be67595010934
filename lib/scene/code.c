/* nevh: a file of C becomes functions: the system's compiler makes a shared
   object of it, in a folder of its own, which is gone once that is loaded.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700
#include "scene/code_private.h"
#include "native/compiler_private.h"
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const flags[] = {"-O2", "-ffp-contract=off", "-fPIC",
                                    "-shared", NULL};

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

static const char *code_load(const char *path, const char *folder,
                             const char *object, const sigset_t *before,
                             nevh__code *code) {
    nevh__compiling run;
    nevh__compile_begin(&(nevh__compilation){flags, path, object, folder},
                        before, &run);
    nevh__compile_await(&run, 1, before, NEVH__LONGEST_COMPILATION);
    if (run.output.interrupted)
        return "%s was not compiled: a signal ended its compiler";
    if (run.output.late)
        return "%s was not compiled: the C compiler took more than two minutes";
    if (run.status == NEVH__NO_COMPILER)
        return "%s needs a C compiler, and there is none: install one, or name "
               "it in the environment, CC=...";
    if (run.status) {
        keep_output(code, run.output.text);
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

bool nevh__code_load(const char *path, nevh__code *code, const char **what) {
    sigset_t before;
    nevh__signals_hold(&before);
    char *folder = nevh__new_folder();
    char *object = folder ? nevh__text("%s/term.so", folder) : NULL;
    *code = (nevh__code){0};
    *what = object ? code_load(path, folder, object, &before, code)
                   : "%s needs a folder to be compiled in, and none can be "
                     "made: TMPDIR=... may name one";
    if (folder)
        nevh__folder_remove(folder);
    free(object);
    free(folder);
    nevh__signals_release(&before);
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

/* nevh: C text becomes a library that is loaded, and kept for the next time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700
#include "native/compiler_private.h"
#include "native/native_private.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* What changes no result, and the vectors that the library itself takes. */
static const char *const most[] = {"-O2",
                                   "-ffp-contract=off",
                                   "-fno-math-errno",
                                   "-fno-trapping-math",
                                   "-fno-tree-slp-vectorize",
                                   "-fno-plt",
                                   "-fPIC",
                                   "-shared",
                                   "-w",
                                   NULL,
                                   NULL};
enum { LAST = sizeof most / sizeof *most - 2 };

static const char *processor(void) {
    int lanes = nevh__vector_lanes();
    return lanes == 8   ? "-march=x86-64-v4"
           : lanes == 4 ? "-march=x86-64-v3"
                        : NULL;
}

typedef struct {
    uint64_t part[2];
} key;

static void add_bytes(key *k, const void *from, size_t count) {
    const unsigned char *bytes = from;
    for (size_t i = 0; i < count; i++) {
        k->part[0] = (k->part[0] ^ bytes[i]) * 0x100000001b3u;
        k->part[1] = (k->part[1] + bytes[i] + 1) * 0x9e3779b97f4a7c15u;
        k->part[1] ^= k->part[1] >> 32;
    }
}

/* A command is another one once its file has changed. */
static void add_command(key *k, char *name) {
    char *rest = NULL;
    for (char *word = strtok_r(name, " \t\n", &rest); word;
         word = strtok_r(NULL, " \t\n", &rest)) {
        struct stat found;
        char *path = nevh__command_find(word);
        add_bytes(k, word, strlen(word) + 1);
        if (path && !stat(path, &found)) {
            add_bytes(k, path, strlen(path) + 1);
            add_bytes(k, &found.st_size, sizeof found.st_size);
            add_bytes(k, &found.st_mtime, sizeof found.st_mtime);
        }
        free(path);
    }
}

static key key_of(const char *source, const char *const flags[]) {
    key k = {{0xcbf29ce484222325u, 0x2545f4914f6cdd1du}};
    char *name = nevh__compiler_name();
    add_bytes(&k, source, strlen(source) + 1);
    for (; *flags; flags++)
        add_bytes(&k, *flags, strlen(*flags) + 1);
    if (name)
        add_command(&k, name);
    free(name);
    return k;
}

static void *open_library(const char *path, char why[NEVH__WHY_NATIVE]) {
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char *wrong = dlerror();
        snprintf(why, NEVH__WHY_NATIVE, "%.300s", wrong ? wrong : "");
    }
    return library;
}

static bool write_source(const char *path, const char *source) {
    FILE *file = fopen(path, "w");
    bool fine = file && fputs(source, file) >= 0;
    return file && fclose(file) == 0 && fine;
}

/* The first line that is an error; where there is none, the first. */
static const char *first_error(const char *text) {
    static const char mark[] = "error: ";
    const char *error = strstr(text, mark);
    return error ? error + sizeof mark - 1 : text;
}

static void tell(const nevh__compiler_output *output, int status,
                 char why[NEVH__WHY_NATIVE]) {
    if (output->interrupted)
        snprintf(why, NEVH__WHY_NATIVE, "a signal ended the compiler");
    else if (output->late)
        snprintf(why, NEVH__WHY_NATIVE,
                 "the C compiler took more than two minutes");
    else if (status == NEVH__NO_COMPILER)
        snprintf(why, NEVH__WHY_NATIVE,
                 "there is no C compiler: install one, or name it in the "
                 "environment, CC=...");
    else {
        const char *error = first_error(output->text);
        snprintf(why, NEVH__WHY_NATIVE, "the C compiler fails: %.*s",
                 (int)strcspn(error, "\n"), error);
    }
}

static bool compile(const char *source, const char *const flags[],
                    const char *folder, const char *object,
                    const sigset_t *before, char why[NEVH__WHY_NATIVE]) {
    nevh__compiler_output output = {.used = 0};
    char *path = nevh__text("%s/steps.c", folder);
    int status = -1;
    if (path && write_source(path, source))
        status = nevh__compile(flags, path, object, folder, before, &output);
    if (status)
        tell(&output, status, why);
    free(path);
    return status == 0;
}

/* A signal takes its course when the folder is gone. */
static void *build(const char *source, const char *const flags[],
                   const char *cache, const char *kept,
                   char why[NEVH__WHY_NATIVE]) {
    sigset_t before;
    nevh__signals_hold(&before);
    char *folder = nevh__new_folder();
    char *object = folder ? nevh__text("%s/steps.so", folder) : NULL;
    void *library = NULL;
    if (!object)
        snprintf(why, NEVH__WHY_NATIVE, "no folder can be made to compile in");
    else if (compile(source, flags, folder, object, &before, why)) {
        bool stored = kept && nevh__cache_store(cache, object, kept);
        library = open_library(stored ? kept : object, why);
    }
    if (folder)
        nevh__folder_remove(folder);
    free(object);
    free(folder);
    nevh__signals_release(&before);
    return library;
}

void *nevh__native_load(const char *source, const char *cache, bool may_compile,
                        char why[NEVH__WHY_NATIVE]) {
    const char *flags[sizeof most / sizeof *most];
    memcpy(flags, most, sizeof most);
    flags[LAST] = processor();
    key k = key_of(source, flags);
    char *folder = cache && !*cache ? NULL : nevh__cache_folder(cache, why);
    char *kept = folder ? nevh__text("%s/%016llx%016llx.so", folder,
                                     (unsigned long long)k.part[0],
                                     (unsigned long long)k.part[1])
                        : NULL;
    void *library = NULL;
    if (kept && nevh__cache_is_whole(kept))
        library = open_library(kept, why);
    if (!library && may_compile)
        library = build(source, flags, folder, kept, why);
    free(kept);
    free(folder);
    return library;
}

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

static void tell(const nevh__compiling *run, char why[NEVH__WHY_NATIVE]) {
    if (run->output.interrupted)
        snprintf(why, NEVH__WHY_NATIVE, "a signal ended the compiler");
    else if (run->output.late)
        snprintf(why, NEVH__WHY_NATIVE,
                 "the C compiler took more than two minutes");
    else if (run->status == NEVH__NO_COMPILER)
        snprintf(why, NEVH__WHY_NATIVE,
                 "there is no C compiler: install one, or name it in the "
                 "environment, CC=...");
    else {
        const char *error = first_error(run->output.text);
        snprintf(why, NEVH__WHY_NATIVE, "the C compiler fails: %.*s",
                 (int)strcspn(error, "\n"), error);
    }
}

/* The flags, and the name of what is compiled in the cache. */
typedef struct {
    const char *flags[sizeof most / sizeof *most];
    char *cache, *kept; /* NULL: there is none */
} place;

/* cache: as of nevh__native_load */
static place place_of(const char *source, const char *cache,
                      char why[NEVH__WHY_NATIVE]) {
    place p = {.kept = NULL};
    memcpy(p.flags, most, sizeof most);
    p.flags[LAST] = processor();
    key k = key_of(source, p.flags);
    p.cache = cache && !*cache ? NULL : nevh__cache_folder(cache, why);
    if (p.cache)
        p.kept = nevh__text("%s/%016llx%016llx.so", p.cache,
                            (unsigned long long)k.part[0],
                            (unsigned long long)k.part[1]);
    return p;
}

static void free_place(place *p) {
    free(p->kept);
    free(p->cache);
}

/* What a text is compiled from and to. */
typedef struct {
    char *folder, *object, *source; /* NULL: no folder could be made */
} files;

static void begin(files *f, const char *source, const place *p,
                  const sigset_t *before, nevh__compiling *run) {
    f->folder = nevh__new_folder();
    f->object = f->folder ? nevh__text("%s/steps.so", f->folder) : NULL;
    f->source = f->object ? nevh__text("%s/steps.c", f->folder) : NULL;
    *run = (nevh__compiling){.status = -1};
    if (f->source && write_source(f->source, source))
        nevh__compile_begin(p->flags, f->source, f->object, f->folder, before,
                            run);
}

static void remove_files(files *f) {
    if (f->folder)
        nevh__folder_remove(f->folder);
    free(f->source);
    free(f->object);
    free(f->folder);
}

/* A signal takes its course when the folder is gone. */
static void *build(const char *source, const place *p,
                   char why[NEVH__WHY_NATIVE]) {
    sigset_t before;
    files f;
    nevh__compiling run;
    void *library = NULL;
    nevh__signals_hold(&before);
    begin(&f, source, p, &before, &run);
    nevh__compile_await(&run, 1, &before);
    if (!f.object)
        snprintf(why, NEVH__WHY_NATIVE, "no folder can be made to compile in");
    else if (run.status)
        tell(&run, why);
    else {
        bool stored = p->kept && nevh__cache_store(p->cache, f.object, p->kept);
        library = open_library(stored ? p->kept : f.object, why);
    }
    remove_files(&f);
    nevh__signals_release(&before);
    return library;
}

void *nevh__native_load(const char *source, const char *cache, bool may_compile,
                        char why[NEVH__WHY_NATIVE]) {
    place p = place_of(source, cache, why);
    void *library = NULL;
    if (p.kept && nevh__cache_is_whole(p.kept))
        library = open_library(p.kept, why);
    if (!library && may_compile)
        library = build(source, &p, why);
    free_place(&p);
    return library;
}

static bool is_missing(const place *p) {
    return p->kept && !nevh__cache_is_whole(p->kept);
}

static size_t processors(void) {
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count < 1                      ? 1
           : count > NEVH__MOST_COMPILERS ? NEVH__MOST_COMPILERS
                                          : (size_t)count;
}

/* The first texts, as many as there are processors to compile them.
   returns  how many are in the cache now: 0, and why, where one is not */
static size_t build_some(char *const sources[], size_t count, const char *cache,
                         const sigset_t *before, char why[NEVH__WHY_NATIVE]) {
    files f[NEVH__MOST_COMPILERS];
    place p[NEVH__MOST_COMPILERS];
    nevh__compiling run[NEVH__MOST_COMPILERS];
    size_t begun = 0, most_begun = processors(), next = 0;
    bool fine = true;
    for (; next < count && begun < most_begun; next++) {
        p[begun] = place_of(sources[next], cache, why);
        if (is_missing(&p[begun])) {
            begin(&f[begun], sources[next], &p[begun], before, &run[begun]);
            begun++;
        } else
            free_place(&p[begun]);
    }
    nevh__compile_await(run, begun, before);
    for (size_t i = 0; i < begun; i++) {
        if (run[i].status && fine)
            tell(&run[i], why);
        fine &= !run[i].status;
        if (!run[i].status)
            nevh__cache_store(p[i].cache, f[i].object, p[i].kept);
        remove_files(&f[i]);
        free_place(&p[i]);
    }
    return fine ? next : 0;
}

size_t nevh__native_build(char *const sources[], size_t count,
                          const char *cache, char why[NEVH__WHY_NATIVE]) {
    sigset_t before;
    size_t done = 0, more = 1;
    nevh__signals_hold(&before);
    for (; done < count && more; done += more)
        more = build_some(sources + done, count - done, cache, &before, why);
    nevh__signals_release(&before);
    return done;
}

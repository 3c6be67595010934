/* nevh: C text becomes a library that is loaded, and kept for the next time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700
#include "native/compiler_private.h"
#include "native/native_private.h"
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
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

/* folder: given away; NULL: none could be made */
static void begin(files *f, char *folder, const char *source, const place *p,
                  const sigset_t *before, nevh__compiling *run) {
    f->folder = folder;
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

static void *open_compiled(const files *f, const place *p,
                           char why[NEVH__WHY_NATIVE]) {
    bool stored = p->kept && nevh__cache_store(p->cache, f->object, p->kept);
    return open_library(stored ? p->kept : f->object, why);
}

/* A signal takes its course when the folder is gone. */
static void *build(const char *source, const place *p,
                   char why[NEVH__WHY_NATIVE]) {
    sigset_t before;
    files f;
    nevh__compiling run;
    void *library = NULL;
    nevh__signals_hold(&before);
    begin(&f, nevh__new_folder(), source, p, &before, &run);
    nevh__compile_await(&run, 1, &before);
    if (!f.object)
        snprintf(why, NEVH__WHY_NATIVE, "no folder can be made to compile in");
    else if (run.status)
        tell(&run, why);
    else
        library = open_compiled(&f, p, why);
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
            begin(&f[begun], nevh__new_folder(), sources[next], &p[begun],
                  before, &run[begun]);
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

/* A compiler that a thread waits for.  A file beside what is to be kept is locked
   meanwhile: a second program, or stepper, waits for that lock, and not for a
   program that was killed. */
struct nevh__background {
    pthread_t thread;
    pid_t process;
    place p;
    files f;
    nevh__compiling run;
    char *lock_path;
    int lock;
    bool waits; /* for the lock: another compiler is at work */
    void *library;
    nevh__steps_at_work *steps;
    atomic_bool done;
    char why[NEVH__WHY_NATIVE];
};

static void *load_other(nevh__background *b) {
    while (flock(b->lock, LOCK_EX) && errno == EINTR)
        continue;
    if (nevh__cache_is_whole(b->p.kept))
        return open_library(b->p.kept, b->why);
    snprintf(b->why, NEVH__WHY_NATIVE,
             "the C compiler of another program fails");
    return NULL;
}

static void *load_own(nevh__background *b) {
    sigset_t all;
    void *library = NULL;
    sigfillset(&all); /* signals are for other threads */
    nevh__compile_await(&b->run, 1, &all);
    if (b->run.status)
        tell(&b->run, b->why);
    else
        library = open_compiled(&b->f, &b->p, b->why);
    nevh__folder_remove(b->f.folder);
    unlink(b->lock_path);
    flock(b->lock, LOCK_UN); /* a copy of the process has the file open, too */
    return library;
}

static void *await_compiler(void *data) {
    nevh__background *b = data;
    nevh__native_steps steps = NULL;
    b->library = b->waits ? load_other(b) : load_own(b);
    if (b->library)
        *(void **)&steps = dlsym(b->library, "nevh_native_steps");
    atomic_store(b->steps, steps);
    atomic_store(&b->done, true);
    return NULL;
}

static void free_background(nevh__background *b) {
    if (b->lock >= 0)
        close(b->lock);
    free(b->lock_path);
    free(b->f.folder);
    free(b->f.object);
    free(b->f.source);
    free_place(&b->p);
    free(b);
}

/* returns  whether there is one to hold, or to wait for */
static bool open_lock(nevh__background *b) {
    b->lock_path = b->p.kept ? nevh__text("%s.lock", b->p.kept) : NULL;
    if (b->lock_path)
        b->lock = open(b->lock_path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    b->waits = b->lock >= 0 && flock(b->lock, LOCK_EX | LOCK_NB);
    return b->lock >= 0 && (!b->waits || errno == EWOULDBLOCK);
}

/* In the cache, where a killed program's folder is removed once it is old. */
static char *folder_in_cache(const nevh__background *b) {
    char *folder = nevh__text("%s.%ld", b->p.kept, (long)b->process);
    if (folder && !mkdir(folder, 0700))
        return folder;
    free(folder);
    return NULL;
}

static void start_compiler(nevh__background *b, const char *source) {
    sigset_t before;
    nevh__signals_hold(&before);
    begin(&b->f, folder_in_cache(b), source, &b->p, &before, &b->run);
    nevh__signals_release(&before);
}

static bool start_thread(nevh__background *b) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    bool started = !pthread_create(&b->thread, NULL, await_compiler, b);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return started;
}

/* Ends what no thread waits for. */
static void abandon(nevh__background *b) {
    sigset_t all;
    sigfillset(&all);
    nevh__compile_await(&b->run, 1, &all);
    if (b->f.folder)
        nevh__folder_remove(b->f.folder);
    if (b->lock >= 0 && !b->waits)
        unlink(b->lock_path);
    free_background(b);
}

nevh__background *nevh__background_begin(const char *source, const char *cache,
                                         nevh__steps_at_work *steps) {
    char why[NEVH__WHY_NATIVE];
    nevh__background *b = nevh__array(1, sizeof *b);
    if (!b)
        return NULL;
    b->steps = steps;
    b->process = getpid();
    b->lock = -1;
    b->p = place_of(source, cache, why);
    bool opened = open_lock(b);
    if (opened && !b->waits)
        start_compiler(b, source);
    if (opened && (b->waits || b->run.child) && start_thread(b))
        return b;
    abandon(b);
    return NULL;
}

bool nevh__background_is_done(nevh__background *b) {
    return atomic_load(&b->done);
}

/* A copy of the process has no such thread. */
void *nevh__background_end(nevh__background *b, char why[NEVH__WHY_NATIVE]) {
    if (b->process != getpid()) {
        snprintf(why, NEVH__WHY_NATIVE, "the compiler is another process's");
        return NULL;
    }
    pthread_join(b->thread, NULL);
    void *library = b->library;
    if (!library)
        memcpy(why, b->why, sizeof b->why);
    free_background(b);
    return library;
}

/* nevh: C text becomes a library that is loaded, and kept for the next time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700
#include "native/compiler_private.h"
#include "native/native_private.h"
#include "system/print_private.h"
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <fenv.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* Flags that change no result and undo what words of CC may change, and the vectors
   that the library itself takes. */
static const char *const most[] = {"-O2",
                                   "-fno-fast-math",
                                   "-fno-unsafe-math-optimizations",
                                   "-fno-associative-math",
                                   "-fno-reciprocal-math",
                                   "-fno-finite-math-only",
                                   "-fsigned-zeros",
                                   "-ffp-contract=off",
                                   "-fno-sanitize=all",
                                   "-fvisibility=default",
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
static void add_word(key *k, const char *word) {
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

static key key_of(const char *source, const char *const flags[]) {
    key k = {{0xcbf29ce484222325u, 0x2545f4914f6cdd1du}};
    char **words = nevh__compiler_words();
    add_bytes(&k, source, strlen(source) + 1);
    for (; *flags; flags++)
        add_bytes(&k, *flags, strlen(*flags) + 1);
    for (char **word = words; word && *word; word++)
        add_word(&k, *word);
    free(words);
    return k;
}

/* Only a library that has steps, or a series. */
static void *open_library(const char *path, char why[NEVH__WHY_NATIVE]) {
    fenv_t own; /* a library that was linked for speed alone may change it */
    fegetenv(&own);
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    fesetenv(&own);
    if (!library) {
        const char *wrong = dlerror();
        snprintf(why, NEVH__WHY_NATIVE, "%.300s", wrong ? wrong : "");
    } else if (!dlsym(library, "nevh_native_steps") &&
               !dlsym(library, "nevh_native_series")) {
        snprintf(why, NEVH__WHY_NATIVE,
                 "what the C compiler makes has no steps");
        dlclose(library);
        library = NULL;
    }
    return library;
}

static bool write_source(const char *path, const char *source) {
    FILE *file = fopen(path, "we");
    bool fine = file && fputs(source, file) >= 0;
    return file && fclose(file) == 0 && fine;
}

/* The flags, and the name of what is compiled in the cache. */
typedef struct {
    const char *flags[sizeof most / sizeof *most];
    char *cache, *kept; /* NULL: there is none */
    char *late; /* a file as old as the compiler's last failure to end */
} place;

/* In the cache; where there is none, a file of this user's beside those of all. */
static char *late_name(const char *cache, const char *const flags[]) {
    const char *where = getenv("TMPDIR");
    unsigned long long compiler = key_of("", flags).part[0];
    if (cache)
        return nevh__text("%s/%016llx.late", cache, compiler);
    return nevh__text("%s/nevh-%lu-%016llx.late",
                      where && *where ? where : "/tmp",
                      (unsigned long)geteuid(), compiler);
}

/* cache: as of nevh__native_load */
static place place_of(const char *source, const char *cache,
                      char why[NEVH__WHY_NATIVE]) {
    place p = {.kept = NULL};
    memcpy(p.flags, most, sizeof most);
    p.flags[LAST] = processor();
    key k = key_of(source, p.flags);
    p.cache = cache && !*cache ? NULL : nevh__cache_folder(cache, why);
    p.late = late_name(p.cache, p.flags);
    if (p.cache)
        p.kept = nevh__text("%s/%016llx%016llx.so", p.cache,
                            (unsigned long long)k.part[0],
                            (unsigned long long)k.part[1]);
    return p;
}

static void free_place(place *p) {
    free(p->late);
    free(p->kept);
    free(p->cache);
}

/* True if a compiler that took too long is to be left alone, so that a command that
   has many texts waits for it once; the caller that waits longest asks all the
   same.  A note that is older than that is removed. */
static bool was_late(const place *p, double seconds,
                     char why[NEVH__WHY_NATIVE]) {
    enum { APART = 600 };
    struct stat found;
    if (seconds >= NEVH__LONGEST_COMPILATION || !p->late ||
        lstat(p->late, &found) || found.st_uid != geteuid())
        return false;
    double age = difftime(time(NULL), found.st_mtime);
    if (age < 0 || age > APART) {
        unlink(p->late);
        return false;
    }
    snprintf(why, NEVH__WHY_NATIVE, "%s", NEVH__TOO_LONG);
    return true;
}

static void note_late(const place *p) {
    int file = p->late ? open(p->late,
                              O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600)
                       : -1;
    if (file < 0)
        return;
    futimens(file, NULL);
    close(file);
}

/* The source and the object of a compilation. */
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
    if (!f->source)
        snprintf(run->output.text, sizeof run->output.text,
                 "no folder can be made to compile in");
    else if (!write_source(f->source, source))
        snprintf(run->output.text, sizeof run->output.text,
                 "%.300s cannot be written: %s", f->source, strerror(errno));
    else
        nevh__compile_begin(
            &(nevh__compilation){p->flags, f->source, f->object, f->folder},
            before, run);
}

static void remove_files(files *f) {
    if (f->folder)
        nevh__folder_remove(f->folder);
    free(f->source);
    free(f->object);
    free(f->folder);
}

/* A compiled library is kept once it is known to have steps. */
static void *open_compiled(const nevh__compiling *run, const files *f,
                           const place *p, char why[NEVH__WHY_NATIVE]) {
    if (run->output.late)
        note_late(p);
    if (run->status) {
        nevh__compiler_tell(run, why, NEVH__WHY_NATIVE);
        return NULL;
    }
    void *library = open_library(f->object, why);
    if (library && p->kept)
        nevh__cache_store(p->cache, f->object, p->kept);
    return library;
}

/* The library in the cache. */
static void *open_kept(const place *p, char why[NEVH__WHY_NATIVE]) {
    return p->kept && nevh__cache_is_whole(p->kept) ? open_library(p->kept, why)
                                                    : NULL;
}

/* A signal takes its course when the folder is gone. */
static void *build(const char *source, const place *p, double seconds,
                   char why[NEVH__WHY_NATIVE]) {
    sigset_t before;
    files f;
    nevh__compiling run;
    if (was_late(p, seconds, why))
        return NULL;
    nevh__signals_hold(&before);
    begin(&f, nevh__new_folder(), source, p, &before, &run);
    nevh__compile_await(&run, 1, &before, seconds);
    void *library = open_compiled(&run, &f, p, why);
    remove_files(&f);
    nevh__signals_release(&before);
    return library;
}

void *nevh__native_load(const char *source, const char *cache, double seconds,
                        char why[NEVH__WHY_NATIVE]) {
    place p = place_of(source, cache, why);
    void *library = open_kept(&p, why);
    if (!library && seconds > 0)
        library = build(source, &p, seconds, why);
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
                         double seconds, const sigset_t *before,
                         char why[NEVH__WHY_NATIVE]) {
    files f[NEVH__MOST_COMPILERS];
    place p[NEVH__MOST_COMPILERS];
    nevh__compiling run[NEVH__MOST_COMPILERS];
    char other[NEVH__WHY_NATIVE];
    size_t begun = 0, most_begun = processors(), next = 0;
    bool fine = true;
    for (; next < count && begun < most_begun; next++) {
        p[begun] = place_of(sources[next], cache, why);
        if (is_missing(&p[begun]) && was_late(&p[begun], seconds, why)) {
            free_place(&p[begun]);
            fine = false;
        } else if (is_missing(&p[begun])) {
            begin(&f[begun], nevh__new_folder(), sources[next], &p[begun],
                  before, &run[begun]);
            begun++;
        } else
            free_place(&p[begun]);
    }
    nevh__compile_await(run, begun, before, seconds);
    for (size_t i = 0; i < begun; i++) {
        void *library =
            open_compiled(&run[i], &f[i], &p[i], fine ? why : other);
        fine &= library != NULL;
        if (library)
            dlclose(library);
        remove_files(&f[i]);
        free_place(&p[i]);
    }
    return fine ? next : 0;
}

size_t nevh__native_build(char *const sources[], size_t count,
                          const char *cache, double seconds,
                          char why[NEVH__WHY_NATIVE]) {
    sigset_t before;
    size_t done = 0, more = 1;
    nevh__signals_hold(&before);
    for (; done < count && more; done += more)
        more = build_some(sources + done, count - done, cache, seconds, &before,
                          why);
    nevh__signals_release(&before);
    return done;
}

/* A compiler that a thread waits for.  A file beside what is to be kept is locked
   meanwhile: a second program, or stepper, waits for that lock as long as it would
   for a compiler, and goes on where the first one was killed, or fails.  Nobody
   holds it longer than a compiler may take: a waiting one gives it up as soon as it
   has it and finds the steps. */
struct nevh__background {
    pthread_t thread;
    pid_t process;
    char *source;
    double seconds; /* at most */
    sigset_t before;
    place p;
    files f;
    nevh__compiling run;
    char *lock_path;
    int lock;
    void *library;
    nevh__steps_at_work *steps;
    atomic_bool unwanted, done;
    char why[NEVH__WHY_NATIVE];
};

/* Without a lock that can be had, two compilers may be at work at the same steps.
   returns  whether it waits no more for another one */
static bool take_lock(nevh__background *b) {
    enum { LOOKS_APART = 10 }; /* milliseconds */
    const struct timespec pause = {.tv_nsec = LOOKS_APART * 1000000L};
    double looks = b->seconds * 1000 / LOOKS_APART;
    if (b->lock < 0)
        return true;
    while (flock(b->lock, LOCK_EX | LOCK_NB)) {
        if (errno != EWOULDBLOCK && errno != EINTR)
            return true;
        if (atomic_load(&b->unwanted) || looks-- <= 0)
            return false;
        nanosleep(&pause, NULL);
    }
    return true;
}

/* A copy of the process has the file open, too. */
static void give_up_lock(nevh__background *b) {
    if (b->lock < 0)
        return;
    unlink(b->lock_path);
    flock(b->lock, LOCK_UN);
}

/* In the cache, where a killed program's folder is removed once it is old. */
static char *folder_in_cache(const nevh__background *b) {
    char *folder = nevh__text("%s.%ld.XXXXXX", b->p.kept, (long)b->process);
    if (folder && mkdtemp(folder))
        return folder;
    free(folder);
    return NULL;
}

static void *compile(nevh__background *b) {
    sigset_t all;
    if (was_late(&b->p, b->seconds, b->why))
        return NULL;
    sigfillset(&all); /* signals are for other threads */
    begin(&b->f, folder_in_cache(b), b->source, &b->p, &b->before, &b->run);
    nevh__compile_await(&b->run, 1, &all, b->seconds);
    void *library = open_compiled(&b->run, &b->f, &b->p, b->why);
    remove_files(&b->f);
    return library;
}

static void *await_compiler(void *data) {
    nevh__background *b = data;
    nevh__compiled_steps steps = NULL;
    if (take_lock(b)) {
        b->library = open_kept(&b->p, b->why);
        if (!b->library && !atomic_load(&b->unwanted))
            b->library = compile(b);
        give_up_lock(b);
    } else
        nevh__print(b->why, NEVH__WHY_NATIVE,
                    "another program has compiled them for %.0f seconds",
                    b->seconds);
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
    free(b->source);
    free_place(&b->p);
    free(b);
}

static void open_lock(nevh__background *b) {
    b->lock_path = nevh__text("%s.lock", b->p.kept);
    b->lock = b->lock_path
                  ? open(b->lock_path,
                         O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600)
                  : -1;
}

static bool start_thread(nevh__background *b) {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &b->before);
    bool started = !pthread_create(&b->thread, NULL, await_compiler, b);
    pthread_sigmask(SIG_SETMASK, &b->before, NULL);
    return started;
}

nevh__background *nevh__background_begin(const char *source, const char *cache,
                                         double seconds,
                                         nevh__steps_at_work *steps) {
    char why[NEVH__WHY_NATIVE];
    nevh__background *b = nevh__array(1, sizeof *b);
    if (!b)
        return NULL;
    b->steps = steps;
    b->process = getpid();
    b->lock = -1;
    b->seconds = seconds;
    b->source = nevh__text("%s", source);
    b->p = place_of(source, cache, why);
    if (b->source && b->p.kept) {
        open_lock(b);
        if (start_thread(b))
            return b;
    }
    free_background(b);
    return NULL;
}

bool nevh__background_is_done(nevh__background *b) {
    return atomic_load(&b->done);
}

/* A copy of the process has no such thread. */
void *nevh__background_end(nevh__background *b, bool wanted,
                           char why[NEVH__WHY_NATIVE]) {
    if (b->process != getpid()) {
        snprintf(why, NEVH__WHY_NATIVE, "the compiler is another process's");
        return NULL;
    }
    if (!wanted)
        atomic_store(&b->unwanted, true);
    pthread_join(b->thread, NULL);
    void *library = b->library;
    if (!library)
        memcpy(why, b->why, sizeof b->why);
    free_background(b);
    return library;
}

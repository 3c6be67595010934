/* nevh tests: compiled steps without a compiler, or with a cache that cannot be used:
   everything goes on.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include "../support/native.h"
#include "native/native_private.h"
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

TEST(no_compiler) {
    nevh_scene *scene = parsed(pendulum);
    make_cache();
    const char *compiler = getenv("CC");
    char *before = compiler ? strdup(compiler) : NULL;
    setenv("CC", "no-such-compiler --really", 1);
    pair x = pair_new(scene, nevh_verlet, nevh_exact, false, cache);
    ck_assert(!nevh_stepper_native(x.native, NULL));
    assert_says(x.why, "there is no C compiler");
    ck_assert_int_eq(pair_run(&x, 0.1, 100), NEVH_OK);
    ck_assert(pair_same(&x));
    pair_free(&x);
    setenv("CC", "false", 1);
    x = pair_new(scene, nevh_verlet, nevh_exact, false, cache);
    ck_assert(!nevh_stepper_native(x.native, NULL));
    assert_says(x.why, "the C compiler fails");
    pair_free(&x);
    unsetenv("CC");
    if (before)
        setenv("CC", before, 1);
    free(before);
    nevh_scene_free(scene);
    remove_cache();
}

/* Nothing of a library is told about what it does not compile. */
TEST(others_are_not) {
    static const char whole[] = "[coordinates]\nx = 1\n[effects]\n"
                                "H = p_x^2/2 + bessel_j0(x)\n";
    nevh_scene *scene = parsed(pendulum), *special = parsed(whole);
    make_cache();
    pair x = pair_new(scene, nevh_gonzalez, nevh_exact, false, cache);
    ck_assert(!nevh_stepper_native(x.native, NULL));
    assert_says(x.why,
                "only splitting, Tao, Runge-Kutta, Nystroem, Gauss, "
                "Lobatto, adaptive Verlet steps and steps by parts can be");
    pair_free(&x);
    x = pair_new(special, nevh_verlet, nevh_exact, false, cache);
    ck_assert(!nevh_stepper_native(x.native, NULL));
    assert_says(x.why, "compiled steps do not have");
    ck_assert_int_eq(pair_run(&x, 0.1, 10), NEVH_OK);
    pair_free(&x);
    /* By default nothing is compiled, unless steps are foreseen. */
    nevh_options o = {.native_cache = cache};
    nevh_stepper *s =
        nevh_stepper_new(nevh_scene_system(scene), nevh_verlet, &o);
    ck_assert(!nevh_stepper_native(s, NULL));
    nevh_stepper_free(s);
    o.steps_foreseen = 1e9;
    s = nevh_stepper_new(nevh_scene_system(scene), nevh_verlet, &o);
    ck_assert(nevh_stepper_native(s, NULL) == has_compiler());
    nevh_stepper_free(s);
    nevh_scene_free(scene);
    nevh_scene_free(special);
    remove_cache();
}

/* The only file of the cache. */
static void find_file(char path[200]) {
    DIR *all = opendir(cache);
    size_t count = 0;
    for (struct dirent *entry; (entry = readdir(all));)
        if (entry->d_name[0] != '.') {
            snprintf(path, 200, "%s/%.100s", cache, entry->d_name);
            count++;
        }
    closedir(all);
    ck_assert_uint_eq(count, 1);
}

static bool is_native(nevh_scene *scene, const char *folder) {
    pair x = pair_new(scene, nevh_verlet, nevh_exact, false, folder);
    bool native = nevh_stepper_native(x.native, NULL);
    ck_assert_int_eq(pair_run(&x, 0.1, 100), NEVH_OK);
    ck_assert(pair_same(&x));
    pair_free(&x);
    return native;
}

/* What is kept is found without a compiler, but made anew once it is broken. */
TEST(cache_is_kept) {
    char path[200];
    struct stat found;
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = parsed(pendulum);
    make_cache();
    ck_assert(is_native(scene, cache));
    find_file(path);
    ck_assert_int_eq(stat(path, &found), 0);
    ck_assert_uint_eq(found.st_mode & 077, 0);
    ck_assert_int_eq(truncate(path, found.st_size / 2), 0);
    ck_assert(!nevh__cache_is_whole(path));
    ck_assert(is_native(scene, cache));
    ck_assert(nevh__cache_is_whole(path));
    /* Parameters are no part of it. */
    nevh_scene *other = parsed("[coordinates]\nphi = 1\n[effects]\n"
                               "T = p_phi^2/3\nV = -7.1*cos(phi)\n");
    nevh_scene *third = parsed("[coordinates]\nu = 1\n[effects]\n"
                               "kin = p_u^2/7\npot = -1.5*cos(u)\n");
    ck_assert(is_native(other, cache));
    ck_assert(is_native(third, cache));
    DIR *all = opendir(cache);
    size_t files = 0;
    for (struct dirent *entry; (entry = readdir(all));)
        files += entry->d_name[0] != '.';
    closedir(all);
    ck_assert_uint_le(files, 2);
    nevh_scene_free(third);
    nevh_scene_free(other);
    nevh_scene_free(scene);
    remove_cache();
}

/* Folders that others may write to are not used; steps are compiled all the
   same, and nothing is kept. */
TEST(cache_is_refused) {
    char why[NEVH__WHY_NATIVE] = "", inside[100];
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = parsed(pendulum);
    make_cache();
    ck_assert_int_eq(chmod(cache, 0777), 0);
    ck_assert_ptr_null(nevh__cache_folder(cache, why));
    assert_says(why, "may be written to by others");
    ck_assert(is_native(scene, cache));
    ck_assert_int_eq(rmdir(cache), 0); /* it is empty */
    ck_assert_int_eq(mkdir(cache, 0700), 0);
    snprintf(inside, sizeof inside, "%s/open", cache);
    ck_assert_int_eq(mkdir(inside, 0777), 0);
    ck_assert_int_eq(chmod(inside, 0777), 0);
    snprintf(inside, sizeof inside, "%s/open/nevh", cache);
    ck_assert_int_eq(mkdir(inside, 0700), 0);
    ck_assert_ptr_null(nevh__cache_folder(inside, why));
    assert_says(why, "in a folder that others may write to");
    ck_assert_int_eq(rmdir(inside), 0);
    snprintf(inside, sizeof inside, "%s/open", cache);
    ck_assert_int_eq(rmdir(inside), 0);
    snprintf(inside, sizeof inside, "%s/link", cache);
    ck_assert_int_eq(symlink("/tmp", inside), 0);
    ck_assert_ptr_null(nevh__cache_folder(inside, why));
    assert_says(why, "is no folder");
    ck_assert(is_native(scene, inside));
    if (geteuid() == 0) {
        ck_assert_int_eq(chown(cache, 12345, 12345), 0);
        ck_assert_ptr_null(nevh__cache_folder(cache, why));
        assert_says(why, "another user's");
        ck_assert(is_native(scene, cache));
    }
    ck_assert_int_eq(chmod(cache, 0500), 0); /* read-only, unless for root */
    ck_assert(is_native(scene, cache));
    ck_assert(is_native(scene, ""));
    chmod(cache, 0700);
    nevh_scene_free(scene);
    remove_cache();
}

TEST(processes_at_once) {
    enum { PROCESSES = 4 };
    pid_t child[PROCESSES];
    char path[200];
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = parsed(pendulum);
    make_cache();
    for (int i = 0; i < PROCESSES; i++) {
        child[i] = fork();
        if (!child[i])
            _exit(is_native(scene, cache) ? 0 : 1);
    }
    for (int i = 0; i < PROCESSES; i++) {
        int status;
        waitpid(child[i], &status, 0);
        ck_assert(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    find_file(path);
    ck_assert(nevh__cache_is_whole(path));
    ck_assert_int_eq(chmod(path, 0722), 0); /* others may write to it */
    ck_assert(!nevh__cache_is_whole(path));
    nevh_scene_free(scene);
    remove_cache();
}

/* A compiler that writes a line to a file, and waits for another one. */
static void write_compiler(const char *path) {
    FILE *file = fopen(path, "w");
    ck_assert_ptr_nonnull(file);
    fprintf(file, "#!/bin/sh\n"
                  "echo >>\"$0.starts\"\n"
                  "until test -e \"$0.may\"; do sleep 0.02; done\n"
                  "exec ${C_COMPILER:-cc} \"$@\"\n");
    fclose(file);
    ck_assert_int_eq(chmod(path, 0700), 0);
}

static off_t size_of(const char *path) {
    struct stat found;
    return stat(path, &found) ? 0 : found.st_size;
}

static nevh_stepper *foreseen(nevh_scene *scene, nevh_native_use native) {
    nevh_options o = {
        .native = native, .native_cache = cache, .steps_foreseen = 1e9};
    return nevh_stepper_new(nevh_scene_system(scene), nevh_gauss8, &o);
}

static int run_on(nevh_stepper *s, size_t steps, double y[2]) {
    return nevh_run(s, 0, 0.1, steps, &y[0], &y[1], NULL, 0);
}

static void set_compiler(const char *command) {
    const char *now = getenv("CC");
    if (now)
        setenv("C_COMPILER", now, 0);
    setenv("CC", command, 1);
}

static void reset_compiler(void) {
    const char *before = getenv("C_COMPILER");
    if (before)
        setenv("CC", before, 1);
    else
        unsetenv("CC");
    unsetenv("C_COMPILER");
}

/* Steps are the kernel's while the compiler is at work: the first stepper starts
   one, and the second waits for it. */
TEST(in_the_background) {
    char compiler[100], starts[120], may[120];
    double a[2] = {2, 0}, b[2] = {2, 0}, c[2] = {2, 0};
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = parsed(pendulum);
    make_cache();
    snprintf(compiler, sizeof compiler, "./%s/compiler", cache);
    snprintf(starts, sizeof starts, "%s.starts", compiler);
    snprintf(may, sizeof may, "%s.may", compiler);
    write_compiler(compiler);
    set_compiler(compiler);
    nevh_stepper *plain = foreseen(scene, NEVH_NATIVE_NEVER);
    nevh_stepper *first = foreseen(scene, NEVH_NATIVE_AUTO);
    nevh_stepper *second = foreseen(scene, NEVH_NATIVE_AUTO);
    for (int i = 0; i < 20; i++) {
        ck_assert_int_eq(run_on(plain, 50, a), NEVH_OK);
        ck_assert_int_eq(run_on(first, 50, b), NEVH_OK);
        ck_assert_int_eq(run_on(second, 50, c), NEVH_OK);
        if (i < 10) {
            ck_assert(nevh_stepper_compiles(first));
            ck_assert(nevh_stepper_compiles(second));
        } else {
            FILE *file = fopen(may, "w");
            ck_assert_ptr_nonnull(file);
            fclose(file);
        }
    }
    ck_assert(nevh_stepper_native(first, NULL));
    ck_assert(nevh_stepper_native(second, NULL));
    ck_assert(!nevh_stepper_compiles(first));
    ck_assert_int_eq(size_of(starts), 1);
    ck_assert_int_eq(run_on(plain, 50, a), NEVH_OK);
    ck_assert_int_eq(run_on(first, 50, b), NEVH_OK);
    ck_assert_int_eq(run_on(second, 50, c), NEVH_OK);
    ck_assert(memcmp(a, b, sizeof a) == 0 && memcmp(a, c, sizeof a) == 0);
    ck_assert_uint_eq(nevh_stepper_counts(plain).gradients,
                      nevh_stepper_counts(first).gradients);
    nevh_stepper_free(plain);
    nevh_stepper_free(first);
    nevh_stepper_free(second);
    nevh_scene_free(scene);
    reset_compiler();
    remove_cache();
}

/* Of a compiler that fails, and of a program that was killed while its own was at
   work. */
TEST(background_fails) {
    char path[200], lock[220], left[220];
    double a[2] = {2, 0};
    const char *why = NULL;
    struct timespec old[2] = {{.tv_sec = 1}, {.tv_sec = 1}};
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = parsed(pendulum);
    make_cache();
    nevh_stepper *s = foreseen(scene, NEVH_NATIVE_AUTO);
    ck_assert(nevh_stepper_native(s, NULL));
    nevh_stepper_free(s);
    set_compiler("false");
    s = foreseen(scene, NEVH_NATIVE_AUTO);
    for (int i = 0; nevh_stepper_compiles(s) && i < 1000; i++)
        usleep(2000);
    ck_assert(!nevh_stepper_compiles(s));
    ck_assert(!nevh_stepper_native(s, &why));
    assert_says(why, "the C compiler fails");
    ck_assert(!nevh_stepper_foresee(s, 1e12));
    ck_assert_int_eq(run_on(s, 50, a), NEVH_OK);
    nevh_stepper_free(s);
    find_file(path);
    ck_assert_int_eq(unlink(path), 0);
    reset_compiler();
    /* Another program at work, which ends without a result: this one goes on. */
    snprintf(lock, sizeof lock, "%s.lock", path);
    int file = open(lock, O_RDWR | O_CREAT, 0600);
    ck_assert_int_eq(flock(file, LOCK_EX), 0);
    s = foreseen(scene, NEVH_NATIVE_AUTO);
    ck_assert_int_eq(run_on(s, 50, a), NEVH_OK);
    ck_assert(nevh_stepper_compiles(s));
    close(file);
    ck_assert(nevh_stepper_native(s, &why));
    nevh_stepper_free(s);
    find_file(path);
    ck_assert_int_eq(unlink(path), 0);
    /* One that was killed left its lock, which nobody holds, and a folder. */
    snprintf(left, sizeof left, "%s.1", path);
    ck_assert_int_eq(mkdir(left, 0700), 0);
    ck_assert_int_eq(utimensat(AT_FDCWD, left, old, 0), 0);
    s = foreseen(scene, NEVH_NATIVE_AUTO);
    ck_assert(nevh_stepper_native(s, &why));
    ck_assert_str_eq(why, "");
    nevh_stepper_free(s);
    find_file(path);
    nevh_scene_free(scene);
    remove_cache();
}

static void await_end(const nevh_stepper *s) {
    for (int i = 0; nevh_stepper_compiles(s) && i < 3000; i++)
        usleep(10000);
    ck_assert(!nevh_stepper_compiles(s));
}

/* Of several that wait for one lock none keeps it from the others, and none waits
   without end: neither who frees a stepper, nor who asks for its steps. */
TEST(locks_are_given_up) {
    enum { WAITING = 4 };
    nevh_stepper *s[WAITING];
    char path[200], lock[220];
    const char *why = NULL;
    double a[2] = {2, 0};
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = parsed(pendulum);
    make_cache();
    s[0] = foreseen(scene, NEVH_NATIVE_AUTO);
    ck_assert(nevh_stepper_native(s[0], NULL));
    nevh_stepper_free(s[0]);
    find_file(path);
    snprintf(lock, sizeof lock, "%s.lock", path);
    for (int present = 0; present < 2; present++) {
        ck_assert_int_eq(unlink(path), 0);
        int file = open(lock, O_RDWR | O_CREAT, 0600);
        ck_assert_int_eq(flock(file, LOCK_EX), 0);
        for (int i = 0; i < WAITING; i++)
            s[i] = foreseen(scene, NEVH_NATIVE_AUTO);
        if (present) { /* a steps' file of a stepper that waits for nobody */
            nevh_stepper *other = foreseen(scene, NEVH_NATIVE_ALWAYS);
            ck_assert(nevh_stepper_native(other, NULL));
            nevh_stepper_free(other);
        }
        for (int i = 0; i < WAITING; i++)
            ck_assert(nevh_stepper_compiles(s[i]));
        close(file);
        for (int i = 0; i < WAITING; i++)
            await_end(s[i]);
        for (int i = WAITING - 1; i >= 0; i--) {
            ck_assert(nevh_stepper_native(s[i], NULL));
            nevh_stepper_free(s[i]);
        }
        find_file(path);
    }
    ck_assert_int_eq(unlink(path), 0);
    int file = open(lock, O_RDWR | O_CREAT, 0600);
    ck_assert_int_eq(flock(file, LOCK_EX), 0);
    s[0] = foreseen(scene, NEVH_NATIVE_AUTO);
    s[1] = foreseen(scene, NEVH_NATIVE_AUTO);
    nevh_stepper_free(s[0]);
    ck_assert(!nevh_stepper_native(s[1], &why));
    assert_says(why, "another program has compiled them for");
    ck_assert_int_eq(run_on(s[1], 50, a), NEVH_OK);
    nevh_stepper_free(s[1]);
    close(file);
    nevh_scene_free(scene);
    remove_cache();
}

/* A copy of a process waits for nothing. */
TEST(copied_process) {
    double a[2] = {2, 0};
    int status;
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = parsed(pendulum);
    make_cache();
    nevh_stepper *s = foreseen(scene, NEVH_NATIVE_AUTO);
    bool compiles = nevh_stepper_compiles(s);
    pid_t child = fork();
    if (!child) {
        bool fine = run_on(s, 50, a) == NEVH_OK;
        nevh_stepper_free(s);
        _exit(fine ? 0 : 1);
    }
    waitpid(child, &status, 0);
    ck_assert(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    ck_assert(compiles && nevh_stepper_native(s, NULL));
    nevh_stepper_free(s);
    nevh_scene_free(scene);
    remove_cache();
}

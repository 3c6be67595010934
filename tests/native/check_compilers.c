/* nevh tests: C compilers that fail, never end, leave children or give other digits, and
   callers with a locale or traps of their own: steps go on, and say why.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include "../support/native.h"
#include "native/native_private.h"
#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <nevh/run.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char kept_compiler[1000];

static void setup(void) {
    const char *now = getenv("CC");
    snprintf(kept_compiler, sizeof kept_compiler, "%s", now ? now : "cc");
    setenv("C_COMPILER", kept_compiler, 1);
    make_cache();
    setenv("WHERE", cache, 1);
}

static void teardown(void) {
    setenv("CC", kept_compiler, 1);
    remove_cache();
}

/* A compiler that is a script, in a folder with a blank in its name. */
static void write_script(const char *name, const char *text) {
    char path[200];
    snprintf(path, sizeof path, "%s/a folder", cache);
    mkdir(path, 0700);
    snprintf(path, sizeof path, "%s/a folder/%s", cache, name);
    FILE *file = fopen(path, "w");
    ck_assert_ptr_nonnull(file);
    fprintf(file, "#!/bin/sh\n%s\n", text);
    fclose(file);
    ck_assert_int_eq(chmod(path, 0700), 0);
    setenv("CC", path, 1);
}

static size_t libraries(void) {
    size_t count = 0;
    char folder[100];
    snprintf(folder, sizeof folder, "%s/kept", cache);
    DIR *all = opendir(folder);
    for (struct dirent *entry; all && (entry = readdir(all));)
        count += strstr(entry->d_name, ".so") != NULL;
    if (all)
        closedir(all);
    return count;
}

static nevh_stepper *stepper(nevh_scene *scene, nevh_native_use native) {
    static char folder[100];
    snprintf(folder, sizeof folder, "%s/kept", cache);
    nevh_options o = {
        .native = native, .native_cache = folder, .steps_foreseen = 1e9};
    return nevh_stepper_new(nevh_scene_system(scene), nevh_gauss8, &o);
}

static void run_on(nevh_stepper *s, double y[2]) {
    ck_assert_int_eq(nevh_run(s, 0, 0.1, 50, &y[0], &y[1], NULL, 0), NEVH_OK);
}

/* said: NULL: steps are compiled all the same; kept: libraries in the cache */
static void assert_compiler(nevh_native_use native, const char *said) {
    double a[2] = {2, 0}, b[2] = {2, 0};
    const char *why = NULL;
    nevh_scene *scene = parsed(pendulum);
    nevh_stepper *plain = stepper(scene, NEVH_NATIVE_NEVER);
    nevh_stepper *s = stepper(scene, native);
    bool is_native = nevh_stepper_native(s, &why);
    if (said)
        assert_says(why, said);
    else
        ck_assert_str_eq(why, "");
    ck_assert(is_native == !said);
    ck_assert_uint_eq(libraries(), said ? 0 : 1);
    run_on(plain, a);
    run_on(s, b);
    ck_assert(memcmp(a, b, sizeof a) == 0);
    nevh_stepper_free(plain);
    nevh_stepper_free(s);
    nevh_scene_free(scene);
}

/* What comes of a compiler; NULL: steps. */
static const struct {
    const char *script, *said;
} compilers[] = {
    {"exec $C_COMPILER \"$@\"", NULL},
    {"sleep 100 & echo $! >\"$WHERE/left\"; exec $C_COMPILER \"$@\"", NULL},
    {"echo a warning; exec $C_COMPILER \"$@\"", NULL},
    {"exec >&- 2>&-; $C_COMPILER \"$@\"", NULL},
    {"exit 0", "steps.so"},
    {"exit 3", "the C compiler fails: exit status 3, without a message"},
    {"kill -9 $$", "Killed"},
    {"kill -15 $$", "Terminated"},
    {"echo; echo; echo no licence; exit 1", "the C compiler fails: no licence"},
    {"printf 'a\\033[31mb\\tc\\n'; exit 1", "the C compiler fails: a?[31mb?c"},
    {"echo x.c:1: error: too odd; exit 1", "the C compiler fails: too odd"},
    {"while test \"$1\" != -o; do shift; done; echo hello >\"$2\"", "steps.so"},
    {"while test \"$1\" != -o; do shift; done; echo 'int x;' >\"$2.c\"\n"
     "exec $C_COMPILER -shared -fPIC -o \"$2\" \"$2.c\"",
     "has no steps"},
    {"while test \"$1\" != -o; do shift; done; mkdir -p \"$2/folder\"",
     "steps.so"},
};
enum { COMPILERS = sizeof compilers / sizeof *compilers };

TEST_EACH(odd_compilers, COMPILERS) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    setup();
    for (int way = 0; way < 2; way++) {
        char name[20];
        snprintf(name, sizeof name, "compiler%d", way);
        write_script(name, compilers[_i].script);
        if (way && !compilers[_i].said) /* else it is in the cache */
            ck_assert_int_eq(system("rm -r \"$WHERE/kept\""), 0);
        assert_compiler(way ? NEVH_NATIVE_ALWAYS : NEVH_NATIVE_AUTO,
                        compilers[_i].said);
    }
    ck_assert_int_ge(system("test ! -e \"$WHERE/left\" || "
                            "kill $(cat \"$WHERE/left\")"),
                     0);
    teardown();
}

/* CC as words: more than a few, and quotes as a shell has them. */
TEST(words_of_compilers) {
    char words[2000] = "\"", *at;
    if (!has_compiler())
        skip_test("there is no C compiler");
    setup();
    write_script("my compiler", "exec $C_COMPILER \"$@\"");
    strcat(strcat(words, getenv("CC")), "\" -DA='a b' -DB=\\ ");
    at = words + strlen(words);
    for (int i = 0; i < 100; i++)
        at += sprintf(at, " -DC%d=1", i);
    setenv("CC", words, 1);
    assert_compiler(NEVH_NATIVE_ALWAYS, NULL);
    ck_assert_int_eq(system("rm -r \"$WHERE/kept\""), 0);
    setenv("CC", cache, 1);
    assert_compiler(NEVH_NATIVE_ALWAYS, "there is no C compiler");
    setenv("CC", "/dev/null", 1);
    assert_compiler(NEVH_NATIVE_AUTO, "there is no C compiler /dev/null");
    teardown();
}

/* What has ended, but was not waited for, is not. */
static bool is_alive(const char *file) {
    char command[200];
    snprintf(command, sizeof command,
             "ps -o stat= -p $(cat \"$WHERE/%s\") | grep -qv '^Z'", file);
    return system(command) == 0;
}

static void await_death(const char *file) {
    for (int i = 0; is_alive(file) && i < 1000; i++)
        usleep(10000);
    ck_assert(!is_alive(file));
}

static const char slow[] = "trap '' TERM\necho $$ >\"$WHERE/compiler\"\n"
                           "sleep 1000 &\necho $! >\"$WHERE/child.new\"\n"
                           "mv \"$WHERE/child.new\" \"$WHERE/child\"\nwait\n"
                           "sleep 1000";

/* One that never ends is ended, with what it started, and then left alone. */
TEST(endless_compiler) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    setup();
    write_script("slow", slow);
    assert_compiler(NEVH_NATIVE_AUTO, "the C compiler took too long");
    await_death("compiler");
    await_death("child");
    ck_assert_int_eq(system("rm \"$WHERE/child\""), 0);
    assert_compiler(NEVH_NATIVE_AUTO, "the C compiler took too long");
    ck_assert(access("child", F_OK) != 0);
    teardown();
}

/* A compiler does not outlive who waits for it, killed by whatever signal; and nobody
   else waits for that. */
TEST_EACH(killed_callers, 4) {
    static const int signals[] = {SIGKILL, SIGTERM, SIGXCPU, SIGUSR1};
    char file[100];
    if (!has_compiler())
        skip_test("there is no C compiler");
    setup();
    write_script("slow", slow);
    nevh_scene *scene = parsed(pendulum);
    pid_t child = fork();
    if (!child) {
        signal(signals[_i], SIG_DFL); /* Check has handlers */
        nevh_stepper *s =
            stepper(scene, _i % 2 ? NEVH_NATIVE_ALWAYS : NEVH_NATIVE_AUTO);
        nevh_stepper_native(s, NULL);
        _exit(0);
    }
    snprintf(file, sizeof file, "%s/child", cache);
    while (access(file, F_OK))
        usleep(10000);
    kill(child, signals[_i]);
    waitpid(child, NULL, 0);
    await_death("compiler");
    await_death("child");
    ck_assert_uint_le(libraries(), 1); /* the lock's file, which nobody holds */
    write_script("fine", "exec $C_COMPILER \"$@\"");
    nevh_stepper *s = stepper(scene, NEVH_NATIVE_AUTO);
    ck_assert(nevh_stepper_native(s, NULL));
    nevh_stepper_free(s);
    nevh_scene_free(scene);
    teardown();
}

/* Formulas with numbers of all kinds. */
static const char decimal[] =
    "[parameters]\na = 1.25e-3\n[coordinates]\nx = 0.5\ny = 0.25\n"
    "[effects]\nT = (p_x^2 + 1.5*p_y^2)/2.5\n"
    "V = 0.75*x^2 + a*x*y + 2.5*y^2 + 0.125*cos(1.5*x)\n";

static void assert_texts(char *texts[2], int turn) {
    char *mathml = NULL;
    size_t bytes;
    nevh_scene *scene = parsed(decimal);
    FILE *out = open_memstream(&mathml, &bytes);
    nevh_stepper *s =
        nevh_stepper_new(nevh_scene_system(scene), nevh_verlet,
                         &(nevh_options){.portable = true,
                                         .q = (double[]){0.5, 0.25},
                                         .p = (double[]){0.125, 1e-3}});
    char *program = nevh_stepper_program(
        s, &(nevh_program){.names = (const char *const[]){"x", "y"},
                           .h = 0.125,
                           .t_end = 1.5,
                           .every = 1});
    ck_assert_msg(program, "%s", nevh_stepper_message(s));
    fprintf(out, "%s", program);
    fclose(out);
    free(program);
    texts[turn] = mathml;
    nevh_stepper_free(s);
    nevh_scene_free(scene);
}

/* Texts are the same in a locale whose decimal point is a comma. */
TEST(decimal_comma) {
    char *texts[2], path[200], number[20];
    if (!has_compiler())
        skip_test("there is no C compiler");
    setup();
    if (system("localedef -i de_DE -f UTF-8 \"$WHERE/de_DE.UTF-8\" "
               ">\"$WHERE/out\" 2>&1"))
        skip_test("localedef makes no locale here");
    assert_texts(texts, 0);
    ck_assert_ptr_nonnull(realpath(cache, path));
    setenv("LOCPATH", path, 1);
    ck_assert_ptr_nonnull(setlocale(LC_ALL, "de_DE.UTF-8"));
    snprintf(number, sizeof number, "%.1f", 0.5);
    ck_assert_str_eq(number, "0,5");
    assert_texts(texts, 1);
    ck_assert_str_eq(texts[0], texts[1]);
    nevh_scene *scene = parsed(decimal);
    for (const nevh_integrator *scheme,
         **all = (const nevh_integrator *[]){nevh_verlet, nevh_gauss8, nevh_rk4,
                                             nevh_taylor, nevh_tao4, NULL};
         (scheme = *all); all++)
        for (int width = 1; width <= 8; width += 7) {
            const nevh_gradient *gradient =
                width > 1 || scheme == nevh_taylor ? nevh_exact : nevh_central4;
            pair x =
                pair_of(scene, scheme, gradient, false, cache, (size_t)width);
            if (!nevh_stepper_status(x.plain) &&
                !(width > 1 &&
                  (scheme == nevh_tao4 || scheme == nevh_taylor))) {
                ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s: %s",
                              scheme->name, x.why);
                ck_assert_int_eq(pair_run(&x, 0.01, 100), NEVH_OK);
                ck_assert(pair_same(&x));
            }
            pair_free(&x);
        }
    snprintf(number, sizeof number, "%.1f",
             0.5); /* the caller's is as it was */
    ck_assert_str_eq(number, "0,5");
    nevh_scene_free(scene);
    setlocale(LC_ALL, "C");
    free(texts[0]);
    free(texts[1]);
    teardown();
}

/* Words of CC that change digits, if nobody takes them back or looks. */
static const char *const words[] = {
    "-ffast-math",
    "-Ofast",
    "-mfma -ffp-contract=fast",
    "-funsafe-math-optimizations",
    "-freciprocal-math",
    "-fassociative-math -fno-signed-zeros -fno-trapping-math",
    "-mfpmath=387",
    "-m32",
    "-fsingle-precision-constant",
    "-fsanitize=address",
    "-fvisibility=hidden",
    "-Dh=(h*(1+1e-15))",
    "-D__builtin_fma(a,b,c)=((a)*(b)+(c))",
};
enum { WORDS = sizeof words / sizeof *words };

static const char two[] =
    "[coordinates]\nx = 0.7\ny = 0.3\n[effects]\n"
    "T = (p_x^2 + p_y^2)/2\nV = (x^2 + y^2)/2 + x^2*y/3 - y^3/7 + "
    "exp(-x*y)/(1.1 + x^2 + y^2)\n";

static void assert_digits(nevh_scene *scene, const nevh_integrator *scheme,
                          size_t width) {
    pair x = pair_of(scene, scheme, nevh_exact, false, cache, width);
    ck_assert_int_eq(nevh_stepper_status(x.plain), NEVH_OK);
    for (int i = 0; i < 4; i++) {
        ck_assert_int_eq(pair_run(&x, 0.05, 100), NEVH_OK);
        ck_assert_msg(pair_same(&x), "%s, %s", getenv("CC"), scheme->name);
    }
    const char *why;
    ck_assert(nevh_stepper_native(x.native, &why) || *why);
    volatile double small = 1e-310;
    ck_assert_double_gt(small / 2,
                        0); /* the processor's mode is the caller's */
    pair_free(&x);
}

TEST_EACH(words_that_change_digits, WORDS) {
    char command[2000];
    if (!has_compiler())
        skip_test("there is no C compiler");
    setup();
    snprintf(command, sizeof command, "%s '%s'", kept_compiler, words[_i]);
    if (!strchr(words[_i], '('))
        snprintf(command, sizeof command, "%s %s", kept_compiler, words[_i]);
    setenv("CC", command, 1);
    nevh_scene *scene = parsed(two);
    assert_digits(scene, nevh_verlet, 1);
    assert_digits(scene, nevh_gauss8, 1);
    nevh_options o = {.tolerance = 1e-12,
                      .q = (double[]){0.7, 0.3},
                      .p = (double[]){0, 0},
                      .native_cache = cache};
    double y[2][4] = {{0.7, 0.3}, {0.7, 0.3}};
    for (int i = 0; i < 2; i++) {
        o.native = i ? NEVH_NATIVE_ALWAYS : NEVH_NATIVE_NEVER;
        nevh_stepper *s =
            nevh_stepper_new(nevh_scene_system(scene), nevh_taylor, &o);
        ck_assert_int_eq(nevh_run(s, 0, 0.1, 200, &y[i][0], &y[i][2], NULL, 0),
                         NEVH_OK);
        nevh_stepper_free(s);
    }
    ck_assert_msg(memcmp(y[0], y[1], sizeof y[0]) == 0, "%s, taylor", command);
    nevh_scene_free(scene);
    teardown();
}

/* A caller that has floating-point exceptions trapped gets no signal from plans. */
TEST(trapping_caller) {
    static const int trapped =
        FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW | FE_INEXACT;
    nevh_scene *scene = parsed(two);
    for (const nevh_integrator *const *all = nevh_integrators(); *all; all++)
        for (int way = 0; way < 3; way++) {
            nevh_options o = {.native = NEVH_NATIVE_NEVER,
                              .gradient = way ? nevh_central4 : nevh_exact,
                              .tolerance = way == 2 ? 1e-9 : 0,
                              .q = (double[]){0.7, 1e-160},
                              .p = (double[]){0, 1e-300}};
            feclearexcept(FE_ALL_EXCEPT);
            ck_assert_int_ne(feenableexcept(trapped), -1);
            nevh_stepper *s =
                nevh_stepper_new(nevh_scene_system(scene), *all, &o);
            int after = fedisableexcept(FE_ALL_EXCEPT);
            ck_assert_int_eq(after & trapped, trapped);
            nevh_stepper_free(s);
        }
    nevh_scene_free(scene);
}

static const char *const trapping[] = {
    "[coordinates]\nx = 1\ny = 0, 1\n[effects]\n"
    "T = (p_x^2 + p_y^2)/2\nV = -1/sqrt(x^2 + y^2)\n",
    "[coordinates]\nx = 1\n[effects]\nH = p_x^2/2 + x^4/4\n"
    "D = x*exp(-((t - 5)/0.01)^2) + 0.1*x*sign(sin(t))\n",
    "[coordinates]\nx = 1\n[effects]\nH = p_x^2/2 - 1/x^2\n",
};

static void plan_all(const nevh_system *s, const double q[], const double p[]) {
    nevh_options o = {.gradient = nevh_central4, .q = q, .p = p};
    nevh_chaos_finding found;
    double frequency, growth;
    nevh_timing_free(nevh_timing_new(s, 0, 10, q, p));
    nevh_probe_free(nevh_probe_new(s, &o));
    nevh_field_free(nevh_field_new(s, &o));
    nevh_reference_free(nevh_reference_new(s, NULL, 0, 2, q, p));
    nevh_solution_ends(s, 0, 10, q, p);
    nevh_chaos_find(s, &o, 0, 5, 0.05, &found);
    nevh_rates *r = nevh_rates_new(s, &o);
    nevh_rates_at(r, 0, q, p, &frequency, &growth);
    nevh_rates_free(r);
}

/* Nor from others that try states where H overflows. */
TEST_EACH(trapping_caller_plans, sizeof trapping / sizeof *trapping) {
    static const int trapped = FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW;
    nevh_scene *scene = parsed(trapping[_i]);
    double q[2], p[2];
    ck_assert_int_eq(nevh_scene_start(scene, q, p), NEVH_OK);
    feclearexcept(FE_ALL_EXCEPT);
    ck_assert_int_ne(feenableexcept(trapped), -1);
    plan_all(nevh_scene_system(scene), q, p);
    int after = fedisableexcept(FE_ALL_EXCEPT);
    ck_assert_int_eq(after & trapped, trapped);
    nevh_scene_free(scene);
}

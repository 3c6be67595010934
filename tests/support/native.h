/* nevh tests: steppers with and without compiled steps, and a cache of their own.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_NATIVE_H
#define NEVH_TESTS_NATIVE_H

#include "native/compiler_private.h"
#include "shipped.h"
#include <stdlib.h>

static char own_cache[64];
static const char *cache = own_cache;

static inline void make_cache(void) {
    strcpy(own_cache, "native.XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(own_cache));
}

static inline void remove_cache(void) {
    char command[100];
    snprintf(command, sizeof command, "rm -rf %s", own_cache);
    ck_assert_int_eq(system(command), 0);
}

/* The cache that all suites share, where they have one. */
static inline void share_cache(void) {
    cache = getenv("XDG_CACHE_HOME");
    if (cache)
        return;
    cache = own_cache;
    make_cache();
}

/* Two steppers planned alike, of which one is to run compiled steps. */
typedef struct {
    size_t n; /* numbers of q, and of p */
    nevh_stepper *plain, *native;
    double *start, *a, *b; /* q and p */
    const char *why;
} pair;

/* Orbits that start side by side, a little apart; a tolerance of 0: steps do not
   adapt. */
static inline pair pair_under(nevh_scene *scene, const nevh_integrator *scheme,
                              const nevh_gradient *gradient, bool portable,
                              const char *folder, size_t width,
                              double tolerance) {
    const nevh_system *s = nevh_scene_system(scene);
    size_t dof = nevh_scene_dof(scene), n = dof * width;
    pair x = {.n = n};
    x.start = calloc(6 * n, sizeof(double));
    x.a = x.start + 2 * n;
    x.b = x.a + 2 * n;
    ck_assert_int_eq(nevh_scene_start(scene, x.a, x.a + dof), NEVH_OK);
    for (size_t i = 0; i < 2 * n; i++)
        x.start[i] = x.a[i / width] * (1 + 0.001 * (double)(i % width));
    memcpy(x.a, x.start, 2 * n * sizeof(double));
    memcpy(x.b, x.start, 2 * n * sizeof(double));
    nevh_options o = {.gradient = gradient,
                      .q = x.start,
                      .p = x.start + n,
                      .width = width,
                      .portable = portable,
                      .tolerance = tolerance,
                      .native = NEVH_NATIVE_NEVER,
                      .native_cache = folder};
    x.plain = nevh_stepper_new(s, scheme, &o);
    o.native = NEVH_NATIVE_ALWAYS;
    x.native = nevh_stepper_new(s, scheme, &o);
    ck_assert(!nevh_stepper_native(x.plain, &x.why) && !*x.why);
    nevh_stepper_native(x.native, &x.why);
    return x;
}

static inline pair pair_of(nevh_scene *scene, const nevh_integrator *scheme,
                           const nevh_gradient *gradient, bool portable,
                           const char *folder, size_t width) {
    return pair_under(scene, scheme, gradient, portable, folder, width, 0);
}

static inline pair pair_new(nevh_scene *scene, const nevh_integrator *scheme,
                            const nevh_gradient *gradient, bool portable,
                            const char *folder) {
    return pair_of(scene, scheme, gradient, portable, folder, 1);
}

static inline void pair_free(pair *x) {
    nevh_stepper_free(x->plain);
    nevh_stepper_free(x->native);
    free(x->start);
}

static inline bool pair_same(const pair *x) {
    nevh_counts a = nevh_stepper_counts(x->plain),
                b = nevh_stepper_counts(x->native);
    return memcmp(x->a, x->b, 2 * x->n * sizeof(double)) == 0 &&
           a.values == b.values && a.gradients == b.gradients &&
           a.sweeps == b.sweeps && a.newtons == b.newtons &&
           a.rescues == b.rescues;
}

/* Runs both, and returns their status. */
static inline int pair_run(pair *x, double h, size_t steps) {
    int a = nevh_run(x->plain, 0, h, steps, x->a, x->a + x->n, NULL, 0);
    int b = nevh_run(x->native, 0, h, steps, x->b, x->b + x->n, NULL, 0);
    ck_assert_int_eq(a, b);
    ck_assert_uint_eq(nevh_stepper_taken(x->plain),
                      nevh_stepper_taken(x->native));
    ck_assert_str_eq(nevh_stepper_message(x->plain),
                     nevh_stepper_message(x->native));
    return a;
}

static inline bool has_compiler(void) {
    char **words = nevh__compiler_words();
    char *found = nevh__command_find(words[0]);
    bool has = found;
    free(found);
    free(words);
    return has;
}

static inline nevh_scene *parsed(const char *text) {
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    return s;
}

static const char pendulum[] =
    "[coordinates]\nphi = 2\n[effects]\nT = p_phi^2/2\nV = -9.8*cos(phi)\n";

#endif

/* nevh tests: kinetic energies of masses that kernels know.
   SPDX-License-Identifier: GPL-3.0-or-later

   Whoever writes the same term out must get the same orbit, bit for bit. */
#include "support.h"
#include <math.h>
#include <string.h>

enum { N = 2, STEPS = 12, MOST_WIDTH = 8 };
static const double masses[N] = {2, 3};

/* c: 1/m */
static double own_value(double t, const double q[], const double p[],
                        const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    return c[0] * p[0] * p[0] / 2;
}

static void own_gradient(size_t width, const double t[], const double q[],
                         const double p[], const double c[], const void *params,
                         double dh_dq[], double dh_dp[]) {
    (void)t, (void)q, (void)params, (void)dh_dq;
    for (size_t i = 0; dh_dp && i < width; i++)
        dh_dp[i] = c[i] * p[i];
}

static void add_own(nevh_system *s, size_t count, const size_t at[]) {
    const double inverse[N] = {1 / masses[at[0]], 1 / masses[N - 1]};
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .p = at,
                                    .c = inverse,
                                    .count = count,
                                    .value = own_value,
                                    .gradient = own_gradient});
}

enum kind { PLAIN, RUBS, ANOTHER_T, KINDS };

static nevh_system *make(enum kind kind, bool known) {
    static const size_t all[] = {0, 1}, one[] = {1};
    nevh_system *s = nevh_system_new(N);
    add_waves(s, N, all);
    if (known)
        nevh_system_add_masses(s, "kinetic", masses);
    else
        add_own(s, N, all);
    if (kind == ANOTHER_T)
        add_own(s, 1, one);
    if (kind == RUBS)
        nevh_system_add_friction(s, "drag", (const double[]){0.3, 0.1});
    ck_assert_msg(!nevh_system_status(s), "%s", nevh_system_message(s));
    return s;
}

/* The last lane; whether the scheme takes that H. */
static bool travel(const nevh_integrator *scheme, enum kind kind, bool known,
                   size_t width, double x[2 * N]) {
    static const double start[] = {0.5, -1, 1, 0.25};
    double z[2 * N * MOST_WIDTH], *p = z + N * width;
    nevh_system *s = make(kind, known);
    for (size_t i = 0; i < 2 * N * width; i++)
        z[i] = start[i / width] + 0.1 * (double)(width - 1 - i % width);
    nevh_stepper *m =
        nevh_stepper_new(s, scheme,
                         &(nevh_options){.gradient = nevh_exact,
                                         .width = width,
                                         .scale = (const double[]){1, 1, 1, 1},
                                         .q = z,
                                         .p = p,
                                         .tolerance = tolerance_for(scheme),
                                         .binding = 2});
    bool planned = !nevh_stepper_status(m);
    if (planned)
        ck_assert(!nevh_run(m, 0, 0.2, STEPS, z, p, NULL, 0));
    for (size_t k = 0; k < 2 * N; k++)
        x[k] = z[k * width + width - 1];
    nevh_stepper_free(m);
    nevh_system_free(s);
    return planned;
}

TEST_EACH(as_written_out, KINDS *scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i / KINDS];
    enum kind kind = _i % KINDS;
    for (size_t width = 1; width <= MOST_WIDTH; width *= 8) {
        double known[2 * N], own[2 * N];
        if (!travel(scheme, kind, true, width, known))
            continue;
        ck_assert(travel(scheme, kind, false, width, own));
        ck_assert_msg(!memcmp(known, own, sizeof own), "%s, %zu lanes",
                      nevh_integrator_name(scheme), width);
    }
}

TEST(of_one_each) {
    double q[N] = {0}, p[N] = {0.3, -7}, t = 0, h, v[N];
    nevh_system *s = nevh_system_new(N);
    ck_assert(!nevh_system_add_masses(s, "T", NULL));
    nevh_field *f = nevh_field_new(s, &(nevh_options){.gradient = nevh_exact});
    ck_assert(!nevh_field_value(f, 1, &t, q, p, &h));
    ck_assert_double_eq_tol(h, (0.09 + 49) / 2, 1e-14);
    ck_assert(!nevh_field_gradient(f, 1, &t, q, p, NULL, v));
    ck_assert_mem_eq(v, p, sizeof v);
    nevh_field_free(f);
    ck_assert(!nevh_system_enable(s, "T", false));
    f = nevh_field_new(s, &(nevh_options){.gradient = nevh_exact});
    ck_assert(!nevh_field_value(f, 1, &t, q, p, &h));
    ck_assert(h == 0);
    nevh_field_free(f);
    nevh_system_free(s);
}

TEST(every_gradient) {
    nevh_system *s = make(PLAIN, true);
    const double q[N] = {0.2, 0.4}, p[N] = {0.3, -7}, t = 0;
    for (const nevh_gradient *const *g = nevh_gradients(); *g; g++) {
        double v[N], dq[N];
        nevh_field *f =
            nevh_field_new(s, &(nevh_options){.gradient = *g, .q = q, .p = p});
        if (!nevh_field_status(f)) {
            ck_assert(!nevh_field_gradient(f, 1, &t, q, p, dq, v));
            for (size_t k = 0; k < N; k++)
                ck_assert_double_eq_tol(v[k], p[k] / masses[k], 1e-9);
        }
        nevh_field_free(f);
    }
    nevh_system_free(s);
}

TEST(refuses) {
    static const double bad[][N] = {
        {1, 0}, {1, -0.}, {INFINITY, 1}, {1, NAN}, {1, 1e-310}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        nevh_system *s = nevh_system_new(N);
        ck_assert_int_eq(nevh_system_add_masses(s, "T", bad[i]), NEVH_EINVAL);
        ck_assert_msg(strstr(nevh_system_message(s), "\"T\"") != NULL, "%s",
                      nevh_system_message(s));
        nevh_system_free(s);
    }
    nevh_system *s = nevh_system_new(N);
    ck_assert_int_eq(nevh_system_add_masses(s, NULL, masses), NEVH_EINVAL);
    nevh_system_free(s);
    ck_assert_int_eq(nevh_system_add_masses(NULL, "T", NULL), NEVH_ENOMEM);
}

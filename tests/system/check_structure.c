/* nevh tests: is H separable, and which schemes fit it?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <string.h>

static double cosine(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return -1.7 * cos(q[0]);
}

static const nevh_term gravity = {
    .effect = "gravity", .nq = 1, .value = cosine};

static double any(double t, const double q[], const double p[],
                  const double c[], const void *params) {
    (void)q, (void)p, (void)c, (void)params;
    return t;
}

/* Every combination of effects that read q, p, both, t and q, nothing, t. */
TEST_EACH(traits, 64) {
    static const struct {
        const char *name;
        size_t nq, np;
        bool time;
    } effects[] = {{"q", 2, 0, false},     {"p", 0, 1, false},
                   {"mixed", 1, 1, false}, {"qt", 1, 0, true},
                   {"none", 0, 0, false},  {"t", 0, 0, true}};
    nevh_system *s = nevh_system_new(2);
    unsigned expected = NEVH_SEPARABLE | NEVH_AUTONOMOUS;
    for (int i = 0; i < 6; i++) {
        bool on = _i >> i & 1;
        nevh_system_add(s, &(nevh_term){.effect = effects[i].name,
                                        .nq = effects[i].nq,
                                        .np = effects[i].np,
                                        .time = effects[i].time,
                                        .value = any});
        ck_assert_int_eq(nevh_system_enable(s, effects[i].name, on), NEVH_OK);
    }
    if (_i & 4)
        expected &= ~(unsigned)NEVH_SEPARABLE;
    if (_i & (8 + 32))
        expected &= ~(unsigned)NEVH_AUTONOMOUS;
    ck_assert_uint_eq(nevh_system_traits(s), expected);
    nevh_system_free(s);
}

/* Whole functions; params is a constant that is added. */
static double one_pendulum(double t, const double q[], const double p[],
                           const void *params) {
    (void)t;
    return p[0] * p[0] / 2.6 - 9.8 * cos(q[0]) + *(const double *)params;
}

static double two_pendulums(double t, const double q[], const double p[],
                            const void *params) {
    return one_pendulum(t, q, p, params) +
           one_pendulum(t, q + 1, p + 1, params);
}

static double double_pendulum_h(double t, const double q[], const double p[],
                                const void *params) {
    (void)t;
    double d = q[0] - q[1];
    return (p[0] * p[0] + 2 * p[1] * p[1] - 2 * p[0] * p[1] * cos(d)) /
               (2 * (1 + sin(d) * sin(d))) -
           9.8 * (2 * cos(q[0]) + cos(q[1])) + *(const double *)params;
}

/* Probe and stepper come to the same answer. */
static void assert_separable(const nevh_system *s, const nevh_options *o,
                             bool expected) {
    nevh_separability found;
    ck_assert_int_eq(nevh_system_probe(s, 0, o->q, o->p, o->scale, &found),
                     NEVH_OK);
    ck_assert_msg(found.separable == expected, "mixed part %g", found.mixed);
    ck_assert_str_eq(found.term, "H");
    ck_assert_uint_gt(found.states, 0);
    nevh_stepper *m = nevh_stepper_new(s, nevh_verlet, o);
    ck_assert_int_eq(nevh_stepper_status(m), expected ? NEVH_OK : NEVH_ESTRUCT);
    if (!expected) {
        assert_says(nevh_stepper_message(m), "\"H\"");
        assert_says(nevh_stepper_message(m), "midpoint");
    }
    nevh_stepper_free(m);
}

TEST_EACH(whole_functions, 6) {
    static const nevh_value_fn functions[] = {one_pendulum, two_pendulums,
                                              double_pendulum_h};
    static const double q[] = {1.1, -0.4}, p[] = {0.3, 0.5};
    const double offset = _i < 3 ? 0 : 1e12;
    const bool separable = _i % 3 != 2;
    size_t n = _i % 3 ? 2 : 1;
    nevh_system *s = nevh_system_from(n, functions[_i % 3], &offset);
    assert_separable(s, &(nevh_options){0}, separable);
    assert_separable(s, &(nevh_options){.q = q, .p = p}, separable);
    nevh_system_free(s);
}

/* Coupled only within 1e-10 and 1e-24 of the origin, as in an atom. */
static double atom(double t, const double q[], const double p[],
                   const void *params) {
    (void)t, (void)params;
    double x = q[0] / 1e-10, y = p[0] / 1e-24;
    return 1e-18 * (x * x + y * y * (1 + exp(-x * x - y * y)));
}

static double small_oscillator(double t, const double q[], const double p[],
                               const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 1.8e-30 + 1e2 * q[0] * q[0];
}

TEST_EACH(follows_scales, 3) {
    static const double q[] = {0.7e-10}, p[] = {1.1e-24};
    static const double scale[] = {1e-10, 1e-24};
    nevh_options by_scale = {.scale = scale}, by_state = {.q = q, .p = p};
    nevh_system *s = nevh_system_from(1, _i ? atom : small_oscillator, NULL);
    assert_separable(s, _i == 2 ? &by_state : &by_scale, _i == 0);
    nevh_system_free(s);
}

static double root(double t, const double q[], const double p[],
                   const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] + sqrt(q[0]);
}

static double coupled_root(double t, const double q[], const double p[],
                           const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] * sqrt(q[0]);
}

TEST_EACH(undefined_in_part, 2) {
    static const double q[] = {0.5}, p[] = {0.3}, scale[] = {2, 1};
    nevh_separability found;
    nevh_system *s = nevh_system_from(1, _i ? coupled_root : root, NULL);
    assert_separable(s, &(nevh_options){.q = q, .p = p, .scale = scale}, !_i);
    ck_assert_int_eq(nevh_system_probe(s, 0, q, p, scale, &found), NEVH_OK);
    ck_assert_uint_lt(found.states, 16);
    nevh_system_free(s);
}

TEST(undefined_everywhere) {
    static const double q[] = {-9};
    nevh_separability found;
    nevh_system *s = nevh_system_from(1, root, NULL);
    nevh_options options = {.q = q, .scale = (const double[]){1, 1}};
    nevh_stepper *m = nevh_stepper_new(s, nevh_verlet, &options);
    ck_assert_int_eq(nevh_system_probe(s, 0, q, NULL, options.scale, &found),
                     NEVH_EDOM);
    ck_assert(!found.separable && found.states == 0);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(m), "\"H\"");
    assert_says(nevh_stepper_message(m), "not finite");
    nevh_stepper_free(m);
    nevh_system_free(s);
}

static double product(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)params;
    return q[0] * q[0] + p[0] * p[0] + c[0] * q[0] * p[0];
}

static nevh_system *three_mixtures(void) {
    nevh_system *s = nevh_system_new(2);
    const char *names[] = {"none", "weak", "strong"};
    for (int i = 0; i < 3; i++)
        nevh_system_add(s, &(nevh_term){.effect = names[i],
                                        .nq = 1,
                                        .np = 1,
                                        .nc = 1,
                                        .value = product,
                                        .c = (double[]){0.05 * i}});
    return s;
}

TEST(names_the_worst_term) {
    const char *worst[] = {"strong", "weak", "none", NULL};
    nevh_system *s = three_mixtures();
    nevh_system_add(s, &gravity);
    for (int i = 0; i < 4; i++) {
        nevh_separability found;
        ck_assert_int_eq(nevh_system_probe(s, 0, NULL, NULL, NULL, &found),
                         NEVH_OK);
        ck_assert_int_eq(found.separable, i > 1);
        if (worst[i])
            ck_assert_str_eq(found.term, worst[i]);
        else
            ck_assert_ptr_null(found.term);
        ck_assert_uint_eq(found.states, worst[i] ? 16 : 0);
        if (worst[i])
            nevh_system_enable(s, worst[i], false);
    }
    nevh_system_free(s);
}

/* A scheme that fits is suggested; what is off is no reason to refuse. */
TEST(verlet_refuses_a_mixed_term) {
    nevh_system *s = three_mixtures();
    nevh_stepper *m = nevh_stepper_new(s, nevh_verlet, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(m), "verlet");
    assert_says(nevh_stepper_message(m), "\"strong\"");
    assert_says(nevh_stepper_message(m), "midpoint, lobatto2, gauss4");
    nevh_stepper_free(m);
    nevh_system_enable(s, "weak", false);
    nevh_system_enable(s, "strong", false);
    m = nevh_stepper_new(s, nevh_verlet, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_OK);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* An invalid option is the reason given, not what the probe makes of it. */
TEST(invalid_scale) {
    static const double offset = 0, bad[] = {NAN, 0, -1, INFINITY};
    nevh_system *s = nevh_system_from(1, one_pendulum, &offset);
    for (int i = 0; i < 4; i++) {
        nevh_options options = {.scale = (double[]){1, bad[i]}};
        nevh_stepper *m = nevh_stepper_new(s, nevh_verlet, &options);
        ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
        assert_says(nevh_stepper_message(m), "scale of p[0]");
        nevh_stepper_free(m);
    }
    nevh_system_free(s);
}

/* Kinetic energies of two momenta; c[0] is what makes them differ. */
typedef struct {
    const char *name;
    nevh_term_fn value;
    double c, scale; /* scale: of the momenta to plan at */
} kinetic_energy;

static double plain(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    return (p[0] * p[0] / 1.3 + 0.4 * p[0] * p[1] + p[1] * p[1]) / (2 * c[0]);
}

static double offset(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    return plain(t, q, p, (const double[]){0.7}, params) + c[0];
}

/* At p = -c[0] its parts cancel, and its rounding is that of each. */
static double moving(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    return p[0] * p[0] / 2 + c[0] * p[0] + c[0] * c[0] / 2 +
           (p[1] - c[0]) * (p[1] - c[0]) / 2;
}

static double relativistic_mass(double t, const double q[], const double p[],
                                const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    const double light = 2.99792458e8, rest = c[0] * light * light;
    double x = p[0] * light, y = p[1] * light;
    return sqrt(rest * rest + x * x + y * y);
}

static double anharmonic(double t, const double q[], const double p[],
                         const double c[], const void *params) {
    return plain(t, q, p, (const double[]){0.7}, params) +
           c[0] * p[1] * p[1] * p[1] * p[1];
}

static double lattice(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    return -cos(c[0] * p[0]) - cos(c[0] * p[1]);
}

static const kinetic_energy quadratic[] = {
    {"plain", plain, 0.7, 1},       {"in SI units", plain, 1e-27, 1e-22},
    {"heavy", plain, 2e30, 6e34},   {"offset", offset, 1e12, 1},
    {"small", offset, 1e12, 1e-3},  {"moving", moving, 1, 1},
    {"moving fast", moving, 1e8, 1}};
static const kinetic_energy other[] = {
    {"electron", relativistic_mass, 9.1e-31, 1e-22},
    {"slow electron", relativistic_mass, 9.1e-31, 5e-25},
    {"quartic", anharmonic, 1e-9, 1},
    {"fast quartic", anharmonic, 1e-20, 1e6},
    {"lattice", lattice, 1, 1},
    {"fine lattice", lattice, 1e24, 1e-24}};

/* With a potential; as a whole H the term reads coordinates, too. */
static nevh_system *system_with(const kinetic_energy *kinetic, bool mixed) {
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(s, &gravity);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .name = "T",
                                    .nq = mixed ? 2 : 0,
                                    .np = 2,
                                    .nc = 1,
                                    .c = &kinetic->c,
                                    .value = kinetic->value});
    return s;
}

/* At rest, moving, and where `moving` is small. */
static void assert_kinetic(const kinetic_energy *kinetic, bool expected) {
    const double x = kinetic->scale, c = kinetic->c;
    const double p[][2] = {{0.7 * x, -0.4 * x}, {0, x}, {-c, c}};
    const double q[] = {0.3, 0.9};
    int states = kinetic->value == moving ? 3 : 2;
    for (int i = 0; i < 2 * states; i++) {
        nevh_system *s = system_with(kinetic, i % 2);
        nevh_options options = {.q = q, .p = p[i / 2]};
        nevh_stepper *m = nevh_stepper_new(s, nevh_rkn14a, &options);
        ck_assert_msg(nevh_stepper_status(m) ==
                          (expected ? NEVH_OK : NEVH_ESTRUCT),
                      "%s, %d: %s", kinetic->name, i, nevh_stepper_message(m));
        if (!expected)
            assert_says(nevh_stepper_message(m), "\"T\" is not");
        nevh_stepper_free(m);
        nevh_system_free(s);
    }
}

TEST_EACH(quadratic_kinetic_energies, sizeof quadratic / sizeof *quadratic) {
    assert_kinetic(&quadratic[_i], true);
}

TEST_EACH(other_kinetic_energies, sizeof other / sizeof *other) {
    assert_kinetic(&other[_i], false);
}

/* A thousand degrees of freedom in one function. */
static double long_chain(double t, const double q[], const double p[],
                         const void *params) {
    double h = 0;
    (void)t, (void)params;
    for (size_t i = 0; i < 1000; i++) {
        double d = i ? q[i] - q[i - 1] : q[i];
        h += p[i] * p[i] / (2 + 0.01 * (double)i) + d * d / 2 + d * d * d * d;
    }
    return h;
}

TEST(large_systems) {
    nevh_system *s = nevh_system_from(1000, long_chain, NULL);
    nevh_options options = {.gradient_step = 0x1p-10};
    nevh_stepper *m = nevh_stepper_new(s, nevh_rkn11b, &options);
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* What is off is no reason; what needs no such T takes it. */
TEST(only_where_it_is_needed) {
    nevh_system *s = system_with(&quadratic[0], false);
    nevh_system_add(s, &(nevh_term){.effect = "fast",
                                    .np = 2,
                                    .nc = 1,
                                    .c = &other[2].c,
                                    .value = anharmonic});
    nevh_stepper *m = nevh_stepper_new(s, nevh_mclachlan_atela4, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(m), "\"fast\" is not");
    assert_says(nevh_stepper_message(m), "order 3 instead of 4");
    assert_says(nevh_stepper_message(m), "blanes-moan4");
    nevh_stepper_free(m);
    m = nevh_stepper_new(s, nevh_rkn11b, NULL);
    assert_says(nevh_stepper_message(m), "order 4 instead of 6");
    assert_says(nevh_stepper_message(m), "blanes-moan6");
    nevh_stepper_free(m);
    m = nevh_stepper_new(s, nevh_rkn6b, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_OK);
    nevh_stepper_free(m);
    nevh_system_enable(s, "fast", false);
    m = nevh_stepper_new(s, nevh_rkn11b, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_OK);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

static double positive(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    return sqrt(p[0] - c[0]);
}

/* Separability comes first; then what cannot be evaluated. */
TEST(other_reasons) {
    const double beyond = 99;
    nevh_system *s = three_mixtures();
    nevh_options options = {.gradient_step = 0x1p-10};
    nevh_stepper *m = nevh_stepper_new(s, nevh_rkn14a, &options);
    assert_says(nevh_stepper_message(m), "\"strong\" mixes");
    nevh_stepper_free(m);
    nevh_system_enable(s, "weak", false);
    nevh_system_enable(s, "strong", false);
    nevh_system_add(s, &(nevh_term){.effect = "positive",
                                    .np = 1,
                                    .nc = 1,
                                    .c = &beyond,
                                    .value = positive});
    m = nevh_stepper_new(s, nevh_rkn14a, &options);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(m), "\"positive\"");
    assert_says(nevh_stepper_message(m), "could not be probed");
    assert_says(nevh_stepper_message(m), "blanes-moan6");
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Each scheme that is suggested takes the system, at no lower order. */
static void assert_suggestions(const nevh_integrator *scheme,
                               const problem *b) {
    nevh_system *s = b->make();
    nevh_options options = {.q = b->q, .p = b->p};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &options);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    char text[400];
    int count = 0;
    strcpy(text, nevh_stepper_message(m));
    nevh_stepper_free(m);
    for (char *name = strtok(strrchr(text, ':') + 1, ", "); name;
         name = strtok(NULL, ", ")) {
        const nevh_integrator *other_scheme = nevh_integrator_named(name);
        m = nevh_stepper_new(s, other_scheme, &options);
        ck_assert_msg(!nevh_stepper_status(m), "%s for %s: %s", name,
                      nevh_integrator_name(scheme), nevh_stepper_message(m));
        ck_assert_int_ge(nevh_integrator_order(other_scheme),
                         nevh_integrator_order(scheme));
        nevh_stepper_free(m);
        count++;
    }
    ck_assert_int_eq(count, 3);
    nevh_system_free(s);
}

TEST_EACH(suggestions_fit, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_needs(scheme) == 0)
        skip_test("it fits any H");
    for (const problem *const *b = problems; *b; b++)
        if (!fits(scheme, *b))
            assert_suggestions(scheme, *b);
}

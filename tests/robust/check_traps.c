/* nevh tests: callers that have floating-point exceptions trapped.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include "shipped.h"
#include <fenv.h>
#include <math.h>

static const int trapped = FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW;

/* False where exceptions cannot be trapped. */
static bool trap(void) {
#ifdef __GLIBC__
    feclearexcept(FE_ALL_EXCEPT);
    return feenableexcept(trapped) != -1;
#else
    return false;
#endif
}

static void assert_trapping(const char *what) {
#ifdef __GLIBC__
    int on = fegetexcept();
    ck_assert_msg((on & trapped) == trapped, "%s: traps are off", what);
#else
    (void)what;
#endif
}

enum { STEPS = 20 };

typedef struct {
    nevh_scene *scene;
    const nevh_system *system;
    size_t n;
    double *q, *p, *a, *b;
    double t, h; /* the start, and a step of the scene */
    nevh_options options;
} subject;

static void open_subject(subject *s, int i) {
    find_shipped();
    s->scene = read_shipped(shipped[i]);
    s->system = nevh_scene_system(s->scene);
    s->n = nevh_scene_dof(s->scene);
    s->q = calloc(4 * s->n, sizeof *s->q);
    s->p = s->q + s->n;
    s->a = s->p + s->n;
    s->b = s->a + s->n;
    ck_assert_int_eq(nevh_scene_start(s->scene, s->q, s->p), NEVH_OK);
    const nevh_scene_run *run = nevh_scene_run_settings(s->scene);
    s->t = run->t_start;
    s->h = run->dts ? run->dt[0] : 0.01;
    s->options = (nevh_options){
        .t = s->t, .q = s->q, .p = s->p, .native = NEVH_NATIVE_NEVER};
}

static void close_subject(subject *s) {
    fedisableexcept(FE_ALL_EXCEPT);
    nevh_scene_free(s->scene);
    free(s->q);
}

static void restart(subject *s) {
    memcpy(s->a, s->q, s->n * sizeof *s->q);
    memcpy(s->b, s->p, s->n * sizeof *s->p);
}

/* True if H overflows nowhere. */
static bool run_untrapped(subject *s, const nevh_integrator *scheme,
                          const nevh_options *o) {
    fenv_t traps;
    feholdexcept(&traps);
    nevh_stepper *m = nevh_stepper_new(s->system, scheme, o);
    bool healthy = !nevh_stepper_status(m);
    feclearexcept(FE_ALL_EXCEPT);
    restart(s);
    healthy = healthy && !nevh_run(m, s->t, s->h, STEPS, s->a, s->b, NULL, 0) &&
              !fetestexcept(FE_OVERFLOW);
    nevh_stepper_free(m);
    restart(s);
    fesetenv(&traps);
    return healthy;
}

/* Runs two steppers: one without traps tells whether the run is a healthy one. */
static void use_schemes(subject *s) {
    static const size_t large = 64; /* implicit steps take matrices */
    if (s->n > large)
        return;
    for (const nevh_integrator *const *all = nevh_integrators(); *all; all++) {
        nevh_options o = s->options;
        o.tolerance = nevh_integrator_needs_tolerance(*all) ? 1e-6 : 0;
        nevh_stepper *m = nevh_stepper_new(s->system, *all, &o);
        restart(s);
        assert_trapping(nevh_integrator_name(*all));
        if (run_untrapped(s, *all, &o))
            nevh_run(m, s->t, s->h, STEPS, s->a, s->b, NULL, 0);
        nevh_stepper_free(m);
        assert_trapping(nevh_integrator_name(*all));
    }
}

static void use_scene(subject *s) {
    size_t fast, slow;
    const char *term;
    double t0 = s->t;
    nevh_separability found;
    nevh_system_parts(s->system, nevh_system_effect_name(s->system, 0), &fast,
                      &slow, &term);
    nevh_system_traits(s->system);
    nevh_system_probe(s->system, t0, s->q, s->p, NULL, &found);
    nevh_scene_set_start(s->scene, "x = 0.5"); /* may have no such name */
    nevh_scene *again = nevh_scene_parse("again", "[coordinates]\nx = 1, 0\n"
                                                  "[effects]\nT = p_x^2/2\n"
                                                  "V = log(x) + 1/x\n");
    nevh_scene_start(again, s->a, s->b);
    nevh_scene_free(again);
    assert_trapping("scene");
}

static void use_orbits(subject *s) {
    const double t1 = s->t + STEPS * s->h;
    nevh_chaos_finding finding;
    char why[400];
    nevh_certain *c = nevh_certain_new(s->system, s->t, s->q, s->p, 20);
    if (c && !nevh_certain_status(c))
        nevh_certain_go(c, t1);
    for (size_t k = 0; k < 2 * s->n; k++)
        free(nevh_certain_text(c, k));
    nevh_certain_free(c);
    assert_trapping("certain");
    nevh_reference *r =
        nevh_reference_new(s->system, NULL, s->t, t1, s->q, s->p);
    nevh_reference_state(r, t1, s->a, s->b);
    nevh_reference_error(r);
    nevh_reference_free(r);
    nevh_solution_ends(s->system, s->t, t1, s->q, s->p);
    nevh_solution_smooth(s->system, s->t, t1, s->q, s->p, why, sizeof why);
    assert_trapping("reference");
    nevh_chaos_find(s->system, &s->options, s->t, t1, 0.02, &finding);
    assert_trapping("chaos");
}

static void use_chaos(subject *s) {
    nevh_chaos_confirmation confirmed;
    double error;
    nevh_chaos *c = nevh_chaos_new(
        s->system, &(nevh_chaos_options){.integrator = nevh_gauss4,
                                         .options = &s->options,
                                         .t_start = s->t,
                                         .dt = s->h,
                                         .exponents = 2,
                                         .starts = 2});
    nevh_chaos_run(c, s->t + STEPS * s->h);
    nevh_chaos_result(c);
    nevh_chaos_exponent(c, 0, &error);
    nevh_chaos_confirm(c, 0, &confirmed);
    nevh_chaos_free(c);
    assert_trapping("indicators of chaos");
}

/* A small circle round the start, in the plane of the first coordinate. */
static int circle(void *data, size_t count, const double at[], double q[],
                  double p[]) {
    const subject *s = data;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < s->n; k++) {
            double turn = k ? 0 : 6.283185307179586 * at[i];
            q[k * count + i] = s->q[k] + (k ? 0 : 1e-3 * cos(turn));
            p[k * count + i] = s->p[k] + (k ? 0 : 1e-3 * sin(turn));
        }
    return 0;
}

static void use_diagnostics(subject *s) {
    static const size_t steps[] = {STEPS};
    double frequency, growth;
    nevh_rates *rates = nevh_rates_new(s->system, &s->options);
    nevh_rates_at(rates, s->t, s->q, s->p, &frequency, &growth);
    nevh_rates_free(rates);
    assert_trapping("rates");
    nevh_loop *loop = nevh_loop_new(
        s->system, nevh_gauss4, &s->options,
        &(nevh_loop_options){circle, s, .steps = steps, .times = 1, .t0 = s->t,
                             .h = s->h, .most_points = 256});
    nevh_loop_carry(loop);
    nevh_loop_free(loop);
    assert_trapping("loop");
    nevh_energy *e = nevh_energy_new(s->system, &s->options);
    nevh_shadow *shadow =
        nevh_shadow_new(s->system, nevh_verlet, s->h, &s->options);
    nevh_stepper *m = nevh_stepper_new(s->system, nevh_gauss4, &s->options);
    const nevh_observer watch[] = {{nevh_energy_observe, e, 1},
                                   {nevh_shadow_observe, shadow, 1}};
    restart(s);
    nevh_run(m, s->t, s->h, STEPS, s->a, s->b, watch,
             nevh_shadow_status(shadow) ? 1 : 2);
    nevh_energy_result(e, 0);
    nevh_stepper_free(m);
    nevh_shadow_free(shadow);
    nevh_energy_free(e);
    assert_trapping("energy");
}

static int take_member(void *data, const nevh_sweep_result *result) {
    (void)data;
    (void)result;
    return 0;
}

static void use_sweep(subject *s) {
    double at[64];
    nevh_spectral_line line[4];
    size_t found;
    for (int i = 0; i < 64; i++)
        at[i] = i % 8 ? 0 : 1;
    nevh_frequencies(0.1, 64, at, 4, line, &found);
    assert_trapping("frequencies");
    nevh_sweep *sweep = nevh_sweep_new(
        s->scene, &(nevh_sweep_options){.integrator = nevh_gauss4,
                                        .dt = s->h,
                                        .t_end = s->t + STEPS * s->h,
                                        .native = NEVH_NATIVE_NEVER});
    if (!nevh_sweep_status(sweep))
        nevh_sweep_run(sweep, 0, 4, NULL, take_member, NULL);
    nevh_sweep_free(sweep);
    assert_trapping("sweep");
}

/* No call on a healthy scene ends in a signal, or leaves the traps off. */
static void try_all(int i, void (*use)(subject *)) {
    if (!trap())
        skip_test("exceptions cannot be trapped here");
    subject s;
    open_subject(&s, i);
    use(&s);
    close_subject(&s);
}

/* Orbits of which a value of H overflows, or is divided by 0. */
static const char *const ending[] = {
    "x = 0\n[effects]\nT = p_x^2/2\nV = -1/x\n",
    "x = 1e200\n[effects]\nT = p_x^2/2\nV = x^4/4\n",
    "x = 1\np_x = -3\n[effects]\nT = p_x^2/2\nV = sqrt(x)\n"};
enum { ENDING = sizeof ending / sizeof *ending };

TEST_EACH(runs_that_end, 2 * ENDING) {
    char text[200];
    if (!trap())
        skip_test("exceptions cannot be trapped here");
    snprintf(text, sizeof text, "[coordinates]\n%s", ending[_i / 2]);
    nevh_scene *scene = nevh_scene_parse("test", text);
    static const double planned[] = {1, 0.5};
    double start[2], z[2], floor;
    nevh_scene_start(scene, start, start + 1);
    nevh_options o = {.gradient = nevh_exact,
                      .q = planned,
                      .p = planned + 1,
                      .native =
                          _i % 2 ? NEVH_NATIVE_ALWAYS : NEVH_NATIVE_NEVER};
    nevh_stepper *s =
        nevh_stepper_new(nevh_scene_system(scene), nevh_verlet, &o);
    nevh_energy *e = nevh_energy_new(nevh_scene_system(scene), &o);
    memcpy(z, start, sizeof z);
    nevh_observer observer = {nevh_energy_observe, e, 1};
    ck_assert_int_ne(nevh_run(s, 0, 0.05, 400, z, z + 1, &observer, 1),
                     NEVH_OK);
    assert_trapping("run");
    memcpy(z, start, sizeof z);
    nevh_stepper_reset(s);
    ck_assert_int_ne(nevh_run_until(s, 0, 0.05, 20, z, z + 1, NULL, 0),
                     NEVH_OK);
    assert_trapping("run_until");
    nevh_field_energy_floor(nevh_stepper_field(s), 0, start, start + 1, 0.05, 9,
                            &floor);
    assert_trapping("energy_floor");
    fedisableexcept(FE_ALL_EXCEPT);
    nevh_energy_free(e);
    nevh_stepper_free(s);
    nevh_scene_free(scene);
}

TEST_EACH(schemes, find_shipped()) {
    try_all(_i, use_schemes);
}

TEST_EACH(scenes, find_shipped()) {
    try_all(_i, use_scene);
}

TEST_EACH(orbits, find_shipped()) {
    try_all(_i, use_orbits);
}

TEST_EACH(chaos, find_shipped()) {
    try_all(_i, use_chaos);
}

TEST_EACH(diagnostics, find_shipped()) {
    try_all(_i, use_diagnostics);
}

TEST_EACH(sweeps, find_shipped()) {
    try_all(_i, use_sweep);
}

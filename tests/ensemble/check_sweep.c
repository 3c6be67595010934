/* nevh tests: members of a scene, and what becomes of them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include "../support/native.h"
#include "ensemble/outcomes/outcome_private.h"
#include "scene/sweep_private.h"
#include "support.h"
#include <gsl/gsl_sf_ellint.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define PENDULUM                                                               \
    "[parameters]\ng = 9.8\n[coordinates]\nphi = 1 ; period 2*pi\n"            \
    "[effects]\nkinetic = p_phi^2/2\ngravity = -g*cos(phi)\n"                  \
    "[sections]\nswing = when phi = 0, rising: phi\n"                          \
    "[run]\nt_end = 40\ndt = 0.05\n[ensemble]\n"

enum { MOST = 700, COLUMNS = 10 };
typedef struct {
    size_t count, columns;
    uint64_t last;
    bool in_order;
    double row[MOST][COLUMNS];
    nevh_member_status status[MOST];
    char message[300];
    uint64_t by_lane; /* members whose lanes had constants of their own */
} results;

static int tell(void *data, const nevh_sweep_result *r) {
    results *all = data;
    all->in_order &= all->count == 0 || r->member > all->last;
    all->last = r->member;
    all->count++;
    all->status[r->member] = r->status;
    if (r->status != NEVH_MEMBER_DONE)
        snprintf(all->message, sizeof all->message, "%s", r->message);
    memcpy(all->row[r->member], r->values, all->columns * sizeof(double));
    return 0;
}

static nevh_scene *scene_of(const char *text) {
    nevh_scene *scene = nevh_scene_parse("test", text);
    ck_assert_str_eq(nevh_scene_message(scene), "");
    return scene;
}

static nevh_sweep_options plain(void) {
    return (nevh_sweep_options){
        .integrator = nevh_gauss10, .gradient = nevh_exact, .ordered = true};
}

static results *run(const char *text, nevh_sweep_options o) {
    results *all = calloc(1, sizeof *all);
    nevh_scene *scene = scene_of(text);
    nevh_sweep *s = nevh_sweep_new(scene, &o);
    ck_assert_str_eq(nevh_sweep_message(s), "");
    all->columns = nevh_sweep_columns(s);
    all->in_order = true;
    ck_assert_uint_le(nevh_sweep_members(s), MOST);
    ck_assert_uint_le(all->columns, COLUMNS);
    ck_assert_int_eq(nevh_sweep_run(s, 0, UINT64_MAX, NULL, tell, all),
                     NEVH_OK);
    ck_assert_uint_eq(all->count, nevh_sweep_members(s));
    all->by_lane = s->by_lane;
    nevh_sweep_free(s);
    nevh_scene_free(scene);
    return all;
}

TEST(periods_are_the_elliptic_integral) {
    results *all = run(PENDULUM "phi = range(0.05, 3.05, 61)\n"
                                "outcomes = period, crossings\n",
                       plain());
    ck_assert_uint_eq(all->count, 61);
    for (size_t i = 0; i < 61; i++) {
        double amplitude = all->row[i][0];
        double period =
            4 / sqrt(9.8) *
            gsl_sf_ellint_Kcomp(sin(amplitude / 2), GSL_PREC_DOUBLE);
        ck_assert_double_eq_tol(amplitude, 0.05 + 0.05 * (double)i, 1e-15);
        ck_assert_double_eq_tol(all->row[i][1] / period, 1, 1e-9);
        ck_assert_double_eq(all->row[i][2], floor(40 / period + 0.25));
    }
    free(all);
}

/* Of a momentum over a period: the root of action over period, while the mean is
   0.  The rule on the steps has positive weights: no mean exceeds the rms. */
TEST_EACH(rms_is_the_root_mean_square, 4) {
    double k = sin((_i + 1) * 0.35), K = gsl_sf_ellint_Kcomp(k, 0);
    double action = gsl_sf_ellint_Ecomp(k, 0) / K - (1 - k * k);
    char text[800];
    snprintf(text, sizeof text,
             PENDULUM "phi = %.17g, 0\noutcomes = rms(p_phi), mean(p_phi), "
                      "rms(sin(2*pi*t/%.17g)), rms(phi - 1), mean(phi - 1), "
                      "rms(-3), rms(t)\n",
             2 * asin(k), 4 * K / sqrt(9.8));
    nevh_sweep_options o = plain();
    o.t_end = 4 * K / sqrt(9.8);
    o.dt = o.t_end / 400;
    results *all = run(text, o);
    const double *row = all->row[0];
    ck_assert_double_eq_tol(row[1], 2 * sqrt(9.8 * action), 1e-9);
    ck_assert_double_lt(fabs(row[2]), 1e-9);
    ck_assert_double_eq_tol(row[3], sqrt(0.5), 1e-12);
    ck_assert_double_gt(row[4], fabs(row[5]) * (1 + 1e-3));
    ck_assert_double_eq_tol(row[6], 3, 1e-15);
    ck_assert_double_eq_tol(
        row[7], sqrt(o.t_end * o.t_end / 3 + o.dt * o.dt / 6), 1e-12);
    free(all);
}

/* Squares overflow or vanish, as the mean of squares shows; the rms does not. */
TEST(rms_is_of_any_unit) {
    results *all =
        run(PENDULUM "phi = 0, 1, 2\noutcomes = rms(phi), rms(2^1000*phi), "
                     "rms(phi/2^1000), mean((2^1000*phi)^2), "
                     "mean((phi/2^1000)^2), rms(phi*t), rms(1/phi), "
                     "rms(exp(-1e5*t)), mean(exp(-2e5*t))\n",
            plain());
    for (size_t i = 0; i < all->count; i++) {
        const double *row = all->row[i];
        ck_assert_double_eq(row[2], ldexp(row[1], 1000));
        ck_assert_double_eq(row[3], ldexp(row[1], -1000));
        ck_assert_double_eq(row[5], 0);
        ck_assert_int_eq(isfinite(row[4]) != 0, i == 0);
        ck_assert_int_eq(row[6] > row[1], i > 0);
        ck_assert_int_eq(isnan(row[7]) != 0, i == 0);
        ck_assert_double_eq_tol(row[8], sqrt(row[9]), 1e-15);
    }
    free(all);
}

TEST_EACH(rms_is_that_of_orbits_alone, 4) {
    static const char text[] =
        PENDULUM "g = 8, 9.8\nphi = range(-3, 3, 100)\n"
                 "outcomes = rms(phi), rms(v_phi*t), mean(phi), last(phi)\n";
    nevh_sweep_options o = plain();
    o.integrator = _i % 2 ? nevh_dopri5 : nevh_verlet;
    o.tolerance = _i % 2 ? 1e-8 : 0;
    o.width = 1;
    results *one = run(text, o);
    o.width = _i < 2 ? 8 : 32;
    o.threads = 3;
    results *many = run(text, o);
    ck_assert_mem_eq(many->row, one->row, sizeof one->row);
    for (size_t i = 0; i < one->count; i++)
        ck_assert_double_ge(one->row[i][2] * (1 + 1e-15), fabs(one->row[i][4]));
    free(one);
    free(many);
}

/* A parameter that is varied gives the same as the same scene with it set. */
TEST(parameters_are_those_of_a_scene) {
    const double g[] = {1.6, 9.8, 24.8};
    results *all = run(PENDULUM "g = 1.6, 9.8, 24.8\nphi = 0.5, 2\n", plain());
    ck_assert_uint_eq(all->count, 6);
    for (size_t i = 0; i < 6; i++) {
        char text[600];
        snprintf(text, sizeof text, PENDULUM "phi = %s\n", i % 2 ? "2" : "0.5");
        char *at = strstr(text, "g = 9.8");
        memcpy(at, i < 2 ? "g = 1.6" : i < 4 ? "g = 9.8" : "g =24.8", 7);
        results *one = run(text, plain());
        ck_assert_double_eq(all->row[i][0], g[i / 2]);
        ck_assert_double_eq(all->row[i][1], i % 2 ? 2 : 0.5);
        ck_assert_mem_eq(all->row[i] + 2, one->row[0] + 1, 3 * sizeof(double));
        free(one);
    }
    free(all);
}

TEST(order_is_of_the_lines) {
    results *product = run(PENDULUM "phi = range(0, 1, 3)\np_phi = 4, 5\n"
                                    "outcomes = t\n",
                           plain());
    results *zip = run(PENDULUM "phi = range(0, 1, 3)\np_phi = 4, 5, 6\n"
                                "combine = zip\noutcomes = t\n",
                       plain());
    ck_assert_uint_eq(product->count, 6);
    ck_assert_uint_eq(zip->count, 3);
    for (size_t i = 0; i < 6; i++) {
        ck_assert_double_eq(product->row[i][0], 0.5 * (double)(i / 2));
        ck_assert_double_eq(product->row[i][1], 4 + (double)(i % 2));
    }
    for (size_t i = 0; i < 3; i++) {
        ck_assert_double_eq(zip->row[i][0], 0.5 * (double)i);
        ck_assert_double_eq(zip->row[i][1], 4 + (double)i);
    }
    free(product);
    free(zip);
}

/* Draws go by seed, name and number alone: not by what else is varied. */
TEST(draws_are_of_seed_name_and_number) {
    results *a = run(PENDULUM "phi = normal(1, 0.1)\ncount = 600\nseed = 3\n"
                              "outcomes = t\n",
                     plain());
    results *b = run(PENDULUM "p_phi = uniform(0, 1)\nphi = normal(1, 0.1)\n"
                              "count = 500\nseed = 3\noutcomes = t\n",
                     plain());
    results *c = run(PENDULUM "phi = normal(1, 0.1)\ncount = 600\nseed = 4\n"
                              "outcomes = t\n",
                     plain());
    for (size_t i = 0; i < 500; i++) {
        ck_assert_double_eq(a->row[i][0], b->row[i][1]);
        ck_assert_double_ne(a->row[i][0], c->row[i][0]);
        ck_assert(b->row[i][0] > 0 && b->row[i][0] < 1);
        ck_assert_double_eq(a->row[i][0],
                            1 + 0.1 * nevh_normal_at(3, "phi", i));
    }
    free(a);
    free(b);
    free(c);
}

TEST(threads_and_widths_change_nothing) {
    static const char text[] =
        PENDULUM "phi = range(-3, 3, 300)\np_phi = 0, 2\n"
                 "outcomes = first(abs(phi) > pi), energy_error, mean(v_phi), "
                 "state\n";
    nevh_sweep_options o = plain();
    o.integrator = nevh_verlet;
    o.gradient = NULL;
    o.width = 1;
    results *one = run(text, o);
    ck_assert(one->in_order);
    for (size_t i = 0; i < 4; i++) {
        o.width = i < 2 ? 8 : 32;
        o.threads = 1 + i % 2 * 2;
        o.ordered = i != 3;
        results *other = run(text, o);
        ck_assert(i == 3 || other->in_order);
        ck_assert_mem_eq(other->row, one->row, sizeof one->row);
        free(other);
    }
    free(one);
}

/* Members without a start are told of. */
TEST(members_without_a_start_are_told) {
    results *all = run("[parameters]\na = 1\n[coordinates]\nx = 1\n"
                       "[effects]\nkinetic = p_x^2/2\nwell = -a*log(x)/x\n"
                       "[run]\nt_end = 0.1\ndt = 0.01\n"
                       "[ensemble]\nx = -1, 1, 2\n",
                       plain());
    ck_assert_int_eq(all->status[0], NEVH_MEMBER_NO_START);
    ck_assert_int_eq(all->status[1], NEVH_MEMBER_DONE);
    ck_assert_int_eq(all->status[2], NEVH_MEMBER_DONE);
    assert_says(all->message, "well");
    ck_assert_double_eq(all->row[0][0], -1);
    ck_assert_double_nan(all->row[0][1]);
    free(all);
}

#define HENON_HEILES                                                           \
    "[coordinates]\nx = 0\ny = 0.1\n[effects]\n"                               \
    "kinetic = (p_x^2 + p_y^2)/2\nsprings = (x^2 + y^2)/2\n"                   \
    "cubic = x^2*y - y^3/3\n[run]\nt_end = 1\ndt = 0.1\n[ensemble]\n"

/* Momenta of one energy, of the sign that the search begins with; beyond the
   energy's boundary, as at y = 0.8, there is none. */
TEST_EACH(momenta_are_solved_for, 2) {
    const char *from = _i ? "-0.4" : "0.4";
    char text[600];
    snprintf(text, sizeof text,
             HENON_HEILES "p_x = solve(H = 1/8, from %s)\n"
                          "y = range(-0.4, 0.8, 13)\noutcomes = t\n",
             from);
    results *all = run(text, plain());
    for (size_t i = 0; i < 13; i++) {
        double p = all->row[i][0], y = all->row[i][1];
        double room = 1. / 4 - y * y + 2 * y * y * y / 3;
        if (room > 1e-12) {
            ck_assert_int_eq(all->status[i], NEVH_MEMBER_DONE);
            ck_assert_double_eq_tol(p, (_i ? -1 : 1) * sqrt(room), 1e-15);
        }
    }
    ck_assert_int_eq(all->status[12], NEVH_MEMBER_NO_START);
    ck_assert_double_nan(all->row[12][0]);
    assert_says(all->message, "no solution");
    free(all);
}
END_TEST

/* Of any formula, for a coordinate, after what else is varied. */
TEST(formulas_are_solved) {
    results *all = run(PENDULUM "phi = solve(sin(phi) = p_phi/g, from 0)\n"
                                "p_phi = 1, 2\ng = 5, 10\noutcomes = t\n",
                       plain());
    for (size_t i = 0; i < 4; i++)
        ck_assert_double_eq_tol(all->row[i][0],
                                asin(all->row[i][1] / all->row[i][2]), 1e-15);
    free(all);
}
END_TEST

static const struct {
    const char *line, *says;
} wrong[] = {
    {"phi = range(0, 1, 0)", "whole number"},
    {"phi = range(0, 1)", "range(A, B, N)"},
    {"phi = range(0, 1, 1e6)\np_phi = range(0, 1, 1e6)", "1e+12 members"},
    {"phi = normal(1, 1)", "how many"},
    {"phi = normal(1, -1)\ncount = 3", "deviation"},
    {"phi = uniform(1, 1)\ncount = 3", "below"},
    {"phi = 1, 2\ncount = 3", "nothing is drawn"},
    {"phi = 1, 2\np_phi = 1, 2, 3\ncombine = zip", "equally many"},
    {"phi = 1\nphi = 2", "already"},
    {"psi = 1", "psi"},
    {"phi = x", "x is not known"},
    {"phi = 1\noutcomes = firts(phi > 1)", "did you mean first?"},
    {"phi = 1\noutcomes = first(phi)", "FORMULA > FORMULA"},
    {"phi = 1\noutcomes = last(psi)", "psi"},
    {"phi = 1\noutcomes = period(swim)", "did you mean swing?"},
    {"phi = 1\ncombine = both", "product or zip"},
    {"phi = 1\nseed = 1.5", "whole number"},
    {"p_phi = 1\nv_phi = 1", "both"},
    {"p_phi = solve(H)", "solve(FORMULA = FORMULA, from NUMBER)"},
    {"p_phi = solve(H = 1, 2)", "solve(FORMULA = FORMULA, from NUMBER)"},
    {"p_phi = solve(H = 1, from phi)", "phi"},
    {"g = solve(H = 1)", "a coordinate or a momentum"},
};

TEST_EACH(wrong_lines_are_refused, sizeof wrong / sizeof *wrong) {
    char text[600];
    snprintf(text, sizeof text, PENDULUM "%s\n", wrong[_i].line);
    nevh_scene *scene = nevh_scene_parse("test", text);
    ck_assert_int_ne(nevh_scene_status(scene), NEVH_OK);
    assert_says(nevh_scene_message(scene), wrong[_i].says);
    assert_says(nevh_scene_message(scene), "test:1");
    nevh_scene_free(scene);
}

/* Lines from outside replace the scene's; one that is wrong changes nothing. */
TEST(lines_from_outside_replace) {
    nevh_scene *scene = scene_of(PENDULUM "phi = 1, 2\n");
    uint64_t digest = nevh_scene_digest(scene);
    const char *wrong_one[] = {"g = 3", "psi = 1"};
    const char *fine[] = {"phi = range(0, 1, 5)", "g = 1, 2"};
    ck_assert_int_eq(nevh_scene_vary(scene, wrong_one, 2), NEVH_EINVAL);
    ck_assert_uint_eq(nevh_scene_digest(scene), digest);
    ck_assert_int_eq(nevh_scene_vary(scene, fine, 2), NEVH_OK);
    ck_assert_int_eq(nevh_scene_set_outcomes(scene, "t"), NEVH_OK);
    ck_assert_uint_ne(nevh_scene_digest(scene), digest);
    nevh_sweep_options o = plain();
    nevh_sweep *s = nevh_sweep_new(scene, &o);
    ck_assert_str_eq(nevh_sweep_message(s), "");
    ck_assert_uint_eq(nevh_sweep_members(s), 10);
    ck_assert_uint_eq(nevh_sweep_columns(s), 3);
    ck_assert_str_eq(nevh_sweep_column(s, 0), "phi");
    ck_assert_str_eq(nevh_sweep_column(s, 1), "g");
    ck_assert_str_eq(nevh_sweep_column(s, 2), "t");
    nevh_sweep_free(s);
    nevh_scene_free(scene);
}

/* A parameter that only the start reads gives what the start itself does; one
   that something else reads, too, gives what the scene with that value gives. */
#define START_OF(system, run)                                                     \
    "[parameters]\na = 1\n[coordinates]\nphi = %s ; period 2*pi\n" system         \
    "[sections]\nswing = when phi = 0.1*%s, rising: phi\n[run]\nt_end = 30\n" run \
    "[ensemble]\n%s\n"
#define PLAIN "[effects]\nkinetic = p_phi^2/2\ngravity = -cos(phi)\n"

static const struct {
    const char *text;
    const char *level, *outcomes; /* with a in them */
    bool only;                    /* the start reads a */
} uses[] = {
    {START_OF(PLAIN, "dt = 0.1\n"), "1", "state, crossings", true},
    {START_OF(PLAIN, "dt = 0.1*a\n"), "1", "state", false},
    {START_OF(PLAIN, "dt = 0.1\nstop = phi < a/2\n"), "1", "t, state", false},
    {START_OF(PLAIN, "dt = 0.1\n"), "1", "last(a*phi)", false},
    {START_OF(PLAIN, "dt = 0.1\n"), "a", "period", false},
    {START_OF("[effects]\nT = p_phi^2/2\nV = -cos(a*phi)\n", "dt = 0.1\n"), "1",
     "state", false},
    {START_OF("[effects]\nT = p_phi^2/2\nV = -sum(i = 1..2, a*cos(phi))\n",
              "dt = 0.1\n"),
     "1", "state", false},
    {START_OF(PLAIN "[friction]\ndrag = all: 0.1*a\n", "dt = 0.1\n"), "1",
     "state", false},
};

static results *run_use(int i, const char *varied, const char *phi) {
    char text[900], lines[200];
    nevh_sweep_options o = plain();
    snprintf(lines, sizeof lines, "%s\noutcomes = %s", varied,
             uses[i].outcomes);
    snprintf(text, sizeof text, uses[i].text, phi, uses[i].level, lines);
    o.integrator = nevh_rk4;
    return run(text, o);
}

TEST_EACH(parameters_of_the_start_are_a_start, sizeof uses / sizeof *uses) {
    results *by_a = run_use(_i, "a = 0.7, 1, 1.3", "a");
    results *by_phi = run_use(_i, "phi = 0.7, 1, 1.3", "1");
    results *both = run_use(_i, "a = 0.7, 1, 1.3\nphi = 0.7, 1, 1.3", "1");
    size_t outcomes = (by_a->columns - 1) * sizeof(double);
    for (int i = 0; i < 3; i++) {
        /* both: rows 0, 4 and 8 have a and phi alike */
        ck_assert_mem_eq(by_a->row[i] + 1, both->row[4 * i] + 2, outcomes);
        bool same = memcmp(by_a->row[i] + 1, by_phi->row[i] + 1, outcomes) == 0;
        ck_assert_int_eq(same, uses[_i].only || i == 1);
    }
    free(by_a);
    free(by_phi);
    free(both);
}

/* Members whose formulas differ in numbers: alone they have a stepper of their
   own.  Some differ more than in numbers (a power of two is multiplied by), in
   constants of instances, in friction; and some fail. */
#define ROD                                                                    \
    "[parameters]\nm = 1.3\nl = 1\ng = 9.8\n"                                  \
    "[coordinates]\nphi = 1 ; period 2*pi\n[effects]\n"                        \
    "kinetic = p_phi^2/(2*m*l^2)\ngravity = -m*g*l*cos(phi)\n"                 \
    "[run]\nt_end = 5\ndt = 0.05\n[ensemble]\n"
#define CHAIN                                                                  \
    "[parameters]\nN = 3\nk = 2\na = 0.3\n"                                    \
    "[coordinates]\nx[i = 1..N] = i/5\n[effects]\n"                            \
    "kinetic = sum(i = 1..N, p_x[i]^2/(2*(1 + k*i)))\n"                        \
    "springs = sum(i = 1..N - 1, k*i*(x[i+1] - x[i])^2/2)\n"                   \
    "walls = sum(i = 1..N, a*x[i]^4 + x[i]^2)\n"                               \
    "[run]\nt_end = 2\ndt = 0.05\n[ensemble]\n"
#define EDGE                                                                   \
    "[parameters]\nb = 1\n[coordinates]\nx = 0\n[effects]\n"                   \
    "kinetic = p_x^2/2\nroot = sqrt(b - x)\n"                                  \
    "[run]\nt_end = 2\ndt = 0.05\n[ensemble]\n"

/* With how many go side by side: not those in which a number is a power of two
   at that, and none where velocities are asked for.  In the last but one Newton's
   iteration takes some steps. */
static const struct {
    const char *text;
    uint64_t by_lane;
} varying[] = {
    {ROD "l = range(0.5, 2, 40)\noutcomes = state, energy_error, verdict\n",
     39},
    {ROD "l = range(0.6, 2, 7)\nphi = 1, 2\nm = 1, 2, 3.1\n"
         "outcomes = state, energy_error, max(phi)\n",
     38},
    {ROD "g = uniform(1, 20)\ncount = 30\n"
         "outcomes = first(phi < 0), min(p_phi)\n",
     30},
    {CHAIN "k = range(0.5, 2, 20)\noutcomes = last(x[1]), last(p_x[3]), "
           "energy_error\n",
     19},
    {CHAIN "a = range(-0.5, 0.7, 20)\nk = 2.1, 2\n"
           "outcomes = last(x[2]), energy_error\n",
     40},
    {EDGE "b = range(0.1, 3, 33)\noutcomes = state, energy_error\n", 33},
    {ROD "l = range(0.004, 0.5, 20)\noutcomes = state, energy_error\n", 20},
    {ROD "l = range(0.5, 2, 20)\noutcomes = max(l*sin(phi)), mean(v_phi)\n", 0},
};
enum { VARYING = sizeof varying / sizeof *varying };
/* The first five with all gradients, others with one each.  The last one does
   not go by lane. */
static const nevh_integrator *const *const by_schemes[] = {
    &nevh_verlet,   &nevh_blanes_moan4, &nevh_rk4,      &nevh_rk3,
    &nevh_gauss4,   &nevh_dprkn12,      &nevh_midpoint, &nevh_implicit_euler,
    &nevh_lobatto4, &nevh_gauss16,      &nevh_gonzalez};
static const nevh_gradient *const *const by_gradients[] = {
    &nevh_exact, &nevh_central2, &nevh_central4, &nevh_central6};
enum {
    SCHEMES = sizeof by_schemes / sizeof *by_schemes,
    GRADIENTS = sizeof by_gradients / sizeof *by_gradients,
    WITH_ALL = 5 * GRADIENTS,
    EACH = WITH_ALL + SCHEMES - 5
};

static void compare_with_alone(const char *text, uint64_t by_lane,
                               nevh_sweep_options o) {
    o.width = 1;
    results *one = run(text, o);
    ck_assert_uint_eq(one->by_lane, 0);
    for (size_t i = 0; i < 3; i++) {
        o.width = i == 0 ? 8 : i == 1 ? 0 : 24;
        o.threads = 1 + i % 2;
        results *other = run(text, o);
        ck_assert(other->in_order);
        ck_assert_mem_eq(other->status, one->status, sizeof one->status);
        ck_assert_str_eq(other->message, one->message);
        ck_assert_mem_eq(other->row, one->row, sizeof one->row);
        ck_assert_uint_eq(other->by_lane, by_lane);
        free(other);
    }
    free(one);
}

TEST_EACH(parameters_by_lane_are_those_of_orbits_alone, VARYING *EACH) {
    nevh_sweep_options o = plain();
    size_t which = _i / EACH, at = _i % EACH;
    size_t scheme = at < WITH_ALL ? at / GRADIENTS : at - WITH_ALL + 5;
    size_t g = at < WITH_ALL ? at % GRADIENTS : (scheme + which) % GRADIENTS;
    bool goes = scheme + 1 < SCHEMES;
    o.integrator = *by_schemes[scheme];
    o.gradient = *by_gradients[g];
    o.portable = g == 1;
    compare_with_alone(varying[which].text, goes ? varying[which].by_lane : 0,
                       o);
}

/* Under `always` members go by lane where such steps are compiled. */
TEST_EACH(compiled_steps_by_lane, 5) {
    const struct {
        const nevh_integrator *integrator;
        const nevh_gradient *gradient;
        size_t which;
    } some[] = {{nevh_verlet, nevh_exact, 0},
                {nevh_verlet, nevh_central4, 3},
                {nevh_rk4, nevh_central4, 0},
                {nevh_gauss4, nevh_exact, 6},
                {nevh_lobatto4, nevh_exact, 3}};
    size_t which = some[_i].which;
    nevh_sweep_options o = plain();
    if (!has_compiler())
        skip_test("there is no C compiler");
    make_cache();
    o.integrator = some[_i].integrator;
    o.gradient = some[_i].gradient;
    o.native = NEVH_NATIVE_ALWAYS;
    o.native_cache = cache;
    compare_with_alone(varying[which].text, varying[which].by_lane, o);
    remove_cache();
}

static const nevh_integrator *const *const adaptive[] = {
    &nevh_dopri5, &nevh_dop853, &nevh_dprkn12};
enum { ADAPTIVE = sizeof adaptive / sizeof *adaptive };

TEST_EACH(parameters_by_lane_under_a_tolerance, VARYING *ADAPTIVE) {
    nevh_sweep_options o = plain();
    size_t which = _i / ADAPTIVE;
    o.integrator = *adaptive[_i % ADAPTIVE];
    o.tolerance = 1e-7;
    o.gradient = *by_gradients[_i % GRADIENTS];
    compare_with_alone(varying[which].text, varying[which].by_lane, o);
}

/* The list, of which the live page makes outcomes that nobody asks for. */
TEST(outcomes_are_those_of_the_list) {
#define ENTRY(name, takes) {#name, NEVH_OUTCOME_TAKES_##takes},
    static const struct {
        const char *name;
        int takes;
    } list[] = {NEVH__OUTCOMES(ENTRY)};
#undef ENTRY
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        ck_assert_str_eq(nevh_outcomes()[i]->name, list[i].name);
        ck_assert_int_eq((int)nevh_outcomes()[i]->takes, list[i].takes);
    }
    ck_assert_ptr_null(nevh_outcomes()[sizeof list / sizeof *list]);
}

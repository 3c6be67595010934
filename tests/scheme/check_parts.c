/* nevh tests: steps by parts.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/form_panel_private.h"
#include "kernels/splitting_private.h"
#include "support.h"
#include <float.h>
#include <math.h>
#include <stdio.h>

typedef struct {
    double z[4];
} state;

/* Springs, rotation and a uniform field; and a centre. */
static const struct {
    const char *fast;
    state start;
} fast_parts[] = {
    {"springs = x^2/2 + 0.6*y^2\nrotation = -w*(x*p_y - y*p_x)\n"
     "field = 0.3*x\n",
     {{0.8, -0.5, 0.3, 0.4}}},
    {"sun = -0.8/hypot(x, y)\n", {{0.8, -0.5, 0.45, 0.8}}},
};
enum { FAST_PARTS = sizeof fast_parts / sizeof *fast_parts };
static int chosen; /* of them */

/* With B of size e. */
static nevh_scene *scene_of(double e, const char *more) {
    char text[700];
    snprintf(text, sizeof text,
             "[parameters]\ne = %.17g\nw = 0.4\n[effects]\n"
             "kinetic = (p_x^2 + p_y^2)/2\n%s"
             "quartic = e*(x^4 + x^2*y + y^4/2)\n%s[run]\nt_end = 1\n",
             e, fast_parts[chosen].fast, more);
    return scene_with("x = 0.8, 0.3\ny = -0.5, 0.4\n", text);
}

static nevh_stepper *stepper_of(const nevh_system *s,
                                const nevh_integrator *scheme) {
    const state *at = &fast_parts[chosen].start;
    nevh_options o = {.gradient = nevh_exact, .q = at->z, .p = at->z + 2};
    return nevh_stepper_new(s, scheme, &o);
}

static state orbit_from(state x, const nevh_system *s,
                        const nevh_integrator *scheme, double h, size_t steps) {
    nevh_stepper *stepper = stepper_of(s, scheme);
    ck_assert_str_eq(nevh_stepper_message(stepper), "");
    ck_assert(!nevh_run(stepper, 0, h, steps, x.z, x.z + 2, NULL, 0));
    nevh_stepper_free(stepper);
    return x;
}

static double distance(state a, state b) {
    double sum = 0;
    for (int k = 0; k < 4; k++)
        sum = hypot(sum, a.z[k] - b.z[k]);
    return sum;
}

/* The error of one step, by powers of e: each part divided by its power. */
typedef struct {
    double of[4]; /* of[1] to of[3] */
} parts;

static state error_of(const nevh_integrator *scheme, double e, double h) {
    nevh_scene *s = scene_of(e, "");
    const nevh_system *system = nevh_scene_system(s);
    state start = fast_parts[chosen].start;
    state x = orbit_from(start, system, scheme, h, 1);
    state exact = orbit_from(start, system, nevh_gauss20, h / 8, 8);
    for (int k = 0; k < 4; k++)
        x.z[k] -= exact.z[k];
    nevh_scene_free(s);
    return x;
}

/* A polynomial of degree 6 without constant term through e, -e, 2 e ... -3 e. */
static parts errors_of(const nevh_integrator *scheme, double e, double h) {
    parts r = {{0}};
    state d[7];
    for (int i = 0; i < 7; i++)
        if (i != 3)
            d[i] = error_of(scheme, (i - 3) * e, h);
    for (int k = 0; k < 4; k++) {
        double odd[4], even[4];
        for (int i = 1; i < 4; i++) {
            odd[i] = (d[3 + i].z[k] - d[3 - i].z[k]) / 2;
            even[i] = (d[3 + i].z[k] + d[3 - i].z[k]) / 2;
        }
        double first = (1.5 * odd[1] - 0.3 * odd[2] + odd[3] / 30) / e;
        double second =
            (1.5 * even[1] - 0.15 * even[2] + even[3] / 90) / (e * e);
        double third = (-13 * odd[1] + 8 * odd[2] - odd[3]) / (24 * e * e * e);
        r.of[1] = hypot(r.of[1], first);
        r.of[2] = hypot(r.of[2], second);
        r.of[3] = hypot(r.of[3], third);
    }
    return r;
}

static const struct {
    const nevh_integrator *const *scheme;
    int order[4]; /* of h in the error's part e, e^2, e^3 */
} known[] = {
    {&nevh_wisdom_holman, {0, 2, 2, 4}}, {&nevh_saba2, {0, 4, 2, 4}},
    {&nevh_saba3, {0, 6, 2, 4}},         {&nevh_saba4, {0, 8, 2, 4}},
    {&nevh_aba84, {0, 8, 4, 4}},         {&nevh_aba864, {0, 8, 6, 4}},
    {&nevh_aba1064, {0, 10, 6, 4}},
};
enum { KNOWN = sizeof known / sizeof *known };

/* Slopes of the error of a step over h; what they are off falls with the square of
   h, and is extrapolated. */
static double slope_at(const nevh_integrator *scheme, int power, double h) {
    const double e = 0.1, ratio = 0.8;
    double size[3], slope[2];
    for (int i = 0; i < 3; i++)
        size[i] = errors_of(scheme, e, h * pow(ratio, i)).of[power];
    for (int i = 0; i < 2; i++)
        slope[i] = log(size[i + 1] / size[i]) / log(ratio) - 1;
    return (slope[1] - ratio * ratio * slope[0]) / (1 - ratio * ratio);
}

/* In each power of the size of B the error of a step falls by the published
   power of h. */
TEST_EACH(orders_in_both_quantities, KNOWN *FAST_PARTS) {
    const nevh_integrator *scheme = *known[_i % KNOWN].scheme;
    chosen = _i / KNOWN;
    double low = chosen ? 0.05 : 0.2;
    for (int power = 1; power < 4; power++) {
        int order = known[_i % KNOWN].order[power];
        if (order == 10)
            continue; /* below rounding: weights_by_algebra */
        double slope = slope_at(scheme, power, order < 5 ? low : 0.36);
        ck_assert_msg(fabs(slope - order) <= 0.1,
                      "%s: e^%d h^%d, measured h^%.3f",
                      nevh_integrator_name(scheme), power, order, slope);
    }
    chosen = 0;
}

/* Times of kicks in [-1, 1], and their weights. */
typedef struct {
    size_t count;
    long double x[20], b[20];
} kicks;

static kicks kicks_of(const nevh_splitting *table, long double wrong) {
    long double w[41], time = -1;
    kicks k = {.count = nevh__splitting_operations(table) / 2};
    nevh__splitting_expand_wide(table, w);
    w[0] += wrong;
    for (size_t i = 0; i < k.count; i++) {
        time += 2 * w[2 * i];
        k.x[i] = time;
        k.b[i] = w[2 * i + 1];
    }
    return k;
}

/* The most that sum_i b_i x_i^d is off; and that, over pairs of kicks one after the
   other, of x^m y^l - x^l y^m with m + l + 2 = d is. */
static long double once(const kicks *k, int d) {
    long double sum = d % 2 ? 0 : -1.0L / (d + 1);
    for (size_t i = 0; i < k->count; i++)
        sum += k->b[i] * powl(k->x[i], d);
    return fabsl(sum);
}
/* Over y from -1 to 1 and x from -1 to y, of x^m y^l. */
static long double integral(int m, int l) {
    long double inner = (l + m) % 2 ? 2.0L / (l + m + 2) : 0;
    long double edge = l % 2 ? 0 : 2.0L / (l + 1);
    return (inner + (m % 2 ? -edge : edge)) / (m + 1);
}
static long double twice(const kicks *k, int d) {
    long double worst = 0;
    for (int m = 1; m <= d - 2; m++) {
        int l = d - 2 - m;
        if (l >= m)
            continue;
        long double sum = -(integral(m, l) - integral(l, m)) / 4;
        for (size_t i = 0; i < k->count; i++)
            for (size_t j = 0; j < i; j++)
                sum += k->b[i] * k->b[j] *
                       (powl(k->x[j], m) * powl(k->x[i], l) -
                        powl(k->x[j], l) * powl(k->x[i], m));
        worst = fmaxl(worst, fabsl(sum));
    }
    return worst;
}

static bool has_orders(const kicks *k, const int order[4]) {
    bool fine = true;
    for (int d = 0; d < order[1]; d++)
        fine = fine && once(k, d) < 1e-17L;
    for (int d = 3; d <= order[2]; d++)
        fine = fine && twice(k, d) < 1e-17L;
    return fine && once(k, order[1]) > 1e-6L && twice(k, order[2] + 1) > 1e-6L;
}

/* The same of the weights, to all their digits; a wrong one is noticed. */
TEST_EACH(weights_by_algebra, KNOWN) {
    const nevh_splitting *table = (*known[_i].scheme)->table;
    kicks right = kicks_of(table, 0), wrong = kicks_of(table, 1e-15L);
    ck_assert(has_orders(&right, known[_i].order));
    ck_assert(!has_orders(&wrong, known[_i].order));
}

/* At a fixed step the error is that of the first power where e is small, and a
   scheme is exact where B is 0. */
TEST_EACH(error_falls_with_B, KNOWN) {
    const nevh_integrator *scheme = *known[_i].scheme;
    const state zero = {{0}};
    double one = distance(error_of(scheme, 1e-6, 1.6), zero);
    double half = distance(error_of(scheme, 5e-7, 1.6), zero);
    ck_assert_double_eq_tol(log2(one / half), 1, 0.1);
    ck_assert_double_lt(distance(error_of(scheme, 0, 1.6), zero), 4e-15);
    ck_assert_double_gt(one, 1e-13);
}

/* The flow of the form alone is symplectic to rounding, for any step. */
TEST_EACH(flow_is_symplectic, 6) {
    static const double steps[] = {1e-3, 0.1, 1, -1, 30, 1000};
    nevh_scene *s = scene_of(0, "");
    state column[4], zero = {{0}};
    const nevh_system *system = nevh_scene_system(s);
    state origin = orbit_from(zero, system, nevh_wisdom_holman, steps[_i], 1);
    for (int k = 0; k < 4; k++) {
        state unit = zero;
        unit.z[k] = 1;
        column[k] = orbit_from(unit, system, nevh_wisdom_holman, steps[_i], 1);
        for (int i = 0; i < 4; i++)
            column[k].z[i] -= origin.z[i];
    }
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            double form = 0;
            for (int k = 0; k < 2; k++)
                form += column[i].z[k] * column[j].z[k + 2] -
                        column[i].z[k + 2] * column[j].z[k];
            ck_assert_double_eq_tol(form,
                                    j == i + 2   ? 1
                                    : i == j + 2 ? -1
                                                 : 0,
                                    1e-14);
        }
    nevh_scene_free(s);
}

/* Rounding is a walk, not a drift: energies of the form over a million steps. */
TEST(energy_of_the_form) {
    nevh_scene *s = scene_of(0, "");
    const nevh_system *system = nevh_scene_system(s);
    nevh_stepper *stepper = stepper_of(system, nevh_wisdom_holman);
    nevh_energy *energy = nevh_energy_new(system, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1000};
    state x = fast_parts[0].start;
    ck_assert(!nevh_run(stepper, 0, 0.37, 1000000, x.z, x.z + 2, &watch, 1));
    nevh_energy_report r = nevh_energy_result(energy, 0);
    ck_assert_double_lt(r.max, 1e-13);
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    nevh_scene_free(s);
}

static nevh_scene *plane(const char *effects, const char *more) {
    char text[500];
    snprintf(text, sizeof text, "[effects]\n%s\n%s[run]\nt_end = 1\n", effects,
             more);
    return scene_with("x = 0.8, 0.3\ny = -0.5, 0.4\n", text);
}

/* What is no form of constant coefficients is told by effect and term. */
TEST_EACH(refusals, 5) {
    static const struct {
        const char *effects, *more, *words[2];
    } wrong[] = {
        {"motion = sqrt(1 + p_x^2) + p_y^2/2\nspring = x^2",
         "",
         {"\"motion\"", "reads momenta and is no such form"}},
        {"motion = (p_x^2 + p_y^2)/2\nspring = x^2\nmixed = 0.01*x*p_y^2",
         "",
         {"\"mixed\"", "reads momenta and is no such form"}},
        {"motion = (p_x^2 + p_y^2)/2*(2 + cos(t))\nspring = x^2",
         "",
         {"\"motion\"", "reads momenta and the time"}},
        {"motion = (p_x^2 + p_y^2)/2\nwave = cos(x)",
         "[parts]\nfast = motion, wave\n",
         {"\"wave\"", "is to be fast and is no such form"}},
        {"motion = (p_x^2 + p_y^2)/2\nspring = x^2",
         "[parts]\nslow = motion\n",
         {"\"motion\"", "is to be slow and reads momenta"}},
    };
    nevh_scene *s = plane(wrong[_i].effects, wrong[_i].more);
    nevh_stepper *stepper = stepper_of(nevh_scene_system(s), nevh_aba864);
    ck_assert_int_eq(nevh_stepper_status(stepper), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(stepper), wrong[_i].words[0]);
    assert_says(nevh_stepper_message(stepper), wrong[_i].words[1]);
    nevh_stepper_free(stepper);
    nevh_scene_free(s);
}

/* Springs that are to be slow make a step that of position-verlet. */
TEST(speeds) {
    const char effects[] = "motion = (p_x^2 + p_y^2)/2\nspring = x^2 + 2*y^2\n"
                           "wave = 0.1*cos(x)";
    size_t fast, slow;
    nevh_scene *found = plane(effects, "");
    nevh_scene *said = plane(effects, "[parts]\nfast = motion\n");
    const nevh_system *all = nevh_scene_system(found);
    const nevh_system *some = nevh_scene_system(said);
    state by_parts =
        orbit_from(fast_parts[0].start, some, nevh_wisdom_holman, 0.1, 50);
    state verlet =
        orbit_from(fast_parts[0].start, some, nevh_position_verlet, 0.1, 50);
    state rotating =
        orbit_from(fast_parts[0].start, all, nevh_wisdom_holman, 0.1, 50);
    ck_assert_double_lt(distance(by_parts, verlet), 1e-13);
    ck_assert_double_gt(distance(rotating, verlet), 1e-4);
    ck_assert(!nevh_system_parts(all, "spring", &fast, &slow, NULL));
    ck_assert(fast == 2 && slow == 0);
    ck_assert(!nevh_system_parts(some, "spring", &fast, &slow, NULL));
    ck_assert(fast == 0 && slow == 2);
    /* All effects at once have what each has. */
    size_t all_fast[3], all_slow[3];
    ck_assert_int_eq(nevh_system_effect_parts(some, all_fast, all_slow),
                     NEVH_OK);
    for (size_t i = 0; i < 3; i++) {
        ck_assert(!nevh_system_parts(some, nevh_system_effect_name(some, i),
                                     &fast, &slow, NULL));
        ck_assert(all_fast[i] == fast && all_slow[i] == slow);
    }
    ck_assert(all_fast[0] > 0 && all_slow[1] == 2 && all_slow[2] > 0);
    nevh_scene_free(found);
    nevh_scene_free(said);
}

/* Which terms are moved about a centre, and which forms then kick. */
TEST_EACH(centres, 10) {
    static const struct {
        const char *effects, *more;
        size_t sun, field; /* instances in A */
    } cases[] = {
        {"sun = -1/hypot(x, y)\nfield = 0.1*x", "", 1, 0},
        {"sun = 1/sqrt(x^2 + y^2)\nfield = x^4", "", 1, 0},
        {"sun = -(x^2 + y^2)^(-1/2) + x^3\nfield = x", "", 1, 0},
        {"sun = -1/sqrt(x^2 + y^2 + 1e-30)\nfield = x", "", 0, 1},
        {"sun = -exp(-1e-9*hypot(x, y))/hypot(x, y)\nfield = x", "", 0, 1},
        {"sun = -1/hypot(x, 2*y)\nfield = x", "", 0, 1},
        {"sun = -1/hypot(x - 1, y)\nfield = x", "", 0, 1},
        {"sun = -1/hypot(x, y)\nfield = p_x^2/8", "", 0, 1},
        {"sun = -1/hypot(x, y)\nfield = 0.1*x*p_y", "", 0, 1},
        {"sun = -1/hypot(x, y)\nfield = x", "[parts]\nslow = sun\n", 0, 1},
    };
    char text[200];
    size_t sun, field;
    snprintf(text, sizeof text, "kinetic = (p_x^2 + p_y^2)/4\n%s",
             cases[_i].effects);
    nevh_scene *s = plane(text, cases[_i].more);
    const nevh_system *system = nevh_scene_system(s);
    ck_assert(!nevh_system_parts(system, "sun", &sun, NULL, NULL));
    ck_assert(!nevh_system_parts(system, "field", &field, NULL, NULL));
    ck_assert_uint_eq(sun, cases[_i].sun);
    ck_assert_uint_eq(field, cases[_i].field);
    nevh_scene_free(s);
}

static double shear(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)t, (void)params;
    return c[0] * q[0] * p[0] + p[0] * p[0] / 2 + 3 * q[0] - 0.7 * p[0];
}

/* Forms are found of values alone, too: (q p)' of a drift with a strain. */
TEST(form_of_values) {
    const double rate = 0.3;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "shear",
                                    .nq = 1,
                                    .np = 1,
                                    .nc = 1,
                                    .c = &rate,
                                    .value = shear});
    double q = 0.4, p = -0.2, x = q, y = p;
    nevh_stepper *split = nevh_stepper_new(s, nevh_saba2, NULL);
    nevh_stepper *gauss = nevh_stepper_new(s, nevh_gauss12, NULL);
    ck_assert_str_eq(nevh_stepper_message(split), "");
    ck_assert(!nevh_run(split, 0, 1, 2, &q, &p, NULL, 0));
    ck_assert(!nevh_run(gauss, 0, 0.05, 40, &x, &y, NULL, 0));
    ck_assert_double_eq_tol(q, x, 1e-8);
    ck_assert_double_eq_tol(p, y, 1e-8);
    nevh_stepper_free(split);
    nevh_stepper_free(gauss);
    nevh_system_free(s);
}

static const char sites[] = "sites = (x^2 + p_x^2)/2 + 0.7*(4*y^2 + p_y^2) + "
                            "0.2*(x*y + p_x*p_y)\n";

static nevh_scene *lattice(const char *more) {
    char text[400];
    snprintf(text, sizeof text, "%s%s", sites, more);
    return plane(text, "");
}

/* B that is a function of actions alone is turned: schemes have their order, and the orbit
   is that of Gauss. */
TEST_EACH(turns, 10) {
    static const char *const turned[] = {
        "b = 0.1*(x^2 + p_x^2)^2",
        "b = 0.1*(x^2 + p_x^2)^2*sqrt(4*y^2 + p_y^2)",
        "b = 0.1*sqrt(1 + (4*y^2 + p_y^2)/3)\nwave = 0.1*cos(x)",
        "b = 0.1*exp(-(x^2 + p_x^2))\ndrive = 0.1*y*cos(0.7*t)",
        "b = 0.1*(4*y^2 + p_y^2)^1.5\nwave = 0.1*sin(x)",
        "b = 0.1*(9*x^2 + p_x^2/9)^2\nb2 = 0.1*sqrt(81*x^2 + p_x^2)",
        "b = 0.1*log(1 + x^2 + p_x^2)*hypot(2*y, p_y)",
        "b = 0.01*exp(x^2 + p_x^2)",
        "b = 0*(4*x^2 + p_x^2)^2\nb2 = 0.1*(4*x^2 + p_x^2)^2",
        "b = 0.1*sin((x^2 + p_x^2)/2 - (4*y^2 + p_y^2)/3)^2"};
    nevh_scene *s = lattice(turned[_i]);
    const nevh_system *system = nevh_scene_system(s);
    state start = fast_parts[0].start;
    state exact = orbit_from(start, system, nevh_gauss20, 0.05, 40);
    double off[2];
    for (int i = 0; i < 2; i++)
        off[i] = distance(exact, orbit_from(start, system, nevh_wisdom_holman,
                                            0.02 / (i + 1), 100 * (i + 1)));
    ck_assert_double_eq_tol(off[0] / off[1], 4, 0.05);
    state by_parts = orbit_from(start, system, nevh_aba1064, 0.02, 100);
    ck_assert_double_lt(distance(exact, by_parts), 1e-9 * off[0] / 1e-5);
    nevh_scene_free(s);
}

/* A step of any length is exact where A keeps the actions, too, also from rest. */
TEST(turns_are_exact) {
    nevh_scene *s = plane("sites = (x^2 + p_x^2)/2 + (4*y^2 + p_y^2)/4\n"
                          "b = (x^2 + p_x^2)^2*(1 + 4*y^2 + p_y^2)",
                          "");
    const nevh_system *system = nevh_scene_system(s);
    state start = fast_parts[0].start, rest = {{0.8, 0, 0, 0}};
    state exact = orbit_from(start, system, nevh_gauss20, 0.01, 70);
    state one = orbit_from(start, system, nevh_saba2, 0.7, 1);
    ck_assert_double_lt(distance(exact, one), 1e-12);
    exact = orbit_from(rest, system, nevh_gauss20, 0.01, 70);
    one = orbit_from(rest, system, nevh_saba2, 0.7, 1);
    ck_assert_double_lt(distance(exact, one), 1e-12);
    nevh_scene_free(s);
}

/* B that reads the coordinate otherwise, too, or another function of q and p. */
TEST_EACH(turns_refused, 9) {
    static const char *const wrong[] = {
        "b = 0.1*(x^2 + p_x^2)^2\nwave = 0.1*cos(x + y)",
        "b = 0.1*(x^2 + p_x^2)^2\nc = 0.1*(x^2 + 1.001*p_x^2)^2",
        "b = 0.1*(x^2 + p_y^2)^2",
        "b = 0.1*(x^2 + p_x^2)^2*(1 + 1e-9*x)",
        "b = 0.1*(x^2 + p_x^2)^2*cos(t)",
        "b = 0.1*(x^2 + p_x^2 + x*p_x)^2",
        "b = 0.1*(x^2 + p_x^2)^2*(1 + 0.3*exp(-(50*(x - 1.6))^2))",
        "b = 0.1*(x^2 + p_x^2)^2*(1 + 0.3*tanh(50*(x - 1.6))/cosh(50*(x - 1.6))^2)",
        "b = 0.1*(x^2 - p_x^2)^2"};
    nevh_scene *s = lattice(wrong[_i]);
    nevh_stepper *stepper = stepper_of(nevh_scene_system(s), nevh_aba864);
    ck_assert_int_eq(nevh_stepper_status(stepper), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(stepper), "\"b\"");
    nevh_stepper_free(stepper);
    nevh_scene_free(s);
}

/* All vectors give the bits of plain sums, over the columns between the ends. */
TEST_EACH(panels_have_the_bits_of_sums, 4) {
    static const size_t sizes[] = {8, 10, 32, 50};
    enum { MOST = 56 };
    size_t m = sizes[_i], size = nevh__panel_size(m), side;
    static double panels[2 * MOST * (MOST + 1)];
    double z[MOST + 1], sum[MOST];
    size_t ends[2 * MOST];
    for (size_t i = 0; i < size; i++)
        panels[i] = sin(1 + (double)i) * (i / NEVH__PANEL % 2 ? 1e-17 : 1);
    for (size_t i = 0; i <= m; i++)
        z[i] = cos(3 * (double)i);
    for (size_t k = 0; k < nevh__panel_count(m); k++) {
        ends[2 * k] = k;
        ends[2 * k + 1] = m + 1 - k;
    }
    for (side = 2; side <= 8; side *= 2) {
        nevh__panels_choose(side)(m, panels, ends, z, sum);
        for (size_t i = 0; i < m; i++) {
            double high = 0, low = 0;
            const size_t *of = ends + i / NEVH__PANEL * 2;
            for (size_t j = of[0]; j < of[1]; j++) {
                size_t at = nevh__panel_place(m, i, j);
                high += panels[at] * z[j];
                low += panels[at + NEVH__PANEL] * z[j];
            }
            ck_assert(sum[i] == high + low);
        }
    }
}

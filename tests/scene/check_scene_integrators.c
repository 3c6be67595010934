/* nevh tests: schemes that a scene brings, typed in as papers print them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <ctype.h>
#include <math.h>
#include <nevh/extend.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char scene_text[] = "[coordinates]\nx = 1, 0.3\n"
                                 "[effects]\nT = p_x^2/2\nV = x^4/4 - x\n"
                                 "[run]\nt_end = 1\ndt = 0.1\n";
enum { ANY = -1 }; /* limit: stable at any step */

#define GAUSS3                                                                 \
    "a = 5/36, 2/9 - sqrt(15)/15, 5/36 - sqrt(15)/30 ; "                       \
    "5/36 + sqrt(15)/24, 2/9, 5/36 - sqrt(15)/24 ; "                           \
    "5/36 + sqrt(15)/30, 2/9 + sqrt(15)/15, 5/36\n"                            \
    "b = 5/18, 4/9, 5/18\n"

/* Limits are those that papers give for the harmonic oscillator. */
static const struct {
    const char *name, *text;
    int order, any_kinetic;
    bool symmetric, symplectic;
    double limit, within;
} published[] = {
    {"verlet", "kick = 1/2, 1/2\ndrift = 1\n", 2, 2, true, true, 2, 1e-6},
    {"forest-ruth",
     "first = drift\n"
     "drift = 0.6756035959798289, -0.1756035959798288, -0.1756035959798288, "
     "0.6756035959798289\n"
     "kick = 1.351207191959658, -1.702414383919315, 1.351207191959658, 0\n",
     4, 4, true, true, 1.573, 1e-3},
    {"pefrl",
     "first = drift\n"
     "drift = 0.1786178958448091, -0.06626458266981849, "
     "1 - 2*(0.1786178958448091 - 0.06626458266981849), -0.06626458266981849, "
     "0.1786178958448091\n"
     "kick = (1 + 2*0.2123418310626054)/2, -0.2123418310626054, "
     "-0.2123418310626054, (1 + 2*0.2123418310626054)/2\n",
     4, 4, true, true, 2.989, 1e-3},
    {"mclachlan",
     "first = drift\n"
     "drift = 1/2 - sqrt(7/8)/3, sqrt(7/8)/3 - 1/3, 2/3, sqrt(7/8)/3 - 1/3, "
     "1/2 - sqrt(7/8)/3\n"
     "kick = 1, -1/2, -1/2, 1\n",
     4, 4, true, true, 0, 0},
    {"blanes-moan",
     "kick = 0.0792036964311957, 0.353172906049774, -0.0420650803577195, "
     "1 - 2*(0.0792036964311957 + 0.353172906049774 - 0.0420650803577195), "
     "-0.0420650803577195, 0.353172906049774, 0.0792036964311957\n"
     "drift = 0.209515106613362, -0.143851773179818, "
     "1/2 - (0.209515106613362 - 0.143851773179818), "
     "1/2 - (0.209515106613362 - 0.143851773179818), -0.143851773179818, "
     "0.209515106613362\n",
     4, 4, true, true, 0, 0},
    {"ruth", "kick = 7/24, 3/4, -1/24\ndrift = 2/3, -2/3, 1\n", 3, 3, false,
     true, 2.51, 1e-2},
    {"mclachlan-atela",
     "kick = 0.1344961992774310892, -0.2248198030794208058, "
     "0.7563200005156682911, 0.3340036032863214255\n"
     "drift = 0.5153528374311229364, -0.085782019412973646, "
     "0.4415830236164665242, 0.1288461583653841854\n",
     4, 3, false, true, 0, 0},
    {"suzuki",
     "compose = verlet: 1/(4-4^(1/3)), 1/(4-4^(1/3)), 1-4/(4-4^(1/3)), "
     "1/(4-4^(1/3)), 1/(4-4^(1/3))\n",
     4, 4, true, true, 0, 0},
    {"yoshida",
     "compose = position-verlet: 0.784513610477560, 0.235573213359357, "
     "-1.17767998417887, "
     "1 + 2*1.17767998417887 - 2*0.235573213359357 - 2*0.784513610477560, "
     "-1.17767998417887, 0.235573213359357, 0.784513610477560\n",
     6, 6, true, true, 0, 0},
    {"rk4",
     "a = 0,0,0,0 ; 1/2,0,0,0 ; 0,1/2,0,0 ; 0,0,1,0\nb = 1/6,1/3,1/3,1/6\n"
     "c = 0, 1/2, 1/2, 1\n",
     4, 4, false, false, 2.828427125, 1e-6},
    {"kutta", "a = ; 1/3 ; -1/3, 1 ; 1, -1, 1\nb = 1/8, 3/8, 3/8, 1/8\n", 4, 4,
     false, false, 2.828427125, 1e-6},
    {"heun", "a = 0 ; 1/3, 0 ; 0, 2/3, 0\nb = 1/4, 0, 3/4\n", 3, 3, false,
     false, 1.7320508, 1e-6},
    {"dormand-prince",
     "a = ; 1/5 ; 3/40, 9/40 ; 44/45, -56/15, 32/9 ; 19372/6561, -25360/2187, "
     "64448/6561, -212/729 ; 9017/3168, -355/33, 46732/5247, 49/176, "
     "-5103/18656 ; 35/384, 0, 500/1113, 125/192, -2187/6784, 11/84\n"
     "b = 35/384, 0, 500/1113, 125/192, -2187/6784, 11/84, 0\n"
     "c = 0, 1/5, 3/10, 4/5, 8/9, 1, 1\n",
     5, 5, false, false, 0.997, 5e-3},
    {"gauss",
     "a = 1/4, 1/4 - sqrt(3)/6 ; 1/4 + sqrt(3)/6, 1/4\nb = 1/2, 1/2\n"
     "c = 1/2 - sqrt(3)/6, 1/2 + sqrt(3)/6\n",
     4, 4, true, true, ANY, 0},
    {"kuntzmann", GAUSS3, 6, 6, true, true, ANY, 0},
    {"lobatto-iiib",
     "a = 1/6, -1/6, 0 ; 1/6, 1/3, 0 ; 1/6, 5/6, 0\nb = 1/6, 2/3, 1/6\n"
     "c = 0, 1/2, 1\n",
     4, 4, true, false, ANY, 0},
    {"radau-iia",
     "a = (88 - 7*sqrt(6))/360, (296 - 169*sqrt(6))/1800, "
     "(-2 + 3*sqrt(6))/225 ; (296 + 169*sqrt(6))/1800, (88 + 7*sqrt(6))/360, "
     "(-2 - 3*sqrt(6))/225 ; (16 - sqrt(6))/36, (16 + sqrt(6))/36, 1/9\n"
     "b = (16 - sqrt(6))/36, (16 + sqrt(6))/36, 1/9\n",
     5, 5, false, false, ANY, 0},
    {"crouzeix",
     "a = (3 + sqrt(3))/6, 0 ; -sqrt(3)/3, (3 + sqrt(3))/6\nb = 1/2, 1/2\n", 3,
     3, false, false, ANY, 0},
    {"trapezoidal", "a = 0, 0 ; 1/2, 1/2\nb = 1/2, 1/2\n", 2, 2, true, false,
     ANY, 0},
    {"lobatto-iiib of two stages",
     "a = 1/2, 0 ; 1/2, 0\nb = 1/2, 1/2\nc = 0, 1\n", 2, 2, true, false, ANY,
     0},
    {"midpoint-jump",
     "compose = midpoint: 1/(2-2^(1/3)), 1-2/(2-2^(1/3)), 1/(2-2^(1/3))\n", 4,
     4, true, true, ANY, 0},
};
enum { PUBLISHED = sizeof published / sizeof *published };

/* A scene with a table under a name of its own. */
static nevh_scene *scene_of_table(const char *table) {
    char text[4000];
    snprintf(text, sizeof text, "%s[integrator mine]\n%s", scene_text, table);
    return nevh_scene_parse("own", text);
}

TEST_EACH(facts_are_as_published, PUBLISHED) {
    nevh_scene *scene = scene_of_table(published[_i].text);
    ck_assert_msg(!nevh_scene_status(scene), "%s", nevh_scene_message(scene));
    const nevh_integrator *own = nevh_scene_integrator(scene, 0);
    nevh_scheme_facts x;
    ck_assert_ptr_null(nevh_scene_integrator(scene, 1));
    ck_assert_ptr_eq(own, nevh_scene_integrator_named(scene, "mine"));
    ck_assert_int_eq(nevh_integrator_facts(own, &x), NEVH_OK);
    ck_assert_msg(x.order == published[_i].order, "%s: order %d",
                  published[_i].name, x.order);
    ck_assert_int_eq(x.any_kinetic, published[_i].any_kinetic);
    ck_assert_int_eq(x.symmetric, published[_i].symmetric);
    ck_assert_int_eq(x.symplectic, published[_i].symplectic);
    ck_assert_int_eq(nevh_integrator_order(own), x.order);
    ck_assert_int_eq(x.needed_for, x.symmetric ? x.order + 2 : x.order + 1);
    double limit = nevh_stability_limit(own);
    if (published[_i].limit > 0)
        ck_assert_double_eq_tol(limit, published[_i].limit,
                                published[_i].within);
    else if (published[_i].limit < 0)
        ck_assert_double_infinite(limit);
    nevh_scene_free(scene);
}

/* The place of the next digit that matters: not beyond the eleventh of a number;
   NULL: there are no more. */
static char *next_digit(char *text, char *from) {
    enum { MATTERING = 11 };
    for (char *at = from; *at; at++) {
        int before = 0;
        if (!isdigit((unsigned char)*at))
            continue;
        for (char *back = at;
             back > text &&
             (isdigit((unsigned char)back[-1]) || back[-1] == '.');
             back--)
            before += back[-1] != '.' && (before || back[-1] != '0');
        bool named = at > text &&
                     (at[-1] == '-' || isalpha((unsigned char)at[-1])) &&
                     at[-1] != '-';
        if (before < MATTERING && !named)
            return at;
    }
    return NULL;
}

/* Every digit of every table: with another in its place the scene is refused, at a
   line of the table, or the scheme is of a lower order, which is said.  A factor of
   0 may become any other: 05/6. */
TEST_EACH(wrong_digits_are_named, PUBLISHED) {
    char text[2000];
    int tried = 0;
    strcpy(text, published[_i].text);
    char *start = strchr(text, ':') ? strchr(text, ':') : text;
    for (char *at = start; (at = next_digit(start, at)); at++) {
        char right = *at;
        nevh_scheme_facts x;
        char said[300];
        *at = (char)('0' + (right - '0' + 1 + tried % 8) % 10);
        nevh_scene *scene = scene_of_table(text);
        tried++;
        if (nevh_scene_status(scene)) {
            assert_says(nevh_scene_message(scene), "own:1");
        } else {
            ck_assert_int_eq(
                nevh_integrator_facts(nevh_scene_integrator(scene, 0), &x),
                NEVH_OK);
            ck_assert_msg(x.order < published[_i].order ||
                              x.any_kinetic < published[_i].any_kinetic ||
                              x.symmetric != published[_i].symmetric ||
                              x.symplectic != published[_i].symplectic,
                          "%s with %c in place of %c: %s", published[_i].name,
                          *at, right, text);
            assert_says(nevh_scheme_shortfall(&x, said, sizeof said),
                        "is needed for order");
        }
        nevh_scene_free(scene);
        *at = right;
    }
    ck_assert_int_ge(tried, 4);
}

/* Algebra says of schemes that ship what their descriptors claim; those of higher
   orders, which are made for small errors, are not suspected of wrong digits. */
TEST(facts_of_shipped_schemes) {
    int known = 0;
    for (const nevh_integrator *const *i = nevh_integrators(); *i; i++) {
        nevh_scheme_facts x;
        char said[300];
        int order = nevh_integrator_order(*i);
        if (nevh_integrator_facts(*i, &x))
            continue;
        known++;
        ck_assert_msg(x.order ==
                          (order < NEVH_MOST_ORDER ? order : NEVH_MOST_ORDER),
                      "%s: order %d", nevh_integrator_name(*i), x.order);
        ck_assert_int_eq(x.symmetric,
                         nevh_integrator_symmetric(*i) == NEVH_YES);
        ck_assert_int_eq(x.symplectic,
                         nevh_integrator_symplectic(*i) == NEVH_YES);
        nevh_scheme_shortfall(&x, said, sizeof said);
        ck_assert_msg(!strstr(said, "digit"), "%s: %s",
                      nevh_integrator_name(*i), said);
    }
    ck_assert_int_ge(known, 40);
}

/* The failing sum of a near miss is named with by how much. */
TEST(near_miss) {
    nevh_scene *scene =
        scene_of_table("a = ; 0.5 ; 0, 0.5 ; 0, 0, 1\n"
                       "b = 0.1666666666666667, 0.3333333433333333, "
                       "0.3333333233333333, 0.1666666666666667\n");
    nevh_scheme_facts x;
    char said[300];
    ck_assert_int_eq(nevh_integrator_facts(nevh_scene_integrator(scene, 0), &x),
                     NEVH_OK);
    ck_assert_int_lt(x.order, 4);
    nevh_scheme_shortfall(&x, said, sizeof said);
    assert_says(said, "sum of b_i");
    assert_says(said, "a digit may be wrong");
    nevh_scene_free(scene);
    scene = scene_of_table("kick = 0.3, 0.7\ndrift = 0.8, 0.2\n");
    nevh_integrator_facts(nevh_scene_integrator(scene, 0), &x);
    ck_assert_int_eq(x.order, 1);
    ck_assert_double_eq_tol((double)x.value, 0.56, 1e-15);
    ck_assert(x.due == 0.5L && x.needed_for == 2);
    ck_assert_str_eq(nevh_scheme_shortfall(&x, said, sizeof said),
                     "sum of kick_i * drift_j (j < i) is 0.56, 1/2 is needed "
                     "for order 2");
    nevh_scene_free(scene);
}

/* A run of some orbits side by side. */
static void run(const nevh_system *s, const nevh_integrator *scheme,
                const nevh_gradient *gradient, size_t width, double q[],
                double p[]) {
    double start[16];
    for (size_t i = 0; i < width; i++) {
        q[i] = start[i] = 1 + 0.01 * (double)i;
        p[i] = 0.3;
    }
    nevh_options o = {.gradient = gradient,
                      .width = width,
                      .q = start,
                      .p = p,
                      .native = NEVH_NATIVE_NEVER};
    nevh_stepper *x = nevh_stepper_new(s, scheme, &o);
    ck_assert_msg(!nevh_stepper_status(x), "%s", nevh_stepper_message(x));
    ck_assert_int_eq(nevh_run(x, 0, 0.1, 200, q, p, NULL, 0), NEVH_OK);
    nevh_stepper_free(x);
}

static const struct {
    const char *shipped, *text;
} copies[] = {
    {"verlet", "kick = 1/2, 1/2\ndrift = 1\n"},
    {"verlet", "kick = 0.5, 0, 0.5\ndrift = 0.25, 0.75\n"},
    {"position-verlet", "first = drift\nkick = 1\ndrift = 1/2, 1/2\n"},
    {"symplectic-euler-a", "kick = 1\ndrift = 1\n"},
    {"ruth3", "kick = 7/24, 3/4, -1/24\ndrift = 2/3, -2/3, 1\n"},
    {"forest-ruth",
     "compose = verlet: 1/(2-2^(1/3)), 1-2/(2-2^(1/3)), 1/(2-2^(1/3))\n"},
    {"rk4",
     "a = 0,0,0,0 ; 1/2,0,0,0 ; 0,1/2,0,0 ; 0,0,1,0\nb = 1/6,1/3,1/3,1/6\n"},
    {"heun", "a = 0, 0 ; 1, 0\nb = 1/2, 1/2\n"},
    {"dopri5",
     "a = ; 1/5 ; 3/40, 9/40 ; 44/45, -56/15, 32/9 ; 19372/6561, -25360/2187, "
     "64448/6561, -212/729 ; 9017/3168, -355/33, 46732/5247, 49/176, "
     "-5103/18656 ; 35/384, 0, 500/1113, 125/192, -2187/6784, 11/84\n"
     "b = 35/384, 0, 500/1113, 125/192, -2187/6784, 11/84, 0\n"}};
enum { COPIES = sizeof copies / sizeof *copies };

/* A copy of a scheme that ships gives its bits; of another scheme other ones. */
TEST_EACH(copies_give_the_same_bits, COPIES) {
    const nevh_gradient *const ways[] = {nevh_exact, nevh_central4};
    nevh_scene *scene = scene_of_table(copies[_i].text);
    ck_assert_msg(!nevh_scene_status(scene), "%s", nevh_scene_message(scene));
    const nevh_system *s = nevh_scene_system(scene);
    const nevh_integrator *own = nevh_scene_integrator(scene, 0);
    const nevh_integrator *ships = nevh_integrator_named(copies[_i].shipped);
    for (size_t k = 0; k < 4; k++) {
        size_t width = k / 2 ? 9 : 1;
        double a[32] = {0}, b[32] = {0};
        run(s, own, ways[k % 2], width, a, a + 16);
        run(s, ships, ways[k % 2], width, b, b + 16);
        ck_assert_mem_eq(a, b, sizeof a);
        run(s, nevh_suzuki4, ways[k % 2], width, b, b + 16);
        ck_assert_mem_ne(a, b, sizeof a);
    }
    ck_assert_int_eq(nevh_integrator_gradients(own),
                     nevh_integrator_gradients(ships));
    nevh_scene_free(scene);
}

/* Of implicit methods within rounding. */
TEST_EACH(implicit_copies, 3) {
    static const struct {
        const char *shipped, *text;
    } of[] = {{"midpoint", "a = 1/2\nb = 1\n"},
              {"implicit-euler", "a = 1\nb = 1\n"},
              {"gauss6", GAUSS3}};
    nevh_scene *scene = scene_of_table(of[_i].text);
    const nevh_system *s = nevh_scene_system(scene);
    double a[32] = {0}, b[32] = {0};
    for (size_t width = 1; width < 10; width += 8) {
        run(s, nevh_scene_integrator(scene, 0), nevh_exact, width, a, a + 16);
        run(s, nevh_integrator_named(of[_i].shipped), nevh_exact, width, b,
            b + 16);
        for (size_t i = 0; i < width; i++) {
            ck_assert_double_eq_tol(a[i], b[i], 1e-12);
            ck_assert_double_eq_tol(a[16 + i], b[16 + i], 1e-12);
        }
    }
    nevh_scene_free(scene);
}

static const struct {
    const char *text, *place, *words;
} wrong[] = {
    {"kick = 0.49, 0.5\ndrift = 1\n", "10:8",
     "kick weights add up to 0.99, not 1"},
    {"kick = 1\ndrift = 0.5, 0.4\n", "11:9", "cannot alternate"},
    {"first = drift\nkick = 1\ndrift = 0.5, 0.4\n", "12:9",
     "drift weights add up to 0.9, not 1"},
    {"kick = 1\n", "10:1", "drift weights add up to 0"},
    {"kick = 1, x\n", "10:11", "x is a coordinate"},
    {"kick = 1,\n", "10:10", "a number is missing"},
    {"kick = nan\n", "10:8", "nan"},
    {"kick = 1/0\n", "10:8", "infinite"},
    {"kick = 1\ndrift = 1\nkick = 1\n", "12:1", "there already, in line 10"},
    {"kcik = 1\n", "10:1", "did you mean kick?"},
    {"first = left\n", "10:9", "kick, drift"},
    {"a = 0, 0 ; 1, 0\nb = 1/2, 0.49\n", "11:5", "b adds up to 0.99, not 1"},
    {"a = 0, 0 ; 1, 0\nb = 1/2, 1/4, 1/4\n", "11:5", "b has 3 numbers"},
    {"a = 0, 0 ; 1, 0\nb = 1/2, 1/2\nc = 0, 0.9\n", "12:8",
     "row 2 of a adds up to 1, but c_2 is 0.9"},
    {"a = 0, 0, 0; 1, 0 ; 1, 2, 0\nb = 1/2, 1/2, 0\n", "10:14",
     "row 2 of a has 2 numbers, not 3"},
    {"a = 0, 0 ; 1, 0\n", "10:1", "b of [integrator mine] is missing"},
    {"b = 1/2, 1/2\n", "10:1", "a of [integrator mine] is missing"},
    {"compose = verlet\n", "10:11", "INTEGRATOR: WEIGHT"},
    {"compose = velet: 1\n", "10:11", "did you mean verlet?"},
    {"compose = mine: 1\n", "10:11", "no integrator mine"},
    {"compose = verlet: 0.6, 0.6\n", "10:11", "add up to 1.2, not 1"},
    {"compose = verlet: 1, 0\n", "10:22", "length 0"},
    {"compose = avf: 1\n", "10:1", "avf is neither a splitting"},
    {"", "9:13", "no weights"},
    {"kick = 1\ndrift = 1\na = 0\nb = 1\n", "10:1", "one of three"},
    {"kick = 1\ndrift = 1\n[integrator mine]\n", "12:13", "in line 9"},
    {"kick = 1\ndrift = 1\n[integrator rk4]\n", "12:13", "something else"},
    {"kick = 1\ndrift = 1\n[integrator leapfrog]\n", "12:13", "something else"},
    {"kick = 1\ndrift = 1\n[integrator exact]\n", "12:13", "something else"},
    {"kick = 1\ndrift = 1\n[integrator a+b]\na = 0\nb = 1\n", "13:1",
     "letters"},
    {"kick = 1\ndrift = 1\n[integrator]\n", "12:2", "has a name"},
    {"kick = 1\ndrift = 1\n[integrators x]\n", "12:2",
     "did you mean integrator?"}};
enum { WRONG = sizeof wrong / sizeof *wrong };

TEST_EACH(wrong_tables, WRONG) {
    char place[40];
    nevh_scene *scene = scene_of_table(wrong[_i].text);
    snprintf(place, sizeof place, "own:%s: error: ", wrong[_i].place);
    assert_says(nevh_scene_message(scene), place);
    assert_says(nevh_scene_message(scene), wrong[_i].words);
    nevh_scene_free(scene);
}

/* Weights follow parameters; a scheme that they leave alone is the same. */
TEST(weights_of_parameters) {
    char text[1000];
    snprintf(text, sizeof text,
             "[parameters]\nw = 0.3\nm = 1\n%s"
             "[integrator mine]\nkick = w, 1 - w\ndrift = 1\n"
             "[integrator other]\ncompose = mine: 0.5, 0.5\n",
             scene_text);
    nevh_scene *scene = nevh_scene_parse("own", text);
    const nevh_integrator *own = nevh_scene_integrator(scene, 0);
    ck_assert_int_eq(nevh_integrator_order(own), 1);
    ck_assert_int_eq(nevh_scene_set(scene, "m = 2"), NEVH_OK);
    ck_assert_ptr_eq(nevh_scene_integrator(scene, 0), own);
    ck_assert_int_eq(nevh_scene_set(scene, "w = 1/2"), NEVH_OK);
    ck_assert_int_eq(nevh_integrator_order(nevh_scene_integrator(scene, 0)), 2);
    ck_assert_int_eq(nevh_integrator_order(nevh_scene_integrator(scene, 1)), 2);
    ck_assert_int_eq(nevh_scene_set(scene, "w = 1/0"), NEVH_EDOM);
    nevh_scene_free(scene);
}

/* nevh tests: terms of many instances are compiled as loops over them.  Steps
   give the bits of the tape, whatever instances read.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include "../support/native.h"
#include "native/native_private.h"
#include "run/stepper_private.h"
#include <nevh/extend.h>

/* Chains longer and shorter than a block of the tape, the last instances of
   which fill no vector. */
static const char chain[] =
    "[parameters]\nN = %d\na = 0.25\n"
    "[coordinates]\nx[i = 1..N] = sin(7*i)\n"
    "[effects]\nkinetic = sum(i = 1..N, p_x[i]^2/2)\n"
    "springs = x[1]^2/2 + sum(i = 1..N-1, (x[i+1] - x[i])^2/2) + x[N]^2/2\n"
    "cubic = a/3*(x[1]^3 + sum(i = 1..N-1, (x[i+1] - x[i])^3) - x[N]^3)\n";
/* Masses of their own, and forces that change with time. */
static const char driven[] =
    "[parameters]\nN = %d\nm[i = 1..N] = 1 + 0.1*sin(i)\n"
    "[coordinates]\nx[i = 1..N] = sin(7*i)\n"
    "[effects]\nkinetic = sum(i = 1..N, p_x[i]^2/(2*m[i]))\n"
    "wells = sum(i = 1..N, -m[i]*(1 + 0.2*sin(3*t + i))*cos(x[i]))\n"
    "springs = sum(i = 1..N-1, exp(x[i] - x[i+1])/m[i])\n";
/* The last instance reads the first variable. */
static const char ring[] =
    "[parameters]\nN = %d\n"
    "[coordinates]\nx[i = 1..N] = sin(7*i)\n"
    "[effects]\nkinetic = sum(i = 1..N, p_x[i]^2/2)\n"
    "wells = sum(i = 1..N, 1 - cos(x[i]))\n"
    "springs = sum(i = 1..N, (x[mod(i, N) + 1] - x[i])^4/4)\n";
/* Rows of a lattice, and a last row and column that go on with the first. */
static const char lattice[] =
    "[parameters]\nL = %d\n"
    "[coordinates]\nx[i = 1..L*L] = sin(7*i)\n"
    "[effects]\nkinetic = sum(i = 1..L*L, p_x[i]^2/2)\n"
    "along = sum(i = 1..L, j = 1..L, 1 - cos(x[(i-1)*L + mod(j, L) + 1] - "
    "x[(i-1)*L + j]))\n"
    "across = sum(i = 1..L, j = 1..L, 1 - cos(x[mod(i, L)*L + j] - "
    "x[(i-1)*L + j]))\n";
/* Every pair: of many bodies one reads the first of them often, of a few
   bodies no piece is long. */
static const char bodies[] =
    "[parameters]\nN = %d\nm[i = 1..N] = 1 + i/7\n"
    "[coordinates]\nx[i = 1..N] = sin(7*i)*i\n"
    "y[i = 1..N] = cos(5*i)*i\n"
    "[effects]\nkinetic = sum(i = 1..N, (p_x[i]^2 + p_y[i]^2)/(2*m[i]))\n"
    "gravity = sum(i = 1..N, j = i+1..N, -m[i]*m[j]/sqrt((x[i] - x[j])^2 + "
    "(y[i] - y[j])^2 + 0.1))\n";
/* Pairs of two kinds of bodies, and of bodies that have three coordinates in another
   order. */
static const char kinds[] =
    "[parameters]\nN = %d\n"
    "[coordinates]\nx[i = 1..N] = sin(7*i)*i\nu[i = 1..N+3] = cos(5*i)*i\n"
    "[effects]\nkinetic = sum(i = 1..N, p_x[i]^2/2) + sum(i = 1..N+3, "
    "p_u[i]^2/4)\n"
    "attraction = sum(i = 1..N, j = 1..N+3, -i/sqrt((x[i] - u[j])^2 + 0.2))\n";
static const char fluid[] =
    "[parameters]\nN = %d\n"
    "[coordinates]\nx[i = 1..N] = 2*i\ny[i = 1..N] = cos(5*i)\n"
    "z[i = 1..N] = sin(3*i)\n"
    "[effects]\nkinetic = sum(i = 1..N, (p_x[i]^2 + p_y[i]^2 + p_z[i]^2)/2)\n"
    "attraction = sum(i = 1..N, j = i+1..N, -1/((y[j] - y[i])^2 + (x[i] - "
    "x[j])^2 + (z[i] - z[j])^2)^3)\n";
/* Bonds that kick in substeps, charges outside. */
static const char bonded[] =
    "[parameters]\nN = %d\n"
    "[coordinates]\nx[i = 1..N] = 1.02*i\ny[i = 1..N] = 0.3*sin(0.7*i)\n"
    "[effects]\nkinetic = sum(i = 1..N, (p_x[i]^2 + p_y[i]^2)/2)\n"
    "bonds = sum(i = 1..N-1, 50*(sqrt((x[i+1] - x[i])^2 + (y[i+1] - "
    "y[i])^2) - 1)^2)\n"
    "charges = sum(i = 1..N, j = i+1..N, 1/sqrt((x[i] - x[j])^2 + (y[i] - "
    "y[j])^2))\n[parts]\nfast = kinetic, bonds\n";
/* Every other mass, and three in a row. */
static const char apart[] =
    "[parameters]\nN = %d\n"
    "[coordinates]\nx[i = 1..2*N] = sin(7*i)\n"
    "[effects]\nkinetic = sum(i = 1..2*N, p_x[i]^2/2 + p_x[i]^4/40)\n"
    "wells = sum(i = 1..N, x[2*i]^4/4 + x[2*i-1]^2/2)\n"
    "beams = sum(i = 1..2*N-2, (x[i] - 2*x[i+1] + x[i+2])^2/2)\n";

static const struct {
    const char *text;
    int count;
} cases[] = {{chain, 33},   {chain, 600}, {chain, 1100}, {driven, 517},
             {ring, 17},    {ring, 513},  {lattice, 9},  {lattice, 24},
             {lattice, 40}, {bodies, 8},  {bodies, 50},  {apart, 300},
             {kinds, 5},    {kinds, 21},  {fluid, 7},    {fluid, 19}};
enum { CASES = sizeof cases / sizeof *cases };

static nevh_scene *counted(const char *format, int count) {
    char text[2000];
    snprintf(text, sizeof text, format, count);
    return parsed(text);
}

typedef struct {
    nevh_stepper *s;
    double *z; /* q and p */
    size_t n;
} run;

static run begin(nevh_scene *scene, const nevh_integrator *scheme,
                 const nevh_gradient *gradient, bool portable,
                 nevh_native_use use) {
    run r = {.n = nevh_scene_dof(scene)};
    r.z = calloc(2 * r.n, sizeof *r.z);
    ck_assert_int_eq(nevh_scene_start(scene, r.z, r.z + r.n), NEVH_OK);
    nevh_options o = {.gradient = gradient,
                      .q = r.z,
                      .p = r.z + r.n,
                      .portable = portable,
                      .native = use,
                      .native_cache = ""};
    r.s = nevh_stepper_new(nevh_scene_system(scene), scheme, &o);
    const char *why = "";
    bool native = nevh_stepper_native(r.s, &why);
    ck_assert_int_eq(nevh_stepper_status(r.s), NEVH_OK);
    ck_assert_msg(native == (use == NEVH_NATIVE_ALWAYS), "%s", why);
    return r;
}

static void end(run *r) {
    nevh_stepper_free(r->s);
    free(r->z);
}

static void assert_same(nevh_scene *scene, const nevh_integrator *scheme,
                        const nevh_gradient *gradient, bool portable) {
    run tape = begin(scene, scheme, gradient, portable, NEVH_NATIVE_NEVER);
    run native = begin(scene, scheme, gradient, portable, NEVH_NATIVE_ALWAYS);
    static const size_t steps[] = {20, 1, 1, 7};
    double t = 0, h = 0.01;
    for (size_t i = 0; i < 4; t += (double)steps[i++] * h) {
        run *both[] = {&tape, &native};
        for (size_t k = 0; k < 2; k++)
            ck_assert_int_eq(nevh_run(both[k]->s, t, h, steps[i], both[k]->z,
                                      both[k]->z + tape.n, NULL, 0),
                             NEVH_OK);
        for (size_t k = 0; k < 2 * tape.n; k++)
            ck_assert_msg(memcmp(&tape.z[k], &native.z[k], sizeof t) == 0,
                          "%s: number %zu is %.17g, not %.17g",
                          nevh_integrator_name(scheme), k, native.z[k],
                          tape.z[k]);
    }
    nevh_counts a = nevh_stepper_counts(tape.s),
                b = nevh_stepper_counts(native.s);
    ck_assert_uint_eq(a.values, b.values);
    ck_assert_uint_eq(a.gradients, b.gradients);
    ck_assert(nevh_stepper_native(native.s, NULL)); /* none differed */
    end(&tape);
    end(&native);
}

TEST_EACH(same_bits, CASES) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = counted(cases[_i].text, cases[_i].count);
    const nevh_integrator *schemes[] = {nevh_verlet, nevh_rk4,
                                        nevh_symplectic_euler_a};
    assert_same(scene, schemes[_i % 2], nevh_exact, true);
    assert_same(scene, schemes[(_i + 1) % 3], nevh_exact, false);
    nevh_scene_free(scene);
}

/* Differences, some of quadratic terms and with steps of their own. */
TEST_EACH(differences_same_bits, CASES) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = counted(cases[_i].text, cases[_i].count);
    assert_same(scene, _i % 2 ? nevh_verlet : nevh_rk4,
                _i % 3 ? nevh_central4 : nevh_central2, _i % 4 < 2);
    nevh_scene_free(scene);
}

/* So long that operations are done on one part after another, and what they have
   of it is moved. */
TEST_EACH(parts_same_bits, 4) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    const nevh_integrator *schemes[] = {nevh_verlet, nevh_position_verlet,
                                        nevh_symplectic_euler_a,
                                        nevh_forest_ruth};
    nevh_scene *scene = counted(_i % 2 ? apart : chain, _i % 2 ? 9000 : 20001);
    assert_same(scene, schemes[_i], _i % 2 ? nevh_central4 : nevh_exact,
                _i == 1);
    nevh_scene_free(scene);
}

/* Vectors that stay in registers for several operations, in chains with all that
   is special: blocks of the tape that end, masses at the ends, numbers of their
   own, and instances that read three variables. */
TEST_EACH(groups_same_bits, 12) {
    static const struct {
        const char *text;
        int count;
    } chains[] = {{driven, 1040}, {chain, 1029}, {apart, 263}};
    if (!has_compiler())
        skip_test("there is no C compiler");
    const nevh_integrator *schemes[] = {nevh_verlet, nevh_position_verlet,
                                        nevh_symplectic_euler_a,
                                        nevh_forest_ruth};
    nevh_scene *scene = counted(chains[_i % 3].text, chains[_i % 3].count);
    assert_same(scene, schemes[_i % 4], nevh_exact, _i % 2);
    assert_same(scene, schemes[_i % 4], nevh_central4, false);
    nevh_scene_free(scene);
}

TEST_EACH(substeps_same_bits, 4) {
    static const int counts[] = {9, 30, 75, 20};
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = counted(bonded, counts[_i]);
    assert_same(scene, nevh_respa, _i == 3 ? nevh_central4 : nevh_exact,
                _i == 1);
    nevh_scene_free(scene);
    scene = counted(driven, 20 + 10 * _i);
    assert_same(scene, nevh_aba84, _i == 3 ? nevh_central2 : nevh_exact, false);
    nevh_scene_free(scene);
}

/* The state stays as it was where it would leave the range of numbers, and the
   tape tells why. */
TEST_EACH(failure_same, 2) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh_scene *scene = counted(chain, _i ? 20500 : 100);
    run tape = begin(scene, nevh_verlet, nevh_exact, false, NEVH_NATIVE_NEVER);
    run native =
        begin(scene, nevh_verlet, nevh_exact, false, NEVH_NATIVE_ALWAYS);
    run *both[] = {&tape, &native};
    for (size_t k = 0; k < 2; k++) {
        double *z = both[k]->z;
        ck_assert_int_ne(
            nevh_run(both[k]->s, 0, 50, 100, z, z + tape.n, NULL, 0), NEVH_OK);
    }
    ck_assert_str_eq(nevh_stepper_message(tape.s),
                     nevh_stepper_message(native.s));
    ck_assert_uint_eq(nevh_stepper_taken(tape.s), nevh_stepper_taken(native.s));
    ck_assert(memcmp(tape.z, native.z, 2 * tape.n * sizeof *tape.z) == 0);
    end(&tape);
    end(&native);
    nevh_scene_free(scene);
}

/* The text does not grow with the instances, but for a few digits. */
static size_t length_of(const char *text, int count) {
    nevh_scene *scene = counted(text, count);
    run r = begin(scene, nevh_verlet, nevh_exact, false, NEVH_NATIVE_NEVER);
    nevh__writer w = {0};
    ck_assert_msg(nevh__native_write(&w, &r.s->work), "%s", w.refusal);
    size_t length = w.used;
    nevh__writer_free(&w);
    end(&r);
    nevh_scene_free(scene);
    return length;
}

TEST(text_does_not_grow) {
    const char *texts[] = {chain, driven, ring, bodies};
    for (size_t i = 0; i < 4; i++)
        ck_assert_uint_lt(length_of(texts[i], 150),
                          length_of(texts[i], 40) + 100);
    ck_assert_uint_lt(length_of(lattice, 190), length_of(lattice, 90) + 100);
}

/* Pairs of bodies go by blocks, and nothing else does. */
TEST(pairs_have_blocks) {
    static const struct {
        const char *text;
        int count;
        bool blocks;
    } texts[] = {{bodies, 8, true},   {kinds, 9, true},    {fluid, 9, true},
                 {bodies, 5, false},  {chain, 100, false}, {ring, 100, false},
                 {lattice, 9, false}, {apart, 50, false}};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        nevh_scene *scene = counted(texts[i].text, texts[i].count);
        run r = begin(scene, nevh_verlet, nevh_exact, false, NEVH_NATIVE_NEVER);
        nevh__writer w = {0};
        ck_assert(nevh__native_write(&w, &r.s->work));
        ck_assert_msg(!!strstr(w.text, "= turned(") == texts[i].blocks,
                      "case %zu", i);
        nevh__writer_free(&w);
        end(&r);
        nevh_scene_free(scene);
    }
}

/* Orbits side by side give the bits of one alone. */
TEST_EACH(pairs_side_by_side, 4) {
    static const struct {
        const char *text;
        int count;
    } texts[] = {{bodies, 8}, {bodies, 50}, {kinds, 6}, {fluid, 19}};
    nevh_scene *scene = counted(texts[_i].text, texts[_i].count);
    run one = begin(scene, nevh_verlet, nevh_exact, false, NEVH_NATIVE_NEVER);
    size_t n = 2 * one.n;
    double *many = calloc(NEVH__LANES * n, sizeof *many);
    for (size_t k = 0; k < NEVH__LANES * n; k++)
        many[k] = one.z[k / NEVH__LANES];
    nevh_options o = {.gradient = nevh_exact,
                      .width = NEVH__LANES,
                      .native = NEVH_NATIVE_NEVER};
    nevh_stepper *s =
        nevh_stepper_new(nevh_scene_system(scene), nevh_verlet, &o);
    ck_assert_int_eq(
        nevh_run(s, 0, 0.01, 9, many, many + NEVH__LANES * one.n, NULL, 0),
        NEVH_OK);
    ck_assert_int_eq(nevh_run(one.s, 0, 0.01, 9, one.z, one.z + one.n, NULL, 0),
                     NEVH_OK);
    for (size_t k = 0; k < NEVH__LANES * n; k++)
        ck_assert_msg(memcmp(&many[k], &one.z[k / NEVH__LANES], sizeof *many) ==
                          0,
                      "number %zu", k);
    nevh_stepper_free(s);
    free(many);
    end(&one);
    nevh_scene_free(scene);
}

/* nevh tests: memory that is out for formulas, scenes and references.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "memory.h"
#include "expression/formula_private.h"
#include <math.h>
#include <nevh/scene.h>

/* Names, and terms of every kind: scalars, instances, a constant, what is
   written out, several shapes. */
static int add_formula(nevh__names *names, nevh_system *s, nevh__owned *owned,
                       nevh__formula_error *e) {
    static const double four = 4, w[] = {2, 3, 5, 7};
    nevh__names_add_parameter(names, "N", 0, &four, e);
    if (!e->status)
        nevh__names_add_parameter(names, "w", 4, w, e);
    if (!e->status)
        nevh__names_add_coordinate(names, "q", 4, 0, e);
    nevh__tree *tree = e->status ? NULL : nevh__tree_parse("q[1] - q[2]", e);
    if (tree)
        nevh__names_add_definition(names, "d", tree, e);
    tree = e->status ? NULL
                     : nevh__tree_parse("d^2/2 + cos(d) - 3 - sum(i = 1..N, "
                                        "j = 1..N, w[i]*q[i]*q[j]) + "
                                        "sqrt(sum(i = 1..N, q[i]^2 + p_q[i]))",
                                        e);
    if (tree)
        nevh__tree_add_terms(tree, names, s, "H", owned, e);
    nevh__tape *tape =
        e->status ? NULL : nevh__tree_tape(tree, names, NEVH__READS_STATE, e);
    nevh__tape_free(tape);
    nevh__tree_free(tree);
    return e->status;
}

static int make_formula(const setting *a) {
    (void)a;
    nevh__formula_error e = {0};
    nevh__head head;
    nevh__owned owned = {0};
    nevh__names *names = nevh__names_new();
    nevh_system *s = nevh_system_new(4);
    bool made = names && s;
    if (made && !add_formula(names, s, &owned, &e) &&
        !nevh__head_parse("q[i = 1..N]", &head, &e))
        nevh__head_free(&head);
    nevh_system_free(s);
    nevh__owned_free(&owned);
    nevh__names_free(names);
    strcpy(text, made ? e.text : "out of memory");
    return made ? e.status : NEVH_ENOMEM;
}

/* All that is shown of a scene at a state, and its text. */
static int ask_scene(nevh_scene *s, const double q[], const double p[]) {
    double values[2];
    bool reached;
    int status = nevh_scene_shown_values(s, NEVH_OBSERVABLES, 0, q, p, values);
    if (!status)
        status = nevh_scene_section_cross(s, 0, 0, q, p, values);
    if (!status)
        status = nevh_scene_part_values(s, 0, 0, q, p, values);
    if (!status)
        status = nevh_scene_stop_reached(s, 0, q, p, &reached);
    return status;
}

/* Read, changed, and momenta sought. */
static int make_scene(const setting *a) {
    (void)a;
    double q[3], p[3];
    nevh_scene *s = nevh_scene_parse(
        "f",
        "[scene]\ntitle = x\neffects = T, V, d\n"
        "[parameters]\na = 2\nb[1..2] = a, 1\n"
        "[coordinates]\nx[1..2] = 1\nv_x[1..2] = 0.5\n"
        "y = 1, 2 ; period pi\n[definitions]\nc = x[1]*y\n"
        "[effects]\nC = file(\"none.c\", y, b)\nT = sum(i = 1..2, p_x[i]^2/(2*b[i])) + "
        "p_x[1]*p_x[2]*cos(c) + p_y^2\nV = c^2\n"
        "[friction]\nd = x: 0.1, y: 0.2\n"
        "[invariants]\nL = x[1] ; without V\n"
        "[observables]\no = v_y\n[picture]\nbob = x[1], x[2]\n"
        "[sections]\ns = when y = 0, both: c\n[labels]\ny = m\n"
        "[run]\ndt = 0.1\nintegrators = verlet, rk4\ntransform = "
        "1 + c^2\nstop = c^2 > 1e9\n");
    int status = nevh_scene_status(s);
    if (!status)
        status = nevh_scene_set(s, "a = 3");
    if (!status)
        status = nevh_scene_start(s, q, p);
    if (!status && !nevh_scene_exact_system(s))
        status = nevh_scene_status(s);
    if (!status)
        status = ask_scene(s, q, p);
    strcpy(text, nevh_scene_message(s));
    char *written = status ? NULL : nevh_scene_write(s, "f");
    if (!status && !written) {
        status = NEVH_ENOMEM;
        strcpy(text, "out of memory");
    }
    free(written);
    nevh_scene_free(s);
    return status;
}

/* Made, and asked for a state between steps. */
static int make_reference(const setting *a) {
    static const double q[] = {0.3, 0.5}, p[] = {0.7, 1.1};
    double to_q[2], to_p[2];
    nevh_reference *r = nevh_reference_new(a->system, a->scheme, 0, 1, q, p);
    nevh_state_error *e = nevh_state_error_new(r);
    int status = nevh_reference_state(r, 0.37, to_q, to_p);
    strcpy(text, nevh_reference_message(r));
    if (r && !e && !status) {
        status = NEVH_ENOMEM;
        strcpy(text, "out of memory");
    }
    nevh_state_error_free(e);
    nevh_reference_free(r);
    return status;
}

TEST(formulas) {
    const setting none = {0};
    ck_assert_uint_ge(starve(make_formula, &none), 100);
}

TEST(scenes) {
    const setting none = {0};
    ck_assert_uint_ge(starve(make_scene, &none), 100);
}

static double attraction(double t, const double q[], const double p[],
                         const void *params) {
    (void)t, (void)params;
    return (p[0] * p[0] + p[1] * p[1]) / 2 - 1 / hypot(q[0], q[1]);
}

TEST_EACH(references, 2) {
    const nevh_integrator *const by[] = {NULL, nevh_gauss12};
    nevh_system *s = nevh_system_from(2, attraction, NULL);
    setting a = {.system = s, .scheme = by[_i]};
    ck_assert_uint_ge(starve(make_reference, &a), 10);
    nevh_system_free(s);
}

/* nevh tests: formulas become terms.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "formula_terms.h"
#include <nevh/models.h>
#include <stdio.h>

/* What is split, and into how many terms. */

static const struct {
    const char *text;
    bool separable, autonomous;
    size_t terms;
} table[] = {
    {"p_x^2/(2*m) + p_y^2/(2*m) - k*(cos(x) + y^2)/2", true, true, 4},
    {"p_x^2/2 - cos(x)", true, true, 2},
    {"kinetic - cos(d)", true, true, 3},
    {"-(p_x^2/2 - cos(x))", true, true, 2},
    {"-k*-(p_x^2 - (x^2 + x^4))/m", true, true, 2},
    {"2*(3*(p_x^2 + x^2)/4)/5", true, true, 2},
    {"(p_x^2 + x^2)^1", true, true, 2},
    {"(m + k)*(p_x^2 + x^2)*(m - k)", true, true, 2},
    {"cos(2*t)*(p_x^2 + x^2)", true, false, 2},
    {"p_x^2 + cos(t)*x + x^2", true, false, 3},
    {"x^2 + y^2 + x^4 + 3*y", true, true, 2},
    {"x^2 + x^2*y + y*x^3 + y", true, true, 3},
    {"(p_x^2 + x^2)*(p_x^2 + x^2)", false, true, 1},
    {"(p_x^2 + x^2)^2", false, true, 1},
    {"x*(p_x + y)", false, true, 1},
    {"(p_x^2 + 2*p_y^2 - p_x*p_y*cos(d))/(1 + sin(d)^2)", false, true, 1},
    {"1/(x + 2) + p_x", true, true, 2},
    {"m/(p_x + x)", false, true, 1},
    {"5 + m", true, true, 1},
    {"p_x + 5 - k", true, true, 2},
    {"sin(t)", true, false, 1},
    {"sum(i = 1..0, q[i])", true, true, 1},
    {"sum(i = 1..0, q[i]) + x", true, true, 1},
    {"sum(i = 1..N, p_q[i]^2/2 + q[i]^2/2)", true, true, 2},
    {"sum(i = 1..N, p_q[i]^2/(2*w[i])) + k/2*sum(i = 1..N, q[i]^2)", true, true,
     2},
    {"-sum(i = 1..N-1, (q[i+1] - q[i])^2 + w[i]*(q[i+1] - q[i])^4)/2", true,
     true, 1},
    {"k*(x + sum(i = 1..N, q[i]))", true, true, 2},
    {"x*(y + sum(i = 1..N, p_q[i]))", false, true, 2},
    {"sum(i = 1..N, q[i])/x", true, true, 1},
    {"sum(i = 1..N, w[i]*sum(j = i+1..N, q[i]*q[j]))", true, true, 1},
    {"sum(i = 1..N, j = 1..N, q[i]*q[j])", true, true, 2},
    {"sum(i = 1..N, q[i]^2 + w[i])", true, true, 2},
    {"sqrt(sum(i = 1..N, q[i]^2))", true, true, 1},
    {"all^2", true, true, 1},
    {"all", true, true, 1},
    {"sum(i = 1..N, w[i]*cos(w[i]*t))", true, false, 1},
    {"sum(i = 1..N, q[i])*sum(i = 1..N, p_q[i])", false, true, 1},
    {"sum(i = 1..N, sqrt(sum(j = i..N, q[j]^2)))", true, true, 4},
};

/* Terms of one formula share a tape, and no other tape is kept. */
static void compare_tapes(const formula_system *s) {
    size_t different = 0;
    for (size_t i = 0; i < s->system->n_terms; i++) {
        const nevh__tape *tape = s->system->terms[i]->decl.params, *first;
        size_t k = 0;
        while (!nevh__tape_same(first = s->system->terms[k]->decl.params, tape))
            k++;
        ck_assert_ptr_eq(first, tape);
        different += k == i;
    }
    ck_assert_uint_eq(s->owned.count, different);
}

TEST_EACH(split, sizeof table / sizeof *table) {
    nevh__names *names = formula_names();
    formula_system s = made(table[_i].text, names, FORMULA_DOF);
    unsigned traits = nevh_system_traits(s.system);
    ck_assert_msg(s.system->n_terms == table[_i].terms, "%s: %zu terms",
                  table[_i].text, s.system->n_terms);
    compare_tapes(&s);
    ck_assert_msg(!(traits & NEVH_SEPARABLE) == !table[_i].separable, "%s",
                  table[_i].text);
    ck_assert_msg(!(traits & NEVH_AUTONOMOUS) == !table[_i].autonomous, "%s",
                  table[_i].text);
    system_done(&s);
    for (int i = 0; i < 3; i++)
        compare_with_whole(table[_i].text, names, FORMULA_DOF);
    nevh__names_free(names);
}

/* Terms come in the order of the text, with names of the effect; constants
   that vary are the only ones kept. */
TEST(order_and_tables) {
    nevh__names *names = formula_names();
    formula_system s =
        made("y^2 + sum(i = 1..N, w[i]*q[i]^2/k + w[i]^2*q[i]*m) + x^2 + y^4",
             names, FORMULA_DOF);
    ck_assert_uint_eq(s.system->n_terms, 3);
    const nevh_term *a = &s.system->terms[0]->decl,
                    *b = &s.system->terms[1]->decl,
                    *c = &s.system->terms[2]->decl;
    ck_assert_str_eq(a->name, "H");
    ck_assert_str_eq(b->name, "H 2");
    ck_assert_str_eq(c->name, "H 3");
    ck_assert_uint_eq(a->q[0], 1);
    ck_assert_uint_eq(c->q[0], 0);
    ck_assert_uint_eq(a->nc + c->nc, 0);
    ck_assert_uint_eq(b->count, 4);
    ck_assert(b->nq == 1 && b->np == 0 && b->nc == 2 && !b->time);
    for (size_t i = 0; i < 4; i++) {
        ck_assert_uint_eq(b->q[i], 2 + i);
        ck_assert_double_eq(b->c[2 * i], formula_w[i]);
        ck_assert_double_eq(b->c[2 * i + 1], formula_w[i] * formula_w[i]);
    }
    system_done(&s);
    s = made("sum(i = 1..N, k*q[i]^2/2)", names, FORMULA_DOF);
    ck_assert_uint_eq(s.system->terms[0]->decl.nc, 0);
    system_done(&s);
    nevh__names_free(names);
}

TEST(pairs) {
    nevh__names *names = formula_names();
    formula_system s =
        made("sum(i = 1..N, j = 1..N, i*q[i]*q[j]*p_q[i])", names, FORMULA_DOF);
    ck_assert_uint_eq(s.system->n_terms, 2);
    const nevh_term *diagonal = &s.system->terms[0]->decl,
                    *others = &s.system->terms[1]->decl;
    ck_assert(diagonal->count == 4 && diagonal->nq == 1 && diagonal->np == 1);
    ck_assert(others->count == 12 && others->nq == 2 && others->np == 1);
    system_done(&s);
    nevh__names_free(names);
}

/* Chains and rings of any length. */

static nevh__names *chain_names(size_t n, double w[]) {
    nevh__formula_error e;
    nevh__names *names = nevh__names_new();
    double count = (double)n, a = 0.25;
    for (size_t i = 0; w && i < n; i++)
        w[i] = 1 + (double)(i % 7) / 8;
    int status = nevh__names_add_parameter(names, "N", 0, &count, &e);
    status |= nevh__names_add_parameter(names, "a", 0, &a, &e);
    if (w)
        status |= nevh__names_add_parameter(names, "w", n, w, &e);
    status |= nevh__names_add_coordinate(names, "x", n, 0, &e);
    ck_assert_int_eq(status, NEVH_OK);
    return names;
}

/* A bond from each mass to the next; bond 0 of a ring closes it. */
static double ring_value(size_t n, const double q[], double dq[]) {
    double h = 0;
    memset(dq, 0, n * sizeof *dq);
    for (size_t i = 0; i < n; i++) {
        size_t next = (i + 1) % n;
        double d = q[next] - q[i], f = d + d * d * d + 0.5;
        h += d * d / 2 + d * d * d * d / 4 + d / 2 - 2 * cos(q[i]) +
             q[i] * q[next];
        dq[next] += f + q[i];
        dq[i] += 2 * sin(q[i]) - f + q[next];
    }
    return h;
}

TEST_RANGE(rings, 1, 7) {
    static const char text[] =
        "sum(i = 1..N, (x[mod(i, N) + 1] - x[i])^2/2"
        " + (x[mod(i, N) + 1] - x[i])^4/4 + (x[mod(i, N) + 1] - x[i])/2"
        " - 2*cos(x[i]) + x[i]*x[mod(i, N) + 1])";
    size_t n = (size_t)_i;
    nevh__names *names = chain_names(n, NULL);
    double q[8], p[8], dq[8], h, slopes[16];
    random_state(n, q, p);
    formula_system s = made(text, names, n);
    evaluate(s.system, 0, q, p, &h, slopes);
    ck_assert_double_eq_tol(h, ring_value(n, q, dq), 1e-13);
    for (size_t k = 0; k < n; k++) {
        ck_assert_double_eq_tol(slopes[k], dq[k], 1e-13);
        ck_assert_double_eq(slopes[n + k], 0);
    }
    system_done(&s);
    compare_with_whole(text, names, n);
    nevh__names_free(names);
}

/* Fermi, Pasta, Ulam and Tsingou, between walls. */
TEST(long_chain) {
    enum { N = 100000 };
    static double w[N], q[N], p[N], slopes[2 * N];
    nevh__names *names = chain_names(N, w);
    formula_system s = made("sum(i = 1..N, p_x[i]^2/(2*w[i]))"
                            " + x[1]^2/2 + x[N]^2/2"
                            " + sum(i = 1..N-1, (x[i+1] - x[i])^2/2"
                            " + a/3*(x[i+1] - x[i])^3)",
                            names, N);
    ck_assert_uint_eq(s.system->n_terms, 4);
    ck_assert_uint_eq(s.system->terms[0]->decl.count, N);
    ck_assert_uint_eq(s.system->terms[3]->decl.count, N - 1);
    ck_assert_uint_eq(s.system->terms[3]->decl.nq, 2);
    random_state(N, q, p);
    double h, sum = q[0] * q[0] / 2 + q[N - 1] * q[N - 1] / 2;
    for (size_t i = 0; i < N; i++) {
        double d = i + 1 < N ? q[i + 1] - q[i] : 0;
        sum += p[i] * p[i] / (2 * w[i]) + d * d / 2 + 0.25 / 3 * d * d * d;
    }
    evaluate(s.system, 0, q, p, &h, slopes);
    ck_assert_double_eq_tol(h, sum, 1e-11 * fabs(sum));
    for (size_t i = 1; i < N - 1; i++) {
        double left = q[i] - q[i - 1], right = q[i + 1] - q[i];
        double force = left + 0.25 * left * left - right - 0.25 * right * right;
        ck_assert_double_eq_tol(slopes[i], force, 1e-12);
        ck_assert_double_eq_tol(slopes[N + i], p[i] / w[i], 1e-14);
    }
    system_done(&s);
    nevh__names_free(names);
}

/* Every pair of 40 bodies with three coordinates each. */
TEST(many_bodies) {
    enum { N = 20 };
    static double w[3 * N];
    nevh__names *names = chain_names(3 * N, w);
    compare_with_whole(
        "sum(i = 1..60, p_x[i]^2/(2*w[i]))"
        " - sum(i = 1..20, j = i+1..20, w[i]*w[j]/sqrt(0.1 + (x[3*i-2] - "
        "x[3*j-2])^2 + (x[3*i-1] - x[3*j-1])^2 + (x[3*i] - x[3*j])^2))",
        names, 3 * N);
    compare_with_whole(
        "-sum(i = 1..20, j = i+1..20, w[i]*w[j]/sqrt(0.1 + sum(k = 0..2, "
        "(x[3*i-k] - x[3*j-k])^2)))",
        names, 3 * N);
    formula_system s = made("sum(i = 1..20, j = i+1..20, 1/(1 + sum(k = 0..2, "
                            "(x[3*i-k] - x[3*j-k])^2)))",
                            names, 3 * N);
    ck_assert_uint_eq(s.system->n_terms, 1);
    ck_assert_uint_eq(s.system->terms[0]->decl.count, 190);
    ck_assert_uint_eq(s.system->terms[0]->decl.nq, 6);
    system_done(&s);
    nevh__names_free(names);
}

/* The model in text. */
TEST(double_pendulum_in_text) {
    nevh__formula_error e;
    nevh__names *names = nevh__names_new();
    const nevh_model *model = nevh_double_pendulum_model;
    const nevh_double_pendulum *a = model->defaults;
    nevh__names_add_parameter(names, "m", 0, &a->m, &e);
    nevh__names_add_parameter(names, "l", 0, &a->l, &e);
    nevh__names_add_parameter(names, "g", 0, &a->g, &e);
    nevh__names_add_coordinate(names, "phi1", 0, 0, &e);
    nevh__names_add_coordinate(names, "phi2", 0, 1, &e);
    define(names, "d", "phi1 - phi2");
    formula_system s =
        made("(p_phi1^2 + 2*p_phi2^2 - 2*p_phi1*p_phi2*cos(d))"
             " / (2*m*l^2*(1 + sin(d)^2)) - m*g*l*(2*cos(phi1) + cos(phi2))",
             names, 2);
    ck_assert_uint_eq(s.system->n_terms, 3);
    nevh_system *reference = model->system(a);
    for (int i = 0; i < 100; i++) {
        double q[2], p[2], h[2], slopes[2][4];
        random_state(2, q, p);
        evaluate(s.system, 0, q, p, &h[0], slopes[0]);
        evaluate(reference, 0, q, p, &h[1], slopes[1]);
        ck_assert_double_eq_tol(h[0], h[1], 1e-14 * (1 + fabs(h[1])));
        for (int k = 0; k < 4; k++)
            ck_assert_double_eq_tol(slopes[0][k], slopes[1][k],
                                    1e-13 * (1 + fabs(slopes[1][k])));
    }
    nevh_system_free(reference);
    system_done(&s);
    nevh__names_free(names);
}

/* Observables may read velocities, which are constants of the tape. */
TEST(velocities) {
    nevh__names *names = formula_names();
    nevh__formula_error e;
    nevh__tree *tree = nevh__tree_parse("x*v_y + v_q[3]^2 + p_x", &e);
    unsigned reads = 0;
    ck_assert_int_eq(nevh__tree_check(tree, names, 15, &reads, &e), NEVH_OK);
    ck_assert_uint_eq(reads, NEVH__READS_STATE | NEVH__READS_V);
    nevh__tape *tape = nevh__tree_tape(tree, names, 15, &e);
    ck_assert(tape != NULL);
    const double q[6] = {2}, p[6] = {5}, v[6] = {0, 3, 0, 0, 7};
    ck_assert_double_eq(nevh__tape_value(0, q, p, v, tape), 6 + 49 + 5);
    nevh__tape_free(tape);
    ck_assert(!nevh__tree_tape(tree, names, NEVH__READS_STATE, &e));
    ck_assert_uint_eq(e.column, 3);
    nevh__tree_free(tree);
    nevh__names_free(names);
}

/* nevh tests: random tapes, short and long, and terms that are tapes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include "expression/tape_private.h"
#include <float.h>
#include <math.h>
#include <nevh/models.h>
#include <stdlib.h>
#include <string.h>

enum { VARIABLES = 3, MOST_NODES = 60000, WIDTH = 72 };

static unsigned long long seed;

/* In [0, below). */
static int random_int(int below) {
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (int)((seed >> 33) % (unsigned long long)below);
}

static double uniform(void) {
    return random_int(1 << 20) / (double)(1 << 20) - 0.5;
}

/* An expression as a list, apart from the tape's: node i is an operation on
   earlier nodes, or a variable (q, p, c, t) or a number. */
typedef struct {
    enum { VARIABLE, NUMBER, OPERATION } kind;
    nevh__tape_operation is;
    int a, b;
    double number;
    bool drawn; /* may be drawn as an operand: a variable, a halved result */
} node;

static node nodes[MOST_NODES + 1100];
static int node_count;

static int put(node n) {
    nodes[node_count] = n;
    return node_count++;
}

static int combine(nevh__tape_operation is, int u, int v) {
    return put((node){.kind = OPERATION, .is = is, .a = u, .b = v});
}

enum { LEAVES = 2 * VARIABLES + 2 };

static void put_leaves(void) {
    node_count = 0;
    for (int i = 0; i < LEAVES; i++)
        put((node){.kind = VARIABLE, .a = i, .drawn = true});
}

/* Of the last `reach` nodes one. */
static int drawn(int reach) {
    int near = node_count < reach ? node_count : reach, found;
    do
        found = node_count - 1 - random_int(near);
    while (!nodes[found].drawn);
    return found;
}

/* Most operands are near, some variables, some from far back. */
static int operand(int reach) {
    int from = random_int(10);
    return from == 0   ? drawn(node_count)
           : from == 1 ? random_int(LEAVES)
                       : drawn(reach);
}

static const nevh__tape_operation smooth[] = {
    NEVH__ADD,  NEVH__SUBTRACT, NEVH__MULTIPLY, NEVH__NEGATE, NEVH__SIN,
    NEVH__COS,  NEVH__TANH,     NEVH__HYPOT,    NEVH__ATAN,   NEVH__ASINH,
    NEVH__ATAN, NEVH__DIVIDE,   NEVH__SQRT,     NEVH__EXP,    NEVH__POWER,
};
static const nevh__tape_operation arithmetic[] = {
    NEVH__ADD,    NEVH__SUBTRACT, NEVH__MULTIPLY, NEVH__NEGATE,
    NEVH__DIVIDE, NEVH__SQRT,     NEVH__MIN,      NEVH__ABS,
};

/* 1.5 + u^2/(1 + u^2), for what must not be near 0. */
static int positive(int u) {
    int square = combine(NEVH__MULTIPLY, u, u);
    int one = put((node){.kind = NUMBER, .number = 1});
    int share = combine(NEVH__DIVIDE, square, combine(NEVH__ADD, square, one));
    return combine(NEVH__ADD, share,
                   put((node){.kind = NUMBER, .number = 1.5}));
}

/* Halved, so that neither values nor derivatives grow from node to node.
   Takes the last result, so that none is without use. */
static void put_random(const nevh__tape_operation from[], int count,
                       int reach) {
    nevh__tape_operation is = from[random_int(count)];
    int u = node_count - 1, v = operand(reach);
    if (is == NEVH__DIVIDE || is == NEVH__HYPOT)
        v = positive(v);
    if (is == NEVH__SQRT || is == NEVH__POWER || is == NEVH__EXP)
        u = positive(u);
    if (is == NEVH__EXP)
        u = combine(NEVH__NEGATE, u, u);
    int cosine = is == NEVH__SIN ? combine(NEVH__COS, u, u) : 0;
    u = combine(is, u, v);
    if (is == NEVH__SIN)
        u = combine(NEVH__ADD, combine(NEVH__MULTIPLY, u, v), cosine);
    v = put((node){.kind = NUMBER, .number = 0.5});
    nodes[combine(NEVH__MULTIPLY, u, v)].drawn = true;
}

/* `count` nodes or a few more, of which many are summed up in the end. */
static void make(const nevh__tape_operation from[], int operations, int count,
                 int reach) {
    put_leaves();
    while (node_count < count)
        put_random(from, operations, 8 + reach);
    int sum = node_count - 1, end = node_count;
    for (int i = 0; i < reach; i++)
        sum = combine(NEVH__ADD, sum, drawn(i % 2 ? 50 + 2 * i : end));
}

static nevh__tape *tape_of_nodes(void) {
    static int made[MOST_NODES + 1100];
    static const nevh__variable kinds[] = {NEVH__Q, NEVH__P};
    int status;
    nevh__tape_builder *b = nevh__tape_builder_new();
    for (int i = 0; i < node_count; i++) {
        const node *n = &nodes[i];
        if (n->kind == OPERATION)
            made[i] = nevh__tape_apply(b, n->is, made[n->a], made[n->b]);
        else if (n->kind == NUMBER)
            made[i] = nevh__tape_number(b, n->number);
        else if (n->a < 2 * VARIABLES)
            made[i] = nevh__tape_variable(b, kinds[n->a / VARIABLES],
                                          n->a % VARIABLES);
        else
            made[i] = nevh__tape_variable(
                b, n->a == 2 * VARIABLES ? NEVH__C : NEVH__T, 0);
    }
    nevh__tape *tape = nevh__tape_finish(b, made[node_count - 1], &status);
    ck_assert_int_eq(status, NEVH_OK);
    return tape;
}

/* Node by node, in the order in which they were made. */
static double plain_value(const double leaves[LEAVES]) {
    static double value[MOST_NODES + 1100];
    for (int i = 0; i < node_count; i++) {
        const node *n = &nodes[i];
        value[i] = n->kind == VARIABLE ? leaves[n->a]
                   : n->kind == NUMBER
                       ? n->number
                       : nevh__operation_value(n->is, value[n->a], value[n->b]);
    }
    return value[node_count - 1];
}

/* Rows as a field has them; and the one lane as a state of its own. */
typedef struct {
    double q[VARIABLES][WIDTH], p[VARIABLES][WIDTH], c[WIDTH], t[WIDTH];
    double h[WIDTH], dq[VARIABLES][WIDTH], dp[VARIABLES][WIDTH];
} block;

static void fill(block *x) {
    for (size_t i = 0; i < WIDTH; i++) {
        for (int k = 0; k < VARIABLES; k++) {
            x->q[k][i] = uniform();
            x->p[k][i] = uniform();
        }
        x->c[i] = uniform();
        x->t[i] = uniform();
    }
}

static void gather(const block *x, size_t i, double leaves[LEAVES]) {
    for (int k = 0; k < VARIABLES; k++) {
        leaves[k] = x->q[k][i];
        leaves[VARIABLES + k] = x->p[k][i];
    }
    leaves[2 * VARIABLES] = x->c[i];
    leaves[2 * VARIABLES + 1] = x->t[i];
}

static void evaluate(block *x, const nevh__tape *tape) {
    nevh__tape_block(WIDTH, x->t, x->q[0], x->p[0], x->c, tape, x->h);
    nevh__tape_block_gradient(WIDTH, x->t, x->q[0], x->p[0], x->c, tape,
                              x->dq[0], x->dp[0]);
}

/* Value and derivative by variable k over complex numbers. */
static void complex_at(const double leaves[LEAVES], int k,
                       const nevh__tape *tape, double h[2]) {
    double z[2 * VARIABLES][2] = {{0}};
    for (int i = 0; i < 2 * VARIABLES; i++)
        z[i][0] = leaves[i];
    z[k][1] = 0x1p-332;
    nevh__tape_complex(leaves[2 * VARIABLES + 1], (const double(*)[2])z,
                       (const double(*)[2])z + VARIABLES,
                       &leaves[2 * VARIABLES], tape, h);
    h[1] *= 0x1p332;
}

/* Scalar values are those of the nodes, to the bit, and so are complex ones;
   blocks to `error`; the reverse sweep gives what forward differentiation
   does. */
static void compare(const block *x, size_t lane, const nevh__tape *tape,
                    double error) {
    double leaves[LEAVES], h[2];
    gather(x, lane, leaves);
    double plain = plain_value(leaves);
    double one =
        nevh__tape_value(leaves[LEAVES - 1], leaves, leaves + VARIABLES,
                         &leaves[LEAVES - 2], tape);
    ck_assert_double_eq(one, plain);
    ck_assert_double_le(fabs(x->h[lane] - plain), error * (1 + fabs(plain)));
    for (int k = 0; k < 2 * VARIABLES; k++) {
        double reverse =
            k < VARIABLES ? x->dq[k][lane] : x->dp[k - VARIABLES][lane];
        complex_at(leaves, k, tape, h);
        ck_assert_double_eq(h[0], plain);
        ck_assert_msg(fabs(reverse - h[1]) <=
                          (error + 1e-13) * (1 + fabs(h[1])),
                      "lane %zu, by variable %d: %.17g, not %.17g", lane, k,
                      reverse, h[1]);
    }
}

static void compare_all(size_t stride, double error) {
    static block x;
    nevh__tape *tape = tape_of_nodes();
    fill(&x);
    evaluate(&x, tape);
    ck_assert_uint_ge(2 * nevh__tape_length(tape), node_count);
    for (size_t lane = 0; lane < WIDTH; lane += stride)
        compare(&x, lane, tape, error);
    nevh__tape_free(tape);
}

TEST_EACH(random_formulas, 60) {
    seed = 1000 + (unsigned)_i;
    make(smooth, sizeof smooth / sizeof *smooth, 80 + 40 * _i, 4 + _i);
    compare_all(5, 1e-12);
}

TEST_EACH(blocks_of_arithmetic_are_exact, 20) {
    seed = 2000 + (unsigned)_i;
    make(arithmetic, sizeof arithmetic / sizeof *arithmetic, 300, 5 + _i);
    compare_all(1, 0);
}

/* Logs that do not fit: short memory in little scratch, long in much. */
TEST_EACH(long_formulas, 5) {
    static const int lengths[] = {3000, 12000, 60000, 3000, 40000};
    static const int reaches[] = {10, 20, 8, 400, 200};
    seed = 3000 + (unsigned)_i;
    make(smooth, sizeof smooth / sizeof *smooth, lengths[_i], reaches[_i]);
    compare_all(17, 1e-12);
}

/* Neither width nor neighbours, where slots are used again and halves run. */
TEST_EACH(lanes_are_alone, 3) {
    static block x, y;
    static const int lengths[] = {60, 400, 6000};
    double h[8], dq[VARIABLES * 8], dp[VARIABLES * 8];
    double q8[VARIABLES * 8], p8[VARIABLES * 8], c8[8], t8[8];
    seed = 4000 + (unsigned)_i;
    make(smooth, sizeof smooth / sizeof *smooth, lengths[_i], 12);
    nevh__tape *tape = tape_of_nodes();
    fill(&x);
    fill(&y);
    evaluate(&x, tape);
    for (size_t i = 0; i < WIDTH; i += 5) {
        size_t lane = i * 3 % 8;
        for (size_t j = 0; j < 8; j++) {
            const block *from = j == lane ? &x : &y;
            size_t at = j == lane ? i : j;
            for (size_t k = 0; k < VARIABLES; k++) {
                q8[k * 8 + j] = from->q[k][at];
                p8[k * 8 + j] = from->p[k][at];
            }
            c8[j] = from->c[at];
            t8[j] = from->t[at];
        }
        nevh__tape_block(8, t8, q8, p8, c8, tape, h);
        nevh__tape_block_gradient(8, t8, q8, p8, c8, tape, dq, dp);
        ck_assert(h[lane] == x.h[i]);
        for (size_t k = 0; k < VARIABLES; k++) {
            ck_assert(dq[k * 8 + lane] == x.dq[k][i]);
            ck_assert(dp[k * 8 + lane] == x.dp[k][i]);
        }
    }
    nevh__tape_free(tape);
}

/* The double pendulum's kinetic energy; w and 2 m l^2 are constants, and the
   third coordinate is declared, but not read. */
static nevh__tape *kinetic_tape(void) {
    nevh__tape_builder *b = nevh__tape_builder_new();
    int q1 = nevh__tape_variable(b, NEVH__Q, 0);
    int q2 = nevh__tape_variable(b, NEVH__Q, 1);
    int p1 = nevh__tape_variable(b, NEVH__P, 0);
    int p2 = nevh__tape_variable(b, NEVH__P, 1);
    int w = nevh__tape_variable(b, NEVH__C, 0);
    int scale = nevh__tape_variable(b, NEVH__C, 1);
    int two = nevh__tape_number(b, 2);
    int d = nevh__tape_apply(b, NEVH__SUBTRACT, q1, q2);
    int sine = nevh__tape_apply(b, NEVH__SIN, d, d);
    int cosine = nevh__tape_apply(b, NEVH__COS, d, d);
    int form = nevh__tape_apply(
        b, NEVH__ADD, nevh__tape_apply(b, NEVH__POWER, p1, two),
        nevh__tape_apply(b, NEVH__MULTIPLY, w,
                         nevh__tape_apply(b, NEVH__POWER, p2, two)));
    int mixed = nevh__tape_apply(b, NEVH__MULTIPLY, two, p1);
    mixed = nevh__tape_apply(b, NEVH__MULTIPLY, mixed, p2);
    mixed = nevh__tape_apply(b, NEVH__MULTIPLY, mixed, cosine);
    form = nevh__tape_apply(b, NEVH__SUBTRACT, form, mixed);
    int root = nevh__tape_apply(b, NEVH__ADD, nevh__tape_number(b, 1),
                                nevh__tape_apply(b, NEVH__POWER, sine, two));
    root = nevh__tape_apply(b, NEVH__MULTIPLY, scale, root);
    return nevh__tape_finish(b, nevh__tape_apply(b, NEVH__DIVIDE, form, root),
                             NULL);
}

/* c[0] cos q[0] */
static nevh__tape *cosine_tape(void) {
    nevh__tape_builder *b = nevh__tape_builder_new();
    int q = nevh__tape_variable(b, NEVH__Q, 0);
    int c = nevh__tape_variable(b, NEVH__C, 0);
    nevh__tape_variable(b, NEVH__Q, 1);
    int h = nevh__tape_apply(b, NEVH__MULTIPLY, c,
                             nevh__tape_apply(b, NEVH__COS, q, q));
    return nevh__tape_finish(b, h, NULL);
}

static nevh_system *system_of_tapes(const nevh__tape *kinetic,
                                    const nevh__tape *cosine) {
    static const size_t swapped[] = {0, 1, 1, 0};
    static const double weights[] = {-2 * 9.8, -9.8}, constants[] = {2, 2};
    nevh_system *s = nevh_system_new(2);
    nevh_term term = {.effect = "kinetic", .c = constants};
    nevh__tape_shape(&term, kinetic);
    ck_assert_int_eq(nevh_system_add(s, &term), NEVH_OK);
    term = (nevh_term){
        .effect = "gravity", .q = swapped, .c = weights, .count = 2};
    nevh__tape_shape(&term, cosine);
    ck_assert_int_eq(nevh_system_add(s, &term), NEVH_OK);
    return s;
}

static nevh_stepper *run(nevh_system *s, const nevh_gradient *g, double q[2],
                         double p[2]) {
    nevh_options options = {.gradient = g, .q = q, .p = p};
    nevh_stepper *stepper = nevh_stepper_new(s, nevh_gauss4, &options);
    ck_assert_msg(nevh_stepper_status(stepper) == NEVH_OK, "%s",
                  nevh_stepper_message(stepper));
    for (int i = 0; i < 200; i++)
        ck_assert_int_eq(nevh_stepper_apply(stepper, 0.01 * i, 0.01, q, p),
                         NEVH_OK);
    return stepper;
}

TEST_EACH(orbits_of_the_model, 3) {
    static const nevh_gradient *const *const gradients[] = {
        &nevh_exact, &nevh_complex_step, &nevh_central4};
    const nevh_gradient *g = *gradients[_i];
    const nevh_model *model = nevh_double_pendulum_model;
    nevh__tape *kinetic = kinetic_tape(), *cosine = cosine_tape();
    nevh_system *systems[] = {system_of_tapes(kinetic, cosine),
                              model->system(model->defaults)};
    double q[2][2], p[2][2], h[2];
    for (int i = 0; i < 2; i++) {
        q[i][0] = 1.1, q[i][1] = -0.4, p[i][0] = 0.3, p[i][1] = 0.2;
        nevh_stepper_free(run(systems[i], g, q[i], p[i]));
        h[i] = model->hamiltonian(0, q[i], p[i], model->defaults);
        nevh_system_free(systems[i]);
    }
    double allowed = g == nevh_central4 ? 1e-8 : 1e-12;
    ck_assert_double_eq_tol(h[0], h[1], allowed);
    for (int k = 0; k < 2; k++) {
        ck_assert_double_eq_tol(q[0][k], q[1][k], allowed);
        ck_assert_double_eq_tol(p[0][k], p[1][k], allowed);
    }
    nevh__tape_free(kinetic);
    nevh__tape_free(cosine);
}

/* nevh tests: formulas drawn at random: their values as muParser finds them,
   their exact gradients as the complex step and differences do.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "config.h"
#include "formula.h"
#include <math.h>
#include <stdio.h>
#ifdef HAVE_MUPARSER
#include <muParserDLL.h>
#endif

enum { FORMULAS = 4000, LENGTH = 4000, WIDTH = 8, VARIABLES = 4 };
static const char *const variables[VARIABLES] = {"x", "y", "p_x", "p_y"};

static unsigned drawn = 1;
static unsigned below(unsigned most) {
    drawn = drawn * 1664525u + 1013904223u;
    return (drawn >> 8) % most;
}
static double between(double from, double to) {
    return from + (to - from) * below(1 << 20) / (1 << 20);
}

static void put(char *text, const char *part) {
    ck_assert_uint_lt(strlen(text) + strlen(part), LENGTH);
    strcat(text, part);
}

static void put_leaf(char *text) {
    char number[40];
    snprintf(number, sizeof number, "%.3g", between(0.1, 3));
    put(text, below(4) ? variables[below(VARIABLES)] : number);
}

/* Functions of everything, smooth and of moderate size.  Not asinh, in which
   muParser loses digits. */
static const char *const smooth[] = {"sin(",  "cos(",         "tanh(",
                                     "atan(", "sinh(0.3*sin", "cosh(0.3*cos"};
/* Of the sum of a square and a number. */
static const char *const positive[] = {"sqrt(1 + ", "1/(2 + ", "log(2 + ",
                                       "exp(-"};

static void put_formula(char *text, int depth);

static void put_pair(char *text, int depth) {
    static const char *const between_them[] = {" + ", " - ", "*", " - 2*",
                                               "*0.7*"};
    put(text, "(");
    put_formula(text, depth - 1);
    put(text, between_them[below(5)]);
    put_formula(text, depth - 1);
    put(text, ")");
}

static void put_formula(char *text, int depth) {
    unsigned which = depth > 0 ? below(10) : 0;
    if (which == 0) {
        put_leaf(text);
    } else if (which < 5) {
        put_pair(text, depth);
    } else if (which < 8) {
        const char *name = smooth[below(6)];
        put(text, name);
        put(text, strchr(name, '*') ? "(" : "");
        put_formula(text, depth - 1);
        put(text, strchr(name, '*') ? "))" : ")");
    } else if (which == 8) {
        put(text, positive[below(4)]);
        put_pair(text, depth);
        put(text, "^2)");
    } else {
        put_pair(text, depth);
        put(text, below(2) ? "^2" : "^3");
    }
}

typedef struct {
    char text[LENGTH];
    nevh__tape *tape;
    double state[VARIABLES]; /* x, y, p_x, p_y */
} formula;

static formula draw(const nevh__names *names, int depth) {
    formula f = {.text = ""};
    nevh__formula_error e;
    put_formula(f.text, depth);
    nevh__tree *tree = nevh__tree_parse(f.text, &e);
    ck_assert_msg(tree != NULL, "%s: %s", f.text, e.text);
    f.tape = nevh__tree_tape(tree, names, NEVH__READS_STATE, &e);
    ck_assert_msg(f.tape != NULL, "%s: %s", f.text, e.text);
    nevh__tree_free(tree);
    for (int i = 0; i < VARIABLES; i++)
        f.state[i] = between(-2, 2);
    return f;
}

static double value(const formula *f, const double state[]) {
    double q[FORMULA_DOF] = {state[0], state[1]};
    double p[FORMULA_DOF] = {state[2], state[3]};
    return nevh__tape_value(0, q, p, NULL, f->tape);
}

/* By the reverse sweep. */
static void exact(const formula *f, double g[]) {
    double t[WIDTH] = {0}, q[FORMULA_DOF * WIDTH] = {0},
           p[FORMULA_DOF * WIDTH] = {0}, dq[FORMULA_DOF * WIDTH],
           dp[FORMULA_DOF * WIDTH];
    memset(dq, 0, sizeof dq);
    memset(dp, 0, sizeof dp);
    for (int i = 0; i < 2 * WIDTH; i++) {
        q[i] = f->state[i / WIDTH];
        p[i] = f->state[2 + i / WIDTH];
    }
    nevh__tape_block_gradient(WIDTH, t, q, p, NULL, f->tape, dq, dp);
    for (int i = 0; i < 2; i++) {
        bool read_q = nevh__tape_reads(f->tape, NEVH__Q, (size_t)i);
        bool read_p = nevh__tape_reads(f->tape, NEVH__P, (size_t)i);
        g[i] = read_q ? dq[i * WIDTH + 3] : 0;
        g[2 + i] = read_p ? dp[i * WIDTH + 3] : 0;
    }
}

static double by_complex_step(const formula *f, int variable) {
    double q[FORMULA_DOF][2] = {{f->state[0]}, {f->state[1]}};
    double p[FORMULA_DOF][2] = {{f->state[2]}, {f->state[3]}}, h[2];
    *(variable < 2 ? &q[variable][1] : &p[variable - 2][1]) = 1e-100;
    nevh__tape_complex(0, (const double(*)[2])q, (const double(*)[2])p, NULL,
                       f->tape, h);
    return h[1] / 1e-100;
}

/* Of order 8. */
static double by_differences(const formula *f, int variable, double delta) {
    static const double weight[] = {4. / 5, -1. / 5, 4. / 105, -1. / 280};
    double sum = 0;
    for (int k = 0; k < 4; k++) {
        double up[VARIABLES], down[VARIABLES];
        memcpy(up, f->state, sizeof up);
        memcpy(down, f->state, sizeof down);
        up[variable] += (k + 1) * delta;
        down[variable] -= (k + 1) * delta;
        sum += weight[k] * (value(f, up) - value(f, down));
    }
    return sum / delta;
}

/* How much the derivative itself varies where the state is rounded: no method
   can tell it better. */
static double unsure(const formula *f, int variable) {
    double most = 0;
    for (int i = 0; i < VARIABLES; i++) {
        formula moved = *f;
        moved.state[i] += 1e-6;
        double change =
            by_complex_step(&moved, variable) - by_complex_step(f, variable);
        most = fmax(most, fabs(change) / 1e-6);
    }
    return most;
}

TEST(gradients) {
    nevh__names *names = formula_names();
    drawn = 7;
    for (int i = 0; i < FORMULAS; i++) {
        formula f = draw(names, 3 + i % 4);
        double g[VARIABLES], size = fabs(value(&f, f.state));
        exact(&f, g);
        for (int k = 0; k < VARIABLES; k++) {
            double scale = 1 + fabs(g[k]) + unsure(&f, k) + size;
            double step = by_complex_step(&f, k);
            ck_assert_msg(fabs(g[k] - step) <= 1e-14 * scale,
                          "%s: d/d%s is %.17g, and %.17g", f.text, variables[k],
                          g[k], step);
        }
        nevh__tape_free(f.tape);
    }
    nevh__names_free(names);
}

/* The best of a sequence of steps, where the function does not vary faster than
   they are long. */
TEST(gradients_by_differences) {
    nevh__names *names = formula_names();
    int compared = 0;
    drawn = 11;
    for (int i = 0; i < FORMULAS / 4; i++) {
        formula f = draw(names, 3 + i % 2);
        double g[VARIABLES];
        exact(&f, g);
        for (int k = 0; k < VARIABLES; k++) {
            double best = INFINITY;
            if (unsure(&f, k) > 100)
                continue;
            compared++;
            for (double delta = 0.25; delta > 1e-4; delta /= 2)
                best = fmin(best, fabs(by_differences(&f, k, delta) - g[k]));
            double scale = 1 + fabs(g[k]) + fabs(value(&f, f.state));
            ck_assert_msg(best <= 1e-9 * scale, "%s: d/d%s is %.17g, off %.1e",
                          f.text, variables[k], g[k], best);
        }
        nevh__tape_free(f.tape);
    }
    ck_assert_int_gt(compared, FORMULAS / 2);
    nevh__names_free(names);
}

#ifdef HAVE_MUPARSER
static double judge(const formula *f) {
    muParserHandle_t parser = mupCreate(0);
    double state[VARIABLES];
    memcpy(state, f->state, sizeof state);
    for (int k = 0; k < VARIABLES; k++)
        mupDefineVar(parser, variables[k], &state[k]);
    mupSetExpr(parser, f->text);
    double found = mupEval(parser);
    ck_assert_msg(!mupError(parser), "%s: %s", f->text, mupGetErrorMsg(parser));
    mupRelease(parser);
    return found;
}

/* The size of what is added up to the value is not known: how it varies where
   the state is rounded stands for it. */
TEST(values) {
    nevh__names *names = formula_names();
    drawn = 13;
    for (int i = 0; i < FORMULAS; i++) {
        formula f = draw(names, 3 + i % 4);
        double g[VARIABLES], own = value(&f, f.state), other = judge(&f);
        exact(&f, g);
        double scale = 1 + fabs(own);
        for (int k = 0; k < VARIABLES; k++)
            scale += fabs(g[k]);
        ck_assert_msg(fabs(own - other) <= 1e-14 * scale,
                      "%s is %.17g, not %.17g", f.text, own, other);
        nevh__tape_free(f.tape);
    }
    nevh__names_free(names);
}

/* What is written without parentheses. */
TEST(precedence) {
    static const char *const texts[] = {
        "-x^2",     "2^-1",         "2^3^2",      "-2^2",   "x - y - 3",
        "x/y/3",    "x/y*3",        "-x*-y",      "2*-x^2", "x^2^0.5",
        "1 - -x^3", "x - y^2*3/-4", "-(x - y)^2", "x*y^-2", "2^-x^2",
        "+x",       "1e-3*x",       ".5*x + 2.",  "-x/-y"};
    nevh__names *names = formula_names();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        formula f = {.state = {1.7, 0.6, 0.3, -0.2}};
        nevh__formula_error e;
        strcpy(f.text, texts[i]);
        nevh__tree *tree = nevh__tree_parse(f.text, &e);
        ck_assert_msg(tree != NULL, "%s: %s", f.text, e.text);
        f.tape = nevh__tree_tape(tree, names, NEVH__READS_STATE, &e);
        ck_assert_msg(fabs(value(&f, f.state) - judge(&f)) < 1e-14,
                      "%s is %.17g, not %.17g", f.text, value(&f, f.state),
                      judge(&f));
        nevh__tree_free(tree);
        nevh__tape_free(f.tape);
    }
    nevh__names_free(names);
}
#endif

/* nevh tests: formulas drawn at random: what is split and gathered is the same
   function.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "formula_terms.h"
#include <stdio.h>

static char text[4000];
static unsigned loops; /* indices in force: i0, i1, ... */

static void put(const char *piece) {
    ck_assert_uint_lt(strlen(text) + strlen(piece), sizeof text);
    strcat(text, piece);
}

static void put_number(void) {
    static const char *const numbers[] = {"2", "0.5", "m", "k", "w[2]", "3"};
    char index[20];
    if (loops && random_below(2)) {
        snprintf(index, sizeof index, random_below(2) ? "w[i%u]" : "i%u",
                 random_below(loops));
        put(index);
    } else {
        put(numbers[random_below(6)]);
    }
}

static void put_variable(void) {
    static const char *const variables[] = {
        "x", "y", "p_x", "q[2]", "p_y", "d", "p_q[3]", "t", "all", "kinetic"};
    char element[40];
    unsigned i = loops ? random_below(loops) : 0;
    if (!loops || random_below(3) == 0)
        put(variables[random_below(10)]);
    else {
        snprintf(element, sizeof element,
                 random_below(2) ? "%s[i%u]" : "%s[mod(i%u, N) + 1]",
                 random_below(2) ? "q" : "p_q", i);
        put(element);
    }
}

static void put_sum(unsigned depth);

static void put_loop(unsigned depth) {
    char head[80];
    if (loops == 2) {
        put_variable();
        return;
    }
    snprintf(head, sizeof head,
             loops && random_below(2) ? "sum(i%u = i0..N, "
                                      : "sum(i%u = 1..%u, ",
             loops, 1 + random_below(4));
    put(head);
    loops++;
    put_sum(depth);
    loops--;
    put(")");
}

static void put_factor(unsigned depth) {
    static const char *const functions[][2] = {
        {"(", ")"},    {"(", ")"},     {"-(", ")"},          {"sin(", ")"},
        {"cos(", ")"}, {"tanh(", ")"}, {"1/(2 + sin(", "))"}};
    unsigned kind = random_below(depth ? 10 : 4);
    if (kind < 2)
        put_number();
    else if (kind < 4)
        put_variable();
    else if (kind < 6)
        put_loop(depth - 1);
    else {
        unsigned i = random_below(sizeof functions / sizeof *functions);
        put(functions[i][0]);
        put_sum(depth - 1);
        put(functions[i][1]);
    }
}

static void put_product(unsigned depth) {
    unsigned count = 1 + random_below(3);
    for (unsigned i = 0; i < count; i++) {
        if (i)
            put("*");
        put_factor(depth);
    }
    if (random_below(3) == 0)
        put(random_below(2) ? "/m" : "/(2*k)");
    if (random_below(8) == 0)
        put("^1");
}

static void put_sum(unsigned depth) {
    unsigned count = 1 + random_below(3);
    if (random_below(5) == 0)
        put("-");
    for (unsigned i = 0; i < count; i++) {
        if (i)
            put(random_below(2) ? " + " : " - ");
        put_product(depth);
    }
}

TEST_EACH(random_formulas, 10) {
    nevh__names *names = formula_names();
    seed = 100 + (unsigned)_i;
    for (int i = 0; i < 100; i++) {
        text[0] = '\0';
        put_sum(1 + random_below(3));
        compare_with_whole(text, names, FORMULA_DOF);
    }
    ck_assert_int_ge(compared, 60);
    nevh__names_free(names);
}

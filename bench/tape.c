/* nevh: what a formula costs as a tape, against the same written in C.

       bench/tape [commit]

   The double pendulum's H at 64 states, one by one and in blocks, and its
   gradient.  All take turns in every round; printed are medians over the
   rounds, of times and of ratios within a round.  Goals are the project's;
   nothing fails where they are missed.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_private.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 41, STATES = 64, VARIABLES = 4 };
static const double least_time = 0.002; /* seconds of CPU a turn */

typedef struct {
    const nevh__tape *tape;
    double one[STATES][VARIABLES]; /* state by state: q1, q2, p1, p2 */
    double h[STATES], dh_dq[2 * STATES], dh_dp[2 * STATES];
} data;

/* All states, `width` at once. */
typedef void (*work_fn)(data *, size_t width);

typedef struct {
    const char *name;
    work_fn work;
    size_t width;
    size_t yardstick;
    double goal; /* of the ratio; 0: none */
    size_t turns;
    double ns[ROUNDS], ratio[ROUNDS];
} contender;

static double compiled(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    double d = q[0] - q[1], s = sin(d);
    (void)t, (void)c, (void)params;
    return (p[0] * p[0] + 2 * (p[1] * p[1]) - 2 * p[0] * p[1] * cos(d)) /
               (2 * (1 + s * s)) -
           9.8 * (2 * cos(q[0]) + cos(q[1]));
}

/* As a solver would call them. */
static const volatile nevh_term_fn value_in_c = compiled,
                                   value_of_tape = nevh__tape_value;

static void values_in_c(data *d, size_t width) {
    (void)width;
    for (size_t i = 0; i < STATES; i++)
        d->h[i] = value_in_c(0, d->one[i], d->one[i] + 2, NULL, NULL);
}

static void values(data *d, size_t width) {
    (void)width;
    for (size_t i = 0; i < STATES; i++)
        d->h[i] = value_of_tape(0, d->one[i], d->one[i] + 2, NULL, d->tape);
}

/* Copying the states into rows is what a field does, too, and is not timed: a
   block is made of whatever lies there. */
static const double zeros[STATES];

static void blocks(data *d, size_t width) {
    const double *x = d->one[0];
    for (size_t i = 0; i < STATES; i += width)
        nevh__tape_block(width, zeros, x + i * VARIABLES,
                         x + i * VARIABLES + 2 * width, NULL, d->tape,
                         d->h + i);
}

static void gradients(data *d, size_t width) {
    const double *x = d->one[0];
    for (size_t i = 0; i < STATES; i += width)
        nevh__tape_block_gradient(width, zeros, x + i * VARIABLES,
                                  x + i * VARIABLES + 2 * width, NULL, d->tape,
                                  d->dh_dq + 2 * i, d->dh_dp + 2 * i);
}

/* One derivative. */
static void complex_steps(data *d, size_t width) {
    (void)width;
    double x[VARIABLES][2] = {{0, 1e-100}}, h[2];
    for (size_t i = 0; i < STATES; i++) {
        for (size_t k = 0; k < VARIABLES; k++)
            x[k][0] = d->one[i][k];
        nevh__tape_complex(0, (const double(*)[2])x, (const double(*)[2])x + 2,
                           NULL, d->tape, h);
        d->h[i] = h[1];
    }
}

static int apply(nevh__tape_builder *b, nevh__tape_operation of, int x, int y) {
    return nevh__tape_apply(b, of, x, y);
}

static int scaled(nevh__tape_builder *b, double c, int x) {
    return apply(b, NEVH__MULTIPLY, nevh__tape_number(b, c), x);
}

static int kinetic(nevh__tape_builder *b, int d) {
    int p1 = nevh__tape_variable(b, NEVH__P, 0);
    int p2 = nevh__tape_variable(b, NEVH__P, 1), two = nevh__tape_number(b, 2);
    int mixed = apply(b, NEVH__MULTIPLY, scaled(b, 2, p1), p2);
    int sine = apply(b, NEVH__POWER, apply(b, NEVH__SIN, d, d), two);
    int form = apply(b, NEVH__ADD, apply(b, NEVH__POWER, p1, two),
                     scaled(b, 2, apply(b, NEVH__POWER, p2, two)));
    mixed = apply(b, NEVH__MULTIPLY, mixed, apply(b, NEVH__COS, d, d));
    sine = apply(b, NEVH__ADD, nevh__tape_number(b, 1), sine);
    return apply(b, NEVH__DIVIDE, apply(b, NEVH__SUBTRACT, form, mixed),
                 scaled(b, 2, sine));
}

static nevh__tape *double_pendulum(void) {
    nevh__tape_builder *b = nevh__tape_builder_new();
    int q1 = nevh__tape_variable(b, NEVH__Q, 0);
    int q2 = nevh__tape_variable(b, NEVH__Q, 1);
    int heights = apply(b, NEVH__ADD, scaled(b, 2, apply(b, NEVH__COS, q1, q1)),
                        apply(b, NEVH__COS, q2, q2));
    int h =
        apply(b, NEVH__SUBTRACT, kinetic(b, apply(b, NEVH__SUBTRACT, q1, q2)),
              scaled(b, 9.8, heights));
    return nevh__tape_finish(b, h, NULL);
}

static double now(void) {
    return (double)clock() / CLOCKS_PER_SEC;
}

static double time_turn(const contender *c, data *d) {
    double start = now();
    for (size_t i = 0; i < c->turns; i++)
        c->work(d, c->width);
    return now() - start;
}

static void calibrate(contender *c, data *d) {
    for (c->turns = 1; time_turn(c, d) < least_time; c->turns *= 2)
        ;
}

static void play(contender all[], size_t count, data *d) {
    for (size_t i = 0; i < count; i++)
        calibrate(&all[i], d);
    for (size_t round = 0; round < ROUNDS; round++) {
        for (size_t i = 0; i < count; i++)
            all[i].ns[round] =
                1e9 * time_turn(&all[i], d) / (double)(all[i].turns * STATES);
        for (size_t i = 0; i < count; i++)
            all[i].ratio[round] =
                all[i].ns[round] / all[all[i].yardstick].ns[round];
    }
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(const double from[ROUNDS]) {
    double sorted[ROUNDS];
    memcpy(sorted, from, sizeof sorted);
    qsort(sorted, ROUNDS, sizeof *sorted, by_size);
    return sorted[ROUNDS / 2];
}

static void print(const contender all[], size_t count) {
    puts("| double pendulum | width | ns a state | ratio | to | goal |\n"
         "|---|---:|---:|---:|---|---:|");
    for (const contender *c = all; c < all + count; c++) {
        const contender *to = &all[c->yardstick];
        char goal[16] = "";
        if (c->goal > 0)
            snprintf(goal, sizeof goal, "%.1f", c->goal);
        printf("| %s | %zu | %.1f | %.2f | %s, %zu | %s |\n", c->name, c->width,
               median(c->ns), median(c->ratio), to->name, to->width, goal);
    }
}

int main(int argc, char **argv) {
    static data d;
    static contender all[] = {
        {"value in C", values_in_c, 1, 0, 0, 0, {0}, {0}},
        {"value", values, 1, 0, 4, 0, {0}, {0}},
        {"value", blocks, 8, 0, 0, 0, {0}, {0}},
        {"value", blocks, STATES, 0, 0.5, 0, {0}, {0}},
        {"one complex step", complex_steps, 1, 1, 0, 0, {0}, {0}},
        {"gradient", gradients, 8, 2, 2.5, 0, {0}, {0}},
        {"gradient", gradients, STATES, 3, 2.5, 0, {0}, {0}},
    };
    nevh__tape *tape = double_pendulum();
    if (!tape) {
        fputs("out of memory\n", stderr);
        return EXIT_FAILURE;
    }
    d.tape = tape;
    for (size_t i = 0; i < STATES; i++)
        for (size_t k = 0; k < VARIABLES; k++)
            d.one[i][k] = sin((double)(VARIABLES * i + k)) * 3;
    play(all, sizeof all / sizeof *all, &d);
    printf("GCC %s; %s; %zu operations; medians of %d rounds\n\n", __VERSION__,
           argc > 1 ? argv[1] : "unknown", nevh__tape_length(tape), ROUNDS);
    print(all, sizeof all / sizeof *all);
    nevh__tape_free(tape);
    return EXIT_SUCCESS;
}

/* The paper's Figure 5 as a table, and what comes after it.
   H = V(x) + p^2/2; one step of 0.001 by rk4 from x = 1, p = 0 with difference
   gradients of half-spread delta: how far from the step with exact ones?  Look
   at the slopes, the powers of delta, until rounding takes over and grows as
   1/delta; at x^n with n <= order, which is exact; at NEVH's own choice.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient_systems.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double h = 0.001;

/* The L2 norm of the difference; where delta is 0 NEVH chooses it. */
static double error(int n, const nevh_gradient *method, double *delta) {
    double q[] = {1, 1}, p[] = {0, 0};
    nevh_system *system = power_system(&n);
    for (int i = 0; i < 2; i++) {
        nevh_options o = {i ? nevh_exact : method, *delta, .q = q, .p = p};
        nevh_stepper *stepper = nevh_stepper_new(system, nevh_rk4, &o);
        if (nevh_stepper_apply(stepper, 0, h, &q[i], &p[i])) {
            fprintf(stderr, "%s\n", nevh_stepper_message(stepper));
            exit(EXIT_FAILURE);
        }
        if (i == 0)
            *delta = nevh_field_step(nevh_stepper_field(stepper), "all", 0, 0);
        nevh_stepper_free(stepper);
    }
    nevh_system_free(system);
    return hypot(q[0] - q[1], p[0] - p[1]);
}

/* V, the method, and sums for a line through log(error) over log(delta). */
typedef struct {
    int n;
    const nevh_gradient *method;
    double points, x, y, xx, xy;
} column;

static double measure(column *c, double delta) {
    double e = error(c->n, c->method, &delta), x = log(delta), y = log(e);
    if (delta < 0.6 && e > 30 * DBL_EPSILON * h / delta) /* above rounding */
        c->points++, c->x += x, c->y += y, c->xx += x * x, c->xy += x * y;
    return e;
}

static void print_slope(const column *c) {
    if (c->points < 3)
        printf("%9s", "exact");
    else
        printf("%9.2f", (c->points * c->xy - c->x * c->y) /
                            (c->points * c->xx - c->x * c->x));
}

static void table(column *c, int count, double from, double to, double factor) {
    printf("\n V, order");
    for (int i = 0; i < count; i++)
        if (c[i].n)
            printf("   x^%d, %d", c[i].n, nevh_gradient_order(c[i].method));
        else
            printf(" cos x, %d", nevh_gradient_order(c[i].method));
    for (double delta = from; delta > to; delta /= factor) {
        printf("\n %.1e", delta);
        for (int i = 0; i < count; i++)
            printf("%9.1e", measure(&c[i], delta));
    }
    printf("\n slope   ");
    for (int i = 0; i < count; i++)
        print_slope(&c[i]);
    puts("");
}

/* The deltas that NEVH chooses, and what needs none. */
static void own_choice(const column *c, int count) {
    double delta[4] = {0}, none = 0;
    for (int i = 0; i < count; i++)
        printf("%s%9.1e", i ? "" : " by NEVH ",
               error(c[i].n, c[i].method, &delta[i]));
    for (int i = 0; i < count; i++)
        printf("%s%9.1e", i ? "" : "\n  delta  ", delta[i]);
    printf("\n complex step %.1e\n", error(0, nevh_complex_step, &none));
}

int main(void) {
    column powers[] = {
        {.n = 2, .method = nevh_central2}, {.n = 3, .method = nevh_central2},
        {.n = 4, .method = nevh_central2}, {.n = 5, .method = nevh_central2},
        {.n = 4, .method = nevh_central4}, {.n = 5, .method = nevh_central4}};
    column cosine[] = {{.method = nevh_central2},
                       {.method = nevh_central4},
                       {.method = nevh_central6},
                       {.method = nevh_central8}};
    puts("Error of one step of 0.001 that difference gradients make, by delta");
    table(powers, 6, 0.1, 9e-10, sqrt(10));
    table(cosine, 4, 1, 1e-6, 2);
    own_choice(cosine, 4);
    return 0;
}

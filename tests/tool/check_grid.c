/* nevh: tests of the grid of step sizes, and of what errors over them tell.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/study.h"
#include "support.h"
#include <math.h>
#include <stdlib.h>

TEST(steps_double_and_can_be_typed) {
    for (int k = -160; k <= 160; k++) {
        char text[32];
        double dt = grid_dt(1, k), ratio = dt / grid_dt(1, k + 1);
        snprintf(text, sizeof text, "%.4g", dt);
        ck_assert(strtod(text, NULL) == dt);
        ck_assert(ratio > 1.04 && ratio < 1.075);
        if (k % 4 == 0 && (k + 160) % 40 != 36) /* 0.125 to 0.064 */
            ck_assert_double_eq_tol(dt / grid_dt(1, k + GRID_STRIDE), 2, 1e-12);
        ck_assert_double_eq_tol(dt / grid_dt(1, k + 40), 10, 1e-12);
    }
    ck_assert(grid_dt(1, 0) == 1 && grid_dt(1, 28) == 0.2 &&
              grid_dt(1, -12) == 2);
}

TEST(steps_are_the_same_in_every_unit_of_time) {
    for (double unit = 1e-30; unit < 1e30; unit *= 977.3)
        for (int k = -160; k <= 160; k++) {
            char text[32];
            double dt = grid_dt(unit, k);
            ck_assert_double_eq_tol(dt / unit / grid_dt(1, k), 1, 6e-6);
            snprintf(text, sizeof text, "%.6g", dt);
            ck_assert(strtod(text, NULL) == dt);
        }
}

TEST(tolerances_fall_by_decades) {
    for (int k = 0; k <= 170; k++) {
        double ratio = grid_tolerance(k) / grid_tolerance(k + 1);
        ck_assert(ratio > 1.15 && ratio < 1.3);
        ck_assert_double_eq_tol(
            grid_tolerance(k) / grid_tolerance(k + GRID_STRIDE), 10, 1e-12);
    }
    ck_assert(grid_tolerance(24) == 0.01 && grid_tolerance(28) == 0.005);
}

TEST(a_power_is_found_between) {
    const double dt[2] = {0.4, 0.1};
    const double error[2] = {3 * pow(0.4, 6), 3 * pow(0.1, 6)};
    double wanted = grid_between(dt, error, 3 * pow(0.23, 6));
    ck_assert_double_eq_tol(wanted, 0.23, 1e-12);
}

/* Work as 1/dt, errors as dt^4, half a digit of scatter. */
TEST(one_digit_costs_a_root_of_ten) {
    double error[7], work[7];
    for (int i = 0; i < 7; i++) {
        double dt = pow(0.5, i), scatter = i % 2 ? 1.2 : 1 / 1.2;
        error[i] = 1e-2 * pow(dt, 4) * scatter;
        work[i] = 5 / dt;
    }
    ck_assert_double_eq_tol(grid_digit_factor(error, work, 7), pow(10, 0.25),
                            0.02);
    ck_assert(isnan(grid_digit_factor(error, work, 1)));
    error[1] = error[0];
    ck_assert(isnan(grid_digit_factor(error, work, 2)));
}

/* Coarse steps of implicit schemes may cost more than finer ones. */
TEST(the_cheapest_need_not_be_the_coarsest) {
    const double error[] = {1e-1, 1e-3, 1e-5, 1e-7, INFINITY};
    const double work[] = {9, 8, 5, 6, 1};
    ck_assert_uint_eq(grid_cheapest(error, work, 5, 1e-2), 2);
    ck_assert_uint_eq(grid_cheapest(error, work, 5, 1e-6), 3);
    ck_assert_uint_eq(grid_cheapest(error, work, 5, 1e-8), 5);
}

/* nevh tests: coefficients satisfy their conditions, algebraically.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/splitting_private.h"
#include "kernels/tableau_private.h"
#include "support.h"
#include <float.h>
#include <gsl/gsl_integration.h>
#include <math.h>
#include <nevh/extend.h>

enum { MOST_STAGES = 24, MOST_OPERATIONS = 100 };

TEST_RANGE(gauss_nodes_are_gsls, 1, MOST_STAGES) {
    size_t s = (size_t)_i;
    nevh__tableau *g = nevh__gauss_new(s);
    gsl_integration_glfixed_table *table =
        gsl_integration_glfixed_table_alloc(s);
    for (size_t i = 0; i < s; i++) {
        double c, b;
        gsl_integration_glfixed_point(0, 1, i, &c, &b, table);
        ck_assert_double_eq_tol(g->c[i], c, 2 * DBL_EPSILON);
        ck_assert_double_eq_tol(g->b[i], b, 2 * DBL_EPSILON);
    }
    gsl_integration_glfixed_table_free(table);
    nevh__tableau_free(g);
}

/* mu_ij + mu_ji = 1 without any rounding: symplectic; and symmetric in time. */
TEST_RANGE(gauss_is_exactly_symplectic, 1, NEVH__MOST_STAGES + 1) {
    size_t s = (size_t)_i;
    nevh__tableau *g = nevh__gauss_new(s);
    for (size_t i = 0; i < s; i++)
        for (size_t j = 0; j < s; j++) {
            double mu = g->mu_q[j * s + i], mirror = g->mu_q[i * s + j];
            ck_assert(mu + mirror == 1);
            ck_assert(1 - mu == mirror);
            ck_assert(g->mu_q[(s - 1 - j) * s + s - 1 - i] == mirror);
            ck_assert(g->b[i] == g->b[s - 1 - i]);
        }
    nevh__tableau_free(g);
}

/* The contrast: with a_ij rounded as usual the same condition does not hold to
   the last bit, so that the test above can fail. */
TEST(rounded_a_is_not_exactly_symplectic) {
    size_t s = 6;
    nevh__tableau *g = nevh__gauss_new(s);
    int violations = 0;
    for (size_t i = 0; i < s; i++)
        for (size_t j = 0; j < i; j++) {
            double a = g->mu_q[j * s + i] * g->b[j];
            double b = g->mu_q[i * s + j] * g->b[i];
            violations += g->b[i] * a + g->b[j] * b != g->b[i] * g->b[j];
        }
    ck_assert_int_gt(violations, 0);
    nevh__tableau_free(g);
}

/* B(2s), C(s) and D(s), from which order 2s follows [Butcher 1964]. */
TEST_RANGE(gauss_has_order_2s, 1, MOST_STAGES) {
    size_t s = (size_t)_i;
    nevh__tableau *g = nevh__gauss_new(s);
    for (size_t k = 1; k <= 2 * s; k++) {
        double sum = 0;
        for (size_t i = 0; i < s; i++)
            sum += g->b[i] * pow(g->c[i], (double)k - 1);
        ck_assert_double_eq_tol(sum, 1. / (double)k, 1e-15);
    }
    for (size_t k = 1; k <= s; k++)
        for (size_t i = 0; i < s; i++) {
            double rows = 0, columns = 0, c = pow(g->c[i], (double)k);
            for (size_t j = 0; j < s; j++) {
                double power = pow(g->c[j], (double)k - 1);
                rows += g->mu_q[j * s + i] * g->b[j] * power;
                columns += g->b[j] * power * g->mu_q[i * s + j];
            }
            ck_assert_double_eq_tol(rows, c / (double)k, 4e-15);
            ck_assert_double_eq_tol(columns, (1 - c) / (double)k, 4e-15);
        }
    nevh__tableau_free(g);
}

/* Tables of the literature [Jay 1996; Hairer, Lubich, Wanner, II.1.4], row by
   row. */
static void compare_tables(size_t s, const double a[], const double b[]) {
    nevh__tableau *g = nevh__lobatto_new(s);
    for (size_t i = 0; i < s; i++)
        for (size_t j = 0; j < s; j++) {
            ck_assert_double_eq_tol(g->a_q[j * s + i], a[i * s + j],
                                    2 * DBL_EPSILON);
            ck_assert_double_eq_tol(g->a_p[j * s + i], b[i * s + j],
                                    2 * DBL_EPSILON);
        }
    nevh__tableau_free(g);
}

TEST(lobatto_tables) {
    compare_tables(2, (double[]){0, 0, 0.5, 0.5}, (double[]){0.5, 0, 0.5, 0});
    compare_tables(
        3,
        (double[]){0, 0, 0, 5 / 24., 1 / 3., -1 / 24., 1 / 6., 2 / 3., 1 / 6.},
        (double[]){1 / 6., -1 / 6., 0, 1 / 6., 1 / 3., 0, 1 / 6., 5 / 6., 0});
    const double r = sqrt(5), e = 1 / 12., m = 5 / 12.;
    compare_tables(4,
                   (double[]){0, 0, 0, 0, (11 + r) / 120, (25 - r) / 120,
                              (25 - 13 * r) / 120, (r - 1) / 120,
                              (11 - r) / 120, (25 + 13 * r) / 120,
                              (25 + r) / 120, (-1 - r) / 120, e, m, m, e},
                   (double[]){e, (-1 - r) / 24, (r - 1) / 24, 0, e,
                              (25 + r) / 120, (25 - 13 * r) / 120, 0, e,
                              (25 + 13 * r) / 120, (25 - r) / 120, 0, e,
                              (11 - r) / 24, (11 + r) / 24, 0});
}

TEST_RANGE(lobatto_is_exactly_symplectic, 2, NEVH__MOST_STAGES + 1) {
    size_t s = (size_t)_i;
    nevh__tableau *g = nevh__lobatto_new(s);
    for (size_t i = 0; i < s; i++)
        for (size_t j = 0; j < s; j++) {
            double q = g->mu_q[j * s + i], p = g->mu_p[i * s + j];
            size_t across = (s - 1 - j) * s + s - 1 - i;
            ck_assert(q + p == 1 && 1 - q == p && 1 - p == q);
            ck_assert(g->mu_q[across] == p);
            ck_assert(g->mu_p[(s - 1 - i) * s + s - 1 - j] == q);
            ck_assert(fmax(q, p) >= 0.5 && fmax(q, p) <= 2);
            ck_assert(g->b[i] == g->b[s - 1 - i]);
        }
    nevh__tableau_free(g);
}

/* C(k) and D(k) of a matrix: sum_j a_ij c_j^(k-1) = c_i^k / k, and
   sum_i b_i c_i^(k-1) a_ij = b_j (1 - c_j^k) / k. */
static bool has_rows(const nevh__tableau *g, const double mu[], size_t k) {
    bool all = true;
    for (size_t i = 0; i < g->stages; i++) {
        double sum = 0, due = pow(g->c[i], (double)k) / (double)k;
        for (size_t j = 0; j < g->stages; j++)
            sum +=
                mu[j * g->stages + i] * g->b[j] * pow(g->c[j], (double)k - 1);
        all &= fabs(sum - due) < 4e-15;
    }
    return all;
}

static bool has_columns(const nevh__tableau *g, const double mu[], size_t k) {
    bool all = true;
    for (size_t j = 0; j < g->stages; j++) {
        double sum = 0, due = (1 - pow(g->c[j], (double)k)) / (double)k;
        for (size_t i = 0; i < g->stages; i++)
            sum +=
                g->b[i] * pow(g->c[i], (double)k - 1) * mu[j * g->stages + i];
        all &= fabs(sum - due) < 4e-15;
    }
    return all;
}

/* B(2s-2), IIIA: C(s) and D(s-2), IIIB: C(s-2) and D(s), and no more: order
   2s-2 follows. */
TEST_RANGE(lobatto_has_order_2s_less_2, 2, MOST_STAGES) {
    size_t s = (size_t)_i;
    nevh__tableau *g = nevh__lobatto_new(s);
    ck_assert(g->c[0] == 0 && g->c[s - 1] == 1);
    for (size_t k = 1; k < 2 * s; k++) {
        double sum = 0, off;
        for (size_t i = 0; i < s; i++)
            sum += g->b[i] * pow(g->c[i], (double)k - 1);
        off = fabs(sum - 1. / (double)k);
        ck_assert(k < 2 * s - 1 ? off < 1e-15 : off > 1e-13 || s > 8);
    }
    for (size_t k = 1; k <= s; k++) {
        ck_assert(has_rows(g, g->mu_q, k) && has_columns(g, g->mu_p, k));
        ck_assert(has_columns(g, g->mu_q, k) == (k <= s - 2) || s > 8);
        ck_assert(has_rows(g, g->mu_p, k) == (k <= s - 2) || s > 8);
    }
    nevh__tableau_free(g);
}

/* The continued polynomial is exact for polynomials of degree s - 1. */
TEST_RANGE(gauss_guess_extrapolates, 1, MOST_STAGES) {
    size_t s = (size_t)_i;
    nevh__tableau *g = nevh__gauss_new(s);
    for (size_t k = 0; k < s; k++)
        for (size_t i = 0; i < s; i++) {
            double sum = 0, size = 0;
            for (size_t j = 0; j < s; j++) {
                sum += g->guess[j * s + i] * pow(g->c[j], (double)k);
                size += fabs(g->guess[j * s + i]);
            }
            ck_assert_double_eq_tol(sum, pow(1 + g->c[i], (double)k),
                                    1e-15 * size);
        }
    nevh__tableau_free(g);
}

/* What the guess from several steps makes of slopes x at node j, `back` steps
   before the last. */
static double continued(const nevh__tableau *g, size_t i,
                        double (*x)(double back, double node, size_t j),
                        double *size) {
    double sum = 0;
    *size = 0;
    for (size_t j = 0; j < g->steps * g->stages; j++) {
        double weight = g->long_guess[j * g->stages + i];
        size_t node = j % g->stages, back = j / g->stages;
        double one = weight * x((double)back, g->c[node], node);
        sum += one;
        *size += fabs(one);
    }
    return sum;
}

static size_t power, chosen;
static double of_time(double back, double node, size_t j) {
    (void)j;
    return pow((node - back) / 2, (double)power);
}
static double of_one_node(double back, double node, size_t j) {
    (void)node;
    return j == chosen ? pow(back / 8, (double)power) : 0;
}

/* The guess from several steps is exact for polynomials in time, of few stages
   up to a degree that exceeds that of the last step's, and, in methods of few stages, for slopes
   that at each node are a polynomial of their own in the number of the step. */
TEST_RANGE(long_guess_extrapolates, 1, MOST_STAGES) {
    size_t s = (size_t)_i;
    for (int lobatto = s < 2; lobatto < 2; lobatto++) {
        nevh__tableau *g =
            lobatto && s > 1 ? nevh__lobatto_new(s) : nevh__gauss_new(s);
        size_t most = 2 * s - (g->c[0] > 0 ? 1 : 2);
        size_t degree = s > 5 ? s - 1 : s + 2 < most ? s + 2 : most;
        double size;
        ck_assert_uint_eq(g->steps, s == 1 ? 9 : s > 5 ? 1 : 16 / s);
        for (size_t i = 0; i < s; i++) {
            for (power = 0; power <= degree; power++) {
                double sum = continued(g, i, of_time, &size);
                double due = pow((1 + g->c[i]) / 2, (double)power);
                ck_assert_double_eq_tol(sum, due, 1e-15 * size);
            }
            for (power = 0; power + 2 < g->steps; power++)
                for (chosen = 0; chosen < s; chosen++) {
                    double sum = continued(g, i, of_one_node, &size);
                    double due = i == chosen ? pow(-1. / 8, (double)power) : 0;
                    ck_assert_double_eq_tol(sum, due, 1e-15 * size);
                }
        }
        nevh__tableau_free(g);
    }
}

TEST_RANGE(gauss_order_rises, 1, MOST_STAGES) {
    size_t s = (size_t)_i, seen = 0;
    nevh__tableau *g = nevh__gauss_new(s);
    for (size_t m = 0; m < s; m++) {
        seen += g->order[m];
        if (m > 0)
            ck_assert(g->b[g->order[m - 1]] <= g->b[g->order[m]]);
    }
    ck_assert_uint_eq(seen, s * (s - 1) / 2);
    nevh__tableau_free(g);
}

static void check_splitting(const nevh_integrator *scheme) {
    double weights[MOST_OPERATIONS], sums[2] = {0, 0};
    size_t count = nevh__splitting_operations(scheme->table);
    ck_assert_uint_le(count, MOST_OPERATIONS);
    nevh__splitting_expand(scheme->table, weights);
    bool palindrome = count % 2 == 1;
    for (size_t i = 0; i < count; i++) {
        sums[i % 2] += weights[i];
        palindrome &= weights[i] == weights[count - 1 - i];
    }
    double slack = DBL_EPSILON * (double)count;
    ck_assert_double_eq_tol(sums[0], 1, slack);
    ck_assert_double_eq_tol(sums[1], 1, slack);
    ck_assert_int_eq(palindrome, scheme->symmetric == NEVH_YES);
}

/* Runge-Kutta tables: check_trees. */
TEST_EACH(explicit_tables, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (scheme->kernel != &nevh_splitting_kernel)
        skip_test("not a splitting");
    check_splitting(scheme);
}

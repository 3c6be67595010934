/* nevh tests: splittings satisfy their order conditions, algebraically, as
   order_private.h has them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include "kernels/splitting_private.h"
#include "kernels/order_private.h"
#include "support.h"
#include "kernels/tao_private.h"
#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_OPERATIONS = 100, MOST_GIVEN = 32 };

typedef struct {
    nevh_operation first;
    size_t count;
    double weights[MOST_OPERATIONS];
} splitting;

static splitting expanded(const nevh_splitting *table) {
    splitting s = {table->first, nevh__splitting_operations(table), {0}};
    ck_assert_uint_le(s.count, MOST_OPERATIONS);
    nevh__splitting_expand(table, s.weights);
    return s;
}

/* Up to which degree the conditions hold for weights that are rounded; tried up to
   `most`. */
static int order_of(const splitting *x, bool quadratic, int most) {
    nevh__conditions found[NEVH__MOST_DEGREE + 1];
    long double weights[MOST_OPERATIONS];
    for (size_t i = 0; i < x->count; i++)
        weights[i] = x->weights[i];
    ck_assert(
        nevh__words_check(&(nevh__operations){x->first, x->count, weights},
                          quadratic, (size_t)most, DBL_EPSILON, found));
    for (int k = 1; k <= most; k++)
        if (found[k].excess > 1)
            return k - 1;
    return most;
}

/* The table of scheme number i, or NULL if it is no splitting. */
/* Tao composes steps of order 2 as others compose Verlet's: the conditions are
   the same. */
static const nevh_splitting *table_of(int i) {
    const nevh_integrator *scheme = nevh_integrators()[i];
    bool is = scheme->kernel == &nevh_splitting_kernel ||
              scheme->kernel == &nevh__tao_kernel;
    return is ? scheme->table : NULL;
}

static bool needs_quadratic(const nevh_integrator *scheme) {
    return nevh_integrator_needs(scheme) & NEVH_QUADRATIC_KINETIC;
}

/* No less than what is claimed, and no more. */
TEST_EACH(order_conditions, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (!table_of(_i))
        skip_test("not a splitting");
    int order = nevh_integrator_order(scheme);
    splitting x = expanded(table_of(_i));
    int found = order_of(&x, needs_quadratic(scheme), order + 1);
    ck_assert_msg(found == order, "%s: order %d, found %d",
                  nevh_integrator_name(scheme), order, found);
}

/* What falls to a lower order where T is not quadratic, or where kicks and
   drifts are exchanged, must not be taken for what does not. */
TEST_EACH(needs_of_the_conditions, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (!table_of(_i))
        skip_test("not a splitting");
    int order = nevh_integrator_order(scheme), least = order;
    if (needs_quadratic(scheme))
        least = nevh_integrator_symmetric(scheme) == NEVH_YES ? 4 : 3;
    splitting x = expanded(table_of(_i));
    ck_assert_int_eq(order_of(&x, false, order), least);
    x.first = !x.first;
    ck_assert_int_eq(order_of(&x, false, order), least);
    ck_assert_int_eq(order_of(&x, needs_quadratic(scheme), order), least);
}

/* Every number in every table matters. */
TEST_EACH(wrong_weights_are_noticed, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const nevh_splitting *table = table_of(_i);
    if (!table || table->count == 0)
        skip_test("no table of a splitting");
    for (size_t k = 0; k < table->count; k++) {
        long double weights[MOST_GIVEN];
        nevh_splitting wrong = *table;
        ck_assert_uint_le(table->count, MOST_GIVEN);
        memcpy(weights, table->weights, table->count * sizeof *weights);
        weights[k] += 1e-6L;
        wrong.weights = weights;
        splitting x = expanded(&wrong);
        int order = nevh_integrator_order(scheme);
        int found = order_of(&x, needs_quadratic(scheme), order);
        ck_assert_msg(found < order, "%s: weight %zu may be wrong",
                      nevh_integrator_name(scheme), k);
    }
}

static void assert_weights(const nevh_splitting *table, size_t count,
                           const double weights[]) {
    splitting x = expanded(table);
    ck_assert_uint_eq(x.count, count);
    for (size_t i = 0; i < count; i++)
        ck_assert_double_eq(x.weights[i], weights[i]);
}

TEST(patterns) {
    static const long double given[] = {0.125L, 0.5L};
    const nevh_splitting tables[] = {{NEVH_KICK, NEVH_LISTED, 0, NULL},
                                     {NEVH_KICK, NEVH_PALINDROME, 0, NULL},
                                     {NEVH_KICK, NEVH_COMPOSITION, 0, NULL},
                                     {NEVH_KICK, NEVH_LISTED, 2, given},
                                     {NEVH_KICK, NEVH_PALINDROME, 2, given},
                                     {NEVH_KICK, NEVH_COMPOSITION, 1, given}};
    assert_weights(&tables[0], 2, (double[]){1, 1});
    assert_weights(&tables[1], 3, (double[]){0.5, 1, 0.5});
    assert_weights(&tables[2], 3, (double[]){0.5, 1, 0.5});
    assert_weights(&tables[3], 4, (double[]){0.125, 0.5, 0.875, 0.5});
    assert_weights(&tables[4], 7,
                   (double[]){0.125, 0.5, 0.375, 0, 0.375, 0.5, 0.125});
    assert_weights(
        &tables[5], 7,
        (double[]){0.0625, 0.125, 0.4375, 0.75, 0.4375, 0.125, 0.0625});
}

/* What papers give besides, and the tables leave out. */
TEST_EACH(weights_that_follow, 16) {
    static const struct {
        const char *name;
        size_t operation;
        double weight;
    } known[] = {{"ruth3", 4, -1. / 24},
                 {"ruth3", 5, 1},
                 {"mclachlan-atela4", 6, 0.334003603286321425},
                 {"mclachlan-atela4", 7, 0.128846158365384185},
                 {"mclachlan-sb3a4", 3, -1. / 2},
                 {"mclachlan-sb3a4", 4, 2. / 3},
                 {"mclachlan-sb3a5", 5, 1 + 6. / 73 - 34. / 59},
                 {"pefrl", 3, -0.2123418310626054},
                 {"pefrl", 5, -0.2123418310626054},
                 {"blanes-moan4", 5, 0.4343366665664560},
                 {"blanes-moan4", 6, 0.2193769557534997},
                 {"rkn6b", 5, -0.3501716228953511},
                 {"rkn6b", 6, 0.1195241940131507},
                 {"yoshida6", 7, 1.31518632068391122},
                 {"kahan-li8", 17, -0.60550853383003451},
                 {"suzuki-umeno8", 15, -0.79688793935291635}};
    const nevh_integrator *scheme = nevh_integrator_named(known[_i].name);
    splitting x = expanded(scheme->table);
    ck_assert_double_eq_tol(x.weights[known[_i].operation], known[_i].weight,
                            4 * DBL_EPSILON);
}

static double pendulum(double t, const double q[], const double p[],
                       const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2.6 - 1.7 * cos(q[0]);
}

/* Friction between two steps: the next one is what it is with nothing kept of
   the last.  Only a dH/dq that is known not to read p is kept and used. */
TEST_EACH(friction_between_steps, 5) {
    const nevh_integrator *schemes[] = {nevh_verlet, nevh_blanes_moan6,
                                        nevh_verlet, nevh_pefrl, nevh_ruth3};
    const double factor[] = {0.75}, h = 0.125;
    nevh_system *s =
        _i == 2 ? nevh_system_from(1, pendulum, NULL) : driven_pendulum.make();
    nevh_options options = {.gradient_step = 0x1p-9};
    nevh_stepper *damped = nevh_stepper_new(s, schemes[_i], &options);
    nevh_stepper *fresh = nevh_stepper_new(s, schemes[_i], &options);
    double z[] = {0.9, 0.3}, y[2];
    ck_assert_int_eq(nevh_run(damped, 0, h, 20, z, z + 1, NULL, 0), NEVH_OK);
    z[1] *= factor[0];
    memcpy(y, z, sizeof y);
    damped->work.memory[1] = 0x1p-57; /* p's compensation; it may have been 0 */
    fresh->work.memory[0] = damped->work.memory[0];
    fresh->work.memory[1] = damped->work.memory[1] * factor[0];
    uint64_t before = nevh_stepper_counts(damped).gradients;
    nevh_splitting_kernel.apply_friction(&damped->work, factor);
    ck_assert_int_eq(nevh__advance(damped, 20 * h, h, z, z + 1), NEVH_OK);
    ck_assert_int_eq(nevh__advance(fresh, 20 * h, h, y, y + 1), NEVH_OK);
    ck_assert_mem_eq(z, y, sizeof z);
    ck_assert_mem_eq(damped->work.memory, fresh->work.memory,
                     2 * sizeof(double));
    ck_assert_uint_eq(nevh_stepper_counts(damped).gradients - before,
                      nevh_stepper_counts(fresh).gradients - (_i < 2));
    nevh_stepper_free(damped);
    nevh_stepper_free(fresh);
    nevh_system_free(s);
}

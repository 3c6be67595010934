/* nevh tests: Runge-Kutta tables satisfy their order conditions, as order_private.h
   has them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include "kernels/order_private.h"
#include <math.h>
#include <nevh/extend.h>
#include <string.h>

enum { MOST_ORDER = NEVH__MOST_TREE, MOST_STAGES = 12, MOST_ENTRIES = 256 };

static nevh__trees trees;

static void plant(void) {
    nevh__trees_plant(&trees, MOST_ORDER);
}

/* A table with entries that may be changed. */
typedef struct {
    size_t stages;
    long double a[MOST_STAGES][MOST_STAGES], b[MOST_STAGES], c[MOST_STAGES],
        error[MOST_STAGES], coarse[MOST_STAGES];
    bool has_error, has_coarse, last_is_first;
} tableau;

static void copy(size_t stages, const double from[], long double to[]) {
    for (size_t i = 0; from && i < stages; i++)
        to[i] = from[i];
}

static tableau tableau_of(const nevh_butcher *table) {
    tableau x = {.stages = table->stages,
                 .has_error = table->error,
                 .has_coarse = table->coarse,
                 .last_is_first = table->last_is_first};
    ck_assert_uint_le(x.stages, MOST_STAGES);
    for (size_t i = 0; i < x.stages; i++)
        copy(i, table->a + i * x.stages, x.a[i]);
    copy(x.stages, table->b, x.b);
    copy(x.stages, table->c, x.c);
    copy(x.stages, table->error, x.error);
    copy(x.stages, table->coarse, x.coarse);
    return x;
}

/* How far the trees of orders `from` to `to` are off: of a method's weights
   (whole = 1), or of weights that should give 0. */
static long double defect(const tableau *x, const long double weights[],
                          long double whole, int from, int to) {
    static long double phi[NEVH__TREES * MOST_STAGES];
    static long double above[NEVH__TREES * MOST_STAGES];
    long double worst = 0, a[MOST_STAGES * MOST_STAGES] = {0};
    for (size_t i = 0; i < x->stages; i++)
        for (size_t j = 0; j < i; j++)
            a[i * x->stages + j] = x->a[i][j];
    nevh__trees_weigh(&trees, x->stages, a, phi, above);
    for (int t = trees.end[from - 1]; t < trees.end[to]; t++) {
        long double sum = 0;
        for (size_t i = 0; i < x->stages; i++)
            sum += weights[i] * phi[(size_t)t * x->stages + i];
        worst = fmaxl(worst, fabsl(sum * trees.tree[t].density - whole));
    }
    return worst;
}

/* Coefficients are doubles, and those of dop853 cancel. */
static const long double rounding = 2e-13L;
static const long double seen = 1e-6L;

static long double row_defect(const tableau *x) {
    long double worst = 0;
    for (size_t i = 0; i < x->stages; i++) {
        long double sum = -x->c[i];
        for (size_t j = 0; j < i; j++)
            sum += x->a[i][j];
        worst = fmaxl(worst, fabsl(sum));
    }
    return worst;
}

/* The last stage stands at the new state. */
static long double last_defect(const tableau *x) {
    long double worst = 0;
    for (size_t j = 0; x->last_is_first && j < x->stages; j++)
        worst = fmaxl(worst, fabsl(x->a[x->stages - 1][j] - x->b[j]));
    return worst;
}

/* The orders up to which the estimates are blind. */
static int error_order(const nevh_integrator *scheme) {
    return scheme == nevh_dop853 ? 5 : scheme->order - 1;
}
enum { COARSE_ORDER = 3 };

static bool holds(const nevh_integrator *scheme, const tableau *x) {
    long double worst = fmaxl(row_defect(x), last_defect(x));
    worst = fmaxl(worst, defect(x, x->b, 1, 1, scheme->order));
    worst = fmaxl(worst, defect(x, x->error, 0, 1, error_order(scheme)));
    worst = fmaxl(worst, defect(x, x->coarse, 0, 1, COARSE_ORDER));
    return worst <= rounding;
}

/* Scheme i of those with a Butcher table; NULL where there are fewer. */
static const nevh_integrator *scheme_at(int i) {
    for (int k = 0; k < scheme_count(); k++)
        if (nevh_integrators()[k]->kernel == &nevh_runge_kutta_kernel &&
            i-- == 0)
            return nevh_integrators()[k];
    return NULL;
}

static int table_count(void) {
    int count = 0;
    while (scheme_at(count))
        count++;
    return count;
}

TEST(tables_are_found) {
    ck_assert_int_ge(table_count(), 8);
}

/* Sloane's A000081. */
TEST(number_of_trees) {
    static const int known[] = {1, 1, 2, 4, 9, 20, 48, 115, 286};
    plant();
    for (int order = 1; order <= MOST_ORDER; order++)
        ck_assert_int_eq(trees.end[order] - trees.end[order - 1],
                         known[order - 1]);
    ck_assert_int_eq(trees.end[8], 200);
    long double bushy = 1, tall = 1; /* n and n! */
    for (int t = 0; t < trees.end[8]; t++) {
        bushy = fminl(bushy, trees.tree[t].density / trees.tree[t].order);
        tall = fmaxl(tall, trees.tree[t].density);
    }
    ck_assert(bushy == 1 && tall == 40320);
}

TEST_EACH(conditions_hold, table_count()) {
    const nevh_integrator *scheme = scheme_at(_i);
    plant();
    tableau x = tableau_of(scheme->table);
    long double worst = defect(&x, x.b, 1, 1, scheme->order);
    ck_assert_msg(worst <= rounding, "%s: %.2Le", scheme->name, worst);
    ck_assert(row_defect(&x) <= rounding && last_defect(&x) <= rounding / 100);
    ck_assert(holds(scheme, &x));
    int next = scheme->order + 1;
    ck_assert(defect(&x, x.b, 1, next, next) > seen);
}

/* An estimate is blind up to its method's order and no further, and falls with
   the power that is said. */
TEST_EACH(estimates_have_their_orders, table_count()) {
    const nevh_integrator *scheme = scheme_at(_i);
    const nevh_butcher *table = scheme->table;
    plant();
    tableau x = tableau_of(table);
    ck_assert_int_eq(scheme->adaptive, x.has_error);
    if (!x.has_error)
        return;
    int order = error_order(scheme), power = order + 1;
    ck_assert(defect(&x, x.error, 0, 1, order) <= rounding);
    ck_assert(defect(&x, x.error, 0, order + 1, order + 1) > seen);
    if (x.has_coarse) {
        ck_assert(defect(&x, x.coarse, 0, 1, COARSE_ORDER) <= rounding);
        ck_assert(defect(&x, x.coarse, 0, COARSE_ORDER + 1, COARSE_ORDER + 1) >
                  seen);
        power = 2 * power - (COARSE_ORDER + 1);
    }
    ck_assert_int_eq(table->error_power, power);
}

/* Where the entries are that are not 0. */
static int list_entries(tableau *x, long double *entries[]) {
    long double *const rows[] = {x->b, x->c, x->error, x->coarse};
    int count = 0;
    for (size_t i = 0; i < x->stages; i++) {
        for (size_t j = 0; j < i; j++)
            if (x->a[i][j] != 0)
                entries[count++] = &x->a[i][j];
        for (size_t k = 0; k < 4; k++)
            if (rows[k][i] != 0)
                entries[count++] = &rows[k][i];
    }
    return count;
}

/* Every entry counts: a change by a millionth is noticed. */
TEST_EACH(every_entry_counts, table_count()) {
    const nevh_integrator *scheme = scheme_at(_i);
    plant();
    tableau x = tableau_of(scheme->table);
    long double *entries[MOST_ENTRIES];
    int count = list_entries(&x, entries);
    ck_assert_int_ge(count, (int)x.stages);
    for (int i = 0; i < count; i++) {
        long double before = *entries[i];
        *entries[i] = before * (1 + 1e-6L);
        ck_assert_msg(!holds(scheme, &x), "%s: entry %d, %.10Lg", scheme->name,
                      i, before);
        *entries[i] = before;
    }
    ck_assert(holds(scheme, &x));
}

/* Of the a_ij the trees notice it without the row sums. */
TEST_EACH(trees_see_the_matrix, table_count()) {
    const nevh_integrator *scheme = scheme_at(_i);
    plant();
    tableau x = tableau_of(scheme->table);
    size_t stages = x.stages - x.last_is_first;
    for (size_t i = 0; i < stages; i++)
        for (size_t j = 0; j < i; j++) {
            long double before = x.a[i][j];
            x.a[i][j] = before * (1 + 1e-6L);
            if (before != 0)
                ck_assert_msg(defect(&x, x.b, 1, 1, scheme->order) > rounding,
                              "%s: a[%zu][%zu]", scheme->name, i, j);
            x.a[i][j] = before;
        }
}

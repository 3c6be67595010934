/* nevh: what follows from the table of a scheme by algebra.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/splitting_private.h"
#include "kernels/tableau_private.h"
#include "kernels/order_private.h"
#include "kernels/scheme_table_private.h"
#include "system/print_private.h"
#include "system/system_private.h"
#include <fenv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Up to which degree conditions hold. */
static int order_of(const nevh__conditions found[], int most) {
    for (int k = 1; k <= most; k++)
        if (found[k].excess > 1)
            return k - 1;
    return most;
}

static void take_condition(const nevh__conditions *x, int degree,
                           nevh_scheme_facts *to) {
    to->value = x->value;
    to->due = x->due;
    to->needed_for = degree + (to->symmetric && degree % 2);
}

static bool is_palindrome(const nevh__operations *x) {
    for (size_t i = 0; 2 * i < x->count; i++) {
        long double a = x->weights[i], b = x->weights[x->count - 1 - i];
        if (!(fabsl(a - b) <= NEVH__DIGITS * (1 + fabsl(a))))
            return false;
    }
    return x->count % 2 == 1;
}

/* Conditions for a quadratic T are known up to a degree; symmetric methods are of
   even order. */
static int quadratic_order(const nevh__operations *x, bool symmetric,
                           nevh__conditions found[]) {
    if (!nevh__words_check(x, true, NEVH__MOST_RELATED, NEVH__DIGITS, found))
        return -1;
    int order = order_of(found, NEVH__MOST_RELATED);
    return order + (symmetric && order % 2);
}

int nevh__splitting_facts(const nevh__operations *x, nevh_scheme_facts *to) {
    nevh__conditions found[NEVH_MOST_ORDER + 1];
    nevh__conditions related[NEVH_MOST_ORDER + 1];
    bool found_all =
        nevh__words_check(x, false, NEVH_MOST_ORDER, NEVH__DIGITS, found);
    to->symplectic = true;
    to->symmetric = is_palindrome(x);
    to->order = to->any_kinetic = order_of(found, NEVH_MOST_ORDER);
    if (!found_all)
        return NEVH_ENOMEM;
    if (to->order >= 3 && to->order < NEVH__MOST_RELATED) {
        int order = quadratic_order(x, to->symmetric, related);
        if (order < 0)
            return NEVH_ENOMEM;
        if (order > to->order) {
            to->order = order;
            memcpy(found, related, sizeof found);
        }
    }
    int next = to->order + 1;
    if (next > NEVH_MOST_ORDER)
        return NEVH_OK;
    nevh__word_text(found[next].which, x->first, &found[next], to->condition,
                    sizeof to->condition);
    take_condition(&found[next], next, to);
    return NEVH_OK;
}

/* Stages in the opposite order are those of the step back. */
static bool is_symmetric(size_t s, const long double a[],
                         const long double b[]) {
    for (size_t i = 0; i < s; i++)
        for (size_t j = 0; j < s; j++) {
            long double x = a[i * s + j], y = a[(s - 1 - i) * s + s - 1 - j];
            long double size = fabsl(x) + fabsl(y) + fabsl(b[j]);
            if (!(fabsl(x + y - b[j]) <= NEVH__DIGITS * size) ||
                !(fabsl(b[j] - b[s - 1 - j]) <= NEVH__DIGITS * size))
                return false;
        }
    return true;
}

/* J. M. Sanz-Serna, Runge-Kutta schemes for Hamiltonian systems, BIT 28 (1988)
   877-883. */
static bool is_symplectic(size_t s, const long double a[],
                          const long double b[]) {
    for (size_t i = 0; i < s; i++)
        for (size_t j = 0; j <= i; j++) {
            long double x = b[i] * a[i * s + j], y = b[j] * a[j * s + i];
            long double z = b[i] * b[j];
            if (!(fabsl(x + y - z) <=
                  NEVH__DIGITS * (fabsl(x) + fabsl(y) + fabsl(z))))
                return false;
        }
    return true;
}

int nevh__runge_kutta_facts(size_t stages, const long double a[],
                            const long double b[], nevh_scheme_facts *to) {
    nevh__conditions found[NEVH_MOST_ORDER + 1];
    nevh__trees *trees = nevh__array(1, sizeof *trees);
    if (!trees)
        return NEVH_ENOMEM;
    nevh__trees_plant(trees, NEVH_MOST_ORDER);
    bool done = nevh__trees_check(trees, stages, a, b, NEVH_MOST_ORDER,
                                  NEVH__DIGITS, found);
    if (done) {
        to->symmetric = is_symmetric(stages, a, b);
        to->symplectic = is_symplectic(stages, a, b);
        to->order = to->any_kinetic = order_of(found, NEVH_MOST_ORDER);
        int next = to->order + 1;
        if (next <= NEVH_MOST_ORDER) {
            nevh__tree_text(trees, found[next].which, to->condition,
                            sizeof to->condition);
            take_condition(&found[next], next, to);
        }
    }
    free(trees);
    return done ? NEVH_OK : NEVH_ENOMEM;
}

static int facts_of_table(nevh__numbers *x, nevh_scheme_facts *to) {
    if (!x->operations && !x->stages)
        return NEVH_EINVAL;
    if (!x->operations)
        return nevh__runge_kutta_facts(x->stages, x->a, x->b, to);
    nevh__operations all = {x->first, x->operations, x->weights};
    return nevh__splitting_facts(&all, to);
}

int nevh_integrator_facts(const nevh_integrator *scheme,
                          nevh_scheme_facts *to) {
    nevh__numbers x;
    if (!scheme || !to)
        return NEVH_EINVAL;
    *to = (nevh_scheme_facts){.value = NAN, .due = NAN};
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = nevh__numbers_of(scheme, &x);
    if (!status)
        status = facts_of_table(&x, to);
    fesetenv(&own);
    nevh__numbers_free(&x);
    return status;
}

/* "1/6", or the number. */
static void print_due(long double due, char text[], size_t size) {
    long double below = roundl(1 / due);
    if (due > 0 && fabsl(due * below - 1) < 1e-12L)
        snprintf(text, size, below > 1 ? "1/%.0f" : "1", (double)below);
    else
        nevh__print(text, size, "%.9g", (double)due);
}

/* A wrong number breaks a condition of low order; those of higher orders are nearly
   fulfilled by methods that are made for small errors, too. */
static bool is_suspicious(const nevh_scheme_facts *x) {
    enum { LOW = 4 };
    static const long double near = 1e-2L, very_near = 1e-7L;
    long double off = fabsl(x->value - x->due) / fabsl(x->due);
    return off <= (x->needed_for <= LOW ? near : very_near);
}

const char *nevh_scheme_shortfall(const nevh_scheme_facts *x, char text[],
                                  size_t size) {
    char due[40], off[60] = "";
    if (size)
        *text = '\0';
    if (!x || !x->needed_for || !size)
        return text;
    print_due(x->due, due, sizeof due);
    if (is_suspicious(x))
        nevh__print(off, sizeof off, " (off by %.2g: a digit may be wrong)",
                    (double)(x->value - x->due));
    nevh__print(text, size, "%s is %.9g, %s is needed for order %d%s",
                x->condition, (double)x->value, due, x->needed_for, off);
    return text;
}

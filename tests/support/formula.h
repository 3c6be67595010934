/* nevh tests: names for formulas, and formulas made systems.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_FORMULA_H
#define NEVH_TESTS_FORMULA_H

#include "expression/formula_private.h"
#include "support.h"
#include "system/system_private.h"
#include <stdlib.h>
#include <string.h>

/* x, y and q[1..4] are coordinates 0, 1 and 2 to 5. */
enum { FORMULA_DOF = 6 };
static const double formula_m = 1.3, formula_k = 0.7, formula_n = 4,
                    formula_half = 2.5, formula_phi = 0.25,
                    formula_w[] = {2, 3, 5, 7};

static inline void define(nevh__names *names, const char *name,
                          const char *text) {
    nevh__formula_error e;
    nevh__tree *tree = nevh__tree_parse(text, &e);
    ck_assert_msg(tree != NULL, "%s: %s", text, e.text);
    ck_assert_int_eq(nevh__names_add_definition(names, name, tree, &e), 0);
}

static inline nevh__names *formula_names(void) {
    nevh__formula_error e;
    nevh__names *names = nevh__names_new();
    int status = nevh__names_add_parameter(names, "m", 0, &formula_m, &e);
    status |= nevh__names_add_parameter(names, "k", 0, &formula_k, &e);
    status |= nevh__names_add_parameter(names, "N", 0, &formula_n, &e);
    status |= nevh__names_add_parameter(names, "half", 0, &formula_half, &e);
    status |= nevh__names_add_parameter(names, "\xCF\x86\xE2\x82\x81", 0,
                                        &formula_phi, &e);
    status |= nevh__names_add_parameter(names, "w", 4, formula_w, &e);
    status |= nevh__names_add_coordinate(names, "x", 0, 0, &e);
    status |= nevh__names_add_coordinate(names, "y", 0, 1, &e);
    status |= nevh__names_add_coordinate(names, "q", 4, 2, &e);
    ck_assert_int_eq(status, NEVH_OK);
    define(names, "d", "x - y");
    define(names, "mass", "2*m");
    define(names, "kinetic", "p_x^2/(2*m) + p_y^2/(2*m)");
    define(names, "all", "sum(i = 1..N, q[i])");
    define(names, "wrong", "1 + nothing*2");
    define(names, "first", "1 + second");
    define(names, "second", "2*first");
    return names;
}

/* A system and what it borrows. */
typedef struct {
    nevh_system *system;
    nevh__owned owned;
    nevh__formula_error error;
} formula_system;

static inline formula_system system_of(const char *text,
                                       const nevh__names *names, size_t n) {
    formula_system s = {.system = nevh_system_new(n)};
    nevh__tree *tree = nevh__tree_parse(text, &s.error);
    if (tree)
        nevh__tree_add_terms(tree, names, s.system, "H", &s.owned, &s.error);
    nevh__tree_free(tree);
    return s;
}

static inline void system_done(formula_system *s) {
    nevh_system_free(s->system);
    nevh__owned_free(&s->owned);
}

#endif

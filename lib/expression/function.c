/* nevh: the functions that formulas know.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <string.h>

static const struct {
    const char *name;
    nevh__tape_operation operation;
} aliases[] = {
    {"ln", NEVH__LOG},       {"pow", NEVH__POWER},
    {"arcsin", NEVH__ASIN},  {"arccos", NEVH__ACOS},
    {"arctan", NEVH__ATAN},  {"arctan2", NEVH__ATAN2},
    {"arsinh", NEVH__ASINH}, {"arcsinh", NEVH__ASINH},
    {"arcosh", NEVH__ACOSH}, {"arccosh", NEVH__ACOSH},
    {"artanh", NEVH__ATANH}, {"arctanh", NEVH__ATANH},
    {"sgn", NEVH__SIGN},
};

static bool function_is(const char *name, const char *text, size_t bytes) {
    return strlen(name) == bytes && memcmp(name, text, bytes) == 0;
}

nevh__tape_operation nevh__function_named(const char *name, size_t bytes) {
    for (nevh__tape_operation i = NEVH__SIN; i < NEVH__OPERATION_COUNT; i++)
        if (function_is(nevh__operation_name(i), name, bytes))
            return i;
    for (size_t i = 0; i < sizeof aliases / sizeof *aliases; i++)
        if (function_is(aliases[i].name, name, bytes))
            return aliases[i].operation;
    return NEVH__OPERATION_COUNT;
}

const char *nevh__function_usage(nevh__tape_operation operation) {
    const nevh__operation_traits *f = nevh__operation_of(operation);
    return f->usage ? f->usage : f->arity == 2 ? "(x, y)" : "(x)";
}

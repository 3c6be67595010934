/* nevh: what is known of the operations of formulas.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "system/print_private.h"
#include <ctype.h>
#include <stdio.h>
#include <string.h>

// clang-format off
#define ENTRY(kind_, identifier, name_, arity_, value, left, right, ...)       \
    [NEVH__##identifier] = {.kind = NEVH__KIND_##kind_, .name = name_,              \
                            .arity = arity_, __VA_ARGS__},
// clang-format on
static const nevh__operation_traits operations[] = {
    NEVH__OPERATIONS(ENTRY)[NEVH__SINCOS] = {
        .kind = NEVH__KIND_FUNCTION, .name = "sin", .arity = 1}};
#undef ENTRY

const nevh__operation_traits *nevh__operation_of(unsigned operation) {
    return &operations[operation];
}

const char *nevh__operation_name(nevh__tape_operation operation) {
    return operations[operation].name;
}

int nevh__operation_arguments(nevh__tape_operation operation) {
    return operations[operation].arity;
}

bool nevh__operation_is_smooth(unsigned operation) {
    return operations[operation].kind != NEVH__KIND_KINK;
}

bool nevh__operation_is_special(unsigned operation) {
    nevh__operation_kind kind = operations[operation].kind;
    return kind == NEVH__KIND_SPECIAL || kind == NEVH__KIND_GSL;
}

/* The name of an operation as formulas here have it; COUNT: there is none. */
static nevh__tape_operation named(const char *name, size_t bytes) {
    if (bytes == 3 && strncmp(name, "neg", bytes) == 0)
        return NEVH__NEGATE;
    int i = 0;
    while (i < NEVH__OPERATION_COUNT &&
           (strlen(operations[i].name) != bytes ||
            strncmp(operations[i].name, name, bytes) != 0))
        i++;
    return (nevh__tape_operation)i;
}

/* In any locale. */
static double number_of(const char *word, size_t bytes) {
    char text[32];
    snprintf(text, sizeof text, "%.*s", (int)bytes, word);
    return nevh__read_number(text);
}

int nevh__operation_build(const char *formula, const int of[3],
                          const nevh__algebra *x) {
    enum { DEPTH = 8 };
    int stack[DEPTH + 1] = {-1}, used = 0;
    for (size_t bytes; *formula; formula += bytes + (formula[bytes] == ' ')) {
        bytes = strcspn(formula, " ");
        bool letter = bytes == 1 && strchr("aby", *formula);
        bool digit =
            isdigit((unsigned char)*formula) || (bytes > 1 && *formula == '-');
        if (letter)
            stack[++used] = of[*formula == 'y' ? 2 : *formula - 'a'];
        else if (digit)
            stack[++used] = x->number(x->data, number_of(formula, bytes));
        else {
            nevh__tape_operation f = named(formula, bytes);
            if (f == NEVH__OPERATION_COUNT)
                return -1;
            int b = stack[used];
            used -= operations[f].arity - 1;
            stack[used] = x->apply(x->data, f, stack[used], b);
        }
    }
    return stack[used];
}

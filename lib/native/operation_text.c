/* nevh: the text of one operation of a tape is that of the table which the tape
   itself runs on, with names for its arguments.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/operation_text_private.h"
#include "expression/tape_inside_private.h"
#include "expression/tape_operations_private.h"
#include <ctype.h>
#include <string.h>

/* Stringified, not expanded. */
#define TEXTS(kind, identifier, name, arity, value, by_a, by_b, ...)           \
    [NEVH__##identifier] = {#value, #by_a, #by_b},
static const char *const texts[][NEVH__OPERATION_PARTS] = {
    NEVH__OPERATIONS(TEXTS)};
#undef TEXTS
_Static_assert(sizeof texts / sizeof *texts == NEVH__OPERATION_COUNT,
               "each operation");

static bool is(const char *word, size_t length, const char *name) {
    return strlen(name) == length && strncmp(word, name, length) == 0;
}

/* One word of the table; returns where the text goes on. */
static const char *write_word(nevh__writer *w, const char *word, size_t length,
                              const nevh__operation_names *m) {
    const char *after = word + length;
    const char *name = is(word, length, "a")   ? m->a
                       : is(word, length, "b") ? m->b
                       : is(word, length, "y") ? m->y
                       : is(word, length, "g") ? m->g
                                               : NULL;
    if (name)
        nevh__write(w, "%s", name);
    else if (is(word, length, "NEVH__F")) { /* NEVH__F(sin) */
        size_t bytes = strcspn(after, ")") - 1;
        nevh__write(w, "%s%.*s", m->lanes ? m->lanes->call : "own_",
                    (int)bytes, after + 1);
        after += bytes + 2;
    } else if (is(word, length, "NEVH__L") || is(word, length, "NEVH__H")) {
        size_t bytes = strcspn(after, ")") - 1; /* NEVH__L(asinh) */
        nevh__write(w, "%s%.*s", word[length - 1] == 'H' ? "nevh__" : "",
                    (int)bytes, after + 1);
        after += bytes + 2;
    } else if (is(word, length, "NEVH__G"))
        nevh__write(w, "%s * ", m->g);
    else if (is(word, length, "NEVH__TWICE_G"))
        nevh__write(w, "(2 * %s) * ", m->g);
    else if (is(word, length, "NEVH__THRICE_G"))
        nevh__write(w, "(3 * %s) * ", m->g);
    else if (is(word, length, "NEVH__LN10"))
        nevh__write(w, "2.302585092994045684");
    else
        nevh__write(w, "%.*s", (int)length, word);
    return after;
}

static void write_text(nevh__writer *w, const char *text,
                       const nevh__operation_names *m) {
    while (*text) {
        size_t length = 0;
        while (isalnum((unsigned char)text[length]) || text[length] == '_')
            length++;
        if (length && !isdigit((unsigned char)*text))
            text = write_word(w, text, length, m);
        else {
            size_t bytes = length ? length : 1;
            nevh__write(w, "%.*s", (int)bytes, text);
            text += bytes;
        }
    }
}

bool nevh__operation_calls(unsigned operation) {
    return operation != NEVH__SQRT && operation < NEVH__OPERATION_COUNT &&
           strstr(texts[operation][NEVH__OPERATION_VALUE], "NEVH__F(");
}

double nevh__operation_bound(unsigned operation, double a, double b) {
    switch (operation) {
    case NEVH__SIN:
    case NEVH__COS:
    case NEVH__SINCOS:
    case NEVH__TANH:
    case NEVH__SIGN:
        return 1;
    case NEVH__ATAN:
    case NEVH__ATAN2:
        return 4;
    case NEVH__NEGATE:
    case NEVH__ABS:
        return a;
    case NEVH__ADD:
    case NEVH__SUBTRACT:
        return a + b;
    case NEVH__MULTIPLY:
        return a * b;
    case NEVH__SQUARE:
        return a * a;
    case NEVH__CUBE:
        return a * a * a;
    default:
        return INFINITY;
    }
}

void nevh__write_expression(nevh__writer *w, unsigned operation,
                            nevh__operation_part part,
                            const nevh__operation_names *m) {
    write_text(w, texts[operation][part], m);
}

void nevh__write_operation(nevh__writer *w, unsigned operation,
                           nevh__operation_part part, const char *to,
                           const nevh__operation_names *m) {
    const char *text = texts[operation][part];
    nevh__write(w, "    %s %s = ", m->lanes ? m->lanes->type : "double", to);
    if (!m->lanes || !nevh__operation_of(operation)->lanewise) {
        write_text(w, text, m);
        nevh__write(w, ";\n");
        return;
    }
    nevh__operation_names one = {"a_", "b_", "y_", "g_", NULL};
    nevh__write(w, "%s;\n    %s { double a_ = %s[lane], b_ = %s[lane]", m->a,
                m->lanes->each, m->a, m->b);
    if (m->y)
        nevh__write(w, ", y_ = %s[lane]", m->y);
    if (m->g)
        nevh__write(w, ", g_ = %s[lane]", m->g);
    nevh__write(w, "; (void)a_, (void)b_; %s[lane] = ", to);
    write_text(w, text, &one);
    nevh__write(w, "; }\n");
}

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

/* The number of a word in a list that ends with NULL; that of the NULL: none. */
static size_t operation_word(const char *word, size_t length,
                             const char *const list[]) {
    size_t i = 0;
    while (list[i] &&
           (strlen(list[i]) != length || strncmp(word, list[i], length) != 0))
        i++;
    return i;
}

/* A word that stands for another text. */
static bool write_name(nevh__writer *w, const char *word, size_t length,
                       const nevh__operation_names *m) {
    static const char *const list[] = {"a",
                                       "b",
                                       "y",
                                       "g",
                                       "NEVH__G",
                                       "NEVH__TWICE_G",
                                       "NEVH__THRICE_G",
                                       "NEVH__LN10",
                                       NULL};
    const char *const names[] = {m->a, m->b, m->y, m->g};
    static const char *const texts_of_g[] = {"%s * ", "(2 * %s) * ",
                                             "(3 * %s) * "};
    size_t i = operation_word(word, length, list);
    if (!list[i] || (i < 4 && !names[i]))
        return false;
    if (i < 4)
        nevh__write(w, "%s", names[i]);
    else if (i < 7)
        nevh__write(w, texts_of_g[i - 4], m->g);
    else
        nevh__write(w, "2.302585092994045684");
    return true;
}

/* One word of the table; returns where the text goes on. */
static const char *write_word(nevh__writer *w, const char *word, size_t length,
                              const nevh__operation_names *m) {
    /* NEVH__F(sin): elementary; NEVH__H: of the text's own; NEVH__L: of libm */
    static const char *const list[] = {"NEVH__F", "NEVH__H", "NEVH__L", NULL};
    const char *const before[] = {"", "nevh__", ""};
    const char *after = word + length;
    if (write_name(w, word, length, m))
        return after;
    size_t i = operation_word(word, length, list);
    if (!list[i]) {
        nevh__write(w, "%.*s", (int)length, word);
        return after;
    }
    size_t bytes = strcspn(after, ")") - 1;
    nevh__write(w, "%s%.*s",
                i ? before[i] : nevh__elementary_call(w, m->lanes, after + 1),
                (int)bytes, after + 1);
    return after + bytes + 2;
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

/* nevh: the numbers that formulas of parameters stand for.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Appends " (i = 3, j = 4)". */
static void add_indices(char *text, size_t room, const nevh__scope *s) {
    for (size_t k = 0; k < s->depth; k++) {
        size_t used = strlen(text);
        bool last = k + 1 == s->depth;
        snprintf(text + used, room - used, "%s%s = %.0f%s", k ? ", " : " (",
                 s->running[k]->name, s->value[s->running[k]->slot],
                 last ? ")" : "");
    }
}

bool nevh__scope_fail(nevh__scope *s, int status, const nevh__expression *at,
                      const char *format, ...) {
    char text[sizeof s->error->text] = "";
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    add_indices(text, sizeof text, s);
    if (!s->error->status)
        s->error->definition = at->definition;
    return nevh__formula_fail(s->error, status, at->column, at->length, "%s",
                              text);
}

bool nevh__scope_finite(nevh__scope *s, double value,
                        const nevh__expression *at) {
    return isfinite(value) ||
           nevh__scope_fail(s, NEVH_EDOM, at, "this is %s",
                            isnan(value) ? "not a number" : "infinite");
}

bool nevh__expression_integer(nevh__scope *s, const nevh__expression *e,
                              const char *what, long *value) {
    double number = nevh__expression_value(s, e);
    if (s->error->status)
        return false;
    if (!(number == floor(number)))
        return nevh__scope_fail(s, NEVH_EINVAL, e,
                                fabs(number - round(number)) > 1e-9
                                    ? "%s is %.10g, which is not a whole number"
                                    : "%s is %.17g, which is not a whole "
                                      "number: rounding; write floor(... + "
                                      "0.5)",
                                what, number);
    if (fabs(number) > 0x1p53 || fabs(number) >= (double)LONG_MAX)
        return nevh__scope_fail(s, NEVH_EINVAL, e, "%s is %g: too large", what,
                                number);
    *value = (long)number;
    return true;
}

bool nevh__expression_element(nevh__scope *s, const nevh__expression *e,
                              size_t *index) {
    long k = 1;
    *index = e->first;
    if (!e->n)
        return true;
    const nevh__expression *at = e->operands[0].of;
    if (!nevh__expression_integer(s, at, "the index", &k))
        return false;
    if (k < 1 || (unsigned long)k > e->count)
        return nevh__scope_fail(s, NEVH_EINVAL, at,
                                "%s[%ld] does not exist: its indices are "
                                "1..%zu",
                                e->name, k, e->count);
    *index += (size_t)k - 1;
    return true;
}

bool nevh__scope_loop(nevh__scope *s, const nevh__expression *loop,
                      bool (*visit)(void *), void *context) {
    long from, to;
    if (!nevh__expression_integer(s, loop->operands[0].of,
                                  "the beginning of the range", &from) ||
        !nevh__expression_integer(s, loop->operands[1].of,
                                  "the end of the range", &to))
        return false;
    double outer = s->value[loop->slot];
    s->running[s->depth++] = loop;
    bool fine = true;
    for (long k = from; fine && k <= to; k++) {
        s->value[loop->slot] = (double)k;
        fine = s->work++ < NEVH__WORK ||
               nevh__scope_fail(s, NEVH_EINVAL, loop,
                                "there is too much to add up");
        fine = fine && visit(context);
    }
    s->depth--;
    s->value[loop->slot] = outer;
    return fine;
}

typedef struct {
    nevh__scope *scope;
    const nevh__expression *body;
    double sum;
} total;

static bool add_body(void *context) {
    total *sum = context;
    sum->sum += nevh__expression_value(sum->scope, sum->body);
    return !sum->scope->error->status;
}

static double loop_value(nevh__scope *s, const nevh__expression *e) {
    total sum = {s, e->operands[2].of, 0};
    return nevh__scope_loop(s, e, add_body, &sum) ? sum.sum : NAN;
}

static double chain_value(nevh__scope *s, const nevh__expression *e) {
    double value = nevh__expression_value(s, e->operands[0].of);
    for (size_t i = 1; i < e->n; i++) {
        double next = nevh__expression_value(s, e->operands[i].of);
        bool inverse = e->operands[i].inverse;
        if (e->form == NEVH__FORM_SUM)
            value = inverse ? value - next : value + next;
        else
            value = inverse ? value / next : value * next;
    }
    return value;
}

static double apply_value(nevh__scope *s, const nevh__expression *e) {
    double a = nevh__expression_value(s, e->operands[0].of);
    double b = e->n > 1 ? nevh__expression_value(s, e->operands[1].of) : 0;
    return nevh__operation_value(e->operation, a, b);
}

static double element_value(nevh__scope *s, const nevh__expression *e) {
    size_t index;
    return nevh__expression_element(s, e, &index) ? e->values[index] : NAN;
}

double nevh__expression_value(nevh__scope *s, const nevh__expression *e) {
    switch (e->form) {
    case NEVH__FORM_NUMBER:
        return e->number;
    case NEVH__FORM_INDEX:
        return s->value[e->slot];
    case NEVH__FORM_PARAMETER:
        return element_value(s, e);
    case NEVH__FORM_SUM:
    case NEVH__FORM_PRODUCT:
        return chain_value(s, e);
    case NEVH__FORM_APPLY:
        return apply_value(s, e);
    case NEVH__FORM_LOOP:
        return loop_value(s, e);
    case NEVH__FORM_TIME:
    case NEVH__FORM_VARIABLE:
        break;
    }
    return NAN; /* who asks makes sure that nothing is read */
}

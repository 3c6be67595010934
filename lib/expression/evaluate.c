/* nevh: the numbers that formulas of parameters stand for.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include "system/print_private.h"
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Appends " (i = 3, j = 4)". */
static void add_indices(char *text, size_t room, const nevh__scope *s) {
    for (size_t k = 0; k < s->depth; k++) {
        size_t used = strlen(text);
        bool last = k + 1 == s->depth;
        nevh__print(text + used, room - used, "%s%s = %.0f%s", k ? ", " : " (",
                    s->running[k]->name, s->value[s->running[k]->slot],
                    last ? ")" : "");
    }
}

bool nevh__scope_fail(nevh__scope *s, int status, const nevh__expression *at,
                      const char *format, ...) {
    char text[sizeof s->error->text] = "";
    va_list arguments;
    va_start(arguments, format);
    nevh__vprint(text, sizeof text, format, arguments);
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
    if (e->form == NEVH__FORM_NUMBER && e->wide_number.value != number)
        return nevh__scope_fail(s, NEVH_EINVAL, e,
                                "%s is %g as a double and %.17g with more "
                                "digits: write it as a number",
                                what, number, (double)e->wide_number.value);
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

#define real               double
#define EXACT(x)           (x)
#define NAMED(name)        name##_value
#define OPERATION(f, a, b) nevh__operation_value(f, a, b)
#define NUMBER(e)          (e)->number
#define ELEMENT(e, index)  (e)->values[index]
#include "expression/evaluate_text.h"
#undef real
#undef EXACT
#undef NAMED
#undef OPERATION
#undef NUMBER
#undef ELEMENT

/* Numbers that are written are doubles. */
static nevh__rounded evaluate_element(const nevh__expression *e, size_t index) {
    return e->wide_values ? e->wide_values[index]
                          : (nevh__rounded){e->values[index], 0};
}

#define real               nevh__rounded
#define EXACT(x)           ((nevh__rounded){x, 0})
#define NAMED(name)        name##_wide
#define OPERATION(f, a, b) nevh__operation_rounded(f, a, b)
#define NUMBER(e)          (e)->wide_number
#define ELEMENT(e, index)  evaluate_element(e, index)
#include "expression/evaluate_text.h"

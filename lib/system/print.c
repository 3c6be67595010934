/* nevh: numbers as text, the same in every locale.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700
#include "system/print_private.h"
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>

/* The calling thread's locale until it is put back; no memory is taken where the C
   locale is there already. */
typedef struct {
    locale_t mine, before;
} in_c_locale;

static in_c_locale print_enter(void) {
    in_c_locale at = {.mine = newlocale(LC_ALL_MASK, "C", (locale_t)0)};
    at.before = at.mine ? uselocale(at.mine) : (locale_t)0;
    return at;
}

static void print_leave(in_c_locale at) {
    if (!at.mine)
        return;
    uselocale(at.before);
    freelocale(at.mine);
}

int nevh__vprint(char text[], size_t size, const char *format,
                 va_list arguments) {
    in_c_locale at = print_enter();
    int length = vsnprintf(text, size, format, arguments);
    print_leave(at);
    return length;
}

int nevh__print(char text[], size_t size, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = nevh__vprint(text, size, format, arguments);
    va_end(arguments);
    return length;
}

double nevh__read_number(const char *text) {
    in_c_locale at = print_enter();
    double number = strtod(text, NULL);
    print_leave(at);
    return number;
}

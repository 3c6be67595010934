/* nevh: what is wrong with a formula.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include "system/print_private.h"
#include <stdio.h>
#include <string.h>

/* Drops the beginning of a character that was cut. */
static void trim(char *text) {
    char *end = text + strlen(text), *last = end;
    while (last > text && ((unsigned char)last[-1] & 0xC0) == 0x80)
        last--;
    uint32_t code;
    if (last > text && (unsigned char)last[-1] >= 0xC0 &&
        nevh__character(last - 1, &code) == 0)
        last[-1] = '\0';
}

bool nevh__formula_fail(nevh__formula_error *error, int status, size_t column,
                        size_t length, const char *format, ...) {
    if (error->status)
        return false;
    error->status = status;
    error->column = column;
    error->length = length;
    va_list arguments;
    va_start(arguments, format);
    nevh__vprint(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    trim(error->text);
    return false;
}

bool nevh__formula_no_memory(nevh__formula_error *error) {
    return nevh__formula_fail(error, NEVH_ENOMEM, 0, 0, "out of memory");
}

/* nevh: memory.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *nevh__array(size_t count, size_t size) {
    return calloc(count ? count : 1, size);
}

bool nevh__width_fits(size_t n, size_t width) {
    const size_t rows = 1 << 12; /* of n each; no plan has as many */
    return n == 0 || width <= SIZE_MAX / sizeof(double) / rows / n;
}

void *nevh__copy(const void *from, size_t count, size_t size) {
    void *to = nevh__array(count, size);
    if (to && count)
        memcpy(to, from, count * size);
    return to;
}

void *nevh__grow(void *array, size_t count, size_t size) {
    if (count > SIZE_MAX / size)
        return NULL;
    return realloc(array, count * size);
}

char *nevh__text(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    char *text = length < 0 ? NULL : nevh__array((size_t)length + 1, 1);
    if (!text)
        return NULL;
    va_start(arguments, format);
    vsnprintf(text, (size_t)length + 1, format, arguments);
    va_end(arguments);
    return text;
}

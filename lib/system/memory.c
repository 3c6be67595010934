/* nevh: memory.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"
#include "system/print_private.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void *nevh__array(size_t count, size_t size) {
    return calloc(count ? count : 1, size);
}

enum { CACHE_LINE = 64 };

void *nevh__arena_take(nevh__arena *a, size_t count, size_t size) {
    const size_t most = SIZE_MAX / 4;
    void *taken = a->from ? a->from + a->size : NULL;
    size_t bytes = count > most / size ? most : count * size;
    bytes = (bytes + CACHE_LINE - 1) / CACHE_LINE * CACHE_LINE;
    a->size = a->size > most ? a->size : a->size + bytes;
    return taken;
}

void *nevh__arena_new(void (*lay_out)(nevh__arena *, void *data), void *data) {
    nevh__arena a = {NULL, 0};
    lay_out(&a, data);
    char *memory = nevh__array(a.size + CACHE_LINE, 1);
    if (!memory)
        return NULL;
    size_t past = (uintptr_t)memory % CACHE_LINE;
    a = (nevh__arena){memory + (CACHE_LINE - past) % CACHE_LINE, 0};
    lay_out(&a, data);
    return memory;
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
    int length = nevh__vprint(NULL, 0, format, arguments);
    va_end(arguments);
    char *text = length < 0 ? NULL : nevh__array((size_t)length + 1, 1);
    if (!text)
        return NULL;
    va_start(arguments, format);
    nevh__vprint(text, (size_t)length + 1, format, arguments);
    va_end(arguments);
    return text;
}

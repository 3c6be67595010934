/* nevh: memory that runs out.  A library that LD_PRELOAD puts before libc: the
   STARVE_AT-th allocation fails, and all after it where STARVE_ON is set.

   Addresses come from libc itself; while dlsym looks for them, what it asks for
   is taken from a block of our own.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <unistd.h>

static _Alignas(max_align_t) char early[1 << 14];
static size_t used;
static bool looking;
static void *(*real_malloc)(size_t);
static void *(*real_calloc)(size_t, size_t);
static void *(*real_realloc)(void *, size_t);
static void (*real_free)(void *);
static long at, asked;
static bool goes_on;

static bool is_early(const void *memory) {
    const char *place = memory;
    return place >= early && place < early + sizeof early;
}

static void *take_early(size_t size) {
    void *place = early + used;
    used += (size + sizeof(max_align_t)) / sizeof(max_align_t) *
            sizeof(max_align_t);
    if (used > sizeof early)
        abort();
    return place;
}

static void look(void) {
    const char *text = getenv("STARVE_AT");
    looking = true;
    *(void **)&real_malloc = dlsym(RTLD_NEXT, "malloc");
    *(void **)&real_calloc = dlsym(RTLD_NEXT, "calloc");
    *(void **)&real_realloc = dlsym(RTLD_NEXT, "realloc");
    *(void **)&real_free = dlsym(RTLD_NEXT, "free");
    looking = false;
    at = text ? atol(text) : 0;
    goes_on = getenv("STARVE_ON");
    unsetenv("LD_PRELOAD"); /* what is started has all it wants */
}

static bool is_there(void) {
    if (!real_free)
        look();
    asked++;
    if (at == 0 || asked < at || (asked > at && !goes_on))
        return true;
    errno = ENOMEM;
    return false;
}

void *malloc(size_t size) {
    if (looking)
        return take_early(size);
    return is_there() ? real_malloc(size) : NULL;
}

void *calloc(size_t count, size_t size) {
    if (looking)
        return take_early(count * size);
    return is_there() ? real_calloc(count, size) : NULL;
}

void *realloc(void *memory, size_t size) {
    return is_there() ? real_realloc(memory, size) : NULL;
}

void free(void *memory) {
    if (!is_early(memory) && real_free)
        real_free(memory);
}

/* STARVE_COUNT: says on stderr how many there were. */
__attribute__((destructor)) static void count(void) {
    char text[24];
    size_t i = sizeof text;
    text[--i] = '\n';
    for (long rest = asked; rest > 0; rest /= 10)
        text[--i] = (char)('0' + rest % 10);
    if (getenv("STARVE_COUNT") &&
        write(STDERR_FILENO, text + i, sizeof text - i))
        return;
}

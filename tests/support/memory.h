/* nevh tests: memory that is out.

   In one file of a program that is linked with --wrap, so that every request of
   the library's own objects comes through here.  What GSL requests is its own
   affair: it aborts when refused, which is why the library asks for as much
   before it calls GSL.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_MEMORY_H
#define NEVH_TESTS_MEMORY_H

#include "support.h"
#include <stdlib.h>
#include <string.h>

void *__real_malloc(size_t);
void *__real_calloc(size_t, size_t);
void *__real_realloc(void *, size_t);
void *__wrap_malloc(size_t);
void *__wrap_calloc(size_t, size_t);
void *__wrap_realloc(void *, size_t);

/* Requests since `watch`, of which number `refused` gets nothing. */
static bool watching;
static size_t requests, refused;

static inline void watch(size_t refuse) {
    requests = 0;
    refused = refuse;
    watching = true;
}

static inline bool refuse_this(void) {
    return watching && ++requests == refused;
}

void *__wrap_malloc(size_t size) {
    return refuse_this() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size) {
    return refuse_this() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size) {
    return refuse_this() ? NULL : __real_realloc(memory, size);
}

/* What is tried with less and less memory: makes a thing and frees it.
   Returns its status; its message goes to `text`. */
typedef struct {
    const nevh_system *system;
    const nevh_integrator *scheme;
    nevh_options options;
    nevh_stepper *stepper;
} setting;
static char text[400];

/* Refuses the first request, then the second, until all are granted.  Returns
   how many there are. */
static inline size_t starve(int (*attempt)(const setting *), const setting *a) {
    for (size_t k = 1; k < 10000; k++) {
        watch(k);
        int status = attempt(a);
        watching = false;
        if (requests < k) {
            ck_assert_msg(status == NEVH_OK, "%d: %s", status, text);
            return requests;
        }
        ck_assert_msg(status == NEVH_ENOMEM, "%s, request %zu refused: %d, %s",
                      a->scheme ? nevh_integrator_name(a->scheme) : "no scheme",
                      k, status, text);
        ck_assert_str_eq(text, "out of memory");
    }
    ck_abort_msg("no end of requests");
}

#endif

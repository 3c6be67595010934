/* nevh: inside a system.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SYSTEM_PRIVATE_H
#define NEVH_SYSTEM_PRIVATE_H

#include "vector_private.h"
#include <nevh/simd.h>
#include <nevh/system.h>
#include <stdarg.h>
#include <stdint.h>

static inline size_t nevh__padded(size_t width) {
    return (width + NEVH__LANES - 1) / NEVH__LANES * NEVH__LANES;
}

/* The next address at which a vector of eight lies within a cache line. */
static inline double *nevh__aligned(double *from) {
    const uintptr_t line = NEVH__LANES * sizeof *from;
    return from + (line - (uintptr_t)from % line) % line / sizeof *from;
}

/* Between -1 and 1, the same on every run. */
static inline double nevh__random(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-52 - 1;
}

/* A status and its message, part of every object that can fail. */
typedef struct nevh__report {
    int status;
    char text[400];
} nevh__report;

/* Records and returns the status. */
int nevh__fail(nevh__report *, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
int nevh__vfail(nevh__report *, int status, const char *format, va_list);
/* Takes over another object's failure. */
int nevh__fail_as(nevh__report *, const nevh__report *other);
/* The same where memory is out. */
int nevh__no_memory(nevh__report *);
/* Defines nevh_NAME_status and nevh_NAME_message of a nevh_NAME that has a report;
   NULL is one for which there was no memory. */
#define NEVH__REPORTS(name)                                                    \
    int nevh_##name##_status(const nevh_##name *x) {                           \
        return x ? x->report.status : NEVH_ENOMEM;                             \
    }                                                                          \
    const char *nevh_##name##_message(const nevh_##name *x) {                  \
        return x ? x->report.text : "out of memory";                           \
    }

/* True if orbits conserve H: the system is autonomous and has no friction. */
bool nevh__conserves_energy(const nevh_system *);

/* Memory; each returns NULL when it is out or the size overflows.  A request
   for nothing gives memory all the same. */
void *nevh__array(size_t count, size_t size); /* zeroed */
/* True if sizes of blocks of so many lanes do not overflow. */
bool nevh__width_fits(size_t n, size_t width);
void *nevh__copy(const void *from, size_t count, size_t size);
void *nevh__grow(void *array, size_t count, size_t size);
char *nevh__text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Arrays in one piece of memory.  A function lays them out twice: first without
   any, to sum up their sizes.  Each begins on a cache line, and is zeroed. */
typedef struct {
    char *from;  /* NULL: sizes are summed up */
    size_t size; /* in bytes, so far */
} nevh__arena;
void *nevh__arena_take(nevh__arena *, size_t count, size_t size);
/* Returns what is to be freed, or NULL when memory is out. */
void *nevh__arena_new(void (*lay_out)(nevh__arena *, void *data), void *data);

/* Numbers by name; the names are borrowed.  Zeros are an empty one, of which
   the entries are to be freed. */
typedef struct {
    const char *name;
    size_t at;
} nevh__registered;
typedef struct {
    nevh__registered *entries; /* at least half of them without a name */
    size_t capacity, count;    /* capacity: a power of two, or 0 */
} nevh__register;
size_t nevh__register_find(const nevh__register *,
                           const char *name); /* SIZE_MAX */
/* Makes room for one more; false when memory is out. */
bool nevh__register_reserve(nevh__register *);
/* A name that is not there yet, where there is room. */
void nevh__register_put(nevh__register *, const char *name, size_t at);

typedef struct {
    char *name;
    size_t number; /* of the last term that was named after it; 0: none */
    bool on;
    nevh_speed speed;
} nevh__effect;

typedef struct {
    nevh_term decl; /* names, indices and constants are the system's own copies;
                      q and p are never NULL when something is read */
    size_t effect;  /* index into the effects */
} nevh__term_entry;

typedef struct {
    size_t effect;
    double *rates; /* n */
} nevh__friction;

struct nevh_system {
    size_t n;
    nevh__term_entry **terms; /* pointers, so that terms stay where they are */
    size_t n_terms;
    nevh__effect *effects;
    size_t n_effects;
    nevh__register term_names, effect_names;
    nevh__friction *frictions;
    size_t n_frictions;
    unsigned long revision; /* counts changes */
    bool by_lane;           /* of states side by side each has constants of its
                               own: see lib/gradient/field_lanes.c */
    nevh_value_fn whole;    /* of nevh_system_from */
    const void *whole_params;
    const char *const
        *names; /* of coordinates, borrowed; NULL: q[0], q[1] ... */
    nevh__report report;
};

/* The name of variable i of either half in messages: "x", "p_x", or "q[0]".
   returns  text */
enum { NEVH__VARIABLE = 64 };
const char *nevh__variable_name(const nevh_system *, bool momentum, size_t i,
                                char text[NEVH__VARIABLE]);

static inline bool nevh__term_on(const nevh_system *s,
                                 const nevh__term_entry *term) {
    return s->effects[term->effect].on;
}

/* The index of an effect, which is added (on) if new; SIZE_MAX: no memory. */
size_t nevh__effect_index(nevh_system *, const char *name);

/* 1/m of each instance where the term came from nevh_system_add_masses; NULL:
   it did not. */
const double *nevh__term_inverse_masses(const nevh__term_entry *);

/* Values of a term in `width` columns (a multiple of NEVH__LANES) of which
   `used` count; rows of `width` doubles as in nevh_block_fn.  A scalar value
   is called for the used columns only; with `scalar` it is taken even where
   there is a block.  one: nq + np + nc doubles. */
void nevh__term_values(const nevh__term_entry *, bool scalar, size_t width,
                       size_t used, const double t[], const double q[],
                       const double p[], const double c[], double h[],
                       double one[]);

#endif

/* nevh: inside a tape.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TAPE_INSIDE_PRIVATE_H
#define NEVH_TAPE_INSIDE_PRIVATE_H

#include "expression/tape_private.h"
#include "system/system_private.h"

/* False of min, mod and the others that jump, or whose derivative does. */
bool nevh__operation_is_smooth(unsigned operation);
/* True for functions of GSL or nevh: compiled text would have to be linked with
   them, and they have no recurrence for Taylor series. */
bool nevh__operation_is_special(unsigned operation);

/* The kind of an operand: a variable of one kind, the result of an operation, or a
   number. */
enum { NEVH__SLOT = NEVH__VARIABLES, NEVH__NUMBER, NEVH__KINDS };

/* The variables by which something changes. */
enum { NEVH__BY_Q = 1, NEVH__BY_P = 2, NEVH__BY_T = 4 };

/* sin and cos of one argument, both of which the result depends on. */
enum { NEVH__SINCOS = NEVH__OPERATION_COUNT };

typedef struct {
    uint8_t kind, by; /* by: an or of the above */
    bool last;        /* an operation's result that is not used again */
    uint32_t at;
} nevh__tape_operand;

typedef struct {
    nevh__tape_operand a, b; /* b is a where there is one argument */
    uint32_t to, also; /* slots, never that of a or b; also is of cosines */
    uint32_t journal;  /* slots not fresh in all that comes before */
    uint8_t operation;
    bool fresh, also_fresh; /* the slot held nothing before */
} nevh__instruction;

struct nevh__tape {
    nevh__instruction *code; /* one more, for its `journal` */
    size_t length, slots;
    double *numbers; /* each once */
    size_t n_numbers;
    const double *wide; /* each NEVH__LANES times, in whole cache lines */
    double *wide_memory;
    nevh__tape_operand result;
    size_t count[NEVH__VARIABLES];
    bool *read[NEVH__VARIABLES];
    bool analytic;
};

/* Rows of columns side by side: base[kind] + at * pitch[kind] is the row of an
   operand.  Numbers have NEVH__LANES columns, which stand for all. */
typedef struct {
    const double *base[NEVH__KINDS];
    size_t pitch[NEVH__KINDS];
    double *slots; /* base[NEVH__SLOT] */
    size_t columns;
    double *out; /* where the last operation's value goes; NULL: to its slot */
} nevh__rows;

/* At most so many columns at once; scratch in doubles. */
enum { NEVH__TAPE_COLUMNS = 64, NEVH__TAPE_SCRATCH = 2048 };

static inline const double *nevh__rows_at(const nevh__rows *r,
                                          nevh__tape_operand o) {
    return r->base[o.kind] + o.at * r->pitch[o.kind];
}

/* The rows of a block of `width` columns from `from` on. */
nevh__rows nevh__rows_of(const nevh__tape *, size_t width, size_t from,
                         size_t columns, const double t[], const double q[],
                         const double p[], const double c[], double slots[]);
/* Carries out operations.  What was in a slot that is not fresh is written to
   the journal first, row by row, unless it is NULL; returns where it ends. */
double *nevh__rows_run(const nevh__rows *, const nevh__instruction code[],
                       size_t length, double journal[]);

/* Building. */

typedef struct {
    uint8_t kind, operation; /* NEVH__SLOT: an operation */
    int a, b;
    uint64_t bits; /* a number's; a variable's k */
} nevh__tape_node;

struct nevh__tape_builder {
    nevh__tape_node *nodes;
    int used, capacity;
    int *table; /* open addressing; -1 is empty */
    size_t table_size;
    size_t count[NEVH__VARIABLES];
    bool unfolded, failed;
};

/* The node that is such, or -1. */
int nevh__builder_find(const nevh__tape_builder *, const nevh__tape_node *);
/* The same, made if need be; -1 when memory is out. */
int nevh__builder_node(nevh__tape_builder *, nevh__tape_node);
double nevh__tape_node_number(const nevh__tape_node *);

#endif

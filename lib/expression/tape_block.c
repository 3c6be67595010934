/* nevh: a tape for many states side by side.

   Each operation runs over some columns before the next one begins.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "expression/tape_operations_private.h"
#include <string.h>

static double *write_row(double *journal, const double row[], size_t columns) {
    memcpy(journal, row, columns * sizeof *journal);
    return journal + columns;
}

/* Applies an operation to whole vectors; numbers are not advanced. */
#define EACH(row, value)                                                       \
    for (size_t i = 0; i < columns; i += 8) {                                  \
        const double *x = from_a + i * step_a, *z = from_b + i * step_b;       \
        NEVH_LANES(lane, 8) {                                                  \
            double a = x[lane], b = z[lane];                                   \
            (void)b;                                                           \
            (row)[i + lane] = value;                                           \
        }                                                                      \
    }
#define CASE(kind, identifier, name, arity, value, by_a, by_b, ...)            \
    case NEVH__##identifier:                                                   \
        EACH(to, value)                                                        \
        break;

NEVH_SIMD static double *run_operations(const nevh__rows *r,
                                        const nevh__instruction *from,
                                        const nevh__instruction *until,
                                        double *journal) {
    size_t columns = r->columns;
    for (const nevh__instruction *at = from; at < until; at++) {
        const double *from_a = nevh__rows_at(r, at->a);
        const double *from_b = nevh__rows_at(r, at->b);
        size_t step_a = at->a.kind != NEVH__NUMBER;
        size_t step_b = at->b.kind != NEVH__NUMBER;
        bool last = r->out && at + 1 == until;
        double *to = last ? r->out : r->slots + at->to * columns;
        double *also = r->slots + at->also * columns;
        if (journal && !at->fresh)
            journal = write_row(journal, to, columns);
        if (journal && !at->also_fresh)
            journal = write_row(journal, also, columns);
        switch (at->operation) {
            NEVH__OPERATIONS(CASE)
        case NEVH__SINCOS:
            EACH(to, NEVH__F(sin)(a))
            EACH(also, NEVH__F(cos)(a))
        }
    }
    return journal;
}
#undef CASE
#undef EACH

double *nevh__rows_run(const nevh__rows *r, const nevh__instruction code[],
                       size_t length, double journal[]) {
    return run_operations(r, code, code + length, journal);
}

nevh__rows nevh__rows_of(const nevh__tape *tape, size_t width, size_t from,
                         size_t columns, const double t[], const double q[],
                         const double p[], const double c[], double slots[]) {
    /* Zero-length arrays are not standard C. */
    const size_t *count = tape->count;
    return (nevh__rows){
        .base = {count[NEVH__T] ? t + from : slots,
                 count[NEVH__Q] ? q + from : slots,
                 count[NEVH__P] ? p + from : slots,
                 count[NEVH__C] ? c + from : slots, slots, tape->wide},
        .pitch = {width, width, width, width, columns, NEVH__LANES},
        .slots = slots,
        .columns = columns,
    };
}

static void store_result(const nevh__tape *tape, const nevh__rows *r,
                         double h[]) {
    const double *from = nevh__rows_at(r, tape->result);
    if (tape->result.kind != NEVH__NUMBER) {
        memcpy(h, from, r->columns * sizeof *h);
        return;
    }
    for (size_t i = 0; i < r->columns; i++)
        h[i] = from[0];
}

/* True if the last operation gives the result, which then needs no slot. */
static bool is_last(const nevh__tape *tape) {
    return tape->length && tape->result.kind == NEVH__SLOT &&
           tape->code[tape->length - 1].to == tape->result.at;
}

/* As many columns as there is room for. */
static size_t fitting(const nevh__tape *tape, size_t room) {
    size_t columns = NEVH__TAPE_COLUMNS;
    while (columns * tape->slots > room)
        columns /= 2;
    return columns;
}

typedef struct {
    size_t width;
    const double *t, *q, *p, *c;
    const nevh__tape *tape;
    double *h;
} task;

static void run_all(const task *job, double *slots, size_t room) {
    size_t most = fitting(job->tape, room), columns;
    bool last = is_last(job->tape);
    for (size_t from = 0; from < job->width; from += columns) {
        columns = job->width - from < most ? job->width - from : most;
        nevh__rows r = nevh__rows_of(job->tape, job->width, from, columns,
                                     job->t, job->q, job->p, job->c, slots);
        if (last)
            r.out = job->h + from;
        nevh__rows_run(&r, job->tape->code, job->tape->length, NULL);
        if (!last)
            store_result(job->tape, &r, job->h + from);
    }
}

/* Apart, so that most tapes do with little of the stack. */
__attribute__((noinline)) static void run_little(const task *job) {
    _Alignas(64) double slots[NEVH__TAPE_SCRATCH];
    run_all(job, slots, NEVH__TAPE_SCRATCH);
}

__attribute__((noinline)) static void run_most(const task *job) {
    _Alignas(64) double slots[NEVH__TAPE_LIVE * NEVH__LANES];
    run_all(job, slots, NEVH__TAPE_LIVE * NEVH__LANES);
}

void nevh__tape_block(size_t width, const double t[], const double q[],
                      const double p[], const double c[], const void *tape,
                      double h[]) {
    const nevh__tape *of = tape;
    const task job = {width, t, q, p, c, of, h};
    if (of->slots * 2 * NEVH__LANES <= NEVH__TAPE_SCRATCH)
        run_little(&job);
    else
        run_most(&job);
}

void nevh__tape_quantity(const void *tape, size_t width, const double t[],
                         const double q[], const double p[], const double v[],
                         double values[]) {
    nevh__tape_block(width, t, q, p, v, tape, values);
}

/* nevh: a tape for many states side by side.

   Each operation runs over some columns before the next one begins.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "expression/tape_operations_private.h"
#include <string.h>

#define NEVH__F(f) nevh_simd_##f

/* From whole vector to whole vector; numbers stay where they are. */
#define CASE(identifier, value, slope_a, slope_b)                              \
    case NEVH__##identifier:                                                   \
        for (double *h = to; h < end; h += 8, x += step_x, z += step_z)        \
            NEVH_LANES(lane, 8) {                                              \
                double a = x[lane], b = z[lane];                               \
                (void)b;                                                       \
                h[lane] = value;                                               \
            }                                                                  \
        break;
NEVH_SIMD static double *run(const nevh__rows *r, const nevh__instruction *from,
                             const nevh__instruction *until, double *log) {
    for (const nevh__instruction *i = from; i < until; i++) {
        const double *x = nevh__rows_at(r, i->a), *z = nevh__rows_at(r, i->b);
        size_t step_x = i->a.kind == NEVH__NUMBER ? 0 : 8;
        size_t step_z = i->b.kind == NEVH__NUMBER ? 0 : 8;
        double *to = r->slots + i->to * r->columns, *end = to + r->columns;
        if (log && !i->fresh) {
            memcpy(log, to, r->columns * sizeof *log);
            log += r->columns;
        }
        switch (i->operation) { NEVH__FORMULAS(CASE) }
    }
    return log;
}
#undef CASE

double *nevh__rows_run(const nevh__rows *r, const nevh__instruction code[],
                       size_t length, double log[]) {
    return run(r, code, code + length, log);
}

nevh__rows nevh__rows_of(const nevh__tape *tape, size_t width, size_t from,
                         size_t columns, const double t[], const double q[],
                         const double p[], const double c[], double slots[]) {
    /* Of nothing there may be no array. */
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

/* As many columns as there is room for. */
static size_t fitting(const nevh__tape *tape) {
    size_t columns = NEVH__TAPE_COLUMNS;
    while (columns * tape->slots > NEVH__TAPE_SCRATCH)
        columns /= 2;
    return columns;
}

void nevh__tape_block(size_t width, const double t[], const double q[],
                      const double p[], const double c[], const void *tape,
                      double h[]) {
    _Alignas(64) double slots[NEVH__TAPE_SCRATCH];
    size_t most = fitting(tape), columns;
    for (size_t from = 0; from < width; from += columns) {
        columns = width - from < most ? width - from : most;
        nevh__rows r =
            nevh__rows_of(tape, width, from, columns, t, q, p, c, slots);
        nevh__tape const *of = tape;
        nevh__rows_run(&r, of->code, of->length, NULL);
        store_result(of, &r, h + from);
    }
}

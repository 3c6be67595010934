/* nevh: a long run in few rows.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "thinned.h"
#include <math.h>
#include <string.h>

thinned thinned_new(size_t columns) {
    return (thinned){.columns = columns,
                     .part = 1,
                     .row =
                         tool_allocate(THINNED_ROWS * columns, sizeof(double)),
                     .number = tool_allocate(THINNED_ROWS, sizeof(size_t))};
}

static bool is_wanted(const thinned *t, size_t number) {
    static const double golden = 0.618033988749894848;
    double place = (double)number * golden;
    return place - floor(place) < t->part;
}

static void leave_out_half(thinned *t) {
    size_t count = 0;
    t->part /= 2;
    for (size_t i = 0; i < t->count; i++)
        if (is_wanted(t, t->number[i])) {
            memmove(t->row + count * t->columns, t->row + i * t->columns,
                    t->columns * sizeof *t->row);
            t->number[count++] = t->number[i];
        }
    t->count = count;
}

double *thinned_next(thinned *t) {
    size_t number = t->seen++;
    if (t->count == THINNED_ROWS)
        leave_out_half(t);
    if (!is_wanted(t, number))
        return NULL;
    t->number[t->count] = number;
    return t->row + t->count++ * t->columns;
}

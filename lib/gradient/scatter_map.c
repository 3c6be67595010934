/* nevh: where the numbers of a term's block come from, and where they go.

   Many instances write to one variable, each waiting for the one before to be
   stored; so sums are taken variable by variable, in the order in which blocks
   have their numbers.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <nevh/body.h>
#include <stdlib.h>

/* The targets, as they are met first. */
static void list_targets(nevh__scatter_map *x, const size_t index[],
                         size_t uses[]) {
    for (size_t i = 0; i < x->rows * x->count; i++)
        if (uses[index[i]]++ == 0)
            x->target[x->targets++] = index[i];
}

/* Sets where the list of each begins; `uses` becomes the place of the next entry. */
static void begin_lists(nevh__scatter_map *x, size_t uses[]) {
    size_t at = 0;
    for (size_t i = 0; i < x->targets; i++) {
        size_t count = uses[x->target[i]];
        x->begin[i] = uses[x->target[i]] = at;
        at += count;
    }
    x->begin[x->targets] = at;
}

static void list(nevh__scatter_map *x, const size_t index[], size_t uses[],
                 size_t k, size_t i) {
    x->column[uses[index[i * x->rows + k]]++] = k * x->stride + i;
}

static void scatter_map_fill(nevh__scatter_map *x, const size_t index[],
                             size_t uses[], bool in_turn) {
    for (size_t k = 0; k < x->rows; k++)
        for (size_t c = 0; c < x->stride; c++)
            x->source[k * x->stride + c] =
                index[(c < x->count ? c : 0) * x->rows + k];
    for (size_t i = 0; in_turn && i < x->count; i++)
        for (size_t k = 0; k < x->rows; k++)
            list(x, index, uses, k, i);
    for (size_t k = 0; !in_turn && k < x->rows; k++)
        for (size_t i = 0; i < x->count; i++)
            list(x, index, uses, k, i);
}

bool nevh__scatter_map_init(nevh__scatter_map *x, size_t uses[], size_t rows,
                            size_t count, const size_t index[], bool in_turn) {
    *x =
        (nevh__scatter_map){.rows = rows,
                            .count = count,
                            .stride = nevh__padded(count),
                            .contiguous = nevh__contiguous(index, rows, count)};
    x->source = nevh__array(rows * x->stride, sizeof *x->source);
    x->target = nevh__array(rows * count, sizeof *x->target);
    x->begin = nevh__array(rows * count + 1, sizeof *x->begin);
    x->column = nevh__array(rows * count, sizeof *x->column);
    if (!x->source || !x->target || !x->begin || !x->column)
        return false;
    list_targets(x, index, uses);
    begin_lists(x, uses);
    scatter_map_fill(x, index, uses, in_turn);
    for (size_t i = 0; i < x->targets; i++)
        uses[x->target[i]] = 0;
    return true;
}

void nevh__scatter_map_clear(nevh__scatter_map *x) {
    free(x->source);
    free(x->target);
    free(x->begin);
    free(x->column);
    *x = (nevh__scatter_map){0};
}

bool nevh__contiguous(const size_t index[], size_t variables, size_t count) {
    if (variables != 1 && count != 1)
        return false;
    for (size_t i = 0; i < variables * count; i++)
        if (index[i] != index[0] + i)
            return false;
    return variables > 0;
}

/* One lane. */
NEVH_SIMD static void gather_one(const nevh__scatter_map *x,
                                 const double from[], double to[]) {
    const size_t *restrict source = x->source;
    NEVH_LANES(i, x->rows * x->stride) {
        to[i] = from[source[i]];
    }
}

NEVH_SIMD static void gather_lanes(const nevh__scatter_map *x, size_t width,
                                   size_t stride, const double from[],
                                   double to[]) {
    for (size_t k = 0; k < x->rows; k++, to += stride) {
        double *column = to;
        for (size_t i = 0; i < x->count; i++, column += width) {
            const double *row = from + x->source[k * x->stride + i] * width;
            for (size_t lane = 0; lane < width; lane++)
                column[lane] = row[lane];
        }
        for (; column < to + stride; column++)
            *column = *to;
    }
}

void nevh__gather(const nevh__scatter_map *x, size_t width, size_t stride,
                  const double from[], double to[]) {
    if (width == 1)
        gather_one(x, from, to);
    else
        gather_lanes(x, width, stride, from, to);
}

/* The sum of x - x: 0 or NaN. */
NEVH_SIMD static double scatter_map_check(size_t size, const double from[]) {
    double bad[NEVH__LANES], sum = 0;
    NEVH_LANES(i, NEVH__LANES) {
        bad[i] = 0;
    }
    for (size_t at = 0; at < size; at += NEVH__LANES)
        NEVH_LANES(i, NEVH__LANES) {
            bad[i] += from[at + i] - from[at + i];
        }
    for (size_t i = 0; i < NEVH__LANES; i++)
        sum += bad[i];
    return sum;
}

static void scatter_one(const nevh__scatter_map *x, const double from[],
                        double out[]) {
    for (size_t i = 0; i < x->targets; i++) {
        double sum = out[x->target[i]];
        for (size_t at = x->begin[i]; at < x->begin[i + 1]; at++)
            sum += from[x->column[at]];
        out[x->target[i]] = sum;
    }
}

/* Lists name rows of the stride of one lane. */
NEVH_SIMD static void scatter_lanes(const nevh__scatter_map *x, size_t width,
                                    size_t stride, const double from[],
                                    double out[]) {
    for (size_t i = 0; i < x->targets; i++)
        for (size_t at = x->begin[i]; at < x->begin[i + 1]; at++) {
            size_t row = x->column[at] / x->stride;
            size_t instance = x->column[at] % x->stride;
            const double *one = from + row * stride + instance * width;
            double *to = out + x->target[i] * width;
            for (size_t lane = 0; lane < width; lane++)
                to[lane] += one[lane];
        }
}

bool nevh__scatter(const nevh__scatter_map *x, size_t width, size_t stride,
                   const double from[], double out[]) {
    if (width == 1)
        scatter_one(x, from, out);
    else
        scatter_lanes(x, width, stride, from, out);
    return scatter_map_check(x->rows * stride, from) == 0;
}

/* nevh: where the numbers of a term's block come from, and where they go.

   Many instances write to one variable, each waiting for the one before to be
   stored; so sums are taken variable by variable, in the order in which blocks
   have their numbers.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include "system/vector_private.h"
#include <nevh/body.h>
#include <stdlib.h>

static size_t count_targets(size_t n, const size_t uses[]) {
    size_t targets = 0;
    for (size_t v = 0; v < n; v++)
        targets += uses[v] > 0;
    return targets;
}

/* The targets, and where the list of each begins; `uses` becomes the place of
   the next entry. */
static void begin_lists(nevh__wiring *x, size_t n, size_t uses[]) {
    size_t at = 0, target = 0;
    for (size_t v = 0; v < n; v++) {
        size_t count = uses[v];
        if (count == 0)
            continue;
        x->target[target] = v;
        x->begin[target++] = at;
        uses[v] = at;
        at += count;
    }
    x->begin[target] = at;
}

static void fill(nevh__wiring *x, const size_t index[], size_t uses[]) {
    for (size_t k = 0; k < x->rows; k++)
        for (size_t c = 0; c < x->stride; c++) {
            size_t i = c < x->count ? c : 0, v = index[i * x->rows + k];
            x->source[k * x->stride + c] = v;
            if (c < x->count) {
                x->column[uses[v]] = k * x->stride + i;
                x->entry[uses[v]++] = k * x->count + i;
            }
        }
}

bool nevh__wiring_plan(nevh__wiring *x, size_t n, size_t rows, size_t count,
                       const size_t index[]) {
    size_t *uses = nevh__array(n, sizeof *uses);
    if (!uses)
        return false;
    for (size_t i = 0; i < rows * count; i++)
        uses[index[i]]++;
    *x = (nevh__wiring){.rows = rows,
                        .count = count,
                        .stride = nevh__padded(count),
                        .targets = count_targets(n, uses)};
    x->source = nevh__array(rows * x->stride, sizeof *x->source);
    x->target = nevh__array(x->targets, sizeof *x->target);
    x->begin = nevh__array(x->targets + 1, sizeof *x->begin);
    x->entry = nevh__array(rows * count, sizeof *x->entry);
    x->column = nevh__array(rows * count, sizeof *x->column);
    bool all = x->source && x->target && x->begin && x->entry && x->column;
    if (all) {
        begin_lists(x, n, uses);
        fill(x, index, uses);
    }
    free(uses);
    return all;
}

void nevh__wiring_free(nevh__wiring *x) {
    free(x->source);
    free(x->target);
    free(x->begin);
    free(x->entry);
    free(x->column);
    *x = (nevh__wiring){0};
}

NEVH_SIMD static void collect(const nevh__wiring *x, const double from[],
                              double to[]) {
    const size_t *restrict source = x->source;
    NEVH_LANES(i, x->rows * x->stride) {
        to[i] = from[source[i]];
    }
}

void nevh__wiring_collect(const nevh__wiring *x, const double from[],
                          double to[]) {
    collect(x, from, to);
}

/* The sum of x - x: 0 or NaN. */
NEVH_SIMD static double check(size_t size, const double from[]) {
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

bool nevh__wiring_add(const nevh__wiring *x, const double from[],
                      double out[]) {
    const size_t *column = x->column;
    for (size_t i = 0; i < x->targets; i++) {
        double sum = out[x->target[i]];
        for (size_t at = x->begin[i]; at < x->begin[i + 1]; at++)
            sum += from[column[at]];
        out[x->target[i]] = sum;
    }
    return check(x->rows * x->stride, from) == 0;
}

NEVH_SIMD static double add_vectors(const nevh__wiring *x, size_t width,
                                    const double from[], double out[]) {
    nevh__vector bad = {0};
    double sum = 0;
    for (size_t i = 0; i < x->targets; i++)
        for (size_t lane = 0; lane < width; lane += NEVH__IN_VECTOR) {
            nevh__vector *to =
                (nevh__vector *)(out + x->target[i] * width + lane);
            nevh__vector all = *to;
            for (size_t at = x->begin[i]; at < x->begin[i + 1]; at++) {
                nevh__vector one =
                    *(const nevh__vector *)(from + x->entry[at] * width + lane);
                all += one;
                bad += one - one;
            }
            *to = all;
        }
    for (size_t i = 0; i < NEVH__IN_VECTOR; i++)
        sum += ((const double *)&bad)[i];
    return sum;
}

bool nevh__wiring_add_vectors(const nevh__wiring *x, size_t width,
                              const double from[], double out[]) {
    return add_vectors(x, width, from, out) == 0;
}

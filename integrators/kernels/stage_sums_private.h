/* nevh: sums over the stages of an explicit method.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_STAGE_SUMS_PRIVATE_H
#define NEVH_STAGE_SUMS_PRIVATE_H

#include "system/vector_private.h"
#include <nevh/simd.h>

/* The weights that are not 0, and how far the slopes they belong to are from
   those of the first stage. */
typedef struct {
    const double *all; /* as the table has them */
    size_t count;
    double *weights;
    size_t *offsets;
} nevh__sum;

/* Lists the first `count` of the table's weights; none where that is NULL.
   stride    from a stage's slopes to the next one's
   weights, offsets    room for as many */
static inline nevh__sum nevh__sum_of(const double all[], size_t count,
                                     size_t stride, double weights[],
                                     size_t offsets[]) {
    nevh__sum x = {all, 0, weights, offsets};
    for (size_t j = 0; all && j < count; j++)
        if (all[j] != 0) {
            weights[x.count] = all[j];
            offsets[x.count++] = j * stride;
        }
    return x;
}

/* The sums of `rows` (a constant) vectors side by side, in the order of the
   stages; slopes: the first one's. */
NEVH__INLINE void nevh__add_up(const nevh__sum *x, size_t rows,
                               const nevh__number slopes[],
                               nevh__vector sums[]) {
    for (size_t k = 0; k < rows; k++)
        sums[k] = (nevh__vector){0};
    NEVH__KNOWN_COUNT
    for (size_t j = 0; j < x->count; j++) {
        const nevh__number *slope = slopes + x->offsets[j];
        double weight = x->weights[j];
        NEVH_UNROLL
        for (size_t k = 0; k < rows; k++)
            sums[k] += weight * NEVH__VECTOR_AT(slope + k * NEVH__IN_VECTOR);
    }
}

/* The same of numbers. */
NEVH__INLINE void nevh__add_up_two(const nevh__sum *x,
                                   const nevh__number slopes[],
                                   nevh__number sums[2]) {
    nevh__number first = {0}, second = {0};
    NEVH__KNOWN_COUNT
    for (size_t j = 0; j < x->count; j++) {
        const nevh__number *slope = slopes + x->offsets[j];
        first += x->weights[j] * slope[0];
        second += x->weights[j] * slope[1];
    }
    sums[0] = first;
    sums[1] = second;
}

NEVH__INLINE nevh__number nevh__add_up_one(const nevh__sum *x,
                                           const nevh__number slopes[]) {
    nevh__number sum = {0};
    for (size_t j = 0; j < x->count; j++)
        sum += x->weights[j] * slopes[x->offsets[j]];
    return sum;
}

#endif

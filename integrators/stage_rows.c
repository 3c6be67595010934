/* nevh: the stages of one orbit as vectors.

   What is NEVH_SIMD is static: else the choice among its versions would be
   visible outside the library.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "stage_rows_private.h"
#include "system/system_private.h"
#include <math.h>
#include <nevh/body.h>
#include <string.h>

/* One vector of a row: start + (sum_j weights[j * stride] x[j] + carry). */
NEVH__INLINE void combine(size_t stages, size_t stride, const double weights[],
                          const double x[], double start, double carry,
                          double out[]) {
    double sum[NEVH__LANES];
    NEVH_LANES(i, NEVH__LANES) {
        sum[i] = 0;
    }
    for (size_t j = 0; j < stages; j++)
        NEVH_LANES(i, NEVH__LANES) {
            sum[i] += weights[j * stride + i] * x[j];
        }
    NEVH_LANES(i, NEVH__LANES) {
        out[i] = start + (sum[i] + carry);
    }
}

NEVH_SIMD static void combine_eight(size_t count, const double weights[],
                                    const double hb[], const double slopes[],
                                    const double y[], const double carry[],
                                    double points[]) {
    for (size_t k = 0; k < count; k++) {
        double sum[NEVH__LANES];
        NEVH_LANES(i, NEVH__LANES) {
            sum[i] = 0;
        }
        NEVH_UNROLL
        for (size_t j = 0; j < NEVH__LANES; j++) {
            double x = hb[j] * slopes[k * NEVH__LANES + j];
            NEVH_LANES(i, NEVH__LANES) {
                sum[i] += weights[j * NEVH__LANES + i] * x;
            }
        }
        NEVH_LANES(i, NEVH__LANES) {
            points[k * NEVH__LANES + i] = y[k] + (sum[i] + carry[k]);
        }
    }
}

NEVH_SIMD static void combine_any(const nevh__rows *r, const double weights[],
                                  const double hb[], const double slopes[],
                                  const double y[], const double carry[],
                                  double points[]) {
    size_t stages = r->stages, stride = r->stride;
    double x[NEVH__MOST_STAGES];
    for (size_t k = 0; k < r->count; k++, slopes += stages, points += stride) {
        for (size_t j = 0; j < stages; j++)
            x[j] = hb[j] * slopes[j];
        for (size_t i = 0; i < stride; i += NEVH__LANES)
            combine(stages, stride, weights + i, x, y[k], carry[k], points + i);
    }
}

void nevh__rows_combine(const nevh__rows *r, const double weights[],
                        const double hb[], const double slopes[],
                        const double y[], const double carry[],
                        double points[]) {
    if (r->stages == NEVH__LANES)
        combine_eight(r->count, weights, hb, slopes, y, carry, points);
    else
        combine_any(r, weights, hb, slopes, y, carry, points);
}

NEVH_SIMD static void multiply(const nevh__rows *r, const double weights[],
                               const double slopes[], double out[]) {
    size_t stages = r->stages, stride = r->stride;
    for (size_t k = 0; k < r->count; k++, slopes += stages, out += stride)
        for (size_t i = 0; i < stride; i += NEVH__LANES)
            combine(stages, stride, weights + i, slopes, 0, 0, out + i);
}

NEVH_SIMD static void negate(size_t size, double x[]) {
    NEVH_LANES(i, size) {
        x[i] = -x[i];
    }
}

/* sum + lost += h b x, without loss. */
NEVH__INLINE void add(double hb, double slope, double *sum, double *lost) {
    double x = hb * slope, d = x + *lost, next = *sum + d, part = next - *sum;
    *lost = (*sum - (next - part)) + (d - part);
    *lost += fma(hb, slope, -x);
    *sum = next;
}

NEVH_SIMD static void sum_up(const nevh__tableau *a, size_t count, size_t width,
                             const double hb[], const double slopes[],
                             double sum[], double lost[]) {
    for (size_t m = 0; m < a->stages; m++) {
        size_t j = a->order[m];
        const double *x = slopes + j * width;
        for (size_t i = 0; i < count; x += a->stages * width)
            for (size_t lane = 0; lane < width; lane++, i++)
                add(hb[j], x[lane], &sum[i], &lost[i]);
    }
}

void nevh__rows_multiply(const nevh__rows *r, const double weights[],
                         const double slopes[], double out[]) {
    multiply(r, weights, slopes, out);
}

void nevh__rows_negate(const nevh__rows *r, double x[]) {
    negate(r->count * r->stride, x);
}

void nevh__rows_sum(const nevh__tableau *a, size_t count, size_t width,
                    const double hb[], const double slopes[], double sum[],
                    double lost[]) {
    sum_up(a, count, width, hb, slopes, sum, lost);
}

void nevh__rows_close(const nevh__rows *r, size_t count, const double from[],
                      double to[]) {
    for (size_t k = 0; k < count; k++)
        memcpy(to + k * r->stages, from + k * r->stride,
               r->stages * sizeof *to);
}

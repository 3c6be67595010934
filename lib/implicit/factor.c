/* nevh: linear equations, by rows and partial pivoting.

   gsl_linalg_LU_decomp allocates in every call, which a step must not.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "implicit/implicit_private.h"
#include <math.h>
#include <nevh/body.h>

/* y -= factor x */
NEVH_SIMD static void factor_subtract(size_t count, double factor,
                                      const double *x, double *y) {
    for (size_t i = 0; i < count; i++)
        y[i] -= factor * x[i];
}

static size_t find_pivot(size_t rows, const double matrix[], size_t k) {
    size_t at = k;
    for (size_t i = k + 1; i < rows; i++)
        if (fabs(matrix[i * rows + k]) > fabs(matrix[at * rows + k]))
            at = i;
    return at;
}

static void swap_rows(size_t rows, double *x, double *y) {
    for (size_t j = 0; j < rows; j++) {
        double keep = x[j];
        x[j] = y[j];
        y[j] = keep;
    }
}

bool nevh__factor(size_t rows, double matrix[], size_t pivot[]) {
    for (size_t k = 0; k < rows; k++) {
        double *row = matrix + k * rows;
        pivot[k] = find_pivot(rows, matrix, k);
        if (pivot[k] != k)
            swap_rows(rows, row, matrix + pivot[k] * rows);
        if (row[k] == 0 || !isfinite(row[k]))
            return false;
        for (size_t i = k + 1; i < rows; i++) {
            double *below = matrix + i * rows, factor = below[k] / row[k];
            below[k] = factor;
            if (factor != 0)
                factor_subtract(rows - k - 1, factor, row + k + 1,
                                below + k + 1);
        }
    }
    return true;
}

void nevh__solve(size_t rows, const double matrix[], const size_t pivot[],
                 double x[]) {
    for (size_t k = 0; k < rows; k++) {
        double value = x[pivot[k]];
        x[pivot[k]] = x[k];
        for (size_t j = 0; j < k; j++)
            value -= matrix[k * rows + j] * x[j];
        x[k] = value;
    }
    for (size_t k = rows; k-- > 0;) {
        for (size_t j = k + 1; j < rows; j++)
            x[k] -= matrix[k * rows + j] * x[j];
        x[k] /= matrix[k * rows + k];
    }
}

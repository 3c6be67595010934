/* nevh: the matrix of the flow of a quadratic form.

   dz/dt = J (K z + g) has the flow z + D(t) (z, 1) with D(t) = exp(t a) - 1, where
   a is the matrix J (K, g) with a row of zeros for the 1.  D is a Taylor series
   over t / 2^k, and D(2 t) = 2 D(t) + D(t)^2 [C. Moler, C. Van Loan, Nineteen
   dubious ways to compute the exponential of a matrix, twenty-five years later,
   SIAM Rev. 45 (2003) 3-49, method 3], in long double (double in WebAssembly, where
   that is software), with momenta in units in which both halves of K are about as
   large.  Elements are kept in two doubles, since a rounding of D is the same in each
   step, and energies of the form would drift by it.
   Elements below the last digits are left out, as those of chains are.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "form_block_private.h"
#include <string.h>
#include <tgmath.h>

enum { TERMS = 18, MOST_HALVINGS = 200 };

/* product = x y, all m x (m + 1), the row below being 0. */
static void multiply(size_t m, const nevh__extended x[],
                     const nevh__extended y[], nevh__extended product[]) {
    size_t row = m + 1;
    memset(product, 0, m * row * sizeof *product);
    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < m; k++) {
            nevh__extended factor = x[i * row + k];
            for (size_t j = 0; factor != 0 && j <= m; j++)
                product[i * row + j] += factor * y[k * row + j];
        }
}

static nevh__extended norm(size_t m, const nevh__extended x[]) {
    nevh__extended most = 0;
    for (size_t i = 0; i < m; i++) {
        nevh__extended sum = 0;
        for (size_t j = 0; j < m; j++)
            sum += fabs(x[i * (m + 1) + j]);
        most = fmax(most, sum);
    }
    return most;
}

/* exp(t a) - 1 to room; returns it. */
static const nevh__extended *exponential(const nevh__form_block *b, double t,
                                         nevh__extended *room) {
    size_t m = 2 * b->count, size = m * (m + 1);
    nevh__extended *x = room, *sum = x + size, *product = sum + size;
    int halvings = 0;
    nevh__extended length = norm(m, b->a) * fabs(t);
    for (; length > 0.5 && halvings < MOST_HALVINGS; halvings++)
        length /= 2;
    for (size_t i = 0; i < size; i++) {
        x[i] = length <= 0.5 ? ldexp(b->a[i] * t, -halvings) : NAN;
        sum[i] = x[i] / TERMS;
    }
    for (int k = TERMS - 1; k > 0; k--) {
        multiply(m, x, sum, product);
        for (size_t i = 0; i < size; i++)
            sum[i] = (x[i] + product[i]) / k;
    }
    for (; halvings; halvings--) {
        multiply(m, sum, sum, product);
        for (size_t i = 0; i < size; i++)
            sum[i] = 2 * sum[i] + product[i];
    }
    return sum;
}

void nevh__form_block_store(const nevh__form_block *b, double t,
                            nevh__extended *room, double panels[],
                            size_t ends[]) {
    const nevh__extended *d = exponential(b, t, room);
    size_t m = 2 * b->count, rows = nevh__panel_rows(m);
    memset(panels, 0, nevh__panel_size(m) * sizeof *panels);
    for (size_t k = 0; k < 2 * nevh__panel_count(m); k++)
        ends[k] = 0;
    for (size_t i = 0; i < m; i++) {
        const nevh__extended *row = d + i * (m + 1);
        size_t *first = ends + i / rows * 2, *last = first + 1;
        nevh__extended most = 0;
        for (size_t j = 0; j < m; j++)
            most = fmax(most, fabs(row[j]));
        for (size_t j = 0; j <= m; j++) {
            bool counts = j == m ? row[j] != 0 : fabs(row[j]) > most * 0x1p-64;
            int unit = b->units[i] - (j < m ? b->units[j] : 0);
            nevh__extended x = counts ? ldexp(row[j], unit) : 0;
            double *to = panels + nevh__panel_place(m, i, j);
            to[0] = (double)x;
            to[rows] = (double)(x - (double)x);
            *first = counts && (!*last || j < *first) ? j : *first;
            *last = counts && j + 1 > *last ? j + 1 : *last;
        }
    }
}

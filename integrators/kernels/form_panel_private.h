/* nevh: products of the matrices of a quadratic form's flow with a state.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FORM_PANEL_PRIVATE_H
#define NEVH_FORM_PANEL_PRIVATE_H

#include <stddef.h>

/* Rows of a matrix of m rows and m + 1 columns stand in panels of NEVH__PANEL, the last
   of them filled with zeros; small matrices are one panel of their own rows.  A panel of
   r rows has, for each column, r elements and then what they lack as doubles. */
enum { NEVH__PANEL = 8 };

static inline size_t nevh__panel_rows(size_t m) {
    return m < NEVH__PANEL ? m : NEVH__PANEL;
}

static inline size_t nevh__panel_count(size_t m) {
    return m < NEVH__PANEL ? 1 : (m + NEVH__PANEL - 1) / NEVH__PANEL;
}

/* The place of an element; what it lacks stands nevh__panel_rows later. */
static inline size_t nevh__panel_place(size_t m, size_t row, size_t column) {
    size_t rows = nevh__panel_rows(m);
    return 2 * rows * (row / rows * (m + 1) + column) + row % rows;
}

static inline size_t nevh__panel_size(size_t m) {
    return 2 * nevh__panel_rows(m) * nevh__panel_count(m) * (m + 1);
}

/* sum[i] = sum of (row i, column j) z[j] over the columns ends[2 k] <= j < ends[2 k + 1]
   of panel k; there are whole panels.  Each element's products are added by rising
   columns, so that all versions give the same bits. */
typedef void nevh__panels_fn(size_t m, const double panels[],
                             const size_t ends[], const double z[],
                             double sum[]);
/* The version for this processor with vectors of at most `side` numbers, of 2, 4 or 8. */
nevh__panels_fn *nevh__panels_choose(size_t side);

#endif

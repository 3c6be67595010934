/* nevh: a block of the flow of a quadratic form.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FORM_BLOCK_PRIVATE_H
#define NEVH_FORM_BLOCK_PRIVATE_H

#include "form_panel_private.h"
#include "kepler_flow_private.h"

/* Some coordinates and their momenta: m = 2 count variables. */
typedef struct {
    size_t count;
    const size_t *index; /* coordinates of the system */
    nevh__extended *a;   /* m x (m + 1), by rows: dz/dt = a (z, 1) */
    int *units;          /* m: powers of two */
    size_t panels, ends; /* where those of its matrix begin in a set */
    double k;            /* of -k/|q| */
} nevh__form_block;

/* D = exp(t a) - 1 as panels, without what is below the last digits of its row.
   room     three matrices
   ends     out: columns of each panel that are not 0, as nevh__panels_fn reads them */
void nevh__form_block_store(const nevh__form_block *, double t,
                            nevh__extended *room, double panels[],
                            size_t ends[]);

#endif

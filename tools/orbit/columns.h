/* nevh: what plots show of a state, by name.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_COLUMNS_H
#define NEVH_COLUMNS_H

#include "experiment/plan.h"

/* t, coordinates, momenta (p_NAME), observables, energy, energy_error: (H - H0)
   over the scale of the energy, and shadow_error: the same of the modified H of
   the scheme. */
typedef enum {
    COLUMN_TIME,
    COLUMN_COORDINATE,
    COLUMN_MOMENTUM,
    COLUMN_OBSERVABLE,
    COLUMN_ENERGY,
    COLUMN_ENERGY_ERROR,
    COLUMN_SHADOW_ERROR
} column_kind;
typedef struct {
    column_kind kind;
    size_t index;
    char *name;
} quantity;

typedef struct {
    const plan *plan;
    quantity *item;
    size_t count;
    double *observed;
    nevh_field *field;   /* of values of H */
    double start, scale; /* of the energy; scale: of errors alone */
    nevh_shadow *shadow; /* of the scheme followed; NULL: none is shown */
    double shadow_start;
} quantities;

quantities columns_new(const plan *); /* of no columns */
void columns_free(quantities *);
/* returns  TOOL_OK, or TOOL_USAGE with the message printed */
int columns_add(quantities *, const char *name);
/* Before a run of that scheme, with the plan's first dt: shadow_error is of that.
   returns  the status; the message is that of the shadow */
int columns_follow(quantities *, const char *integrator, double dt);
/* Computes the values; those that are not finite become NAN. */
void columns_values(quantities *, double t, const double q[], const double p[],
                    double values[]);
/* The axis: name and unit. */
char *column_label(const plan *, const quantity *);

#endif

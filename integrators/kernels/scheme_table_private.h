/* nevh: the numbers of schemes that follow from tables.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SCHEME_TABLE_PRIVATE_H
#define NEVH_SCHEME_TABLE_PRIVATE_H

#include "kernels/order_private.h"

/* The relative accuracy of numbers in a table: some units in the last place of
   papers' fifteen digits. */
#define NEVH__DIGITS 4e-15

/* A table in long double: operations of a splitting, or coefficients; the counts of
   what it is not are 0. */
typedef struct {
    nevh_operation first;
    size_t operations, stages;
    long double *weights; /* operations */
    long double *a, *b;   /* stages x stages, stages */
} nevh__numbers;
/* returns  NEVH_OK; NEVH_EINVAL for other families; NEVH_ENOMEM.  To be freed in
            each case */
int nevh__numbers_of(const nevh_integrator *, nevh__numbers *);
void nevh__numbers_free(nevh__numbers *);

int nevh__splitting_facts(const nevh__operations *, nevh_scheme_facts *);
int nevh__runge_kutta_facts(size_t stages, const long double a[],
                            const long double b[], nevh_scheme_facts *);

#endif

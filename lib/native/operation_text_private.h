/* nevh: the text of one operation of a tape, and of its derivatives.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_OPERATION_TEXT_PRIVATE_H
#define NEVH_OPERATION_TEXT_PRIVATE_H

#include "native/writer_private.h"

/* Names that an operation is called with: of its arguments, of its result and of
   the result's adjoint, which values do without. */
typedef struct {
    const char *a, *b, *y, *g;
    const nevh__lane_words *lanes; /* as in nevh__formula_text */
} nevh__operation_names;

typedef enum {
    NEVH__OPERATION_VALUE,
    NEVH__OPERATION_BY_A, /* times the adjoint */
    NEVH__OPERATION_BY_B,
    NEVH__OPERATION_PARTS
} nevh__operation_part;

/* True if its value is that of a function of vectors, which is called. */
bool nevh__operation_calls(unsigned operation);
/* A bound of the size of a result whose arguments have sizes up to a and b. */
double nevh__operation_bound(unsigned operation, double a, double b);
/* The expression alone. */
void nevh__write_expression(nevh__writer *, unsigned operation,
                            nevh__operation_part,
                            const nevh__operation_names *);
/* The declaration of a number, or of a vector: to = expression;
   Where the operation takes no vectors, one lane follows another. */
void nevh__write_operation(nevh__writer *, unsigned operation,
                           nevh__operation_part, const char *to,
                           const nevh__operation_names *);

#endif

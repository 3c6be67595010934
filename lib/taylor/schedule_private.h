/* nevh: the operations of a recurrence, before they are put in order.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SCHEDULE_PRIVATE_H
#define NEVH_SCHEDULE_PRIVATE_H

#include "taylor/series_private.h"

/* An operation, or a variable or number; operands are such items. */
typedef struct {
    int kind; /* nevh__batch_kind, or of what has no operation: */
    uint8_t arity, function;
    int operand[NEVH__MOST_SUMMANDS];
    int slope;
    nevh__wide number[NEVH__MOST_SUMMANDS];
    int level, tag, rank;
    uint32_t value;
} nevh__work_item;
enum { NEVH__ITEM_VARIABLE = -2, NEVH__ITEM_NUMBER = -1 };

typedef struct {
    int leaf;
    nevh__wide factor;
} nevh__summand_item;

typedef struct {
    const nevh__graph *g;
    size_t n;
    int *uses; /* by node: of live ones, and by what is no sum */
    int *apart;
    int *item_of; /* by node; -1: none */
    nevh__work_item *items;
    size_t count, capacity;
    nevh__summand_item *sum;
    size_t summands, sum_capacity;
    int *stack;
    nevh__wide *factors; /* of what is on the stack */
    size_t depth, stack_capacity;
    bool failed;
} nevh__scheduler;

/* The node of which another is a multiple. */
int nevh__schedule_peel(const nevh__graph *, int node, nevh__wide *factor);
/* Items of all that slopes and edges need.  `failed` where memory is out; arrays are
   the caller's to free. */
void nevh__schedule_items(nevh__scheduler *, const int slope[]);

#endif

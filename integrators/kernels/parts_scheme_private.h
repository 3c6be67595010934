/* nevh: the operations of a step by parts, in the order in which they are done; for
   compiled steps, too.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PARTS_SCHEME_PRIVATE_H
#define NEVH_PARTS_SCHEME_PRIVATE_H

#include <stddef.h>

/* Kicks of B, of inner terms, flows. */
typedef enum { NEVH__OUTER_KICK, NEVH__INNER_KICK, NEVH__FLOW } nevh__part_kind;
enum { NEVH__KICKS = NEVH__FLOW };

typedef struct {
    double weight, time; /* parts of a step */
    nevh__part_kind kind;
    size_t which; /* the part of a step that a flow takes */
} nevh__part_operation;

struct nevh__turns;
typedef struct {
    size_t count;
    nevh__part_operation *operations;
    size_t kept; /* slopes that the next step begins with */
    struct nevh__form_flow *flow;
    /* nevh__form_flow_set and _add */
    void (*set)(struct nevh__form_flow *, double h);
    void (*add)(const struct nevh__form_flow *, size_t which, size_t width,
                const double q[], const double p[], double dq[], double dp[]);
    /* nevh__form_flow_lessen, of outer kicks; NULL: slopes are those of B */
    void (*lessen)(const struct nevh__form_flow *, size_t width,
                   const double q[], double dh_dq[]);
    /* nevh__turns_add, of outer kicks; NULL: B reads no momenta */
    void (*turn)(const struct nevh__turns *, size_t width, double h,
                 const double q[], const double p[], const double slope_q[],
                 const double slope_p[], double dq[], double dp[]);
    struct nevh__turns *turns;
} nevh__parts_scheme;

#endif

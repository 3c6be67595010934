/* nevh: bodies that move about one another.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_HIERARCHY_PRIVATE_H
#define NEVH_HIERARCHY_PRIVATE_H

#include "gradient/field_private.h"

/* Bodies that attract or repel one another by -k/|a - b|, as a hierarchy of pairs: in
   Jacobi coordinates, each group moves about another one as about a centre, and the
   centre of mass of all moves freely.  This motion is A; B has what the
   attractions differ from it. */
typedef struct nevh__hierarchy nevh__hierarchy;
enum { NEVH__MOST_BODIES = 64 };

/* The hierarchy of the bodies of a field, from the shortest period at a state.
   inverse_mass  of each coordinate that A moves freely, else 0
   q, p          the state, rows of width; q: NULL for no hierarchy, p: for zeros
   found         out: NULL where there are no such bodies; or, unless effects are to be
                 fast, where their attractions differ from such motion by more than
                 half, or a group comes near the centre of mass of another one
   why           out: why attractions stay in B; NULL: they do not, or there are none
   returns       NEVH_OK; NEVH_ESTRUCT where effects are to be fast and there are none;
                 NEVH_ENOMEM
   cost          of n bodies n^3 operations and 20 n^2 values of H */
int nevh__hierarchy_new(const nevh_field *, const double inverse_mass[],
                        const double q[], const double p[], size_t width,
                        nevh__hierarchy **found, const char **why);
void nevh__hierarchy_free(nevh__hierarchy *); /* NULL is allowed */
/* True if it moves a coordinate. */
bool nevh__hierarchy_moves(const nevh__hierarchy *, size_t coordinate);
/* As nevh_stepper_body. */
size_t nevh__hierarchy_body(const nevh__hierarchy *, size_t coordinate);
/* Adds to dq, dp what the flow over t adds to the states q, p, n x width each. */
void nevh__hierarchy_add(const nevh__hierarchy *, double t, size_t width,
                         const double q[], const double p[], double dq[],
                         double dp[]);
/* Takes the slopes of the motion about one another from a gradient. */
void nevh__hierarchy_lessen(const nevh__hierarchy *, size_t width,
                            const double q[], double dh_dq[]);
/* True if there is nothing else in H. */
bool nevh__hierarchy_is_whole(const nevh__hierarchy *);
/* As nevh_stepper_hierarchy. */
size_t nevh__hierarchy_words(const nevh__hierarchy *, const nevh_system *,
                             char *text, size_t size);

#endif

/* nevh: the kernel of steps by parts, H = A + B, and the flow of A.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FORM_FLOW_PRIVATE_H
#define NEVH_FORM_FLOW_PRIVATE_H

#include <nevh/extend.h>

/* The table is a nevh_splitting: its drifts are flows of A, its kicks those of
   B = V(t, q).  With inner terms in A a flow is substeps of Verlet's, of their
   kicks and flows of the others: a table that begins with a kick. */
extern const nevh_kernel nevh__parts_kernel, nevh__substeps_kernel;

/* A symmetric scheme by parts of that order, from the weights that a palindrome is
   given by. */
#define NEVH__BY_PARTS(id, order_, stages_, given, weights, aliases_, source_) \
    static const nevh_splitting id##_table = {NEVH_DRIFT, NEVH_PALINDROME,     \
                                              given, weights};                 \
    const nevh_integrator nevh__##id##_entry = {                               \
        .name = #id,                                                           \
        .aliases = aliases_,                                                   \
        .source = source_,                                                     \
        .order = order_,                                                       \
        .stages = stages_,                                                     \
        .gradients = stages_,                                                  \
        .symplectic = NEVH_YES,                                                \
        .symmetric = NEVH_YES,                                                 \
        .explicit_form = NEVH_YES,                                             \
        .preserves_energy = NEVH_NO,                                           \
        .needs = NEVH_PARTS,                                                   \
        .kernel = &nevh__parts_kernel,                                         \
        .table = &id##_table,                                                  \
    };                                                                         \
    NEVH__PUBLISH(id)

/* The flow of A = z' K z / 2 + g' z, by the matrix exponential of each block of
   variables that K connects. */
typedef struct nevh__form_flow nevh__form_flow;
/* apart    the terms of A in the field of w, which planning has marked
   times    parts of a step over which the flow is taken, count of them
   returns  NULL, with a failure recorded, where memory is out or a block is too
            large */
nevh__form_flow *nevh__form_flow_new(nevh_work *w, size_t count,
                                     const double times[]);
void nevh__form_flow_free(nevh__form_flow *); /* NULL is allowed */
/* Makes the matrices for steps of h, unless these are there. */
void nevh__form_flow_set(nevh__form_flow *, double h);
/* Adds to dz what the flow over part `which` of the step adds to the states q, p,
   n x width each. */
void nevh__form_flow_add(const nevh__form_flow *, size_t which, size_t width,
                         const double q[], const double p[], double dq[],
                         double dp[]);
/* The bodies that move about one another, or NULL. */
const struct nevh__hierarchy *nevh__form_flow_bodies(const nevh__form_flow *);
/* The reason why attractions stay in B, or NULL. */
const char *nevh__form_flow_why(const nevh__form_flow *);
/* The flow of a scheme by parts; NULL for other schemes. */
const nevh__form_flow *nevh__parts_flow_of(const nevh_work *);
/* The bodies of a scheme by parts; NULL, too, for other schemes. */
const struct nevh__hierarchy *nevh__parts_hierarchy(const nevh_work *);
/* Takes what A has of their attractions from a gradient with all of them. */
void nevh__form_flow_lessen(const nevh__form_flow *, size_t width,
                            const double q[], double dh_dq[]);

#endif

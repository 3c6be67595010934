/* nevh: the operations of a splitting.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SPLITTING_PRIVATE_H
#define NEVH_SPLITTING_PRIVATE_H

#include <nevh/extend.h>

/* Kicks and drifts of a step. */
size_t nevh__splitting_operations(const nevh_splitting *);
/* Their weights in turn, that many; a palindrome is one to the last bit. */
void nevh__splitting_expand(const nevh_splitting *, double weights[]);

typedef struct nevh__repeated nevh__repeated;

typedef struct {
    nevh_operation first;
    size_t count;
    bool same_ends; /* the last operation is of the first one's kind */
    double *weights;
    double *times; /* parts of h that the half at rest has gone through */
    nevh__repeated *repeated; /* one orbit's own way, or NULL */
} nevh__operations;

/* What a splitting remembers of each half, and the last slope of a step. */
typedef struct {
    double *carry_q, *carry_p, *kept, *has_kept;
} nevh__splitting_memory;

static inline nevh__splitting_memory nevh__splitting_recall(nevh_work *w) {
    double *m = w->memory;
    return (nevh__splitting_memory){m, m + w->size, m + 2 * w->size,
                                    m + 3 * w->size};
}

/* Steps of one orbit of a small system, where H can be called as it is; see
   splitting_repeated.c.  To *repeated; NULL: there is no such way.  NEVH_OK or
   NEVH_ENOMEM. */
int nevh__repeated_plan(nevh_work *, nevh__repeated **repeated);
void nevh__repeated_free(nevh__repeated *);
/* A whole step, or false, with nothing changed: something is not finite, or H
   may not be called. */
bool nevh__repeated_step(nevh_work *, double t, double h, double q[],
                         double p[]);

#endif

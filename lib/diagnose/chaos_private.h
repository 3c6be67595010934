/* nevh: inside the analysis of chaos.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_CHAOS_PRIVATE_H
#define NEVH_CHAOS_PRIVATE_H

#include "system/system_private.h"
#include <nevh/chaos.h>

/* variational.c: the system whose coordinates are q and dq, and whose momenta
   are dp and p, in that order, with H = dq dH/dq + dp dH/dp. */
typedef struct {
    nevh_system *system;
    void **tapes; /* of terms that are formulas; NULL of others */
    size_t count;
} nevh__variational;
/* scale    in, 2n lengths over which H varies, coordinates first
   returns  to be freed; NULL, with a report, where a term reads too much or
            memory is out.  The system that it is of must outlive it. */
nevh__variational *nevh__variational_new(const nevh_system *,
                                         const double scale[], nevh__report *);
void nevh__variational_free(nevh__variational *);

/* Batches in time; full, they are merged in pairs. */
enum { NEVH__BINS = 64 };

/* A start. */
typedef struct {
    double *w; /* deviations and frame: vectors x 2n, in units of the scale */
    double *norm; /* of deviations, when they were last looked at */
    double *log;  /* logs x NEVH__BINS: growth in each bin */
    double *gali; /* deviations + 1 */
    double sali;
    double moment;    /* int t dlog|w| of the first deviation */
    double indicator; /* 2 moment/t */
    double area;      /* int of that over time */
} nevh__chaos_start;

struct nevh_chaos {
    nevh__report report;
    bool planned, tangent;
    char why[400];
    const nevh_system *system;
    size_t n, starts, exponents, deviations, frame; /* frame: vectors that are
                                    kept orthonormal; 0: one exponent */
    size_t lanes;                                   /* of a start */
    size_t width;
    nevh_options options; /* q, p and scale are its own */
    double t_start, dt, period;
    uint64_t seed;
    nevh__variational *variational;
    nevh_stepper *stepper;
    nevh_field *field;     /* of H, for the energy of starts */
    double *own;           /* q, p, scale: n, n, 2n */
    double *q, *p;         /* of the stepper */
    double *slope, *place; /* 2n */
    nevh__chaos_start *start;
    double done; /* steps */
    size_t first_stride;
    size_t stride;           /* steps between looks */
    double span[NEVH__BINS]; /* the time of each bin */
    size_t bin, looks, looks_a_bin;
};

static inline size_t nevh__chaos_vectors(const nevh_chaos *c) {
    return c->deviations + c->frame;
}
/* Series of growth that are kept. */
static inline size_t nevh__chaos_logs(const nevh_chaos *c) {
    return c->frame ? c->frame : 1;
}

/* chaos_starts.c: states and displacements at the start. */
int nevh__chaos_begin(nevh_chaos *);
/* chaos_walk.c: hands displacement v of a start to the stepper, or takes it. */
void nevh__chaos_put(nevh_chaos *, size_t start, size_t v);

#endif

/* nevh: inside the analysis of chaos.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_CHAOS_PRIVATE_H
#define NEVH_CHAOS_PRIVATE_H

#include "system/system_private.h"
#include <nevh/chaos.h>
#include <signal.h>

/* variational.c: the system whose coordinates are q and dq, and whose momenta
   are dp and p, in that order, with H = dq dH/dq + dp dH/dp. */
typedef struct {
    nevh_system *system;
    const char **names; /* of its coordinates; NULL: the system has none */
    void **tapes;       /* of terms that are formulas; NULL of others */
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

/* The progress of a start. */
typedef struct {
    double done, seen;       /* steps; those when it was last looked at */
    double span[NEVH__BINS]; /* the time of each bin */
    size_t bin, looks, looks_a_bin;
} nevh__chaos_clock;

/* A variable, in units of the scale: its range, and how often it has gone from
   the lowest quarter of that to the highest, or back, since the range grew. */
typedef struct {
    double low, high, crossings;
    int side; /* -1, 1: the last of these quarters; 0: none yet */
} nevh__course;

/* A start. */
typedef struct {
    nevh__chaos_clock clock;
    double *w; /* deviations and frame: vectors x 2n, in units of the scale */
    double *norm; /* of deviations, when they were last looked at */
    double *log;  /* logs x NEVH__BINS: growth in each bin */
    double *gali; /* deviations + 1 */
    double sali;
    double *first; /* 2n: where the orbit started, in units of the scale */
    double moved;  /* how far from there it was at most */
    nevh__course *course; /* 2n: of the variables */
    double moment;        /* int t dlog|w| of the first deviation */
    double indicator;     /* 2 moment/t */
    double area;          /* int of that over time */
} nevh__chaos_start;

typedef struct nevh__chaos_batch nevh__chaos_batch;

struct nevh_chaos {
    nevh__report report;
    bool planned, tangent;
    bool of_members; /* it finds what nevh__chaos_member has, and no more */
    char why[400];
    const nevh_system *system;
    const nevh_integrator *integrator;
    size_t n, starts, exponents, deviations, frame; /* frame: vectors that are
                                    kept orthonormal; 0: one exponent */
    size_t lanes;                                   /* of a start */
    size_t width;
    nevh_options options;       /* q, p and scale are its own */
    double t_start, dt, period; /* dt > 0, and */
    double way;                 /* 1, or -1: backward in time */
    uint64_t seed;
    nevh__variational *variational;
    nevh_stepper *stepper;
    nevh_field *field;     /* of H, for the energy of starts */
    void *memory;          /* of all arrays but `start` */
    double *own;           /* q, p, scale: n, n, 2n */
    double *q, *p;         /* of the stepper */
    double *slope, *place; /* 2n */
    /* Jumps of the force on the way of the first start: displacements miss what these
       add to their growth. */
    bool searches;  /* H may have some */
    double *marked; /* 6n: the state at the step `mark`, that now, and room */
    double mark, largest; /* largest: the sum of the terms' |values| */
    size_t kinks;
    nevh__chaos_start *start;
    size_t first_stride, turn; /* turn: steps of a period */
    size_t stride;             /* steps between looks */
    nevh__chaos_batch *batch;  /* of members; or NULL */
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
/* A start at a state that has taken no step.
   z      in, 2n: q, then p
   drawn  the generator that displacements are drawn from, as nevh__chaos_draw
          has it; in and out */
void nevh__chaos_place(nevh_chaos *, size_t start, const double z[],
                       uint64_t *drawn);
/* Lanes that only fill up the last vector of eight become those of the last start,
   whose displacements are kept from growing. */
void nevh__chaos_fill_up(nevh_chaos *);
/* The generator of start number `number`. */
uint64_t nevh__chaos_draw(const nevh_chaos *, size_t number);
/* chaos_walk.c: hands displacement v of a start to the stepper, or takes it. */
void nevh__chaos_put(nevh_chaos *, size_t start, size_t v);
/* Subtracts from b its part along the unit vector a; m numbers each. */
void nevh__chaos_remove_part(double b[], const double a[], size_t m);
/* Looks at a start, whose clock->done is set.
   returns  the largest growth of its frame; NAN where a displacement has
            overflowed or vanished */
double nevh__chaos_look(nevh_chaos *, size_t start);
/* The steps that lead nearest to `until`. */
double nevh__chaos_steps(const nevh_chaos *, double until);
/* Goes on to the next look, or to the step `last`; false: it is over. */
bool nevh__chaos_advance(nevh_chaos *, double last);
/* chaos_report.c: of one start. */
/* All growth of displacements, as a logarithm. */
double nevh__chaos_growth(const nevh_chaos *, size_t start);
double nevh__chaos_rate(const nevh_chaos *, size_t start, size_t i);
double nevh__chaos_megno(const nevh_chaos *, size_t start);

/* chaos_batch.c: starts that are orbits of their own, side by side, each from
   t_start to a time of its own; the next takes the place of one that has ended.
   What is found of one is what a nevh_chaos of one start finds, whatever its
   neighbours. */
typedef struct {
    uint64_t member;
    int status; /* of the step that failed, with a message; or NEVH_OK */
    const char *message;
    double exponent, sali, megno;
} nevh__chaos_member;
typedef struct {
    bool (*next)(void *data, uint64_t *member, double q[], double p[],
                 double *until);
    int (*done)(void *data, const nevh__chaos_member *); /* not 0: stop */
    void *data;
    bool sparse;   /* MEGNO is not asked for: looks once a turn will do */
    bool aligned;  /* SALI alone is: an orbit ends where it has fallen below
                     nevh__chaos_aligned */
    bool together; /* H reads t: orbits begin together */
    const volatile sig_atomic_t *ending; /* not 0: orbits are left; or NULL */
} nevh__chaos_jobs;
/* A nevh_chaos for that alone, which has no verdict; one deviation is enough where
   SALI is not asked for. */
nevh_chaos *nevh__chaos_of_members(const nevh_system *,
                                   const nevh_chaos_options *);
/* Plans a batch; false if memory is out. */
bool nevh__chaos_batch_plan(nevh_chaos *);
void nevh__chaos_batch_free(nevh__chaos_batch *); /* NULL is allowed */
void nevh__chaos_batch_run(nevh_chaos *, const nevh__chaos_jobs *);
/* Below it displacements are aligned. */
double nevh__chaos_aligned(const nevh_chaos *);

#endif

/* nevh: the equations of implicit stages.
   SPDX-License-Identifier: GPL-3.0-or-later

   Unknown are the slopes x at each stage; they solve x = G(x), where G puts
   the slopes into the scheme, gets states, and takes the field there.  Layout:

       x[(k * stages + stage) * width + lane],

   k < n for slopes of coordinates, then of momenta; in the partitioned form,
   for H = T(p) + V(q), unknown are the slopes of momenta alone, k < n.

   Lanes are swept side by side (fixed_point.c).  One that does not get on is
   given to simplified Newton (newton.c), one that does not get on there to GSL
   (rescue.c); judge.c tells whether it gets on. */
#ifndef NEVH_IMPLICIT_PRIVATE_H
#define NEVH_IMPLICIT_PRIVATE_H

#include "implicit/stage_progress.h"
#include <nevh/extend.h>
#include <stdbool.h>

typedef struct nevh__stage_solver nevh__stage_solver;

/* The dependence of stage states on derivatives, for Newton's iteration: Q_i = q +
   h sum_j a_q[j*stages + i] (derivative of q at j), P_i with a_p.  In the
   partitioned form G takes the derivatives of q from P_j. */
typedef struct {
    size_t stages;
    bool partitioned;
    const double *a_q, *a_p; /* may be one array; outlive the solver */
} nevh__stage_shape;

/* Lanes that are swept, and compared, together: at most NEVH__MOST_GROUP, next
   to each other.  data: the problem's. */
enum { NEVH__MOST_GROUP = 8 };
typedef struct {
    /* Begins with some of the lanes from `first` on, and returns how many; 0:
       none can be.  unit: 2n x width, |h| over scale. */
    size_t (*begin)(void *data, size_t first, const double unit[]);
    /* Sweeps on from where begun, and tells what that changed. */
    int (*sweep)(void *data, nevh__stage_progress made[]);
    /* So many sweeps of a lane were made: counts what they evaluated. */
    void (*count)(void *data, size_t sweeps);
    /* Takes the x of a lane of the group. */
    void (*fetch)(void *data, size_t lane);
    /* So many lanes of a group, or fewer, had better leave it: what follows is
       of this lane alone, which goes on where it stands.  few 0: none does. */
    void (*leave)(void *data, size_t lane);
    size_t few;
    /* The first guess for any lane, to x. */
    void (*guess)(void *data, size_t lane);
} nevh__stage_group;

/* One step's equations. */
typedef struct {
    double t, h;
    const double *q, *p; /* the state at the start of the step */
    double *x;           /* in: first guess, unless in groups; out: solution */
    /* out = G(x) at the given lanes, side by side: out[row*active + a]. */
    int (*map)(void *data, size_t active, const size_t lanes[],
               const double x[], double out[]);
    void *data;
    /* Lanes that are swept and compared together; NULL: map will do. */
    const nevh__stage_group *group;
    /* width, in and out: steps for which a lane is given to Newton's iteration
       at once, from the step before and for the next.  To be kept in memory,
       but not before the step is certain.  NULL: nothing is known. */
    double *hold;
    /* The noise that rounding in H adds to each of a lane's 2n derivatives; NULL:
       as much as to the field's gradient. */
    int (*noise)(void *data, size_t lane, double noise[]);
} nevh__stage_problem;

/* Unknown and known slopes of a lane up to which Newton's iteration is there. */
enum { NEVH__MOST_DENSE = 1024 };
/* For the work's n and width.  NULL when memory is out. */
nevh__stage_solver *nevh__stage_solver_new(nevh_work *,
                                           const nevh__stage_shape *);
void nevh__stage_solver_free(nevh__stage_solver *);
/* Solves to the rounding floor, or fails with a message. */
int nevh__stage_solve(nevh__stage_solver *, const nevh__stage_problem *);

/* For the parts of the solver. */
struct nevh__stage_solver {
    nevh_work *work;
    nevh__stage_shape shape;
    size_t stages, first;  /* first: the variable that row 0 belongs to */
    size_t rows;           /* 2 n stages or n stages: unknowns of a lane */
    void *memory;          /* holds all arrays that follow */
    double *scale;         /* 2n x width: sizes that changes are held against */
    double *unit;          /* 2n x width: |h| over them */
    double *out;           /* rows x width */
    double *least;         /* rows x width: smallest change so far */
    double *noise;         /* 2n, of one lane */
    double *one_scale;     /* 2n: of Newton's lane */
    const double *typical; /* 2n: sizes of the variables, of that lane */
    size_t *lanes;         /* lanes under way */
    nevh__stage_lane *lane;
    struct nevh__newton *newton; /* these two: NULL for large systems */
    struct nevh__rescue *rescue;
    const nevh__stage_problem *problem;
    int status; /* of the noise, where it was asked for */
};

/* Slopes times |h| over this are in units of the state's scales. */
static inline double nevh__stage_unit(const nevh__stage_solver *s, size_t row,
                                      size_t lane) {
    size_t k = s->first + row / s->stages;
    double h = s->problem->h < 0 ? -s->problem->h : s->problem->h;
    return s->scale[k * s->work->width + lane] / h;
}

/* The state of a lane before its first sweep. */
extern const nevh__stage_lane nevh__stage_fresh;
/* Forgets what is known of a lane's iteration, and its smallest changes. */
void nevh__stage_begin(nevh__stage_solver *, size_t lane);
/* True if a change, in units of scale, is no more than rounding. */
bool nevh__stage_small(nevh__stage_solver *, size_t lane, double change);

/* To s->noise, 2n: what noise of differences, at the start of the step, adds to
   a lane's slopes.  Sets s->status. */
void nevh__stage_noise(nevh__stage_solver *, size_t lane);

/* Progress is that the changes of more than `chance` unknowns fall below `by`
   times their smallest so far.  It is believed to have ended where changes are
   small. */
typedef struct {
    double by;
    size_t chance;
    bool (*small)(nevh__stage_solver *, size_t lane, double change);
} nevh__stage_rule;
/* Compares one lane's sweep, out[row*stride], with those before. */
nevh__stage_progress nevh__stage_compare(nevh__stage_solver *, size_t lane,
                                         size_t stride, const double out[],
                                         const nevh__stage_rule *);
nevh__stage_state nevh__stage_judge(nevh__stage_solver *, size_t lane,
                                    const nevh__stage_progress *,
                                    const nevh__stage_rule *);
/* The same of fixed-point iteration by its rule; NEVH__STUCK, too, where that
   would take too long. */
extern const nevh__stage_rule nevh__fixed_point_rule;
nevh__stage_state nevh__fixed_point_judge(nevh__stage_solver *, size_t lane,
                                          const nevh__stage_progress *);
/* Makes that sweep the lane's slopes. */
void nevh__stage_take(nevh__stage_solver *, size_t lane, size_t stride,
                      const double out[]);

struct nevh__newton *nevh__newton_new(nevh__stage_solver *);
void nevh__newton_free(struct nevh__newton *);
/* One lane by simplified Newton, or else by GSL's multiroot solver. */
int nevh__newton_lane(nevh__stage_solver *, size_t lane);

struct nevh__rescue *nevh__rescue_new(nevh__stage_solver *);
void nevh__rescue_free(struct nevh__rescue *);
/* One lane by GSL's multiroot solver. */
int nevh__rescue_lane(nevh__stage_solver *, size_t lane);

/* Factors of a square matrix, row by row, whose rows are exchanged as `pivot`
   says; false where it is singular or not finite.  GSL's own allocates. */
bool nevh__factor(size_t rows, double matrix[], size_t pivot[]);
/* x = matrix^-1 x, of the factors. */
void nevh__solve(size_t rows, const double matrix[], const size_t pivot[],
                 double x[]);

#endif

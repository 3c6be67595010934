/* nevh: a closed curve of starts, carried along, and the area in it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_LOOP_H
#define NEVH_LOOP_H

#include <nevh/run.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The area that a closed curve of starts encloses after some steps: the sum over
   coordinates of the integral of q dp round the curve, which is positive where a
   curve of one degree of freedom goes from q to p.  A symplectic scheme keeps
   it (Poincare's integral invariant); this measures what others do.

   The curve is cut into panels between its corners, each with 16 nodes of
   Gauss and Legendre in the parameter s; where what the scheme made of a panel
   is no longer smooth on these nodes it is cut into two, whose nodes start
   afresh.  So the error falls exponentially with the points, and is estimated
   from the last coefficients of the Legendre series of q and p.

   Where even the most points do not resolve the curve, and there is one degree
   of freedom, the area is found from the inside: the mean of the products of the
   determinants of all steps, each step taken from its beginning alone, over some
   4000 points of what the curve enclosed at first.  The error is then the
   difference between two halves of these points. */
typedef struct nevh_loop nevh_loop;

/* States of the curve at `count` values of s, which goes round from 0 to 1;
   q[k*count + i] and p likewise.
   returns  0; anything else ends nevh_loop_carry with NEVH_EFAILED */
typedef int (*nevh_curve_fn)(void *data, size_t count, const double s[],
                             double q[], double p[]);

typedef struct {
    nevh_curve_fn curve;   /* smooth between corners */
    void *data;            /* its first argument */
    const double *corners; /* values of s, rising, in [0, 1); borrowed until
                              nevh_loop_new returns */
    size_t n_corners;      /* 0: smooth all round */
    const size_t *steps;   /* numbers of steps, rising, after which the area is
                              asked for; borrowed likewise */
    size_t times;          /* of them */
    double t0, h;          /* as of nevh_run */
    size_t most_points;    /* 0: 16384; fewer are carried along once it is clear
                              that these do not give an area to 1e-3 */
    bool shapes;           /* nevh_loop_shape is to be asked */
} nevh_loop_options;

/* returns  to be freed with nevh_loop_free; NULL when memory is out or an
            argument is NULL; carries the stepper's refusal, NEVH_ESTRUCT for
            schemes and transforms that choose their own times (states at one
            time are what a curve is made of), or NEVH_EINVAL otherwise
   options  as the stepper's; q and p: one state to plan at, n each; width is
            ignored */
NEVH_API nevh_loop *nevh_loop_new(const nevh_system *, const nevh_integrator *,
                                  const nevh_options *options,
                                  const nevh_loop_options *);
NEVH_API void nevh_loop_free(nevh_loop *); /* NULL is allowed */
/* The status of planning or of the last call; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_loop_status(const nevh_loop *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_loop_message(const nevh_loop *);

/* Carries the curve along, once.
   returns  NEVH_OK; where a point's step fails its status: areas before it are
            there; NEVH_EINVAL where the curve encloses no area; NEVH_EFAILED
            where `curve` said so; NEVH_ENOMEM
   cost     as many orbits as points of the result, and about half of that for
            panels that were cut; states of panels take up to 64 MB */
NEVH_API int nevh_loop_carry(nevh_loop *);

typedef struct {
    double t;
    double area;   /* NAN where a step failed before */
    double error;  /* an estimate of what the panels leave of it, rounding left
                      out */
    size_t points; /* of the curve */
    bool inside;   /* the curve is stretched beyond what its points resolve, and
                      the area was found from the inside */
} nevh_loop_area;
/* After the steps number i of the options: areas are there up to the first that
   failed. */
NEVH_API nevh_loop_area nevh_loop_result(const nevh_loop *, size_t i);
/* The curve after the steps number i, point by point as s rises, for drawing.
   q, p     out, n each, of the point; NULL: not wanted
   returns  whether there is a point of that number */
NEVH_API bool nevh_loop_shape(const nevh_loop *, size_t i, size_t point,
                              double q[], double p[]);

#ifdef __cplusplus
}
#endif
#endif

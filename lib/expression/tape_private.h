/* nevh: formulas as tapes.
   SPDX-License-Identifier: GPL-3.0-or-later

   A tape is an expression over the variables of one term instance, as a list
   of operations in static single assignment.  A builder makes it node by node:

       nevh__tape_builder *b = nevh__tape_builder_new();
       int p = nevh__tape_variable(b, NEVH__P, 0);
       int m = nevh__tape_variable(b, NEVH__C, 0);
       int two = nevh__tape_number(b, 2);
       int square = nevh__tape_apply(b, NEVH__POWER, p, two);
       int twice = nevh__tape_apply(b, NEVH__MULTIPLY, two, m);
       int h = nevh__tape_apply(b, NEVH__DIVIDE, square, twice);
       nevh__tape *tape = nevh__tape_finish(b, h, &status);

   A finished tape is const: threads share it.  Evaluation allocates nothing;
   it takes up to 66 KiB of stack, gradients of tapes that hold many values at
   once (about 100, and fewer where there are more than 1000 operations) up to
   520 KiB. */
#ifndef NEVH_TAPE_PRIVATE_H
#define NEVH_TAPE_PRIVATE_H

#include "expression/operations_private.h"
#include <nevh/system.h>

/* Time; the instance's k-th coordinate, momentum and constant. */
typedef enum { NEVH__T, NEVH__Q, NEVH__P, NEVH__C } nevh__variable;
enum { NEVH__VARIABLES = 4 };

/* The operations of operations_private.h.  atan2(y, x).  mod has the sign of its
   second argument and is exact for integers.  Of min and max, an argument that is NaN wins.  bessel_j0 and
   bessel_j1 are of the first kind, |x| < 4e15; elliptic_k and elliptic_e are
   complete integrals of the modulus k, |k| < 1 (elliptic_e: also 1).
   kepler(M, e) is the eccentric anomaly, E - e sin E = M, 0 <= e < 1, of mean
   anomalies up to 1e15.

   Outside its domain a function is NaN.  Derivatives at a kink: abs has 0 at
   0, hypot at (0, 0); min and max of equals have that of the second argument;
   sign and floor have 0 everywhere, mod by its first argument 1.  In the chain
   rule 0 times infinity is 0, as for x*sqrt(x) at 0. */
#define NEVH__OPERATION_ENTRY(kind, identifier, ...) NEVH__##identifier,
typedef enum {
    NEVH__OPERATIONS(NEVH__OPERATION_ENTRY) NEVH__OPERATION_COUNT
} nevh__tape_operation;
#undef NEVH__OPERATION_ENTRY

typedef enum {
    NEVH__KIND_ARITHMETIC,
    NEVH__KIND_FUNCTION,
    NEVH__KIND_KINK,
    NEVH__KIND_SPECIAL,
    NEVH__KIND_GSL
} nevh__operation_kind;

/* A formula {numerator, denominator}; numerator NULL: not known; denominator
   NULL: 1. */
typedef struct {
    const char *top, *bottom;
} nevh__derivative_text;

/* An entry of operations_private.h.  Texts may be NULL. */
typedef struct {
    nevh__operation_kind kind;
    const char *name; /* a function's begins with a letter */
    int arity;        /* 1 or 2 */
    const char *usage;
    nevh__derivative_text by_a, by_b; /* derivatives */
    const char *as;      /* rewritten in other operations, for series */
    const char *edge;    /* where it is 0 the function ends */
    const char *at_edge; /* and what is said there */
    bool touches;        /* finite at the edge */
    bool jumps;          /* its values do at the edge */
    bool steep;    /* it grows faster than any polynomial, or saturates so */
    bool exact;    /* it rounds nothing */
    bool lanewise; /* compiled text takes lane by lane */
} nevh__operation_traits;
/* Also of NEVH__SINCOS. */
const nevh__operation_traits *nevh__operation_of(unsigned);

/* The functions that build the formula of an entry, as nodes; negative if that
   fails. */
typedef struct {
    void *data;
    int (*number)(void *data, double);
    int (*apply)(void *data, nevh__tape_operation, int a, int b);
} nevh__algebra;
/* The node of a formula; of = {a, b, y}. */
int nevh__operation_build(const char *formula, const int of[3],
                          const nevh__algebra *);

/* The name in formulas, and 1 or 2.  pow(x, y) is for who reads formulas to map to
   NEVH__POWER. */
const char *nevh__operation_name(nevh__tape_operation);
int nevh__operation_arguments(nevh__tape_operation);
/* One operation on numbers, as the tape does it one state at a time; b is
   ignored where there is one argument. */
double nevh__operation_value(nevh__tape_operation, double a, double b);

typedef struct nevh__tape_builder nevh__tape_builder;
typedef struct nevh__tape nevh__tape;

/* NULL when memory is out; that may be handed on: each function below then
   returns -1 or NULL. */
nevh__tape_builder *nevh__tape_builder_new(void);
/* Operations on numbers alone are left for the tape from now on. */
void nevh__tape_unfold(nevh__tape_builder *);
/* Without a tape having been made of it. */
void nevh__tape_abandon(nevh__tape_builder *);

/* Each returns a node, at least 0, or -1 when memory is out, now or earlier:
   -1 may be handed on as an argument.

   The same operation on the same nodes is the same node, for a + b and b + a
   too.  Numbers are folded.  Rewritten is only what changes no result, be it
   of rounding or a zero's sign: x*1, x/1, x^1, x - 0, x + (-y), -(-x), x*(-1),
   (-x)*(-y), x/2^k, abs(x)^2 and the like; not 0*x, which is not 0 where x is infinite.
   Powers that are numbers are an exception: x^n with a whole |n| <= 8 is
   multiplied out (|n| - 1 roundings of half an ulp each, and one where n < 0),
   x^(n + 1/2) with |n + 1/2| < 5 is the same times sqrt(x), so that there a
   zero keeps its sign and -inf has no root. */
int nevh__tape_number(nevh__tape_builder *, double);
int nevh__tape_variable(nevh__tape_builder *, nevh__variable, size_t k);
/* b is ignored where there is one argument. */
int nevh__tape_apply(nevh__tape_builder *, nevh__tape_operation, int a, int b);
/* True if a node is a number; value, if not NULL, is then that number. */
bool nevh__tape_is_number(const nevh__tape_builder *, int node, double *value);

/* Makes the tape and frees the builder, whatever happens.
   status   out, may be NULL: NEVH_OK; NEVH_ENOMEM; NEVH_EINVAL when the
            expression holds more than NEVH__TAPE_LIVE values at once or
            has more than NEVH__TAPE_LENGTH operations
   returns  the tape, to be freed with nevh__tape_free; NULL on failure */
nevh__tape *nevh__tape_finish(nevh__tape_builder *, int result, int *status);
enum { NEVH__TAPE_LIVE = 512, NEVH__TAPE_LENGTH = 1 << 20 };
void nevh__tape_free(nevh__tape *);

/* True if the result depends on a variable, according to the operations left. */
bool nevh__tape_reads(const nevh__tape *, nevh__variable, size_t k);
/* True if an operation of coordinates or momenta has kinks or jumps. */
bool nevh__tape_breaks(const nevh__tape *);
/* True if other operations of them may have: at the edges of sqrt, hypot, acos ... */
bool nevh__tape_touches(const nevh__tape *);
/* One more than the largest k that the builder was asked for, read or not: what
   a term must declare as nq, np, nc. */
size_t nevh__tape_count(const nevh__tape *, nevh__variable);
/* A tape as a nevh_quantity: its constants are velocities. */
void nevh__tape_quantity(const void *tape, size_t width, const double t[],
                         const double q[], const double p[], const double v[],
                         double values[]);
/* True if two tapes have the same operations and numbers. */
bool nevh__tape_same(const nevh__tape *, const nevh__tape *);
/* True if they have the same operations and as many numbers, which may differ. */
bool nevh__tape_alike(const nevh__tape *, const nevh__tape *);
/* Its numbers, each once. */
size_t nevh__tape_numbers(const nevh__tape *, const double **);
/* The same with some of its numbers, opened[i] of number i, as constants after
   those that it has: it gives the same bits where these are the numbers.
   returns  to be freed with nevh__tape_free; NULL when memory is out */
nevh__tape *nevh__tape_open(const nevh__tape *, const bool opened[]);
/* Operations; sine and cosine of one argument are one. */
size_t nevh__tape_length(const nevh__tape *);

/* The functions of a nevh_term whose params is the tape; nevh_term_fn etc.

   Value, block and the real part of complex_value agree to the bit.
   Where the value is not finite no derivative is: each by a variable that the
   tape reads is NaN.
   cost     gradient: about 2.5 values; with more than about 1000 operations,
            half a value more for each time the tape is halved to fit into the
            stack */
double nevh__tape_value(double t, const double q[], const double p[],
                        const double c[], const void *tape);
void nevh__tape_block(size_t width, const double t[], const double q[],
                      const double p[], const double c[], const void *tape,
                      double h[]);
void nevh__tape_block_gradient(size_t width, const double t[], const double q[],
                               const double p[], const double c[],
                               const void *tape, double dh_dq[],
                               double dh_dp[]);
/* Reads the formula as it is written: nevh_actions_fn. */
bool nevh__tape_actions(const double c[], const void *tape, const size_t of[],
                        double s[]);
/* The derivative with respect to t. */
void nevh__tape_block_time(size_t width, const double t[], const double q[],
                           const double p[], const double c[], const void *tape,
                           double dh_dt[]);
void nevh__tape_complex(double t, const double q[][2], const double p[][2],
                        const double c[], const void *tape, double h[2]);

/* A bound, to first order, of what the rounding of all operations may do to the
   value. */
double nevh__tape_rounding(double t, const double q[], const double p[],
                           const double c[], const void *tape);

/* The derivative of a tape along (dq, dp): a tape that reads q and then dq, p
   and then dp, twice as many of each; kinks have the derivatives above.
   status   out: NEVH_OK; NEVH_ENOGRAD where it calls Bessel functions or
            elliptic integrals; NEVH_ENOMEM, NEVH_EINVAL as of
            nevh__tape_finish
   returns  to be freed with nevh__tape_free; NULL on failure */
nevh__tape *nevh__tape_along(const nevh__tape *, int *status);

/* Fills in value, block, gradient, time_slope, complex_value (NULL unless
   analytic), params, nq, np, nc and time; leaves the rest, so q, p, c and count are the
   caller's, rows of nq, np and nc. */
void nevh__tape_shape(nevh_term *, const nevh__tape *);

#endif

/* nevh: Taylor series of orbits.

   From a graph follow recurrences: the coefficients of order k of all that H's
   gradient is made of, from those of lower order [A. Jorba, M. Zou, A software
   package for the numerical integration of ODEs by means of high-order Taylor
   methods, Exp. Math. 14 (2005) 99-117; F. Biscani, D. Izzo, Revisiting
   high-order Taylor methods for astrodynamics and celestial mechanics, MNRAS
   504 (2021) 2614-2628].

   A product's coefficient is a sum over pairs, of which all but the outermost
   are known before the order begins.  So the inner sums of all products are
   taken first, side by side: each product has a lane, whose operands are kept
   in rows by order.  What is left of an order is a list of batches, operations
   of one kind that do not wait for each other.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SERIES_PRIVATE_H
#define NEVH_SERIES_PRIVATE_H

#include "taylor/graph_private.h"
#include "taylor/dd_private.h"

typedef enum {
    NEVH__BATCH_SUM, /* of up to four multiples */
    NEVH__BATCH_MULTIPLY,
    NEVH__BATCH_INVERT,
    NEVH__BATCH_ROOT,
    NEVH__BATCH_POWER,
    NEVH__BATCH_CALL
} nevh__batch_kind;
enum { NEVH__MOST_SUMMANDS = 4 };

/* `count` operations that give values `first` and on. */
typedef struct {
    uint8_t kind, arity, function;
    bool together[NEVH__MOST_SUMMANDS]; /* operands stand side by side */
    uint32_t count, first;
    uint32_t operand[NEVH__MOST_SUMMANDS]; /* values; else places in `index` */
    uint32_t lane, also;                   /* also: of a power's second sums */
    uint32_t number; /* factors of summands, exponents, factors of slopes */
} nevh__batch;

/* Values are coordinates, momenta and time, then numbers, then results.
   Lanes whose first operand counts with its order come first. */
typedef struct {
    size_t n, values, n_batches, lanes, weighted, widest;
    size_t used[2]; /* lanes, of either kind; others are 0 */
    size_t first_constant, n_constants; /* whose numbers are the first */
    size_t n_numbers;
    nevh__batch *batches;
    uint32_t *index;
    nevh__wide *numbers;
    uint32_t *lane_a, *lane_b; /* lanes each */
    uint32_t *slope;           /* 2n values, and their factors' numbers */
    size_t slope_number;
    struct nevh__edge *edges; /* what is to keep away from 0 */
    size_t n_edges, n_watched;
    uint32_t
        *watched; /* values: of edges, then what else those of atan2 read */
} nevh__recurrence;

typedef struct nevh__edge {
    bool strict; /* as of a graph */
    bool steep;
    uint32_t also; /* of atan2: x among what is watched; 0: it is none */
    uint8_t function;
    double exponent;    /* of steep powers */
    const char *effect; /* NULL: of several */
} nevh__edge;

/* log2 of the reach by the size of the coefficients of order k, from order/2 on: the
   last two are to be below the tolerance, and so are others beyond the last that is
   not 0, as of x^4 from x = 0, where three of four are.
   tolerance, size   their log2 */
NEVH__INLINE double nevh__series_reach(size_t order, double tolerance, size_t k,
                                       double size) {
    static const double an_order = 3.3219280948873623; /* log2(10) */
    double before = k + 1 < order ? (double)(order - k) : 0;
    return (tolerance + before * an_order - size) / (double)k;
}

/* The time for which series hold, at most `reach`, before the edge of a domain, to
   either side.
   rows   coefficients of what is watched, n_watched each, of `orders` orders */
double nevh__domain_reach(const nevh__recurrence *, const double rows[],
                          size_t orders, double reach);
/* The edge that a series meets which cannot be taken, or soon after it: by the
   orders that are finite.  SIZE_MAX: none. */
size_t nevh__domain_edge(const nevh__recurrence *, const double rows[],
                         size_t orders, double reach);
/* True if an orbit goes on behind an edge: the function is finite there for all
   arguments, and so is the momentum. */
bool nevh__domain_is_closed(const nevh__recurrence *, size_t edge);
/* True if an operation jumps at one of the edges. */
bool nevh__domain_may_jump(const nevh__recurrence *);
/* The first edge that is a kink of an operation, behind which an orbit goes on;
   SIZE_MAX: there is none. */
size_t nevh__domain_kink(const nevh__recurrence *);
#define NEVH__SERIES_EDGE                                                      \
    "%s is not analytic there, as far as its digits tell, and a series knows " \
    "nothing of what follows"
/* "sqrt(...), whose argument reaches 0, in effect "V"" */
void nevh__domain_words(const nevh__recurrence *, size_t edge, char text[],
                        size_t room);

/* friction  n rates or NULL
   broken    functions of t alone may have kinks and jumps: series are then to
             begin after them
   returns   NULL, with the reason in the report */
nevh__recurrence *nevh__recurrence_new(const nevh_system *,
                                       const double friction[], bool broken,
                                       nevh__report *);
/* The same of rates with more digits, and for runs of more digits: jumps of H that are
   below those of a double count, and functions of t have no kinks. */
nevh__recurrence *nevh__recurrence_wide(const nevh_system *,
                                        const nevh__wide friction[],
                                        nevh__report *);
void nevh__recurrence_free(nevh__recurrence *); /* NULL is allowed */

/* The message on coefficients that are not finite, at a time. */
#define NEVH__SERIES_NOT_FINITE                                                \
    "the series at t = %.9g is not finite: H has no derivatives there, the "   \
    "state is out of its domain, or a value is beyond 1e308 or below 1e-308"

/* Memory to expand series up to an order in, in numbers of one kind. */
#define NEVH__SERIES(kind, real, number)                                             \
    typedef struct nevh__series_##kind nevh__series_##kind;                          \
    nevh__series_##kind *nevh__series_new_##kind(const nevh__recurrence *,           \
                                                 size_t order);                      \
    void nevh__series_free_##kind(nevh__series_##kind *);                            \
    /* From now on time is counted in that unit: 1 at first.  By powers of two \
       this changes nothing but the exponents of coefficients. */     \
    void nevh__series_in_##kind(nevh__series_##kind *, double unit);                 \
    /* From now on values of functions are off by up to that part, each by         \
       another: as their algorithms may round them.  0 at first. */ \
    void nevh__series_away_##kind(nevh__series_##kind *, double by);                 \
    /* The coefficients at a state: rows of 2n, from that of order 0, the      \
       state itself, on.  Returns whether they are finite. */     \
    bool nevh__series_expand_##kind(nevh__series_##kind *, real t,                   \
                                    const real state[], number rows[]);              \
    /* The largest value of a node at a state.                                   \
       row  2n, out */   \
    double nevh__series_largest_##kind(nevh__series_##kind *, real t,                \
                                       const real state[], number row[]);            \
    /* The watched nodes at the state of the last expansion, for                 \
       nevh__domain_reach. */   \
    const double *nevh__series_watched_##kind(const nevh__series_##kind *);
NEVH__SERIES(double, double, double)
NEVH__SERIES(long, long double, long double)
#ifdef NEVH_QUADMATH
NEVH__SERIES(quad, nevh__wide, nevh__wide)
NEVH__SERIES(dd, nevh__wide, nevh__dd)
#endif

#endif

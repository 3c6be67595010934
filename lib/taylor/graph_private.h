/* nevh: formulas as a graph of few operations, of which Taylor coefficients
   follow by recurrences.

   Sums are binary, differences are sums with a factor of -1, quotients are
   products with a reciprocal.  Any other function f is carried by its
   derivative: y' = slope(...) x', of which slope is a node, too; so that one
   recurrence stands for them all.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_GRAPH_PRIVATE_H
#define NEVH_GRAPH_PRIVATE_H

#include "expression/tape_private.h"
#include "expression/wide_private.h"
#include "system/system_private.h"

typedef enum {
    NEVH__GRAPH_NUMBER,
    NEVH__GRAPH_VARIABLE, /* at: coordinates, momenta, time */
    NEVH__GRAPH_ADD,      /* a + b */
    NEVH__GRAPH_SCALE,    /* number a */
    NEVH__GRAPH_MULTIPLY, /* a b */
    NEVH__GRAPH_INVERT,   /* 1/a */
    NEVH__GRAPH_POWER,    /* a^number, not a whole one */
    NEVH__GRAPH_CALL,     /* f(a), or f(a, b) whose derivative by b is another
                             call's; f = nevh__tape_operation, or NEVH__NOTHING */
    NEVH__GRAPH_KINDS
} nevh__graph_kind;
/* The function that begins at 0: the second half of atan2. */
enum { NEVH__NOTHING = NEVH__OPERATION_COUNT };

typedef struct {
    uint8_t kind, function;
    uint8_t watched; /* among the edges */
    int a, b;        /* b: -1 where there is none */
    int slope;       /* of a call: the derivative by a */
    int tag; /* the same for what instances of a term do alike; rank: the
                  order of instances */
    int rank;
    size_t at;
    float degree; /* as a polynomial of variables; 0: constant, but for jumps of
                     others */
    int base;     /* a multiple of whose power the node is, */
    float power;  /* and which one; of itself, the first */
    nevh__wide number;
} nevh__graph_node;

/* A node that must keep away from 0, because a function and its derivatives change
   there: the arguments of roots, powers and logarithms, the distance of others from
   the edge of their domain, and poles that a function sees.  Or a node that must
   change little within a series: the arguments of functions that grow faster than
   any polynomial, and may be lost in rounding at its beginning. */
typedef struct {
    int node, also; /* also: of atan2, whose node is y, x; else -1 */
    int jump;    /* the node of floor or atan2, which may jump there; else -1 */
    bool strict; /* else it may touch 0: of a root that is squared again */
    bool steep;  /* of a function that grows so */
    uint8_t function;
    double exponent;    /* of steep powers */
    const char *effect; /* of the system */
} nevh__graph_edge;

/* Nodes in the order in which they were made: operands come first, but for
   slopes.  Zeros at first. */
typedef struct {
    nevh__graph_node *nodes;
    int used, capacity;
    int *table; /* open addressing; 0 is empty, else a node and 1 */
    size_t slots;
    nevh__graph_edge *edges; /* each once */
    size_t n_edges, edge_capacity;
    bool exact;      /* numbers mean no more digits than they have */
    bool failed;     /* memory is out */
    bool overflowed; /* too many nodes */
} nevh__graph;
enum { NEVH__GRAPH_NODES = 1 << 21 };

void nevh__graph_clear(nevh__graph *);

/* Each returns a node, or -1 when memory is out, now or earlier: -1 may be
   handed on.  What is the same is one node. */
int nevh__graph_number(nevh__graph *, nevh__wide);
int nevh__graph_variable(nevh__graph *, size_t at);
int nevh__graph_add(nevh__graph *, int a, int b);
int nevh__graph_scale(nevh__graph *, nevh__wide, int a);
int nevh__graph_multiply(nevh__graph *, int a, int b);
int nevh__graph_power(nevh__graph *, int a, nevh__wide exponent);
/* The cube root of a multiple of x^3, x^6 and so on, which is analytic; -1 of other
   nodes. */
int nevh__graph_cube_root(nevh__graph *, int a);
/* Any operation whose derivatives are known.  Of kinks series hold between these.
   b is a where there is one argument. */
int nevh__graph_apply(nevh__graph *, nevh__tape_operation, int a, int b);
/* A formula of operations_private.h. */
int nevh__graph_build(nevh__graph *, const char *formula, int a, int b);
/* Adds what an operation on nodes asks for; its result is another node. */
void nevh__graph_watch(nevh__graph *, unsigned operation, int a, int b,
                       const char *effect);
/* The node of half of atan2(a, b) that has its value. */
int nevh__graph_angle(nevh__graph *, int a, int b);
/* Forgets the cuts of atan2, and the jumps of floor and mod, that H does not have.
   roots   nodes that are H's values */
void nevh__graph_join_cuts(nevh__graph *, const int roots[], size_t count);
/* Which edges are jumps of H; those are, too, of which trials cannot tell.
   jumps  out, one an edge, zeros before */
void nevh__graph_find_jumps(nevh__graph *, const int roots[], size_t count,
                            unsigned char jumps[]);
/* Adds the poles that functions have been given to the edges. */
void nevh__graph_watch_poles(nevh__graph *, const char *effect);
bool nevh__graph_is_number(const nevh__graph *, int node, nevh__wide *value);

/* Why a system has no series: a status and a message in the report.
   broken  whether functions of t alone may have kinks
   slope   out, 2n: nodes of dq/dt and dp/dt, friction counted in */
int nevh__graph_of_system(nevh__graph *, const nevh_system *,
                          const nevh__wide friction[], bool broken, int slope[],
                          nevh__report *);

#endif

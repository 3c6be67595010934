/* nevh: formulas.
   SPDX-License-Identifier: GPL-3.0-or-later

   Text becomes a tree (what is written, with columns); a tree is resolved
   against names when it is used, and becomes a number, a tape over the whole
   state, or terms of a system.

   ^ (or **) binds to the right and above the sign: -2^2 = -4, 2^3^2 = 512,
   2^-1 = 0.5.  There is no implicit multiplication.  sum(i = 1..N, j = i+1..N,
   body) adds up; its ranges, and indices in x[i], are whole numbers made of
   parameters and index variables.  t is time, pi is pi.  Letters are those of
   ASCII, Latin, Greek and Cyrillic in UTF-8, and _.

   All functions are thread-safe as long as nobody changes the names. */
#ifndef NEVH_FORMULA_PRIVATE_H
#define NEVH_FORMULA_PRIVATE_H

#include "expression/tape_private.h"
#include "expression/wide_private.h"

/* The first thing that is wrong; never NULL.  Every function clears it at
   first. */
typedef struct {
    int status;             /* NEVH_OK, NEVH_EINVAL, NEVH_EDOM, NEVH_ENOMEM */
    size_t column, length;  /* from 1, in characters; 0 and 0: no place */
    const char *definition; /* in whose text the column is, a name that the
                               nevh__names own; NULL: in the text given */
    char text[300];
} nevh__formula_error;

typedef struct nevh__tree nevh__tree;

/* text     NUL-terminated UTF-8; not needed any more afterwards
   returns  NULL on error; names are looked up only when the tree is used */
nevh__tree *nevh__tree_parse(const char *text, nevh__formula_error *);
void nevh__tree_free(nevh__tree *); /* NULL is allowed */
/* typeset.c: name = formula as an element of MathML Core, to be freed; NULL:
   memory is out. */
char *nevh__equation_mathml(const char *name, const nevh__tree *);

/* The left side of a line: NAME, NAME[a], NAME[a..b] or NAME[i = a..b]. */
typedef struct {
    char *name, *index;    /* index: NULL where there is none */
    nevh__tree *from, *to; /* NULL where there is none; NAME[a] has no `to`;
                              columns are those of the whole head */
} nevh__head;
/* returns  NEVH_OK or a status, then there is nothing to free */
int nevh__head_parse(const char *text, nevh__head *, nevh__formula_error *);
void nevh__head_free(nevh__head *);

/* Insertions, deletions, replacements and swaps of neighbours that lead from
   one word to another, whatever the case; SIZE_MAX where one is very long. */
size_t nevh__words_apart(const char *, const char *);

/* Bytes until the first of the ASCII characters `stops` that stands outside
   all parentheses and brackets, or until the end. */
size_t nevh__formula_extent(const char *text, const char *stops);

/* The table of names.  Each function returns NEVH_OK or a status, with the names
   as before; an error's column is that of the name itself.  A name is refused
   when it is taken, not a name, a function's, t, pi, or begins with p_ or v_
   (momenta and velocities). */
typedef struct nevh__names nevh__names;
nevh__names *nevh__names_new(void); /* NULL when memory is out */
void nevh__names_free(nevh__names *);
/* From now on what is computed of numbers alone has the digits of nevh__wide;
   numbers that are written are doubles.  In terms a constant is a sum of
   doubles that the tape leaves for who reads it with more digits. */
void nevh__names_exact(nevh__names *);
/* The same, and constants in terms are as far from their values as rounding may
   have moved these. */
void nevh__names_away(nevh__names *);
/* count    0: one number; else an array 1 ... count
   values   in, one or count of them; copied */
int nevh__names_add_parameter(nevh__names *, const char *name, size_t count,
                              const double values[], nevh__formula_error *);
/* wide     the same values with more digits; NULL: there are none */
int nevh__names_add_wide(nevh__names *, const char *name, size_t count,
                         const double values[], const nevh__rounded wide[],
                         nevh__formula_error *);
/* count    as above; p_NAME and v_NAME come with it
   first    index of the (first) coordinate in the system */
int nevh__names_add_coordinate(nevh__names *, const char *name, size_t count,
                               size_t first, nevh__formula_error *);
/* The formula stands for the name wherever it is used, before it was added,
   too.  The tree is taken over, and freed on failure. */
int nevh__names_add_definition(nevh__names *, const char *name, nevh__tree *,
                               nevh__formula_error *);

typedef enum {
    NEVH__UNKNOWN,
    NEVH__PARAMETER,
    NEVH__COORDINATE,
    NEVH__MOMENTUM,
    NEVH__VELOCITY,
    NEVH__DEFINITION
} nevh__meaning;
/* The meaning of a name; count and first (NULL-able) as it was added. */
nevh__meaning nevh__names_find(const nevh__names *, const char *name,
                               size_t *count, size_t *first);

/* The variables, apart from parameters, that a formula may read; a set. */
enum {
    NEVH__READS_TIME = 1,
    NEVH__READS_Q = 2,
    NEVH__READS_P = 4,
    NEVH__READS_V = 8, /* v_NAME = dH/dp_NAME */
    NEVH__READS_STATE = NEVH__READS_Q | NEVH__READS_P
};

/* Checks all names of a formula, which may read `allowed`.
   reads    out, NULL-able: what it reads */
int nevh__tree_check(const nevh__tree *, const nevh__names *, unsigned allowed,
                     unsigned *reads, nevh__formula_error *);

/* The value of an index variable that stands outside all sums. */
typedef struct {
    const char *name;
    long value;
    size_t *work; /* passes through sums so far, of all values that share it;
                     NULL: each may have as many */
} nevh__index;

/* The number that a formula of parameters stands for, and of an index (NULL:
   none); NEVH_EDOM when it is not finite. */
int nevh__tree_number(const nevh__tree *, const nevh__names *,
                      const nevh__index *, double *value,
                      nevh__formula_error *);
/* The same with more digits, of names that are exact. */
int nevh__tree_wide(const nevh__tree *, const nevh__names *,
                    const nevh__index *, nevh__rounded *value,
                    nevh__formula_error *);
/* The same for what must be a whole number. */
int nevh__tree_integer(const nevh__tree *, const nevh__names *,
                       const nevh__index *, long *value, nevh__formula_error *);

/* A tape over the whole state: NEVH__Q and NEVH__P of k are the system's k-th
   coordinate and momentum, NEVH__C of k its k-th velocity.
   allowed  what the formula may read
   returns  the tape, to be freed with nevh__tape_free; NULL on error */
nevh__tape *nevh__tree_tape(const nevh__tree *, const nevh__names *,
                            unsigned allowed, nevh__formula_error *);

/* The memory that the terms of a system borrow: to be freed after it.  Zeros at
   first. */
typedef struct {
    nevh__tape **tapes;
    size_t count;
} nevh__owned;
void nevh__owned_free(nevh__owned *);

/* Adds the terms of a formula to a system, under an effect's name.

   The formula is split at its + and -, definitions written out.  A product is
   split where all factors but one read neither coordinates nor momenta (time
   is allowed), and that one is a sum; and where one factor alone is or holds
   an addend sum(...), whatever the others read.  Other products, powers and
   functions of sums are left whole.  So whatever is T(p) + V(q) up to factors
   of parameters, index variables and time becomes separable terms.

   What is inside sum(...) is split likewise, a sum within a sum counts further
   indices.  Parts of the same sum(...) (or of none) that read the same
   variables are one term, at the place of the first.  sum(...) is one term
   with an instance for each tuple of its indices; what depends on indices
   alone, such as m[i], is a constant of the instance.  Instances of which two
   indices fall on one variable are a term of their own.  A sum(...) inside a
   function is written out.  Where nothing is left to add, the term is 0.

   Parameters are bound to their values.
   cost     linear in instances, up to 2^24 of them
   returns  NEVH_OK or a status; on failure the system may hold some of the
            terms */
int nevh__tree_add_terms(const nevh__tree *, const nevh__names *, nevh_system *,
                         const char *effect, nevh__owned *,
                         nevh__formula_error *);

#endif

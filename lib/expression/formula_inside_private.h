/* nevh: inside formulas.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FORMULA_INSIDE_PRIVATE_H
#define NEVH_FORMULA_INSIDE_PRIVATE_H

#include "expression/formula_private.h"
#include "system/system_private.h"

enum {
    NEVH__FORMULA_LENGTH = 1 << 17,  /* bytes of text */
    NEVH__NAME_LENGTH = 80,          /* bytes of a name */
    NEVH__NESTING = 200,             /* of one text */
    NEVH__HEIGHT = 600,              /* with definitions written out */
    NEVH__INDICES = 64,              /* sum(...) in one formula */
    NEVH__PARTS = 10000,             /* that one formula is split into */
    NEVH__WORK = 1 << 26,            /* passes through sums of one formula */
    NEVH__INSTANCES = 1 << 24,       /* of one formula */
    NEVH__INSTANCE_LENGTH = 1 << 14, /* operations of one instance */
    NEVH__WHOLE_LENGTH = 1 << 20     /* of a tape over the whole state */
};

/* Records what is wrong unless something is wrong already; returns false. */
bool nevh__formula_fail(nevh__formula_error *, int status, size_t column,
                        size_t length, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
bool nevh__formula_no_memory(nevh__formula_error *);

/* Memory that is freed as a whole.  Zeros at first. */
typedef struct {
    struct nevh__chunk *chunks;
} nevh__pool;
void *nevh__pool_take(nevh__pool *, size_t count, size_t size); /* zeroed */
/* Moves a text of nevh__text() there; NULL, as for NULL: memory is out. */
char *nevh__pool_keep(nevh__pool *, char *text);
void nevh__pool_free(nevh__pool *);

/* Characters. */
/* The character at `text` and its bytes; 0 bytes where it is not UTF-8. */
size_t nevh__character(const char *text, uint32_t *code);
size_t nevh__characters(const char *text);
bool nevh__is_letter(uint32_t code);

/* Tokens: kinds that are one character are that character. */
enum {
    NEVH__END = 0,
    NEVH__INVALID = 1, /* the error says why */
    NEVH__NUMERAL,
    NEVH__WORD,
    NEVH__DOTS
};
typedef struct {
    int kind; /* ** is '^' */
    const char *at;
    size_t bytes, column, length;
    double number;
} nevh__token;
typedef struct {
    const char *at;
    size_t column; /* of the next character */
    nevh__formula_error *error;
} nevh__scanner;
nevh__token nevh__scan(nevh__scanner *);

/* Trees: what is written. */
typedef enum {
    NEVH__NODE_NUMBER,
    NEVH__NODE_NAME,
    NEVH__NODE_ELEMENT, /* name[first] */
    NEVH__NODE_CALL,    /* name(first, ...) */
    NEVH__NODE_LOOP,    /* sum(name = first..second, third) */
    NEVH__NODE_SUM,     /* first, then + or - (inverse) the others */
    NEVH__NODE_PRODUCT, /* the same with * and / */
    NEVH__NODE_MINUS,
    NEVH__NODE_POWER
} nevh__syntax_kind;
typedef struct nevh__syntax_node {
    nevh__syntax_kind kind;
    bool inverse;
    size_t column, length;
    double number;
    const char *name;
    struct nevh__syntax_node *first, *next; /* operands; siblings */
} nevh__syntax_node;
struct nevh__tree {
    nevh__pool pool;
    nevh__syntax_node *root;
    size_t length; /* characters */
};

/* A parser that stops where a sum of products ends. */
typedef struct {
    nevh__scanner scanner;
    nevh__token previous, token;
    nevh__pool *pool;
    size_t depth;
    nevh__formula_error *error;
} nevh__parser;
void nevh__parser_init(nevh__parser *, const char *text, nevh__pool *,
                       nevh__formula_error *);
void nevh__parser_advance(nevh__parser *);
nevh__syntax_node *nevh__parse_sum(nevh__parser *); /* NULL on error */
/* A copy of a token's text; NULL when memory is out. */
char *nevh__parser_copy(nevh__parser *, const nevh__token *);
/* Says what is wrong with the present token, and returns NULL. */
void *nevh__parser_refuse(nevh__parser *);
/* The same for a function's name without parentheses, the previous token. */
void *nevh__parser_refuse_function(nevh__parser *, const char *name);

/* The operation of a function's name or alias; NEVH__OPERATION_COUNT when
   there is none. */
nevh__tape_operation nevh__function_named(const char *name, size_t bytes);
/* Arguments as in atan2(y, x), for messages. */
const char *nevh__function_usage(nevh__tape_operation);

/* Names. */
typedef struct {
    char *name;
    nevh__meaning meaning; /* parameter, coordinate or definition */
    size_t count, first;
    double *values;
    nevh__rounded *wide; /* the same with more digits; NULL: these are all */
    nevh__tree *tree;
    size_t next; /* of the same chain, from 1; 0: none */
} nevh__entry;
enum { NEVH__CHAINS = 4096 };
struct nevh__names {
    nevh__entry *entries;
    size_t count;
    size_t chain[NEVH__CHAINS]; /* by name: the last entry, from 1; 0: none */
    bool exact, away;           /* nevh__names_exact, nevh__names_away */
};
/* meaning: also of p_NAME and v_NAME, whose entry is that of NAME. */
const nevh__entry *nevh__entry_named(const nevh__names *, const char *name,
                                     nevh__meaning *meaning);
/* More than any index of a coordinate. */
size_t nevh__names_extent(const nevh__names *);

/* Names of indices in force, the innermost first. */
typedef struct nevh__bound {
    const char *name;
    unsigned slot;
    const struct nevh__bound *outer;
} nevh__bound;
/* Says that a name is not known, with advice. */
bool nevh__refuse_name(const nevh__names *, const nevh__bound *,
                       const nevh__syntax_node *, bool in_index,
                       nevh__formula_error *);

/* Expressions: resolved, definitions written out (shared, not copied),
   parameters bound; what is made of numbers alone is a number. */
typedef enum {
    NEVH__FORM_NUMBER,
    NEVH__FORM_INDEX,     /* the value of an index variable */
    NEVH__FORM_PARAMETER, /* values[of[0] - 1] */
    NEVH__FORM_TIME,
    NEVH__FORM_VARIABLE, /* kind, first (+ of[0] - 1 where n is 1) */
    NEVH__FORM_SUM,
    NEVH__FORM_PRODUCT,
    NEVH__FORM_APPLY, /* an operation on of[0] (and of[1]) */
    NEVH__FORM_LOOP   /* the sum over slot = of[0]..of[1] of of[2] */
} nevh__form;
typedef struct nevh__expression nevh__expression;
typedef struct {
    nevh__expression *of;
    bool inverse; /* subtracted or divided by */
} nevh__expression_operand;
struct nevh__expression {
    nevh__form form;
    unsigned reads;   /* NEVH__READS_... */
    uint64_t indices; /* slots of free index variables */
    uint64_t hash;    /* of the structure */
    unsigned height;
    bool shared; /* the whole of a definition */
    bool sums;   /* a sum, under signs and factors */
    bool loops;  /* is or adds up a sum(...) that reads something */
    size_t column, length;
    const char *definition;
    const char *name; /* of an element, or of the index of a loop */
    double number;
    nevh__rounded wide_number; /* where names are exact: with more digits */
    const double *values;
    const nevh__rounded *wide_values; /* NULL: the others are all */
    nevh__variable kind;
    size_t first, count;
    nevh__tape_operation operation;
    unsigned slot;
    size_t n;
    nevh__expression_operand *operands;
    uint64_t stamp; /* the walk that saw it last, and what that made of it */
    int node;
};

/* Resolves a tree into an expression that lives in the pool.
   at       NULL: no index stands outside the sums
   returns  NULL on error */
nevh__expression *nevh__resolve(const nevh__tree *, const nevh__names *,
                                const nevh__index *at, unsigned allowed,
                                nevh__pool *, nevh__formula_error *);

/* Values of index variables, and the sums that are running; the sum(...) of a
   definition may run within itself, where one is written out and the other
   makes instances. */
typedef struct {
    double value[NEVH__INDICES];
    const nevh__expression *running[2 * NEVH__INDICES];
    size_t depth;
    size_t work; /* passes through loops so far */
    nevh__formula_error *error;
} nevh__scope;
/* An error at an expression; the values of running indices are added.
   returns  false */
bool nevh__scope_fail(nevh__scope *, int status, const nevh__expression *,
                      const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* True if a value is finite; otherwise sets an error at the expression. */
bool nevh__scope_finite(nevh__scope *, double, const nevh__expression *);
/* The number that an expression stands for that reads nothing; NaN, with an
   error, when it has none. */
double nevh__expression_value(nevh__scope *, const nevh__expression *);
/* The same with more digits. */
nevh__rounded nevh__expression_wide(nevh__scope *, const nevh__expression *);
/* A whole number, for an index or a bound (`what`). */
bool nevh__expression_integer(nevh__scope *, const nevh__expression *,
                              const char *what, long *value);
/* The index in the system of a variable, in `values` of a parameter. */
bool nevh__expression_element(nevh__scope *, const nevh__expression *,
                              size_t *index);
/* Calls visit for each value of a loop's index; false when one of them or a
   bound failed. */
bool nevh__scope_loop(nevh__scope *, const nevh__expression *loop,
                      bool (*visit)(void *), void *);

/* Parts of a formula: sums of products over the same loops, reading the same
   variables. */
typedef struct {
    bool negative;
    size_t n;
    nevh__expression_operand *factors;
} nevh__summand;
typedef struct {
    size_t n_loops;
    const nevh__expression **loops; /* the outermost first */
    unsigned reads;
    uint64_t variables; /* hash of the set of what it reads */
    size_t n, capacity;
    nevh__summand *summands;
} nevh__formula_part;
typedef struct {
    nevh__pool *pool;
    nevh__formula_error *error;
    nevh__formula_part *parts; /* freed by the caller */
    size_t n, capacity;
    size_t summands;
    uint64_t stamp;
} nevh__parts;
bool nevh__split(nevh__parts *, nevh__expression *);
/* The hash of the set of variables that a summand reads. */
bool nevh__variables_hash(nevh__parts *, const nevh__summand *, uint64_t *hash);

/* A walk through an instance.  Without a builder it notes what the instance
   needs, in the order of the walk: slots of variables and counts of loops
   (shape), and constants; with one it makes the tape from these. */
typedef struct {
    nevh__scope scope;
    nevh__tape_builder *builder;
    bool whole; /* slots are indices in the system */
    bool exact; /* constants are sums of NEVH__WIDE_PARTS numbers */
    bool away;  /* as far from their values as rounding may have moved them */
    size_t limit, length;
    uint64_t stamp;

    size_t *shape;
    size_t n_shape, shape_capacity, at_shape;
    double *constants;
    size_t n_constants, constants_capacity, at_constant;
    const int *columns; /* constant -> its slot, or -1: a number; NULL: all are
                           numbers */

    size_t *read[2]; /* by slot: coordinates, momenta */
    size_t n_read[2];
    size_t *slot[2];   /* by variable, valid where ... */
    uint64_t *seen[2]; /* ... this is the present stamp */
} nevh__walk;
bool nevh__walk_init(nevh__walk *, size_t extent, nevh__formula_error *);
void nevh__walk_clear(nevh__walk *);
/* Notes an instance; false on error. */
bool nevh__walk_note(nevh__walk *, const nevh__formula_part *);
/* Makes the tape of a noted instance; NULL on error. */
nevh__tape *nevh__walk_tape(nevh__walk *, const nevh__formula_part *);

/* Adds the terms of one part. */
typedef struct {
    nevh_system *system;
    const char *effect;
    nevh__owned *owned;
    nevh__walk walk;
    size_t instances; /* so far */
    size_t added;     /* terms so far */
} nevh__adder;
bool nevh__add_part(nevh__adder *, const nevh__formula_part *);

#endif

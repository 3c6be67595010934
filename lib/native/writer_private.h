/* nevh: C text in the making.
   SPDX-License-Identifier: GPL-3.0-or-later

   Numbers do not stand in the text but in a table, N[0], N[1] and so on, that
   is handed to the compiled function: systems that differ in parameters alone
   share one text, and so one compiled file. */
#ifndef NEVH_WRITER_PRIVATE_H
#define NEVH_WRITER_PRIVATE_H

#include "expression/tape_private.h"
#include "gradient/field_private.h"

enum { NEVH__NAME = 40 };

typedef struct {
    char *text;
    size_t used, room;
    double *numbers;
    size_t count, number_room;
    unsigned formulas;   /* written so far: names of each are its own */
    bool readable;       /* numbers stand in the text, functions are libm's */
    bool failed;         /* memory is out */
    const char *refusal; /* why there is no text; NULL: there is */
} nevh__writer;

void nevh__write(nevh__writer *, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void nevh__writer_free(nevh__writer *);
/* What a number is called. */
void nevh__write_number(nevh__writer *, double, char name[NEVH__NAME]);
/* A number as C has it. */
void nevh__number_text(double, char name[NEVH__NAME]);
/* A number that follows the last one, whatever it is: the place of the first of
   so many is the count before. */
void nevh__writer_append(nevh__writer *, double);
/* A line for each of 0 ... n - 1, in which "$" is an index. */
void nevh__write_each(nevh__writer *, size_t n, const char *line);
/* The same of few of them, else a loop: what n is up to which each has a line of
   its own. */
enum { NEVH__MOST_APART = 16 };

/* A formula at one point, or at eight of them side by side. */
typedef struct nevh__formula_text {
    const nevh__tape *tape;
    bool wide;   /* eight points */
    bool scalar; /* functions of libm, not of vectors */
    /* What a variable is called. */
    void (*variable)(nevh__writer *, const struct nevh__formula_text *,
                     nevh__variable, size_t k, char name[NEVH__NAME]);
    const void *data;
    size_t instance;
    /* Set by what is written. */
    unsigned id;
    bool numbered;
    size_t first_number;
} nevh__formula_text;

/* Writes statements that take the value.
   result  out: its name */
bool nevh__write_value(nevh__writer *, nevh__formula_text *,
                       char result[NEVH__NAME]);
/* Writes statements that take the value and derivatives by what is wanted, an
   or of NEVH__BY_Q and so on: names are those of nevh__derivative_name, where the
   tape reads the variable.  Where the value is not finite, but the derivatives
   may be, it is added to `bad`. */
bool nevh__write_gradient(nevh__writer *, nevh__formula_text *,
                          unsigned wanted);
/* The same by the complex step: the derivative by one variable, times that
   step. */
bool nevh__write_complex(nevh__writer *, nevh__formula_text *,
                         nevh__variable by, size_t k, char result[NEVH__NAME]);
void nevh__derivative_name(const nevh__formula_text *, nevh__variable, size_t k,
                           char name[NEVH__NAME]);

/* What formulas need before them. */
void nevh__write_prelude(nevh__writer *);

/* The beginning of the function that takes steps: state and memory. */
void nevh__write_head(nevh__writer *, size_t n);

/* double slope of H: a function
       SLOPE double NAME(const double *N, double t, const double *q,
                         const double *p, double *slope)
   that writes n numbers, and returns something that is 0 if all is well. */
bool nevh__write_slope(nevh__writer *, nevh_field *, bool kick,
                       const char *name);
/* Operations in the text of both halves. */
double nevh__slope_operations(const nevh_field *);
/* Values of each term that a slope takes, to values[]; 0 where it is exact. */
void nevh__slope_values(const nevh_field *, bool kick, uint64_t values[]);

/* The processor's vectors, as the library's own blocks take them: 8, 4, 2
   doubles, or 1: there are none. */
int nevh__vector_lanes(void);

#endif

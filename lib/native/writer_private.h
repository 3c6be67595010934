/* nevh: C text in the making.
   SPDX-License-Identifier: GPL-3.0-or-later

   Numbers do not stand in the text but in a table, N[0], N[1] and so on, that
   is handed to the compiled function: systems that differ in parameters alone
   share one text, and so one compiled file. */
#ifndef NEVH_WRITER_PRIVATE_H
#define NEVH_WRITER_PRIVATE_H

#include "expression/tape_private.h"
#include "gradient/field_private.h"

enum { NEVH__CALLERS = 3 };
enum { NEVH__NAME = 40, NEVH__MOST_SHARED = 32, NEVH__MOST_FORMS = 16 };

/* Numbers that stand in the table once, and where. */
typedef struct {
    const double *numbers;
    size_t count, first;
} nevh__shared_numbers;

/* Numbers that each orbit of a vector has of its own, and where: `times` what a row of
   all lanes says. */
typedef struct {
    const double *row;
    double times;
    size_t first;
} nevh__lane_numbers;

typedef struct {
    char *text;
    size_t used, room;
    double *numbers;
    size_t count, number_room;
    nevh__shared_numbers shared[NEVH__MOST_SHARED];
    size_t shared_count;
    bool by_lane; /* orbits side by side have numbers of their own: N is that of
                     a vector of them, TABLE(b) */
    nevh__lane_numbers *own;
    size_t own_count, own_room;
    unsigned formulas; /* written so far: names of each are its own */
    size_t width;      /* orbits side by side, as vectors; 1: one orbit */
    size_t group;      /* vectors of them that a step takes at once; 0: one */
    bool stages;       /* those of an implicit step are, of one orbit; for
                            readers one after the other */
    bool loops;        /* over instances; the state is rows of vectors */
    bool takes_steps;  /* several at once: there is a function take_steps */
    bool own_time;     /* steps of a program take times of their own */
    size_t rows;       /* of DOF vectors, for them */
    const struct nevh__watched
        *watched;            /* what is found of each state; or NULL */
    const nevh_field *field; /* for that */
    bool readable;           /* numbers stand in the text */
    const char
        *forms[NEVH__MOST_FORMS]; /* for readers: names that are defined */
    size_t form_count;
    size_t n;
    char (*names)[NEVH__NAME]; /* of q, and of p, in a text for readers; "": it
                                  has none that C takes */
    unsigned
        calls[NEVH__CALLERS]; /* elementary functions: bits, of one number, of
                                      four and of eight */
    size_t elementary;        /* characters of these functions */
    bool failed;              /* memory is out */
    const char *refusal;      /* why there is no text; NULL: there is */
} nevh__writer;

void nevh__write(nevh__writer *, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* A text in which $1, $2 and so on stand for words. */
void nevh__write_filled(nevh__writer *, const char *text,
                        const char *const words[]);
void nevh__writer_free(nevh__writer *);
/* Names a number. */
void nevh__write_number(nevh__writer *, double, char name[NEVH__NAME]);
/* Names the numbers of a vector of lanes. */
void nevh__write_own(nevh__writer *, const double row[], double times,
                     char name[NEVH__NAME]);
/* A number as C has it. */
void nevh__number_text(double, char name[NEVH__NAME]);
/* A number that follows the last one, whatever it is: the place of the first of
   so many is the count before. */
void nevh__writer_append(nevh__writer *, double);
/* The place of numbers that do not change: of all who ask for those at one
   address it is the same, so that compilers find what formulas have in common.
*/
size_t nevh__writer_share(nevh__writer *, size_t count, const double x[]);
/* NAME[count] = {...}; as C has it. */
void nevh__write_numbers(nevh__writer *, const char *name, size_t count,
                         const double x[]);
/* An array of numbers, "static const double NAME", or a part of the table, whose
   name is `table` where the array is read. */
void nevh__write_array(nevh__writer *, const char *name, const char *table,
                       size_t count, const double x[]);
/* A number: the same, or of the table N. */
void nevh__write_constant(nevh__writer *, const char *name, double);
/* A name that conditions of headers ask for, "#ifdef NAME". */
void nevh__write_form(nevh__writer *, const char *name);
void nevh__write_lines(nevh__writer *, const char *const lines[]);
/* Variables get names in C like those of the coordinates, n; false when memory
   is out. */
bool nevh__writer_name(nevh__writer *, size_t n, const char *const names[]);
/* Names q[k] or p[k]; writes declarations of the names that terms have but for
   loops. */
void nevh__state_name(const nevh__writer *, bool momentum, size_t k,
                      char name[NEVH__NAME]);
void nevh__write_state_names(nevh__writer *, const nevh_field *);
/* Letters, digits and what names of elements have; anything else of a scene's
   word stays out of the text. */
void nevh__write_word(nevh__writer *, const char *word);
/* A comment: which term follows. */
void nevh__write_effect(nevh__writer *, const nevh_term *);
/* True if anything stands side by side. */
static inline bool nevh__has_lanes(const nevh__writer *w) {
    return w->width > 1 || (w->stages && !w->readable);
}
/* Orbits, or stages, in a vector of them, "wide". */
size_t nevh__orbits_together(const nevh__writer *);
/* "double", or what stands side by side. */
const char *nevh__number_type(const nevh__writer *);

/* Headers of kernels, and of steps/, line by line, ended by NULL: made from them
   by kernel_texts.awk.  What NEVH__COMPILED stands for is left out for readers. */
extern const char *const nevh__splitting_step_text[];
extern const char *const nevh__stage_progress_text[];
extern const char *const nevh__stage_judge_text[];
extern const char *const nevh__stage_step_text[];
extern const char *const nevh__stage_sums_text[];
extern const char *const nevh__runge_kutta_step_text[];
extern const char *const nevh__nystrom_step_text[];
extern const char *const nevh__tao_step_text[];
extern const char *const nevh__parts_scheme_text[];
extern const char *const nevh__parts_step_text[];
extern const char *const nevh__adaptive_verlet_step_text[];
extern const char *const nevh__pace_text[];
extern const char *const nevh__adaptive_step_text[];
extern const char *const nevh__adaptive_driver_text[];
extern const char *const nevh__adaptive_verlet_driver_text[];
extern const char *const nevh__implicit_driver_text[];
extern const char *const nevh__implicit_orbit_text[];
extern const char *const nevh__implicit_lanes_text[];
extern const char *const nevh__tao_driver_text[];
extern const char *const nevh__parts_driver_text[];
extern const char *const nevh__steps_call_text[];
extern const char *const nevh__entry_text[];
extern const char *const nevh__runge_kutta_driver_text[];
extern const char *const nevh__nystrom_driver_text[];
extern const char *const nevh__splitting_first_text[];
extern const char *const nevh__splitting_whole_text[];
extern const char *const nevh__splitting_parts_text[];
extern const char *const nevh__splitting_groups_text[];
extern const char *const nevh__block_driver_text[];
extern const char *const nevh__long_driver_text[];
extern const char *const nevh__compiled_needs_text[];
extern const char *const nevh__program_needs_text[];
extern const char *const nevh__program_main_text[];
extern const char *const nevh__formula_needs_text[];
extern const char *const nevh__elementary_number_text[];
extern const char *const nevh__elementary_text_text[];
extern const char *const nevh__elementary_edges_text[];
extern const char *const nevh__elementary_lanes_text[];
extern const char *const nevh__compiled_formulas_text[];
extern const char *const nevh__loop_needs_text[];
extern const char *const nevh__series_sums_text[];
extern const char *const nevh__fraction_text[];

/* The words of C text for numbers side by side. */
typedef struct {
    const char *type;
    const char *all;  /* so many times one number */
    const char *each; /* a loop over them */
    const char *call; /* what a function's name begins with */
} nevh__lane_words;
extern const nevh__lane_words nevh__eight, nevh__four;

/* A formula at one point, or at several of them side by side. */
typedef struct nevh__formula_text {
    const nevh__tape *tape;
    const nevh__lane_words *lanes; /* NULL: one point */
    /* Names a variable. */
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

/* Characters that take a compiler as long: those of elementary functions take less. */
size_t nevh__compiled_characters(const nevh__writer *);
/* Writes before a text what formulas need: elementary functions, as far as it calls
   them. */
void nevh__write_prelude(nevh__writer *text);
void nevh__write_elementary_numbers(nevh__writer *, const nevh__writer *text);
/* "nevh__one_" or the like: what the name of an elementary function begins with;
   notes that the text calls it.  lanes: NULL for one number */
const char *nevh__elementary_call(nevh__writer *, const nevh__lane_words *lanes,
                                  const char *function);

/* After w->group was chosen: what kernels' texts need; finite: nevh__not_finite, sums: stage_sums.  DOF is the
   numbers of a half of a step's state. */
void nevh__write_needs(nevh__writer *, size_t n, bool finite, bool sums);
/* A list of sums over stages, "sums": the weights of each that are not 0, and
   whose slopes they are for, which are so far apart (a text). */
enum { NEVH__MOST_SUMS = 64 };
typedef struct {
    size_t rows, count[NEVH__MOST_SUMS];
} nevh__sums_text;
void nevh__write_sum(nevh__writer *, nevh__sums_text *, const double weights[],
                     size_t count, const char *apart);
void nevh__write_sums(nevh__writer *, const nevh__sums_text *);
/* The function that takes steps, of
       take_step(N, W, T, operations, t, h, y, lost, kept)
   which returns 0 if all is well; for readers take_step(t, h, y, lost)
   or, where slopes are kept, take_step(t, h, y, lost, kept).  Where
   w->takes_steps it is of
       take_steps(N, W, T, operations, t0, h, from, steps, y, lost, kept, room,
                  done)
   which adds to `done` how many steps are fine, and returns whether it is all
   that were taken, of up to `steps`.
   rows  of DOF numbers that a step has in its room where a state is long */
void nevh__write_driver(nevh__writer *, bool keeps, size_t rows);
/* TABLE(b), the numbers of a vector of orbits; none is added later. */
void nevh__write_table(nevh__writer *);
/* Writes that function by the text's own function advance. */
void nevh__write_entry(nevh__writer *);

/* Functions kick_slope and drift_slope
       NUMBER NAME(const double *N, double t, const NUMBER *q,
                   const NUMBER *p, NUMBER *slope)
   that write dH/dq and dH/dp, n numbers, and return something that is 0 if all is
   well.  They are called so many times in the text.  Loops have two arguments
   more, the first slope that is wanted and the one after the last: multiples of
   8.  Of a field that is divided they are of what kicks, and there is inner_slope, of
   inner terms. */
#define NEVH__ALL_SLOPES ", 0, 8 * DOF"
bool nevh__write_slopes(nevh__writer *, nevh_field *, size_t calls);
/* True if terms have so many instances that they are loops. */
bool nevh__has_loops(const nevh_field *);
/* The distance of the variables, at most, that an instance of a term reads;
   SIZE_MAX: its instances do not follow one another through the state. */
size_t nevh__slope_reach(nevh__writer *, nevh_field *, bool kick);
/* A function worst_noise(N, t, y, scale, bad): what rounding in H adds to
   derivatives by differences at the state y, the largest over a scale; of a
   field whose gradients are differences. */
bool nevh__write_noise(nevh__writer *, const nevh_field *);
/* Values that are found of each state as steps are taken of orbits side by side: of
   formulas of coordinates and momenta, and of H. */
typedef struct nevh__watched {
    const nevh__tape *const *tapes;
    size_t count;
    bool energy;
} nevh__watched;
static inline size_t nevh__watched_rows(const nevh__watched *x) {
    return x->count + x->energy;
}
/* A function watch(N, y, to) that writes a row of each to `to`.  false: there is no
   text, and w->refusal may say why. */
bool nevh__write_watch(nevh__writer *);
/* For readers: a function energy(t, q, p), the value of H.  false: there is no
   text of a term, and w->refusal says why. */
bool nevh__write_energy(nevh__writer *, const nevh_field *);
/* Values of each term that a slope takes, to values[]; 0 where it is exact. */
void nevh__slope_values(const nevh_field *, bool kick, uint64_t values[]);

/* The processor's vectors, as the library's own blocks take them: 8, 4, 2
   doubles, or 1: there are none. */
int nevh__vector_lanes(void);
/* Lanes of the longest vectors in texts: eight where the processor has such, else four.
   Through memory GCC takes vectors that are longer than those of the processor. */
size_t nevh__lanes_together(void);

#endif

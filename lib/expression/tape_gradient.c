/* nevh: exact derivatives of a tape by one reverse sweep.

   Operations are carried out forwards; what a result overwrites goes to a
   journal.  Backwards, each hands its adjoint on to its arguments and puts back
   what its slot held, so that a slot may be used again and again.  Where the
   journal of the whole tape would not fit, the first half is run, its slots are
   kept, the second half is swept, and the first half is swept after it, halved
   again if need be [A. Griewank, "Achieving logarithmic growth of temporal and
   spatial complexity in reverse automatic differentiation", Optim. Methods
   Softw. 1 (1992) 35-54].
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "expression/tape_operations_private.h"
#include <string.h>

/* Doubles on the stack: of most formulas, of long ones, of the longest. */
enum { LITTLE = NEVH__TAPE_SCRATCH, MORE = 4 * LITTLE, MOST = 32 * LITTLE };

typedef struct {
    const nevh__tape *tape;
    nevh__rows rows;
    double *base[NEVH__KINDS]; /* adjoints; pitches are those of the rows */
    unsigned wanted;           /* an or of NEVH__BY_Q and so on */
} sweep;

/* The row of adjoints of an operand; NULL when it is not wanted. */
static inline double *adjoint(const sweep *s, nevh__tape_operand o) {
    return o.by & s->wanted ? s->base[o.kind] + o.at * s->rows.pitch[o.kind]
                            : NULL;
}

/* The adjoint of an argument before its last use. */
static const double nothing[NEVH__TAPE_COLUMNS];

/* A slot was another's before: it gets back what that one left.  Returns where
   the journal then ends. */
static const double *put_back(const sweep *s, uint32_t slot,
                              const double *journal) {
    size_t columns = s->rows.columns, bytes = columns * sizeof *journal;
    memcpy(s->rows.slots + slot * columns, journal - columns, bytes);
    return journal - columns;
}

/* One operation's adjoints g times its derivative by one argument are added to
   those of the argument, d; its last use comes first, and adds to nothing. */
#define EACH(product)                                                          \
    for (size_t i = 0; i < columns; i += 8) {                                  \
        const double *x = from_a + i * step_a, *z = from_b + i * step_b;       \
        NEVH_LANES(lane, 8) {                                                  \
            double a = x[lane], b = z[lane], y = from_y[i + lane];             \
            double g = from_g[i + lane];                                       \
            (void)a, (void)b, (void)y, (void)g;                                \
            d[i + lane] = sum[i + lane] + product;                             \
        }                                                                      \
    }                                                                          \
    break;
#define CASE_A(kind, identifier, name, arity, value, by_a, by_b, ...)          \
    case NEVH__##identifier:                                                   \
        EACH(by_a)
#define CASE_B(kind, identifier, name, arity, value, by_a, by_b, ...)          \
    case NEVH__##identifier:                                                   \
        EACH(by_b)
#define ROWS(argument)                                                         \
    size_t columns = s->rows.columns;                                          \
    const double *from_a = nevh__rows_at(&s->rows, at->a);                     \
    const double *from_b = nevh__rows_at(&s->rows, at->b);                     \
    const double *from_y = s->rows.slots + at->to * columns;                   \
    const double *from_g = s->base[NEVH__SLOT] + at->to * columns;             \
    const double *sum = argument.last ? nothing : d;                           \
    size_t step_a = at->a.kind != NEVH__NUMBER;                                \
    size_t step_b = at->b.kind != NEVH__NUMBER

NEVH__INLINE void hand_on_a(const sweep *s, const nevh__instruction *at,
                            double *d) {
    ROWS(at->a);
    const double *from_cosine = s->rows.slots + at->also * columns;
    const double *from_g_cosine = s->base[NEVH__SLOT] + at->also * columns;
    switch (at->operation) {
        NEVH__OPERATIONS(CASE_A)
    case NEVH__SINCOS:
        EACH(nevh__chain(g, from_cosine[i + lane]) -
             nevh__chain(from_g_cosine[i + lane], y))
    }
}

NEVH__INLINE void hand_on_b(const sweep *s, const nevh__instruction *at,
                            double *d) {
    ROWS(at->b);
    switch (at->operation) { NEVH__OPERATIONS(CASE_B) }
}

/* journal: where it ends. */
NEVH_SIMD static void backwards(const sweep *s, size_t from, size_t until,
                                const double *journal) {
    const nevh__instruction *code = s->tape->code;
    for (const nevh__instruction *at = code + until; at-- > code + from;) {
        double *d_a = adjoint(s, at->a), *d_b = adjoint(s, at->b);
        if (d_a)
            hand_on_a(s, at, d_a);
        if (d_b)
            hand_on_b(s, at, d_b);
        if (!at->also_fresh)
            journal = put_back(s, at->also, journal);
        if (!at->fresh)
            journal = put_back(s, at->to, journal);
    }
}
#undef EACH
#undef CASE_A
#undef CASE_B
#undef ROWS

/* 1, but NaN where the value is not finite. */
static void seed(const sweep *s) {
    const double *h = nevh__rows_at(&s->rows, s->tape->result);
    double *d = adjoint(s, s->tape->result);
    for (size_t i = 0; d && i < s->rows.columns; i++)
        d[i] = h[i] - h[i] + 1;
}

/* `capacity` doubles are free from `scratch` on. */
static void run_back(const sweep *s, size_t from, size_t until, double *scratch,
                     size_t capacity) {
    const nevh__instruction *code = s->tape->code;
    size_t length = until - from,
           rows = code[until].journal - code[from].journal;
    if (rows * s->rows.columns <= capacity) {
        double *end = nevh__rows_run(&s->rows, code + from, length, scratch);
        if (until == s->tape->length)
            seed(s);
        backwards(s, from, until, end);
        return;
    }
    size_t kept = s->tape->slots * s->rows.columns, half = length / 2;
    memcpy(scratch, s->rows.slots, kept * sizeof *scratch);
    nevh__rows_run(&s->rows, code + from, half, NULL);
    run_back(s, from + half, until, scratch + kept, capacity - kept);
    memcpy(s->rows.slots, scratch, kept * sizeof *scratch);
    run_back(s, from, from + half, scratch, capacity);
}

static void tape_gradient_clear(double d[], size_t rows, size_t width,
                                size_t columns) {
    for (size_t k = 0; d && k < rows; k++)
        memset(d + k * width, 0, columns * sizeof *d);
}

typedef struct {
    const double *t, *q, *p, *c;
    double *dh_dq, *dh_dp, *dh_dt;
    const nevh__tape *tape;
    size_t width;
} task;

static void sweep_columns(const task *job, size_t from, size_t columns,
                          double *scratch, size_t capacity) {
    const nevh__tape *tape = job->tape;
    size_t slots = tape->slots * columns;
    sweep s = {
        .tape = tape,
        .rows = nevh__rows_of(tape, job->width, from, columns, job->t, job->q,
                              job->p, job->c, scratch),
        .wanted = (job->dh_dq ? NEVH__BY_Q : 0u) |
                  (job->dh_dp ? NEVH__BY_P : 0u) |
                  (job->dh_dt ? NEVH__BY_T : 0u),
    };
    s.base[NEVH__T] = job->dh_dt ? job->dh_dt + from : NULL;
    s.base[NEVH__Q] = job->dh_dq ? job->dh_dq + from : NULL;
    s.base[NEVH__P] = job->dh_dp ? job->dh_dp + from : NULL;
    s.base[NEVH__SLOT] = scratch + slots;
    tape_gradient_clear(s.base[NEVH__T], 1, job->width, columns);
    tape_gradient_clear(s.base[NEVH__Q], tape->count[NEVH__Q], job->width,
                        columns);
    tape_gradient_clear(s.base[NEVH__P], tape->count[NEVH__P], job->width,
                        columns);
    run_back(&s, 0, tape->length, scratch + 2 * slots, capacity - 2 * slots);
}

static size_t tape_gradient_smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

/* Rows that the journal of so many operations takes at most. */
static size_t longest_journal(const nevh__tape *tape, size_t length) {
    return tape_gradient_smaller(tape->code[tape->length].journal, 2 * length);
}

/* Doubles that `columns` columns take without halves. */
static size_t whole(const nevh__tape *tape, size_t columns) {
    return columns * (2 * tape->slots + longest_journal(tape, tape->length));
}

static void sweep_all(const task *job, double *scratch, size_t capacity) {
    size_t most = NEVH__TAPE_COLUMNS, columns;
    while (most > NEVH__LANES && whole(job->tape, most) > capacity)
        most /= 2;
    for (size_t from = 0; from < job->width; from += columns) {
        columns = job->width - from < most ? job->width - from : most;
        sweep_columns(job, from, columns, scratch, capacity);
    }
}

/* True if halving ends with a journal that fits. */
static bool is_enough(const nevh__tape *tape, size_t capacity) {
    size_t kept = NEVH__LANES * tape->slots, length = tape->length;
    for (size_t used = 2 * kept; used <= capacity; used += kept) {
        if (NEVH__LANES * longest_journal(tape, length) <= capacity - used)
            return true;
        length = (length + 1) / 2;
    }
    return false;
}

/* Apart, so that most tapes do with little of the stack. */
#define SWEEP(name, capacity)                                                  \
    __attribute__((noinline)) static void name(const task *job) {              \
        _Alignas(64) double scratch[capacity];                                 \
        sweep_all(job, scratch, capacity);                                     \
    }
SWEEP(sweep_little, LITTLE)
SWEEP(sweep_more, MORE)
SWEEP(sweep_most, MOST)

/* Little has to do without halves, which would take time. */
static void sweep_task(const task *job) {
    if (whole(job->tape, NEVH__TAPE_COLUMNS / 2) <= LITTLE)
        sweep_little(job);
    else if (is_enough(job->tape, MORE))
        sweep_more(job);
    else
        sweep_most(job);
}

void nevh__tape_block_gradient(size_t width, const double t[], const double q[],
                               const double p[], const double c[],
                               const void *tape, double dh_dq[],
                               double dh_dp[]) {
    sweep_task(&(task){.t = t,
                       .q = q,
                       .p = p,
                       .c = c,
                       .dh_dq = dh_dq,
                       .dh_dp = dh_dp,
                       .tape = tape,
                       .width = width});
}

void nevh__tape_block_time(size_t width, const double t[], const double q[],
                           const double p[], const double c[], const void *tape,
                           double dh_dt[]) {
    sweep_task(&(task){.t = t,
                       .q = q,
                       .p = p,
                       .c = c,
                       .dh_dt = dh_dt,
                       .tape = tape,
                       .width = width});
}

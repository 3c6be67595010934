/* nevh: a tape as C text.

   Text and tape do the same operations in the same order, but for one:
   0 times infinity is NaN here where the chain rule of the tape has 0: who calls
   such text looks for NaN, and asks the tape.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "native/operation_text_private.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Places of a tape's numbers: the operation that wrote what a slot holds. */
typedef struct nevh__reading {
    uint32_t *a, *b;  /* by operation: which wrote its operand */
    uint32_t *holder; /* by slot, for now */
    double *bound;    /* by result: it is smaller, if all it reads is finite */
    bool *cosine;     /* by operand, whether it is the second result */
    bool *begun, *begun_cosine; /* by result: whether it has an adjoint */
    bool *variable[NEVH__VARIABLES];
    uint32_t last; /* which wrote the tape's result, if a slot holds that */
    bool last_cosine;
} reading;

static void free_reading(reading *r) {
    free(r->a);
    free(r->holder);
    free(r->bound);
    free(r->cosine);
}

static bool new_reading(const nevh__tape *tape, reading *r) {
    size_t n = tape->length, variables = 0;
    *r = (reading){0};
    for (size_t v = 0; v < NEVH__VARIABLES; v++)
        variables += tape->count[v];
    r->a = nevh__array(2 * n, sizeof *r->a);
    r->holder = nevh__array(2 * tape->slots, sizeof *r->holder);
    r->bound = nevh__array(2 * n, sizeof *r->bound);
    r->cosine = nevh__array(4 * n + variables, sizeof *r->cosine);
    if (!r->a || !r->holder || !r->bound || !r->cosine) {
        free_reading(r);
        return false;
    }
    r->b = r->a + n;
    r->begun = r->cosine + 2 * n;
    r->begun_cosine = r->begun + n;
    bool *at = r->begun_cosine + n;
    for (size_t v = 0; v < NEVH__VARIABLES; at += tape->count[v++])
        r->variable[v] = at;
    return true;
}

/* Results are called v3_7, operation 7 of formula 3, and cosines beside a sine
   w3_7; adjoints dv3_7 and dw3_7. */
static void result_name(const nevh__formula_text *f, uint32_t at, bool cosine,
                        char name[NEVH__NAME]) {
    snprintf(name, NEVH__NAME, "%c%u_%u", cosine ? 'w' : 'v', f->id, at);
}

/* Factors that compilers may leave out stand in the text. */
static bool is_plain(double x) {
    return fabs(x) == 0.5 || fabs(x) == 1 || fabs(x) == 2;
}

static void operand_name(nevh__writer *w, const nevh__formula_text *f,
                         nevh__tape_operand o, uint32_t from, bool cosine,
                         char name[NEVH__NAME]) {
    bool number = o.kind == NEVH__NUMBER;
    if (o.kind == NEVH__SLOT)
        result_name(f, from, cosine, name);
    else if (number && (w->readable || is_plain(f->tape->numbers[o.at])))
        nevh__number_text(f->tape->numbers[o.at], name);
    else if (number)
        snprintf(name, NEVH__NAME, "N[%zu]", f->first_number + o.at);
    else
        f->variable(w, f, (nevh__variable)o.kind, o.at, name);
    if (f->lanes && number) {
        char plain[NEVH__NAME];
        memcpy(plain, name, sizeof plain);
        snprintf(name, NEVH__NAME, "%s(%.30s)", f->lanes->all, plain);
    }
}

static double bound_of(const nevh__formula_text *f, const reading *r,
                       nevh__tape_operand o, uint32_t from, bool cosine) {
    if (o.kind == NEVH__SLOT)
        return cosine ? 1 : r->bound[from];
    return o.kind == NEVH__NUMBER ? fabs(f->tape->numbers[o.at]) : INFINITY;
}

static const char *type_of(const nevh__formula_text *f) {
    return f->lanes ? f->lanes->type : "double";
}

/* One operation's operands and results. */
typedef struct {
    char a[NEVH__NAME], b[NEVH__NAME], y[NEVH__NAME], also[NEVH__NAME];
} names;

static void find_names(nevh__writer *w, const nevh__formula_text *f,
                       const reading *r, uint32_t i, names *x) {
    const nevh__instruction *at = &f->tape->code[i];
    operand_name(w, f, at->a, r->a[i], r->cosine[2 * i], x->a);
    operand_name(w, f, at->b, r->b[i], r->cosine[2 * i + 1], x->b);
    result_name(f, i, false, x->y);
    result_name(f, i, true, x->also);
}

/* Which operations wrote the operands of one, and where it writes. */
static void trace(const nevh__formula_text *f, reading *r, uint32_t i) {
    const nevh__instruction *at = &f->tape->code[i];
    const nevh__tape_operand operands[] = {at->a, at->b};
    uint32_t *from[] = {&r->a[i], &r->b[i]};
    size_t slots = f->tape->slots;
    for (size_t k = 0; k < 2; k++)
        if (operands[k].kind == NEVH__SLOT) {
            *from[k] = r->holder[operands[k].at];
            r->cosine[2 * i + k] = r->holder[slots + operands[k].at];
        }
    double a = bound_of(f, r, at->a, r->a[i], r->cosine[2 * i]);
    double b = bound_of(f, r, at->b, r->b[i], r->cosine[2 * i + 1]);
    r->bound[i] = nevh__operation_bound(at->operation, a, b);
    r->holder[at->to] = i;
    r->holder[slots + at->to] = 0;
    if (at->operation == NEVH__SINCOS) {
        r->holder[at->also] = i;
        r->holder[slots + at->also] = 1;
    }
}

/* The tape's numbers, once for all instances of a formula. */
static void write_numbers(nevh__writer *w, nevh__formula_text *f) {
    const nevh__tape *tape = f->tape;
    size_t count = 0;
    if (f->numbered || w->readable)
        return;
    for (size_t i = 0; i <= tape->length; i++) {
        nevh__tape_operand a =
            i < tape->length ? tape->code[i].a : tape->result;
        nevh__tape_operand b =
            i < tape->length ? tape->code[i].b : tape->result;
        if (a.kind == NEVH__NUMBER && a.at >= count)
            count = a.at + 1;
        if (b.kind == NEVH__NUMBER && b.at >= count)
            count = b.at + 1;
    }
    f->first_number = nevh__writer_share(w, count, tape->numbers);
    f->numbered = true;
}

static bool write_forwards(nevh__writer *w, nevh__formula_text *f, reading *r,
                           char result[NEVH__NAME], double *most) {
    const nevh__tape *tape = f->tape;
    f->id = w->formulas++;
    write_numbers(w, f);
    for (uint32_t i = 0; i < tape->length; i++) {
        const nevh__instruction *at = &tape->code[i];
        names x;
        if (nevh__operation_is_special(at->operation)) {
            w->refusal = "it calls a function that compiled steps do not have";
            return false;
        }
        trace(f, r, i);
        find_names(w, f, r, i, &x);
        nevh__operation_names m = {x.a, x.b, NULL, NULL, f->lanes};
        bool pair = at->operation == NEVH__SINCOS;
        nevh__write_operation(w, pair ? NEVH__SIN : at->operation,
                              NEVH__OPERATION_VALUE, x.y, &m);
        if (pair)
            nevh__write_operation(w, NEVH__COS, NEVH__OPERATION_VALUE, x.also,
                                  &m);
    }
    nevh__tape_operand o = tape->result;
    if (o.kind == NEVH__SLOT) {
        r->last = r->holder[o.at];
        r->last_cosine = r->holder[tape->slots + o.at];
    }
    operand_name(w, f, o, r->last, r->last_cosine, result);
    *most = bound_of(f, r, o, r->last, r->last_cosine);
    return true;
}

bool nevh__write_value(nevh__writer *w, nevh__formula_text *f,
                       char result[NEVH__NAME]) {
    reading r;
    double most;
    if (!new_reading(f->tape, &r)) {
        w->failed = true;
        return false;
    }
    bool fine = write_forwards(w, f, &r, result, &most);
    free_reading(&r);
    return fine;
}

void nevh__derivative_name(const nevh__formula_text *f, nevh__variable kind,
                           size_t k, char name[NEVH__NAME]) {
    snprintf(name, NEVH__NAME, "d%u%c%zu", f->id, "tqpc"[kind], k);
}

/* The adjoint of an operand, and whether there was something before. */
static bool *adjoint_name(const nevh__formula_text *f, const reading *r,
                          nevh__tape_operand o, uint32_t from, bool cosine,
                          char name[NEVH__NAME]) {
    if (o.kind != NEVH__SLOT) {
        nevh__derivative_name(f, (nevh__variable)o.kind, o.at, name);
        return &r->variable[o.kind][o.at];
    }
    snprintf(name, NEVH__NAME, "d%c%u_%u", cosine ? 'w' : 'v', f->id, from);
    return cosine ? &r->begun_cosine[from] : &r->begun[from];
}

/* The adjoint of an operation's result is handed on to one argument. */
static void formula_text_hand_on(nevh__writer *w, const nevh__formula_text *f,
                                 const reading *r, uint32_t i, bool second,
                                 const names *x) {
    const nevh__instruction *at = &f->tape->code[i];
    nevh__tape_operand o = second ? at->b : at->a;
    char to[NEVH__NAME], g[NEVH__NAME], g_cosine[NEVH__NAME],
        product[NEVH__NAME];
    bool *begun = adjoint_name(f, r, o, second ? r->b[i] : r->a[i],
                               r->cosine[2 * i + second], to);
    snprintf(g, sizeof g, "dv%u_%u", f->id, i);
    snprintf(g_cosine, sizeof g_cosine, "dw%u_%u", f->id, i);
    snprintf(product, sizeof product, "%c%u_%u", second ? 'f' : 'e', f->id, i);
    if (at->operation == NEVH__SINCOS) {
        /* As the tape has it: one after the other. */
        if (*begun)
            nevh__write(w, "    %s = %s + %s * %s - %s * %s;\n", to, to, g,
                        x->also, g_cosine, x->y);
        else
            nevh__write(w, "    %s %s = %s * %s - %s * %s;\n", type_of(f), to,
                        g, x->also, g_cosine, x->y);
        *begun = true;
        return;
    }
    nevh__write_operation(
        w, at->operation, second ? NEVH__OPERATION_BY_B : NEVH__OPERATION_BY_A,
        product, &(nevh__operation_names){x->a, x->b, x->y, g, f->lanes});
    if (*begun)
        nevh__write(w, "    %s += %s;\n", to, product);
    else
        nevh__write(w, "    %s %s = %s;\n", type_of(f), to, product);
    *begun = true;
}

static void write_backwards(nevh__writer *w, const nevh__formula_text *f,
                            const reading *r, unsigned wanted) {
    const nevh__tape *tape = f->tape;
    for (uint32_t i = (uint32_t)tape->length; i-- > 0;) {
        const nevh__instruction *at = &tape->code[i];
        names x;
        if (!((at->a.by | at->b.by) & wanted))
            continue;
        find_names(w, f, r, i, &x);
        if (at->a.by & wanted)
            formula_text_hand_on(w, f, r, i, false, &x);
        if (at->b.by & wanted)
            formula_text_hand_on(w, f, r, i, true, &x);
    }
}

/* A sum of values is not finite where one of them is not; that of slopes is looked
   at when they are there. */
static void write_check(nevh__writer *w, const char *value) {
    if (w->readable)
        nevh__write(w, "    bad += %s - %s;\n", value, value);
    else
        nevh__write(w, "    bad += %s;\n", value);
}

/* |c| of a number c, else NAN. */
static double formula_text_size_of(const nevh__tape *tape,
                                   nevh__tape_operand o) {
    return o.kind == NEVH__NUMBER ? fabs(tape->numbers[o.at]) : NAN;
}

/* A number that is finite where the value is: the value without a sign and factors
   up to 1. */
static void finite_with(nevh__writer *w, const nevh__formula_text *f,
                        const reading *r, char value[NEVH__NAME]) {
    const nevh__tape *tape = f->tape;
    nevh__tape_operand o = tape->result;
    uint32_t from = r->last;
    bool cosine = r->last_cosine;
    while (o.kind == NEVH__SLOT && !cosine) {
        const nevh__instruction *at = &tape->code[from];
        double a = formula_text_size_of(tape, at->a),
               b = formula_text_size_of(tape, at->b);
        bool first = at->operation == NEVH__NEGATE ||
                     (at->operation == NEVH__MULTIPLY && b <= 1) ||
                     (at->operation == NEVH__DIVIDE && b >= 1);
        if (!first && !(at->operation == NEVH__MULTIPLY && a <= 1))
            break;
        o = first ? at->a : at->b;
        cosine = r->cosine[2 * from + !first];
        from = first ? r->a[from] : r->b[from];
    }
    operand_name(w, f, o, from, cosine, value);
}

bool nevh__write_gradient(nevh__writer *w, nevh__formula_text *f,
                          unsigned wanted) {
    static const double safe = 1e300;
    reading r;
    char result[NEVH__NAME], to[NEVH__NAME];
    double most;
    if (!new_reading(f->tape, &r)) {
        w->failed = true;
        return false;
    }
    bool fine = write_forwards(w, f, &r, result, &most);
    nevh__tape_operand o = f->tape->result;
    if (fine && o.by & wanted) {
        bool *begun = adjoint_name(f, &r, o, r.last, r.last_cosine, to);
        if (!w->readable)
            finite_with(w, f, &r, result);
        if (!(most < safe))
            write_check(w, result);
        nevh__write(w, "    %s %s = %s(1.0);\n", type_of(f), to,
                    f->lanes ? f->lanes->all : "");
        *begun = true;
        write_backwards(w, f, &r, wanted);
    }
    free_reading(&r);
    return fine;
}

/* True if an operand changes with the variable that is moved. */
static bool formula_text_moves(const reading *r, nevh__tape_operand o,
                               uint32_t from, bool cosine, nevh__variable by,
                               size_t k) {
    if (o.kind == NEVH__SLOT)
        return cosine ? r->begun_cosine[from] : r->begun[from];
    return o.kind == (uint8_t)by && o.at == k;
}

/* The imaginary part of an operand that moves. */
static void part_name(const nevh__formula_text *f, nevh__tape_operand o,
                      uint32_t from, bool cosine, char name[NEVH__NAME]) {
    if (o.kind == NEVH__SLOT)
        snprintf(name, NEVH__NAME, "i%c%u_%u", cosine ? 'w' : 'v', f->id, from);
    else
        snprintf(name, NEVH__NAME, "0x1p-332");
}

/* The imaginary parts of a sine and a cosine, taken together. */
static void write_parts_of_both(nevh__writer *w, const nevh__formula_text *f,
                                uint32_t i, const names *x, const char *part) {
    nevh__write(w, "    double iv%u_%u = %s * %s;\n", f->id, i, x->also, part);
    nevh__write(w, "    double iw%u_%u = -%s * %s;\n", f->id, i, x->y, part);
}

static void formula_text_write_parts(nevh__writer *w,
                                     const nevh__formula_text *f, reading *r,
                                     nevh__variable by, size_t k) {
    for (uint32_t i = 0; i < f->tape->length; i++) {
        const nevh__instruction *at = &f->tape->code[i];
        bool cosine_a = r->cosine[2 * i], cosine_b = r->cosine[2 * i + 1];
        bool one = at->operation >= NEVH__OPERATION_COUNT ||
                   nevh__operation_arguments(at->operation) == 1;
        bool a = formula_text_moves(r, at->a, r->a[i], cosine_a, by, k);
        bool b = !one && formula_text_moves(r, at->b, r->b[i], cosine_b, by, k);
        names x;
        char of_a[NEVH__NAME], of_b[NEVH__NAME];
        if (!a && !b)
            continue;
        find_names(w, f, r, i, &x);
        r->begun[i] = true;
        part_name(f, at->a, r->a[i], cosine_a, of_a);
        if (at->operation == NEVH__SINCOS) {
            r->begun_cosine[i] = true;
            write_parts_of_both(w, f, i, &x, of_a);
            continue;
        }
        nevh__operation_names m = {x.a, x.b, x.y, of_a, NULL};
        nevh__write(w, "    double iv%u_%u = ", f->id, i);
        if (a)
            nevh__write_expression(w, at->operation, NEVH__OPERATION_BY_A, &m);
        nevh__write(w, a && b ? " + (" : b ? "(" : "");
        if (b) {
            part_name(f, at->b, r->b[i], cosine_b, of_b);
            m.g = of_b;
            nevh__write_expression(w, at->operation, NEVH__OPERATION_BY_B, &m);
        }
        nevh__write(w, b ? ");\n" : ";\n");
    }
}

bool nevh__write_complex(nevh__writer *w, nevh__formula_text *f,
                         nevh__variable by, size_t k, char result[NEVH__NAME]) {
    reading r;
    double most;
    if (!new_reading(f->tape, &r)) {
        w->failed = true;
        return false;
    }
    bool fine = write_forwards(w, f, &r, result, &most);
    if (fine) {
        nevh__tape_operand o = f->tape->result;
        write_check(w, result);
        formula_text_write_parts(w, f, &r, by, k);
        if (formula_text_moves(&r, o, r.last, r.last_cosine, by, k))
            part_name(f, o, r.last, r.last_cosine, result);
        else
            snprintf(result, NEVH__NAME, "0.0");
    }
    free_reading(&r);
    return fine;
}

/* nevh: jumps of floor and of atan2 that H does not have.

   H(z; n) reads the value n of floor, and has no jump where H(z; n + 1) is the same
   function of z.  Both are tried at states here and there, in wide numbers.  Sines may
   read whole periods of the change, and two that change may cancel in a sum or product;
   any other function that does not show the change may show it at other states.  Jumps
   that H has of two at one place, such as floor(x + 1) - floor(x), count as jumps.
   Those that H does not have are tried together, too: if H has one then, all count.
   Some numbers of H are rounded, such as 6.283185307179586: what a change of their
   last digit explains is no difference.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/graph_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    COPIES = 3, /* the numbers as they are, and changed in their last digit */
    SHIFTS = 2 * (COPIES - 1)
};

/* Values at one state. */
typedef struct {
    nevh__graph *g;
    int used;
    nevh__wide *plain, *shifted; /* COPIES a node; shifted: of changed nodes */
    int *last;                   /* the last node that reads a node */
    /* From -1 to 1, of a size of 1/2 at least: SHIFTS a node; 0 of a number that is
       meant as it is. */
    double *shifts;
    unsigned char *changed, *is_root, *is_read; /* is_read: by H */
    unsigned char *lost;   /* true of what hides a summand at the state */
    unsigned char *jumped; /* the functions that jump together */
    nevh__wide turn;
    uint64_t random;
    double work; /* operations */
} states;

/* From 0 to 1. */
static double scatter(states *s) {
    return (nevh__random(&s->random) + 1) / 2;
}

/* The power of 2 near which the variables are at a state: from -4 to 10; at every
   third from -100 to 50: units may be of any size. */
static double scattered_scale(states *s, int state) {
    return state % 3 == 2 ? -100 + 146 * scatter(s) : -4 + 10 * scatter(s);
}

static double scattered(states *s, double scale) {
    enum { SPREAD = 4 };
    double size = exp2(scale + SPREAD * scatter(s));
    return copysign(size, nevh__random(&s->random));
}

static nevh__wide size_of(nevh__wide x) {
    return x < 0 ? -x : x;
}

static bool is_whole(nevh__wide x) {
    double near = rint((double)x); /* of more digits than a double: some off */
    nevh__wide rest = x - near;
    double off = (double)(rest - rint((double)rest));
    return fabs(off) < 1e-9;
}

/* True of a double that is no short number, as 3, 0.5 or 1e16 are, and of a decimal
   number of 14 to 17 digits: more are meant. */
static bool is_rounded(nevh__wide x) {
    enum { BITS = 40, MORE = 16 }; /* digits after the first */
    static const double short_part = 1e-4;
    int exponent;
    double mantissa = ldexp(frexp((double)x, &exponent), BITS);
    if ((double)x == x)
        return mantissa != rint(mantissa);
    double first = floor(log10(fabs((double)x)));
    nevh__wide digits =
        x * nevh__operation_wide(NEVH__POWER, 10, MORE - (nevh__wide)first);
    return is_whole(digits) && !is_whole(digits * (nevh__wide)short_part);
}

/* The shift of a node in a changed copy.
   again  the second one: of what has jumped */
static double shift_of(const states *s, int i, int copy, bool again) {
    return s->shifts[SHIFTS * i + 2 * (copy - 1) + again];
}

/* A number of H as a copy has it. */
static nevh__wide number_of(const states *s, int i, int copy) {
    nevh__wide number = s->g->nodes[i].number;
    return copy ? number *
                      (1 + (nevh__wide)(shift_of(s, i, copy, false) * 0x1p-51))
                : number;
}

static const nevh__wide *jumps_values(const states *s, int i) {
    return (s->changed[i] ? s->shifted : s->plain) + COPIES * (size_t)i;
}

static nevh__wide jumps_operate(const states *s, int i, int copy, nevh__wide a,
                                nevh__wide b) {
    const nevh__graph_node *x = &s->g->nodes[i];
    switch (x->kind) {
    case NEVH__GRAPH_NUMBER:
        return number_of(s, i, copy);
    case NEVH__GRAPH_ADD:
        return a + b;
    case NEVH__GRAPH_SCALE:
        return number_of(s, i, copy) * a;
    case NEVH__GRAPH_MULTIPLY:
        return a * b;
    case NEVH__GRAPH_INVERT:
        return 1 / a;
    case NEVH__GRAPH_POWER:
        return nevh__operation_wide(NEVH__POWER, a, x->number);
    default:
        return x->function == NEVH__NOTHING
                   ? 0
                   : nevh__operation_wide(x->function, a, b);
    }
}

static void jumps_evaluate(const states *s, int i, nevh__wide to[]) {
    const nevh__graph_node *x = &s->g->nodes[i];
    for (int copy = 0; copy < COPIES; copy++) {
        nevh__wide a = x->a >= 0 ? jumps_values(s, x->a)[copy] : 0;
        nevh__wide b = x->b >= 0 ? jumps_values(s, x->b)[copy] : a;
        to[copy] = jumps_operate(s, i, copy, a, b);
        if (copy && x->kind == NEVH__GRAPH_ADD) /* rounding, as large as it
                                                    may be */
            to[copy] += shift_of(s, i, copy, to < s->shifted) *
                        NEVH__WIDE_ROUNDING * (size_of(a) + size_of(b));
    }
}

/* True if values differ by no more than rounding and the numbers of H explain.
   size  of what they are made of */
static bool jumps_same(const nevh__wide x[], const nevh__wide y[],
                       nevh__wide size) {
    static const double roundings = 256, digits = 16;
    nevh__wide apart = y[0] - x[0], spread = 0;
    for (int copy = 1; copy < COPIES; copy++) {
        nevh__wide off = size_of(y[copy] - x[copy] - apart);
        spread = off > spread ? off : spread;
    }
    return size_of(apart) <=
           digits * spread + roundings * NEVH__WIDE_ROUNDING *
                                 (size_of(x[0]) + size_of(y[0]) + size);
}

/* The operands of a sum, which may cancel. */
static nevh__wide size_of_parts(const states *s, const nevh__graph_node *x) {
    return x->kind == NEVH__GRAPH_ADD ? size_of(jumps_values(s, x->a)[0]) +
                                            size_of(jumps_values(s, x->b)[0])
                                      : 0;
}

/* True if a change of an operand that the node does not show is none elsewhere. */
static bool cancels(const states *s, const nevh__graph_node *x) {
    if (x->kind == NEVH__GRAPH_ADD || x->kind == NEVH__GRAPH_MULTIPLY)
        return s->changed[x->a] && s->changed[x->b];
    return x->kind == NEVH__GRAPH_CALL &&
           (x->function == NEVH__SIN || x->function == NEVH__COS ||
            x->function == NEVH__TAN || x->function == NEVH__NOTHING);
}

/* True if a step function is so near a step that the last digits decide. */
static bool is_doubtful(const nevh__graph_node *x, const nevh__wide y[]) {
    return x->kind == NEVH__GRAPH_CALL &&
           (x->function == NEVH__FLOOR || x->function == NEVH__SIGN) &&
           (y[1] != y[0] || y[2] != y[0]);
}

/* True if a part of the node is hidden in what it reads: a summand that is far smaller
   than the other one, a number too small for any digits, or the argument of a function
   that has saturated. */
static bool loses(const states *s, int i) {
    static const double least = 1e-10;
    const nevh__graph_node *x = &s->g->nodes[i];
    double y = fabs((double)s->plain[COPIES * (size_t)i]);
    double a = x->a >= 0 ? fabs((double)jumps_values(s, x->a)[0]) : 1;
    double b = x->b >= 0 ? fabs((double)jumps_values(s, x->b)[0]) : 1;
    bool lost = (x->a >= 0 && s->lost[x->a]) || (x->b >= 0 && s->lost[x->b]);
    if (x->kind == NEVH__GRAPH_ADD)
        return lost || (fmin(a, b) > 0 && fmin(a, b) <= least * fmax(a, b));
    if (x->kind == NEVH__GRAPH_CALL && x->function == NEVH__TANH)
        return lost || 1 - y < least;
    if (x->kind == NEVH__GRAPH_CALL && x->function == NEVH__ATAN)
        return lost || a > 1 / least;
    bool vanishes = x->kind != NEVH__GRAPH_CALL || x->function == NEVH__EXP;
    return lost || (vanishes && x->a >= 0 && y == 0 && a > 0 && b > 0);
}

/* True if a change is so small that functions of it may hide theirs. */
static bool is_slight(const nevh__wide x[], const nevh__wide y[]) {
    static const double least = 1e-6;
    return size_of(y[0] - x[0]) < least * (size_of(x[0]) + size_of(y[0]));
}

typedef enum { NO_JUMP, JUMP, UNKNOWN } verdict;

/* Evaluates what reads a node that has been shifted, as long as something changes. */
static verdict follow_jump(states *s, int from, int *until) {
    verdict found = NO_JUMP;
    for (int i = from + 1; i <= *until && found == NO_JUMP; i++) {
        const nevh__graph_node *x = &s->g->nodes[i];
        nevh__wide *to = s->shifted + COPIES * (size_t)i,
                   *before = s->plain + COPIES * (size_t)i;
        s->work++;
        if (!s->is_read[i] || (!(x->a >= 0 && s->changed[x->a]) &&
                               !(x->b >= 0 && s->changed[x->b])))
            continue;
        jumps_evaluate(s, i, to);
        s->work += COPIES;
        bool same = jumps_same(before, to, size_of_parts(s, x));
        if (to[0] - to[0] != 0 || before[0] - before[0] != 0 ||
            is_doubtful(x, to) || is_doubtful(x, before) ||
            (same && (!cancels(s, x) || s->lost[i])))
            found = UNKNOWN;
        else if (!same && s->is_root[i])
            found = JUMP;
        else if (!same && is_slight(before, to))
            found = UNKNOWN;
        else if (!same) {
            s->changed[i] = 1;
            *until = s->last[i] > *until ? s->last[i] : *until;
        }
    }
    return found;
}

/* Gives a function that jumps its value behind the jump. */
static void jumps_shift(states *s, int i, const nevh__wide before[]) {
    bool whole = s->g->nodes[i].function == NEVH__FLOOR;
    for (int copy = 0; copy < COPIES; copy++)
        s->shifted[COPIES * (size_t)i + copy] =
            before[copy] + (whole ? 1 : s->turn);
}

static verdict jumps_at_state(states *s, const nevh__graph_edge *e) {
    int from = e->jump, until = s->last[from];
    jumps_shift(s, from, s->plain + COPIES * (size_t)from);
    s->changed[from] = 1;
    verdict found = s->is_root[from] ? JUMP : follow_jump(s, from, &until);
    memset(s->changed + from, 0, (size_t)(until - from) + 1);
    return found;
}

/* The values of the nodes that H reads. */
static void go_to_state(states *s, int state) {
    double scale = scattered_scale(s, state);
    for (int i = 0; i < s->used; i++) {
        const nevh__graph_node *x = &s->g->nodes[i];
        nevh__wide *to = s->plain + COPIES * (size_t)i;
        if (x->kind == NEVH__GRAPH_VARIABLE) {
            to[0] = scattered(s, scale);
            for (int copy = 1; copy < COPIES; copy++)
                to[copy] = to[0];
        } else if (s->is_read[i]) {
            jumps_evaluate(s, i, to);
            s->lost[i] = loses(s, i);
        }
    }
    s->work += COPIES * (double)s->used;
}

static void draw_shifts(states *s, int i) {
    const nevh__graph_node *x = &s->g->nodes[i];
    bool number = x->kind != NEVH__GRAPH_ADD;
    bool kept = number && (s->g->exact || !is_rounded(x->number));
    for (int k = 0; k < SHIFTS && !kept; k++) {
        double y = nevh__random(&s->random) / 2;
        s->shifts[SHIFTS * i + k] = y + copysign(0.5, y);
    }
}

static bool jumps_make(states *s, const int roots[], size_t count) {
    size_t used = (size_t)s->used;
    s->plain = nevh__array(2 * COPIES * used, sizeof *s->plain);
    s->shifts = nevh__array(SHIFTS * used, sizeof *s->shifts);
    s->last = nevh__array(used, sizeof *s->last);
    s->changed = nevh__array(used, 1);
    s->is_root = nevh__array(4 * used, 1);
    if (!s->plain || !s->shifts || !s->last || !s->changed || !s->is_root)
        return false;
    s->is_read = s->is_root + used;
    s->lost = s->is_read + used;
    s->jumped = s->lost + used;
    s->shifted = s->plain + COPIES * used;
    for (size_t k = 0; k < count; k++)
        s->is_root[roots[k]] = 1;
    for (int i = s->used - 1; i >= 0; i--) {
        draw_shifts(s, i);
        const int *of[] = {&s->g->nodes[i].a, &s->g->nodes[i].b};
        s->is_read[i] |= s->is_root[i];
        s->last[i] = s->last[i] > i ? s->last[i] : i;
        for (int k = 0; k < 2 && s->is_read[i]; k++)
            if (*of[k] >= 0) {
                s->is_read[*of[k]] = 1;
                s->last[*of[k]] = i > s->last[*of[k]] ? i : s->last[*of[k]];
            }
    }
    return true;
}

/* True if H has another value where all of the functions have jumped: each may be hidden
   by another one, as in (floor(x) - 1)*(floor(y) - 1). */
static bool jumps_together(states *s, const unsigned char jumps[]) {
    bool apart = false;
    memset(s->changed, 1, (size_t)s->used);
    memset(s->jumped, 0, (size_t)s->used);
    for (size_t k = 0; k < s->g->n_edges; k++)
        if (s->g->edges[k].jump >= 0 && !jumps[k])
            s->jumped[s->g->edges[k].jump] = 1;
    for (int i = 0; i < s->used && !apart; i++) {
        nevh__wide *to = s->shifted + COPIES * (size_t)i,
                   *before = s->plain + COPIES * (size_t)i;
        if (s->g->nodes[i].kind == NEVH__GRAPH_VARIABLE)
            memcpy(to, before, COPIES * sizeof *to);
        else if (s->is_read[i])
            jumps_evaluate(s, i, to);
        if (s->jumped[i])
            jumps_shift(s, i, to);
        apart = s->is_root[i] && to[0] - to[0] == 0 &&
                before[0] - before[0] == 0 &&
                !jumps_same(before, to, size_of_parts(s, &s->g->nodes[i]));
    }
    memset(s->changed, 0, (size_t)s->used);
    return apart;
}

/* States at which nothing jumps; enough of them say that H does not. */
enum { TRIED = 15, ENOUGH = 4, HAS_JUMP = 255 };

void nevh__graph_find_jumps(nevh__graph *g, const int roots[], size_t count,
                            unsigned char jumps[]) {
    static const double most_work = 3e7;
    states s = {
        .g = g, .used = g->used, .turn = 2 * nevh__wide_pi(), .random = 1};
    bool made = jumps_make(&s, roots, count);
    for (int state = 0; made && state < TRIED && s.work < most_work; state++) {
        go_to_state(&s, state);
        for (size_t k = 0; k < g->n_edges && s.work < most_work; k++) {
            bool open = g->edges[k].jump >= 0 && jumps[k] != HAS_JUMP;
            verdict found = open ? jumps_at_state(&s, &g->edges[k]) : UNKNOWN;
            jumps[k] =
                (unsigned char)(found == JUMP ? HAS_JUMP
                                              : jumps[k] + (found == NO_JUMP));
        }
    }
    bool apart = false;
    size_t several = 0;
    for (size_t k = 0; k < g->n_edges; k++)
        jumps[k] = jumps[k] < ENOUGH || jumps[k] == HAS_JUMP;
    for (size_t k = 0; k < g->n_edges; k++)
        several += g->edges[k].jump >= 0 && !jumps[k];
    for (int state = 0; several > 1 && state < TRIED && !apart; state++) {
        go_to_state(&s, state);
        apart = jumps_together(&s, jumps);
    }
    for (size_t k = 0; k < g->n_edges; k++)
        jumps[k] = jumps[k] || apart;
    g->failed = g->failed || !made;
    free(s.plain);
    free(s.shifts);
    free(s.last);
    free(s.changed);
    free(s.is_root);
}

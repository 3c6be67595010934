/* nevh: from the nodes of a builder to a tape.

   Operations are ordered so that few results are held at once: of two
   arguments the one that needs more room comes first [R. Sethi, J. D. Ullman,
   "The generation of optimal code for arithmetic expressions", J. ACM 17 (1970)
   715-728]; for shared nodes that is a heuristic.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include <stdlib.h>
#include <string.h>

/* Slots are not used again before there are so many: a gradient then has no
   old values to keep. */
enum { PLENTY = 24, NOWHERE = -1 };

/* Properties of a node. */
typedef struct {
    int need;  /* slots held at once */
    int place; /* operations: when; numbers: which of them; or NOWHERE */
    int last;  /* the place of the last operation that takes it */
    int twin;  /* the cosine that is found together with this sine; NOWHERE */
    int slot;
    bool fresh; /* the slot was no other's */
    bool idle;  /* and is not the node's any more */
    uint8_t by;
} role;

typedef struct {
    const nevh__tape_builder *from;
    role *roles;
    int *order; /* nodes of the operations, by place */
    int *stack;
    int length, numbers;
    int *idle; /* slots that may be used again */
    int idle_count, slots;
} plan;

static bool is_operation(const plan *p, int node) {
    return p->from->nodes[node].kind == NEVH__SLOT;
}

static void free_plan(plan *p) {
    free(p->roles);
    free(p->order);
    free(p->stack);
    free(p->idle);
}

static bool new_plan(plan *p, const nevh__tape_builder *from) {
    size_t n = (size_t)from->used;
    *p = (plan){.from = from};
    p->roles = nevh__array(n, sizeof *p->roles);
    p->order = nevh__array(n, sizeof *p->order);
    p->stack = nevh__array(n, sizeof *p->stack);
    p->idle = nevh__array(n, sizeof *p->idle);
    if (p->roles && p->order && p->stack && p->idle)
        return true;
    free_plan(p);
    return false;
}

/* Arguments have smaller numbers than what is made of them. */
static void find_needs(plan *p) {
    for (int i = 0; i < p->from->used; i++) {
        const nevh__tape_node *n = &p->from->nodes[i];
        role *r = &p->roles[i];
        r->place = r->twin = NOWHERE;
        if (!is_operation(p, i))
            continue;
        int a = p->roles[n->a].need, b = p->roles[n->b].need;
        int both = a == b && n->a != n->b ? a + 1 : a > b ? a : b;
        r->need = both > 0 ? both : 1;
    }
}

/* The argument that has to be placed before the node can be, the needier
   first; or NOWHERE. */
static int missing(const plan *p, int node) {
    const nevh__tape_node *n = &p->from->nodes[node];
    bool a = is_operation(p, n->a) && p->roles[n->a].place == NOWHERE;
    bool b = is_operation(p, n->b) && p->roles[n->b].place == NOWHERE;
    if (a && b)
        return p->roles[n->b].need > p->roles[n->a].need ? n->b : n->a;
    return a ? n->a : b ? n->b : NOWHERE;
}

static void put_in_order(plan *p, int result) {
    int depth = 0;
    if (is_operation(p, result))
        p->stack[depth++] = result;
    while (depth) {
        int node = p->stack[depth - 1], next = missing(p, node);
        if (next != NOWHERE) {
            p->stack[depth++] = next;
            continue;
        }
        depth--;
        p->roles[node].place = p->length;
        p->order[p->length++] = node;
    }
}

/* The sine of a cosine's argument, or the other way round; or NOWHERE. */
static int counterpart(const plan *p, int node) {
    nevh__tape_node n = p->from->nodes[node];
    if (n.operation != NEVH__SIN && n.operation != NEVH__COS)
        return NOWHERE;
    n.operation = n.operation == NEVH__SIN ? NEVH__COS : NEVH__SIN;
    int found = nevh__builder_find(p->from, &n);
    return found >= 0 && p->roles[found].place != NOWHERE ? found : NOWHERE;
}

/* Sine and cosine of one argument become one, where the first of them was. */
static void join_twins(plan *p) {
    int length = 0;
    for (int i = 0; i < p->length; i++) {
        int node = p->order[i], other = counterpart(p, node);
        bool is_sine = p->from->nodes[node].operation == NEVH__SIN;
        int place = length;
        if (other != NOWHERE && p->roles[other].place < i) {
            place = p->roles[other].place;
        } else {
            p->order[length++] = other == NOWHERE || is_sine ? node : other;
        }
        if (other != NOWHERE && is_sine)
            p->roles[node].twin = other;
        p->roles[node].place = place;
    }
    p->length = length;
}

static void see_argument(plan *p, int node, int place) {
    role *r = &p->roles[node];
    const nevh__tape_node *n = &p->from->nodes[node];
    r->last = place;
    if (n->kind == NEVH__NUMBER && r->place == NOWHERE)
        r->place = p->numbers++;
    if (n->kind == NEVH__Q)
        r->by = NEVH__BY_Q;
    if (n->kind == NEVH__P)
        r->by = NEVH__BY_P;
    if (n->kind == NEVH__T)
        r->by = NEVH__BY_T;
}

/* Last uses, numbers, and by what each operation changes. */
static void see_uses(plan *p, int result) {
    for (int i = 0; i < p->length; i++) {
        const nevh__tape_node *n = &p->from->nodes[p->order[i]];
        see_argument(p, n->a, i);
        see_argument(p, n->b, i);
        role *r = &p->roles[p->order[i]];
        r->by = p->roles[n->a].by | p->roles[n->b].by;
        if (r->twin != NOWHERE)
            p->roles[r->twin].by = r->by;
    }
    see_argument(p, result, p->length);
}

static void release(plan *p, int node, int place) {
    role *r = &p->roles[node];
    if (!is_operation(p, node) || r->last != place || r->idle)
        return;
    p->idle[p->idle_count++] = r->slot;
    r->idle = true; /* both arguments may be one */
}

static void choose_slot(plan *p, int node) {
    role *r = &p->roles[node];
    r->fresh = !p->idle_count || p->slots < PLENTY;
    r->slot = r->fresh ? p->slots++ : p->idle[--p->idle_count];
}

/* Arguments are released after the result has its slot, so that a gradient
   finds both. */
static void choose_slots(plan *p) {
    for (int i = 0; i < p->length; i++) {
        const nevh__tape_node *n = &p->from->nodes[p->order[i]];
        choose_slot(p, p->order[i]);
        if (p->roles[p->order[i]].twin != NOWHERE)
            choose_slot(p, p->roles[p->order[i]].twin);
        release(p, n->a, i);
        release(p, n->b, i);
    }
}

static nevh__tape_operand tape_finish_operand(const plan *p, int node) {
    const nevh__tape_node *n = &p->from->nodes[node];
    const role *r = &p->roles[node];
    uint32_t at = n->kind == NEVH__SLOT     ? (uint32_t)r->slot
                  : n->kind == NEVH__NUMBER ? (uint32_t)r->place
                                            : (uint32_t)n->bits;
    return (nevh__tape_operand){.kind = n->kind, .by = r->by, .at = at};
}

bool nevh__tape_breaks(const nevh__tape *tape) {
    for (size_t i = 0; i < tape->length; i++) {
        const nevh__instruction *c = &tape->code[i];
        if (!nevh__operation_is_smooth(c->operation) &&
            ((c->a.by | c->b.by) & (NEVH__BY_Q | NEVH__BY_P)))
            return true;
    }
    return false;
}

bool nevh__tape_touches(const nevh__tape *tape) {
    for (size_t i = 0; i < tape->length; i++) {
        const nevh__instruction *c = &tape->code[i];
        bool edges = nevh__operation_of(c->operation)->edge ||
                     c->operation == NEVH__ATAN2 || c->operation == NEVH__POWER;
        if (edges && ((c->a.by | c->b.by) & (NEVH__BY_Q | NEVH__BY_P)))
            return true;
    }
    return false;
}

static void note_read(nevh__tape *tape, nevh__tape_operand o) {
    if (o.kind < NEVH__VARIABLES)
        tape->read[o.kind][o.at] = true;
}

static nevh__instruction instruction(const plan *p, int node) {
    const nevh__tape_node *n = &p->from->nodes[node];
    const role *r = &p->roles[node];
    nevh__instruction made = {
        .a = tape_finish_operand(p, n->a),
        .b = tape_finish_operand(p, n->b),
        .to = (uint32_t)r->slot,
        .also = (uint32_t)r->slot,
        .operation = n->operation,
        .fresh = r->fresh,
        .also_fresh = true,
    };
    made.a.last = is_operation(p, n->a) && p->roles[n->a].last == r->place;
    made.b.last = is_operation(p, n->b) && p->roles[n->b].last == r->place &&
                  n->a != n->b;
    if (nevh__operation_arguments(n->operation) == 1)
        made.b.by = 0;
    if (r->twin != NOWHERE) {
        made.operation = NEVH__SINCOS;
        made.also = (uint32_t)p->roles[r->twin].slot;
        made.also_fresh = p->roles[r->twin].fresh;
    }
    return made;
}

static void write_code(nevh__tape *tape, const plan *p) {
    uint32_t journal = 0;
    for (int i = 0; i < p->length; i++) {
        nevh__instruction *to = &tape->code[i];
        *to = instruction(p, p->order[i]);
        to->journal = journal;
        journal += !to->fresh + !to->also_fresh;
        note_read(tape, to->a);
        note_read(tape, to->b);
        if (!nevh__operation_is_smooth(to->operation) &&
            ((to->a.by | to->b.by) & ~NEVH__BY_T))
            tape->analytic = false;
    }
    tape->code[p->length].journal = journal;
}

static void write_numbers(nevh__tape *tape, const plan *p) {
    size_t misplaced = (uintptr_t)tape->wide_memory / sizeof(double);
    double *wide = tape->wide_memory +
                   (NEVH__LANES - misplaced % NEVH__LANES) % NEVH__LANES;
    for (int i = 0; i < p->from->used; i++) {
        const nevh__tape_node *n = &p->from->nodes[i];
        int at = p->roles[i].place;
        if (n->kind != NEVH__NUMBER || at == NOWHERE)
            continue;
        tape->numbers[at] = nevh__tape_node_number(n);
        for (int lane = 0; lane < NEVH__LANES; lane++)
            wide[at * NEVH__LANES + lane] = tape->numbers[at];
    }
    tape->wide = wide;
}

static nevh__tape *tape_finish_allocate(const plan *p) {
    size_t numbers = (size_t)p->numbers, all = 0, at = 0;
    const size_t *count = p->from->count;
    for (int v = 0; v < NEVH__VARIABLES; v++)
        all += count[v];
    nevh__tape *tape = nevh__array(1, sizeof *tape);
    if (!tape)
        return NULL;
    tape->code = nevh__array((size_t)p->length + 1, sizeof *tape->code);
    tape->numbers = nevh__array(numbers, sizeof(double));
    tape->wide_memory =
        nevh__array((numbers + 1) * NEVH__LANES, sizeof(double));
    tape->read[0] = nevh__array(all, sizeof(bool));
    if (!tape->code || !tape->numbers || !tape->wide_memory || !tape->read[0]) {
        nevh__tape_free(tape);
        return NULL;
    }
    tape->n_numbers = numbers;
    memcpy(tape->count, count, sizeof tape->count);
    for (int v = 0; v < NEVH__VARIABLES; at += count[v++])
        tape->read[v] = tape->read[0] + at;
    return tape;
}

static nevh__tape *tape_finish_write(const plan *p, int result) {
    nevh__tape *tape = tape_finish_allocate(p);
    if (!tape)
        return NULL;
    tape->length = (size_t)p->length;
    tape->slots = (size_t)p->slots;
    tape->analytic = true;
    tape->result = tape_finish_operand(p, result);
    note_read(tape, tape->result);
    write_code(tape, p);
    write_numbers(tape, p);
    return tape;
}

static int finish(plan *p, int result, nevh__tape **tape) {
    find_needs(p);
    put_in_order(p, result);
    join_twins(p);
    see_uses(p, result);
    choose_slots(p);
    if (p->slots > NEVH__TAPE_LIVE || p->length > NEVH__TAPE_LENGTH)
        return NEVH_EINVAL;
    *tape = tape_finish_write(p, result);
    return *tape ? NEVH_OK : NEVH_ENOMEM;
}

nevh__tape *nevh__tape_finish(nevh__tape_builder *b, int result, int *status) {
    plan p;
    nevh__tape *tape = NULL;
    int outcome = NEVH_ENOMEM;
    if (b && !b->failed && result >= 0 && new_plan(&p, b)) {
        outcome = finish(&p, result, &tape);
        free_plan(&p);
    }
    nevh__tape_abandon(b);
    if (status)
        *status = outcome;
    return tape;
}

void nevh__tape_free(nevh__tape *tape) {
    if (!tape)
        return;
    free(tape->code);
    free(tape->numbers);
    free(tape->wide_memory);
    free(tape->read[0]);
    free(tape);
}

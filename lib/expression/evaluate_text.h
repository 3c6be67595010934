/* nevh: the number that an expression stands for, in one kind of numbers.

   Before this is included are defined: real; EXACT(x), the real of a number that
   is not rounded; NAMED(name), the name of a function; OPERATION(f, a, b), NUMBER(e)
   and ELEMENT(e, index) of theirs.
   SPDX-License-Identifier: GPL-3.0-or-later */

typedef struct {
    nevh__scope *scope;
    const nevh__expression *body;
    real sum;
} NAMED(total);

static bool NAMED(add_body)(void *context) {
    NAMED(total) *sum = context;
    sum->sum = OPERATION(NEVH__ADD, sum->sum,
                         NAMED(nevh__expression)(sum->scope, sum->body));
    return !sum->scope->error->status;
}

static real NAMED(loop_value)(nevh__scope *s, const nevh__expression *e) {
    NAMED(total) sum = {s, e->operands[2].of, EXACT(0)};
    return nevh__scope_loop(s, e, NAMED(add_body), &sum) ? sum.sum : EXACT(NAN);
}

static real NAMED(chain_value)(nevh__scope *s, const nevh__expression *e) {
    real value = NAMED(nevh__expression)(s, e->operands[0].of);
    for (size_t i = 1; i < e->n; i++) {
        real next = NAMED(nevh__expression)(s, e->operands[i].of);
        bool inverse = e->operands[i].inverse;
        nevh__tape_operation by = e->form == NEVH__FORM_SUM
                                      ? inverse ? NEVH__SUBTRACT : NEVH__ADD
                                  : inverse ? NEVH__DIVIDE
                                            : NEVH__MULTIPLY;
        value = OPERATION(by, value, next);
    }
    return value;
}

static real NAMED(apply_value)(nevh__scope *s, const nevh__expression *e) {
    real a = NAMED(nevh__expression)(s, e->operands[0].of);
    real b =
        e->n > 1 ? NAMED(nevh__expression)(s, e->operands[1].of) : EXACT(0);
    return OPERATION(e->operation, a, b);
}

static real NAMED(element_value)(nevh__scope *s, const nevh__expression *e) {
    size_t index;
    return nevh__expression_element(s, e, &index) ? ELEMENT(e, index)
                                                  : EXACT(NAN);
}

real NAMED(nevh__expression)(nevh__scope *s, const nevh__expression *e) {
    switch (e->form) {
    case NEVH__FORM_NUMBER:
        return NUMBER(e);
    case NEVH__FORM_INDEX:
        return EXACT(s->value[e->slot]);
    case NEVH__FORM_PARAMETER:
        return NAMED(element_value)(s, e);
    case NEVH__FORM_SUM:
    case NEVH__FORM_PRODUCT:
        return NAMED(chain_value)(s, e);
    case NEVH__FORM_APPLY:
        return NAMED(apply_value)(s, e);
    case NEVH__FORM_LOOP:
        return NAMED(loop_value)(s, e);
    case NEVH__FORM_TIME:
    case NEVH__FORM_VARIABLE:
        break;
    }
    return EXACT(NAN); /* who asks makes sure that nothing is read */
}

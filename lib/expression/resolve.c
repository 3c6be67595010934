/* nevh: trees become expressions.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/resolve_private.h"
#include <string.h>

/* Resolves all operands of a node. */
static bool take_operands(nevh__resolver *r, const nevh__syntax_node *node,
                          nevh__expression *e) {
    const nevh__syntax_node *operand = node->first;
    for (size_t i = 0; i < e->n; i++, operand = operand->next) {
        e->operands[i].inverse = operand->inverse;
        if (!(e->operands[i].of = nevh__resolve_node(r, operand)))
            return false;
    }
    return true;
}

static size_t operands_of(const nevh__syntax_node *node) {
    size_t count = 0;
    for (const nevh__syntax_node *at = node->first; at; at = at->next)
        count++;
    return count;
}

static nevh__expression *resolve_chain(nevh__resolver *r,
                                       const nevh__syntax_node *node,
                                       nevh__form form) {
    nevh__expression *e =
        nevh__expression_new(r, form, node, operands_of(node));
    return e && take_operands(r, node, e) ? nevh__expression_finish(r, e)
                                          : NULL;
}

static nevh__expression *resolve_apply(nevh__resolver *r,
                                       const nevh__syntax_node *node,
                                       nevh__tape_operation operation) {
    nevh__expression *e =
        nevh__expression_new(r, NEVH__FORM_APPLY, node, operands_of(node));
    if (!e || !take_operands(r, node, e))
        return NULL;
    e->operation = operation;
    const nevh__expression *last = e->operands[e->n - 1].of;
    if (operation == NEVH__POWER && last->form == NEVH__FORM_NUMBER &&
        last->wide_number.value == 1)
        return e->operands[0].of;
    return nevh__expression_finish(r, e);
}

static nevh__expression *resolve_call(nevh__resolver *r,
                                      const nevh__syntax_node *node) {
    nevh__tape_operation operation =
        nevh__function_named(node->name, strlen(node->name));
    if (operation == NEVH__OPERATION_COUNT) {
        r->scope.error->definition = r->in.definition;
        nevh__refuse_name(r->names, r->in.bound, node, false, r->scope.error);
        return NULL;
    }
    if (operands_of(node) != (size_t)nevh__operation_arguments(operation))
        return nevh__resolver_fail(r, node, node->length,
                                   "wrong number of arguments: it is %s%s",
                                   node->name, nevh__function_usage(operation));
    return resolve_apply(r, node, operation);
}

/* Fails if a new index cannot have this name. */
static bool check_bound(nevh__resolver *r, const nevh__syntax_node *node) {
    nevh__meaning meaning;
    const char *name = node->name;
    bool taken =
        strcmp(name, "t") == 0 || strcmp(name, "pi") == 0 ||
        nevh__entry_named(r->names, name, &meaning) ||
        (r->in.at && strcmp(r->in.at->name, name) == 0) ||
        nevh__function_named(name, strlen(name)) != NEVH__OPERATION_COUNT;
    for (const nevh__bound *b = r->in.bound; b; b = b->outer)
        taken = taken || strcmp(b->name, name) == 0;
    if (taken)
        nevh__resolver_fail_name(
            r, node,
            "%s already means something else: take another "
            "name for the index",
            "");
    else if (r->slots == NEVH__INDICES)
        nevh__resolver_fail_name(
            r, node, "with the index %s there are too many sums", "");
    return !r->scope.error->status;
}

static nevh__expression *resolve_loop(nevh__resolver *r,
                                      const nevh__syntax_node *node) {
    const nevh__syntax_node *from = node->first, *to = from->next,
                            *body = to->next;
    nevh__expression *e = nevh__expression_new(r, NEVH__FORM_LOOP, node, 3);
    if (!e || !check_bound(r, node))
        return NULL;
    if (!(e->operands[0].of = nevh__resolve_index(r, from)) ||
        !(e->operands[1].of = nevh__resolve_index(r, to)))
        return NULL;
    nevh__bound bound = {node->name, r->slots++, r->in.bound};
    e->slot = bound.slot;
    r->in.bound = &bound;
    e->operands[2].of = nevh__resolve_node(r, body);
    r->in.bound = bound.outer;
    return e->operands[2].of ? nevh__expression_finish(r, e) : NULL;
}

static nevh__expression *resolve_form(nevh__resolver *r,
                                      const nevh__syntax_node *node) {
    switch (node->kind) {
    case NEVH__NODE_NUMBER:
        return nevh__expression_number(r, node, node->number);
    case NEVH__NODE_NAME:
    case NEVH__NODE_ELEMENT:
        return nevh__resolve_name(r, node);
    case NEVH__NODE_CALL:
        return resolve_call(r, node);
    case NEVH__NODE_LOOP:
        return resolve_loop(r, node);
    case NEVH__NODE_SUM:
        return resolve_chain(r, node, NEVH__FORM_SUM);
    case NEVH__NODE_PRODUCT:
        return resolve_chain(r, node, NEVH__FORM_PRODUCT);
    case NEVH__NODE_MINUS:
        return resolve_apply(r, node, NEVH__NEGATE);
    case NEVH__NODE_POWER:
        return resolve_apply(r, node, NEVH__POWER);
    }
    return NULL;
}

nevh__expression *nevh__resolve_node(nevh__resolver *r,
                                     const nevh__syntax_node *node) {
    if (r->depth > 2 * NEVH__HEIGHT)
        return nevh__resolver_fail(
            r, node, node->length,
            "with definitions written out there are too many levels%s%s", "",
            "");
    r->depth++;
    nevh__expression *e = resolve_form(r, node);
    r->depth--;
    return e;
}

nevh__expression *nevh__resolve(const nevh__tree *tree,
                                const nevh__names *names, const nevh__index *at,
                                unsigned allowed, nevh__pool *pool,
                                nevh__formula_error *error) {
    nevh__resolver r = {.names = names, .pool = pool};
    r.in = (nevh__place){.allowed = allowed, .at = at};
    r.scope.error = error;
    r.scope.work = at && at->work ? *at->work : 0;
    nevh__expression *e = nevh__resolve_node(&r, tree->root);
    if (at && at->work)
        *at->work = r.scope.work;
    return e;
}

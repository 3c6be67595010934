/* nevh: expressions are made, and what is made of numbers is a number.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/resolve_private.h"
#include <string.h>

void *nevh__resolver_fail(nevh__resolver *r, const nevh__syntax_node *node,
                          size_t length, const char *format, const char *a,
                          const char *b) {
    nevh__formula_error *error = r->scope.error;
    if (!error->status)
        error->definition = r->in.definition;
    nevh__formula_fail(error, NEVH_EINVAL, node->column, length, format, a, b);
    return NULL;
}

void *nevh__resolver_fail_name(nevh__resolver *r, const nevh__syntax_node *node,
                               const char *format, const char *b) {
    return nevh__resolver_fail(r, node, node->length, format, node->name, b);
}

nevh__expression *nevh__expression_new(nevh__resolver *r, nevh__form form,
                                       const nevh__syntax_node *node,
                                       size_t n) {
    nevh__expression *e = nevh__pool_take(r->pool, 1, sizeof *e);
    if (e && n)
        e->operands = nevh__pool_take(r->pool, n, sizeof *e->operands);
    if (!e || (n && !e->operands)) {
        nevh__formula_no_memory(r->scope.error);
        return NULL;
    }
    e->form = form;
    e->n = n;
    e->column = node->column;
    e->length = node->length;
    e->name = node->name;
    e->definition = r->in.definition;
    return e;
}

static uint64_t mix(uint64_t hash, uint64_t with) {
    hash = (hash ^ with) * 0x9E3779B97F4A7C15u;
    return hash ^ hash >> 29;
}

static uint64_t bits(double number) {
    uint64_t all;
    memcpy(&all, &number, sizeof all);
    return all;
}

static void set_hash(nevh__expression *e) {
    uint64_t hash = mix(1, e->form);
    hash = mix(hash, bits(e->number));
    hash = mix(hash, bits((double)(e->wide_number.value - e->number)));
    hash = mix(hash, (uint64_t)(uintptr_t)e->values);
    hash = mix(hash, e->kind);
    hash = mix(hash, e->first);
    hash = mix(hash, e->operation);
    hash = mix(hash, e->slot);
    for (size_t i = 0; i < e->n; i++)
        hash = mix(mix(hash, e->operands[i].of->hash), e->operands[i].inverse);
    e->hash = hash;
}

/* For splitting: what is found here once need not be searched for in
   definitions of definitions again and again. */
static void set_sums(nevh__expression *e) {
    bool negative = e->form == NEVH__FORM_APPLY && e->operation == NEVH__NEGATE;
    e->sums = e->form == NEVH__FORM_SUM || e->form == NEVH__FORM_LOOP;
    e->loops = e->form == NEVH__FORM_LOOP && e->reads;
    for (size_t i = 0; i < e->n; i++) {
        const nevh__expression *of = e->operands[i].of;
        bool inverse = e->operands[i].inverse;
        bool product = e->form == NEVH__FORM_PRODUCT && !inverse;
        bool through = product || negative;
        e->sums = e->sums || (through && of->reads && of->sums);
        e->loops =
            e->loops || ((through || e->form == NEVH__FORM_SUM) && of->loops);
    }
}

/* Sets the properties that follow from the operands. */
nevh__expression *nevh__expression_finish(nevh__resolver *r,
                                          nevh__expression *e) {
    for (size_t i = 0; i < e->n; i++) {
        const nevh__expression *of = e->operands[i].of;
        e->reads |= of->reads;
        e->indices |= of->indices;
        e->height = of->height >= e->height ? of->height + 1 : e->height;
    }
    if (e->form == NEVH__FORM_LOOP)
        e->indices &= ~((uint64_t)1 << e->slot);
    if (e->height > NEVH__HEIGHT) {
        nevh__scope_fail(&r->scope, NEVH_EINVAL, e,
                         "with definitions written out this has more than %d "
                         "levels",
                         NEVH__HEIGHT);
        return NULL;
    }
    bool constant = !e->reads && !e->indices && e->form != NEVH__FORM_NUMBER;
    if (constant) {
        e->number = nevh__expression_value(&r->scope, e);
        e->wide_number = r->names->exact ? nevh__expression_wide(&r->scope, e)
                                         : (nevh__rounded){e->number, 0};
        e->form = NEVH__FORM_NUMBER;
        e->n = 0;
    }
    set_hash(e);
    set_sums(e);
    return r->scope.error->status ? NULL : e;
}

nevh__expression *nevh__expression_number(nevh__resolver *r,
                                          const nevh__syntax_node *node,
                                          double number) {
    nevh__expression *e = nevh__expression_new(r, NEVH__FORM_NUMBER, node, 0);
    if (!e)
        return NULL;
    e->number = number;
    e->wide_number = (nevh__rounded){number, 0};
    return nevh__expression_finish(r, e);
}

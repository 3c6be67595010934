/* nevh: what a name in a formula stands for.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/resolve_private.h"
#include <stdio.h>
#include <string.h>

enum { ANYTHING = NEVH__READS_TIME | NEVH__READS_STATE | NEVH__READS_V };

/* Fails if a formula may not read something of this kind here. */
static bool permit(nevh__resolver *r, const nevh__syntax_node *node,
                   unsigned reads, const char *kind) {
    unsigned excess = reads & ~r->in.allowed;
    if (!excess)
        return true;
    if (r->in.in_index)
        nevh__resolver_fail_name(
            r, node,
            "%s is %s, but indices and ranges are made of parameters "
            "and index variables",
            kind);
    else if (!r->in.allowed)
        nevh__resolver_fail_name(
            r, node, "%s is %s, but only parameters can stand here", kind);
    else if (excess & NEVH__READS_V)
        nevh__resolver_fail_name(
            r, node,
            "%s is %s, which cannot stand here; write it with "
            "momenta",
            kind);
    else
        nevh__resolver_fail_name(r, node, "%s is %s, which cannot stand here",
                                 kind);
    return false;
}

/* An operand resolved as an index or an end of a range. */
nevh__expression *nevh__resolve_index(nevh__resolver *r,
                                      const nevh__syntax_node *node) {
    nevh__place outside = r->in;
    r->in.allowed = 0;
    r->in.in_index = true;
    nevh__expression *e = nevh__resolve_node(r, node);
    r->in = outside;
    return e;
}

static void *fail_array(nevh__resolver *r, const nevh__syntax_node *node,
                        size_t count) {
    char advice[3 * NEVH__NAME_LENGTH];
    snprintf(advice, sizeof advice, "%s[1], or sum(i = 1..%zu, %s[i])",
             node->name, count, node->name);
    return nevh__resolver_fail_name(r, node, "%s has no index: write %s",
                                    advice);
}

/* Gives an element its index, where the name has any. */
static bool take_index(nevh__resolver *r, const nevh__syntax_node *node,
                       nevh__expression *e) {
    bool array = e->count > 0, indexed = node->kind == NEVH__NODE_ELEMENT;
    if (array && !indexed)
        return fail_array(r, node, e->count);
    if (!array && indexed)
        return nevh__resolver_fail_name(
            r, node, "%s is a single number: it has no index", "");
    return !indexed ||
           (e->operands[0].of = nevh__resolve_index(r, node->first)) != NULL;
}

static nevh__expression *new_parameter(nevh__resolver *r,
                                       const nevh__syntax_node *node,
                                       const nevh__entry *entry) {
    nevh__expression *e =
        nevh__expression_new(r, NEVH__FORM_PARAMETER, node, entry->count > 0);
    if (!e)
        return NULL;
    e->count = entry->count;
    e->values = entry->values;
    e->wide_values = entry->wide;
    return take_index(r, node, e) ? nevh__expression_finish(r, e) : NULL;
}

static nevh__expression *new_variable(nevh__resolver *r,
                                      const nevh__syntax_node *node,
                                      const nevh__entry *entry,
                                      nevh__meaning meaning) {
    bool q = meaning == NEVH__COORDINATE, p = meaning == NEVH__MOMENTUM;
    unsigned reads = q ? NEVH__READS_Q : p ? NEVH__READS_P : NEVH__READS_V;
    if (!permit(r, node, reads,
                q   ? "a coordinate"
                : p ? "a momentum"
                    : "a velocity"))
        return NULL;
    nevh__expression *e =
        nevh__expression_new(r, NEVH__FORM_VARIABLE, node, entry->count > 0);
    if (!e)
        return NULL;
    e->reads = reads;
    e->kind = q ? NEVH__Q : p ? NEVH__P : NEVH__C;
    e->first = entry->first;
    e->count = entry->count;
    if (!take_index(r, node, e))
        return NULL;
    if (e->n && !e->operands[0].of->indices) {
        if (!nevh__expression_element(&r->scope, e, &e->first))
            return NULL;
        e->n = 0;
    }
    return nevh__expression_finish(r, e);
}

static nevh__expression *resolve_definition(nevh__resolver *r,
                                            const nevh__entry *entry) {
    size_t i = (size_t)(entry - r->names->entries);
    if (r->definitions[i])
        return r->definitions[i];
    nevh__place outside = r->in;
    r->in = (nevh__place){.allowed = ANYTHING, .definition = entry->name};
    r->open[i] = true;
    nevh__expression *e = nevh__resolve_node(r, entry->tree->root);
    r->open[i] = false;
    r->in = outside;
    if (e)
        e->shared = true;
    return r->definitions[i] = e;
}

/* Most formulas, and all of parameters, have none. */
static bool meaning_reserve(nevh__resolver *r) {
    size_t count = r->names->count;
    if (!r->definitions)
        r->definitions =
            nevh__pool_take(r->pool, count, sizeof *r->definitions);
    if (!r->open)
        r->open = nevh__pool_take(r->pool, count, sizeof *r->open);
    if (r->definitions && r->open)
        return true;
    nevh__formula_no_memory(r->scope.error);
    return false;
}

static nevh__expression *use_definition(nevh__resolver *r,
                                        const nevh__syntax_node *node,
                                        const nevh__entry *entry) {
    if (node->kind == NEVH__NODE_ELEMENT)
        return nevh__resolver_fail_name(
            r, node, "%s is a definition: it has no index", "");
    if (!meaning_reserve(r))
        return NULL;
    if (r->open[entry - r->names->entries])
        return nevh__resolver_fail_name(r, node, "%s is defined by itself", "");
    nevh__expression *e = resolve_definition(r, entry);
    if (!e)
        return NULL;
    const char *kind = e->reads & NEVH__READS_V ? "made of velocities"
                       : e->reads & NEVH__READS_STATE
                           ? "made of coordinates or momenta"
                           : "made of the time";
    return permit(r, node, e->reads, kind) ? e : NULL;
}

static nevh__expression *
new_index(nevh__resolver *r, const nevh__syntax_node *node, unsigned slot) {
    if (node->kind == NEVH__NODE_ELEMENT)
        return nevh__resolver_fail_name(
            r, node, "%s is an index: it has none itself", "");
    nevh__expression *e = nevh__expression_new(r, NEVH__FORM_INDEX, node, 0);
    if (!e)
        return NULL;
    e->slot = slot;
    e->indices = (uint64_t)1 << slot;
    return nevh__expression_finish(r, e);
}

static nevh__expression *new_time(nevh__resolver *r,
                                  const nevh__syntax_node *node) {
    if (!permit(r, node, NEVH__READS_TIME, "the time"))
        return NULL;
    nevh__expression *e = nevh__expression_new(r, NEVH__FORM_TIME, node, 0);
    if (!e)
        return NULL;
    e->reads = NEVH__READS_TIME;
    return nevh__expression_finish(r, e);
}

/* t, pi. */
static nevh__expression *resolve_constant(nevh__resolver *r,
                                          const nevh__syntax_node *node) {
    if (node->kind == NEVH__NODE_ELEMENT)
        return nevh__resolver_fail_name(
            r, node, "%s is a single number: it has no index", "");
    if (node->name[0] == 't')
        return new_time(r, node);
    nevh__expression *pi = nevh__expression_new(r, NEVH__FORM_NUMBER, node, 0);
    if (!pi)
        return NULL;
    pi->wide_number = nevh__rounded_pi();
    pi->number = (double)pi->wide_number.value;
    return nevh__expression_finish(r, pi);
}

nevh__expression *nevh__resolve_name(nevh__resolver *r,
                                     const nevh__syntax_node *node) {
    for (const nevh__bound *b = r->in.bound; b; b = b->outer)
        if (strcmp(b->name, node->name) == 0)
            return new_index(r, node, b->slot);
    if (r->in.at && strcmp(r->in.at->name, node->name) == 0)
        return nevh__expression_number(r, node, (double)r->in.at->value);
    if (strcmp(node->name, "t") == 0 || strcmp(node->name, "pi") == 0)
        return resolve_constant(r, node);
    nevh__meaning meaning;
    const nevh__entry *entry =
        nevh__entry_named(r->names, node->name, &meaning);
    if (meaning == NEVH__PARAMETER)
        return new_parameter(r, node, entry);
    if (meaning == NEVH__DEFINITION)
        return use_definition(r, node, entry);
    if (entry)
        return new_variable(r, node, entry, meaning);
    r->scope.error->definition = r->in.definition;
    nevh__refuse_name(r->names, r->in.bound, node, r->in.in_index,
                      r->scope.error);
    return NULL;
}

/* nevh: names in a tree get their meanings.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <stdio.h>
#include <string.h>

enum { ANYTHING = NEVH__READS_TIME | NEVH__READS_STATE | NEVH__READS_V };

/* Where a name stands. */
typedef struct {
    unsigned allowed;
    bool in_index;
    const nevh__index *at;
    const nevh__bound *bound;
    const char *definition; /* NULL: in the formula itself */
} place;

typedef struct {
    const nevh__names *names;
    place in;
    nevh__expression **definitions; /* by entry; NULL: not yet */
    bool *open;                     /* by entry: being resolved */
    unsigned depth, slots;
    nevh__pool *pool;
    nevh__scope scope; /* its error is everybody's */
} resolver;

static nevh__expression *resolve(resolver *, const nevh__node *);

static void *fail(resolver *r, const nevh__node *node, size_t length,
                  const char *format, const char *a, const char *b) {
    nevh__formula_error *error = r->scope.error;
    if (!error->status)
        error->definition = r->in.definition;
    nevh__formula_fail(error, NEVH_EINVAL, node->column, length, format, a, b);
    return NULL;
}

static void *fail_name(resolver *r, const nevh__node *node, const char *format,
                       const char *b) {
    return fail(r, node, node->length, format, node->name, b);
}

static nevh__expression *new_expression(resolver *r, nevh__form form,
                                        const nevh__node *node, size_t n) {
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

/* What follows from the operands. */
static nevh__expression *finish(resolver *r, nevh__expression *e) {
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
        e->form = NEVH__FORM_NUMBER;
        e->n = 0;
    }
    set_hash(e);
    set_sums(e);
    return r->scope.error->status ? NULL : e;
}

static nevh__expression *new_number(resolver *r, const nevh__node *node,
                                    double number) {
    nevh__expression *e = new_expression(r, NEVH__FORM_NUMBER, node, 0);
    if (!e)
        return NULL;
    e->number = number;
    return finish(r, e);
}

/* Whether something may be read here that is of this kind. */
static bool permit(resolver *r, const nevh__node *node, unsigned reads,
                   const char *kind) {
    unsigned excess = reads & ~r->in.allowed;
    if (!excess)
        return true;
    if (r->in.in_index)
        fail_name(r, node,
                  "%s is %s, but indices and ranges are made of parameters "
                  "and index variables",
                  kind);
    else if (!r->in.allowed)
        fail_name(r, node, "%s is %s, but only parameters can stand here",
                  kind);
    else if (excess & NEVH__READS_V)
        fail_name(r, node,
                  "%s is %s, which cannot stand here; write it with "
                  "momenta",
                  kind);
    else
        fail_name(r, node, "%s is %s, which cannot stand here", kind);
    return false;
}

/* An operand resolved as an index or an end of a range. */
static nevh__expression *resolve_index(resolver *r, const nevh__node *node) {
    place outside = r->in;
    r->in.allowed = 0;
    r->in.in_index = true;
    nevh__expression *e = resolve(r, node);
    r->in = outside;
    return e;
}

static void *fail_array(resolver *r, const nevh__node *node, size_t count) {
    char advice[3 * NEVH__NAME_LENGTH];
    snprintf(advice, sizeof advice, "%s[1], or sum(i = 1..%zu, %s[i])",
             node->name, count, node->name);
    return fail_name(r, node, "%s has no index: write %s", advice);
}

/* Gives an element its index, where the name has any. */
static bool take_index(resolver *r, const nevh__node *node,
                       nevh__expression *e) {
    bool array = e->count > 0, indexed = node->kind == NEVH__NODE_ELEMENT;
    if (array && !indexed)
        return fail_array(r, node, e->count);
    if (!array && indexed)
        return fail_name(r, node, "%s is a single number: it has no index", "");
    return !indexed ||
           (e->operands[0].of = resolve_index(r, node->first)) != NULL;
}

static nevh__expression *new_parameter(resolver *r, const nevh__node *node,
                                       const nevh__entry *entry) {
    nevh__expression *e =
        new_expression(r, NEVH__FORM_PARAMETER, node, entry->count > 0);
    if (!e)
        return NULL;
    e->count = entry->count;
    e->values = entry->values;
    return take_index(r, node, e) ? finish(r, e) : NULL;
}

static nevh__expression *new_variable(resolver *r, const nevh__node *node,
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
        new_expression(r, NEVH__FORM_VARIABLE, node, entry->count > 0);
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
    return finish(r, e);
}

static nevh__expression *resolve_definition(resolver *r,
                                            const nevh__entry *entry) {
    size_t i = (size_t)(entry - r->names->entries);
    if (r->definitions[i])
        return r->definitions[i];
    place outside = r->in;
    r->in = (place){.allowed = ANYTHING, .definition = entry->name};
    r->open[i] = true;
    nevh__expression *e = resolve(r, entry->tree->root);
    r->open[i] = false;
    r->in = outside;
    if (e)
        e->shared = true;
    return r->definitions[i] = e;
}

static nevh__expression *use_definition(resolver *r, const nevh__node *node,
                                        const nevh__entry *entry) {
    if (node->kind == NEVH__NODE_ELEMENT)
        return fail_name(r, node, "%s is a definition: it has no index", "");
    if (r->open[entry - r->names->entries])
        return fail_name(r, node, "%s is defined by itself", "");
    nevh__expression *e = resolve_definition(r, entry);
    if (!e)
        return NULL;
    const char *kind = e->reads & NEVH__READS_V ? "made of velocities"
                       : e->reads & NEVH__READS_STATE
                           ? "made of coordinates or momenta"
                           : "made of the time";
    return permit(r, node, e->reads, kind) ? e : NULL;
}

static nevh__expression *new_index(resolver *r, const nevh__node *node,
                                   unsigned slot) {
    if (node->kind == NEVH__NODE_ELEMENT)
        return fail_name(r, node, "%s is an index: it has none itself", "");
    nevh__expression *e = new_expression(r, NEVH__FORM_INDEX, node, 0);
    if (!e)
        return NULL;
    e->slot = slot;
    e->indices = (uint64_t)1 << slot;
    return finish(r, e);
}

static nevh__expression *new_time(resolver *r, const nevh__node *node) {
    if (!permit(r, node, NEVH__READS_TIME, "the time"))
        return NULL;
    nevh__expression *e = new_expression(r, NEVH__FORM_TIME, node, 0);
    if (!e)
        return NULL;
    e->reads = NEVH__READS_TIME;
    return finish(r, e);
}

/* t, pi. */
static nevh__expression *resolve_constant(resolver *r, const nevh__node *node) {
    if (node->kind == NEVH__NODE_ELEMENT)
        return fail_name(r, node, "%s is a single number: it has no index", "");
    return node->name[0] == 't' ? new_time(r, node)
                                : new_number(r, node, 3.14159265358979323846);
}

static nevh__expression *resolve_name(resolver *r, const nevh__node *node) {
    for (const nevh__bound *b = r->in.bound; b; b = b->outer)
        if (strcmp(b->name, node->name) == 0)
            return new_index(r, node, b->slot);
    if (r->in.at && strcmp(r->in.at->name, node->name) == 0)
        return new_number(r, node, (double)r->in.at->value);
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

/* Resolves all operands of a node. */
static bool take_operands(resolver *r, const nevh__node *node,
                          nevh__expression *e) {
    const nevh__node *operand = node->first;
    for (size_t i = 0; i < e->n; i++, operand = operand->next) {
        e->operands[i].inverse = operand->inverse;
        if (!(e->operands[i].of = resolve(r, operand)))
            return false;
    }
    return true;
}

static size_t operands_of(const nevh__node *node) {
    size_t count = 0;
    for (const nevh__node *at = node->first; at; at = at->next)
        count++;
    return count;
}

static nevh__expression *resolve_chain(resolver *r, const nevh__node *node,
                                       nevh__form form) {
    nevh__expression *e = new_expression(r, form, node, operands_of(node));
    return e && take_operands(r, node, e) ? finish(r, e) : NULL;
}

static nevh__expression *apply(resolver *r, const nevh__node *node,
                               nevh__operation operation) {
    nevh__expression *e =
        new_expression(r, NEVH__FORM_APPLY, node, operands_of(node));
    if (!e || !take_operands(r, node, e))
        return NULL;
    e->operation = operation;
    const nevh__expression *last = e->operands[e->n - 1].of;
    if (operation == NEVH__POWER && last->form == NEVH__FORM_NUMBER &&
        last->number == 1)
        return e->operands[0].of;
    return finish(r, e);
}

static nevh__expression *resolve_call(resolver *r, const nevh__node *node) {
    nevh__operation operation =
        nevh__function_named(node->name, strlen(node->name));
    if (operation == NEVH__OPERATION_COUNT) {
        r->scope.error->definition = r->in.definition;
        nevh__refuse_name(r->names, r->in.bound, node, false, r->scope.error);
        return NULL;
    }
    if (operands_of(node) != (size_t)nevh__operation_arguments(operation))
        return fail(r, node, node->length,
                    "wrong number of arguments: it is %s%s", node->name,
                    nevh__function_usage(operation));
    return apply(r, node, operation);
}

/* Whether a new index may have this name. */
static bool check_bound(resolver *r, const nevh__node *node) {
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
        fail_name(r, node,
                  "%s already means something else: take another "
                  "name for the index",
                  "");
    else if (r->slots == NEVH__INDICES)
        fail_name(r, node, "with the index %s there are too many sums", "");
    return !r->scope.error->status;
}

static nevh__expression *resolve_loop(resolver *r, const nevh__node *node) {
    const nevh__node *from = node->first, *to = from->next, *body = to->next;
    nevh__expression *e = new_expression(r, NEVH__FORM_LOOP, node, 3);
    if (!e || !check_bound(r, node))
        return NULL;
    if (!(e->operands[0].of = resolve_index(r, from)) ||
        !(e->operands[1].of = resolve_index(r, to)))
        return NULL;
    nevh__bound bound = {node->name, r->slots++, r->in.bound};
    e->slot = bound.slot;
    r->in.bound = &bound;
    e->operands[2].of = resolve(r, body);
    r->in.bound = bound.outer;
    return e->operands[2].of ? finish(r, e) : NULL;
}

static nevh__expression *resolve_node(resolver *r, const nevh__node *node) {
    switch (node->kind) {
    case NEVH__NODE_NUMBER:
        return new_number(r, node, node->number);
    case NEVH__NODE_NAME:
    case NEVH__NODE_ELEMENT:
        return resolve_name(r, node);
    case NEVH__NODE_CALL:
        return resolve_call(r, node);
    case NEVH__NODE_LOOP:
        return resolve_loop(r, node);
    case NEVH__NODE_SUM:
        return resolve_chain(r, node, NEVH__FORM_SUM);
    case NEVH__NODE_PRODUCT:
        return resolve_chain(r, node, NEVH__FORM_PRODUCT);
    case NEVH__NODE_MINUS:
        return apply(r, node, NEVH__NEGATE);
    case NEVH__NODE_POWER:
        return apply(r, node, NEVH__POWER);
    }
    return NULL;
}

static nevh__expression *resolve(resolver *r, const nevh__node *node) {
    if (r->depth > 2 * NEVH__HEIGHT)
        return fail(
            r, node, node->length,
            "with definitions written out there are too many levels%s%s", "",
            "");
    r->depth++;
    nevh__expression *e = resolve_node(r, node);
    r->depth--;
    return e;
}

nevh__expression *nevh__resolve(const nevh__tree *tree,
                                const nevh__names *names, const nevh__index *at,
                                unsigned allowed, nevh__pool *pool,
                                nevh__formula_error *error) {
    resolver r = {.names = names, .pool = pool};
    r.in = (place){.allowed = allowed, .at = at};
    r.scope.error = error;
    r.definitions =
        nevh__pool_take(pool, names->count + 1, sizeof *r.definitions);
    r.open = nevh__pool_take(pool, names->count + 1, sizeof *r.open);
    if (r.definitions && r.open)
        return resolve(&r, tree->root);
    nevh__formula_no_memory(error);
    return NULL;
}

/* nevh: from text to tree, by recursive descent.

       sum      = product {("+" | "-") product}
       product  = sign {("*" | "/") sign}
       sign     = {"+" | "-"} power
       power    = value ["^" sign]
       value    = number | "(" sum ")" | name | name "[" sum "]"
                | name "(" sum {"," sum} ")"
                | "sum" "(" range {"," range} "," sum ")"
       range    = name "=" sum ".." sum

   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <stdlib.h>
#include <string.h>

void nevh__parser_advance(nevh__parser *p) {
    p->previous = p->token;
    p->token = nevh__scan(&p->scanner);
}

void nevh__parser_init(nevh__parser *p, const char *text, nevh__pool *pool,
                       nevh__formula_error *error) {
    *p = (nevh__parser){.pool = pool, .error = error};
    p->scanner = (nevh__scanner){text, 1, error};
    nevh__parser_advance(p);
}

/* True if a name and "=" follow: the head of a range. */
static bool at_range(const nevh__parser *p) {
    nevh__formula_error ignored = {0};
    nevh__scanner ahead = p->scanner;
    ahead.error = &ignored;
    return p->token.kind == NEVH__WORD && nevh__scan(&ahead).kind == '=';
}

char *nevh__parser_copy(nevh__parser *p, const nevh__token *token) {
    char *copy = nevh__pool_take(p->pool, token->bytes + 1, 1);
    if (copy)
        memcpy(copy, token->at, token->bytes);
    else
        nevh__formula_no_memory(p->error);
    return copy;
}

static nevh__syntax_node *new_node(nevh__parser *p, nevh__syntax_kind kind,
                                   size_t column) {
    nevh__syntax_node *node = nevh__pool_take(p->pool, 1, sizeof *node);
    if (!node) {
        nevh__formula_no_memory(p->error);
        return NULL;
    }
    node->kind = kind;
    node->column = column;
    return node;
}

/* A node that ends with the previous token. */
static nevh__syntax_node *ended(const nevh__parser *p,
                                nevh__syntax_node *node) {
    node->length = p->previous.column + p->previous.length - node->column;
    return node;
}

static bool expect(nevh__parser *p, int kind) {
    if (p->token.kind != kind)
        return nevh__parser_refuse(p) != NULL;
    nevh__parser_advance(p);
    return true;
}

/* The closing one to a token that was passed. */
static bool expect_closing(nevh__parser *p, int kind,
                           const nevh__token *opening) {
    if (p->token.kind == NEVH__END)
        return nevh__formula_fail(p->error, NEVH_EINVAL, opening->column, 1,
                                  "\"%c\" is missing for this \"%c\"", kind,
                                  opening->at[0]);
    return expect(p, kind);
}

/* Appends an operand, a sum, to a node. */
static bool take_operand(nevh__parser *p, nevh__syntax_node *node) {
    nevh__syntax_node **end = &node->first;
    while (*end)
        end = &(*end)->next;
    *end = nevh__parse_sum(p);
    return *end;
}

/* Whatever nests comes by here, and goes by leave. */
static bool parse_enter(nevh__parser *p) {
    if (p->depth++ < NEVH__NESTING)
        return true;
    return nevh__formula_fail(p->error, NEVH_EINVAL, p->token.column,
                              p->token.length,
                              "more than %d levels of parentheses, signs and "
                              "powers",
                              NEVH__NESTING);
}

static nevh__syntax_node *parse_leave(nevh__parser *p,
                                      nevh__syntax_node *node) {
    p->depth--;
    return node;
}

static nevh__syntax_node *parse_loop(nevh__parser *p,
                                     const nevh__token *opening) {
    nevh__syntax_node *loop = new_node(p, NEVH__NODE_LOOP, p->token.column);
    if (!loop || !parse_enter(p) ||
        !(loop->name = nevh__parser_copy(p, &p->token)))
        return NULL;
    nevh__parser_advance(p);
    ended(p, loop);
    if (!expect(p, '=') || !take_operand(p, loop) || !expect(p, NEVH__DOTS) ||
        !take_operand(p, loop))
        return NULL;
    if (p->token.kind == ')') {
        nevh__formula_fail(p->error, NEVH_EINVAL, p->token.column, 1,
                           "what is to be added up is missing: "
                           "sum(i = 1..N, x[i])");
        return NULL;
    }
    if (p->token.kind == NEVH__END)
        return expect_closing(p, ')', opening) ? loop : NULL;
    if (!expect(p, ','))
        return NULL;
    nevh__syntax_node *to = loop->first->next;
    to->next = at_range(p) ? parse_loop(p, opening) : nevh__parse_sum(p);
    return parse_leave(p, to->next ? loop : NULL);
}

static nevh__syntax_node *parse_loops(nevh__parser *p) {
    nevh__token opening = p->token;
    nevh__parser_advance(p);
    if (!at_range(p)) {
        nevh__formula_fail(p->error, NEVH_EINVAL, opening.column, 1,
                           "sum is written with a range: "
                           "sum(i = 1..N, x[i])");
        return NULL;
    }
    nevh__syntax_node *loop = parse_loop(p, &opening);
    return loop && expect_closing(p, ')', &opening) ? loop : NULL;
}

static nevh__syntax_node *parse_call(nevh__parser *p, nevh__syntax_node *call) {
    nevh__token opening = p->token;
    call->kind = NEVH__NODE_CALL;
    do {
        nevh__parser_advance(p);
        if (!take_operand(p, call))
            return NULL;
    } while (p->token.kind == ',');
    return expect_closing(p, ')', &opening) ? ended(p, call) : NULL;
}

static nevh__syntax_node *parse_element(nevh__parser *p,
                                        nevh__syntax_node *element) {
    nevh__token opening = p->token;
    element->kind = NEVH__NODE_ELEMENT;
    nevh__parser_advance(p);
    if (!take_operand(p, element))
        return NULL;
    if (p->token.kind == ',') {
        nevh__formula_fail(p->error, NEVH_EINVAL, p->token.column, 1,
                           "a name has one index");
        return NULL;
    }
    return expect_closing(p, ']', &opening) ? ended(p, element) : NULL;
}

static nevh__syntax_node *parse_name(nevh__parser *p) {
    nevh__syntax_node *node = new_node(p, NEVH__NODE_NAME, p->token.column);
    if (!node || !(node->name = nevh__parser_copy(p, &p->token)))
        return NULL;
    nevh__parser_advance(p);
    ended(p, node);
    bool sum = strcmp(node->name, "sum") == 0;
    if (p->token.kind == '(')
        return sum ? parse_loops(p) : parse_call(p, node);
    if (sum || nevh__function_named(node->name, strlen(node->name)) !=
                   NEVH__OPERATION_COUNT)
        return nevh__parser_refuse_function(p, node->name);
    return p->token.kind == '[' ? parse_element(p, node) : node;
}

static nevh__syntax_node *parse_number(nevh__parser *p) {
    nevh__syntax_node *node = new_node(p, NEVH__NODE_NUMBER, p->token.column);
    if (!node)
        return NULL;
    node->number = p->token.number;
    nevh__parser_advance(p);
    return ended(p, node);
}

static nevh__syntax_node *parse_value(nevh__parser *p) {
    nevh__token opening = p->token;
    if (opening.kind == NEVH__NUMERAL)
        return parse_number(p);
    if (opening.kind == NEVH__WORD)
        return parse_name(p);
    if (opening.kind != '(')
        return nevh__parser_refuse(p);
    nevh__parser_advance(p);
    nevh__syntax_node *inside = nevh__parse_sum(p);
    return inside && expect_closing(p, ')', &opening) ? inside : NULL;
}

static nevh__syntax_node *parse_sign(nevh__parser *);

static nevh__syntax_node *parse_power(nevh__parser *p) {
    size_t column = p->token.column;
    nevh__syntax_node *base = parse_value(p);
    if (!base || p->token.kind != '^')
        return base;
    nevh__parser_advance(p);
    nevh__syntax_node *exponent = parse_sign(p);
    nevh__syntax_node *power = new_node(p, NEVH__NODE_POWER, column);
    if (!exponent || !power)
        return NULL;
    power->first = base;
    base->next = exponent;
    return ended(p, power);
}

static nevh__syntax_node *parse_signed(nevh__parser *p) {
    if (p->token.kind == '+') {
        nevh__parser_advance(p);
        return parse_sign(p);
    }
    if (p->token.kind != '-')
        return parse_power(p);
    nevh__syntax_node *minus = new_node(p, NEVH__NODE_MINUS, p->token.column);
    nevh__parser_advance(p);
    if (!minus || !(minus->first = parse_sign(p)))
        return NULL;
    return ended(p, minus);
}

static nevh__syntax_node *parse_sign(nevh__parser *p) {
    return parse_enter(p) ? parse_leave(p, parse_signed(p)) : NULL;
}

/* Operands between `plus` and `minus`, or * and /. */
static nevh__syntax_node *
parse_chain(nevh__parser *p, nevh__syntax_kind kind, int plus, int minus,
            nevh__syntax_node *operand(nevh__parser *)) {
    size_t column = p->token.column;
    nevh__syntax_node *last = operand(p);
    if (!last || (p->token.kind != plus && p->token.kind != minus))
        return last;
    nevh__syntax_node *chain = new_node(p, kind, column);
    if (!chain)
        return NULL;
    chain->first = last;
    while (p->token.kind == plus || p->token.kind == minus) {
        bool inverse = p->token.kind == minus;
        nevh__parser_advance(p);
        if (!(last->next = operand(p)))
            return NULL;
        last = last->next;
        last->inverse = inverse;
    }
    return ended(p, chain);
}

static nevh__syntax_node *parse_product(nevh__parser *p) {
    return parse_chain(p, NEVH__NODE_PRODUCT, '*', '/', parse_sign);
}

nevh__syntax_node *nevh__parse_sum(nevh__parser *p) {
    return parse_chain(p, NEVH__NODE_SUM, '+', '-', parse_product);
}

static bool parse_all(nevh__tree *tree, const char *text,
                      nevh__formula_error *error) {
    nevh__parser parser;
    nevh__parser_init(&parser, text, &tree->pool, error);
    tree->length = nevh__characters(text);
    tree->root = nevh__parse_sum(&parser);
    if (tree->root && parser.token.kind != NEVH__END)
        nevh__parser_refuse(&parser);
    return !error->status;
}

nevh__tree *nevh__tree_parse(const char *text, nevh__formula_error *error) {
    *error = (nevh__formula_error){0};
    if (strlen(text) > NEVH__FORMULA_LENGTH) {
        nevh__formula_fail(error, NEVH_EINVAL, 1, nevh__characters(text),
                           "a formula may have at most %d bytes",
                           NEVH__FORMULA_LENGTH);
        return NULL;
    }
    nevh__tree *tree = nevh__array(1, sizeof *tree);
    if (!tree)
        nevh__formula_no_memory(error);
    else if (parse_all(tree, text, error))
        return tree;
    nevh__tree_free(tree);
    return NULL;
}

void nevh__tree_free(nevh__tree *tree) {
    if (tree)
        nevh__pool_free(&tree->pool);
    free(tree);
}

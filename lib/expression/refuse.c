/* nevh: what is wrong with a formula's text, and what to write instead.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <string.h>

/* An error over two tokens. */
static void *refuse_both(nevh__parser *p, const nevh__token *from,
                         const nevh__token *to, const char *format,
                         const char *instead) {
    nevh__formula_fail(p->error, NEVH_EINVAL, from->column,
                       to->column + to->length - from->column, format, instead);
    return NULL;
}

static void *refuse_token(nevh__parser *p, const nevh__token *token,
                          const char *text) {
    nevh__formula_fail(p->error, NEVH_EINVAL, token->column, token->length,
                       "%s", text);
    return NULL;
}

static bool ends_value(const nevh__token *token) {
    return token->kind == NEVH__NUMERAL || token->kind == NEVH__WORD ||
           token->kind == ')' || token->kind == ']';
}

static bool begins_value(const nevh__token *token) {
    return token->kind == NEVH__NUMERAL || token->kind == NEVH__WORD ||
           token->kind == '(';
}

/* The text of a token within a message; shortened where it is a long number. */
static const char *refuse_shown(nevh__parser *p, const nevh__token *token) {
    nevh__token part = *token;
    if (part.kind == NEVH__NUMERAL && part.bytes > 30)
        return "...";
    const char *copy = nevh__parser_copy(p, &part);
    return copy ? copy : "...";
}

/* 0.3 rad */
static void *refuse_unit(nevh__parser *p, const nevh__token *from,
                         const nevh__token *to, const char *word) {
    nevh__formula_fail(p->error, NEVH_EINVAL, from->column,
                       to->column + to->length - from->column,
                       "units are not read: put %s behind a #, or in [labels]; "
                       "for a product write %s*%s",
                       word, refuse_shown(p, from), word);
    return NULL;
}

/* Two values side by side. */
static void *refuse_neighbours(nevh__parser *p) {
    const nevh__token *from = &p->previous, *to = &p->token;
    bool numbers = from->kind == NEVH__NUMERAL && to->kind == NEVH__NUMERAL;
    if (numbers)
        return refuse_both(p, from, to, "%s",
                           from->at + from->bytes == to->at
                               ? "this is no number"
                               : "an operator is missing between two numbers");
    const char *left = from->kind == NEVH__NUMERAL || from->kind == NEVH__WORD
                           ? refuse_shown(p, from)
                           : "(...)";
    const char *right = to->kind == '(' ? "(...)" : refuse_shown(p, to);
    if (from->kind == ']')
        left = "[...]";
    bool apart = from->at + from->bytes != to->at;
    if (from->kind == NEVH__NUMERAL && to->kind == NEVH__WORD && apart)
        return refuse_unit(p, from, to, right);
    bool power = from->kind == NEVH__NUMERAL && to->bytes == 1 &&
                 (*to->at == 'e' || *to->at == 'E');
    nevh__formula_fail(p->error, NEVH_EINVAL, from->column,
                       to->column + to->length - from->column,
                       power ? "the exponent is missing, as in %se3; for a "
                               "product write %s*%s"
                             : "an operator is missing; for a product write "
                               "%.0s%s*%s",
                       left, left, right);
    return NULL;
}

static void *refuse_comma(nevh__parser *p) {
    nevh__scanner ahead = p->scanner;
    nevh__formula_error ignored = {0};
    ahead.error = &ignored;
    nevh__token next = nevh__scan(&ahead);
    bool decimal = p->previous.kind == NEVH__NUMERAL &&
                   next.kind == NEVH__NUMERAL && next.at == p->token.at + 1;
    return refuse_token(p, &p->token,
                        decimal ? "decimals are written with a point, as in 1.5"
                                : "there is nothing here that takes a \",\"");
}

/* A token that cannot follow what is complete. */
static void *refuse_after_value(nevh__parser *p) {
    if (begins_value(&p->token))
        return refuse_neighbours(p);
    switch (p->token.kind) {
    case ')':
        return refuse_token(p, &p->token, "there is no \"(\" to this \")\"");
    case ']':
        return refuse_token(p, &p->token, "there is no \"[\" to this \"]\"");
    case '[':
        return refuse_token(p, &p->token, "only a name can have an index");
    case ',':
        return refuse_comma(p);
    case NEVH__DOTS:
        return refuse_token(p, &p->token,
                            "a range stands only in sum(i = 1..N, ...)");
    case NEVH__END:
        return refuse_token(p, &p->previous,
                            "the formula ends here, but something is missing");
    default:
        return refuse_token(p, &p->token,
                            "a formula has no \"=\", except in "
                            "sum(i = 1..N, ...)");
    }
}

void *nevh__parser_refuse(nevh__parser *p) {
    const nevh__token *token = &p->token, *previous = &p->previous;
    if (p->error->status)
        return NULL;
    if (ends_value(previous))
        return refuse_after_value(p);
    if (token->kind == NEVH__END && !previous->at) {
        nevh__formula_fail(p->error, NEVH_EINVAL, 1, 0, "a formula is missing");
        return NULL;
    }
    if (token->kind == NEVH__END)
        return refuse_both(p, previous, previous,
                           "something is missing after \"%s\"",
                           refuse_shown(p, previous));
    if (token->kind == ')' && previous->kind == '(')
        return refuse_both(p, previous, token, "%s between the parentheses",
                           "something is missing");
    if (token->kind == '=' && previous->kind == '=')
        return refuse_both(p, previous, token, "%s", "write a single \"=\"");
    return refuse_both(p, token, token,
                       "a number, a name or \"(\" is missing before \"%s\"",
                       refuse_shown(p, token));
}

/* asin for sin, or NULL. */
static const char *inverse_of(const char *name) {
    static const char *const pairs[][2] = {
        {"sin", "asin"},   {"cos", "acos"},   {"tan", "atan"},
        {"sinh", "asinh"}, {"cosh", "acosh"}, {"tanh", "atanh"}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        if (strcmp(pairs[i][0], name) == 0)
            return pairs[i][1];
    return NULL;
}

/* sin^2(x) */
static void *refuse_power(nevh__parser *p, const nevh__token *function,
                          const char *name) {
    nevh__token power = p->token;
    nevh__parser_advance(p);
    bool minus = p->token.kind == '-';
    if (minus)
        nevh__parser_advance(p);
    nevh__token last = p->token.kind == NEVH__NUMERAL ? p->token : power;
    const char *exponent =
        last.kind == NEVH__NUMERAL ? refuse_shown(p, &last) : "2";
    const char *inverse = minus ? inverse_of(name) : NULL;
    size_t length = last.column + last.length - function->column;
    if (inverse)
        nevh__formula_fail(p->error, NEVH_EINVAL, function->column, length,
                           "write %s(x), or 1/%s(x)", inverse, name);
    else
        nevh__formula_fail(p->error, NEVH_EINVAL, function->column, length,
                           "write %s(x)^%s", name, exponent);
    return NULL;
}

void *nevh__parser_refuse_function(nevh__parser *p, const char *name) {
    nevh__token function = p->previous;
    if (strcmp(name, "sum") == 0)
        return refuse_token(p, &function, "sum is written sum(i = 1..N, x[i])");
    if (p->token.kind == '^')
        return refuse_power(p, &function, name);
    bool argument =
        p->token.kind == NEVH__WORD || p->token.kind == NEVH__NUMERAL;
    const nevh__token *last = argument ? &p->token : &function;
    nevh__formula_fail(p->error, NEVH_EINVAL, function.column,
                       last->column + last->length - function.column,
                       "%s is a function: write %s(%s)", name, name,
                       argument ? refuse_shown(p, last) : "x");
    return NULL;
}

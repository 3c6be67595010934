/* nevh: formulas in MathML (Core).
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _POSIX_C_SOURCE 200809L
#include "expression/formula_inside_private.h"
#include "system/print_private.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put_node(FILE *, const nevh__syntax_node *);

static const char *const greek[][2] = {
    {"alpha", "α"}, {"beta", "β"},    {"gamma", "γ"},  {"delta", "δ"},
    {"eps", "ε"},   {"epsilon", "ε"}, {"zeta", "ζ"},   {"eta", "η"},
    {"theta", "θ"}, {"kappa", "κ"},   {"lambda", "λ"}, {"mu", "μ"},
    {"nu", "ν"},    {"xi", "ξ"},      {"pi", "π"},     {"rho", "ρ"},
    {"sigma", "σ"}, {"tau", "τ"},     {"phi", "φ"},    {"chi", "χ"},
    {"psi", "ψ"},   {"omega", "ω"},   {"Gamma", "Γ"},  {"Delta", "Δ"},
    {"Omega", "Ω"}, {"Phi", "Φ"},     {"Psi", "Ψ"},    {"Lambda", "Λ"},
};

static void put_identifier(FILE *f, const char *name, size_t bytes) {
    for (size_t i = 0; i < sizeof greek / sizeof *greek; i++)
        if (strlen(greek[i][0]) == bytes &&
            memcmp(greek[i][0], name, bytes) == 0) {
            fprintf(f, "<mi>%s</mi>", greek[i][1]);
            return;
        }
    fprintf(f, "<mi>%.*s</mi>", (int)bytes, name);
}

static void begin_index(FILE *f, const char *name, size_t base) {
    fputs("<msub>", f);
    put_identifier(f, name, base);
    fputs("<mrow>", f);
}

/* p_x is p with the index x, and phi1 is phi with the index 1.  `index` is one
   more index, of an element; NULL: none. */
static void put_name(FILE *f, const char *name, size_t bytes,
                     const nevh__syntax_node *index) {
    const char *bar = memchr(name, '_', bytes);
    size_t base = bar ? (size_t)(bar - name) : bytes;
    if (base > 0 && base + 1 < bytes) {
        begin_index(f, name, base);
        put_name(f, bar + 1, bytes - base - 1, index);
        fputs("</mrow></msub>", f);
        return;
    }
    base = bytes;
    while (base > 1 && name[base - 1] >= '0' && name[base - 1] <= '9')
        base--;
    if (base == bytes && !index) {
        put_identifier(f, name, bytes);
        return;
    }
    begin_index(f, name, base);
    if (base < bytes)
        fprintf(f, "<mn>%.*s</mn>%s", (int)(bytes - base), name + base,
                index ? "<mo>,</mo>" : "");
    if (index)
        put_node(f, index);
    fputs("</mrow></msub>", f);
}

static void put_number(FILE *f, double number) {
    char text[40];
    for (int digits = 6; digits <= 17; digits++) {
        nevh__print(text, sizeof text, "%.*g", digits, number);
        if (nevh__read_number(text) == number)
            break;
    }
    char *power = strchr(text, 'e');
    if (!power) {
        fprintf(f, "<mn>%s</mn>", text);
        return;
    }
    *power = '\0';
    int exponent = atoi(power + 1);
    if (strcmp(text, "1") != 0)
        fprintf(f, "<mn>%s</mn><mo>⋅</mo>", text);
    fprintf(f, "<msup><mn>10</mn><mrow>%s<mn>%d</mn></mrow></msup>",
            exponent < 0 ? "<mo>−</mo>" : "", abs(exponent));
}

static void put_enclosed(FILE *f, const char *open,
                         const nevh__syntax_node *node, const char *close) {
    fprintf(f, "<mrow><mo>%s</mo>", open);
    put_node(f, node);
    fprintf(f, "<mo>%s</mo></mrow>", close);
}

/* In parentheses where it binds less than `kind`. */
static void put_within(FILE *f, const nevh__syntax_node *node,
                       nevh__syntax_kind kind) {
    static const int binding[] = {
        [NEVH__NODE_SUM] = 1,   [NEVH__NODE_LOOP] = 2,
        [NEVH__NODE_MINUS] = 2, [NEVH__NODE_PRODUCT] = 3,
        [NEVH__NODE_POWER] = 4, [NEVH__NODE_NUMBER] = 5,
        [NEVH__NODE_NAME] = 5,  [NEVH__NODE_ELEMENT] = 5,
        [NEVH__NODE_CALL] = 5,
    };
    _Static_assert(sizeof binding / sizeof *binding == NEVH__NODE_POWER + 1,
                   "each kind of node");
    bool tight =
        binding[node->kind] > binding[kind] ||
        (binding[node->kind] == binding[kind] && kind == NEVH__NODE_PRODUCT);
    if (tight)
        put_node(f, node);
    else
        put_enclosed(f, "(", node, ")");
}

/* Factors over or under the line.  A lone one stands without parentheses, and so
   does a sign at the beginning. */
static void put_factors(FILE *f, const nevh__syntax_node *product, bool inverse,
                        size_t count) {
    const nevh__syntax_node *last = NULL;
    if (count == 0)
        fputs("<mn>1</mn>", f);
    for (const nevh__syntax_node *x = product->first; x; x = x->next) {
        if (x->inverse != inverse)
            continue;
        if (last)
            fputs(x->kind == NEVH__NODE_NUMBER || last->kind == NEVH__NODE_CALL
                      ? "<mo>⋅</mo>"
                      : "<mo>&#x2062;</mo>",
                  f);
        if (count == 1 || (!last && x->kind == NEVH__NODE_MINUS))
            put_node(f, x);
        else
            put_within(f, x, NEVH__NODE_PRODUCT);
        last = x;
    }
}

static void put_product(FILE *f, const nevh__syntax_node *node) {
    size_t over = 0, under = 0;
    for (const nevh__syntax_node *x = node->first; x; x = x->next)
        (*(x->inverse ? &under : &over))++;
    if (under == 0) {
        put_factors(f, node, false, over);
        return;
    }
    fputs("<mfrac><mrow>", f);
    put_factors(f, node, false, over);
    fputs("</mrow><mrow>", f);
    put_factors(f, node, true, under);
    fputs("</mrow></mfrac>", f);
}

static void put_sum(FILE *f, const nevh__syntax_node *node) {
    for (const nevh__syntax_node *x = node->first; x; x = x->next) {
        if (x != node->first)
            fputs(x->inverse ? "<mo>−</mo>" : "<mo>+</mo>", f);
        if (x != node->first && x->kind == NEVH__NODE_MINUS)
            put_enclosed(f, "(", x, ")");
        else if (x->inverse)
            put_within(f, x, NEVH__NODE_SUM);
        else
            put_node(f, x);
    }
}

static void put_loop(FILE *f, const nevh__syntax_node *node) {
    const nevh__syntax_node *from = node->first, *to = from->next;
    fputs("<munderover><mo>∑</mo><mrow>", f);
    put_name(f, node->name, strlen(node->name), NULL);
    fputs("<mo>=</mo>", f);
    put_node(f, from);
    fputs("</mrow><mrow>", f);
    put_node(f, to);
    fputs("</mrow></munderover>", f);
    put_within(f, to->next, NEVH__NODE_SUM);
}

static void put_arguments(FILE *f, const nevh__syntax_node *call) {
    fputs("<mo>&#x2061;</mo><mrow><mo>(</mo>", f);
    for (const nevh__syntax_node *x = call->first; x; x = x->next) {
        fputs(x == call->first ? "" : "<mo>,</mo>", f);
        put_node(f, x);
    }
    fputs("<mo>)</mo></mrow>", f);
}

static void put_call(FILE *f, const nevh__syntax_node *node) {
    if (strcmp(node->name, "sqrt") == 0) {
        fputs("<msqrt>", f);
        put_node(f, node->first);
        fputs("</msqrt>", f);
    } else if (strcmp(node->name, "abs") == 0) {
        put_enclosed(f, "|", node->first, "|");
    } else {
        fprintf(f, "<mi>%s</mi>", node->name);
        put_arguments(f, node);
    }
}

/* sin^2(x) for the square of a sine. */
static void put_power(FILE *f, const nevh__syntax_node *node) {
    const nevh__syntax_node *base = node->first, *exponent = base->next;
    bool called =
        base->kind == NEVH__NODE_CALL && exponent->kind == NEVH__NODE_NUMBER &&
        strcmp(base->name, "sqrt") != 0 && strcmp(base->name, "abs") != 0;
    fputs("<msup>", f);
    if (called)
        fprintf(f, "<mi>%s</mi>", base->name);
    else {
        fputs("<mrow>", f);
        put_within(f, base, NEVH__NODE_POWER);
        fputs("</mrow>", f);
    }
    fputs("<mrow>", f);
    put_node(f, exponent);
    fputs("</mrow></msup>", f);
    if (called)
        put_arguments(f, base);
}

static void put_node(FILE *f, const nevh__syntax_node *node) {
    switch (node->kind) {
    case NEVH__NODE_NUMBER:
        put_number(f, node->number);
        break;
    case NEVH__NODE_NAME:
        put_name(f, node->name, strlen(node->name), NULL);
        break;
    case NEVH__NODE_ELEMENT:
        put_name(f, node->name, strlen(node->name), node->first);
        break;
    case NEVH__NODE_CALL:
        put_call(f, node);
        break;
    case NEVH__NODE_LOOP:
        put_loop(f, node);
        break;
    case NEVH__NODE_SUM:
        put_sum(f, node);
        break;
    case NEVH__NODE_PRODUCT:
        put_product(f, node);
        break;
    case NEVH__NODE_MINUS:
        fputs("<mo>−</mo>", f);
        put_within(f, node->first, NEVH__NODE_MINUS);
        break;
    case NEVH__NODE_POWER:
        put_power(f, node);
        break;
    }
}

char *nevh__equation_mathml(const char *name, const nevh__tree *tree) {
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    if (!f)
        return NULL;
    fputs("<math displaystyle=\"true\"><mrow>", f);
    put_name(f, name, strlen(name), NULL);
    fputs("<mo>=</mo>", f);
    put_node(f, tree->root);
    fputs("</mrow></math>", f);
    bool failed = ferror(f);
    if (fclose(f) || failed) {
        free(text);
        return NULL;
    }
    return text;
}

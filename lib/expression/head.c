/* nevh: the left side of a line, and where formulas end.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <stdlib.h>
#include <string.h>

static char *copy_word(nevh__parser *p) {
    char *copy = nevh__array(p->token.bytes + 1, 1);
    if (copy)
        memcpy(copy, p->token.at, p->token.bytes);
    else
        nevh__formula_no_memory(p->error);
    nevh__parser_advance(p);
    return copy;
}

/* A formula that goes on until something else begins. */
static nevh__tree *parse_bound(nevh__parser *p) {
    nevh__tree *tree = nevh__array(1, sizeof *tree);
    if (!tree) {
        nevh__formula_no_memory(p->error);
        return NULL;
    }
    p->pool = &tree->pool;
    tree->root = nevh__parse_sum(p);
    if (tree->root)
        tree->length = tree->root->column + tree->root->length - 1;
    return tree;
}

static bool head_accept(nevh__parser *p, int kind) {
    bool is = p->token.kind == kind;
    if (is)
        nevh__parser_advance(p);
    return is;
}

/* Parses the range after "[". */
static bool parse_range(nevh__parser *p, nevh__head *head) {
    nevh__parser ahead = *p;
    nevh__formula_error ignored = {0};
    ahead.scanner.error = &ignored;
    nevh__parser_advance(&ahead);
    if (p->token.kind == NEVH__WORD && ahead.token.kind == '=') {
        if (!(head->index = copy_word(p)))
            return false;
        nevh__parser_advance(p);
    }
    head->from = parse_bound(p);
    if (p->error->status)
        return false;
    if (head_accept(p, NEVH__DOTS))
        head->to = parse_bound(p);
    else if (head->index)
        return nevh__parser_refuse(p) != NULL;
    return !p->error->status;
}

static bool parse_head(nevh__parser *p, nevh__head *head) {
    if (p->token.kind != NEVH__WORD)
        return nevh__formula_fail(p->error, NEVH_EINVAL, p->token.column,
                                  p->token.length, "a name is missing here");
    if (!(head->name = copy_word(p)))
        return false;
    nevh__token opening = p->token;
    if (head_accept(p, '[')) {
        if (!parse_range(p, head))
            return false;
        if (p->token.kind == NEVH__END)
            return nevh__formula_fail(p->error, NEVH_EINVAL, opening.column, 1,
                                      "\"]\" is missing for this \"[\"");
        if (!head_accept(p, ']'))
            return nevh__parser_refuse(p) != NULL;
    }
    if (p->token.kind == NEVH__END)
        return true;
    return nevh__formula_fail(p->error, NEVH_EINVAL, p->token.column,
                              p->token.length,
                              "only NAME, NAME[1..N] or NAME[i = 1..N] can "
                              "stand here");
}

int nevh__head_parse(const char *text, nevh__head *head,
                     nevh__formula_error *error) {
    *error = (nevh__formula_error){0};
    *head = (nevh__head){0};
    if (strlen(text) > NEVH__FORMULA_LENGTH) {
        nevh__formula_fail(error, NEVH_EINVAL, 1, nevh__characters(text),
                           "this is too long for a name");
        return error->status;
    }
    nevh__pool pool = {0}; /* of words in messages */
    nevh__parser parser;
    nevh__parser_init(&parser, text, &pool, error);
    if (!parse_head(&parser, head))
        nevh__head_free(head);
    nevh__pool_free(&pool);
    return error->status;
}

void nevh__head_free(nevh__head *head) {
    free(head->name);
    free(head->index);
    nevh__tree_free(head->from);
    nevh__tree_free(head->to);
    *head = (nevh__head){0};
}

size_t nevh__formula_extent(const char *text, const char *stops) {
    size_t depth = 0, at = 0;
    for (; text[at]; at++) {
        bool closing = text[at] == ')' || text[at] == ']';
        if (depth == 0 && strchr(stops, text[at]))
            return at;
        depth += text[at] == '(' || text[at] == '[';
        depth -= closing && depth > 0;
    }
    return at;
}

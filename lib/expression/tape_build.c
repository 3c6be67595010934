/* nevh: the nodes of a tape in the making, each of them once.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_CAPACITY = 32 };

nevh__tape_builder *nevh__tape_builder_new(void) {
    return nevh__array(1, sizeof(nevh__tape_builder));
}

void nevh__tape_unfold(nevh__tape_builder *b) {
    b->unfolded = true;
}

void nevh__tape_abandon(nevh__tape_builder *b) {
    if (!b)
        return;
    free(b->nodes);
    free(b->table);
    free(b);
}

static size_t tape_build_hash(const nevh__tape_node *n) {
    static const uint64_t odd = 0x9e3779b97f4a7c15u;
    uint64_t h = n->bits + n->kind;
    h = (h ^ h >> 32) * odd + n->operation;
    h = (h ^ h >> 32) * odd + (uint64_t)n->a;
    h = (h ^ h >> 32) * odd + (uint64_t)n->b;
    h = (h ^ h >> 32) * odd;
    return (size_t)(h >> 16);
}

static bool tape_build_same(const nevh__tape_node *x,
                            const nevh__tape_node *y) {
    return x->kind == y->kind && x->operation == y->operation && x->a == y->a &&
           x->b == y->b && x->bits == y->bits;
}

/* The place of a node in the table, or the free place for it. */
static size_t tape_build_place(const nevh__tape_builder *b,
                               const nevh__tape_node *n) {
    size_t mask = b->table_size - 1, i = tape_build_hash(n) & mask;
    while (b->table[i] >= 0 && !tape_build_same(&b->nodes[b->table[i]], n))
        i = (i + 1) & mask;
    return i;
}

int nevh__builder_find(const nevh__tape_builder *b, const nevh__tape_node *n) {
    return b->table[tape_build_place(b, n)];
}

static bool tape_build_grow(nevh__tape_builder *b) {
    if (b->capacity > INT_MAX / 4)
        return false;
    int capacity = b->capacity ? 2 * b->capacity : FIRST_CAPACITY;
    nevh__tape_node *nodes =
        nevh__grow(b->nodes, (size_t)capacity, sizeof *nodes);
    if (!nodes)
        return false;
    b->nodes = nodes;
    int *table = nevh__array(2 * (size_t)capacity, sizeof *table);
    if (!table)
        return false;
    free(b->table);
    b->table = table;
    b->table_size = 2 * (size_t)capacity;
    b->capacity = capacity;
    memset(table, 0xff, b->table_size * sizeof *table);
    for (int i = 0; i < b->used; i++)
        table[tape_build_place(b, &nodes[i])] = i;
    return true;
}

int nevh__builder_node(nevh__tape_builder *b, nevh__tape_node node) {
    if (!b || b->failed)
        return -1;
    if (b->used == b->capacity && !tape_build_grow(b)) {
        b->failed = true;
        return -1;
    }
    int *at = &b->table[tape_build_place(b, &node)];
    if (*at < 0) {
        b->nodes[b->used] = node;
        *at = b->used++;
    }
    return *at;
}

double nevh__tape_node_number(const nevh__tape_node *n) {
    double x;
    memcpy(&x, &n->bits, sizeof x);
    return x;
}

int nevh__tape_number(nevh__tape_builder *b, double x) {
    nevh__tape_node node = {.kind = NEVH__NUMBER};
    memcpy(&node.bits, &x, sizeof x);
    return nevh__builder_node(b, node);
}

int nevh__tape_variable(nevh__tape_builder *b, nevh__variable v, size_t k) {
    if (!b)
        return -1;
    if (k >= UINT32_MAX / 2)
        b->failed = true;
    else if (b->count[v] <= k)
        b->count[v] = k + 1;
    return nevh__builder_node(b,
                              (nevh__tape_node){.kind = (uint8_t)v, .bits = k});
}

bool nevh__tape_is_number(const nevh__tape_builder *b, int node,
                          double *value) {
    if (node < 0 || b->nodes[node].kind != NEVH__NUMBER)
        return false;
    if (value)
        *value = nevh__tape_node_number(&b->nodes[node]);
    return true;
}

/* nevh: order conditions of Runge-Kutta methods.

   The trees are generated: one of order n is a multiset of smaller ones, put on a
   root.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/order_private.h"
#include "system/system_private.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Adds all trees that have these children and more, of `left` vertices and not
   later than `latest`. */
static void grow(nevh__trees *x, nevh__rooted t, int left, int latest) {
    if (left == 0) {
        x->tree[x->count++] = t;
        return;
    }
    for (int i = latest; i >= 0; i--) {
        if (x->tree[i].order > left)
            continue;
        nevh__rooted more = t;
        more.child[more.children++] = i;
        more.density *= x->tree[i].density;
        grow(x, more, left - x->tree[i].order, i);
    }
}

void nevh__trees_plant(nevh__trees *x, int order) {
    x->count = x->end[0] = 0;
    for (int k = 1; k <= order; k++) {
        grow(x, (nevh__rooted){.order = k, .density = k}, k - 1, x->count - 1);
        x->end[k] = x->count;
    }
}

void nevh__trees_weigh(const nevh__trees *x, size_t stages,
                       const long double a[], long double phi[],
                       long double above[]) {
    for (int t = 0; t < x->count; t++) {
        long double *own = phi + (size_t)t * stages;
        long double *up = above + (size_t)t * stages;
        for (size_t i = 0; i < stages; i++) {
            own[i] = 1;
            for (int k = 0; k < x->tree[t].children; k++)
                own[i] *= above[(size_t)x->tree[t].child[k] * stages + i];
        }
        for (size_t i = 0; i < stages; i++) {
            up[i] = 0;
            for (size_t j = 0; j < stages; j++)
                up[i] += a[i * stages + j] * own[j];
        }
    }
}

/* The condition of one tree; phi, size: its weights, and those of what the numbers
   are without their signs. */
static void check_tree(const nevh__rooted *t, size_t which, size_t stages,
                       const long double b[], const long double phi[],
                       const long double size[], double digits,
                       nevh__conditions *to) {
    long double value = 0, all = 0, due = 1 / t->density;
    for (size_t i = 0; i < stages; i++) {
        value += b[i] * phi[i];
        all += fabsl(b[i]) * size[i];
    }
    double excess = (double)(fabsl(value - due) / (digits * t->order * all));
    bool first = !(to->excess > 1) && excess > 1;
    to->excess = fmax(to->excess, excess);
    if (!first)
        return;
    to->which = which;
    to->value = value;
    to->due = due;
}

bool nevh__trees_check(const nevh__trees *x, size_t stages,
                       const long double a[], const long double b[], int order,
                       double digits, nevh__conditions found[]) {
    size_t each = (size_t)x->count * stages, square = stages * stages;
    long double *all = nevh__array(4 * each + square, sizeof *all);
    if (!all)
        return false;
    long double *phi = all, *size = phi + each, *above = size + each;
    long double *plain = above + 2 * each;
    for (size_t i = 0; i < square; i++)
        plain[i] = fabsl(a[i]);
    nevh__trees_weigh(x, stages, a, phi, above);
    nevh__trees_weigh(x, stages, plain, size, above + each);
    for (int k = 1; k <= order; k++) {
        found[k] = (nevh__conditions){0};
        for (int t = x->end[k - 1]; t < x->end[k]; t++)
            check_tree(&x->tree[t], (size_t)t, stages, b,
                       phi + (size_t)t * stages, size + (size_t)t * stages,
                       digits, &found[k]);
    }
    free(all);
    return true;
}

typedef struct {
    char *text;
    size_t size, used;
    char last; /* the letter used last */
} speller;

static void put(speller *s, const char *text) {
    if (s->used < s->size)
        s->used +=
            (size_t)snprintf(s->text + s->used, s->size - s->used, "%s", text);
}

/* The factors of a vertex: c of leaves, a of others, which have letters. */
static void spell(speller *s, const nevh__trees *x, int which, char own) {
    const nevh__rooted *t = &x->tree[which];
    int leaves = 0;
    char factor[16];
    for (int k = 0; k < t->children; k++)
        if (x->tree[t->child[k]].order == 1)
            leaves++;
        else {
            char letter = ++s->last;
            snprintf(factor, sizeof factor, " a_%c%c", own, letter);
            put(s, factor);
            spell(s, x, t->child[k], letter);
        }
    if (leaves > 1)
        snprintf(factor, sizeof factor, " c_%c^%d", own, leaves);
    else
        snprintf(factor, sizeof factor, " c_%c", own);
    if (leaves)
        put(s, factor);
}

void nevh__tree_text(const nevh__trees *x, size_t which, char text[],
                     size_t size) {
    speller s = {text, size, 0, 'i'};
    put(&s, "sum of b_i");
    spell(&s, x, (int)which, 'i');
}

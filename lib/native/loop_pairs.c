/* nevh: derivatives of a term of pairs of bodies as C text: a loop over blocks of
   eight bodies, turned past each other.

   Eight bodies of one block stand in the lanes of vectors, and so do eight of another,
   turned by 0, 1, ... 7.  What they give is added to slopes in vectors, instance by
   instance as the tape adds it: within a block that is paired with itself, the second
   body of a pair has its turn before the lane behind it is a first one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/slope_private.h"
#include "system/pairs_private.h"
#include <stdio.h>
#include <stdlib.h>

/* Packed of a pair of blocks: the first body of each and how many there are, and which
   lanes are there for each turn, a byte each. */
enum { FIELDS = 6, TURN = NEVH__LANES, BLOCK = TURN * NEVH__LANES };

typedef struct {
    const nevh__term_loop *loop;
    nevh__pairs of;
    size_t blocks, rows; /* pairs of blocks; of eight pairs of bodies */
    size_t places, constants;
} pairs;

static size_t left(const pairs *x, size_t body, bool second) {
    size_t rest = x->of.bodies[second] - body;
    return rest < NEVH__LANES ? rest : NEVH__LANES;
}

static void begin_block(const pairs *x, size_t instance, uint32_t block[]) {
    for (int half = 0; half < 2; half++) {
        size_t body = nevh__pairs_body(&x->of, instance, half);
        body -= body % NEVH__LANES;
        block[half] = (uint32_t)body;
        block[2 + half] = (uint32_t)left(x, body, half);
    }
}

/* Blocks, and the place of each instance's constants. */
static bool list_blocks(pairs *x, size_t at[]) {
    size_t before = SIZE_MAX, row = SIZE_MAX;
    uint32_t *all = NULL;
    for (size_t i = 0; i < x->of.count; i++) {
        size_t key = nevh__pairs_key(&x->of, i);
        if (key / BLOCK != before) {
            uint32_t *more =
                nevh__grow(all, (x->blocks + 1) * FIELDS, sizeof *all);
            if (!more) {
                free(all);
                return false;
            }
            all = more;
            for (size_t k = 0; k < FIELDS; k++)
                all[x->blocks * FIELDS + k] = 0;
            begin_block(x, i, all + x->blocks++ * FIELDS);
            before = key / BLOCK;
        }
        x->rows += key / NEVH__LANES != row;
        row = key / NEVH__LANES;
        all[(x->blocks - 1) * FIELDS + 4 + row % TURN / 4] |=
            (uint32_t)1 << (row % 4 * 8 + key % NEVH__LANES);
        at[i] = (x->rows - 1) * NEVH__LANES + key % NEVH__LANES;
    }
    x->places = x->loop->s->w->count;
    nevh__loop_pack_all(x->loop->s->w, all, x->blocks * FIELDS);
    free(all);
    return true;
}

/* Columns of constants; lanes without a pair have those of the first. */
static bool list_constants(pairs *x, const size_t at[]) {
    nevh__writer *w = x->loop->s->w;
    const nevh_term *is = nevh__loop_term(x->loop);
    size_t size = x->rows * NEVH__LANES;
    double *column = nevh__array(size, sizeof *column);
    x->constants = w->count;
    for (size_t k = 0; column && k < is->nc; k++) {
        for (size_t i = 0; i < size; i++)
            column[i] = is->c[k];
        for (size_t i = 0; i < is->count; i++)
            column[at[i]] = is->c[i * is->nc + k];
        for (size_t i = 0; i < size; i++)
            nevh__writer_append(w, column[i]);
    }
    free(column);
    return column;
}

static bool list_all(pairs *x) {
    size_t *at = nevh__array(x->of.count, sizeof *at);
    bool fine = at && list_blocks(x, at) && list_constants(x, at);
    free(at);
    x->loop->s->w->failed |= !fine;
    return fine;
}

static const char *half_of(const pairs *x, size_t k) {
    return x->of.of_second >> k & 1 ? "b" : "a";
}

/* States and slopes of both blocks. */
static void loop_pairs_write_loads(const pairs *x) {
    nevh__writer *w = x->loop->s->w;
    unsigned id = x->loop->id;
    for (size_t k = 0; k < x->of.nq; k++) {
        const char *half = half_of(x, k);
        nevh__write(
            w,
            "        const wide %s%u_%zu = load_row(q + %zu + %s, left_%s);\n",
            *half == 'b' ? "y" : "x", id, k, nevh__pairs_base(&x->of, k), half,
            half);
    }
    for (size_t v = 0; v < x->loop->n_vars; v++) {
        size_t k = x->loop->vars[v];
        const char *half = half_of(x, k);
        nevh__write(
            w, "        wide s%u_%zu = load_row(slope + %zu + %s, left_%s);\n",
            id, k, nevh__pairs_base(&x->of, k), half, half);
    }
}

static void write_turn(const pairs *x) {
    nevh__writer *w = x->loop->s->w;
    unsigned id = x->loop->id;
    for (size_t k = 0; k < x->of.nq; k++)
        if (x->of.of_second >> k & 1)
            nevh__write(w, "    wide x%u_%zu = turned(y%u_%zu, turn);\n", id, k,
                        id, k);
    for (size_t k = 0; k < nevh__loop_term(x->loop)->nc; k++)
        nevh__write(w, "    wide c%u_%zu = *(const wide *)(c + %zu);\n", id, k,
                    k * x->rows * NEVH__LANES);
}

/* The first bodies' variable whose slope is that of variable k, too, in a block that
   is alone; SIZE_MAX: there is none. */
static size_t shares_with(const pairs *x, size_t k) {
    size_t partner = nevh__pairs_partner(&x->of, k);
    for (size_t v = 0; v < x->loop->n_vars; v++)
        if (x->loop->vars[v] == partner)
            return partner;
    return SIZE_MAX;
}

/* Adds to the second bodies, and then to the first. */
static void write_adds(const pairs *x) {
    nevh__writer *w = x->loop->s->w;
    unsigned id = x->loop->id;
    for (size_t v = 0; v < x->loop->n_vars; v++) {
        size_t k = x->loop->vars[v], partner = shares_with(x, k);
        if (!(x->of.of_second >> k & 1))
            continue;
        nevh__write(
            w,
            "    const wide to%u_%zu = turned(only(row%u_%zu, there), 8 "
            "- turn);\n",
            id, k, id, k);
        if (partner != SIZE_MAX)
            nevh__write(w, "    if (alone) s%u_%zu += to%u_%zu; else\n", id,
                        partner, id, k);
        nevh__write(w, "    s%u_%zu += to%u_%zu;\n", id, k, id, k);
    }
    for (size_t v = 0; v < x->loop->n_vars; v++) {
        size_t k = x->loop->vars[v];
        if (!(x->of.of_second >> k & 1))
            nevh__write(w, "    s%u_%zu += only(row%u_%zu, there);\n", id, k,
                        id, k);
    }
}

static void write_stores(const pairs *x) {
    nevh__writer *w = x->loop->s->w;
    unsigned id = x->loop->id;
    for (size_t v = 0; v < x->loop->n_vars; v++) {
        size_t k = x->loop->vars[v];
        const char *half = half_of(x, k);
        bool shared = shares_with(x, k) != SIZE_MAX;
        nevh__write(
            w, "        %sstore_row(slope + %zu + %s, s%u_%zu, left_%s);\n",
            shared ? "if (!alone) " : "", nevh__pairs_base(&x->of, k), half, id,
            k, half);
    }
}

/* Blocks; $4: numbers of one. */
static const char begins[] =
    "    {\n"
    "    const place *g = (const place *)(N + $1);\n"
    "    const double *c = N + $2;\n"
    "    wide all_bad = {0};\n"
    "    for (size block = 0; block < $3; block++, g += $4) {\n"
    "        const size a = g[0], b = g[1], left_a = g[2], left_b = g[3];\n"
    "        const bool alone = $5;\n";
static const char turns[] =
    "        for (size turn = 0; turn < 8; turn++) {\n"
    "    const place bits = g[4 + turn / 4] >> turn % 4 * 8 & 255;\n"
    "    if (!bits)\n        continue;\n"
    "    const lanes there = lanes_of(bits);\n"
    "    wide bad = {0};\n";

static void write_number(char name[NEVH__NAME], size_t x) {
    snprintf(name, NEVH__NAME, "%zu", x);
}

bool nevh__write_pairs(const nevh__term_loop *loop) {
    nevh__term_loop inside = *loop;
    pairs x = {.loop = &inside};
    nevh__writer *w = loop->s->w;
    char number[4][NEVH__NAME];
    const nevh_term *is = nevh__loop_term(loop);
    inside.in_registers = true;
    if (!nevh__pairs_find(&x.of, is->nq, is->np, is->count, is->q) ||
        !list_all(&x))
        return false;
    write_number(number[0], x.places);
    write_number(number[1], x.constants);
    write_number(number[2], x.blocks);
    write_number(number[3], FIELDS);
    nevh__write_filled(w, begins,
                       (const char *const[]){number[0], number[1], number[2],
                                             number[3],
                                             x.of.same ? "a == b" : "false"});
    loop_pairs_write_loads(&x);
    nevh__write_lines(w, (const char *const[]){turns, NULL});
    write_turn(&x);
    if (!nevh__write_loop_body(&inside))
        return false;
    write_adds(&x);
    nevh__write(w,
                "    all_bad += only(bad, there);\n    c += 8;\n        }\n");
    write_stores(&x);
    nevh__write(w, "    }\n    rows_bad += sum_of(all_bad);\n    }\n");
    return true;
}

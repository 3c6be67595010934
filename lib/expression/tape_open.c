/* nevh: numbers of a tape as constants.

   Tapes that differ in numbers alone then are one, and states side by side may
   have numbers of their own.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include <string.h>

size_t nevh__tape_numbers(const nevh__tape *tape, const double **numbers) {
    *numbers = tape->numbers;
    return tape->n_numbers;
}

static bool copy_parts(const nevh__tape *from, size_t constants,
                       nevh__tape *to) {
    size_t numbers = from->n_numbers, all = constants, at = 0;
    for (int v = 0; v < NEVH__C; v++)
        all += from->count[v];
    to->code = nevh__copy(from->code, from->length + 1, sizeof *to->code);
    to->numbers = nevh__copy(from->numbers, numbers, sizeof(double));
    to->wide_memory = nevh__array((numbers + 1) * NEVH__LANES, sizeof(double));
    to->read[0] = nevh__array(all, sizeof(bool));
    if (!to->code || !to->numbers || !to->wide_memory || !to->read[0])
        return false;
    double *wide = nevh__aligned(to->wide_memory);
    memcpy(wide, from->wide, numbers * NEVH__LANES * sizeof *wide);
    to->wide = wide;
    for (int v = 0; v < NEVH__VARIABLES; at += from->count[v++]) {
        to->read[v] = to->read[0] + at;
        memcpy(to->read[v], from->read[v], from->count[v] * sizeof(bool));
    }
    to->count[NEVH__C] = constants;
    return true;
}

/* The constant that a number becomes. */
static uint32_t tape_open_place_of(const nevh__tape *from, const bool opened[],
                                   uint32_t number) {
    uint32_t at = (uint32_t)from->count[NEVH__C];
    for (uint32_t i = 0; i < number; i++)
        at += opened[i];
    return at;
}

static void tape_open_open(const nevh__tape *from, const bool opened[],
                           nevh__tape *to, nevh__tape_operand *o) {
    if (o->kind != NEVH__NUMBER || !opened[o->at])
        return;
    o->kind = NEVH__C;
    o->at = tape_open_place_of(from, opened, o->at);
    to->read[NEVH__C][o->at] = true;
}

nevh__tape *nevh__tape_open(const nevh__tape *from, const bool opened[]) {
    size_t constants =
        tape_open_place_of(from, opened, (uint32_t)from->n_numbers);
    nevh__tape *to = nevh__copy(from, 1, sizeof *from);
    if (!to)
        return NULL;
    to->code = NULL;
    to->numbers = to->wide_memory = NULL;
    to->read[0] = NULL;
    if (!copy_parts(from, constants, to)) {
        nevh__tape_free(to);
        return NULL;
    }
    tape_open_open(from, opened, to, &to->result);
    for (size_t i = 0; i < to->length; i++) {
        tape_open_open(from, opened, to, &to->code[i].a);
        tape_open_open(from, opened, to, &to->code[i].b);
    }
    return to;
}

/* nevh: where a block's rows stand in the state.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SCATTER_MAP_PRIVATE_H
#define NEVH_SCATTER_MAP_PRIVATE_H

#include <stdbool.h>
#include <stddef.h>

/* From a half of the state to the rows of a block of all instances of a term,
   one row for each variable of an instance, and back.  Lists of a variable's
   numbers are in their order in the block. */
typedef struct {
    size_t rows, count, stride; /* count: instances; stride: padded */
    size_t *source;             /* rows x stride: of one lane */
    size_t targets;             /* variables that are written to */
    size_t *target;
    size_t *begin;   /* targets + 1: of the lists */
    size_t *column;  /* each list: in rows of `stride`, of one lane */
    bool contiguous; /* row after row, as they stand in the state */
} nevh__scatter_map;

/* For `count` instances whose variable k of instance i is index[i*rows + k] of
   n; false when memory is out.
   uses     n zeros, before and after
   in_turn  what instances give is added instance by instance, not variable by
            variable */
bool nevh__scatter_map_init(nevh__scatter_map *, size_t uses[], size_t rows,
                            size_t count, const size_t index[], bool in_turn);
void nevh__scatter_map_clear(nevh__scatter_map *);
/* Fills rows of `stride` with all instances of `width` lanes, and then with
   column 0; adds such rows to what they belong to, and tells whether all are
   finite. */
void nevh__gather(const nevh__scatter_map *, size_t width, size_t stride,
                  const double from[], double to[]);
bool nevh__scatter(const nevh__scatter_map *, size_t width, size_t stride,
                   const double from[], double out[]);
/* True if variable k of instance i is number i + k: one row after another, in a
   block of one instance or of one variable. */
bool nevh__contiguous(const size_t index[], size_t variables, size_t count);

#endif

/* nevh: what elementary.h needs in compiled text: SHAPE is 1 for numbers, else the
   lanes of a vector.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ELEMENTARY_SHAPE_H
#define NEVH_ELEMENTARY_SHAPE_H

#undef REAL
#undef BITS
#undef PICK
#undef EVERY
#undef BITS_OF
#undef REAL_OF
#undef ONE
#undef FAR
#if SHAPE == 1
typedef unsigned long long bits;
typedef union {
    double x;
    bits b;
} number_bits;
#define REAL          double
#define BITS          bits
#define PICK(c, x, y) ((c) ? (x) : (y))
#define EVERY(c)      (c)
#define BITS_OF(x)    (((number_bits){x}).b)
#define REAL_OF(c)    (((number_bits){.b = c}).x)
#define ONE(f)        own_##f
#define own_sqrt      __builtin_sqrt
#define FAR(x, r, rest, turns)                                                 \
    if (__builtin_expect(!((x) < 0x1p20), 0))                                  \
    *(turns) = nevh__turn_far(x, r, rest)
#else
#if SHAPE == 8
typedef bits wide_bits __attribute__((vector_size(64), aligned(8)));
#define REAL     wide
#define BITS     wide_bits
#define EVERY(c) ALL(c)
#define ONE(f)   wide_##f
#else
typedef bits few_bits __attribute__((vector_size(32), aligned(8)));
#define REAL     few
#define BITS     few_bits
#define EVERY(c) ALL_FOUR(c)
#define ONE(f)   few_##f
#endif
#define BITS_OF(x) ((BITS)(x))
#define REAL_OF(c) ((REAL)(c))
#define PICK(c, x, y)                                                          \
    ((__typeof__(x))(((BITS)(c) & (BITS)(x)) | (~(BITS)(c) & (BITS)(y))))
/* Who calls such text looks for NaN, and asks the tape. */
#define FAR(x, r, rest, turns)                                                 \
    *(rest) = PICK((x) < 0x1p20, *(rest), EVERY(__builtin_nan("")))
#endif

#endif

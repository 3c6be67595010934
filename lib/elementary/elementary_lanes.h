/* nevh: elementary functions of vectors.  The includer has included
   elementary_number.h, and defines NEVH__SIDE, how many numbers a vector has,
   NEVH__NUMBER, its type, NEVH__PAIR, a name for a pair of them, and NEVH__E.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ELEMENTARY_LANES_H /* never defined */

#define NEVH__BITS NEVH__E(whole)
#ifndef NEVH__TWO_BITS
#define NEVH__TWO_BITS
typedef uint64_t nevh__two_bits __attribute__((vector_size(16), aligned(8)));
#endif
typedef uint64_t NEVH__BITS
    __attribute__((vector_size(8 * NEVH__SIDE), aligned(8)));

NEVH__INLINE NEVH__BITS NEVH__E(bits)(NEVH__NUMBER x) {
    return (NEVH__BITS)x;
}

NEVH__INLINE NEVH__NUMBER NEVH__E(number)(NEVH__BITS bits) {
    return (NEVH__NUMBER)bits;
}

NEVH__INLINE NEVH__BITS NEVH__E(less)(NEVH__NUMBER x, NEVH__NUMBER y) {
    return (NEVH__BITS)(x < y);
}

/* x where the mask has bits, else y. */
NEVH__INLINE NEVH__NUMBER NEVH__E(choose)(NEVH__BITS mask, NEVH__NUMBER x,
                                          NEVH__NUMBER y) {
    return (NEVH__NUMBER)(((NEVH__BITS)x & mask) | ((NEVH__BITS)y & ~mask));
}

#ifndef NEVH__HAS_SQRT
NEVH__INLINE NEVH__NUMBER NEVH__E(sqrt)(NEVH__NUMBER x) {
    for (int i = 0; i < NEVH__SIDE; i++)
        x[i] = __builtin_sqrt(x[i]);
    return x;
}
#endif

NEVH__INLINE bool NEVH__E(every)(NEVH__BITS mask) {
    union {
        NEVH__BITS all;
        nevh__two_bits part[NEVH__SIDE / 2];
    } u = {mask};
    for (int i = 1; i < NEVH__SIDE / 2; i++)
        u.part[0] &= u.part[i];
    return (u.part[0][0] & u.part[0][1]) != 0;
}

static NEVH__RARE NEVH__NUMBER NEVH__E(mended)(NEVH__BITS good, NEVH__NUMBER y,
                                               NEVH__NUMBER x,
                                               double (*f)(double)) {
    for (int i = 0; i < NEVH__SIDE; i++)
        y[i] = good[i] ? y[i] : f(x[i]);
    return y;
}

NEVH__INLINE NEVH__NUMBER NEVH__E(mend)(NEVH__BITS good, NEVH__NUMBER y,
                                        NEVH__NUMBER x, double (*f)(double)) {
    return NEVH__E(every)(good) ? y : NEVH__E(mended)(good, y, x, f);
}

static NEVH__RARE NEVH__NUMBER
NEVH__E(mended_two)(NEVH__BITS good, NEVH__NUMBER value, NEVH__NUMBER x,
                    NEVH__NUMBER y, double (*f)(double, double)) {
    for (int i = 0; i < NEVH__SIDE; i++)
        value[i] = good[i] ? value[i] : f(x[i], y[i]);
    return value;
}

NEVH__INLINE NEVH__NUMBER NEVH__E(mend_two)(NEVH__BITS good, NEVH__NUMBER value,
                                            NEVH__NUMBER x, NEVH__NUMBER y,
                                            double (*f)(double, double)) {
    return NEVH__E(every)(good) ? value
                                : NEVH__E(mended_two)(good, value, x, y, f);
}

#undef NEVH__SIDE
#include "elementary/elementary_text.h"

#endif

/* nevh: numbers with more digits than double, for constants of formulas.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_WIDE_PRIVATE_H
#define NEVH_WIDE_PRIVATE_H

#ifdef NEVH_QUADMATH
__extension__ typedef __float128 nevh__wide;
#define NEVH__WIDE_FUNCTION(f) f##q
#define NEVH__WIDE_ROUNDING    0x1p-106 /* of a few operations */
#define NEVH__WIDE_EPSILON     0x1p-112
#elif defined(__wasm__) /* long doubles are slow and large there */
typedef double nevh__wide;
#define NEVH__WIDE_FUNCTION(f) f
#define NEVH__WIDE_ROUNDING    0x1p-48
#define NEVH__WIDE_EPSILON     0x1p-52
#else
typedef long double nevh__wide;
#define NEVH__WIDE_FUNCTION(f) f##l
#define NEVH__WIDE_ROUNDING    0x1p-58
#define NEVH__WIDE_EPSILON     0x1p-63
#endif

/* One nevh__tape_operation on numbers.  Without libquadmath special functions
   are those of doubles. */
nevh__wide nevh__operation_wide(unsigned operation, nevh__wide a, nevh__wide b);
nevh__wide nevh__wide_pi(void);

/* A number that was computed, and how far rounding may have moved it. */
typedef struct {
    nevh__wide value, off;
} nevh__rounded;
nevh__rounded nevh__rounded_pi(void);
/* The number as far away as rounding may have moved it, or some times as far; another
   number is moved by another factor, of either sign. */
nevh__wide nevh__rounded_away(nevh__rounded);
nevh__rounded nevh__operation_rounded(unsigned operation, nevh__rounded a,
                                      nevh__rounded b);

/* Three doubles whose sum is the number. */
enum { NEVH__WIDE_PARTS = 3 };
static inline void nevh__wide_split(nevh__wide x,
                                    double part[NEVH__WIDE_PARTS]) {
    for (int i = 0; i < NEVH__WIDE_PARTS; i++) {
        part[i] = (double)x;
        x -= part[i];
    }
}
/* The rest of a number that is too small for its parts, which are doubles. */
static inline nevh__wide nevh__wide_left(nevh__wide x, const double part[]) {
    for (int i = 0; i < NEVH__WIDE_PARTS; i++)
        x -= part[i];
    return x;
}

#endif

/* nevh: elementary functions of one number; what elementary_text.h needs for it, and
   what the functions of any numbers share.
   SPDX-License-Identifier: GPL-3.0-or-later

   The includer has size_t, uint64_t, INFINITY, NAN, memcpy, floor, sqrt and
   NEVH__INLINE. */
#ifndef NEVH_ELEMENTARY_NUMBER_H
#define NEVH_ELEMENTARY_NUMBER_H

#ifndef NEVH__FOR_READERS
#ifndef NEVH__MAIN
#define NEVH__MAIN NEVH__INLINE
#endif
#ifdef __GNUC__
#define NEVH__UNROLLED _Pragma("GCC unroll 16")
#define NEVH__RARE     __attribute__((cold, noinline))
#else
#define NEVH__UNROLLED
#define NEVH__RARE
#endif
#endif

/* Bits of doubles: the sign; 1; the root of 1/2; 2^52, added to whole numbers; the
   fraction; and the first 25 bits of it. */
#define NEVH__ONE_SIGN       ((uint64_t)1 << 63)
#define NEVH__ONE_BITS       0x3ff0000000000000u
#define NEVH__ONE_ROOT       0x3fe6a09e667f3bcdu
#define NEVH__ONE_SHIFTED    0x4330000000000000u
#define NEVH__ONE_FRACTION   0x000fffffffffffffu
#define NEVH__ONE_SHORT      0xfffffffff8000000u
#define NEVH__ONE_HALF_SHORT 0x4000000u
/* Added and subtracted, it leaves a whole number. */
#define NEVH__ONE_ROUND 0x1.8p52
/* Below the first odd functions are their arguments; angles beyond the second need
   elementary_edges.h; exponents beyond the third overflow. */
#define NEVH__ONE_LITTLE 0x1p-27
#define NEVH__ONE_FAR    1e6
#define NEVH__ONE_STEEP  800.0

/* pi/2 by 33 bits and a rest, and by two doubles. */
static const double NEVH__ONE_QUARTER[] = {
    0x1.921fb544p+0,        0x1.0b4611a6p-34,     0x1.3198a2ep-69,
    0x1.b839a252049c1p-104, 0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
/* log(2) by 32 bits and a rest, and as one double; 2/3; 1/log(10). */
static const double NEVH__ONE_LN2[] = {0x1.62e42feep-1, 0x1.a39ef35793c76p-33,
                                       0x1.62e42fefa39efp-1};
static const double NEVH__ONE_TWO_THIRDS[] = {0x1.5555555555555p-1,
                                              0x1.5555555555555p-55};
static const double NEVH__ONE_PER_LN10[] = {0x1.bcb7b1526e50ep-2,
                                            0x1.95355baaafad3p-57};

/* (sin(x)/x - 1)/x^2 and the like: of x^2, but those of exp and the cube root of x,
   and those of log of ((x - 1)/(x + 1))^2. */
static const double nevh__one_sine[] = {
    -0x1.5555555555555p-3, 0x1.1111111111110p-7,   -0x1.a01a01a019926p-13,
    0x1.71de3a545e700p-19, -0x1.ae64540f0ba18p-26, 0x1.61217c1864fa1p-33,
    -0x1.ab161757f0c63p-41};
static const double nevh__one_cosine[] = {0x1.5555555555555p-5,
                                          -0x1.6c16c16c16960p-10,
                                          0x1.a01a019f4d0edp-16,
                                          -0x1.27e4fa15bd814p-22,
                                          0x1.1eeb66b683028p-29,
                                          -0x1.907c0e63adbb6p-37,
                                          0};
static const double nevh__one_exponential[] = {
    0x1.0000000000000p-1,  0x1.5555555555557p-3,  0x1.5555555555556p-5,
    0x1.11111111100bep-7,  0x1.6c16c16c162c3p-10, 0x1.a01a01abf85abp-13,
    0x1.a01a01a6e1e2ap-16, 0x1.71de01fdbf9cap-19, 0x1.27e4db46cddd1p-22,
    0x1.af4e554377204p-26, 0x1.1f7340dbc337ep-29};
static const double nevh__one_logarithm[] = {
    0x1.5555555555558p-1, 0x1.9999999995204p-2, 0x1.2492492e09d4dp-2,
    0x1.c71c62c639fdep-3, 0x1.7462bd8f7796ep-3, 0x1.39fd392179a95p-3,
    0x1.2b6688a387e03p-3};
static const double nevh__one_logarithm_rest[] = {
    0x1.999999999999ap-2, 0x1.2492492492523p-2, 0x1.c71c71c6ea0c3p-3,
    0x1.745d177b19a81p-3, 0x1.3b13959b359a4p-3, 0x1.1118d38b0f57bp-3,
    0x1.df7a598f77bc4p-4, 0x1.e047e001993cbp-4};
static const double nevh__one_arctangent[] = {
    -0x1.5555555555555p-2, 0x1.99999999998c1p-3,  -0x1.2492492485138p-3,
    0x1.c71c71bd022abp-4,  -0x1.745d154551dfep-4, 0x1.3b13751405671p-4,
    -0x1.110c9133aa5bdp-4, 0x1.e16f8f1c47b36p-5,  -0x1.ab537f7d4c8dbp-5,
    0x1.6fe829d0a3ec1p-5,  -0x1.0f2861ac33793p-5, 0x1.e32edd64fe1d6p-7};
static const double nevh__one_arcsine[] = {
    0x1.5555555555555p-3, 0x1.333333333332dp-4,  0x1.6db6db6db7cc5p-5,
    0x1.f1c71c70eaa23p-6, 0x1.6e8ba31d6ffb0p-6,  0x1.1c4ebd5b57f2ap-6,
    0x1.c99b033e24ec2p-7, 0x1.7a707bf2f13eep-7,  0x1.40e6659b2ceebp-7,
    0x1.0a83b301a63bap-7, 0x1.209a2aab920efp-7,  0x1.621676c123564p-12,
    0x1.731ec507868d2p-6, -0x1.8bafe89f4c365p-6, 0x1.f8904489aadc5p-6};
static const double nevh__one_sinh_rest[] = {
    0x1.5555555555555p-3,  0x1.1111111111111p-7,  0x1.a01a01a01a001p-13,
    0x1.71de3a556f9acp-19, 0x1.ae64567924223p-26, 0x1.612467d1c2fabp-33,
    0x1.ae777839b3498p-41, 0x1.99f1ba85cd318p-49};
static const double nevh__one_cosh_rest[] = {
    0x1.5555555555555p-5,  0x1.6c16c16c16c0ep-10, 0x1.a01a01a01c30fp-16,
    0x1.27e4fb7444175p-22, 0x1.1eed93aabc793p-29, 0x1.939074e3f05f6p-37,
    0x1.b374223e35012p-45};
static const double nevh__one_cube_root[] = {
    0x1.4ecb7ee28e2bbp-1, 0x1.a612e6bf7887cp-2, -0x1.166aa5a8ad33cp-4,
    0x1.ca0ace5bab84ep-8, -0x1.2e387317adddep-12};
/* From which argument on the angle is measured from that of c; tan of the difference
   is (x c2 - c3)/(c2 + x c3); the angle by two doubles. */
static const double nevh__one_arc[][6] = {
    {0.4375, 0, 2, 1, 0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0.6875, 0, 1, 1, 0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
    {1.1875, 0, 2, 3, 0x1.f730bd281f69bp-1, 0x1.007887af0cbbdp-56},
    {2.4375, 0, 0, 0, 0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54}};

static double nevh__one_sin_far(double x);
static double nevh__one_cos_far(double x);
static double nevh__one_tan_far(double x);
static double nevh__one_pow_edge(double x, double y);
static double nevh__one_atan2_edge(double y, double x);
static double nevh__one_hypot_edge(double x, double y);

#ifndef NEVH__FOR_READERS
#define NEVH__NUMBER double
#define NEVH__BITS   uint64_t
#define NEVH__PAIR   nevh__one_pair
#define NEVH__E(f)   nevh__one_##f
#endif

NEVH__INLINE uint64_t nevh__one_bits(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

NEVH__INLINE double nevh__one_number(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

NEVH__INLINE uint64_t nevh__one_less(double x, double y) {
    return -(uint64_t)(x < y);
}

NEVH__INLINE double nevh__one_choose(uint64_t mask, double x, double y) {
    return mask ? x : y;
}

NEVH__INLINE double nevh__one_sqrt(double x) {
    return sqrt(x);
}

/* y where `good`, else f(x). */
NEVH__INLINE double nevh__one_mend(uint64_t good, double y, double x,
                                   double (*f)(double)) {
    return good ? y : f(x);
}

NEVH__INLINE double nevh__one_mend_two(uint64_t good, double value, double x,
                                       double y, double (*f)(double, double)) {
    return good ? value : f(x, y);
}

#include "elementary/elementary_text.h"
#include "elementary/elementary_edges.h"

#endif

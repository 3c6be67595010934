/* nevh: what loops over the instances of terms need in compiled steps, behind
   compiled_formulas.h.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_LOOP_NEEDS_H
#define NEVH_LOOP_NEEDS_H

typedef unsigned place __attribute__((may_alias));
#define APART static __attribute__((noinline, unused))

APART wide load_part(const double *x, size left) {
    wide y;
    EACH_LANE y[lane] = x[(size)lane < left ? lane : 0];
    return y;
}

INLINE wide load_row(const double *x, size left) {
    return left >= 8 ? *(const wide *)x : load_part(x, left);
}

INLINE wide load_at(const double *x, const place *at, size left) {
    wide y;
    EACH_LANE y[lane] = x[at[(size)lane < left ? lane : 0]];
    return y;
}

APART void add_row(double *to, const double *x, size count) {
    size i = 0;
    for (; i + 8 <= count; i += 8)
        *(wide *)(to + i) += *(const wide *)(x + i);
    for (; i < count; i++)
        to[i] += x[i];
}

/* Derivatives that a row gives to variables from `at` on, but for those that are not
   asked for. */
INLINE void add_some(double *slope, size at, const double *x, size count,
                     size first, size past) {
    size skip = at < first ? first - at : 0;
    size stop = past < at ? 0 : past - at < count ? past - at : count;
    if (skip < stop)
        add_row(slope + at + skip, x + skip, stop - skip);
}

APART void add_all(double *to, const double *x, size count) {
    double sum = *to;
    for (size i = 0; i < count; i++)
        sum += x[i];
    *to = sum;
}

INLINE void add_at(double *to, const place *at, const double *x, size count) {
    for (size i = 0; i < count; i++)
        to[at[i]] += x[i];
}

/* Pairs: which lanes are there, by bits; others are given -0.0, which changes nothing
   that it is added to. */
typedef long long lanes __attribute__((vector_size(64), aligned(8)));
INLINE lanes lanes_of(place bits) {
    const long long b = bits;
    const lanes all = {b, b, b, b, b, b, b, b};
    return (all & (lanes){1, 2, 4, 8, 16, 32, 64, 128}) != 0;
}

INLINE wide only(wide x, lanes there) {
    return (wide)(((lanes)x & there) | ((lanes)ALL(-0.0) & ~there));
}

/* Lane i is lane i + by of x, modulo 8. */
INLINE wide turned(wide x, size by) {
#ifdef __clang__
    double twice[16];
    *(wide *)twice = *(wide *)(twice + 8) = x;
    return *(const wide *)(twice + by % 8);
#else
    const long long n = (long long)by;
    return (wide)__builtin_shuffle((lanes)x,
                                   (lanes){0, 1, 2, 3, 4, 5, 6, 7} +
                                       (lanes){n, n, n, n, n, n, n, n});
#endif
}

INLINE void store_row(double *to, wide x, size left) {
    if (left >= 8)
        *(wide *)to = x;
    else
        for (size i = 0; i < left; i++)
            to[i] = x[i];
}

INLINE double sum_of(wide x) {
    return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]));
}

/* Pieces of instances from `from` to `until`.  g: where a piece begins, and which
   variables its first instance reads; the next piece follows. */
#define EACH_PIECE(g, fields)                                                  \
    for (size begin = from, end;                                               \
         begin < until && (end = g[fields] < until ? g[fields] : until, 1);    \
         g += g[fields] == end ? fields : 0, begin = end)

#undef SLOPE
#define SLOPE static __attribute__((noinline))

#endif

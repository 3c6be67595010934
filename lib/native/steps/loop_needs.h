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

/* nevh: functions that formulas call, in compiled steps and in programs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FORMULA_NEEDS_H
#define NEVH_FORMULA_NEEDS_H

NEVH__INLINE double nevh__choose(int first, double x, double y) {
    return first ? x : y;
}

NEVH__INLINE double nevh__real_min(double x, double y) {
    return x != x || x < y ? x : y;
}

NEVH__INLINE double nevh__real_max(double x, double y) {
    return x != x || x > y ? x : y;
}

NEVH__INLINE double nevh__sign(double x) {
    return x != x ? x : x > 0 ? 1 : x < 0 ? -1 : 0;
}

#ifdef NEVH__FOR_READERS
static double nevh__chain(double x, double y) {
    return x * y;
}
#else
#define nevh__chain(x, y) ((x) * (y)) /* of numbers and of vectors */
#endif

NEVH__INLINE double nevh__mod(double x, double y) {
    double rest = fmod(x, y);
    return rest != 0 && (rest < 0) != (y < 0) ? rest + y : rest;
}

#endif

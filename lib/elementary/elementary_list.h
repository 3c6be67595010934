/* nevh: the elementary functions, all that have one result on every machine.
   SPDX-License-Identifier: GPL-3.0-or-later

   X(name, f, family): nevh_simd_NAME, as <nevh/simd.h> declares it; the name f in
   elementary_text.h and in <math.h>; which part of that text it stands in.  Hyperbolic
   functions need powers. */
#ifndef NEVH_ELEMENTARY_LIST_H
#define NEVH_ELEMENTARY_LIST_H

#define NEVH__EACH_ONE(X)                                                      \
    X(sin, sin, CIRCLE)                                                        \
    X(cos, cos, CIRCLE)                                                        \
    X(tan, tan, CIRCLE)                                                        \
    X(asin, asin, ARCS)                                                        \
    X(acos, acos, ARCS)                                                        \
    X(atan, atan, ARCS)                                                        \
    X(sinh, sinh, HYPERBOLIC | POWERS)                                         \
    X(cosh, cosh, HYPERBOLIC | POWERS)                                         \
    X(tanh, tanh, HYPERBOLIC | POWERS)                                         \
    X(asinh, asinh, HYPERBOLIC | POWERS)                                       \
    X(acosh, acosh, HYPERBOLIC | POWERS)                                       \
    X(atanh, atanh, HYPERBOLIC | POWERS)                                       \
    X(exp, exp, POWERS)                                                        \
    X(log, log, POWERS)                                                        \
    X(log10, log10, POWERS)                                                    \
    X(cbrt, cbrt, ROOTS)

/* Functions of two numbers. */
#define NEVH__EACH_TWO(X)                                                      \
    X(atan2, atan2, ARCS)                                                      \
    X(hypot, hypot, ROOTS)                                                     \
    X(power, pow, POWERS)

#endif

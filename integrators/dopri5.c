/* nevh: Dormand and Prince's method of order 5, with an estimate from order 4.

   The quotients of whole numbers are rounded once.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

static const double a[7][7] = {
    {0},
    {1. / 5},
    {3. / 40, 9. / 40},
    {44. / 45, -56. / 15, 32. / 9},
    {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
    {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
    {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84},
};
static const double b[] = {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784,
                           11. / 84,  0};
static const double c[] = {0, 1. / 5, 3. / 10, 4. / 5, 8. / 9, 1, 1};
/* b less 5179/57600, 0, 7571/16695, 393/640, -92097/339200, 187/2100, 1/40. */
static const double error[] = {
    71. / 57600,      0,         -71. / 16695, 71. / 1920,
    -17253. / 339200, 22. / 525, -1. / 40};
static const nevh_butcher table = {
    7, a[0], b, c, .error = error, .error_power = 5, .last_is_first = true};

const nevh_integrator nevh__dopri5_entry = {
    .name = "dopri5",
    .aliases = "DOPRI5, RK45, rk45, ode45, dormand-prince5",
    .source = "J. R. Dormand, P. J. Prince, A family of embedded Runge-Kutta "
              "formulae, J. Comput. Appl. Math. 6 (1980) 19-26, RK5(4)7M",
    .order = 5,
    .stages = 7,
    .gradients = 6,
    .adaptive = true,
    NEVH__EXPLICIT_RUNGE_KUTTA(table),
};
NEVH__PUBLISH(dopri5);

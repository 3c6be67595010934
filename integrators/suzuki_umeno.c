/* nevh: the composition of Suzuki and Umeno: 15 Verlet steps.

   Found again by McLachlan (1995); not Yoshida's solution D, which begins with
   0.9148 and is less accurate.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

static const long double steps[] = {
    0.7416703643506129534482278017838063156035L,
    -0.4091008258000315939973000958935634173099L,
    0.1907547102962383799538762564503716627355L,
    -0.5738624711160822666563877266355357421595L,
    0.2990641813036559238444635406886029882258L,
    0.3346249182452981837849579798821822886337L,
    0.3152930923967665966320566638110024309941L,
};
static const nevh_splitting table = {NEVH_KICK, NEVH_COMPOSITION, 7, steps};

const nevh_integrator nevh__suzuki_umeno8_entry = {
    .name = "suzuki-umeno8",
    .aliases = "SS15, s15odr8, McAte8, McLachlan1995SS15, "
               "ARKODE_SPRK_SUZUKI_UMENO_8_16",
    .source = "M. Suzuki, K. Umeno, Higher-order decomposition theory of "
              "exponential operators and its applications to QMC and "
              "nonlinear dynamics, Springer Proc. Phys. 76 (1993) 74-86; E. "
              "Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, "
              "eq. (V.3.13); kick first",
    .order = 8,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(15, table),
};
NEVH__PUBLISH(suzuki_umeno8);

/* nevh: Tao's schemes, of order 2 and composed of it.

   Of order 6 the composition of Kahan and Li is taken.  At equal numbers of
   gradients its energy error was 0.6 to 1.2 times that of Yoshida's seven
   (solution A) in 29 of 30 runs, and mostly a hundredth of that of Tao's triple
   jump of a triple jump, of nine steps as well: its own steps are all shorter
   than h, which helps the binding, too.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"
#include "kernels/tao_private.h"

/* Claims hold in the extended phase space. */
#define COMPOSED(steps, method)                                                \
    .stages = (steps), .gradients = 3 * (steps), .symplectic = NEVH_EXTENDED,  \
    .symmetric = NEVH_EXTENDED, .explicit_form = NEVH_YES,                     \
    .preserves_energy = NEVH_NO, .kernel = &nevh__tao_kernel,                  \
    .table = &(method)

static const nevh_splitting once = {NEVH_KICK, NEVH_COMPOSITION, 0, NULL};

const nevh_integrator nevh__tao2_entry = {
    .name = "tao2",
    .aliases = "",
    .source = "M. Tao, Explicit symplectic approximation of nonseparable "
              "Hamiltonians: algorithm and long time performance, Phys. Rev. "
              "E 94 (2016) 043303, sec. I",
    .order = 2,
    COMPOSED(1, once),
};
NEVH__PUBLISH(tao2);

/* 1 / (2 - 2^(1/3)) */
static const long double jump[] = {1.351207191959657634047687808971460826922L};
static const nevh_splitting triple_jump = {NEVH_KICK, NEVH_COMPOSITION, 1,
                                           jump};

const nevh_integrator nevh__tao4_entry = {
    .name = "tao4",
    .aliases = "",
    .source = "M. Tao, Phys. Rev. E 94 (2016) 043303, sec. I: triple jump",
    .order = 4,
    COMPOSED(3, triple_jump),
};
NEVH__PUBLISH(tao4);

static const long double kahan_li[] = {
    0.3921614440073141392792505574226714038049L,
    0.3325991367893594385997486375000496468816L,
    -0.7062461725576393598099648195492564593955L,
    0.08221359629355080023149044810205633110329L,
};
static const nevh_splitting nine = {NEVH_KICK, NEVH_COMPOSITION, 4, kahan_li};

const nevh_integrator nevh__tao6_entry = {
    .name = "tao6",
    .aliases = "",
    .source = "M. Tao, Phys. Rev. E 94 (2016) 043303, composed by W. Kahan, "
              "R.-C. Li, Composition constants for raising the orders of "
              "unconventional schemes for ordinary differential equations, "
              "Math. Comp. 66 (1997) 1089-1099, s9odr6a",
    .order = 6,
    COMPOSED(9, nine),
};
NEVH__PUBLISH(tao6);

/* nevh: steps by parts whose errors are of high order in both small quantities,
   the step and the size of B.

   With e for that size an (r1, r2, ...) method errs by e h^r1 + e^2 h^r2 + ...
   Weights are refined here to all their digits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/form_flow_private.h"
#include "schemes_private.h"

#define ABA(id, stages, given, weights, aliases, source)                       \
    NEVH__BY_PARTS(id, 4, stages, given, weights, aliases, source)
#define BLANES                                                                 \
    "S. Blanes, F. Casas, A. Farres, J. Laskar, J. Makazaga, A. Murua, New "   \
    "families of symplectic splitting methods for numerical integration in "   \
    "dynamical astronomy, Appl. Numer. Math. 68 (2013) 58-72, "

/* (8, 4): e h^8 + e^2 h^4. */
static const long double aba84_weights[] = {
    0.07534696026989288841652780368347446437265L,
    0.1902259393736766192452307627384538974612L,
    0.5179168546882567823007739784963156443238L,
    0.8465240704435262570550805446467758341771L,
};
ABA(aba84, 5, 4, aba84_weights, NULL,
    "R. I. McLachlan, Composition methods in the presence of small "
    "parameters, BIT 35 (1995) 258-268, (8, 4) of 5 stages");

/* (8, 6, 4): e h^8 + e^2 h^6 + e^3 h^4. */
static const long double aba864_weights[] = {
    0.0711334264982231177779387300061549964174L,
    0.1830836874721972219617037571664302910726L,
    0.2411534279566400987364877953262896496178L,
    0.3107828598985748695075222910542627963752L,
    0.5214117617728147892121360780679942299914L,
    -0.02656461851195880069721213791649875926633L,
};
ABA(aba864, 7, 6, aba864_weights, "REB_SABA_8_6_4", BLANES "ABA864");

/* (10, 6, 4): e h^10 + e^2 h^6 + e^3 h^4. */
static const long double aba1064_weights[] = {
    0.0380944974224121954569753223086375653406L,
    0.09585888083707521061077150377145884776934L,
    0.1452987161169137492940200726606637497443L,
    0.204446153142998780680507783916434477976L,
    0.2076276957255412507162056113249882065158L,
    0.217070347978991101714338592430633671453L,
    0.4359097036515261592231548624010651844007L,
};
ABA(aba1064, 8, 7, aba1064_weights, "REB_SABA_10_6_4", BLANES "ABA1064");

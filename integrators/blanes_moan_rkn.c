/* nevh: the Runge-Kutta-Nystroem methods of Blanes and Moan.

   Made for a T quadratic in p, with which [V,[V,[V,T]]] vanishes; two of them
   need it, and with kicks and drifts exchanged they are of order 4 whatever T
   is.  Weights in turn from the first operation; the paper's 15 to 18 digits
   were moved to the nearest point that satisfies the conditions to 40.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

static const long double srkn6b[] = {
    0.08298440641740501883834747894225011249475L,
    0.2452989571842711626039324260014008804072L,
    0.3963098014983680770949115282636867393961L,
    0.6048726657110799749608926976430762452210L,
    -0.03905630492234843517086529076537924228761L,
};
static const nevh_splitting six = {NEVH_KICK, NEVH_PALINDROME, 5, srkn6b};

const nevh_integrator nevh__rkn6b_entry = {
    .name = "rkn6b",
    .aliases = "SRKN6B, RKN4b, BlanesMoan2002SRKN6B",
    .source = "S. Blanes, P. C. Moan, Practical symplectic partitioned "
              "Runge-Kutta and Runge-Kutta-Nystroem methods, J. Comput. Appl. "
              "Math. 142 (2002) 313-330, table 3, SRKN 6 b; kick first",
    .order = 4,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(6, six),
};
NEVH__PUBLISH(rkn6b);

static const long double srkn11b[] = {
    0.04146499851826284329877813391470493672394L,
    0.1232297759462711515610863803333667525905L,
    0.1981286719180665411367264731814969606125L,
    0.2905537977995582703664141693279161833302L,
    -0.04000619210415268688882836353594483937569L,
    -0.1270492126254169156625050538274859344730L,
    0.07525398430158034112787887852704275554175L,
    -0.2463317610620754041949734891040628625960L,
    -0.01151138742068777006244320150128919955259L,
    0.3572088727959277526198603496193104628369L,
};
static const nevh_splitting eleven = {NEVH_KICK, NEVH_PALINDROME, 10, srkn11b};

const nevh_integrator nevh__rkn11b_entry = {
    .name = "rkn11b",
    .aliases = "SRKN11B, BlanesMoan2002SRKN11B",
    .source = "S. Blanes, P. C. Moan, Practical symplectic partitioned "
              "Runge-Kutta and Runge-Kutta-Nystroem methods, J. Comput. Appl. "
              "Math. 142 (2002) 313-330, table 3, SRKN 11 b; kick first",
    .order = 6,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING_FOR(NEVH_SEPARABLE | NEVH_QUADRATIC_KINETIC, 11, eleven),
};
NEVH__PUBLISH(rkn11b);

static const long double srkn14a[] = {
    0.03785931984061094144702117903801110403198L,
    0.09171915262446201798118322826486834024983L,
    0.1026356331024365528470822509403380612759L,
    0.1839831700050048984914765646763433380067L,
    -0.02586788826655833316394696035936533855913L,
    -0.05653436583288910439527704484808994928962L,
    0.3142414030714464341471425357032840110789L,
    0.004914688774711885640205616455015724404119L,
    -0.1301444595174151138496150785400285161721L,
    0.1437611271683616823873745299867722104871L,
    0.1064177003695413680222801392853834569480L,
    0.3285676937468041402004812576270353400948L,
    -0.008794243128510204394069428427659903032337L,
};
static const nevh_splitting fourteen = {NEVH_DRIFT, NEVH_PALINDROME, 13,
                                        srkn14a};

const nevh_integrator nevh__rkn14a_entry = {
    .name = "rkn14a",
    .aliases = "SRKN14A, RKN6a, BlanesMoan2002SRKN14A",
    .source = "S. Blanes, P. C. Moan, Practical symplectic partitioned "
              "Runge-Kutta and Runge-Kutta-Nystroem methods, J. Comput. Appl. "
              "Math. 142 (2002) 313-330, table 3, SRKN 14 a; drift first",
    .order = 6,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING_FOR(NEVH_SEPARABLE | NEVH_QUADRATIC_KINETIC, 14, fourteen),
};
NEVH__PUBLISH(rkn14a);

/* nevh: the partitioned methods of Blanes and Moan.

   Weights in turn, a kick first.  The paper's 15 to 16 digits satisfy the
   conditions to double precision; moved here to the nearest point that
   satisfies them to 40.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

static const long double s6[] = {
    0.07920369643119566943366349588826887330802L,
    0.2095151066133620212740726400295010169021L,
    0.3531729060497739884810613115731210565304L,
    -0.1438517731798180082751150578565277256482L,
    -0.04206508035771953536811029830251703872041L,
};
static const nevh_splitting six = {NEVH_KICK, NEVH_PALINDROME, 5, s6};

const nevh_integrator nevh__blanes_moan4_entry = {
    .name = "blanes-moan4",
    .aliases = "S6, BM4, BlanesMoan2002S6",
    .source = "S. Blanes, P. C. Moan, Practical symplectic partitioned "
              "Runge-Kutta and Runge-Kutta-Nystroem methods, J. Comput. Appl. "
              "Math. 142 (2002) 313-330, table 2, S6; kick first",
    .order = 4,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(6, six),
};
NEVH__PUBLISH(blanes_moan4);

static const long double s10[] = {
    0.05026276440039268602122165440207410940601L,
    0.1488164479010432319209010055355775888774L,
    0.4135143004283438150630637201338844389753L,
    -0.1323858657677836474488454265989399215745L,
    0.04507988979439806296889705212451347116172L,
    0.06730760469218445815025789659260104689936L,
    -0.1880548538195689147991284889188705424878L,
    0.4326664025781735975276679708835452980582L,
    0.5419606784507801348314147409330724963482L,
};
static const nevh_splitting ten = {NEVH_KICK, NEVH_PALINDROME, 9, s10};

const nevh_integrator nevh__blanes_moan6_entry = {
    .name = "blanes-moan6",
    .aliases = "S10, BM6, BlanesMoan2002S10",
    .source = "S. Blanes, P. C. Moan, Practical symplectic partitioned "
              "Runge-Kutta and Runge-Kutta-Nystroem methods, J. Comput. Appl. "
              "Math. 142 (2002) 313-330, table 2, S10; kick first",
    .order = 6,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(10, ten),
};
NEVH__PUBLISH(blanes_moan6);

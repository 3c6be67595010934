/* nevh: compositions of Verlet steps by Kahan and Li.

   Published to 26 digits, refined here.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

static const long double steps9[] = {
    0.3921614440073141392792505574226714038049L,
    0.3325991367893594385997486375000496468816L,
    -0.7062461725576393598099648195492564593955L,
    0.08221359629355080023149044810205633110329L,
};
static const nevh_splitting nine = {NEVH_KICK, NEVH_COMPOSITION, 4, steps9};

const nevh_integrator nevh__kahan_li6_entry = {
    .name = "kahan-li6",
    .aliases = "KahanLi6, s9odr6a",
    .source = "W. Kahan, R.-C. Li, Composition constants for raising the "
              "orders of unconventional schemes for ordinary differential "
              "equations, Math. Comp. 66 (1997) 1089-1099, s9odr6a; kick first",
    .order = 6,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(9, nine),
};
NEVH__PUBLISH(kahan_li6);

static const long double steps17[] = {
    0.1302024830888900808788176320967005223572L,
    0.5611629817751083845619644077001505672662L,
    -0.3894749626448472864080785982352483888361L,
    0.1588419065551556008962107457071524814121L,
    -0.3959038941332375773362315393479389360268L,
    0.1845396409783157070918325415333754628190L,
    0.2583743876863220472939791099949394718131L,
    0.2950117236093102988709662402182281129765L,
};
static const nevh_splitting seventeen = {NEVH_KICK, NEVH_COMPOSITION, 8,
                                         steps17};

const nevh_integrator nevh__kahan_li8_entry = {
    .name = "kahan-li8",
    .aliases = "KahanLi8, s17odr8a",
    .source = "W. Kahan, R.-C. Li, Composition constants for raising the "
              "orders of unconventional schemes for ordinary differential "
              "equations, Math. Comp. 66 (1997) 1089-1099, s17odr8a; kick "
              "first",
    .order = 8,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(17, seventeen),
};
NEVH__PUBLISH(kahan_li8);

/* nevh: two symmetric methods of McLachlan, made for a T quadratic in p.

   They satisfy the conditions of order 4 whatever T is; a quadratic T has
   smaller errors.  The first one's weights are exact.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

/* 1/2 - z (drift), 1 (kick), z - 1/3, where z = sqrt(7/8)/3; the kick -1/2 and the
   drift 2/3 follow. */
static const long double sb3a4[] = {
    0.1881952177688382178680209389736208915203L,
    1,
    -0.02152855110217155120135427230695422485367L,
};
static const nevh_splitting four = {NEVH_DRIFT, NEVH_PALINDROME, 3, sb3a4};

const nevh_integrator nevh__mclachlan_sb3a4_entry = {
    .name = "mclachlan-sb3a4",
    .aliases = "McLachlan1995SB3A4, symplectic_rkn_sb3a_m4_mclachlan",
    .source = "R. I. McLachlan, On the numerical integration of ordinary "
              "differential equations by symmetric composition methods, SIAM "
              "J. Sci. Comput. 16 (1995) 151-168, SB3A, m = 4; drift first",
    .order = 4,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(4, four),
};
NEVH__PUBLISH(mclachlan_sb3a4);

/* The kicks are -3/73, 17/59 and what follows; in the paper the drifts are
   0.40518861839525227722 and -0.28714404081652408900, refined here. */
static const long double sb3a5[] = {
    0.4051886183952522772205531983898517327134L,
    -3.0L / 73,
    -0.2871440408165240889966277933622274550686L,
    17.0L / 59,
};
static const nevh_splitting five = {NEVH_DRIFT, NEVH_PALINDROME, 4, sb3a5};

const nevh_integrator nevh__mclachlan_sb3a5_entry = {
    .name = "mclachlan-sb3a5",
    .aliases = "McLachlan1995SB3A5, symplectic_rkn_sb3a_mclachlan",
    .source = "R. I. McLachlan, On the numerical integration of ordinary "
              "differential equations by symmetric composition methods, SIAM "
              "J. Sci. Comput. 16 (1995) 151-168, SB3A, m = 5; drift first",
    .order = 4,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(5, five),
};
NEVH__PUBLISH(mclachlan_sb3a5);

/* nevh: the composition of Sofroniou and Spaletta: 35 Verlet steps.

   Published to 32 digits, refined here.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

static const long double steps[] = {
    0.07879572252168641926390767933768424825937L,
    0.3130961034151085277648124719264726964955L,
    0.02791838323507806610952027327529882253858L,
    -0.2295928415939070941512133967965498761942L,
    0.1309620610771648631746568592796054134538L,
    -0.2697334056545107143446097322241114966917L,
    0.07497334315589143566613710564141041220016L,
    0.1119934239998102048895750807364020587704L,
    0.3661334495462267511931481235314990827254L,
    -0.3991056301360358978786298105834047304336L,
    0.1030873985274710773158027700137244779884L,
    0.4114308739558902378207041189760783505939L,
    -0.004866360583135261762195659309977062881840L,
    -0.3920333537086399064480819364261042699342L,
    0.05194250296244964703718290401597576432958L,
    0.05066509075992449633587434415686588054380L,
    0.04967437063972987905456880027946096861440L,
};
static const nevh_splitting table = {NEVH_KICK, NEVH_COMPOSITION, 17, steps};

const nevh_integrator nevh__sofroniou_spaletta10_entry = {
    .name = "sofroniou-spaletta10",
    .aliases = "SofSpa10, ARKODE_SPRK_SOFRONIOU_10_36, SPLIT_10TH_SS_M35",
    .source = "M. Sofroniou, G. Spaletta, Derivation of symmetric composition "
              "constants for symmetric integrators, Optim. Methods Softw. 20 "
              "(2005) 597-613; E. Hairer, C. Lubich, G. Wanner, Geometric "
              "Numerical Integration, eq. (V.3.15); kick first",
    .order = 10,
    .stages = 35,
    .gradients = 35,
    .symplectic = NEVH_YES,
    .symmetric = NEVH_YES,
    .explicit_form = NEVH_YES,
    .preserves_energy = NEVH_NO,
    .needs = NEVH_SEPARABLE,
    .kernel = &nevh_splitting_kernel,
    .table = &table,
};
NEVH__PUBLISH(sofroniou_spaletta10);

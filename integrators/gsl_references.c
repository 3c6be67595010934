/* nevh: reference steppers that come with GSL.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/gsl_private.h"
#include "schemes_private.h"

#define BY_GSL(method)                                                         \
    .adaptive = true, .symplectic = NEVH_NO, .symmetric = NEVH_NO,             \
    .explicit_form = NEVH_YES, .preserves_energy = NEVH_NO,                    \
    .kernel = &nevh__gsl_kernel, .table = &(method)

const nevh_integrator nevh__gsl_rkf45_entry = {
    .name = "gsl-rkf45",
    .aliases = "gsl_odeiv2_step_rkf45, fehlberg45",
    .source = "E. Fehlberg, NASA TR R-315 (1969), table III; as in GSL, which "
              "goes on with the solution of order 5",
    .order = 5,
    .stages = 6,
    .gradients = 6,
    BY_GSL(gsl_odeiv2_step_rkf45),
};
NEVH__PUBLISH(gsl_rkf45);

const nevh_integrator nevh__gsl_rk8pd_entry = {
    .name = "gsl-rk8pd",
    .aliases = "gsl_odeiv2_step_rk8pd, prince-dormand8",
    .source = "P. J. Prince, J. R. Dormand, High order embedded Runge-Kutta "
              "formulae, J. Comput. Appl. Math. 7 (1981) 67-75; as in GSL",
    .order = 8,
    .stages = 13,
    .gradients = 13,
    BY_GSL(gsl_odeiv2_step_rk8pd),
};
NEVH__PUBLISH(gsl_rk8pd);

const nevh_integrator nevh__gsl_msadams_entry = {
    .name = "gsl-msadams",
    .aliases = "gsl_odeiv2_step_msadams, adams",
    .source = "G. D. Byrne, A. C. Hindmarsh, A polyalgorithm for the numerical "
              "solution of ordinary differential equations, ACM Trans. Math. "
              "Software 1 (1975) 71-96; as in GSL, orders 1 to 12, P(EC)^m",
    .order = 12,
    .stages = 1,
    .needs_tolerance = true,
    BY_GSL(gsl_odeiv2_step_msadams),
};
NEVH__PUBLISH(gsl_msadams);

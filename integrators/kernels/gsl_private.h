/* nevh: GSL's steppers as schemes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_GSL_PRIVATE_H
#define NEVH_GSL_PRIVATE_H

#include <gsl/gsl_odeiv2.h>
#include <nevh/extend.h>

/* The table is a pointer to GSL's own pointer, which is known at run time
   only: const gsl_odeiv2_step_type **. */
extern const nevh_kernel nevh__gsl_kernel;

#endif

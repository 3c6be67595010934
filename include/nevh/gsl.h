/* nevh: GSL sees nevh's gradients.  The only header that shows GSL types.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_GSL_H
#define NEVH_GSL_H

#include <gsl/gsl_odeiv2.h>
#include <nevh/gradient.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Hamilton's equations of a field as a right-hand side for GSL's solvers: the
   state is y = (q, p), 2n long; dy/dt = (dH/dp, -dH/dq).  This is what the
   paper's HGrad class does for SciPy.  The Jacobian is made by central
   differences of the gradient, for the solvers that want one.

   field    borrowed; must outlive the result.  A failure of H is handed to
            GSL as GSL_EBADFUNC; nevh_field_message tells what it was.
   cost     one gradient a right-hand side; 4n gradients a Jacobian */
NEVH_API gsl_odeiv2_system nevh_gsl_system(nevh_field *field);

#ifdef __cplusplus
}
#endif
#endif

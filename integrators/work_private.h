/* nevh: what kernels share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_WORK_PRIVATE_H
#define NEVH_WORK_PRIVATE_H

#include <nevh/extend.h>

/* NEVH_EDOM: the new state is not finite. */
int nevh__fail_range(nevh_work *, double t, double h);

/* As nevh__field_noise, of H or of K where time is transformed; a failure is
   recorded. */
int nevh__work_noise(nevh_work *, double t, const double q[], const double p[],
                     double noise_q[], double noise_p[]);

#endif

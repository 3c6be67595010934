/* nevh: what kernels share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_WORK_PRIVATE_H
#define NEVH_WORK_PRIVATE_H

#include <nevh/extend.h>

/* NEVH_EDOM: the new state is not finite. */
int nevh__fail_range(nevh_work *, double t, double h);

#endif

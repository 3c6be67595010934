/* nevh: steps along Taylor series.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TAYLOR_PRIVATE_H
#define NEVH_TAYLOR_PRIVATE_H

#include <nevh/extend.h>

extern const nevh_kernel nevh__taylor_kernel;

#endif

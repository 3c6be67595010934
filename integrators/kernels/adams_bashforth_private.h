/* nevh: the kernel of adams-bashforth2.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ADAMS_BASHFORTH_PRIVATE_H
#define NEVH_ADAMS_BASHFORTH_PRIVATE_H

#include <nevh/extend.h>

extern const nevh_kernel nevh__adams_bashforth_kernel;

#endif

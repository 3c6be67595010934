/* nevh: whether invariants are conserved.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_CONSERVED_H
#define NEVH_CONSERVED_H

#include "plan.h"

/* Names the scene's [invariants] that are not conserved on the orbit of a high
   order at two tolerances, over at most 2000 dt. */
void conserved_words(const plan *, list *notes);
/* Likewise, but without a word where that is not known. */
void conserved_warn(const plan *, list *notes);

#endif

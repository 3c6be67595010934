/* nevh check: the parts that schemes by parts find.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PARTS_WORDS_H
#define NEVH_PARTS_WORDS_H

#include "experiment/plan.h"

/* Nothing where no scheme by parts fits. */
void parts_words(const plan *, list *notes);

#endif

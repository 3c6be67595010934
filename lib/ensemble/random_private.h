/* nevh: a counter-based generator.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RANDOM_PRIVATE_H
#define NEVH_RANDOM_PRIVATE_H

#include <stdint.h>

/* Philox4x32-10 of a counter and a key. */
void nevh__philox(const uint32_t counter[4], const uint32_t key[2],
                  uint32_t out[4]);

#endif

/* nevh: the operations of a splitting.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SPLITTING_PRIVATE_H
#define NEVH_SPLITTING_PRIVATE_H

#include <nevh/extend.h>

/* Kicks and drifts of a step. */
size_t nevh__splitting_operations(const nevh_splitting *);
/* The same in long double. */
void nevh__splitting_expand_wide(const nevh_splitting *, long double weights[]);
/* Their weights in turn, that many; a palindrome is one to the last bit. */
void nevh__splitting_expand(const nevh_splitting *, double weights[]);

#endif

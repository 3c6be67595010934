/* nevh: the function of a library of compiled steps, of families that take up to
   `steps` steps on their own: they have a function advance.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ENTRY_H
#define NEVH_ENTRY_H

size_t nevh_native_steps(const nevh__steps_call *c) {
    return advance(c->numbers, c->t0, c->h, c->from, c->steps, c->q, c->p,
                   c->memory, c->counted);
}

#endif

/* nevh: the function of a library of compiled steps, of families that take up to
   `steps` steps on their own: they have a function advance.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ENTRY_H
#define NEVH_ENTRY_H

size_t nevh_native_steps(const double *restrict N, double *restrict W,
                         double *restrict T, size_t operations, double t0,
                         double h, size_t from, size_t steps,
                         double *restrict Q, double *restrict P,
                         double *restrict M, size_t *counted, double *room) {
    (void)W, (void)T, (void)operations, (void)room;
    return advance(N, t0, h, from, steps, Q, P, M, counted);
}

#endif

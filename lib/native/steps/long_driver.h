/* nevh: the same as block_driver.h of one orbit, whose numbers are too many for the
   stack: they stand in the room that a library is handed, behind ROWS_BEFORE rows
   of a step.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_LONG_DRIVER_H
#define NEVH_LONG_DRIVER_H

#ifndef NEVH__TAKES_STEPS
NEVH__INLINE bool take_steps(const double *N, double *W, double *T,
                             size_t operations, double t0, double h,
                             size_t from, size_t steps, wide *y, wide *lost,
                             wide *kept, wide *room, size_t *done) {
    (void)steps;
    double t = t0 + (double)from * h;
    bool fine =
        !is_bad(take_step(N, W, T, operations, t, h, y, lost, kept, room));
    *done += fine;
    return fine;
}
#endif

NEVH__INLINE void load_all(double *to, const double *from) {
    __builtin_memcpy(to, from, COUNT * sizeof *to);
    for (size_t k = COUNT; k < 8 * DOF; k++)
        to[k] = 0;
}

NEVH__INLINE void store_all(double *to, const double *from) {
    __builtin_memcpy(to, from, COUNT * sizeof *to);
}

size_t nevh_native_steps(const double *restrict N, double *restrict W,
                         double *restrict T, size_t operations, double t0,
                         double h, size_t from, size_t steps,
                         double *restrict Q, double *restrict P,
                         double *restrict M, size_t *counted,
                         double *restrict numbers) {
    nevh__number *restrict room = (nevh__number *)numbers;
    nevh__number *y = room + ROWS_BEFORE * (size_t)DOF;
    nevh__number *lost = room + (ROWS_BEFORE + 2) * (size_t)DOF;
    nevh__number *kept = room + (ROWS_BEFORE + 4) * (size_t)DOF;
    (void)counted;
    double *flags = M + (2 + (KEPT > 0)) * COUNT;
    size_t done = 0;
    load_all((double *)y, Q);
    load_all((double *)(y + DOF), P);
    load_all((double *)lost, M);
    load_all((double *)(lost + DOF), M + COUNT);
    if (KEPT > 0 && *flags != 0)
        load_all((double *)kept, M + 2 * COUNT);
    else if (is_bad(take_first(N, T, t0 + (double)from * h, h, y, lost, kept,
                               room)))
        return 0;
    while (done < steps)
        if (!take_steps(N, W, T, operations, t0, h, from + done, steps - done,
                        y, lost, kept, room, &done))
            return done;
    store_all(Q, (double *)y);
    store_all(P, (double *)(y + DOF));
    store_all(M, (double *)lost);
    store_all(M + COUNT, (double *)(lost + DOF));
    if (KEPT) {
        store_all(M + 2 * COUNT, (double *)kept);
        *flags = 1;
    }
    return done;
}

#endif

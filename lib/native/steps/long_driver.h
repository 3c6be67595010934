/* nevh: the same as block_driver.h of one orbit, whose numbers are too many for the
   stack: they stand in the room that a library is handed, behind ROWS_BEFORE rows
   of a step.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_LONG_DRIVER_H
#define NEVH_LONG_DRIVER_H

#ifndef NEVH__TAKES_STEPS
NEVH__INLINE bool take_steps(const nevh__steps_call *c, wide *y, wide *lost,
                             wide *kept, wide *room, size_t *done) {
    double t = c->t0 + (double)(c->from + *done) * c->h;
    bool fine = !is_bad(take_step(c, c->numbers, t, y, lost, kept, room));
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

size_t nevh_native_steps(const nevh__steps_call *call) {
    const nevh__steps_call c = *call;
    nevh__number *restrict room = (nevh__number *)c.room;
    nevh__number *y = room + ROWS_BEFORE * (size_t)DOF;
    nevh__number *lost = room + (ROWS_BEFORE + 2) * (size_t)DOF;
    nevh__number *kept = room + (ROWS_BEFORE + 4) * (size_t)DOF;
    double *M = c.memory, *flags = M + (2 + KEPT / DOF) * COUNT;
    size_t done = 0;
    load_all((double *)y, c.q);
    load_all((double *)(y + DOF), c.p);
    load_all((double *)lost, M);
    load_all((double *)(lost + DOF), M + COUNT);
    for (int i = 0; i < KEPT / DOF && *flags != 0; i++)
        load_all((double *)(kept + i * DOF), M + (2 + i) * COUNT);
    if (KEPT > 0 && *flags == 0 &&
        is_bad(take_first(&c, c.numbers, y, lost, kept, room)))
        return 0;
    while (done < c.steps)
        if (!take_steps(&c, y, lost, kept, room, &done))
            return done;
    store_all(c.q, (double *)y);
    store_all(c.p, (double *)(y + DOF));
    store_all(M, (double *)lost);
    store_all(M + COUNT, (double *)(lost + DOF));
    for (int i = 0; i < KEPT / DOF; i++)
        store_all(M + (2 + i) * COUNT, (double *)(kept + i * DOF));
    if (KEPT)
        *flags = 1;
    return done;
}

#endif

/* nevh: steps of families that take one at a time of copies of the state, which are
   stored if all of them went well.

   The text needs take_step, which returns 0 if all is well, and, where slopes are kept
   (KEPT numbers), take_first.  lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_BLOCK_DRIVER_H
#define NEVH_BLOCK_DRIVER_H

#ifdef NEVH__FOR_READERS
/* Takes up to `steps` steps of h, the first being number `from`, and returns how
   many of them it could take. */
static size_t advance(double t0, double h, size_t from, size_t steps, double *q,
                      double *p, double *memory) {
#ifdef NEVH__LOOPS
    static double y[2 * DOF], lost[2 * DOF];
#else
    double y[2 * DOF], lost[2 * DOF];
#endif
    size_t done = 0;
    memcpy(lost, memory, sizeof lost);
    for (; done < steps; done++) {
        memcpy(y, q, DOF * sizeof *q);
        memcpy(y + DOF, p, DOF * sizeof *p);
        double t = t0 + (double)(from + done) * h;
#ifdef NEVH__KEEPS
        if (take_step(t, h, y, lost, memory + 2 * DOF) != 0)
            break;
#else
        if (take_step(t, h, y, lost) != 0)
            break;
#endif
        memcpy(q, y, DOF * sizeof *q);
        memcpy(p, y + DOF, DOF * sizeof *p);
        memcpy(memory, lost, sizeof lost);
    }
    return done;
}
#else
/* copy(mine, theirs) for each number of the blocks and of what is handed over. */
#define NEVH__EACH_NUMBER(copy)                                                \
    for (int b = 0; b < BLOCKS; b++) {                                         \
        NEVH_UNROLL for (size_t k = 0; k < DOF; k++) {                         \
            copy(y[b][k], AT(Q, k, b));                                        \
            copy(y[b][DOF + k], AT(P, k, b));                                  \
        }                                                                      \
        NEVH_UNROLL for (size_t k = 0; k < 2 * DOF; k++) {                     \
            copy(lost[b][k], AT(M, k, b));                                     \
        }                                                                      \
        NEVH_UNROLL for (size_t k = 0; k < KEPT; k++) {                        \
            copy(kept[b][k], AT(M, 2 * DOF + k, b));                           \
        }                                                                      \
    }
#define NEVH__LOAD(mine, theirs)  mine = theirs
#define NEVH__STORE(mine, theirs) theirs = mine

size_t nevh_native_steps(const nevh__steps_call *call) {
    const nevh__steps_call c = *call;
    const double *restrict N = c.numbers;
    double *restrict Q = c.q, *restrict P = c.p, *restrict M = c.memory;
    nevh__number y[BLOCKS][2 * DOF], lost[BLOCKS][2 * DOF];
    nevh__number kept[BLOCKS][KEPT + 1];
    double *flags = M + (2 * DOF + KEPT) / GROUP * WIDTH;
    bool has_kept = true;
    size_t done = 0;
    NEVH__EACH_NUMBER(NEVH__LOAD)
    for (int i = 0; KEPT > 0 && i < WIDTH; i++)
        has_kept &= flags[i] != 0;
    for (int b = 0; KEPT > 0 && !has_kept && b < BLOCKS; b++)
        if (is_bad(take_first(&c, TABLE(b), y[b], lost[b], kept[b], NULL)))
            return 0;
    for (; done < c.steps; done++) {
        double t = c.t0 + (double)(c.from + done) * c.h;
        nevh__number bad = {0};
        for (int b = 0; b < BLOCKS; b++)
            bad += take_step(&c, TABLE(b), t, y[b], lost[b], kept[b], NULL);
        if (is_bad(bad))
            return done;
#ifdef NEVH__WATCHES
        for (int i = 0; c.room && i < BLOCKS * GROUP; i++)
            watch(N, &y[i / GROUP][i % GROUP * ONE],
                  c.room + done * WATCHED * WIDTH + i * LANES);
#endif
    }
    NEVH__EACH_NUMBER(NEVH__STORE)
    for (int i = 0; KEPT > 0 && i < WIDTH; i++)
        flags[i] = 1;
    return done;
}
#endif

#endif

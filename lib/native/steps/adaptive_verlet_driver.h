/* nevh: steps of Verlet that vary, of one orbit.

   A compiled step that is the first of an orbit, or that fails, is the kernel's.
   The text needs what adaptive_verlet_step.h does, a scene's kick_slope and
   drift_slope, units of |f| (UNIT_Q, UNIT_P) and the least rate (LEAST_RATE);
   NEVH__REVERSIBLE: steps are those of the density.  lib/native hands it to the C
   compiler, and after fraction_private.h writes it into programs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ADAPTIVE_VERLET_DRIVER_H
#define NEVH_ADAPTIVE_VERLET_DRIVER_H

#include "kernels/adaptive_verlet_step.h"

struct nevh__leap_owner {
    double *bad;
    NEVH__COMPILED(const double *N;)
};

NEVH__INLINE int nevh__leap_slopes(const nevh__leap *x, double t, double *force,
                                   double *speed) {
    const struct nevh__leap_owner *o = x->owner;
    if (force)
        *o->bad += kick_slope(NEVH__COMPILED(o->N, ) t, x->q, x->p, force);
    if (speed)
        *o->bad += drift_slope(NEVH__COMPILED(o->N, ) t, x->q, x->p, speed);
    return 0;
}

NEVH__INLINE int nevh__leap_pair(const nevh__leap *x, double t) {
    const struct nevh__leap_owner *o = x->owner;
    for (int which = 0; which < 2; which++) {
        double z[2 * DOF], slope[2 * DOF];
        NEVH__EACH(k, 1, 2 * DOF) {
            z[k] = x->pair[2 * k + which];
        }
        *o->bad += kick_slope(NEVH__COMPILED(o->N, ) t, z, z + DOF, slope);
        *o->bad +=
            drift_slope(NEVH__COMPILED(o->N, ) t, z, z + DOF, slope + DOF);
        NEVH__EACH(k, 1, 2 * DOF) {
            x->pair_slopes[2 * k + which] = slope[k];
        }
    }
    return 0;
}

#ifndef NEVH__FOR_READERS
NEVH__INLINE int nevh__leap_account(const nevh__leap *x, bool of_q, double t,
                                    double length) {
    (void)x, (void)of_q, (void)t, (void)length;
    return 0;
}
#endif

/* The memory behind digits that sums have lost: dV/dq where the step begins, and
   the density's. */
enum { FORCE_AT = 2 * DOF, BEGUN_AT = 3 * DOF, UNIT_AT, DENSITY_AT, CHANGE_AT };

/* The new state, with digits that sums lose, and the force there; false: it is not
   finite, and nothing has changed. */
NEVH__INLINE bool add_changes(const nevh__leap *x, double *Q, double *P,
                              double *M) {
    double bad = 0;
    NEVH__EACH(k, 1, DOF) {
        x->q[k] = Q[k] + (x->dq[k] + M[k]);
        x->p[k] = P[k] + (x->dp[k] + M[DOF + k]);
        bad += (x->q[k] - x->q[k]) + (x->p[k] - x->p[k]);
    }
    if (bad != 0)
        return false;
    NEVH__EACH(k, 1, DOF) {
        M[k] = nevh__roundoff(x->q[k], Q[k], x->dq[k] + M[k]);
        M[DOF + k] = nevh__roundoff(x->p[k], P[k], x->dp[k] + M[DOF + k]);
        Q[k] = x->q[k];
        P[k] = x->p[k];
        M[FORCE_AT + k] = x->force[k];
    }
    return true;
}

/* A step of h times what the density says.  Returns whether it could be
   taken, and sets the time that it takes. */
NEVH__INLINE bool take_step(NEVH__COMPILED(const double *N, ) double t,
                            double h, double *Q, double *P, double *M,
                            double *length) {
    double q[DOF], p[DOF], force[DOF], speed[DOF], dq[DOF], dp[DOF];
    double pair[4 * DOF], pair_slopes[4 * DOF], bad = 0, s;
    nevh__density c = {1, M[UNIT_AT], M[DENSITY_AT], M[CHANGE_AT]};
    struct nevh__leap_owner owner = {&bad NEVH__COMPILED(, N)};
    nevh__leap x = {DOF,   UNIT_Q, UNIT_P, M,    q,           p,     force,
                    speed, dq,     dp,     pair, pair_slopes, &owner};
    NEVH__COMPILED(if (M[BEGUN_AT] == 0) return false;)
    nevh__leap_place(&x, Q, P, M + FORCE_AT);
    nevh__leap_slopes(&x, t, M[BEGUN_AT] == 0 ? force : NULL, speed);
#ifdef NEVH__FOR_READERS
    if (M[BEGUN_AT] == 0) { /* the orbit begins */
        M[BEGUN_AT] = c.density = 1;
        M[UNIT_AT] = c.unit = nevh__leap_size(&x);
#ifdef NEVH__REVERSIBLE
        nevh__leap_change(&x, t, c.unit, &c.change);
#endif
    }
#endif
#ifdef NEVH__REVERSIBLE
    s = nevh__leap_rate(&c, h);
#else
    s = nevh__leap_stretch(&x, c.unit);
#endif
    *length = h * s;
    if (!(s > LEAST_RATE) || *length - *length != 0)
        return false;
    nevh__leap_take(&x, t, *length, Q, P);
#ifdef NEVH__REVERSIBLE
    /* The kernel counts no slopes of a change of 0 where nothing moves. */
    NEVH__COMPILED(if (!(nevh__leap_size(&x) > 0)) return false;)
    nevh__leap_change(&x, t + *length, c.unit, &c.change);
    c.density += h / 2 * c.change;
#endif
    if (bad != 0 || !add_changes(&x, Q, P, M))
        return false;
    M[DENSITY_AT] = c.density;
    M[CHANGE_AT] = c.change;
    return true;
}

#ifdef NEVH__FOR_READERS
/* The state where a step of h from the time t begins, and where a part of it
   ends. */
typedef struct {
    double q[DOF], p[DOF], memory[3 * DOF + 4];
} orbit;
struct nevh__fraction_owner {
    orbit begin, end;
    double t, h;
    double whole, due; /* times: of the step, and of the part */
};

static bool take_part(struct nevh__fraction_owner *o, double part,
                      double *length) {
    o->end = o->begin;
    return take_step(o->t, part * o->h, o->end.q, o->end.p, o->end.memory,
                     length);
}

NEVH__INLINE double nevh__fraction_miss(struct nevh__fraction_owner *o,
                                        double fraction) {
    double length;
    return take_part(o, fraction, &length)
               ? length / o->whole - o->due / o->whole
               : NAN;
}

/* The part that ends on time. */
static bool end_on_time(struct nevh__fraction_owner *o) {
    double length, fraction = nevh__fraction_find(o, o->due / o->whole);
    return fraction == fraction && take_part(o, fraction, &length) &&
           fabs(length - o->due) <= 1e-9 * fabs(o->due);
}

/* Takes up to `steps` steps of h, and returns how many of them it could
   take.  Each takes a time of its own, which is added to *t, and the last one
   ends at t_end.  Time is a sum with compensation, whose last digits stand in the
   memory. */
static size_t advance(double *t, double t_end, double h, size_t steps,
                      double *q, double *p, double *memory) {
    double *lost = memory + 3 * DOF + 4; /* of t, by rounding */
    size_t done = 0;
    for (; done < steps && *t != t_end; done++) {
        struct nevh__fraction_owner o = {.t = *t, .h = h};
        memcpy(o.begin.q, q, sizeof o.begin.q);
        memcpy(o.begin.p, p, sizeof o.begin.p);
        memcpy(o.begin.memory, memory, sizeof o.begin.memory);
        if (!take_part(&o, 1, &o.whole) || !(o.whole / h > 0))
            break;
        double passed = o.whole + *lost, next = *t + passed;
        *lost = nevh__roundoff(next, *t, passed);
        if ((next - t_end) / h > 0) {
            o.due = t_end - *t;
            next = t_end;
            if (o.due / o.whole < 1 && !end_on_time(&o))
                break;
        }
        memcpy(q, o.end.q, sizeof o.end.q);
        memcpy(p, o.end.p, sizeof o.end.p);
        memcpy(memory, o.end.memory, sizeof o.end.memory);
        *t = next;
    }
    return done;
}
#else
/* Takes one step, whose length goes to T. */
size_t nevh_native_steps(const nevh__steps_call *c) {
    return c->steps == 1 &&
           take_step(c->numbers, c->t0 + (double)c->from * c->h, c->h, c->q,
                     c->p, c->memory, c->times);
}
#endif

#endif

/* nevh: the motions that are known, as references.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/exact_private.h"
#include "system/motion_private.h"
#include <math.h>
#include <stdlib.h>

void nevh__exact_free(nevh__exact_solution *e) {
    if (e && e->solver)
        gsl_root_fsolver_free(e->solver);
    free(e);
}

const char *nevh__exact_name(const nevh__exact_solution *e) {
    static const char *const names[] = {[NEVH__PENDULUM] = "Jacobi sn",
                                        [NEVH__OSCILLATOR] = "cosine",
                                        [NEVH__KEPLER] = "Kepler's equation"};
    _Static_assert(sizeof names / sizeof *names == NEVH__EXACT_KINDS,
                   "each solution");
    return names[e->kind];
}

static void carry(const nevh__exact_solution *e, long double t, long double q[],
                  long double p[]) {
    if (e->kind == NEVH__PENDULUM) {
        q[0] -= e->c;
        nevh__swing(t, 1 / e->a, e->b, q, p);
        q[0] += e->c;
        return;
    }
    for (size_t i = 0; i < e->n; i++)
        p[i] *= e->a; /* velocities */
    if (e->kind == NEVH__OSCILLATOR) {
        q[0] -= e->c;
        nevh__normal_mode(e->a * e->b, t, q, p);
        q[0] += e->c;
    } else {
        nevh__ellipse(e->solver, e->a * e->b, t, e->n, q, p);
    }
    for (size_t i = 0; i < e->n; i++)
        p[i] /= e->a;
}

int nevh__exact_state(const nevh__exact_solution *e, long double t,
                      const double q0[], const double p0[], double q[],
                      double p[]) {
    long double to_q[NEVH__EXACT_DOF], to_p[NEVH__EXACT_DOF];
    bool finite = isfinite(t);
    for (size_t i = 0; i < e->n; i++) {
        to_q[i] = q0[i];
        to_p[i] = p0[i];
    }
    if (finite && t != 0)
        carry(e, t, to_q, to_p);
    for (size_t i = 0; i < e->n; i++) {
        q[i] = (double)to_q[i];
        p[i] = (double)to_p[i];
        finite = finite && isfinite(q[i]) && isfinite(p[i]);
    }
    return finite ? NEVH_OK : NEVH_EDOM;
}

/* Equal parts of the eccentric anomaly. */
static double ellipse_time(const nevh__exact_solution *e, double span, double u,
                           const double q0[], const double p0[]) {
    long double r2 = 0, v2 = 0, rv = 0, mu = e->a * e->b;
    for (size_t i = 0; i < e->n; i++) {
        r2 += (long double)q0[i] * q0[i];
        v2 += e->a * p0[i] * (e->a * p0[i]);
        rv += e->a * p0[i] * q0[i];
    }
    long double r0 = sqrtl(r2), a = 1 / (2 / r0 - v2 / mu);
    long double rate = sqrtl(mu / a) / a, E = u * span * rate;
    long double ec = 1 - r0 / a, es = rv / sqrtl(mu * a);
    long double t = (E - ec * sinl(E) + es * (1 - cosl(E))) / rate;
    return (double)(span > 0 ? fminl(fmaxl(t, 0), span)
                             : fmaxl(fminl(t, 0), span));
}

double nevh__exact_time(const nevh__exact_solution *e, double span, double u,
                        const double q0[], const double p0[]) {
    return e->kind == NEVH__KEPLER ? ellipse_time(e, span, u, q0, p0)
                                   : u * span;
}

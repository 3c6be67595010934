/* nevh: the pendulum, H = p^2/(2 m l^2) - m g l cos q, q from straight down.
   SPDX-License-Identifier: GPL-3.0-or-later

   The exact motion.  With tau = sqrt(g/l) t, S = sin(q/2), C = cos(q/2) and
   Y = p/(2 m l^2 sqrt(g/l)), Hamilton's equations are
       S' = C Y,  C' = -S Y,  Y' = -S C,
   which k sn, dn, k cn of tau solve.  Here k^2 = S^2 + Y^2 is below 1 where the
   pendulum swings and above where it turns over.  The addition theorem of these
   functions takes any state on by tau, with no elliptic integral to find its
   phase; it is written with C^2 + S^2 c^2 for 1 - k^2 sn^2 sn^2, and then no
   cancellation in it is worse than rounding.

   GSL's gsl_sf_elljac_e is not used: it is handed k^2, whose rounding near the
   separatrix costs 1e-6 of phase and more.  The functions below take the
   complement k'^2 = 1 - k^2 and work in long double. */
#include "models_private.h"
#include <float.h>
#include <math.h>

#define PI 3.141592653589793238462643383279502884L

NEVH_BODY(cosine, void, { return -nevh_c(0) * nevh_cos(nevh_q(0)); })

NEVH_SIMD
static void cosine_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dh_dq[],
                            double dh_dp[]) {
    (void)t, (void)p, (void)params, (void)dh_dp;
    if (!dh_dq)
        return;
    NEVH_LANES(i, width) {
        dh_dq[i] = c[i] * nevh_simd_sin(q[i]);
    }
}

const nevh_term nevh__cosine_term = {.effect = "gravity",
                                     .nq = 1,
                                     .nc = 1,
                                     NEVH_FORMS(cosine),
                                     .gradient = cosine_gradient};

static nevh_system *pendulum_system(const void *params) {
    const nevh_pendulum *a = params;
    nevh_term terms[] = {nevh__kinetic_term, nevh__cosine_term};
    terms[0].c = (const double[]){a->m * (a->l * a->l)};
    terms[1].c = (const double[]){a->m * a->g * a->l};
    return nevh__model_system(1, terms, 2);
}

static double pendulum_hamiltonian(double t, const double q[], const double p[],
                                   const void *params) {
    const nevh_pendulum *a = params;
    (void)t;
    return p[0] * p[0] / (2 * a->m * (a->l * a->l)) -
           a->m * a->g * a->l * cos(q[0]);
}

/* Jacobi's functions for some modulus. */
typedef struct {
    long double sn, cn, dn;
    long double turns; /* of 2 K each, left out of the argument */
} elliptic;

/* The arithmetic-geometric mean of 1 and k'. */
typedef struct {
    int count;
    long double a[32], g[32], mean;
} means;

static means means_of(long double kc) {
    means m = {.count = 0};
    long double a = 1, g = kc;
    while (m.count < 31 && a - g > 4 * LDBL_EPSILON * a) {
        m.a[m.count] = a;
        m.g[m.count++] = g;
        a = (a + g) / 2;
        g = sqrtl(m.a[m.count - 1] * g);
    }
    m.mean = (a + g) / 2;
    return m;
}

/* 0 <= u <= K/2.  Bulirsch, Numer. Math. 7 (1965) 78, sncndn: Gauss'
   transformation of cn/sn, all of it in sums of positive numbers. */
static elliptic elliptic_basic(const means *m, long double u) {
    if (u < 1e-30L)
        return (elliptic){u, 1, 1, 0};
    long double cot = 1 / tanl(m->mean * u);
    long double cs = m->mean * cot, dn = 1, next = cot * cs;
    for (int i = m->count; i-- > 0;) {
        cs *= dn;
        dn = (m->g[i] + next) / (m->a[i] + next);
        next = cs * cs / m->a[i];
    }
    long double sn = 1 / sqrtl(1 + cs * cs);
    return (elliptic){sn, cs * sn, dn, 0};
}

/* Any u >= 0, 0 < k' <= 1.  The quarter period K goes into K - u, so that
   cn and dn are right to the last digits also where they are small. */
static elliptic elliptic_functions(long double u, long double kc) {
    if (!(u < 1 / LDBL_EPSILON)) /* no digit of the phase is known */
        return (elliptic){NAN, NAN, NAN, 0};
    means m = means_of(kc);
    long double quarter = PI / (2 * m.mean);
    long double turns = rintl(u / (2 * quarter));
    long double rest = u - 2 * quarter * turns, size = fabsl(rest);
    elliptic e = elliptic_basic(&m, fminl(size, quarter - size));
    if (size > quarter / 2)
        e = (elliptic){e.cn / e.dn, kc * e.sn / e.dn, kc / e.dn, 0};
    e.sn = copysignl(e.sn, rest);
    e.turns = turns;
    return e;
}

/* sn, cn, dn of tau >= 0 with k'^2 of any sign: the motion that starts from
   the bottom.  Half a swing of a libration is no turn. */
static elliptic from_bottom(long double tau, long double kc2) {
    if (kc2 > 0) {
        elliptic e = elliptic_functions(tau, sqrtl(kc2));
        long double sign = fmodl(e.turns, 2) != 0 ? -1 : 1;
        return (elliptic){sign * e.sn, sign * e.cn, e.dn, 0};
    }
    if (kc2 < 0) {
        long double k = sqrtl(1 - kc2);
        elliptic e = elliptic_functions(k * tau, sqrtl(-kc2) / k);
        return (elliptic){e.sn / k, e.dn, e.cn, e.turns};
    }
    return (elliptic){tanhl(tau), 1 / coshl(tau), 1 / coshl(tau), 0};
}

/* On from (q, Y) by tau >= 0; S and C are the sine and cosine of q/2, from the
   position at which the pendulum can rest. */
static void travel(long double tau, long double S, long double C,
                   long double kc2, long double *q, long double *Y) {
    elliptic e = from_bottom(tau, kc2);
    long double s = e.sn, c = e.cn, d = e.dn, Y0 = *Y;
    long double both = C * C + S * S * c, cross = S * C * (1 - c);
    long double way =
        2 * atan2l(s * Y0 * both - d * cross, d * both + s * Y0 * cross);
    *q += way + copysignl(2 * PI, Y0) * e.turns;
    *Y = (Y0 * c - S * C * s * d) / (C * C + S * S * c * c);
}

/* The pendulum with gravity, of either sign. */
static void swing(long double t, long double inertia, long double weight,
                  long double *q, long double *p) {
    long double rate = sqrtl(fabsl(weight / inertia));
    long double unit = 2 * inertia * rate, unit2 = fabsl(4 * inertia * weight);
    bool up = weight / inertia < 0; /* rests at q = pi */
    long double S = up ? -cosl(*q / 2) : sinl(*q / 2);
    long double C = up ? sinl(*q / 2) : cosl(*q / 2);
    long double kc2 = fmal(-*p, *p, unit2 * (C * C)) / unit2;
    long double way = copysignl(1, t); /* backwards is forwards with -p */
    long double Y = way * *p / unit;
    travel(fabsl(rate * t), S, C, kc2, q, &Y);
    *p = way * unit * Y;
}

static int pendulum_exact(const void *params, double t, const double q0[],
                          const double p0[], double q[], double p[]) {
    const nevh_pendulum *a = params;
    long double m = a->m, l = a->l, to_q = q0[0], to_p = p0[0];
    if (!isfinite(t))
        return NEVH_EDOM;
    if (a->g != 0)
        swing(t, m * l * l, m * a->g * l, &to_q, &to_p);
    else
        to_q += to_p * t / (m * l * l);
    return nevh__model_state(1, &to_q, &to_p, q, p);
}

const nevh_model nevh__pendulum = {
    .name = "pendulum",
    .title = "Pendulum",
    .n = 1,
    .defaults = &(const nevh_pendulum){.m = 1, .l = 1, .g = 9.8},
    .q = (const double[]){2},
    .p = (const double[]){0},
    .coords = (const char *const[]){"phi"},
    .system = pendulum_system,
    .hamiltonian = pendulum_hamiltonian,
    .exact = pendulum_exact,
};
const nevh_model *const nevh_pendulum_model = &nevh__pendulum;

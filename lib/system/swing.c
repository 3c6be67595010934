/* nevh: the motion of a pendulum.
   SPDX-License-Identifier: GPL-3.0-or-later

   With tau = sqrt(weight/inertia) t, S = sin(q/2), C = cos(q/2) and
   Y = p/(2 sqrt(weight inertia)), Hamilton's equations are
       S' = C Y,  C' = -S Y,  Y' = -S C,
   which k sn, dn, k cn of tau solve.  Here k^2 = S^2 + Y^2 is below 1 where the
   pendulum swings and above where it turns over.  The addition theorem of these
   functions takes any state on by tau, with no elliptic integral to find its
   phase; it is written with C^2 + S^2 c^2 for 1 - k^2 sn^2 sn^2, and then no
   cancellation in it is worse than rounding.

   GSL's gsl_sf_elljac_e is not used: it is handed k^2, whose rounding near the
   separatrix costs 1e-6 of phase and more.  The functions below take the
   complement k'^2 = 1 - k^2 and work in long double. */
#include "system/motion_private.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>

#define PI 3.141592653589793238462643383279502884L

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

void nevh__swing(long double t, long double inertia, long double weight,
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

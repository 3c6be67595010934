/* nevh: steps of Verlet that vary as C text: that of the kernel, whose slopes are
   a scene's formulas.

   The first step of an orbit, and one that fails, are the kernel's.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/adaptive_verlet_private.h"
#include "native/native_private.h"
#include "work/transform_private.h"

static const char needs[] = "extern double hypot(double, double) CONST;\n"
                            "extern double pow(double, double) CONST;\n";

static const char slopes[] =
    "struct nevh__leap_owner {\n    const double *N;\n    double *bad;\n};\n"
    "INLINE int nevh__leap_slopes(const nevh__leap *x, double t, double *force, "
    "double *speed) {\n"
    "    const double *N = x->owner->N;\n"
    "    if (force) *x->owner->bad += kick_slope(N, t, x->q, x->p, force);\n"
    "    if (speed) *x->owner->bad += drift_slope(N, t, x->q, x->p, speed);\n"
    "    return 0;\n}\n"
    "INLINE int nevh__leap_pair(const nevh__leap *x, double t) {\n"
    "    for (int which = 0; which < 2; which++) {\n"
    "        double z[2 * DOF], slope[2 * DOF];\n"
    "        NEVH__EACH(k, 1, 2 * DOF) z[k] = x->pair[2 * k + which];\n"
    "        *x->owner->bad += kick_slope(x->owner->N, t, z, z + DOF, slope);\n"
    "        *x->owner->bad += drift_slope(x->owner->N, t, z, z + DOF, slope + "
    "DOF);\n"
    "        NEVH__EACH(k, 1, 2 * DOF) x->pair_slopes[2 * k + which] = "
    "slope[k];\n"
    "    }\n"
    "    return 0;\n}\n"
    "INLINE int nevh__leap_account(const nevh__leap *x, bool of_q, double t, "
    "double length) { return 0; }\n";

static const char step[] =
    "INLINE bool take_step(const double *N, double t, double h, double *Q, "
    "double *P, double *M, double *length) {\n"
    "    double q[DOF], p[DOF], force[DOF], speed[DOF], dq[DOF], dp[DOF];\n"
    "    double pair[4 * DOF], pair_slopes[4 * DOF], bad = 0, s;\n"
    "    nevh__density c = {1, M[3 * DOF + 1], M[3 * DOF + 2], M[3 * DOF + "
    "3]};\n"
    "    struct nevh__leap_owner owner = {N, &bad};\n"
    "    nevh__leap x = {DOF, $1, $2, M, q, p, force, speed, dq, dp, pair,\n"
    "                    pair_slopes, &owner};\n"
    "    if (M[3 * DOF] == 0) return false;\n"
    "    nevh__leap_place(&x, Q, P, M + 2 * DOF);\n"
    "    nevh__leap_slopes(&x, t, NULL, speed);\n"
    "    s = $3;\n"
    "    *length = h * s;\n"
    "    if (!(s > $4) || *length - *length != 0) return false;\n"
    "    nevh__leap_take(&x, t, *length, Q, P);\n"
    "$5"
    "    NEVH__EACH(k, 1, DOF) {\n"
    "        q[k] = Q[k] + (dq[k] + M[k]);\n"
    "        p[k] = P[k] + (dp[k] + M[DOF + k]);\n"
    "        bad += (q[k] - q[k]) + (p[k] - p[k]);\n"
    "    }\n"
    "    if (bad != 0) return false;\n"
    "    NEVH__EACH(k, 1, DOF) {\n"
    "        M[k] = nevh__roundoff(q[k], Q[k], dq[k] + M[k]);\n"
    "        M[DOF + k] = nevh__roundoff(p[k], P[k], dp[k] + M[DOF + k]);\n"
    "        Q[k] = q[k];\n"
    "        P[k] = p[k];\n"
    "        M[2 * DOF + k] = force[k];\n"
    "    }\n"
    "    M[3 * DOF + 2] = c.density;\n"
    "    M[3 * DOF + 3] = c.change;\n"
    "    return true;\n}\n";
/* Where nothing moves the change is 0 without a slope, and counts are others. */
static const char changes[] =
    "    if (!(nevh__leap_size(&x) > 0)) return false;\n"
    "    nevh__leap_change(&x, t + *length, c.unit, &c.change);\n"
    "    c.density += h / 2 * c.change;\n";

static const char driver[] =
    "    return steps == 1 && take_step(N, t0 + (double)from * h, h, Q, P, M, "
    "T);\n}\n";

bool nevh__write_adaptive_verlet(nevh__writer *w, nevh_work *work) {
    const nevh__step_control *table = work->integrator->table;
    double unit_p, unit_q = nevh__adaptive_verlet_units(work, &unit_p);
    char of_q[NEVH__NAME], of_p[NEVH__NAME], least[NEVH__NAME];
    if (w->readable) {
        w->refusal = NEVH__ONLY_PROGRAMS;
        return false;
    }
    nevh__write_needs(w, work->n, false, false);
    if (!nevh__write_slopes(w, work->field, 4))
        return false;
    nevh__write_number(w, unit_q, of_q);
    nevh__write_number(w, unit_p, of_p);
    nevh__number_text(NEVH__LEAST_RATE, least);
    nevh__write(w, "%s", needs);
    nevh__write_lines(w, nevh__adaptive_verlet_step_text);
    nevh__write(w, "%s", slopes);
    nevh__write_filled(w, step,
                       (const char *const[]){
                           of_q, of_p,
                           table->reversible ? "nevh__leap_rate(&c, h)"
                                             : "nevh__leap_stretch(&x, c.unit)",
                           least, table->reversible ? changes : ""});
    nevh__write_driver_head(w);
    nevh__write(w, "%s", driver);
    return true;
}

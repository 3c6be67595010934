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
    "struct nevh__leap_owner {\n$1    double *bad;\n};\n\n"
    "NEVH__INLINE int nevh__leap_slopes(const nevh__leap *x, double t,\n"
    "                                   double *force, double *speed) {\n"
    "    if (force)\n"
    "        *x->owner->bad += kick_slope($2t, x->q, x->p, force);\n"
    "    if (speed)\n"
    "        *x->owner->bad += drift_slope($2t, x->q, x->p, speed);\n"
    "    return 0;\n}\n\n"
    "NEVH__INLINE int nevh__leap_pair(const nevh__leap *x, double t) {\n"
    "    for (int which = 0; which < 2; which++) {\n"
    "        double z[2 * DOF], slope[2 * DOF];\n"
    "        NEVH__EACH(k, 1, 2 * DOF)\n"
    "            z[k] = x->pair[2 * k + which];\n"
    "        *x->owner->bad += kick_slope($2t, z, z + DOF, slope);\n"
    "        *x->owner->bad += drift_slope($2t, z, z + DOF, slope + DOF);\n"
    "        NEVH__EACH(k, 1, 2 * DOF)\n"
    "            x->pair_slopes[2 * k + which] = slope[k];\n"
    "    }\n"
    "    return 0;\n}\n\n";
static const char no_account[] =
    "INLINE int nevh__leap_account(const nevh__leap *x, bool of_q, double t, "
    "double length) { return 0; }\n";

/* The memory behind digits that sums have lost: dV/dq where the step begins, and
   the density's. */
static const char head_for_readers[] =
    "/* A step of h times what the density says.  Returns whether it could be\n"
    "   taken, and sets the time that it takes. */\n"
    "static bool take_step(double t, double h, double *Q, double *P, double *M,\n"
    "                      double *length) {\n";
static const char head[] =
    "INLINE bool take_step(const double *N, double t, double h, double *Q, "
    "double *P, double *M, double *length) {\n";
static const char opening[] =
    "    double q[DOF], p[DOF], force[DOF], speed[DOF], dq[DOF], dp[DOF];\n"
    "    double pair[4 * DOF], pair_slopes[4 * DOF], bad = 0, s;\n"
    "    nevh__density c = {1, M[3 * DOF + 1], M[3 * DOF + 2], M[3 * DOF + "
    "3]};\n"
    "    struct nevh__leap_owner owner = {$1&bad};\n"
    "    nevh__leap x = {DOF, $2, $3, M, q, p, force, speed, dq, dp, pair,\n"
    "                    pair_slopes, &owner};\n";
static const char goes_on[] = "    if (M[3 * DOF] == 0)\n"
                              "        return false;\n"
                              "    nevh__leap_place(&x, Q, P, M + 2 * DOF);\n"
                              "    nevh__leap_slopes(&x, t, NULL, speed);\n";
static const char begins[] =
    "    nevh__leap_place(&x, Q, P, M + 2 * DOF);\n"
    "    nevh__leap_slopes(&x, t, M[3 * DOF] == 0 ? force : NULL, speed);\n"
    "    if (M[3 * DOF] == 0) { /* the orbit begins */\n"
    "        M[3 * DOF] = c.density = 1;\n"
    "        M[3 * DOF + 1] = c.unit = nevh__leap_size(&x);\n"
    "$1"
    "    }\n";
static const char first_change[] =
    "        nevh__leap_change(&x, t, c.unit, &c.change);\n";
static const char taking[] = "    s = $1;\n"
                             "    *length = h * s;\n"
                             "    if (!(s > $2) || *length - *length != 0)\n"
                             "        return false;\n"
                             "    nevh__leap_take(&x, t, *length, Q, P);\n";
/* Where nothing moves the change is 0 without a slope, and counts are others. */
static const char moves[] =
    "    if (!(nevh__leap_size(&x) > 0)) return false;\n";
static const char change[] =
    "    nevh__leap_change(&x, t + *length, c.unit, &c.change);\n"
    "    c.density += h / 2 * c.change;\n";
static const char closing[] =
    "    NEVH__EACH(k, 1, DOF) {\n"
    "        q[k] = Q[k] + (dq[k] + M[k]);\n"
    "        p[k] = P[k] + (dp[k] + M[DOF + k]);\n"
    "        bad += (q[k] - q[k]) + (p[k] - p[k]);\n"
    "    }\n"
    "    if (bad != 0)\n"
    "        return false;\n"
    "    NEVH__EACH(k, 1, DOF) {\n"
    "        M[k] = nevh__roundoff(q[k], Q[k], dq[k] + M[k]);\n"
    "        M[DOF + k] = nevh__roundoff(p[k], P[k], dp[k] + M[DOF + k]);\n"
    "        Q[k] = q[k];\n"
    "        P[k] = p[k];\n"
    "        M[2 * DOF + k] = force[k];\n"
    "    }\n"
    "    M[3 * DOF + 2] = c.density;\n"
    "    M[3 * DOF + 3] = c.change;\n"
    "    return true;\n}\n\n";

static const char driver[] =
    "    return steps == 1 && take_step(N, t0 + (double)from * h, h, Q, P, M, "
    "T);\n}\n";

/* Time is a sum with compensation, whose last digits stand in the memory. */
static const char driver_for_readers[] =
    "/* Where a step of h from the time t begins, and where a part of it ends. */\n"
    "typedef struct {\n"
    "    double q[DOF], p[DOF], memory[3 * DOF + 4];\n"
    "} orbit;\n"
    "struct nevh__fraction_owner {\n"
    "    orbit begin, end;\n"
    "    double t, h;\n"
    "    double whole, due; /* times: of the step, and of the part */\n"
    "};\n\n"
    "static bool take_part(struct nevh__fraction_owner *o, double part,\n"
    "                      double *length) {\n"
    "    o->end = o->begin;\n"
    "    return take_step(o->t, part * o->h, o->end.q, o->end.p, o->end.memory,\n"
    "                     length);\n}\n\n"
    "static double nevh__fraction_miss(struct nevh__fraction_owner *o,\n"
    "                                  double fraction) {\n"
    "    double length;\n"
    "    return take_part(o, fraction, &length) ? length / o->whole - o->due / "
    "o->whole\n"
    "                                           : NAN;\n}\n\n"
    "/* The part that ends on time. */\n"
    "static bool end_on_time(struct nevh__fraction_owner *o) {\n"
    "    double length, fraction = nevh__fraction_find(o, o->due / o->whole);\n"
    "    return fraction == fraction && take_part(o, fraction, &length) &&\n"
    "           fabs(length - o->due) <= 1e-9 * fabs(o->due);\n}\n\n"
    "/* Takes up to `steps` steps of h, and returns how many of them it could\n"
    "   take.  Each takes a time of its own, which is added to *t, and the last one\n"
    "   ends at t_end. */\n"
    "static size_t advance(double *t, double t_end, double h, size_t steps,\n"
    "                      double *q, double *p, double *memory) {\n"
    "    double *lost = memory + 3 * DOF + 4; /* of t, by rounding */\n"
    "    size_t done = 0;\n"
    "    for (; done < steps && *t != t_end; done++) {\n"
    "        struct nevh__fraction_owner o = {.t = *t, .h = h};\n"
    "        memcpy(o.begin.q, q, sizeof o.begin.q);\n"
    "        memcpy(o.begin.p, p, sizeof o.begin.p);\n"
    "        memcpy(o.begin.memory, memory, sizeof o.begin.memory);\n"
    "        if (!take_part(&o, 1, &o.whole) || !(o.whole / h > 0))\n"
    "            break;\n"
    "        double passed = o.whole + *lost, next = *t + passed;\n"
    "        *lost = nevh__roundoff(next, *t, passed);\n"
    "        if ((next - t_end) / h > 0) {\n"
    "            o.due = t_end - *t;\n"
    "            next = t_end;\n"
    "            if (o.due / o.whole < 1 && !end_on_time(&o))\n"
    "                break;\n"
    "        }\n"
    "        memcpy(q, o.end.q, sizeof o.end.q);\n"
    "        memcpy(p, o.end.p, sizeof o.end.p);\n"
    "        memcpy(memory, o.end.memory, sizeof o.end.memory);\n"
    "        *t = next;\n"
    "    }\n"
    "    return done;\n}\n";

static void write_step(nevh__writer *w, const nevh_work *work) {
    const nevh__step_control *table = work->integrator->table;
    bool plain = w->readable, follows = table->reversible;
    double unit_p, unit_q = nevh__adaptive_verlet_units(work, &unit_p);
    char of_q[NEVH__NAME], of_p[NEVH__NAME], least[NEVH__NAME];
    nevh__write_number(w, unit_q, of_q);
    nevh__write_number(w, unit_p, of_p);
    nevh__number_text(NEVH__LEAST_RATE, least);
    nevh__write(w, "%s", plain ? head_for_readers : head);
    nevh__write_filled(w, opening,
                       (const char *const[]){plain ? "" : "N, ", of_q, of_p});
    nevh__write_filled(w, plain ? begins : goes_on,
                       (const char *const[]){follows ? first_change : ""});
    nevh__write_filled(
        w, taking,
        (const char *const[]){follows ? "nevh__leap_rate(&c, h)"
                                      : "nevh__leap_stretch(&x, c.unit)",
                              least});
    nevh__write(w, "%s%s%s", follows && !plain ? moves : "",
                follows ? change : "", closing);
}

bool nevh__write_adaptive_verlet(nevh__writer *w, nevh_work *work) {
    bool plain = w->readable;
    nevh__write_needs(w, work->n, false, false);
    if (!nevh__write_slopes(w, work->field, plain ? 1 : 4))
        return false;
    nevh__write(w, "%s", plain ? "" : needs);
    nevh__write_lines(w, nevh__adaptive_verlet_step_text);
    nevh__write_filled(
        w, slopes,
        (const char *const[]){plain ? "" : "    const double *N;\n",
                              plain ? "" : "x->owner->N, "});
    nevh__write(w, "%s", plain ? "" : no_account);
    write_step(w, work);
    w->own_time = plain;
    if (plain) {
        nevh__write(w, "struct nevh__fraction_owner;\n");
        nevh__write_lines(w, nevh__fraction_text);
        nevh__write(w, "%s", driver_for_readers);
        return true;
    }
    nevh__write_driver_head(w);
    nevh__write(w, "%s", driver);
    return true;
}

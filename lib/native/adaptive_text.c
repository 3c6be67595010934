/* nevh: steps under a tolerance as C text: their control is the kernel's, around
   the trials of a family.

   A step whose trials leave the numbers, or that takes too many, is left to the
   kernel, which begins it anew.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/runge_kutta_private.h"
#include "native/native_private.h"

static const char needs[] =
    "extern double log2(double) CONST, exp2(double) CONST;\n"
    "extern double fmin(double, double) CONST, fmax(double, double) CONST;\n"
    "extern double copysign(double, double) CONST;\n";

/* The memory of the kernel, behind digits that sums have lost. */
static const char sizes[] =
    "enum { LENGTH_AT = 2 * DOF, LAST_AT, BEFORE_AT, EXCESS_AT, FIRST_AT,\n"
    "       HAS_FIRST_AT = FIRST_AT + 2 * DOF, KEEPS = $1 };\n\n";

static const char step[] =
    "/* A step from t to t + h in as many substeps as the tolerance needs; false:\n"
    "   they do not get there, and nothing has changed. */\n"
    "NEVH__INLINE bool take_step($1double t, double h, double *Q, double *P,\n"
    "                            double *M$2) {\n"
    "    double y[2 * DOF], lost[2 * DOF], first[2 * DOF], ahead[2 * DOF];\n"
    "    double next[2 * DOF], next_lost[2 * DOF];\n"
    "    double change[2 * DOF], error[2 * DOF], coarse[2 * DOF];\n"
    "    const nevh__adaptive_rule rule = {2 * DOF, $3, $4, KEEPS, $5, $6, $7};\n"
    "    nevh__substeps l = {.size = M[LENGTH_AT],\n"
    "                        .last = M[LAST_AT],\n"
    "                        .before = M[BEFORE_AT],\n"
    "                        .excess = M[EXCESS_AT],\n"
    "                        .has_first = KEEPS && M[HAS_FIRST_AT] != 0};\n"
    "$8"
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        y[k] = k < DOF ? Q[k] : P[k - DOF];\n"
    "        lost[k] = M[k];\n"
    "        first[k] = KEEPS ? M[FIRST_AT + k] : 0;\n"
    "    }\n"
    "    while (l.done < fabs(h)) {\n"
    "        double begin = t + copysign(l.done, h), bad = 0, err;\n"
    "        if (!l.has_first) {\n"
    "            bad += take_first($9begin, h, y, lost, first);\n"
    "            l.has_first = true;\n";
static const char step_goes_on[] =
    "        }\n"
    "        if (l.size == 0)\n"
    "            l.size = nevh__substeps_first(&rule, h, 1, y, first);\n"
    "        if (bad != 0 || nevh__substeps_too_short(&l, h) ||\n"
    "            nevh__pace_count(&l.pace, fabs(h), l.done) ||\n"
    "            nevh__substeps_exceed(&l))\n"
    "            return false;\n"
    "        nevh__substeps_choose(&l, h);\n"
    "        bad = take_trial($1begin, copysign(l.step, h), y, lost, first,\n"
    "                         ahead, change, error, coarse);\n"
    "        NEVH__EACH(k, 1, 2 * DOF) {\n"
    "            double moved = change[k] + lost[k];\n"
    "            next[k] = y[k] + moved;\n"
    "            bad += next[k] - next[k];\n"
    "            next_lost[k] = nevh__roundoff(next[k], y[k], moved);\n"
    "        }\n"
    "$2"
    "        err = nevh__substeps_judge(&rule, 1, error, coarse, y, next);\n"
    "        if (!(err <= 1)) {\n"
    "            if (!nevh__substeps_reject(&rule, &l, h, err))\n"
    "                return false;\n"
    "            continue;\n"
    "        }\n"
    "        nevh__substeps_accept(&rule, &l, h, err);\n"
    "        NEVH__EACH(k, 1, 2 * DOF) {\n"
    "            y[k] = next[k];\n"
    "            lost[k] = next_lost[k];\n"
    "            first[k] = KEEPS ? ahead[k] : 0;\n"
    "        }\n"
    "    }\n";
static const char step_ends[] =
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        *(k < DOF ? Q + k : P + (k - DOF)) = y[k];\n"
    "        M[k] = lost[k];\n"
    "        if (KEEPS)\n"
    "            M[FIRST_AT + k] = first[k];\n"
    "    }\n"
    "    M[LENGTH_AT] = l.size;\n"
    "    M[LAST_AT] = l.last;\n"
    "    M[BEFORE_AT] = l.before;\n"
    "    M[EXCESS_AT] = nevh__substeps_excess(&l);\n"
    "    if (KEEPS)\n"
    "        M[HAS_FIRST_AT] = l.has_first;\n"
    "$1"
    "    return true;\n}\n\n";

static const char leaves[] = "        trials++;\n"
                             "        if (bad != 0)\n"
                             "            return false;\n";
static const char retreats[] =
    "        if (bad != 0) {\n"
    "            if (!nevh__substeps_retreat(&l, h))\n"
    "                return false;\n"
    "            continue;\n"
    "        }\n";

static const char driver[] =
    "    size_t done = 0;\n"
    "    while (done < steps &&\n"
    "           take_step($1t0 + (double)(from + done) * h, h, Q, P, M$2))\n"
    "        done++;\n"
    "    return done;\n}\n";

static void write_step(nevh__writer *w, const nevh__adaptive_rule *rule,
                       const char *scale) {
    bool plain = w->readable;
    char power[NEVH__NAME], tolerance[NEVH__NAME], part[NEVH__NAME];
    nevh__number_text(rule->power, power);
    nevh__write_number(w, rule->tolerance, tolerance);
    nevh__write_number(w, rule->part, part);
    const char *n = plain ? "" : "N, ";
    nevh__write_filled(
        w, step,
        (const char *const[]){
            plain ? "" : "const double *N, ", plain ? "" : ", size_t *counted",
            power, rule->coarse ? "true" : "false", tolerance, part, scale,
            plain ? "" : "    size_t firsts = 0, trials = 0;\n", n});
    nevh__write(w, "%s", plain ? "" : "            firsts++;\n");
    nevh__write_filled(w, step_goes_on,
                       (const char *const[]){n, plain ? retreats : leaves});
    nevh__write_filled(
        w, step_ends,
        (const char *const[]){plain ? ""
                                    : "    counted[0] += firsts;\n"
                                      "    counted[1] += trials;\n"});
}

void nevh__write_adaptive(nevh__writer *w, const nevh_work *work,
                          const nevh__adaptive_rule *rule) {
    char scale[NEVH__NAME];
    nevh__write_filled(w, sizes,
                       (const char *const[]){rule->keeps ? "true" : "false"});
    nevh__write_array(w, "scales", "N", 2 * work->n, work->scale, scale);
    nevh__write(w, "%s", w->readable ? "" : needs);
    nevh__write_lines(w, nevh__pace_text);
    nevh__write_lines(w, nevh__adaptive_step_text);
    write_step(w, rule, scale);
    nevh__write_driver_head(w);
    nevh__write_filled(w, driver,
                       (const char *const[]){w->readable ? "" : "N, ",
                                             w->readable ? "" : ", counted"});
}

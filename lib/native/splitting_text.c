/* nevh: steps of a splitting as C text: that of the kernel, whose slopes are a
   scene's formulas.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/splitting_private.h"
#include "native/native_private.h"
#include <stdio.h>
#include <stdlib.h>

static const char slope[] =
    "NEVH__INLINE int nevh__splitting_slope(const nevh__splitting_step *x, int "
    "way,\n"
    "                                       size_t i, bool kick, bool kept) {\n"
    "    double t = x->t + x->scheme->times[i] * x->h;\n"
    "    (void)way;\n"
    "    if (!kept)\n"
    "        *x->owner->bad += kick ? kick_slope($1t, x->q.point,\n"
    "                                            x->p.point, x->slope)\n"
    "                               : drift_slope($1t, x->q.point,\n"
    "                                             x->p.point, x->slope);\n"
    "    return 0;\n}\n\n"
    "NEVH__INLINE const nevh__number *\n"
    "nevh__splitting_inverse(const nevh__splitting_step *x, int way) {\n"
    "    (void)x, (void)way;\n"
    "    return NULL;\n}\n\n";

static const char first[] =
    "static __attribute__((noinline)) nevh__number take_first(const double *N, "
    "const double *T, double t, double h, const nevh__number *y, const "
    "nevh__number *lost, nevh__number *kept) {\n"
    "    nevh__number point[2 * DOF];\n"
    "    NEVH__EACH(k, 1, 2 * DOF) point[k] = y[k] + lost[k];\n"
    "    return %s(N, t + T[0] * h, point, point + DOF, kept);\n}\n";
static const char no_first[] =
    "#define take_first(N, T, t, h, y, lost, kept) ((nevh__number){0})\n";

/* The state's check of finite numbers is that of all lanes. */
static const char step[] =
    "INLINE nevh__number take_step(const double *N, double *W, double *T,\n"
    "        size_t operations, double t, double h, nevh__number *y,\n"
    "        nevh__number *lost, nevh__number *kept) {\n"
    "    nevh__number change[2 * DOF], point[2 * DOF], slope[DOF], bad = {0};\n"
    "    struct nevh__splitting_owner owner = {N, &bad};\n"
    "    nevh__splitting_scheme scheme = {operations, W, T, $1, $2};\n"
    "    nevh__splitting_step x = {t, h, &scheme, $2,\n"
    "        {y, lost, change, point},\n"
    "        {y + DOF, lost + DOF, change + DOF, point + DOF},\n"
    "        slope, kept, &owner};\n"
    "    nevh__splitting_take(&x, 0, 1, DOF);\n"
    "    NEVH__EACH(k, 1, 2 * DOF) bad += point[k] - point[k];\n"
    "    return bad;\n}\n";

static const char step_for_readers[] =
    "/* A step of the state y, q and then p.  Returns 0 if all is finite. */\n"
    "static double take_step(double t, double h, double *y, double *lost,\n"
    "                        double *kept) {\n"
    "    static const nevh__splitting_scheme scheme = {$3, W, T, $1, "
    "$2};\n"
    "    double change[2 * DOF], point[2 * DOF], slope[DOF], bad = 0;\n"
    "    struct nevh__splitting_owner owner = {&bad};\n"
    "    nevh__splitting_step x = {\n"
    "        t, h, &scheme, $2 && kept[DOF] != 0,\n"
    "        {y, lost, change, point},\n"
    "        {y + DOF, lost + DOF, change + DOF, point + DOF},\n"
    "        slope, kept, &owner};\n"
    "    if (nevh__splitting_take(&x, 0, 1, DOF) != 0)\n"
    "        return 1;\n"
    "$4"
    "    return bad;\n}\n\n";

static const char owner[] = "struct nevh__splitting_owner {\n"
                            "%s    nevh__number *bad;\n};\n\n";

/* A kick takes dH/dq at the drifts' time, a drift dH/dp at the kicks'. */
bool nevh__splitting_tables(const nevh_splitting *table, double **weights,
                            double **times) {
    size_t count = nevh__splitting_operations(table);
    double passed[2] = {0, 0};
    *weights = nevh__array(count, sizeof **weights);
    *times = nevh__array(count, sizeof **times);
    if (!*weights || !*times)
        return false;
    nevh__splitting_expand(table, *weights);
    for (size_t i = 0; i < count; i++) {
        (*times)[i] = passed[1 - i % 2];
        passed[i % 2] += (*weights)[i];
    }
    return true;
}

static void write_tables(nevh__writer *w, const nevh_splitting *table) {
    size_t count = nevh__splitting_operations(table);
    double *weights, *times;
    if (nevh__splitting_tables(table, &weights, &times)) {
        nevh__write(w, "/* Weights, and times as parts of a step. */\n");
        nevh__write_numbers(w, "static double W", count, weights);
        nevh__write_numbers(w, "static double T", count, times);
        nevh__write(w, "\n");
    } else
        w->failed = true;
    free(weights);
    free(times);
}

bool nevh__write_splitting(nevh__writer *w, nevh_work *work) {
    const nevh_splitting *table = work->integrator->table;
    size_t count = nevh__splitting_operations(table);
    bool keeps = count % 2 == 1, kicks = table->first == NEVH_KICK;
    char number[24];
    snprintf(number, sizeof number, "%zu", count);
    const char *keep = keeps ? "true" : "false",
               *kick = kicks ? "true" : "false";
    nevh__write_needs(w, work->n, true, false);
    if (!nevh__write_slopes(w, work->field, 2))
        return false;
    if (w->readable)
        write_tables(w, table);
    nevh__write_lines(w, nevh__splitting_step_text);
    nevh__write(w, owner, w->readable ? "" : "    const double *N;\n");
    nevh__write_filled(
        w, slope, (const char *const[]){w->readable ? "" : "x->owner->N, "});
    if (w->readable)
        nevh__write_filled(
            w, step_for_readers,
            (const char *const[]){kick, keep, number,
                                  keeps ? "    kept[DOF] = 1;\n" : ""});
    else {
        nevh__write(w, "enum { KEPT = %s };\n", keeps ? "DOF" : "0");
        nevh__write(w, keeps ? first : no_first,
                    kicks ? "kick_slope" : "drift_slope");
        nevh__write_filled(w, step, (const char *const[]){kick, keep});
    }
    nevh__write_driver(w, true);
    return true;
}

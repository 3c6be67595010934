/* nevh: steps of a Runge-Kutta-Nystroem method as C text: that of the kernel,
   whose slopes are a scene's formulas, and the tables in digits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/runge_kutta_private.h"
#include "native/native_private.h"
#include <stdio.h>

static const char owner[] = "struct nevh__nystrom_owner {\n"
                            "$1    double t, h, *now;\n"
                            "    nevh__number *bad;\n};\n\n";

static const char slopes[] =
    "NEVH__INLINE void nevh__nystrom_time(const nevh__nystrom_step *x, int way,\n"
    "                                     double c) {\n"
    "    (void)way;\n"
    "    *x->owner->now = x->owner->t + c * x->owner->h;\n}\n\n"
    "NEVH__INLINE int nevh__nystrom_drift(const nevh__nystrom_step *x, int way) "
    "{\n"
    "    const struct nevh__nystrom_owner *o = x->owner;\n"
    "    (void)way;\n"
    "    *o->bad += drift_slope($1*o->now, x->points, x->momenta,\n"
    "                           x->velocities);\n"
    "    return 0;\n}\n\n"
    "NEVH__INLINE int nevh__nystrom_kick(const nevh__nystrom_step *x, int way,\n"
    "                                    size_t stage) {\n"
    "    const struct nevh__nystrom_owner *o = x->owner;\n"
    "    (void)way;\n"
    "    *o->bad += kick_slope($1*o->now, x->points, x->p,\n"
    "                          x->slopes + stage * x->stride);\n"
    "    return 0;\n}\n\n";

/* T_p(0) and W by arrays of numbers. */
static const char step_begins[] =
    "{\n"
    "    double steps[DOF], ways[DOF], gain[DOF], rest[DOF], momenta[DOF];\n"
    "    double velocities[DOF], points[DOF], slopes[$2 * DOF], change[2 * "
    "DOF];\n"
    "    double now = t, bad = 0;\n"
    "    struct nevh__nystrom_owner owner = {$1t, h, &now, &bad};\n"
    "    nevh__nystrom_step x = {\n"
    "        .c = times, .sums = sums, .lanes = 1, .size = DOF, .stride = "
    "DOF,\n"
    "        .diagonal = $3, .moves = $4, .q = y, .p = y + DOF, .compensation = "
    "lost,\n"
    "        .h = steps, .way = ways, .gain = gain, .at_rest = rest,\n"
    "        .momenta = momenta, .velocities = velocities, .points = points,\n"
    "        .slopes = slopes, .owner = &owner};\n"
    "    NEVH__EACH(k, 1, DOF) {\n"
    "        steps[k] = h;\n"
    "        rest[k] = $5[k];\n"
    "        gain[k] = h * h * $6[k];\n"
    "    }\n";

static const char stages_apart[] =
    "    nevh__nystrom_place_start(&x);\n"
    "    nevh__nystrom_time(&x, 0, 0);\n"
    "    if (x.diagonal) nevh__nystrom_find_way(&x, 0, false);\n";

static const char step_ends[] =
    "    nevh__nystrom_sum_kicks(&x, &sums[$1 + 1], 1, change + DOF);\n"
    "    nevh__nystrom_sum_drifts(&x, 0, &sums[$1], 1, 1, change);\n"
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        double moved = change[k] + lost[k], next = y[k] + moved;\n"
    "        bad += next - next;\n"
    "        lost[k] = nevh__roundoff(next, y[k], moved);\n"
    "        y[k] = next;\n"
    "    }\n"
    "    return bad;\n}\n\n";

static void write_step(nevh__writer *w, const nevh__nystrom_kinetic *kinetic,
                       size_t stages, const char *rest, const char *inverse) {
    char count[24];
    snprintf(count, sizeof count, "%zu", stages);
    nevh__write_step_head(w);
    nevh__write_filled(w, step_begins,
                       (const char *const[]){
                           w->readable ? "" : "N, ", count,
                           kinetic->diagonal ? "true" : "false",
                           kinetic->moves ? "true" : "false", rest, inverse});
    if (w->readable)
        nevh__write(w, "    nevh__nystrom_take(&x, 0, false, 0, %zu);\n",
                    stages);
    else
        nevh__write(w, "%s", stages_apart);
    for (size_t i = 0; i < stages && !w->readable; i++)
        nevh__write(w,
                    "    nevh__nystrom_place(&x, 0, %zu);\n"
                    "    nevh__nystrom_kick(&x, 0, %zu);\n",
                    i, i);
    nevh__write_filled(w, step_ends, (const char *const[]){count});
}

bool nevh__write_nystrom(nevh__writer *w, nevh_work *work) {
    const nevh_nystrom *table = work->integrator->table;
    nevh__nystrom_kinetic kinetic = nevh__nystrom_kinetic_of(work);
    nevh__sums_text sums = {0};
    size_t s = table->stages;
    char rest[NEVH__NAME], inverse[NEVH__NAME];
    if (w->width > 1) {
        w->refusal = "orbits stand side by side";
        return false;
    }
    nevh__write_needs(w, work->n, false, true);
    if (!nevh__write_slopes(w, work->field, s))
        return false;
    nevh__write_lines(w, nevh__stage_sums_text);
    nevh__write_lines(w, nevh__nystrom_step_text);
    for (size_t i = 0; i < s; i++)
        nevh__write_sum(w, &sums, table->a + i * s, i, "DOF");
    nevh__write_sum(w, &sums, table->bq, s, "DOF");
    nevh__write_sum(w, &sums, table->bp, s, "DOF");
    nevh__write_sums(w, &sums);
    nevh__write_numbers(w, "static const double times", s, table->c);
    nevh__write_array(w, "at_rest", "N", work->n, kinetic.rest, rest);
    nevh__write_array(w, "inverse", "N", work->n, kinetic.inverse, inverse);
    nevh__write(w, "\n");
    nevh__write_filled(
        w, owner,
        (const char *const[]){w->readable ? "" : "    const double *N;\n"});
    nevh__write_filled(w, slopes,
                       (const char *const[]){w->readable ? "" : "o->N, "});
    write_step(w, &kinetic, s, rest, inverse);
    nevh__write_unkept(w);
    nevh__write_driver(w, false);
    return true;
}

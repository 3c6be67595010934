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
static const char stages_begin[] =
    "    double steps[DOF], ways[DOF], gain[DOF], rest[DOF], momenta[DOF];\n"
    "    double velocities[DOF], points[DOF], slopes[$2 * DOF];\n"
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
    "        rest[k] = AT_REST[k];\n"
    "        gain[k] = h * h * INVERSE[k];\n"
    "    }\n";

static const char stages_apart[] =
    "    nevh__nystrom_place_start(&x);\n"
    "    nevh__nystrom_time(&x, 0, 0);\n"
    "    if (x.diagonal) nevh__nystrom_find_way(&x, 0, $1);\n";

static const char step_ends[] =
    "    double change[2 * DOF];\n"
    "    nevh__nystrom_sum_kicks(&x, &sums[$1 + 1], 1, change + DOF);\n"
    "    nevh__nystrom_sum_drifts(&x, 0, &sums[$1], 1, 1, change);\n"
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        double moved = change[k] + lost[k], next = y[k] + moved;\n"
    "        bad += next - next;\n"
    "        lost[k] = nevh__roundoff(next, y[k], moved);\n"
    "        y[k] = next;\n"
    "    }\n"
    "    return bad;\n}\n\n";

/* Under a tolerance: T_p and D_0 at the state, and the other stages. */
static const char first_slope[] =
    "static double take_first($1double t, double h, double *y, double *lost,\n"
    "                         double *first) {\n";
static const char first_ends[] = "    nevh__nystrom_take(&x, 0, false, 0, 1);\n"
                                 "    NEVH__EACH(k, 1, DOF) {\n"
                                 "        first[k] = velocities[k];\n"
                                 "        first[DOF + k] = slopes[k];\n"
                                 "        bad += slopes[k] - slopes[k];\n"
                                 "    }\n"
                                 "    return bad;\n}\n\n";
static const char trial[] =
    "NEVH__INLINE double take_trial($1double t, double h, double *y,\n"
    "                               double *lost, double *first, double *ahead,\n"
    "                               double *change, double *error,\n"
    "                               double *coarse) {\n";
static const char trial_begins[] = "    NEVH__EACH(k, 1, DOF) {\n"
                                   "        velocities[k] = first[k];\n"
                                   "        slopes[k] = first[DOF + k];\n"
                                   "    }\n";
static const char trial_ends[] =
    "    NEVH__EACH(k, 1, 2 * DOF)\n"
    "        ahead[k] = coarse[k] = 0;\n"
    "    nevh__nystrom_sum_kicks(&x, &sums[$1 + 1], 1, change + DOF);\n"
    "    nevh__nystrom_sum_drifts(&x, 0, &sums[$1], 1, 1, change);\n"
    "    nevh__nystrom_sum_kicks(&x, &sums[$1 + 3], 1, error + DOF);\n"
    "    nevh__nystrom_sum_drifts(&x, 0, &sums[$1 + 2], 0, 1, error);\n"
    "    for (size_t k = 0; k < $1 * DOF; k++)\n"
    "        bad += slopes[k] - slopes[k];\n"
    "    return bad;\n}\n\n";

/* The stages from the first one on: for readers a loop. */
static void write_stages(nevh__writer *w, size_t first, size_t until) {
    if (w->readable)
        nevh__write(w, "    nevh__nystrom_take(&x, 0, false, %zu, %zu);\n",
                    first, until);
    else
        nevh__write_filled(w, stages_apart,
                           (const char *const[]){first > 0 ? "true" : "false"});
    for (size_t i = first; i < until && !w->readable; i++)
        nevh__write(w,
                    "    nevh__nystrom_place(&x, 0, %zu);\n"
                    "    nevh__nystrom_kick(&x, 0, %zu);\n",
                    i, i);
}

static void write_step(nevh__writer *w, size_t stages,
                       const char *const words[]) {
    nevh__write_step_head(w);
    nevh__write(w, "{\n");
    nevh__write_filled(w, stages_begin, words);
    write_stages(w, 0, stages);
    nevh__write_filled(w, step_ends, words + 1);
    nevh__write_unkept(w);
    nevh__write_driver(w, false);
}

static void write_trial(nevh__writer *w, size_t stages,
                        const char *const words[]) {
    const char *const parameter[] = {w->readable ? "" : "const double *N, "};
    nevh__write_filled(w, first_slope, parameter);
    nevh__write_filled(w, stages_begin, words);
    nevh__write(w, "%s", first_ends);
    nevh__write_filled(w, trial, parameter);
    nevh__write_filled(w, stages_begin, words);
    nevh__write(w, "%s", trial_begins);
    write_stages(w, 1, stages);
    nevh__write_filled(w, trial_ends, words + 1);
}

static void write_tables(nevh__writer *w, const nevh_nystrom *table,
                         bool adapts) {
    nevh__sums_text sums = {0};
    size_t s = table->stages;
    for (size_t i = 0; i < s; i++)
        nevh__write_sum(w, &sums, table->a + i * s, i, "DOF");
    nevh__write_sum(w, &sums, table->bq, s, "DOF");
    nevh__write_sum(w, &sums, table->bp, s, "DOF");
    if (adapts) {
        nevh__write_sum(w, &sums, table->error_q, s, "DOF");
        nevh__write_sum(w, &sums, table->error_p, s, "DOF");
    }
    nevh__write_sums(w, &sums);
    nevh__write_numbers(w, "static const double times", s, table->c);
}

bool nevh__write_nystrom(nevh__writer *w, nevh_work *work) {
    const nevh_nystrom *table = work->integrator->table;
    nevh__nystrom_kinetic kinetic = nevh__nystrom_kinetic_of(work);
    bool adapts = nevh__adapts(work);
    char count[24];
    if (w->width > 1) {
        w->refusal = "orbits stand side by side";
        return false;
    }
    nevh__write_needs(w, work->n, false, true);
    if (!nevh__write_slopes(w, work->field, table->stages))
        return false;
    nevh__write_lines(w, nevh__stage_sums_text);
    nevh__write_lines(w, nevh__nystrom_step_text);
    write_tables(w, table, adapts);
    nevh__write_array(w, "AT_REST", "N", work->n, kinetic.rest);
    nevh__write_array(w, "INVERSE", "N", work->n, kinetic.inverse);
    nevh__write(w, "\n");
    nevh__write_filled(
        w, owner,
        (const char *const[]){w->readable ? "" : "    const double *N;\n"});
    nevh__write_filled(w, slopes,
                       (const char *const[]){w->readable ? "" : "o->N, "});
    snprintf(count, sizeof count, "%zu", table->stages);
    const char *const words[] = {w->readable ? "" : "N, ", count,
                                 kinetic.diagonal ? "true" : "false",
                                 kinetic.moves ? "true" : "false"};
    if (adapts) {
        write_trial(w, table->stages, words);
        nevh__write_adaptive(w, work, nevh__adaptive_rule_of(work));
    } else
        write_step(w, table->stages, words);
    return true;
}

/* nevh: steps of an explicit Runge-Kutta method as C text: that of the kernel,
   whose slopes are a scene's formulas, and the tables in digits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/runge_kutta_private.h"
#include "native/native_private.h"
#include "native/slope_private.h"
#include <stdio.h>

static const char slope[] =
    "NEVH__INLINE int nevh__runge_kutta_slope(const nevh__runge_kutta_step *x,\n"
    "                                         int way, size_t stage) {\n"
    "    const struct nevh__runge_kutta_owner *o = x->owner;\n"
    "    nevh__number *slopes = x->slopes + stage * x->stride;\n"
    "    double t = o->t + times[stage] * o->h;\n"
    "    (void)way;\n"
    "$4    *o->bad += kick_slope($1t, x->point$5, x->point + DOF$5, slopes + "
    "DOF$5$3);\n"
    "    *o->bad += drift_slope($1t, x->point$5, x->point + DOF$5, slopes$5$3);\n"
    "$6$2"
    "    return 0;\n}\n\n";

/* dp/dt = -(dH/dq + rate p). */
static const char friction[] =
    "    NEVH__EACH(k, 1, DOF)\n"
    "        slopes[DOF + k] += RATES[k$1] * x->point[DOF + k];\n";

static const char owner[] =
    "struct nevh__runge_kutta_owner {\n"
    "%s    double t, h;\n    nevh__number *bad;\n};\n\n";

static const char step_begins[] =
    "    nevh__number bad = {0};\n"
    "    struct nevh__runge_kutta_owner owner = {$1t, h, &bad};\n"
    "    nevh__runge_kutta_step x = {sums, 2 * DOF, 2 * DOF, y, lost,\n"
    "                                step, point, slopes, &owner};\n"
    "    NEVH__EACH(k, 1, DOF) {\n"
    "        step[k] = (nevh__number){0} + h;\n"
    "        step[DOF + k] = -step[k];\n"
    "    }\n";

static const char step_ends[] =
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        nevh__number change, next;\n"
    "        nevh__runge_kutta_sum(&x, &sums[$1], 1, k, &change);\n"
    "        change += lost[k];\n"
    "        next = y[k] + change;\n"
    "        bad += next - next;\n"
    "        lost[k] = nevh__roundoff(next, y[k], change);\n"
    "        y[k] = next;\n"
    "    }\n"
    "    return bad;\n}\n\n";

/* Under a tolerance: the slope at the state, and the other stages. */
static const char first_slope[] =
    "static double take_first($1double t, double h, double *y, double *lost,\n"
    "                         double *first) {\n"
    "    double bad = 0, step[2 * DOF], point[2 * DOF];\n"
    "    struct nevh__runge_kutta_owner owner = {$2t, h, &bad};\n"
    "    nevh__runge_kutta_step x = {sums, 2 * DOF, 2 * DOF, y, lost,\n"
    "                                step, point, first, &owner};\n"
    "    NEVH__EACH(k, 1, 2 * DOF)\n"
    "        step[k] = k < DOF ? h : -h;\n"
    "    nevh__runge_kutta_take(&x, 0, 0, 1);\n"
    "    NEVH__EACH(k, 1, 2 * DOF)\n"
    "        bad += first[k] - first[k];\n"
    "    return bad;\n}\n\n";
static const char trial_begins[] =
    "NEVH__INLINE double take_trial($1double t, double h, double *y,\n"
    "                               double *lost, double *first, double *ahead,\n"
    "                               double *change, double *error,\n"
    "                               double *coarse) {\n"
    "    double bad = 0, step[2 * DOF], point[2 * DOF];\n"
    "    double slopes[$3 * 2 * DOF];\n"
    "    struct nevh__runge_kutta_owner owner = {$2t, h, &bad};\n"
    "    nevh__runge_kutta_step x = {sums, 2 * DOF, 2 * DOF, y, lost,\n"
    "                                step, point, slopes, &owner};\n"
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        step[k] = k < DOF ? h : -h;\n"
    "        slopes[k] = first[k];\n"
    "    }\n";
static const char trial_ends[] =
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        nevh__runge_kutta_sum(&x, &sums[$1], 1, k, &change[k]);\n"
    "        nevh__runge_kutta_sum(&x, &sums[$1 + 1], 1, k, &error[k]);\n"
    "        nevh__runge_kutta_sum(&x, &sums[$1 + 2], 1, k, &coarse[k]);\n"
    "        ahead[k] = slopes[($1 - 1) * 2 * DOF + k];\n"
    "    }\n"
    "    for (size_t k = 0; k < $1 * 2 * DOF; k++)\n"
    "        bad += slopes[k] - slopes[k];\n"
    "    return bad;\n}\n\n";

static size_t stages_of(const nevh_butcher *table) {
    return table->stages - table->last_is_first;
}

static void write_tables(nevh__writer *w, const nevh_butcher *table,
                         size_t used, bool adapts) {
    static const double none[1];
    size_t s = table->stages;
    nevh__sums_text sums = {0};
    for (size_t i = 0; i < used; i++)
        nevh__write_sum(w, &sums, table->a + i * s, i, "2 * DOF");
    nevh__write_sum(w, &sums, table->b, used, "2 * DOF");
    if (adapts) {
        bool coarse = table->coarse;
        nevh__write_sum(w, &sums, table->error, s, "2 * DOF");
        nevh__write_sum(w, &sums, coarse ? table->coarse : none, coarse ? s : 0,
                        "2 * DOF");
    }
    nevh__write_sums(w, &sums);
    nevh__write_numbers(w, "static const double times", used, table->c);
    nevh__write(w, "\n");
}

/* The stages from the first one on: for readers a loop. */
static void write_stages(nevh__writer *w, size_t first, size_t until) {
    if (w->readable)
        nevh__write(w, "    nevh__runge_kutta_take(&x, 0, %zu, %zu);\n", first,
                    until);
    for (size_t i = first; i < until && !w->readable; i++)
        nevh__write(w, "    nevh__runge_kutta_take(&x, 0, %zu, %zu);\n", i,
                    i + 1);
}

static void write_step(nevh__writer *w, size_t stages) {
    char number[24];
    snprintf(number, sizeof number, "%zu", stages);
    nevh__write_step_head(w);
    nevh__write(w, "{\n");
    nevh__write_rows(w, "step", 2);
    nevh__write_rows(w, "point", 2);
    nevh__write_rows(w, "slopes", 2 * stages);
    nevh__write_filled(w, step_begins,
                       (const char *const[]){w->readable ? "" : "N, ", number});
    write_stages(w, 0, stages);
    nevh__write_filled(w, step_ends, (const char *const[]){number});
}

static void write_trial(nevh__writer *w, size_t stages) {
    char number[24];
    snprintf(number, sizeof number, "%zu", stages);
    const char *const words[] = {w->readable ? "" : "const double *N, ",
                                 w->readable ? "" : "N, ", number};
    nevh__write_filled(w, first_slope, words);
    nevh__write_filled(w, trial_begins, words);
    write_stages(w, 1, stages);
    nevh__write_filled(w, trial_ends, (const char *const[]){number});
}

static void write_slope(nevh__writer *w, const nevh_work *work) {
    nevh__writer part = {0};
    if (work->friction) {
        nevh__write_array(w, "RATES", "o->N", work->n, work->friction);
        nevh__write_filled(&part, friction,
                           (const char *const[]){w->group > 1 ? " % ONE" : ""});
        w->failed |= part.failed;
    }
    bool several = w->group > 1; /* both slopes have much in common */
    nevh__write_filled(
        w, slope,
        (const char *const[]){
            w->readable ? "" : "o->N, ", part.text ? part.text : "",
            w->loops && !w->readable ? NEVH__ALL_SLOPES : "",
            several ? "    for (size_t i = 0; i < DOF; i += ONE) {\n" : "",
            several ? " + i" : "", several ? "    }\n" : ""});
    nevh__writer_free(&part);
}

bool nevh__write_runge_kutta(nevh__writer *w, nevh_work *work) {
    const nevh_butcher *table = work->integrator->table;
    bool adapts = nevh__adapts(work);
    size_t stages = adapts ? table->stages : stages_of(table);
    w->group = nevh__vectors_at_once(w, work->field, 2 * stages);
    nevh__write_needs(w, work->n, false, true);
    if (!nevh__write_slopes(w, work->field, stages))
        return false;
    nevh__write_lines(w, nevh__stage_sums_text);
    nevh__write_lines(w, nevh__runge_kutta_step_text);
    write_tables(w, table, stages, adapts);
    nevh__write(w, owner, w->readable ? "" : "    const double *N;\n");
    write_slope(w, work);
    if (adapts) {
        write_trial(w, stages);
        nevh__write_adaptive(w, work, nevh__adaptive_rule_of(work));
        return true;
    }
    write_step(w, stages);
    nevh__write_unkept(w);
    nevh__write_driver(w, false);
    return true;
}

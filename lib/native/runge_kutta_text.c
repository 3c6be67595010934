/* nevh: steps of an explicit Runge-Kutta method as C text: that of the kernel,
   whose slopes are a scene's formulas, and the tables in digits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/native_private.h"
#include <stdio.h>

static const char slope[] =
    "NEVH__INLINE int nevh__runge_kutta_slope(const nevh__runge_kutta_step *x,\n"
    "                                         int way, size_t stage) {\n"
    "    const struct nevh__runge_kutta_owner *o = x->owner;\n"
    "    nevh__number *slopes = x->slopes + stage * x->stride;\n"
    "    double t = o->t + times[stage] * o->h;\n"
    "    (void)way;\n"
    "    *o->bad += kick_slope($1t, x->point, x->point + DOF, slopes + DOF);\n"
    "    *o->bad += drift_slope($1t, x->point, x->point + DOF, slopes);\n"
    "    return 0;\n}\n\n";

static const char owner[] =
    "struct nevh__runge_kutta_owner {\n"
    "%s    double t, h;\n    nevh__number *bad;\n};\n\n";

static const char step_begins[] =
    "{\n"
    "    nevh__number step[2 * DOF], point[2 * DOF], slopes[$2 * 2 * DOF];\n"
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

static size_t stages_of(const nevh_butcher *table) {
    return table->stages - table->last_is_first;
}

/* The weights of a sum that are not 0, and whose they are. */
static size_t write_row(nevh__writer *w, size_t row, const double all[],
                        size_t count) {
    size_t some = 0;
    for (int part = 0; part < 2; part++) {
        const char *plus = part ? "static size_t offsets_%zu[] = {"
                                : "static double weights_%zu[] = {";
        for (size_t j = 0; j < count; j++) {
            char number[NEVH__NAME];
            if (all[j] == 0)
                continue;
            nevh__number_text(all[j], number);
            if (*plus == 's')
                nevh__write(w, plus, row);
            else
                nevh__write(w, "%s", plus);
            if (part)
                nevh__write(w, "%zu * 2 * DOF", j);
            else
                nevh__write(w, "%s", number);
            plus = ", ";
            some += !part;
        }
        if (some)
            nevh__write(w, "};\n");
    }
    return some;
}

static void write_tables(nevh__writer *w, const nevh_butcher *table) {
    size_t s = table->stages, used = stages_of(table), count[64];
    for (size_t i = 0; i <= used; i++)
        count[i] = i < used ? write_row(w, i, table->a + i * s, i)
                            : write_row(w, i, table->b, used);
    nevh__write(w, "static const nevh__sum sums[] = {\n");
    for (size_t i = 0; i <= used; i++)
        if (count[i])
            nevh__write(w, "    {NULL, %zu, weights_%zu, offsets_%zu},\n",
                        count[i], i, i);
        else
            nevh__write(w, "    {NULL, 0, NULL, NULL},\n");
    nevh__write(w, "};\n\n");
    nevh__write_numbers(w, "static const double times", used, table->c);
}

static void write_step(nevh__writer *w, size_t stages) {
    char number[24];
    snprintf(number, sizeof number, "%zu", stages);
    if (w->readable)
        nevh__write(w, "/* A step of the state y, q and then p.  Returns 0 if "
                       "all is finite. */\n"
                       "static double take_step(double t, double h, double *y, "
                       "double *lost,\n                        double *unused) "
                       "");
    else
        nevh__write(w, "INLINE nevh__number take_step(const double *N, double "
                       "*W, double *T, size_t operations, double t, double h, "
                       "nevh__number *y, nevh__number *lost, nevh__number "
                       "*kept) ");
    nevh__write_filled(w, step_begins,
                       (const char *const[]){w->readable ? "" : "N, ", number});
    if (w->readable)
        nevh__write(w,
                    "    (void)unused;\n"
                    "    nevh__runge_kutta_take(&x, 0, 0, %zu);\n",
                    stages);
    else
        for (size_t i = 0; i < stages; i++)
            nevh__write(w, "    nevh__runge_kutta_take(&x, 0, %zu, %zu);\n", i,
                        i + 1);
    nevh__write_filled(w, step_ends, (const char *const[]){number});
}

bool nevh__write_runge_kutta(nevh__writer *w, nevh_work *work) {
    const nevh_butcher *table = work->integrator->table;
    size_t stages = stages_of(table);
    nevh__write_needs(w, work->n, false, true);
    if (!nevh__write_slopes(w, work->field, stages))
        return false;
    nevh__write_lines(w, nevh__stage_sums_text);
    nevh__write_lines(w, nevh__runge_kutta_step_text);
    write_tables(w, table);
    nevh__write(w, owner, w->readable ? "" : "    const double *N;\n");
    nevh__write_filled(w, slope,
                       (const char *const[]){w->readable ? "" : "o->N, "});
    write_step(w, stages);
    if (!w->readable)
        nevh__write(w, "enum { KEPT = 0 };\n"
                       "#define take_first(N, T, t, h, y, lost, kept) "
                       "((nevh__number){0})\n");
    nevh__write_driver(w);
    return true;
}

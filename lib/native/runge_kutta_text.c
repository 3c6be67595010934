/* nevh: steps of an explicit Runge-Kutta method as C text: that of the kernel,
   whose slopes are a scene's formulas, and the tables in digits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/runge_kutta_private.h"
#include "native/native_private.h"
#include "native/slope_private.h"

static size_t stages_of(const nevh_butcher *table) {
    return table->stages - table->last_is_first;
}

static void runge_kutta_text_write_tables(nevh__writer *w,
                                          const nevh_butcher *table,
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
    runge_kutta_text_write_tables(w, table, stages, adapts);
    if (work->friction) {
        nevh__write_form(w, "NEVH__FRICTION");
        nevh__write_array(w, "RATES", "o->N", work->n, work->friction);
    }
    nevh__write_stage_driver(w, work, nevh__runge_kutta_driver_text, stages);
    return true;
}

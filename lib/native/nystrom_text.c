/* nevh: steps of a Runge-Kutta-Nystroem method as C text: that of the kernel,
   whose slopes are a scene's formulas, and the tables in digits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/runge_kutta_private.h"
#include "native/native_private.h"

static void nystrom_text_write_tables(nevh__writer *w,
                                      const nevh_nystrom *table,
                                      const nevh__nystrom_kinetic *kinetic,
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
    nevh__write(w, "enum { DIAGONAL = %d, MOVES = %d };\n", kinetic->diagonal,
                kinetic->moves);
}

bool nevh__write_nystrom(nevh__writer *w, nevh_work *work) {
    const nevh_nystrom *table = work->integrator->table;
    nevh__nystrom_kinetic kinetic = nevh__nystrom_kinetic_of(work);
    bool adapts = nevh__adapts(work);
    if (w->width > 1) {
        w->refusal = "orbits stand side by side";
        return false;
    }
    nevh__write_needs(w, work->n, false, true);
    if (!nevh__write_slopes(w, work->field, table->stages))
        return false;
    nevh__write_lines(w, nevh__stage_sums_text);
    nevh__write_lines(w, nevh__nystrom_step_text);
    nystrom_text_write_tables(w, table, &kinetic, adapts);
    nevh__write_array(w, "AT_REST", "o->N", work->n, kinetic.rest);
    nevh__write_array(w, "INVERSE", "o->N", work->n, kinetic.inverse);
    nevh__write(w, "\n");
    nevh__write_stage_driver(w, work, nevh__nystrom_driver_text, table->stages);
    return true;
}

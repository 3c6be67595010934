/* nevh: steps of Verlet that vary as C text: that of the kernel, whose slopes are
   a scene's formulas.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/adaptive_verlet_private.h"
#include "native/native_private.h"
#include "work/transform_private.h"

bool nevh__write_adaptive_verlet(nevh__writer *w, nevh_work *work) {
    const nevh__step_control *table = work->integrator->table;
    double unit_p, unit_q = nevh__adaptive_verlet_units(work, &unit_p);
    char least[NEVH__NAME];
    w->own_time = w->readable;
    nevh__write_needs(w, work->n, false, false);
    if (!nevh__write_slopes(w, work->field, w->readable ? 1 : 4))
        return false;
    if (table->reversible)
        nevh__write_form(w, "NEVH__REVERSIBLE");
    nevh__number_text(NEVH__LEAST_RATE, least);
    nevh__write_constant(w, "UNIT_Q", unit_q);
    nevh__write_constant(w, "UNIT_P", unit_p);
    nevh__write(w, "static const double LEAST_RATE = %s;\n", least);
    nevh__elementary_call(w, NULL, "hypot");
    nevh__elementary_call(w, NULL, "pow");
    nevh__write_lines(w, nevh__adaptive_verlet_step_text);
    if (w->readable)
        nevh__write_lines(w, nevh__fraction_text);
    nevh__write_lines(w, nevh__adaptive_verlet_driver_text);
    return true;
}

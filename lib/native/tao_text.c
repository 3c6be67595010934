/* nevh: steps of Tao's schemes as C text: that of the kernel, whose slopes are a
   scene's formulas.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/tao_private.h"
#include "native/native_private.h"

bool nevh__write_tao(nevh__writer *w, nevh_work *work) {
    const nevh_splitting *table = work->integrator->table;
    const nevh__binding *binding = work->plan;
    nevh__write_needs(w, work->n, false, false);
    if (!nevh__write_slopes(w, work->field, w->readable ? 1 : 4))
        return false;
    nevh__write(w, "enum { PARTS = %zu };\n", 2 * table->count + 1);
    nevh__write_numbers(w, "static const double WEIGHTS",
                        table->count ? table->count : 1, binding->weights);
    nevh__write_array(w, "RATIOS", "N", work->n, binding->ratio);
    nevh__write_constant(w, "OMEGA", binding->omega);
    nevh__write(w, "\n");
    nevh__elementary_call(w, NULL, "sin");
    nevh__elementary_call(w, NULL, "cos");
    nevh__write_lines(w, nevh__tao_step_text);
    nevh__write_lines(w, nevh__tao_driver_text);
    nevh__write_driver(w, true, 0);
    return true;
}

/* nevh: steps by parts as C text: that of the kernel, whose slopes are a scene's
   formulas.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/parts_scheme_private.h"
#include "native/native_private.h"

bool nevh__write_parts(nevh__writer *w, nevh_work *work) {
    const nevh__parts_scheme *scheme = work->plan;
    if (w->readable) {
        w->refusal = "flows of parts are functions of the library";
        return false;
    }
    nevh__write_needs(w, work->n, true, false);
    if (!nevh__write_slopes(w, work->field, 2))
        return false;
    nevh__write(w, "enum { KEPT_ROWS = %zu };\n", scheme->kept);
    nevh__write_lines(w, nevh__parts_scheme_text);
    nevh__write_lines(w, nevh__parts_step_text);
    nevh__write_lines(w, nevh__parts_driver_text);
    nevh__write_driver(w, true, 7);
    return true;
}

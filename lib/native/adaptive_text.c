/* nevh: steps under a tolerance as C text: their control is the kernel's, around
   the trials of a family.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/runge_kutta_private.h"
#include "native/native_private.h"

static const char needs[] =
    "extern double fmin(double, double) CONST, fmax(double, double) CONST;\n"
    "extern double copysign(double, double) CONST;\n";

void nevh__write_adaptive(nevh__writer *w, const nevh_work *work,
                          const nevh__adaptive_rule *rule) {
    char power[NEVH__NAME];
    nevh__number_text(rule->power, power);
    nevh__write(w,
                "enum { KEEPS = %d, COARSE = %d };\n"
                "static const double POWER = %s;\n",
                rule->keeps, rule->coarse, power);
    nevh__write_constant(w, "TOLERANCE", rule->tolerance);
    nevh__write_constant(w, "FIRST_PART", rule->part);
    nevh__write_array(w, "SCALES", "N", 2 * work->n, work->scale);
    nevh__write(w, "%s", w->readable ? "" : needs);
    nevh__elementary_call(w, NULL, "log");
    nevh__elementary_call(w, NULL, "exp");
    nevh__elementary_call(w, NULL, "pow");
    nevh__write_lines(w, nevh__pace_text);
    nevh__write_lines(w, nevh__adaptive_step_text);
    nevh__write_lines(w, nevh__adaptive_driver_text);
    nevh__write_entry(w);
}

/* nevh: fixed steps of an explicit Runge-Kutta method as C text: what
   integrators/kernels/runge_kutta_kernel.c does, operation by operation, with
   gradients written into the stages.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/native_private.h"
#include "native/writer_private.h"
#include <stdio.h>
#include <stdlib.h>

/* More text than that is called instead of being repeated stage by stage. */
enum { MOST_REPEATED = 800 };

static size_t stages_of(const nevh_butcher *table) {
    return table->stages - table->last_is_first;
}

/* The sum of a table's row, times the slopes of the stages so far. */
static void write_sum(nevh__writer *w, size_t n, const double row[],
                      size_t count, size_t at, const char *half,
                      const char *to) {
    char line[4000];
    size_t used = (size_t)snprintf(line, sizeof line, "%s[$] = ", to);
    const char *plus = "";
    for (size_t j = 0; j < count && used < sizeof line - 100; j++)
        if (row[j] != 0) {
            used +=
                (size_t)snprintf(line + used, sizeof line - used,
                                 "%sW[%zu] * k%s%zu[$]", plus, at + j, half, j);
            plus = " + ";
        }
    snprintf(line + used, sizeof line - used, "%s;", *plus ? "" : "0.0");
    nevh__write_each(w, n, line);
}

static void write_stage(nevh__writer *w, size_t n, const nevh_butcher *table,
                        size_t i) {
    size_t s = table->stages;
    const char *N = w->readable ? "" : "N, ";
    nevh__write(w, "    double kq%zu[%zu], kp%zu[%zu];\n", i, n, i, n);
    write_sum(w, n, table->a + i * s, i, i * s, "q", "dq");
    write_sum(w, n, table->a + i * s, i, i * s, "p", "dp");
    nevh__write_each(w, n,
                     "yq[$] = q[$] + (dq[$] * h + lost_q[$]); yp[$] = p[$] + "
                     "(dp[$] * -h + lost_p[$]);");
    nevh__write(w,
                "    bad += kick_slope(%st + T[%zu] * h, yq, yp, kp%zu);\n"
                "    bad += drift_slope(%st + T[%zu] * h, yq, yp, kq%zu);\n",
                N, i, i, N, i, i);
}

static void write_commit(nevh__writer *w, size_t n, const nevh_butcher *table) {
    size_t s = table->stages, used = stages_of(table);
    write_sum(w, n, table->b, used, s * s, "q", "dq");
    write_sum(w, n, table->b, used, s * s, "p", "dp");
    nevh__write_each(w, n,
                     "dq[$] = dq[$] * h + lost_q[$]; dp[$] = dp[$] * -h + "
                     "lost_p[$]; yq[$] = q[$] + dq[$]; yp[$] = p[$] + dp[$]; "
                     "bad += (yq[$] - yq[$]) + (yp[$] - yp[$]);");
    nevh__write(w, "    if (bad != 0) break;\n");
    nevh__write_each(
        w, n,
        "lost_q[$] = nevh_roundoff(yq[$], q[$], dq[$]); lost_p[$] = "
        "nevh_roundoff(yp[$], p[$], dp[$]); q[$] = yq[$]; p[$] = yp[$];");
}

bool nevh__write_runge_kutta(nevh__writer *w, nevh_work *work) {
    const nevh_butcher *table = work->integrator->table;
    size_t n = work->n, stages = stages_of(table);
    bool repeats =
        nevh__slope_operations(work->field) * (double)stages < MOST_REPEATED;
    if (!repeats && !w->readable)
        nevh__write(w, "#undef SLOPE\n"
                       "#define SLOPE static __attribute__((noinline))\n");
    if (!nevh__write_slope(w, work->field, true, "kick_slope") ||
        !nevh__write_slope(w, work->field, false, "drift_slope"))
        return false;
    nevh__write_head(w, n);
    nevh__write(w, "    for (; done < steps; done++) {\n    double t = t0 + "
                   "(double)(from + done) * h, bad = 0; (void)t;\n");
    for (size_t i = 0; i < stages; i++)
        write_stage(w, n, table, i);
    write_commit(w, n, table);
    nevh__write(w, "    }\n");
    nevh__write_each(
        w, n, "Q[$] = q[$]; P[$] = p[$]; M[$] = lost_q[$]; Mp[$] = lost_p[$];");
    nevh__write(w, "    return done;\n}\n");
    return true;
}

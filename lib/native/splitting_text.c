/* nevh: steps of a splitting as C text: what
   integrators/kernels/splitting_kernel.c does, operation by operation, with
   gradients written into the step.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/splitting_private.h"
#include "native/native_private.h"
#include "native/writer_private.h"
#include <stdio.h>
#include <stdlib.h>

/* A kick, or else a drift; `at`: the operation's number. */
static void write_operation(nevh__writer *w, size_t n, const char *at,
                            bool kick, bool kept) {
    if (kept)
        nevh__write_each(w, n, "slope[$] = kept[$];");
    else
        nevh__write(w, "    bad += %s(%st + T[%s] * h, yq, yp, slope);\n",
                    kick ? "kick_slope" : "drift_slope",
                    w->readable ? "" : "N, ", at);
    nevh__write(w, "    { double step = %s(W[%s] * h);\n", kick ? "-" : "", at);
    nevh__write_each(w, n,
                     kick ? "dp[$] += step * slope[$]; yp[$] = p[$] + (dp[$] + "
                            "lost_p[$]);"
                          : "dq[$] += step * slope[$]; yq[$] = q[$] + (dq[$] + "
                            "lost_q[$]);");
    nevh__write(w, "    }\n");
}

/* Two by two: one text for all schemes that begin and end alike. */
static void write_operations(nevh__writer *w, size_t n, bool keeps,
                             bool kicks_first) {
    if (keeps)
        write_operation(w, n, "0", kicks_first, true);
    nevh__write(w, "    for (%s i = %d; i + 1 < operations; i += 2) {\n",
                w->readable ? "size_t" : "size", keeps);
    write_operation(w, n, "i", kicks_first != keeps, false);
    write_operation(w, n, "i + 1", kicks_first == keeps, false);
    nevh__write(w, "    }\n");
}

static void write_kept(nevh__writer *w, size_t n) {
    nevh__write(w, "    double kept[%zu];\n    double *Mk = Mp + %zu;\n", n, n);
    nevh__write_each(w, n, "kept[$] = Mk[$];");
}

static void write_begin(nevh__writer *w, size_t n) {
    nevh__write_each(w, n,
                     "dq[$] = 0; dp[$] = 0; yq[$] = q[$] + lost_q[$]; yp[$] = "
                     "p[$] + lost_p[$];");
}

/* Where no slope is kept, the first step takes its own. */
static void write_first_slope(nevh__writer *w, size_t n) {
    nevh__write(w,
                "    if (!Mk[%zu] && steps) {\n    double t = t0 + "
                "(double)from * h;\n",
                n);
    write_begin(w, n);
    nevh__write(w,
                "    if (first_slope(%st + T[0] * h, yq, yp, kept) != 0) "
                "return 0;\n    }\n",
                w->readable ? "" : "N, ");
}

static void write_commit(nevh__writer *w, size_t n, bool keeps) {
    nevh__write_each(w, n, "bad += (yq[$] - yq[$]) + (yp[$] - yp[$]);");
    nevh__write(w, "    if (bad != 0) break;\n");
    nevh__write_each(
        w, n,
        "{ double d = dq[$] + lost_q[$], e = dp[$] + lost_p[$]; lost_q[$] = "
        "nevh_roundoff(yq[$], q[$], d); lost_p[$] = nevh_roundoff(yp[$], p[$], e); "
        "q[$] = yq[$]; p[$] = yp[$]; }");
    if (keeps)
        nevh__write_each(w, n, "kept[$] = slope[$];");
}

static void write_store(nevh__writer *w, size_t n, bool keeps) {
    nevh__write_each(
        w, n, "Q[$] = q[$]; P[$] = p[$]; M[$] = lost_q[$]; Mp[$] = lost_p[$];");
    if (!keeps)
        return;
    nevh__write(w, "    if (done) {\n");
    nevh__write_each(w, n, "Mk[$] = kept[$];");
    nevh__write(w, "    Mk[%zu] = 1; }\n", n);
}

static void write_steps(nevh__writer *w, size_t n, bool keeps,
                        bool kicks_first) {
    if (keeps)
        nevh__write(w,
                    "%s double first_slope(%sdouble t, const double *q, const "
                    "double *p, double *slope) {\n    return %s(%st, q, p, "
                    "slope);\n}\n",
                    w->readable ? "static" : "static __attribute__((noinline))",
                    w->readable ? "" : "const double *N, ",
                    kicks_first ? "kick_slope" : "drift_slope",
                    w->readable ? "" : "N, ");
    nevh__write_head(w, n);
    nevh__write(w, "    double slope[%zu];\n", n);
    if (keeps)
        write_kept(w, n);
    if (keeps)
        write_first_slope(w, n);
    nevh__write(w, "    for (; done < steps; done++) {\n    double t = t0 + "
                   "(double)(from + done) * h, bad = 0; (void)t;\n");
    write_begin(w, n);
    write_operations(w, n, keeps, kicks_first);
    write_commit(w, n, keeps);
    nevh__write(w, "    }\n");
    write_store(w, n, keeps);
    nevh__write(w, "    return done;\n}\n");
}

bool nevh__write_splitting(nevh__writer *w, nevh_work *work) {
    const nevh_splitting *table = work->integrator->table;
    size_t count = nevh__splitting_operations(table);
    if (!nevh__write_slope(w, work->field, true, "kick_slope") ||
        !nevh__write_slope(w, work->field, false, "drift_slope"))
        return false;
    write_steps(w, work->n, count % 2 == 1, table->first == NEVH_KICK);
    return true;
}

void nevh__write_head(nevh__writer *w, size_t n) {
    static const char *const arrays[] = {"q",  "p",  "lost_q", "lost_p",
                                         "dq", "dp", "yq",     "yp"};
    if (w->readable)
        nevh__write(w,
                    "static size_t advance(double t0, double h, size_t from, "
                    "size_t steps, double *Q, double *P, double *M) {\n"
                    "    size_t done = 0;\n");
    else
        nevh__write(w,
                    "size nevh_native_steps(const double *restrict N, const "
                    "double *restrict W, const double *restrict T, size "
                    "operations, double t0, double h, size from, size steps, "
                    "double *restrict Q, double *restrict P, double *restrict "
                    "M) {\n    size done = 0;\n");
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        nevh__write(w, "    double %s[%zu];\n", arrays[i], n);
    nevh__write(w, "    double *Mp = M + %zu;\n", n);
    nevh__write_each(
        w, n, "q[$] = Q[$]; p[$] = P[$]; lost_q[$] = M[$]; lost_p[$] = Mp[$];");
}

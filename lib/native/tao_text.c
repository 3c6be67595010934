/* nevh: steps of Tao's schemes as C text: that of the kernel, whose slopes are a
   scene's formulas.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/tao_private.h"
#include "native/native_private.h"

static const char owner[] = "struct nevh__tao_owner {\n"
                            "$1    nevh__number *bad;\n};\n\n";

static const char slope[] =
    "NEVH__INLINE int nevh__tao_slope(const nevh__tao_step *z,\n"
    "                                 const nevh__tao_group *g, double t) {\n"
    "    const struct nevh__tao_owner *o = z->owner;\n"
    "    *o->bad += kick_slope($1t, g->q, g->p, g->dh_dq);\n"
    "    *o->bad += drift_slope($1t, g->q, g->p, g->dh_dp);\n"
    "    return 0;\n}\n\n";

static const char no_account[] =
    "NEVH__INLINE int nevh__tao_account(const nevh__tao_step *z, const "
    "nevh__tao_group *g, double h) { return 0; }\n";

/* The memory behind digits that sums have lost: the second copy less the first,
   and the gradient where the step begins. */
static const char first[] =
    "enum { KEPT = 4 * DOF };\n"
    "static __attribute__((noinline)) nevh__number take_first(const double *N, "
    "const double *T, double t, double h, const nevh__number *y, const "
    "nevh__number *lost, nevh__number *kept, nevh__number *room) {\n"
    "    nevh__number point[2 * DOF], bad;\n"
    "    NEVH__EACH(k, 1, DOF) {\n"
    "        point[k] = y[k] + lost[k];\n"
    "        point[DOF + k] = y[DOF + k] + (kept[DOF + k] + lost[DOF + k]);\n"
    "    }\n"
    "    bad = (nevh__number){0} +\n"
    "          kick_slope(N, t, point, point + DOF, kept + 2 * DOF);\n"
    "    bad += drift_slope(N, t, point, point + DOF, kept + 3 * DOF);\n"
    "    return bad;\n}\n";

static const char step_for_readers[] =
    "/* A step of the state y, q and then p.  Returns 0 if all is finite. */\n"
    "static double take_step(double t, double h, double *y, double *lost,\n"
    "                        double *kept) {\n"
    "    static double W[3 * PARTS + 1];\n";

static const char step[] =
    "    nevh__number moved[4 * DOF], points[4 * DOF], slopes[4 * DOF];\n"
    "    nevh__number bad = {0};\n"
    "    struct nevh__tao_owner owner = {$1&bad};\n"
    "    nevh__tao_step z = {\n"
    "        .size = DOF, .width = 1, .parts = PARTS, .lengths = W + 1,\n"
    "        .ratio = RATIOS, .start_q = y, .start_p = y + DOF,\n"
    "        .compensation = lost, .q = moved, .p = moved + DOF,\n"
    "        .x = moved + 2 * DOF, .y = moved + 3 * DOF,\n"
    "        .a = {points, points + DOF, slopes, slopes + DOF},\n"
    "        .b = {points + 2 * DOF, points + 3 * DOF, slopes + 2 * DOF,\n"
    "              slopes + 3 * DOF},\n"
    "        .owner = &owner};\n"
    "    if (W[0] != h)\n"
    "        nevh__tao_prepare(PARTS / 2, weights, OMEGA, h, W + 1);\n"
    "    W[0] = h;\n"
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        moved[k] = (nevh__number){0};\n"
    "        moved[2 * DOF + k] = kept[k];\n"
    "        slopes[k] = kept[2 * DOF + k];\n"
    "    }\n"
    "$2"
    "    nevh__tao_take(&z, t);\n"
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        nevh__number change = moved[k] + lost[k], next = y[k] + change;\n"
    "        bad += (next - next) + (moved[2 * DOF + k] - moved[2 * DOF + k]);\n"
    "        lost[k] = nevh__roundoff(next, y[k], change);\n"
    "        y[k] = next;\n"
    "    }\n"
    "$3"
    "    return bad;\n}\n\n";
static const char keeping[] = "    NEVH__EACH(k, 1, 2 * DOF) {\n"
                              "        kept[k] = moved[2 * DOF + k];\n"
                              "        kept[2 * DOF + k] = slopes[k];\n"
                              "    }\n";
static const char first_for_readers[] =
    "    if (kept[4 * DOF] == 0) {\n"
    "        nevh__tao_place(&z, &z.a, z.q, z.y);\n"
    "        nevh__tao_slope(&z, &z.a, t);\n"
    "    }\n";
static const char keeping_for_readers[] =
    "    if (bad != 0)\n"
    "        return bad;\n"
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        kept[k] = moved[2 * DOF + k];\n"
    "        kept[2 * DOF + k] = slopes[k];\n"
    "    }\n"
    "    kept[4 * DOF] = 1;\n";

static void write_step(nevh__writer *w, const nevh_work *work) {
    const nevh__binding *binding = work->plan;
    bool plain = w->readable;
    nevh__write_array(w, "RATIOS", "N", work->n, binding->ratio);
    nevh__write_constant(w, "OMEGA", binding->omega);
    if (plain)
        nevh__write(w, "\n%s", step_for_readers);
    else {
        nevh__write(w, "%s", first);
        nevh__write_step_head(w);
        nevh__write(w, "{\n");
    }
    nevh__write_filled(w, step,
                       (const char *const[]){
                           plain ? "" : "N, ", plain ? first_for_readers : "",
                           plain ? keeping_for_readers : keeping});
}

bool nevh__write_tao(nevh__writer *w, nevh_work *work) {
    const nevh_splitting *table = work->integrator->table;
    const nevh__binding *binding = work->plan;
    bool plain = w->readable;
    nevh__write_needs(w, work->n, false, false);
    if (!nevh__write_slopes(w, work->field, plain ? 1 : 4))
        return false;
    nevh__write(w, "enum { PARTS = %zu };\n", 2 * table->count + 1);
    nevh__write_numbers(w, "static const double weights",
                        table->count ? table->count : 1, binding->weights);
    nevh__write(w, "\n");
    nevh__write_lines(w, nevh__tao_step_text);
    nevh__write(w, "%s", plain ? "" : no_account);
    nevh__write_filled(
        w, owner, (const char *const[]){plain ? "" : "    const double *N;\n"});
    nevh__write_filled(w, slope, (const char *const[]){plain ? "" : "o->N, "});
    write_step(w, work);
    nevh__write_driver(w, true);
    return true;
}

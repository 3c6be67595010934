/* nevh: steps of a splitting as C text: that of the kernel, whose slopes are a
   scene's formulas.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/splitting_private.h"
#include "native/native_private.h"
#include "native/slope_private.h"
#include <stdio.h>
#include <stdlib.h>

/* Vectors of a part of a state that is long; all that a step has of them are in
   the nearest cache. */
enum { PART = 32 };

static const char slope[] =
    "NEVH__INLINE int nevh__splitting_slope(const nevh__splitting_step *x, int "
    "way,\n"
    "                                       size_t i, bool kick, bool kept) {\n"
    "    double t = x->t + x->scheme->times[i] * x->h;\n"
    "    (void)way;\n"
    "    if (!kept)\n"
    "$2"
    "        *x->owner->bad += kick ? kick_slope($1t, x->q.point$3,\n"
    "                                            x->p.point$3, x->slope$3)\n"
    "                               : drift_slope($1t, x->q.point$3,\n"
    "                                             x->p.point$3, x->slope$3);\n"
    "    return 0;\n}\n\n";

static const char inverse[] =
    "NEVH__INLINE const nevh__number *\n"
    "nevh__splitting_inverse(const nevh__splitting_step *x, int way) {\n"
    "    (void)x, (void)way;\n"
    "    return NULL;\n}\n\n";

static const char first[] =
    "static __attribute__((noinline)) nevh__number take_first(const double *N, "
    "const double *T, double t, double h, const nevh__number *y, const "
    "nevh__number *lost, nevh__number *kept, nevh__number *room) {\n";
static const char first_ends[] =
    "    nevh__number bad = {0};\n"
    "    NEVH__EACH(k, 1, 2 * DOF) point[k] = y[k] + lost[k];\n"
    "    for (size_t i = 0; i < DOF; i += ONE)\n"
    "        bad += %s(N, t + T[0] * h, point + i, point + DOF + i, kept + i%s);\n"
    "    return bad;\n}\n";
static const char no_first[] =
    "#define take_first(N, T, t, h, y, lost, kept, room) "
    "((nevh__number){0})\n";

/* The state's check of finite numbers is that of all lanes. */
static const char step[] =
    "    nevh__number bad = {0};\n"
    "    struct nevh__splitting_owner owner = {N, &bad};\n"
    "    nevh__splitting_scheme scheme = {operations, W, T, $1, $2};\n"
    "    nevh__splitting_step x = {t, h, &scheme, $2,\n"
    "        {y, lost, change, point},\n"
    "        {y + DOF, lost + DOF, change + DOF, point + DOF},\n"
    "        slope, kept, &owner};\n"
    "    nevh__splitting_take(&x, 0, 1, DOF);\n"
    "    NEVH__EACH(k, 1, 2 * DOF) bad += point[k] - point[k];\n"
    "    return bad;\n}\n";

/* States that are too long for the caches are taken part after part, all operations
   on one before the next.  A part of a slope is taken once all points that it reads
   are there, and points are moved once all slopes have been taken that read them:
   each operation lags behind the one before. */
static const char slope_of_part[] =
    "NEVH__INLINE int nevh__splitting_slope(const nevh__splitting_step *x, int "
    "way,\n"
    "                                       size_t i, bool kick, bool kept) {\n"
    "    const struct nevh__splitting_owner *o = x->owner;\n"
    "    double t = x->t + x->scheme->times[i] * x->h;\n"
    "    const wide *q = x->q.point - o->first, *p = x->p.point - o->first;\n"
    "    wide *slope = x->slope - o->first;\n"
    "    if (!kept)\n"
    "        *o->bad += (kick ? kick_slope : drift_slope)(\n"
    "            o->N, t, q, p, slope, 8 * o->first, 8 * (o->first + o->size));\n"
    "    return 0;\n}\n\n";
/* A step's arrays but for the state hold the parts that are in work, and are moved
   to the front where their space ends. */
static const char step_of_parts[] =
    "    wide bad = {0};\n"
    "    nevh__splitting_scheme scheme = {operations, W, T, $1, $2};\n"
    "    size_t origin = 0;\n"
    "    for (size_t round = 0; round < PARTS + lags[$3 - 1]; round++) {\n"
    "        if (round < PARTS && round * PART == origin + WINDOW) {\n"
    "            size_t next = (round - IN_WORK) * PART;\n"
    "            move_all(change, next - origin, 2);\n"
    "            move_all(point, next - origin, 2);\n"
    "            move_all(slope, next - origin, 1);\n"
    "            origin = next;\n"
    "        }\n"
    "        for (size_t i = 0; i <= $3; i++) {\n"
    "            size_t part = i ? round - lags[i - 1] : round;\n"
    "            if (part >= PARTS) continue;\n"
    "            size_t at = part * PART, here = at - origin;\n"
    "            size_t size = DOF - at < PART ? DOF - at : PART;\n"
    "            struct nevh__splitting_owner owner = {N, &bad, at, size};\n"
    "            nevh__splitting_step x = {t, h, &scheme, $2,\n"
    "                {y + at, lost + at, change + here, point + here},\n"
    "                {y + DOF + at, lost + DOF + at, change + WINDOW + here,\n"
    "                 point + WINDOW + here},\n"
    "                slope + here, kept + at, &owner};\n"
    "            if (i == 0) nevh__splitting_place(&x, 1, size);\n"
    "            else operate(&x, size, i - 1, $1 == (i % 2 == 1), $2 && i == "
    "1);\n"
    "            if (i < $3) continue;\n"
    "            NEVH__EACH(k, 1, size) bad += (x.q.point[k] - x.q.point[k]) +\n"
    "                                          (x.p.point[k] - x.p.point[k]);\n"
    "            nevh__splitting_commit_all(&x, 1, size, $2);\n"
    "        }\n"
    "    }\n"
    "    return bad;\n}\n";
static const char moving[] =
    "INLINE void move_all(wide *x, size_t by, int rows) {\n"
    "    for (; rows > 0; rows--, x += WINDOW)\n"
    "        __builtin_memmove(x, x + by, (WINDOW - by) * sizeof *x);\n}\n";
static const char operate_on_part[] =
    "static __attribute__((noinline)) void operate(const nevh__splitting_step "
    "*x, size_t size, size_t i, bool kick, bool kept) {\n"
    "    if (kept) nevh__splitting_operate(x, 0, 1, size, i, $1, true);\n"
    "    else if (kick) nevh__splitting_operate(x, 0, 1, size, i, true, "
    "false);\n"
    "    else nevh__splitting_operate(x, 0, 1, size, i, false, false);\n}\n";

static const char step_for_readers[] =
    "/* A step of the state y, q and then p.  Returns 0 if all is finite. */\n"
    "static double take_step(double t, double h, double *y, double *lost,\n"
    "                        double *kept) {\n";
static const char step_of_readers[] =
    "    static const nevh__splitting_scheme scheme = {$3, W, T, $1, "
    "$2};\n"
    "    double bad = 0;\n"
    "    struct nevh__splitting_owner owner = {&bad};\n"
    "    nevh__splitting_step x = {\n"
    "        t, h, &scheme, $2 && kept[DOF] != 0,\n"
    "        {y, lost, change, point},\n"
    "        {y + DOF, lost + DOF, change + DOF, point + DOF},\n"
    "        slope, kept, &owner};\n"
    "    if (nevh__splitting_take(&x, 0, 1, DOF) != 0)\n"
    "        return 1;\n"
    "$4"
    "    return bad;\n}\n\n";

static const char owner[] = "struct nevh__splitting_owner {\n"
                            "%s    nevh__number *bad;\n%s};\n\n";

/* A kick takes dH/dq at the drifts' time, a drift dH/dp at the kicks'. */
bool nevh__splitting_tables(const nevh_splitting *table, double **weights,
                            double **times) {
    size_t count = nevh__splitting_operations(table);
    double passed[2] = {0, 0};
    *weights = nevh__array(count, sizeof **weights);
    *times = nevh__array(count, sizeof **times);
    if (!*weights || !*times)
        return false;
    nevh__splitting_expand(table, *weights);
    for (size_t i = 0; i < count; i++) {
        (*times)[i] = passed[1 - i % 2];
        passed[i % 2] += (*weights)[i];
    }
    return true;
}

static void write_tables(nevh__writer *w, const nevh_splitting *table) {
    size_t count = nevh__splitting_operations(table);
    double *weights, *times;
    if (nevh__splitting_tables(table, &weights, &times)) {
        nevh__write(w, "/* Weights, and times as parts of a step. */\n");
        nevh__write_numbers(w, "static double W", count, weights);
        nevh__write_numbers(w, "static double T", count, times);
        nevh__write(w, "\n");
    } else
        w->failed = true;
    free(weights);
    free(times);
}

/* Writes by how many parts each operation lags. */
static void write_lags(nevh__writer *w, nevh_work *work, bool kicks_first,
                       bool keeps, size_t count) {
    size_t kick = nevh__slope_reach(w, work->field, true);
    size_t drift = nevh__slope_reach(w, work->field, false);
    size_t most = PART * NEVH__LANES, all = nevh__padded(work->n) / NEVH__LANES;
    bool local = kick <= most && drift <= most, before = false;
    size_t part = local ? PART : all, lag = 0;
    nevh__write(w, "enum { PART = %zu, PARTS = %zu };\n", part,
                (all + part - 1) / part);
    nevh__write(w, "static const size_t lags[] = {");
    for (size_t i = 0; i < count; i++) {
        bool kicks = kicks_first == (i % 2 == 0);
        bool reaches = (kicks ? kick : drift) > 0 && !(keeps && i == 0);
        lag += local && (reaches || before);
        before = reaches;
        nevh__write(w, "%zu, ", lag);
    }
    nevh__write(w, "};\n");
    /* A part before those that lag is read, too. */
    size_t work_in = lag + 2, window = 5 * work_in * part;
    nevh__write(w, "enum { IN_WORK = %zu, WINDOW = %zu };\n%s", work_in,
                window < all ? window : all, moving);
}

static void write_first(nevh__writer *w, bool keeps, bool kicks) {
    nevh__write(w, "%senum { KEPT = %s };\n", inverse, keeps ? "DOF" : "0");
    if (!keeps) {
        nevh__write(w, "%s", no_first);
        return;
    }
    nevh__write(w, "%s", first);
    nevh__write_rows(w, "point", 2);
    nevh__write(w, first_ends, kicks ? "kick_slope" : "drift_slope",
                w->loops ? NEVH__ALL_SLOPES : "");
}

static void write_step(nevh__writer *w, const char *const words[]) {
    if (w->readable)
        nevh__write(w, "%s", step_for_readers);
    else {
        nevh__write_step_head(w);
        nevh__write(w, "{\n");
    }
    nevh__write_rows(w, "change", 2);
    nevh__write_rows(w, "point", 2);
    nevh__write_rows(w, "slope", 1);
    nevh__write_filled(w,
                       w->readable ? step_of_readers
                       : w->loops  ? step_of_parts
                                   : step,
                       words);
}

static bool keeps_slope(const nevh_splitting *table) {
    return nevh__splitting_operations(table) % 2 == 1;
}

static void write_parts(nevh__writer *w, nevh_work *work,
                        const char *const words[]) {
    const nevh_splitting *table = work->integrator->table;
    bool keeps = keeps_slope(table), kicks = table->first == NEVH_KICK;
    nevh__write(w, owner, "    const double *N;\n",
                "    size_t first, size;\n");
    nevh__write(w, "%s", slope_of_part);
    write_first(w, keeps, kicks);
    write_lags(w, work, kicks, keeps, nevh__splitting_operations(table));
    nevh__write_filled(w, operate_on_part, words);
    write_step(w, words);
}

static void write_whole(nevh__writer *w, const nevh_splitting *table,
                        const char *const words[]) {
    nevh__write(w, owner, w->readable ? "" : "    const double *N;\n", "");
    nevh__write_filled(
        w, slope,
        (const char *const[]){
            w->readable ? "" : "x->owner->N, ",
            w->readable ? "" : "    for (size_t k = 0; k < DOF; k += ONE)\n",
            w->readable ? "" : " + k"});
    if (!w->readable)
        write_first(w, keeps_slope(table), table->first == NEVH_KICK);
    write_step(w, words);
}

bool nevh__write_splitting(nevh__writer *w, nevh_work *work) {
    const nevh_splitting *table = work->integrator->table;
    size_t count = nevh__splitting_operations(table);
    bool keeps = count % 2 == 1, kicks = table->first == NEVH_KICK;
    char number[24];
    snprintf(number, sizeof number, "%zu", count);
    const char *keep = keeps ? "true" : "false",
               *kick = kicks ? "true" : "false";
    w->group = nevh__vectors_at_once(w, work->field, keeps ? count - 1 : count);
    nevh__write_needs(w, work->n, true, false);
    if (!nevh__write_slopes(w, work->field, 2))
        return false;
    if (w->readable)
        write_tables(w, table);
    nevh__write_lines(w, nevh__splitting_step_text);
    const char *const words[] = {kick, keep, number,
                                 keeps ? "    kept[DOF] = 1;\n" : ""};
    if (w->loops && !w->readable && nevh__write_splitting_groups(w, work))
        write_first(w, keeps, kicks);
    else if (w->loops && !w->readable)
        write_parts(w, work, words);
    else
        write_whole(w, table, words);
    nevh__write_driver(w, true);
    return true;
}

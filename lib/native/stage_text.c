/* nevh: steps of Gauss-Legendre methods and Lobatto pairs as C text: sweeps are
   the kernel's, whose slopes are a scene's formulas at all stages side by side.

   Where fixed-point iteration does not get on, or anything is not finite, a
   step is left to the kernel, which begins it anew.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/stage_sweeps_private.h"
#include "native/native_private.h"
#include <stdio.h>

/* The memory of the kernel, behind digits that sums have lost: slopes that the
   last PAST steps solved for, their h, of how many steps they are, and for how
   many steps Newton's iteration is to go first. */
static const char sizes[] =
    "enum { STAGES = %zu, ROW = %zu, FIRST = %zu, UNKNOWN = 2 * DOF - FIRST,\n"
    "       PAST = %zu, KEPT_STAGES = PAST * STAGES, SLOPES_AT = 2 * DOF,\n"
    "       H_AT = SLOPES_AT + UNKNOWN * KEPT_STAGES, STEPS_AT, HOLD_AT,\n"
    "       SWEEPS_AT, APART = %zu, STRIDE = %zu,\n"
    "       FEW = STAGES == ROW ? %d : 0 };\n"
    "#define PARTITIONED %s\n#define NOISY %s\n#define NEWTON %s\n";

static const char owners[] =
    "struct nevh__stage_owner {\n"
    "    const double $1*times;\n    nevh__vector *bad;\n};\n"
    "struct nevh__stage_judge_owner {\n"
    "    const double $1*y, *scale;\n    double t, h, *level, *bad;\n"
    "    size_t *noises;\n};\n\n";

/* Those of vectors of stages, or of orbits. */
static const char slopes[] =
    "/* dH/dp, dH/dq or both at the points of all stages. */\n"
    "NEVH__INLINE int nevh__stage_slopes(const nevh__stage_step *x, bool q,\n"
    "                                    bool p) {\n"
    "    const struct nevh__stage_owner *o = x->owner;\n"
    "    for (size_t from = 0; from < STRIDE; from += NEVH__LANES) {\n"
    "        nevh__vector y[2 * DOF], slope[DOF];\n"
    "        nevh__vector t = NEVH__VECTOR_AT(o->times + from);\n"
    "        double *to = x->gradient + from;\n"
    "        NEVH__EACH(k, 1, DOF) {\n"
    "            const double *at = x->points + k * STRIDE + from;\n"
    "            y[k] = NEVH__VECTOR_AT(at);\n"
    "            y[DOF + k] = NEVH__VECTOR_AT(at + x->half);\n"
    "        }\n"
    "        if (p) {\n"
    "            *o->bad += drift_slope($1t, y, y + DOF, slope);\n"
    "            NEVH__EACH(k, 1, DOF)\n"
    "                NEVH__VECTOR_AT(to + k * STRIDE) = slope[k];\n"
    "        }\n"
    "        if (q) {\n"
    "            *o->bad += kick_slope($1t, y, y + DOF, slope);\n"
    "            NEVH__EACH(k, 1, DOF)\n"
    "                NEVH__VECTOR_AT(to + (DOF + k) * STRIDE) = slope[k];\n"
    "        }\n"
    "    }\n"
    "    return 0;\n}\n\n";
static const char inverse[] =
    "NEVH__INLINE const double *nevh__stage_inverse(const nevh__stage_step *x) "
    "{\n    return NULL;\n}\n";

/* The level is taken once a step. */
static const char noise_level[] =
    "/* What noise of differences makes of a step, in units of scale. */\n"
    "NEVH__INLINE double nevh__stage_noise_level(const nevh__stage_judged *x) "
    "{\n"
    "    const struct nevh__stage_judge_owner *o = x->owner;\n"
    "    if (*o->level < 0) {\n"
    "        double y[2 * DOF], scale[2 * DOF];\n"
    "        NEVH__EACH(k, 1, 2 * DOF) {\n"
    "            y[k] = o->y[k * APART];\n"
    "            scale[k] = o->scale[k * APART];\n"
    "        }\n"
    "        *o->level =\n"
    "            fabs(o->h) * worst_noise($1o->t, y, scale, o->bad);\n"
    "    }\n"
    "    ++*o->noises;\n"
    "    return *o->level;\n}\n\n";
static const char no_noise[] =
    "NEVH__INLINE double nevh__stage_noise_level(const nevh__stage_judged *x) "
    "{\n    (void)x;\n    return 0;\n}\n\n";
static const char is_small[] =
    "NEVH__INLINE bool nevh__stage_is_small(const nevh__stage_judged *x,\n"
    "                                       double change) {\n"
    "    return change <= NEVH__STAGE_TINY ||\n"
    "           (change < INFINITY &&\n"
    "            change <= NEVH__STAGE_TINY +\n"
    "                          NEVH__STAGE_MARGIN *\n"
    "                              nevh__stage_noise_level(x));\n}\n\n";

static const char step_weights[] =
    "/* h b_j and -h b_j. */\n"
    "typedef struct {\n"
    "    double plus[STAGES], minus[STAGES];\n"
    "    double to_q[STAGES * NEVH__LANES], to_p[STAGES * NEVH__LANES];\n"
    "} step_weights;\n\n";

static const char addition[] =
    "/* The new state from the slopes, which the next step continues. */\n"
    "NEVH__INLINE bool add_step(const step_weights *w, const double *gradient,\n"
    "                           double first_change, double *y, double *M,\n"
    "                           double h) {\n"
    "    double sum[2 * DOF], lost[2 * DOF], check = 0;\n"
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        sum[k] = y[k];\n"
    "        lost[k] = M[k];\n"
    "        nevh__stage_advance(STAGES, order, k < DOF ? w->plus : w->minus,\n"
    "                            1, 1, gradient + k * ROW, &sum[k], &lost[k]);\n"
    "        check += sum[k] - sum[k];\n"
    "    }\n"
    "    if (check != 0)\n        return false;\n"
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        y[k] = sum[k];\n"
    "        M[k] = lost[k];\n"
    "    }\n"
    "    for (size_t k = 0; k < UNKNOWN; k++) {\n"
    "        double older[KEPT_STAGES], *kept = M + SLOPES_AT + k * KEPT_STAGES;\n"
    "        for (size_t i = STAGES; i < KEPT_STAGES; i++)\n"
    "            older[i] = kept[i - STAGES];\n"
    "        NEVH__EACH(i, 1, STAGES) {\n"
    "            double slope = gradient[(FIRST + k) * ROW + i];\n"
    "            kept[i] = FIRST + k < DOF ? slope : -slope;\n"
    "        }\n"
    "        for (size_t i = STAGES; i < KEPT_STAGES; i++)\n"
    "            kept[i] = older[i];\n"
    "    }\n"
    "    M[STEPS_AT] = nevh__stage_remember(M[H_AT] == h ? M[STEPS_AT] : 0, "
    "PAST,\n"
    "                                       first_change);\n"
    "    M[H_AT] = h;\n"
    "    return true;\n}\n\n";

static const char step[] =
    "/* Sweeps until the slopes are those at the points that they lead to, but\n"
    "   for rounding; false: they do not get there, and nothing has changed. */\n"
    "NEVH__INLINE bool take_step($1const step_weights *w, double t, double h,\n"
    "                            double *Q, double *P, double *M$2) {\n"
    "    double y[2 * DOF];\n"
    "    double points[2 * DOF * ROW], gradient[2 * DOF * ROW], times[ROW];\n"
    "    double before[UNKNOWN * ROW], least[UNKNOWN * ROW];\n"
    "    double unit[2 * DOF], scale[2 * DOF];\n"
    "    double lowest = INFINITY, level = -1, unknown = 0;\n"
    "    nevh__vector bad = {0};\n"
    "    size_t sweeps = 0, noises = 0;\n"
    "    struct nevh__stage_owner owner = {$3times, &bad};\n"
    "    struct nevh__stage_judge_owner judge_owner = {\n"
    "        $3y, scale, t, h, &level, &unknown, &noises};\n"
    "    nevh__stage_step x = {\n"
    "        .n = DOF, .stages = STAGES, .row = ROW, .stride = ROW,\n"
    "        .half = DOF * ROW, .partitioned = PARTITIONED,\n"
    "        .unchecked = true, .mu_q = mu_q, .mu_p = mu_p,\n"
    "        .to_q = w->to_q, .to_p = w->to_p, .q = y, .p = y + DOF,\n"
    "        .compensation = M, .points = points, .gradient = gradient,\n"
    "        .owner = &owner};\n"
    "    nevh__stage_changes changes = {FIRST, UNKNOWN, unit, before, least,\n"
    "                                   &lowest};\n"
    "    nevh__stage_judged judged = {0, true, NOISY, NEWTON,\n"
    "                                 UNKNOWN * STAGES, &judge_owner};\n"
    "    nevh__stage_lane lane;\n"
    "    nevh__stage_progress made;\n"
    "    nevh__stage_state state = NEVH__GO_ON;\n"
    "    if (M[HOLD_AT] > 0)\n        return false;\n"
    "    NEVH__EACH(k, 1, 2 * DOF) {\n"
    "        double size, most = $4[k];\n"
    "        y[k] = k < DOF ? Q[k] : P[k - DOF];\n"
    "        size = fabs(y[k]);\n"
    "        scale[k] = size > most ? size : most;\n"
    "        unit[k] = fabs(h) / scale[k];\n"
    "    }\n"
    "    NEVH_LANES(i, ROW) {\n        times[i] = t + nodes[i] * h;\n    }\n"
    "    nevh__stage_forget(&lane);\n"
    "    if (M[H_AT] == h && M[STEPS_AT] >= PAST)\n"
    "        nevh__stage_begin_sweeps(&x, &changes, NEVH__STAGES_TOGETHER,\n"
    "                                 long_guess, KEPT_STAGES, M + SLOPES_AT,\n"
    "                                 KEPT_STAGES);\n"
    "    else\n"
    "        nevh__stage_begin_sweeps(&x, &changes, NEVH__STAGES_TOGETHER, "
    "guess,\n"
    "                                 M[H_AT] == h && M[STEPS_AT] > 0 ? STAGES : "
    "0,\n"
    "                                 M + SLOPES_AT, KEPT_STAGES);\n"
    "    while (state == NEVH__GO_ON && sweeps < NEVH__STAGE_SWEEPS) {\n"
    "        if (nevh__stage_map(&x, NEVH__STAGES_TOGETHER))\n"
    "            return false;\n"
    "        nevh__stage_compare_sweep(&x, &changes, NEVH__STAGES_TOGETHER,\n"
    "                                  &made);\n"
    "        if (!(made.change < INFINITY))\n            return false;\n"
    "        state = nevh__stage_judge_fixed_point(&judged, &lane, &made);\n"
    "        sweeps++;\n"
    "    }\n"
    "    if (state != NEVH__DONE || is_bad(bad) || unknown != 0 ||\n"
    "        !add_step(w, gradient, lane.first, y, M, h))\n"
    "        return false;\n"
    "    NEVH__EACH(k, 1, DOF) {\n"
    "        Q[k] = y[k];\n        P[k] = y[DOF + k];\n    }\n"
    "$5"
    "    return true;\n}\n\n";
static const char counts[] = "    counted[0] += sweeps;\n"
                             "    counted[1] += noises;\n"
                             "    counted[2] += sweeps;\n";
static const char counts_for_readers[] =
    "    M[SWEEPS_AT] += (double)sweeps;\n";

static const char driver[] =
    "    step_weights w;\n"
    "    size_t done = 0;\n"
    "    nevh__stage_split(STAGES, weights, h, w.plus);\n"
    "    for (size_t j = 0; j < STAGES; j++) {\n"
    "        w.minus[j] = -w.plus[j];\n"
    "        NEVH_LANES(i, NEVH__LANES) {\n"
    "            w.to_q[j * NEVH__LANES + i] = w.plus[j];\n"
    "            w.to_p[j * NEVH__LANES + i] = w.minus[j];\n"
    "        }\n"
    "    }\n"
    "    while (done < steps &&\n"
    "           take_step($1&w, t0 + (double)(from + done) * h, h, Q, P, M$2))\n"
    "        done++;\n"
    "    return done;\n}\n";

static void write_tables(nevh__writer *w, const nevh__tableau *a,
                         const nevh__stage_weights *padded) {
    size_t matrix = padded->stages * padded->row;
    nevh__write(w,
                "/* mu_ij = a_ij / b_j, column by column, by which slopes "
                "lead to the states of\n   stages; what continues the slopes "
                "of the last step, and of PAST steps; nodes c_i;\n   weights "
                "b_j, and their order by size. */\n");
    nevh__write_numbers(w, "static const double mu_q", matrix, padded->mu_q);
    nevh__write_numbers(w, "static const double mu_p", matrix, padded->mu_p);
    nevh__write_numbers(w, "static const double guess", matrix, padded->guess);
    nevh__write_numbers(w, "static const double long_guess",
                        padded->steps * matrix, padded->long_guess);
    nevh__write_numbers(w, "static const double nodes", padded->row, padded->c);
    nevh__write_numbers(w, "static const double weights", a->stages, a->b);
    nevh__write(w, "static const size_t order[] = {");
    for (size_t i = 0; i < a->stages; i++)
        nevh__write(w, "%s%zu", i ? ", " : "", a->order[i]);
    nevh__write(w, "};\n\n");
}

static void write_sizes(nevh__writer *w, const nevh_work *work,
                        const nevh__stage_weights *padded) {
    bool partitioned = nevh__stages_are_partitioned(work);
    bool noisy = work->field->gradient->offsets, one = w->width == 1;
    bool newton = nevh__stages_have_newton(work, padded->stages);
    nevh__write(w, sizes, padded->stages, padded->row,
                partitioned ? work->n : 0, padded->steps,
                one ? (size_t)1 : (size_t)NEVH__LANES,
                one ? padded->row : padded->stages * NEVH__LANES,
                NEVH__FEW_TOGETHER, partitioned ? "true" : "false",
                noisy ? "true" : "false", newton ? "true" : "false");
}

static void write_one_orbit(nevh__writer *w, const char *scales) {
    bool plain = w->readable;
    nevh__write(w, "%s", addition);
    nevh__write_filled(w, step,
                       (const char *const[]){
                           plain ? "" : "const double *N, ",
                           plain ? "" : ", size_t *counted", plain ? "" : "N, ",
                           scales, plain ? counts_for_readers : counts});
}

/* Vectors of lanes, one after the other. */
static void write_lane_scales(nevh__writer *w, const nevh_field *f,
                              char scales[NEVH__NAME]) {
    char name[NEVH__NAME];
    snprintf(scales, NEVH__NAME, "(N + %zu)", w->count);
    for (size_t k = 0; k < 2 * f->n; k++)
        nevh__write_own(w, f->lane_scale + k * f->lanes, 1, name);
}

static void write_step(nevh__writer *w, const nevh_work *work,
                       const nevh__tableau *a,
                       const nevh__stage_weights *padded) {
    char scales[NEVH__NAME];
    const char *const parameter[] = {w->readable ? "" : "*N, "};
    const char *const argument[] = {w->readable ? "" : "o->N, "};
    write_sizes(w, work, padded);
    write_tables(w, a, padded);
    nevh__write_lines(w, nevh__stage_progress_text);
    nevh__write_lines(w, nevh__stage_judge_text);
    nevh__write_lines(w, nevh__stage_step_text);
    if (w->by_lane)
        write_lane_scales(w, work->field, scales);
    else
        nevh__write_array(w, "scales", "N", 2 * work->n, work->scale, scales);
    nevh__write_filled(w, owners, parameter);
    nevh__write_filled(w, slopes, argument);
    nevh__write(w, "%s", w->readable ? "" : inverse);
    if (work->field->gradient->offsets) {
        nevh__write_noise(w, work->field);
        nevh__write_filled(w, noise_level, argument);
    } else
        nevh__write(w, "%s", no_noise);
    nevh__write(w, "%s%s", is_small, step_weights);
    if (w->width == 1)
        write_one_orbit(w, scales);
    else
        nevh__write_stage_lanes(w, scales);
    nevh__write_driver_head(w);
    nevh__write_filled(w, driver,
                       (const char *const[]){w->readable ? "" : "N, ",
                                             w->readable ? "" : ", counted"});
}

/* Readers have stages one after the other, and rows that are not padded. */
static void write_plain(nevh__writer *w, const nevh_work *work,
                        const nevh__tableau *a) {
    const nevh__stage_weights plain = {.stages = a->stages,
                                       .row = a->stages,
                                       .steps = a->steps,
                                       .mu_q = a->mu_q,
                                       .mu_p = a->mu_p,
                                       .guess = a->guess,
                                       .long_guess = a->long_guess,
                                       .c = a->c};
    write_step(w, work, a, &plain);
}

static void write_padded(nevh__writer *w, const nevh_work *work,
                         const nevh__tableau *a) {
    nevh__stage_weights *padded = nevh__stage_weights_new(a);
    if (padded)
        write_step(w, work, a, padded);
    w->failed |= !padded;
    nevh__stage_weights_free(padded);
}

bool nevh__write_stages(nevh__writer *w, nevh_work *work) {
    w->stages = true;
    nevh__write_needs(w, work->n, false, false);
    if (!nevh__write_slopes(w, work->field, 1))
        return false;
    nevh__tableau *a = nevh__stage_tableau_new(work->integrator);
    w->failed |= !a;
    if (a)
        (w->readable ? write_plain : write_padded)(w, work, a);
    nevh__tableau_free(a);
    return !w->failed && !w->refusal;
}

/* nevh: steps of Gauss-Legendre methods and Lobatto pairs as C text: sweeps are
   the kernel's, whose slopes are a scene's formulas at all stages side by side.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/stage_sweeps_private.h"
#include "native/native_private.h"

/* APART, SCALES_APART: from a number of an orbit's state, or scale, to the next. */
static const char sizes[] =
    "enum { STAGES = %zu, ROW = %zu, FIRST = %zu, PAST = %zu, APART = %zu,\n"
    "       SCALES_APART = %zu, STRIDE = %zu, FEW = STAGES == ROW ? %d : 0,\n"
    "       PARTITIONED = %d, NOISY = %d, NEWTON = %d };\n";

static void stage_text_write_tables(nevh__writer *w, const nevh__tableau *a,
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
    size_t lanes = NEVH__LANES;
    nevh__write(
        w, sizes, padded->stages, padded->row, partitioned ? work->n : 0,
        padded->steps, one ? 1 : lanes, w->by_lane ? lanes : 1,
        one ? padded->row : padded->stages * lanes, NEVH__FEW_TOGETHER,
        partitioned, noisy, nevh__stages_have_newton(work, padded->stages));
    if (noisy)
        nevh__write_form(w, "NEVH__DIFFERENCES");
}

/* Vectors of lanes, one after the other. */
static void write_lane_scales(nevh__writer *w, const nevh_field *f) {
    char name[NEVH__NAME];
    nevh__write(w, "#define SCALES (N + %zu)\n", w->count);
    for (size_t k = 0; k < 2 * f->n; k++)
        nevh__write_own(w, f->lane_scale + k * f->lanes, 1, name);
}

static void write_step(nevh__writer *w, const nevh_work *work,
                       const nevh__tableau *a,
                       const nevh__stage_weights *padded) {
    bool one = w->width == 1;
    write_sizes(w, work, padded);
    stage_text_write_tables(w, a, padded);
    nevh__write_lines(w, nevh__stage_progress_text);
    nevh__write_lines(w, nevh__stage_judge_text);
    nevh__write_lines(w, nevh__stage_step_text);
    if (w->by_lane)
        write_lane_scales(w, work->field);
    else
        nevh__write_array(w, "SCALES", "N", 2 * work->n, work->scale);
    if (work->field->gradient->offsets)
        nevh__write_noise(w, work->field);
    nevh__write_table(w);
    nevh__write_lines(w, nevh__implicit_driver_text);
    nevh__write_lines(w, one ? nevh__implicit_orbit_text
                             : nevh__implicit_lanes_text);
    nevh__write_entry(w);
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

/* nevh tests: frequencies in a series.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <gsl/gsl_sf_ellint.h>
#include <math.h>

enum { SAMPLES = 10001, LINES = 6 };
static double values[SAMPLES];

static int record(void *data, size_t step, double t, const double q[],
                  const double p[]) {
    (void)data, (void)t, (void)p;
    values[step] = q[0];
    return 0;
}

TEST(lines_of_a_sum_are_found) {
    static const double w[] = {1.2345678901, 2.3, 0.7071067811865, 0.6};
    static const double size[] = {1, 0.1, 1e-3, 1e-5};
    static const double phase[] = {0.3, -1.5, 2, 0.1};
    nevh_spectral_line lines[LINES];
    size_t found;
    for (size_t k = 0; k < SAMPLES; k++) {
        values[k] = 0.3;
        for (int i = 0; i < 4; i++)
            values[k] += size[i] * cos(w[i] * 0.1 * (double)k + phase[i]);
    }
    ck_assert_int_eq(
        nevh_frequencies(0.1, SAMPLES, values, LINES, lines, &found), NEVH_OK);
    ck_assert_uint_ge(found, 4);
    for (int i = 0; i < 4; i++) {
        double noise = 1e-15 / size[i];
        ck_assert_double_eq_tol(lines[i].frequency, w[i], 1e-14 + noise / 10);
        ck_assert_double_eq_tol(lines[i].amplitude, size[i], 1e-13);
        ck_assert_double_eq_tol(lines[i].phase, phase[i], 1e-10 + 20 * noise);
        ck_assert_double_le(fabs(lines[i].drift), 1e-13 + noise);
    }
    /* A frequency that moves. */
    for (size_t k = 0; k < SAMPLES; k++) {
        double t = 0.1 * (double)k;
        values[k] = cos(t + 1e-6 * t * t / 2);
    }
    nevh_frequencies(0.1, SAMPLES, values, 1, lines, &found);
    ck_assert_uint_eq(found, 1);
    ck_assert_double_eq_tol(lines[0].frequency, 1 + 5e-4, 1e-7);
    ck_assert_double_eq_tol(lines[0].drift, 5e-4, 1e-6);
}

/* Two lines, some tenths of a peak's width to some widths apart: whether they are
   told apart or not, none is claimed with digits that are false. */
TEST_EACH(errors_of_near_lines_hold_the_truth, 16) {
    double apart = 0.15 / pow(1.5, _i), h = 0.1;
    nevh_spectral_line lines[LINES];
    size_t found;
    for (size_t k = 0; k < SAMPLES; k++) {
        double t = h * (double)k;
        values[k] = cos(t) + 0.7 * cos((1 + apart) * t + 1);
    }
    ck_assert_int_eq(nevh_frequencies(h, SAMPLES, values, LINES, lines, &found),
                     NEVH_OK);
    ck_assert_uint_ge(found, 1);
    ck_assert_double_gt(lines[0].amplitude, 0.3);
    for (size_t i = 0; i < found && lines[i].amplitude > 0.3; i++) {
        double w = lines[i].frequency;
        double off = fmin(fabs(w - 1), fabs(w - 1 - apart));
        ck_assert_msg(off <= 3 * lines[i].error, "%g apart: %g off, error %g",
                      apart, off, lines[i].error);
        if (apart * h * (SAMPLES - 1) > 4 * acos(-1))
            ck_assert_double_lt(off, 1e-13);
    }
}

/* The same of two pendulums that beat, with lines beside: half a beat to fifty. */
TEST_EACH(errors_of_beats_hold_the_truth, 40) {
    double apart = 0.16, h = 0.1, end = 20 * pow(1.12, _i);
    size_t count = (size_t)(end / h) + 1, found;
    nevh_spectral_line lines[LINES];
    static double x[SAMPLES];
    count = count < SAMPLES ? count : SAMPLES;
    for (size_t k = 0; k < count; k++) {
        double t = h * (double)k;
        x[k] = 0.26 * cos(3.1 * t) + 0.24 * cos((3.1 + apart) * t) +
               0.0097 * cos((3.1 - apart) * t) +
               0.0093 * cos((3.1 + 2 * apart) * t);
    }
    ck_assert_int_eq(nevh_frequencies(h, count, x, LINES, lines, &found),
                     NEVH_OK);
    for (size_t i = 0; i < found && lines[i].amplitude > 0.15; i++) {
        double w = lines[i].frequency;
        double off = fmin(fabs(w - 3.1), fabs(w - 3.1 - apart));
        ck_assert_msg(off <= 3 * lines[i].error, "until %g: %g off, error %g",
                      end, off, lines[i].error);
    }
}

TEST(a_line_of_one_half_has_no_drift) {
    nevh_spectral_line line;
    size_t found;
    for (size_t k = 0; k < SAMPLES; k++)
        values[k] = cos((k < SAMPLES / 2 ? 2.2 : 1.1) * 0.1 * (double)k);
    ck_assert_int_eq(nevh_frequencies(0.1, SAMPLES, values, 1, &line, &found),
                     NEVH_OK);
    ck_assert_uint_eq(found, 1);
    ck_assert_double_nan(line.drift);
    ck_assert_double_gt(line.error, 1e-6);
}

/* Its odd multiples are all there is in the angle. */
TEST(frequency_of_the_pendulum_is_exact) {
    nevh_scene *s = nevh_scene_parse("pendulum", "[coordinates]\nx = 2\n"
                                                 "[effects]\n"
                                                 "kinetic = p_x^2/2\n"
                                                 "gravity = -9.8*cos(x)\n");
    double q = 2, p = 0;
    nevh_options o = {.gradient = nevh_exact, .q = &q, .p = &p};
    nevh_stepper *r = nevh_stepper_new(nevh_scene_system(s), nevh_gauss16, &o);
    nevh_observer observer = {record, NULL, 1};
    ck_assert_int_eq(nevh_run(r, 0, 0.1, SAMPLES - 1, &q, &p, &observer, 1),
                     NEVH_OK);
    nevh_spectral_line lines[LINES];
    size_t found;
    nevh_frequencies(0.1, SAMPLES, values, LINES, lines, &found);
    double exact = acos(-1) * sqrt(9.8) /
                   (2 * gsl_sf_ellint_Kcomp(sin(1), GSL_PREC_DOUBLE));
    ck_assert_uint_ge(found, 4);
    for (int i = 0; i < 4; i++)
        ck_assert_double_eq_tol(lines[i].frequency / exact / (2 * i + 1), 1,
                                1e-12);
    nevh_stepper_free(r);
    nevh_scene_free(s);
}

/* Samples of 1e6 steps in a room of 1000: a fast line, however small, keeps them
   dense, so that it does not pass for a slow one. */
TEST(samples_of_a_long_run_are_dense_enough) {
    static const double fast[] = {0, 0.3, 0.01, 1e-5};
    enum { ROOM = 1000, STEPS = 1000000 };
    nevh_spectral_samples *s = nevh_spectral_samples_new(ROOM);
    nevh_spectral_line lines[LINES];
    double h;
    for (int i = 0; i < 4; i++) {
        size_t found, count;
        nevh_spectral_samples_restart(s);
        for (size_t k = 0; k <= STEPS; k++) {
            double t = 5 + 0.001 * (double)k;
            nevh_spectral_samples_take(s, k, t,
                                       cos(t) + fast[i] * cos(41.3 * t));
        }
        const double *x = nevh_spectral_samples_values(s, &count, &h);
        ck_assert_uint_ge(count, ROOM / 2);
        ck_assert_uint_le(count, ROOM);
        ck_assert_double_lt(fast[i] > 0 ? 41.3 * h : h,
                            fast[i] > 0 ? 3 : 0.512 * 3);
        ck_assert_int_eq(nevh_frequencies(h, count, x, 2, lines, &found),
                         NEVH_OK);
        if (fast[i] > 0) {
            ck_assert_uint_eq(found, 2);
            ck_assert_double_eq_tol(lines[1].frequency, 41.3, 1e-3);
        }
        ck_assert_double_eq_tol(lines[0].frequency, 1,
                                fast[i] > 0 ? 1e-4 : 1e-12);
    }
    nevh_spectral_samples_free(s);
}

/* A last step that is shorter is no sample; steps that end early are few. */
TEST(samples_are_at_equal_times) {
    nevh_spectral_samples *s = nevh_spectral_samples_new(NEVH_FEWEST_SAMPLES);
    size_t count;
    double h;
    for (size_t k = 0; k < 50; k++)
        nevh_spectral_samples_take(s, k, 0.1 * (double)k, (double)k);
    nevh_spectral_samples_take(s, 50, 4.93, 50);
    const double *x = nevh_spectral_samples_values(s, &count, &h);
    ck_assert_uint_eq(count, 50);
    ck_assert_double_eq_tol(h, 0.1, 1e-15);
    ck_assert_double_eq(x[49], 49);
    ck_assert(!nevh_spectral_samples_straighten(s, 0));
    ck_assert(!nevh_spectral_samples_straighten(s, 100));
    ck_assert(nevh_spectral_samples_straighten(s, 2));
    ck_assert_double_eq_tol(x[3], -1, 1e-14);
    nevh_spectral_samples_free(s);
    ck_assert_ptr_null(nevh_spectral_samples_new(NEVH_FEWEST_SAMPLES - 1));
    ck_assert_ptr_null(nevh_spectral_samples_new((size_t)-1));
}

TEST(bad_series_are_refused) {
    nevh_spectral_line line;
    size_t found;
    for (size_t k = 0; k < 100; k++)
        values[k] = 1;
    ck_assert_int_eq(nevh_frequencies(0.1, 63, values, 1, &line, &found),
                     NEVH_EINVAL);
    ck_assert_int_eq(nevh_frequencies(0, 100, values, 1, &line, &found),
                     NEVH_EINVAL);
    ck_assert_int_eq(nevh_frequencies(NAN, 100, values, 1, &line, &found),
                     NEVH_EINVAL);
    ck_assert_int_eq(nevh_frequencies(0.1, 100, values, 1, &line, &found),
                     NEVH_OK);
    ck_assert_uint_eq(found, 0); /* a constant */
    values[5] = NAN;
    ck_assert_int_eq(nevh_frequencies(0.1, 100, values, 1, &line, &found),
                     NEVH_EDOM);
}

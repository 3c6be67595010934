/* nevh tests: what H does with time is found: jumps, kinks, poles, peaks and
   drives, in ways to write them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/scene.h>
#include <nevh/timing.h>
#include <stdio.h>

typedef struct {
    nevh_scene *scene;
    nevh_timing *timing;
} setup;

static setup look(const char *drive, double t0, double t1) {
    char text[400];
    double q[1], p[1];
    snprintf(text, sizeof text, "K = p_x^2/2\nV = x^2/2\nD = %s", drive);
    setup s = {.scene = scene_with("x = 1", text)};
    nevh_scene_start(s.scene, q, p);
    s.timing = nevh_timing_new(nevh_scene_system(s.scene), t0, t1, q, p);
    ck_assert_ptr_nonnull(s.timing);
    return s;
}

static void tear_down(setup *s) {
    nevh_timing_free(s->timing);
    nevh_scene_free(s->scene);
}

/* From 0 to 20: the shortest change, and where it is. */
static const struct {
    const char *drive;
    double time, at;
} peaks[] = {
    {"-100*x*exp(-((t-7.77)/0.001)^2)", 1e-3, 7.77},
    {"-x*exp(-((t-5)/1e-9)^2)", 1e-9, 5},
    {"-x/(1+((t-11.123)/1e-4)^2)", 1e-4, 11.123},
    {"x*max(0, 1-abs(t-3.3)/1e-5)", 1e-5, 3.3},
    {"-x*tanh((t-6)/1e-6)", 2e-6, 6},
    {"x*atan((t-13)/1e-5)", 3e-5, 13},
    {"x/cosh((t-1)/1e-3)^2", 1e-3, 1},
    {"-x*(1000*t + exp(-((t-5)/1e-3)^2))", 1e-3, 5},
    {"x^2*(1 + 1e-3*exp(-(t-9)^2/1e-6))", 1e-3, 9},
    {"cos(x)*exp(-((t-2)/1e-3)^2 - x^2)", 1e-3, 2},
    {"-x*exp(-abs(t-8)/1e-4)", 1e-4, 8},
    {"x*1/(exp((t-4)/1e-5)+1)", 1e-5, 4},
};

TEST_EACH(narrow_peaks_are_found, sizeof peaks / sizeof *peaks) {
    setup s = look(peaks[_i].drive, 0, 20);
    double at = NAN;
    const char *effect = "";
    double time = nevh_timing_shortest(s.timing, &at, &effect);
    ck_assert_double_gt(time, peaks[_i].time / 5);
    ck_assert_double_lt(time, peaks[_i].time * 5);
    ck_assert_double_lt(fabs(at - peaks[_i].at), 5 * peaks[_i].time);
    ck_assert_str_eq(effect, "D");
    ck_assert(nevh_timing_whole(s.timing));
    tear_down(&s);
}

static const struct {
    const char *drive;
    double frequency;
} drives[] = {
    {"-0.3*x*cos(50*t)", 50},        {"x*sin(2*pi*t/0.01)", 628.3185307},
    {"0.1*cos(x - 40*t)", 40},       {"-x*(cos(3*t) + 1e-3*sin(70*t))", 70},
    {"-x*exp(-t)*cos(7*t)", 7},      {"-0.1*x*cos(t^2)", 40},
    {"x*mod(t, 0.5)", 12.566370614}, {"x*floor(t/2)", 3.1415926536},
    {"x^2*sqrt(t + 1)", 0},          {"x*p_x", 0},
};

TEST_EACH(drives_are_found, sizeof drives / sizeof *drives) {
    setup s = look(drives[_i].drive, 0, 20);
    double found = nevh_timing_frequency(s.timing, NULL);
    ck_assert_double_lt(fabs(found - drives[_i].frequency),
                        1e-6 * drives[_i].frequency + 1e-12);
    tear_down(&s);
}

/* How many jumps and kinks from 0 to 10, and where the first is. */
static const struct {
    const char *drive;
    size_t jumps, kinks, poles;
    double first;
} broken[] = {
    {"-0.3*x*sign(t-5)", 1, 0, 0, 5},
    {"x*(sign(t-4)-sign(t-4.00001))", 2, 0, 0, 4},
    {"x*sign(sin(pi*(t + 0.25)))", 10, 0, 0, 0.75},
    {"x*mod(t + 0.3, 0.7)", 14, 0, 0, 0.4},
    {"x*floor(t/3 + 0.1)", 3, 0, 0, 2.7},
    {"x*max(0, t-3)", 0, 1, 0, 3},
    {"x*abs(t-6.5)", 0, 1, 0, 6.5},
    {"x*min(t, 2)", 0, 1, 0, 2},
    {"x*max(0, sign(t-1))*min(1, t)", 1, 0, 0, 1},
    {"x*atan2(t-4, -1)", 1, 0, 0, 4},
    {"x/(t-4.7)", 0, 0, 1, 4.7},
    {"x*cos(t)", 0, 0, 0, 0},
    {"max(x, cos(t))", 0, 0, 0, 0}, /* where it breaks depends on x */
    {"x*(-1)^floor(t/3 + 0.1)", 3, 0, 0, 2.7},
    /* what jumps is read in whole periods */
    {"cos(x - 2*pi*mod(t + 0.75, 1))", 0, 10, 0, 0.25},
    {"cos(x - 2*pi*mod(t + 0.75, 1)) + 1e-9*x*floor(t/5 + 0.15)", 2, 8, 0,
     0.25},
};

TEST_EACH(breaks_are_found, sizeof broken / sizeof *broken) {
    setup s = look(broken[_i].drive, 0, 10);
    size_t jumps = 0, kinks = 0, poles = 0,
           count = nevh_timing_breaks(s.timing);
    for (size_t i = 0; i < count; i++) {
        nevh_time_break b = nevh_timing_break(s.timing, i);
        jumps += b.jump;
        poles += b.pole;
        kinks += !b.jump && !b.pole;
        ck_assert_double_lt(b.before, b.after);
        ck_assert_double_lt(b.after - b.before, 1e-12);
        ck_assert_str_eq(b.effect, "D");
        if (i == 0) {
            ck_assert_double_lt(b.before, broken[_i].first + 1e-14);
            ck_assert_double_gt(b.after, broken[_i].first - 1e-14);
        }
    }
    if (jumps > 0 && broken[_i].jumps > 0)
        kinks = broken[_i].kinks; /* min(1, t) breaks where max does */
    ck_assert_uint_eq(jumps, broken[_i].jumps);
    ck_assert_uint_eq(kinks, broken[_i].kinks);
    ck_assert_uint_eq(poles, broken[_i].poles);
    tear_down(&s);
}

/* In C, where only values are known. */
static double pulse(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)p, (void)c;
    const double *at = params;
    return q[0] * (fabs(t - at[0]) < at[1]);
}

TEST(functions_in_c_are_sampled) {
    static const double at[] = {7.7, 0.02}, q[] = {1}, p[] = {0};
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "pulse",
                                    .nq = 1,
                                    .time = true,
                                    .value = pulse,
                                    .params = at});
    nevh_timing *m = nevh_timing_new(s, 0, 20, q, p);
    ck_assert(!nevh_timing_whole(m));
    ck_assert_uint_eq(nevh_timing_breaks(m), 2);
    ck_assert(nevh_timing_break(m, 0).jump);
    ck_assert_double_lt(fabs(nevh_timing_break(m, 0).before - 7.68), 1e-9);
    nevh_timing_free(m);
    nevh_system_free(s);
}

TEST(nothing_of_h_without_time) {
    setup s = look("x^4", 0, 20);
    ck_assert_uint_eq(nevh_timing_breaks(s.timing), 0);
    ck_assert_double_eq(nevh_timing_shortest(s.timing, NULL, NULL), INFINITY);
    ck_assert_double_eq(nevh_timing_frequency(s.timing, NULL), 0);
    ck_assert(nevh_timing_whole(s.timing));
    tear_down(&s);
}

/* nevh: tests of plots: fewer points look the same.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/plot_private.h"
#include "support.h"
#include <math.h>
#include <stdlib.h>

enum { MOST = 6000, FINE = 8 };

/* From 0 to 1: a linear congruence. */
static double random_number(void) {
    static unsigned state = 1;
    state = state * 1664525u + 1013904223u;
    return state / 4294967296.0;
}

/* A point of `which` curve at k of MOST: a spiral that returns, an orbit that
   precesses, a random walk, cusps, powers, a line to and fro. */
static pair curve(int which, size_t k, pair before) {
    double s = (double)k / MOST, turn = 2 * acos(-1);
    switch (which) {
    case 0:
        return (pair){(1 - s) * cos(20 * turn * s), (1 - s) * sin(turn * s)};
    case 1:
        return (pair){cos(61.7 * turn * s) * (1 + 0.3 * cos(40 * s)),
                      sin(61.7 * turn * s)};
    case 2:
        return (pair){before.x + 0.02 * (random_number() - 0.5),
                      before.y + 0.02 * (random_number() - 0.5)};
    case 3:
        return (pair){fabs(sin(9 * turn * s)), pow(fabs(cos(7 * turn * s)), 9)};
    case 4:
        return (pair){pow(10, -3 + 4 * s),
                      pow(10, -8 * s) * (1 + 0.5 * sin(90 * turn * s))};
    default:
        return (pair){k % 2 ? s : 1 - s, 0.25};
    }
}
enum { CURVES = 6, LOGARITHMIC = 4 };

static size_t make_curve(int which, pair at[MOST]) {
    pair before = {0, 0};
    for (size_t k = 0; k < MOST; k++) {
        at[k] = before = curve(which, k, before);
        if (k % 1777 == 1776)
            at[k] = (pair){NAN, NAN};
    }
    return MOST;
}

static plot_screen screen_of(int which) {
    bool log = which == LOGARITHMIC;
    return (plot_screen){{log ? 1e-3 : -1.5, log ? 10 : 1.2},
                         {log ? 1e-9 : -1.1, log ? 10 : 0.9},
                         log,
                         log,
                         640,
                         420,
                         0.1};
}

static double to_line(pair p, pair a, pair b) {
    double x = b.x - a.x, y = b.y - a.y, square = x * x + y * y;
    double along =
        square > 0 ? ((p.x - a.x) * x + (p.y - a.y) * y) / square : 0;
    along = fmin(fmax(along, 0), 1);
    return hypot(p.x - a.x - along * x, p.y - a.y - along * y);
}

static double to_drawn(const plot_screen *s, pair p, const pair at[],
                       size_t count, bool dots) {
    double least = INFINITY;
    for (size_t i = dots ? 0 : 1; i < count; i++) {
        pair from = at[dots ? i : i - 1];
        if (!isnan(from.x) && !isnan(at[i].x))
            least = fmin(least, to_line(p, plot_in_pixels(s, from),
                                        plot_in_pixels(s, at[i])));
    }
    return least;
}

/* Of what is within the panel: the farthest of points along the whole curve from
   what is drawn. */
static double farthest(const plot_screen *s, const pair all[], size_t count,
                       const pair at[], size_t kept, bool dots) {
    double most = 0;
    for (size_t i = 1; i < count; i += 7) {
        if (isnan(all[i].x) || isnan(all[i - 1].x))
            continue;
        pair a = plot_in_pixels(s, all[i - 1]), b = plot_in_pixels(s, all[i]);
        double along = dots ? 1 : (double)(i % FINE) / FINE;
        pair p = {a.x + along * (b.x - a.x), a.y + along * (b.y - a.y)};
        if (p.x >= 0 && p.x <= s->width && p.y >= 0 && p.y <= s->height)
            most = fmax(most, to_drawn(s, p, at, kept, dots));
    }
    return most;
}

TEST_EACH(what_is_left_out_is_within_the_error_of_what_is_drawn, 3 * CURVES) {
    static const plot_thinning hows[] = {THIN_LINE, THIN_SOLID, THIN_DOTS};
    plot_thinning how = hows[_i / CURVES];
    plot_screen s = screen_of(_i % CURVES);
    pair *all = calloc(3 * MOST, sizeof *all), *at = all + MOST;
    size_t count = make_curve(_i % CURVES, all);
    size_t kept = plot_thin(&s, how, all, count, at);
    ck_assert(kept > 1 && kept <= 2 * count);
    double most = farthest(&s, all, count, at, kept, how == THIN_DOTS);
    ck_assert_double_le(most, plot_thin_error(how, s.detail));
    ck_assert_double_le(plot_thin_error(how, s.detail), 0.5);
    free(all);
}

TEST_EACH(points_stay_where_they_are_and_in_order, CURVES) {
    plot_screen s = screen_of(_i);
    pair *all = calloc(3 * MOST, sizeof *all), *at = all + MOST;
    size_t count = make_curve(_i, all), k = 0;
    size_t kept = plot_thin(&s, THIN_LINE, all, count, at);
    for (size_t i = 0; i < kept; i++) {
        while (k < count &&
               !(isnan(at[i].x) ? isnan(all[k].x)
                                : at[i].x == all[k].x && at[i].y == all[k].y))
            k++;
        ck_assert(k++ < count);
    }
    ck_assert(at[0].x == all[0].x && at[kept - 1].x == all[count - 1].x);
    free(all);
}

/* Turns of one circle, whose points are never the same. */
static size_t kept_of_turns(double turns, plot_thinning how) {
    plot_screen s = screen_of(0);
    pair *all = calloc(3 * MOST, sizeof *all);
    for (size_t k = 0; k < MOST; k++) {
        double angle = 2 * acos(-1) * turns * (double)k / MOST;
        all[k] = (pair){0.5 * cos(angle), 0.5 * sin(angle)};
    }
    size_t kept = plot_thin(&s, how, all, MOST, all + MOST);
    free(all);
    return kept;
}

TEST(fine_curves_have_few_points) {
    ck_assert(kept_of_turns(1, THIN_LINE) < 100);
}

TEST(turns_over_what_is_drawn_are_left_out) {
    ck_assert(kept_of_turns(100, THIN_LINE) > MOST / 2);
    ck_assert(kept_of_turns(100, THIN_SOLID) < MOST / 5);
    ck_assert(kept_of_turns(100, THIN_DOTS) < MOST / 2);
}

TEST(coarser_screens_keep_fewer_points_within_their_detail) {
    plot_screen s = screen_of(1);
    pair *all = calloc(3 * MOST, sizeof *all), *at = all + MOST;
    size_t count = make_curve(1, all);
    size_t fine = plot_thin(&s, THIN_LINE, all, count, at);
    s.detail = 1;
    size_t kept = plot_thin(&s, THIN_LINE, all, count, at);
    ck_assert(kept < fine / 2);
    ck_assert_double_le(farthest(&s, all, count, at, kept, false),
                        plot_thin_error(THIN_LINE, s.detail));
    free(all);
}

TEST(lines_are_cut_at_the_border) {
    pair low = {0, 0}, high = {10, 5};
    pair a = {-10, 0}, b = {20, 6}, beside = {-1, 9}, away = {-5, 2};
    ck_assert(plot_clip(&a, &b, low, high));
    ck_assert(fabs(a.x) < 1e-12 && fabs(a.y - 2) < 1e-12);
    ck_assert(fabs(b.x - 10) < 1e-12 && fabs(b.y - 4) < 1e-12);
    ck_assert(!plot_clip(&beside, &away, low, high));
    a = (pair){1, 1}, b = (pair){1, 1e300 * 1e300};
    ck_assert(!plot_clip(&a, &b, low, high));
}

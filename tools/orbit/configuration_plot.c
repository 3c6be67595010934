/* nevh run --plot-kind configuration, animation: the scene's picture: trails of its bobs,
   and where all is at the end.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run_plot_private.h"
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_BOBS = 16 };

typedef struct {
    nevh_scene *scene;
    size_t count, part[MOST_BOBS];
} bob_list;

static bob_list bobs_of(nevh_scene *s) {
    bob_list b = {.scene = s};
    for (size_t i = 0; i < nevh_scene_part_count(s); i++)
        if (strcmp(nevh_scene_part_at(s, i).kind, "bob") == 0 &&
            b.count < MOST_BOBS)
            b.part[b.count++] = i;
    return b;
}

/* True if the place of a bob is two numbers. */
static bool is_fixed(const bob_list *b, size_t bob) {
    for (size_t k = 0; k < 2; k++) {
        char *end;
        strtod(nevh_scene_part_at(b->scene, b->part[bob]).item[k], &end);
        if (*end)
            return false;
    }
    return true;
}

/* The four values of part i; NAN for formulas without a value. */
static void part(nevh_scene *s, size_t i, double t, const double q[],
                 const double p[], double values[4]) {
    for (size_t k = 0; k < 4; k++)
        values[k] = NAN;
    nevh_scene_part_values(s, i, t, q, p, values);
}

static void fill(void *data, double t, const double q[], const double p[],
                 double places[]) {
    const bob_list *b = data;
    double values[4];
    for (size_t i = 0; i < b->count; i++) {
        part(b->scene, b->part[i], t, q, p, values);
        memcpy(places + 2 * i, values, 2 * sizeof *values);
    }
}

/* Axes. */

/* The name that a formula is, without its number or index: x of x, x1, x[1];
   "" of other formulas. */
static void base_of(const char *formula, char base[], size_t size) {
    size_t length = strcspn(formula, "[ ");
    const char *rest = formula + length;
    base[0] = '\0';
    if (*rest == '[' && (!strchr(rest, ']') || strchr(rest, ']')[1]))
        return;
    if (*rest == ' ' || strpbrk(formula, "+-*/^(") || length >= size)
        return;
    memcpy(base, formula, length);
    base[length] = '\0';
    while (length > 1 && isdigit((unsigned char)base[length - 1]))
        base[--length] = '\0';
    if (isdigit((unsigned char)base[0]))
        base[0] = '\0';
}

/* The label of the axis that all bobs share, numbers apart; x or y if they differ.
   The unit is that of any that has one. */
static char *axis_label(const plan *p, const bob_list *b, size_t which) {
    char name[64] = "", other[64];
    const char *unit = "";
    bool same = true;
    for (size_t i = 0; i < b->count; i++) {
        const char *item = nevh_scene_part_at(b->scene, b->part[i]).item[which];
        const char *label = nevh_scene_label(p->scene, item);
        base_of(item, other, sizeof other);
        unit = *label ? label : unit;
        same = same && (*other ? !*name || strcmp(name, other) == 0
                               : isdigit((unsigned char)*item));
        if (*other)
            strcpy(name, other);
    }
    if (!same || !*name)
        strcpy(name, which ? "y" : "x");
    return text_print(*unit ? "%s (%s)" : "%s%s", name, unit);
}

/* Parts. */

/* In the colour of the integrator; the reference is grey. */
static size_t new_series(plot *to, const orbit *o, plot_form form,
                         plot_form of_reference) {
    size_t series = plot_series(to, NULL);
    plot_style(to, series, o->integrator ? form : of_reference);
    if (o->integrator)
        plot_set_look(to, series, plot_look_of_integrator(o->integrator));
    return series;
}

static void draw_trail(plot *to, const orbit *o, size_t bob) {
    size_t series = new_series(to, o, o->rows.part < 1 ? PLOT_DOTS : PLOT_TRAIL,
                               PLOT_REFERENCE);
    for (size_t i = 0; i < o->rows.count; i++) {
        const double *at = orbit_row(o, i) + 2 * bob;
        plot_point(to, series, at[0], at[1]);
    }
}

static void draw_start(plot *to, const orbit *o, size_t bob) {
    const double *at = orbit_row(o, 0) + 2 * bob;
    size_t series = new_series(to, o, PLOT_START, PLOT_START);
    plot_point(to, series, at[0], at[1]);
}

static void draw_rod(plot *to, const double values[4]) {
    size_t series = plot_series(to, NULL);
    plot_style(to, series, PLOT_RODS);
    plot_point(to, series, values[0], values[1]);
    plot_point(to, series, values[2], values[3]);
}

/* True if a bob is there at the end of the run. */
static bool is_bob(const bob_list *b, const orbit *o, const double at[2]) {
    static const double rounding = 1e-9;
    double values[4];
    for (size_t bob = 0; bob < b->count; bob++) {
        part(b->scene, b->part[bob], o->t, o->q, o->p, values);
        if (hypot(values[0] - at[0], values[1] - at[1]) < rounding)
            return true;
    }
    return false;
}

/* Draws the rods at the end of the run, and their pivots. */
static void draw_rods(plot *to, const bob_list *b, const orbit *o) {
    double values[4];
    for (size_t i = 0; i < nevh_scene_part_count(b->scene); i++) {
        if (strcmp(nevh_scene_part_at(b->scene, i).kind, "rod") != 0)
            continue;
        part(b->scene, i, o->t, o->q, o->p, values);
        draw_rod(to, values);
        for (size_t end = 0; end < 4; end += 2)
            if (!is_bob(b, o, values + end)) {
                size_t series = plot_series(to, NULL);
                plot_style(to, series, PLOT_CENTRE);
                plot_point(to, series, values[end], values[end + 1]);
            }
    }
}

/* Smaller ones later, so that none is hidden; grey where no integrator moves it. */
static void draw_bob(plot *to, const bob_list *b, size_t bob, const orbit *o,
                     const double at[2]) {
    static const double least = 0.35, less = 0.2;
    size_t series = new_series(to, o, PLOT_BOBS, PLOT_GREY_BOBS);
    if (is_fixed(b, bob))
        plot_style(to, series, PLOT_GREY_BOBS);
    plot_size(to, series, fmax(1 - less * (double)bob, least));
    plot_point(to, series, at[0], at[1]);
}

static void name_bob(plot *to, const bob_list *b, size_t bob,
                     const double at[2]) {
    char *name = plot_bob_name(b->scene, bob);
    if (!name)
        return;
    size_t series = plot_series(to, name);
    plot_style(to, series, PLOT_GUIDE);
    plot_point(to, series, at[0], at[1]);
}

static void draw(plot *to, const bob_list *b, const orbit *o) {
    double values[4];
    for (size_t bob = 0; bob < b->count; bob++)
        draw_trail(to, o, bob);
    for (size_t bob = 0; bob < b->count && o->rows.count && o->integrator;
         bob++)
        if (!is_fixed(b, bob))
            draw_start(to, o, bob);
    draw_rods(to, b, o);
    for (size_t bob = 0; bob < b->count; bob++) {
        part(b->scene, b->part[bob], o->t, o->q, o->p, values);
        draw_bob(to, b, bob, o, values);
        name_bob(to, b, bob, values);
    }
}

/* The number of turns of the slowest bob that moves. */
static double least_turns(const bob_list *b, const orbit *o) {
    double least = INFINITY;
    for (size_t i = 0; i < b->count; i++) {
        double turns = fmax(orbit_turns(o, 2 * i), orbit_turns(o, 2 * i + 1));
        least = turns > 0 ? fmin(least, turns) : least;
    }
    return isfinite(least) ? least : 0;
}

static void follow_dense(run_picture *picture, bob_list *b) {
    row_times dense = orbit_dense_times(&picture->plan);
    picture_follow(picture, &dense, 2 * b->count, fill, b);
}

/* returns  what is to be said of it */
static char *follow(run_picture *picture, bob_list *b) {
    follow_dense(picture, b);
    char *words = picture_cut(picture, least_turns(b, picture->orbits.item),
                              PICTURE_TURNS);
    if (!words)
        return text_print("%s", "");
    follow_dense(picture, b);
    return words;
}

/* All panels show what rods reach, too. */
static void set_window(plot *to, const run_picture *picture, const bob_list *b,
                       picture_range window[2]) {
    size_t columns[2][MOST_BOBS];
    for (size_t i = 0; i < b->count; i++) {
        columns[0][i] = 2 * i;
        columns[1][i] = 2 * i + 1;
    }
    for (size_t k = 0; k < 2; k++)
        window[k] = picture_extent(picture, columns[k], b->count);
    const orbit *o = picture_orbit(picture, 0);
    double values[4];
    for (size_t i = 0; i < nevh_scene_part_count(b->scene); i++) {
        if (strcmp(nevh_scene_part_at(b->scene, i).kind, "rod") != 0)
            continue;
        part(b->scene, i, o->t, o->q, o->p, values);
        for (size_t k = 0; k < 4; k++) {
            picture_range *w = &window[k % 2];
            double more = 0.02 * (w->high - w->low);
            w->low = fmin(w->low, values[k] - more);
            w->high = fmax(w->high, values[k] + more);
        }
    }
    plot_equal(to);
    plot_span_x(to, window[0].low, window[0].high);
    plot_span_y(to, window[1].low, window[1].high);
}

/* Adds to the words the discs of an orbit that are outside the window. */
static void note_outside(const bob_list *b, const run_picture *picture,
                         const orbit *o, const picture_range window[2],
                         char **words) {
    double at[4];
    for (size_t bob = 0; bob < b->count; bob++) {
        part(b->scene, b->part[bob], o->t, o->q, o->p, at);
        if (at[0] >= window[0].low && at[0] <= window[0].high &&
            at[1] >= window[1].low && at[1] <= window[1].high)
            continue;
        char *name = plot_bob_name(b->scene, bob);
        text_extend(words, "%s%s, %s", **words ? "; " : "; outside: ",
                    picture->orbits.count > 1 || !o->integrator ? o->name
                                                                : o->integrator,
                    name ? name : "the body");
    }
}

plot *plot_configuration(run_picture *picture) {
    bob_list b = bobs_of(picture->plan.scene);
    orbit *first = picture->orbits.item;
    plot *to = NULL;
    picture_range window[2];
    char *outside = text_print("%s", "");
    char *cut = follow(picture, &b);
    picture_refer(picture, 2 * b.count, fill, &b);
    char *x = axis_label(&picture->plan, &b, 0),
         *y = axis_label(&picture->plan, &b, 1);
    for (size_t i = 0; i < picture_columns(picture); i++) {
        char *heading = picture_heading(picture, i);
        if (to)
            plot_panel(to, heading, x, y);
        else
            to = plot_new(picture->plan.title, x, y);
        if (!i)
            plot_heading(to, heading);
        set_window(to, picture, &b, window);
        draw(to, &b, picture_orbit(picture, i));
        note_outside(&b, picture, picture_orbit(picture, i), window, &outside);
    }
    plot_columns(to, picture_across(picture));
    char *more =
        text_print("circles: the start; discs: t = %.6g%s%s%s%s", first->t,
                   picture->plan.unit, *cut ? "; " : "", cut, outside);
    picture_note(picture, to, more);
    return to;
}

/* Animations. */

enum { FRAMES = 84, EACH = 10, TRAIL = 25 * EACH, MOST_PANELS = 4 };

/* Writes four values of each part. */
static void fill_parts(void *data, double t, const double q[], const double p[],
                       double values[]) {
    const bob_list *b = data;
    for (size_t i = 0; i < nevh_scene_part_count(b->scene); i++)
        part(b->scene, i, t, q, p, values + 4 * i);
}

static void follow_evenly(run_picture *picture, bob_list *b) {
    row_times even = {.by = BY_TIMES,
                      .time = tool_allocate(FRAMES * EACH + 1, sizeof(double))};
    double begin = picture->plan.run->t_start;
    double span = picture->plan.t_end - begin;
    for (size_t i = 0; i <= FRAMES * EACH; i++)
        even.time[even.count++] = begin + span * (double)i / (FRAMES * EACH);
    picture_follow(picture, &even, 4 * nevh_scene_part_count(b->scene),
                   fill_parts, b);
}

/* The range of the first orbit with a margin: other orbits are seen to leave it. */
static void find_reach(const orbit *o, size_t parts, double low[2],
                       double high[2]) {
    static const double room = 0.2;
    for (size_t k = 0; k < 2; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
        for (size_t i = 0; i < o->rows.count; i++)
            for (size_t j = 0; j < 2 * parts; j++)
                if (isfinite(orbit_row(o, i)[2 * j + k])) {
                    low[k] = fmin(low[k], orbit_row(o, i)[2 * j + k]);
                    high[k] = fmax(high[k], orbit_row(o, i)[2 * j + k]);
                }
    }
    double most = room * fmax(high[0] - low[0], high[1] - low[1]);
    for (size_t k = 0; k < 2; k++) {
        low[k] -= most > 0 ? most : 1;
        high[k] += most > 0 ? most : 1;
    }
}

/* Its name among others, and that it ended early. */
static char *heading_of(const run_picture *picture, const orbit *o) {
    char *name = text_print("%s", picture->orbits.count > 1 ? o->name : "");
    if (!o->status)
        return name;
    return text_print("%s%sended at t = %.4g", name, *name ? ", " : "", o->t);
}

/* One orbit up to row `last`, or to where it ended. */
static void draw_moment(plot *to, const bob_list *b, const orbit *o,
                        size_t last) {
    size_t parts = nevh_scene_part_count(b->scene);
    if (o->rows.count == 0)
        return;
    last = last < o->rows.count ? last : o->rows.count - 1;
    for (size_t bob = 0; bob < b->count; bob++) {
        size_t trail = new_series(to, o, PLOT_TRAIL, PLOT_REFERENCE);
        for (size_t i = last > TRAIL ? last - TRAIL : 0; i <= last; i++)
            plot_point(to, trail, orbit_row(o, i)[4 * b->part[bob]],
                       orbit_row(o, i)[4 * b->part[bob] + 1]);
    }
    for (size_t i = 0; i < parts; i++)
        if (strcmp(nevh_scene_part_at(b->scene, i).kind, "rod") == 0)
            draw_rod(to, orbit_row(o, last) + 4 * i);
    for (size_t bob = 0; bob < b->count; bob++)
        draw_bob(to, b, bob, o, orbit_row(o, last) + 4 * b->part[bob]);
    for (size_t bob = 0; bob < b->count; bob++)
        name_bob(to, b, bob, orbit_row(o, last) + 4 * b->part[bob]);
}

static plot *draw_frame(const run_picture *picture, const bob_list *b,
                        size_t frame, const double low[2], const double high[2],
                        const char *more) {
    const plan *p = &picture->plan;
    double begin = p->run->t_start, span = p->t_end - begin;
    int digits = (int)fmax(0, 2 - floor(log10(span)));
    char *x = axis_label(p, b, 0), *y = axis_label(p, b, 1);
    plot *to = plot_new(p->title, x, y);
    for (size_t i = 0; i < picture->orbits.count; i++) {
        const orbit *o = &picture->orbits.item[i];
        char *heading = heading_of(picture, o);
        if (i)
            plot_panel(to, heading, x, y);
        else
            plot_heading(to, *heading ? heading : NULL);
        plot_equal(to);
        plot_span_x(to, low[0], high[0]);
        plot_span_y(to, low[1], high[1]);
        draw_moment(to, b, o, frame * EACH);
    }
    char *when = text_print("t = %.*f%s%s%s", digits,
                            begin + span * (double)frame / FRAMES, p->unit,
                            *more ? "; " : "", more);
    picture_note(picture, to, when);
    return to;
}

plot *plot_animation(run_picture *picture) {
    static const double turns = 6;
    bob_list b = bobs_of(picture->plan.scene);
    double low[2], high[2];
    plot *first = NULL, *last = NULL;
    if (picture->orbits.count > MOST_PANELS) {
        tool_refuse("--plot-kind animation draws up to %d orbits side by side",
                    MOST_PANELS);
        return NULL;
    }
    bool quiet = picture->quiet;
    double seen = 0;
    picture->quiet = true;
    follow_dense(picture, &b);
    picture->quiet = quiet;
    for (size_t i = 0; i < picture->orbits.count; i++)
        seen = fmax(seen, least_turns(&b, &picture->orbits.item[i]));
    char *cut = picture_cut(picture, seen, turns);
    follow_evenly(picture, &b);
    find_reach(picture->orbits.item, nevh_scene_part_count(b.scene), low, high);
    for (size_t i = 0; i <= FRAMES; i++) {
        plot *next = draw_frame(picture, &b, i, low, high, cut ? cut : "");
        if (last)
            plot_then(last, next);
        else
            first = next;
        last = next;
    }
    return first;
}

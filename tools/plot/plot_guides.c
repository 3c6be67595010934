/* nevh: plots: where the names of guides have room.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>

static bool is_covered(const guide_name *all, size_t count,
                       const guide_name *one) {
    for (size_t i = 0; i < count; i++)
        if (one->left < all[i].right && all[i].left < one->right &&
            fabs(one->middle - all[i].middle) < 1.2 * PLOT_NOTE_FONT)
            return true;
    return false;
}

static bool is_crossed_by(const guide_name *one, pair a, pair b) {
    const double half = 0.6 * PLOT_NOTE_FONT;
    return plot_clip(&a, &b, (pair){one->left, one->middle - half},
                     (pair){one->right, one->middle + half});
}

/* True if the disc of a body, or another large mark, is under the name. */
static bool is_marked(const guide_name *one, double radius, pair at) {
    return radius > 0 && at.x + radius > one->left &&
           at.x - radius < one->right &&
           fabs(at.y - one->middle) < radius + 0.6 * PLOT_NOTE_FONT;
}

static double mark_radius(const plot *p, const series *s) {
    plot_look look = plot_look_of(p, s);
    return look.mark && look.size >= 0.7 && s->count < 3 ? 5.25 * look.size : 0;
}

/* True if a curve of the panel, another guide, or a mark crosses the name. */
static bool is_crossed(const plot *p, const series *guide,
                       const plot_screen *on, const guide_name *one) {
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        if (s == guide || s->panel != guide->panel)
            continue;
        double radius = mark_radius(p, s);
        for (size_t k = 0; k < s->count && radius > 0; k++)
            if (is_marked(one, radius, plot_in_pixels(on, s->point[k])))
                return true;
        for (size_t k = 1; k < s->count; k++)
            if (is_crossed_by(one, plot_in_pixels(on, s->point[k - 1]),
                              plot_in_pixels(on, s->point[k])))
                return true;
    }
    return false;
}

enum { PLACES = 10, SIDES = 10 };

/* The place number n of a name of that width: beside the guide, from its end on, on
   one side and the other, then farther away; of a point in its line, then in lines
   below and above. */
static guide_name place_at(const series *s, const plot_screen *on, double width,
                           size_t n) {
    enum { NEAR = 4 };
    static const double sides[SIDES] = {4,   -4, 14,  -14, 24,
                                        -24, 34, -34, 44,  -44};
    bool is_point = s->count < 2;
    double side = sides[is_point ? n % NEAR : n / PLACES];
    size_t k = is_point ? n / NEAR : n % PLACES;
    double share = (double)k / PLACES;
    double lines = (k % 2 ? -1.0 : 1.0) * (double)((k + 1) / 2);
    pair first = plot_in_pixels(on, s->point[0]);
    pair last = plot_in_pixels(on, s->point[s->count - 1]);
    double x =
        last.x + share * (first.x - last.x) + side - (side < 0 ? width : 0);
    double y = last.y + share * (first.y - last.y) +
               (is_point ? 1.2 * PLOT_NOTE_FONT * lines : 0);
    return (guide_name){.left = x,
                        .right = x + width,
                        .middle = y,
                        .text = s->name,
                        .from = last};
}

/* The first place within the picture and over no other name, nor, if need be, over a
   curve; false where there is none. */
static bool place_beside(const plot *p, const series *s, const plot_screen *on,
                         double right, bool apart, const guide_name *others,
                         size_t count, guide_name *to) {
    enum { AWAY = 4 };
    double width = 0.6 * PLOT_NOTE_FONT * (double)plot_letters(s->name);
    size_t places = apart ? PLACES * SIDES : PLACES;
    size_t first = apart || s->count > 1 ? 0 : 2; /* off the disc */
    for (size_t n = first; n < places; n++) {
        *to = place_at(s, on, width, n);
        bool within = to->left > AWAY && to->middle > AWAY &&
                      to->middle < on->height - AWAY;
        if (to->right < right && !is_covered(others, count, to) &&
            (!apart || (within && !is_crossed(p, s, on, to))))
            return true;
    }
    return false;
}

/* Joins a name to its point where it is farther away than others may be. */
static void join_name(guide_name *name) {
    static const double near = 24, disc = 10; /* pixels */
    pair *to = &name->to;
    *to = (pair){fmin(fmax(name->from.x, name->left), name->right),
                 fmin(fmax(name->from.y, name->middle - PLOT_NOTE_FONT / 2.),
                      name->middle + PLOT_NOTE_FONT / 2.)};
    double x = to->x - name->from.x, y = to->y - name->from.y;
    double distance = hypot(x, y);
    name->far = distance > near;
    if (name->far)
        name->from = (pair){name->from.x + disc * x / distance,
                            name->from.y + disc * y / distance};
}

static bool is_outside(const plot_screen *on, pair at) {
    return !(at.x >= 0 && at.x <= on->width && at.y >= 0 && at.y <= on->height);
}

/* A point must have its name, a line none that curves cross. */
static bool place_name(const plot *p, const series *s, const plot_screen *on,
                       double right, const guide_name *others, size_t count,
                       guide_name *to) {
    if (s->count < 2 && is_outside(on, plot_in_pixels(on, s->point[0])))
        return false;
    bool placed = place_beside(p, s, on, right, true, others, count, to) ||
                  (s->count < 2 &&
                   place_beside(p, s, on, right, false, others, count, to));
    if (placed && s->count < 2)
        join_name(to);
    return placed;
}

size_t plot_guide_names(const plot *p, size_t number, const layout *l,
                        guide_name names[]) {
    plot_screen on = plot_screen_of(p, number, l);
    size_t count = 0;
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        if (s->panel == number && s->form == PLOT_GUIDE && s->count &&
            place_name(p, s, &on, on.width + l->right, names, count,
                       &names[count]))
            count++;
    }
    return count;
}

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

/* True if a curve of the panel, or another guide, crosses the name. */
static bool is_crossed(const plot *p, const series *guide,
                       const plot_screen *on, const guide_name *one) {
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        if (s == guide || s->panel != guide->panel)
            continue;
        for (size_t k = 1; k < s->count; k++)
            if (is_crossed_by(one, plot_in_pixels(on, s->point[k - 1]),
                              plot_in_pixels(on, s->point[k])))
                return true;
    }
    return false;
}

/* Beside the guide, from its end on, so that it is within the picture and over no
   other, nor, if need be, over a curve; false where it has no place. */
static bool place_beside(const plot *p, const series *s, const plot_screen *on,
                         double right, bool apart, const guide_name *others,
                         size_t count, guide_name *to) {
    enum { PLACES = 10, AWAY = 4 };
    static const double sides[] = {4, -4, 14, -14, 24, -24, 34, -34, 44, -44};
    enum { SIDES = sizeof sides / sizeof *sides };
    pair first = plot_in_pixels(on, s->point[0]);
    pair last = plot_in_pixels(on, s->point[s->count - 1]);
    double width = 0.6 * PLOT_NOTE_FONT * (double)plot_letters(s->name);
    for (size_t i = 0; i < (apart ? SIDES : 1); i++)
        for (int k = 0; k < PLACES; k++) {
            double share = (double)k / PLACES;
            double x = last.x + share * (first.x - last.x) + sides[i] -
                       (sides[i] < 0 ? width : 0);
            double y = last.y + share * (first.y - last.y);
            *to = (guide_name){x, x + width, y, s->name};
            bool within = x > AWAY && y > AWAY && y < on->height - AWAY;
            if (to->right < right && !is_covered(others, count, to) &&
                (!apart || (within && !is_crossed(p, s, on, to))))
                return true;
        }
    return false;
}

static bool place_name(const plot *p, const series *s, const plot_screen *on,
                       double right, const guide_name *others, size_t count,
                       guide_name *to) {
    return place_beside(p, s, on, right, true, others, count, to) ||
           place_beside(p, s, on, right, false, others, count, to);
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

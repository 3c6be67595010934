/* nevh: plots: where the names of guides have room.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>

enum { PLACES = 10, LINE_SIDES = 10, POINT_SIDES = 5 };

static bool is_covered(const guide_name *all, size_t count,
                       const guide_name *one) {
    for (size_t i = 0; i < count; i++)
        if (one->left < all[i].right && all[i].left < one->right &&
            fabs(one->middle - all[i].middle) < 1.2 * one->letter)
            return true;
    return false;
}

static bool is_crossed_by(const guide_name *one, pair a, pair b) {
    const double half = 0.6 * one->letter;
    return plot_clip(&a, &b, (pair){one->left, one->middle - half},
                     (pair){one->right, one->middle + half});
}

/* True if the disc of a body, or another large mark, is under the name. */
static bool is_marked(const guide_name *one, double radius, pair at) {
    return radius > 0 && at.x + radius > one->left &&
           at.x - radius < one->right &&
           fabs(at.y - one->middle) < radius + 0.6 * one->letter;
}

static double mark_radius(const plot *p, const series *s) {
    plot_look look = plot_look_of(p, s);
    return look.mark && look.size >= 0.7 && s->count < 3 ? 5.25 * look.size : 0;
}

/* True if a mark, or, if need be, a curve of the panel or another guide crosses the
   name. */
static bool is_crossed(const plot *p, const series *guide,
                       const plot_screen *on, const guide_name *one,
                       bool by_curves) {
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        if (s == guide || s->panel != guide->panel)
            continue;
        double radius = mark_radius(p, s);
        for (size_t k = 0; k < s->count && radius > 0; k++)
            if (is_marked(one, radius, plot_in_pixels(on, s->point[k])))
                return true;
        for (size_t k = 1; k < s->count && by_curves; k++)
            if (is_crossed_by(one, plot_in_pixels(on, s->point[k - 1]),
                              plot_in_pixels(on, s->point[k])))
                return true;
    }
    return false;
}

/* The place number n of a line's name, of that width: beside its end, on one side and
   the other, then farther away and farther along. */
static guide_name place_of_line(const series *s, const plot_screen *on,
                                double width, size_t n) {
    double side =
        (n / PLACES % 2 ? -1 : 1) * (4 + 10. * (double)(n / PLACES / 2));
    double share = (double)(n % PLACES) / PLACES;
    pair first = plot_in_pixels(on, s->point[0]);
    pair last = plot_in_pixels(on, s->point[s->count - 1]);
    return (guide_name){.left = last.x + share * (first.x - last.x) + side -
                                (side < 0 ? width : 0),
                        .middle = last.y + share * (first.y - last.y),
                        .from = last};
}

/* The place number n of a point's name: beside it, then in lines below and above, also
   over its middle. */
static guide_name place_of_point(const series *s, const plot_screen *on,
                                 double width, double letter, size_t n) {
    static const double sides[POINT_SIDES - 1] = {8, -8, 14, -14};
    size_t side = n % POINT_SIDES, line = n / POINT_SIDES;
    double lines = (line % 2 ? -0.6 : 0.6) * (double)((line + 1) / 2);
    pair at = plot_in_pixels(on, s->point[0]);
    double beside = side == POINT_SIDES - 1 ? -width / 2
                    : sides[side] < 0       ? sides[side] - width
                                            : sides[side];
    return (guide_name){
        .left = at.x + beside, .middle = at.y + letter * lines, .from = at};
}

/* Selects what may be under a name; another name never may. */
typedef enum { NOTHING, CURVES, ANYTHING } under;

/* The first place within the picture that is allowed; false where there is none. */
static bool find_place(const plot *p, const series *s, const plot_screen *on,
                       double right, under allowed, size_t places,
                       const guide_name *others, size_t count, guide_name *to) {
    enum { AWAY = 4 };
    double letter = to->letter;
    double width = 0.6 * letter * (double)plot_letters(s->name);
    for (size_t n = 0; n < places; n++) {
        *to = s->count < 2 ? place_of_point(s, on, width, letter, n)
                           : place_of_line(s, on, width, n);
        to->right = to->left + width;
        to->text = s->name;
        to->letter = letter;
        bool within = to->left > AWAY && to->middle > AWAY &&
                      to->middle < on->height - AWAY;
        if (to->right < right && !is_covered(others, count, to) &&
            (allowed == ANYTHING ||
             (within && !is_crossed(p, s, on, to, allowed == NOTHING))))
            return true;
    }
    return false;
}

/* Joins a name to its point where it is farther away than others may be. */
static void join_name(guide_name *name) {
    static const double near = 24, disc = 10; /* pixels */
    pair *to = &name->to;
    *to = (pair){fmin(fmax(name->from.x, name->left), name->right),
                 fmin(fmax(name->from.y, name->middle - name->letter / 2),
                      name->middle + name->letter / 2)};
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

/* A point must have its name, near it rather than off the curves; a line none that
   curves cross. */
static bool place_name(const plot *p, const series *s, const plot_screen *on,
                       double right, const guide_name *others, size_t count,
                       guide_name *to) {
    static const struct {
        under allowed;
        size_t places;
    } tries[] = {{NOTHING, 9 * POINT_SIDES},
                 {CURVES, 9 * POINT_SIDES},
                 {NOTHING, 41 * POINT_SIDES},
                 {ANYTHING, 9 * POINT_SIDES}};
    if (s->count > 1)
        return find_place(p, s, on, right, NOTHING, PLACES * LINE_SIDES, others,
                          count, to);
    if (is_outside(on, plot_in_pixels(on, s->point[0])))
        return false;
    for (size_t i = 0; i < sizeof tries / sizeof *tries; i++)
        if (find_place(p, s, on, right, tries[i].allowed, tries[i].places,
                       others, count, to)) {
            join_name(to);
            return true;
        }
    return false;
}

size_t plot_guide_names(const plot *p, size_t number, const layout *l,
                        guide_name names[]) {
    plot_screen on = plot_screen_of(p, number, l);
    size_t count = 0;
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        names[count].letter = l->small;
        if (s->panel == number && s->form == PLOT_GUIDE && s->count &&
            place_name(p, s, &on, on.width + l->right, names, count,
                       &names[count]))
            count++;
    }
    return count;
}

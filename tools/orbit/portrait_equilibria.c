/* nevh portrait: where the gradient of H is 0 in a window.

   Newton's method begins in each cell of a fine grid at whose corners both
   derivatives change their signs, or where the gradient is smallest among its
   neighbours: at a degenerate point a derivative may touch 0 and not cross it.
   Both coordinates are measured in cells, so that derivatives are energies.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "portrait.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 1537, ROWS = 257, MOST_STEPS = 80, MOST_EQUILIBRIA = 4000 };

/* The grid goes a cell beyond the window on all sides. */
typedef struct {
    levels *l;
    double *f; /* both derivatives, COLUMNS x ROWS each */
    double low[2], cell[2];
} survey;

/* The derivatives at z, in cells. */
static int gradient(const survey *s, const double z[2], double f[2]) {
    double t = s->l->plan->run->t_start;
    double x = s->low[0] + s->cell[0] * z[0], y = s->low[1] + s->cell[1] * z[1];
    int status = nevh_field_gradient(s->l->field, 1, &t, &x, &y, &f[0], &f[1]);
    f[0] *= s->cell[0];
    f[1] *= s->cell[1];
    return status;
}

/* j[2*i + k] = d f[i]/d z[k], by differences over that length. */
static int hessian(const survey *s, const double z[2], double length,
                   double j[4]) {
    for (int k = 0; k < 2; k++) {
        double at[2] = {z[0], z[1]}, high[2], low[2];
        at[k] = z[k] + length;
        int status = gradient(s, at, high);
        at[k] = z[k] - length;
        if (status || (status = gradient(s, at, low)))
            return status;
        for (int i = 0; i < 2; i++)
            j[2 * i + k] = (high[i] - low[i]) / (2 * length);
    }
    return 0;
}

/* Newton's method in two variables is written out: GSL's allocates in each step,
   and does not look whether it got the memory.  j dz = -f; where j is singular,
   the shortest dz that comes nearest. */
static bool solve(const double j[4], const double f[2], double dz[2]) {
    static const double singular = 1e-13;
    double determinant = j[0] * j[3] - j[1] * j[2], square = 0;
    for (int i = 0; i < 4; i++)
        square += j[i] * j[i];
    if (fabs(determinant) >
        singular * (fabs(j[0] * j[3]) + fabs(j[1] * j[2]))) {
        dz[0] = (j[1] * f[1] - j[3] * f[0]) / determinant;
        dz[1] = (j[2] * f[0] - j[0] * f[1]) / determinant;
    } else {
        dz[0] = -(j[0] * f[0] + j[2] * f[1]) / square;
        dz[1] = -(j[1] * f[0] + j[3] * f[1]) / square;
    }
    return isfinite(dz[0]) && isfinite(dz[1]);
}

/* The longest part of dz, halved at most so often, that makes the gradient, f,
   smaller; z, f and dz become those of that step. */
static bool take_step(const survey *s, double z[2], double f[2], double dz[2]) {
    enum { HALVINGS = 30 };
    double size = hypot(f[0], f[1]);
    for (int i = 0; i < HALVINGS; i++) {
        double at[2] = {z[0] + dz[0], z[1] + dz[1]}, next[2];
        if (!gradient(s, at, next) && hypot(next[0], next[1]) <= size) {
            for (int k = 0; k < 2; k++) {
                z[k] = at[k];
                f[k] = next[k];
            }
            return true;
        }
        dz[0] /= 2;
        dz[1] /= 2;
    }
    return false;
}

/* The largest of either derivative one cell to either side. */
static void size_around(const survey *s, const double z[2], double size[2]) {
    size[0] = size[1] = 0;
    for (int n = 0; n < 4; n++) {
        double f[2], at[2] = {z[0], z[1]};
        at[n / 2] += n % 2 ? 1 : -1;
        if (gradient(s, at, f))
            continue;
        size[0] = fmax(size[0], fabs(f[0]));
        size[1] = fmax(size[1], fabs(f[1]));
    }
}

/* Damped Newton steps from z, in and out.  Differences get shorter with the steps,
   which go on by a part of the way alone near a degenerate point.
   returns  whether that is an equilibrium: the gradient is far below that around */
static bool refine(const survey *s, double z[2]) {
    static const double small = 1e-7, longest = 1e-2, shortest = 1e-6;
    static const double far_below = 1e-5;
    double f[2], j[4], dz[2], size[2], length = longest;
    if (gradient(s, z, f))
        return false;
    for (int i = 0; i < MOST_STEPS; i++) {
        if (hessian(s, z, length, j) || !solve(j, f, dz) ||
            !take_step(s, z, f, dz))
            break;
        double moved = fmax(fabs(dz[0]), fabs(dz[1]));
        length = fmax(shortest, fmin(longest, moved));
        if (moved < small)
            break;
    }
    size_around(s, z, size);
    return fabs(f[0]) <= far_below * size[0] &&
           fabs(f[1]) <= far_below * size[1];
}

static bool is_inside(const double z[2]) {
    static const double edge = 1e-3;
    return z[0] >= 1 - edge && z[0] <= COLUMNS - 2 + edge && z[1] >= 1 - edge &&
           z[1] <= ROWS - 2 + edge;
}

/* Degenerate where the determinant is far below what the derivatives around make of
   it. */
static bool kind_of(const survey *s, const double z[2], equilibrium *e) {
    static const double length = 1e-4, little = 1e-3;
    double j[4], size[2];
    if (hessian(s, z, length, j))
        return false;
    size_around(s, z, size);
    double determinant = j[0] * j[3] - j[1] * j[2];
    double around =
        fmax(size[0] * size[1], fabs(j[0] * j[3]) + fabs(j[1] * j[2]));
    e->kind = !(fabs(determinant) > little * around) ? PORTRAIT_DEGENERATE
              : determinant > 0                      ? PORTRAIT_CENTRE
                                                     : PORTRAIT_SADDLE;
    return true;
}

/* 0, where that is what rounding leaves. */
static double place(const survey *s, int k, double z) {
    double x = s->low[k] + s->cell[k] * z;
    return fabs(x) < 1e-5 * s->cell[k] ? 0 : x;
}

/* H there; 0 where it is no larger than its own rounding: H of places so near that it is
   the same, for it is level there, differs by as much. */
static double energy_at(const survey *s, double x, double y) {
    static const double beside = 1e-9, few = 4; /* of a cell */
    double h = levels_energy(s->l, x, y), rounding = 0;
    for (int i = -4; i <= 4; i++) {
        double move = beside * i;
        double there =
            levels_energy(s->l, x + move * s->cell[0], y + move * s->cell[1]);
        rounding = fmax(rounding, fabs(there - h));
    }
    return fabs(h) <= few * rounding ? 0 : h;
}

static void add(const survey *s, const double z[2]) {
    static const double near = 1e-2;
    levels *l = s->l;
    equilibrium e = {.x = place(s, 0, z[0]), .y = place(s, 1, z[1])};
    if (!is_inside(z) || l->count == MOST_EQUILIBRIA || !kind_of(s, z, &e))
        return;
    for (size_t i = 0; i < l->count; i++)
        if (fabs(l->found[i].x - e.x) < near * s->cell[0] &&
            fabs(l->found[i].y - e.y) < near * s->cell[1])
            return;
    e.energy = energy_at(s, e.x, e.y);
    e.distance = hypot((e.x - l->plan->q[0]) / s->cell[0] / (COLUMNS - 1),
                       (e.y - l->plan->p[0]) / s->cell[1] / (ROWS - 1));
    l->found = tool_grown(l->found, l->count, sizeof *l->found);
    l->found[l->count++] = e;
}

/* Newton's method may leave a cell for the equilibrium of another: then it begins
   in the cell's quarters, too. */
static void search(const survey *s, size_t i, size_t k) {
    static const double from[][2] = {
        {0.5, 0.5}, {0.25, 0.25}, {0.75, 0.25}, {0.25, 0.75}, {0.75, 0.75}};
    for (size_t n = 0; n < sizeof from / sizeof *from; n++) {
        double middle[2] = {(double)i + from[n][0], (double)k + from[n][1]};
        double z[2] = {middle[0], middle[1]};
        if (!refine(s, z))
            continue;
        add(s, z);
        if (fabs(z[0] - middle[0]) < 2 && fabs(z[1] - middle[1]) < 2)
            return;
    }
}

/* The start, where it is one: of a curve of them the grid has others. */
static void search_start(const survey *s) {
    static const double near = 1e-2;
    const plan *p = s->l->plan;
    const double start[2] = {(p->q[0] - s->low[0]) / s->cell[0],
                             (p->p[0] - s->low[1]) / s->cell[1]};
    double z[2] = {start[0], start[1]};
    if (refine(s, z) && fabs(z[0] - start[0]) < near &&
        fabs(z[1] - start[1]) < near)
        add(s, z);
}

/* room: t, x and y of all columns */
static void measure_row(const survey *s, size_t k, double room[]) {
    nevh_field *field = s->l->field;
    double *f = s->f + k * COLUMNS, *g = f + COLUMNS * ROWS;
    double *t = room, *x = t + COLUMNS, *y = x + COLUMNS;
    for (size_t i = 0; i < COLUMNS; i++) {
        x[i] = s->low[0] + s->cell[0] * (double)i;
        y[i] = s->low[1] + s->cell[1] * (double)k;
    }
    bool whole = !nevh_field_gradient(field, COLUMNS, t, x, y, f, g);
    for (size_t i = 0; i < COLUMNS; i++) {
        if (!whole &&
            nevh_field_gradient(field, 1, t, &x[i], &y[i], &f[i], &g[i]))
            f[i] = g[i] = NAN;
        f[i] *= s->cell[0];
        g[i] *= s->cell[1];
    }
}

static void measure(const survey *s) {
    double *room = tool_allocate(3 * COLUMNS, sizeof *room);
    for (size_t i = 0; i < COLUMNS; i++)
        room[i] = s->l->plan->run->t_start;
    for (size_t k = 0; k < ROWS; k++)
        measure_row(s, k, room);
}

/* Both derivatives, of all corners: not of one sign. */
static bool changes_signs(const survey *s, size_t i, size_t k) {
    for (size_t d = 0; d < 2; d++) {
        const double *f = s->f + d * COLUMNS * ROWS + k * COLUMNS + i;
        const double corner[] = {f[0], f[1], f[COLUMNS], f[COLUMNS + 1]};
        double low = INFINITY, high = -INFINITY;
        for (int n = 0; n < 4; n++) {
            if (!isfinite(corner[n]))
                return false;
            low = fmin(low, corner[n]);
            high = fmax(high, corner[n]);
        }
        if (low > 0 || high < 0)
            return false;
    }
    return true;
}

/* True if none of the eight neighbours is smaller, and one is larger. */
static bool is_smallest(const survey *s, size_t i, size_t k) {
    const double *f = s->f + k * COLUMNS + i, *g = f + COLUMNS * ROWS;
    double here = hypot(f[0], g[0]);
    bool larger = false;
    for (int n = 0; n < 9; n++) {
        long at = (n / 3 - 1) * COLUMNS + n % 3 - 1;
        double there = hypot(f[at], g[at]);
        if (there < here)
            return false;
        larger = larger || there > here;
    }
    return larger;
}

static int by_distance(const void *a, const void *b) {
    const equilibrium *one = a, *other = b;
    if (one->distance != other->distance)
        return one->distance < other->distance ? -1 : 1;
    return one->x != other->x ? (one->x < other->x) - (one->x > other->x)
                              : (one->y < other->y) - (one->y > other->y);
}

/* Degenerate ones that fill a curve: the nearest alone is left. */
static void thin_curve(levels *l) {
    enum { MANY = 50 };
    size_t degenerate = 0, kept = 0;
    for (size_t i = 0; i < l->count; i++)
        degenerate += l->found[i].kind == PORTRAIT_DEGENERATE;
    l->curve = degenerate > MANY;
    bool any = false;
    for (size_t i = 0; l->curve && i < l->count; i++) {
        bool of_curve = l->found[i].kind == PORTRAIT_DEGENERATE;
        if (!of_curve || !any)
            l->found[kept++] = l->found[i];
        any = any || of_curve;
    }
    l->count = l->curve ? kept : l->count;
}

void levels_find_equilibria(levels *l) {
    const portrait_window *w = &l->window;
    survey s = {.l = l,
                .f = tool_allocate(2 * COLUMNS * ROWS, sizeof(double)),
                .cell = {(w->high_x - w->low_x) / (COLUMNS - 3),
                         (w->high_y - w->low_y) / (ROWS - 3)}};
    s.low[0] = w->low_x - s.cell[0];
    s.low[1] = w->low_y - s.cell[1];
    measure(&s);
    search_start(&s);
    for (size_t k = 0; k + 1 < ROWS; k++)
        for (size_t i = 0; i + 1 < COLUMNS; i++) {
            bool inside = i > 0 && k > 0;
            if (changes_signs(&s, i, k) || (inside && is_smallest(&s, i, k)))
                search(&s, i, k);
        }
    tool_release(s.f);
    if (l->count)
        qsort(l->found, l->count, sizeof *l->found, by_distance);
    l->many = l->count == MOST_EQUILIBRIA;
    thin_curve(l);
}

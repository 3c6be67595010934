/* nevh portrait: level curves of H, its equilibria and separatrices.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "portrait.h"
#include <math.h>
#include <stdlib.h>

enum { ACROSS = 201, UP = 161, STARTS = 24, MOST_STEPS = 60 };

double levels_energy(const levels *l, double x, double y) {
    double h, t = l->plan->run->t_start;
    return nevh_field_value(l->field, 1, &t, &x, &y, &h) ? NAN : h;
}

static double x_at(const levels *l, size_t i) {
    const portrait_window *w = &l->window;
    return w->low_x + (w->high_x - w->low_x) * (double)i / (ACROSS - 1);
}

static double y_at(const levels *l, size_t k) {
    const portrait_window *w = &l->window;
    return w->low_y + (w->high_y - w->low_y) * (double)k / (UP - 1);
}

/* Equilibria. */

/* Newton's method in two variables is written out: GSL's allocates in each step,
   and does not look whether it got the memory. */
static int gradient(const levels *l, const double z[2], double f[2]) {
    double t = l->plan->run->t_start;
    return nevh_field_gradient(l->field, 1, &t, &z[0], &z[1], &f[0], &f[1]);
}

/* j[2*i + k] = d f[i]/d z[k], by differences that are small against the window. */
static int hessian(const levels *l, const double z[2], double j[4]) {
    static const double part = 1e-5;
    double length[2] = {part * (l->window.high_x - l->window.low_x),
                        part * (l->window.high_y - l->window.low_y)};
    for (int k = 0; k < 2; k++) {
        double at[2] = {z[0], z[1]}, high[2], low[2];
        at[k] = z[k] + length[k];
        int status = gradient(l, at, high);
        at[k] = z[k] - length[k];
        if (status || (status = gradient(l, at, low)))
            return status;
        for (int i = 0; i < 2; i++)
            j[2 * i + k] = (high[i] - low[i]) / (2 * length[k]);
    }
    return 0;
}

static bool is_inside(const portrait_window *w, double x, double y) {
    double edge_x = 1e-6 * (w->high_x - w->low_x);
    return x >= w->low_x - edge_x && x <= w->high_x + edge_x && y >= w->low_y &&
           y <= w->high_y;
}

static void add(levels *l, const double z[2]) {
    static const double near = 1e-5, little = 1e-6;
    const portrait_window *w = &l->window;
    double width = w->high_x - w->low_x, height = w->high_y - w->low_y;
    double x = z[0], y = z[1], part[4];
    if (!is_inside(w, x, y) || hessian(l, z, part))
        return;
    for (size_t i = 0; i < l->count; i++)
        if (fabs(l->found[i].x - x) < near * width &&
            fabs(l->found[i].y - y) < near * height)
            return;
    double a = part[0] * width * width, b = part[3] * height * height;
    double c = part[1] * width * height, size = fmax(fabs(a), fabs(b));
    double determinant = a * b - c * c;
    l->found = tool_enlarge(l->found, l->count + 1, sizeof *l->found);
    l->found[l->count++] = (equilibrium){
        fabs(x) < near * width * 1e-3 ? 0 : x,
        fabs(y) < near * height * 1e-3 ? 0 : y, levels_energy(l, x, y),
        fabs(determinant) < little * size * size ? PORTRAIT_DEGENERATE
        : determinant > 0                        ? PORTRAIT_CENTRE
                                                 : PORTRAIT_SADDLE};
}

/* j dz = -f; false where that has no solution. */
static bool solve(const double j[4], const double f[2], double dz[2]) {
    double determinant = j[0] * j[3] - j[1] * j[2];
    dz[0] = (j[1] * f[1] - j[3] * f[0]) / determinant;
    dz[1] = (j[2] * f[0] - j[0] * f[1]) / determinant;
    return isfinite(dz[0]) && isfinite(dz[1]);
}

/* The longest part of dz, halved at most so often, that makes the gradient, f,
   smaller; z, f and dz become those of that step. */
static bool take_step(const levels *l, double z[2], double f[2], double dz[2]) {
    enum { HALVINGS = 30 };
    double size = hypot(f[0], f[1]);
    for (int i = 0; i < HALVINGS; i++) {
        double at[2] = {z[0] + dz[0], z[1] + dz[1]}, next[2];
        if (!gradient(l, at, next) && hypot(next[0], next[1]) <= size) {
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

/* Damped Newton steps from a place of the grid. */
static void search(levels *l, double x, double y) {
    static const double small = 1e-10;
    const portrait_window *w = &l->window;
    double z[2] = {x, y}, f[2], j[4], dz[2];
    if (gradient(l, z, f))
        return;
    for (int i = 0; i < MOST_STEPS; i++) {
        if (hessian(l, z, j) || !solve(j, f, dz))
            return;
        bool near = fabs(dz[0]) < small * (w->high_x - w->low_x) &&
                    fabs(dz[1]) < small * (w->high_y - w->low_y);
        if (near) {
            add(l, (double[]){z[0] + dz[0], z[1] + dz[1]});
            return;
        }
        if (!take_step(l, z, f, dz))
            return;
    }
}

static int by_place(const void *a, const void *b) {
    const equilibrium *one = a, *other = b;
    return one->x != other->x ? (one->x > other->x) - (one->x < other->x)
                              : (one->y > other->y) - (one->y < other->y);
}

static void find_equilibria(levels *l) {
    const portrait_window *w = &l->window;
    for (int i = 0; i < STARTS; i++)
        for (int k = 0; k < STARTS; k++)
            search(l, w->low_x + (w->high_x - w->low_x) * (i + 0.5) / STARTS,
                   w->low_y + (w->high_y - w->low_y) * (k + 0.5) / STARTS);
    if (l->count)
        qsort(l->found, l->count, sizeof *l->found, by_place);
}

int levels_new(levels *l, const plan *p, portrait_window w) {
    nevh_options o = plan_options(p, "exact");
    *l = (levels){.plan = p, .window = w};
    l->field = nevh_field_new(p->system, &o);
    if (nevh_field_status(l->field)) {
        nevh_field_free(l->field);
        o.gradient = nevh_central6;
        l->field = nevh_field_new(p->system, &o);
    }
    if (nevh_field_status(l->field))
        return tool_refuse("%s: %s", p->name, nevh_field_message(l->field));
    l->h = tool_allocate(ACROSS * UP, sizeof *l->h);
    for (size_t k = 0; k < UP; k++)
        for (size_t i = 0; i < ACROSS; i++)
            l->h[k * ACROSS + i] = levels_energy(l, x_at(l, i), y_at(l, k));
    find_equilibria(l);
    return TOOL_OK;
}

void levels_free(levels *l) {
    nevh_field_free(l->field);
    free(l->h);
    free(l->found);
}

/* Curves. */

/* Where a level crosses an edge of the grid: from a corner to the one on its
   right, or, those after them, to the one above it. */
typedef struct {
    double x, y;
    size_t count, next[2]; /* crossings that a curve goes on to */
} crossing;
enum { EDGES = 2 * ACROSS * UP };

static bool cross(const levels *l, double level, size_t edge, crossing *c) {
    bool upright = edge >= ACROSS * UP;
    size_t from = edge % (ACROSS * UP), to = from + (upright ? ACROSS : 1);
    size_t i[2] = {from % ACROSS, to % ACROSS};
    size_t k[2] = {from / ACROSS, to / ACROSS};
    double a = l->h[from] - level, b = l->h[to] - level;
    if (!((a < 0 && b >= 0) || (a >= 0 && b < 0)))
        return false;
    double part = a / (a - b);
    c->x = x_at(l, i[0]) + part * (x_at(l, i[1]) - x_at(l, i[0]));
    c->y = y_at(l, k[0]) + part * (y_at(l, k[1]) - y_at(l, k[0]));
    return true;
}

static void join(crossing *all, size_t a, size_t b) {
    all[a].next[all[a].count++] = b;
    all[b].next[all[b].count++] = a;
}

/* Marching squares: the crossings of a cell's edges, two by two. */
static void find_crossings(const levels *l, double level, crossing *all) {
    for (size_t k = 0; k + 1 < UP; k++)
        for (size_t i = 0; i + 1 < ACROSS; i++) {
            size_t at = k * ACROSS + i, up = ACROSS * UP + at;
            size_t edge[4] = {at, up + 1, at + ACROSS, up}, last = EDGES;
            for (int e = 0; e < 4; e++) {
                if (!cross(l, level, edge[e], &all[edge[e]]))
                    continue;
                if (last < EDGES)
                    join(all, last, edge[e]);
                last = last < EDGES ? EDGES : edge[e];
            }
        }
}

static void leave(crossing *c, size_t to) {
    if (c->next[0] == to)
        c->next[0] = c->next[1];
    c->count--;
}

static void draw_curve(crossing *all, size_t at, plot *to, size_t series) {
    plot_point(to, series, all[at].x, all[at].y);
    while (all[at].count) {
        size_t next = all[at].next[0];
        leave(&all[at], next);
        leave(&all[next], at);
        at = next;
        plot_point(to, series, all[at].x, all[at].y);
    }
    plot_break(to, series);
}

/* Curves that end at the window first, then those that are closed. */
static void draw_level(const levels *l, plot *to, size_t series, double level) {
    crossing *all = tool_allocate(EDGES, sizeof *all);
    find_crossings(l, level, all);
    for (size_t count = 1; count <= 2; count++)
        for (size_t i = 0; i < EDGES; i++)
            if (all[i].count == count)
                draw_curve(all, i, to, series);
    free(all);
}

static void draw_equilibria(const levels *l, plot *to) {
    static const char *const names[] = {"centre", "saddle", "degenerate"};
    static const plot_form forms[] = {PLOT_CENTRE, PLOT_SADDLE, PLOT_CENTRE};
    _Static_assert(sizeof names / sizeof *names == PORTRAIT_KINDS &&
                       sizeof forms / sizeof *forms == PORTRAIT_KINDS,
                   "each kind");
    for (int kind = 0; kind < PORTRAIT_KINDS; kind++) {
        size_t series = 0, count = 0;
        for (size_t i = 0; i < l->count; i++) {
            if ((int)l->found[i].kind != kind)
                continue;
            if (!count++) {
                series = plot_series(to, names[kind]);
                plot_style(to, series, forms[kind]);
            }
            plot_point(to, series, l->found[i].x, l->found[i].y);
        }
    }
}

void levels_draw(const levels *l, plot *to, const double energy[],
                 size_t count) {
    size_t series = plot_series(to, NULL);
    bool any = false;
    plot_style(to, series, PLOT_LEVEL);
    for (size_t i = 0; i < count; i++)
        draw_level(l, to, series, energy[i]);
    for (size_t i = 0; i < l->count; i++)
        any = any || l->found[i].kind == PORTRAIT_SADDLE;
    if (any) {
        series = plot_series(to, "separatrix");
        plot_style(to, series, PLOT_SEPARATRIX);
    }
    for (size_t i = 0; any && i < l->count; i++) {
        bool told = l->found[i].kind != PORTRAIT_SADDLE;
        for (size_t k = 0; !told && k < i; k++)
            told = l->found[k].kind == PORTRAIT_SADDLE &&
                   fabs(l->found[k].energy - l->found[i].energy) <=
                       1e-9 * fabs(l->found[i].energy);
        if (!told)
            draw_level(l, to, series, l->found[i].energy);
    }
    draw_equilibria(l, to);
}

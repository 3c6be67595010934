/* nevh portrait: level curves of H, and separatrices.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "portrait.h"
#include <math.h>
#include <stdlib.h>

enum { ACROSS = 201, UP = 161 };

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

nevh_field *levels_field(const plan *p) {
    nevh_options o = plan_options(p, "exact");
    nevh_field *field = nevh_field_new(p->system, &o);
    if (nevh_field_status(field)) {
        nevh_field_free(field);
        o.gradient = nevh_central6;
        field = nevh_field_new(p->system, &o);
    }
    return field;
}

int levels_new(levels *l, const plan *p, portrait_window w) {
    *l = (levels){.plan = p, .window = w, .field = levels_field(p)};
    if (nevh_field_status(l->field))
        return tool_refuse("%s: %s", p->name, nevh_field_message(l->field));
    l->h = tool_allocate(ACROSS * UP, sizeof *l->h);
    for (size_t k = 0; k < UP; k++)
        for (size_t i = 0; i < ACROSS; i++)
            l->h[k * ACROSS + i] = levels_energy(l, x_at(l, i), y_at(l, k));
    levels_find_equilibria(l);
    return TOOL_OK;
}

/* Curves. */

/* The point at which a level crosses an edge of the grid. The first ACROSS * UP
   edges go from a corner to its right, the others upwards. */
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
    tool_release(all);
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
        bool known = l->found[i].kind != PORTRAIT_SADDLE;
        for (size_t k = 0; !known && k < i; k++)
            known = l->found[k].kind == PORTRAIT_SADDLE &&
                    fabs(l->found[k].energy - l->found[i].energy) <=
                        1e-9 * fabs(l->found[i].energy);
        if (!known)
            draw_level(l, to, series, l->found[i].energy);
    }
    draw_equilibria(l, to);
}

/* nevh flow --shape: discs, rectangles, the cat, and loops.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "flow_shape.h"
#include <ctype.h>
#include <math.h>
#include <string.h>

static const double turn = 6.283185307179586;

/* The outlines, about 1 from 0. */

static void disc_at(double s, double *x, double *y) {
    *x = cos(turn * s);
    *y = sin(turn * s);
}

static void along(double s, double x0, double y0, double x1, double y1,
                  double *x, double *y) {
    *x = x0 + s * (x1 - x0);
    *y = y0 + s * (y1 - y0);
}

static void box_at(double s, double *x, double *y) {
    static const double across[] = {1, -1, -1, 1, 1}, up[] = {1, 1, -1, -1, 1};
    int side = (int)(4 * s) & 3;
    along(4 * s - side, across[side], up[side], across[side + 1], up[side + 1],
          x, y);
}

/* V. I. Arnold's, its head: a circle with two ears. */
static const double head = 0.72;
static const double ear_begin = 25, ear_tip = 50, ear_end = 75; /* degrees */

static void polar(double r, double degrees, double *x, double *y) {
    *x = r * cos(turn * degrees / 360);
    *y = r * sin(turn * degrees / 360);
}

/* Its six pieces, of s from 0 to 1 each. */
static void cat_piece(int piece, double s, double *x, double *y) {
    bool left = piece == 3 || piece == 4;
    double begin[2], tip[2], end[2];
    polar(head, left ? 180 - ear_end : ear_begin, &begin[0], &begin[1]);
    polar(1.2, left ? 180 - ear_tip : ear_tip, &tip[0], &tip[1]);
    polar(head, left ? 180 - ear_begin : ear_end, &end[0], &end[1]);
    if (piece == 0 || piece == 3)
        along(s, begin[0], begin[1], tip[0], tip[1], x, y);
    else if (piece == 1 || piece == 4)
        along(s, tip[0], tip[1], end[0], end[1], x, y);
    else if (piece == 2)
        polar(head, ear_end + s * (180 - 2 * ear_end), x, y);
    else
        polar(head, 180 - ear_begin + s * (180 + 2 * ear_begin), x, y);
}

static void cat_at(double s, double *x, double *y) {
    int piece = (int)(6 * s) % 6;
    cat_piece(piece, 6 * s - piece, x, y);
}

static void eye_at(int eye, double s, double *x, double *y) {
    disc_at(s, x, y);
    *x = 0.12 * *x + (eye == 1 ? -0.28 : 0.28);
    *y = 0.16 * *y + 0.15;
}

static void outline(const shape *c, double s, double *x, double *y) {
    if (c->eye)
        eye_at(c->eye, s, x, y);
    else if (c->kind == FLOW_DISC)
        disc_at(s, x, y);
    else if (c->kind == FLOW_BOX)
        box_at(s, x, y);
    else
        cat_at(s, x, y);
}

size_t shape_corners(const shape *c, double corner[FLOW_CORNERS]) {
    size_t count = c->eye                ? 0
                   : c->kind == FLOW_BOX ? 4
                   : c->kind == FLOW_CAT ? 6
                                         : 0;
    for (size_t i = 0; i < count; i++)
        corner[i] = (double)i / (double)count;
    return count;
}

/* Which row of q, or of p after n, a variable is; 2n: none. */
static size_t row_of(const plan *p, const char *variable) {
    bool momentum = strncmp(variable, "p_", 2) == 0;
    for (int part = 0; part < 2; part++)
        for (size_t k = 0; k < p->n; k++) {
            const char *name = nevh_scene_coordinate(p->scene, k);
            if (part == 0 && strcmp(name, variable) == 0)
                return k;
            if (part == 1 && momentum && strcmp(name, variable + 2) == 0)
                return p->n + k;
        }
    return 2 * p->n;
}

/* A formula of t, the angle round the loop, at the start of the scene. */
static int fill_row(shape *c, size_t i, size_t count, const double s[],
                    double row[]) {
    nevh_scene *scene = c->plan->scene;
    int status = nevh_scene_set_judged(scene, c->formula.item[i]);
    for (size_t j = 0; !status && j < count; j++) {
        status = nevh_scene_judged_value(scene, turn * s[j], c->plan->q,
                                         c->plan->p, &row[j]);
        if (!status && !isfinite(row[j])) {
            c->failed = true;
            return tool_refuse("--shape: %s = %s is not finite at t = %.6g",
                               c->variable.item[i], c->formula.item[i],
                               turn * s[j]);
        }
    }
    if (status && !c->failed) {
        c->failed = true;
        tool_refuse("--shape: %s = %s: %s", c->variable.item[i],
                    c->formula.item[i], nevh_scene_message(scene));
    }
    return status;
}

int shape_curve(void *data, size_t count, const double s[], double q[],
                double p[]) {
    shape *c = data;
    size_t n = c->plan->n;
    for (size_t j = 0; j < count; j++) {
        double x, y;
        for (size_t k = 0; k < n; k++) {
            q[k * count + j] = c->plan->q[k];
            p[k * count + j] = c->plan->p[k];
        }
        if (c->kind == FLOW_LOOP)
            continue;
        outline(c, s[j], &x, &y);
        q[c->k * count + j] = c->x + c->width * x;
        p[c->k * count + j] = c->y + c->height * y;
    }
    for (size_t i = 0; i < c->variable.count; i++) {
        size_t row = row_of(c->plan, c->variable.item[i]);
        if (fill_row(c, i, count, s,
                     row < n ? q + row * count : p + (row - n) * count))
            return 1;
    }
    return 0;
}

/* Reading --shape. */

static const char *const forms[] = {"disc", "box", "cat", "loop"};

static int refuse_form(const char *text) {
    return tool_refuse(
        "--shape takes disc(x = 1, p_x = 0, RADIUS), box(x = 1, p_x = 0, "
        "WIDTH, HEIGHT), cat(x = 1, p_x = 0, SIZE) or, of formulas of t from 0 "
        "to 2*pi, loop(x = cos(t), p_x = sin(t)), not \"%s\"",
        text);
}

static char *trimmed(const char *text, size_t length) {
    while (length && isspace((unsigned char)*text))
        text++, length--;
    while (length && isspace((unsigned char)text[length - 1]))
        length--;
    return text_print("%.*s", (int)length, text);
}

/* At commas outside of brackets. */
static void split(list *to, const char *text, size_t length) {
    size_t from = 0;
    int depth = 0;
    for (size_t i = 0; i <= length; i++) {
        char c = i < length ? text[i] : ',';
        depth += (c == '(' || c == '[') - (c == ')' || c == ']');
        if (i < length && (c != ',' || depth > 0))
            continue;
        list_add(to, trimmed(text + from, i - from));
        from = i + 1;
    }
}

/* "x = 1" into x and 1; false: it has no "=". */
static bool cut(const char *text, char **name, char **value) {
    const char *equals = strchr(text, '=');
    if (!equals)
        return false;
    *name = trimmed(text, (size_t)(equals - text));
    *value = trimmed(equals + 1, strlen(equals + 1));
    return true;
}

static int unknown_variable(const plan *p, const char *name) {
    list names = {0};
    for (size_t k = 0; k < p->n; k++) {
        list_add(&names, nevh_scene_coordinate(p->scene, k));
        list_print(&names, "p_%s", nevh_scene_coordinate(p->scene, k));
    }
    return tool_unknown("coordinate or momentum", name, &names);
}

static int read_loop(shape *c, const list *parts, const char *text) {
    for (size_t i = 0; i < parts->count; i++) {
        char *name, *value;
        if (!cut(parts->item[i], &name, &value))
            return refuse_form(text);
        bool known = row_of(c->plan, name) < 2 * c->plan->n;
        bool twice = list_has(&c->variable, name);
        int status = !known  ? unknown_variable(c->plan, name)
                     : twice ? tool_refuse("--shape: %s is given twice", name)
                             : TOOL_OK;
        list_add(&c->variable, name);
        list_add(&c->formula, value);
        if (status)
            return status;
    }
    return TOOL_OK;
}

/* A curve that does not come back encloses nothing. */
static int check_closed(shape *c) {
    static const double ends[] = {0, 1}, nothing = 1e-9;
    size_t n = c->plan->n;
    double *q = tool_allocate(4 * n, sizeof *q), *p = q + 2 * n;
    int status = shape_curve(c, 2, ends, q, p) ? TOOL_USAGE : TOOL_OK;
    for (size_t i = 0; !status && i < c->variable.count; i++) {
        const double *at = q + 2 * row_of(c->plan, c->variable.item[i]);
        if (fabs(at[0] - at[1]) > nothing * (1 + fabs(at[0])))
            status = tool_refuse("--shape: the loop is not closed: %s is %.6g "
                                 "at t = 0 and %.6g at t = 2*pi",
                                 c->variable.item[i], at[0], at[1]);
    }
    return status;
}

static int read_number(const shape *c, const options *o, const char *text,
                       double *number) {
    return scene_number(c->plan->scene, o, text, number);
}

/* The two of a plane, in either order. */
static int read_middle(shape *c, const options *o, const list *parts,
                       const char *text) {
    size_t n = c->plan->n, row[2];
    for (size_t i = 0; i < 2; i++) {
        char *name, *value;
        double number;
        if (!cut(parts->item[i], &name, &value))
            return refuse_form(text);
        row[i] = row_of(c->plan, name);
        int status = row[i] == 2 * n ? unknown_variable(c->plan, name)
                                     : read_number(c, o, value, &number);
        if (status)
            return status;
        *(row[i] < n ? &c->x : &c->y) = number;
    }
    c->k = row[0] % n;
    if (row[0] != row[1] && row[0] % n == row[1] % n)
        return TOOL_OK;
    const char *own = nevh_scene_coordinate(c->plan->scene, c->k);
    return tool_refuse(
        "--shape: a %s lies in the plane of a coordinate and its "
        "own momentum: %s goes with p_%s",
        forms[c->kind], own, own);
}

static int read_plane(shape *c, const options *o, const list *parts,
                      const char *text) {
    size_t sizes = parts->count - 2;
    bool box = c->kind == FLOW_BOX;
    if (parts->count < 3 || parts->count > 4 || (box && sizes != 2))
        return refuse_form(text);
    if (read_middle(c, o, parts, text) ||
        read_number(c, o, parts->item[2], &c->width) ||
        read_number(c, o, parts->item[parts->count - 1], &c->height))
        return TOOL_USAGE;
    if (!(c->width > 0 && c->height > 0))
        return tool_refuse("--shape: sizes are above 0, not %s",
                           parts->item[c->width > 0 ? parts->count - 1 : 2]);
    if (box) {
        c->width /= 2;
        c->height /= 2;
    }
    return TOOL_OK;
}

static int read_given(shape *c, const options *o, const char *text) {
    char *whole = trimmed(text, strlen(text));
    char *open = strchr(whole, '(');
    size_t length = strlen(whole), kind = 0,
           count = sizeof forms / sizeof *forms;
    list parts = {0};
    char *name = trimmed(whole, open ? (size_t)(open - whole) : length);
    while (kind < count && strcmp(forms[kind], name) != 0)
        kind++;
    int status = TOOL_OK;
    if (kind == count || !open || whole[length - 1] != ')') {
        status = refuse_form(text);
    } else {
        c->kind = (shape_kind)kind;
        split(&parts, open + 1, length - 2 - (size_t)(open - whole));
        status = c->kind == FLOW_LOOP ? read_loop(c, &parts, text)
                                      : read_plane(c, o, &parts, text);
    }
    if (!status && c->kind == FLOW_LOOP)
        status = check_closed(c);
    return status;
}

/* The extent of the scene's orbit in 1000 steps of the first scheme, and the
   longest of these steps. */
typedef struct {
    size_t n;
    double *low, *high, *last, *longest; /* 2n each */
} extent;

static int widen(void *data, size_t step, double t, const double q[],
                 const double p[]) {
    extent *e = data;
    (void)t;
    for (size_t k = 0; k < 2 * e->n; k++) {
        double x = k < e->n ? q[k] : p[k - e->n];
        e->low[k] = fmin(e->low[k], x);
        e->high[k] = fmax(e->high[k], x);
        if (step > 0)
            e->longest[k] = fmax(e->longest[k], fabs(x - e->last[k]));
        e->last[k] = x;
    }
    return 0;
}

static bool moves(const extent *e) {
    for (size_t k = 0; k < 2 * e->n; k++)
        if (e->high[k] > e->low[k])
            return true;
    return false;
}

/* Steps that keep the orbit in place. */
static nevh_stepper *plan_symplectic(const plan *p) {
    const char *name;
    bool transformed;
    nevh_stepper *s = plan_first(p, &name);
    if (!s || nevh_integrator_symplectic(plan_scheme(p, name, &transformed)) !=
                  NEVH_NO)
        return s;
    nevh_stepper_free(s);
    return plan_stepper(p, "gauss4");
}

/* Along so many steps, or as far as the orbit can be followed. */
static int follow(const plan *p, nevh_stepper *s, size_t steps, extent *e) {
    double *q = plan_state(p), *m = q + p->n;
    nevh_observer observer = {widen, e, 1};
    for (size_t k = 0; k < 2 * e->n; k++) {
        e->low[k] = INFINITY;
        e->high[k] = -INFINITY;
        e->longest[k] = 0;
    }
    nevh_stepper_reset(s);
    return nevh_run(s, p->run->t_start, p->dt[0], steps, q, m, &observer, 1);
}

/* An orbit that ends has no size, but up to the end of the run if that is before. */
static int measure(const plan *p, nevh_stepper *s, extent *e) {
    int status = follow(p, s, 1000, e);
    if (status && plan_refuse_end(p))
        return TOOL_FAILED;
    double steps = floor((p->t_end - p->run->t_start) / p->dt[0]);
    if (status && steps >= 1 && steps < 1000)
        status = follow(p, s, (size_t)steps, e);
    if (status && !moves(e))
        status = tool_refuse("%s: the orbit fails, so that no shape follows "
                             "from it: %s",
                             p->name, nevh_stepper_message(s));
    else
        status = TOOL_OK;
    return status;
}

/* True if steps from points of the outline are at most 4 times as long as those
   of the orbit: a shape around a singularity breaks at once. */
static bool moves_as_the_orbit(shape *c, nevh_stepper *s, const extent *e) {
    enum { POINTS = 48 };
    static const double most = 4;
    const plan *p = c->plan;
    double *from = tool_allocate(4 * p->n, sizeof *from), *to = from + 2 * p->n;
    bool fits = true;
    for (size_t i = 0; fits && i < POINTS; i++) {
        const double at = (double)i / POINTS;
        shape_curve(c, 1, &at, from, from + p->n);
        memcpy(to, from, 2 * p->n * sizeof *to);
        fits = nevh_run(s, p->run->t_start, p->dt[0], 1, to, to + p->n, NULL,
                        0) == NEVH_OK;
        for (size_t k = 0; fits && k < 2 * p->n; k++)
            fits = fabs(to[k] - from[k]) <= most * e->longest[k];
    }
    return fits;
}

/* The length over which coordinate k moves: a turn at most, where it is an angle. */
static double range_of(const plan *p, const extent *e, size_t k) {
    double period = nevh_scene_period(p->scene, k),
           range = e->high[k] - e->low[k];
    return period > 0 ? fmin(range, period) : range;
}

/* The first pair of a coordinate and its momentum that both change. */
static int choose_plane(shape *c, const extent *e) {
    static const double part = 0.1;
    const plan *p = c->plan;
    for (c->k = 0; c->k < p->n; c->k++) {
        c->width = part * range_of(p, e, c->k);
        c->height = part * (e->high[p->n + c->k] - e->low[p->n + c->k]);
        if (c->width > 0 && c->height > 0 && isfinite(c->width * c->height))
            break;
    }
    if (c->k == p->n)
        return tool_refuse("%s: %s: name a shape, as --shape 'disc(%s = 0, "
                           "p_%s = 0, 0.1)'",
                           p->name,
                           moves(e) ? "along the orbit no coordinate changes "
                                      "together with its momentum"
                                    : "the orbit stays where it starts",
                           nevh_scene_coordinate(p->scene, 0),
                           nevh_scene_coordinate(p->scene, 0));
    c->kind = FLOW_CAT;
    c->x = p->q[c->k];
    c->y = p->p[c->k];
    return TOOL_OK;
}

/* A cat round the start, a fifth of the orbit in size, or less where points of
   its outline move much faster. */
static int choose(shape *c) {
    enum { HALVINGS = 6 };
    const plan *p = c->plan;
    nevh_stepper *s = plan_symplectic(p);
    if (!s)
        return TOOL_USAGE;
    double *room = tool_allocate(8 * p->n, sizeof *room);
    extent e = {p->n, room, room + 2 * p->n, room + 4 * p->n, room + 6 * p->n};
    int status = measure(p, s, &e);
    if (!status)
        status = choose_plane(c, &e);
    for (int i = 0; !status && i < HALVINGS && !moves_as_the_orbit(c, s, &e);
         i++) {
        c->width /= 2;
        c->height /= 2;
    }
    nevh_stepper_free(s);
    if (status)
        return status;
    const char *name = nevh_scene_coordinate(p->scene, c->k);
    c->text = text_print("cat(%s = %.4g, p_%s = %.4g, %.3g, %.3g)", name, c->x,
                         name, c->y, c->width, c->height);
    return TOOL_OK;
}

int shape_read(shape *c, const plan *p, const options *o, const char *text) {
    *c = (shape){.plan = p};
    if (!text)
        return choose(c);
    c->text = text_print("%s", text);
    return read_given(c, o, text);
}

/* nevh compare and cost --plot-kind order: errors against the step, with slopes; cost
   --against length: against the length of the run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "order_plot.h"
#include "energy_plot.h"
#include <math.h>
#include <string.h>

static const double useless = 1, rounding = 1e-13; /* as errors */
static const double saturated = 0.1; /* above: no longer powers of dt */
enum { ORDER_STEPS = 5 };            /* that a slope needs */

/* Selects the error of a panel. */
typedef double error_of(const row *);
static double energy_error(const row *r) {
    return r->energy.max;
}
static double state_error(const row *r) {
    return r->state_error;
}
static double observable_error(const row *r) {
    return r->observable ? r->observable_error : NAN;
}
enum { ERRORS = 3 };
static const struct {
    error_of *of;
    const char *label; /* NULL: as the plan says */
} errors[ERRORS] = {{energy_error, NULL},
                    {state_error, "largest state error, relative"},
                    {observable_error, "largest error of the observable"}};

static const char *label_of(const plan *p, size_t kind) {
    return errors[kind].label ? errors[kind].label : energy_plot_largest(p);
}

/* The points of one scheme, by rising x: dt, or the end of the run. */
typedef struct {
    size_t count, from, to; /* from, to: of the slope */
    double *x, *error, slope;
} curve;

typedef struct {
    const row *row;
    size_t count;
    order_axis axis;
} rows_drawn;

void order_plot_steps(const options *o, plan *p) {
    static const double steps = 200; /* of the longest */
    if (o->plot.kind != PLOT_KIND_order || o->dt.count || !p->dts)
        return;
    double longest = p->dt[0];
    for (size_t i = 1; i < p->dts; i++)
        longest = fmax(longest, p->dt[i]);
    p->given_dt = tool_allocate(ORDER_STEPS, sizeof *p->given_dt);
    for (int i = 0; i < ORDER_STEPS; i++)
        p->given_dt[i] = ldexp(longest, -i);
    p->dt = p->given_dt;
    p->dts = ORDER_STEPS;
    if (!o->t_end)
        p->t_end = fmin(p->t_end, p->run->t_start + steps * longest);
}

int order_plot_check(const options *o, size_t steps) {
    if (o->plot.kind == PLOT_KIND_order && plot_wanted(o) && steps < 2)
        return tool_refuse("--plot-kind order needs two steps or more, as "
                           "--dt 0.1,0.05,0.02");
    return TOOL_OK;
}

typedef struct {
    double slope, worst; /* worst: distance from the line, of log y */
} line;

static line fit(const double x[], const double y[], size_t from, size_t to) {
    double count = (double)(to - from), mx = 0, my = 0, xx = 0, xy = 0;
    for (size_t i = from; i < to; i++) {
        mx += log(x[i]) / count;
        my += log(y[i]) / count;
    }
    for (size_t i = from; i < to; i++) {
        xx += (log(x[i]) - mx) * (log(x[i]) - mx);
        xy += (log(x[i]) - mx) * (log(y[i]) - my);
    }
    line l = {xy / xx, 0};
    for (size_t i = from; i < to; i++)
        l.worst =
            fmax(l.worst, fabs(log(y[i]) - my - l.slope * (log(x[i]) - mx)));
    return l;
}

static double pair_slope(const double x[], const double y[], size_t a,
                         size_t b) {
    return log(y[b] / y[a]) / log(x[b] / x[a]);
}

/* The next point that is not close; `count` where there is none. */
static size_t next_apart(const double x[], size_t count, size_t i) {
    size_t k = i + 1;
    while (k < count && steps_are_close(x[i], x[k]))
        k++;
    return k < count ? k : count;
}

/* True if the slopes of neighbouring pairs agree from `from` to `to`. */
static bool is_straight(const double x[], const double y[], size_t from,
                        size_t to) {
    double last = NAN;
    for (size_t i = from, k; (k = next_apart(x, to, i)) < to; i = k) {
        double slope = pair_slope(x, y, i, k);
        if (!isnan(last) && !orders_agree(slope, last))
            return false;
        last = slope;
    }
    return true;
}

/* True if an error falls faster below the points that a slope is fitted to: it changes
   its sign there.  Rounding makes it fall more slowly. */
static bool bends_down(const double x[], const double y[], size_t from,
                       double slope) {
    size_t k = from;
    while (k-- > 0)
        if (!steps_are_close(x[k], x[from])) {
            double below = pair_slope(x, y, k, from);
            return below > slope && !orders_agree(below, slope);
        }
    return false;
}

/* The slope of log y over log x, by least squares over as many neighbours as are
   on a rising line to a factor of 1.25, the slopes of pairs of which agree.
   x         rising
   from, to  out: the neighbours; to: past the last
   returns   NAN where no three are on such a line */
static double order_slope(const double x[], const double y[], size_t count,
                          size_t *from, size_t *to) {
    static const double near = 0.22, least = 0.8; /* log 1.25; of a slope */
    static const double span = 1.5;               /* of x */
    double slope = NAN;
    *from = *to = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t k = count; k > i + 2; k--) {
            line l = fit(x, y, i, k);
            bool good = l.worst <= near && l.slope >= least &&
                        x[k - 1] > span * x[i] && is_straight(x, y, i, k);
            if (!good || k - i <= *to - *from)
                continue;
            *from = i;
            *to = k;
            slope = l.slope;
        }
    return slope;
}

static bool is_same(const row *a, const row *b) {
    return strcmp(a->integrator, b->integrator) == 0 &&
           strcmp(a->gradient, b->gradient) == 0;
}

static bool is_first(const row rows[], size_t i) {
    for (size_t k = 0; k < i; k++)
        if (is_same(&rows[k], &rows[i]))
            return false;
    return true;
}

static void insert(curve *c, double x, double error) {
    size_t i = c->count++;
    for (; i > 0 && c->x[i - 1] > x; i--) {
        c->x[i] = c->x[i - 1];
        c->error[i] = c->error[i - 1];
    }
    c->x[i] = x;
    c->error[i] = error;
}

static curve curve_of(const rows_drawn *d, size_t first, error_of *error) {
    bool steps = d->axis == ORDER_DT;
    curve c = {.x = tool_allocate(d->count, sizeof *c.x),
               .error = tool_allocate(d->count, sizeof *c.error)};
    size_t above = 0, below; /* those that rounding makes; saturated ones */
    for (size_t i = first; i < d->count; i++) {
        const row *r = &d->row[i];
        double value = r->ran && (r->tolerance == 0 || !steps) ? error(r) : NAN;
        if (is_same(r, &d->row[first]) && value > 0 && value < useless)
            insert(&c, steps ? r->dt : r->t_end, value);
    }
    while (above < c.count && !(c.error[above] > rounding))
        above++;
    for (below = c.count; below > above && c.error[below - 1] > saturated;)
        below--;
    c.slope = c.count < ORDER_STEPS
                  ? NAN
                  : order_slope(c.x + above, c.error + above, below - above,
                                &c.from, &c.to);
    if (steps && bends_down(c.x + above, c.error + above, c.from, c.slope)) {
        c.slope = NAN;
        c.to = c.from;
    }
    c.from += above;
    c.to += above;
    return c;
}

/* True once a scheme; its parts do not solve H, which leaves rounding at any step. */
static bool is_drawn(const plan *p, const rows_drawn *d, size_t i) {
    return is_first(d->row, i) && !plan_is_exact(p, d->row[i].scheme);
}

/* "" where no scheme is. */
static const char *left_out(const plan *p, const rows_drawn *d) {
    for (size_t i = 0; i < d->count; i++)
        if (plan_is_exact(p, d->row[i].scheme))
            return "; schemes whose parts solve H are left out";
    return "";
}

/* The kinds of errors that some scheme has at two steps. */
static size_t find_kinds(const plan *p, const rows_drawn *d, size_t kinds[]) {
    size_t found = 0;
    for (size_t k = 0; k < ERRORS; k++) {
        bool drawn = false;
        for (size_t i = 0; i < d->count && !drawn; i++) {
            curve c = curve_of(d, i, errors[k].of);
            drawn = is_drawn(p, d, i) && c.count > 1;
        }
        if (drawn)
            kinds[found++] = k;
    }
    return found;
}

/* With the slope in each panel. */
static char *name_of(const plan *p, const row *r, const curve curves[],
                     size_t panels) {
    bool some = false;
    char *name = p->gradients.count < 2
                     ? text_print("%s", r->integrator)
                     : text_print("%s, %s", r->integrator, r->gradient);
    for (size_t k = 0; k < panels; k++)
        some |= curves[k].slope > 0;
    for (size_t k = 0; some && k < panels; k++) {
        const char *before = k > 0        ? ", "
                             : panels > 1 ? ": slopes "
                                          : ": slope ";
        char *more = curves[k].slope > 0
                         ? text_print("%s%s%.2f", name, before, curves[k].slope)
                         : text_print("%s%s-", name, before);
        name = more;
    }
    return name;
}

static void draw_points(plot *to, size_t series, const curve *c, size_t from,
                        size_t end) {
    for (size_t i = from; i < end; i++)
        plot_point(to, series, c->x[i], c->error[i]);
}

static void draw_curve(plot *to, const char *name, const char *integrator,
                       const curve *c) {
    if (c->count < 2)
        return;
    size_t behind = plot_series(to, NULL);
    plot_style(to, behind, PLOT_BEHIND);
    draw_points(to, behind, c, c->from, c->to);
    size_t series = plot_series(to, name);
    plot_integrator(to, series, integrator);
    plot_style(to, series, PLOT_BOTH);
    draw_points(to, series, c, 0, c->count);
}

static void draw_panel(plot *to, const plan *p, const rows_drawn *d,
                       const size_t kinds[], size_t panels, size_t panel) {
    for (size_t i = 0; i < d->count; i++) {
        curve curves[ERRORS];
        if (!is_drawn(p, d, i))
            continue;
        for (size_t k = 0; k < panels; k++)
            curves[k] = curve_of(d, i, errors[kinds[k]].of);
        draw_curve(to, name_of(p, &d->row[i], curves, panels),
                   d->row[i].integrator, &curves[panel]);
    }
}

static void add_note(plot *to, const plan *p, const rows_drawn *d) {
    bool adaptive = false, some = false;
    for (size_t i = 0; i < d->count; i++)
        adaptive |= d->row[i].tolerance > 0;
    for (size_t i = 0; i < d->count; i++) {
        size_t steps = 0;
        for (size_t k = 0; k < d->count; k++)
            steps += is_same(&d->row[i], &d->row[k]);
        some |= steps >= ORDER_STEPS;
    }
    char *text = text_print(
        "%s%s%s",
        some ? "grey: the points that a slope is fitted to, none above 0.1"
             : "a slope needs five steps: --dt",
        adaptive ? "; schemes that choose their steps are left out" : "",
        left_out(p, d));
    plot_note_run(to, p, NULL, text);
}

int order_plot(const options *o, const plan *p, const row rows[], size_t count,
               order_axis axis) {
    rows_drawn d = {rows, count, axis};
    size_t kinds[ERRORS], panels = find_kinds(p, &d, kinds);
    plot *to = NULL;
    if (panels == 0)
        return tool_refuse("there is nothing to plot: no scheme has errors "
                           "between 0 and %g at two %s%s",
                           useless, axis == ORDER_DT ? "steps" : "lengths",
                           left_out(p, &d));
    char *x = plot_label(p, axis == ORDER_DT ? "dt" : "end of the run", "t");
    for (size_t k = 0; k < panels; k++) {
        if (to)
            plot_panel(to, NULL, x, label_of(p, kinds[k]));
        else
            to = plot_new(p->title, x, label_of(p, kinds[k]));
        plot_log(to, true, true);
        draw_panel(to, p, &d, kinds, panels, k);
    }
    add_note(to, p, &d);
    return plot_write(to, o);
}

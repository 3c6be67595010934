/* nevh: a closed curve of starts, carried along, and the area in it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/loop_private.h"
#include <fenv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    PIECES = 4, /* panels between two corners, to begin with */
    MOST_POINTS = 1 << 14
};
static const double shortest = 1e-12; /* panel, in s */

static size_t most_panels(const nevh_loop *l) {
    size_t points =
        l->options.most_points ? l->options.most_points : MOST_POINTS;
    return points / NEVH__NODES;
}

/* States are kept where those of all panels take no more bytes than that. */
static const double most_kept = 0x1p26;

static bool keeps_states(const nevh_loop *l) {
    double numbers = 2 * NEVH__NODES * (double)l->n * (double)l->options.times;
    return l->options.shapes ||
           numbers * sizeof(double) * (double)most_panels(l) <= most_kept;
}

/* Planning. */

/* P_k(x) for k < NEVH__NODES. */
static void legendre_values(double x, double value[]) {
    value[0] = 1;
    value[1] = x;
    for (int k = 2; k < NEVH__NODES; k++)
        value[k] =
            ((2 * k - 1) * x * value[k - 1] - (k - 1) * value[k - 2]) / k;
}

/* Gauss-Lobatto nodes: the ends, and the zeros of P'_{N-1}, by Newton's method with
   (1 - x^2) P'' = 2 x P' - (N-1) N P.  Sums over them are exact for products of two
   of the polynomials, but for the last one's with itself. */
static void plan_nodes(nevh_loop *l) {
    enum { LAST = NEVH__NODES - 1, ROUNDS = 8 };
    for (int j = 0; j < NEVH__NODES; j++) {
        double x = -cos(acos(-1) * j / LAST), value[NEVH__NODES];
        for (int i = 0; j > 0 && j < LAST && i < ROUNDS; i++) {
            legendre_values(x, value);
            x -= (x * value[LAST] - value[LAST - 1]) /
                 (NEVH__NODES * value[LAST]);
        }
        l->node[j] = j == 0 ? -1 : j == LAST ? 1 : x;
        legendre_values(l->node[j], value);
        for (int k = 0; k < NEVH__NODES; k++)
            l->legendre[k][j] =
                (k < LAST ? 2 * k + 1 : LAST) * value[k] /
                (LAST * NEVH__NODES * value[LAST] * value[LAST]);
    }
}

static bool is_loop(const nevh_loop_options *o) {
    bool good = o->curve && o->times && o->steps && isfinite(o->t0) &&
                isfinite(o->h) && (o->corners || !o->n_corners);
    for (size_t i = 0; good && i < o->n_corners; i++)
        good = o->corners[i] >= 0 && o->corners[i] < 1 &&
               (!i || o->corners[i] > o->corners[i - 1]);
    for (size_t i = 1; good && i < o->times; i++)
        good = o->steps[i] >= o->steps[i - 1];
    return good;
}

static int loop_check_options(nevh_loop *l, const nevh_options *o,
                              const nevh_integrator *scheme) {
    if (!is_loop(&l->options))
        return nevh__fail(&l->report, NEVH_EINVAL,
                          "a loop needs a curve, corners that rise within "
                          "[0, 1), times that rise, and finite t0 and h");
    if (nevh_integrator_own_time(scheme) || o->transform)
        return nevh__fail(&l->report, NEVH_ESTRUCT,
                          "%s chooses times of its own for each orbit: there "
                          "is no curve at one time",
                          nevh_integrator_name(scheme));
    return NEVH_OK;
}

static int plan_stepper(nevh_loop *l, const nevh_system *s,
                        const nevh_integrator *scheme, nevh_options o) {
    size_t size = l->n * NEVH__NODES;
    for (size_t i = 0; i < size; i++) {
        l->q[i] = o.q ? o.q[i / NEVH__NODES] : 0;
        l->p[i] = o.p ? o.p[i / NEVH__NODES] : 0;
    }
    o.width = NEVH__NODES;
    o.q = o.q ? l->q : NULL;
    o.p = o.p ? l->p : NULL;
    l->stepper = nevh_stepper_new(s, scheme, &o);
    return nevh_stepper_status(l->stepper)
               ? nevh__fail(&l->report, nevh_stepper_status(l->stepper), "%s",
                            nevh_stepper_message(l->stepper))
               : NEVH_OK;
}

static int plan_corners(nevh_loop *l) {
    static const double beginning;
    const double *given =
        l->options.n_corners ? l->options.corners : &beginning;
    size_t count = l->options.n_corners ? l->options.n_corners : 1;
    l->corners = nevh__array(count + 1, sizeof *l->corners);
    l->steps = nevh__copy(l->options.steps, l->options.times, sizeof *l->steps);
    if (!l->corners || !l->steps)
        return nevh__no_memory(&l->report);
    memcpy(l->corners, given, count * sizeof *given);
    l->corners[count] = given[0] + 1;
    l->options.n_corners = count;
    l->options.corners = NULL;
    l->options.steps = NULL;
    return NEVH_OK;
}

static void loop_lay_out(nevh__arena *a, void *loop) {
    nevh_loop *l = loop;
    size_t times = l->options.times, n = l->n;
    double **const numbers[] = {
        &l->taken_area, &l->taken_error, &l->taken_noise, &l->unit,
        &l->area,       &l->error,       &l->noise};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        *numbers[i] = nevh__arena_take(a, times, sizeof(double));
    l->q = nevh__arena_take(a, n * NEVH__NODES, sizeof(double));
    l->p = nevh__arena_take(a, n * NEVH__NODES, sizeof(double));
    l->centre = nevh__arena_take(a, times * n, sizeof(double));
    l->level = nevh__arena_take(a, times * 2 * n, sizeof(double));
    l->low = nevh__arena_take(a, times * 2 * n, sizeof(double));
    l->high = nevh__arena_take(a, times * 2 * n, sizeof(double));
    l->rough = nevh__arena_take(a, times, sizeof *l->rough);
    l->inside = nevh__arena_take(a, times, sizeof(bool));
}

static int loop_plan_memory(nevh_loop *l) {
    l->memory = nevh__arena_new(loop_lay_out, l);
    return l->memory ? NEVH_OK : nevh__no_memory(&l->report);
}

nevh_loop *nevh_loop_new(const nevh_system *s, const nevh_integrator *scheme,
                         const nevh_options *options,
                         const nevh_loop_options *loop) {
    static const nevh_options defaults;
    const nevh_options *o = options ? options : &defaults;
    nevh_loop *l = s && scheme && loop ? nevh__array(1, sizeof *l) : NULL;
    if (!l)
        return NULL;
    l->options = *loop;
    l->n = nevh_system_dof(s);
    l->keeps = keeps_states(l);
    plan_nodes(l);
    if (!loop_check_options(l, o, scheme) && !plan_corners(l) &&
        !loop_plan_memory(l))
        plan_stepper(l, s, scheme, *o);
    return l;
}

static void queue_clear(nevh__queue *all) {
    for (size_t i = all->front; i < all->count; i++)
        free(all->item[i].states);
    free(all->item);
}

void nevh_loop_free(nevh_loop *l) {
    if (!l)
        return;
    for (size_t i = 0; l->shape && i < l->panels; i++)
        free(l->shape[i].states);
    for (size_t i = 0; l->memory && i < l->options.times; i++)
        queue_clear(&l->rough[i]);
    nevh_stepper_free(l->stepper);
    free(l->corners);
    free(l->steps);
    free(l->memory);
    free(l->shape);
    free(l);
}

NEVH__REPORTS(loop)

/* The whole. */

static int put(nevh_loop *l, nevh__queue *to, nevh__panel at) {
    if (to->count == to->room) {
        size_t room = 2 * to->room + 16;
        nevh__panel *more = nevh__grow(to->item, room, sizeof *more);
        if (!more)
            return nevh__no_memory(&l->report);
        to->item = more;
        to->room = room;
    }
    to->item[to->count++] = at;
    return NEVH_OK;
}

/* The length of the box in one direction; 0 if it is rounding. */
static double loop_length(const nevh_loop *l, size_t i) {
    static const double rounding = 1e-13;
    double low = l->low[i], high = l->high[i];
    return high - low > rounding * fmax(fabs(low), fabs(high)) ? high - low : 0;
}

/* The panels as they begin tell what is large: rounding and errors are of that. */
static int find_units(nevh_loop *l, const nevh__queue *all) {
    static const double thin = 1e-3, nothing = 1e-6;
    for (size_t i = 0; i < l->options.times * 2 * l->n; i++) {
        l->low[i] = INFINITY;
        l->high[i] = -INFINITY;
    }
    for (size_t i = 0; i < all->count; i++)
        if (nevh__loop_follow(l, &all->item[i], nevh__loop_measure))
            return l->report.status;
    for (size_t time = 0; time < l->reach; time++) {
        double box = 0;
        for (size_t k = 0; k < l->n; k++) {
            size_t i = (time * l->n + k) * 2;
            box += loop_length(l, i) * loop_length(l, i + 1);
            l->centre[time * l->n + k] = (l->low[i] + l->high[i]) / 2;
        }
        if (time == 0 && !(box > 0 && fabs(l->area[0]) > nothing * box))
            return nevh__fail(&l->report, NEVH_EINVAL,
                              "the curve encloses no area");
        l->unit[time] = fmax(fabs(l->area[0]), thin * box);
    }
    memset(l->area, 0, l->options.times * sizeof *l->area);
    return NEVH_OK;
}

static int loop_accept(nevh_loop *l, nevh__panel at) {
    for (size_t i = 0; i < l->reach; i++) {
        l->area[i] += l->taken_area[i];
        l->error[i] += l->taken_error[i];
        l->noise[i] += l->taken_noise[i] * l->taken_noise[i];
    }
    if (l->options.shapes) {
        nevh__panel *more = nevh__grow(l->shape, l->panels + 1, sizeof *more);
        if (!more) {
            free(at.states);
            return nevh__no_memory(&l->report);
        }
        l->shape = more;
        l->shape[l->panels] = at;
    } else
        free(at.states);
    l->panels++;
    return NEVH_OK;
}

/* Accepts a panel that is smooth at all times, or that is the last resort; else
   it waits to be cut. */
static int loop_take(nevh_loop *l, nevh__panel at, bool last) {
    l->taken_times = 0;
    int status = nevh__loop_follow(
        l, &at, last ? nevh__loop_integrate : nevh__loop_integrate_smooth);
    if (!status && (last || l->taken_times >= l->reach))
        return loop_accept(l, at);
    if (!status) {
        at.parts = nevh__loop_parts(l);
        at.least = nevh__loop_least_parts(l);
        status = put(l, &l->rough[l->taken_times], at);
    }
    if (status)
        free(at.states);
    return status;
}

/* True if the most points do not give the area at a time: no more than these need be
   carried along for it. */
static bool is_out_of_reach(const nevh_loop *l, const nevh__queue *rough,
                            size_t waiting) {
    size_t least = l->panels + waiting;
    for (size_t i = rough->front; i < rough->count; i++)
        least += rough->item[i].least - 1;
    return least > most_panels(l);
}

/* Cuts the panel that is rough first, while there may be more. */
static int loop_cut(nevh_loop *l, nevh__queue *from, size_t waiting) {
    nevh__panel at = from->item[from->front++];
    size_t most = l->full ? 0 : most_panels(l), panels = l->panels + waiting;
    size_t parts = panels + at.parts <= most ? at.parts : 2;
    double length = (at.to - at.from) / (double)parts;
    int status = NEVH_OK;
    if (panels >= most || at.to - at.from < shortest)
        return loop_take(l, at, true);
    free(at.states);
    for (size_t i = 0; !status && i < parts; i++) {
        double begins = at.from + (double)i * length;
        double ends = i + 1 < parts ? begins + length : at.to;
        status = loop_take(l, (nevh__panel){.from = begins, .to = ends}, false);
    }
    return status;
}

static int cut_all(nevh_loop *l) {
    int status = NEVH_OK;
    while (!status) {
        nevh__queue *first = NULL;
        size_t waiting = 0;
        for (size_t i = l->options.times; i-- > 0;) {
            nevh__queue *here = &l->rough[i];
            waiting += here->count - here->front;
            first = here->count > here->front ? here : first;
        }
        if (!first)
            break;
        l->full = l->full || is_out_of_reach(l, first, waiting);
        status = loop_cut(l, first, waiting);
    }
    return status;
}

/* Finds the level of noise by some panels that are all but points. */
static int find_noise(nevh_loop *l, const nevh__queue *all) {
    enum { PLACES = 4 };
    static const double short_of = 0x1p-14;
    for (size_t i = 0; i < PLACES; i++) {
        nevh__panel at = all->item[i * all->count / PLACES];
        at.to = at.from + short_of * (at.to - at.from);
        int status = nevh__loop_follow(l, &at, nevh__loop_listen);
        free(at.states);
        if (status)
            return status;
    }
    return NEVH_OK;
}

static int loop_begin(nevh_loop *l) {
    nevh__queue all = {0};
    int status = NEVH_OK;
    for (size_t c = 0; !status && c < l->options.n_corners; c++)
        for (int i = 0; !status && i < PIECES; i++) {
            double from = l->corners[c], length = l->corners[c + 1] - from;
            status = put(l, &all,
                         (nevh__panel){.from = from + length * i / PIECES,
                                       .to = from + length * (i + 1) / PIECES});
        }
    if (!status)
        status = find_noise(l, &all);
    if (!status)
        status = find_units(l, &all);
    while (!status && all.front < all.count)
        status = loop_take(l, all.item[all.front++], false);
    queue_clear(&all);
    return status;
}

static int by_place(const void *a, const void *b) {
    const nevh__panel *one = a, *other = b;
    return (one->from > other->from) - (one->from < other->from);
}

int nevh_loop_carry(nevh_loop *l) {
    if (!l)
        return NEVH_EINVAL;
    if (l->report.status || l->carried)
        return l->report.status;
    l->carried = true;
    l->reach = l->options.times;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = loop_begin(l);
    if (!status)
        status = cut_all(l);
    if (!status)
        status = nevh__loop_look_inside(l);
    fesetenv(&own);
    if (status)
        l->reach = 0;
    if (l->shape)
        qsort(l->shape, l->panels, sizeof *l->shape, by_place);
    return l->report.status;
}

nevh_loop_area nevh_loop_result(const nevh_loop *l, size_t i) {
    nevh_loop_area r = {NAN, NAN, NAN, 0, false};
    if (!l || i >= l->options.times || !l->steps)
        return r;
    r.t = l->options.t0 + (double)l->steps[i] * l->options.h;
    if (l->carried && i < l->reach) {
        r.area = l->area[i];
        r.error = l->error[i] + sqrt(l->noise[i]);
        r.inside = l->inside[i];
        r.points = l->panels * NEVH__NODES;
    }
    return r;
}

bool nevh_loop_shape(const nevh_loop *l, size_t i, size_t point, double q[],
                     double p[]) {
    if (!l || i >= l->reach || !l->shape || point >= l->panels * NEVH__NODES)
        return false;
    size_t size = l->n * NEVH__NODES;
    const double *from = l->shape[point / NEVH__NODES].states + 2 * size * i;
    for (size_t k = 0; k < l->n; k++) {
        if (q)
            q[k] = from[k * NEVH__NODES + point % NEVH__NODES];
        if (p)
            p[k] = from[size + k * NEVH__NODES + point % NEVH__NODES];
    }
    return true;
}

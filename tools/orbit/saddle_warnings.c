/* nevh: runs that pass a saddle, or do not pass it, by the error of their energy.

   An orbit of H = T(p) + V(q) never reaches a place where V is above its energy, and
   never turns on the top of a barrier that is below it.  A run that does either is on the
   wrong side of a separatrix, however small its error is.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "portrait.h"
#include "warnings.h"
#include <math.h>
#include <stdlib.h>

static const double most_steps = 2e5; /* of a trial */

/* A saddle that the orbit comes to, and the centres on its sides. */
typedef struct {
    double x, left, right;
    double energy, gap; /* gap: the orbit's energy less the saddle's */
} barrier;

typedef struct {
    const plan *plan;
    double period; /* of the coordinate; 0 */
    double energy; /* of the start */
    double depth; /* of the well: the start's energy over the lowest centre's */
    double low, high, fastest; /* what the orbit spans: q, and |p| */
    size_t turns;
    double last, moved; /* q of the step before, and the change up to it */
    equilibrium *at;    /* centres and saddles from left to right */
    size_t count;
    barrier found[2]; /* the nearest to a crossing of those above and below */
    size_t barriers;
} survey;

/* The copy of x that is nearest to q. */
static double copy_near(const survey *s, double x, double q) {
    return s->period > 0 ? x + s->period * round((q - x) / s->period) : x;
}

/* Ends when the orbit has turned on both sides, or gone round. */
static int observe_span(void *data, size_t step, double t, const double q[],
                        const double p[]) {
    enum { TURNS = 3 };
    survey *s = data;
    double moved = step ? *q - s->last : 0;
    (void)t;
    s->turns += moved * s->moved < 0;
    s->last = *q;
    s->moved = moved != 0 ? moved : s->moved;
    s->low = fmin(s->low, *q);
    s->high = fmax(s->high, *q);
    s->fastest = fmax(s->fastest, fabs(*p));
    bool round = s->period > 0 && s->high - s->low > s->period;
    return s->turns >= TURNS || round ? NEVH_STOPPED : NEVH_OK;
}

/* The span of the orbit itself; false: it is not known. */
static bool span_orbit(survey *s) {
    static const double tolerance = 1e-10;
    const plan *p = s->plan;
    nevh_options o = plan_options(p, "exact");
    double q = p->q[0], m = p->p[0], h = plan_shortest_dt(p);
    o.gradient_step = 0;
    o.tolerance = tolerance;
    s->low = s->high = q;
    nevh_stepper *dop = nevh_stepper_new(p->system, nevh_dop853, &o);
    int status = nevh_stepper_status(dop);
    size_t steps = (size_t)fmin(most_steps, fmax(1, plan_steps(p, h)));
    if (!status)
        status = nevh_run(dop, p->run->t_start, h, steps, &q, &m,
                          &(nevh_observer){observe_span, s, 1}, 1);
    nevh_stepper_free(dop);
    return (!status || status == NEVH_STOPPED) && s->high > s->low;
}

/* Half of what the orbit spans beyond it on each side; of an angle a period. */
static portrait_window window_of(const survey *s) {
    double middle = (s->low + s->high) / 2, width = s->high - s->low;
    double half = s->period > 0 ? s->period / 2 : width;
    return (portrait_window){middle - half, middle + half, -1.25 * s->fastest,
                             1.25 * s->fastest};
}

static int by_place(const void *a, const void *b) {
    const equilibrium *one = a, *other = b;
    return (one->x > other->x) - (one->x < other->x);
}

/* False where one of them moves, or is of no clear kind. */
static bool find_equilibria(survey *s) {
    static const double rest = 1e-3; /* of the largest momentum */
    levels l = {.plan = s->plan,
                .window = window_of(s),
                .field = levels_field(s->plan)};
    if (nevh_field_status(l.field)) {
        nevh_field_free(l.field);
        return false;
    }
    levels_find_equilibria(&l);
    s->at = l.found;
    s->count = l.count;
    if (s->count)
        qsort(s->at, s->count, sizeof *s->at, by_place);
    bool clear = s->count > 0 && !l.curve && !l.many;
    for (size_t i = 0; i < s->count; i++)
        clear = clear && s->at[i].kind != PORTRAIT_DEGENERATE &&
                fabs(s->at[i].y) < rest * s->fastest;
    s->energy = levels_energy(&l, s->plan->q[0], s->plan->p[0]);
    for (size_t i = 0; i < s->count; i++)
        s->depth = fmax(s->depth, s->energy - s->at[i].energy);
    nevh_field_free(l.field);
    return clear;
}

/* The centre next to saddle i; where there is none, what the window ends at. */
static double centre_beside(const survey *s, size_t i, int way) {
    double end = s->at[i].x + way * (s->period > 0 ? s->period / 2 : INFINITY);
    for (size_t k = i; way > 0 ? ++k < s->count : k-- > 0;)
        if (s->at[k].kind == PORTRAIT_CENTRE)
            return way > 0 ? fmin(end, s->at[k].x) : fmax(end, s->at[k].x);
    return end;
}

/* A saddle that ends what the orbit can reach, or that it passes: with a gap that is
   small against the well's depth, and no rounding. */
static void add_barrier(survey *s, size_t i) {
    static const double small = 0.25, rounding = 1e-12;
    barrier b = {s->at[i].x, centre_beside(s, i, -1), centre_beside(s, i, 1),
                 s->at[i].energy, s->energy - s->at[i].energy};
    double size = fmax(s->depth, fabs(s->energy));
    if (!(fabs(b.gap) < small * s->depth) || !(fabs(b.gap) > rounding * size))
        return;
    size_t k = 0; /* the nearest of those above, and of those below */
    while (k < s->barriers && (s->found[k].gap < 0) != (b.gap < 0))
        k++;
    if (k == s->barriers)
        s->found[s->barriers++] = b;
    else if (fabs(b.gap) < fabs(s->found[k].gap))
        s->found[k] = b;
}

/* From the start to one side, up to what ends the orbit's reach. */
static void look_along(survey *s, int way) {
    double from = s->plan->q[0];
    for (size_t k = 0; k < s->count; k++) {
        size_t i = way > 0 ? k : s->count - 1 - k;
        if (s->at[i].kind != PORTRAIT_SADDLE ||
            (s->period == 0 && (s->at[i].x - from) * way < 0))
            continue;
        add_barrier(s, i);
        if (s->at[i].energy > s->energy)
            return;
    }
}

/* Saddles are looked for in a whole plane, which takes long where H has many terms. */
static bool has_many_terms(const plan *p) {
    enum { MOST = 300 };
    size_t effects = nevh_system_effect_count(p->system), instances = 0;
    size_t *parts = tool_allocate(2 * effects, sizeof *parts);
    nevh_system_effect_parts(p->system, parts, parts + effects);
    for (size_t i = 0; i < 2 * effects; i++)
        instances += parts[i];
    tool_release(parts);
    return instances > MOST;
}

static bool has_saddles(survey *s) {
    const plan *p = s->plan;
    unsigned traits = nevh_system_traits(p->system);
    s->period = p->n == 1 ? nevh_scene_period(p->scene, 0) : 0;
    if (p->n != 1 || p->time || p->friction || !(traits & NEVH_SEPARABLE) ||
        !p->dts || has_many_terms(p) || !span_orbit(s) || !find_equilibria(s))
        return false;
    look_along(s, -1);
    look_along(s, 1);
    return s->barriers > 0;
}

/* A run that stops where it is on the wrong side. */
typedef struct {
    const survey *survey;
    double last, moved;
    const barrier *passed; /* NULL: none */
    double at, q, p;       /* when, and where */
} trial;

static bool is_wrong(const trial *r, const barrier *b, double q) {
    double x = copy_near(r->survey, b->x, r->last), off = r->last - x;
    if (b->gap < 0)
        return off * (q - x) < 0;
    return r->moved * (q - r->last) < 0 && off > b->left - b->x &&
           off < b->right - b->x;
}

static int observe_side(void *data, size_t step, double t, const double q[],
                        const double p[]) {
    trial *r = data;
    const survey *s = r->survey;
    for (size_t i = 0; step > 0 && !r->passed && i < s->barriers; i++)
        if (is_wrong(r, &s->found[i], *q)) {
            r->passed = &s->found[i];
            r->at = t;
            r->p = *p;
            r->q = *q;
        }
    r->moved = step && *q != r->last ? *q - r->last : r->moved;
    r->last = *q;
    return r->passed ? NEVH_STOPPED : NEVH_OK;
}

/* The barrier that the run goes wrong at, and when; `unknown` where it would take too
   many steps, or fails. */
static trial run(const survey *s, const row *r, double dt, bool *unknown) {
    const plan *p = s->plan;
    trial found = {.survey = s};
    double stopped;
    nevh_stepper *stepper = row_stepper(p, r, false);
    int status = nevh_stepper_status(stepper);
    *unknown = status || plan_steps(p, dt) > most_steps;
    if (!*unknown) {
        nevh_observer watch = {observe_side, &found, 1};
        status = plan_run(p, stepper, dt, &watch, 1, &stopped);
        *unknown = status && !found.passed;
    }
    row_stepper_keep(p, r, false, stepper);
    return found;
}

/* The first of halved steps that stays on its side; 0: none of those tried. */
static double step_that_holds(const survey *s, const row *r) {
    enum { HALVINGS = 5 };
    bool unknown = false;
    double dt = r->dt;
    for (int i = 0; i < HALVINGS && !unknown; i++) {
        dt /= 2;
        if (!run(s, r, dt, &unknown).passed && !unknown)
            return dt;
    }
    return 0;
}

/* The error of its energy where the run is on the wrong side. */
static double error_of(const survey *s, const trial *found) {
    nevh_field *field = plan_values(s->plan);
    double h = NAN, t = found->at;
    nevh_field_value(field, 1, &t, &found->q, &found->p, &h);
    nevh_field_free(field);
    return h - s->energy;
}

static void warn(const survey *s, const row *r, const trial *found,
                 list *words) {
    const plan *p = s->plan;
    const barrier *b = found->passed;
    double dt = step_that_holds(s, r);
    char *advice = dt > 0 ? text_print("; dt = %.3g%s does not", dt, p->unit)
                          : text_print("%s", "");
    list_print(words,
               "%s at dt = %.4g%s %s the saddle at %s = %.6g (t = "
               "%.4g%s), which the orbit does not: its energy error there is "
               "%+.2g%s, the saddle's energy is %.2g%s %s the orbit's%s",
               r->integrator, r->dt, p->unit,
               b->gap < 0 ? "passes" : "turns back at",
               nevh_scene_coordinate(p->scene, 0), b->x, found->at, p->unit,
               error_of(s, found), p->energy_unit, fabs(b->gap), p->energy_unit,
               b->gap < 0 ? "above" : "below", advice);
}

/* True if its energy errors, where it ran, may bridge a gap. */
static bool may_go_wrong(const survey *s, const row *r) {
    static const double part = 0.25; /* rows look at steps alone */
    double gap = INFINITY;
    for (size_t i = 0; i < s->barriers; i++)
        gap = fmin(gap, fabs(s->found[i].gap));
    return r->tolerance == 0 && !nevh_integrator_own_time(r->scheme) &&
           (!r->ran || r->energy.max * r->energy.scale > part * gap);
}

void saddle_warnings(const plan *p, const row rows[], size_t count,
                     list *words) {
    survey s = {.plan = p};
    if (!has_saddles(&s))
        return;
    for (size_t i = 0; i < count; i++) {
        bool unknown;
        if (!may_go_wrong(&s, &rows[i]))
            continue;
        trial found = run(&s, &rows[i], rows[i].dt, &unknown);
        if (found.passed)
            warn(&s, &rows[i], &found, words);
    }
}

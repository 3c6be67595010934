/* nevh check: what a short trial run says of a run.

   The orbit by a method of order 8 that adapts its steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "trial_run.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SAMPLES = 256,
    PARTS = 16,
    EDGE_EVERY = 8,
    PLACE_EVERY = 32,
    MOST_DOF = 48
};
/* Evaluations of single terms, or of their derivatives, in all: a second or
   two, and as many on every machine. */
static const double enough = 1e8;
static const double large = 1e4; /* instances of terms */
static const double tolerance = 1e-10;

/* The sample of most gradients, from the state and time before it. */
typedef struct {
    double *z; /* 2n */
    double t, h;
    uint64_t gradients;
} busiest;

typedef struct {
    const plan *plan;
    trial_run *found;
    largest_rates fastest;
    nevh_field *field;           /* for values */
    nevh_field *gradient;        /* the first that is asked for */
    nevh_field *exact;           /* the same, exact */
    double *slopes;              /* 6n: of both, and the exact ones beside */
    double *largest;             /* 4n: exact slopes, errors of the others */
    double steepest, most_wrong; /* of exact slopes; of errors of the others */
    double most_cancelled;       /* how much rounding changes exact ones */
    double scale;                /* of the energy */
    double *length;              /* 2n */
    double *z, *before;          /* 2n */
    double *trial;               /* 2n */
    double *moved;               /* 4n: moves, and the state that is moved */
    double *fast;                /* 2n: the state of fastest.rate */
    nevh_stepper *stepper;
    bool ends; /* the orbit, or what may be spent, at a time */
    busiest busiest;
    double looks, instances; /* instances: of terms, in H */
    double slope;            /* evaluations that a gradient of H costs */
} trial;

/* Derivatives that are taken by one state for its rates, as nevh_rates_at
   says. */
static double rates_gradients(size_t n) {
    return n <= MOST_DOF ? 12 * (double)n : 6 * 60;
}

static double work_of(const trial *f) {
    nevh_counts step = nevh_stepper_counts(f->stepper);
    nevh_counts value = nevh_field_counts(f->field);
    nevh_counts noise = nevh_field_counts(f->gradient);
    nevh_counts exact = nevh_field_counts(f->exact);
    double gradients =
        (double)(step.gradients + noise.gradients + exact.gradients) +
        f->looks * rates_gradients(f->plan->n);
    return (double)(step.values + value.values + noise.values) +
           gradients * f->slope;
}

/* H at the state, variable k moved. */
static bool is_there(trial *f, double t, size_t k, double move) {
    size_t n = f->plan->n;
    double h = NAN;
    for (size_t i = 0; i < 2 * n; i++)
        f->trial[i] = f->z[i] + (i == k ? move : 0);
    return !nevh_field_value(f->field, 1, &t, f->trial, f->trial + n, &h) &&
           isfinite(h);
}

/* Between the state, where H is, and a move to where it is not. */
static double find_edge(trial *f, double t, size_t k, double away) {
    enum { HALVINGS = 60 };
    double near = 0;
    for (int i = 0; i < HALVINGS; i++) {
        double middle = near + (away - near) / 2;
        *(is_there(f, t, k, middle) ? &near : &away) = middle;
    }
    return away;
}

/* Up to two lengths to either side, from near to far. */
static void look_for_edge(trial *f, double t) {
    for (size_t k = 0; k < 2 * f->plan->n; k++)
        for (int i = 0; i < 12; i++) {
            double part = ldexp(1, i / 2 - 4);
            double move = (i % 2 ? -part : part) * f->length[k];
            if (part >= f->found->edge || is_there(f, t, k, move))
                continue;
            static const double rounding = 1e-9; /* of the length */
            double edge = find_edge(f, t, k, move), at = f->z[k] + edge;
            f->found->edge = fabs(edge) / f->length[k];
            f->found->edge_variable = k;
            f->found->edge_at = fabs(at) < rounding * f->length[k] ? 0 : at;
            f->found->edge_time = t;
        }
}

/* Rounding noise of the first gradient over the steps of the first dt, at its
   largest. */
static void look_for_noise(trial *f, double t) {
    const plan *p = f->plan;
    double steps = fmin(1e15, (p->t_end - p->run->t_start) / p->dt[0]);
    double noise = 0;
    if (!nevh_field_energy_floor(f->gradient, t, f->trial, f->trial + p->n,
                                 p->dt[0], (size_t)steps, &noise))
        f->found->noise = fmax(f->found->noise, noise / f->scale);
}

/* True if rounding explains how far slopes b are off a, by the energy that both would
   change in a unit of time. */
static bool is_rounding(trial *f, double t, const double a[],
                        const double b[]) {
    static const double most = 8; /* of an rms */
    size_t n = f->plan->n;
    double sum = 0, floor = 0;
    for (size_t k = 0; k < n; k++) {
        double x = a[n + k] * (a[k] - b[k]), y = a[k] * (a[n + k] - b[n + k]);
        sum += x * x + y * y;
    }
    return !nevh_field_energy_floor(f->gradient, t, f->trial, f->trial + n, 1,
                                    1, &floor) &&
           sqrt(sum) <= most * floor;
}

static void take_cancelled(trial *f, double t, double most) {
    if (most > f->most_cancelled) {
        f->most_cancelled = most;
        f->found->cancelled_at = t;
    }
}

/* Exact slopes b away from the state, by `length` times what `moved` says. */
static bool slopes_beside(trial *f, double t, double length, double b[]) {
    size_t n = f->plan->n;
    double *at = f->moved + 2 * n;
    for (size_t k = 0; k < 2 * n; k++)
        at[k] = f->trial[k] + length * f->moved[k];
    return !nevh_field_gradient(f->exact, 1, &t, at, at + n, b, b + n);
}

/* Finds cancellation in the formulas: exact slopes a few roundings of the state away
   differ by more than these, and the mean of those at both sides, so close that it
   should be the slope, is off by the rounding of what cancels. */
static void look_for_cancellation(trial *f, double t, const double a[],
                                  double b[]) {
    enum { TRIES = 3 };
    static const double close = 0x1p-22;
    size_t n = f->plan->n;
    double *c = b + 2 * n, most = 0;
    for (size_t i = 0; i < TRIES; i++) {
        for (size_t k = 0; k < 2 * n; k++)
            f->moved[k] = f->trial[k] * ((double)((k + 2 * i) % 5) - 2);
        if (!slopes_beside(f, t, DBL_EPSILON, b))
            return;
        for (size_t k = 0; k < 2 * n; k++)
            most = fmax(most, fabs(b[k] - a[k]));
        for (size_t k = 0; k < 2 * n; k++)
            f->moved[k] = fmin(fabs(f->trial[k]), f->length[k]) *
                          (1 + (double)((k + i) % 3) / 4);
        if (!slopes_beside(f, t, close, b) || !slopes_beside(f, t, -close, c))
            return;
        for (size_t k = 0; k < 2 * n; k++)
            most = fmax(most, fabs((b[k] - a[k]) + (c[k] - a[k])) / 2);
    }
    take_cancelled(f, t, most);
}

/* Errors of the first gradient at the state, and of the exact one. */
static void look_for_errors(trial *f, double t) {
    size_t n = f->plan->n;
    double *a = f->slopes, *b = a + 2 * n, wrong = 0;
    const double *q = f->trial, *p = q + n;
    if (f->instances > large ||
        nevh_field_gradient(f->exact, 1, &t, q, p, a, a + n))
        return;
    look_for_cancellation(f, t, a, b);
    if (nevh_field_gradient(f->gradient, 1, &t, q, p, b, b + n))
        return;
    for (size_t k = 0; k < 2 * n; k++) {
        wrong = fmax(wrong, fabs(a[k] - b[k]));
        f->steepest = fmax(f->steepest, fabs(a[k]));
        f->largest[k] = fmax(f->largest[k], fabs(a[k]));
        f->largest[2 * n + k] = fmax(f->largest[2 * n + k], fabs(a[k] - b[k]));
    }
    if (wrong > f->most_wrong) {
        f->most_wrong = wrong;
        f->found->wrong_at = t;
        f->found->rounded = is_rounding(f, t, a, b);
    }
}

/* The variable whose own derivative is lost most. */
static void find_lost(const trial *f) {
    size_t n = f->plan->n;
    for (size_t k = 0; k < 2 * n; k++) {
        double own = f->largest[k], error = f->largest[2 * n + k];
        if (own > 0 && error / own > f->found->lost) {
            f->found->lost = error / own;
            f->found->lost_variable = k;
        }
    }
}

static void look(trial *f, int i, double t) {
    size_t n = f->plan->n;
    f->looks++;
    memcpy(f->trial, f->z, 2 * n * sizeof *f->z);
    double rate = f->fastest.rate;
    largest_rates_observe(&f->fastest, 0, t, f->trial, f->trial + n);
    if (f->fastest.rate > rate)
        memcpy(f->fast, f->z, 2 * n * sizeof *f->z);
    look_for_noise(f, t);
    look_for_errors(f, t);
    if (i % EDGE_EVERY == 0 && n <= MOST_DOF)
        look_for_edge(f, t);
}

/* True if the scene stops the run here. */
static bool is_stopped(trial *f, double t) {
    bool reached;
    memcpy(f->trial, f->z, 2 * f->plan->n * sizeof *f->z);
    return !nevh_scene_stop_reached(f->plan->scene, t, f->trial,
                                    f->trial + f->plan->n, &reached) &&
           reached;
}

/* A sample's time back, and on to the stop in short steps.
   returns  the time there */
static double look_up_to_stop(trial *f, double t, double h) {
    enum { SHORTER = 64 };
    size_t n = f->plan->n;
    memcpy(f->z, f->before, 2 * n * sizeof *f->z);
    for (int i = 1; i <= SHORTER; i++) {
        double from = t + (i - 1) * h / SHORTER;
        int status =
            nevh_stepper_apply(f->stepper, from, h / SHORTER, f->z, f->z + n);
        if (status || is_stopped(f, from + h / SHORTER))
            return from + h / SHORTER;
        look(f, i, from + h / SHORTER);
    }
    return t + h;
}

static void keep_busiest(trial *f, double t, double h, uint64_t gradients) {
    if (gradients <= f->busiest.gradients)
        return;
    memcpy(f->busiest.z, f->before, 2 * f->plan->n * sizeof *f->z);
    f->busiest.t = t;
    f->busiest.h = h;
    f->busiest.gradients = gradients;
}

/* Steps of sample i, to the time *t; a sample alone may use the whole budget for a
   large H, of which one step is taken in any case. */
static int take_sample(trial *f, int i, double h, double *t) {
    const plan *p = f->plan;
    int parts = f->instances > large ? PARTS : 1, status = NEVH_OK;
    uint64_t gradients = nevh_stepper_counts(f->stepper).gradients;
    memcpy(f->before, f->z, 2 * p->n * sizeof *f->z);
    for (int k = 0; !status && k < parts; k++) {
        if (k > 0 && work_of(f) >= enough)
            break;
        status =
            nevh_stepper_apply(f->stepper, *t, h / parts, f->z, f->z + p->n);
        if (!status)
            *t = p->run->t_start + (i - 1 + (k + 1.) / parts) * h;
    }
    gradients = nevh_stepper_counts(f->stepper).gradients - gradients;
    if (!status)
        keep_busiest(f, p->run->t_start + (i - 1) * h, h, gradients);
    return status;
}

/* The busiest part of the busiest sample, again and again: what is fast there may lie
   between samples, as where bodies pass each other closely. */
static void look_closer(trial *f) {
    enum { TIMES = 3, FINER = 32 };
    size_t n = f->plan->n;
    for (int i = 0; i < TIMES && f->busiest.gradients > 0; i++) {
        double begin = f->busiest.t, h = f->busiest.h / FINER;
        memcpy(f->z, f->busiest.z, 2 * n * sizeof *f->z);
        f->busiest.gradients = 0;
        for (int k = 0; k < FINER && work_of(f) < enough; k++) {
            double t = begin + k * h;
            uint64_t before = nevh_stepper_counts(f->stepper).gradients;
            memcpy(f->before, f->z, 2 * n * sizeof *f->z);
            if (nevh_stepper_apply(f->stepper, t, h, f->z, f->z + n) ||
                is_stopped(f, t + h))
                return;
            keep_busiest(f, t, h,
                         nevh_stepper_counts(f->stepper).gradients - before);
            look(f, 1, t + h);
        }
    }
}

static void keep_place(trial *f, double t, const double z[]) {
    trial_run *found = f->found;
    size_t width = 2 * f->plan->n;
    found->place =
        tool_grown(found->place, found->places, sizeof *found->place);
    double *copy = tool_allocate(width, sizeof *copy);
    memcpy(copy, z, width * sizeof *copy);
    found->place[found->places++] = (trial_place){t, copy};
}

/* Steps may pass the end of the solution, where its rates are none. */
static void run(trial *f) {
    const plan *p = f->plan;
    double begin = p->run->t_start, t = begin, ends = plan_ends(p);
    double h = ((isfinite(ends) ? ends : p->t_end) - begin) / SAMPLES;
    int status = nevh_stepper_status(f->stepper);
    bool over = false;
    look(f, 0, t);
    keep_place(f, t, f->z);
    for (int i = 1; !status && i <= SAMPLES; i++) {
        over = isfinite(ends) && i == SAMPLES;
        if (over || (i > 1 && work_of(f) >= enough))
            break;
        status = take_sample(f, i, h, &t);
        if (status)
            break;
        if (is_stopped(f, t)) {
            t = look_up_to_stop(f, begin + (i - 1) * h, h);
            f->ends = true;
            break;
        }
        look(f, i, t);
        if (i % PLACE_EVERY == 0 && i < SAMPLES)
            keep_place(f, t, f->z);
    }
    f->found->length = t - begin;
    f->ends = f->ends || status || !(f->found->length >= p->t_end - begin);
    if (!status && !over)
        look_closer(f);
    if (f->fastest.rate > 0)
        keep_place(f, f->fastest.rate_at, f->fast);
    if (status || over)
        f->found->failure =
            why_until(p, ends, nevh_stepper_message(f->stepper));
}

/* The indicators of nevh chaos, of H itself; where the run is too short for them,
   of a longer one, unless the orbit ends or H is large. */
static void judge(const trial *f) {
    static const double longer = 8, little = 0.5;
    const plan *p = f->plan;
    trial_run *found = f->found;
    nevh_options o = plan_options(p, p->gradients.item[0]);
    nevh_chaos_finding more;
    double begin = p->run->t_start, length = found->length;
    found->plane = p->n == 1 && !p->time;
    if (found->plane || !(length > 0))
        return;
    o.gradient_step = 0;
    o.scale = f->length;
    o.transform = NULL;
    double seconds = f->slope > large ? little : 0;
    nevh_chaos_find(p->system, &o, begin, begin + length, seconds,
                    &found->chaos);
    double missing = begin + length - found->chaos.report.t;
    if (found->chaos.report.verdict == NEVH_EARLY && !f->ends && !seconds &&
        missing < 1e-6 * length &&
        !nevh_chaos_find(p->system, &o, begin, begin + longer * length, 0,
                         &more))
        found->chaos = more;
}

static bool take_lengths(trial *f, const nevh_options *o) {
    nevh_probe *probe = nevh_probe_new(f->plan->system, o);
    bool there = !nevh_probe_status(probe);
    if (there)
        memcpy(f->length, nevh_probe_lengths(probe),
               2 * f->plan->n * sizeof *f->length);
    nevh_probe_free(probe);
    return there;
}

static nevh_stepper *new_stepper(const trial *f) {
    const plan *p = f->plan;
    nevh_options o = plan_options(p, "exact");
    for (size_t k = 0; k < p->n; k++) {
        f->z[k] = p->q[k];
        f->z[p->n + k] = p->p[k];
    }
    o.q = f->z;
    o.p = f->z + p->n;
    o.gradient_step = 0;
    o.tolerance = tolerance;
    o.scale = f->length;
    return nevh_stepper_new(p->system, nevh_dop853, &o);
}

/* A piece of many costs as much as so many instances. */
static double cost_of_gradient(const trial *f) {
    static const double a_piece = 40, few = 100;
    double pieces = (double)nevh_field_pieces(f->gradient);
    return f->instances + a_piece * fmax(0, pieces - few);
}

trial_run trial_run_new(const plan *p, bool chaos) {
    trial_run found = {.edge = INFINITY};
    nevh_options given = plan_options(p, p->gradients.item[0]);
    nevh_options o = plan_options(p, "exact");
    trial f = {.plan = p, .found = &found};
    f.length = tool_allocate(2 * p->n, sizeof *f.length);
    f.z = tool_allocate(2 * p->n, sizeof *f.z);
    f.before = tool_allocate(2 * p->n, sizeof *f.z);
    f.trial = tool_allocate(2 * p->n, sizeof *f.trial);
    f.moved = tool_allocate(4 * p->n, sizeof *f.moved);
    f.fast = tool_allocate(2 * p->n, sizeof *f.fast);
    f.busiest.z = tool_allocate(2 * p->n, sizeof *f.z);
    o.gradient_step = 0;
    f.field = plan_values(p);
    f.gradient = nevh_field_new(p->system, &given);
    f.exact = nevh_field_new(p->system, &o);
    f.slopes = tool_allocate(6 * p->n, sizeof *f.slopes);
    f.largest = tool_allocate(4 * p->n, sizeof *f.largest);
    f.scale = plan_energy_scale(p);
    f.instances = (double)nevh_field_counts(f.field).instances;
    f.slope = cost_of_gradient(&f);
    if (take_lengths(&f, &o)) {
        o.scale = f.length;
        f.fastest.rates = nevh_rates_new(p->system, &o);
        f.stepper = new_stepper(&f);
        run(&f);
        if (chaos)
            judge(&f);
        nevh_stepper_free(f.stepper);
    }
    find_lost(&f);
    found.wrong = f.steepest > 0 ? f.most_wrong / f.steepest : 0;
    found.cancelled = f.steepest > 0 ? f.most_cancelled / f.steepest : 0;
    found.frequency = f.fastest.frequency;
    found.frequency_at = f.fastest.frequency_at;
    found.rate = f.fastest.rate;
    found.rate_at = f.fastest.rate_at;
    found.drive = plan_drive(p, &found.driver);
    nevh_rates_free(f.fastest.rates);
    nevh_field_free(f.field);
    nevh_field_free(f.gradient);
    nevh_field_free(f.exact);
    return found;
}

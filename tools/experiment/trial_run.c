/* nevh check: what a short trial run says of a run.

   The orbit by a method of order 8 that adapts its steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "trial_run.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 256, PARTS = 16, EDGE_EVERY = 8, MOST_DOF = 48 };
/* Evaluations of single terms, or of their derivatives, in all: a second or
   two, and as many on every machine. */
static const double enough = 1e8;
static const double large = 1e4; /* instances of terms */
static const double tolerance = 1e-10;

typedef struct {
    const plan *plan;
    trial_run *found;
    largest_rates fastest;
    nevh_field *field;           /* for values */
    nevh_field *gradient;        /* the first that is asked for */
    nevh_field *exact;           /* the same, exact */
    double *slopes;              /* 4n: of both */
    double steepest, most_wrong; /* of exact slopes; of errors of the others */
    double scale;                /* of the energy */
    double *length;              /* 2n */
    double *z, *before;          /* 2n */
    double *trial;               /* 2n */
    nevh_stepper *stepper;
    bool ends;               /* the orbit, or what may be spent, at a time */
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

/* Errors of the first gradient at the state. */
static void look_for_errors(trial *f, double t) {
    size_t n = f->plan->n;
    double *a = f->slopes, *b = a + 2 * n;
    const double *q = f->trial, *p = q + n;
    if (f->instances > large ||
        nevh_field_gradient(f->exact, 1, &t, q, p, a, a + n) ||
        nevh_field_gradient(f->gradient, 1, &t, q, p, b, b + n))
        return;
    double wrong = 0;
    for (size_t k = 0; k < 2 * n; k++) {
        wrong = fmax(wrong, fabs(a[k] - b[k]));
        f->steepest = fmax(f->steepest, fabs(a[k]));
    }
    if (wrong > f->most_wrong) {
        f->most_wrong = wrong;
        f->found->wrong_at = t;
        f->found->rounded = is_rounding(f, t, a, b);
    }
}

static void look(trial *f, int i, double t) {
    size_t n = f->plan->n;
    f->looks++;
    memcpy(f->trial, f->z, 2 * f->plan->n * sizeof *f->z);
    largest_rates_observe(&f->fastest, 0, t, f->trial, f->trial + n);
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

/* Steps of sample i, to the time *t; a sample alone may use the whole budget for a
   large H, of which one step is taken in any case. */
static int take_sample(trial *f, int i, double h, double *t) {
    const plan *p = f->plan;
    int parts = f->instances > large ? PARTS : 1, status = NEVH_OK;
    memcpy(f->before, f->z, 2 * p->n * sizeof *f->z);
    for (int k = 0; !status && k < parts; k++) {
        if (k > 0 && work_of(f) >= enough)
            break;
        status =
            nevh_stepper_apply(f->stepper, *t, h / parts, f->z, f->z + p->n);
        if (!status)
            *t = p->run->t_start + (i - 1 + (k + 1.) / parts) * h;
    }
    return status;
}

/* Steps may pass the end of the solution, where its rates are none. */
static void run(trial *f) {
    const plan *p = f->plan;
    double begin = p->run->t_start, t = begin, ends = plan_ends(p);
    double h = ((isfinite(ends) ? ends : p->t_end) - begin) / SAMPLES;
    int status = nevh_stepper_status(f->stepper);
    bool over = false;
    look(f, 0, t);
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
    }
    f->found->length = t - begin;
    f->ends = f->ends || status || !(f->found->length >= p->t_end - begin);
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
    o.gradient_step = 0;
    f.field = plan_values(p);
    f.gradient = nevh_field_new(p->system, &given);
    f.exact = nevh_field_new(p->system, &o);
    f.slopes = tool_allocate(4 * p->n, sizeof *f.slopes);
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
    found.wrong = f.steepest > 0 ? f.most_wrong / f.steepest : 0;
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

static void edge_notes(const plan *p, const trial_run *f, list *notes) {
    size_t k = f->edge_variable;
    if (isfinite(f->edge))
        list_print(notes,
                   "The domain of H ends at %s%s = %.6g: its distance "
                   "from the orbit is %.2g of the length over which H varies, "
                   "near t = %.4g",
                   k < p->n ? "" : "p_",
                   nevh_scene_coordinate(p->scene, k % p->n), f->edge_at,
                   f->edge, f->edge_time);
    if (f->failure)
        list_print(notes, "The orbit was integrated up to t = %.6g: %s",
                   p->run->t_start + f->length, f->failure);
}

/* When rounding errors of a chaotic orbit are as large as it is. */
static void horizon_notes(const plan *p, const trial_run *f, list *notes) {
    double start = p->run->t_start, grown = -log(DBL_EPSILON);
    double exponent = f->chaos.exponent, error = f->chaos.error;
    double horizon = start + grown / exponent;
    char *range = text_print("%.3g to %.3g", start + grown / (exponent + error),
                             start + grown / (exponent - error));
    list_print(notes,
               "Chaotic: Lyapunov exponent %.2g +- %.1g%s (over %.3g%s)."
               "  Predictability horizon: %sabout t = %.3g%s (%s, as the "
               "exponent is uncertain): rounding errors have then grown to the "
               "size of the orbit.  Positions after it cannot be predicted; "
               "energies and averages can.",
               exponent, error, p->per_unit, f->chaos.report.t - start, p->unit,
               horizon < p->t_end ? "" : "beyond the run, ", horizon, p->unit,
               range);
}

/* Notes the time followed, and its meaning for a longer run. */
static void outlook_notes(const plan *p, const trial_run *f, list *notes) {
    double time = f->chaos.report.t - p->run->t_start;
    if (f->plane) {
        list_add(notes, "Regular: one degree of freedom without a drive cannot "
                        "be chaotic.");
        return;
    }
    switch (f->chaos.report.verdict) {
    case NEVH_CHAOTIC:
        horizon_notes(p, f, notes);
        break;
    case NEVH_UNSTABLE_ORBIT:
        list_print(notes,
                   "Unstable, not chaotic: Lyapunov exponent about %.2g%s over "
                   "%.3g%s; nearby orbits separate as near an unstable "
                   "equilibrium or periodic orbit, or in an escape.",
                   f->chaos.exponent, p->per_unit, time, p->unit);
        break;
    case NEVH_UNRESOLVED:
        list_print(notes, "Chaotic or regular: %s", plan_kinks_text);
        break;
    case NEVH_REGULAR:
        list_print(notes,
                   "Regular: over %.3g%s the distance of neighbouring orbits "
                   "does not grow exponentially (Lyapunov exponent below "
                   "%.2g%s).",
                   time, p->unit, f->chaos.error + fabs(f->chaos.exponent),
                   p->per_unit);
        break;
    default:
        if (f->length > 0)
            list_print(notes,
                       "Chaotic or regular: %.3g%s are too short to decide; "
                       "%s.",
                       f->length, p->unit,
                       f->failure ? "the orbit is followed no further"
                                  : "--t-end makes the run longer");
        else
            list_print(notes,
                       "Chaotic or regular: unknown, since the run ends at "
                       "its start%s%s.",
                       f->failure ? ": " : "", f->failure ? f->failure : "");
    }
}

/* Notes changes of H with time that are faster than a step. */
static void change_notes(const plan *p, list *notes) {
    const char *effect = "";
    double at, time = nevh_timing_shortest(p->timing, &at, &effect);
    if (time < p->dt[0])
        list_print(notes,
                   "%s changes within %.2g%s near t = %.6g%s: steps of dt "
                   "= %.4g%s pass over it",
                   effect, time, p->unit, at, p->unit, p->dt[0], p->unit);
    time_notes(p, notes);
}

/* The rounding of differences that are far off means nothing. */
static void gradient_notes(const plan *p, const trial_run *f, list *notes) {
    static const double much = 1e-6, far_off = 1e-2;
    const char *name = p->gradients.item[0];
    if (isfinite(f->noise) && !(f->wrong > far_off))
        list_print(notes,
                   f->noise > 0
                       ? "Gradient: the rounding of %s causes an energy error "
                         "of %.1e over the run%s"
                       : "Gradient: %s adds no rounding error of its own",
                   name, f->noise,
                   f->rough ? "; its differences err more where they reach "
                              "across a place where H is not smooth"
                            : "");
    if (f->wrong > much && !f->rough)
        list_print(notes,
                   "Gradient: %s errs by %.1e of the largest derivative (t = "
                   "%.4g%s): %s; --gradient exact does not err.",
                   name, f->wrong, f->wrong_at, p->unit,
                   f->rounded ? "its steps are so short that the rounding of H "
                                "counts"
                              : "H varies there over shorter lengths than its "
                                "differences are made for");
}

void trial_run_words(const plan *p, const trial_run *f, list *notes) {
    const char *rad = *p->unit ? " rad" : "";
    if (f->drive > f->frequency)
        list_print(notes,
                   "Highest frequency: omega = %.3g%s%s, of %s with time; "
                   "omega dt = %.3g at dt = %.4g%s",
                   f->drive, rad, p->per_unit, f->driver, p->dt[0] * f->drive,
                   p->dt[0], p->unit);
    if (f->frequency > 0)
        list_print(notes,
                   "%s: omega = %.3g%s%s (t = %.4g%s); "
                   "omega dt = %.3g at dt = %.4g%s",
                   f->drive > f->frequency ? "Highest frequency of the motion"
                                           : "Highest frequency",
                   f->frequency, rad, p->per_unit, f->frequency_at, p->unit,
                   p->dt[0] * f->frequency, p->dt[0], p->unit);
    change_notes(p, notes);
    if (f->rate > f->frequency)
        list_print(notes,
                   "Fastest growth: small displacements grow at a rate of "
                   "%.3g%s (t = %.4g%s); rate dt = %.3g at dt = %.4g%s",
                   f->rate, p->per_unit, f->rate_at, p->unit,
                   p->dt[0] * f->rate, p->dt[0], p->unit);
    outlook_notes(p, f, notes);
    gradient_notes(p, f, notes);
    edge_notes(p, f, notes);
}

const char *trial_run_verdict(const trial_run *f, double limit, double dt) {
    if (f->frequency * dt > limit)
        return "unstable";
    return fmax(f->rate, f->drive) * dt > 1 ? "not resolved" : NULL;
}

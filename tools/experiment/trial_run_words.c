/* nevh check: a trial run in words.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "trial_run.h"
#include <float.h>
#include <math.h>

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
    bool cancelled = f->cancelled > much && !f->rough;
    if (cancelled)
        list_print(
            notes,
            "Gradient: numbers in the formulas of H cancel, so that rounding "
            "changes even the exact gradient by %.1g of the largest "
            "derivative (t = %.4g%s): write them otherwise, as "
            "2*sin(x/2)^2 for 1 - cos(x)",
            f->cancelled, f->cancelled_at, p->unit);
    if (isfinite(f->noise) && !(f->wrong > far_off) && !cancelled)
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
                   "%.4g%s): %s%s.",
                   name, f->wrong, f->wrong_at, p->unit,
                   f->rounded ? "its steps are so short that the rounding of H "
                                "counts"
                              : "H varies there over shorter lengths than its "
                                "differences are made for",
                   cancelled ? "" : "; --gradient exact takes no differences");
}

/* A derivative far below others may be lost where theirs are not. */
static void lost_notes(const plan *p, const trial_run *f, list *notes) {
    static const double most = 1e-2, much = 1e-6;
    size_t k = f->lost_variable;
    if (f->lost > most && !(f->wrong > much) && !f->rough)
        list_print(
            notes,
            "Gradient: %s errs by %.1g of the largest dH/d%s%s, which is "
            "far below other derivatives: --gradient exact takes no "
            "differences",
            p->gradients.item[0], f->lost, k < p->n ? "" : "p_",
            nevh_scene_coordinate(p->scene, k % p->n));
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
    lost_notes(p, f, notes);
    edge_notes(p, f, notes);
}

const char *trial_run_verdict(const trial_run *f, double limit, double dt) {
    if (f->frequency * dt > limit)
        return "unstable";
    return fmax(f->rate, f->drive) * dt > 1 ? "not resolved" : NULL;
}

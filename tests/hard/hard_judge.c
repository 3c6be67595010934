/* nevh tests: hard cases: what a result means, by what is known of scheme and case.

   Theory: steps of order r conserve an energy that differs from H by a part
   (h omega)^r of what the orbit exchanges, if they are symplectic, or symmetric
   and the orbit reversible [E. Hairer, C. Lubich, G. Wanner, Geometric
   Numerical Integration, chapters IX and XI]; those of other methods add an
   error of (h omega)^(r+1) in each step.  Constants are taken to be below 10.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hard_judge.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double constant = 10, tolerance = 1e-9;

const char *hard_verdict_name(hard_verdict v) {
    static const char *const names[] = {"none",   "wrong orbit", "bounded",
                                        "drifts", "unstable",    "refused",
                                        "failed"};
    _Static_assert(sizeof names / sizeof *names == HARD_VERDICTS,
                   "each verdict");
    return v < HARD_VERDICTS ? names[v] : "none";
}

static bool is(const hard_subject *s, unsigned facts) {
    return s->known.facts & facts;
}

/* Of the orbit as it should be: where a run went astray excuses nothing. */
static double pace_of(const hard_subject *s) {
    return s->dt * s->pace;
}

/* Whether theory keeps the energy in bounds. */
bool hard_keeps(const hard_result *r) {
    return nevh_integrator_symplectic(r->scheme) != NEVH_NO ||
           nevh_integrator_preserves_energy(r->scheme) == NEVH_YES ||
           nevh_integrator_symmetric(r->scheme) != NEVH_NO;
}

/* What is preserved for any step: H itself, by Itoh and Abe's and by Gonzalez's
   methods.  Averaging has a quadrature, exact for polynomials of twice as many
   degrees as there are nodes: an order of its own. */
static double kept_order(const hard_subject *s, const hard_result *r) {
    if (nevh_integrator_preserves_energy(r->scheme) != NEVH_YES || s->balance)
        return nevh_integrator_order(r->scheme);
    if (r->scheme != nevh_avf)
        return INFINITY;
    return 2 * nevh_integrator_stages(r->scheme);
}

static double kept_bound(const hard_subject *s, const hard_result *r) {
    double x = pace_of(s), order = kept_order(s, r);
    if (isinf(order))
        return 0;
    return constant * hard_haste(r) * s->peak * pow(x, order);
}

static double drift_bound(const hard_subject *s, const hard_result *r) {
    double x = pace_of(s), steps = (double)r->steps;
    if (nevh_integrator_adaptive(r->scheme))
        return 100 * tolerance * s->peak * steps * fmax(1, x);
    return constant * s->peak * steps *
           pow(x, nevh_integrator_order(r->scheme) + 1);
}

/* Of stages solved to the last digits, some forty epsilon a step. */
static double rounding(const hard_subject *s, const hard_result *r) {
    return 1e-14 * s->peak * (double)r->steps;
}

static double find_bound(const hard_subject *s, const hard_result *r) {
    double error = hard_keeps(r) ? kept_bound(s, r)
                                 : fmax(kept_bound(s, r), drift_bound(s, r));
    return fmin(1, error + r->floor + rounding(s, r));
}

/* Why a scheme may refuse a case, told apart by what the case is. */
static bool refuses_rightly(const hard_subject *s, const hard_result *r) {
    unsigned needs = nevh_integrator_needs(r->scheme);
    bool exact = strcmp(r->gradient, "exact") == 0;
    if (!r->reason || strlen(r->reason) < 20)
        return false;
    if (r->status == NEVH_ENOGRAD)
        return exact && is(s, HARD_BLACK_BOX);
    if (r->status != NEVH_ESTRUCT)
        return false;
    /* GSL's own evaluations are out of reach, so that they cannot be balanced.
     */
    if (s->balance && strncmp(nevh_integrator_name(r->scheme), "gsl-", 4) == 0)
        return true;
    /* Series are of formulas that are analytic. */
    if (nevh_integrator_needs_formulas(r->scheme) &&
        is(s, HARD_BLACK_BOX | HARD_KINK | HARD_EDGE))
        return true;
    /* A tolerance decides over steps that friction would be put around. */
    if (needs && nevh_integrator_adaptive(r->scheme) && is(s, HARD_FRICTION))
        return true;
    return (needs && is(s, HARD_MIXED | HARD_NOISE)) ||
           (needs & NEVH_QUADRATIC_KINETIC && is(s, HARD_MIXED)) ||
           (needs & NEVH_PARTS && is(s, HARD_BLACK_BOX)) ||
           (nevh_integrator_own_time(r->scheme) && s->balance);
}

/* Steps beyond the scheme's limit.  To have next to none contradicts the claim
   to keep the energy. */
static bool is_too_long(const hard_subject *s, const hard_result *r) {
    return stability_exceeded(r->scheme, r->limit, s->dt * s->frequency) &&
           (r->limit > 0.1 || !hard_keeps(r));
}

/* Whether a run that ended, or lost its energy, had a reason to. */
static bool is_explained(const hard_subject *s, const hard_result *r) {
    double x = pace_of(s);
    return is(s, HARD_EDGE | HARD_ESCAPE | HARD_NOISE | HARD_ANY_STEP) ||
           is_too_long(s, r) || x > 1 || kept_bound(s, r) > 1 ||
           (!hard_keeps(r) && drift_bound(s, r) > 0.1);
}

static char *tell_cause(const hard_subject *s, const hard_result *r) {
    largest_rates fastest = {.frequency = r->frequency,
                             .frequency_at = r->fastest_at};
    char *cause =
        stability_cause(r->scheme, r->limit, s->dt, s->t_end - s->t, &fastest);
    if (cause)
        return cause;
    return text_print(is(s, HARD_EDGE) ? "the orbit meets a singularity, or "
                                         "the end of H"
                      : is(s, HARD_ESCAPE) ? "the orbit escapes"
                      : is(s, HARD_NOISE)  ? "values of H are noise"
                      : kept_bound(s, r) > 1
                          ? "the orbit exchanges more than its energy, which "
                            "theory bounds no better at this order and step"
                          : "no cause was found");
}

/* A symmetric method goes back the way it came, whatever its errors and those
   of its gradients: all but the rounding of each step, carried along. */
static hard_verdict judge_return(const hard_subject *s, hard_result *r) {
    double rest = r->state_floor + 1e-14 * 2 * r->asked;
    double allowed = rest * hard_orbit_growth(s->orbit);
    bool symmetric = nevh_integrator_symmetric(r->scheme) == NEVH_YES;
    r->happened = text_print("comes back to %.1e", r->defect);
    if (r->defect <= allowed)
        return HARD_BOUNDED;
    return symmetric ? HARD_NONE : HARD_DRIFTS;
}

/* A line all along, above rounding, in a scheme that must not have any where it
   resolves the orbit: what its energy differs by from H is a function of the
   state, and states come back.  Of balances nothing is known. */
static bool climbs(const hard_subject *s, const hard_result *r) {
    bool known =
        !s->balance && pace_of(s) <= 1 && !is(s, HARD_KINK | HARD_SHORT);
    return known && hard_keeps(r) && r->energy.verdict == NEVH_DRIFTS &&
           r->energy.max > r->floor + rounding(s, r);
}

/* Whether there is no more than rounding.  Where values of H are noise that is larger
   than rounding, errors walk at random, also while they happen to stay small. */
static bool is_level(const hard_subject *s, const hard_result *r) {
    static const double most_rounding = 1e-8; /* of the energy */
    double most = r->energy.max;
    bool walks = is(s, HARD_NOISE) && most > most_rounding;
    return r->energy.verdict == NEVH_BOUNDED && !walks &&
           most <= r->floor + rounding(s, r);
}

static hard_verdict judge_energy(const hard_subject *s, hard_result *r) {
    double most = r->energy.max;
    r->happened = text_print(
        r->whole ? "energy error %.1e"
                 : "energy error %.1e; stopped by the budget after %zu of %.0e "
                   "steps",
        most, r->steps, r->asked);
    if (most > r->bound || climbs(s, r))
        return HARD_NONE;
    if (r->state_error > r->state_bound) {
        tool_release(r->happened);
        r->happened = text_print(
            "energy error %.1e, but at t = %.4g it is off by %.1e of the "
            "orbit's size, where theory allows %.1e",
            most, r->state_at, r->state_error, r->state_bound);
        return HARD_WRONG;
    }
    return is_level(s, r) || hard_keeps(r) ? HARD_BOUNDED : HARD_DRIFTS;
}

static hard_verdict judge_explosion(const hard_subject *s, hard_result *r) {
    char *cause = tell_cause(s, r);
    r->happened = text_print("energy error %.1e: %s", r->energy.max, cause);
    tool_release(cause);
    return is_explained(s, r) ? HARD_UNSTABLE : HARD_NONE;
}

static hard_verdict judge_failure(const hard_subject *s, hard_result *r) {
    char *cause = tell_cause(s, r);
    r->happened =
        text_print("after %zu steps: %s; %s", r->steps, r->reason, cause);
    tool_release(cause);
    return is_explained(s, r) ? HARD_FAILED : HARD_NONE;
}

static hard_verdict judge(const hard_subject *s, hard_result *r) {
    if (!r->planned) {
        r->happened = text_print("%s", r->reason);
        return refuses_rightly(s, r) ? HARD_REFUSED : HARD_NONE;
    }
    if (!r->sound) {
        r->happened = text_print("numbers are not finite: %s",
                                 r->reason ? r->reason : "");
        return HARD_NONE;
    }
    if (r->status)
        return judge_failure(s, r);
    if (r->energy.max > 1)
        return judge_explosion(s, r);
    if (is(s, HARD_RETURN))
        return judge_return(s, r);
    return judge_energy(s, r);
}

void hard_judge(const hard_subject *s, hard_result *r) {
    r->bound = r->planned ? find_bound(s, r) : NAN;
    r->verdict = judge(s, r);
}

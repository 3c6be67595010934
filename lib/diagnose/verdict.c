/* nevh: the verdict on a run's energy.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/diagnose.h>
#include <math.h>

enum { FEWEST = 12 };                    /* errors that a rule is made for */
static const double growth_allowed = 2;  /* of the last fifth to the first */
static const double significant = 4;     /* of a slope, its own errors */
static const double confirmed = 4;       /* lengths of the run */
static const double nearly_ended = 0.3;  /* a power of t */
static const double along_a_line = 0.75; /* likewise */

static bool is_level(const nevh_energy_report *r) {
    return r->last_fifth <= growth_allowed * r->first_fifth;
}

static bool has_slope(const nevh_energy_report *r) {
    return r->samples >= FEWEST &&
           fabs(r->drift) > significant * r->drift_error;
}

/* The line makes most of the error. */
static bool is_line(const nevh_energy_report *r) {
    return has_slope(r) && fabs(r->drift) * r->span > r->max / 2;
}

static nevh_verdict judge_large(const nevh_energy_report *r, double times) {
    bool alone = r->theory == NEVH_THEORY_NONE;
    bool grows = !is_level(r);
    if (!isfinite(r->max) || r->least > r->limit ||
        (grows && r->max > 10 * r->limit) || r->theory == NEVH_THEORY_LOSES)
        return NEVH_UNSTABLE;
    if (!alone && times < confirmed)
        return NEVH_UNDECIDED;
    return grows ? NEVH_UNSTABLE : NEVH_BOUNDED;
}

static nevh_verdict judge_rounding(const nevh_energy_report *r, double times) {
    bool loses = r->theory == NEVH_THEORY_LOSES && is_line(r);
    bool alone = r->theory == NEVH_THEORY_NONE;
    if (is_level(r) && !loses)
        return NEVH_BOUNDED;
    return loses || (!alone && times < confirmed) ? NEVH_UNDECIDED
                                                  : NEVH_RANDOM_WALK;
}

static nevh_verdict judge_loss(const nevh_energy_report *r) {
    return has_slope(r) || r->gone ? NEVH_DRIFTS : NEVH_UNDECIDED;
}

static nevh_verdict judge_growth(const nevh_energy_report *r) {
    double slowest = fmin(r->rate[0], fmin(r->rate[1], r->rate[2]));
    double fastest = fmax(r->rate[0], fmax(r->rate[1], r->rate[2]));
    bool keeps = r->theory == NEVH_THEORY_KEEPS && r->max > r->gradient;
    bool line = is_line(r) && fmin(r->rate[0], r->rate[1]) > along_a_line;
    if (r->rate[0] < nearly_ended)
        return NEVH_BOUNDED;
    if (keeps && (slowest < nearly_ended || fastest > along_a_line))
        return NEVH_UNDECIDED;
    return line ? NEVH_DRIFTS : NEVH_RANDOM_WALK;
}

static nevh_verdict judge_kept(const nevh_energy_report *r, double times) {
    bool alone = r->theory == NEVH_THEORY_NONE;
    if (is_level(r) && (r->theory == NEVH_THEORY_KEEPS || !is_line(r)))
        return NEVH_BOUNDED;
    if (!alone && times < confirmed)
        return NEVH_UNDECIDED;
    if (is_level(r))
        return NEVH_DRIFTS;
    if (alone)
        return r->straightness >= 0.8 ? NEVH_DRIFTS : NEVH_RANDOM_WALK;
    return judge_growth(r);
}

nevh_verdict nevh_energy_verdict(const nevh_energy_report *r, double times) {
    if (!(r->max <= r->limit)) {
        nevh_verdict verdict = judge_large(r, times);
        if (verdict != NEVH_BOUNDED)
            return verdict;
    }
    if (r->max <= r->rounding)
        return judge_rounding(r, times);
    if (r->samples < FEWEST && r->theory != NEVH_THEORY_NONE)
        return NEVH_UNDECIDED;
    return r->theory == NEVH_THEORY_LOSES ? judge_loss(r)
                                          : judge_kept(r, times);
}

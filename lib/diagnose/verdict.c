/* nevh: the verdict on a run's energy.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/diagnose.h>
#include <float.h>
#include <math.h>

enum { FEWEST = 12 };                    /* errors that a rule is made for */
static const double growth_allowed = 2;  /* of the last fifth to the first */
static const double significant = 4;     /* of a slope, its own errors */
static const double nearly_ended = 0.3;  /* a power of t */
static const double along_a_line = 0.75; /* likewise */
static const double no_walk = 2;         /* likewise: faster than a drift */
static const double straight =
    0.95;                         /* of a line that theory knows nothing of */
static const double ruled = 0.99; /* of rounding that is no walk */
static const double lasting =
    0.3; /* of the largest error: is never made good */
/* Part of the limit: steps with larger errors may not resolve the orbit. */
static const double coarse = 0.03;
/* Lengths of the run that confirm: that growth has ended, that coarse steps
   keep the energy, that growth lasts. */
static const double ended = 4, kept = 8, lasted = 16;

static bool is_level(const nevh_energy_report *r) {
    return r->last_fifth <= growth_allowed * r->first_fifth;
}

static bool has_slope(const nevh_energy_report *r) {
    return r->samples >= FEWEST &&
           fabs(r->drift) > significant * r->drift_error;
}

/* The line makes most of the error; where theory says nothing, a random walk
   leans to one side as well. */
static bool is_line(const nevh_energy_report *r) {
    bool open = r->theory == NEVH_THEORY_OPEN || r->theory == NEVH_THEORY_ROUGH;
    bool leans = r->straightness <= straight || r->rate[2] < along_a_line / 2;
    return has_slope(r) && fabs(r->drift) * r->span > r->max / 2 &&
           !(open && leans);
}

/* Neither larger than early on, by more than that, nor about to grow. */
static bool is_flat(const nevh_energy_report *r, double allowed) {
    double power = log2(allowed) / 3;
    bool saturates = r->rate[0] <= power && r->rate[1] <= power;
    return r->max <= allowed * r->early ||
           (saturates && r->last_fifth <= allowed * r->first_fifth);
}

/* A drive makes the motion grow, and the error with it: a hundredfold, or less and
   steadily, as in a resonance. */
static bool is_carried(const nevh_energy_report *r) {
    static const double much = 100, some = 4;
    double before = r->relative[0], after = r->relative[1];
    bool steadily = fmin(r->rate[0], r->rate[1]) > along_a_line;
    double small = steadily ? 1 : 0.5;
    return r->theory == NEVH_THEORY_OPEN &&
           r->grown > (steadily ? some : much) &&
           r->last_fifth > sqrt(r->grown) * r->first_fifth &&
           after <= fmin(growth_allowed * before, small);
}

/* The same of a scheme that loses energy: the energies met grow faster than any drift
   does, and the error is a small part of them. */
static bool is_outgrown(const nevh_energy_report *r) {
    static const double much = 100, part = 0.1;
    double grown = fmin(r->grown, DBL_MAX);
    double slowest = fmin(r->rate[0], fmin(r->rate[1], r->rate[2]));
    return r->theory == NEVH_THEORY_LOSES && grown > much &&
           r->last_fifth > sqrt(grown) * r->first_fifth && slowest > no_walk &&
           r->relative[1] <= part;
}

/* Above the energies at the start, but level relative to those that a drive has brought
   since. */
static bool is_driven_there(const nevh_energy_report *r) {
    static const double level = 1.25, some = 1.5;
    return r->theory == NEVH_THEORY_OPEN && r->max <= r->met &&
           r->grown > some && r->relative[1] <= fmin(1, level * r->relative[0]);
}

/* True if the motion does not grow, but the energy that friction or a drive exchanges
   with it adds up, and the error of the balance with it. */
static bool adds_up(const nevh_energy_report *r) {
    static const double some = 1.5;
    return r->theory == NEVH_THEORY_OPEN && r->grown <= some && is_line(r);
}

/* Errors that are small where a motion has met its limit. */
static const double small_share = 0.1;

/* An error that large comes back where the orbit is still of use: those of the end are
   small, or there are small ones among them.  One that stays where an encounter left
   it does not. */
static bool comes_back(const nevh_energy_report *r) {
    return r->last_fifth <= small_share * r->limit ||
           r->least <= lasting * fmin(r->last_fifth, r->max);
}

static nevh_verdict judge_large(const nevh_energy_report *r, double times) {
    static const double hopeless = 1e6, much = 10;
    bool huge = r->max > much * r->limit;
    if (is_outgrown(r))
        return NEVH_UNDECIDED;
    if (!(r->max <= hopeless * r->limit) || r->theory == NEVH_THEORY_LOSES)
        return NEVH_UNSTABLE;
    if (times < (huge ? 2 * lasted : lasted))
        return NEVH_UNDECIDED;
    bool level = huge ? r->max <= 1.05 * r->early : is_flat(r, 1.25);
    if (comes_back(r) && level)
        return NEVH_BOUNDED;
    if (adds_up(r))
        return NEVH_DRIFTS;
    return is_driven_there(r) ? NEVH_UNDECIDED : NEVH_UNSTABLE;
}

/* Rounding beyond the limit hides what the scheme does. */
static nevh_verdict judge_rounding(const nevh_energy_report *r, double times) {
    if (r->theory == NEVH_THEORY_LOSES || r->max > r->limit)
        return NEVH_UNDECIDED;
    if (is_level(r))
        return NEVH_BOUNDED;
    /* Rounding alike at each step, as of an exact flow's matrix, is no walk. */
    bool walks = times >= lasted && r->straightness < ruled;
    return walks ? NEVH_RANDOM_WALK : NEVH_UNDECIDED;
}

/* Rounding of gradients leads an orbit that moves far to one side, too, though along no
   line: nothing is seen of a scheme that is exact, as in uniform gravity. */
static nevh_verdict judge_loss(const nevh_energy_report *r) {
    bool gone = r->gone || r->least > lasting * r->max;
    bool leans = isfinite(r->gradient) && r->max <= r->gradient &&
                 r->straightness < straight;
    return (has_slope(r) || gone) && !leans ? NEVH_DRIFTS : NEVH_UNDECIDED;
}

static nevh_verdict judge_growth(const nevh_energy_report *r) {
    double slowest = fmin(r->rate[0], fmin(r->rate[1], r->rate[2]));
    double fastest = fmax(r->rate[0], fmax(r->rate[1], r->rate[2]));
    bool noise = r->max <= 100 * r->rounding;
    bool keeps = r->theory == NEVH_THEORY_KEEPS && r->max > r->gradient;
    bool line = is_line(r) && fmin(r->rate[0], r->rate[1]) > along_a_line;
    if (keeps && (slowest < nearly_ended || fastest > along_a_line))
        return NEVH_UNDECIDED;
    if (fastest > no_walk || (noise && line && r->straightness > ruled))
        return NEVH_UNDECIDED;
    return line && !noise ? NEVH_DRIFTS : NEVH_RANDOM_WALK;
}

/* Lengths of the run that it takes before an error that does not grow can be
   believed: more of one that is large, or of few steps. */
static double needed(const nevh_energy_report *r, double times) {
    double few = r->theory == NEVH_THEORY_KEEPS ? 200 : 2000;
    if (r->max > coarse * r->limit)
        return kept;
    if ((double)r->samples < few * fmin(times, kept))
        return kept;
    return is_level(r) ? 1 : ended;
}

/* The motion has left the place where its energy is lost, as after a collision, and says
   nothing of what a second one would do. */
bool nevh_energy_stays(const nevh_energy_report *r) {
    static const double alike = 0.99;
    return r && r->theory == NEVH_THEORY_KEEPS &&
           r->max > small_share * r->limit && r->max > r->rounding &&
           r->least > lasting * r->max && r->least > alike * r->last_fifth;
}

static nevh_verdict judge_kept(const nevh_energy_report *r, double times) {
    bool keeps = r->theory == NEVH_THEORY_KEEPS;
    bool line = !keeps && is_line(r);
    bool large = r->max > coarse * r->limit;
    double of_large = times < lasted ? 1.25 : 1.6;
    bool flat = is_flat(r, large ? of_large : growth_allowed);
    bool level = large || !keeps ? flat : is_level(r);
    bool ending = !large && keeps && r->rate[0] < nearly_ended;
    if (nevh_energy_stays(r))
        return NEVH_UNDECIDED;
    if (!line && (level || ending))
        return times < needed(r, times) ? NEVH_UNDECIDED : NEVH_BOUNDED;
    if (times < lasted)
        return NEVH_UNDECIDED;
    if (is_level(r))
        return line ? NEVH_DRIFTS : NEVH_UNDECIDED;
    return judge_growth(r);
}

/* The verdict from the errors alone. */
static nevh_verdict judge_alone(const nevh_energy_report *r) {
    if (is_level(r))
        return is_line(r) ? NEVH_DRIFTS : NEVH_BOUNDED;
    return r->straightness >= 0.8 ? NEVH_DRIFTS : NEVH_RANDOM_WALK;
}

bool nevh_energy_passes_over(const nevh_energy_report *r) {
    static const double good = 0.5; /* of the largest error */
    return r && r->missed > good * r->max;
}

static nevh_verdict verdict_judge(const nevh_energy_report *r, double times) {
    if (r->theory == NEVH_THEORY_NONE)
        times = INFINITY;
    if (r->samples <= 1) /* of the start alone */
        return NEVH_UNDECIDED;
    if (r->scale > 0 && r->scale < DBL_MIN) /* of rounding alone */
        return NEVH_UNDECIDED;
    if (is_carried(r))
        return NEVH_UNDECIDED;
    if (r->max <= r->rounding)
        return judge_rounding(r, times);
    if (!(r->max <= r->limit))
        return judge_large(r, times);
    if (r->theory == NEVH_THEORY_NONE)
        return judge_alone(r);
    if (r->samples < FEWEST)
        return NEVH_UNDECIDED;
    return r->theory == NEVH_THEORY_LOSES ? judge_loss(r)
                                          : judge_kept(r, times);
}

nevh_verdict nevh_energy_verdict(const nevh_energy_report *r, double times) {
    nevh_verdict verdict = r ? verdict_judge(r, times) : NEVH_UNDECIDED;
    bool passes = verdict != NEVH_BOUNDED && nevh_energy_passes_over(r);
    return passes ? NEVH_UNDECIDED : verdict;
}

/* nevh compare: the table in words.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "verdict_private.h"
#include <float.h>
#include <math.h>
#include <string.h>

/* Its own run is calm: what the longer one does has a sentence of its own. */
static bool is_later(const row *r) {
    return r->ran && r->energy.verdict == NEVH_UNSTABLE && r->followed > 0 &&
           r->energy.max <= r->energy.limit;
}

bool verdict_is(const row *r, nevh_verdict verdict) {
    return r->ran && r->energy.verdict == verdict && !is_later(r);
}

/* True if all rows of that integrator have the verdict, and this is the first of
   them. */
static bool always(const row rows[], size_t count, size_t i,
                   nevh_verdict verdict) {
    for (size_t k = 0; k < count; k++)
        if (strcmp(rows[k].integrator, rows[i].integrator) == 0 &&
            (!verdict_is(&rows[k], verdict) || k < i))
            return false;
    return true;
}

static void common_words(const row rows[], size_t count, nevh_verdict verdict,
                         const char *one, const char *many, list *words) {
    list names = {0};
    for (size_t i = 0; i < count; i++)
        if (always(rows, count, i, verdict))
            list_add(&names, rows[i].integrator);
    if (names.count)
        list_print(words, "%s %s", list_joined(&names),
                   names.count == 1 ? one : many);
}

static bool same_place(const row *a, const row *b) {
    return strcmp(a->integrator, b->integrator) == 0 &&
           a->tolerance == b->tolerance && (a->tolerance > 0 || a->dt == b->dt);
}

/* True if the verdict depends on the gradient for that integrator and step. */
static bool differs(const row rows[], size_t count, const row *r) {
    for (size_t k = 0; k < count; k++)
        if (same_place(&rows[k], r) && !verdict_is(&rows[k], r->energy.verdict))
            return true;
    return false;
}

/* "dt = 0.1", and the gradient where others have another verdict there. */
static char *place_of(const row rows[], size_t count, const row *r) {
    bool adapts = r->tolerance > 0, differ = differs(rows, count, r);
    return text_print("%s = %.4g%s%s%s", adapts ? "tolerance" : "dt",
                      adapts ? r->tolerance : r->dt, differ ? " with the " : "",
                      differ ? r->gradient : "", differ ? " gradient" : "");
}

static bool several_gradients(const row rows[], size_t count) {
    for (size_t k = 1; k < count; k++)
        if (strcmp(rows[k].gradient, rows[0].gradient) != 0)
            return true;
    return false;
}

/* The integrator, and the gradient where there are several. */
static char *name_of(const row rows[], size_t count, const row *r) {
    bool several = several_gradients(rows, count);
    return text_print("%s%s%s%s", r->integrator, several ? " with the " : "",
                      several ? r->gradient : "", several ? " gradient" : "");
}

/* The bounded row that a drifting one is to be compared with: symplectic, in
   the same group. */
static const row *bounded_beside(const row rows[], size_t count,
                                 const row *drifting) {
    for (size_t i = 0; i < count; i++)
        if (rows[i].group == drifting->group &&
            verdict_is(&rows[i], NEVH_BOUNDED) &&
            nevh_integrator_symplectic(rows[i].scheme) == NEVH_YES)
            return &rows[i];
    return NULL;
}

/* The step or the tolerance of a row, in words. */
static char *step_of(const plan *p, const row *r) {
    return r->tolerance > 0 ? text_print("tolerance = %.4g", r->tolerance)
                            : text_print("dt = %.4g%s", r->dt, p->unit);
}

char *verdict_subject(const plan *p, const row rows[], size_t count,
                      const row *r) {
    return text_print("%s at %s", name_of(rows, count, r), step_of(p, r));
}

/* When the drifting error passes, or would pass, the bounded one. */
static void crossing_words(const plan *p, const row *r, const row *b,
                           const char *text, list *words) {
    static const double long_after = 1e4; /* runs: of no practical meaning */
    static const double straight =
        0.999; /* R^2: the line tells of first steps */
    double span = r->t_end - p->run->t_start;
    double passes = b ? b->energy.max / fabs(r->energy.drift) : 0;
    double t = p->run->t_start + passes;
    if (!b)
        list_print(words, "%s.", text);
    else if (passes < fabs(r->step) && r->energy.straightness < straight)
        list_print(words, "%s; at the end it is far above %s's %.1e.", text,
                   b->integrator, b->energy.max);
    else if (passes < fabs(r->step))
        list_print(words, "%s; it is above %s's %.1e from the first step on.",
                   text, b->integrator, b->energy.max);
    else if (passes < span)
        list_print(words, "%s; it passed %s's %.1e near t = %.4g%s.", text,
                   b->integrator, b->energy.max, t, p->unit);
    else if (passes < long_after * span)
        list_print(words,
                   "%s; still below %s's %.1e, which it would pass near t = "
                   "%.4g%s.",
                   text, b->integrator, b->energy.max, t, p->unit);
    else
        list_print(words, "%s; that is far below %s's %.1e.", text,
                   b->integrator, b->energy.max);
}

/* True if the line accounts for most of the error; else the loss was made at once. */
static bool has_line(const nevh_energy_report *e) {
    static const double some = 0.5; /* R^2 */
    return fabs(e->drift) > 4 * e->drift_error && e->straightness > some &&
           (fabs(e->drift) * e->span > e->max / 2 || e->least < e->max / 3);
}

/* "loses energy steadily", of a line that errors follow. */
static char *drift_of(const nevh_energy_report *e) {
    static const double straight = 0.9; /* R^2 */
    return text_print("%s energy%s", e->drift < 0 ? "loses" : "gains",
                      e->straightness > straight ? " steadily" : " unevenly");
}

static char *slope_of(const plan *p, const nevh_energy_report *e) {
    return text_print("slope (%.3g +- %.1g)%s, R^2 = %.4f", e->drift,
                      e->drift_error, p->per_unit, e->straightness);
}

double verdict_drift(const plan *p, const row *r) {
    double drift = r->energy.drift * (r->t_end - p->run->t_start);
    return copysign(fmin(fabs(drift), r->energy.max), drift);
}

static void line_words(const plan *p, const row rows[], size_t count,
                       const row *r, const char *subject, list *words) {
    const nevh_energy_report *e = &r->energy;
    char *drifts = drift_of(e), *slope = slope_of(p, e);
    char *text =
        text_print("%s %s%s, %.2g %% of the scale over the run (%s)", subject,
                   drifts, p->balance ? " against the balance" : "",
                   100 * fabs(verdict_drift(p, r)), slope);
    crossing_words(p, r, bounded_beside(rows, count, r), text, words);
}

static void later_line_words(const plan *p, const row *r, const char *subject,
                             list *words) {
    char *until = verdict_until(p, r);
    list_print(words,
               "%s has an energy error of at most %.1e in the run; continued "
               "until t = %s it %s%s (%s).",
               subject, r->energy.max, until, drift_of(&r->longer),
               p->balance ? " against the balance" : "",
               slope_of(p, &r->longer));
}

/* True if one jump accounts for the change, and no line does as well: of a line it
   accounts for 0.75. */
static bool has_jump(const nevh_energy_report *e) {
    static const double most = 0.9;
    return e->jump > most && e->jump > e->straightness;
}

static void jump_words(const plan *p, const row *r, const char *subject,
                       list *words) {
    list_print(words,
               "%s %s energy at once%s, near t = %.4g%s: the error is level "
               "before and after, %.2g %% of the scale at the end of the run.",
               subject, r->energy.final < 0 ? "loses" : "gains",
               p->balance ? " against the balance" : "", r->energy.jump_t,
               p->unit, 100 * fabs(r->energy.final));
}

static void drift_words(const plan *p, const row rows[], size_t count,
                        const row *r, list *words) {
    char *subject = verdict_subject(p, rows, count, r);
    if (has_jump(&r->energy))
        jump_words(p, r, subject, words);
    else if (has_line(&r->energy))
        line_words(p, rows, count, r, subject, words);
    else if (r->followed > 0 && has_line(&r->longer))
        later_line_words(p, r, subject, words);
    else
        list_print(
            words,
            "%s %s energy for good%s, %.2g %% of the scale by the end of "
            "the run.",
            subject, r->energy.final < 0 ? "loses" : "gains",
            p->balance ? " against the balance" : "",
            100 * fabs(r->energy.final));
}

/* Errors that do not grow, or that rounding hides, but are no small part of the
   energy. */
static void large_error_words(const plan *p, const row rows[], size_t count,
                              list *words) {
    for (size_t i = 0; i < count; i++) {
        const row *r = &rows[i];
        bool rounded = r->energy.max <= r->energy.rounding;
        bool hidden = rounded && verdict_is(r, NEVH_UNDECIDED) &&
                      r->energy.scale >= DBL_MIN;
        if (!(verdict_is(r, NEVH_BOUNDED) || hidden) || !(r->energy.max > 1))
            continue;
        list_print(words,
                   rounded ? "%s at %s: the error, up to %.2g times the energy "
                             "scale, is rounding: far larger energies cancel "
                             "in H, and a shorter step does not reduce it."
                           : "%s at %s: the error is bounded but large, up to "
                             "%.2g times the energy scale: take a shorter "
                             "step.",
                   name_of(rows, count, r), step_of(p, r), r->energy.max);
    }
}

/* The time until which the errors of all bounded rows were level. */
static double level_until(const plan *p, const row rows[], size_t count) {
    double least = INFINITY, start = p->run->t_start;
    for (size_t i = 0; i < count; i++) {
        const row *r = &rows[i];
        bool beyond = r->followed > 0 && r->longer.max > r->longer.limit;
        double lengths = beyond || verdict_leaves(r) ? 1 : fmax(1, r->followed);
        if (verdict_is(r, NEVH_BOUNDED))
            least = fmin(least, lengths * (r->t_end - start));
    }
    return start + least;
}

static void bounded_words(const plan *p, const row rows[], size_t count,
                          list *words) {
    double until = level_until(p, rows, count);
    char *also =
        until > p->t_end && isfinite(until)
            ? text_print(", and up to t = %.4g%s at least, to which it "
                         "was continued",
                         until, p->unit)
            : text_print("%s", "");
    char *one = text_print("keeps the energy bounded: its error is level over "
                           "the run%s.",
                           also);
    char *many = text_print("keep the energy bounded: their errors are level "
                            "over the run%s.",
                            also);
    common_words(rows, count, NEVH_BOUNDED, one, many, words);
}

/* Names, for an integrator with several verdicts, the steps that have that one. */
static void partial_words(const row rows[], size_t count,
                          const char *integrator, nevh_verdict verdict,
                          list *words) {
    static const char *const text[] = {
        [NEVH_BOUNDED] = "keeps the energy bounded",
        [NEVH_RANDOM_WALK] = "shows a random walk of the energy",
        [NEVH_UNSTABLE] = "is unstable"};
    list places = {0};
    for (size_t k = 0; k < count; k++) {
        if (strcmp(rows[k].integrator, integrator) != 0 ||
            !verdict_is(&rows[k], verdict))
            continue;
        char *place = place_of(rows, count, &rows[k]);
        if (!list_has(&places, place))
            list_add(&places, place);
    }
    if (places.count)
        list_print(words, "%s %s at %s.", integrator, text[verdict],
                   list_joined(&places));
}

/* Row i, where it is the first of its integrator, whose rows differ. */
static void mixed_words(const row rows[], size_t count, size_t i, list *words) {
    static const nevh_verdict kind[] = {NEVH_BOUNDED, NEVH_RANDOM_WALK,
                                        NEVH_UNSTABLE};
    bool first = true;
    for (size_t k = 0; k < i; k++)
        first &= strcmp(rows[k].integrator, rows[i].integrator) != 0;
    for (size_t v = 0; first && v < sizeof kind / sizeof *kind; v++)
        if (!always(rows, count, i, kind[v]))
            partial_words(rows, count, rows[i].integrator, kind[v], words);
}

/* The row of the same scheme with the next longer dt. */
static const row *longer(const row rows[], const row *r) {
    for (const row *k = r; k-- > rows;)
        if (strcmp(k->integrator, r->integrator) == 0 &&
            strcmp(k->gradient, r->gradient) == 0)
            return k->ran && r->ran && k->tolerance == 0 && r->tolerance == 0 &&
                           k->dt > r->dt
                       ? k
                       : NULL;
    return NULL;
}

/* True if an earlier row, with another gradient, stands for this one. */
static bool is_repeated(const row rows[], const row *r) {
    for (const row *k = rows; k < r; k++)
        if (same_place(k, r))
            return true;
    return false;
}

static void warn_of_changes(const row rows[], size_t count, list *words) {
    char *text = NULL;
    for (size_t i = 0; i < count; i++) {
        const row *b = &rows[i], *a = longer(rows, b);
        if (!a || a->energy.verdict == b->energy.verdict)
            continue;
        bool own = differs(rows, count, a) || differs(rows, count, b);
        if (!own && is_repeated(rows, b))
            continue;
        text_extend(&text, "%s of %s%s%s: %s at dt = %.4g, %s at %.4g",
                    text ? ";" : "", b->integrator, own ? " with " : "",
                    own ? b->gradient : "",
                    nevh_verdict_name(a->energy.verdict), a->dt,
                    nevh_verdict_name(b->energy.verdict), b->dt);
    }
    if (text)
        list_print(words,
                   "Warning: a smaller dt changes the verdict%s.  Trust a "
                   "verdict that a still smaller dt confirms.",
                   text);
}

void verdict_words(const plan *p, const row rows[], size_t count, list *words) {
    bounded_words(p, rows, count, words);
    common_words(rows, count, NEVH_RANDOM_WALK,
                 "shows a random walk of the energy: its error grows, but not "
                 "linearly.",
                 "show a random walk of the energy: their errors grow, but not "
                 "linearly.",
                 words);
    for (size_t i = 0; i < count; i++)
        if (verdict_is(&rows[i], NEVH_DRIFTS))
            drift_words(p, rows, count, &rows[i], words);
    common_words(
        rows, count, NEVH_UNSTABLE,
        "is unstable: its energy error has grown past every energy the "
        "system started with.",
        "are unstable: their energy errors have grown past every energy "
        "the system started with.",
        words);
    for (size_t i = 0; i < count; i++)
        if (is_later(&rows[i]))
            verdict_later_words(p, rows, count, &rows[i], words);
    for (size_t i = 0; i < count; i++)
        mixed_words(rows, count, i, words);
    large_error_words(p, rows, count, words);
    verdict_larger_words(p, rows, count, words);
    for (size_t i = 0; i < count; i++)
        if (verdict_is(&rows[i], NEVH_UNDECIDED))
            verdict_open_words(p, rows, count, &rows[i], words);
    verdict_followed_words(p, rows, count, words);
    state_words(p, rows, count, words);
    warn_of_changes(rows, count, words);
}

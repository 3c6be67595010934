/* nevh compare: what runs that are continued say of rows.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "verdict_private.h"
#include <float.h>
#include <math.h>
#include <string.h>

/* The end of the run that a row's verdict is from. */
char *verdict_until(const plan *p, const row *r) {
    double start = p->run->t_start;
    return text_print("%.6g%s", start + r->followed * (r->t_end - start),
                      p->unit);
}

/* The outcome of a calm run when it is continued. */
void verdict_later_words(const plan *p, const row rows[], size_t count,
                         const row *r, list *words) {
    char *until = verdict_until(p, r);
    list_print(words,
               "%s: the energy error is at most %.1e in the run, but "
               "grows past every energy the system started with when the run "
               "is continued until t = %s.",
               verdict_subject(p, rows, count, r), r->energy.max, until);
}

/* Two digits upwards. */
static double rounded_up(double x) {
    double unit = pow(10, floor(log10(x)) - 1);
    return ceil(x / unit) * unit;
}

/* Why even a longer run leaves a row open, and what may decide it. */
static void open_run_words(const plan *p, const row *r, const char *subject,
                           list *words) {
    double start = p->run->t_start, span = r->t_end - start;
    double seen = r->followed > 0 ? r->followed : 1;
    double decides = rounded_up(start + 4 * seen * span);
    char *until = verdict_until(p, r);
    if (r->followed > 0 && r->longer.max > 2 * r->energy.max)
        list_print(words,
                   "%s: the energy error is at most %.1e in the run and %.1e "
                   "when it is continued until t = %s; a run until t = %g%s "
                   "may show whether it keeps growing.",
                   subject, r->energy.max, r->longer.max, until, decides,
                   p->unit);
    else
        list_print(
            words,
            "%s: the run is too short for a verdict on the energy%s%s; a "
            "run until t = %g%s may decide.",
            subject, r->followed > 0 ? ", also when continued until t = " : "",
            r->followed > 0 ? until : "", decides, p->unit);
}

/* The error grows because the motion does. */
static bool is_carried(const row *r, const nevh_energy_report *e) {
    static const double more = 4;
    bool loses = e->theory == NEVH_THEORY_LOSES && e->max > e->limit;
    return (e->theory == NEVH_THEORY_OPEN || loses) && e->relative[1] <= 1 &&
           (e->grown > more || e->met > more * r->energy.met);
}

static bool is_hidden(const nevh_energy_report *e) {
    return e->theory == NEVH_THEORY_LOSES && e->max <= e->rounding;
}

/* A row that even a longer run leaves open. */
void verdict_open_words(const plan *p, const row rows[], size_t count,
                        const row *r, list *words) {
    const nevh_energy_report *e = r->followed > 0 ? &r->longer : &r->energy;
    char *subject = verdict_subject(p, rows, count, r);
    char *until = r->followed > 0 ? verdict_until(p, r) : NULL;
    if (e->scale < DBL_MIN)
        list_print(words,
                   "%s: H is about %.1g, and its terms underflow: take units "
                   "in which it is larger.",
                   subject, e->scale);
    else if (nevh_energy_passes_over(e))
        list_print(words,
                   "%s: H changes within a step, and the energy error, up to "
                   "%.1e, is that of steps which pass over the change, not "
                   "of the scheme; take a shorter step.",
                   subject, r->energy.max);
    else if (nevh_energy_stays(&r->energy) && nevh_energy_stays(e))
        list_print(words,
                   "%s: the energy error, up to %.1e, does not change in the "
                   "last fifth of the run, where the motion has left the "
                   "place that made it: whether a second passage adds to it "
                   "is not known; take a shorter step.",
                   subject, r->energy.max);
    else if (is_carried(r, e))
        list_print(
            words,
            "%s: the energies of the motion grow%s%s, and the error with "
            "them: relative to them it is at most %.1e.",
            subject, until ? " until t = " : "", until ? until : "",
            fmax(e->relative[0], e->relative[1]));
    else if (r->followed > 0 && e->max > e->limit)
        verdict_later_words(p, rows, count, r, words);
    else if (isfinite(r->stopped))
        list_print(words,
                   "%s: it stopped at t = %.4g%s, too early for a verdict on "
                   "the energy.",
                   subject, r->stopped, p->unit);
    else if (is_hidden(&r->energy) && e->max == 0)
        list_print(words,
                   "%s: the energy error is 0 throughout, as that of any "
                   "scheme at rest or in free flight.",
                   subject);
    else if (is_hidden(&r->energy))
        list_print(
            words,
            "%s: the error is that of rounding%s; a drift that %s adds "
            "with each step, if this motion has one, is hidden below it.",
            subject,
            strcmp(r->gradient, "exact") == 0 ? "" : " in the gradient",
            r->integrator);
    else
        open_run_words(p, r, subject, words);
}

/* To a motion of far larger energies, in the longer run. */
bool verdict_leaves(const row *r) {
    static const double larger = 4;
    return r->followed > 0 && r->longer.met > larger * r->energy.met &&
           r->longer.theory != NEVH_THEORY_OPEN;
}

/* Level errors of a run that are larger when it is continued. */
void verdict_larger_words(const plan *p, const row rows[], size_t count,
                          list *words) {
    static const double larger = 3;
    for (size_t i = 0; i < count; i++) {
        const row *r = &rows[i];
        if (!verdict_is(r, NEVH_BOUNDED) || r->followed <= 0 ||
            !(r->longer.max > larger * r->energy.max) ||
            r->longer.max <= r->longer.rounding)
            continue;
        bool leaves = verdict_leaves(r);
        bool level = r->longer.last_fifth <= 2 * r->longer.first_fifth;
        bool above = r->longer.max > r->longer.limit;
        if (above && (leaves || !level)) {
            verdict_later_words(p, rows, count, r, words);
            continue;
        }
        char *until = verdict_until(p, r);
        list_print(words,
                   "%s: the energy error is at most %.1e in the run, and "
                   "%.1e when it is continued until t = %s%s.",
                   verdict_subject(p, rows, count, r), r->energy.max,
                   r->longer.max, until,
                   leaves ? ", where its energies are far larger"
                   : above
                       ? ", above all energies of the motion, and level since"
                   : level ? ", level since"
                           : "");
    }
}

/* True if the errors are level in the run and no longer where it is continued: the
   verdict is then that of the run. */
static bool is_of_run(const row *r) {
    bool beyond =
        r->longer.max > r->longer.limit && r->energy.max <= r->energy.limit;
    return verdict_is(r, NEVH_BOUNDED) && (beyond || verdict_leaves(r));
}

/* Which verdicts are not from the run alone. */
void verdict_followed_words(const plan *p, const row rows[], size_t count,
                            list *words) {
    list names = {0};
    double most = 0;
    for (size_t i = 0; i < count; i++) {
        const row *r = &rows[i];
        bool clear = r->energy.max > r->energy.limit;
        if (r->followed <= 0 || !r->open || verdict_is(r, NEVH_UNDECIDED) ||
            is_of_run(r) || (clear && verdict_is(r, NEVH_UNSTABLE)))
            continue;
        most = fmax(most, rows[i].followed);
        if (!list_has(&names, rows[i].integrator))
            list_add(&names, rows[i].integrator);
    }
    char *joined = list_joined(&names);
    double start = p->run->t_start, span = p->t_end - start;
    if (names.count)
        list_print(
            words,
            "%.6g%s is too short to judge %s: %s from runs to t = %.6g%s "
            "at most, which the table does not show.",
            span, p->unit, joined,
            names.count == 1 ? "its verdict is" : "their verdicts are",
            start + most * span, p->unit);
}

/* nevh compare: the table in words.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/row.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is(const row *r, nevh_verdict verdict) {
    return r->ran && r->energy.verdict == verdict;
}

/* Whether all rows of that integrator have the verdict, and this is the first
   of them. */
static bool always(const row rows[], size_t count, size_t i,
                   nevh_verdict verdict) {
    for (size_t k = 0; k < count; k++)
        if (strcmp(rows[k].integrator, rows[i].integrator) == 0 &&
            (!is(&rows[k], verdict) || k < i))
            return false;
    return true;
}

static void tell_all(const row rows[], size_t count, nevh_verdict verdict,
                     const char *one, const char *many, list *words) {
    list names = {0};
    for (size_t i = 0; i < count; i++)
        if (always(rows, count, i, verdict))
            list_add(&names, rows[i].integrator);
    char *text = list_joined(&names);
    if (names.count)
        list_print(words, "%s %s", text, names.count == 1 ? one : many);
    list_free(&names);
    free(text);
}

static bool same_place(const row *a, const row *b) {
    return strcmp(a->integrator, b->integrator) == 0 &&
           a->tolerance == b->tolerance && (a->tolerance > 0 || a->dt == b->dt);
}

/* Whether gradients make different verdicts there. */
static bool differs(const row rows[], size_t count, const row *r) {
    for (size_t k = 0; k < count; k++)
        if (same_place(&rows[k], r) && !is(&rows[k], r->energy.verdict))
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
        if (rows[i].group == drifting->group && is(&rows[i], NEVH_BOUNDED) &&
            nevh_integrator_symplectic(rows[i].scheme) == NEVH_YES)
            return &rows[i];
    return NULL;
}

/* Numbers of a row that its longer run knows better. */
static const nevh_energy_report *known(const row *r) {
    return r->followed > 0 ? &r->longer : &r->energy;
}

static char *unit_of(const plan *p, const char *before) {
    const char *unit = nevh_scene_label(p->scene, "t");
    return text_print("%s%s", *unit ? before : "", unit);
}

/* What the row was asked for: a step, or a tolerance. */
static char *step_of(const plan *p, const row *r) {
    char *unit = unit_of(p, " ");
    char *text = r->tolerance > 0 ? text_print("tolerance = %.4g", r->tolerance)
                                  : text_print("dt = %.4g%s", r->dt, unit);
    free(unit);
    return text;
}

/* When the drifting error passes, or would pass, the bounded one. */
static void tell_crossing(const plan *p, const row *r, const row *b,
                          const char *text, list *words) {
    static const double long_after = 1e4; /* runs: of no practical meaning */
    static const double straight =
        0.999; /* R^2: the line tells of first steps */
    double span = r->t_end - p->run->t_start;
    double passes = b ? b->energy.max / fabs(known(r)->drift) : 0;
    double t = p->run->t_start + passes;
    char *unit = unit_of(p, " ");
    if (!b)
        list_print(words, "%s.", text);
    else if (passes < fabs(r->step) && known(r)->straightness < straight)
        list_print(words, "%s; at the end it is far above %s's %.1e.", text,
                   b->integrator, b->energy.max);
    else if (passes < fabs(r->step))
        list_print(words, "%s; it is above %s's %.1e from the first step on.",
                   text, b->integrator, b->energy.max);
    else if (passes < span)
        list_print(words, "%s; it passed %s's %.1e near t = %.4g%s.", text,
                   b->integrator, b->energy.max, t, unit);
    else if (passes < long_after * span)
        list_print(words,
                   "%s; still below %s's %.1e, which it would pass near t = "
                   "%.4g%s.",
                   text, b->integrator, b->energy.max, t, unit);
    else
        list_print(words, "%s; that is far below %s's %.1e.", text,
                   b->integrator, b->energy.max);
    free(unit);
}

/* Whether the line is most of the error; else the loss was made at once. */
static bool is_steady(const nevh_energy_report *e) {
    return fabs(e->drift) > 4 * e->drift_error &&
           (fabs(e->drift) * e->span > e->max / 2 || e->least < e->max / 3);
}

static void tell_drift(const plan *p, const row rows[], size_t count,
                       const row *r, list *words) {
    const nevh_energy_report *e = known(r);
    const char *against = p->balance ? " against the balance" : "";
    char *name = name_of(rows, count, r), *unit = unit_of(p, " ");
    char *per = unit_of(p, "/"), *place = step_of(p, r), *text = NULL;
    double span = r->t_end - p->run->t_start;
    if (is_steady(e)) {
        text = text_print("%s at %s %s energy steadily%s, %.2g %% of "
                          "the scale over the run (slope (%.3g +- %.1g)%s, "
                          "R^2 = %.4f)",
                          name, place, e->drift < 0 ? "loses" : "gains",
                          against, 100 * fabs(e->drift) * span, e->drift,
                          e->drift_error, per, e->straightness);
        tell_crossing(p, r, bounded_beside(rows, count, r), text, words);
    } else
        list_print(words,
                   "%s at %s %s energy for good%s, %.2g %% of the "
                   "scale by the end of the run.",
                   name, place, r->energy.final < 0 ? "loses" : "gains",
                   against, 100 * fabs(r->energy.final));
    free(name);
    free(unit);
    free(per);
    free(place);
    free(text);
}

/* Two digits upwards. */
static double rounded_up(double x) {
    double unit = pow(10, floor(log10(x)) - 1);
    return ceil(x / unit) * unit;
}

/* A row that even a longer run leaves open. */
static void tell_open(const plan *p, const row rows[], size_t count,
                      const row *r, list *words) {
    double start = p->run->t_start, span = r->t_end - start;
    double seen = r->followed > 0 ? r->followed : 1;
    char *name = name_of(rows, count, r), *unit = unit_of(p, " ");
    char *place = step_of(p, r);
    char *further = r->followed > 0
                        ? text_print(", also when continued until t = %.4g%s",
                                     start + seen * span, unit)
                        : text_print("%s", "");
    if (r->followed > 0 && r->longer.max > r->longer.limit)
        list_print(words,
                   "%s at %s: the energy error is at most %.1e in the run, but "
                   "exceeds all energies when the run is continued until t = "
                   "%.4g%s: such steps fail in an encounter there, or are "
                   "unstable in the long run.",
                   name, place, r->energy.max, start + seen * span, unit);
    else if (isfinite(r->stopped))
        list_print(words,
                   "%s at %s: it stopped at t = %.4g%s, too early for a "
                   "verdict on the energy.",
                   name, place, r->stopped, unit);
    else
        list_print(words,
                   "%s at %s: the run is too short for a verdict on the "
                   "energy%s; a run until t = %g%s may decide.",
                   name, place, further, rounded_up(start + 4 * seen * span),
                   unit);
    free(name);
    free(unit);
    free(place);
    free(further);
}

/* Errors that do not grow, but are no small part of the energy. */
static void tell_large(const plan *p, const row rows[], size_t count,
                       list *words) {
    for (size_t i = 0; i < count; i++) {
        const row *r = &rows[i];
        if (!is(r, NEVH_BOUNDED) || !(r->energy.max > 1))
            continue;
        char *name = name_of(rows, count, r), *place = step_of(p, r);
        bool rounded = r->energy.max <= r->energy.rounding;
        list_print(words,
                   rounded ? "%s at %s: the error, up to %.2g times the energy "
                             "scale, is rounding: far larger energies cancel "
                             "in H, and a shorter step does not reduce it."
                           : "%s at %s: the error is bounded but large, up to "
                             "%.2g times the energy scale: take a shorter "
                             "step.",
                   name, place, r->energy.max);
        free(name);
        free(place);
    }
}

/* Which verdicts are not from the run alone. */
static void tell_followed(const plan *p, const row rows[], size_t count,
                          list *words) {
    list names = {0};
    double most = 0;
    for (size_t i = 0; i < count; i++) {
        if (rows[i].followed <= 0 || is(&rows[i], NEVH_UNDECIDED))
            continue;
        most = fmax(most, rows[i].followed);
        if (!list_has(&names, rows[i].integrator))
            list_add(&names, rows[i].integrator);
    }
    char *joined = list_joined(&names), *unit = unit_of(p, " ");
    double start = p->run->t_start;
    if (names.count)
        list_print(words,
                   "The run is short for a verdict on %s: continued at most "
                   "until t = %.4g%s.",
                   joined, start + most * (p->t_end - start), unit);
    free(joined);
    free(unit);
    list_free(&names);
}

/* Of an integrator with several verdicts, where it has that one. */
static void tell_some(const row rows[], size_t count, const char *integrator,
                      nevh_verdict verdict, list *words) {
    static const char *const text[] = {
        [NEVH_BOUNDED] = "keeps the energy bounded",
        [NEVH_RANDOM_WALK] = "shows a random walk of the energy",
        [NEVH_UNSTABLE] = "is unstable"};
    list places = {0};
    for (size_t k = 0; k < count; k++) {
        if (strcmp(rows[k].integrator, integrator) != 0 ||
            !is(&rows[k], verdict))
            continue;
        char *place = place_of(rows, count, &rows[k]);
        if (!list_has(&places, place))
            list_add(&places, place);
        free(place);
    }
    char *joined = list_joined(&places);
    if (places.count)
        list_print(words, "%s %s at %s.", integrator, text[verdict], joined);
    list_free(&places);
    free(joined);
}

/* Row i, where it is the first of its integrator, whose rows differ. */
static void tell_mixed(const row rows[], size_t count, size_t i, list *words) {
    static const nevh_verdict told[] = {NEVH_BOUNDED, NEVH_RANDOM_WALK,
                                        NEVH_UNSTABLE};
    bool first = true;
    for (size_t k = 0; k < i; k++)
        first &= strcmp(rows[k].integrator, rows[i].integrator) != 0;
    for (size_t v = 0; first && v < sizeof told / sizeof *told; v++)
        if (!always(rows, count, i, told[v]))
            tell_some(rows, count, rows[i].integrator, told[v], words);
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

/* Whether the same was said of a gradient before. */
static bool is_told(const row rows[], const row *r) {
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
        if (!own && is_told(rows, b))
            continue;
        char *more = text_print("%s of %s%s%s: %s at dt = %.4g, %s at %.4g",
                                text ? text : "", b->integrator,
                                own ? " with " : "", own ? b->gradient : "",
                                nevh_verdict_name(a->energy.verdict), a->dt,
                                nevh_verdict_name(b->energy.verdict), b->dt);
        free(text);
        text = text_print("%s;", more);
        free(more);
    }
    if (text)
        list_print(words,
                   "Warning: a smaller dt changes the verdict%.*s.  Trust a "
                   "verdict that a still smaller dt confirms.",
                   (int)strlen(text) - 1, text);
    free(text);
}

void verdict_words(const plan *p, const row rows[], size_t count, list *words) {
    tell_all(rows, count, NEVH_BOUNDED,
             "keeps the energy bounded: its error does not grow with time.",
             "keep the energy bounded: their errors do not grow with time.",
             words);
    tell_all(rows, count, NEVH_RANDOM_WALK,
             "shows a random walk of the energy: its error grows, but not "
             "linearly.",
             "show a random walk of the energy: their errors grow, but not "
             "linearly.",
             words);
    for (size_t i = 0; i < count; i++)
        if (is(&rows[i], NEVH_DRIFTS))
            tell_drift(p, rows, count, &rows[i], words);
    tell_all(rows, count, NEVH_UNSTABLE,
             "is unstable: its error exceeds all energies at the start.",
             "are unstable: their errors exceed all energies at the start.",
             words);
    for (size_t i = 0; i < count; i++)
        tell_mixed(rows, count, i, words);
    tell_large(p, rows, count, words);
    for (size_t i = 0; i < count; i++)
        if (is(&rows[i], NEVH_UNDECIDED))
            tell_open(p, rows, count, &rows[i], words);
    tell_followed(p, rows, count, words);
    state_words(p, rows, count, words);
    warn_of_changes(rows, count, words);
}

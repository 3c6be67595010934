/* nevh compare: the table in words.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
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
    return text_print("%s = %.4g%s%s", adapts ? "tolerance" : "dt",
                      adapts ? r->tolerance : r->dt, differ ? " with " : "",
                      differ ? r->gradient : "");
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
    return text_print("%s%s%s", r->integrator, several ? " with " : "",
                      several ? r->gradient : "");
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

/* When the drifting error passes, or would pass, the bounded one. */
static void tell_crossing(const plan *p, const row *r, const row *b,
                          const char *text, list *words) {
    static const double long_after = 1e4; /* runs: of no practical meaning */
    double span = r->t_end - p->run->t_start;
    double passes = b ? b->energy.max / fabs(r->energy.drift) : 0;
    double t = p->run->t_start + passes;
    if (!b)
        list_print(words, "%s.", text);
    else if (passes < span)
        list_print(words, "%s; it passed %s's %.1e near t = %.4g.", text,
                   b->integrator, b->energy.max, t);
    else if (passes < long_after * span)
        list_print(words,
                   "%s; still below %s's %.1e, which it would pass near t = "
                   "%.4g.",
                   text, b->integrator, b->energy.max, t);
    else
        list_print(words, "%s; that is far below %s's %.1e.", text,
                   b->integrator, b->energy.max);
}

static void tell_drift(const plan *p, const row rows[], size_t count,
                       const row *r, list *words) {
    const row *b = bounded_beside(rows, count, r);
    char *name = name_of(rows, count, r);
    double span = r->t_end - p->run->t_start;
    char *text =
        text_print("%s at dt = %.4g %s energy steadily%s, %.2g %% of the "
                   "scale over the run (slope %.3g +- %.1g, R^2 = %.4f)",
                   name, r->dt, r->energy.drift < 0 ? "loses" : "gains",
                   p->balance ? " against the balance" : "",
                   100 * fabs(r->energy.drift) * span, r->energy.drift,
                   r->energy.drift_error, r->energy.straightness);
    tell_crossing(p, r, b, text, words);
    free(name);
    free(text);
}

/* Of an integrator with several verdicts, where it has that one. */
static void tell_some(const row rows[], size_t count, const char *integrator,
                      nevh_verdict verdict, list *words) {
    static const char *const text[] = {
        [NEVH_BOUNDED] = "keeps the energy bounded",
        [NEVH_RANDOM_WALK] = "lets the energy wander",
        [NEVH_UNSTABLE] = "is unstable",
        [NEVH_UNDECIDED] = "cannot be told yet"};
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
                                        NEVH_UNSTABLE, NEVH_UNDECIDED};
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
                   "Warning: a smaller dt changes the verdict%.*s.  Trust it "
                   "when yet another does not.",
                   (int)strlen(text) - 1, text);
    free(text);
}

void verdict_words(const plan *p, const row rows[], size_t count, list *words) {
    tell_all(rows, count, NEVH_BOUNDED,
             "keeps the energy bounded: its error is no larger at the end of "
             "the run than at the beginning.",
             "keep the energy bounded: their errors are no larger at the end "
             "of the run than at the beginning.",
             words);
    tell_all(rows, count, NEVH_RANDOM_WALK,
             "lets the energy wander: the error grows, but not along a line.",
             "let the energy wander: their errors grow, but not along a line.",
             words);
    for (size_t i = 0; i < count; i++)
        if (is(&rows[i], NEVH_DRIFTS))
            tell_drift(p, rows, count, &rows[i], words);
    tell_all(rows, count, NEVH_UNSTABLE,
             "is unstable: its error exceeds the energy itself.",
             "are unstable: their errors exceed the energy itself.", words);
    tell_all(rows, count, NEVH_UNDECIDED,
             "cannot be told yet: the run is too short to say what becomes of "
             "its energy.",
             "cannot be told yet: the run is too short to say what becomes of "
             "their energies.",
             words);
    for (size_t i = 0; i < count; i++)
        tell_mixed(rows, count, i, words);
    state_words(p, rows, count, words);
    warn_of_changes(rows, count, words);
}

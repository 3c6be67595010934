/* nevh compare --diagnostics: what steps of a scheme keep instead of H.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>
#include <stdlib.h>

nevh_shadow *row_shadow(const plan *p, const row *r) {
    nevh_options o = plan_options(p, r->gradient);
    if (!p->diagnostics || r->tolerance > 0)
        return NULL;
    o.transform = plan_transform(p, r->integrator);
    nevh_shadow *s = nevh_shadow_new(p->system, r->scheme, r->step, &o);
    tool_owned(nevh_shadow_status(s) == NEVH_ENOMEM ? NULL : s);
    if (!nevh_shadow_status(s))
        return s;
    nevh_shadow_free(s);
    return NULL;
}

int shadow_observe(void *shadow, size_t step, double t, const double q[],
                   const double p[]) {
    if (!nevh_shadow_status(shadow))
        nevh_shadow_observe(shadow, step, t, q, p);
    return NEVH_OK;
}

double shadow_error(const row *r) {
    return r->ran && r->shadow.samples ? r->shadow.shadow / r->energy.scale
                                       : NAN;
}

void shadow_show(table *t, const row *r) {
    if (r->ran && r->shadow.breaks_down)
        table_text(t, "breaks down");
    else
        table_error(t, shadow_error(r));
}

static bool has_shadow(const row *r) {
    return r->ran && r->shadow.samples > 1;
}

static bool is_at_rounding(const row *r) {
    return r->shadow.shadow <= r->shadow.rounding;
}

/* The row whose shadow is the flattest. */
static const row *flattest(const row rows[], size_t count, size_t first) {
    const row *best = NULL;
    for (size_t i = first; i < count; i++) {
        const nevh_shadow_report *is = &rows[i].shadow;
        if (has_shadow(&rows[i]) && rows[i].scheme == rows[first].scheme &&
            !is->breaks_down && !is_at_rounding(&rows[i]) &&
            (!best || is->energy / is->shadow >
                          best->shadow.energy / best->shadow.shadow))
            best = &rows[i];
    }
    return best;
}

/* To two digits. */
static double rounded(double ratio) {
    double unit = pow(10, fmax(0, floor(log10(ratio)) - 1));
    return unit * round(ratio / unit);
}

static void scheme_words(const row rows[], size_t count, size_t first,
                         list *words) {
    const row *best = flattest(rows, count, first);
    if (best)
        list_print(words,
                   "%s at dt = %.4g follows a shadow of H, which changes %.0f "
                   "times less than H.",
                   best->integrator, best->dt,
                   rounded(best->shadow.energy / best->shadow.shadow));
}

static void broken_words(const row rows[], size_t count, list *words) {
    list broken = {0};
    for (size_t i = 0; i < count; i++)
        if (has_shadow(&rows[i]) && rows[i].shadow.breaks_down)
            list_print(&broken, "%s at dt = %.4g", rows[i].integrator,
                       rows[i].dt);
    if (broken.count)
        list_print(words,
                   "The shadow of H breaks down for %s: such steps are too "
                   "long for its series.",
                   list_joined(&broken));
}

void shadow_words(const plan *p, const row rows[], size_t count, list *words) {
    for (size_t i = 0; p->diagnostics && i < count; i++) {
        bool known = false;
        for (size_t k = 0; k < i; k++)
            known |= has_shadow(&rows[k]) && rows[k].scheme == rows[i].scheme;
        if (!known && has_shadow(&rows[i]))
            scheme_words(rows, count, i, words);
    }
    if (p->diagnostics)
        broken_words(rows, count, words);
}

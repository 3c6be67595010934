/* nevh: a field looks around.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/step_selection_private.h"
#include "system/forest_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LARGE = 65536 };
enum { FEWEST_SAMPLES = 4 }; /* of the pilot, for scales */

size_t nevh__stride(size_t count) {
    return (count + NEVH__PROBED - 1) / NEVH__PROBED;
}

size_t nevh__probed(const nevh__planned *term, size_t k) {
    size_t first = k < term->nq ? 0 : term->nq;
    size_t stride = nevh__stride(k < term->nq ? term->nq : term->np);
    return k - (k - first) % stride;
}

size_t nevh__step_rows(const nevh__planned *term) {
    size_t count = term->term->decl.count, stride = nevh__stride(count);
    return (count + stride - 1) / stride;
}

size_t nevh__step_at(const nevh__planned *term, size_t instance, size_t k) {
    return instance / nevh__stride(term->term->decl.count) * term->nv + k;
}

double nevh__largest_size(const nevh__step_selection *e, size_t i,
                          size_t count) {
    size_t n = e->field->n;
    if (count > e->lanes)
        return e->samples.largest[(count - 1) * 2 * n + i];
    const double *x = i < n ? e->samples.q : e->samples.p;
    double most = 0;
    for (size_t at = 0; at < count; at++)
        most = fmax(most, fabs(x[at * n + i % n]));
    return most;
}

bool nevh__sizes_settled(const nevh__step_selection *e, size_t count) {
    if (count < FEWEST_SAMPLES || (count & (count - 1)) != 0)
        return false;
    for (size_t i = 0; i < 2 * e->field->n; i++) {
        double before = nevh__largest_size(e, i, e->lanes + count / 2);
        if (before < e->length[i] &&
            nevh__largest_size(e, i, e->lanes + count) > 2 * before)
            return false;
    }
    return true;
}

/* The largest sizes met on the way until they settle, or the lengths, which are
   where H varies and not where the origin is, if these are shorter. */
static void set_scales(nevh__step_selection *e) {
    nevh_field *f = e->field;
    size_t count = 0;
    while (e->lanes + count < e->neighbours && !nevh__sizes_settled(e, count))
        count++;
    for (size_t i = 0; i < 2 * f->n; i++) {
        double most = nevh__largest_size(e, i, e->lanes + count);
        f->scale[i] = most > 0 ? fmin(most, e->length[i]) : e->length[i];
    }
}

/* Adds the changes of H by one instance, up and down by the length of each
   variable. */
static void add_changes(const nevh__step_selection *e,
                        const nevh__planned *term, size_t instance,
                        double changes[]) {
    double up = 0, down = 0;
    for (size_t k = 0; k < term->nv; k++) {
        size_t i = nevh__index(term, instance, k);
        i = k < term->nq ? i : e->field->n + i;
        if (nevh__probed(term, k) == k) {
            const double move[3] = {0, e->length[i], -e->length[i]};
            double x[3], h[3];
            nevh__sample_line(&(nevh__axis){e, term, instance, k}, e->at, 3,
                              move, x, h);
            up = h[1] - h[0];
            down = h[2] - h[0];
        }
        changes[2 * i] += up;
        changes[2 * i + 1] += down;
    }
}

void nevh__find_curvatures(nevh__step_selection *e, double changes[],
                           double curvature[]) {
    const nevh_field *f = e->field;
    for (e->at = 0; e->at < e->samples.count; e->at++) {
        memset(changes, 0, 4 * f->n * sizeof *changes);
        for (size_t j = 0; j < f->n_terms; j++)
            for (size_t i = 0; i < f->terms[j].term->decl.count; i++)
                add_changes(e, &f->terms[j], i, changes);
        for (size_t i = 0; i < 2 * f->n; i++) {
            double most = fmax(fabs(changes[2 * i]), fabs(changes[2 * i + 1]));
            double curved = most / (e->length[i] * e->length[i]);
            if (isfinite(curved))
                curvature[i] = fmax(curvature[i], curved);
        }
    }
    e->at = 0;
}

int nevh__step_selection_init(nevh__step_selection *e, nevh_field *f,
                              const nevh_options *o) {
    size_t n = f->n, most = n > LARGE ? 4 : NEVH__MOST_SAMPLES;
    *e = (nevh__step_selection){.field = f, .options = o, .samples.most = most};
    e->length = nevh__array(2 * n, sizeof *e->length);
    e->samples.q = nevh__array((most + 1) * n, sizeof *e->samples.q);
    e->samples.p = nevh__array((most + 1) * n, sizeof *e->samples.p);
    e->samples.largest = nevh__array(2 * most * n, sizeof *e->samples.largest);
    e->component = nevh__components(f->system);
    if (!e->length || !e->samples.q || !e->samples.p || !e->samples.largest ||
        !e->component || !nevh__find_lengths(e))
        return nevh__no_memory(&f->report);
    return NEVH_OK;
}

void nevh__step_selection_clear(nevh__step_selection *e) {
    free(e->length);
    free(e->component);
    free(e->samples.q);
    free(e->samples.p);
    free(e->samples.largest);
}

int nevh__field_select_steps(nevh_field *f, const nevh_options *o) {
    nevh__step_selection e;
    int status = nevh__step_selection_init(&e, f, o);
    if (!status)
        nevh__set_crude_steps(&e);
    if (!status && (!nevh__central_stencil_plan(f) || !nevh__find_samples(&e)))
        status = nevh__no_memory(&f->report);
    nevh__central_stencils_clear(f); /* of crude steps */
    if (!status && !o->scale)
        set_scales(&e);
    for (size_t i = 0; !status && i < f->n_terms; i++)
        nevh__scan_steps(&e, &f->terms[i]);
    nevh__step_selection_clear(&e);
    return status;
}

int nevh__field_verify(nevh_field *f, const nevh_options *o) {
    nevh__step_selection e;
    int status = nevh__step_selection_init(&e, f, o);
    if (!status)
        nevh__find_neighbours(&e);
    for (size_t i = 0; !status && i < f->n_terms; i++)
        if (f->terms[i].nv)
            status = nevh__verify(&e, &f->terms[i]);
    if (!status && !nevh__keep_lengths(&e))
        status = nevh__no_memory(&f->report);
    nevh__step_selection_clear(&e);
    return status;
}

int nevh__field_find_scale(nevh_field *f, const nevh_options *o) {
    nevh__step_selection e;
    if (f->gradient != nevh_exact || o->scale || f->scaled)
        return NEVH_OK;
    int status = nevh__step_selection_init(&e, f, o);
    e.scales_alone = true;
    if (!status && !nevh__find_samples(&e))
        status = nevh__no_memory(&f->report);
    if (!status)
        set_scales(&e);
    f->scaled = !status;
    nevh__step_selection_clear(&e);
    return nevh__field_forget(f, status);
}

/* nevh: a field is planned once and asked many times.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/evaluation_private.h"
#include <stdlib.h>
#include <string.h>

void nevh__planned_clear(nevh__planned *x) {
    free(x->gathered);
    x->gathered = NULL;
    nevh__central_stencil_clear(x);
    nevh__scatter_map_clear(&x->to_q);
    nevh__scatter_map_clear(&x->to_p);
}

void nevh_field_free(nevh_field *f) {
    if (!f)
        return;
    nevh__joints_clear(f);
    for (size_t i = 0; f->terms && i < f->n_terms; i++) {
        free(f->terms[i].delta);
        free(f->terms[i].steps);
        free(f->terms[i].vars);
        free(f->terms[i].lane_c);
        free(f->terms[i].lane_delta);
        nevh__constants_free(f->terms[i].constants);
    }
    free(f->terms);
    free(f->pieces);
    nevh__single_free(f->single);
    free(f->scale);
    free(f->length);
    free(f->jacobian);
    free(f->chosen);
    free(f->lane_scale);
    free(f->workspace);
    free(f);
}

NEVH__REPORTS(field)

int nevh__field_ready(nevh_field *f) {
    if (!f->planned)
        return f->report.status;
    f->report.status = NEVH_OK;
    f->report.text[0] = '\0';
    if (f->system->revision == f->revision)
        return NEVH_OK;
    return nevh__fail(&f->report, NEVH_ESTALE,
                      "effects were added or switched since this was planned: "
                      "make a new stepper or field");
}

double nevh_field_step(const nevh_field *f, const char *name, size_t instance,
                       size_t i) {
    if (!f)
        return NAN;
    for (size_t j = 0; j < f->n_terms; j++) {
        const nevh__planned *term = &f->terms[j];
        if (strcmp(term->term->decl.name, name) != 0 || !term->delta ||
            instance >= term->term->decl.count)
            continue;
        for (size_t k = 0; k < term->nv; k++)
            if (nevh__index(term, instance, k) + (k < term->nq ? 0 : f->n) == i)
                return term->delta[instance * term->nv + k];
    }
    return 0;
}

nevh_counts nevh_field_counts(const nevh_field *f) {
    if (!f)
        return (nevh_counts){0};
    uint64_t inner = f->instances ? f->inner / f->instances : 0;
    nevh_counts counts = {.gradients = f->gradients + inner,
                          .instances = f->instances};
    for (size_t i = 0; i < f->n_terms; i++)
        counts.values += f->terms[i].values;
    if (f->instances)
        counts.hamiltonians = (double)counts.values / (double)f->instances;
    return counts;
}

size_t nevh_field_pieces(const nevh_field *f) {
    return f ? f->n_pieces : 0;
}

uint64_t nevh_field_effect_values(const nevh_field *f, const char *effect) {
    if (!f)
        return 0;
    uint64_t values = 0;
    for (size_t i = 0; effect && i < f->n_terms; i++)
        if (strcmp(f->terms[i].term->decl.effect, effect) == 0)
            values += f->terms[i].values;
    return values;
}

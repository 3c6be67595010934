/* nevh: a field is planned once and asked many times.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The length over which variable i varies (from n: momenta): what the user
   says, else the largest size in the state to plan at, else 1. */
static double choose_scale(const nevh_options *o, size_t n, size_t i) {
    if (o->scale)
        return o->scale[i];
    const double *x = i < n ? o->q : o->p;
    size_t width = o->width ? o->width : 1;
    double most = 0;
    for (size_t lane = 0; x && lane < width; lane++)
        most = fmax(most, fabs(x[i % n * width + lane]));
    return most > 0 && isfinite(most) ? most : 1;
}

/* The step for variable i: what the user says, else the power of two nearest
   to epsilon^(1/(order+1)) scales, where truncation meets rounding. */
static double choose_delta(const nevh_field *f, const nevh_options *o,
                           size_t i) {
    if (o->gradient_steps && o->gradient_steps[i] > 0)
        return o->gradient_steps[i];
    if (o->gradient_step > 0)
        return o->gradient_step;
    double best = pow(DBL_EPSILON, 1. / (f->gradient->order + 1)) * f->scale[i];
    return exp2(round(log2(best)));
}

static int check_options(nevh_field *f, const nevh_options *o) {
    if (!(o->gradient_step >= 0 && o->gradient_step <= DBL_MAX))
        return nevh__fail(&f->report, NEVH_EINVAL,
                          "the gradient step %g is not a positive number",
                          o->gradient_step);
    for (size_t i = 0; i < 2 * f->n; i++) {
        double step = o->gradient_steps ? o->gradient_steps[i] : 0;
        double scale = o->scale ? o->scale[i] : 1;
        if (!(step >= 0 && step <= DBL_MAX))
            return nevh__fail(&f->report, NEVH_EINVAL,
                              "gradient step %zu, %g, is not a positive number",
                              i, step);
        if (!(scale > 0 && scale <= DBL_MAX))
            return nevh__fail(&f->report, NEVH_EINVAL,
                              "scale %zu, %g, is not a positive number", i,
                              scale);
    }
    return NEVH_OK;
}

static int plan_term(nevh_field *f, const nevh__term *term,
                     const nevh_options *o) {
    const nevh_term *is = &term->is;
    nevh__planned *plan = &f->terms[f->n_terms++];
    *plan = (nevh__planned){
        .term = term, .nq = is->nq, .np = is->np, .nv = is->nq + is->np};
    f->instances += is->count;
    if (!f->gradient->offsets)
        return is->gradient || !plan->nv
                   ? NEVH_OK
                   : nevh__fail(&f->report, NEVH_ENOGRAD,
                                "term \"%s\" of effect \"%s\" has no exact "
                                "gradient: take central4, or give it one",
                                is->name, is->effect);
    plan->delta = nevh__array(is->count * plan->nv, sizeof *plan->delta);
    if (!plan->delta)
        return nevh__fail(&f->report, NEVH_ENOMEM, "out of memory");
    for (size_t at = 0; at < is->count * plan->nv; at++) {
        size_t k = at % plan->nv, i = nevh__index(plan, at / plan->nv, k);
        plan->delta[at] = choose_delta(f, o, k < plan->nq ? i : f->n + i);
    }
    return NEVH_OK;
}

static int plan_workspace(nevh_field *f) {
    size_t variables = 0, reads = 0;
    for (size_t i = 0; i < f->n_terms; i++) {
        const nevh__planned *term = &f->terms[i];
        size_t all = term->nv + term->term->is.nc;
        variables = term->nv > variables ? term->nv : variables;
        reads = all > reads ? all : reads;
    }
    size_t columns = f->capacity = NEVH__COLUMNS;
    f->rows = nevh__array(reads * columns, sizeof(double));
    f->slopes = nevh__array(variables * columns, sizeof(double));
    f->times = nevh__array(columns, sizeof(double));
    f->zeros = nevh__array(columns, sizeof(double));
    f->h = nevh__array(columns, sizeof(double));
    f->sums = nevh__array(2 * columns, sizeof(double));
    f->one = nevh__array(reads, sizeof(double));
    if (f->rows && f->slopes && f->times && f->zeros && f->h && f->sums &&
        f->one)
        return NEVH_OK;
    return nevh__fail(&f->report, NEVH_ENOMEM, "out of memory");
}

static int plan(nevh_field *f, const nevh_options *o) {
    const nevh_system *s = f->system;
    if (s->report.status)
        return nevh__fail_as(&f->report, &s->report);
    int status = check_options(f, o);
    if (!status && !(f->scale = nevh__array(2 * f->n, sizeof(double))))
        status = nevh__fail(&f->report, NEVH_ENOMEM, "out of memory");
    for (size_t i = 0; !status && i < 2 * f->n; i++)
        f->scale[i] = choose_scale(o, f->n, i);
    for (size_t i = 0; !status && i < s->n_terms; i++)
        if (nevh__term_on(s, s->terms[i]))
            status = plan_term(f, s->terms[i], o);
    return status ? status : plan_workspace(f);
}

nevh_field *nevh_field_new(const nevh_system *s, const nevh_options *options) {
    static const nevh_options defaults = {0};
    const nevh_options *o = options ? options : &defaults;
    nevh_field *f = s ? nevh__array(1, sizeof *f) : NULL;
    if (!f)
        return NULL;
    f->system = s;
    f->revision = s->revision;
    f->n = s->n;
    f->gradient = o->gradient ? o->gradient : nevh_central4;
    f->terms = nevh__array(s->n_terms, sizeof *f->terms);
    if (f->terms && plan(f, o) != NEVH_ENOMEM)
        return f;
    nevh_field_free(f);
    return NULL;
}

void nevh_field_free(nevh_field *f) {
    if (!f)
        return;
    for (size_t i = 0; i < f->n_terms; i++)
        free(f->terms[i].delta);
    free(f->terms);
    free(f->scale);
    free(f->jacobian);
    free(f->rows);
    free(f->slopes);
    free(f->times);
    free(f->zeros);
    free(f->h);
    free(f->sums);
    free(f->one);
    free(f);
}

int nevh_field_status(const nevh_field *f) {
    return f ? f->report.status : NEVH_ENOMEM;
}

const char *nevh_field_message(const nevh_field *f) {
    return f ? f->report.text : "out of memory";
}

int nevh__field_ready(nevh_field *f) {
    if (!f->one) /* could not be planned */
        return f->report.status;
    f->report.status = NEVH_OK;
    f->report.text[0] = '\0';
    if (f->system->revision == f->revision)
        return NEVH_OK;
    return nevh__fail(&f->report, NEVH_ESTALE,
                      "effects were added or switched since this was planned: "
                      "make a new stepper or field");
}

static bool reads(const nevh__planned *term, bool q, bool p) {
    return (q && term->nq) || (p && term->np);
}

int nevh_field_gradient(nevh_field *f, size_t width, const double t[],
                        const double q[], const double p[], double dh_dq[],
                        double dh_dp[]) {
    int status = nevh__field_ready(f);
    if (status)
        return status;
    for (size_t i = 0; dh_dq && i < f->n * width; i++)
        dh_dq[i] = 0;
    for (size_t i = 0; dh_dp && i < f->n * width; i++)
        dh_dp[i] = 0;
    if (dh_dq)
        f->gradients += width;
    for (size_t i = 0; !status && i < f->n_terms; i++)
        if (reads(&f->terms[i], dh_dq, dh_dp))
            status = (f->gradient->offsets ? nevh__central : nevh__exact)(
                f, &f->terms[i], width, t, q, p, dh_dq, dh_dp);
    return status;
}

double nevh_field_step(const nevh_field *f, const char *name, size_t instance,
                       size_t i) {
    for (size_t j = 0; j < f->n_terms; j++) {
        const nevh__planned *term = &f->terms[j];
        if (strcmp(term->term->is.name, name) != 0 || !term->delta ||
            instance >= term->term->is.count)
            continue;
        for (size_t k = 0; k < term->nv; k++)
            if (nevh__index(term, instance, k) + (k < term->nq ? 0 : f->n) == i)
                return term->delta[instance * term->nv + k];
    }
    return 0;
}

nevh_counts nevh_field_counts(const nevh_field *f) {
    nevh_counts counts = {.gradients = f->gradients};
    for (size_t i = 0; i < f->n_terms; i++)
        counts.values += f->terms[i].values;
    if (f->instances)
        counts.hamiltonians = (double)counts.values / (double)f->instances;
    return counts;
}

uint64_t nevh_field_effect_values(const nevh_field *f, const char *effect) {
    uint64_t values = 0;
    for (size_t i = 0; effect && i < f->n_terms; i++)
        if (strcmp(f->terms[i].term->is.effect, effect) == 0)
            values += f->terms[i].values;
    return values;
}

/* nevh: a field is planned.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/block_private.h"
#include "gradient/step_selection_private.h"
#include "gradient/evaluation_private.h"
#include <fenv.h>
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

/* The step that the user gives for variable i, or 0. */
static double given_step(const nevh_options *o, size_t i) {
    if (o->gradient_steps && o->gradient_steps[i] > 0)
        return o->gradient_steps[i];
    return o->gradient_step;
}

static int plan_check_options(nevh_field *f, const nevh_options *o) {
    if (!(o->gradient_step >= 0 && o->gradient_step <= DBL_MAX))
        return nevh__fail(&f->report, NEVH_EINVAL,
                          "the gradient step %g is not a positive number",
                          o->gradient_step);
    for (size_t i = 0; i < 2 * f->n; i++) {
        double step = o->gradient_steps ? o->gradient_steps[i] : 0;
        double scale = o->scale ? o->scale[i] : 1;
        char name[NEVH__VARIABLE];
        nevh__variable_name(f->system, i >= f->n, i % f->n, name);
        if (!(step >= 0 && step <= DBL_MAX))
            return nevh__fail(&f->report, NEVH_EINVAL,
                              "the gradient step of %s, %g, is not a positive "
                              "number",
                              name, step);
        if (!(scale > 0 && scale <= DBL_MAX))
            return nevh__fail(&f->report, NEVH_EINVAL,
                              "the scale of %s, %g, is not a positive number",
                              name, scale);
    }
    return NEVH_OK;
}

static int check_gradient(nevh_field *f, const nevh_term *term) {
    if (!f->gradient->has || f->gradient->has(term) || !(term->nq + term->np))
        return NEVH_OK;
    return nevh__fail(&f->report, NEVH_ENOGRAD,
                      "term \"%s\" of effect \"%s\" has no %s: take central4, "
                      "or give it one",
                      term->name, term->effect, f->gradient->wants);
}

static int plan_term(nevh_field *f, const nevh__term_entry *term,
                     nevh__part_role part) {
    const nevh_term *decl = &term->decl;
    nevh__planned *plan = &f->terms[f->n_terms++];
    *plan = (nevh__planned){.term = term,
                            .part = part,
                            .nq = decl->nq,
                            .np = decl->np,
                            .nv = decl->nq + decl->np};
    f->instances += decl->count;
    if (!f->gradient->offsets)
        return check_gradient(f, decl);
    size_t rows = nevh__step_rows(plan);
    plan->delta = nevh__array(decl->count * plan->nv, sizeof *plan->delta);
    plan->steps = nevh__array(rows * plan->nv, sizeof *plan->steps);
    plan->vars = nevh__array(plan->nv, sizeof *plan->vars);
    plan->first_step = f->n_steps;
    f->n_steps += rows * plan->nv;
    if (plan->delta && plan->steps && plan->vars)
        return NEVH_OK;
    return nevh__no_memory(&f->report);
}

static size_t block_columns(size_t reads) {
    size_t fit =
        NEVH__BLOCK_SIZE / (reads ? reads : 1) / NEVH__LANES * NEVH__LANES;
    fit = fit < NEVH__COLUMNS ? fit : NEVH__COLUMNS;
    return fit > NEVH__FEWEST_COLUMNS ? fit : NEVH__FEWEST_COLUMNS;
}

static int plan_workspace(nevh_field *f) {
    size_t variables = 0, reads = 0;
    if (!nevh__field_join(f))
        return nevh__no_memory(&f->report);
    for (size_t i = 0; i < f->n_pieces; i++) {
        const nevh__planned *term = f->pieces[i];
        size_t all = term->nv + term->term->decl.nc;
        variables = term->nv > variables ? term->nv : variables;
        reads = all > reads ? all : reads;
    }
    size_t columns = f->capacity = block_columns(reads);
    size_t rows = reads + variables + 5; /* and three of columns, two sums */
    f->workspace = nevh__array(rows * columns + 2 * reads + NEVH__LANES,
                               sizeof *f->workspace);
    if (!f->workspace)
        return nevh__no_memory(&f->report);
    f->rows = nevh__aligned(f->workspace);
    f->slopes = f->rows + reads * columns;
    f->times = f->slopes + variables * columns;
    f->zeros = f->times + columns;
    f->h = f->zeros + columns;
    f->sums = f->h + columns;
    f->one = f->sums + 2 * columns;
    if (f->gradient != nevh_exact)
        return NEVH_OK;
    f->broadcasts = nevh__exact_block_broadcasts(f);
    if (nevh__exact_gather_plan(f))
        return NEVH_OK;
    return nevh__no_memory(&f->report);
}

/* The user's steps win, and are differenced at full order. */
static void take_given(nevh_field *f, nevh__planned *term,
                       const nevh_options *o) {
    for (size_t at = 0; at < term->term->decl.count * term->nv; at++) {
        size_t instance = at / term->nv, k = at % term->nv;
        size_t i = nevh__index(term, instance, k);
        double given = given_step(o, k < term->nq ? i : f->n + i);
        nevh__step *step = &term->steps[nevh__step_at(term, instance, k)];
        if (!(given > 0))
            continue;
        term->delta[at] = given;
        step->quadratic = false;
        if (instance % nevh__stride(term->term->decl.count) == 0)
            *step = (nevh__step){.delta = given, .given = true};
    }
}

/* True if order 2 is enough for variable k of every instance. */
static bool quadratic(const nevh__planned *term, size_t k) {
    for (size_t row = 0; row < nevh__step_rows(term); row++)
        if (!term->steps[row * term->nv + k].quadratic)
            return false;
    return true;
}

/* Sorts the variables into passes: full order, then order 2, coordinates
   before momenta. */
static void arrange(const nevh_field *f, nevh__planned *term) {
    size_t at = 0;
    for (int i = 0; i < 2; i++) {
        nevh__pass *pass = &term->pass[i];
        pass->pairs = i ? 1 : f->gradient->offsets;
        pass->begin = at;
        for (size_t k = 0; k < term->nq; k++)
            if (quadratic(term, k) == i)
                term->vars[at++] = k;
        pass->first_p = at;
        for (size_t k = term->nq; k < term->nv; k++)
            if (quadratic(term, k) == i)
                term->vars[at++] = k;
        pass->end = at;
    }
}

static bool all_given(const nevh_field *f, const nevh_options *o) {
    for (size_t i = 0; i < 2 * f->n; i++)
        if (!(given_step(o, i) > 0))
            return false;
    return true;
}

int nevh__field_lengths(nevh_field *f, const nevh_options *o, double length[]) {
    size_t size = 2 * f->n * sizeof *length;
    if (f->gradient->offsets && all_given(f, o)) {
        memcpy(length, f->scale, size);
        return NEVH_OK;
    }
    nevh__step_selection e;
    int status = nevh__step_selection_init(&e, f, o);
    if (!status)
        memcpy(length, e.length, size);
    nevh__step_selection_clear(&e);
    return status;
}

int nevh__field_curvatures(nevh_field *f, const nevh_options *o,
                           double curvature[]) {
    nevh__step_selection e;
    memset(curvature, 0, 2 * f->n * sizeof *curvature);
    double *changes = nevh__array(4 * f->n, sizeof *changes);
    if (!changes)
        return nevh__no_memory(&f->report);
    int status = nevh__step_selection_init(&e, f, o);
    if (!status) {
        nevh__find_neighbours(&e);
        nevh__find_curvatures(&e, changes, curvature);
    }
    nevh__step_selection_clear(&e);
    free(changes);
    return status;
}

static int plan_steps(nevh_field *f, const nevh_options *o) {
    int status = NEVH_OK;
    for (size_t i = 0; i < f->n_terms; i++)
        arrange(f, &f->terms[i]); /* for the pilot */
    if (!all_given(f, o))
        status = nevh__field_select_steps(f, o);
    for (size_t i = 0; !status && i < f->n_terms; i++) {
        take_given(f, &f->terms[i], o);
        arrange(f, &f->terms[i]);
    }
    if (!status && !nevh__central_stencil_plan(f))
        status = nevh__no_memory(&f->report);
    return status;
}

int nevh__field_forget(nevh_field *f, int status) {
    for (size_t i = 0; i < f->n_terms; i++)
        f->terms[i].values = 0;
    f->gradients = f->inner = 0;
    if (!status)
        f->report = (nevh__report){0};
    return status;
}

/* Planning was of all terms; no term has all of a half from here on. */
static void set_apart(nevh_field *f) {
    for (size_t i = 0; i < f->n_terms; i++)
        if (f->terms[i].part != NEVH__KICK) {
            f->parts = 1u << NEVH__KICK;
            f->whole_q = f->whole_p = NULL;
            if (f->terms[i].part == NEVH__INNER)
                f->n_inner += f->terms[i].term->decl.count;
        }
}

static int plan_gradient(nevh_field *f, const nevh_options *o) {
    int status = NEVH_OK;
    if (f->gradient->offsets)
        status = plan_steps(f, o);
    else if (f->gradient == nevh_exact)
        status = nevh__field_verify(f, o);
    nevh__field_forget(f, status);
    set_apart(f);
    if (!status && !nevh__single_plan(f))
        status = nevh__no_memory(&f->report);
    return status;
}

static int plan_field(nevh_field *f, const nevh_options *o,
                      const nevh__part_role part[]) {
    const nevh_system *s = f->system;
    if (s->report.status)
        return nevh__fail_as(&f->report, &s->report);
    int status = plan_check_options(f, o);
    if (!status && !(f->scale = nevh__array(2 * f->n, sizeof(double))))
        status = nevh__no_memory(&f->report);
    for (size_t i = 0; !status && i < 2 * f->n; i++)
        f->scale[i] = choose_scale(o, f->n, i);
    for (size_t i = 0; !status && i < s->n_terms; i++)
        if (nevh__term_on(s, s->terms[i]))
            status = plan_term(f, s->terms[i], part ? part[i] : NEVH__KICK);
    if (!status)
        status = plan_workspace(f);
    if (status)
        return status;
    f->planned = true; /* it can be asked, and planning does */
    status = plan_gradient(f, o);
    if (!status && s->by_lane)
        status = nevh__field_lanes_plan(f, o->width ? o->width : 1);
    f->planned = !status;
    return status;
}

nevh_field *nevh_field_new(const nevh_system *s, const nevh_options *options) {
    return nevh__field_of(s, options, NULL);
}

nevh_field *nevh__field_of(const nevh_system *s, const nevh_options *options,
                           const nevh__part_role part[]) {
    static const nevh_options defaults = {0};
    const nevh_options *o = options ? options : &defaults;
    bool fits = s && nevh__width_fits(s->report.status ? 0 : s->n, o->width);
    nevh_field *f = fits ? nevh__array(1, sizeof *f) : NULL;
    if (!f)
        return NULL;
    f->system = s;
    f->revision = s->revision;
    f->n = s->n;
    f->portable = o->portable;
    f->gradient = o->gradient ? o->gradient : nevh_central4;
    f->parts = NEVH__ALL_PARTS;
    f->terms = nevh__array(s->n_terms, sizeof *f->terms);
    f->pieces = nevh__array(s->n_terms, sizeof *f->pieces);
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = f->terms && f->pieces ? plan_field(f, o, part) : NEVH_ENOMEM;
    fesetenv(&own);
    if (status != NEVH_ENOMEM)
        return f;
    nevh_field_free(f);
    return NULL;
}

/* nevh: a field whose lanes have constants of their own.

   Orbits side by side may belong to systems that differ in the constants of
   their terms, and so in the steps of differences.  Rows of constants are filled
   by lane then, whenever a lane takes others; what is evaluated is the same.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/stencil_private.h"
#include <string.h>

/* Differences in blocks have one step for all lanes, and so have points for
   which there is no room in vectors. */
static bool has_points(const nevh_field *f, const nevh__planned *term) {
    static const size_t parts[] = {0, 1, 2};
    const bool asked[] = {term->nq > 0, term->np > 0, term->nv > 0};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const nevh__stencil *s = term->stencil[i];
        if (asked[i] && (!s || s->points * NEVH__LANES > f->capacity))
            return false;
    }
    return true;
}

static bool can_differ(const nevh_field *f) {
    if (f->gradient == nevh_exact || f->gradient == &nevh__no_gradient)
        return true;
    bool can = f->gradient->offsets > 0;
    for (size_t i = 0; i < f->n_terms; i++)
        can = can && has_points(f, &f->terms[i]);
    return can;
}

static void field_lanes_repeat(size_t count, size_t lanes, const double from[],
                               double rows[]) {
    for (size_t i = 0; i < count * lanes; i++)
        rows[i] = from[i / lanes];
}

/* Shifts are those of the lanes alone. */
static void rest(const nevh__planned *term, nevh__stencil *s) {
    for (size_t i = 0; s && i < term->nv * s->padded; i++)
        s->shift[i] = -0.0;
}

static bool field_lanes_plan_term(nevh__planned *term, size_t lanes) {
    const nevh_term *decl = &term->term->decl;
    size_t constants = decl->count * decl->nc, steps = decl->count * term->nv;
    term->lane_c = nevh__array(constants * lanes, sizeof *term->lane_c);
    term->lane_delta = nevh__array(steps * lanes, sizeof *term->lane_delta);
    if (!term->lane_c || !term->lane_delta)
        return false;
    field_lanes_repeat(constants, lanes, decl->c, term->lane_c);
    for (size_t part = 0; term->delta && part < 3; part++)
        rest(term, term->stencil[part]);
    if (term->delta)
        field_lanes_repeat(steps, lanes, term->delta, term->lane_delta);
    return true;
}

static void choose_all(nevh_field *f) {
    f->n_chosen = f->lanes;
    for (size_t lane = 0; lane < f->lanes; lane++)
        f->chosen[lane] = lane;
}

int nevh__field_lanes_plan(nevh_field *f, size_t lanes) {
    if (!can_differ(f))
        return nevh__fail(&f->report, NEVH_ESTRUCT,
                          "lanes cannot have constants of their own");
    for (size_t i = 0; i < f->n_terms; i++)
        if (!field_lanes_plan_term(&f->terms[i], lanes))
            return nevh__no_memory(&f->report);
    f->chosen = nevh__array(lanes, sizeof *f->chosen);
    f->lane_scale = nevh__array(2 * f->n * lanes, sizeof *f->lane_scale);
    if (!f->chosen || !f->lane_scale)
        return nevh__no_memory(&f->report);
    f->lanes = lanes;
    choose_all(f);
    return NEVH_OK;
}

static bool same_passes(const nevh__planned *a, const nevh__planned *b) {
    return a->nv == b->nv && memcmp(a->pass, b->pass, sizeof a->pass) == 0 &&
           memcmp(a->vars, b->vars, a->nv * sizeof *a->vars) == 0;
}

static bool differenced_alike(const nevh_field *a, const nevh_field *b) {
    bool same = a->n_terms == b->n_terms && a->gradient == b->gradient;
    for (size_t i = 0; same && i < a->n_terms; i++)
        same = !a->terms[i].delta || same_passes(&a->terms[i], &b->terms[i]);
    return same;
}

/* Constants of other lanes lie in the same rows. */
static void fill_again(nevh_field *f) {
    choose_all(f);
    for (size_t i = 0; i < f->n_terms; i++) {
        f->terms[i].gathered_width = 0;
        nevh__constants_fill(f, &f->terms[i]);
    }
}

static void field_lanes_put(size_t count, size_t lanes, size_t lane,
                            const double from[], double rows[]) {
    for (size_t i = 0; i < count; i++)
        rows[i * lanes + lane] = from[i];
}

bool nevh__field_lane_take(nevh_field *f, size_t lane, const double *const c[],
                           const nevh_field *own) {
    if (own && !differenced_alike(f, own))
        return false;
    for (size_t i = 0; i < f->n_terms; i++) {
        nevh__planned *term = &f->terms[i];
        const nevh_term *decl = &term->term->decl;
        field_lanes_put(decl->count * decl->nc, f->lanes, lane, c[i],
                        term->lane_c);
        if (own && term->delta)
            field_lanes_put(decl->count * term->nv, f->lanes, lane,
                            own->terms[i].delta, term->lane_delta);
    }
    if (own && own->scale)
        field_lanes_put(2 * f->n, f->lanes, lane, own->scale, f->lane_scale);
    fill_again(f);
    return true;
}

void nevh__field_lane_copy(nevh_field *f, size_t from, size_t to) {
    for (size_t i = 0; i < f->n_terms; i++) {
        nevh__planned *term = &f->terms[i];
        const nevh_term *decl = &term->term->decl;
        size_t constants = decl->count * decl->nc * f->lanes;
        for (size_t k = 0; k < constants; k += f->lanes)
            term->lane_c[k + to] = term->lane_c[k + from];
        for (size_t k = 0; k < decl->count * term->nv * f->lanes; k += f->lanes)
            term->lane_delta[k + to] = term->lane_delta[k + from];
    }
    for (size_t k = 0; k < 2 * f->n * f->lanes; k += f->lanes)
        f->lane_scale[k + to] = f->lane_scale[k + from];
    fill_again(f);
}

void nevh__field_alone(nevh_field *f, size_t lane) {
    f->alone = lane;
    for (size_t i = 0; i < f->n_terms; i++)
        f->terms[i].gathered_width = 0;
}

const double *nevh__field_lane_scale(const nevh_field *f, size_t lane,
                                     double room[]) {
    for (size_t k = 0; f->lanes && k < 2 * f->n; k++)
        room[k] = f->lane_scale[k * f->lanes + lane];
    return f->lanes ? room : f->scale;
}

void nevh__field_choose(nevh_field *f, size_t count, const size_t lanes[]) {
    f->n_chosen = count;
    memcpy(f->chosen, lanes, count * sizeof *lanes);
    nevh__field_alone(f, lanes[0]);
}

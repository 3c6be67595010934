/* nevh: central differences of any order.

   The derivative with respect to variable x of a term h is a weighted sum of
   the slopes of chords,

       dh/dx = sum_j w_j (h(x+_j) - h(x-_j)) / (x+_j - x-_j),
       x+-_j = x +- j delta,  j = 1 ... order/2,

   divided by the difference of the arguments as they were rounded.  All points
   of many variables, instances and lanes go through one block evaluation.
   Error: c delta^order times the (order+1)-th derivative, plus rounding of
   about epsilon |h| / delta.  The step delta is fixed for the life of a
   field: one that followed the state would break time reversal.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/block_private.h"
#include "system/print_private.h"
#include <math.h>
#include <nevh/body.h>
#include <stdio.h>

/* The differenced variables of each instance, and the points on each side. */
typedef struct {
    const size_t *vars;
    size_t count, pairs;
} selection;

/* Copies come in pairs, + before -, nearest first; `row` and `h` begin at the
   group's first lane, `apart` is the distance between copies. */
NEVH_SIMD static void perturb(double *row, size_t pairs, size_t apart,
                              size_t lanes, double delta) {
    for (size_t j = 0; j < pairs; j++) {
        double shift = (double)(j + 1) * delta;
        double *plus = row + 2 * j * apart, *minus = plus + apart;
        for (size_t lane = 0; lane < lanes; lane++)
            plus[lane] += shift;
        for (size_t lane = 0; lane < lanes; lane++)
            minus[lane] -= shift;
    }
}

/* Static, since what finds the clone to call would be exported otherwise. */
NEVH_SIMD static bool add_slopes(const nevh_gradient *g, size_t apart,
                                 size_t lanes, const double *x, const double *h,
                                 double *out) {
    double slope[NEVH__COLUMNS];
    int64_t bad = 0;
    for (size_t lane = 0; lane < lanes; lane++)
        slope[lane] = 0;
    for (size_t j = 0; j < g->offsets; j++) {
        const double *plus = h + 2 * j * apart, *minus = plus + apart;
        const double *above = x + 2 * j * apart, *below = above + apart;
        double weight = g->weights[j];
        for (size_t lane = 0; lane < lanes; lane++)
            slope[lane] += weight * ((plus[lane] - minus[lane]) /
                                     (above[lane] - below[lane]));
    }
    for (size_t lane = 0; lane < lanes; lane++) {
        out[lane] += slope[lane];
        bad |= slope[lane] - slope[lane] != 0;
    }
    return bad != 0;
}

bool nevh__add_slopes(const nevh_gradient *g, size_t apart, size_t lanes,
                      const double *x, const double *h, double *out) {
    return add_slopes(g, apart, lanes, x, h, out);
}

/* The distance of a column from the orbit, and the variable in which it is largest. */
static double central_block_reach_of(const nevh_field *f,
                                     const nevh__planned *term,
                                     const nevh__block *b, size_t column,
                                     size_t *variable) {
    size_t lane = b->lane + column % b->lanes;
    size_t group = column % (b->groups * b->lanes) / b->lanes;
    size_t instance = (b->group + group) / b->per_instance;
    double most = 0;
    for (size_t k = 0; k < term->nv; k++) {
        const double *z = k < term->nq ? b->q : b->p;
        double orbit = z[nevh__index(term, instance, k) * b->width + lane];
        double away = fabs(nevh__row(f, b, k)[column] - orbit);
        *variable = away > most ? k : *variable;
        most = fmax(most, away);
    }
    return most;
}

/* Fills the rows with the orbit's own points; *column is that of the instance. */
static nevh__block orbit_block(nevh_field *f, const nevh__planned *term,
                               const nevh__block *b, size_t lane,
                               size_t instance, size_t *column) {
    nevh__block one = nevh__block_over(b->width, b->t, b->q, b->p, 1, 1);
    one.first = b->first;
    one.lane = lane;
    one.until = lane + 1;
    while (nevh__block_next(f, term, &one) &&
           one.group + one.groups <= instance)
        continue;
    *column = instance - one.group;
    return one;
}

/* Told and true where an instance has no value on the orbit itself, or none one
   rounding beside it in variable k. */
static bool fails_on_orbit(nevh_field *f, nevh__planned *term,
                           const nevh__block *b, size_t lane, size_t instance,
                           size_t k) {
    size_t column;
    nevh__block one = orbit_block(f, term, b, lane, instance, &column);
    uint64_t counted = term->values;
    char name[NEVH__VARIABLE], edge[200] = "";
    double *z = f->rows + k * one.stride + column, orbit = *z;
    nevh__block_evaluate(f, term, &one);
    for (int side = 0; side < 2 && isfinite(f->h[column]); side++) {
        *z = nextafter(orbit, side ? -INFINITY : INFINITY);
        nevh__block_evaluate(f, term, &one);
        nevh__variable_name(f->system, k >= term->nq,
                            nevh__index(term, instance, k), name);
        nevh__print(edge, sizeof edge,
                    "no difference by %s can be taken at %s = %.9g, an edge of "
                    "the domain of H, where its slope may be infinite: %s it, ",
                    name, name, orbit, side ? "below" : "above");
    }
    term->values = counted;
    if (isfinite(f->h[column]))
        return false;
    nevh__block_fail(f, term, &one, column, edge, f->h[column]);
    return true;
}

/* It is a point of the difference that has no value, or the orbit. */
int nevh__fail_outside(nevh_field *f, nevh__planned *term, const nevh__block *b,
                       size_t column, size_t instance, size_t k, double reach) {
    char where[200], name[NEVH__VARIABLE];
    nevh__report report = f->report;
    nevh__variable_name(f->system, k >= term->nq,
                        nevh__index(term, instance, k), name);
    nevh__print(where, sizeof where,
                "a difference by %s reaches %.3g from the orbit (the exact "
                "gradient reads no such point), where ",
                name, reach);
    int status = nevh__block_fail(f, term, b, column, where, f->h[column]);
    nevh__report outside = f->report;
    f->report = report;
    if (!fails_on_orbit(f, term, b, b->lane + column % b->lanes, instance, k))
        f->report = outside;
    return status;
}

int nevh__central_fail(nevh_field *f, nevh__planned *term, const nevh__block *b,
                       size_t lane, size_t instance, size_t k) {
    const nevh_term *decl = &term->term->decl;
    if (nevh__block_check(f, term, b)) {
        size_t column = 0, moved = 0;
        while (column + 1 < b->used && isfinite(f->h[column]))
            column++;
        double reach = central_block_reach_of(f, term, b, column, &moved);
        return nevh__fail_outside(f, term, b, column, instance, moved, reach);
    }
    char name[NEVH__VARIABLE], when[40] = "";
    size_t index = nevh__index(term, instance, k);
    const double *z = k < term->nq ? b->q : b->p;
    if (fails_on_orbit(f, term, b, lane, instance, k))
        return f->report.status;
    if (decl->time)
        nevh__print(when, sizeof when, ", t = %.9g", b->t[lane]);
    nevh__variable_name(f->system, k >= term->nq, index, name);
    return nevh__fail(
        &f->report, NEVH_EDOM,
        "the derivative of term \"%s\" of effect \"%s\" with respect to "
        "%s is not finite at %s = %.9g%s: its step of %g is lost in a "
        "value too large, or too small for the values of H, which may jump "
        "there; take a smaller step, a gradient step or the exact gradient",
        decl->name, decl->effect, name, name, z[index * b->width + lane], when,
        term->delta[instance * term->nv + k]);
}

static void perturb_block(nevh_field *f, const nevh__planned *term,
                          const nevh__block *b, selection s) {
    nevh__cursor at = nevh__first_group(b);
    size_t apart = b->groups * b->lanes;
    for (size_t group = 0; group < b->groups; group++) {
        size_t k = s.vars[at.v];
        perturb(f->rows + k * b->stride + group * b->lanes, s.pairs, apart,
                b->lanes, term->delta[at.instance * term->nv + k]);
        nevh__next_group(b, &at);
    }
}

/* One pair is the difference of order 2, whatever the method. */
static const nevh_gradient *weights_of(const nevh_field *f, size_t pairs) {
    return pairs == 1 ? nevh_central2 : f->gradient;
}

/* One lane: the groups take the place of lanes.  Weighted slopes of chords,
   whose widths stand as the values do. */
NEVH_SIMD static bool
central_block_find_slopes(const nevh_gradient *g, size_t groups,
                          const double *width, const double *h, double *slope) {
    int64_t bad = 0;
    for (size_t i = 0; i < groups; i++)
        slope[i] = 0;
    for (size_t j = 0; j < g->offsets; j++) {
        const double *plus = h + 2 * j * groups, *minus = plus + groups;
        double weight = g->weights[j];
        for (size_t i = 0; i < groups; i++)
            slope[i] += weight * ((plus[i] - minus[i]) / width[j * groups + i]);
    }
    for (size_t i = 0; i < groups; i++)
        bad |= slope[i] - slope[i] != 0;
    return bad != 0;
}

/* As perturb, of one lane; also the widths of the chords. */
static void perturb_one(double *row, size_t pairs, size_t apart, double delta,
                        double *width) {
    for (size_t j = 0; j < pairs; j++, row += 2 * apart) {
        double shift = (double)(j + 1) * delta;
        row[0] += shift;
        row[apart] -= shift;
        width[j * apart] = row[0] - row[apart];
    }
}

/* As difference_lanes, bit for bit, with a shorter loop over groups for terms of
   many instances. */
static int difference_one(nevh_field *f, nevh__planned *term, nevh__block *b,
                          selection s, const nevh__places *x) {
    const nevh_gradient *g = weights_of(f, s.pairs);
    double width[NEVH__COLUMNS], slope[NEVH__COLUMNS];
    nevh__cursor at = nevh__first_group(b);
    for (size_t i = 0; i < b->groups; i++, nevh__next_group(b, &at)) {
        size_t k = s.vars[at.v];
        perturb_one(f->rows + k * b->stride + i, s.pairs, b->groups,
                    term->delta[at.instance * term->nv + k], width + i);
    }
    nevh__block_evaluate(f, term, b);
    bool bad = central_block_find_slopes(g, b->groups, width, f->h, slope);
    at = nevh__first_group(b);
    for (size_t i = 0; i < b->groups; i++, nevh__next_group(b, &at)) {
        size_t k = s.vars[at.v];
        if (bad && slope[i] - slope[i] != 0)
            return nevh__central_fail(f, term, b, b->lane, at.instance, k);
        double *out = k < term->nq ? x->dh_dq : x->dh_dp;
        out[nevh__index(term, at.instance, k) * b->width + b->lane] += slope[i];
    }
    return NEVH_OK;
}

/* The first that is not finite; 0: none. */
static size_t not_finite(const double x[], size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(x[i]))
            return i;
    return 0;
}

static int difference_lanes(nevh_field *f, nevh__planned *term, nevh__block *b,
                            selection s, const nevh__places *x) {
    const nevh_gradient *g = weights_of(f, s.pairs);
    size_t apart = b->groups * b->lanes;
    perturb_block(f, term, b, s);
    nevh__block_evaluate(f, term, b);
    nevh__cursor at = nevh__first_group(b);
    for (size_t group = 0; group < b->groups; group++) {
        size_t k = s.vars[at.v], first = group * b->lanes;
        double *out = k < term->nq ? x->dh_dq : x->dh_dp;
        out += nevh__index(term, at.instance, k) * b->width + b->lane;
        bool bad = nevh__add_slopes(g, apart, b->lanes,
                                    f->rows + k * b->stride + first,
                                    f->h + first, out);
        if (bad)
            return nevh__central_fail(f, term, b,
                                      b->lane + not_finite(out, b->lanes),
                                      at.instance, k);
        nevh__next_group(b, &at);
    }
    return NEVH_OK;
}

/* The part of a pass that is wanted. */
static selection select_vars(const nevh__planned *term, const nevh__pass *pass,
                             bool q, bool p) {
    size_t begin = q ? pass->begin : pass->first_p;
    size_t end = p ? pass->end : pass->first_p;
    return (selection){term->vars + begin, end - begin, pass->pairs};
}

int nevh__central_blocks(nevh_field *f, nevh__planned *term,
                         const nevh__places *x) {
    int status = NEVH_OK;
    for (int i = 0; !status && i < 2; i++) {
        selection s = select_vars(term, &term->pass[i], x->dh_dq, x->dh_dp);
        if (s.count == 0)
            continue;
        nevh__block b =
            nevh__block_over(x->width, x->t, x->q, x->p, 2 * s.pairs, s.count);
        while (!status && nevh__block_next(f, term, &b))
            status = (b.lanes == 1 ? difference_one
                                   : difference_lanes)(f, term, &b, s, x);
    }
    return status;
}

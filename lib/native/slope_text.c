/* nevh: dH/dq or dH/dp of a small system as C text.

   Terms and instances stand one after the other, and what belongs to one
   variable is added in the order in which the field adds it: the same bits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "native/slope_private.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = 8 };

/* A summand of one variable's derivative. */
typedef struct {
    size_t target;
    char name[NEVH__NAME];
} part;

typedef struct {
    nevh__slope_text of;
    size_t constants; /* of the term, in the table of numbers */
    part *parts;
    size_t count, room;
} sum;

static void slope_text_add_part(sum *s, size_t target, const char *name) {
    if (s->count == s->room) {
        size_t room = s->room ? 2 * s->room : 64;
        part *parts = nevh__grow(s->parts, room, sizeof *parts);
        if (!parts) {
            s->of.w->failed = true;
            return;
        }
        s->parts = parts;
        s->room = room;
    }
    part *p = &s->parts[s->count++];
    p->target = target;
    snprintf(p->name, sizeof p->name, "%s", name);
}

/* At the state. */
static void slope_text_name_at_state(nevh__writer *w,
                                     const nevh__formula_text *f,
                                     nevh__variable kind, size_t k,
                                     char name[NEVH__NAME]) {
    const sum *s = f->data;
    const nevh_term *is = &s->of.term->term->decl;
    switch (kind) {
    case NEVH__T:
        snprintf(name, NEVH__NAME, f->lanes && !w->stages ? "ALL(t)" : "t");
        break;
    case NEVH__Q:
        nevh__state_name(w, false, is->q[f->instance * is->nq + k], name);
        break;
    case NEVH__P:
        nevh__state_name(w, true, is->p[f->instance * is->np + k], name);
        break;
    default:
        if (w->readable) {
            nevh__number_text(is->c[f->instance * is->nc + k], name);
            break;
        }
        if (w->by_lane) {
            nevh__write_own(w,
                            s->of.term->lane_c +
                                (f->instance * is->nc + k) * s->of.f->lanes,
                            1, name);
            break;
        }
        snprintf(name, NEVH__NAME, f->lanes ? "ALL(N[%zu])" : "N[%zu]",
                 s->constants + f->instance * is->nc + k);
    }
}

/* Derivative k of an instance; `first` is the id of instance 0. */
static void add_derivative(sum *s, nevh__formula_text *f, unsigned first,
                           size_t k, size_t instance) {
    char name[NEVH__NAME];
    if (!nevh__slope_reads(&s->of, k))
        return;
    f->id = first + (unsigned)instance;
    nevh__derivative_name(f, s->of.kick ? NEVH__Q : NEVH__P,
                          k - nevh__first_of(&s->of), name);
    slope_text_add_part(s, nevh__index(s->of.term, instance, k), name);
}

static bool write_exact(sum *s) {
    const nevh_term *is = &s->of.term->term->decl;
    nevh__formula_text f = {.tape = is->params,
                            .lanes =
                                nevh__has_lanes(s->of.w) ? &nevh__eight : NULL,
                            .variable = slope_text_name_at_state,
                            .data = s};
    unsigned first = s->of.w->formulas;
    for (f.instance = 0; f.instance < is->count; f.instance++)
        if (!nevh__write_gradient(s->of.w, &f,
                                  s->of.kick ? NEVH__BY_Q : NEVH__BY_P))
            return false;
    size_t begin = nevh__first_of(&s->of), end = nevh__end_of(&s->of);
    for (size_t i = 0; s->of.term->turned && i < is->count; i++)
        for (size_t k = begin; k < end; k++)
            add_derivative(s, &f, first, k, i);
    for (size_t k = begin; !s->of.term->turned && k < end; k++)
        for (size_t i = 0; i < is->count; i++)
            add_derivative(s, &f, first, k, i);
    return true;
}

static bool write_complex(sum *s) {
    const nevh_term *is = &s->of.term->term->decl;
    nevh__formula_text f = {
        .tape = is->params, .variable = slope_text_name_at_state, .data = s};
    for (f.instance = 0; f.instance < is->count; f.instance++)
        for (size_t k = nevh__first_of(&s->of); k < nevh__end_of(&s->of); k++) {
            char taken[NEVH__NAME], name[NEVH__NAME];
            if (!nevh__write_complex(
                    s->of.w, &f, s->of.kick ? NEVH__Q : NEVH__P,
                    s->of.kick ? k : k - s->of.term->nq, taken))
                return false;
            snprintf(name, sizeof name, "c%u", f.id);
            nevh__write(s->of.w, "    double %s = %s * 0x1p332;\n", name,
                        taken);
            slope_text_add_part(s, nevh__index(s->of.term, f.instance, k),
                                name);
        }
    return true;
}

/* The points of central differences of a term, in the field's order. */
typedef struct {
    size_t instance, k;
    double times, shift; /* shift: so many times the step */
} point;
typedef struct {
    size_t instance, k, first; /* first: of its points */
    const nevh_gradient *method;
} slope;
typedef struct {
    const sum *s;
    point *points;
    slope *slopes;
    size_t count, slope_count;
    size_t at; /* the first point of a block, or the only one */
    unsigned block;
} stencil;

static void list_points(const sum *s, stencil *x) {
    const nevh__planned *term = s->of.term;
    x->count = x->slope_count = 0;
    for (int i = 0; i < 2; i++) {
        const nevh__pass *pass = &term->pass[i];
        size_t begin = s->of.kick ? pass->begin : pass->first_p;
        size_t end = s->of.kick ? pass->first_p : pass->end;
        const nevh_gradient *method =
            pass->pairs == 1 ? nevh_central2 : s->of.f->gradient;
        for (size_t instance = 0; instance < term->term->decl.count; instance++)
            for (size_t v = begin; v < end; v++) {
                size_t k = term->vars[v];
                double delta = term->delta[instance * term->nv + k];
                x->slopes[x->slope_count++] =
                    (slope){instance, k, x->count, method};
                for (size_t j = 0; j < 2 * pass->pairs; j++) {
                    double times = (double)(j / 2 + 1);
                    times = j % 2 ? -times : times;
                    x->points[x->count++] =
                        (point){instance, k, times, times * delta};
                }
            }
    }
}

/* A block of no more than four points takes vectors of four. */
static size_t slope_text_lanes_of(const stencil *x) {
    return x->count - x->at > 4 ? nevh__lanes_together() : 4;
}

static const nevh__lane_words *words_of(const stencil *x) {
    return slope_text_lanes_of(x) > 4 ? &nevh__eight : &nevh__four;
}

/* The point that is in a lane; those beyond the last repeat the first. */
static const point *point_in(const stencil *x, size_t lane) {
    size_t at = x->at + lane;
    return &x->points[at < x->count ? at : x->at];
}

/* One variable of a block's points. */
static void write_variable(nevh__writer *w, const stencil *x, size_t k) {
    const nevh__planned *term = x->s->of.term;
    size_t index[LANES] = {0}, lanes = slope_text_lanes_of(x);
    const nevh__lane_words *words = words_of(x);
    bool same = true, moved = false;
    const char *half = k < term->nq ? "q" : "p";
    for (size_t lane = 0; lane < lanes; lane++) {
        const point *at = point_in(x, lane);
        index[lane] = nevh__index(term, at->instance, k);
        same &= index[lane] == index[0];
        moved |= at->k == k;
    }
    nevh__write(w, "    %s x%u_%zu = ", words->type, x->block, k);
    if (same)
        nevh__write(w, "%s(%s[%zu])", words->all, half, index[0]);
    else
        nevh__write(w, "(%s){", words->type);
    for (size_t lane = 0; lane < lanes && !same; lane++)
        nevh__write(w, "%s%s[%zu]%s", lane ? ", " : "", half, index[lane],
                    lane + 1 < lanes ? "" : "}");
    if (moved)
        nevh__write(w, " + *(const %s *)(N + %zu)", words->type, w->count);
    for (size_t lane = 0; lane < lanes && moved; lane++) {
        const point *at = point_in(x, lane);
        nevh__writer_append(w, at->k == k ? at->shift : -0.0);
    }
    nevh__write(w, ";\n");
}

static void name_in_block(nevh__writer *w, const nevh__formula_text *f,
                          nevh__variable kind, size_t k,
                          char name[NEVH__NAME]) {
    const stencil *x = f->data;
    const nevh__planned *term = x->s->of.term;
    const nevh_term *is = &term->term->decl;
    if (kind == NEVH__T)
        snprintf(name, NEVH__NAME, "%s(t)", f->lanes->all);
    else if (kind != NEVH__C)
        snprintf(name, NEVH__NAME, "x%u_%zu", x->block,
                 kind == NEVH__Q ? k : term->nq + k);
    else {
        bool same = true;
        size_t lanes = slope_text_lanes_of(x);
        for (size_t lane = 1; lane < lanes; lane++)
            same &= point_in(x, lane)->instance == point_in(x, 0)->instance;
        if (same) {
            snprintf(name, NEVH__NAME, "%s(N[%zu])", f->lanes->all,
                     x->s->constants + point_in(x, 0)->instance * is->nc + k);
            return;
        }
        snprintf(name, NEVH__NAME, "(*(const %s *)(N + %zu))", f->lanes->type,
                 w->count);
        for (size_t lane = 0; lane < lanes; lane++)
            nevh__writer_append(
                w, is->c[point_in(x, lane)->instance * is->nc + k]);
    }
}

static bool write_blocks(nevh__writer *w, stencil *x) {
    for (x->at = 0; x->at < x->count; x->at += nevh__lanes_together()) {
        nevh__formula_text f = {.tape = x->s->of.term->term->decl.params,
                                .lanes = words_of(x),
                                .variable = name_in_block,
                                .data = x};
        char result[NEVH__NAME];
        x->block = w->formulas;
        for (size_t k = 0; k < x->s->of.term->nv; k++)
            write_variable(w, x, k);
        if (!nevh__write_value(w, &f, result))
            return false;
        nevh__write(w, "    %s h%u = %s;\n", f.lanes->type, x->block, result);
    }
    return true;
}

/* One variable of the point. */
static void name_at_point(nevh__writer *w, const nevh__formula_text *f,
                          nevh__variable kind, size_t k,
                          char name[NEVH__NAME]) {
    const stencil *x = f->data;
    const nevh__planned *term = x->s->of.term;
    size_t all = kind == NEVH__P ? term->nq + k : k;
    if ((kind == NEVH__Q || kind == NEVH__P) && x->points[x->at].k == all)
        snprintf(name, NEVH__NAME, "x%u", x->block);
    else {
        nevh__formula_text at = *f;
        at.data = x->s;
        at.instance = x->points[x->at].instance;
        slope_text_name_at_state(w, &at, kind, k, name);
    }
}

static const double *lane_steps(const sum *s, const point *at) {
    const nevh__planned *term = s->of.term;
    return term->lane_delta +
           (at->instance * term->nv + at->k) * s->of.f->lanes;
}

static bool write_points(nevh__writer *w, stencil *x) {
    bool lanes = nevh__has_lanes(w);
    nevh__formula_text f = {.tape = x->s->of.term->term->decl.params,
                            .lanes = lanes ? &nevh__eight : NULL,
                            .variable = name_at_point,
                            .data = x};
    for (x->at = 0; x->at < x->count; x->at++) {
        const point *at = &x->points[x->at];
        char result[NEVH__NAME];
        x->block = w->formulas;
        char shift[NEVH__NAME], moved[NEVH__NAME];
        if (w->by_lane)
            nevh__write_own(w, lane_steps(x->s, at), at->times, shift);
        else
            nevh__write_number(w, at->shift, shift);
        nevh__state_name(w, at->k >= x->s->of.term->nq,
                         nevh__index(x->s->of.term, at->instance, at->k),
                         moved);
        nevh__write(w, "    %s x%u = %s + %s;\n", nevh__number_type(w),
                    x->block, moved, shift);
        if (!nevh__write_value(w, &f, result))
            return false;
        nevh__write(w, "    %s h%u = %s;\n", nevh__number_type(w), x->block,
                    result);
    }
    return true;
}

/* A point's name: one of a block's, or its own. */
static void write_point(nevh__writer *w, const char *letter, unsigned first,
                        size_t at, bool wide, size_t k) {
    nevh__write(w, "%s%u", letter,
                first + (unsigned)(wide ? at / nevh__lanes_together() : at));
    if (wide && *letter == 'x')
        nevh__write(w, "_%zu", k);
    if (wide)
        nevh__write(w, "[%zu]", at % nevh__lanes_together());
}

static void write_weight(nevh__writer *w, double weight) {
    char name[NEVH__NAME];
    if (weight == 1)
        return;
    nevh__write_number(w, weight, name);
    nevh__write(w, "%s * ", name);
}

static void write_slopes(nevh__writer *w, sum *s, const stencil *x,
                         unsigned first, bool wide) {
    for (size_t i = 0; i < x->slope_count; i++) {
        const slope *one = &x->slopes[i];
        char name[NEVH__NAME];
        snprintf(name, sizeof name, "s%u_%zu", first, i);
        nevh__write(w, "    %s %s = ", nevh__number_type(w), name);
        for (size_t j = 0; j < one->method->offsets; j++) {
            size_t plus = one->first + 2 * j, minus = plus + 1;
            nevh__write(w, "%s", j ? " + " : "");
            write_weight(w, one->method->weights[j]);
            nevh__write(w, "((");
            write_point(w, "h", first, plus, wide, one->k);
            nevh__write(w, " - ");
            write_point(w, "h", first, minus, wide, one->k);
            nevh__write(w, ") / (");
            write_point(w, "x", first, plus, wide, one->k);
            nevh__write(w, " - ");
            write_point(w, "x", first, minus, wide, one->k);
            nevh__write(w, "))");
        }
        nevh__write(w, ";\n");
        slope_text_add_part(s, nevh__index(s->of.term, one->instance, one->k),
                            name);
    }
}

static bool write_central(sum *s) {
    size_t slopes = s->of.term->term->decl.count * s->of.term->nv;
    stencil x = {.s = s};
    x.points =
        nevh__array(slopes * 2 * s->of.f->gradient->offsets, sizeof(point));
    x.slopes = nevh__array(slopes, sizeof(slope));
    bool fine = x.points && x.slopes, wide = nevh__side_by_side(s->of.w);
    unsigned first = s->of.w->formulas;
    if (fine) {
        list_points(s, &x);
        fine = (wide ? write_blocks : write_points)(s->of.w, &x);
        write_slopes(s->of.w, s, &x, first, wide);
    } else
        s->of.w->failed = true;
    free(x.points);
    free(x.slopes);
    return fine;
}

static void write_sums(const sum *s) {
    for (size_t v = 0; v < s->of.f->n; v++) {
        nevh__write(s->of.w, "    slope[%zu] =", v);
        const char *plus = " ";
        for (size_t i = 0; i < s->count; i++)
            if (s->parts[i].target == v) {
                nevh__write(s->of.w, "%s%s", plus, s->parts[i].name);
                plus = " + ";
            }
        const char *zero = nevh__has_lanes(s->of.w) ? " ALL(0.0)" : " 0.0";
        nevh__write(s->of.w, "%s;\n", *plus == ' ' && !plus[1] ? zero : "");
    }
}

/* After loops: to what they have left. */
static void write_added(sum *s) {
    for (size_t i = 0; i < s->count; i++) {
        size_t target = s->parts[i].target;
        if (!s->of.w->readable)
            nevh__write(s->of.w, "    if (%zu - first < past - first)\n    ",
                        target);
        nevh__write(s->of.w, "    slope[%zu] += %s;\n", target,
                    s->parts[i].name);
    }
    s->count = 0;
}

static bool slope_text_write_term(sum *s) {
    nevh__writer *w = s->of.w;
    const nevh_term *is = &s->of.term->term->decl;
    if (w->loops && nevh__is_loop(s->of.term))
        return nevh__write_loop(&s->of);
    if (!w->readable)
        s->constants = nevh__writer_share(w, is->count * is->nc, is->c);
    else
        nevh__write_effect(w, is);
    if (w->loops && !w->readable)
        nevh__write_asked(&s->of);
    bool fine = s->of.f->gradient == nevh_exact ? write_exact(s)
                : s->of.f->gradient->offsets    ? write_central(s)
                                                : write_complex(s);
    if (w->loops)
        write_added(s);
    if (w->loops && !w->readable)
        nevh__write(w, "    }\n");
    return fine;
}

static const char slope_begins[] =
    "$1 $2 $3($4$5 t, const $2 *q, const $2 *p,\n"
    "$6$2 *slope) {\n    $2 bad = {0};\n";
/* Numbers of vectors in which the state stands. */
static const char loops_begin[] =
    "SLOPE double $3(const double *N, double t, const wide *points,\n"
    "        const wide *momenta, wide *slopes, size first, size past) {\n"
    "    const double *q = (const double *)points;\n"
    "    const double *p = (const double *)momenta;\n"
    "    double *slope = (double *)slopes, bad = 0, rows_bad = 0;\n"
    "    for (size k = first / 8; k < past / 8; k++) slopes[k] = (wide){0};\n";

static void write_head(nevh__writer *w, const nevh_field *f, bool kick,
                       const char *name) {
    bool vectors = w->loops && !w->readable;
    char below[NEVH__NAME]; /* the parenthesis */
    snprintf(below, sizeof below, "%*s",
             (int)(strlen("static double (") + strlen(name)), "");
    if (w->readable)
        nevh__write(w, "/* %s at t, q, p. */\n", kick ? "dH/dq" : "dH/dp");
    nevh__write_filled(
        w, vectors ? loops_begin : slope_begins,
        (const char *const[]){
            w->readable ? "static" : "SLOPE", nevh__number_type(w), name,
            w->readable ? "" : "const double *N, ",
            w->stages && !w->readable ? "wide" : "double", below});
    if (w->readable)
        nevh__write(w, "    (void)t, (void)q, (void)p;\n");
    nevh__write_state_names(w, f);
    if (w->readable && w->loops)
        nevh__write(w, "    NEVH__EACH(k, 1, DOF)\n        slope[k] = 0;\n");
}

static bool write_slope(nevh__writer *w, nevh_field *f, bool kick,
                        const char *name) {
    sum s = {.of = {.w = w, .f = f, .kick = kick}};
    bool fine = true;
    write_head(w, f, kick, name);
    for (size_t i = 0; fine && i < f->n_terms; i++) {
        s.of.term = &f->terms[i];
        if (nevh__is_wanted(f, s.of.term, kick))
            fine = slope_text_write_term(&s);
    }
    if (!w->loops)
        write_sums(&s);
    nevh__write(w, "    return bad%s;\n}\n%s",
                w->readable ? ""
                : w->loops  ? " - bad + (rows_bad - rows_bad)"
                            : " - bad",
                w->readable ? "\n" : "");
    free(s.parts);
    return fine;
}

bool nevh__write_slopes(nevh__writer *w, nevh_field *f, size_t calls) {
    unsigned parts = f->parts, inner = 1u << NEVH__INNER;
    f->parts |= inner;
    bool fine = nevh__slopes_fit(w, f, calls);
    if (fine && w->loops && !w->readable)
        nevh__write_lines(w, nevh__loop_needs_text);
    f->parts = inner;
    if (fine && parts != NEVH__ALL_PARTS)
        fine = write_slope(w, f, true, "inner_slope");
    f->parts = parts;
    return fine && write_slope(w, f, true, "kick_slope") &&
           write_slope(w, f, false, "drift_slope");
}

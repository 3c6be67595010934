/* nevh: dH/dq or dH/dp of a small system as C text.

   Terms and instances stand one after the other, and what belongs to one
   variable is added in the order in which the field adds it: the same bits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "native/writer_private.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More text than MOST_BROADCAST is called instead of being repeated. */
enum { MOST_OPERATIONS = 800, MOST_BROADCAST = 800, LANES = 8 };

/* What is added to one variable's derivative. */
typedef struct {
    size_t target;
    char name[NEVH__NAME];
} part;

typedef struct {
    nevh__writer *w;
    nevh_field *f;
    const nevh__planned *term;
    bool kick;
    size_t constants; /* of the term, in the table of numbers */
    part *parts;
    size_t count, room;
} sum;

static void add_part(sum *s, size_t target, const char *name) {
    if (s->count == s->room) {
        size_t room = s->room ? 2 * s->room : 64;
        part *parts = nevh__grow(s->parts, room, sizeof *parts);
        if (!parts) {
            s->w->failed = true;
            return;
        }
        s->parts = parts;
        s->room = room;
    }
    part *p = &s->parts[s->count++];
    p->target = target;
    snprintf(p->name, sizeof p->name, "%s", name);
}

/* The first of the half's variables, and where they end. */
static size_t first_of(const sum *s) {
    return s->kick ? 0 : s->term->nq;
}
static size_t end_of(const sum *s) {
    return s->kick ? s->term->nq : s->term->nv;
}

static bool is_read(const sum *s, size_t k) {
    const nevh__tape *tape = s->term->term->decl.params;
    size_t nq = s->term->nq;
    return k < nq ? nevh__tape_reads(tape, NEVH__Q, k)
                  : nevh__tape_reads(tape, NEVH__P, k - nq);
}

/* At the state. */
static void name_at_state(nevh__writer *w, const nevh__formula_text *f,
                          nevh__variable kind, size_t k,
                          char name[NEVH__NAME]) {
    const sum *s = f->data;
    const nevh_term *is = &s->term->term->decl;
    switch (kind) {
    case NEVH__T:
        snprintf(name, NEVH__NAME, f->wide && !w->stages ? "ALL(t)" : "t");
        break;
    case NEVH__Q:
        snprintf(name, NEVH__NAME, "q[%zu]", is->q[f->instance * is->nq + k]);
        break;
    case NEVH__P:
        snprintf(name, NEVH__NAME, "p[%zu]", is->p[f->instance * is->np + k]);
        break;
    default:
        if (w->readable) {
            nevh__number_text(is->c[f->instance * is->nc + k], name);
            break;
        }
        snprintf(name, NEVH__NAME, f->wide ? "ALL(N[%zu])" : "N[%zu]",
                 s->constants + f->instance * is->nc + k);
    }
}

static bool write_exact(sum *s) {
    const nevh_term *is = &s->term->term->decl;
    nevh__formula_text f = {.tape = is->params,
                            .wide = nevh__has_lanes(s->w),
                            .variable = name_at_state,
                            .data = s};
    unsigned first = s->w->formulas;
    for (f.instance = 0; f.instance < is->count; f.instance++)
        if (!nevh__write_gradient(s->w, &f, s->kick ? NEVH__BY_Q : NEVH__BY_P))
            return false;
    for (size_t k = first_of(s); k < end_of(s); k++)
        for (size_t i = 0; i < is->count && is_read(s, k); i++) {
            char name[NEVH__NAME];
            f.id = first + (unsigned)i;
            nevh__derivative_name(&f, s->kick ? NEVH__Q : NEVH__P,
                                  s->kick ? k : k - s->term->nq, name);
            add_part(s, nevh__index(s->term, i, k), name);
        }
    return true;
}

static bool write_complex(sum *s) {
    const nevh_term *is = &s->term->term->decl;
    nevh__formula_text f = {
        .tape = is->params, .variable = name_at_state, .data = s};
    for (f.instance = 0; f.instance < is->count; f.instance++)
        for (size_t k = first_of(s); k < end_of(s); k++) {
            char taken[NEVH__NAME], name[NEVH__NAME];
            if (!nevh__write_complex(s->w, &f, s->kick ? NEVH__Q : NEVH__P,
                                     s->kick ? k : k - s->term->nq, taken))
                return false;
            snprintf(name, sizeof name, "c%u", f.id);
            nevh__write(s->w, "    double %s = %s * 0x1p332;\n", name, taken);
            add_part(s, nevh__index(s->term, f.instance, k), name);
        }
    return true;
}

/* The points of central differences of a term, in the field's order. */
typedef struct {
    size_t instance, k;
    double shift;
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
    const nevh__planned *term = s->term;
    x->count = x->slope_count = 0;
    for (int i = 0; i < 2; i++) {
        const nevh__pass *pass = &term->pass[i];
        size_t begin = s->kick ? pass->begin : pass->first_p;
        size_t end = s->kick ? pass->first_p : pass->end;
        const nevh_gradient *method =
            pass->pairs == 1 ? nevh_central2 : s->f->gradient;
        for (size_t instance = 0; instance < term->term->decl.count; instance++)
            for (size_t v = begin; v < end; v++) {
                size_t k = term->vars[v];
                double delta = term->delta[instance * term->nv + k];
                x->slopes[x->slope_count++] =
                    (slope){instance, k, x->count, method};
                for (size_t j = 0; j < 2 * pass->pairs; j++) {
                    double move = (double)(j / 2 + 1) * delta;
                    x->points[x->count++] =
                        (point){instance, k, j % 2 ? -move : move};
                }
            }
    }
}

/* The point that is in a lane; those beyond the last repeat the first. */
static const point *point_in(const stencil *x, size_t lane) {
    size_t at = x->at + lane;
    return &x->points[at < x->count ? at : x->at];
}

/* One variable of eight points. */
static void write_wide(nevh__writer *w, const stencil *x, size_t k) {
    const nevh__planned *term = x->s->term;
    size_t index[LANES];
    bool same = true, moved = false;
    const char *half = k < term->nq ? "q" : "p";
    for (size_t lane = 0; lane < LANES; lane++) {
        const point *at = point_in(x, lane);
        index[lane] = nevh__index(term, at->instance, k);
        same &= index[lane] == index[0];
        moved |= at->k == k;
    }
    nevh__write(w, "    wide x%u_%zu = ", x->block, k);
    if (same)
        nevh__write(w, "ALL(%s[%zu])", half, index[0]);
    for (size_t lane = 0; lane < LANES && !same; lane++)
        nevh__write(w, "%s%s[%zu]%s", lane ? ", " : "(wide){", half,
                    index[lane], lane + 1 < LANES ? "" : "}");
    if (moved)
        nevh__write(w, " + *(const wide *)(N + %zu)", w->count);
    for (size_t lane = 0; lane < LANES && moved; lane++) {
        const point *at = point_in(x, lane);
        nevh__writer_append(w, at->k == k ? at->shift : -0.0);
    }
    nevh__write(w, ";\n");
}

static void name_in_block(nevh__writer *w, const nevh__formula_text *f,
                          nevh__variable kind, size_t k,
                          char name[NEVH__NAME]) {
    const stencil *x = f->data;
    const nevh__planned *term = x->s->term;
    const nevh_term *is = &term->term->decl;
    if (kind == NEVH__T)
        snprintf(name, NEVH__NAME, "ALL(t)");
    else if (kind != NEVH__C)
        snprintf(name, NEVH__NAME, "x%u_%zu", x->block,
                 kind == NEVH__Q ? k : term->nq + k);
    else {
        bool same = true;
        for (size_t lane = 1; lane < LANES; lane++)
            same &= point_in(x, lane)->instance == point_in(x, 0)->instance;
        if (same) {
            snprintf(name, NEVH__NAME, "ALL(N[%zu])",
                     x->s->constants + point_in(x, 0)->instance * is->nc + k);
            return;
        }
        snprintf(name, NEVH__NAME, "(*(const wide *)(N + %zu))", w->count);
        for (size_t lane = 0; lane < LANES; lane++)
            nevh__writer_append(
                w, is->c[point_in(x, lane)->instance * is->nc + k]);
    }
}

static bool write_blocks(nevh__writer *w, stencil *x) {
    for (x->at = 0; x->at < x->count; x->at += LANES) {
        nevh__formula_text f = {.tape = x->s->term->term->decl.params,
                                .wide = true,
                                .variable = name_in_block,
                                .data = x};
        char result[NEVH__NAME];
        x->block = w->formulas;
        for (size_t k = 0; k < x->s->term->nv; k++)
            write_wide(w, x, k);
        if (!nevh__write_value(w, &f, result))
            return false;
        nevh__write(w, "    wide h%u = %s;\n", x->block, result);
    }
    return true;
}

/* One variable of the point. */
static void name_at_point(nevh__writer *w, const nevh__formula_text *f,
                          nevh__variable kind, size_t k,
                          char name[NEVH__NAME]) {
    const stencil *x = f->data;
    const nevh__planned *term = x->s->term;
    size_t all = kind == NEVH__P ? term->nq + k : k;
    if ((kind == NEVH__Q || kind == NEVH__P) && x->points[x->at].k == all)
        snprintf(name, NEVH__NAME, "x%u", x->block);
    else {
        nevh__formula_text at = *f;
        at.data = x->s;
        at.instance = x->points[x->at].instance;
        name_at_state(w, &at, kind, k, name);
    }
}

static bool write_points(nevh__writer *w, stencil *x) {
    bool lanes = nevh__has_lanes(w);
    nevh__formula_text f = {.tape = x->s->term->term->decl.params,
                            .wide = lanes,
                            .scalar = !lanes || x->s->f->portable,
                            .variable = name_at_point,
                            .data = x};
    for (x->at = 0; x->at < x->count; x->at++) {
        const point *at = &x->points[x->at];
        char result[NEVH__NAME];
        x->block = w->formulas;
        char shift[NEVH__NAME];
        nevh__write_number(w, at->shift, shift);
        nevh__write(w, "    %s x%u = %s[%zu] + %s;\n", nevh__number_type(w),
                    x->block, at->k < x->s->term->nq ? "q" : "p",
                    nevh__index(x->s->term, at->instance, at->k), shift);
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
    nevh__write(w, "%s%u", letter, first + (unsigned)(wide ? at / LANES : at));
    if (wide && *letter == 'x')
        nevh__write(w, "_%zu", k);
    if (wide)
        nevh__write(w, "[%zu]", at % LANES);
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
            char weight[NEVH__NAME];
            nevh__write_number(w, one->method->weights[j], weight);
            nevh__write(w, "%s%s * ((", j ? " + " : "", weight);
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
        add_part(s, nevh__index(s->term, one->instance, one->k), name);
    }
}

/* Whether points of differences stand in a vector's lanes. */
static bool side_by_side(const nevh__writer *w, const nevh_field *f) {
    return !f->portable && !w->readable && !nevh__has_lanes(w);
}

static bool write_central(sum *s) {
    size_t slopes = s->term->term->decl.count * s->term->nv;
    stencil x = {.s = s};
    x.points = nevh__array(slopes * 2 * s->f->gradient->offsets, sizeof(point));
    x.slopes = nevh__array(slopes, sizeof(slope));
    bool fine = x.points && x.slopes, wide = side_by_side(s->w, s->f);
    unsigned first = s->w->formulas;
    if (fine) {
        list_points(s, &x);
        fine = (wide ? write_blocks : write_points)(s->w, &x);
        write_slopes(s->w, s, &x, first, wide);
    } else
        s->w->failed = true;
    free(x.points);
    free(x.slopes);
    return fine;
}

static bool is_wanted(const nevh__planned *term, bool kick) {
    return kick ? term->nq : term->np;
}

/* Points of a term's differences by the half's variables. */
static size_t points_of(const nevh_field *f, const nevh__planned *term,
                        bool kick) {
    size_t points = 0;
    for (int i = 0; i < 2; i++) {
        const nevh__pass *pass = &term->pass[i];
        size_t variables =
            kick ? pass->first_p - pass->begin : pass->end - pass->first_p;
        points += 2 * pass->pairs * variables;
    }
    if (!f->gradient->offsets)
        points = f->gradient == nevh_exact ? 0 : kick ? term->nq : term->np;
    return points * term->term->decl.count;
}

void nevh__slope_values(const nevh_field *f, bool kick, uint64_t values[]) {
    for (size_t i = 0; i < f->n_terms; i++)
        values[i] += is_wanted(&f->terms[i], kick)
                         ? points_of(f, &f->terms[i], kick)
                         : 0;
}

static bool is_tape(const nevh_term *is) {
    return is->gradient == nevh__tape_block_gradient;
}

/* How long the text of one half is, in operations; INFINITY: there is none, and
   why. */
static double half_operations(const nevh_field *f, bool kick, bool wide,
                              const char **why) {
    double operations = 0;
    for (size_t i = 0; i < f->n_terms; i++) {
        const nevh__planned *term = &f->terms[i];
        const nevh_term *is = &term->term->decl;
        if (!is_wanted(term, kick))
            continue;
        if (!is_tape(is)) {
            *why = "a term is no formula";
            return INFINITY;
        }
        double times = (double)is->count;
        if (f->gradient != nevh_exact)
            times = (double)points_of(f, term, kick) /
                    (f->gradient->offsets && wide ? LANES : 1);
        operations += times * (double)nevh__tape_length(is->params);
    }
    return operations;
}

static bool fits(nevh__writer *w, const nevh_field *f, size_t calls) {
    bool wide = side_by_side(w, f);
    double most = w->readable ? 10 * MOST_OPERATIONS : MOST_OPERATIONS;
    double kick = half_operations(f, true, wide, &w->refusal);
    double drift = half_operations(f, false, wide, &w->refusal);
    if ((kick > most || drift > most) && !w->refusal)
        w->refusal = "its formulas are too long";
    if (nevh__has_lanes(w) && f->gradient != nevh_exact &&
        !f->gradient->offsets)
        w->refusal = w->stages ? "stages stand side by side"
                               : "orbits stand side by side";
    if (!w->readable && (kick + drift) * (double)calls > MOST_BROADCAST)
        nevh__write(w, "#undef SLOPE\n"
                       "#define SLOPE static __attribute__((noinline))\n");
    return !w->refusal;
}

static void write_sums(const sum *s) {
    for (size_t v = 0; v < s->f->n; v++) {
        nevh__write(s->w, "    slope[%zu] =", v);
        const char *plus = " ";
        for (size_t i = 0; i < s->count; i++)
            if (s->parts[i].target == v) {
                nevh__write(s->w, "%s%s", plus, s->parts[i].name);
                plus = " + ";
            }
        const char *zero = nevh__has_lanes(s->w) ? " ALL(0.0)" : " 0.0";
        nevh__write(s->w, "%s;\n", *plus == ' ' && !plus[1] ? zero : "");
    }
}

static bool write_slope(nevh__writer *w, nevh_field *f, bool kick,
                        const char *name) {
    sum s = {.w = w, .f = f, .kick = kick};
    const char *type = nevh__number_type(w);
    bool fine = true;
    nevh__write_filled(
        w,
        "$1 $2 $3($4$5 t, const $2 *q, const $2 *p,\n"
        "        $2 *slope) {\n    $2 bad = {0};\n",
        (const char *const[]){w->readable ? "static" : "SLOPE", type, name,
                              w->readable ? "" : "const double *N, ",
                              w->stages ? "wide" : "double"});
    if (w->readable)
        nevh__write(w, "    (void)t, (void)q, (void)p;\n");
    for (size_t i = 0; fine && i < f->n_terms; i++) {
        s.term = &f->terms[i];
        const nevh_term *is = &s.term->term->decl;
        if (!is_wanted(s.term, kick))
            continue;
        if (!w->readable)
            s.constants = nevh__writer_share(w, is->count * is->nc, is->c);
        fine = f->gradient == nevh_exact ? write_exact(&s)
               : f->gradient->offsets    ? write_central(&s)
                                         : write_complex(&s);
    }
    write_sums(&s);
    nevh__write(w, "    return bad;\n}\n");
    free(s.parts);
    return fine;
}

bool nevh__write_slopes(nevh__writer *w, nevh_field *f, size_t calls) {
    return fits(w, f, calls) && write_slope(w, f, true, "kick_slope") &&
           write_slope(w, f, false, "drift_slope");
}

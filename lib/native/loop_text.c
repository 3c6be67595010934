/* nevh: derivatives of a term of many instances as C text: a loop, which has the
   formula once.

   Instances are taken in the blocks of the tape, and what they give to a
   variable is added in its order: all instances of a block by the first
   variable, then by the second: the same bits.  What stands in neighbouring
   instances stands side by side in the state but for a few places (the rows of a
   lattice, the end of a ring): a loop goes over pieces between these.  Where
   there are too many, as of pairs of a few bodies, indices are read.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "native/slope_private.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Names in a comment. */
enum { MOST_NAMES = 8 };

/* Names. */

static void name_for_readers(const nevh__term_loop *x, nevh__variable kind,
                             size_t k, char name[NEVH__NAME]) {
    size_t all = kind == NEVH__P ? x->s->term->nq + k : k;
    char half = kind == NEVH__P ? 'p' : 'q';
    if (kind == NEVH__T)
        snprintf(name, NEVH__NAME, "t");
    else if (kind == NEVH__C)
        snprintf(name, NEVH__NAME, "c%u_%zu[i]", x->id, k);
    else if (x->listed)
        snprintf(name, NEVH__NAME, "%c[at%u_%zu[i]]", half, x->id, all);
    else if (!x->step[all])
        snprintf(name, NEVH__NAME, "%c[%zu]", half,
                 nevh__loop_index(x, 0, all));
    else if (nevh__loop_index(x, 0, all) == 0)
        snprintf(name, NEVH__NAME, "%c[i]", half);
    else
        snprintf(name, NEVH__NAME, "%c[%zu + i]", half,
                 nevh__loop_index(x, 0, all));
}

void nevh__loop_name(nevh__writer *w, const nevh__formula_text *f,
                     nevh__variable kind, size_t k, char name[NEVH__NAME]) {
    const nevh__term_loop *x = f->data;
    if (w->readable)
        name_for_readers(x, kind, k, name);
    else if (kind == NEVH__T)
        snprintf(name, NEVH__NAME, "ALL(t)");
    else
        snprintf(name, NEVH__NAME, "%c%u_%zu", kind == NEVH__C ? 'c' : 'x',
                 x->id, kind == NEVH__P ? x->s->term->nq + k : k);
}

/* Loads of a vector of instances. */
static void loop_text_write_loads(const nevh__term_loop *x, size_t constants) {
    nevh__writer *w = x->s->w;
    const nevh_term *is = nevh__loop_term(x);
    for (size_t k = 0; k < x->s->term->nv; k++) {
        const char *half = k < x->s->term->nq ? "q" : "p";
        nevh__write(w, "    wide x%u_%zu = ", x->id, k);
        if (x->listed)
            nevh__write(w, "load_at(%s, g + %zu + i, left);\n", half,
                        k * is->count);
        else if (x->step[k])
            nevh__write(w, "load_row(%s + g[%zu] + (i - g[0]), left);\n", half,
                        k + 1);
        else
            nevh__write(w, "ALL(%s[g[%zu]]);\n", half, k + 1);
    }
    for (size_t k = 0; k < is->nc; k++)
        nevh__write(w, "    wide c%u_%zu = load_row(N + %zu + i, left);\n",
                    x->id, k, constants + k * is->count);
}

/* Adds what a block gives to one variable. */
static void write_add(const nevh__term_loop *x, size_t k) {
    nevh__writer *w = x->s->w;
    size_t fields = x->s->term->nv + 1;
    if (x->listed)
        nevh__write(w,
                    "        add_at(slope, g + %zu + from, row%u_%zu, until - "
                    "from);\n",
                    k * nevh__loop_term(x)->count, x->id, k);
    else if (x->step[k])
        nevh__write(w,
                    "        g = start;\n        EACH_PIECE(g, %zu) "
                    "add_some(slope, g[%zu] + (begin - g[0]), row%u_%zu + "
                    "(begin - from), end - begin, first, past);\n",
                    fields, k + 1, x->id, k);
    else
        nevh__write(w,
                    "        g = start;\n        EACH_PIECE(g, %zu) "
                    "add_all(slope + g[%zu], row%u_%zu + (begin - from), end - "
                    "begin);\n",
                    fields, k + 1, x->id, k);
}

/* Differences are added instance by instance; where a variable's instances
   follow one another that is row by row, the one that is read furthest on
   first. */
static void write_adds_in_turn(const nevh__term_loop *x) {
    nevh__writer *w = x->s->w;
    if (x->listed)
        nevh__write(w, "        for (size i = from; i < until; i++) {\n");
    else
        nevh__write(w,
                    "        g = start;\n        EACH_PIECE(g, %zu)\n"
                    "        for (size i = begin; i < end; i++) {\n",
                    x->s->term->nv + 1);
    for (size_t v = 0; v < x->n_vars; v++) {
        size_t k = x->vars[v];
        if (x->listed)
            nevh__write(w, "    slope[g[%zu + i]]",
                        k * nevh__loop_term(x)->count);
        else
            nevh__write(w, "    slope[g[%zu]%s]", k + 1,
                        x->step[k] ? " + (i - g[0])" : "");
        nevh__write(w, " += row%u_%zu[i - from];\n", x->id, k);
    }
    nevh__write(w, "        }\n");
}

static void write_adds(const nevh__term_loop *x) {
    size_t before = SIZE_MAX, count = x->n_vars;
    if (!x->method || count == 1) {
        for (size_t v = 0; v < count; v++)
            write_add(x, x->vars[v]);
        return;
    }
    if (!nevh__loop_is_local(x)) {
        write_adds_in_turn(x);
        return;
    }
    for (size_t left = count; left > 0;) {
        size_t next = 0;
        for (size_t v = 0; v < count; v++) {
            size_t at = nevh__loop_index(x, 0, x->vars[v]);
            next = at < before && at + 1 > next ? at + 1 : next;
        }
        before = next - 1;
        for (size_t v = 0; v < count; v++)
            if (nevh__loop_index(x, 0, x->vars[v]) == before) {
                write_add(x, x->vars[v]);
                left--;
            }
    }
}

void nevh__write_row(const nevh__term_loop *x, size_t k, const char *name) {
    nevh__write(x->s->w,
                x->in_registers     ? "    wide row%u_%zu = %s;\n"
                : x->s->w->readable ? "    row%u_%zu[i - from] = %s;\n"
                                    : "    *(wide *)(row%u_%zu + (i - from)) = "
                                      "%s;\n",
                x->id, k, name);
}

bool nevh__write_loop_body(const nevh__term_loop *x) {
    nevh__formula_text f = {.tape = nevh__loop_term(x)->params,
                            .lanes = x->s->w->readable ? NULL : &nevh__eight,
                            .variable = nevh__loop_name,
                            .data = x};
    if (x->method)
        return nevh__write_differences(x);
    if (!nevh__write_gradient(x->s->w, &f,
                              x->s->kick ? NEVH__BY_Q : NEVH__BY_P))
        return false;
    for (size_t v = 0; v < x->n_vars; v++) {
        char name[NEVH__NAME];
        nevh__derivative_name(&f, x->s->kick ? NEVH__Q : NEVH__P,
                              x->vars[v] - nevh__first_of(x->s), name);
        nevh__write_row(x, x->vars[v], name);
    }
    return true;
}

/* Blocks of the tape: instances lo to hi. */
static const char block_begins[] =
    "    const place *g = (const place *)(N + $1);\n"
    "    wide bad = {0};\n"
    "    for (size from = lo, until; from < hi; from = until) {\n"
    "        until = (from / $2 + 1) * $2;\n"
    "        until = until < hi ? until : hi;\n";

static void write_rows(const nevh__term_loop *x, size_t size) {
    for (size_t v = 0; v < x->n_vars; v++)
        nevh__write(x->s->w, "        double row%u_%zu[%zu];\n", x->id,
                    x->vars[v], size);
}

/* Instances that have a part in the slopes from `first` to `past`. */
static void write_range(const nevh__term_loop *x) {
    size_t count = nevh__loop_term(x)->count, least, most;
    nevh__write(x->s->w, "    size lo = 0, hi = %zu;\n", count);
    if (!nevh__loop_is_local(x))
        return;
    nevh__loop_bases(x, 0, &least, &most);
    nevh__write(x->s->w,
                "    if (first > %zu) lo = first - %zu;\n"
                "    if (past < %zu) hi = past > %zu ? past - %zu : 0;\n",
                most, most, count + least, least, least);
}

static bool write_block(const nevh__term_loop *x) {
    nevh__writer *w = x->s->w;
    char places[24], block[24];
    snprintf(places, sizeof places, "%zu", w->count);
    snprintf(block, sizeof block, "%zu", x->s->f->capacity);
    nevh__loop_pack(x);
    size_t constants = nevh__loop_constants(x);
    nevh__write(w, "    {\n");
    write_range(x);
    nevh__write_filled(w, block_begins, (const char *const[]){places, block});
    write_rows(x, x->s->f->capacity + NEVH__LANES);
    if (x->listed)
        nevh__write(w, "        const size begin = from, end = until;\n");
    else
        nevh__write(w,
                    "        const place *start = g;\n"
                    "        EACH_PIECE(g, %zu)\n",
                    x->s->term->nv + 1);
    nevh__write(w, "        for (size i = begin; i < end; i += 8) {\n"
                   "    const size left = end - i;\n");
    loop_text_write_loads(x, constants);
    if (!nevh__write_loop_body(x))
        return false;
    nevh__write(w, "        }\n");
    write_adds(x);
    nevh__write(w, "    }\n    rows_bad += sum_of(bad);\n    }\n");
    return true;
}

/* For readers. */

static void write_list(const nevh__term_loop *x, size_t k) {
    nevh__writer *w = x->s->w;
    size_t count = nevh__loop_term(x)->count;
    nevh__write(w, "    static const int at%u_%zu[%zu] = {", x->id, k, count);
    for (size_t i = 0; i < count; i++)
        nevh__write(w, "%s%zu",
                    i == 0   ? ""
                    : i % 12 ? ", "
                             : ",\n        ",
                    nevh__loop_index(x, i, k));
    nevh__write(w, "};\n");
}

static void write_lists(const nevh__term_loop *x) {
    const nevh_term *is = nevh__loop_term(x);
    double *column = nevh__array(is->count, sizeof *column);
    for (size_t k = 0; x->listed && k < x->s->term->nv; k++)
        write_list(x, k);
    for (size_t k = 0; column && k < is->nc; k++) {
        char name[60];
        for (size_t i = 0; i < is->count; i++)
            column[i] = is->c[i * is->nc + k];
        snprintf(name, sizeof name, "    static const double c%u_%zu", x->id,
                 k);
        nevh__write_numbers(x->s->w, name, is->count, column);
    }
    x->s->w->failed |= !column;
    free(column);
}

/* "springs: 999 times, the first of x_2, x_1" */
static void write_comment(const nevh__term_loop *x) {
    nevh__writer *w = x->s->w;
    nevh__write(w, "    /* ");
    nevh__write_word(w, nevh__loop_term(x)->effect ? nevh__loop_term(x)->effect
                                                   : "H");
    nevh__write(w, ": %zu times, the first of ", nevh__loop_term(x)->count);
    for (size_t k = 0; k < x->s->term->nv && k < MOST_NAMES; k++) {
        char name[NEVH__NAME];
        nevh__state_name(w, k >= x->s->term->nq, nevh__loop_index(x, 0, k),
                         name);
        nevh__write(w, "%s%s", k ? ", " : "", name);
    }
    nevh__write(w, "%s */\n", x->s->term->nv > MOST_NAMES ? " ..." : "");
}

static const char block_for_readers[] =
    "    for (size_t from = 0; from < $1; from += $2) {\n"
    "        const size_t until = $1 - from < $2 ? $1 : from + $2;\n";
/* Lines from a place on are indented more deeply. */
static void indent(nevh__writer *w, size_t from, int more) {
    char *text = w->failed ? NULL : nevh__text("%s", w->text + from);
    w->used = text ? from : w->used;
    for (const char *line = text; line && *line;) {
        size_t bytes = strcspn(line, "\n");
        nevh__write(w, "%*s%.*s\n", more, "", (int)bytes, line);
        line += bytes + (line[bytes] != 0);
    }
    w->failed |= !text;
    free(text);
}

/* Differences and pairs in the order of instances, others of variables. */
static void write_adds_for_readers(const nevh__term_loop *x) {
    static const char each[] =
        "        for (size_t i = from; i < until; i++)%s\n";
    nevh__writer *w = x->s->w;
    bool together = (x->method || x->s->term->turned) && x->n_vars > 1;
    if (together)
        nevh__write(w, each, " {");
    for (size_t v = 0; v < x->n_vars; v++) {
        size_t k = x->vars[v];
        char to[NEVH__NAME];
        name_for_readers(x, x->s->kick ? NEVH__Q : NEVH__P,
                         k - nevh__first_of(x->s), to);
        if (!together)
            nevh__write(w, each, "");
        nevh__write(w, "            slope%s += row%u_%zu[i - from];\n", to + 1,
                    x->id, k);
    }
    if (together)
        nevh__write(w, "        }\n");
}

static bool write_for_readers(const nevh__term_loop *x) {
    nevh__writer *w = x->s->w;
    char count[24], block[24];
    size_t size = x->s->f->capacity;
    if (size > nevh__loop_term(x)->count)
        size = nevh__loop_term(x)->count;
    snprintf(count, sizeof count, "%zu", nevh__loop_term(x)->count);
    snprintf(block, sizeof block, "%zu", size);
    write_comment(x);
    write_lists(x);
    nevh__write_steps(x);
    nevh__write_filled(w, block_for_readers,
                       (const char *const[]){count, block});
    write_rows(x, size);
    nevh__write(w, "        for (size_t i = from; i < until; i++) {\n");
    size_t body = w->used;
    if (!nevh__write_loop_body(x))
        return false;
    indent(w, body, 8);
    nevh__write(w, "        }\n");
    write_adds_for_readers(x);
    nevh__write(w, "    }\n");
    return true;
}

void nevh__write_asked(const nevh__slope_text *s) {
    size_t least = SIZE_MAX, most = 0;
    for (size_t i = 0; i < s->term->term->decl.count; i++)
        for (size_t k = nevh__first_of(s); k < nevh__end_of(s); k++) {
            size_t at = nevh__index(s->term, i, k);
            least = at < least ? at : least;
            most = at > most ? at : most;
        }
    nevh__write(s->w, "    if (%zu < past && %zu >= first) {\n", least, most);
}

/* Exact ones, or differences alike. */
static bool write_part(const nevh__term_loop *x) {
    bool pairs = x->s->term->turned && !x->method;
    return x->n_vars == 0 || (x->s->w->readable ? write_for_readers
                              : pairs           ? nevh__write_pairs
                                                : write_block)(x);
}

void nevh__loop_take_pass(nevh__term_loop *x, int i) {
    const nevh__pass *pass = &x->s->term->pass[i];
    size_t begin = x->s->kick ? pass->begin : pass->first_p;
    size_t end = x->s->kick ? pass->first_p : pass->end;
    x->id = x->s->w->formulas;
    x->method = pass->pairs == 1 ? nevh_central2 : x->s->f->gradient;
    x->n_vars = end - begin;
    memcpy(x->vars, x->s->term->vars + begin, x->n_vars * sizeof *x->vars);
}

/* Passes one after the other. */
static bool write_passes(nevh__term_loop *x) {
    bool fine = true;
    for (int i = 0; fine && i < 2; i++) {
        nevh__loop_take_pass(x, i);
        fine = write_part(x);
    }
    return fine;
}

bool nevh__write_loop(const nevh__slope_text *s) {
    nevh__term_loop x;
    bool fine = nevh__loop_init(s, &x);
    if (fine)
        fine = s->f->gradient == nevh_exact ? write_part(&x) : write_passes(&x);
    nevh__loop_clear(&x);
    return fine;
}

bool nevh__write_loop_of_values(nevh__writer *w, const nevh__planned *term) {
    nevh__slope_text s = {.w = w, .term = term};
    nevh__term_loop x;
    nevh__formula_text f = {.tape = term->term->decl.params,
                            .variable = nevh__loop_name,
                            .data = &x};
    char value[NEVH__NAME];
    bool fine = nevh__loop_init(&s, &x);
    if (fine) {
        write_comment(&x);
        write_lists(&x);
        nevh__write(w, "    for (size_t i = 0; i < %zu; i++) {\n",
                    term->term->decl.count);
        size_t body = w->used;
        fine = nevh__write_value(w, &f, value);
        nevh__write(w, "    add(&sum, &lost, %s);\n", fine ? value : "");
        indent(w, body, 4);
        nevh__write(w, "    }\n");
    }
    nevh__loop_clear(&x);
    return fine;
}

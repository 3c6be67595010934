/* nevh: NAME = file("term.c", WHAT, IT, READS) as a term.

   Code is loaded when its effect is first switched on, and stays with the
   scene; a term refers to it, so nothing else changes then.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/code_private.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MOST_READ = 256 }; /* variables of a gradient */

/* One term, and what it hands on; lives as long as the model. */
typedef struct {
    const nevh__code *code;
    size_t nq, np, nc;
} handed;

static double code_term_value(double t, const double q[], const double p[],
                              const double c[], const void *params) {
    const handed *h = params;
    return h->code->value(t, q, p, c);
}

static void take_lane(size_t count, size_t width, size_t lane,
                      const double from[], double to[]) {
    for (size_t k = 0; k < count; k++)
        to[k] = from[k * width + lane];
}

static void put_lane(size_t count, size_t width, size_t lane,
                     const double from[], double to[]) {
    for (size_t k = 0; to && k < count; k++)
        to[k * width + lane] = from[k];
}

static void gradient(size_t width, const double t[], const double q[],
                     const double p[], const double c[], const void *params,
                     double dh_dq[], double dh_dp[]) {
    const handed *h = params;
    double in[3][MOST_READ], out[2][MOST_READ];
    for (size_t lane = 0; lane < width; lane++) {
        take_lane(h->nq, width, lane, q, in[0]);
        take_lane(h->np, width, lane, p, in[1]);
        take_lane(h->nc, width, lane, c, in[2]);
        h->code->gradient(t[lane], in[0], in[1], in[2], out[0], out[1]);
        put_lane(h->nq, width, lane, out[0], dh_dq);
        put_lane(h->np, width, lane, out[1], dh_dp);
    }
}

/* The variables of a term, in the order of the list. */
typedef struct {
    size_t *q, *p, nq, np, nc; /* n each */
    double *c;
    bool time;
} reading;

static bool already(const size_t list[], size_t count, size_t k) {
    for (size_t i = 0; i < count; i++)
        if (list[i] == k)
            return true;
    return false;
}

static bool add_variable(nevh_scene *s, const nevh__piece *name, size_t k,
                         size_t list[], size_t *count) {
    if (already(list, *count, k))
        return nevh__scene_fail(s, NEVH_EINVAL, name, "%s is there twice",
                                name->text);
    list[(*count)++] = k;
    return true;
}

/* The elements of NAME or NAME[k], from and to (not included). */
static bool find_elements(nevh_scene *s, const nevh__scene_model *m,
                          const nevh__piece *name, const nevh__head *head,
                          size_t count, size_t *from, size_t *to) {
    long k = 0;
    *from = 0;
    *to = count ? count : 1;
    if (head->to || head->index || (head->from && !count))
        return nevh__scene_fail(s, NEVH_EINVAL, name,
                                "what is read is written NAME, or NAME[k] of "
                                "an array");
    if (!head->from)
        return true;
    if (!nevh__head_bound(s, m, name, head->from, &k))
        return false;
    if (k < 1 || k > (long)count)
        return nevh__scene_fail(s, NEVH_EINVAL, name, "%s has no element %ld",
                                head->name, k);
    *from = (size_t)k - 1;
    *to = (size_t)k;
    return true;
}

static bool add_values(nevh_scene *s, const nevh__scene_model *m,
                       const nevh__piece *name, const nevh__head *head,
                       size_t from, size_t to, reading *r) {
    const nevh__entry *entry =
        nevh__entry_named(m->names, head->name, &(nevh__meaning){0});
    for (size_t k = from; k < to; k++) {
        if (r->nc == MOST_READ)
            return nevh__scene_fail(s, NEVH_EINVAL, name,
                                    "more than %d numbers are handed on",
                                    MOST_READ);
        r->c[r->nc++] = entry->values[k];
    }
    return true;
}

static bool add_read(nevh_scene *s, const nevh__scene_model *m,
                     const nevh__piece *name, const nevh__head *head,
                     reading *r) {
    size_t count = 0, first = 0, from, to;
    nevh__meaning meaning =
        nevh__names_find(m->names, head->name, &count, &first);
    if (strcmp(name->text, "t") == 0)
        return r->time = true;
    if (meaning != NEVH__COORDINATE && meaning != NEVH__MOMENTUM &&
        meaning != NEVH__PARAMETER)
        return nevh__scene_fail(s, NEVH_EINVAL, name,
                                "there is no coordinate, momentum or parameter "
                                "%s",
                                head->name);
    if (!find_elements(s, m, name, head, count, &from, &to))
        return false;
    if (meaning == NEVH__PARAMETER)
        return add_values(s, m, name, head, from, to, r);
    bool fine = true, momentum = meaning == NEVH__MOMENTUM;
    for (size_t k = from; fine && k < to; k++)
        fine = add_variable(s, name, first + k, momentum ? r->p : r->q,
                            momentum ? &r->np : &r->nq);
    return fine;
}

static bool read_name(nevh_scene *s, const nevh__scene_model *m,
                      const nevh__piece *name, reading *r) {
    nevh__head head;
    nevh__formula_error error = {0};
    if (nevh__head_parse(name->text, &head, &error))
        return nevh__scene_fail_formula(s, name, &error);
    bool fine = add_read(s, m, name, &head, r);
    nevh__head_free(&head);
    return fine;
}

static bool read_all(const nevh__scene_model *m, reading *r) {
    for (size_t k = 0; k < m->n; k++)
        r->q[k] = r->p[k] = k;
    r->nq = r->np = m->n;
    return true;
}

/* , NAME, NAME ... */
static bool read_names(nevh_scene *s, nevh__scene_model *m,
                       const nevh__piece *after, reading *r) {
    size_t count;
    nevh__piece rest;
    size_t from = (size_t)(after->at - after->line->text);
    if (!after->text[0])
        return read_all(m, r);
    if (after->text[0] != ',')
        return nevh__scene_fail(s, NEVH_EINVAL, after,
                                "after the file comes \",\" and what it "
                                "reads, or \")\"");
    if (!nevh__piece_take(s, &m->pool, after->line, from + 1,
                          from + strlen(after->text), &rest))
        return false;
    nevh__piece *names = nevh__piece_list(s, &m->pool, &rest, &count);
    for (size_t i = 0; names && i < count; i++)
        if (!read_name(s, m, &names[i], r))
            return false;
    return names;
}

/* file("NAME" AFTER): the name and what follows it up to the last ")". */
static bool code_term_cut(nevh_scene *s, nevh__scene_model *m,
                          const nevh__piece *value, nevh__piece *name,
                          nevh__piece *after) {
    size_t at = (size_t)(value->at - value->line->text),
           bytes = strlen(value->text);
    const char *open = strchr(value->text, '"');
    const char *shut = open ? strchr(open + 1, '"') : NULL;
    bool first = open && strspn(value->text + 5, " \t") ==
                             (size_t)(open - value->text - 5);
    if (!first || !shut || shut == open + 1 || value->text[bytes - 1] != ')')
        return nevh__scene_fail(s, NEVH_EINVAL, value,
                                "code is written file(\"NAME.c\"), or "
                                "file(\"NAME.c\", WHAT, IT, READS)");
    return nevh__piece_take(s, &m->pool, value->line,
                            at + (size_t)(open - value->text) + 1,
                            at + (size_t)(shut - value->text), name) &&
           nevh__piece_take(s, &m->pool, value->line,
                            at + (size_t)(shut - value->text) + 1,
                            at + bytes - 1, after);
}

/* The path of a file beside the scene. */
static char *path_of(const nevh_scene *s, const char *name) {
    const char *slash = strrchr(s->name, '/');
    if (name[0] == '/' || !slash)
        return nevh__text("%s", name);
    return nevh__text("%.*s/%s", (int)(slash - s->name), s->name, name);
}

static bool digest_file(nevh_scene *s, const nevh__piece *name,
                        const char *path, uint64_t *digest) {
    struct stat found;
    bool there = stat(path, &found) == 0;
    if (there && !S_ISREG(found.st_mode))
        return nevh__scene_fail(s, NEVH_EINVAL, name, "%s is no regular file",
                                path);
    FILE *file = there ? fopen(path, "re") : NULL;
    if (!file)
        return nevh__scene_fail(s, NEVH_EINVAL, name, "%s cannot be read: %s",
                                path, strerror(errno));
    *digest = nevh__digest_begin;
    for (int c; (c = getc(file)) != EOF;)
        *digest = nevh__digest_byte(*digest, (unsigned char)c);
    fclose(file);
    return true;
}

static bool code_term_load(nevh_scene *s, const nevh__piece *name,
                           nevh__code *code) {
    const char *what = NULL;
    if (!s->allow_code)
        return nevh__scene_fail(s, NEVH_EINVAL, name,
                                "%s is code, which is compiled and run only "
                                "where that is allowed: --allow-code",
                                name->text);
    char *path = path_of(s, name->text);
    if (!path)
        return nevh__scene_no_memory(s);
    uint64_t digest = 0;
    if (digest_file(s, name, path, &digest) &&
        !nevh__code_load(path, code, &what)) {
        char *text = nevh__text(what, name->text);
        nevh__scene_fail(s, NEVH_EINVAL, name, "%s", text ? text : "");
        if (code->output)
            nevh__scene_quote(s, code->output);
        nevh__code_unload(code);
        free(text);
    }
    if (code->value)
        code->digest = digest;
    free(path);
    return code->value;
}

/* The code of a statement, loaded or not; NULL when memory is out. */
static nevh__code *code_of(nevh_scene *s, const nevh__statement *statement) {
    size_t at = (size_t)(statement - s->statements);
    if (!s->codes)
        s->codes = nevh__pool_take(&s->pool, s->n_statements, sizeof *s->codes);
    if (s->codes && !s->codes[at])
        s->codes[at] = nevh__pool_take(&s->pool, 1, sizeof **s->codes);
    return s->codes ? s->codes[at] : NULL;
}

static bool code_term_reserve(nevh_scene *s, nevh__scene_model *m, reading *r) {
    r->q = nevh__pool_take(&m->pool, m->n, sizeof *r->q);
    r->p = nevh__pool_take(&m->pool, m->n, sizeof *r->p);
    r->c = nevh__pool_take(&m->pool, MOST_READ, sizeof *r->c);
    return (r->q && r->p && r->c) || nevh__scene_no_memory(s);
}

static bool has_gradient(const handed *h) {
    return h->code->gradient && h->nq <= MOST_READ && h->np <= MOST_READ;
}

static bool code_term_add(nevh_scene *s, nevh__scene_model *m,
                          const char *effect, const reading *r,
                          const nevh__code *code) {
    handed *h = nevh__pool_take(&m->pool, 1, sizeof *h);
    if (!h)
        return nevh__scene_no_memory(s);
    *h = (handed){code, r->nq, r->np, r->nc};
    nevh_term term = {.effect = effect,
                      .nq = r->nq,
                      .np = r->np,
                      .nc = r->nc,
                      .q = r->q,
                      .p = r->p,
                      .c = r->nc ? r->c : NULL,
                      .time = r->time,
                      .value = code_term_value,
                      .gradient = has_gradient(h) ? gradient : NULL,
                      .params = h};
    return !nevh_system_add(m->system, &term) || nevh__scene_no_memory(s);
}

bool nevh__is_code(const nevh__statement *statement) {
    return statement->section == NEVH__EFFECTS &&
           strncmp(statement->value.text, "file(", 5) == 0;
}

bool nevh__model_code(nevh_scene *s, nevh__scene_model *m,
                      const nevh__statement *statement) {
    nevh__piece name, after;
    reading r = {0};
    nevh__code *code = code_of(s, statement);
    if (!code)
        return nevh__scene_no_memory(s);
    if (!code_term_cut(s, m, &statement->value, &name, &after) ||
        !code_term_reserve(s, m, &r) || !read_names(s, m, &after, &r))
        return false;
    bool on = nevh__scene_effect(s, statement->head.name)->on;
    return (!on || code->value || code_term_load(s, &name, code)) &&
           code_term_add(s, m, statement->head.name, &r, code);
}

/* The terms that waited for it get its gradient. */
static void announce(nevh__scene_model *m, const nevh__code *code) {
    for (size_t i = 0; i < m->system->n_terms; i++) {
        nevh_term *decl = &m->system->terms[i]->decl;
        if (decl->value != code_term_value)
            continue;
        const handed *h = decl->params;
        if (h->code == code && has_gradient(h))
            decl->gradient = gradient;
    }
}

static bool load_statement(nevh_scene *s, nevh__scene_model *m,
                           const nevh__statement *statement) {
    nevh__piece name, after;
    nevh__code *code = code_of(s, statement);
    if (!code)
        return nevh__scene_no_memory(s);
    if (code->value)
        return true;
    if (!code_term_cut(s, m, &statement->value, &name, &after) ||
        !code_term_load(s, &name, code))
        return false;
    announce(m, code);
    return true;
}

char *nevh_scene_code_path(const nevh_scene *s, size_t i) {
    for (size_t k = 0; s && k < s->n_statements; k++) {
        const char *open = nevh__is_code(&s->statements[k])
                               ? strchr(s->statements[k].value.text, '"')
                               : NULL;
        const char *shut = open ? strchr(open + 1, '"') : NULL;
        if (!shut || i-- > 0)
            continue;
        char *name = nevh__text("%.*s", (int)(shut - open) - 1, open + 1);
        char *path = name ? path_of(s, name) : NULL;
        free(name);
        return path;
    }
    return NULL;
}

bool nevh__scene_load_code(nevh_scene *s, const char *effect) {
    for (size_t i = 0; i < s->n_statements; i++)
        if (nevh__is_code(&s->statements[i]) &&
            strcmp(s->statements[i].head.name, effect) == 0 &&
            !load_statement(s, s->model, &s->statements[i]))
            return false;
    return true;
}

uint64_t nevh__scene_digest_code(const nevh_scene *s, uint64_t digest) {
    for (size_t i = 0; s->codes && i < s->n_statements; i++)
        for (size_t k = 0; s->codes[i] && k < sizeof s->codes[i]->digest; k++)
            digest = nevh__digest_byte(
                digest, (unsigned char)(s->codes[i]->digest >> 8 * k));
    return digest;
}

void nevh__scene_unload_code(nevh_scene *s) {
    for (size_t i = 0; s->codes && i < s->n_statements; i++)
        if (s->codes[i])
            nevh__code_unload(s->codes[i]);
}

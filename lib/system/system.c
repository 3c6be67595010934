/* nevh: a system is a list of terms, grouped into effects.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static nevh__effect *effect_named(const nevh_system *s, const char *name) {
    size_t i = nevh__register_find(&s->effect_names, name);
    return i < s->n_effects ? &s->effects[i] : NULL;
}

static bool is_term(const nevh_system *s, const char *name) {
    return nevh__register_find(&s->term_names, name) < s->n_terms;
}

static void term_free(nevh__term_entry *term) {
    if (!term)
        return;
    free((char *)term->decl.name);
    free((size_t *)term->decl.q);
    free((size_t *)term->decl.p);
    free((double *)term->decl.c);
    free(term);
}

/* Checks one table of indices; `read` is n flags, all false before and after.
   What is at fault goes to the report. */
static int check_indices(nevh_system *s, const nevh_term *term, char kind,
                         const size_t *indices, size_t each, bool *read) {
    if (each > s->n)
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "effect %s: a term reads %zu of %c, but the system "
                          "has %zu degrees of freedom",
                          term->effect, each, kind, s->n);
    for (size_t i = 0; indices && i < term->count; i++) {
        const size_t *row = indices + i * each;
        char name[NEVH__VARIABLE];
        size_t k = 0;
        while (k < each && row[k] < s->n && !read[row[k]])
            read[row[k++]] = true;
        for (size_t done = 0; done < k; done++)
            read[row[done]] = false;
        if (k < each)
            return nevh__fail(
                &s->report, NEVH_EINVAL,
                "effect %s, instance %zu: %s %s (%zu degrees of freedom, "
                "counted from 0)",
                term->effect, i,
                nevh__variable_name(s, kind == 'p', row[k], name),
                row[k] < s->n ? "is read twice" : "is out of range", s->n);
    }
    return NEVH_OK;
}

static int check_tables(nevh_system *s, const nevh_term *term) {
    const size_t columns[] = {term->nq, term->np, term->nc};
    for (int i = 0; i < 3; i++)
        if (columns[i] && term->count > SIZE_MAX / sizeof(double) / columns[i])
            return nevh__fail(&s->report, NEVH_EINVAL,
                              "effect %s: %zu instances are too many",
                              term->effect, term->count);
    bool *read = nevh__array(s->n, sizeof *read);
    if (!read)
        return nevh__no_memory(&s->report);
    int status = check_indices(s, term, 'q', term->q, term->nq, read);
    if (!status)
        status = check_indices(s, term, 'p', term->p, term->np, read);
    free(read);
    return status;
}

/* `term` with count filled in. */
static int check_term(nevh_system *s, const nevh_term *term) {
    if (!term->effect || !term->effect[0])
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "a term needs the name of its effect");
    if (!term->value && !term->block)
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "effect %s: a term needs a value or block function",
                          term->effect);
    if (term->point_gradient && !term->gradient)
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "effect %s: a point gradient needs a gradient beside "
                          "it, for blocks",
                          term->effect);
    if (term->nc && !term->c)
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "effect %s: nc is %zu but c is NULL", term->effect,
                          term->nc);
    if (term->name && (!term->name[0] || is_term(s, term->name)))
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "effect %s: the term name \"%s\" is %s", term->effect,
                          term->name, term->name[0] ? "used twice" : "empty");
    return check_tables(s, term);
}

/* count x each indices; 0 ... each-1 for every instance where given none. */
static size_t *copy_indices(const size_t *from, size_t count, size_t each) {
    if (from)
        return nevh__copy(from, count * each, sizeof *from);
    size_t *to = nevh__array(count * each, sizeof *to);
    for (size_t i = 0; to && i < count * each; i++)
        to[i] = i % each;
    return to;
}

/* The effect's name, or with the first number that makes it unique.  Names stay
   used, so that a search goes on where the last one of the effect ended. */
static char *free_name(const nevh_system *s, const char *effect) {
    nevh__effect *known = effect_named(s, effect);
    size_t k = known ? known->number : 0;
    char *name = k ? nevh__text("%s %zu", effect, k) : nevh__text("%s", effect);
    while (name && is_term(s, name)) {
        free(name);
        k = k ? k + 1 : 2;
        name = nevh__text("%s %zu", effect, k);
    }
    if (known && name)
        known->number = k;
    return name;
}

static nevh__term_entry *copy_term(const nevh_system *s,
                                   const nevh_term *from) {
    nevh__term_entry *term = nevh__array(1, sizeof *term);
    if (!term)
        return NULL;
    term->decl = *from;
    term->decl.effect = NULL;
    term->decl.name =
        from->name ? nevh__text("%s", from->name) : free_name(s, from->effect);
    term->decl.q = copy_indices(from->q, from->count, from->nq);
    term->decl.p = copy_indices(from->p, from->count, from->np);
    term->decl.c = nevh__copy(from->c, from->count * from->nc, sizeof *from->c);
    if (term->decl.name && term->decl.q && term->decl.p && term->decl.c)
        return term;
    term_free(term);
    return NULL;
}

size_t nevh__effect_index(nevh_system *s, const char *name) {
    nevh__effect *effect = effect_named(s, name);
    if (effect)
        return (size_t)(effect - s->effects);
    nevh__effect *effects =
        nevh__grow(s->effects, s->n_effects + 1, sizeof *effects);
    if (!effects)
        return SIZE_MAX;
    s->effects = effects;
    char *copy = nevh__register_reserve(&s->effect_names)
                     ? nevh__text("%s", name)
                     : NULL;
    if (!copy)
        return SIZE_MAX;
    effects[s->n_effects] = (nevh__effect){.name = copy, .on = true};
    nevh__register_put(&s->effect_names, copy, s->n_effects);
    return s->n_effects++;
}

/* Makes room first, so that the system is as before when memory is out. */
static int system_append(nevh_system *s, const nevh_term *from) {
    nevh__term_entry **terms =
        nevh__grow(s->terms, s->n_terms + 1, sizeof(nevh__term_entry *));
    if (!terms)
        return nevh__no_memory(&s->report);
    s->terms = terms;
    nevh__term_entry *term =
        nevh__register_reserve(&s->term_names) ? copy_term(s, from) : NULL;
    size_t effect = term ? nevh__effect_index(s, from->effect) : SIZE_MAX;
    if (effect == SIZE_MAX) {
        term_free(term);
        return nevh__no_memory(&s->report);
    }
    term->effect = effect;
    term->decl.effect = s->effects[effect].name;
    nevh__register_put(&s->term_names, term->decl.name, s->n_terms);
    s->terms[s->n_terms++] = term;
    s->revision++;
    return NEVH_OK;
}

int nevh_system_add(nevh_system *s, const nevh_term *from) {
    if (nevh_system_status(s))
        return nevh_system_status(s);
    if (!from)
        return nevh__fail(&s->report, NEVH_EINVAL, "the term is NULL");
    nevh_term term = *from;
    if (!term.count)
        term.count = 1;
    int status = check_term(s, &term);
    return status ? status : system_append(s, &term);
}

/* NULL, with a status: there is none, or the system has failed. */
static nevh__effect *effect_to_change(nevh_system *s, const char *name) {
    if (nevh_system_status(s))
        return NULL;
    nevh__effect *effect = effect_named(s, name);
    if (!effect)
        nevh__fail(&s->report, NEVH_EINVAL, "there is no effect \"%s\"",
                   name ? name : "");
    return effect;
}

int nevh_system_enable(nevh_system *s, const char *name, bool on) {
    nevh__effect *effect = effect_to_change(s, name);
    if (!effect)
        return nevh_system_status(s);
    if (effect->on != on)
        s->revision++;
    effect->on = on;
    return NEVH_OK;
}

int nevh_system_set_speed(nevh_system *s, const char *name, nevh_speed speed) {
    nevh__effect *effect = effect_to_change(s, name);
    if (!effect)
        return nevh_system_status(s);
    if (effect->speed != speed)
        s->revision++;
    effect->speed = speed;
    return NEVH_OK;
}

nevh_system *nevh_system_new(size_t n) {
    nevh_system *s = nevh__array(1, sizeof *s);
    if (!s)
        return NULL;
    s->n = n;
    if (n == 0 || n > SIZE_MAX / sizeof(double) / 4)
        nevh__fail(&s->report, NEVH_EINVAL,
                   "a system needs between 1 and %zu degrees of freedom",
                   SIZE_MAX / sizeof(double) / 4);
    return s;
}

/* params is the system itself, which knows the user's function. */
static double whole_value(double t, const double q[], const double p[],
                          const double c[], const void *params) {
    (void)c;
    const nevh_system *s = params;
    return s->whole(t, q, p, s->whole_params);
}

nevh_system *nevh_system_from(size_t n, nevh_value_fn H, const void *params) {
    nevh_system *s = nevh_system_new(n);
    if (!s || s->report.status)
        return s;
    s->whole = H;
    s->whole_params = params;
    if (!H)
        nevh__fail(&s->report, NEVH_EINVAL, "the function H is NULL");
    else
        nevh_system_add(s, &(nevh_term){.effect = "H",
                                        .nq = n,
                                        .np = n,
                                        .time = true,
                                        .value = whole_value,
                                        .params = s});
    return s;
}

void nevh_system_free(nevh_system *s) {
    if (!s)
        return;
    for (size_t i = 0; i < s->n_terms; i++)
        term_free(s->terms[i]);
    for (size_t i = 0; i < s->n_effects; i++)
        free(s->effects[i].name);
    for (size_t i = 0; i < s->n_frictions; i++)
        free(s->frictions[i].rates);
    free(s->terms);
    free(s->effects);
    free(s->term_names.entries);
    free(s->effect_names.entries);
    free(s->frictions);
    free(s);
}

const char *nevh__variable_name(const nevh_system *s, bool momentum, size_t i,
                                char text[NEVH__VARIABLE]) {
    if (s->names && i < s->n)
        snprintf(text, NEVH__VARIABLE, "%s%s", momentum ? "p_" : "",
                 s->names[i]);
    else
        snprintf(text, NEVH__VARIABLE, "%c[%zu]", momentum ? 'p' : 'q', i);
    return text;
}

NEVH__REPORTS(system)

size_t nevh_system_dof(const nevh_system *s) {
    return s ? s->n : 0;
}

size_t nevh_system_effect_count(const nevh_system *s) {
    return s ? s->n_effects : 0;
}

const char *nevh_system_effect_name(const nevh_system *s, size_t i) {
    if (!s)
        return "";
    return i < s->n_effects ? s->effects[i].name : NULL;
}

bool nevh_system_effect_on(const nevh_system *s, const char *name) {
    if (!s)
        return false;
    const nevh__effect *effect = effect_named(s, name);
    return effect && effect->on;
}

unsigned nevh_system_traits(const nevh_system *s) {
    if (!s)
        return 0;
    unsigned traits = NEVH_SEPARABLE | NEVH_AUTONOMOUS;
    for (size_t i = 0; i < s->n_terms; i++) {
        const nevh_term *term = &s->terms[i]->decl;
        if (!nevh__term_on(s, s->terms[i]))
            continue;
        if (term->nq && term->np)
            traits &= ~(unsigned)NEVH_SEPARABLE;
        if (term->time)
            traits &= ~(unsigned)NEVH_AUTONOMOUS;
    }
    return traits;
}

/* nevh: what the names in formulas mean.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

nevh__names *nevh__names_new(void) {
    return nevh__array(1, sizeof(nevh__names));
}

static void entry_free(nevh__entry *entry) {
    free(entry->name);
    free(entry->values);
    free(entry->wide);
    nevh__tree_free(entry->tree);
}

void nevh__names_exact(nevh__names *names) {
    names->exact = true;
}

void nevh__names_away(nevh__names *names) {
    names->exact = names->away = true;
}

void nevh__names_free(nevh__names *names) {
    for (size_t i = 0; names && i < names->count; i++)
        entry_free(&names->entries[i]);
    if (names)
        free(names->entries);
    free(names);
}

static size_t chain_of(const char *name) {
    uint32_t digest = 0x811C9DC5u; /* FNV-1a */
    for (; *name; name++)
        digest = (digest ^ (unsigned char)*name) * 0x01000193u;
    return digest % NEVH__CHAINS;
}

static nevh__entry *entry_exactly(const nevh__names *names, const char *name) {
    for (size_t i = names->chain[chain_of(name)]; i;
         i = names->entries[i - 1].next)
        if (strcmp(names->entries[i - 1].name, name) == 0)
            return &names->entries[i - 1];
    return NULL;
}

const nevh__entry *nevh__entry_named(const nevh__names *names, const char *name,
                                     nevh__meaning *meaning) {
    const nevh__entry *entry = entry_exactly(names, name);
    bool prefixed = !entry && (name[0] == 'p' || name[0] == 'v') &&
                    name[1] == '_' && name[2];
    if (prefixed)
        entry = entry_exactly(names, name + 2);
    if (prefixed && entry && entry->meaning != NEVH__COORDINATE)
        entry = NULL;
    *meaning = !entry           ? NEVH__UNKNOWN
               : !prefixed      ? entry->meaning
               : name[0] == 'p' ? NEVH__MOMENTUM
                                : NEVH__VELOCITY;
    return entry;
}

nevh__meaning nevh__names_find(const nevh__names *names, const char *name,
                               size_t *count, size_t *first) {
    nevh__meaning meaning;
    const nevh__entry *entry = nevh__entry_named(names, name, &meaning);
    if (entry && count)
        *count = entry->count;
    if (entry && first)
        *first = entry->first;
    return meaning;
}

size_t nevh__names_extent(const nevh__names *names) {
    size_t extent = 1;
    for (size_t i = 0; i < names->count; i++) {
        const nevh__entry *entry = &names->entries[i];
        size_t end = entry->first + (entry->count ? entry->count : 1);
        extent = end > extent ? end : extent;
    }
    return extent;
}

/* True if the text is one name, as formulas spell it. */
static bool is_word(const char *name) {
    nevh__formula_error ignored = {0};
    nevh__scanner scanner = {name, 1, &ignored};
    nevh__token token = nevh__scan(&scanner);
    return token.kind == NEVH__WORD && token.at == name && !name[token.bytes] &&
           token.bytes + 2 <= NEVH__NAME_LENGTH;
}

static bool names_refuse(const char *name, nevh__formula_error *error,
                         const char *format) {
    char part[NEVH__NAME_LENGTH + 1] = "";
    strncat(part, name, NEVH__NAME_LENGTH);
    return nevh__formula_fail(error, NEVH_EINVAL, 1, nevh__characters(name),
                              format, part, part + 2);
}

/* Fails if the name cannot be given a meaning. */
static bool check_name(const nevh__names *names, const char *name,
                       nevh__formula_error *error) {
    if (!is_word(name))
        return names_refuse(name, error,
                            "\"%s\" is no name: a letter, then letters, digits "
                            "and _");
    if (strcmp(name, "t") == 0)
        return names_refuse(name, error, "%s is the time");
    if (strcmp(name, "pi") == 0)
        return names_refuse(name, error, "%s is a constant");
    if (strcmp(name, "sum") == 0 ||
        nevh__function_named(name, strlen(name)) != NEVH__OPERATION_COUNT)
        return names_refuse(name, error, "%s is a function");
    if (strncmp(name, "p_", 2) == 0)
        return names_refuse(name, error,
                            "%s would be the momentum of a coordinate %s");
    if (strncmp(name, "v_", 2) == 0)
        return names_refuse(name, error,
                            "%s would be the velocity of a coordinate %s");
    if (entry_exactly(names, name))
        return names_refuse(name, error, "the name %s is taken");
    return true;
}

/* A new entry of that name, or NULL. */
static nevh__entry *new_entry(nevh__names *names, const char *name,
                              nevh__formula_error *error) {
    *error = (nevh__formula_error){0};
    if (!check_name(names, name, error))
        return NULL;
    nevh__entry *entries =
        nevh__grow(names->entries, names->count + 1, sizeof *entries);
    char *copy = nevh__text("%s", name);
    if (entries)
        names->entries = entries;
    if (!entries || !copy) {
        free(copy);
        nevh__formula_no_memory(error);
        return NULL;
    }
    size_t *chain = &names->chain[chain_of(name)];
    entries[names->count] = (nevh__entry){.name = copy, .next = *chain};
    *chain = names->count + 1;
    return &entries[names->count++];
}

static void drop_last_entry(nevh__names *names) {
    nevh__entry *last = &names->entries[--names->count];
    names->chain[chain_of(last->name)] = last->next;
    free(last->name);
}

int nevh__names_add_wide(nevh__names *names, const char *name, size_t count,
                         const double values[], const nevh__rounded wide[],
                         nevh__formula_error *error) {
    size_t n = count ? count : 1;
    double *copy = nevh__copy(values, n, sizeof *values);
    nevh__rounded *wide_copy = wide ? nevh__copy(wide, n, sizeof *wide) : NULL;
    bool copied = copy && (!wide || wide_copy);
    nevh__entry *entry = new_entry(names, name, error);
    if (!entry || !copied) {
        if (entry)
            drop_last_entry(names);
        free(copy);
        free(wide_copy);
        if (!copied)
            nevh__formula_no_memory(error);
        return error->status;
    }
    entry->meaning = NEVH__PARAMETER;
    entry->count = count;
    entry->values = copy;
    entry->wide = wide_copy;
    return NEVH_OK;
}

int nevh__names_add_parameter(nevh__names *names, const char *name,
                              size_t count, const double values[],
                              nevh__formula_error *error) {
    return nevh__names_add_wide(names, name, count, values, NULL, error);
}

int nevh__names_add_coordinate(nevh__names *names, const char *name,
                               size_t count, size_t first,
                               nevh__formula_error *error) {
    nevh__entry *entry = new_entry(names, name, error);
    if (!entry)
        return error->status;
    entry->meaning = NEVH__COORDINATE;
    entry->count = count;
    entry->first = first;
    return NEVH_OK;
}

int nevh__names_add_definition(nevh__names *names, const char *name,
                               nevh__tree *tree, nevh__formula_error *error) {
    nevh__entry *entry = new_entry(names, name, error);
    if (!entry) {
        nevh__tree_free(tree);
        return error->status;
    }
    entry->meaning = NEVH__DEFINITION;
    entry->tree = tree;
    return NEVH_OK;
}

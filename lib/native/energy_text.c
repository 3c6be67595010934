/* nevh: H and names of variables as C text for readers.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/slope_private.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Words that have another meaning among formulas, other than names that begin with
   one or two letters and a digit. */
static const char *const words[] = {
    "t",        "q",        "p",        "y",      "slope",      "bad",
    "h",        "sum",      "lost",     "most",   "noise",      "scale",
    "auto",     "break",    "case",     "char",   "const",      "continue",
    "default",  "do",       "double",   "else",   "enum",       "extern",
    "float",    "for",      "goto",     "if",     "inline",     "int",
    "long",     "register", "restrict", "return", "short",      "signed",
    "sizeof",   "static",   "struct",   "switch", "typedef",    "union",
    "unsigned", "void",     "volatile", "while",  "asm",        "typeof",
    "true",     "false",    "bool",     "linux",  "unix",       "add",
    "choose",   "real_min", "real_max", "sign",   "chain",      "mod",
    "fabs",     "floor",    "rint",     "fmod",   "sqrt",       "cbrt",
    "sin",      "cos",      "tan",      "asin",   "acos",       "atan",
    "atan2",    "sinh",     "cosh",     "tanh",   "asinh",      "acosh",
    "atanh",    "exp",      "log",      "log10",  "pow",        "hypot",
    "DOF",      "EACH",     "NULL",     "NAN",    "INFINITY",   "LANES",
    "STAGES",   "ROW",      "FIRST",    "NOISY",  "NEWTON",     "APART",
    "STRIDE",   "FEW",      "UNKNOWN",  "MEMORY", "W",          "T",
    "stdin",    "stdout",   "stderr",   "EOF",    "PARTITIONED"};

/* As generated names do. */
static bool is_generated(const char *name) {
    size_t letters = 0;
    while (letters < 3 && isalpha((unsigned char)name[letters]))
        letters++;
    return letters > 0 && letters < 3 && isdigit((unsigned char)name[letters]);
}

static bool is_taken(const char *name) {
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcmp(name, words[i]) == 0)
            return true;
    return is_generated(name) || strstr(name, "__") ||
           strncmp(name, "STAGE_", strlen("STAGE_")) == 0 ||
           strncmp(name, "one_", strlen("one_")) == 0 ||
           strncmp(name, "ONE_", strlen("ONE_")) == 0;
}

/* x[3] is x_3.  "": the name has characters that names in C have not, or that of
   the library, which programs have nowhere. */
static void name_variable(const char *prefix, const char *from,
                          char name[NEVH__NAME]) {
    size_t used = (size_t)snprintf(name, NEVH__NAME, "%s", prefix);
    for (; *from && used + 2 < NEVH__NAME; from++) {
        if (*from == ']' && !from[1])
            continue;
        if (!(isalnum((unsigned char)*from) && (unsigned char)*from < 128) &&
            *from != '_' && *from != '[')
            break;
        name[used++] = *from == '[' ? '_' : *from;
    }
    name[used] = '\0';
    if (*from || !isalpha((unsigned char)name[0]) || strstr(name, "nevh"))
        name[0] = '\0';
    else if (is_taken(name))
        strcat(name, "_");
}

static int by_name(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Keeps one of equal names. */
static bool drop_twins(size_t count, char names[][NEVH__NAME]) {
    char **sorted = nevh__array(count, sizeof *sorted);
    if (!sorted)
        return false;
    for (size_t i = 0; i < count; i++)
        sorted[i] = names[i];
    qsort(sorted, count, sizeof *sorted, by_name);
    for (size_t i = count; i-- > 1;)
        if (strcmp(sorted[i - 1], sorted[i]) == 0)
            sorted[i][0] = '\0';
    free(sorted);
    return true;
}

bool nevh__writer_name(nevh__writer *w, size_t n, const char *const names[]) {
    w->n = n;
    w->names = nevh__array(2 * n, sizeof *w->names);
    if (!w->names)
        return false;
    for (size_t k = 0; k < n; k++) {
        name_variable("", names[k], w->names[k]);
        name_variable("p_", names[k], w->names[n + k]);
    }
    return drop_twins(2 * n, w->names);
}

void nevh__state_name(const nevh__writer *w, bool momentum, size_t k,
                      char name[NEVH__NAME]) {
    const char *own = w->names ? w->names[momentum ? w->n + k : k] : "";
    if (*own)
        snprintf(name, NEVH__NAME, "%s", own);
    else
        snprintf(name, NEVH__NAME, "%s[%zu]", momentum ? "p" : "q", k);
}

static void mark_read(const nevh__writer *w, const nevh__planned *term,
                      bool read[]) {
    for (size_t i = 0; i < term->term->decl.count; i++)
        for (size_t k = 0; k < term->nv; k++)
            read[(k < term->nq ? 0 : w->n) + nevh__index(term, i, k)] = true;
}

void nevh__write_state_names(nevh__writer *w, const nevh_field *f) {
    bool *read = w->names ? nevh__array(2 * w->n, sizeof *read) : NULL;
    w->failed |= w->names && !read;
    for (size_t i = 0; read && i < f->n_terms; i++)
        if (!w->loops || !nevh__is_loop(&f->terms[i]))
            mark_read(w, &f->terms[i], read);
    for (size_t k = 0; read && k < 2 * w->n; k++)
        if (read[k] && *w->names[k])
            nevh__write(w, "    double %s = %s[%zu];\n", w->names[k],
                        k < w->n ? "q" : "p", k % w->n);
    free(read);
}

void nevh__write_word(nevh__writer *w, const char *word) {
    for (; *word; word++) {
        unsigned char c = (unsigned char)*word;
        bool plain = isalnum(c) || c == '_' || c == '[' || c == ']' || c > 127;
        nevh__write(w, "%c", plain ? c : '-');
    }
}

void nevh__write_effect(nevh__writer *w, const nevh_term *is) {
    nevh__write(w, "    /* ");
    nevh__write_word(w, is->effect ? is->effect : "H");
    nevh__write(w, " */\n");
}

static void energy_text_name_at_state(nevh__writer *w,
                                      const nevh__formula_text *f,
                                      nevh__variable kind, size_t k,
                                      char name[NEVH__NAME]) {
    const nevh_term *is = f->data;
    if (kind == NEVH__T)
        snprintf(name, NEVH__NAME, "t");
    else if (kind == NEVH__C)
        nevh__number_text(is->c[f->instance * is->nc + k], name);
    else
        nevh__state_name(w, kind == NEVH__P,
                         kind == NEVH__P ? is->p[f->instance * is->np + k]
                                         : is->q[f->instance * is->nq + k],
                         name);
}

static const char add[] =
    "/* Adds x, and what rounding loses of that to lost [A. Neumaier, ZAMM 54\n"
    "   (1974) 39]. */\n"
    "static void add(double *sum, double *lost, double x) {\n"
    "    double next = *sum + x;\n"
    "    *lost += fabs(*sum) >= fabs(x) ? (*sum - next) + x\n"
    "                                   : (x - next) + *sum;\n"
    "    *sum = next;\n}\n\n";

static bool energy_text_write_term(nevh__writer *w, const nevh_term *is) {
    nevh__formula_text formula = {
        .tape = is->params, .variable = energy_text_name_at_state, .data = is};
    nevh__write_effect(w, is);
    for (size_t i = 0; i < is->count; i++) {
        char value[NEVH__NAME];
        formula.instance = i;
        if (!nevh__write_value(w, &formula, value))
            return false;
        nevh__write(w, "    add(&sum, &lost, %s);\n", value);
    }
    return true;
}

bool nevh__write_energy(nevh__writer *w, const nevh_field *f) {
    bool fine = true;
    nevh__write(w,
                "%s/* H, the sum of all terms. */\n"
                "static double energy(double t, const double *q, const double "
                "*p) {\n"
                "    double sum = 0, lost = 0;\n"
                "    (void)t, (void)q, (void)p;\n",
                add);
    nevh__write_state_names(w, f);
    for (size_t i = 0; fine && i < f->n_terms; i++) {
        const nevh_term *is = &f->terms[i].term->decl;
        if (is->gradient != nevh__tape_block_gradient) {
            w->refusal = "a term is no formula";
            return false;
        }
        fine = w->loops && nevh__is_loop(&f->terms[i])
                   ? nevh__write_loop_of_values(w, &f->terms[i])
                   : energy_text_write_term(w, is);
    }
    nevh__write(w, "    return sum + lost;\n}\n\n");
    return fine;
}

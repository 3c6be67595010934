/* nevh: schemes from numbers: descriptors over the kernels of the families.

   Operations of a splitting that do nothing are left out, and neighbours of one kind
   are one; what is a palindrome but for rounding becomes one to the last bit.  A
   composition of steps of a splitting is a splitting, and that of a Runge-Kutta
   method is one with as many stages more.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/splitting_private.h"
#include "kernels/tableau_private.h"
#include "kernels/tao_private.h"
#include "kernels/scheme_table_private.h"
#include "system/print_private.h"
#include "system/system_private.h"
#include <fenv.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NAME = 60, MOST_OPERATIONS = 4096 };

/* A scheme with all that it points to. */
typedef struct {
    nevh_integrator scheme; /* first: the caller has its address */
    char name[MOST_NAME + 1];
    nevh_splitting splitting;
    nevh_butcher butcher;
    nevh__implicit_table implicit;
    long double *wide; /* weights, or a, b and c */
    double *rounded;   /* a, b and c */
} own_scheme;

static bool fail(nevh_table_error *e, char list, size_t index,
                 const char *format, ...) __attribute__((format(printf, 4, 5)));
static bool fail(nevh_table_error *e, char list, size_t index,
                 const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    *e = (nevh_table_error){NEVH_EINVAL, list, index, ""};
    nevh__vprint(e->text, sizeof e->text, format, arguments);
    va_end(arguments);
    return false;
}

static bool no_memory(nevh_table_error *e) {
    fail(e, 0, SIZE_MAX, "out of memory");
    e->status = NEVH_ENOMEM;
    return false;
}

static bool check_name(const char *name, nevh_table_error *e) {
    size_t length = name ? strlen(name) : 0;
    if (length < 1 || length > MOST_NAME)
        return fail(e, 0, SIZE_MAX, "a name has 1 to %d characters", MOST_NAME);
    for (const char *at = name; *at; at++) {
        bool letter = (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z');
        bool later = (*at >= '0' && *at <= '9') || *at == '-' || *at == '_';
        if (!letter && !(later && at > name))
            return fail(e, 0, SIZE_MAX,
                        "a name of an integrator has letters, digits, \"-\" "
                        "and \"_\", and begins with a letter");
    }
    return true;
}

static bool check_finite(char list, size_t count, const long double x[],
                         nevh_table_error *e) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(x[i]) || !isfinite((double)x[i]))
            return fail(e, list, i, "this is not a finite number");
    return true;
}

/* "0.99", or "1 + 3e-12". */
static void print_sum(long double sum, char text[], size_t size) {
    long double off = sum - 1;
    if (fabsl(off) < 1e-10L)
        nevh__print(text, size, "1 %c %.2g", off < 0 ? '-' : '+',
                    (double)fabsl(off));
    else
        nevh__print(text, size, "%.12g", (double)sum);
}

static bool check_sum(const char *what, char list, size_t count,
                      const long double x[], nevh_table_error *e) {
    long double sum = 0, size = 0;
    char text[40];
    if (!check_finite(list, count, x, e))
        return false;
    for (size_t i = 0; i < count; i++) {
        sum += x[i];
        size += fabsl(x[i]);
    }
    if (fabsl(sum - 1) <= 2 * NEVH__DIGITS * (1 + size))
        return true;
    print_sum(sum, text, sizeof text);
    return fail(e, list, SIZE_MAX, "%s add%s up to %s, not 1", what,
                list == 'b' ? "s" : "", text);
}

/* Operations of a step, in their turn. */
typedef struct {
    size_t count;
    nevh_operation kind[MOST_OPERATIONS];
    long double weight[MOST_OPERATIONS];
} sequence;

static void add_operation(sequence *s, nevh_operation kind, long double w) {
    if (w == 0)
        return;
    size_t last = s->count - 1;
    if (s->count && s->kind[last] == kind) {
        s->weight[last] += w;
        s->count -= s->weight[last] == 0;
        return;
    }
    s->kind[s->count] = kind;
    s->weight[s->count++] = w;
}

/* An error of rounding makes no other scheme of a palindrome. */
static void give_splitting(own_scheme *x, const sequence *s,
                           const nevh_scheme_facts *facts) {
    size_t given = facts->symmetric ? (s->count - 3) / 2 : s->count - 2;
    size_t kicks = (s->count + (s->kind[0] == NEVH_KICK)) / 2;
    x->splitting = (nevh_splitting){
        s->kind[0], facts->symmetric ? NEVH_PALINDROME : NEVH_LISTED, given,
        given ? x->wide : NULL};
    memcpy(x->wide, s->weight, given * sizeof *x->wide);
    bool kept = s->count % 2 == 1 && s->kind[0] == NEVH_KICK;
    x->scheme.gradients = x->scheme.stages = (int)(kicks - kept);
    x->scheme.explicit_form = NEVH_YES;
    x->scheme.needs = NEVH_SEPARABLE;
    if (facts->order > facts->any_kinetic)
        x->scheme.needs |= NEVH_QUADRATIC_KINETIC;
    x->scheme.kernel = &nevh_splitting_kernel;
    x->scheme.table = &x->splitting;
}

static bool make_of_sequence(own_scheme *x, const sequence *s,
                             nevh_scheme_facts *facts, nevh_table_error *e) {
    nevh__operations all = {s->kind[0], s->count, s->weight};
    x->wide = nevh__array(s->count, sizeof *x->wide);
    if (!x->wide || nevh__splitting_facts(&all, facts))
        return no_memory(e);
    give_splitting(x, s, facts);
    return true;
}

static bool check_counts(const nevh_scheme_table *t, nevh_table_error *e) {
    size_t first = t->first == NEVH_KICK ? t->kicks : t->drifts;
    size_t second = t->first == NEVH_KICK ? t->drifts : t->kicks;
    if (t->kicks + t->drifts > MOST_OPERATIONS)
        return fail(e, 0, SIZE_MAX, "more than %d kicks and drifts",
                    MOST_OPERATIONS);
    if (first == second || first == second + 1)
        return true;
    const char *name = t->first == NEVH_KICK ? "kick" : "drift";
    return fail(
        e, t->first == NEVH_KICK ? 'd' : 'k', SIZE_MAX,
        "%zu kicks and %zu drifts cannot alternate, %s first: there are "
        "as many of both, or one %s more",
        t->kicks, t->drifts, name, name);
}

static bool make_splitting(own_scheme *x, const nevh_scheme_table *t,
                           nevh_scheme_facts *facts, nevh_table_error *e) {
    if (!check_counts(t, e) ||
        !check_sum("kick weights", 'k', t->kicks, t->kick, e) ||
        !check_sum("drift weights", 'd', t->drifts, t->drift, e))
        return false;
    sequence *s = nevh__array(1, sizeof *s);
    for (size_t i = 0; s && i < t->kicks + t->drifts; i++) {
        bool kick = (t->first == NEVH_KICK) == (i % 2 == 0);
        add_operation(s, kick ? NEVH_KICK : NEVH_DRIFT,
                      kick ? t->kick[i / 2] : t->drift[i / 2]);
    }
    bool made = s ? make_of_sequence(x, s, facts, e) : no_memory(e);
    free(s);
    return made;
}

/* Room for coefficients. */
static bool reserve(own_scheme *x, size_t stages) {
    size_t count = stages * (stages + 2);
    x->wide = nevh__array(count, sizeof *x->wide);
    x->rounded = nevh__array(count, sizeof *x->rounded);
    return x->wide && x->rounded;
}

static bool is_explicit(size_t s, const long double a[]) {
    for (size_t i = 0; i < s; i++)
        for (size_t j = i; j < s; j++)
            if (a[i * s + j] != 0)
                return false;
    return true;
}

/* The last stage stands at the new state. */
static bool last_is_first(size_t s, const long double a[],
                          const long double b[]) {
    return s > 1 &&
           memcmp(a + (s - 1) * s, b, s * sizeof *b) == 0; /* so b[s-1] = 0 */
}

static void give_explicit(own_scheme *x, size_t s) {
    const double *a = x->rounded, *b = a + s * s;
    for (size_t i = 0; i < s * (s + 2); i++)
        x->rounded[i] = (double)x->wide[i];
    x->butcher = (nevh_butcher){.stages = s,
                                .a = a,
                                .b = b,
                                .c = b + s,
                                .last_is_first =
                                    last_is_first(s, x->wide, x->wide + s * s)};
    x->scheme.gradients = (int)(s - x->butcher.last_is_first);
    x->scheme.explicit_form = NEVH_YES;
    x->scheme.kernel = &nevh_runge_kutta_kernel;
    x->scheme.table = &x->butcher;
}

/* A stage without a weight has no part in what makes mu exact. */
static void give_implicit(own_scheme *x, size_t s,
                          const nevh_scheme_facts *facts) {
    const long double *a = x->wide, *b = a + s * s;
    x->implicit = (nevh__implicit_table){.stages = s,
                                         .a = a,
                                         .b = b,
                                         .c = b + s,
                                         .symplectic = facts->symplectic};
    for (size_t i = 0; i < s; i++)
        if (b[i] == 0)
            x->implicit.symplectic = false;
    x->scheme.sweep_gradients = (int)s;
    x->scheme.explicit_form = NEVH_NO;
    x->scheme.kernel = &nevh__implicit_kernel;
    x->scheme.table = &x->implicit;
}

/* A method of order 2 may have other nodes than sums of rows, as Lobatto IIIB of two
   stages, if its condition of order 2 holds for these, too. */
static bool has_free_nodes(size_t s, const long double b[],
                           const long double c[],
                           const nevh_scheme_facts *facts) {
    long double sum = 0, size = 1;
    for (size_t i = 0; i < s; i++) {
        sum += b[i] * c[i];
        size += fabsl(b[i] * c[i]);
    }
    return facts->order == 2 && fabsl(sum - 0.5L) <= NEVH__DIGITS * size;
}

/* Fills in nodes, and compares them with those that are given. */
static bool take_nodes(own_scheme *x, size_t s, const long double *c,
                       const nevh_scheme_facts *facts, nevh_table_error *e) {
    long double *a = x->wide, *b = a + s * s, *rows = b + s;
    bool any = c && has_free_nodes(s, b, c, facts);
    for (size_t i = 0; i < s; i++) {
        long double size = c ? fabsl(c[i]) : 0;
        for (size_t j = 0; j < s; j++) {
            rows[i] += a[i * s + j];
            size += fabsl(a[i * s + j]);
        }
        if (c && !any && !(fabsl(rows[i] - c[i]) <= 2 * NEVH__DIGITS * size))
            return fail(e, 'c', i,
                        "row %zu of a adds up to %.12g, but c_%zu is %.12g",
                        i + 1, (double)rows[i], i + 1, (double)c[i]);
        rows[i] = c ? c[i] : rows[i];
    }
    return true;
}

/* From coefficients that are there: a and b. */
static bool make_of_coefficients(own_scheme *x, size_t s, const long double *c,
                                 nevh_scheme_facts *facts,
                                 nevh_table_error *e) {
    x->scheme.stages = (int)s;
    if (nevh__runge_kutta_facts(s, x->wide, x->wide + s * s, facts))
        return no_memory(e);
    if (!take_nodes(x, s, c, facts, e))
        return false;
    if (is_explicit(s, x->wide))
        give_explicit(x, s);
    else
        give_implicit(x, s, facts);
    return true;
}

static bool make_runge_kutta(own_scheme *x, const nevh_scheme_table *t,
                             nevh_scheme_facts *facts, nevh_table_error *e) {
    size_t s = t->stages;
    if (s > NEVH_MOST_STAGES)
        return fail(e, 'b', SIZE_MAX, "%zu stages, where %d are possible", s,
                    NEVH_MOST_STAGES);
    for (size_t i = 0; i < s; i++)
        if (!check_finite('a', s, t->a + i * s, e)) {
            e->index = i;
            return false;
        }
    if (!check_sum("b", 'b', s, t->b, e) ||
        (t->c && !check_finite('c', s, t->c, e)))
        return false;
    if (!reserve(x, s))
        return no_memory(e);
    memcpy(x->wide, t->a, s * s * sizeof *x->wide);
    memcpy(x->wide + s * s, t->b, s * sizeof *x->wide);
    return make_of_coefficients(x, s, t->c, facts, e);
}

static bool compose_splitting(own_scheme *x, const nevh_scheme_table *t,
                              const nevh__numbers *base,
                              nevh_scheme_facts *facts, nevh_table_error *e) {
    if (t->steps > MOST_OPERATIONS / base->operations)
        return fail(e, 's', SIZE_MAX, "more than %d kicks and drifts",
                    MOST_OPERATIONS);
    sequence *s = nevh__array(1, sizeof *s);
    for (size_t k = 0; s && k < t->steps; k++)
        for (size_t i = 0; i < base->operations; i++) {
            bool kick = (base->first == NEVH_KICK) == (i % 2 == 0);
            add_operation(s, kick ? NEVH_KICK : NEVH_DRIFT,
                          t->step[k] * base->weights[i]);
        }
    bool made = s ? make_of_sequence(x, s, facts, e) : no_memory(e);
    free(s);
    return made;
}

/* Stages of a step follow the whole steps before it. */
static bool compose_runge_kutta(own_scheme *x, const nevh_scheme_table *t,
                                const nevh__numbers *base,
                                nevh_scheme_facts *facts, nevh_table_error *e) {
    size_t each = base->stages, s = each * t->steps;
    if (t->steps > NEVH_MOST_STAGES / each)
        return fail(e, 's', SIZE_MAX,
                    "%zu steps of %zu stages, where %d stages are possible",
                    t->steps, each, NEVH_MOST_STAGES);
    if (!reserve(x, s))
        return no_memory(e);
    for (size_t i = 0; i < s; i++) {
        long double *row = x->wide + i * s, step = t->step[i / each];
        for (size_t j = 0; j < i / each * each; j++)
            row[j] = t->step[j / each] * base->b[j % each];
        for (size_t j = 0; j < each; j++)
            row[i / each * each + j] = step * base->a[i % each * each + j];
        x->wide[s * s + i] = step * base->b[i % each];
    }
    return make_of_coefficients(x, s, NULL, facts, e);
}

/* Step i of a composition of Tao's steps, of which `half` are given and the others
   mirror them. */
static long double part_of(const nevh_splitting *c, size_t i) {
    size_t parts = 2 * c->count + 1;
    long double middle = 1;
    for (size_t k = 0; k < c->count; k++)
        middle -= 2 * c->weights[k];
    return i == c->count ? middle
                         : c->weights[i < c->count ? i : parts - 1 - i];
}

/* The weights of all steps, in turn; whether they are as many and mirror each other
   as a table has them. */
static bool take_parts(own_scheme *x, const nevh_scheme_table *t,
                       nevh_table_error *e) {
    const nevh_splitting *base = t->base->table;
    size_t each = 2 * base->count + 1, parts = each * t->steps;
    long double all[2 * NEVH__TAO_MOST_WEIGHTS + 1];
    if (parts > 2 * NEVH__TAO_MOST_WEIGHTS + 1)
        return fail(e, 's', SIZE_MAX,
                    "%zu steps of tao2, where %d are possible", parts,
                    2 * NEVH__TAO_MOST_WEIGHTS + 1);
    for (size_t i = 0; i < parts; i++)
        all[i] = t->step[i / each] * part_of(base, i % each);
    for (size_t i = 0; i < parts; i++)
        if (parts % 2 == 0 || !(fabsl(all[i] - all[parts - 1 - i]) <=
                                NEVH__DIGITS * (1 + fabsl(all[i]))))
            return fail(e, 's', SIZE_MAX,
                        "steps of %s are composed of an odd number of weights, "
                        "which are the same from back to front",
                        t->base->name);
    x->wide = nevh__array(parts, sizeof *x->wide);
    if (!x->wide)
        return no_memory(e);
    memcpy(x->wide, all, parts / 2 * sizeof *all);
    x->splitting = (nevh_splitting){NEVH_KICK, NEVH_COMPOSITION, parts / 2,
                                    parts > 1 ? x->wide : NULL};
    return true;
}

/* The conditions are those of Verlet's steps of the same parts. */
static bool compose_tao(own_scheme *x, const nevh_scheme_table *t,
                        nevh_scheme_facts *facts, nevh_table_error *e) {
    if (!take_parts(x, t, e))
        return false;
    size_t count = nevh__splitting_operations(&x->splitting);
    long double *weights = nevh__array(count, sizeof *weights);
    nevh__operations all = {NEVH_KICK, count, weights};
    if (!weights)
        return no_memory(e);
    nevh__splitting_expand_wide(&x->splitting, weights);
    int status = nevh__splitting_facts(&all, facts);
    free(weights);
    if (status)
        return no_memory(e);
    facts->order = facts->any_kinetic;
    x->scheme.stages = (int)(2 * x->splitting.count + 1);
    x->scheme.gradients = 3 * x->scheme.stages;
    x->scheme.explicit_form = NEVH_YES;
    x->scheme.kernel = &nevh__tao_kernel;
    x->scheme.table = &x->splitting;
    return true;
}

static bool make_composition(own_scheme *x, const nevh_scheme_table *t,
                             nevh_scheme_facts *facts, nevh_table_error *e) {
    nevh__numbers base;
    if (!check_sum("weights of the steps", 's', t->steps, t->step, e))
        return false;
    for (size_t i = 0; i < t->steps; i++)
        if (t->step[i] == 0)
            return fail(e, 's', i, "a step of length 0");
    if (t->base->kernel == &nevh__tao_kernel)
        return compose_tao(x, t, facts, e);
    int status = nevh__numbers_of(t->base, &base);
    bool made = status == NEVH_EINVAL
                    ? fail(e, 0, SIZE_MAX,
                           "%s is neither a splitting nor a Runge-Kutta "
                           "method: there is no table to compose",
                           t->base->name)
                : status          ? no_memory(e)
                : base.operations ? compose_splitting(x, t, &base, facts, e)
                                  : compose_runge_kutta(x, t, &base, facts, e);
    nevh__numbers_free(&base);
    return made;
}

static bool make(own_scheme *x, const nevh_scheme_table *t,
                 nevh_table_error *e) {
    nevh_scheme_facts facts = {.value = NAN, .due = NAN};
    int kinds = (t->kicks || t->drifts) + (t->stages > 0) + (t->base != NULL);
    if (!check_name(t->name, e))
        return false;
    if (kinds != 1)
        return fail(e, 0, SIZE_MAX,
                    kinds ? "a scheme is one of three: kick and drift, a and "
                            "b, or a composition"
                          : "no weights: a scheme has kick and drift, a and b, "
                            "or compose");
    strcpy(x->name, t->name);
    x->scheme.name = x->name;
    x->scheme.source = "a table of one's own";
    bool made = t->base     ? make_composition(x, t, &facts, e)
                : t->stages ? make_runge_kutta(x, t, &facts, e)
                            : make_splitting(x, t, &facts, e);
    x->scheme.order = facts.order;
    nevh_claim holds =
        x->scheme.kernel == &nevh__tao_kernel ? NEVH_EXTENDED : NEVH_YES;
    x->scheme.symplectic = facts.symplectic ? holds : NEVH_NO;
    x->scheme.symmetric = facts.symmetric ? holds : NEVH_NO;
    x->scheme.preserves_energy = NEVH_NO;
    return made;
}

static bool make_untrapped(own_scheme *x, const nevh_scheme_table *table,
                           nevh_table_error *e) {
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    bool made = make(x, table, e);
    fesetenv(&own);
    return made;
}

nevh_integrator *nevh_integrator_new(const nevh_scheme_table *table,
                                     nevh_table_error *error) {
    nevh_table_error own;
    nevh_table_error *e = error ? error : &own;
    own_scheme *x = nevh__array(1, sizeof *x);
    *e = (nevh_table_error){0};
    if (!x)
        no_memory(e);
    else if (!table)
        fail(e, 0, SIZE_MAX, "there is no table");
    else if (make_untrapped(x, table, e))
        return &x->scheme;
    if (x)
        nevh_integrator_free(&x->scheme);
    return NULL;
}

void nevh_integrator_free(nevh_integrator *scheme) {
    own_scheme *x = (own_scheme *)(void *)scheme;
    if (!x)
        return;
    free(x->wide);
    free(x->rounded);
    free(x);
}

/* nevh hard: every hard case with every scheme and gradient, and the verdicts.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "hard_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double budget = 1e6; /* evaluations of a run */

typedef struct {
    hard_result *result;
    size_t count;
    double frequency, dt, t, t_end;
    const hard_case *decl;
} case_results;

typedef struct {
    list gradients;
    const nevh_integrator **schemes;
    double *limits; /* of stability, a scheme each */
    size_t n_schemes, n_cases;
    case_results *cases;
} suite;

static double find_limit(const nevh_integrator *scheme) {
    hard_begin("oscillator", scheme, 60);
    double limit = nevh_stability_limit(scheme);
    hard_end();
    return limit;
}

static int take_schemes(suite *all, const options *o) {
    list names = {0};
    size_t count = 0;
    int status = TOOL_OK;
    while (nevh_integrators()[count])
        list_add(&names, nevh_integrator_name(nevh_integrators()[count++]));
    size_t wanted = o->integrators.count;
    all->n_schemes = wanted ? wanted : count;
    all->schemes = tool_allocate(all->n_schemes, sizeof *all->schemes);
    all->limits = tool_allocate(all->n_schemes, sizeof *all->limits);
    for (size_t i = 0; !status && i < all->n_schemes; i++) {
        const char *name = wanted ? o->integrators.item[i] : names.item[i];
        all->schemes[i] = nevh_integrator_named(name);
        if (!all->schemes[i])
            status = tool_unknown("integrator", name, &names);
        else
            all->limits[i] = find_limit(all->schemes[i]);
    }
    list_free(&names);
    return status;
}

static int take_gradients(suite *all, const options *o) {
    list names = {0};
    int status = TOOL_OK;
    for (size_t i = 0; nevh_gradients()[i]; i++)
        list_add(&names, nevh_gradient_name(nevh_gradients()[i]));
    for (size_t i = 0; i < o->gradients.count; i++)
        list_add(&all->gradients, o->gradients.item[i]);
    if (o->gradients.count == 0)
        list_split(&all->gradients, "central2,central6,exact");
    for (size_t i = 0; !status && i < all->gradients.count; i++)
        if (!nevh_gradient_named(all->gradients.item[i]))
            status = tool_unknown("gradient", all->gradients.item[i], &names);
    list_free(&names);
    return status;
}

static bool wanted(const options *o, const char *name) {
    for (size_t i = 1; i < o->operands.count; i++)
        if (strcmp(o->operands.item[i], name) == 0)
            return true;
    return o->operands.count == 1;
}

static int check_names(const options *o) {
    list names = {0};
    int status = TOOL_OK;
    for (const hard_case *c = hard_cases; c->name; c++)
        list_add(&names, c->name);
    for (size_t i = 1; !status && i < o->operands.count; i++) {
        bool found = false;
        for (size_t k = 0; k < names.count; k++)
            found |= strcmp(o->operands.item[i], names.item[k]) == 0;
        if (!found)
            status = tool_unknown("case", o->operands.item[i], &names);
    }
    list_free(&names);
    return status;
}

static void run_case(const suite *all, hard_subject *s, case_results *c) {
    c->count = all->gradients.count * all->n_schemes;
    c->result = tool_allocate(c->count, sizeof *c->result);
    c->decl = s->decl;
    c->frequency = s->frequency;
    c->dt = s->dt;
    c->t = s->t;
    c->t_end = s->t_end;
    for (size_t i = 0; i < c->count; i++) {
        hard_result *r = &c->result[i];
        r->gradient = all->gradients.item[i / all->n_schemes];
        r->scheme = all->schemes[i % all->n_schemes];
        r->limit = all->limits[i % all->n_schemes];
        hard_run(s, budget, r);
        hard_judge(s, r);
    }
}

static size_t cases_wanted(const options *o) {
    size_t count = 0;
    for (const hard_case *c = hard_cases; c->name; c++)
        count += wanted(o, c->name);
    return count;
}

/* Runs take most of the budget of evaluations, or end early: 0.03 s on average on
   the machines that this was measured on. */
static void announce(const suite *all, const options *o) {
    size_t runs = cases_wanted(o) * all->n_schemes * all->gradients.count;
    double minutes = (double)runs * 0.03 / 60;
    if (!o->quiet && minutes > 0.3)
        fprintf(stderr, "nevh: %zu runs, about %.0f minute%s\n", runs,
                ceil(minutes), ceil(minutes) > 1 ? "s" : "");
}

static void progress(const suite *all, const options *o, const hard_case *c) {
    if (o->quiet || !isatty(STDERR_FILENO))
        return;
    fputs("\r\033[K", stderr);
    if (c)
        fprintf(stderr, "%zu of %zu: %s", all->n_cases + 1, cases_wanted(o),
                c->name);
    fflush(stderr);
}

static int run_all(suite *all, const options *o) {
    size_t most = 0;
    int status = TOOL_OK;
    while (hard_cases[most].name)
        most++;
    all->cases = tool_allocate(most, sizeof *all->cases);
    for (size_t i = 0; !status && i < most; i++) {
        hard_subject s;
        if (!wanted(o, hard_cases[i].name))
            continue;
        progress(all, o, &hard_cases[i]);
        status = hard_open(&s, &hard_cases[i]);
        if (!status) {
            run_case(all, &s, &all->cases[all->n_cases++]);
            hard_close(&s);
        }
    }
    progress(all, o, NULL);
    return status;
}

static char *asked(const case_results *c) {
    return text_print("dt = %.4g, t = %.4g ... %.6g", c->dt, c->t, c->t_end);
}

static void add_record(table *t, const case_results *c, const hard_result *r) {
    char *what = asked(c);
    bool ran = r->planned && !r->status;
    table_text(t, c->decl->name);
    table_text(t, nevh_integrator_name(r->scheme));
    table_text(t, r->gradient);
    table_text(t, what);
    table_number(t, c->dt * r->frequency);
    table_number(t, r->limit);
    table_number(t, r->planned ? (double)r->steps : NAN);
    table_number(t, ran ? r->energy.max : NAN);
    table_number(t, ran ? r->bound : NAN);
    table_number(t, r->state_error);
    table_number(t, r->state_bound);
    table_text(t, r->happened);
    table_text(t, hard_verdict_name(r->verdict));
    free(what);
}

static table *runs(const suite *all) {
    table *t = table_new();
    table_titles(t, hard_command.columns);
    for (size_t i = 0; i < all->n_cases; i++)
        for (size_t k = 0; k < all->cases[i].count; k++)
            add_record(t, &all->cases[i], &all->cases[i].result[k]);
    return t;
}

/* The results of one case with one verdict: how many, their largest error, and
   what happened to the one that went farthest. */
typedef struct {
    size_t count;
    double least, most;
    const hard_result *example;
} bundle;

static bundle collect(const case_results *c, hard_verdict v) {
    bundle b = {0, INFINITY, 0, NULL};
    for (size_t i = 0; i < c->count; i++) {
        const hard_result *r = &c->result[i];
        if (r->verdict != v)
            continue;
        if (!b.example || r->energy.max > b.most)
            b.example = r;
        b.count++;
        b.least = fmin(b.least, r->energy.max);
        b.most = fmax(b.most, r->energy.max);
    }
    return b;
}

static void show_bundle(table *t, const case_results *c, hard_verdict v,
                        const bundle *b) {
    bool numbers = v != HARD_REFUSED && v != HARD_FAILED;
    char *what = asked(c);
    table_text(t, c->decl->name);
    table_text(t, what);
    table_shown(t, "%.2g", c->dt * c->frequency);
    table_text(t, hard_verdict_name(v));
    table_shown(t, "%zu", b->count);
    table_shown(t, numbers ? "%.1e" : "", b->least);
    table_shown(t, numbers ? "%.1e" : "", b->most);
    char *text =
        text_print("%s, %s: %s", nevh_integrator_name(b->example->scheme),
                   b->example->gradient, b->example->happened);
    table_text(t, text);
    free(text);
    free(what);
}

static table *shown(const suite *all) {
    table *t = table_new();
    table_titles(t, "case,asked,omega\ndt,verdict,rows,error\nfrom,"
                    "\nto,the worst of them");
    table_below(t);
    for (size_t i = 0; i < all->n_cases; i++) {
        table_group(t);
        for (hard_verdict v = HARD_NONE; v < HARD_VERDICTS; v++) {
            bundle b = collect(&all->cases[i], v);
            if (b.count)
                show_bundle(t, &all->cases[i], v, &b);
        }
    }
    return t;
}

static size_t count_verdicts(const suite *all, size_t counts[HARD_VERDICTS]) {
    size_t sum = 0;
    for (size_t i = 0; i < all->n_cases; i++)
        for (size_t k = 0; k < all->cases[i].count; k++, sum++)
            counts[all->cases[i].result[k].verdict]++;
    return sum;
}

static void tell_counts(const suite *all, const size_t counts[HARD_VERDICTS],
                        size_t sum, list *words) {
    list_print(words,
               "%zu cases x %zu schemes x %zu gradients: %zu combinations; %zu "
               "bounded, %zu drift as theory expects, %zu unstable, %zu "
               "refused, %zu failed with the last good state kept; %zu on a "
               "wrong orbit, %zu without a verdict.",
               all->n_cases, all->n_schemes, all->gradients.count, sum,
               counts[HARD_BOUNDED], counts[HARD_DRIFTS], counts[HARD_UNSTABLE],
               counts[HARD_REFUSED], counts[HARD_FAILED], counts[HARD_WRONG],
               counts[HARD_NONE]);
}

static int print_suite(const suite *all, const options *o) {
    size_t counts[HARD_VERDICTS] = {0};
    size_t sum = count_verdicts(all, counts);
    bool each = o->all || o->format != FORMAT_TABLE;
    page result = {.table = each ? runs(all) : shown(all)};
    tell_counts(all, counts, sum,
                o->format == FORMAT_CSV ? &result.before : &result.after);
    int status = counts[HARD_NONE] + counts[HARD_WRONG] ? TOOL_FAILED : TOOL_OK;
    status = output_page(o, &result, status);
    page_free(&result);
    return status;
}

static void suite_free(suite *all) {
    for (size_t i = 0; i < all->n_cases; i++) {
        for (size_t k = 0; k < all->cases[i].count; k++)
            hard_result_free(&all->cases[i].result[k]);
        free(all->cases[i].result);
    }
    free(all->cases);
    free(all->schemes);
    free(all->limits);
    list_free(&all->gradients);
}

static int hard(const options *o) {
    suite all = {0};
    int status = check_names(o);
    if (!status)
        status = take_schemes(&all, o);
    if (!status)
        status = take_gradients(&all, o);
    if (!status) {
        announce(&all, o);
        status = run_all(&all, o);
    }
    if (!status)
        status = print_suite(&all, o);
    suite_free(&all);
    return status;
}

const command hard_command = {
    .name = "hard",
    .operand = "",
    .brief = "every integrator on hard cases",
    .help = "every integrator on cases that are hard to integrate",
    .examples = "hard --integrators verlet\n"
                "hard --integrators verlet,rk4 --all",
    .options = "TABLE integrators gradient all",
    .columns = "case,integrator,gradient,asked,h_omega,stable_below,steps,"
               "max_energy_error,bound,state_error,state_bound,happened,"
               "verdict",
    .run = hard,
};

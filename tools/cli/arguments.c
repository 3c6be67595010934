/* nevh: what the arguments of options mean.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "options_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The names of a list, behind what is to be put before each. */
static int read_names(list *l, const char *before, const char *option,
                      const char *argument) {
    list names = {0};
    int status = TOOL_OK;
    list_split(&names, argument);
    for (size_t i = 0; !status && i < names.count; i++) {
        const char *name = names.item[i];
        if (!*name)
            status = tool_refuse("--%s: a name is missing in \"%s\"", option,
                                 argument);
        else if (strchr(name, ' '))
            status = tool_refuse("--%s: names are separated by commas, not "
                                 "\"%s\"",
                                 option, name);
        else
            list_print(l, "%s%s", before, name);
    }
    list_free(&names);
    return status;
}

int read_with(options *o, const char *argument) {
    return read_names(&o->settings, "+", "with", argument);
}

int read_without(options *o, const char *argument) {
    return read_names(&o->settings, "-", "without", argument);
}

/* Where the next NAME = VALUE begins: behind a comma, outside of brackets,
   after which a name and "=" follow; other commas separate values. */
static const char *next_assignment(const char *text) {
    const char *comma = NULL;
    int depth = 0;
    for (bool first = true; *text; text++) {
        depth +=
            (*text == '(' || *text == '[') - (*text == ')' || *text == ']');
        if (depth == 0 && *text == ',')
            comma = text;
        if (depth == 0 && *text == '=' && !first && comma)
            return comma + 1;
        first = first && *text != '=';
    }
    return NULL;
}

static int read_assignments(list *l, char kind, const char *argument) {
    for (const char *next; argument; argument = next) {
        next = next_assignment(argument);
        int length = next ? (int)(next - argument) - 1 : (int)strlen(argument);
        list_print(l, "%c%.*s", kind, length, argument);
    }
    return TOOL_OK;
}

int read_set(options *o, const char *argument) {
    return read_assignments(&o->settings, '=', argument);
}

int read_variant(options *o, const char *argument) {
    list_add(&o->variants, argument);
    return TOOL_OK;
}

int read_start(options *o, const char *argument) {
    return read_assignments(&o->settings, '@', argument);
}

int read_integrators(options *o, const char *argument) {
    return read_names(&o->integrators, "", "integrators", argument);
}

int read_gradient(options *o, const char *argument) {
    return read_names(&o->gradients, "", "gradient", argument);
}

static int read_number(const char *option, const char *text, double *number) {
    char *end;
    bool decimal = text[strspn(text, "0123456789.eE+-")] == '\0';
    *number = strtod(text, &end);
    if (decimal && end != text && !*end && isfinite(*number))
        return TOOL_OK;
    return tool_refuse("--%s takes numbers, not \"%s\"", option, text);
}

static int read_positive(const char *option, const char *text, double *number) {
    if (read_number(option, text, number))
        return TOOL_USAGE;
    if (*number > 0)
        return TOOL_OK;
    return tool_refuse("--%s takes numbers above 0, not %s", option, text);
}

static int read_numbers(const char *option, const char *argument,
                        double **numbers, size_t *count,
                        int (*read)(const char *, const char *, double *)) {
    list texts = {0};
    int status = TOOL_OK;
    list_split(&texts, argument);
    free(*numbers);
    *numbers = tool_allocate(texts.count, sizeof **numbers);
    *count = texts.count;
    for (size_t i = 0; !status && i < texts.count; i++)
        status = read(option, texts.item[i], &(*numbers)[i]);
    list_free(&texts);
    return status;
}

/* Formulas, whose commas inside of parentheses stay. */
static int read_formulas(list *l, const char *argument) {
    list_free(l);
    for (;;) {
        int depth = 0;
        size_t length = 0;
        for (; argument[length]; length++) {
            depth += (argument[length] == '(') - (argument[length] == ')');
            if (depth == 0 && argument[length] == ',')
                break;
        }
        list_print(l, "%.*s", (int)length, argument);
        if (!argument[length])
            return TOOL_OK;
        argument += length + 1;
    }
}

int read_dt(options *o, const char *argument) {
    return read_formulas(&o->dt, argument);
}

int read_tolerance(options *o, const char *argument) {
    return read_numbers("tolerance", argument, &o->tolerance, &o->tolerances,
                        read_positive);
}

int read_at(options *o, const char *argument) {
    return read_formulas(&o->at, argument);
}

int read_t_end(options *o, const char *argument) {
    o->t_end = argument;
    return TOOL_OK;
}

int read_after(options *o, const char *argument) {
    o->after = argument;
    return TOOL_OK;
}

int read_gradient_step(options *o, const char *argument) {
    return read_positive("gradient-step", argument, &o->gradient_step);
}

int read_energy_error(options *o, const char *argument) {
    return read_positive("energy-error", argument, &o->search.energy_error);
}

int read_state_error(options *o, const char *argument) {
    return read_positive("state-error", argument, &o->search.state_error);
}

static int read_count(const char *option, const char *text, size_t *count) {
    double number;
    if (read_positive(option, text, &number))
        return TOOL_USAGE;
    if (number != floor(number) || number > 0x1p53)
        return tool_refuse("--%s takes a whole number, not %s", option, text);
    *count = (size_t)number;
    return TOOL_OK;
}

int read_every(options *o, const char *argument) {
    return read_count("every", argument, &o->every);
}

int read_samples(options *o, const char *argument) {
    return read_count("samples", argument, &o->samples);
}

int read_digits(options *o, const char *argument) {
    int status = read_count("digits", argument, &o->digits);
    return status || o->digits <= 30
               ? status
               : tool_refuse("--digits takes 1 to 30, not %s", argument);
}

int read_starts(options *o, const char *argument) {
    return read_count("starts", argument, &o->chaos.starts);
}

int read_gali(options *o, const char *argument) {
    return read_count("gali", argument, &o->chaos.deviations);
}

int read_exponents(options *o, const char *argument) {
    o->chaos.all = strcmp(argument, "all") == 0;
    return o->chaos.all
               ? TOOL_OK
               : read_count("exponents", argument, &o->chaos.exponents);
}

int read_repeat(options *o, const char *argument) {
    return read_count("repeat", argument, &o->search.repeats);
}

int read_budget(options *o, const char *argument) {
    return read_positive("budget", argument, &o->search.budget);
}

int read_data(options *o, const char *argument) {
    o->fit.data = argument;
    return *argument ? TOOL_OK : tool_refuse("--data takes a file");
}

int read_sigma(options *o, const char *argument) {
    return read_positive("sigma", argument, &o->fit.sigma);
}

int read_vary(options *o, const char *argument) {
    list_add(&o->vary, argument);
    return TOOL_OK;
}

int read_outcomes(options *o, const char *argument) {
    o->outcomes = argument;
    return TOOL_OK;
}

static int read_few(const char *option, const char *text, size_t most,
                    size_t *count) {
    if (read_count(option, text, count))
        return TOOL_USAGE;
    return *count <= most ? TOOL_OK
                          : tool_refuse("--%s takes at most %zu, not %s",
                                        option, most, text);
}

int read_threads(options *o, const char *argument) {
    return read_few("threads", argument, 4096, &o->threads);
}

int read_retry(options *o, const char *argument) {
    (void)argument;
    o->retry = true;
    return TOOL_OK;
}

int read_join(options *o, const char *argument) {
    (void)argument;
    o->join = true;
    return TOOL_OK;
}

/* 90, 90s, 50m, 2h, 1d */
int read_stop_after(options *o, const char *argument) {
    static const char units[] = "smhd";
    static const double seconds[] = {1, 60, 3600, 86400};
    size_t length = strlen(argument);
    const char *unit = length ? strchr(units, argument[length - 1]) : NULL;
    char *number = text_print("%.*s", (int)(length - (unit != NULL)), argument);
    int status = read_positive("stop-after", number, &o->stop_after);
    free(number);
    o->stop_after *= unit ? seconds[unit - units] : 1;
    return status;
}

/* I/N */
int read_task(options *o, const char *argument) {
    char *slash = strchr(argument, '/');
    char *part =
        text_print("%.*s", slash ? (int)(slash - argument) : 0, argument);
    int status =
        slash ? read_count("task", part, &o->task)
              : tool_refuse("--task is written 3/16, not \"%s\"", argument);
    if (!status)
        status = read_count("task", slash + 1, &o->tasks);
    free(part);
    if (!status && o->task > o->tasks)
        return tool_refuse("--task %s: there are %zu", argument, o->tasks);
    return status;
}

int read_width(options *o, const char *argument) {
    return read_few("width", argument, 4096, &o->width);
}

/* "a, b or c" */
static char *either(const char *const names[]) {
    char *text = text_print("%s", names[0]);
    for (size_t i = 1; names[i]; i++) {
        char *longer =
            text_print(names[i + 1] ? "%s, %s" : "%s or %s", text, names[i]);
        free(text);
        text = longer;
    }
    return text;
}

/* Which of the names, as a number from 0. */
static int read_name(const char *option, const char *text,
                     const char *const names[], int *which) {
    for (*which = 0; names[*which]; ++*which)
        if (strcmp(text, names[*which]) == 0)
            return TOOL_OK;
    char *known = either(names);
    int status = tool_refuse("--%s is %s, not \"%s\"", option, known, text);
    free(known);
    return status;
}

int read_match(options *o, const char *argument) {
    static const char *const names[] = {"steps", "work", NULL};
    int which;
    int status = read_name("match", argument, names, &which);
    o->match = which == 1 ? MATCH_WORK : MATCH_STEPS;
    return status;
}

int read_by(options *o, const char *argument) {
    static const char *const names[] = {"energy", "state", NULL};
    int which;
    int status = read_name("by", argument, names, &which);
    o->search.by_state = which == 1;
    return status;
}

int read_format(options *o, const char *argument) {
    static const char *const names[] = {"table", "csv", "json", NULL};
    int which;
    int status = read_name("format", argument, names, &which);
    o->format = (table_format)which;
    o->formatted = true;
    return status;
}

int read_section(options *o, const char *argument) {
    list_split(&o->sections, argument);
    return TOOL_OK;
}

int read_file(options *o, const char *argument) {
    if (strcmp(argument, "-") == 0)
        return tool_refuse("--output takes a file; without it rows go to the "
                           "terminal");
    o->file = argument;
    return TOOL_OK;
}

int read_plot(options *o, const char *argument) {
    o->plot.file = argument;
    return TOOL_OK;
}

int read_plot_script(options *o, const char *argument) {
    o->plot.script = argument;
    return TOOL_OK;
}

int read_plot_kind(options *o, const char *argument) {
    static const char *const names[] = {
        "phase", "energy", "configuration", "time", "order", "animation", NULL};
    int which;
    int status = read_name("plot-kind", argument, names, &which);
    o->plot.kind = (plot_kind)(which + PLOT_PHASE);
    return status;
}

int plot_kind_check(const options *o, unsigned bit) {
    bool order = o->plot.kind == PLOT_ORDER;
    if (order && bit == FOR_RUN)
        return tool_refuse("--plot-kind order is for nevh compare and nevh "
                           "cost");
    if (o->plot.kind && !order && bit != FOR_RUN)
        return tool_refuse("--plot-kind of nevh %s is order, or not given",
                           command_name(bit));
    return TOOL_OK;
}

int read_columns(options *o, const char *argument) {
    o->columns = argument;
    return TOOL_OK;
}

int read_error(options *o, const char *argument) {
    return read_positive("error", argument, &o->search.error);
}

int read_observable(options *o, const char *argument) {
    o->observable = argument;
    return TOOL_OK;
}

int read_picture(options *o, const char *argument) {
    o->picture = argument;
    return TOOL_OK;
}

int read_shape(options *o, const char *argument) {
    o->shape = argument;
    return TOOL_OK;
}

int read_transform(options *o, const char *argument) {
    o->transform = argument;
    return TOOL_OK;
}

int read_resume(options *o, const char *argument) {
    o->resume = argument;
    return TOOL_OK;
}

int read_from(options *o, const char *argument) {
    o->from = argument;
    return TOOL_OK;
}

int read_quiet(options *o, const char *argument) {
    (void)argument;
    o->quiet = true;
    return TOOL_OK;
}

int read_portable(options *o, const char *argument) {
    (void)argument;
    o->portable = true;
    return TOOL_OK;
}

int read_native(options *o, const char *argument) {
    static const char *const names[] = {"auto", "always", "never", NULL};
    int which;
    int status = read_name("native", argument, names, &which);
    o->native.use = (nevh_native_use)which;
    o->native.given = true;
    return status;
}

int read_header(options *o, const char *argument) {
    (void)argument;
    o->header = true;
    return TOOL_OK;
}

int read_no_cache(options *o, const char *argument) {
    (void)argument;
    o->native.no_cache = true;
    return TOOL_OK;
}

int read_all(options *o, const char *argument) {
    (void)argument;
    o->all = true;
    return TOOL_OK;
}

int read_allow_code(options *o, const char *argument) {
    (void)argument;
    o->allow_code = true;
    return TOOL_OK;
}

int read_diagnostics(options *o, const char *argument) {
    (void)argument;
    o->diagnostics = true;
    return TOOL_OK;
}

int read_impact(options *o, const char *argument) {
    (void)argument;
    o->impact = true;
    return TOOL_OK;
}

int read_help(options *o, const char *argument) {
    (void)argument;
    o->help = true;
    return TOOL_OK;
}

int read_version(options *o, const char *argument) {
    (void)argument;
    o->version = true;
    return TOOL_OK;
}

/* nevh: what the arguments of options mean.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "options_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The member of the options that an option sets. */
static void *target(options *o, const option_row *row) {
    return (char *)o + row->target;
}

int read_flag(options *o, const option_row *row, const char *argument) {
    (void)argument;
    *(bool *)target(o, row) = true;
    return TOOL_OK;
}

int read_text(options *o, const option_row *row, const char *argument) {
    *(const char **)target(o, row) = argument;
    return TOOL_OK;
}

int read_line(options *o, const option_row *row, const char *argument) {
    list_add(target(o, row), argument);
    return TOOL_OK;
}

/* The names of a list, behind the mark of the row, if any. */
int read_names(options *o, const option_row *row, const char *argument) {
    const char before[] = {row->mark, '\0'};
    list names = {0};
    int status = TOOL_OK;
    list_split(&names, argument);
    for (size_t i = 0; !status && i < names.count; i++) {
        const char *name = names.item[i];
        if (!*name)
            status = tool_refuse("--%s: a name is missing in \"%s\"", row->name,
                                 argument);
        else if (strchr(name, ' '))
            status = tool_refuse("--%s: names are separated by commas, not "
                                 "\"%s\"",
                                 row->name, name);
        else
            list_print(target(o, row), "%s%s", before, name);
    }
    return status;
}

/* Finds the comma before the next NAME = VALUE: outside of brackets, with a name
   and "=" after it; other commas separate values. */
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

int read_settings(options *o, const option_row *row, const char *argument) {
    for (const char *next; argument; argument = next) {
        next = next_assignment(argument);
        int length = next ? (int)(next - argument) - 1 : (int)strlen(argument);
        list_print(&o->settings, "%c%.*s", row->mark, length, argument);
    }
    return TOOL_OK;
}

static int read_number(const char *option, const char *text, double *number) {
    char *end;
    bool decimal = text[strspn(text, "0123456789.eE+-")] == '\0';
    *number = strtod(text, &end);
    if (decimal && end != text && !*end && isfinite(*number))
        return TOOL_OK;
    return tool_refuse("--%s takes numbers, not \"%s\"", option, text);
}

static int positive(const char *option, const char *text, double *number) {
    if (read_number(option, text, number))
        return TOOL_USAGE;
    if (*number > 0)
        return TOOL_OK;
    return tool_refuse("--%s takes numbers above 0, not %s", option, text);
}

int read_positive(options *o, const option_row *row, const char *argument) {
    return positive(row->name, argument, target(o, row));
}

int read_tolerance(options *o, const option_row *row, const char *argument) {
    list texts = {0};
    int status = TOOL_OK;
    list_split(&texts, argument);
    o->tolerance = tool_allocate(texts.count, sizeof *o->tolerance);
    o->tolerances = texts.count;
    for (size_t i = 0; !status && i < texts.count; i++)
        status = positive(row->name, texts.item[i], &o->tolerance[i]);
    return status;
}

/* Formulas, whose commas inside of parentheses stay. */
int read_formulas(options *o, const option_row *row, const char *argument) {
    list *l = target(o, row);
    *l = (list){0};
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

static int whole(const char *option, const char *text, size_t *count) {
    double number;
    if (positive(option, text, &number))
        return TOOL_USAGE;
    if (number != floor(number) || number > 0x1p53)
        return tool_refuse("--%s takes a whole number, not %s", option, text);
    *count = (size_t)number;
    return TOOL_OK;
}

int read_count(options *o, const option_row *row, const char *argument) {
    size_t *count = target(o, row);
    if (whole(row->name, argument, count))
        return TOOL_USAGE;
    return !row->most || *count <= row->most
               ? TOOL_OK
               : tool_refuse("--%s takes 1 to %zu, not %s", row->name,
                             row->most, argument);
}

int read_exponents(options *o, const option_row *row, const char *argument) {
    o->chaos.all = strcmp(argument, "all") == 0;
    return o->chaos.all ? TOOL_OK
                        : whole(row->name, argument, &o->chaos.exponents);
}

int read_data(options *o, const option_row *row, const char *argument) {
    o->fit.data = argument;
    return *argument ? TOOL_OK : tool_refuse("--%s takes a file", row->name);
}

int read_output(options *o, const option_row *row, const char *argument) {
    if (strcmp(argument, "-") == 0)
        return tool_refuse("--%s takes a file; without it rows go to the "
                           "terminal",
                           row->name);
    o->file = argument;
    return TOOL_OK;
}

/* 90, 90s, 50m, 2h, 1d */
int read_stop_after(options *o, const option_row *row, const char *argument) {
    static const char units[] = "smhd";
    static const double seconds[] = {1, 60, 3600, 86400};
    size_t length = strlen(argument);
    const char *unit = length ? strchr(units, argument[length - 1]) : NULL;
    char *number = text_print("%.*s", (int)(length - (unit != NULL)), argument);
    int status = positive(row->name, number, &o->stop_after);
    o->stop_after *= unit ? seconds[unit - units] : 1;
    return status;
}

/* I/N */
int read_task(options *o, const option_row *row, const char *argument) {
    char *slash = strchr(argument, '/');
    char *part =
        text_print("%.*s", slash ? (int)(slash - argument) : 0, argument);
    int status =
        slash ? whole(row->name, part, &o->task)
              : tool_refuse("--task is written 3/16, not \"%s\"", argument);
    if (!status)
        status = whole(row->name, slash + 1, &o->tasks);
    if (!status && o->task > o->tasks)
        return tool_refuse("--task %s: there are %zu", argument, o->tasks);
    return status;
}

int read_choice(options *o, const option_row *row, const char *argument) {
    list words = {0};
    unsigned i = 0;
    int status = TOOL_OK;
    list_split_at(&words, row->words, '|');
    while (i < words.count && strcmp(argument, words.item[i]) != 0)
        i++;
    if (i == words.count)
        status = tool_refuse("--%s is %s, not \"%s\"", row->name,
                             list_sentence(&words, "or"), argument);
    i += row->first;
    memcpy(target(o, row), &i, sizeof i);
    return status;
}

int read_section(options *o, const option_row *row, const char *argument) {
    (void)row;
    list_split(&o->sections, argument);
    return TOOL_OK;
}

/* nevh: the command line.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef int reader(options *, const char *argument);

static int read_with(options *o, const char *argument) {
    list_print(&o->settings, "+%s", argument);
    return TOOL_OK;
}

static int read_without(options *o, const char *argument) {
    list_print(&o->settings, "-%s", argument);
    return TOOL_OK;
}

static int read_set(options *o, const char *argument) {
    list_print(&o->settings, "=%s", argument);
    return TOOL_OK;
}

static int read_integrators(options *o, const char *argument) {
    list_split(&o->integrators, argument);
    return TOOL_OK;
}

static int read_gradient(options *o, const char *argument) {
    list_split(&o->gradients, argument);
    return TOOL_OK;
}

static int read_number(const char *option, const char *text, double *number) {
    char *end;
    *number = strtod(text, &end);
    if (end != text && !*end && isfinite(*number))
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

static int read_dt(options *o, const char *argument) {
    list texts = {0};
    int status = TOOL_OK;
    list_split(&texts, argument);
    free(o->dt);
    o->dt = tool_allocate(texts.count, sizeof *o->dt);
    o->dts = texts.count;
    for (size_t i = 0; !status && i < texts.count; i++)
        status = read_positive("dt", texts.item[i], &o->dt[i]);
    list_free(&texts);
    return status;
}

static int read_t_end(options *o, const char *argument) {
    return read_number("t-end", argument, &o->t_end);
}

static int read_gradient_step(options *o, const char *argument) {
    return read_positive("gradient-step", argument, &o->gradient_step);
}

static int read_match(options *o, const char *argument) {
    (void)o;
    if (strcmp(argument, "steps") == 0)
        return TOOL_OK;
    if (strcmp(argument, "work") == 0)
        return tool_refuse("--match work is not there yet: rows are matched "
                           "by steps");
    return tool_refuse("--match is steps or work, not \"%s\"", argument);
}

static int read_format(options *o, const char *argument) {
    static const char *const names[] = {"table", "csv", "json"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(argument, names[i]) == 0) {
            o->format = (table_format)i;
            return TOOL_OK;
        }
    return tool_refuse("--format is table, csv or json, not \"%s\"", argument);
}

static int read_file(options *o, const char *argument) {
    o->file = argument;
    return TOOL_OK;
}

static int read_quiet(options *o, const char *argument) {
    (void)argument;
    o->quiet = true;
    return TOOL_OK;
}

static int read_portable(options *o, const char *argument) {
    (void)argument;
    o->portable = true;
    return TOOL_OK;
}

static int read_all(options *o, const char *argument) {
    (void)argument;
    o->all = true;
    return TOOL_OK;
}

static int read_help(options *o, const char *argument) {
    (void)argument;
    o->help = true;
    return TOOL_OK;
}

static int read_version(options *o, const char *argument) {
    (void)argument;
    o->version = true;
    return TOOL_OK;
}

/* The commands that each option is for, as letters of `letters` below; NULL:
   all. */
static const struct {
    const char *name, *argument, *commands;
    reader *read;
    const char *help;
} known[] = {
    {"with", "EFFECT", "cef", read_with, "switch an effect on"},
    {"without", "EFFECT", "cef", read_without, "switch an effect off"},
    {"set", "NAME=VALUE", "cef", read_set, "change a parameter"},
    {"integrators", "A,B", "cef", read_integrators, "instead of the scene's"},
    {"dt", "A,B", "cef", read_dt, "time steps, instead of the scene's"},
    {"t-end", "T", "cef", read_t_end, "the end, instead of the scene's"},
    {"gradient", "A,B", "cef", read_gradient,
     "central2, central4, ...; see nevh list gradients"},
    {"gradient-step", "D", "cef", read_gradient_step,
     "half-spread of the differences; chosen by trial if not given"},
    {"match", "steps|work", "c", read_match,
     "what the rows of one dt have in common (only steps, for now)"},
    {"portable", NULL, "cef", read_portable,
     "no vector code: the same digits with the same libm"},
    {"all", NULL, "l", read_all, "with names in other packages and sources"},
    {"format", "table|csv|json", "celf", read_format, ""},
    {"output", "FILE", "celf", read_file, "write there (-o), when it is whole"},
    {"quiet", NULL, "celf", read_quiet, "the table alone, and no progress"},
    {"help", NULL, NULL, read_help, ""},
    {"version", NULL, NULL, read_version, ""},
};
enum { KNOWN = sizeof known / sizeof *known };

void options_help(FILE *f) {
    fputs("\nOptions:\n", f);
    for (size_t i = 0; i < KNOWN; i++) {
        char text[80];
        snprintf(text, sizeof text, "--%s %s", known[i].name,
                 known[i].argument ? known[i].argument : "");
        fprintf(f, *known[i].help ? "  %-25s %s\n" : "  %s\n", text,
                known[i].help);
    }
}

static int unknown_option(const char *text) {
    list names = {0};
    if (strncmp(text, "--", 2) != 0)
        return tool_refuse("unknown option %s", text);
    char *name = text_print("%.*s", (int)strcspn(text, "="), text);
    for (size_t i = 0; i < KNOWN; i++)
        list_print(&names, "--%s", known[i].name);
    int status = tool_unknown("option", name, &names);
    list_free(&names);
    free(name);
    return status;
}

static void describe(struct option described[KNOWN + 1]) {
    memset(described, 0, (KNOWN + 1) * sizeof *described);
    for (int i = 0; i < KNOWN; i++)
        described[i] = (struct option){
            known[i].name, known[i].argument ? required_argument : no_argument,
            NULL, 256 + i};
}

static int read_one(options *o, int code, bool used[KNOWN], char **argv) {
    const char *text = argv[optind - 1];
    if (code == ':')
        return tool_refuse("%s needs an argument", text);
    if (code == 'o')
        return read_file(o, optarg);
    if (code == 'h')
        return read_help(o, NULL);
    if (code < 256)
        return optopt && strncmp(text, "--", 2) != 0
                   ? tool_refuse("unknown option -%c", optopt)
                   : unknown_option(text);
    used[code - 256] = true;
    return known[code - 256].read(o, optarg);
}

static int check_use(const options *o, const bool used[KNOWN]) {
    const char *word = o->operands.count ? o->operands.item[0] : "";
    static const char *const letters[][2] = {
        {"compare", "c"}, {"check", "e"}, {"effects", "f"}, {"list", "l"}};
    for (size_t i = 0; i < sizeof letters / sizeof *letters; i++)
        for (size_t k = 0; k < KNOWN; k++)
            if (used[k] && known[k].commands &&
                strcmp(word, letters[i][0]) == 0 &&
                !strstr(known[k].commands, letters[i][1]))
                return tool_refuse("--%s is no option of nevh %s",
                                   known[k].name, word);
    return TOOL_OK;
}

int options_read(options *o, int argc, char **argv) {
    struct option described[KNOWN + 1];
    bool used[KNOWN] = {false};
    int status = TOOL_OK, code;
    *o = (options){.t_end = NAN};
    describe(described);
    opterr = 0;
    while (!status &&
           (code = getopt_long(argc, argv, ":o:h", described, NULL)) != -1)
        status = read_one(o, code, used, argv);
    for (int i = optind; i < argc; i++)
        list_add(&o->operands, argv[i]);
    return status ? status : check_use(o, used);
}

void options_free(options *o) {
    list_free(&o->operands);
    list_free(&o->settings);
    list_free(&o->integrators);
    list_free(&o->gradients);
    free(o->dt);
}

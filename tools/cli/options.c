/* nevh: the command line.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "options_private.h"
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    OF_COST = FOR_COST | FOR_GRADIENTS | FOR_RECOMMEND,
    OF_SCENES = FOR_EXPORT | FOR_COMPARE | FOR_CHECK | FOR_EFFECTS | FOR_RUN |
                FOR_SECTION | FOR_SWEEP | FOR_FLOW | FOR_PORTRAIT |
                FOR_REFERENCE | FOR_REPORT | FOR_CHAOS | FOR_FREQUENCIES |
                FOR_FIT | OF_COST,
    OF_STEPS = OF_SCENES & ~FOR_REFERENCE, /* of an integrator */
    OF_NATIVE = FOR_COMPARE | FOR_RUN | FOR_SECTION | FOR_SWEEP | FOR_PORTRAIT |
                OF_COST,
    OF_TABLES = (OF_SCENES & ~(FOR_EXPORT | FOR_REPORT | FOR_PORTRAIT)) |
                FOR_LIST | FOR_HARD,
    OF_PLOTS = FOR_COMPARE | FOR_RUN | FOR_SECTION | FOR_COST | FOR_GRADIENTS |
               FOR_FLOW | FOR_PORTRAIT | FOR_EFFECTS
};

/* The commands that each option is for, as an or. */
static const struct {
    const char *name, *argument;
    unsigned commands;
    reader *read;
    const char *help;
} known[] = {
    {"with", "A,B", OF_SCENES | FOR_NEW | FOR_PAGE, read_with,
     "switch effects on"},
    {"without", "A,B", OF_SCENES | FOR_NEW | FOR_PAGE, read_without,
     "switch effects off"},
    {"set", "NAME=VALUE", OF_SCENES | FOR_NEW | FOR_PAGE, read_set,
     "change a parameter; several: A=1,B=2"},
    {"variant", "NAME=VALUE", FOR_REPORT, read_variant,
     "each scene also with these parameters, beside the other variants; "
     "several: A=1,B=2; repeated for more variants"},
    {"start", "NAME=VALUE", OF_SCENES | FOR_PAGE, read_start,
     "where a coordinate x, a momentum p_x or a velocity v_x starts"},
    {"integrators", "A,B", OF_STEPS | FOR_HARD | FOR_PAGE, read_integrators,
     "see nevh list integrators; instead of the scene's"},
    {"dt", "A,B", OF_STEPS | FOR_PAGE, read_dt,
     "time steps, instead of the scene's; formulas such as pi/50"},
    {"tolerance", "A,B",
     FOR_COMPARE | FOR_RUN | FOR_SECTION | FOR_SWEEP | FOR_FLOW | FOR_PORTRAIT |
         FOR_FREQUENCIES | FOR_FIT | FOR_EXPORT,
     read_tolerance,
     "of integrators that choose their steps; instead of the scene's"},
    {"t-end", "T", OF_SCENES, read_t_end,
     "the end, instead of the scene's; a formula"},
    {"gradient", "A,B", OF_STEPS | FOR_HARD | FOR_PAGE, read_gradient,
     "central2, central4, ...; see nevh list gradients"},
    {"gradient-step", "D", OF_STEPS, read_gradient_step,
     "step D of the finite differences, (H(x+D) - H(x-D))/2D; found "
     "automatically if not given"},
    {"by", "energy|state", FOR_COST, read_by,
     "count digits of the energy (default) or of the orbit"},
    {"energy-error", "X", FOR_RECOMMEND, read_energy_error,
     "largest relative energy error allowed"},
    {"state-error", "X", FOR_RECOMMEND, read_state_error,
     "largest relative error of the orbit allowed"},
    {"observable", "FORMULA",
     FOR_COMPARE | FOR_COST | FOR_RECOMMEND | FOR_FREQUENCIES, read_observable,
     "the formula, or observable, whose errors or frequencies are found; errors "
     "are relative to its range"},
    {"error", "X", FOR_RECOMMEND, read_error,
     "largest error of the observable allowed"},
    {"repeat", "N", FOR_COMPARE | FOR_COST | FOR_RECOMMEND, read_repeat,
     "number of timed runs; the median is printed"},
    {"budget", "SECONDS", FOR_COST | FOR_CHAOS, read_budget,
     "of processor time for all runs, about; if not given, cost takes a minute "
     "at most"},
    {"every", "K", FOR_RUN | FOR_EXPORT, read_every,
     "a row after every K steps, and at the end"},
    {"samples", "N", FOR_RUN | FOR_FLOW | FOR_CHAOS, read_samples,
     "N rows at equal times, the first and the last included"},
    {"at", "T1,T2", FOR_RUN | FOR_FLOW | FOR_REFERENCE, read_at,
     "rows at these times only"},
    {"picture", "FILE", FOR_SWEEP, read_picture,
     "draw the outcome over what is varied, one number or two: FILE.svg, .png "
     "or .pdf"},
    {"shape", "SHAPE", FOR_FLOW, read_shape,
     "disc(x = 1, p_x = 0, RADIUS), box(x = 1, p_x = 0, WIDTH, HEIGHT), cat(x "
     "= 1, p_x = 0, SIZE), or loop(x = cos(t), p_x = sin(t)) of formulas of t "
     "from 0 to 2*pi; a cat round the start if not given"},
    {"digits", "N", FOR_REFERENCE, read_digits,
     "digits of the states, 1 to 30; 24 if not given"},
    {"exponents", "N|all", FOR_CHAOS, read_exponents,
     "the N largest exponents, or all, instead of the largest"},
    {"starts", "N", FOR_CHAOS, read_starts,
     "run N orbits that start close together at the same energy; the error "
     "contains their spread; 8 if not given"},
    {"gali", "K", FOR_CHAOS, read_gali,
     "the generalised alignment indices of up to K displacements"},
    {"resume", "FILE", FOR_RUN | FOR_SWEEP, read_resume,
     "continue FILE, which nevh run or nevh sweep -o FILE left unfinished"},
    {"vary", "NAME=WHAT", FOR_SWEEP | FOR_SECTION | FOR_PORTRAIT | FOR_FIT,
     read_vary,
     "a line of [ensemble]: a list, range(A, B, N), normal(M, S), "
     "uniform(A, B) or solve(F = G, from X); repeated for more names; of fit: "
     "names A,B of parameters and starts"},
    {"data", "FILE", FOR_FIT | FOR_RUN | FOR_PORTRAIT | FOR_SWEEP, read_data,
     "measured points, as CSV: t, and columns named as in the scene; run prints "
     "residuals, and pictures show the points"},
    {"sigma", "X", FOR_FIT, read_sigma,
     "the standard deviation of all measured numbers; columns sigma or "
     "sigma_NAME of the data give it for each point"},
    {"outcomes", "A,B", FOR_SWEEP, read_outcomes,
     "columns, such as mean(F); nevh help sweep lists them"},
    {"retry", NULL, FOR_SWEEP, read_retry,
     "with --resume: repeat the members that failed"},
    {"stop-after", "TIME", FOR_SWEEP | FOR_REFERENCE, read_stop_after,
     "sweep: after 50m, 2h or 90s finish the running members and end with "
     "exit status 3; reference: refuse orbits that take longer (10m)"},
    {"task", "I/N", FOR_SWEEP, read_task,
     "run only part I of N, into FILE.I-of-N.npy"},
    {"join", NULL, FOR_SWEEP, read_join,
     "combine the parts FILE.1-of-N.npy, ... into -o FILE.npy"},
    {"threads", "N", FOR_SWEEP, read_threads,
     "number of threads; as many as processors if not given"},
    {"width", "N", FOR_SWEEP, read_width,
     "number of orbits that a thread runs side by side; changes no digit; "
     "chosen if not given"},
    {"transform", "FORMULA", FOR_COMPARE | FOR_RUN | FOR_SECTION | FOR_SWEEP,
     read_transform,
     "of time, for integrators NAME+transform; instead of the scene's"},
    {"match", "steps|work", FOR_COMPARE, read_match,
     "work: rows take equal numbers of gradients instead of equal steps"},
    {"diagnostics", NULL, FOR_COMPARE, read_diagnostics,
     "symplecticity, reversal, solvers, invariants, energies by effect and "
     "body"},
    {"portable", NULL, OF_STEPS, read_portable,
     "no vector code: the same digits with the same libm"},
    {"native", "auto|never|always", OF_NATIVE, read_native,
     "compile steps of formulas; auto (default): if that saves time"},
    {"no-cache", NULL, OF_NATIVE, read_no_cache,
     "keep no compiled steps, and use none that were kept"},
    {"plot", "FILE", OF_PLOTS, read_plot,
     "draw FILE.svg, .png or .pdf, or - in the terminal"},
    {"plot-kind", "KIND", FOR_RUN | FOR_COMPARE | FOR_COST, read_plot_kind,
     "of run: phase (the default), time, energy, configuration or animation (a "
     ".gif of that); of compare "
     "and cost: order, errors against dt with slopes"},
    {"columns", "A,B:C", FOR_RUN | FOR_FIT, read_columns,
     "of fit: the columns of the data to use; of run: what --plot-kind time or "
     "phase draws: a panel each, names joined by : in one; t, coordinates, "
     "p_NAME, observables, energy, energy_error, shadow_error"},
    {"keep-plot-script", "FILE", OF_PLOTS | FOR_SWEEP, read_plot_script,
     "write the commands for gnuplot, with the data"},
    {"header", NULL, FOR_EXPORT, read_header,
     "write functions for another program, instead of a program"},
    {"section", "A,B", FOR_SECTION | FOR_PORTRAIT, read_section,
     "only these sections"},
    {"after", "T", FOR_SECTION, read_after,
     "leave out points before T, as of a transient; a formula"},
    {"from", "SCENE", FOR_NEW, read_from, "the scene to begin with"},
    {"allow-code", NULL, OF_SCENES | FOR_NEW, read_allow_code,
     "compile and run C code that the scene names"},
    {"impact", NULL, FOR_EFFECTS, read_impact,
     "what each effect changes in the orbit, costs, and rules out"},
    {"all", NULL, FOR_LIST | FOR_HARD | FOR_CHECK, read_all,
     "list: also the names in other packages, and sources. check: all "
     "integrators. hard: each run"},
    {"format", "table|csv|json", OF_TABLES, read_format,
     "csv for run, section and sweep, table for others, if not given"},
    {"output", "FILE", OF_TABLES | FOR_EXPORT | FOR_REPORT | FOR_PAGE,
     read_file, "write FILE when it is complete; nevh run: line by line"},
    {"quiet", NULL, OF_TABLES | FOR_NEW | FOR_PORTRAIT, read_quiet,
     "only the table: no # lines, no notes, no progress"},
    {"help", NULL, ~0u, read_help, "this text"},
    {"version", NULL, ~0u, read_version, "version and licence"},
};
enum { KNOWN = sizeof known / sizeof *known };

void help_print(FILE *f, int used, int column, const char *text) {
    enum { WIDTH = 80 };
    if (column > 0 && used + 2 > column) {
        fputc('\n', f);
        used = 0;
    }
    for (; *text; used = 0) {
        size_t end = strlen(text);
        if (end > (size_t)(WIDTH - column))
            for (end = (size_t)(WIDTH - column); end && text[end] != ' ';)
                end--;
        end = end ? end : strcspn(text, " ");
        fprintf(f, "%*s%.*s\n", column - used, "", (int)end, text);
        text += end;
        text += strspn(text, " ");
    }
}

/* Options that are letters, too. */
static const char *letter_of(const char *name) {
    return strcmp(name, "output") == 0 ? "-o, "
           : strcmp(name, "help") == 0 ? "-h, "
                                       : "";
}

void options_help(FILE *f, unsigned which) {
    fputs("\nOptions:\n", f);
    for (size_t i = 0; i < KNOWN; i++) {
        const char *argument = known[i].argument;
        if (!(known[i].commands & which))
            continue;
        int used =
            fprintf(f, "  %s--%s%s%s", letter_of(known[i].name), known[i].name,
                    argument ? " " : "", argument ? argument : "");
        help_print(f, used, 28, known[i].help);
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

static int read_one(options *o, int code, char **argv) {
    const char *text = argv[optind - 1];
    if (code == ':')
        return tool_refuse("%s needs an argument", text);
    if (code == 1)
        return list_add(&o->operands, optarg), TOOL_OK;
    if (code == 'o')
        return read_file(o, optarg);
    if (code == 'h')
        return read_help(o, NULL);
    if (code < 256)
        return optopt && strncmp(text, "--", 2) != 0
                   ? tool_refuse("unknown option -%c", optopt)
                   : unknown_option(text);
    o->used |= 1ull << (code - 256);
    return known[code - 256].read(o, optarg);
}

/* Operands come in turn, between options, also under POSIXLY_CORRECT. */
int options_read(options *o, int argc, char **argv) {
    struct option described[KNOWN + 1];
    int status = TOOL_OK, code;
    *o = (options){0};
    describe(described);
    opterr = 0;
    while (!status &&
           (code = getopt_long(argc, argv, "-:o:h", described, NULL)) != -1)
        status = read_one(o, code, argv);
    for (int i = optind; i < argc; i++)
        list_add(&o->operands, argv[i]);
    return status;
}

const char *command_name(unsigned bit) {
#define COMMAND_NAME(run, id, name)                                            \
    case FOR_##id:                                                             \
        return name;
    switch (bit) {
        COMMANDS(COMMAND_NAME)
    default:
        return "";
    }
}

/* What to do instead, of commands that could be thought to take an option. */
static const struct {
    const char *option;
    unsigned commands;
    const char *advice;
} instead[] = {{"vary", FOR_FLOW,
                "its starts are those of --shape; --set sets a parameter, for "
                "a run for each value"}};

static const char *advice_for(const char *option, unsigned of) {
    for (size_t i = 0; i < sizeof instead / sizeof *instead; i++)
        if (instead[i].commands & of && strcmp(instead[i].option, option) == 0)
            return instead[i].advice;
    return NULL;
}

/* With what to do instead, or the commands that it is for, where they are few. */
static int refuse_option(int k, const char *name, unsigned of) {
    enum { FEW = 5 };
    const char *advice = advice_for(known[k].name, of);
    if (advice)
        return tool_refuse("--%s is no option of nevh %s: %s", known[k].name,
                           name, advice);
    list those = {0};
    for (unsigned bit = 1; bit < 1u << COMMAND_COUNT; bit *= 2)
        if (known[k].commands & bit)
            list_add(&those, command_name(bit));
    char *text = list_joined(&those);
    int status =
        tool_refuse(those.count <= FEW ? "--%s is no option of nevh "
                                         "%s; it is for %s"
                                       : "--%s is no option of nevh %s",
                    known[k].name, name, text);
    free(text);
    list_free(&those);
    return status;
}

int options_check(const options *o, unsigned which) {
    for (int k = 0; k < KNOWN; k++)
        if (o->used >> k & 1 && !(known[k].commands & which))
            return refuse_option(k, o->operands.item[0], which);
    return plot_kind_check(o, which);
}

void settings_notes(const options *o, list *notes) {
    for (size_t i = 0; i < o->settings.count; i++)
        if (o->settings.item[i][0] == '=')
            list_print(notes, "set: %s", o->settings.item[i] + 1);
        else if (o->settings.item[i][0] == '@')
            list_print(notes, "start: %s", o->settings.item[i] + 1);
}

void options_free(options *o) {
    list_free(&o->operands);
    list_free(&o->settings);
    list_free(&o->integrators);
    list_free(&o->gradients);
    list_free(&o->sections);
    list_free(&o->variants);
    list_free(&o->vary);
    list_free(&o->dt);
    list_free(&o->at);
    free(o->tolerance);
}

/* nevh: the command line.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "options_private.h"
#include <assert.h>
#include <getopt.h>
#include <stddef.h>
#include <string.h>

/* A member of the options, whose type is checked: kind, reader, place. */
#define MEMBER(type, member)                                                   \
    (offsetof(options, member) +                                               \
     0 * sizeof((type *)0 == &((options *)0)->member))
#define KIND(name, reader, to) .kind = name, .read = reader, .target = to
#define FLAG(member)           KIND("flag", read_flag, MEMBER(bool, member))
#define TEXT(kind, member)     KIND(kind, read_text, MEMBER(const char *, member))
#define FORMULA(member)        TEXT("formula", member)
#define FILE_NAME(member)      TEXT("file", member)
#define NUMBER(member)         KIND("number", read_positive, MEMBER(double, member))
#define COUNT(member)          KIND("count", read_count, MEMBER(size_t, member))
#define NAMES(kind, member)    KIND(kind, read_names, MEMBER(list, member))
#define LINE(kind, member)     KIND(kind, read_line, MEMBER(list, member))
#define FORMULAS(member)       KIND("formulas", read_formulas, MEMBER(list, member))
#define SETTINGS               KIND("settings", read_settings, 0)
#define CHOICE(type, member)   KIND("choice", read_choice, MEMBER(type, member))
#define TAKEN(kind, reader)    KIND(kind, reader, 0)
static_assert(sizeof(plot_kind) == sizeof(unsigned),
              "read_choice writes these");

const option_row option_rows[] = {
    {"with", "A,B", NAMES("effects", settings), "SCENE", "switch effects on",
     .mark = '+'},
    {"without", "A,B", NAMES("effects", settings), "SCENE",
     "switch effects off", .mark = '-'},
    {"set", "NAME=VALUE", SETTINGS, "SCENE",
     "change a parameter; several: A=1,B=2", .mark = '='},
    {"variant", "NAME=VALUE", LINE("assignments", variants), NULL,
     "each scene also with these parameters, beside the other variants; "
     "several: A=1,B=2; repeated for more variants"},
    {"start", "NAME=VALUE", SETTINGS, "SCENE",
     "where a coordinate x, a momentum p_x or a velocity v_x starts",
     .mark = '@'},
    {"integrators", "A,B", NAMES("integrators", integrators), "STEPS",
     "see nevh list integrators; instead of the scene's"},
    {"dt", "A,B", FORMULAS(dt), "STEPS",
     "time steps, instead of the scene's; formulas such as pi/50"},
    {"tolerance", "A,B", TAKEN("numbers", read_tolerance), NULL,
     "of integrators that choose their steps; instead of the scene's"},
    {"t-end", "T", FORMULA(t_end), "SCENE",
     "the end, instead of the scene's; a formula"},
    {"gradient", "A,B", NAMES("gradients", gradients), "STEPS",
     "central2, central4, ...; see nevh list gradients"},
    {"gradient-step", "D", NUMBER(gradient_step), "STEPS",
     "step D of the finite differences, (H(x+D) - H(x-D))/2D; found "
     "automatically if not given"},
    {"by", "energy|state", CHOICE(unsigned, search.by), NULL,
     "count digits of the energy (default) or of the orbit",
     .words = "energy|state"},
    {"against", "work|length", CHOICE(unsigned, search.against), NULL,
     "length: digits of the scene's integrators at equal work against the length "
     "of the run; of the orbit, unless --by energy",
     .words = "work|length"},
    {"energy-error", "X", NUMBER(search.energy_error), NULL,
     "largest relative energy error allowed"},
    {"state-error", "X", NUMBER(search.state_error), NULL,
     "largest relative error of the orbit allowed"},
    {"observable", "FORMULA", FORMULA(observable), NULL,
     "the formula, or observable, whose errors or frequencies are found; errors "
     "are relative to its range"},
    {"error", "X", NUMBER(search.error), NULL,
     "largest error of the observable allowed"},
    {"repeat", "N", COUNT(search.repeats), NULL,
     "number of timed runs; the median is printed"},
    {"budget", "SECONDS", NUMBER(search.budget), NULL,
     "of processor time for all runs, about; if not given, cost takes a minute "
     "at most"},
    {"every", "K", COUNT(every), NULL,
     "a row after every K steps, and at the end"},
    {"samples", "N", COUNT(samples), NULL,
     "N rows at equal times, the first and the last included"},
    {"at", "T1,T2", FORMULAS(at), NULL, "rows at these times only"},
    {"picture", "FILE", FILE_NAME(picture), NULL,
     "draw the outcome over what is varied, one number or two: FILE.svg, .png "
     "or .pdf"},
    {"shape", "SHAPE", TEXT("shape", shape), NULL,
     "disc(x = 1, p_x = 0, RADIUS), box(x = 1, p_x = 0, WIDTH, HEIGHT), cat(x "
     "= 1, p_x = 0, SIZE), or loop(x = cos(t), p_x = sin(t)) of formulas of t "
     "from 0 to 2*pi; a cat round the start if not given"},
    {"digits", "N", COUNT(digits), NULL,
     "digits of the states, 1 to 30; 24 if not given", .most = 30},
    {"exponents", "N|all", TAKEN("count-or-all", read_exponents), NULL,
     "the N largest exponents, or all, instead of the largest"},
    {"starts", "N", COUNT(chaos.starts), NULL,
     "run N orbits that start close together at the same energy; the error "
     "contains their spread; 8 if not given"},
    {"gali", "K", COUNT(chaos.deviations), NULL,
     "the generalised alignment indices of up to K displacements"},
    {"resume", "FILE", FILE_NAME(resume), NULL,
     "continue FILE, which nevh run or nevh sweep -o FILE left unfinished"},
    {"vary", "NAME=WHAT", LINE("assignment", vary), NULL,
     "a line of [ensemble]: a list, range(A, B, N), normal(M, S), "
     "uniform(A, B) or solve(F = G, from X); repeated for more names; of fit: "
     "names A,B of parameters and starts"},
    {"data", "FILE", TAKEN("file", read_data), NULL,
     "measured points, as CSV: t, and columns named as in the scene; run prints "
     "residuals, and pictures show the points"},
    {"sigma", "X", NUMBER(fit.sigma), NULL,
     "the standard deviation of all measured numbers; columns sigma or "
     "sigma_NAME of the data give it for each point"},
    {"outcomes", "A,B", TEXT("outcomes", outcomes), NULL,
     "columns, such as mean(F); nevh help sweep lists them"},
    {"retry", NULL, FLAG(retry), NULL,
     "with --resume: repeat the members that failed"},
    {"stop-after", "TIME", TAKEN("time", read_stop_after), NULL,
     "sweep: after 50m, 2h or 90s leave the rest to --resume and end with "
     "exit status 3; reference: refuse orbits that take longer (10m)"},
    {"task", "I/N", TAKEN("part", read_task), NULL,
     "run only part I of N, into FILE.I-of-N.npy"},
    {"join", NULL, FLAG(join), NULL,
     "combine the parts FILE.1-of-N.npy, ... into -o FILE.npy"},
    {"threads", "N", COUNT(threads), NULL,
     "number of threads; as many as processors if not given", .most = 4096},
    {"width", "N", COUNT(width), NULL,
     "number of orbits that a thread runs side by side; changes no digit; "
     "chosen if not given",
     .most = 4096},
    {"transform", "FORMULA", FORMULA(transform), NULL,
     "of time, for integrators NAME+transform; instead of the scene's"},
    {"match", "steps|work", CHOICE(matching, match), NULL,
     "work: rows take equal numbers of gradients instead of equal steps",
     .first = MATCH_STEPS, .words = "steps|work"},
    {"diagnostics", NULL, FLAG(diagnostics), NULL,
     "symplecticity, reversal, solvers, invariants, energies by effect and "
     "body"},
    {"portable", NULL, FLAG(portable), "STEPS",
     "terms in C state by state, not as vector code"},
    {"native", "auto|never|always", CHOICE(nevh_native_use, native.use),
     "NATIVE", "compile steps of formulas; auto (default): if that saves time",
     .words = "auto|always|never"},
    {"no-cache", NULL, FLAG(native.no_cache), "NATIVE",
     "keep no compiled steps, and use none that were kept"},
    {"plot", "FILE", FILE_NAME(plot.file), "PLOT",
     "draw FILE.svg; by gnuplot .png or .pdf, or - in the terminal"},
    {"plot-narrow", NULL, FLAG(plot.is_narrow), "PLOT",
     "lay the .svg out for 400 pixels, panels and key one below the other"},
    {"plot-kind", "KIND", CHOICE(plot_kind, plot.kind), NULL,
     "of run" RUN_PLOTS(PLOT_HELP) "; of compare and cost: order, errors "
                                   "against dt with slopes",
     .first = PLOT_KIND_phase, .words = &(RUN_PLOTS(PLOT_WORD) "|order")[1]},
    {"columns", "A,B:C", TEXT("columns", columns), NULL,
     "of fit: the columns of the data to use; of run: what --plot-kind time or "
     "phase draws: a panel each, names joined by : in one; t, coordinates, "
     "p_NAME, observables, energy, energy_error, shadow_error"},
    {"keep-plot-script", "FILE", FILE_NAME(plot.script), "PLOT",
     "write the commands for gnuplot, with the data"},
    {"header", NULL, FLAG(header), NULL,
     "write functions for another program, instead of a program"},
    {"section", "A,B", TAKEN("sections", read_section), NULL,
     "only these sections"},
    {"after", "T", FORMULA(after), NULL,
     "leave out points before T, as of a transient; a formula"},
    {"from", "SCENE", TEXT("scene", from), NULL, "the scene to begin with"},
    {"for", "NAME|FILE", FILE_NAME(sheet.names), NULL,
     "a sheet for this name, or for each name of a file, one a line; of mark: "
     "the names there are"},
    {"key", "TEXT", TEXT("text", sheet.key), NULL,
     "of the lecturer: numbers are drawn from it and from the name; without "
     "it mark takes those of the sheets that all have"},
    {"answers", NULL, FLAG(sheet.answers), NULL,
     "the answers, and how far right ones may be from them"},
    {"as", "FORM", CHOICE(unsigned, sheet.form), NULL,
     "page or notebook (both, if not given), check: a page that marks itself, "
     "moodle: questions as XML, or form: a table of answers to fill in",
     .words = "page|notebook|check|moodle|form"},
    {"allow-code", NULL, FLAG(allow_code), "SCENE",
     "compile and run C code that the scene names"},
    {"impact", NULL, FLAG(impact), NULL,
     "what each effect changes in the orbit, costs, and rules out"},
    {"needed", "FORMULA", FORMULA(observable), NULL,
     "the fewest effects that keep this formula or observable within --error of "
     "its range"},
    {"all", NULL, FLAG(all), NULL,
     "list: also the names in other packages, and sources. check: all "
     "integrators. hard: each run. report: all parts"},
    {"format", "table|csv|json", CHOICE(table_format, format), "TABLE",
     "csv for run, section and sweep, table for others, if not given",
     .words = "table|csv|json"},
    {"output", "FILE", TAKEN("file", read_output), "TABLE",
     "write FILE when it is complete; nevh run: line by line", .letter = 'o'},
    {"quiet", NULL, FLAG(quiet), "TABLE",
     "only the table: no # lines, no notes, no progress"},
    {"help", NULL, FLAG(help), "ALL", "this text", .letter = 'h'},
    {"version", NULL, FLAG(version), "ALL", "version and licence"},
    {0},
};

const option_row *option_find(const char *name) {
    const option_row *row = option_rows;
    while (row->name && strcmp(row->name, name) != 0)
        row++;
    return row->name ? row : NULL;
}

static bool is_known(const char *word) {
    for (const option_row *row = option_rows; row->name; row++)
        if (strcmp(word, row->name) == 0 ||
            (row->group && strcmp(word, row->group) == 0))
            return true;
    return false;
}

int command_takes_known(const command *c) {
    list words = {0};
    int status = TOOL_OK;
    list_split_at(&words, c->options, ' ');
    for (size_t i = 0; i < words.count && !status; i++)
        if (!is_known(words.item[i]))
            status = tool_refuse("nevh %s takes %s, which is neither an option "
                                 "nor a group of options",
                                 c->name, words.item[i]);
    return status;
}

bool command_takes(const command *c, const option_row *row) {
    list words = {0};
    list_split_at(&words, c->options, ' ');
    list_add(&words, "ALL");
    return list_has(&words, row->name) ||
           (row->group && list_has(&words, row->group));
}

bool option_given(const options *o, const char *name) {
    return list_has(&o->given, name);
}

static int unknown_option(const char *text) {
    list names = {0};
    if (strncmp(text, "--", 2) != 0)
        return tool_refuse("unknown option %s", text);
    char *name = text_print("%.*s", (int)strcspn(text, "="), text);
    for (const option_row *row = option_rows; row->name; row++)
        list_print(&names, "--%s", row->name);
    return tool_unknown("option", name, &names);
}

enum { KNOWN = sizeof option_rows / sizeof *option_rows - 1, FIRST = 256 };

/* The rows, and their letters, as getopt_long takes them; codes are numbers of
   rows, from FIRST on, or letters. */
static void describe(struct option described[KNOWN + 1]) {
    for (int i = 0; i < KNOWN; i++)
        described[i] = (struct option){
            option_rows[i].name,
            option_rows[i].argument ? required_argument : no_argument, NULL,
            option_rows[i].letter ? option_rows[i].letter : FIRST + i};
    described[KNOWN] = (struct option){0};
}

static const option_row *row_of(int code) {
    for (int i = 0; i < KNOWN; i++)
        if (code == FIRST + i || code == option_rows[i].letter)
            return &option_rows[i];
    return NULL;
}

static int read_one(options *o, int code, char **argv) {
    const char *text = argv[optind - 1];
    if (code == ':')
        return tool_refuse("%s needs an argument", text);
    if (code == 1)
        return list_add(&o->operands, optarg), TOOL_OK;
    if (code == '?')
        return optopt && strncmp(text, "--", 2) != 0
                   ? tool_refuse("unknown option -%c", optopt)
                   : unknown_option(text);
    const option_row *row = row_of(code);
    list_add(&o->given, row->name);
    return row->read(o, row, optarg);
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

void settings_notes(const options *o, list *notes) {
    for (size_t i = 0; i < o->settings.count; i++)
        if (o->settings.item[i][0] == '=')
            list_print(notes, "set: %s", o->settings.item[i] + 1);
        else if (o->settings.item[i][0] == '@')
            list_print(notes, "start: %s", o->settings.item[i] + 1);
}

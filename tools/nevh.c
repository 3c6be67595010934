/* nevh: the command.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ranks.h"
#include "config.h"
#include "cli/tool.h"
#include <errno.h>
#include <gsl/gsl_errno.h>
#include <signal.h>
#include <string.h>

static const struct {
    command *run;
    unsigned bit;
    const char *operand, *help;
} known[] = {
    {compare, FOR_COMPARE, "SCENE",
     "one row for each integrator and dt: energy error, orbit error, cost; "
     "then a verdict"},
    {run_scene, FOR_RUN, "SCENE",
     "the trajectory as CSV: t, coordinates, momenta, observables, energy"},
    {cost, FOR_COST, "SCENE", "what each digit costs, for each integrator"},
    {recommend, FOR_RECOMMEND, "SCENE",
     "the cheapest integrator, gradient and step whose error stays below a "
     "target"},
    {gradients, FOR_GRADIENTS, "SCENE",
     "error and cost of each gradient method and step along the orbit"},
    {check, FOR_CHECK, "SCENE",
     "errors of the scene, properties of H, and which integrators fit"},
    {effects, FOR_EFFECTS, "SCENE",
     "each effect: on or off, what it reads, evaluations, time; with --impact "
     "what it changes"},
    {section, FOR_SECTION, "SCENE",
     "points of Poincare and stroboscopic sections, as CSV"},
    {chaos, FOR_CHAOS, "SCENE",
     "whether the orbit is chaotic: Lyapunov exponents with errors, alignment "
     "indices, MEGNO"},
    {sweep, FOR_SWEEP, "SCENE",
     "many orbits: a row for each member of the ensemble, with outcomes, as "
     "CSV or an array of NumPy (-o FILE.npy)"},
    {portrait, FOR_PORTRAIT, "SCENE",
     "draws the orbits of the ensemble by each integrator, over level curves of "
     "H or in a plane of section"},
    {frequencies_command, FOR_FREQUENCIES, "SCENE",
     "the frequencies in the orbit by each integrator, with amplitudes, errors "
     "and drift"},
    {fit_command, FOR_FIT, "SCENE",
     "parameters and starts from measured points: least squares, with errors "
     "and correlations"},
    {flow, FOR_FLOW, "SCENE",
     "the area of a disc, a rectangle or Arnold's cat of starts against time, "
     "for each integrator"},
    {reference_command, FOR_REFERENCE, "SCENE",
     "the state at the end, or at given times, with certain digits"},
    {export_scene, FOR_EXPORT, "SCENE",
     "the steps of one integrator as a C program that needs nothing else"},
    {report, FOR_REPORT, "SCENE...",
     "one page of HTML with the tables and pictures of the other commands"},
    {live_page, FOR_PAGE, "SCENE...",
     "a live page in one file: the scene runs in a browser, offline"},
    {hard, FOR_HARD, "",
     "every integrator on cases that are hard to integrate"},
    {new_scene, FOR_NEW, "FILE", "makes a commented scene, FILE.nevh"},
    {list_command, FOR_LIST, "WHAT",
     "integrators, gradients, models or scenes"},
};
enum { KNOWN = sizeof known / sizeof *known };

/* Space between the name and the text of a command, and nowhere else: help2man
   takes that for the end of the name. */
static void help_line(FILE *f, const char *name, const char *operand,
                      const char *text) {
    int used = fprintf(f, "  nevh %s%s%s", name, *operand ? " " : "", operand);
    help_print(f, used, 25, text);
}

static void help_all(FILE *f) {
    fputs("Usage: nevh COMMAND SCENE [OPTION]...\n"
          "Compares integrators on a Hamiltonian, which it differentiates "
          "numerically.\n\nCommands:\n",
          f);
    for (size_t i = 0; i < KNOWN; i++)
        help_line(f, command_name(known[i].bit), known[i].operand,
                  known[i].help);
    help_line(f, "help", "COMMAND", "what a command does, and its options");
    options_help(f, ~0u);
    fputs(
        "\nSCENE is a file, or a name of nevh list scenes.  Exit status: 0; "
        "1 when a row\nfailed numerically; 2 for bad input or usage; 3 when a sweep was "
        "stopped early.\n",
        f);
}

static int help(size_t i) {
    printf("Usage: nevh %s %s%s[OPTION]...\n", command_name(known[i].bit),
           known[i].operand, *known[i].operand ? " " : "");
    help_print(stdout, 0, 0, known[i].help);
    options_help(stdout, known[i].bit);
    return TOOL_OK;
}

static int version(void) {
    puts("nevh " PACKAGE_VERSION "\nLicense GPL-3.0-or-later.  There is no "
         "warranty.");
    return TOOL_OK;
}

static int unknown_command(const char *name) {
    list names = {0};
    for (size_t i = 0; i < KNOWN; i++)
        list_add(&names, command_name(known[i].bit));
    list_add(&names, "help");
    int status = tool_unknown("command", name, &names);
    list_free(&names);
    return status;
}

static size_t find(const char *name) {
    size_t i = 0;
    while (i < KNOWN && strcmp(name, command_name(known[i].bit)) != 0)
        i++;
    return i;
}

/* nevh help, nevh help COMMAND, nevh --help, nevh COMMAND --help. */
static int help_on(const char *name) {
    if (!name)
        return help_all(stdout), TOOL_OK;
    size_t i = find(name);
    return i < KNOWN ? help(i) : unknown_command(name);
}

static int dispatch(const options *o) {
    const list *words = &o->operands;
    const char *word = words->count ? words->item[0] : NULL;
    if (o->version)
        return version();
    if (word && strcmp(word, "help") == 0)
        return help_on(words->count > 1 ? words->item[1] : NULL);
    if (o->help)
        return help_on(word);
    if (!word)
        return help_all(stderr), TOOL_USAGE;
    size_t i = find(word);
    if (i == KNOWN)
        return unknown_command(word);
    int status = options_check(o, known[i].bit);
    return status ? status : known[i].run(o);
}

/* A limit of a file's size is an error like another, and GSL, whose own handler
   aborts, is to say what it lacks. */
static void set_process(void) {
    signal(SIGXFSZ, SIG_IGN);
    gsl_set_error_handler_off();
}

/* What no command looked after. */
static int end_output(int status) {
    if (status != TOOL_USAGE && (fflush(stdout) || ferror(stdout)))
        return tool_refuse("the output cannot be written: %s", strerror(errno));
    return status;
}

int main(int argc, char **argv) {
    options o;
    ranks_exec(argv);
    set_process();
    int status = options_read(&o, argc, argv);
    if (!status)
        status = end_output(dispatch(&o));
    options_free(&o);
    return status;
}

/* nevh: the command.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "config.h"
#include "tool.h"
#include <gsl/gsl_errno.h>
#include <signal.h>
#include <string.h>

static const struct {
    const char *name;
    command *run;
    unsigned bit;
    const char *operand, *help;
} known[] = {
    {"compare", compare, FOR_COMPARE, "SCENE",
     "energy errors, a row an integrator and dt, and the verdict in words"},
    {"run", run_scene, FOR_RUN, "SCENE",
     "the trajectory as CSV: t, coordinates, momenta, observables, energy"},
    {"cost", cost, FOR_COST, "SCENE",
     "what a digit costs: target errors, a row an integrator"},
    {"recommend", recommend, FOR_RECOMMEND, "SCENE",
     "the cheapest integrator, gradient and step that keep an error"},
    {"gradients", gradients, FOR_GRADIENTS, "SCENE",
     "error and cost of each gradient method and step along the orbit"},
    {"check", check, FOR_CHECK, "SCENE",
     "errors, structure of H with evidence, and which schemes fit"},
    {"effects", effects, FOR_EFFECTS, "SCENE",
     "each effect: on or off, what it reads, evaluations, time; --impact"},
    {"section", section, FOR_SECTION, "SCENE",
     "points of Poincare and stroboscopic sections, as CSV"},
    {"hard", hard, FOR_HARD, "",
     "every scheme on cases that are hard to integrate, and the verdicts"},
    {"new", new_scene, FOR_NEW, "FILE",
     "makes a scene to start from, FILE.nevh"},
    {"list", list_what, FOR_LIST, "WHAT",
     "integrators, gradients, models or scenes"},
};
enum { KNOWN = sizeof known / sizeof *known };

static int help_all(void) {
    puts("Usage: nevh COMMAND SCENE [OPTION]...\n"
         "Compares symplectic integrators on a Hamiltonian, its gradient taken "
         "from its values.\n");
    for (size_t i = 0; i < KNOWN; i++)
        printf("  nevh %-9s %-5s  %s\n", known[i].name, known[i].operand,
               known[i].help);
    options_help(stdout, ~0u);
    puts("\nSCENE is a file, or a name of nevh list scenes.  nevh COMMAND "
         "--help names the\noptions of one command.  Exit status: 0; 1 when a "
         "row failed numerically; 2 for\nbad input or usage.");
    return TOOL_OK;
}

static int help(size_t i) {
    printf("Usage: nevh %s %s%s[OPTION]...\n%s\n", known[i].name,
           known[i].operand, *known[i].operand ? " " : "", known[i].help);
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
        list_add(&names, known[i].name);
    int status = tool_unknown("command", name, &names);
    list_free(&names);
    return status;
}

static int obey(const options *o) {
    const char *word = o->operands.count ? o->operands.item[0] : NULL;
    size_t i = 0;
    if (o->version)
        return version();
    if (!word)
        return o->help ? help_all()
                       : tool_refuse("no command; see nevh --help");
    while (i < KNOWN && strcmp(word, known[i].name) != 0)
        i++;
    if (i == KNOWN)
        return unknown_command(word);
    if (o->help)
        return help(i);
    int status = options_check(o, known[i].bit);
    return status ? status : known[i].run(o);
}

/* A limit of a file's size is an error like another, and GSL, whose own handler
   aborts, is to say what it lacks. */
static void set_process(void) {
    signal(SIGXFSZ, SIG_IGN);
    gsl_set_error_handler_off();
}

int main(int argc, char **argv) {
    options o;
    set_process();
    int status = options_read(&o, argc, argv);
    if (!status)
        status = obey(&o);
    options_free(&o);
    return status;
}

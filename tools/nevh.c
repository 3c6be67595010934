/* nevh: the command.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ranks.h"
#include "config.h"
#include "cli/tool.h"
#include <errno.h>
#include <unistd.h>
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <signal.h>
#include <string.h>

/* brief is a line of the list; examples are commands without "nevh ", a line each,
   that anyone can type: tests/tool/nevh_help.sh runs them. */
static const struct {
    command *run;
    unsigned bit;
    const char *operand, *brief, *help, *examples;
} known[] = {
    {compare, FOR_COMPARE, "SCENE",
     "energy error, orbit error and cost of each integrator",
     "one row for each integrator and dt: energy error, orbit error, cost; then a verdict",
     "compare pendulum\ncompare double-pendulum --integrators verlet,gauss4,rk4 --dt 0.01 --t-end 20"},
    {run_scene, FOR_RUN, "SCENE", "the trajectory, as CSV or as a picture",
     "the trajectory as CSV: t, coordinates, momenta, observables, energy",
     "run pendulum --t-end 10 --samples 11\nrun kepler --t-end 20 --plot kepler.svg"},
    {cost, FOR_COST, "SCENE", "what each digit costs",
     "what each digit costs, for each integrator",
     "cost oscillator --t-end 20\ncost pendulum --t-end 20 --integrators verlet,gauss6,rk4 --by state"},
    {recommend, FOR_RECOMMEND, "SCENE",
     "the cheapest way to keep an error below a target",
     "the cheapest integrator, gradient and step whose error stays below a target",
     "recommend pendulum --t-end 20 --energy-error 1e-8\nrecommend kepler --t-end 20 --state-error 1e-6"},
    {gradients, FOR_GRADIENTS, "SCENE",
     "error and cost of the gradient methods",
     "error and cost of each gradient method and step along the orbit",
     "gradients pendulum\ngradients pendulum --t-end 10 --plot gradients.svg"},
    {check, FOR_CHECK, "SCENE",
     "mistakes in the scene, properties of H, what fits",
     "mistakes in the scene file, properties of H, and which integrators fit",
     "check double-pendulum --t-end 20\ncheck pendulum --all"},
    {effects, FOR_EFFECTS, "SCENE",
     "the effects, what each reads, changes and costs",
     "each effect: on or off, what it reads, evaluations, time; with --impact what it changes",
     "effects elastic-pendulum\neffects damped-driven-pendulum --t-end 20 --impact"},
    {section, FOR_SECTION, "SCENE", "points of Poincare sections",
     "points of Poincare and stroboscopic sections, as CSV",
     "section henon-heiles --t-end 200\nsection henon-heiles --t-end 200 --plot section.svg"},
    {chaos, FOR_CHAOS, "SCENE", "chaotic or regular, with Lyapunov exponents",
     "whether the orbit is chaotic: Lyapunov exponents with errors, alignment indices, MEGNO",
     "chaos henon-heiles --t-end 1000\nchaos double-pendulum --t-end 50 --exponents all"},
    {sweep, FOR_SWEEP, "SCENE", "many orbits, a row of outcomes for each",
     "many orbits: a row for each member of the ensemble, with outcomes, as CSV or an array of NumPy (-o FILE.npy)",
     "sweep pendulum --t-end 50 --vary 'phi = range(0.1, 3, 20)' --outcomes period,energy_error\nsweep double-pendulum --t-end 20 --vary 'phi1 = range(-3, 3, 20)' --vary 'phi2 = range(-3, 3, 20)' --outcomes 'first(abs(phi2) > pi)' --picture flips.svg"},
    {portrait, FOR_PORTRAIT, "SCENE",
     "orbits over level curves of H, a panel a scheme",
     "draws the orbits of the ensemble by each integrator, over level curves of H or in a plane of section",
     "portrait pendulum --t-end 20 --vary 'phi = range(0.5, 3, 6)' --plot portrait.svg\nportrait pendulum --t-end 20 --integrators verlet,rk4 --dt 0.3 --plot portrait.svg"},
    {frequencies_command, FOR_FREQUENCIES, "SCENE",
     "the frequencies in the orbit",
     "the frequencies in the orbit by each integrator, with amplitudes, errors and drift",
     "frequencies pendulum\nfrequencies coupled-pendulums --integrators gauss6"},
    {fit_command, FOR_FIT, "SCENE",
     "parameters and starts from measured points",
     "parameters and starts from measured points: least squares, with errors and correlations",
     "fit pendulum-filmed --data pendulum-filmed.csv --vary g\nfit pendulum-filmed --data pendulum-filmed.csv --vary g,phi"},
    {flow, FOR_FLOW, "SCENE", "the area of a set of starts, carried along",
     "the area of a disc, a rectangle or Arnold's cat of starts against time, for each integrator",
     "flow pendulum --t-end 5\nflow pendulum --t-end 5 --shape 'disc(phi = 1, p_phi = 0, 0.3)' --plot flow.svg"},
    {reference_command, FOR_REFERENCE, "SCENE",
     "the state to digits that are certain",
     "the state at the end, or at given times, with certain digits",
     "reference pendulum --at 1,10\nreference henon-heiles --t-end 20 --digits 20"},
    {export_scene, FOR_EXPORT, "SCENE", "the steps as a C program",
     "the steps of one integrator as a C program that needs nothing else",
     "export pendulum -o pendulum.c\nexport kepler --integrators gauss6 --header -o kepler.h"},
    {report, FOR_REPORT, "SCENE...",
     "one HTML page with all tables and pictures",
     "one page of HTML with the tables and pictures of the other commands",
     "report pendulum -o pendulum.html\nreport pendulum --variant g=1.6 -o moon.html"},
    {live_page, FOR_PAGE, "SCENE...",
     "a live page that runs in a browser, offline",
     "a live page in one file: the scene runs in a browser, offline",
     "page pendulum -o pendulum.html\npage pendulum kepler --dt 0.05 -o class.html"},
    {hard, FOR_HARD, "", "every integrator on hard cases",
     "every integrator on cases that are hard to integrate",
     "hard --integrators verlet\nhard --integrators verlet,rk4 --all"},
    {new_scene, FOR_NEW, "FILE", "a commented scene to edit",
     "makes a commented scene, FILE.nevh",
     "new mine.nevh\nnew moon.nevh --from pendulum --set g=1.6"},
    {list_command, FOR_LIST, "WHAT", "integrators, gradients, models or scenes",
     "integrators, gradients, models or scenes",
     "list integrators\nlist scenes"},
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

/* What nevh prints where no command is given. */
static void help_brief(FILE *f) {
    fputs("Usage: nevh COMMAND SCENE [OPTION]...\n\n", f);
    for (size_t i = 0; i < KNOWN; i++)
        fprintf(f, "  %-12s %s\n", command_name(known[i].bit), known[i].brief);
    fputs(
        "\nTo begin:\n"
        "  nevh compare pendulum        a table of integrators\n"
        "  nevh new mine.nevh           a scene of your own\n"
        "  nevh help compare            a command, its options and examples\n"
        "SCENE is a file, or a name of nevh list scenes.  nevh help prints all "
        "options.\n",
        f);
}

/* A line that is too long for a terminal goes on after a backslash, as the shell
   reads it. */
static void print_example(const char *text, size_t length) {
    enum { WIDTH = 78 };
    int used = printf("  nevh");
    while (length) {
        size_t word = 0;
        for (bool quoted = false; word < length; word++) {
            quoted ^= text[word] == '\'';
            if (text[word] == ' ' && !quoted)
                break;
        }
        if (used + 1 + (int)word > WIDTH)
            used = printf(" \\\n     ") - 3;
        used += printf(" %.*s", (int)word, text);
        word += word < length;
        text += word, length -= word;
    }
    putchar('\n');
}

static void print_examples(const char *text) {
    puts("\nExamples:");
    for (; *text; text += *text == '\n') {
        size_t length = strcspn(text, "\n");
        print_example(text, length);
        text += length;
    }
}

static int help(size_t i) {
    printf("Usage: nevh %s %s%s[OPTION]...\n", command_name(known[i].bit),
           known[i].operand, *known[i].operand ? " " : "");
    help_print(stdout, 0, 0, known[i].help);
    print_examples(known[i].examples);
    options_help(stdout, known[i].bit);
    if (known[i].bit == FOR_SWEEP)
        outcomes_help(stdout);
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
        return help_brief(stderr), TOOL_USAGE;
    size_t i = find(word);
    if (i == KNOWN)
        return unknown_command(word);
    int status = options_check(o, known[i].bit);
    return status ? status : known[i].run(o);
}

/* So that no file of ours is taken for one of these.  Who writes to one that was
   closed is told so. */
static void open_standard_files(void) {
    int file;
    do
        file = open("/dev/null", O_RDONLY);
    while (file >= 0 && file <= STDERR_FILENO);
    if (file >= 0)
        close(file);
}

/* A limit of a file's size is an error like another, and GSL, whose own handler
   aborts, is to say what it lacks. */
static void set_process(void) {
    open_standard_files();
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

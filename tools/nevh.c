/* nevh: the command.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "config.h"
#include "tool.h"
#include <string.h>

static const struct {
    const char *name;
    command *run;
    const char *operand, *help;
} commands[] = {
    {"compare", compare, "SCENE",
     "energy errors, a row an integrator and dt, and the verdict in words"},
    {"check", check, "SCENE",
     "errors, structure of H with evidence, and which schemes fit"},
    {"effects", effects, "SCENE",
     "each effect: on or off, what it reads, evaluations"},
    {"list", list_what, "WHAT", "integrators, gradients, models or scenes"},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

static int help(void) {
    puts("Usage: nevh COMMAND SCENE [OPTION]...\n"
         "Compares symplectic integrators on a Hamiltonian, its gradient taken "
         "from its values.\n");
    for (size_t i = 0; i < COMMANDS; i++)
        printf("  nevh %-7s %s  %s\n", commands[i].name, commands[i].operand,
               commands[i].help);
    options_help(stdout);
    puts("\nSCENE is a file, or a name of nevh list scenes.  Exit status: 0; 1 "
         "when a row\nfailed numerically; 2 for bad input or usage.");
    return TOOL_OK;
}

static int version(void) {
    puts("nevh " PACKAGE_VERSION "\nLicense GPL-3.0-or-later.  There is no "
         "warranty.");
    return TOOL_OK;
}

static int unknown_command(const char *name) {
    list names = {0};
    for (size_t i = 0; i < COMMANDS; i++)
        list_add(&names, commands[i].name);
    int status = tool_unknown("command", name, &names);
    list_free(&names);
    return status;
}

static int obey(const options *o) {
    if (o->help)
        return help();
    if (o->version)
        return version();
    if (o->operands.count == 0)
        return tool_refuse("no command; see nevh --help");
    for (size_t i = 0; i < COMMANDS; i++)
        if (strcmp(o->operands.item[0], commands[i].name) == 0)
            return commands[i].run(o);
    return unknown_command(o->operands.item[0]);
}

int main(int argc, char **argv) {
    options o;
    int status = options_read(&o, argc, argv);
    if (!status)
        status = obey(&o);
    options_free(&o);
    return status;
}

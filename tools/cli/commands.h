/* nevh: the commands.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_COMMANDS_H
#define NEVH_COMMANDS_H

#include "tool.h"

/* In the order of nevh help: NAME is NAME_command of the file that implements it. */
#define COMMANDS(X)                                                            \
    X(compare)                                                                 \
    X(run)                                                                     \
    X(cost)                                                                    \
    X(recommend)                                                               \
    X(gradients)                                                               \
    X(check)                                                                   \
    X(effects)                                                                 \
    X(section)                                                                 \
    X(chaos)                                                                   \
    X(sweep)                                                                   \
    X(portrait)                                                                \
    X(frequencies)                                                             \
    X(fit)                                                                     \
    X(flow)                                                                    \
    X(reference)                                                               \
    X(export)                                                                  \
    X(report)                                                                  \
    X(page)                                                                    \
    X(hard)                                                                    \
    X(new)                                                                     \
    X(sheet)                                                                   \
    X(mark)                                                                    \
    X(list)                                                                    \
    X(help)

#define COMMAND_DECLARED(name) extern const command name##_command;
COMMANDS(COMMAND_DECLARED)

/* commands.c */
extern const command *const commands[]; /* until NULL */
/* NULL, the message being printed. */
const command *command_find(const char *name);
/* Checks that the command takes all options given, and draws the kind of picture.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int command_check(const command *, const options *);

/* help.c: what nevh prints where no command is given. */
void help_brief(FILE *);
/* Prints the help of a command, or of all, as text or JSON. */
int help_on(const options *, const char *name);

#endif

/* nevh: the list of commands, and whether one takes what it is given.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include <string.h>

#define COMMAND_OF(name) &name##_command,
const command *const commands[] = {COMMANDS(COMMAND_OF) NULL};

const command *command_find(const char *name) {
    list names = {0};
    size_t i = 0;
    if (strcmp(name, "sheets") == 0) /* as one says for all of them */
        name = "sheet";
    for (; commands[i] && strcmp(name, commands[i]->name) != 0; i++)
        list_add(&names, commands[i]->name);
    if (!commands[i])
        tool_unknown("command", name, &names);
    return commands[i];
}

/* With what to do instead, or the commands that it is for, where they are few. */
static int refuse_option(const command *c, const option_row *row) {
    enum { FEW = 5 };
    if (c->instead.option && strcmp(c->instead.option, row->name) == 0)
        return tool_refuse("--%s is no option of nevh %s: %s", row->name,
                           c->name, c->instead.advice);
    list those = {0};
    for (size_t i = 0; commands[i]; i++)
        if (command_takes(commands[i], row))
            list_add(&those, commands[i]->name);
    return tool_refuse(those.count <= FEW ? "--%s is no option of nevh "
                                            "%s; it is for %s"
                                          : "--%s is no option of nevh %s",
                       row->name, c->name, list_joined(&those));
}

static bool draws(const command *c, const char *kind) {
    list kinds = {0};
    list_split_at(&kinds, c->draws ? c->draws : "", '|');
    return list_has(&kinds, kind);
}

static int check_plot_kind(const command *c, const char *kind) {
    list those = {0}, kinds = {0};
    if (draws(c, kind))
        return TOOL_OK;
    list_split_at(&kinds, c->draws, '|');
    for (size_t i = 0; commands[i]; i++)
        if (draws(commands[i], kind))
            list_print(&those, "nevh %s", commands[i]->name);
    tool_refuse("--plot-kind %s is for %s; of nevh %s it is %s, or not given",
                kind, list_sentence(&those, "and"), c->name,
                list_sentence(&kinds, "or"));
    return TOOL_USAGE;
}

int command_check(const command *c, const options *o) {
    for (size_t i = 0; i < o->given.count; i++) {
        const option_row *row = option_find(o->given.item[i]);
        if (!command_takes(c, row))
            return refuse_option(c, row);
    }
    if (!o->plot.kind)
        return TOOL_OK;
    list kinds = {0};
    list_split_at(&kinds, option_find("plot-kind")->words, '|');
    return check_plot_kind(c, kinds.item[o->plot.kind - PLOT_KIND_phase]);
}

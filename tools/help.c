/* nevh help: what is made from the list of commands and the table of options:
   texts for people, and JSON for programs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "config.h"
#include <signal.h>
#include <string.h>

/* The meaning of each exit status. */
static const struct {
    int status;
    const char *when;
} statuses[] = {
    {TOOL_OK, "when all was done, also where rows are unstable or refused"},
    {TOOL_FAILED, "when a computation ended early"},
    {TOOL_USAGE, "for wrong input or usage, or output that cannot be written"},
    {TOOL_STOPPED, "when a sweep was stopped and can be resumed"},
    {128 + SIGINT, "when nevh was interrupted"}};
enum { STATUSES = sizeof statuses / sizeof *statuses };

/* Space between the name and the text of a command, and nowhere else: help2man
   takes that for the end of the name. */
static void print_command(FILE *f, const command *c) {
    int used = fprintf(f, "  nevh %s%s%s", c->name, *c->operand ? " " : "",
                       c->operand);
    help_print(f, used, 25, c->help);
}

/* The options of a command, or all. */
static void print_options(FILE *f, const command *c) {
    fputs("\nOptions:\n", f);
    for (const option_row *row = option_rows; row->name; row++) {
        char letter[] = {'-', row->letter, ',', ' ', '\0'};
        if (c && !command_takes(c, row))
            continue;
        int used = fprintf(f, "  %s--%s%s%s", row->letter ? letter : "",
                           row->name, row->argument ? " " : "",
                           row->argument ? row->argument : "");
        help_print(f, used, 28, row->help);
    }
}

static void print_all(FILE *f) {
    fputs("Usage: nevh COMMAND SCENE [OPTION]...\n"
          "Compares integrators on a Hamiltonian, which it differentiates "
          "numerically.\n\nCommands:\n",
          f);
    for (size_t i = 0; commands[i]; i++)
        print_command(f, commands[i]);
    print_options(f, NULL);
    char *text = text_print("SCENE is a file, or a name of nevh list scenes.  "
                            "Exit status:");
    for (int i = 0; i < STATUSES; i++)
        text_extend(&text, " %d %s%s", statuses[i].status, statuses[i].when,
                    i + 1 < STATUSES ? ";" : ".");
    fputc('\n', f);
    help_print(f, 0, 0, text);
    fputc('\n', f);
    help_print(f, 0, 0,
               "The manual is info nevh, in the sources info doc/nevh.info; as "
               "pages, with pictures and the worksheets, make -C build site "
               "makes build/doc/nevh-site/index.html.  nevh sheet lists the "
               "worksheets.");
}

/* Prints the help of nevh without a command. */
void help_brief(FILE *f) {
    fputs("Usage: nevh COMMAND SCENE [OPTION]...\n\n", f);
    for (size_t i = 0; commands[i]; i++)
        if (commands[i]->brief)
            fprintf(f, "  %-12s %s\n", commands[i]->name, commands[i]->brief);
    fputs(
        "\nTo begin:\n"
        "  nevh compare pendulum        a table of integrators\n"
        "  nevh new mine.nevh           a scene of your own\n"
        "  nevh help compare            a command; nevh help: all options, and the "
        "manual\n"
        "SCENE is a file, or a name of nevh list scenes.\n",
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

static void print_one(const command *c) {
    printf("Usage: nevh %s %s%s[OPTION]...\n", c->name, c->operand,
           *c->operand ? " " : "");
    help_print(stdout, 0, 0, c->help);
    print_examples(c->examples);
    print_options(stdout, c);
    if (c->more)
        c->more(stdout);
}

/* A member of an object of JSON: `name` is all that stands before the text. */
static void print_member(const char *name, const char *text) {
    fputs(name, stdout);
    if (text)
        json_string(text, stdout);
    else
        fputs("null", stdout);
}

/* An array of the parts of a text that `mark` divides; null where there is none. */
static void print_parts(const char *name, const char *before, const char *text,
                        char mark) {
    list parts = {0};
    printf("%s%s", name, text ? "[" : "null");
    if (text)
        list_split_at(&parts, text, mark);
    for (size_t i = 0; i < parts.count; i++)
        print_member(i ? ", " : "", text_print("%s%s", before, parts.item[i]));
    fputs(text ? "]" : "", stdout);
}

static void print_command_json(const command *c) {
    const char *before = ",\n     \"options\": [\"";
    print_member("{\"name\": ", c->name);
    print_member(", \"operand\": ", *c->operand ? c->operand : NULL);
    print_parts(",\n     \"operands\": ", "", c->operands, '|');
    print_member(",\n     \"help\": ", c->help);
    print_parts(",\n     \"examples\": ", "nevh ", c->examples, '\n');
    print_parts(",\n     \"columns\": ", "", c->columns, ',');
    print_parts(",\n     \"plot_kinds\": ", "", c->draws, '|');
    for (const option_row *row = option_rows; row->name; row++)
        if (command_takes(c, row))
            printf("%s%s", before, row->name), before = "\", \"";
    fputs("\"]}", stdout);
}

static void print_option_json(const option_row *row) {
    const char letter[] = {row->letter, '\0'};
    print_member("{\"name\": ", row->name);
    print_member(", \"letter\": ", row->letter ? letter : NULL);
    print_member(", \"argument\": ", row->argument);
    print_member(", \"kind\": ", row->kind);
    print_parts(", \"words\": ", "", row->words, '|');
    print_member(", \"help\": ", row->help);
    fputs("}", stdout);
}

/* Prints one command with its options, or all. */
static int print_json(const command *c) {
    for (size_t i = 0; commands[i]; i++)
        if (command_takes_known(commands[i]))
            return TOOL_USAGE;
    const char *comma = "";
    printf("{\"version\": \"%s\",\n \"commands\": [", PACKAGE_VERSION);
    for (size_t i = 0; commands[i]; i++)
        if (!c || commands[i] == c) {
            printf("%s\n    ", comma), comma = ",";
            print_command_json(commands[i]);
        }
    fputs("\n ],\n \"options\": [", stdout), comma = "";
    for (const option_row *row = option_rows; row->name; row++)
        if (!c || command_takes(c, row)) {
            printf("%s\n    ", comma), comma = ",";
            print_option_json(row);
        }
    fputs("\n ],\n \"exit_status\": {", stdout);
    for (int i = 0; i < STATUSES; i++)
        printf("%s\"%d\": \"%s\"", i ? ", " : "", statuses[i].status,
               statuses[i].when);
    fputs("}}\n", stdout);
    return TOOL_OK;
}

/* Sections of own integrators, and lines to paste into a shell. */
static const char own_integrators[] =
    "\n"
    "  kick, drift     weights of p -= w h dV/dq and q += w h dT/dp, in "
    "turn;\n"
    "                  first = drift begins with the other\n"
    "  a, b            a Butcher table, rows between ;  explicit or "
    "implicit\n"
    "  compose         NAME: weights.  Steps of another, of parts of dt\n"
    "\n"
    "Weights are formulas of numbers and parameters, and add up to 1.\n"
    "nevh check prints the order, by algebra, and the condition of the "
    "next one\n"
    "that fails.  An example to paste:\n"
    "\n"
    "cat >mine.nevh <<'END'\n"
    "[parameters]\n"
    "w = 1/(2 - 2^(1/3))\n"
    "[coordinates]\n"
    "x = 1\n"
    "[effects]\n"
    "T = p_x^2/2\n"
    "V = x^4/4\n"
    "[integrator leap]\n"
    "kick = 1/2, 1/2\n"
    "drift = 1\n"
    "[integrator triple]\n"
    "compose = leap: w, 1 - 2*w, w\n"
    "[integrator ralston-of-mine]\n"
    "a = 0, 0 ; 2/3, 0\n"
    "b = 1/4, 3/4\n"
    "[run]\n"
    "dt = 0.1, 0.05\n"
    "t_end = 50\n"
    "integrators = leap, triple, ralston-of-mine, rk4\n"
    "END\n"
    "nevh check mine.nevh\n"
    "nevh compare mine.nevh\n"
    "nevh check mine.nevh --set w=1.35\n";

static int print_integrators(void) {
    help_print(stdout, 0, 0,
               "nevh list integrators shows those that ship.  A scene has its "
               "own by their numbers, in sections [integrator NAME], and NAME "
               "then stands wherever an integrator does.  One section is");
    fputs(own_integrators, stdout);
    return TOOL_OK;
}

int help_on(const options *o, const char *name) {
    if (name && strcmp(name, "integrators") == 0 && o->format == FORMAT_TABLE)
        return print_integrators();
    const command *c = name ? command_find(name) : NULL;
    if (name && !c)
        return TOOL_USAGE;
    if (o->format == FORMAT_CSV)
        return tool_refuse("nevh help prints text, or with --format json JSON");
    if (o->format == FORMAT_JSON)
        return print_json(c);
    if (c)
        print_one(c);
    else
        print_all(stdout);
    return TOOL_OK;
}

static int help(const options *o) {
    return help_on(o, o->operands.count > 1 ? o->operands.item[1] : NULL);
}

const command help_command = {
    .name = "help",
    .operand = "COMMAND",
    .help = "what a command does, and its options; nevh help integrators: "
            "integrators of your own",
    .examples = "help compare\n"
                "help integrators",
    .options = "format",
    .run = help,
};

/* nevh sheet and nevh mark: worksheets of a class, which the package for Python
   makes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "commands.h"
#include "tool.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* One word, since a value may begin with a hyphen. */
static void add(list *words, const char *option, const char *value) {
    if (value)
        list_print(words, "--%s=%s", option, value);
}

static void add_choice(list *words, const char *option, unsigned choice) {
    list those = {0};
    list_split_at(&those, option_find(option)->words, '|');
    add(words, option, those.item[choice]);
}

static void set_environment(void) {
    char *package = package_folder(), *library = library_file();
    const char *given = getenv("PYTHONPATH");
    char *path = text_print("%s%s%s", package, given && *given ? ":" : "",
                            given ? given : "");
    setenv("PYTHONPATH", path, 1);
    setenv("PYTHONDONTWRITEBYTECODE", "1", 0);
    if (library)
        setenv("NEVH_LIBRARY", library, 0);
    char *program = text_adopt(realpath("/proc/self/exe", NULL));
    if (program)
        setenv("NEVH_COMMAND", program, 0);
}

/* Becomes Python; comes back where there is none. */
static int become(const list *words) {
    char **argv = tool_allocate(words->count + 1, sizeof *argv);
    memcpy(argv, words->item, words->count * sizeof *argv);
    execvp(argv[0], argv);
    return tool_refuse(
        errno == ENOENT
            ? "nevh sheet and nevh mark need Python 3.7 or newer, and there is "
              "no %s here; install it, or set PYTHON to its name"
            : "%s does not run",
        words->item[0]);
}

static int by_python(const options *o, const char *name) {
    const char *python = getenv("PYTHON");
    list words = {0};
    list_add(&words, python && *python ? python : "python3");
    list_add(&words, "-m");
    list_add(&words, "nevh._classroom");
    list_add(&words, name);
    for (size_t i = 1; i < o->operands.count; i++)
        list_add(&words, o->operands.item[i]);
    add(&words, "for", o->sheet.names);
    add(&words, "key", o->sheet.key);
    add(&words, "output", o->file);
    if (option_given(o, "as"))
        add_choice(&words, "as", o->sheet.form);
    if (option_given(o, "format"))
        add_choice(&words, "format", o->format);
    if (o->sheet.answers)
        list_add(&words, "--answers");
    set_environment();
    return become(&words);
}

static int sheet(const options *o) {
    if (o->operands.count > 2)
        return tool_refuse("nevh sheet takes one number, or none for all");
    return by_python(o, "sheet");
}

static int mark(const options *o) {
    if (o->operands.count != 2)
        return tool_refuse("nevh mark takes one file of answers: a CSV with "
                           "the columns name,task,answer");
    return by_python(o, "mark");
}

const command sheet_command = {
    .name = "sheet",
    .operand = "N",
    .brief = "worksheets for a class, one for each student",
    .help =
        "makes worksheet N, or all, as a page to print and a notebook; with "
        "--for one for each name, with other numbers; with -o FILE.html all on "
        "one page to print; without anything lists the worksheets.  It needs "
        "Python",
    .examples = "sheet 1\n"
                "sheet 1 --for 'Ada Lovelace' --key 7 --answers",
    .options = "for key answers as format output",
    .run = sheet,
};

const command mark_command = {
    .name = "mark",
    .operand = "FILE",
    .brief = "answers to worksheets: right, wrong, and why",
    .help =
        "marks answers to worksheets, a CSV with the columns name, task and "
        "answer, or name and a column a task: right, wrong, and where a known mistake gives that number, "
        "why.  It needs Python",
    .examples = "mark answers.csv --key 7\n"
                "mark answers.csv --for names.txt --key 7 --format csv -o "
                "marks.csv",
    .options = "for key format output",
    .run = mark,
};

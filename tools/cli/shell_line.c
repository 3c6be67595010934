/* nevh: lines to be typed into a shell.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <string.h>

/* In single quotes, where a quote itself is '\''. */
static char *quoted(const char *word) {
    static const char special[] = " \t\n()*[]{}?<>|&;$\\\"'`!#~";
    if (*word && !word[strcspn(word, special)])
        return text_print("%s", word);
    char *text = text_print("'");
    while (*word) {
        size_t bytes = strcspn(word, "'");
        text_extend(&text, "%.*s%s", (int)bytes, word,
                    word[bytes] ? "'\\''" : "");
        word += bytes + (word[bytes] != '\0');
    }
    text_extend(&text, "'");
    return text;
}

char *shell_word(char *line, const char *word) {
    char *quotes = quoted(word);
    text_extend(&line, " %s", quotes);
    tool_release(quotes);
    return line;
}

char *shell_option(char *line, const char *name, const char *value) {
    text_extend(&line, " --%s", name);
    return shell_word(line, value);
}

char *shell_number(char *line, const char *name, double value) {
    char text[NUMBER_SIZE];
    return shell_option(line, name, number_text(text, value));
}

char *shell_line(const options *o, const char *run, const char *scene) {
    char *line = shell_word(text_print("  nevh %s", run), scene);
    for (size_t i = 0; i < o->settings.count; i++) {
        const char *setting = o->settings.item[i];
        line = shell_option(line,
                            *setting == '+'   ? "with"
                            : *setting == '-' ? "without"
                            : *setting == '@' ? "start"
                                              : "set",
                            setting + 1);
    }
    return line;
}

/* nevh: which C compiler to call.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700
#include "native/compiler_private.h"
#include "system/system_private.h"
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool can_be_run(const char *path) {
    struct stat found;
    return !stat(path, &found) && S_ISREG(found.st_mode) && !access(path, X_OK);
}

/* The file that the shell would run; NULL: there is none. */
char *nevh__command_find(const char *name) {
    const char *path = getenv("PATH");
    char *found = NULL;
    if (strchr(name, '/'))
        return can_be_run(name) ? nevh__text("%s", name) : NULL;
    for (const char *at = path ? path : ""; *at && !found;) {
        size_t bytes = strcspn(at, ":");
        found = nevh__text("%.*s/%s", (int)bytes, at, name);
        if (found && (!bytes || !can_be_run(found))) {
            free(found);
            found = NULL;
        }
        at += bytes + (at[bytes] == ':');
    }
    return found;
}

/* Takes quotes and backslashes off a word.
   returns  where the text goes on */
static const char *take_word(const char *at, char **to) {
    char quote = '\0';
    for (; *at && (quote || !strchr(" \t\n", *at)); at++)
        if (quote ? *at == quote : *at == '\'' || *at == '"')
            quote = quote ? '\0' : *at;
        else {
            if (*at == '\\' && at[1] && quote != '\'')
                at++;
            *(*to)++ = *at;
        }
    *(*to)++ = '\0';
    return at;
}

/* Words apart by blanks, as a shell has them; in one piece of memory. */
static char **compiler_words_split(const char *text) {
    size_t bytes = strlen(text) + 1, count = 0;
    char **words = malloc((bytes / 2 + 2) * sizeof *words + bytes);
    char *to = words ? (char *)(words + bytes / 2 + 2) : NULL;
    if (!words)
        return NULL;
    for (text += strspn(text, " \t\n"); *text; text += strspn(text, " \t\n")) {
        words[count++] = to;
        text = take_word(text, &to);
    }
    words[count] = NULL;
    return words;
}

/* One word, which may have blanks. */
static char **single(const char *word) {
    char **words = malloc(2 * sizeof *words + strlen(word) + 1);
    if (!words)
        return NULL;
    words[0] = strcpy((char *)(words + 2), word);
    words[1] = NULL;
    return words;
}

static bool is_command(const char *name) {
    char *found = nevh__command_find(name);
    free(found);
    return found;
}

char **nevh__compiler_words(void) {
    static const char *const usual[] = {"cc", "gcc", "clang"};
    const char *given = getenv("CC");
    if (given && given[strspn(given, " \t\n")])
        return is_command(given) ? single(given) : compiler_words_split(given);
    for (size_t i = 0; i < sizeof usual / sizeof *usual; i++)
        if (is_command(usual[i]))
            return single(usual[i]);
    return single(usual[0]);
}

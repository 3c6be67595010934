/* nevh: the text of a program becomes what people read: names without what they have
   in the library, and nothing that is not asked for.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/native_private.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static bool is_word(char c) {
    return isalnum((unsigned char)c) || c == '_';
}

/* True if a line that is no comment has a word; call: with a parenthesis behind it, as
   a function that is called or handed on. */
static bool has_word(const char *line, const char *word, size_t length,
                     bool call) {
    if (strncmp(line + strspn(line, " "), "/*", 2) == 0)
        return false;
    for (const char *at = line; (at = strchr(at, *word)); at++)
        if (strncmp(at, word, length) == 0 &&
            (at == line || !is_word(at[-1])) &&
            (call ? at[length] == '(' || at[length] == ')'
                  : !is_word(at[length])))
            return true;
    return false;
}

/* A line of text before and after names become shorter, and the parentheses and braces
   that are open: what follows them stands below them. */
enum { MOST_OPEN = 32 };
typedef struct {
    const char *from;
    char *to;
    const char *from_line, *to_line; /* where they begin */
    struct {
        size_t from, to; /* columns behind it */
    } open[MOST_OPEN];
    size_t depth;
    bool text, comment; /* a string, or a comment: has none */
    bool closing;       /* the next parenthesis that closes goes */
} renaming;

static void take_line(renaming *r) {
    size_t indent = strspn(r->from, " ");
    r->from_line = r->from;
    r->to_line = r->to;
    if (!r->depth || r->depth > MOST_OPEN ||
        r->open[r->depth - 1].from != indent)
        return;
    r->from += indent;
    memset(r->to, ' ', r->open[r->depth - 1].to);
    r->to += r->open[r->depth - 1].to;
}

/* Notes whether the character begins or ends a string or a comment. */
static void take_quote(renaming *r, char c, char next) {
    bool escaped = r->from > r->from_line && r->from[-1] == '\\';
    if (r->comment)
        r->comment = c != '*' || next != '/';
    else if (c == '"' && !escaped)
        r->text = !r->text;
    else if (c == '/' && next == '*')
        r->comment = true;
}

static void take_open(renaming *r) {
    if (r->depth < MOST_OPEN) {
        r->open[r->depth].from = (size_t)(r->from - r->from_line);
        r->open[r->depth].to = (size_t)(r->to - r->to_line);
    }
    r->depth++;
}

static void take_character(renaming *r) {
    char c = *r->from;
    take_quote(r, c, r->from[1]);
    *r->to++ = *r->from++;
    if (c == '\n')
        take_line(r);
    if (r->text || r->comment)
        return;
    if (c == '(' || c == '{')
        take_open(r);
    else if ((c == ')' || c == '}') && r->depth)
        r->depth--;
}

void nevh__names_shorten(char *text) {
    static const struct {
        const char *from, *to;
    } names[] = {{"NEVH__E(", "one_"},
                 {"NEVH__NUMBER", "double"},
                 {"NEVH__BITS", "uint64_t"},
                 {"NEVH__PAIR", "one_pair"},
                 {"NEVH__RARE ", ""},
                 {"NEVH__MAIN", "static"},
                 {"nevh__number", "double"},
                 {"NEVH_LANES", "EACH_LANE"},
                 {"NEVH__INLINE", "static"},
                 {"nevh__", ""},
                 {"NEVH__", ""},
                 {"NEVH_", ""},
                 {"nevh_simd_", "one_"},
                 {"nevh_", ""}};
    renaming r = {.from = text, .to = text, .from_line = text, .to_line = text};
    bool begins = true;
    while (*r.from) {
        size_t i = 0, count = sizeof names / sizeof *names;
        while (i < count &&
               strncmp(r.from, names[i].from, strlen(names[i].from)) != 0)
            i++;
        if (r.closing && *r.from == ')') {
            r.from++;
            r.closing = false;
            continue;
        }
        if (!begins || i == count) {
            begins = !is_word(*r.from);
            take_character(&r);
            continue;
        }
        r.from += strlen(names[i].from);
        r.closing |= i == 0;
        for (const char *c = names[i].to; *c; c++)
            *r.to++ = *c;
        begins = r.from[-1] == ' ';
    }
    *r.to = '\0';
}

/* Lines become strings. */
static char **split_lines(char *text, size_t *count) {
    size_t lines = 0;
    for (const char *c = text; *c; c++)
        lines += *c == '\n';
    char **all = nevh__array(lines + 1, sizeof *all);
    for (*count = 0; all && *text; (*count)++) {
        size_t bytes = strcspn(text, "\n");
        all[*count] = text;
        if (text[bytes])
            text[bytes++] = '\0';
        text += bytes;
    }
    return all;
}

/* True if "    double NAME = ...;" is used by a line that is left, up to the
   function's end. */
static bool is_of_use(char **lines, size_t i, size_t count) {
    static const char begin[] = "double ";
    const char *name = lines[i] ? lines[i] + strspn(lines[i], " ") : "";
    if (name == lines[i] || strncmp(name, begin, sizeof begin - 1) != 0)
        return true;
    name += sizeof begin - 1;
    size_t length = 0;
    while (is_word(name[length]))
        length++;
    char word[64];
    if (strncmp(name + length, " = ", 3) != 0 || length >= sizeof word)
        return true;
    memcpy(word, name, length);
    word[length] = '\0';
    for (size_t k = i + 1; k < count && (!lines[k] || lines[k][0] != '}'); k++)
        if (lines[k] && has_word(lines[k], word, length, false))
            return true;
    return false;
}

/* True if the first line of a function, or of its declaration. */
static bool begins_function(const char *line) {
    return line && strncmp(line, "static ", 7) == 0 && strchr(line, '(') &&
           !strchr(line, '=');
}

/* The first line from i on that has one of the characters, of those that are left;
   count: none has. */
static size_t line_with(char **lines, size_t i, size_t count,
                        const char *characters) {
    while (i < count && lines[i] && !strpbrk(lines[i], characters))
        i++;
    return i < count && lines[i] ? i : count;
}

/* The end of a function that begins at line i, or of its declaration alone; i: none
   begins there. */
static size_t end_of_function(char **lines, size_t i, size_t count,
                              bool *declared_only) {
    if (!begins_function(lines[i]))
        return i;
    size_t end = line_with(lines, i, count, "{;");
    if (end == count)
        return i;
    *declared_only = !strchr(lines[end], '{');
    if (*declared_only)
        return end + 1;
    while (end < count && (!lines[end] || lines[end][0] != '}'))
        end++;
    return end < count ? end + 1 : i;
}

/* True if a line other than those from i to end names the function; declarations
   alone name it for a definition only. */
static bool is_named(char **lines, size_t i, size_t end, size_t count,
                     bool declared_only) {
    const char *after = strchr(lines[i], '('), *name = after;
    while (name > lines[i] && is_word(name[-1]))
        name--;
    for (size_t k = 0; k < count; k++) {
        bool other_declared_only;
        if ((k >= i && k < end) || !lines[k] ||
            !has_word(lines[k], name, (size_t)(after - name), true))
            continue;
        if (end_of_function(lines, k, count, &other_declared_only) == k ||
            !other_declared_only || declared_only)
            return true;
    }
    return false;
}

/* The end of a macro, or of an array of constants, that begins at line i; i: none
   does.  name: out, with its length */
static size_t end_of_constant(char **lines, size_t i, size_t count,
                              const char **name, size_t *length) {
    static const char macro[] = "#define ", array[] = "static const ";
    const char *line = lines[i];
    if (!line)
        return i;
    bool is_macro = strncmp(line, macro, sizeof macro - 1) == 0;
    const char *after = strchr(line, '[');
    size_t end = i;
    if (!is_macro && (strncmp(line, array, sizeof array - 1) != 0 || !after ||
                      !strchr(after, '{')))
        return i;
    *name = is_macro ? line + sizeof macro - 1 : after;
    while (!is_macro && *name > line && is_word((*name)[-1]))
        --*name;
    for (*length = 0; is_word((*name)[*length]);)
        ++*length;
    do
        line = lines[end++];
    while (end < count && lines[end] &&
           (is_macro ? *line && line[strlen(line) - 1] == '\\'
                     : !strstr(line, "};")));
    return end;
}

/* Lines go, and the comment before them where nothing else follows it. */
static void drop_lines(char **lines, size_t i, size_t end, size_t count) {
    size_t after = end;
    while (end > i)
        lines[--end] = NULL;
    while (after < count && !lines[after])
        after++;
    bool comment = i > 0 && lines[i - 1] && strstr(lines[i - 1], "*/") &&
                   (after == count || !lines[after][0]);
    while (comment && i-- > 0) {
        comment = lines[i] && strncmp(lines[i], "/*", 2) != 0;
        lines[i] = NULL;
    }
}

/* A macro or an array that no other line names goes; whether it went. */
static bool drop_constant(char **lines, size_t i, size_t count) {
    const char *name;
    size_t length, end = end_of_constant(lines, i, count, &name, &length);
    if (end == i)
        return false;
    for (size_t k = 0; k < count; k++)
        if ((k < i || k >= end) && lines[k] &&
            has_word(lines[k], name, length, false))
            return false;
    drop_lines(lines, i, end, count);
    return true;
}

/* A function that no other line names goes; whether it went. */
static bool drop_function(char **lines, size_t i, size_t count) {
    bool declared_only;
    size_t end = end_of_function(lines, i, count, &declared_only);
    if (end == i)
        return false;
    const char *arguments = strchr(lines[i], '(');
    bool advance = strncmp(arguments, "(double t0", 10) == 0 ||
                   strncmp(arguments, "(double *t", 10) == 0;
    if (advance || is_named(lines, i, end, count, declared_only))
        return false;
    drop_lines(lines, i, end, count);
    return true;
}

bool nevh__write_used(nevh__writer *w, char *text) {
    size_t count;
    char **lines = split_lines(text, &count);
    if (!lines)
        return false;
    bool dropped = true;
    while (dropped) {
        dropped = false;
        for (size_t i = count; i-- > 0;)
            dropped |= drop_function(lines, i, count) ||
                       drop_constant(lines, i, count);
    }
    for (size_t i = count; i-- > 0;)
        if (!is_of_use(lines, i, count))
            lines[i] = NULL;
    bool empty = true; /* no two empty lines */
    for (size_t i = 0; i < count; i++)
        if (lines[i] && (lines[i][0] || !empty)) {
            nevh__write(w, "%s\n", lines[i]);
            empty = !lines[i][0];
        }
    free(lines);
    return true;
}

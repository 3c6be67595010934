/* nevh: texts, lists of them, and messages.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

static char *print(const char *format, va_list arguments) {
    va_list again;
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, again);
    va_end(again);
    if (length < 0) /* 2 GiB and above */
        tool_owned(NULL);
    char *text = tool_allocate((size_t)length + 1, 1);
    vsnprintf(text, (size_t)length + 1, format, arguments);
    return text;
}

char *text_print(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    char *text = print(format, arguments);
    va_end(arguments);
    return text;
}

void text_extend(char **text, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    char *more = print(format, arguments);
    va_end(arguments);
    size_t before = *text ? strlen(*text) : 0, added = strlen(more) + 1;
    *text = tool_enlarge(*text, before + added, 1);
    memcpy(*text + before, more, added);
    tool_release(more);
}

static void take(list *l, char *text) {
    l->item = tool_grown(l->item, l->count, sizeof *l->item);
    l->item[l->count++] = text;
}

void list_add(list *l, const char *text) {
    take(l, text_print("%s", text));
}

void list_print(list *l, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    take(l, print(format, arguments));
    va_end(arguments);
}

void list_split_at(list *l, const char *text, char mark) {
    const char end[] = {mark, '\0'};
    for (;;) {
        text += strspn(text, " ");
        size_t length = strcspn(text, end);
        const char *next = text + length;
        while (length && text[length - 1] == ' ')
            length--;
        take(l, text_print("%.*s", (int)length, text));
        if (!*next)
            return;
        text = next + 1;
    }
}

void list_split(list *l, const char *text) {
    list_split_at(l, text, ',');
}

bool list_has(const list *l, const char *text) {
    for (size_t i = 0; i < l->count; i++)
        if (strcmp(l->item[i], text) == 0)
            return true;
    return false;
}

char *list_joined(const list *l) {
    size_t bytes = 1;
    for (size_t i = 0; i < l->count; i++)
        bytes += strlen(l->item[i]) + 2;
    char *text = tool_allocate(bytes, 1), *end = text;
    for (size_t i = 0; i < l->count; i++)
        end += sprintf(end, "%s%s", i ? ", " : "", l->item[i]);
    return text;
}

char *list_sentence(const list *l, const char *last) {
    char *text = text_print("%s", l->count ? l->item[0] : "");
    for (size_t i = 1; i < l->count; i++)
        if (i + 1 < l->count)
            text_extend(&text, ", %s", l->item[i]);
        else
            text_extend(&text, " %s %s", last, l->item[i]);
    return text;
}

static size_t least(size_t a, size_t b) {
    return a < b ? a : b;
}

/* Letters to insert, delete or replace. */
static size_t distance(const char *a, const char *b) {
    size_t width = strlen(b), last = 0;
    size_t *edits = tool_allocate(width + 1, sizeof *edits);
    for (size_t j = 0; j <= width; j++)
        edits[j] = j;
    for (size_t i = 0; a[i]; i++) {
        last = edits[0]++;
        for (size_t j = 0; j < width; j++) {
            size_t replaced = last + (a[i] != b[j]);
            last = edits[j + 1];
            edits[j + 1] = least(replaced, least(last, edits[j]) + 1);
        }
    }
    last = edits[width];
    tool_release(edits);
    return last;
}

const char *list_closest(const list *l, const char *name) {
    size_t length = strlen(name), best = length < 4 ? 2 : length / 3 + 2;
    const char *closest = NULL;
    for (size_t i = 0; i < l->count; i++) {
        const char *item = l->item[i];
        size_t d = distance(name, item);
        if (length > 2 && strncmp(name, item, length) == 0)
            d = 1;
        if (d < best)
            best = d, closest = item;
    }
    return closest;
}

/* Puts question marks for characters that would control a terminal. */
static void make_safe(char *text) {
    for (; *text; text++)
        if (((unsigned char)*text < ' ' && !strchr("\n\t", *text)) ||
            *text == 0x7F)
            *text = '?';
}

static bool continues(char byte) { /* a character of UTF-8 */
    return ((unsigned char)byte & 0xC0) == 0x80;
}

/* Takes the middle out of what is long: a file may be given where a name is meant. */
static void shorten(char *text) {
    enum { LONGEST = 1000, PART = 450 };
    size_t length = strlen(text), first = PART, last = length - PART;
    if (length <= LONGEST)
        return;
    while (first > 0 && continues(text[first]))
        first--;
    while (continues(text[last]))
        last++;
    memcpy(text + first, "...", 3);
    memmove(text + first + 3, text + last, length - last + 1);
}

int tool_refuse(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    char *text = print(format, arguments);
    va_end(arguments);
    fflush(stdout);
    make_safe(text);
    shorten(text);
    fprintf(stderr, "nevh: %s\n", text);
    tool_release(text);
    return TOOL_USAGE;
}

int tool_unknown(const char *kind, const char *name, const list *known) {
    enum { FEW = 12 };
    const char *closest = list_closest(known, name);
    if (closest)
        return tool_refuse("unknown %s %s; did you mean %s?", kind, name,
                           closest);
    if (known->count > FEW || known->count == 0)
        return tool_refuse("unknown %s %s", kind, name);
    return tool_refuse("unknown %s %s; there are %s", kind, name,
                       list_joined(known));
}

void help_print(FILE *f, int used, int column, const char *text) {
    enum { WIDTH = 80 };
    if (column > 0 && used + 2 > column) {
        fputc('\n', f);
        used = 0;
    }
    for (; *text; used = 0) {
        size_t end = strlen(text);
        if (end > (size_t)(WIDTH - column))
            for (end = (size_t)(WIDTH - column); end && text[end] != ' ';)
                end--;
        end = end ? end : strcspn(text, " ");
        fprintf(f, "%*s%.*s\n", column - used, "", (int)end, text);
        text += end;
        text += strspn(text, " ");
    }
}

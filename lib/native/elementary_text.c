/* nevh: the elementary functions that a text calls, as C text before it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/writer_private.h"
#include <ctype.h>
#include <string.h>

enum { MOST = 64 };
static const struct {
    int lanes;
    const char *call;
} shapes[] = {{1, "own_"}, {8, "wide_"}, {4, "few_"}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

/* A function of elementary.h: lines from its comment or head to its end. */
typedef struct {
    size_t from, until;
    char call[24]; /* "NAME)" */
    bool used[SHAPES];
} function;

static size_t find_functions(const char *const lines[], function all[MOST]) {
    static const char head[] = "NEVH__INLINE ", name[] = " ONE(";
    size_t count = 0, from = 0;
    bool open = false;
    for (size_t i = 0; lines[i]; i++) {
        if (!open && strcmp(lines[i], "\n") == 0)
            from = i + 1;
        if (strncmp(lines[i], head, sizeof head - 1) == 0 && count < MOST) {
            const char *begin = strstr(lines[i], name) + sizeof name - 1;
            all[count] = (function){.from = from};
            memcpy(all[count].call, begin, strcspn(begin, ")") + 1);
            open = true;
        }
        if (open && lines[i][0] == '}') {
            all[count++].until = i + 1;
            open = false;
        }
    }
    return count;
}

/* Marks those whose names follow a prefix in the text. */
static void mark_called(const char *text, function all[], size_t count,
                        const char *prefix, int shape) {
    for (const char *at = text; (at = strstr(at, prefix));) {
        bool begins = at == text || (!isalnum((unsigned char)at[-1]) &&
                                     at[-1] != '_');
        at += strlen(prefix);
        for (size_t i = 0; begins && i < count; i++) {
            size_t length = strlen(all[i].call) - 1;
            if (strncmp(at, all[i].call, length) == 0 &&
                (at[length] == '(' || at[length] == ')'))
                all[i].used[shape] = true;
        }
    }
}

/* A function stands behind those that it calls. */
static bool mark_all(const nevh__writer *w, size_t at, function all[],
                     size_t count, int shape) {
    bool any = false;
    mark_called(w->text + at, all, count, shapes[shape].call, shape);
    for (size_t i = count; i-- > 0;)
        for (size_t k = all[i].from; all[i].used[shape] && k < all[i].until;
             k++) {
            mark_called(nevh__elementary_text[k], all, count, "ONE(", shape);
            any = true;
        }
    return any;
}

static void write_shape(nevh__writer *w, const function all[], size_t count,
                        int shape) {
    nevh__write(w, "#undef SHAPE\n#define SHAPE %d\n", shapes[shape].lanes);
    nevh__write_lines(w, nevh__elementary_shape_text);
    for (size_t i = 0, line = 0; i < count; i++) {
        /* What stands between functions is of all. */
        for (; line < all[i].from; line++)
            nevh__write(w, "%s", nevh__elementary_text[line]);
        for (; line < all[i].until; line++)
            if (all[i].used[shape])
                nevh__write(w, "%s", nevh__elementary_text[line]);
    }
}

void nevh__write_elementary(nevh__writer *w, size_t at) {
    function all[MOST];
    size_t count = find_functions(nevh__elementary_text, all);
    nevh__writer own = {.readable = false};
    if (w->failed)
        return;
    for (int shape = 0; shape < SHAPES; shape++) {
        bool any = mark_all(w, at, all, count, shape);
        if (shape == 0 && any)
            nevh__write_lines(&own, nevh__turn_far_text);
        if (any || (shape == 0 && (!w->readable || strstr(w->text, "own_"))))
            write_shape(&own, all, count, shape);
    }
    nevh__writer_insert(w, at, own.text, own.used);
    w->failed |= own.failed;
    nevh__writer_free(&own);
}

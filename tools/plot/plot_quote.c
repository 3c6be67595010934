/* nevh: plots: texts in the language of gnuplot.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <string.h>

/* In double quotes a backslash, a quote and a backquote (a command, to gnuplot)
   mean something; written as numbers they do not. */
static void quote_letter(FILE *f, const char *c, size_t bytes) {
    if (bytes == 0)
        fputc('?', f);
    else if ((unsigned char)*c < ' ' || *c == 0x7f)
        fputc(' ', f);
    else if (strchr("\\\"`", *c))
        fprintf(f, "\\%03o", (unsigned)*c);
    else
        fwrite(c, 1, bytes, f);
}

/* The first `bytes` of the text. */
void plot_quote_part(FILE *f, const char *text, size_t bytes,
                     const char *more) {
    fputc('"', f);
    for (const char *end = text + bytes; text < end;) {
        size_t letter = plot_letter_bytes((const unsigned char *)text);
        quote_letter(f, text, letter);
        text += letter ? letter : 1;
    }
    fprintf(f, "%s\"", more);
}

static size_t bytes_of(const char *text, size_t letters) {
    size_t at = 0;
    while (text[at] && letters--) {
        size_t bytes = plot_letter_bytes((const unsigned char *)text + at);
        at += bytes ? bytes : 1;
    }
    return at;
}

char *plot_shortened(const char *text, size_t longest) {
    bool cut = plot_letters(text) > longest;
    return text_print("%.*s%s",
                      (int)bytes_of(text, cut ? longest - 3 : longest), text,
                      cut ? "..." : "");
}

void plot_quote(FILE *f, const char *text, size_t longest) {
    char *part = plot_shortened(text, longest);
    plot_quote_part(f, part, strlen(part), "");
}

void plot_quote_line(FILE *f, const char *before, const char *text,
                     double length, const char *after) {
    fputs(before, f);
    plot_quote(f, text ? text : "", (size_t)fmax(length, 8));
    fprintf(f, " noenhanced%s\n", after);
}

/* nevh: tables as aligned text, CSV (RFC 4180) and JSON (RFC 8259).
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_private.h"
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

table *table_new(void) {
    return tool_allocate(1, sizeof(table));
}

void table_column(table *t, const char *title) {
    list_add(&t->title, title);
    t->key = tool_enlarge(t->key, t->title.count, sizeof *t->key);
    t->key[t->title.count - 1] = false;
}

void table_key(table *t) {
    t->key[t->title.count - 1] = true;
}

void table_break(table *t) {
    t->breaking = t->title.count;
}

void table_below(table *t) {
    t->below = true;
}

void table_group(table *t) {
    t->begins = t->cell.count > 0;
}

static void add(table *t, table_kind k, const char *text) {
    size_t i = t->cell.count;
    list_add(&t->cell, text);
    t->kind = tool_grown(t->kind, i, sizeof *t->kind);
    t->group = tool_grown(t->group, i, sizeof *t->group);
    t->kind[i] = k;
    t->group[i] = t->begins;
    t->begins = false;
}

void table_titles(table *t, const char *titles) {
    list each = {0};
    list_split(&each, titles);
    for (size_t i = 0; i < each.count; i++)
        table_column(t, each.item[i]);
}

void table_text(table *t, const char *text) {
    add(t, text ? TABLE_TEXT : TABLE_EMPTY, text ? text : "");
}

void table_round(table *t) {
    t->rounds = true;
}

void table_number(table *t, double number) {
    char text[NUMBER_SIZE];
    bool there = isfinite(number);
    if (t->rounds)
        snprintf(text, sizeof text, "%.10g", number);
    else
        number_text(text, number);
    add(t, there ? TABLE_NUMBER : TABLE_EMPTY, there ? text : "");
}

void table_error(table *t, double error) {
    if (isfinite(error))
        table_shown(t, "%.1e", error);
    else
        table_text(t, NULL);
}

void table_shown(table *t, const char *format, ...) {
    char text[80];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    add(t, TABLE_NUMBER, text);
}

/* Characters of UTF-8 up to the end of a line, whatever the locale. */
static size_t characters(const char *text) {
    size_t count = 0;
    for (; *text && *text != '\n'; text++)
        count += ((unsigned char)*text & 0xC0) != 0x80;
    return count;
}

static const char *line_of(const char *text, size_t line) {
    while (line-- && text)
        text = (text = strchr(text, '\n')) ? text + 1 : NULL;
    return text ? text : "";
}

static size_t lines(const table *t) {
    size_t most = 0;
    for (size_t j = 0; j < t->title.count; j++) {
        size_t count = 1;
        for (const char *c = t->title.item[j]; *c; c++)
            count += *c == '\n';
        most = count > most ? count : most;
    }
    return most;
}

static size_t rows(const table *t) {
    return t->title.count ? t->cell.count / t->title.count : 0;
}

static size_t wider(size_t width, const char *text) {
    size_t w = characters(text);
    return w > width ? w : width;
}

static size_t column_width(const table *t, size_t j) {
    size_t width = 0, columns = t->title.count;
    for (size_t k = 0; k < lines(t); k++)
        width = wider(width, line_of(t->title.item[j], k));
    for (size_t i = j; i < t->cell.count; i += columns)
        width = wider(width, t->cell.item[i]);
    return width;
}

/* Columns without a number are set to the left. */
static bool to_the_right(const table *t, size_t j) {
    for (size_t i = j; i < t->cell.count; i += t->title.count)
        if (t->kind[i] == TABLE_NUMBER)
            return true;
    return false;
}

/* Control characters of names and texts are for nobody's terminal. */
static void print_safely(const char *text, size_t bytes, FILE *f) {
    for (size_t i = 0; i < bytes; i++) {
        unsigned char c = (unsigned char)text[i];
        fputc((c < ' ' && c != '\t') || c == 0x7F ? '?' : c, f);
    }
}

/* No line ends in spaces. */
static void print_line(const char *text, size_t bytes, FILE *f) {
    while (bytes > 0 && text[bytes - 1] == ' ')
        bytes--;
    print_safely(text, bytes, f);
    fputc('\n', f);
}

/* Breaks a text at spaces into lines of at most 80 characters.
   first, more  the indentation of the first line and of the others */
static void print_paragraph(const char *text, size_t first, size_t more,
                            FILE *f) {
    enum { WIDTH = 80 };
    for (size_t in = first; *text; in = more) {
        size_t end = strlen(text), last = 0;
        if (in + end > WIDTH) {
            for (size_t i = 0; i + in <= WIDTH; i++)
                last = text[i] == ' ' ? i : last;
            end = last ? last : strcspn(text, " ");
        }
        fprintf(f, "%*s", (int)in, "");
        print_line(text, end, f);
        text += end;
        text += strspn(text, " ");
    }
}

/* A text that begins with a space is printed as it is. */
static void print_wrapped(const char *text, FILE *f) {
    if (*text == ' ')
        print_line(text, strlen(text), f);
    else
        print_paragraph(text, 0, 2, f);
}

/* The layout of a column, found once. */
typedef struct {
    size_t width;
    bool right;
} setting;

static setting *set_columns(const table *t) {
    setting *all = tool_allocate(t->title.count, sizeof *all);
    for (size_t j = 0; j < t->title.count; j++)
        all[j] = (setting){column_width(t, j), to_the_right(t, j)};
    return all;
}

/* Spaces are held back until something follows them. */
static void print_padded(const char *text, size_t *spaces, FILE *f) {
    size_t bytes = strcspn(text, "\n");
    if (bytes == 0)
        return;
    fprintf(f, "%*s%.*s", (int)*spaces, "", (int)bytes, text);
    *spaces = 0;
}

static void print_cell(const setting *column, size_t gap, const char *text,
                       size_t *spaces, FILE *f) {
    size_t space = column->width - characters(text);
    *spaces += gap + (column->right ? space : 0);
    print_padded(text, spaces, f);
    *spaces += column->right ? 0 : space;
}

/* Columns beside each other: those from `first` to before `last`, after the
   keys among those before. */
typedef struct {
    const setting *set;
    size_t first, last, gap;
} panel;

static bool is_shown(const table *t, const panel *p, size_t j) {
    return j < p->last && (j >= p->first || t->key[j]);
}

static void print_row(const table *t, const panel *p, const char *const text[],
                      FILE *f) {
    bool first = true;
    for (size_t j = 0, spaces = 0; j < p->last; j++)
        if (is_shown(t, p, j)) {
            print_cell(&p->set[j], first ? 1 : p->gap, text[j], &spaces, f);
            first = false;
        }
    fputc('\n', f);
}

static void print_panel(const table *t, const panel *p, FILE *f) {
    size_t columns = t->title.count;
    const char **text = tool_allocate(columns, sizeof *text);
    for (size_t k = 0; k < lines(t); k++) {
        for (size_t j = 0; j < columns; j++)
            text[j] = line_of(t->title.item[j], k);
        print_row(t, p, text, f);
    }
    for (size_t i = 0; i < rows(t); i++) {
        if (t->group[i * columns])
            fputc('\n', f);
        for (size_t j = 0; j < columns; j++)
            text[j] = t->cell.item[i * columns + j];
        print_row(t, p, text, f);
        if (t->below)
            print_paragraph(text[columns - 1], 4, 6, f);
    }
}

static size_t panel_width(const table *t, const panel *p) {
    size_t width = 0;
    for (size_t j = 0; j < p->last; j++)
        if (is_shown(t, p, j))
            width += p->set[j].width + (width ? p->gap : 1);
    return width;
}

/* All columns; of a table that may be broken as many as fit, closer to each
   other if need be. */
static panel panel_from(const table *t, const setting set[], size_t first) {
    enum { MOST = 100 };
    panel p = {set, first, t->title.count - t->below, 2};
    if (!t->breaking)
        return p;
    if (panel_width(t, &p) > MOST && first == 0)
        p.last = t->breaking;
    if (panel_width(t, &p) > MOST)
        p.gap = 1;
    while (p.last > first + 1 && panel_width(t, &p) > MOST)
        p.last--;
    return p;
}

static void print_table(const table *t, FILE *f) {
    setting *set = set_columns(t);
    for (size_t first = 0; first < t->title.count - t->below;) {
        panel p = panel_from(t, set, first);
        if (first)
            fputc('\n', f);
        print_panel(t, &p, f);
        first = p.last;
    }
}

/* Spreadsheets compute a text that begins so, unless an apostrophe is before it. */
static bool is_computed(const char *text) {
    char *end;
    if (!*text || !strchr("=+-@\t\r", *text))
        return false;
    strtod(text, &end);
    return *end || end == text;
}

static void print_quoted(const char *text, FILE *f) {
    const char *before = is_computed(text) ? "'" : "";
    if (!strpbrk(text, ",\"\r\n")) {
        fprintf(f, "%s%s", before, text);
        return;
    }
    fprintf(f, "\"%s", before);
    for (; *text; text++)
        fputs(*text == '"' ? "\"\"" : (char[]){*text, 0}, f);
    fputc('"', f);
}

/* A title on one line: "-\n" divides a word, "\n" words. */
static char *joined_title(const char *title) {
    char *text = text_print("%s", title), *to = text;
    for (const char *from = text; *from; from++)
        if (from[0] == '-' && from[1] == '\n')
            from++;
        else
            *to++ = *from == '\n' ? ' ' : *from;
    *to = '\0';
    return text;
}

/* Lines end with a line feed, as all text here does. */
static void print_csv(const table *t, FILE *f) {
    size_t columns = t->title.count;
    for (size_t j = 0; j < columns; j++) {
        char *title = joined_title(t->title.item[j]);
        print_quoted(title, f);
        fputc(j + 1 < columns ? ',' : '\n', f);
    }
    for (size_t i = 0; i < t->cell.count; i++) {
        print_quoted(t->cell.item[i], f);
        fputc((i + 1) % columns ? ',' : '\n', f);
    }
}

/* Bytes of the character of UTF-8 that a text begins with; 0: it is none, an
   overlong one, a surrogate, or beyond U+10FFFF. */
static size_t character_bytes(const char *text) {
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char *at = (const unsigned char *)text;
    size_t count = *at < 0x80   ? 1
                   : *at < 0xC2 ? 0
                   : *at < 0xE0 ? 2
                   : *at < 0xF0 ? 3
                   : *at < 0xF5 ? 4
                                : 0;
    uint32_t code = count > 1 ? *at & (0xFFu >> (count + 1)) : *at;
    for (size_t i = 1; i < count; i++) {
        if ((at[i] & 0xC0) != 0x80)
            return 0;
        code = code << 6 | (at[i] & 0x3F);
    }
    bool wrong = code < least[count] || (code >= 0xD800 && code < 0xE000) ||
                 code > 0x10FFFF;
    return wrong ? 0 : count;
}

/* Replaces bytes that are not UTF-8, as names of files may have, by U+FFFD. */
void json_string(const char *text, FILE *f) {
    fputc('"', f);
    while (*text) {
        size_t bytes = character_bytes(text);
        if ((unsigned char)*text < ' ')
            fprintf(f, "\\u%04x", (unsigned)*text);
        else if (bytes == 0)
            fputs("\\ufffd", f);
        else
            fprintf(f, "%s%.*s", *text == '"' || *text == '\\' ? "\\" : "",
                    (int)bytes, text);
        text += bytes ? bytes : 1;
    }
    fputc('"', f);
}

static void print_value(const table *t, size_t i, FILE *f) {
    if (t->kind[i] == TABLE_TEXT)
        json_string(t->cell.item[i], f);
    else
        fputs(t->kind[i] == TABLE_NUMBER ? t->cell.item[i] : "null", f);
}

static void print_rows(const table *t, FILE *f) {
    size_t columns = t->title.count;
    fputs("  \"rows\": [", f);
    for (size_t i = 0; i < t->cell.count; i++) {
        fputs(i % columns ? ", " : i ? ",\n    {" : "\n    {", f);
        char *title = joined_title(t->title.item[i % columns]);
        json_string(title, f);
        fputs(": ", f);
        print_value(t, i, f);
        fputs((i + 1) % columns ? "" : "}", f);
    }
    fputs("\n  ]", f);
}

static void print_strings(const char *name, const list *l, FILE *f) {
    fprintf(f, "  \"%s\": [", name);
    for (size_t i = 0; i < l->count; i++) {
        fputs(i ? ",\n    " : "\n    ", f);
        json_string(l->item[i], f);
    }
    fputs("\n  ]", f);
}

static void print_json(const page *p, FILE *f) {
    fputs("{\n", f);
    print_strings("notes", &p->before, f);
    fputs(",\n", f);
    print_rows(p->table, f);
    fputs(",\n", f);
    print_strings("verdict", &p->after, f);
    fputs("\n}\n", f);
}

static void print_comments(const list *l, FILE *f) {
    for (size_t i = 0; i < l->count; i++) {
        fputs("# ", f);
        print_safely(l->item[i], strlen(l->item[i]), f);
        fputc('\n', f);
    }
}

static void print_all_wrapped(const list *l, FILE *f) {
    for (size_t i = 0; i < l->count; i++)
        print_wrapped(l->item[i], f);
}

void page_print(const page *p, const options *o, FILE *f) {
    if (o->as_html) {
        page_html(p, f);
    } else if (o->format == FORMAT_JSON) {
        print_json(p, f);
    } else if (o->format == FORMAT_CSV) {
        if (!o->quiet)
            print_comments(&p->before, f);
        print_csv(p->table, f);
    } else {
        if (!o->quiet)
            print_all_wrapped(&p->before, f);
        fputs(!o->quiet && p->before.count ? "\n" : "", f);
        print_table(p->table, f);
        fputs(!o->quiet && p->after.count ? "\n" : "", f);
        if (!o->quiet)
            print_all_wrapped(&p->after, f);
    }
}

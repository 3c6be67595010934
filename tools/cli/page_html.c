/* nevh: a page as HTML: notes, a table with its headings, words.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_private.h"

void html_text(FILE *f, const char *text) {
    for (; *text; text++)
        switch (*text) {
        case '&':
            fputs("&amp;", f);
            break;
        case '<':
            fputs("&lt;", f);
            break;
        case '>':
            fputs("&gt;", f);
            break;
        case '"':
            fputs("&quot;", f);
            break;
        case '\n':
            fputc(' ', f);
            break;
        default:
            /* Control characters are none of HTML's. */
            fputc((unsigned char)*text < ' ' || *text == 0x7f ? '?' : *text, f);
        }
}

/* Lines that begin with a space are set as they are; empty ones are the terminal's. */
static void put_lines(FILE *f, const list *l) {
    bool set = false;
    for (size_t i = 0; i < l->count; i++) {
        bool is_set = l->item[i][0] == ' ';
        if (!*l->item[i])
            continue;
        if (is_set != set)
            fputs(is_set ? "<pre tabindex=\"0\">" : "</pre>\n", f);
        fputs(is_set ? "" : "<p>", f);
        html_text(f, l->item[i]);
        fputs(is_set ? "\n" : "</p>\n", f);
        set = is_set;
    }
    fputs(set ? "</pre>\n" : "", f);
}

static void put_table(FILE *f, const table *t) {
    size_t columns = t->title.count;
    size_t rows = columns ? t->cell.count / columns : 0;
    if (rows == 0)
        return;
    fputs("<div class=\"wide\" tabindex=\"0\"><table>\n<thead><tr>", f);
    for (size_t j = 0; j < columns; j++) {
        bool titled = *t->title.item[j];
        fputs(titled ? "<th scope=\"col\">" : "<td>", f);
        html_text(f, t->title.item[j]);
        fputs(titled ? "</th>" : "</td>", f);
    }
    fputs("</tr></thead>\n<tbody>\n", f);
    for (size_t i = 0; i < rows * columns; i++) {
        const char *tag = i % columns ? "td" : "th scope=\"row\"";
        if (i % columns == 0)
            fprintf(f, i && t->group[i] ? "</tbody>\n<tbody>\n<tr>" : "<tr>");
        fprintf(f, "<%s%s>", tag,
                t->kind[i] == TABLE_NUMBER ? " class=\"number\"" : "");
        html_text(f, t->cell.item[i]);
        fprintf(f, "</%.2s>%s", tag, (i + 1) % columns ? "" : "</tr>\n");
    }
    fputs("</tbody></table></div>\n", f);
}

void page_html(const page *p, FILE *f) {
    put_lines(f, &p->before);
    put_table(f, p->table);
    put_lines(f, &p->after);
}

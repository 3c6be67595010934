/* nevh report: the parts of the page.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "config.h"
#include "report_private.h"
#include <stdlib.h>
#include <string.h>

static const char style[] =
    ":root{color-scheme:light dark;--line:#8888}\n"
    "body{font:16px/1.5 system-ui,sans-serif;max-width:62rem;margin:auto;"
    "padding:1rem;overflow-wrap:anywhere}\n"
    "h1,h2,h3{line-height:1.2}\n"
    ".wide{overflow-x:auto}\n"
    "table{border-collapse:collapse;font-size:.9rem;margin:1rem 0;"
    "overflow-wrap:normal}\n"
    "th,td{padding:.15rem .6rem;text-align:left;vertical-align:top;"
    "font-weight:normal}\n"
    "tbody th{white-space:nowrap}\n"
    "thead th{border-bottom:1px solid var(--line);font-weight:bold;"
    "vertical-align:bottom}\n"
    "tbody{border-bottom:1px solid var(--line)}\n"
    ".number{text-align:right;font-variant-numeric:tabular-nums;"
    "white-space:nowrap}\n"
    "figure{margin:1rem 0;background:#fff;color:#000;color-scheme:light;"
    "border-radius:4px}\n"
    "svg{display:block;width:100%;height:auto;max-height:95vh}\n"
    ".sized{container-type:inline-size}\n"
    ".narrow{display:none;max-width:32rem;max-height:none}\n"
    "@container(max-width:42rem){.broad{display:none}"
    ".narrow{display:block}}\n"
    "figcaption{padding:.3rem .6rem}input{width:50%}\n"
    "pre{overflow-x:auto;font-size:.85rem}\n"
    "dd{overflow-x:auto;overflow-y:hidden;margin:0 0 0 1.5rem;"
    "padding:.3rem 0}\n"
    "math{font-size:1.15em}\n"
    ".off{opacity:.6}\n"
    "@media print{tr,figure{break-inside:avoid}"
    "h2,h3,h2+p,h2+p+p{break-after:avoid}"
    "p{orphans:3;widows:3}svg{max-height:13cm}"
    "dd,pre,.wide{overflow:visible}button,input{display:none}}\n";

static const char wide_style[] =
    "body{max-width:120rem}\n"
    ".variants{display:grid;gap:0 2rem;"
    "grid-template-columns:repeat(auto-fit,minmax(min(100%,32rem),1fr))}\n"
    ".variants>section{min-width:0}\n";

void html_head(FILE *f, const char *title, bool wide) {
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
          "<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
          "content=\"width=device-width, initial-scale=1\">\n<title>",
          f);
    html_text(f, title);
    fprintf(f, "</title>\n<style>\n%s%s</style>\n</head>\n<body>\n<main>\n",
            style, wide ? wide_style : "");
}

void html_side_by_side(FILE *f, size_t count, bool begins) {
    if (count > 1)
        fputs(begins ? "<div class=\"variants\">\n" : "</div>\n", f);
}

static void put_heading(FILE *f, const char *title, const char *name) {
    fputs("<h2>", f);
    html_text(f, title);
    fputs(name ? ": " : "", f);
    html_text(f, name ? name : "");
    fputs("</h2>\n", f);
}

static void put_drawing(FILE *f, const report_part *p, const char *drawing,
                        const char *look, size_t number) {
    static const char begin[] = "<svg";
    const char *body = strchr(drawing, '>');
    if (!body || strncmp(drawing, begin, sizeof begin - 1) != 0)
        return;
    drawing += sizeof begin - 1;
    fprintf(f,
            "<svg class=\"%s\" role=\"img\" "
            "aria-labelledby=\"t%zu\"%.*s>\n<title id=\"t%zu\">",
            look, number, (int)(body - drawing), drawing, number);
    html_text(f, p->title);
    fputs(". ", f);
    html_text(f, p->about);
    fprintf(f, "</title>%s", body + 1);
}

/* Twice: one of both is shown, by the room that there is. */
static void put_picture(FILE *f, const report_part *p, size_t number) {
    fputs("<figure class=\"sized\">\n", f);
    put_drawing(f, p, p->picture, "broad", 2 * number);
    if (p->narrow)
        put_drawing(f, p, p->narrow, "narrow", 2 * number + 1);
    fputs("</figure>\n", f);
}

/* Each line of notes once: most commands begin with the same ones. */
static void put_notes_once(FILE *f, char *html, list *earlier) {
    for (char *line = strtok(html, "\n"); line; line = strtok(NULL, "\n")) {
        bool note = strncmp(line, "<p>", 3) == 0;
        if (note && list_has(earlier, line))
            continue;
        if (note)
            list_add(earlier, line);
        fprintf(f, "%s\n", line);
    }
}

void html_part(FILE *f, const report_part *p, size_t number, list *earlier) {
    fputs("<section>\n", f);
    put_heading(f, p->title, p->variant);
    fputs("<p>", f);
    html_text(f, p->about);
    fputs("</p>\n", f);
    if (p->picture)
        put_picture(f, p, number);
    if (p->html)
        put_notes_once(f, p->html, earlier);
    if (p->messages && *p->messages) {
        fputs("<pre tabindex=\"0\">", f);
        for (char *line = strtok(p->messages, "\n"); line;
             line = strtok(NULL, "\n")) {
            html_text(f, line);
            fputc('\n', f);
        }
        fputs("</pre>\n", f);
    }
    fprintf(f, "<p>%s <code>", p->by ? p->by : "Made by");
    html_text(f, p->command);
    fputs("</code></p>\n</section>\n", f);
}

static void put_equation(FILE *f, const nevh_scene *scene, size_t i) {
    nevh_scene_equation e = nevh_scene_equation_at(scene, i);
    char *math = nevh_scene_equation_mathml(scene, i);
    fprintf(f, "<dd%s tabindex=\"0\">", e.on ? "" : " class=\"off\"");
    if (strcmp(e.section, "effects") == 0 || strcmp(e.section, "friction") == 0)
        fputs(e.on ? "" : "(off) ", f);
    if (math)
        fputs(math, f);
    else {
        fputs("<code>", f);
        html_text(f, e.name);
        fputs(" = ", f);
        html_text(f, e.value);
        fputs("</code>", f);
    }
    fputs("</dd>\n", f);
    free(math);
}

void html_title(FILE *f, const nevh_scene *scene, const char *title) {
    const char *source = nevh_scene_source(scene);
    fputs("<h1>", f);
    html_text(f, title);
    fputs("</h1>\n", f);
    if (*source) {
        fputs("<p>Source: ", f);
        html_text(f, source);
        fputs("</p>\n", f);
    }
}

void html_scene(FILE *f, const nevh_scene *scene, const char *name) {
    const char *section = "";
    fputs("<section>\n", f);
    put_heading(f, "The Hamiltonian", name);
    fputs("<p>H is the sum of the effects that are on.</p>\n<dl>\n", f);
    for (size_t i = 0; i < nevh_scene_equation_count(scene); i++) {
        nevh_scene_equation e = nevh_scene_equation_at(scene, i);
        if (strcmp(section, e.section) != 0)
            fprintf(f, "<dt>%s</dt>\n", section = e.section);
        put_equation(f, scene, i);
    }
    fputs("</dl>\n</section>\n", f);
}

void html_foot(FILE *f) {
    fputs("</main>\n<footer><p>Made by nevh " PACKAGE_VERSION
          ".</p></footer>\n</body>\n</html>\n",
          f);
}

/* nevh report: the parts of the page.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "config.h"
#include "plot/looks.h"
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
    "figure{margin:1rem 0;border-radius:4px}\n"
    ".facts th{font-weight:bold;white-space:nowrap}\n"
    ".contents{columns:16rem;padding-left:1.2rem}\n"
    "svg{display:block;width:100%;height:auto;max-height:95vh}\n"
    ".sized{container-type:inline-size}\n"
    ".narrow{display:none;max-width:32rem;max-height:none}\n"
    "@container(max-width:42rem){.broad{display:none}"
    ".narrow{display:block}}\n"
    "figcaption{padding:.3rem .6rem}input{width:50%}\n"
    "pre{white-space:pre-wrap;overflow-wrap:anywhere;font-size:.85rem}\n"
    "dd{overflow-x:auto;overflow-y:hidden;margin:0 0 0 1.5rem;"
    "padding:.3rem 0}\n"
    "math{font-size:1.15em}\n"
    ".off{opacity:.6}\n"
    "@media print{@page{margin:1.2cm}"
    "body{font-size:9pt;line-height:1.25;max-width:none;padding:0}"
    "h1{font-size:15pt;margin:0 0 .3rem}h2{font-size:11pt;margin:.6rem 0 .2rem}"
    "p,table,dl,figure{margin:.2rem 0}table{font-size:6.8pt}pre{font-size:6.8pt}"
    "th,td{padding:0 .3rem}"
    "tr,figure{break-inside:avoid}"
    "h2,h3,h2+p,h2+p+p{break-after:avoid}"
    "p{orphans:3;widows:3}svg{max-height:6.1cm}"
    "dd,pre,.wide{overflow:visible}"
    "button,input,nav,.film{display:none}}\n";

/* Colours of pictures on white, and on black. */
static const struct {
    const char *light, *dark;
} colours[] = {
#define PAIR(light, dark) {light, dark},
    NEVH_COLOURS(PAIR){"#ffffff", "#17171b"},
    {"#444444", "#b8b8c2"},
    {"#555555", "#a5a5b0"},
    {"#777777", "#9a9aa6"},
    {"#777", "#9a9aa6"},
    {"#dddddd", "#34343a"},
    {"#bbbbbb", "#55555e"},
    {"#f4f4f4", "#202026"},
    {"#000", "#ececf1"}};

static void put_dark(FILE *f) {
    fputs("@media screen and (prefers-color-scheme:dark){"
          "figure svg{fill:#ececf1}\n",
          f);
    for (size_t i = 0; i < sizeof colours / sizeof *colours; i++)
        fprintf(f,
                "figure [stroke='%s']{stroke:%s}figure [fill='%s']{fill:%s}\n",
                colours[i].light, colours[i].dark, colours[i].light,
                colours[i].dark);
    fputs("}\n", f);
}

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
    fprintf(f, "</title>\n<style>\n%s%s", style, wide ? wide_style : "");
    put_dark(f);
    fputs("</style>\n</head>\n<body>\n<main>\n", f);
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

static bool is_note(const char *line) {
    return strncmp(line, "<p>", 3) == 0;
}

/* Each line of notes once: most commands begin with the same ones. */
static void put_notes_once(FILE *f, char *html, list *earlier) {
    for (char *line = strtok(html, "\n"); line; line = strtok(NULL, "\n")) {
        bool note = is_note(line);
        if (note && list_has(earlier, line))
            continue;
        if (note)
            list_add(earlier, line);
        fprintf(f, "%s\n", line);
    }
}

void html_find_facts(const char *html, list *facts, list *earlier) {
    char *line = strtok(text_print("%s", html ? html : ""), "\n");
    if (line && is_note(line)) { /* the title */
        list_add(earlier, line);
        line = strtok(NULL, "\n");
    }
    for (; line && is_note(line); line = strtok(NULL, "\n")) {
        list_add(earlier, line);
        list_print(facts, "%.*s", (int)(strlen(line) - strlen("<p></p>")),
                   line + strlen("<p>"));
    }
}

/* "H = T(p) + V(q)", "gradient: exact". */
static void put_fact(FILE *f, const char *text) {
    enum { LONGEST = 30 };
    const char *colon = strstr(text, ": "), *equals = strstr(text, " = ");
    const char *end = equals && (!colon || equals < colon) ? equals : colon;
    if (end && end - text <= LONGEST)
        fprintf(f, "<tr><th scope=\"row\">%.*s</th><td>%s</td></tr>\n",
                (int)(end - text), text, end + (end == equals ? 3 : 2));
    else
        fprintf(f, "<tr><td colspan=\"2\">%s</td></tr>\n", text);
}

void html_contents(FILE *f, const list *parts) {
    fputs("<nav aria-label=\"Contents\"><ul class=\"contents\">\n", f);
    for (size_t i = 0; i < parts->count; i++) {
        size_t digits = strcspn(parts->item[i], " ");
        fprintf(f, "<li><a href=\"#part%.*s\">", (int)digits, parts->item[i]);
        html_text(f, parts->item[i] + digits + 1);
        fputs("</a></li>\n", f);
    }
    fputs("</ul></nav>\n", f);
}

void html_part(FILE *f, const report_part *p, size_t number, list *earlier) {
    fprintf(f, "<section id=\"part%zu\"%s>\n", number,
            p->by ? " class=\"film\"" : "");
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
    char *math = text_adopt(nevh_scene_equation_mathml(scene, i));
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

void html_scene(FILE *f, const nevh_scene *scene, const char *name,
                const list *facts) {
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
    fputs("</dl>\n", f);
    if (facts->count)
        fputs("<table class=\"facts\"><tbody>\n", f);
    for (size_t i = 0; i < facts->count; i++)
        put_fact(f, facts->item[i]);
    fputs(facts->count ? "</tbody></table>\n</section>\n" : "</section>\n", f);
}

void html_foot(FILE *f) {
    fputs("</main>\n<footer><p>Made by nevh " PACKAGE_VERSION
          ". The manual is <code>info nevh</code>; <code>nevh sheet</code> "
          "lists worksheets for a class.</p></footer>\n</body>\n</html>\n",
          f);
}

/* nevh report: a page of HTML that fetches nothing.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_REPORT_PRIVATE_H
#define NEVH_REPORT_PRIVATE_H

#include "cli/commands.h"
#include "experiment/plan.h"

/* The output of one command: its page as HTML, its picture, and its messages. Each
   is NULL if there is none. */
typedef struct {
    const char *title, *about; /* about: how to read it */
    const char *variant;       /* NULL: there is one */
    const char *by;            /* before the command; NULL: Made by */
    char *command, *html, *picture, *messages;
    char *narrow; /* the picture for a telephone */
    int status;
} report_part;

/* report_kinds.c: in the order of the page; the last has no title. */
typedef struct {
    const char *title, *about, *arguments;
    const command *of;
    bool (*wanted)(nevh_scene *);
    plot_kind kind;
    bool rows, draws;
    double budget;               /* seconds; 0: as much as the command takes */
    bool (*usual)(nevh_scene *); /* without --all, if wanted; NULL: never */
} kind_of_part;
extern const kind_of_part report_kinds[];

/* variants.c: a scene with settings of its own. */
typedef struct {
    const char *name; /* its settings; NULL: none */
    options given;
    nevh_scene *scene;
    list earlier; /* notes of its parts so far */
    list facts;   /* see html_find_facts */
} variant;
typedef struct {
    size_t count;
    variant *item;
} variants;
/* As --variant says; to be closed in any case.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int variants_open(variants *, const options *, const char *scene);
void variants_close(variants *);

/* report.c: a whole file; NULL: there is none, or it is empty. */
char *text_read(const char *name);

/* report_html.c */
/* wide: things stand side by side */
void html_head(FILE *, const char *title, bool wide);
/* Begins or ends a group of `count` parts side by side; nothing for one. */
void html_side_by_side(FILE *, size_t count, bool begins);
/* number   of its picture in the page
   earlier  in, out: notes of the parts before it, and then its own */
void html_part(FILE *, const report_part *, size_t number, list *earlier);
/* Title and source. */
void html_title(FILE *, const nevh_scene *, const char *title);
/* Links to parts: the number of each, and its title. */
void html_contents(FILE *, const list *parts);
/* The notes that stand before the table of a part, as facts of the scene: "key: text",
   in HTML.  earlier: see html_part. */
void html_find_facts(const char *html, list *facts, list *earlier);
/* The lines that say what H is, and facts.  name: of the variant; NULL: there is
   one. */
void html_scene(FILE *, const nevh_scene *, const char *name,
                const list *facts);
void html_foot(FILE *);

#endif

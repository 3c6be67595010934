/* nevh report: a page of HTML that fetches nothing.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_REPORT_PRIVATE_H
#define NEVH_REPORT_PRIVATE_H

#include "experiment/plan.h"

/* What one command made: its page as HTML, its picture, and its messages.  Each
   is NULL where there is none. */
typedef struct {
    const char *title, *about; /* about: how to read it */
    const char *by;            /* before the command; NULL: Made by */
    char *command, *html, *picture, *messages;
    int status;
    bool undrawn; /* its picture is left out */
} report_part;

/* report.c: a whole file, to be freed; NULL: there is none, or it is empty. */
char *text_read(const char *name);

/* report_html.c: text with markup's characters written out. */
void html_text(FILE *, const char *);
void html_head(FILE *, const char *title);
/* That pictures are left out, and why. */
void html_undrawn(FILE *);
/* number  of its picture in the page
   told    notes that parts before it have, and then its own */
void html_part(FILE *, const report_part *, size_t number, list *told);
/* Title, source, the lines that say what H is. */
void html_scene(FILE *, const nevh_scene *, const char *name);
void html_foot(FILE *);

#endif

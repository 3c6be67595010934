/* nevh: the live page's module: a scene, the runs that race on it, and what of
   them is drawn.

   The page's script calls these functions, which are the module's exports, and
   reads texts and numbers where their results point to.  Nothing else comes in
   or goes out.  Nothing here is for programs in C.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_WEB_PAGE_H
#define NEVH_WEB_PAGE_H

#include <nevh/nevh.h>

enum { PAGE_RUNS = 24, PAGE_MESSAGE = 2000, PAGE_POINTS = 4096 };

/* One scheme, in one slot of the page. */
typedef struct {
    const nevh_integrator *scheme;
    nevh_stepper *stepper; /* NULL: the slot is empty */
    nevh_energy *energy;
    double h;
    size_t width, steps; /* orbits side by side; steps taken */
    double
        *state; /* t, energy, its error, the largest |error| of the steps that
                      were taken last, 2n x width */
    int status;
    nevh_sections *finder; /* NULL: no section is looked at */
    size_t section;        /* its number in the scene */
    struct page *page;
} page_run;

/* What a state begins with. */
enum { PAGE_T, PAGE_ENERGY, PAGE_ERROR, PAGE_MOST, PAGE_STATE };

typedef struct page {
    nevh_scene *scene;
    const nevh_system
        *system; /* the scene's, for as long as it is not changed */
    const nevh_scene_run *run; /* the same */
    size_t n;
    bool balance;  /* H reads t, or there is friction */
    double *start; /* 2n: where runs begin */
    double *shown; /* what was asked for last: a picture, or levels of H */
    char *text;    /* the same, as JSON */
    nevh_field *field;
    page_run runs[PAGE_RUNS];
    double *points; /* pairs: those of the section in the last steps */
    size_t n_points;
    int status;
    char message[PAGE_MESSAGE];
} page;

#define PAGE_EXPORT(name) __attribute__((export_name(#name), used))

/* describe.c: the scene as JSON, to be freed; NULL when memory is out. */
char *page_scene_text(page *);
/* A status, and its message as printf has it; returns the status. */
__attribute__((format(printf, 3, 4))) int page_fail(page *, int status,
                                                    const char *format, ...);
/* absent.c: what was asked for since it was cleared, and is not in the module;
   NULL: nothing. */
extern const char *page_absent;

#endif

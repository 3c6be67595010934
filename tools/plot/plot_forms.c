/* nevh: plots: how series look, in one table that both writers read.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "looks.h"
#include "plot_private.h"
#include <math.h>
#include <string.h>

static const char *const colours[] = {
#define COLOUR(light, dark) light,
    NEVH_COLOURS(COLOUR)};
static const plot_dash_lengths dashes[] = {
    {0}, {12, 5}, {3, 3}, {14, 4, 3, 4}, {20, 6}};
static const int markers[] = {
#define MARK(number, letter, python) number,
    NEVH_MARKS(MARK)};
enum {
    COLOURS = sizeof colours / sizeof *colours,
    DASHES = sizeof dashes / sizeof *dashes,
    MARKERS = sizeof markers / sizeof *markers,
    MARKS = 9 /* of a PLOT_MARKED line */
};

/* The attributes of a form; 0: none, or the default. */
static const struct {
    const char *colour; /* NULL: that of the look */
    double width;
    enum { SOLID, OF_LOOK, AS_ASKED } dash;
    int mark; /* OWN: that of the look */
    double size, opacity;
    const char *edge;
} forms[] = {
#define OWN -1
    [PLOT_LINES] = {.width = 1.5, .dash = OF_LOOK},
    [PLOT_TRAIL] = {.width = 1.5, .dash = AS_ASKED},
    [PLOT_BEHIND] = {.colour = "#bbbbbb", .width = 5},
    [PLOT_REFERENCE] = {.colour = "#777777", .width = 1.5},
    [PLOT_MARKED] = {.width = 1.5, .dash = OF_LOOK, .mark = OWN},
    [PLOT_BOTH] = {.width = 1.5, .dash = OF_LOOK, .mark = OWN},
    [PLOT_POINTS] = {.mark = OWN},
    [PLOT_MEASURED] = {.colour = "#000000", .mark = PLOT_PLUS, .size = 0.8},
    [PLOT_DOTS] = {.mark = PLOT_DISC},
    [PLOT_RINGS] = {.mark = PLOT_CIRCLE},
    [PLOT_RODS] = {.colour = "#777777", .width = 4},
    [PLOT_BOBS] = {.mark = PLOT_DISC, .size = 2.2, .edge = "#000000"},
    [PLOT_GREY_BOBS] = {.colour = "#999999",
                        .mark = PLOT_DISC,
                        .size = 2.2,
                        .edge = "#000000"},
    [PLOT_START] = {.mark = PLOT_CIRCLE, .size = 1.2},
    [PLOT_LEVEL] = {.colour = "#bbbbbb", .width = 0.7},
    [PLOT_SEPARATRIX] = {.colour = "#000000", .width = 1.3},
    [PLOT_CENTRE] = {.colour = "#000000", .mark = PLOT_DISC, .size = 0.8},
    [PLOT_SADDLE] = {.colour = "#000000", .mark = PLOT_CROSS, .size = 1.1},
    [PLOT_FILLED] = {.width = 0.8, .dash = OF_LOOK, .opacity = 0.45},
    [PLOT_HOLE] = {.colour = "#ffffff",
                   .width = 0.8,
                   .opacity = 1,
                   .edge = "#555555"},
    [PLOT_GUIDE] = {.colour = "#999999", .width = 1},
};

const char *plot_colour_of(size_t look) {
    return colours[look % COLOURS];
}

const double *plot_look_dash(size_t look) {
    return dashes[look % DASHES];
}

int plot_look_mark(size_t look) {
    return markers[look % MARKERS];
}

static double dot_size(size_t count) {
    static const double largest = 0.8, smallest = 0.15;
    return fmax(fmin(largest * pow(50 / (double)(count + 1), 0.3), largest),
                smallest);
}

/* A dash tells lines apart: of one alone it would but hide parts. */
static bool is_alone(const plot *p, const series *s) {
    for (size_t i = 0; i < p->count; i++)
        if (p->series[i].panel == s->panel && p->series[i].look != s->look &&
            forms[p->series[i].form].dash == OF_LOOK)
            return false;
    return true;
}

plot_look plot_look_of(const plot *p, const series *s) {
    plot_look l = {.own = !forms[s->form].colour,
                   .width = forms[s->form].width,
                   .dash = dashes[0],
                   .mark = forms[s->form].mark,
                   .opacity = forms[s->form].opacity,
                   .edge = forms[s->form].edge,
                   .every = 1};
    double size = forms[s->form].size;
    snprintf(l.colour, sizeof l.colour, "%s",
             l.own ? plot_colour_of(s->look) : forms[s->form].colour);
    if (forms[s->form].dash == OF_LOOK && !is_alone(p, s))
        l.dash = plot_look_dash(s->look);
    else if (forms[s->form].dash == AS_ASKED)
        l.dash = dashes[s->dash % DASHES];
    if (l.mark == OWN)
        l.mark = plot_look_mark(s->look);
    l.size = PLOT_USUAL_SIZE;
    if (s->form == PLOT_DOTS || s->form == PLOT_RINGS)
        l.size = dot_size(s->count) * s->size;
    else if (size > 0)
        l.size = size * s->size;
    if (s->form == PLOT_MARKED)
        l.every = s->count / MARKS + 1 + s->look;
    l.many = s->form == PLOT_DOTS || s->form == PLOT_RINGS ||
             s->form == PLOT_POINTS || s->form == PLOT_MEASURED;
    return l;
}

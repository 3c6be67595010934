/* nevh: plots: where panels and legends are.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <string.h>

static const double title_letter = 0.63 * PLOT_FONT; /* pixels, at scale 1 */
static const double narrow_width = 360;
enum { TITLE_LINES = 2, NOTE_LINES = 3, NARROW_LINES = PLOT_MOST_LINES / 2 };

/* Letters of XML: no surrogates, U+FFFE, U+FFFF, and none longer than need be. */
static bool is_letter(unsigned long code, size_t more) {
    static const unsigned long least[] = {0, 0x80, 0x800, 0x10000};
    return code >= least[more] && code <= 0x10ffff &&
           !(code >= 0xd800 && code < 0xe000) && code != 0xfffe &&
           code != 0xffff;
}

size_t plot_letter_bytes(const unsigned char *c) {
    size_t more = *c >= 0xf0 && *c < 0xf5   ? 3
                  : *c >= 0xe0 && *c < 0xf0 ? 2
                  : *c >= 0xc2 && *c < 0xe0 ? 1
                                            : 0;
    unsigned long code = more ? *c & (0x3fu >> more) : *c;
    if (*c >= 0x80 && more == 0)
        return 0;
    for (size_t i = 1; i <= more; i++) {
        if ((c[i] & 0xc0) != 0x80)
            return 0;
        code = code << 6 | (c[i] & 0x3fu);
    }
    return is_letter(code, more) ? more + 1 : 0;
}

size_t plot_letters(const char *text) {
    size_t count = 0;
    for (const char *c = text; *c; count++) {
        size_t bytes = plot_letter_bytes((const unsigned char *)c);
        c += bytes ? bytes : 1;
    }
    return count;
}

static size_t line_bytes(const char *text, size_t letters) {
    size_t at = 0, space = 0;
    for (size_t count = 0; text[at] && count < letters; count++) {
        size_t bytes = plot_letter_bytes((const unsigned char *)text + at);
        space = text[at] == ' ' ? at : space;
        at += bytes ? bytes : 1;
    }
    return !text[at] || space == 0 ? at : space;
}

static bool is_namesake(const plot *p, size_t i) {
    for (size_t k = 0; k < i; k++)
        if (p->series[k].name && p->series[i].name &&
            strcmp(p->series[k].name, p->series[i].name) == 0)
            return true;
    return false;
}

bool plot_in_legend(const plot *p, size_t i) {
    return p->series[i].name && p->series[i].form != PLOT_GUIDE &&
           !is_namesake(p, i);
}

static size_t legend_lines(const plot *p, size_t *longest) {
    size_t lines = 0;
    *longest = 0;
    for (size_t i = 0; i < p->count; i++)
        if (plot_in_legend(p, i)) {
            size_t length = plot_letters(p->series[i].name);
            *longest = length > *longest ? length : *longest;
            lines++;
        }
    if (*longest > PLOT_LONGEST_NAME)
        *longest = PLOT_LONGEST_NAME;
    return lines;
}

static bool has_headings(const plot *p) {
    for (size_t i = 0; i < p->panels; i++)
        if (p->panel[i].heading)
            return true;
    return false;
}

/* As the picture is. */
static void shape_panel(layout *l, const plot *p, double width) {
    range x = plot_range_x(p, 0), y = plot_range_y(p, 0);
    double height = width * (y.high - y.low) / (x.high - x.low);
    l->panel_width = width;
    l->panel_height = fmin(fmax(height, 0.4 * width), width);
}

static void choose_panels(layout *l, const plot *p, const target *t) {
    static const struct {
        size_t columns;
        double width, height;
    } few[] = {{1, 640, 420}, {2, 330, 280}, {3, 220, 220}, {2, 330, 240}},
      many = {3, 220, 190};
    size_t last = sizeof few / sizeof *few;
    if (p->stacked) {
        l->columns = 1;
        l->panel_width = 640;
        l->panel_height = fmax(fmin(720 / (double)p->panels, 340), 110);
    } else {
        l->columns =
            p->panels > last ? many.columns : few[p->panels - 1].columns;
        l->panel_width =
            p->panels > last ? many.width : few[p->panels - 1].width;
        l->panel_height =
            p->panels > last ? many.height : few[p->panels - 1].height;
    }
    if (p->beside && !p->stacked) {
        l->columns = p->beside < p->panels ? p->beside : p->panels;
        l->panel_width = fmax(fmin(720 / (double)l->columns, 340), 200);
        l->panel_height = 0.8 * l->panel_width;
        if (p->panel->equal)
            shape_panel(l, p, l->panel_width);
    }
    if (t->narrow) {
        double height = l->panel_height / l->panel_width;
        l->columns = 1;
        l->panel_width = narrow_width - l->left - l->right;
        l->panel_height = p->stacked
                              ? fmin(l->panel_height, 200)
                              : fmin(fmax(height, 0.75), 1) * l->panel_width;
    }
    if (p->panels == 1 && p->panel->equal)
        shape_panel(l, p, t->narrow ? l->panel_width : 560);
    if (t->medium == PLOT_TEXT) {
        double beside = l->left + l->right + l->legend;
        l->columns = 1;
        l->panel_width = fmax((double)t->columns - beside, 20);
        l->panel_height = fmin(fmax(floor(l->panel_width / 3), 10),
                               fmax((double)t->lines - 7, 10));
    }
    l->rows = (p->panels + l->columns - 1) / l->columns;
}

axes plot_axes(const plot *p, size_t number, const layout *l, bool text) {
    const panel *on = &p->panel[number];
    range x = plot_range_x(p, number), y = plot_range_y(p, number);
    double letter = text ? 2 : 1; /* is as high as so many are wide */
    double lines = on->log_y ? 1.3 : 2;
    if (on->equal)
        plot_range_equal(&x, &y, l->panel_width, l->panel_height * letter);
    return (axes){
        plot_axis_across(x, on->log_x, l->panel_width / l->letter, text),
        plot_axis(y, on->log_y, l->panel_height / (lines * l->line), text)};
}

/* The numbers at the widest axis, and its label. */
static double room_beside(const plot *p, const layout *l, const target *t) {
    bool text = t->medium == PLOT_TEXT;
    size_t longest = 0;
    for (size_t i = 0; i < p->panels; i++) {
        axes a = plot_axes(p, i, l, text);
        size_t letters = plot_axis_letters(&a.y);
        longest = letters > longest ? letters : longest;
    }
    return text        ? (double)longest + 4
           : t->narrow ? 8.5 * (double)longest + 20
                       : 9 * (double)longest + 52;
}

/* As it is cut into lines of so many letters. */
static size_t lines_of(const char *text, size_t letters, size_t most) {
    size_t lines = 0;
    for (; text && *text && lines < most; lines++) {
        text += line_bytes(text, letters);
        text += *text == ' ';
    }
    return lines;
}

/* As large as it fits, but not too small. */
static double title_scale(const plot *p, const layout *l) {
    static const double smallest = 0.8, largest = 1.2;
    double letters = p->title ? (double)plot_letters(p->title) : 0;
    double fitting = l->width / (title_letter * fmax(letters, 1));
    return fmin(fmax(fitting, smallest), largest);
}

static size_t title_letters(const layout *l) {
    double letter = l->letter == 1 ? 1 : title_letter * l->title_scale;
    return (size_t)fmax(l->width / letter, 20);
}

static size_t note_letters(const layout *l) {
    double letter = l->letter == 1 ? 1 : 0.6 * l->small;
    return (size_t)fmax(l->width / letter - 2, 20);
}

static double room_above(const plot *p, const layout *l) {
    double title = p->title && *p->title ? 1 : -0.5;
    double lines = (l->letter == 1 ? 1 : 1.2) * (double)l->title_lines;
    return (title + lines - (lines > 0 && l->letter > 1 ? 0.2 : 0) +
            (l->letter == 1 ? 1 : 0.95) * (double)l->note_lines) *
           l->line;
}

/* The margins of a panel before the numbers at its axes are known. */
static void set_margins(layout *l, const plot *p, const target *t) {
    bool text = t->medium == PLOT_TEXT;
    l->left = (text ? 9 : 12) * l->letter;
    l->right = 3 * l->letter;
    l->top = (text || has_headings(p) ? 1.8 : 0.7) * l->line;
    l->top += l->narrow ? 1.3 * l->line : 0;
    l->bottom = (text ? 3 : 3.7) * l->line;
    if (p->stacked && !text)
        l->bottom = 1.2 * l->line; /* numbers are below the last one */
}

static void set_panels(layout *l, const plot *p, const target *t) {
    choose_panels(l, p, t);
    l->left = room_beside(p, l, t);
    if (t->medium == PLOT_TEXT || t->narrow)
        choose_panels(l, p, t);
    if (t->narrow) { /* other numbers at other sizes */
        l->left = fmax(l->left, room_beside(p, l, t));
        choose_panels(l, p, t);
    }
}

/* Large enough to be read where a picture is 480 pixels wide, but smaller than the
   title. */
static double small_letters(const layout *l) {
    static const double smallest = 11, readable = 7. / 480, less = 0.9;
    double most = PLOT_FONT * fmin(less * l->title_scale, 1);
    return fmax(fmin(readable * l->width, most), smallest);
}

static void set_title(layout *l, const plot *p, bool narrow) {
    l->title_scale = title_scale(p, l);
    l->small = small_letters(l);
    l->title_lines = lines_of(p->title, title_letters(l),
                              narrow ? NARROW_LINES : TITLE_LINES);
    l->note_lines =
        lines_of(p->note, note_letters(l), narrow ? NARROW_LINES : NOTE_LINES);
    l->title = room_above(p, l);
}

/* legend: the height of all its lines. */
static void set_height(layout *l, const plot *p, bool text, double legend) {
    l->height = (l->top + l->panel_height + l->bottom) * (double)l->rows;
    l->height += l->title + (p->stacked && !text ? 2.5 * l->line : 0);
    if (l->narrow)
        l->height += l->legend_height;
    else
        l->height = fmax(l->height, l->title + l->top + legend);
    l->legend_apart = l->narrow || legend > l->panel_height;
}

layout plot_lay_out(const plot *p, const target *t) {
    bool text = t->medium == PLOT_TEXT;
    size_t longest, lines = legend_lines(p, &longest);
    layout l = {.letter = text ? 1 : 8, .line = text ? 1 : 18};
    double entry = text ? 1 : 26; /* of the legend */
    double legend = entry * (double)(lines + 1);
    l.narrow = t->narrow && !p->map.columns;
    if (p->map.columns)
        l.legend = 17 * l.letter; /* the scale of colours */
    else if (lines && !l.narrow)
        l.legend = l.letter * (double)(longest + 8);
    l.legend_height = l.narrow && lines ? legend : 0;
    set_margins(&l, p, t);
    set_panels(&l, p, t);
    l.width = (l.left + l.panel_width + l.right) * (double)l.columns + l.legend;
    set_title(&l, p, t->narrow);
    set_height(&l, p, text, legend);
    l.width = ceil(l.width); /* gnuplot takes whole pixels */
    l.height = ceil(l.height);
    return l;
}

pair plot_panel_at(size_t number, const layout *l) {
    double column = (double)(number % l->columns);
    double row = (double)(number / l->columns);
    return (pair){l->left + column * (l->left + l->panel_width + l->right),
                  l->title + l->top +
                      row * (l->top + l->panel_height + l->bottom)};
}

pair plot_legend_at(const layout *l) {
    return l->narrow ? (pair){l->letter, l->height - l->legend_height}
                     : (pair){l->width - l->legend, l->title + l->top};
}

plot_screen plot_screen_of(const plot *p, size_t number, const layout *l) {
    axes a = plot_axes(p, number, l, false);
    return (plot_screen){a.x.shown,      a.y.shown,       a.x.log, a.y.log,
                         l->panel_width, l->panel_height, 0};
}

/* The fewest letters a line that take no more lines: no line is of one word. */
static size_t balanced(const char *text, size_t letters, size_t lines) {
    while (letters > 1 && lines > 1 &&
           lines_of(text, letters - 1, lines + 1) <= lines)
        letters--;
    return letters;
}

static text_line *add_lines(text_line *to, const char *text, size_t letters,
                            size_t lines, double first, double apart,
                            double size) {
    letters = balanced(text, letters, lines);
    for (size_t i = 0; i < lines; i++) {
        size_t bytes = line_bytes(text, letters);
        *to++ = (text_line){text,
                            bytes,
                            i + 1 == lines && text[bytes],
                            false,
                            first + apart * (double)i,
                            size};
        text += bytes;
        text += *text == ' ';
    }
    return to;
}

size_t plot_title_lines(const plot *p, const layout *l,
                        text_line lines[PLOT_MOST_LINES]) {
    bool text = l->letter == 1;
    double apart = (text ? 1 : 1.2) * l->line;
    double begin = p->title && *p->title
                       ? 0.9 * l->line + apart * (double)l->title_lines
                       : 0;
    text_line *end =
        add_lines(lines, p->title, title_letters(l), l->title_lines,
                  1.1 * l->line, apart, PLOT_FONT * l->title_scale);
    text_line *note = end;
    end = add_lines(end, p->note, note_letters(l), l->note_lines, begin,
                    (text ? 1 : 0.95) * l->line, l->small);
    for (; note < end; note++)
        note->note = true;
    return (size_t)(end - lines);
}

/* A third of so many letters is the name's at least; the unit, which begins with a
   factor, has the others. */
static char *shorter_label(const char *label, size_t letters) {
    const char *unit = strrchr(label, '(');
    size_t name = unit ? plot_letters(label) - plot_letters(unit) : 0;
    size_t least = letters / 3, unit_and_dots = plot_letters(label) - name + 4;
    size_t kept =
        letters > unit_and_dots + least ? letters - unit_and_dots : least;
    size_t bytes = 0;
    if (!unit || plot_letters(label) <= letters || name <= kept)
        return text_print("%s", label);
    while (kept--)
        bytes += plot_letter_bytes((const unsigned char *)label + bytes);
    return text_print("%.*s... %s", (int)bytes, label, unit);
}

char *plot_fit_label(const char *label, double room, double *size) {
    static const double letter = 0.57, smallest = 0.75;
    double letters = fmax(label ? (double)plot_letters(label) : 0, 1);
    double scale =
        fmin(fmax(room / (letter * PLOT_FONT * letters), smallest), 1);
    double most = fmax(room / (letter * PLOT_FONT * scale), 8);
    char *whole = shorter_label(label ? label : "", (size_t)most);
    char *text = plot_shortened(whole, (size_t)most);
    *size = scale * PLOT_FONT;
    return text;
}

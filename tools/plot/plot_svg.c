/* nevh: plots as SVG: panels, axes, texts and the legend.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <string.h>

static const double middle_line = 0.325; /* of a letter: from its base */
static const double base = 4.55;         /* the same, of usual letters */

/* Replaces by a question mark all that is not valid UTF-8, or not allowed in XML. */
static void put_letters(FILE *f, const char *text, size_t bytes) {
    for (const char *end = text + bytes; text < end;) {
        size_t length = plot_letter_bytes((const unsigned char *)text);
        char letter[8] = "?";
        if (length)
            memcpy(letter, text, length);
        html_text(f, letter);
        text += length ? length : 1;
    }
}

/* Raises the power of "10^{-3}". */
static void put_number(FILE *f, const char *text) {
    const char *power = strstr(text, "^{");
    if (!power) {
        put_letters(f, text, strlen(text));
        return;
    }
    put_letters(f, text, (size_t)(power - text));
    fprintf(f, "<tspan dy='-.5em' font-size='.8em'>%.*s</tspan>",
            (int)strcspn(power + 2, "}"), power + 2);
}

typedef enum { START, MIDDLE, END } anchor;

static void begin_text(FILE *f, double x, double y, anchor a, double size,
                       const char *colour) {
    static const char *const anchors[] = {"", " text-anchor='middle'",
                                          " text-anchor='end'"};
    fprintf(f, "<text x='%.5g' y='%.5g'%s", x, y, anchors[a]);
    if (size != PLOT_FONT)
        fprintf(f, " font-size='%.3g'", size);
    if (colour)
        fprintf(f, " fill='%s'", colour);
    fputc('>', f);
}

static void put_text(FILE *f, double x, double y, anchor a, double size,
                     const char *colour, const char *text) {
    begin_text(f, x, y, a, size, colour);
    put_letters(f, text, strlen(text));
    fputs("</text>\n", f);
}

static void put_label(FILE *f, double x, double y, anchor a, double room,
                      const char *label) {
    double size;
    char *text = plot_fit_label(label, room, &size);
    if (*text)
        put_text(f, x, y, a, size, NULL, text);
}

/* On its side, from below. */
static void put_standing(FILE *f, double x, double y, double room,
                         const char *label) {
    if (!label || !*label)
        return;
    fprintf(f, "<g transform='translate(%.1f %.1f)rotate(-90)'>\n", x, y);
    put_label(f, 0, 0, MIDDLE, room, label);
    fputs("</g>\n", f);
}

static void put_titles(FILE *f, const plot *p, const layout *l) {
    text_line lines[PLOT_MOST_LINES];
    size_t count = plot_title_lines(p, l, lines);
    for (size_t i = 0; i < count; i++) {
        const text_line *line = &lines[i];
        begin_text(f, l->width / 2, line->middle + middle_line * line->size,
                   MIDDLE, line->size, line->note ? "#444444" : NULL);
        put_letters(f, line->text, line->bytes);
        fputs(line->cut ? " ...</text>\n" : "</text>\n", f);
    }
}

static double share_of(const axis *a, double at) {
    range r = a->shown;
    return a->log ? log(at / r.low) / log(r.high / r.low)
                  : (at - r.low) / (r.high - r.low);
}

/* The geometry of an axis: its start, its direction, and the side of its ticks. */
typedef struct {
    pair from, along; /* pixels */
    pair out;         /* direction of the ticks */
    pair number;      /* from the axis on */
    anchor anchor;
} place;

static pair tick_at(const axis *a, const place *on, size_t i) {
    double share = share_of(a, a->tick[i].at);
    return (pair){on->from.x + share * on->along.x,
                  on->from.y + share * on->along.y};
}

static void put_axis(FILE *f, const axis *a, const place *on, bool numbers) {
    enum { TICK = 10 };
    fprintf(f, "<path fill='none' stroke='#555555' d='M%.1f %.1fl%g %g",
            on->from.x, on->from.y, on->along.x, on->along.y);
    for (size_t i = 0; i < a->count; i++) {
        pair at = tick_at(a, on, i);
        int length = a->tick[i].minor ? TICK / 2 : TICK;
        fprintf(f, "M%.1f %.1fl%g %g", at.x, at.y, length * on->out.x,
                length * on->out.y);
    }
    fputs("'/>\n", f);
    for (size_t i = 0; i < a->count && numbers; i++) {
        pair at = tick_at(a, on, i);
        if (a->tick[i].minor)
            continue;
        begin_text(f, at.x + on->number.x, at.y + on->number.y, on->anchor,
                   PLOT_FONT, NULL);
        put_number(f, a->tick[i].text);
        fputs("</text>\n", f);
    }
}

static void put_grid(FILE *f, const axis *a, const place *on, double right,
                     double down) {
    for (size_t i = 0; i < a->count; i++) {
        pair at = tick_at(a, on, i);
        if (!a->tick[i].minor)
            fprintf(f, "M%.1f %.1fl%g %g", at.x, at.y, right, down);
    }
}

static const double edge = 15; /* of a column of panels, to its labels */

/* The middle of a label beside numbers of that axis. */
static double beside(const axis *a) {
    return 9 * (double)plot_axis_letters(a) + 37;
}

static void put_labels(FILE *f, const panel *on, const axes *a, pair at,
                       bool x_too, const layout *l) {
    double width = l->panel_width + 2 * l->right;
    double middle = at.x + l->panel_width / 2;
    char *x = x_too ? plot_axis_label(&a->x, on->x, false) : NULL;
    char *y = plot_axis_label(&a->y, on->y, false);
    put_label(f, middle, at.y + l->panel_height + 57, MIDDLE, width, x);
    if (l->narrow)
        put_label(f, l->letter, at.y - 17, START, l->width - 2 * l->letter, y);
    else
        put_standing(f, at.x - l->left + edge, at.y + l->panel_height / 2,
                     l->panel_height + l->top + 0.8 * l->bottom, y);
    put_label(f, middle, at.y - (l->narrow ? 35 : 16.5), MIDDLE, width,
              on->heading);
}

static void put_guides(FILE *f, const plot *p, size_t number, pair at,
                       const layout *l) {
    guide_name *names = tool_allocate(p->count + 1, sizeof *names);
    size_t count = plot_guide_names(p, number, l, names);
    for (size_t i = 0; i < count; i++) {
        char *text = plot_shortened(names[i].text, PLOT_LONGEST_NAME);
        fputs("<g paint-order='stroke' stroke='#ffffff' stroke-width='3'>", f);
        put_text(f, at.x + names[i].left,
                 at.y + l->panel_height - names[i].middle +
                     middle_line * names[i].letter,
                 START, names[i].letter, "#777777", text);
        fputs("</g>\n", f);
        if (names[i].far)
            fprintf(f,
                    "<path stroke='#999999' stroke-width='.8' d='M%.1f "
                    "%.1fL%.1f %.1f'/>\n",
                    at.x + names[i].from.x,
                    at.y + l->panel_height - names[i].from.y,
                    at.x + names[i].to.x,
                    at.y + l->panel_height - names[i].to.y);
    }
    tool_release(names);
}

/* Each with its name, which a browser shows where the pointer is. */
static void put_curves(FILE *f, const plot *p, size_t number,
                       const plot_screen *on, pair at) {
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        if (s->panel != number || !s->count)
            continue;
        fputs("<g>", f);
        if (s->name) {
            fputs("<title>", f);
            put_letters(f, s->name, strlen(s->name));
            fputs("</title>", f);
        }
        fputc('\n', f);
        plot_svg_series(f, p, s, on, at);
        fputs("</g>\n", f);
    }
}

static void put_panel(FILE *f, const plot *p, size_t number, const layout *l,
                      double detail) {
    axes a = plot_axes(p, number, l, false);
    pair at = plot_panel_at(number, l);
    plot_screen on = plot_screen_of(p, number, l);
    double width = l->panel_width, height = l->panel_height;
    pair corner = {at.x, at.y + height};
    place x = {corner, {width, 0}, {0, 1}, {0, 36}, MIDDLE};
    place y = {corner, {0, -height}, {-1, 0}, {-20, base}, END};
    bool last = number + 1 == p->panels;
    on.detail = detail;
    fputs("<path stroke='#dddddd' stroke-width='.5' d='", f);
    put_grid(f, &a.x, &x, 0, -height);
    put_grid(f, &a.y, &y, width, 0);
    fputs("'/>\n", f);
    if (number == 0 && p->map.columns)
        plot_svg_map(f, &p->map, &on, at);
    put_curves(f, p, number, &on, at);
    put_axis(f, &a.x, &x, last || !p->stacked);
    put_axis(f, &a.y, &y, true);
    put_labels(f, &p->panel[number], &a, at, last || !p->stacked, l);
    put_guides(f, p, number, at, l);
}

static void put_scale(FILE *f, const field_map *m, const layout *l) {
    pair at = plot_panel_at(0, l);
    double left = at.x + l->panel_width + 2 * l->letter;
    double right = left + 2 * l->letter, height = l->panel_height;
    axis a = plot_map_axis(m, height / (2 * l->line), false);
    char *label = plot_axis_label(&a, m->label, false);
    plot_svg_palette(f, left, at.y, height);
    put_axis(
        f, &a,
        &(place){
            {right, at.y + height}, {0, -height}, {1, 0}, {20, base}, START},
        true);
    put_standing(f, right + beside(&a), at.y + height / 2, height, label);
}

static void put_legend(FILE *f, const plot *p, const layout *l) {
    static const double apart = 25.2, half = 12.6, sample = 9.8, name = 49.6;
    pair at = plot_legend_at(l);
    double y = at.y + half;
    for (size_t i = 0; i < p->count; i++) {
        if (!plot_in_legend(p, i))
            continue;
        char *text = plot_shortened(p->series[i].name, PLOT_LONGEST_NAME);
        plot_svg_sample(f, p, &p->series[i], (pair){at.x + sample, y});
        put_text(f, at.x + name, y + base, START, PLOT_FONT, NULL, text);
        y += apart;
    }
}

static void put_picture(FILE *f, const plot *p, const layout *l,
                        double detail) {
    fprintf(f,
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %g %g' "
            "font-family='sans-serif' font-size='%d' "
            "stroke-linejoin='round'>\n"
            "<path fill='#ffffff' d='M0 0h%gv%gH0z'/>\n",
            l->width, l->height, PLOT_FONT, l->width, l->height);
    put_titles(f, p, l);
    for (size_t i = 0; i < p->panels; i++)
        put_panel(f, p, i, l, detail);
    if (p->map.columns)
        put_scale(f, &p->map, l);
    else if (l->legend + l->legend_height > 0)
        put_legend(f, p, l);
    fputs("</svg>\n", f);
}

void plot_svg(const plot *p, const target *t, FILE *to) {
    static const double finest = 0.1, coarsest = 4, coarser = 1.5;
    layout l = plot_lay_out(p, t);
    size_t most = t->most_bytes ? t->most_bytes : PLOT_MOST_BYTES;
    size_t size = most + 1;
    for (double detail = finest; size > most; detail *= coarser) {
        text_file text;
        put_picture(text_open(&text), p, &l, detail);
        char *picture = text_close(&text);
        size = text.size;
        if (size <= most || detail * coarser > coarsest) {
            fwrite(picture, 1, size, to);
            size = 0;
        }
        tool_release(picture);
    }
}

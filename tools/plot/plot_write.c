/* nevh: where plots go: --plot and --keep-plot-script.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

enum { USUAL_COLUMNS = 80, USUAL_LINES = 24 };

static bool in_terminal(const options *o) {
    return o->plot.file && strcmp(o->plot.file, "-") == 0;
}

static int find_medium(const options *o, medium *m) {
    static const struct {
        const char *ending;
        medium medium;
    } known[] = {{"svg", PLOT_SVG},
                 {"png", PLOT_PNG},
                 {"pdf", PLOT_PDF},
                 {"gif", PLOT_GIF}};
    const char *dot = o->plot.file ? strrchr(o->plot.file, '.') : NULL;
    bool moves = o->plot.kind == PLOT_KIND_animation;
    bool gif = dot && strcmp(dot, ".gif") == 0;
    *m = o->plot.file ? PLOT_TEXT : PLOT_SCREEN;
    if (moves && !gif)
        return tool_refuse("--plot-kind animation takes --plot FILE.gif");
    if (gif && !moves)
        return tool_refuse("--plot %s: a .gif is for nevh run --plot-kind "
                           "animation; FILE.svg, FILE.png and FILE.pdf are for "
                           "all",
                           o->plot.file);
    if (!o->plot.file || in_terminal(o))
        return TOOL_OK;
    for (size_t i = 0; dot && i < sizeof known / sizeof *known; i++)
        if (strcmp(dot + 1, known[i].ending) == 0) {
            *m = known[i].medium;
            return TOOL_OK;
        }
    return tool_refuse("--plot takes FILE.svg, FILE.png, FILE.pdf or -, not "
                       "\"%s\"",
                       o->plot.file);
}

static size_t columns_named(void) {
    const char *text = getenv("COLUMNS");
    long columns = text ? strtol(text, NULL, 10) : 0;
    return columns > 0 && columns < 10000 ? (size_t)columns : USUAL_COLUMNS;
}

static void measure_terminal(target *t) {
    struct winsize window = {0};
    bool is_terminal = ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0;
    bool known = is_terminal && window.ws_col > 0 && window.ws_row > 0;
    t->columns = known ? window.ws_col : columns_named();
    t->lines = known ? window.ws_row : USUAL_LINES;
    t->colours = is_terminal && !getenv("NO_COLOR");
}

static int find_target(const options *o, target *t) {
    *t = (target){0};
    if (find_medium(o, &t->medium))
        return TOOL_USAGE;
    if (t->medium == PLOT_TEXT)
        measure_terminal(t);
    t->narrow = o->plot.is_narrow;
    return t->narrow && t->medium != PLOT_SVG
               ? tool_refuse("--plot-narrow takes --plot FILE.svg")
               : TOOL_OK;
}

bool plot_wanted(const options *o) {
    return o->plot.file || o->plot.script;
}

bool plot_goes_first(const options *o) {
    return plot_wanted(o) && !in_terminal(o);
}

bool plot_replaces_rows(const options *o) {
    return plot_wanted(o) && !o->file && !o->resume &&
           !option_given(o, "format");
}

void plot_written_report(const options *o, const plan *p,
                         const char *integrator, size_t points) {
    if (o->quiet || !plot_replaces_rows(o) || !plot_goes_first(o))
        return;
    printf("%s: %s", o->plot.file ? o->plot.file : o->plot.script,
           plot_scheme(p, integrator));
    if (points)
        printf(", %zu points", points);
    puts("; -o FILE writes the rows as CSV");
}

int plot_check(const options *o) {
    target t;
    if (find_target(o, &t))
        return TOOL_USAGE;
    if (in_terminal(o) && !o->file && o->format != FORMAT_TABLE)
        return tool_refuse("--plot - would draw among the rows; give them a "
                           "file with -o");
    if ((o->plot.file && t.medium != PLOT_SVG && gnuplot_check()) ||
        (o->plot.file && !in_terminal(o) && output_check(o->plot.file)) ||
        (o->plot.script && output_check(o->plot.script)))
        return TOOL_USAGE;
    return TOOL_OK;
}

static int keep_script(const plot *p, const options *o, target t) {
    output out;
    if (output_open(&out, o->plot.script))
        return TOOL_USAGE;
    t.file = in_terminal(o) ? NULL : o->plot.file;
    plot_script(p, &t, out.stream);
    return output_close(&out, TOOL_OK);
}

static int draw_to(const plot *p, const target *t, FILE *drawing) {
    FILE *script = tmpfile();
    if (!script)
        return tool_refuse("no temporary file: %s", strerror(errno));
    int status = TOOL_OK;
    plot_script(p, t, script);
    if (fflush(script) || ferror(script))
        status = tool_refuse("the script for gnuplot cannot be written: %s",
                             strerror(errno));
    rewind(script);
    if (!status)
        status = gnuplot_draw(script, drawing, t->medium);
    fclose(script);
    return status;
}

/* Without the form feed at the beginning, and blanks at the ends of lines. */
static void show(FILE *drawing, FILE *f) {
    int blanks = 0, c;
    while ((c = getc(drawing)) != EOF) {
        if (c == ' ') {
            blanks++;
            continue;
        }
        if (c != '\n')
            fprintf(f, "%*s", blanks, "");
        blanks = 0;
        if (c != '\f')
            putc(c, f);
    }
    putc('\n', f);
}

static void copy(FILE *drawing, FILE *f) {
    for (int c; (c = getc(drawing)) != EOF;)
        putc(c, f);
}

/* Draws PNG of more than PLOT_MOST_BYTES again with fewer pixels; lines take bytes
   in proportion to the scale, or to its square where they lie close.
   t  its scale is that of the drawing */
static int draw_small(const plot *p, target *t, FILE *drawing) {
    static const double least = 0.65; /* letters of nine pixels */
    t->scale = 2;
    int status = draw_to(p, t, drawing);
    while (!status && t->medium == PLOT_PNG && t->scale > least) {
        struct stat found;
        if (fstat(fileno(drawing), &found) != 0 ||
            found.st_size <= PLOT_MOST_BYTES)
            break;
        double share = PLOT_MOST_BYTES / (double)found.st_size;
        t->scale = fmax(least, t->scale * fmin(0.9, 0.95 * sqrt(share)));
        if (ftruncate(fileno(drawing), 0) != 0)
            return tool_refuse("the temporary file cannot be emptied: %s",
                               strerror(errno));
        rewind(drawing);
        status = draw_to(p, t, drawing);
    }
    return status;
}

/* In a file between: gnuplot reports no error of writing, and it may be a device. */
static int draw_between(const plot *p, target *t, FILE *f) {
    FILE *drawing = tmpfile();
    if (!drawing)
        return tool_refuse("no temporary file: %s", strerror(errno));
    int status = draw_small(p, t, drawing);
    rewind(drawing);
    if (!status)
        (t->medium == PLOT_TEXT ? show : copy)(drawing, f);
    fclose(drawing);
    return status;
}

static int draw_in_terminal(const plot *p, target *t) {
    int status = draw_between(p, t, stdout);
    if (!status && (fflush(stdout) || ferror(stdout)))
        return tool_refuse("the plot cannot be written: %s", strerror(errno));
    return status;
}

static int draw_to_file(const plot *p, const char *file, target *t) {
    output out;
    if (output_open(&out, file))
        return TOOL_USAGE;
    int status = TOOL_OK;
    if (t->medium == PLOT_SVG)
        plot_svg(p, t, out.stream);
    else
        status = draw_between(p, t, out.stream);
    return output_close(&out, status);
}

/* Both for a page where a narrow one is wanted, which is smaller. */
static int draw(const plot *p, const options *o, target *t) {
    enum { OF_PAGE = 40000 };
    if (in_terminal(o))
        return draw_in_terminal(p, t);
    target broad = *t, narrow;
    broad.most_bytes = o->plot.narrow ? OF_PAGE : 0;
    narrow = broad;
    narrow.narrow = true;
    int status = draw_to_file(p, o->plot.file, &broad);
    t->scale = broad.scale;
    return status || !o->plot.narrow ? status
                                     : draw_to_file(p, o->plot.narrow, &narrow);
}

static bool is_empty(const plot *p) {
    for (size_t i = 0; i < p->count; i++)
        if (p->series[i].count)
            return false;
    return p->map.columns == 0;
}

int plot_write(plot *p, const options *o) {
    target t;
    if (find_target(o, &t))
        return TOOL_USAGE;
    if (is_empty(p)) {
        int refused =
            tool_refuse(p->hidden ? "there is nothing to plot: all values "
                                    "are 0, which a logarithmic axis does "
                                    "not show"
                                  : "there is nothing to plot");
        /* A report shows the table alone. */
        return p->hidden && o->as_html ? TOOL_OK : refused;
    }
    int status = o->plot.file ? draw(p, o, &t) : TOOL_OK;
    if (!status && o->plot.script)
        status = keep_script(p, o, t);
    return status;
}

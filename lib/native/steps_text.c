/* nevh: what the texts of all families of steps share: what the kernels' texts
   need, and the function that takes steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/runge_kutta_private.h"
#include "native/native_private.h"
#include "native/slope_private.h"
#include <string.h>

static bool begins(const char *line, const char *word) {
    return strncmp(line, word, strlen(word)) == 0;
}

/* True if the condition of a line "#ifdef NAME" or "#ifndef NAME" holds. */
static bool steps_text_holds(const nevh__writer *w, const char *line) {
    static const char readers[] = "NEVH__FOR_READERS";
    static const char shape[] = "NEVH__ONE_SHAPE";
    const char *name = line + strcspn(line, " ") + 1;
    bool defined = begins(name, readers) || begins(name, shape);
    for (size_t i = 0; i < w->form_count; i++)
        defined |= begins(name, w->forms[i]);
    return defined == begins(line, "#ifdef");
}

/* The conditions that are open, and the outermost of them that does not hold; 0:
   all do. */
typedef struct {
    unsigned open, skipped;
} conditions;

static bool take_condition(const nevh__writer *w, conditions *c,
                           const char *line) {
    if (begins(line, "#if")) {
        c->open++;
        if (!c->skipped && !steps_text_holds(w, line))
            c->skipped = c->open;
    } else if (begins(line, "#else")) {
        c->skipped = c->skipped == c->open ? 0
                     : c->skipped          ? c->skipped
                                           : c->open;
    } else if (begins(line, "#endif")) {
        c->skipped = c->skipped == c->open ? 0 : c->skipped;
        c->open--;
    } else
        return false;
    return true;
}

/* A line without NEVH__COMPILED(...), which ends in it, and the blank beside that;
   nothing where no more is left. */
static void write_line(nevh__writer *w, const char *line) {
    static const char word[] = "NEVH__COMPILED(";
    size_t begin = w->used;
    const char *at = strstr(line, word);
    bool had = at;
    for (; at; at = strstr(line, word)) {
        int open = 1;
        nevh__write(w, "%.*s", (int)(at - line), line);
        for (line = at + sizeof word - 1; *line && open > 0; line++)
            open += (*line == '(') - (*line == ')');
        if (*line == ' ')
            line++;
        else if (w->used > begin && w->text[w->used - 1] == ' ')
            w->text[--w->used] = '\0';
    }
    nevh__write(w, "%s", line);
    if (had && strspn(w->text + begin, " \n") == w->used - begin)
        w->used = begin;
}

/* Conditions are resolved, hints to compilers left out. */
static void write_for_readers(nevh__writer *w, const char *const lines[]) {
    conditions c = {0, 0};
    for (; *lines && !w->failed; lines++) {
        const char *text = *lines + strspn(*lines, " ");
        if (!take_condition(w, &c, text) && !c.skipped &&
            strcmp(text, "NEVH_UNROLL\n") != 0 &&
            strcmp(text, "NEVH__KNOWN_COUNT\n") != 0 &&
            strcmp(text, "NEVH__UNROLLED\n") != 0)
            write_line(w, *lines);
    }
}

void nevh__write_lines(nevh__writer *w, const char *const lines[]) {
    if (w->readable) {
        write_for_readers(w, lines);
        return;
    }
    for (; *lines; lines++)
        nevh__write(w, "%s", *lines);
}

void nevh__write_entry(nevh__writer *w) {
    if (!w->readable)
        nevh__write_lines(w, nevh__entry_text);
}

size_t nevh__orbits_together(const nevh__writer *w) {
    bool any = nevh__has_lanes(w) && !w->loops && !(w->stages && w->by_lane);
    return any ? nevh__lanes_together() : NEVH__LANES;
}

const char *nevh__number_type(const nevh__writer *w) {
    return nevh__has_lanes(w) ? "wide" : "double";
}

/* Sums go number by number: rows are short, and lanes are vectors already. */
static void write_compiled_needs(nevh__writer *w, size_t lanes, size_t group) {
    const struct {
        bool holds;
        const char *name;
    } forms[] = {{w->loops, "NEVH__LOOPS"},
                 {lanes > 1, "NEVH__SIDE_BY_SIDE"},
                 {lanes > 1 && !w->stages, "NEVH__WIDE"},
                 {w->stages, "NEVH__STAGES"},
                 {group > 1, "NEVH__GROUPS"}};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
        if (forms[i].holds)
            nevh__write_form(w, forms[i].name);
    nevh__write_lines(w, nevh__compiled_needs_text);
    nevh__write_lines(w, nevh__steps_call_text);
}

static void write_program_needs(nevh__writer *w, size_t n, bool finite,
                                bool sums) {
    nevh__write(w, "enum { DOF = %zu };\n", n);
    if (w->loops)
        nevh__write_form(w, "NEVH__LOOPS");
    if (finite)
        nevh__write_form(w, "NEVH__FINITE");
    if (sums || w->stages)
        nevh__write_form(w, "NEVH__SUMS");
    if (w->stages)
        nevh__write_form(w, "NEVH__STAGES");
    nevh__write_lines(w, nevh__program_needs_text);
    nevh__write(w, "\n");
}

void nevh__write_needs(nevh__writer *w, size_t n, bool finite, bool sums) {
    size_t lanes = w->width == 1 && !w->loops ? 1
                   : w->stages                ? NEVH__LANES
                                              : nevh__orbits_together(w);
    size_t group = w->group && !w->loops ? w->group : 1;
    if (w->readable) {
        write_program_needs(w, n, finite, sums);
        return;
    }
    write_compiled_needs(w, lanes, group);
    if (w->loops)
        nevh__write(w, "enum { DOF = %zu, ONE = DOF, COUNT = %zu };\n",
                    nevh__padded(n) / NEVH__LANES, n);
    else
        nevh__write(w,
                    "enum { ONE = %zu, GROUP = %zu, DOF = ONE * GROUP };\n"
                    "enum { WIDTH = %zu, LANES = %zu, BLOCKS = WIDTH / LANES / "
                    "GROUP };\n",
                    n, group, w->width, lanes);
}

void nevh__write_table(nevh__writer *w) {
    if (w->readable)
        return;
    if (w->by_lane)
        nevh__write(w, "#define TABLE(b) (N + (b) * (size_t)%zu)\n", w->count);
    else
        nevh__write(w, "#define TABLE(b) N\n");
}

static void write_long_driver(nevh__writer *w, size_t rows) {
    if (w->takes_steps)
        nevh__write_form(w, "NEVH__TAKES_STEPS");
    nevh__write(w, "enum { ROWS_BEFORE = %zu };\n", rows);
    w->rows = rows + 6; /* the state, what it lost, up to two slopes kept */
    nevh__write_lines(w, nevh__long_driver_text);
}

void nevh__write_driver(nevh__writer *w, bool keeps, size_t rows) {
    if (w->readable && keeps)
        nevh__write_form(w, "NEVH__KEEPS");
    if (w->loops && !w->readable)
        write_long_driver(w, rows);
    else {
        if (w->watched)
            nevh__write_watch(w);
        nevh__write_table(w);
        nevh__write_lines(w, nevh__block_driver_text);
    }
}

void nevh__write_sum(nevh__writer *w, nevh__sums_text *sums,
                     const double weights[], size_t count, const char *apart) {
    size_t some = 0, row = sums->rows++;
    for (size_t j = 0; j < count; j++)
        some += weights[j] != 0;
    sums->count[row] = some;
    if (!some)
        return;
    nevh__write(w, "static double weights_%zu[] = {", row);
    for (size_t j = 0; j < count; j++) {
        char number[NEVH__NAME];
        nevh__number_text(weights[j], number);
        if (weights[j] != 0)
            nevh__write(w, "%s, ", number);
    }
    nevh__write(w, "};\nstatic size_t offsets_%zu[] = {", row);
    for (size_t j = 0; j < count; j++)
        if (weights[j] != 0)
            nevh__write(w, "%zu * %s, ", j, apart);
    nevh__write(w, "};\n");
}

void nevh__write_sums(nevh__writer *w, const nevh__sums_text *sums) {
    nevh__write(w, "static const nevh__sum sums[] = {\n");
    for (size_t i = 0; i < sums->rows; i++)
        if (sums->count[i])
            nevh__write(w, "    {NULL, %zu, weights_%zu, offsets_%zu},\n",
                        sums->count[i], i, i);
        else
            nevh__write(w, "    {NULL, 0, NULL, NULL},\n");
    nevh__write(w, "};\n");
}

static void write_unkept(nevh__writer *w) {
    if (!w->readable)
        nevh__write(w, "enum { KEPT = 0 };\n"
                       "#define take_first(c, N, y, lost, kept, room) "
                       "((nevh__number){0})\n");
}

/* The stages of compiled steps are written one by one. */
static void write_stages(nevh__writer *w, size_t first, size_t stages) {
    nevh__write(w, "enum { STAGES = %zu };\n", stages);
    if (w->readable)
        return;
    nevh__write(w, "#define NEVH__EACH_STAGE(take)");
    for (size_t i = first; i < stages; i++)
        nevh__write(w, " take(%zu)", i);
    nevh__write(w, "\n");
}

void nevh__write_stage_driver(nevh__writer *w, const nevh_work *work,
                              const char *const header[], size_t stages) {
    bool adapts = nevh__adapts(work);
    if (adapts)
        nevh__write_form(w, "NEVH__ADAPTS");
    write_stages(w, adapts, stages);
    nevh__write_lines(w, header);
    if (adapts) {
        nevh__write_adaptive(w, work, nevh__adaptive_rule_of(work));
        return;
    }
    write_unkept(w);
    nevh__write_driver(w, false, 4 + 2 * stages);
}

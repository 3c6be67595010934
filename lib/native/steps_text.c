/* nevh: what the texts of all families of steps share: what the kernels' texts
   need, and the function that takes steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/native_private.h"
#include "native/slope_private.h"
#include <string.h>

/* Sums go number by number: rows are short, and lanes are vectors already. */
static const char needs[] =
    "typedef size size_t;\n"
    "#define bool _Bool\n"
    "#define true 1\n"
    "#define false 0\n"
    "#define NULL ((void *)0)\n"
    "#define INFINITY __builtin_inf()\n"
    "#define NEVH__INLINE INLINE\n"
    "#define NEVH__COMPILED(...) __VA_ARGS__\n"
    "#define NEVH__KNOWN_COUNT NEVH_UNROLL\n"
    "#define NEVH__EACH(i, lanes, size) \\\n"
    "    NEVH_UNROLL for (size_t i = 0; i < (size); i += (lanes))\n";
static const char one_in_a_vector[] = "#define NEVH__VECTOR_AT(x) (*(x))\n"
                                      "enum { NEVH__IN_VECTOR = 1 };\n";

static const char needs_of_numbers[] = "typedef double nevh__number;\n";
static const char roundoff_of_lanes[] =
    "INLINE double nevh__roundoff(double sum, double a, double b) {\n"
    "    double part = sum - a;\n"
    "    return (a - (sum - part)) + (b - part);\n}\n";

/* Of the larger one of a and b what is lost follows in two operations instead
   of six, which all wait for one another; it is exact in both ways. */
static const char roundoff_of_one[] =
    "static __attribute__((noinline, cold)) double rare_roundoff(double sum, "
    "double a, double b) { return a - (sum - b); }\n"
    "INLINE double nevh__roundoff(double sum, double a, double b) {\n"
    "    if (__builtin_expect(!(fabs(a) >= fabs(b)), 0))\n"
    "        return rare_roundoff(sum, a, b);\n"
    "    return b - (sum - a);\n}\n";
static const char needs_of_one[] =
    "typedef double nevh__vector;\n"
    "INLINE bool nevh__not_finite(size_t lanes, size_t size, const double *x, "
    "const double *y) {\n"
    "    double bad = 0;\n"
    "    NEVH__EACH(i, lanes, size) bad += (x[i] - x[i]) + (y[i] - y[i]);\n"
    "    return bad != 0;\n}\n"
    "INLINE bool is_bad(double bad) { return bad != 0; }\n";

static const char is_bad[] =
    "INLINE bool is_bad(wide bad) {\n"
    "    return ((bad[0] + bad[1]) + (bad[2] + bad[3])) + ((bad[4] + bad[5]) + "
    "(bad[6] + bad[7])) != 0;\n}\n";

/* Numbers, and vectors of what stands side by side. */
static const char needs_of_stages[] =
    "typedef wide nevh__vector;\n"
    "#define NEVH__ONE_SHAPE\n"
    "#define NEVH__VECTOR_AT(x) (*(nevh__vector *)(x))\n"
    "enum { NEVH__IN_VECTOR = 8, NEVH__LANES = 8 };\n"
    "#define NEVH_LANES(i, width) \\\n"
    "    for (size_t i##_from = 0; i##_from < (width); i##_from += 8) \\\n"
    "    _Pragma(\"GCC ivdep\") for (size_t i = i##_from; i != i##_from + 8; "
    "i++)\n"
    "extern double fma(double, double, double) CONST;\n"
    "INLINE double nevh__sum_lanes(const double *x) {\n"
    "    return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + "
    "x[7]));\n}\n";

/* What is not finite is found once for all blocks. */
static const char needs_of_lanes[] =
    "typedef wide nevh__number, nevh__vector;\n"
    "INLINE wide nevh__roundoff(wide sum, wide a, wide b) {\n"
    "    wide part = sum - a;\n"
    "    return (a - (sum - part)) + (b - part);\n}\n"
    "INLINE bool nevh__not_finite(size_t lanes, size_t size, const wide *x, "
    "const wide *y) { return false; }\n";

static const char needs_of_readers[] =
    "/* Element by element. */\n"
    "#define NEVH__EACH(i, lanes, size) \\\n"
    "    for (size_t i = 0; i < (size); i += (lanes))\n\n"
    "/* What rounding has lost of a + b. */\n"
    "static double nevh__roundoff(double sum, double a, double b) {\n"
    "    double part = sum - a;\n"
    "    return (a - (sum - part)) + (b - part);\n}\n\n";
static const char not_finite_for_readers[] =
    "static bool nevh__not_finite(size_t lanes, size_t size, const double *x,\n"
    "                             const double *y) {\n"
    "    double bad = 0;\n"
    "    NEVH__EACH(i, lanes, size)\n"
    "        bad += (x[i] - x[i]) + (y[i] - y[i]);\n"
    "    return bad != 0;\n}\n\n";
static const char stages_for_readers[] =
    "enum { NEVH__LANES = 1 };\n"
    "#define NEVH_LANES(i, width) for (size_t i = 0; i < (width); i++)\n\n"
    "static double nevh__sum_lanes(const double *x) {\n    return x[0];\n}\n\n"
    "static bool is_bad(double bad) {\n    return bad != 0;\n}\n\n";
static const char vectors_for_readers[] = "#define NEVH__VECTOR_AT(x) (*(x))\n"
                                          "enum { NEVH__IN_VECTOR = 1 };\n"
                                          "typedef double nevh__vector;\n\n";

/* Steps are taken of copies, which are stored if all of them went well. */
static const char driver[] =
    "size_t nevh_native_steps(const double *restrict N, double *restrict W,\n"
    "        double *restrict T, size_t operations, double t0, double h,\n"
    "        size_t from, size_t steps, double *restrict Q,\n"
    "        double *restrict P, double *restrict M, size_t *counted,\n"
    "        double *room) {\n"
    "    nevh__number y[BLOCKS][2 * DOF], lost[BLOCKS][2 * DOF];\n"
    "    nevh__number kept[BLOCKS][KEPT + 1];\n"
    "    double *flags = M + (2 * DOF + KEPT) / GROUP * WIDTH;\n"
    "    bool has_kept = true;\n"
    "    size_t done = 0;\n"
    "    for (int b = 0; b < BLOCKS; b++) {\n"
    "        NEVH__EACH(k, 1, DOF) y[b][k] = AT(Q, k, b);\n"
    "        NEVH__EACH(k, 1, DOF) y[b][DOF + k] = AT(P, k, b);\n"
    "        NEVH__EACH(k, 1, 2 * DOF) lost[b][k] = AT(M, k, b);\n"
    "        NEVH__EACH(k, 1, KEPT) kept[b][k] = AT(M, 2 * DOF + k, b);\n"
    "    }\n"
    "    for (int i = 0; KEPT && i < WIDTH; i++) has_kept &= flags[i] != 0;\n"
    "    for (int b = 0; KEPT && !has_kept && b < BLOCKS; b++)\n"
    "        if (is_bad(take_first(TABLE(b), T, t0 + (double)from * h, h,\n"
    "                              y[b], lost[b], kept[b], NULL)))\n"
    "            return 0;\n"
    "    for (; done < steps; done++) {\n"
    "        double t = t0 + (double)(from + done) * h;\n"
    "        nevh__number bad = {0};\n"
    "        for (int b = 0; b < BLOCKS; b++)\n"
    "            bad += take_step(TABLE(b), W, T, operations, t, h, y[b],\n"
    "                             lost[b], kept[b], NULL);\n"
    "        if (is_bad(bad)) return done;\n"
    "    }\n"
    "    for (int b = 0; b < BLOCKS; b++) {\n"
    "        NEVH__EACH(k, 1, DOF) AT(Q, k, b) = y[b][k];\n"
    "        NEVH__EACH(k, 1, DOF) AT(P, k, b) = y[b][DOF + k];\n"
    "        NEVH__EACH(k, 1, 2 * DOF) AT(M, k, b) = lost[b][k];\n"
    "        NEVH__EACH(k, 1, KEPT) AT(M, 2 * DOF + k, b) = kept[b][k];\n"
    "    }\n"
    "    for (int i = 0; KEPT && i < WIDTH; i++) flags[i] = 1;\n"
    "    return done;\n}\n";

/* The same of one orbit, whose numbers are too many for the stack. */
static const char loading[] =
    "INLINE void load_all(double *to, const double *from) {\n"
    "    __builtin_memcpy(to, from, COUNT * sizeof *to);\n"
    "    for (size_t k = COUNT; k < 8 * DOF; k++) to[k] = 0;\n}\n"
    "INLINE void store_all(double *to, const double *from) {\n"
    "    __builtin_memcpy(to, from, COUNT * sizeof *to);\n}\n"
    "size_t nevh_native_steps(const double *restrict N, double *restrict W,\n"
    "        double *restrict T, size_t operations, double t0, double h,\n"
    "        size_t from, size_t steps, double *restrict Q,\n"
    "        double *restrict P, double *restrict M, size_t *counted,\n"
    "        double *restrict numbers) {\n"
    "    nevh__number *restrict room = (nevh__number *)numbers;\n";
static const char long_driver[] =
    "    double *flags = M + (2 + (KEPT > 0)) * COUNT;\n"
    "    size_t done = 0;\n"
    "    load_all((double *)y, Q);\n"
    "    load_all((double *)(y + DOF), P);\n"
    "    load_all((double *)lost, M);\n"
    "    load_all((double *)(lost + DOF), M + COUNT);\n"
    "    if (KEPT && *flags != 0) load_all((double *)kept, M + 2 * COUNT);\n"
    "    else if (is_bad(take_first(N, T, t0 + (double)from * h, h, y, lost,\n"
    "                               kept, room)))\n"
    "        return 0;\n"
    "    while (done < steps)\n"
    "        if (!take_steps(N, W, T, operations, t0, h, from + done,\n"
    "                        steps - done, y, lost, kept, room, &done))\n"
    "            return done;\n"
    "    store_all(Q, (double *)y);\n"
    "    store_all(P, (double *)(y + DOF));\n"
    "    store_all(M, (double *)lost);\n"
    "    store_all(M + COUNT, (double *)(lost + DOF));\n"
    "    if (KEPT) {\n"
    "        store_all(M + 2 * COUNT, (double *)kept);\n"
    "        *flags = 1;\n"
    "    }\n"
    "    return done;\n}\n";

static const char driver_for_readers[] =
    "static size_t advance(double t0, double h, size_t from, size_t steps,\n"
    "                      double *q, double *p, double *memory) {\n"
    "    $2double y[2 * DOF], lost[2 * DOF];\n"
    "    size_t done = 0;\n"
    "    memcpy(lost, memory, sizeof lost);\n"
    "    for (; done < steps; done++) {\n"
    "        memcpy(y, q, DOF * sizeof *q);\n"
    "        memcpy(y + DOF, p, DOF * sizeof *p);\n"
    "        if (take_step(t0 + (double)(from + done) * h, h, y, lost$1) != "
    "0)\n"
    "            break;\n"
    "        memcpy(q, y, DOF * sizeof *q);\n"
    "        memcpy(p, y + DOF, DOF * sizeof *p);\n"
    "        memcpy(memory, lost, sizeof lost);\n"
    "    }\n"
    "    return done;\n}\n";

static bool begins(const char *line, const char *word) {
    return strncmp(line, word, strlen(word)) == 0;
}

/* Whether the condition of a line "#ifdef NAME" or "#ifndef NAME" holds. */
static bool holds(const nevh__writer *w, const char *line) {
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
        if (!c->skipped && !holds(w, line))
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
            strcmp(text, "NEVH__KNOWN_COUNT\n") != 0)
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

const char *nevh__number_type(const nevh__writer *w) {
    return nevh__has_lanes(w) ? "wide" : "double";
}

/* A number of all orbits, where it is that of a block. */
static const char at_in_row[] =
    "#define AT(x, row, b) (*(nevh__number *)((x) + (row) * WIDTH + (b) * "
    "LANES))\n";
static const char at_in_group[] =
    "#define AT(x, row, b) (*(nevh__number *)((x) + ((row) / DOF * ONE + (row) % "
    "ONE) * WIDTH + ((b) * GROUP + (row) % DOF / ONE) * LANES))\n";

void nevh__write_needs(nevh__writer *w, size_t n, bool finite, bool sums) {
    if (w->readable) {
        nevh__write(w, "enum { DOF = %zu };\n\n%s%s%s", n, needs_of_readers,
                    finite ? not_finite_for_readers : "",
                    sums || w->stages ? vectors_for_readers : "");
        if (w->stages)
            nevh__write(w, "%s", stages_for_readers);
        return;
    }
    size_t lanes = w->width > 1 || w->loops ? NEVH__LANES : 1;
    bool wide = lanes > 1 && !w->stages;
    nevh__write(w, "#define NEVH_UNROLL%s\n",
                w->loops ? "" : " _Pragma(\"GCC unroll 16\")");
    nevh__write(w, "%s%s", needs, wide ? needs_of_lanes : needs_of_numbers);
    if (!wide)
        nevh__write(w, "%s", lanes > 1 ? roundoff_of_lanes : roundoff_of_one);
    if (w->stages)
        nevh__write(w, "%s%s", needs_of_stages, is_bad);
    else
        nevh__write(w, "%s%s", one_in_a_vector, wide ? is_bad : needs_of_one);
    if (w->loops) {
        nevh__write(w, "enum { DOF = %zu, ONE = DOF, COUNT = %zu };\n",
                    nevh__padded(n) / NEVH__LANES, n);
        return;
    }
    size_t group = w->group ? w->group : 1;
    nevh__write(
        w,
        "enum { ONE = %zu, GROUP = %zu, DOF = ONE * GROUP };\n"
        "enum { WIDTH = %zu, LANES = %zu, BLOCKS = WIDTH / LANES / GROUP "
        "};\n%s",
        n, group, w->width, lanes, group > 1 ? at_in_group : at_in_row);
}

void nevh__write_rows(nevh__writer *w, const char *name, size_t rows) {
    if (w->loops && !w->readable) {
        nevh__write(w, "    nevh__number *%s = room + %zu * (size_t)DOF;\n",
                    name, w->rows);
        w->rows += rows;
    } else
        nevh__write(w, "    %snevh__number %s[%zu * DOF];\n",
                    w->loops ? "static " : "", name, rows);
}

static const char take_one[] =
    "INLINE bool take_steps(const double *N, double *W, double *T, size_t "
    "operations, double t0, double h, size_t from, size_t steps, wide *y, wide "
    "*lost, wide *kept, wide *room, size_t *done) {\n"
    "    double t = t0 + (double)from * h;\n"
    "    bool fine = !is_bad(take_step(N, W, T, operations, t, h, y, lost, kept,\n"
    "                                  room));\n"
    "    *done += fine;\n"
    "    return fine;\n}\n";

static void write_long_driver(nevh__writer *w) {
    if (!w->takes_steps)
        nevh__write(w, "%s", take_one);
    nevh__write(w, "%s", loading);
    nevh__write_rows(w, "y", 2);
    nevh__write_rows(w, "lost", 2);
    nevh__write_rows(w, "kept", 1);
    nevh__write(w, "%s", long_driver);
}

void nevh__write_table(nevh__writer *w) {
    if (w->readable)
        return;
    if (w->by_lane)
        nevh__write(w, "#define TABLE(b) (N + (b) * (size_t)%zu)\n", w->count);
    else
        nevh__write(w, "#define TABLE(b) N\n");
}

void nevh__write_driver(nevh__writer *w, bool keeps) {
    if (w->readable)
        nevh__write_filled(
            w, driver_for_readers,
            (const char *const[]){keeps ? ", memory + 2 * DOF" : "",
                                  w->loops ? "static " : ""});
    else if (w->loops)
        write_long_driver(w);
    else {
        nevh__write_table(w);
        nevh__write(w, "%s", driver);
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

void nevh__write_step_head(nevh__writer *w) {
    nevh__write(w, "%s",
                w->readable
                    ? "/* A step of the state y, q and then p.  Returns 0 if "
                      "all is finite. */\n"
                      "static double take_step(double t, double h, double *y, "
                      "double *lost) "
                    : "INLINE nevh__number take_step(const double *N, double "
                      "*W, double *T, size_t operations, double t, double h, "
                      "nevh__number *y, nevh__number *lost, nevh__number "
                      "*kept, nevh__number *room) ");
}

void nevh__write_unkept(nevh__writer *w) {
    if (!w->readable)
        nevh__write(w, "enum { KEPT = 0 };\n"
                       "#define take_first(N, T, t, h, y, lost, kept, room) "
                       "((nevh__number){0})\n");
}

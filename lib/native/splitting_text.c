/* nevh: steps of a splitting as C text: that of the kernel, whose slopes are a
   scene's formulas.

   A state that is long is taken part after part where what terms read of it is
   near.  Where that is very near a vector stays in registers for several operations,
   a group: only slopes by variables that are read beside a vector, with which a group
   begins, have to wait for those beside.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/splitting_private.h"
#include "native/native_private.h"
#include "native/slope_private.h"
#include "native/vector_text_private.h"
#include <stdlib.h>

/* Vectors of a part; states of more numbers than LONG fill the caches, so that
   several steps are taken while a part is there: at most so many groups. */
enum { PART = 16, LONG = 20000, MOST_GROUPS = 32 };
/* Vectors of a part where operations are done one by one. */
enum { WHOLE_PART = 32 };

typedef struct {
    nevh__vectors kick, drift;
    size_t count; /* of operations */
    size_t first; /* in the first group, 0 to 2 */
    size_t groups;
    bool kicks_first, keeps;
} grouping;

/* A kick takes dH/dq at the drifts' time, a drift dH/dp at the kicks'. */
bool nevh__splitting_tables(const nevh_splitting *table, double **weights,
                            double **times) {
    size_t count = nevh__splitting_operations(table);
    double passed[2] = {0, 0};
    *weights = nevh__array(count, sizeof **weights);
    *times = nevh__array(count, sizeof **times);
    if (!*weights || !*times)
        return false;
    nevh__splitting_expand(table, *weights);
    for (size_t i = 0; i < count; i++) {
        (*times)[i] = passed[1 - i % 2];
        passed[i % 2] += (*weights)[i];
    }
    return true;
}

static bool reaches(const grouping *g, size_t operation) {
    bool kick = g->kicks_first == (operation % 2 == 0);
    return !(g->keeps && operation == 0) &&
           (kick ? g->kick.reaches : g->drift.reaches);
}

static void find_groups(grouping *g) {
    while (g->first < 2 && g->first < g->count && !reaches(g, g->first))
        g->first++;
    g->groups = 1 + (g->count - g->first + 1) / 2;
}

/* True if a group after the first has no kick, or no drift. */
static bool lacks(const grouping *g, bool kick) {
    bool single = (g->count - g->first) % 2,
         last_kicks = g->kicks_first == (g->count % 2 == 1);
    return single && last_kicks != kick;
}

static void write_groups(nevh__writer *w, const grouping *g, size_t n) {
    size_t all = nevh__padded(n) / NEVH__LANES;
    size_t steps = n > LONG ? (MOST_GROUPS + g->groups - 1) / g->groups : 1;
    /* A part before those that lag is read, too. */
    size_t in_work = steps * g->groups + 2, window = 3 * in_work * PART;
    size_t last = g->first + 2 * (g->groups > 1 ? g->groups - 2 : 0);
    nevh__write(w,
                "enum { PART = %d, PARTS = %zu, GROUPS = %zu, AT_ONCE = %zu, "
                "IN_WORK = %zu, WINDOW = %zu };\n"
                "enum { IN_FIRST = %zu, LAST_AT = %zu, IN_LAST = %zu };\n"
                "enum { KICK_REACHES = %d, DRIFT_REACHES = %d, READS_Q = %d, "
                "READS_P = %d };\n",
                PART, (all + PART - 1) / PART, g->groups, steps, in_work,
                window < all ? window : all, g->first, last, g->count - last,
                g->kick.reaches, g->drift.reaches,
                g->kick.reaches || lacks(g, false),
                g->drift.reaches || lacks(g, true));
    nevh__write_lines(w, nevh__splitting_groups_text);
}

static bool write_steps_of_groups(nevh__writer *w, nevh_work *work) {
    const nevh_splitting *table = work->integrator->table;
    grouping g = {.count = nevh__splitting_operations(table),
                  .kicks_first = table->first == NEVH_KICK};
    g.keeps = g.count % 2 == 1;
    bool kick = nevh__vectors_init(&g.kick, w, work->field, true);
    bool drift = nevh__vectors_init(&g.drift, w, work->field, false);
    w->takes_steps = kick && drift && !(g.kick.reaches && g.drift.reaches);
    if (w->takes_steps) {
        find_groups(&g);
        nevh__write_vector_helpers(w);
        w->takes_steps = nevh__write_vector_slope(w, work->field, &g.kick) &&
                         nevh__write_vector_slope(w, work->field, &g.drift);
        write_groups(w, &g, work->n);
    }
    nevh__vectors_clear(&g.kick);
    nevh__vectors_clear(&g.drift);
    return w->takes_steps;
}

/* The number of parts by which the last operation lags; writes that of each. */
static size_t write_lags(nevh__writer *w, const nevh_work *work, bool kick,
                         bool drift) {
    const nevh_splitting *table = work->integrator->table;
    size_t count = nevh__splitting_operations(table), lag = 0;
    bool before = false;
    nevh__write(w, "static const size_t lags[] = {");
    for (size_t i = 0; i < count; i++) {
        bool kicks = (table->first == NEVH_KICK) == (i % 2 == 0);
        bool reaches = (kicks ? kick : drift) && !(count % 2 == 1 && i == 0);
        lag += reaches || before;
        before = reaches;
        nevh__write(w, "%zu, ", lag);
    }
    nevh__write(w, "};\n");
    return lag;
}

static bool write_step_of_parts(nevh__writer *w, nevh_work *work) {
    size_t kick = nevh__slope_reach(w, work->field, true);
    size_t drift = nevh__slope_reach(w, work->field, false);
    size_t most = WHOLE_PART * NEVH__LANES;
    size_t all = nevh__padded(work->n) / NEVH__LANES;
    if (kick > most || drift > most)
        return false;
    /* A part before those that lag is read, too. */
    size_t in_work = write_lags(w, work, kick > 0, drift > 0) + 2;
    size_t window = 5 * in_work * WHOLE_PART;
    nevh__write(w,
                "enum { PART = %d, PARTS = %zu, IN_WORK = %zu, WINDOW = %zu "
                "};\n",
                WHOLE_PART, (all + WHOLE_PART - 1) / WHOLE_PART, in_work,
                window < all ? window : all);
    nevh__write_lines(w, nevh__splitting_parts_text);
    return true;
}

static void splitting_text_write_tables(nevh__writer *w,
                                        const nevh_splitting *table,
                                        size_t count) {
    double *weights, *times;
    if (nevh__splitting_tables(table, &weights, &times)) {
        nevh__write(w, "/* Weights, and times as parts of a step. */\n");
        nevh__write_numbers(w, "static double W", count, weights);
        nevh__write_numbers(w, "static double T", count, times);
        nevh__write(w, "\n");
    } else
        w->failed = true;
    free(weights);
    free(times);
}

bool nevh__write_splitting(nevh__writer *w, nevh_work *work) {
    const nevh_splitting *table = work->integrator->table;
    size_t count = nevh__splitting_operations(table);
    bool keeps = count % 2 == 1;
    w->group = nevh__vectors_at_once(w, work->field, keeps ? count - 1 : count);
    nevh__write_needs(w, work->n, true, false);
    if (!nevh__write_slopes(w, work->field, 2))
        return false;
    nevh__write(w, "enum { OPERATIONS = %zu, KICKS_FIRST = %d, KEEPS = %d };\n",
                count, table->first == NEVH_KICK, keeps);
    if (w->readable)
        splitting_text_write_tables(w, table, count);
    nevh__write_lines(w, nevh__splitting_step_text);
    if (!w->readable)
        nevh__write_lines(w, nevh__splitting_first_text);
    bool in_parts =
        w->loops && !w->readable &&
        (write_steps_of_groups(w, work) || write_step_of_parts(w, work));
    if (!in_parts)
        nevh__write_lines(w, nevh__splitting_whole_text);
    nevh__write_driver(w, true, w->takes_steps ? 6 : 5);
    return true;
}

/* nevh: steps of a splitting as C text where a state is long and what terms read
   of it is near: a vector of the state stays in registers for several operations.

   Only slopes by variables that are read beside a vector have to wait for those
   beside.  So operations are done in groups, each of which begins with such a
   slope, part after part of the state; each group lags one part behind the group
   before, and the next step behind this one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/splitting_private.h"
#include "native/native_private.h"
#include "native/vector_text_private.h"
#include <stdio.h>

/* Vectors of a part; states of more numbers than LONG fill the caches, so that
   several steps are taken while a part is there: at most so many groups. */
enum { PART = 16, LONG = 20000, MOST_GROUPS = 32 };

typedef struct {
    nevh__vectors kick, drift;
    size_t count; /* of operations */
    size_t first; /* in the first group, 0 to 2 */
    size_t groups;
    bool kicks_first, keeps;
} grouping;

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

static const char owner[] =
    "struct nevh__splitting_owner {\n"
    "    const double *N;\n"
    "    size_t k;\n"
    "    const wide *q, *p;\n"
    "    wide *bad, *kick, *drift;\n};\n\n"
    "NEVH__INLINE int nevh__splitting_slope(const nevh__splitting_step *x, int "
    "way,\n"
    "                                       size_t i, bool kick, bool kept) {\n"
    "    const struct nevh__splitting_owner *o = x->owner;\n"
    "    double t = x->t + x->scheme->times[i] * x->h;\n"
    "    if (kept) return 0;\n"
    "    *x->slope = kick ? kick_at(o->N, t, KICK_REACHES ? o->q : x->q.point,\n"
    "                               o->k, o->kick, o->bad)\n"
    "                     : drift_at(o->N, t, DRIFT_REACHES ? o->p : "
    "x->p.point,\n"
    "                                o->k, o->drift, o->bad);\n"
    "    return 0;\n}\n\n";

/* A group of `count` operations from i on, of one part.  `here`: where it is in
   rows of change, which are of the part, and of points, which are of parts. */
static const char group[] =
    "typedef struct {\n"
    "    const double *N;\n"
    "    const nevh__splitting_scheme *scheme;\n"
    "    double t, h;\n"
    "    wide *y, *lost, *kept, *change, *bad;\n"
    "    const wide *from;\n"
    "    wide *to;\n"
    "    size_t at, here, size;\n"
    "} part;\n"
    "INLINE void operate(const part *r, size_t i, size_t count, bool kick, "
    "bool begins, bool ends) {\n"
    "    wide kick_left[kick_before] = {0}, drift_left[drift_before] = {0};\n"
    "    wide check = {0}, none = {0};\n"
    "    wide *restrict state = r->y, *restrict rest = r->lost;\n"
    "    wide *restrict slopes = r->kept, *restrict to = r->to;\n"
    "    wide *restrict changes = r->change;\n"
    "    const double *N = r->N;\n"
    "    double now = r->t, h = r->h;\n"
    "    size_t from = r->at, place = r->here, size = r->size;\n"
    "    nevh__splitting_scheme scheme = *r->scheme;\n"
    "    const wide *q = r->from + r->here, *p = q + WINDOW;\n"
    "    bool takes = count > 0 && !begins && r->at > 0;\n"
    "    double t = takes ? r->t + r->scheme->times[i] * r->h : 0;\n"
    "    if (takes && KICK_REACHES)\n"
    "        kick_vector(r->N, t, q - 1, r->at - 1, kick_left, &none);\n"
    "    if (takes && DRIFT_REACHES)\n"
    "        drift_vector(r->N, t, p - 1, r->at - 1, drift_left, &none);\n"
    "    for (size_t k = 0; k < size; k++) {\n"
    "        size_t at = from + k, here = place + k;\n"
    "        wide y[2] = {state[at], state[DOF + at]};\n"
    "        wide lost[2] = {rest[at], rest[DOF + at]};\n"
    "        wide change[2], point[2], slope, kept;\n"
    "        struct nevh__splitting_owner owner = {N, at, q + k, p + k, "
    "&check,\n"
    "            kick_left, drift_left};\n"
    "        nevh__splitting_step x = {now, h, &scheme, $1,\n"
    "            {y, lost, change, point},\n"
    "            {y + 1, lost + 1, change + 1, point + 1},\n"
    "            &slope, &kept, &owner};\n"
    "        if (begins) {\n"
    "            if ($1) kept = slopes[at];\n"
    "            nevh__splitting_place(&x, 1, 1);\n"
    "        } else {\n"
    "            change[0] = changes[here], change[1] = changes[WINDOW + "
    "here];\n"
    "            point[0] = READS_Q ? q[k] : none;\n"
    "            point[1] = READS_P ? p[k] : none;\n"
    "        }\n"
    "        if (count > 0)\n"
    "            nevh__splitting_operate(&x, 0, 1, 1, i, kick, $1 && begins);\n"
    "        if (count > 1)\n"
    "            nevh__splitting_operate(&x, 0, 1, 1, i + 1, !kick, false);\n"
    "        if (ends) {\n"
    "            check += point[0] + point[1];\n"
    "            nevh__splitting_commit_all(&x, 1, 1, $1);\n"
    "            state[at] = y[0], state[DOF + at] = y[1];\n"
    "            rest[at] = lost[0], rest[DOF + at] = lost[1];\n"
    "            if ($1) slopes[at] = kept;\n"
    "        } else {\n"
    "            changes[here] = change[0], changes[WINDOW + here] = "
    "change[1];\n"
    "            if (READS_Q) to[here] = point[0];\n"
    "            if (READS_P) to[WINDOW + here] = point[1];\n"
    "        }\n"
    "    }\n"
    "    *r->bad += check - check;\n"
    "}\n"
    "static __attribute__((noinline)) void first_group(const part *r) {\n"
    "    operate(r, 0, $2, $3, true, GROUPS == 1);\n}\n"
    "static __attribute__((noinline)) void last_group(const part *r) {\n"
    "    operate(r, $4, $5, $6, false, true);\n}\n";
static const char middle[] =
    "static __attribute__((noinline)) void middle_group(const part *r, size_t "
    "i) {\n"
    "    operate(r, i, 2, $1, false, false);\n}\n";
static const char no_middle[] = "#define middle_group(r, i) ((void)0)\n";

static const char take_steps[] =
    "INLINE void move_all(wide *x, size_t by, int rows) {\n"
    "    for (; rows > 0; rows--, x += WINDOW)\n"
    "        __builtin_memmove(x, x + by, (WINDOW - by) * sizeof *x);\n}\n"
    "/* false: a step of those is bad, the state unknown. */\n"
    "static bool take_steps(const double *N, double *W, double *T, size_t "
    "operations, double t0, double h, size_t from, size_t steps, wide *y, wide "
    "*lost, wide *kept, wide *room, size_t *done) {\n";
static const char steps_of_parts[] =
    "    nevh__splitting_scheme scheme = {operations, W, T, $1, $2};\n"
    "    size_t count = steps < AT_ONCE ? steps : AT_ONCE, all = count * "
    "GROUPS;\n"
    "    size_t origin = 0, fine = 0;\n"
    "    wide bad[AT_ONCE] = {0};\n"
    "    for (size_t round = 0; round < PARTS + all - 1; round++) {\n"
    "        if (round < PARTS && round * PART == origin + WINDOW) {\n"
    "            size_t next = (round - IN_WORK) * PART;\n"
    "            move_all(change, next - origin, 2);\n"
    "            move_all(point, next - origin, 4);\n"
    "            origin = next;\n"
    "        }\n"
    "        for (size_t i = 0; i < all && i <= round; i++) {\n"
    "            size_t at = (round - i) * PART, step = i / GROUPS;\n"
    "            size_t g = i % GROUPS;\n"
    "            if (at >= DOF) continue;\n"
    "            double t = t0 + (double)(from + step) * h;\n"
    "            part r = {N, &scheme, t, h, y, lost, kept, change, bad + step,\n"
    "                point + (i % 2 ? 0 : 2 * WINDOW),\n"
    "                point + (i % 2 ? 2 * WINDOW : 0), at, at - origin,\n"
    "                DOF - at < PART ? DOF - at : PART};\n"
    "            if (g == 0) first_group(&r);\n"
    "            else if (g == GROUPS - 1) last_group(&r);\n"
    "            else middle_group(&r, $3 + 2 * (g - 1));\n"
    "        }\n"
    "    }\n"
    "    while (fine < count && !is_bad(bad[fine])) fine++;\n"
    "    *done += fine;\n"
    "    return fine == count;\n}\n";

static const char *truth(bool x) {
    return x ? "true" : "false";
}

/* True if a group after the first has no kick, or no drift. */
static bool lacks(const grouping *g, bool kick) {
    bool single = (g->count - g->first) % 2,
         last_kicks = g->kicks_first == (g->count % 2 == 1);
    return single && last_kicks != kick;
}

static void write_sizes(nevh__writer *w, const grouping *g, size_t n) {
    size_t all = nevh__padded(n) / NEVH__LANES;
    size_t steps = n > LONG ? (MOST_GROUPS + g->groups - 1) / g->groups : 1;
    /* A part before those that lag is read, too. */
    size_t in_work = steps * g->groups + 2, window = 3 * in_work * PART;
    nevh__write(w,
                "enum { PART = %d, PARTS = %zu, GROUPS = %zu, AT_ONCE = %zu, "
                "IN_WORK = %zu, WINDOW = %zu,\n"
                "       KICK_REACHES = %d, DRIFT_REACHES = %d, READS_Q = %d, "
                "READS_P = %d };\n",
                PART, (all + PART - 1) / PART, g->groups, steps, in_work,
                window < all ? window : all, g->kick.reaches, g->drift.reaches,
                g->kick.reaches || lacks(g, false),
                g->drift.reaches || lacks(g, true));
}

static void write_groups(nevh__writer *w, const grouping *g) {
    char first[24], last[24], left[24];
    size_t at = g->first + 2 * (g->groups > 1 ? g->groups - 2 : 0);
    const char *reaching = truth(g->kicks_first == (g->first % 2 == 0));
    snprintf(first, sizeof first, "%zu", g->first);
    snprintf(last, sizeof last, "%zu", at);
    snprintf(left, sizeof left, "%zu", g->count - at);
    nevh__write_filled(w, group,
                       (const char *const[]){truth(g->keeps), first,
                                             truth(g->kicks_first), last, left,
                                             reaching});
    nevh__write_filled(w, g->groups > 2 ? middle : no_middle, &reaching);
    nevh__write(w, "%s", take_steps);
    nevh__write_rows(w, "change", 2);
    nevh__write_rows(w, "point", 4);
    nevh__write_filled(
        w, steps_of_parts,
        (const char *const[]){truth(g->kicks_first), truth(g->keeps), first});
}

static bool plan(grouping *g, nevh__writer *w, nevh_work *work) {
    const nevh_splitting *table = work->integrator->table;
    g->count = nevh__splitting_operations(table);
    g->keeps = g->count % 2 == 1;
    g->kicks_first = table->first == NEVH_KICK;
    bool kick = nevh__vectors_init(&g->kick, w, work->field, true);
    bool drift = nevh__vectors_init(&g->drift, w, work->field, false);
    find_groups(g);
    return kick && drift && !(g->kick.reaches && g->drift.reaches);
}

bool nevh__write_splitting_groups(nevh__writer *w, nevh_work *work) {
    grouping g = {.first = 0};
    bool fine = !w->failed && plan(&g, w, work);
    w->takes_steps = fine;
    if (fine) {
        nevh__write_vector_helpers(w);
        fine = nevh__write_vector_slope(w, work->field, &g.kick) &&
               nevh__write_vector_slope(w, work->field, &g.drift);
        write_sizes(w, &g, work->n);
        nevh__write(w, "%s", owner);
        write_groups(w, &g);
    }
    nevh__vectors_clear(&g.kick);
    nevh__vectors_clear(&g.drift);
    return fine;
}

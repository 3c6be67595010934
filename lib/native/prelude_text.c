/* nevh: what formulas as C text need before them.  nevh__one_sin is the elementary
   function of one number, few_sin that of four, wide_sin that of as many as orbits stand
   together, eight or four: by vectors that the processor has, since numbers have few registers otherwise.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "elementary/elementary_list.h"
#include "native/writer_private.h"
#include <float.h>
#include <nevh/simd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const nevh__lane_words nevh__eight = {"wide", "ALL", "EACH_LANE", "wide_"};
const nevh__lane_words nevh__four = {"few", "ALL_FOUR", "EACH_OF_FOUR", "few_"};

int nevh__vector_lanes(void) {
#ifdef NEVH__VECTORS
    __builtin_cpu_init();
    if (__builtin_cpu_supports("x86-64-v4"))
        return 8;
    return __builtin_cpu_supports("x86-64-v3") ? 4 : 2;
#else
    return 1;
#endif
}

size_t nevh__lanes_together(void) {
    return nevh__vector_lanes() < NEVH__LANES ? NEVH__LANES / 2 : NEVH__LANES;
}

/* Families of elementary functions. */
enum { CIRCLE = 1, POWERS = 2, HYPERBOLIC = 4, ARCS = 8, ROOTS = 16 };

static const struct {
    const char *name;
    unsigned family;
    bool two; /* of two numbers */
} functions[] = {
#define ONE(name, f, family) {#f, family, false},
#define TWO(name, f, family) {#f, family, true},
    NEVH__EACH_ONE(ONE) NEVH__EACH_TWO(TWO)
#undef ONE
#undef TWO
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };
enum { OF_ONE, OF_FOUR, OF_EIGHT };

const char *nevh__elementary_call(nevh__writer *w,
                                  const nevh__lane_words *lanes,
                                  const char *function) {
    size_t length = strspn(function, "abcdefghijklmnopqrstuvwxyz0123456789");
    for (size_t i = 0; i < FUNCTIONS; i++)
        if (strlen(functions[i].name) == length &&
            strncmp(functions[i].name, function, length) == 0) {
            w->calls[OF_ONE] |= 1u << i;
            if (lanes)
                w->calls[lanes == &nevh__eight ? OF_EIGHT : OF_FOUR] |= 1u << i;
            return lanes ? lanes->call : "nevh__one_";
        }
    return lanes ? lanes->call : "";
}

size_t nevh__compiled_characters(const nevh__writer *text) {
    enum { QUICK = 4 }; /* most of them no step calls */
    return text->used - text->elementary + text->elementary / QUICK;
}

static unsigned families_of(unsigned calls) {
    unsigned families = 0;
    for (size_t i = 0; i < FUNCTIONS; i++)
        if (calls >> i & 1)
            families |= functions[i].family;
    return families;
}

/* Families that the text does not call are left out. */
static void write_left_out(nevh__writer *w, unsigned families, bool done) {
    static const char *const names[] = {"NEVH__NO_CIRCLE", "NEVH__NO_POWERS",
                                        "NEVH__NO_HYPERBOLIC", "NEVH__NO_ARCS",
                                        "NEVH__NO_ROOTS"};
    for (unsigned i = 0; i < sizeof names / sizeof *names; i++)
        if (!(families >> i & 1) && !done)
            nevh__write_form(w, names[i]);
        else if (!(families >> i & 1) && !w->readable)
            nevh__write(w, "#undef %s\n", names[i]);
}

/* The functions of so many numbers side by side, of vectors that the processor has. */
static void write_lanes(nevh__writer *w, const nevh__lane_words *words,
                        int lanes, unsigned calls) {
    unsigned families = families_of(calls);
    if (!calls)
        return;
    write_left_out(w, families, false);
    nevh__write_filled(w,
                       "#define NEVH__NUMBER $1\n"
                       "#define NEVH__PAIR $2pair\n"
                       "#define NEVH__E(f) $2##f\n",
                       (const char *const[]){words->type, words->call});
    nevh__write(w, "#define NEVH__SIDE %d\n", lanes);
    nevh__write_lines(w, nevh__elementary_lanes_text);
    nevh__write_lines(w, nevh__elementary_text_text);
    write_left_out(w, families, true);
}

/* The functions of more numbers, by parts. */
static void write_by_parts(nevh__writer *w, const nevh__lane_words *words,
                           int parts, const nevh__lane_words *part,
                           unsigned calls) {
    char count[12];
    snprintf(count, sizeof count, "%d", parts);
    for (size_t i = 0; i < FUNCTIONS; i++)
        if (calls >> i & 1)
            nevh__write_filled(
                w,
                functions[i].two
                    ? "INLINE $1 $2$3($1 x, $1 y) { union { $1 all; $4 part[$5]; "
                      "} u = {x}, v = {y}; for (int i = 0; i < $5; i++) "
                      "u.part[i] = $6$3(u.part[i], v.part[i]); return u.all; }\n"
                    : "INLINE $1 $2$3($1 x) { union { $1 all; $4 part[$5]; } u = "
                      "{x}; for (int i = 0; i < $5; i++) u.part[i] = "
                      "$6$3(u.part[i]); return u.all; }\n",
                (const char *const[]){words->type, words->call,
                                      functions[i].name, part->type, count,
                                      part->call});
}

void nevh__write_elementary_numbers(nevh__writer *w, const nevh__writer *text) {
    unsigned families = families_of(text->calls[OF_ONE]);
    if (!families)
        return;
    write_left_out(w, families, false);
    nevh__write_lines(w, nevh__elementary_number_text);
    nevh__write_lines(w, nevh__elementary_text_text);
    nevh__write_lines(w, nevh__elementary_edges_text);
    write_left_out(w, families, true);
    for (size_t i = 0; !w->readable && i < FUNCTIONS; i++)
        if (text->calls[OF_ONE] >> i & 1)
            nevh__write(w, "#define nevh_simd_%s nevh__one_%s\n",
                        functions[i].name, functions[i].name);
}

/* together: numbers of "wide" */
static void write_elementary_lanes(nevh__writer *w, int lanes, int together,
                                   const unsigned calls[]) {
    static const nevh__lane_words two = {"couple", NULL, NULL, "couple_"};
    unsigned few = calls[OF_FOUR], wide = calls[OF_EIGHT];
    nevh__write(w, "#define NEVH__HAS_SQRT\n");
    if (lanes == 8) {
        write_lanes(w, &nevh__four, 4, few);
        write_lanes(w, &nevh__eight, 8, wide);
    } else if (lanes == 4) {
        write_lanes(w, &nevh__four, 4, few | wide);
        write_by_parts(w, &nevh__eight, together / 4, &nevh__four, wide);
    } else {
        write_lanes(w, &two, 2, few | wide);
        write_by_parts(w, &nevh__four, 2, &two, few);
        write_by_parts(w, &nevh__eight, together / 2, &two, wide);
    }
}

void nevh__write_prelude(nevh__writer *text) {
    nevh__writer all = {0};
    int lanes = nevh__vector_lanes();
    int together = (int)nevh__orbits_together(text);
    if (together < NEVH__LANES)
        nevh__write_form(&all, "NEVH__FOUR_TOGETHER");
    if (FLT_EVAL_METHOD == 0)
        nevh__write_form(&all, "NEVH__PLAIN_DOUBLES");
    nevh__write_lines(&all, nevh__compiled_formulas_text);
    nevh__write_lines(&all, nevh__formula_needs_text);
    if (lanes == 8)
        nevh__write(&all, "#ifndef __AVX512F__\n#error no vectors of eight\n"
                          "#endif\n");
    if (lanes == 4)
        nevh__write(&all,
                    "#ifndef __AVX2__\n#error no vectors of four\n#endif\n");
    text->elementary = all.used;
    nevh__write_elementary_numbers(&all, text);
    write_elementary_lanes(&all, lanes, together, text->calls);
    text->elementary = all.used - text->elementary;
    nevh__write(&all, "%s", text->text);
    free(text->text);
    text->text = all.text;
    text->used = all.used;
    text->room = all.room;
    text->failed |= all.failed;
}

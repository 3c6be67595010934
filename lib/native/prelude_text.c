/* nevh: what formulas as C text need before them.

   lane_sin(x) is for one number what the library's blocks have for each of
   eight: functions of vectors, whose last bits are their own and depend on the
   processor.  wide is eight numbers, whatever vectors the processor has.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/writer_private.h"
#include <nevh/simd.h>
#include <stdio.h>
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

/* Functions of libm, and which of them have a form for vectors. */
static const struct {
    const char *name;
    int arguments;
    bool more;  /* only newer ones do */
    bool alike; /* forms of four and of eight lanes are one algorithm */
} functions[] = {{"sin", 1, false, true},  {"cos", 1, false, true},
                 {"exp", 1, false, false}, {"log", 1, false, false},
                 {"pow", 2, false, false}, {"tan", 1, true, false},
                 {"asin", 1, true, false}, {"acos", 1, true, false},
                 {"atan", 1, true, false}, {"sinh", 1, true, false},
                 {"cosh", 1, true, false}, {"tanh", 1, true, false},
                 {"cbrt", 1, true, false}, {"atan2", 2, true, false},
                 {"hypot", 2, true, false}};

#ifdef NEVH__VECTORS_MORE
static const bool has_more = true;
#else
static const bool has_more = false;
#endif

/* Without vectors, lane by lane. */
static void write_plain(nevh__writer *w, const char *f, bool two) {
    const nevh__lane_words *words[] = {&nevh__eight, &nevh__four};
    nevh__write(w, "#define lane_%s %s\n", f, f);
    for (int i = 0; i < 2; i++)
        nevh__write_filled(
            w,
            "INLINE $1 $2$3($1 x$4) { $1 z; $5 z[lane] = $3(x[lane]$6); return "
            "z; }\n",
            (const char *const[]){words[i]->type, words[i]->call, f,
                                  !two ? ""
                                  : i  ? ", few y"
                                       : ", wide y",
                                  words[i]->each, two ? ", y[lane]" : ""});
}

static void vector_name(const char *f, bool two, int lanes, char name[40]) {
    snprintf(name, 40, "_ZGV%cN%d%s_%s",
             lanes == 8   ? 'e'
             : lanes == 4 ? 'd'
                          : 'b',
             lanes, two ? "vv" : "v", f);
}

/* One number by four lanes takes two thirds of the time of eight. */
static void write_lane(nevh__writer *w, const char *f) {
    char name[40];
    vector_name(f, false, 4, name);
    nevh__write_filled(w,
                       "extern four $1(four) CONST;\n"
                       "INLINE double lane_$2(double x) { return $1((four){x, "
                       "x, x, x})[0]; }\n"
                       "INLINE few few_$2(few x) { return $1(x); }\n",
                       (const char *const[]){name, f});
}

/* A function of numbers side by side by vectors of fewer lanes: $1 the type, $2
   what its functions' names begin with, $3 the function, $4 $5 a second argument,
   $6 how many vectors, $7 the vectors' function, $8 their second argument. */
static const char by_parts[] =
    "INLINE $1 $2$3($1 x$4) { union { $1 all; vector part[$6]; } u = {x}$5; for "
    "(int i = 0; i < $6; i++) u.part[i] = $7(u.part[i]$8); return u.all; }\n";
/* Four by eight, of which the others are not needed. */
static const char by_eight[] =
    "INLINE few few_$1(few x$2) { wide z = wide_$1((wide){x[0], x[1], x[2], x[3], "
    "x[0], x[1], x[2], x[3]}$3); return (few){z[0], z[1], z[2], z[3]}; }\n";

static void prelude_text_write_parts(nevh__writer *w, const char *f, bool two,
                                     const nevh__lane_words *words, int parts,
                                     const char *vector) {
    char count[12], second[20];
    snprintf(count, sizeof count, "%d", parts);
    snprintf(second, sizeof second, ", %s y", words->type);
    nevh__write_filled(w, by_parts,
                       (const char *const[]){words->type, words->call, f,
                                             two ? second : "",
                                             two ? ", v = {y}" : "", count,
                                             vector, two ? ", v.part[i]" : ""});
}

static void write_vector(nevh__writer *w, const char *f, bool two, int lanes,
                         bool alike) {
    char name[40];
    vector_name(f, two, lanes, name);
    nevh__write(w, "extern vector %s(vector%s) CONST;\n", name,
                two ? ", vector" : "");
    prelude_text_write_parts(w, f, two, &nevh__eight, 8 / lanes, name);
    if (alike && lanes == 8) {
        write_lane(w, f);
        return;
    }
    nevh__write(w,
                "INLINE double lane_%s(double x%s) { return "
                "%s(SAME(x)%s)[0]; }\n",
                f, two ? ", double y" : "", name, two ? ", SAME(y)" : "");
    if (lanes < 8)
        prelude_text_write_parts(w, f, two, &nevh__four, 4 / lanes, name);
    else
        nevh__write_filled(
            w, by_eight,
            (const char *const[]){
                f, two ? ", few y" : "",
                two ? ", (wide){y[0], y[1], y[2], y[3], y[0], y[1], y[2], y[3]}"
                    : ""});
}

void nevh__write_prelude(nevh__writer *w) {
    static const char *const same[] = {"{x, x}", "{x, x, x, x}",
                                       "{x, x, x, x, x, x, x, x}"};
    int lanes = nevh__vector_lanes();
    nevh__write_lines(w, nevh__compiled_formulas_text);
    nevh__write_lines(w, nevh__formula_needs_text);
    if (lanes > 1)
        nevh__write(w,
                    "typedef double vector __attribute__((vector_size(%d)));\n"
                    "typedef double four __attribute__((vector_size(32)));\n"
                    "#define SAME(x) ((vector)%s)\n",
                    8 * lanes, same[lanes == 8 ? 2 : lanes / 4]);
    if (lanes == 8)
        nevh__write(w, "#ifndef __AVX512F__\n#error no vectors of eight\n"
                       "#endif\n");
    if (lanes == 4)
        nevh__write(w, "#ifndef __AVX2__\n#error no vectors of four\n#endif\n");
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        bool two = functions[i].arguments == 2;
        nevh__write(w, "extern double %s(double%s) CONST;\n", functions[i].name,
                    two ? ", double" : "");
        if (lanes > 1 && (has_more || !functions[i].more))
            write_vector(w, functions[i].name, two, lanes, functions[i].alike);
        else
            write_plain(w, functions[i].name, two);
    }
}

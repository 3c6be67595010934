/* nevh: what formulas as C text need before them.

   lane_sin(x) is for one number what the library's blocks have for each of
   eight: functions of vectors, whose last bits are their own and depend on the
   processor.  wide is eight numbers, whatever vectors the processor has.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/writer_private.h"
#include <nevh/simd.h>
#include <stdio.h>
#include <string.h>

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

static const char basis[] =
    "typedef __SIZE_TYPE__ size;\n"
    "#define INLINE static inline __attribute__((always_inline, unused))\n"
    "#define SLOPE INLINE\n"
    "#define CONST __attribute__((const))\n"
    "typedef double wide __attribute__((vector_size(64), aligned(8)));\n"
    "#define ALL(x) ((wide){x, x, x, x, x, x, x, x})\n"
    "#define EACH_LANE for (int lane = 0; lane < 8; lane++)\n"
    "INLINE double nevh_choose(int first, double x, double y) { return first ? "
    "x : y; }\n"
    "INLINE double nevh_real_min(double x, double y) { return x != x || x < y ? x : "
    "y; }\n"
    "INLINE double nevh_real_max(double x, double y) { return x != x || x > y ? x : "
    "y; }\n"
    "INLINE double nevh_sign(double x) { return x != x ? x : x > 0 ? 1 : x < 0 "
    "? -1 : 0; }\n"
    "#define nevh_chain(x, y) ((x) * (y)) /* of numbers and of vectors */\n"
    "extern double fmod(double, double) CONST;\n"
    "INLINE double nevh_mod(double x, double y) { double rest = fmod(x, y); "
    "return rest != 0 && (rest < 0) != (y < 0) ? rest + y : rest; }\n"
    "INLINE double nevh_roundoff(double sum, double a, double b) { double part = "
    "sum - a; return (a - (sum - part)) + (b - part); }\n"
    "extern double fabs(double) CONST, floor(double) CONST, rint(double) "
    "CONST;\n"
    "extern double asinh(double) CONST, acosh(double) CONST, atanh(double) "
    "CONST, log10(double) CONST, sqrt(double) CONST;\n"
    "#define lane_sqrt __builtin_sqrt\n"
    "INLINE wide wide_sqrt(wide x) { wide y; EACH_LANE y[lane] = "
    "__builtin_sqrt(x[lane]); return y; }\n";

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
    const char *second = two ? ", wide y" : "", *y = two ? ", y[lane]" : "";
    nevh__write(w,
                "#define lane_%s %s\n"
                "INLINE wide wide_%s(wide x%s) { wide z; EACH_LANE z[lane] = "
                "%s(x[lane]%s); return z; }\n",
                f, f, f, second, f, y);
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
                       "x, x, x})[0]; }\n",
                       (const char *const[]){name, f});
}

static void write_vector(nevh__writer *w, const char *f, bool two, int lanes,
                         bool alike) {
    char name[40];
    vector_name(f, two, lanes, name);
    nevh__write(w, "extern vector %s(vector%s) CONST;\n", name,
                two ? ", vector" : "");
    if (alike && lanes == 8)
        write_lane(w, f);
    else
        nevh__write(w,
                    "INLINE double lane_%s(double x%s) { return "
                    "%s(SAME(x)%s)[0]; }\n",
                    f, two ? ", double y" : "", name, two ? ", SAME(y)" : "");
    nevh__write(w,
                "INLINE wide wide_%s(wide x%s) { union { wide all; vector "
                "part[%d]; } u = {x}%s; for (int i = 0; i < %d; i++) u.part[i] "
                "= %s(u.part[i]%s); return u.all; }\n",
                f, two ? ", wide y" : "", 8 / lanes, two ? ", v = {y}" : "",
                8 / lanes, name, two ? ", v.part[i]" : "");
}

void nevh__write_prelude(nevh__writer *w) {
    static const char *const same[] = {"{x, x}", "{x, x, x, x}",
                                       "{x, x, x, x, x, x, x, x}"};
    int lanes = nevh__vector_lanes();
    nevh__write(w, "%s", basis);
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

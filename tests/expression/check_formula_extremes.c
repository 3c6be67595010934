/* nevh tests: formulas of any size, and text of any kind.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "formula.h"
#include <stdio.h>

static void refuse_repeated(const char *before, const char *piece, size_t count,
                            const char *after, const char *words) {
    size_t each = strlen(piece), at = strlen(before);
    char *text = calloc(at + count * each + strlen(after) + 1, 1);
    strcpy(text, before);
    for (size_t i = 0; i < count; i++, at += each)
        memcpy(text + at, piece, each);
    strcpy(text + at, after);
    nevh__names *names = formula_names();
    formula_system s = system_of(text, names, FORMULA_DOF);
    ck_assert_msg(words ? s.error.status == NEVH_EINVAL &&
                              strstr(s.error.text, words)
                        : !s.error.status,
                  "%s x %zu: %s", piece, count, s.error.text);
    system_done(&s);
    nevh__names_free(names);
    free(text);
}

TEST(extremes) {
    refuse_repeated("", "(", 100000, "", "levels");
    refuse_repeated("", "-", 100000, "x", "levels");
    refuse_repeated("x", "^x", 50000, "", "levels");
    refuse_repeated("", "sin(", 30000, "x", "levels");
    refuse_repeated("", "q[", 50000, "1", "levels");
    refuse_repeated("sum(", "i=1..1,", 15000, "x)", "levels");
    refuse_repeated("x", "+x", 100000, "", "at most");
    refuse_repeated("x", "+x", 20000, "", "summands");
    refuse_repeated("x", "+x", 9000, "", NULL);
    refuse_repeated("x", "*x", 7000, "", NULL);
    refuse_repeated("1", "0", 1000, "", "digits");
    refuse_repeated("x", "a", 1000, "", "longer than");
    refuse_repeated("x", "+sum(i=1..1,x)", 65, "", "too many sums");
    refuse_repeated("", "(", 150, "x", "is missing");
}

/* Definitions that double: 2^60 summands, 2^60 operations, 900 levels. */
TEST(doubling_definitions) {
    nevh__names *names = formula_names();
    char name[20], text[60];
    define(names, "a0", "x");
    define(names, "b0", "x");
    define(names, "c0", "x");
    for (int i = 1; i <= 60; i++) {
        snprintf(name, sizeof name, "a%d", i);
        snprintf(text, sizeof text, "a%d + a%d", i - 1, i - 1);
        define(names, name, text);
        snprintf(name, sizeof name, "b%d", i);
        snprintf(text, sizeof text, "b%d*b%d", i - 1, i - 1);
        define(names, name, text);
    }
    for (int i = 1; i <= 900; i++) {
        snprintf(name, sizeof name, "c%d", i);
        snprintf(text, sizeof text, "sin(c%d)", i - 1);
        define(names, name, text);
    }
    formula_system s = system_of("a60", names, FORMULA_DOF);
    ck_assert_msg(strstr(s.error.text, "summands"), "%s", s.error.text);
    system_done(&s);
    s = system_of("cos(a60) + b60", names, FORMULA_DOF);
    ck_assert_msg(!s.error.status, "%s", s.error.text);
    system_done(&s);
    s = system_of("c900", names, FORMULA_DOF);
    ck_assert_msg(strstr(s.error.text, "levels"), "%s", s.error.text);
    system_done(&s);
    s = system_of("c300 + c700", names, FORMULA_DOF);
    ck_assert_msg(strstr(s.error.text, "levels"), "%s", s.error.text);
    system_done(&s);
    s = system_of("c500", names, FORMULA_DOF);
    ck_assert_msg(!s.error.status, "%s", s.error.text);
    system_done(&s);
    nevh__names_free(names);
}

static unsigned long long seed = 7;

static unsigned random_below(unsigned most) {
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (unsigned)(seed >> 33) % most;
}

static void try_garbage(const char *text, const nevh__names *names) {
    formula_system s = system_of(text, names, FORMULA_DOF);
    const nevh__formula_error *e = &s.error;
    bool utf8 = !strstr(e->text, "UTF-8");
    size_t length = 0;
    for (const char *c = text; *c; c++)
        length += !utf8 || ((unsigned char)*c & 0xC0) != 0x80;
    if (e->status && !e->definition)
        ck_assert_msg(e->text[0] && e->column >= 1 &&
                          e->column + e->length <= length + 1 &&
                          e->column <= length + !length,
                      "%s: column %zu, length %zu: %s", text, e->column,
                      e->length, e->text);
    system_done(&s);
}

TEST(garbage) {
    static const char *const pieces[] = {"1",
                                         "2.5",
                                         ".",
                                         "..",
                                         "e",
                                         "E3",
                                         "+",
                                         "-",
                                         "*",
                                         "/",
                                         "^",
                                         "**",
                                         "(",
                                         ")",
                                         "[",
                                         "]",
                                         ",",
                                         "=",
                                         "x",
                                         "y",
                                         "p_x",
                                         "q",
                                         "p_q",
                                         "w",
                                         "N",
                                         "t",
                                         "pi",
                                         "d",
                                         "all",
                                         "sin",
                                         "sum",
                                         "i",
                                         "j",
                                         " ",
                                         "sum(i=1..N,",
                                         "q[i]",
                                         "sin(",
                                         "q[1]",
                                         "%",
                                         "#",
                                         "\t",
                                         "\xCF\x86",
                                         "\xE2\x88\x92",
                                         "\xFF",
                                         "atan2(x,",
                                         "x^2",
                                         ")*",
                                         "wrong",
                                         "first",
                                         "p",
                                         "v_x"};
    nevh__names *names = formula_names();
    for (int i = 0; i < 100000; i++) {
        char text[200] = "";
        unsigned count = random_below(i % 4 ? 9 : 20);
        for (unsigned k = 0; k < count; k++)
            strcat(text, pieces[random_below(sizeof pieces / sizeof *pieces)]);
        try_garbage(text, names);
    }
    for (int i = 0; i < 20000; i++) {
        char text[12] = "";
        for (unsigned k = 0; k + 1 < sizeof text; k++)
            text[k] = (char)random_below(256);
        try_garbage(text, names);
    }
    nevh__names_free(names);
}

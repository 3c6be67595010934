/* nevh tests: scenes that are wrong, and what is said about them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene.h"
#include "support.h"
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COORDINATES "[coordinates]\nx = 1\n"
#define EFFECTS     "[effects]\nH = p_x^2/2\n"

static const struct {
    const char *text, *place, *words;
} wrong[] = {
    {"", "1:1", "no [coordinates]"},
    {"# nothing\n\n", "2:1", "no [coordinates]"},
    {EFFECTS, "2:1", "no [coordinates]"},
    {COORDINATES, "2:1", "no [effects]"},
    {"x = 1\n", "1:1", "a section must come first"},
    {"[scene\n", "1:1", "line of its own"},
    {"[]\n", "1:2", "no section"},
    {"[scene] title = x\n", "1:1", "line of its own"},
    {"[coordinatse]\n", "1:2", "did you mean coordinates?"},
    {"[assembly]\n", "1:2", "no section assembly"},
    {"[parameters]\nm 1\n", "2:1", "neither NAME = VALUE"},
    {"[parameters]\nm : 1 # = 2\n", "2:1", "neither NAME = VALUE"},
    {"[parameters]\n  = 1\n", "2:3", "name is missing"},
    {"[parameters]\nm =\n", "2:4", "formula is missing"},
    {"[parameters]\nm = 1\n\tk = 2*mm\n", "3:8", "did you mean m?"},
    {"[parameters]\nk = 2*m\nm = 1\n", "2:7", "name m is not known"},
    {"[parameters]\nm = 1\nm = 2\n", "3:1", "taken"},
    {"[parameters]\nsin = 1\n", "2:1", "sin is a function"},
    {"[parameters]\nm = 1, 2\n", "2:8", "m takes 1 value, not 2"},
    {"[parameters]\nm[1..3] = 1, 2\n", "2:11", "m takes 3 values, not 2"},
    {"[parameters]\nm[1..3] = 1,, 2\n", "2:13", "formula is missing"},
    {"[parameters]\nm[0..3] = 1\n", "2:1", "indices begin with 1"},
    {"[parameters]\nm[1..0] = 1\n", "2:1", "between 1 and"},
    {"[parameters]\nm[1..1e9] = 1\n", "2:1", "between 1 and"},
    {"[parameters]\nm[k = 1..1e6] = sum(j = 1..1e6, j*k)\n", "2:21",
     "too much to add up"},
    {"[parameters]\nm[1..2.5] = 1\n", "2:6", "not a whole number"},
    {"[parameters]\nm[1..N] = 1\n", "2:6", "N"},
    {"[parameters]\nm[2] = 1\n", "2:1", "given at once"},
    {"[parameters]\nm[1..3 = 1\n", "2:2", "\"]\" is missing"},
    {"[parameters]\nm[i = 1..3] = 1/(i - 2)\n", "2:15", "i = 2"},
    {"[parameters]\na = 1\nm[a = 1..3] = a\n", "3:1", "something else"},
    {"[parameters]\na = 1/0\n", "2:5", "infinite"},
    {"[parameters]\nm = \xCE\xB1\xCE\xB2 + 2 3\n", "2:10", "operator"},
    {"[parameters]\n\xCE\xB1 = 2*zz\n", "2:7", "zz"},
    {"[parameters]\nm = \xFF\n", "2:5", "UTF-8"},
    {"[coordinates]\nx = 1, 2, 3\n" EFFECTS, "2:11", "VALUE, MOMENTUM"},
    {"[coordinates]\nx = 1 ; periode 2\n" EFFECTS, "2:9", "period FORMULA"},
    {"[coordinates]\nx = 1 ; period -2\n" EFFECTS, "2:16", "greater than 0"},
    {"[coordinates]\nx = 1 ; period 2*y\n" EFFECTS, "2:18", "name y"},
    {"[coordinates]\nx = y\n" EFFECTS, "2:5", "name y"},
    {"[coordinates]\nx = 1\np_y = 2\n" EFFECTS, "3:1", "no coordinate y"},
    {"[coordinates]\nx = 1, 2\np_x = 2\n" EFFECTS, "3:1", "line 2"},
    {"[coordinates]\nx = 1\nv_x = 2\np_x = 2\n" EFFECTS, "4:1", "line 3"},
    {"[coordinates]\nx = 1\nv_x[1..2] = 2\n" EFFECTS, "3:1", "no index"},
    {"[coordinates]\ny[1..2] = 1\nx = 0\nv_y = 2\n" EFFECTS, "4:1", "array"},
    {"[coordinates]\nx = x\n" EFFECTS, "2:5", "x"},
    {COORDINATES "[definitions]\nd = x + z\n" EFFECTS, "4:9", "name z"},
    {COORDINATES "[definitions]\nd = e2\ne2 = d\n" EFFECTS, "4:5", "itself"},
    {COORDINATES "[definitions]\nd = 10*e2\ne2 = zz\n" EFFECTS, "5:6", "zz"},
    {COORDINATES "[definitions]\nd = 1 +\n" EFFECTS, "4:7", "after"},
    {COORDINATES "[definitions]\nd = v_x\n" EFFECTS "V = x*d\n", "7:7",
     "velocities"},
    {COORDINATES "[effects]\nH = px^2\n", "4:5", "p_x"},
    {COORDINATES "[effects]\nH = p_x^2 + 2x\n", "4:13", "2*x"},
    {COORDINATES "[effects]\nH = 1\nV = 2\nH = 3\n", "6:1", "line 4"},
    {COORDINATES "[effects]\nH[1..2] = 1\n", "4:1", "plain name"},
    {COORDINATES "[effects]\nall = 1\n", "4:1", "all effects"},
    {COORDINATES "[effects]\nnone = 1\n", "4:1", "no effects"},
    {COORDINATES "[effects]\nH = file(\"term.c\")\n", "4:11", "--allow-code"},
    {COORDINATES "[effects]\nH = file(term.c)\n", "4:5", "file(\"NAME.c\")"},
    {COORDINATES "[effects]\nH = file(\"a.c\" x)\n", "4:16", "\",\""},
    {COORDINATES "[effects]\nH = file(\"a.c\", y)\n", "4:17", "parameter y"},
    {COORDINATES EFFECTS "[run]\ngradient_step = x: 0\n", "6:20", "greater"},
    {COORDINATES EFFECTS "[run]\ngradient_step = y: 1\n", "6:17", "momentum y"},
    {COORDINATES EFFECTS "[run]\ngradient_step = x: 1, 2\n", "6:23",
     "NAME: STEP"},
    {COORDINATES EFFECTS "[run]\ngradient_step = x: 1, x: 2\n", "6:23",
     "twice"},
    {"[scene]\neffects = H, G\n" COORDINATES EFFECTS, "2:14", "mean H?"},
    {"[scene]\neffects = H,\n" COORDINATES EFFECTS, "2:13", "missing"},
    {"[scene]\ntitel = x\n" COORDINATES EFFECTS, "2:1", "mean title?"},
    {COORDINATES EFFECTS "[friction]\nd = 0.1\n", "6:5", "COORDINATE: RATE"},
    {COORDINATES EFFECTS "[friction]\nd = y: 1\n", "6:5", "no coordinate y"},
    {COORDINATES EFFECTS "[friction]\nd = x: x\n", "6:8", "x"},
    {COORDINATES EFFECTS "[friction]\nd = x: 1, x: 2\n", "6:11", "twice"},
    {COORDINATES EFFECTS "[friction]\nd = x[1]: 1\n", "6:5", "no such"},
    {"[coordinates]\nx[1..2] = 0\n[effects]\nV = x[1]\n[friction]\n"
     "d = x[3]: 1\n",
     "6:5", "no such"},
    {COORDINATES EFFECTS "[invariants]\nL = x*z\n", "6:7", "name z"},
    {COORDINATES EFFECTS "[invariants]\nL = x ; without G\n", "6:17", "mean H"},
    {COORDINATES EFFECTS "[invariants]\nL = x ; with H\n", "6:9", "without"},
    {COORDINATES EFFECTS "[observables]\na = b\n", "6:5", "name b"},
    {COORDINATES EFFECTS "[picture]\nrodd = 0, 0\n", "6:1", "mean rod?"},
    {COORDINATES EFFECTS "[picture]\nrod = 0, 0, x\n", "6:7", "4 numbers"},
    {COORDINATES EFFECTS "[picture]\nbob = 0, y\n", "6:10", "name y"},
    {COORDINATES EFFECTS "[picture]\nbob = 0, x; Moon\n", "6:13", "name TEXT"},
    {COORDINATES EFFECTS "[sections]\na = x\n", "6:5", "is written"},
    {COORDINATES EFFECTS "[sections]\na = when x: p_x\n", "6:10", "\"=\""},
    {COORDINATES EFFECTS "[sections]\na = when x = 0: x\n", "6:14", "rising"},
    {COORDINATES EFFECTS "[sections]\na = when x = 0, up: x\n", "6:17",
     "rising"},
    {COORDINATES EFFECTS "[sections]\na = every x: x\n", "6:11", "x"},
    {COORDINATES EFFECTS "[sections]\na = every 1: x, y\n", "6:17", "name y"},
    {COORDINATES EFFECTS "[labels]\nenergi = J\n", "6:1", "mean energy?"},
    {COORDINATES EFFECTS "[run]\ndtt = 1\n", "6:1", "mean dt?"},
    {COORDINATES EFFECTS "[run]\ndt = 1\ndt = 2\n", "7:1", "line 6"},
    {COORDINATES EFFECTS "[run]\ndt = 1, -1\n", "6:9", "greater than 0"},
    {COORDINATES EFFECTS "[run]\nt_end = 2*x\n", "6:11", "x"},
    {COORDINATES EFFECTS "[run]\nintegrators = rk4, verlett\n", "6:20",
     "mean verlet?"},
    {COORDINATES EFFECTS "[run]\nintegrators = rk4+transfrom\n", "6:15", "rk4"},
    {COORDINATES EFFECTS "[run]\nintegrators = rk4,\n", "6:19", "missing"},
    {COORDINATES EFFECTS "[run]\ngradient = centrel4\n", "6:12", "central4?"},
    {COORDINATES EFFECTS "[run]\nreference = gaus\n", "6:13", "integrator"},
    {COORDINATES EFFECTS "[run]\nmatch = time\n", "6:9", "steps or work"},
    {COORDINATES EFFECTS "[run]\ntransform = t*x\n", "6:13", "time"},
    {COORDINATES EFFECTS "[run]\nstop = x\n", "6:8", "FORMULA < VALUE"},
    {COORDINATES EFFECTS "[run]\nstop = x < y\n", "6:12", "name y"},
};

TEST_EACH(errors, sizeof wrong / sizeof *wrong) {
    nevh_scene *s = nevh_scene_parse("f", wrong[_i].text);
    char place[40];
    const char *message = nevh_scene_message(s);
    snprintf(place, sizeof place, "f:%s: error: ", wrong[_i].place);
    ck_assert(nevh_scene_status(s) == NEVH_EINVAL ||
              nevh_scene_status(s) == NEVH_EDOM);
    ck_assert_msg(!strncmp(message, place, strlen(place)) &&
                      strstr(message, wrong[_i].words),
                  "%s: %s\nnot %s%s", wrong[_i].text, message, place,
                  wrong[_i].words);
    ck_assert_ptr_null(nevh_scene_system(s));
    ck_assert_int_ne(nevh_scene_set(s, "m = 1"), NEVH_OK);
    ck_assert_int_ne(nevh_scene_enable(s, "H", true), NEVH_OK);
    ck_assert_uint_eq(nevh_scene_dof(s), 0);
    nevh_scene_free(s);
}

TEST(caret_keeps_tabs) {
    nevh_scene *s = nevh_scene_parse("f", "[parameters]\n\tm\t= 2*\xCE\xB1z");
    ck_assert_str_eq(nevh_scene_message(s),
                     "f:2:8: error: the name \xCE\xB1z is not known\n"
                     "\tm\t= 2*\xCE\xB1z\n"
                     "\t \t    ^~");
    nevh_scene_free(s);
}

TEST(carriage_returns_are_not_shown) {
    nevh_scene *s = nevh_scene_parse("f", "[parameters]\r\nm = zz\r\n");
    ck_assert_str_eq(nevh_scene_message(s),
                     "f:2:5: error: the name zz is not known\n"
                     "m = zz\n"
                     "    ^~");
    nevh_scene_free(s);
}

/* Long lines are shown around the column, with dots where they go on. */
TEST_EACH(caret_in_a_long_line, 3) {
    static const int before[] = {400, 400, 2}, after[] = {0, 400, 400};
    char text[6000] = "[parameters]\nm = 0", place[20];
    for (int i = 0; i < before[_i]; i++)
        strcat(text, " + 1");
    strcat(text, " + zz");
    for (int i = 0; i < after[_i]; i++)
        strcat(text, " + 1");
    nevh_scene *s = nevh_scene_parse("f", text);
    const char *line = strchr(nevh_scene_message(s), '\n') + 1;
    const char *caret = strchr(line, '\n') + 1;
    snprintf(place, sizeof place, "f:2:%d: ", 4 * before[_i] + 9);
    ck_assert(!strncmp(nevh_scene_message(s), place, strlen(place)));
    ck_assert(strchr(caret, '^') - caret == strstr(line, "zz") - line);
    ck_assert_uint_lt(strlen(line), 300);
    ck_assert_int_eq(!strncmp(line, "...", 3), before[_i] > 2);
    ck_assert_int_eq(!strncmp(caret - 4, "...", 3), after[_i] > 2);
    nevh_scene_free(s);
}

TEST(control_characters_are_not_shown) {
    nevh_scene *s = nevh_scene_parse("f\033\n", "[sec\033tion\177]\n");
    for (const char *at = nevh_scene_message(s); *at; at++)
        ck_assert(*at == '\n' || (*at >= ' ' && *at < 0x7F));
    ck_assert(!strncmp(nevh_scene_message(s), "f\?\?:1:", 6));
    nevh_scene_free(s);
}

static nevh_scene *scene_in_file(const char *bytes, size_t count) {
    const char *path = "check_scene_errors.nevh";
    FILE *file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(bytes, 1, count, file), count);
    fclose(file);
    nevh_scene *s = nevh_scene_read(path);
    remove(path);
    return s;
}

TEST(files) {
    nevh_scene *s = scene_in_file(shaken_pendulum, sizeof shaken_pendulum - 2);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    nevh_scene_free(s);
    s = scene_in_file("", 0);
    ck_assert_int_eq(nevh_scene_status(s), NEVH_EINVAL);
    nevh_scene_free(s);
    s = scene_in_file("[scene]\ntitle = \0\n", 18);
    ck_assert_ptr_nonnull(strstr(nevh_scene_message(s), ":2:9: error: a NUL"));
    nevh_scene_free(s);
    const char *const paths[] = {".", "/nowhere/at/all", ""};
    for (size_t i = 0; i < 3; i++) {
        s = nevh_scene_read(paths[i]);
        ck_assert_int_eq(nevh_scene_status(s), NEVH_EFAILED);
        ck_assert_ptr_nonnull(strstr(nevh_scene_message(s), ": error: "));
        nevh_scene_free(s);
    }
    s = nevh_scene_read("/dev/zero");
    ck_assert_int_eq(nevh_scene_status(s), NEVH_EFAILED);
    nevh_scene_free(s);
}

static uint64_t state = 1;

static size_t below(size_t n) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (size_t)(state >> 33) % n;
}

static void mutate(char *text) {
    static const char letters[] = "[]()=;:,.#\n\r\t *^+-/<0129eEpv_xit\xCE\xFF";
    size_t length = strlen(text), at = below(length), many = 1 + below(12);
    many = many < length - at ? many : length - at;
    switch (below(4)) {
    case 0: /* replace */
        text[at] = letters[below(sizeof letters - 1)];
        break;
    case 1: /* leave out */
        memmove(text + at, text + at + many, length - at - many + 1);
        break;
    case 2: /* insert */
        memmove(text + at + 1, text + at, length - at + 1);
        text[at] = letters[below(sizeof letters - 1)];
        break;
    default: /* copy from elsewhere */
        memmove(text + at, text + below(length - many), many);
    }
}

/* Whatever the text, there is a scene or a message with a place. */
TEST(mutations) {
    double q[64], p[64];
    for (int i = 0; i < 4000; i++) {
        char text[2 * sizeof shaken_pendulum] = "";
        strcpy(text, i % 2 ? shaken_pendulum : moving_chain);
        for (size_t k = 1 + below(3); k > 0; k--)
            mutate(text);
        nevh_scene *s = nevh_scene_parse("f", text);
        int status = nevh_scene_status(s);
        ck_assert_msg(!status || strstr(nevh_scene_message(s), ": error: "),
                      "%s: %s", text, nevh_scene_message(s));
        ck_assert_int_eq(status != 0, nevh_scene_system(s) == NULL);
        if (!status && nevh_scene_dof(s) < 64)
            nevh_scene_start(s, q, p);
        if (i % 5 == 0)
            nevh_scene_set(s, i % 2 ? "w = 1/m" : "N = 2");
        nevh_scene_free(s);
    }
}

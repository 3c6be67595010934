/* nevh tests: what a scene says of H, and its formulas in MathML.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "shipped.h"
#include <stdlib.h>
#include <string.h>

static nevh_scene *scene_of(const char *formula) {
    char text[700];
    snprintf(text, sizeof text,
             "[parameters]\nN = 3\na = 2 # m\nc[1..3] = 1, 2, 3\n"
             "[coordinates]\nx = 0 ; period 2*pi\nphi1 = 1\n"
             "[effects]\nK = (p_x^2 + p_phi1^2)/2\nV = %s\n[run]\nt_end = 1\n"
             "dt = 0.1\n",
             formula);
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_str_eq(nevh_scene_message(s), "");
    return s;
}

static char *equation_of(const nevh_scene *s, const char *name) {
    for (size_t i = 0; i < nevh_scene_equation_count(s); i++)
        if (strcmp(nevh_scene_equation_at(s, i).name, name) == 0)
            return nevh_scene_equation_mathml(s, i);
    ck_abort_msg("there is no line of %s", name);
    return NULL;
}

/* What a reader sees: a fraction as {over|under}, a power as ^{}, an index as
   _{}, a root as root{}. */
static void read_as_text(const char *math, char *to) {
    static const char *const marks[][2] = {
        {"<mfrac><mrow>", "{"},    {"</mrow><mrow>", "|"},
        {"</mrow></mfrac>", "}"},  {"<msqrt>", "root{"},
        {"</msqrt>", "}"},         {"<msub>", "_{"},
        {"</msub>", "}"},          {"<msup>", "^{"},
        {"</msup>", "}"},          {"<munderover>", "sum{"},
        {"</munderover>", "}"},    {"<mo>&#x2062;</mo>", "*"},
        {"<mo>&#x2061;</mo>", ""}, {"<mo>−</mo>", "-"},
        {"<mo>⋅</mo>", "."},
    };
    while (*math) {
        size_t i = 0, count = sizeof marks / sizeof *marks;
        while (i < count &&
               strncmp(math, marks[i][0], strlen(marks[i][0])) != 0)
            i++;
        if (i < count) {
            to += sprintf(to, "%s", marks[i][1]);
            math += strlen(marks[i][0]);
        } else if (*math == '<')
            math = strchr(math, '>') + 1;
        else
            *to++ = *math++;
    }
    *to = '\0';
}

static const struct {
    const char *formula, *seen;
} formulas[] = {
    {"x - (a - x)", "V=x-(a-x)"},
    {"x - (a + x)*2", "V=x-(a+x).2"},
    {"-a*x", "V=-a*x"},
    {"a*(-x)", "V=a*(-x)"},
    {"x + -a", "V=x+(-a)"},
    {"-(a + x)", "V=-(a+x)"},
    {"x/2/a", "V={x|2*a}"},
    {"x/(2*a)*3", "V={x.3|2*a}"},
    {"1/(x + a)", "V={1|x+a}"},
    {"(x + a)/2", "V={x+a|2}"},
    {"(x*a)^2", "V=^{(x*a)|2}"},
    {"(-x)^2", "V=^{(-x)|2}"},
    {"-x^2", "V=-^{x|2}"},
    {"x^(a + 1)", "V=^{x|a+1}"},
    {"(x^2)^a", "V=^{(^{x|2})|a}"},
    {"sin(x)^2", "V=^{sin2}(x)"},
    {"sqrt(x + a)", "V=root{x+a}"},
    {"sqrt(x)^3", "V=^{root{x}|3}"},
    {"abs(x)", "V=|x|"},
    {"atan2(x, a)", "V=atan2(x,a)"},
    {"1.5e-7*x", "V=1.5.^{10-7}*x"},
    {"pi*phi1", "V=π*_{φ1}"},
    {"p_phi1*x", "V=_{p_{φ1}}*x"},
    {"sum(i = 1..N, c[i]*x^i)", "V=sum{∑i=1|N}_{ci}*^{x|i}"},
    {"sum(i = 1..N, c[i] - x)*a", "V=(sum{∑i=1|N}(_{ci}-x))*a"},
};

TEST_EACH(formulas_are_set_as_they_are_read,
          sizeof formulas / sizeof *formulas) {
    nevh_scene *s = scene_of(formulas[_i].formula);
    char *math = equation_of(s, "V"), seen[2000];
    ck_assert_ptr_nonnull(math);
    read_as_text(math, seen);
    ck_assert_str_eq(seen, formulas[_i].seen);
    free(math);
    nevh_scene_free(s);
}

TEST(lines_follow_what_was_set_and_switched) {
    nevh_scene *s = scene_of("a*x");
    ck_assert_uint_eq(nevh_scene_equation_count(s), 7);
    ck_assert_str_eq(nevh_scene_equation_at(s, 1).section, "parameters");
    ck_assert_str_eq(nevh_scene_equation_at(s, 3).section, "coordinates");
    ck_assert_int_eq(nevh_scene_set(s, "a=5"), NEVH_OK);
    ck_assert_str_eq(nevh_scene_equation_at(s, 1).value, "5");
    ck_assert(nevh_scene_equation_at(s, 6).on);
    ck_assert_int_eq(nevh_scene_enable(s, "V", false), NEVH_OK);
    ck_assert(!nevh_scene_equation_at(s, 6).on);
    ck_assert_ptr_null(nevh_scene_equation_at(s, 7).section);
    ck_assert_ptr_null(nevh_scene_equation_mathml(s, 7));
    /* A list is no formula; a period is none either. */
    ck_assert_ptr_null(nevh_scene_equation_mathml(s, 2));
    char *math = nevh_scene_equation_mathml(s, 3);
    ck_assert_ptr_nonnull(math);
    ck_assert_ptr_null(strstr(math, "period"));
    free(math);
    nevh_scene_free(s);
}

/* Each end closes the element that was opened last. */
static void is_nested(const char *math) {
    char open[400][20];
    size_t depth = 0;
    for (const char *c = strchr(math, '<'); c; c = strchr(c + 1, '<')) {
        size_t bytes = strcspn(c + 1, " >");
        ck_assert_uint_lt(bytes, sizeof *open);
        if (c[1] == '/') {
            ck_assert_uint_gt(depth, 0);
            depth--;
            ck_assert_int_eq(strncmp(open[depth], c + 2, bytes - 1), 0);
        } else {
            ck_assert_uint_lt(depth, 400);
            snprintf(open[depth++], sizeof *open, "%.*s", (int)bytes, c + 1);
        }
    }
    ck_assert_uint_eq(depth, 0);
}

TEST_EACH(shipped_scenes_are_well_formed, find_shipped()) {
    nevh_scene *s = read_shipped(shipped[_i]);
    ck_assert_str_eq(nevh_scene_message(s), "");
    for (size_t i = 0; i < nevh_scene_equation_count(s); i++) {
        char *math = nevh_scene_equation_mathml(s, i);
        if (math)
            is_nested(math);
        else
            ck_assert_str_ne(nevh_scene_equation_at(s, i).section,
                             "definitions");
        free(math);
    }
    nevh_scene_free(s);
}

/* nevh tests: the text of formulas, their numbers and their errors.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "formula.h"
#include <math.h>
#include <stdio.h>

static const double PI = 3.14159265358979323846;

static double number_of(const char *text) {
    nevh__names *names = formula_names();
    nevh__formula_error e;
    double value = NAN;
    nevh__tree *tree = nevh__tree_parse(text, &e);
    if (tree)
        nevh__tree_number(tree, names, NULL, &value, &e);
    ck_assert_msg(!e.status, "%s: column %zu: %s", text, e.column, e.text);
    nevh__tree_free(tree);
    nevh__names_free(names);
    return value;
}

TEST(numbers) {
    const struct {
        const char *text;
        double value;
    } table[] = {
        {"-2^2", -4},
        {"2^3^2", 512},
        {"2**3**2", 512},
        {"2^-1", 0.5},
        {"2^-2^2", 0.0625},
        {"-2^-2", -0.25},
        {"(-2)^2", 4},
        {"6/2*3", 9},
        {"6/2/3", 1},
        {"2 - 3 - 4", -5},
        {"2 - (3 - 4)", 3},
        {"2--3", 5},
        {"2*-3", -6},
        {"+2 - +3", -1},
        {"-2*3 + 4", -2},
        {"1 + 2*3^2/4 - 5", 1 + 2 * 9 / 4. - 5},
        {"1.", 1},
        {".5", 0.5},
        {"1e-3", 1e-3},
        {"1.5E+3", 1500},
        {"00012.50e+01", 125},
        {"0.1", 0.1},
        {"3.14159265358979323846264338327950288", PI},
        {"123456789012345678901234567890", 123456789012345678901234567890.},
        {"1.7976931348623157e308", 1.7976931348623157e308},
        {"4.9406564584124654e-324", 0x1p-1074},
        {"1e-999999", 0},
        {"0e999999", 0},
        {"pi", PI},
        {"ln(2) - log(2)", 0},
        {"arcsin(0.3) + arccos(0.3) - pi/2", asin(0.3) + acos(0.3) - PI / 2},
        {"arctan2(-1, -2)", atan2(-1, -2)},
        {"arsinh(2) + artanh(0.5)", asinh(2) + atanh(0.5)},
        {"pow(2, 10)", 1024},
        {"mod(-1, 4)", 3},
        {"min(2, 1) + max(2, 1)", 3},
        {"m + mass", 1.3 + 2 * 1.3},
        {"2*\xCF\x86\xE2\x82\x81", 0.5},
        {"w[1] + w[N]", 9},
        {"w[mod(7, N) + 1]", 7},
        {"w[2*(N - 3)]^2", 9},
        {"sum(i = 1..N, w[i])", 17},
        {"sum(i = 2..N-1, i*w[i])", 21},
        {"sum(i = 1..N, j = i+1..N, w[i]*w[j])", (17 * 17 - 87) / 2.},
        {"sum(i = 1..N, sum(j = 1..i, 1))", 10},
        {"sum(i = -1..1, i^2)", 2},
        {"sum(i = 1..0, w[i + 99])", 0},
        {"2\xC2\xA0* 3\t", 6},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        double value = number_of(table[i].text);
        ck_assert_msg(value == table[i].value, "%s is %.17g, not %.17g",
                      table[i].text, value, table[i].value);
    }
}

/* Columns count characters; phi with an index is two of them. */
static const struct {
    const char *text;
    size_t column, length;
    const char *words, *definition;
} wrong[] = {
    {"", 1, 0, "formula is missing", NULL},
    {"   ", 1, 0, "formula is missing", NULL},
    {"2x", 1, 2, "write 2*x", NULL},
    {"x + 2(y + 1)", 5, 2, "write 2*(...)", NULL},
    {"(x)(y)", 3, 2, "write (...)*(...)", NULL},
    {"x y", 1, 3, "write x*y", NULL},
    {"q[1]x", 4, 2, "write [...]*x", NULL},
    {"2 3", 1, 3, "operator is missing", NULL},
    {"1.2.3", 1, 5, "no number", NULL},
    {"1,5*x", 2, 1, "1.5", NULL},
    {"x, y", 2, 1, "takes a \",\"", NULL},
    {"1 + sin^2(x)", 5, 5, "write sin(x)^2", NULL},
    {"sin^-1(x)", 1, 6, "write asin(x), or 1/sin(x)", NULL},
    {"exp^-1(x)", 1, 6, "write exp(x)^1", NULL},
    {"sin x", 1, 5, "write sin(x)", NULL},
    {"2*cos", 3, 3, "write cos(x)", NULL},
    {"px^2", 1, 2, "the momentum of x is p_x", NULL},
    {"px*2", 1, 2, "the momentum of x is p_x", NULL},
    {"pq[1]", 1, 2, "the momentum of q is p_q", NULL},
    {"vx", 1, 2, "the velocity of x is v_x", NULL},
    {"2*e", 3, 1, "write exp(1)", NULL},
    {"masss + 1", 1, 5, "did you mean mass?", NULL},
    {"2 - amss", 5, 4, "did you mean mass?", NULL},
    {"Sin(x)", 1, 3, "did you mean sin?", NULL},
    {"sine(x)", 1, 4, "did you mean sin?", NULL},
    {"2*banana", 3, 6, "name banana is not known", NULL},
    {"banana(x)", 1, 6, "no function banana", NULL},
    {"x(y + 1)", 1, 1, "write x*(...)", NULL},
    {"pi(2)", 1, 2, "write pi*(...)", NULL},
    {"p_z", 1, 3, "no coordinate z", NULL},
    {"v_x*p_x", 1, 3, "velocity", NULL},
    {"\xCF\x80*x", 1, 1, "did you mean pi?", NULL},
    {"atan2(x)", 1, 8, "atan2(y, x)", NULL},
    {"1 + sin(x, y)", 5, 9, "sin(x)", NULL},
    {"sin()", 4, 2, "missing", NULL},
    {"(x + 1", 1, 1, "\")\" is missing", NULL},
    {"x*(y + (1)", 3, 1, "\")\" is missing", NULL},
    {"sin(x", 4, 1, "\")\" is missing", NULL},
    {"x + 1)", 6, 1, "no \"(\"", NULL},
    {"q[1", 2, 1, "\"]\" is missing", NULL},
    {"q[1)", 4, 1, "no \"(\"", NULL},
    {"x]", 2, 1, "no \"[\"", NULL},
    {"2[1]", 2, 1, "only a name", NULL},
    {"x + ", 3, 1, "after \"+\"", NULL},
    {"x*/y", 3, 1, "before \"/\"", NULL},
    {"*x", 1, 1, "before \"*\"", NULL},
    {"(x + )", 6, 1, "before \")\"", NULL},
    {"()", 1, 2, "missing between", NULL},
    {"\xCF\x86\xE2\x82\x81 \xE2\x88\x92 1", 4, 1, "write -", NULL},
    {"x \xE2\x80\x93 1", 3, 1, "write -", NULL},
    {"2\xC3\x97x", 2, 1, "write *", NULL},
    {"2\xC2\xB7x", 2, 1, "write *", NULL},
    {"x\xC2\xB2", 2, 1, "write ^2", NULL},
    {"x \xFF", 3, 1, "not UTF-8", NULL},
    {"x % 2", 3, 1, "mod(a, b)", NULL},
    {"x & 2", 3, 1, "no meaning", NULL},
    {"x < 2", 3, 1, "comparisons", NULL},
    {"x = 2", 3, 1, "no \"=\"", NULL},
    {"x == 2", 3, 1, "no \"=\"", NULL},
    {"1..3", 2, 2, "sum(i = 1..N", NULL},
    {"1e999", 1, 5, "too large", NULL},
    {"2e", 1, 2, "the exponent is missing, as in 2e3; for a product write 2*e",
     NULL},
    {"2E", 1, 2, "the exponent is missing", NULL},
    {"2ea", 1, 3, "an operator is missing; for a product write 2*ea", NULL},
    {"q", 1, 1, "q has no index: write q[1], or sum(i = 1..4, q[i])", NULL},
    {"2*p_q^2", 3, 3, "p_q has no index", NULL},
    {"w*x", 1, 1, "w has no index", NULL},
    {"x[1]", 1, 4, "it has no index", NULL},
    {"m[1]", 1, 4, "it has no index", NULL},
    {"t[1]", 1, 4, "it has no index", NULL},
    {"d[1]", 1, 4, "it has no index", NULL},
    {"q[1, 2]", 4, 1, "one index", NULL},
    {"q[0]", 3, 1, "q[0] does not exist: its indices are 1..4", NULL},
    {"p_q[5]", 5, 1, "p_q[5] does not exist", NULL},
    {"w[5]*x", 3, 1, "w[5] does not exist", NULL},
    {"q[half]", 3, 4, "2.5, which is not a whole number", NULL},
    {"q[1e300]", 3, 5, "too large", NULL},
    {"q[x]", 3, 1, "x is a coordinate", NULL},
    {"q[t]", 3, 1, "t is the time", NULL},
    {"q[d]", 3, 1, "d is made of coordinates", NULL},
    {"q[i]", 3, 1, "indices come from sum", NULL},
    {"sum(i = 1..N, q[i + 1]^2)", 17, 5, "1..4 (i = 4)", NULL},
    {"sum(i = 1..N, j = 1..i, q[i + j])", 27, 5, "(i = 3, j = 2)", NULL},
    {"sum(i = 1..N, cos(q[i/2]))", 21, 3, "0.5, which is not a whole", NULL},
    {"sum(i = 1..half, q[i])", 12, 4, "end of the range is 2.5", NULL},
    {"sum(i = y..N, q[i])", 9, 1, "y is a coordinate", NULL},
    {"sum(i = 1..2^60, x)", 12, 4, "too large", NULL},
    {"sum(i = 1..1e9, x)", 17, 1, "more than 16777216", NULL},
    {"sum(i = 1..1e9, 1)*x", 5, 1, "too much to add up", NULL},
    {"sum(i = 1..2^24 + 1, x)", 22, 1, "more than 16777216", NULL},
    {"sum(i = 1..1e5, cos(x*i))^2", 21, 1, "more than 16384", NULL},
    {"sum(x)", 4, 1, "sum(i = 1..N, x[i])", NULL},
    {"sum*x", 1, 3, "sum(i = 1..N, x[i])", NULL},
    {"sum(i = 1..3)", 13, 1, "to be added up is missing", NULL},
    {"sum(i = 1, x)", 10, 1, "takes a \",\"", NULL},
    {"sum(i = 1..N, q[i]", 4, 1, "\")\" is missing", NULL},
    {"sum(m = 1..N, x)", 5, 1, "m already means something", NULL},
    {"sum(sin = 1..N, x)", 5, 3, "sin already means something", NULL},
    {"sum(i = 1..N, i = 1..N, x)", 15, 1, "i already means", NULL},
    {"sum(i = i..N, x)", 9, 1, "index i is not known", NULL},
    {"sum(i = 1..N, i[2])", 15, 4, "i is an index", NULL},
    {"x + 1/(m - 1.3)", 5, 11, "infinite", NULL},
    {"sqrt(m - 2)*x", 1, 11, "not a number", NULL},
    {"x^2*log(m - 2)", 5, 10, "not a number", NULL},
    {"sum(i = 1..N, q[i]/(i - 2)*log(i - 2))", 28, 10, "(i = 1)", NULL},
    {"2*wrong", 5, 7, "nothing is not known", "wrong"},
    {"x*first", 3, 5, "first is defined by itself", "second"},
};

TEST_EACH(errors, sizeof wrong / sizeof *wrong) {
    nevh__names *names = formula_names();
    formula_system s = system_of(wrong[_i].text, names, FORMULA_DOF);
    const nevh__formula_error *e = &s.error;
    ck_assert_msg(e->status == NEVH_EINVAL || e->status == NEVH_EDOM,
                  "%s: status %d", wrong[_i].text, e->status);
    ck_assert_msg(strstr(e->text, wrong[_i].words), "%s: no \"%s\" in: %s",
                  wrong[_i].text, wrong[_i].words, e->text);
    ck_assert_msg(e->column == wrong[_i].column &&
                      e->length == wrong[_i].length,
                  "%s: column %zu, length %zu: %s", wrong[_i].text, e->column,
                  e->length, e->text);
    const char *definition = wrong[_i].definition;
    ck_assert_msg(definition
                      ? e->definition && strcmp(e->definition, definition) == 0
                      : !e->definition,
                  "%s", wrong[_i].text);
    system_done(&s);
    nevh__names_free(names);
}

/* Where numbers are wanted. */
TEST(parameters_only) {
    static const struct {
        const char *text;
        size_t column;
        const char *words;
    } table[] = {
        {"2*x", 3, "x is a coordinate, but only parameters"},
        {"1 + p_q[1]", 5, "p_q is a momentum"},
        {"d", 1, "d is made of coordinates"},
        {"t", 1, "t is the time"},
        {"1/(m - 1.3)", 1, "infinite"},
    };
    nevh__names *names = formula_names();
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        nevh__formula_error e;
        double value;
        nevh__tree *tree = nevh__tree_parse(table[i].text, &e);
        ck_assert_int_ne(nevh__tree_number(tree, names, NULL, &value, &e), 0);
        ck_assert_msg(strstr(e.text, table[i].words), "%s", e.text);
        ck_assert_uint_eq(e.column, table[i].column);
        nevh__tree_free(tree);
    }
    nevh__names_free(names);
}

TEST(whole_numbers_and_indices) {
    nevh__names *names = formula_names();
    nevh__formula_error e;
    nevh__index i = {.name = "i", .value = 3};
    long whole;
    double value;
    nevh__tree *tree = nevh__tree_parse("w[i] + 10*i", &e);
    ck_assert_int_eq(nevh__tree_number(tree, names, &i, &value, &e), 0);
    ck_assert_double_eq(value, 35);
    ck_assert_int_eq(nevh__tree_integer(tree, names, &i, &whole, &e), 0);
    ck_assert_int_eq(whole, 35);
    ck_assert_int_eq(nevh__tree_number(tree, names, NULL, &value, &e),
                     NEVH_EINVAL);
    ck_assert_uint_eq(e.column, 3);
    nevh__tree_free(tree);
    tree = nevh__tree_parse("N/half", &e);
    ck_assert_int_eq(nevh__tree_integer(tree, names, NULL, &whole, &e),
                     NEVH_EINVAL);
    ck_assert_msg(strstr(e.text, "the value is 1.6"), "%s", e.text);
    nevh__tree_free(tree);
    nevh__names_free(names);
}

/* Names. */

TEST(names_are_refused) {
    static const struct {
        const char *name, *words;
    } table[] = {
        {"x", "taken"},       {"m", "taken"},           {"d", "taken"},
        {"t", "time"},        {"pi", "constant"},       {"sin", "function"},
        {"ln", "function"},   {"sum", "function"},      {"p_0", "momentum"},
        {"v_0", "velocity"},  {"", "no name"},          {"2x", "no name"},
        {"a b", "no name"},   {" a", "no name"},        {"a+", "no name"},
        {"a\xFF", "no name"}, {"x\xC3\x97", "no name"},
    };
    nevh__names *names = formula_names();
    const double one = 1;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        nevh__formula_error e;
        nevh__tree *tree = nevh__tree_parse("1", &e);
        const char *name = table[i].name;
        ck_assert_int_eq(nevh__names_add_definition(names, name, tree, &e),
                         NEVH_EINVAL);
        ck_assert_msg(strstr(e.text, table[i].words), "%s", e.text);
        ck_assert_int_eq(nevh__names_add_parameter(names, name, 0, &one, &e),
                         NEVH_EINVAL);
        ck_assert_int_eq(nevh__names_add_coordinate(names, name, 0, 0, &e),
                         NEVH_EINVAL);
    }
    nevh__names_free(names);
}

TEST(names_are_found) {
    nevh__names *names = formula_names();
    nevh__formula_error e;
    size_t count = 99, first = 99;
    ck_assert_int_eq(nevh__names_find(names, "p_q", &count, &first),
                     NEVH__MOMENTUM);
    ck_assert_uint_eq(count, 4);
    ck_assert_uint_eq(first, 2);
    ck_assert_int_eq(nevh__names_find(names, "v_y", NULL, &first),
                     NEVH__VELOCITY);
    ck_assert_uint_eq(first, 1);
    ck_assert_int_eq(nevh__names_find(names, "d", NULL, NULL),
                     NEVH__DEFINITION);
    ck_assert_int_eq(nevh__names_find(names, "p_d", NULL, NULL), NEVH__UNKNOWN);
    nevh__tree *tree = nevh__tree_parse("sum(i = 1..N, w[i])", &e);
    double sum;
    ck_assert_int_eq(nevh__tree_number(tree, names, NULL, &sum, &e), 0);
    ck_assert_double_eq(sum, 17);
    nevh__tree_free(tree);
    nevh__names_free(names);
}

/* Heads of lines. */

TEST(heads) {
    nevh__head head;
    nevh__formula_error e;
    ck_assert_int_eq(nevh__head_parse(" p_x [i = 1 .. 2*N - 1] ", &head, &e),
                     0);
    ck_assert_str_eq(head.name, "p_x");
    ck_assert_str_eq(head.index, "i");
    nevh__names *names = formula_names();
    long to;
    ck_assert_int_eq(nevh__tree_integer(head.to, names, NULL, &to, &e), 0);
    ck_assert_int_eq(to, 7);
    nevh__head_free(&head);
    ck_assert_int_eq(nevh__head_parse("x", &head, &e), 0);
    ck_assert(!head.from && !head.to && !head.index);
    nevh__head_free(&head);
    ck_assert_int_eq(nevh__head_parse("x[3]", &head, &e), 0);
    ck_assert(head.from && !head.to && !head.index);
    nevh__head_free(&head);
    ck_assert_int_eq(nevh__head_parse("x[1..N]", &head, &e), 0);
    ck_assert(head.from && head.to && !head.index);
    nevh__head_free(&head);
    nevh__names_free(names);
}

TEST(wrong_heads) {
    static const struct {
        const char *text;
        size_t column;
    } table[] = {{"", 1},    {"2", 1},     {"x y", 3},         {"x[", 2},
                 {"x[1", 2}, {"x[1..", 4}, {"x[i=1]", 6},      {"x[1..2] 3", 9},
                 {"x[]", 3}, {"x = 1", 3}, {"x[i = 1..N)", 11}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        nevh__head head;
        nevh__formula_error e;
        ck_assert_int_eq(nevh__head_parse(table[i].text, &head, &e),
                         NEVH_EINVAL);
        ck_assert(!head.name && !head.from);
        ck_assert_msg(e.column == table[i].column, "%s: %zu: %s", table[i].text,
                      e.column, e.text);
    }
}

TEST(extents) {
    ck_assert_uint_eq(nevh__formula_extent("f(1, 2)[3, 4], 5; 6", ",;"), 13);
    ck_assert_uint_eq(nevh__formula_extent("(1, 2", ",;"), 5);
    ck_assert_uint_eq(nevh__formula_extent("1) ; 2", ",;"), 3);
    ck_assert_uint_eq(nevh__formula_extent("", ",;"), 0);
}

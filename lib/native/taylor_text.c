/* nevh: Taylor coefficients of an H as C text: its recurrences written out, one
   statement each, with the inner sums of all products side by side.

   The numbers are those of lib/taylor/series_text.h, to the last bit: what is
   added to what is the same.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/taylor_private.h"
#include "native/native_private.h"
#include <stdio.h>
#include <stdlib.h>

/* Beyond that a compiler takes longer than the series of a usual run. */
enum { MOST_VALUES = 3000, MOST_LANES = 1024, MANY_LANES = 64, WIDE = 8 };

typedef struct {
    nevh__writer *text;
    const nevh__recurrence *r;
    size_t order, lanes, together;
    bool first; /* coefficients of order 0 */
} author;

/* Lanes without the padding between their kinds. */
static size_t lane_of(const author *a, size_t lane) {
    return lane < a->r->weighted ? lane : lane - a->r->weighted + a->r->used[0];
}

static void name_value(const author *a, size_t value, char name[NEVH__NAME]) {
    size_t constant = value - a->r->first_constant;
    if (value >= a->r->first_constant && constant < a->r->n_constants)
        snprintf(name, NEVH__NAME, a->first ? "N[%zu]" : "0.0", constant);
    else
        snprintf(name, NEVH__NAME, "v%zu", value);
}

static void name_operand(const author *a, const nevh__batch *b, size_t i,
                         int which, char name[NEVH__NAME]) {
    size_t value = b->together[which] ? b->operand[which] + i
                                      : a->r->index[b->operand[which] + i];
    name_value(a, value, name);
}

static void name_operands(const author *a, const nevh__batch *b, size_t i,
                          char x[NEVH__NAME], char z[NEVH__NAME]) {
    name_operand(a, b, i, 0, x);
    if (b->arity > 1)
        name_operand(a, b, i, 1, z);
}

static void write_sum(const author *a, const nevh__batch *b, size_t i) {
    char part[NEVH__MOST_SUMMANDS][2 * NEVH__NAME], x[NEVH__NAME];
    for (int k = 0; k < b->arity; k++) {
        name_operand(a, b, i, k, x);
        snprintf(part[k], sizeof part[k], "N[%zu] * %s",
                 b->number + (size_t)k * b->count + i, x);
    }
    static const char *const forms[] = {"%s", "%s + %s", "(%s + %s) + %s",
                                        "(%s + %s) + (%s + %s)"};
    char sum[10 * NEVH__NAME];
    snprintf(sum, sizeof sum, forms[b->arity - 1], part[0], part[1], part[2],
             part[3]);
    nevh__write(a->text, "v%zu = %s;\n", b->first + i, sum);
}

static void write_call(const author *a, const nevh__batch *b, size_t y,
                       const char *x, const char *z) {
    const char *name =
        b->function == NEVH__NOTHING ? NULL : nevh__operation_name(b->function);
    if (!name) {
        nevh__write(a->text, "v%zu = 0;\n", y);
        return;
    }
    const char *before = nevh__elementary_call(a->text, NULL, name);
    nevh__write(a->text, "v%zu = %s%s(%s%s%s);\n", y, before, name, x,
                b->arity > 1 ? ", " : "", b->arity > 1 ? z : "");
}

static void write_power(const author *a, size_t y, const char *x,
                        size_t number) {
    double exponent = (double)a->r->numbers[number];
    if (exponent == -1.5)
        nevh__write(a->text, "v%zu = 1 / (%s * __builtin_sqrt(%s));\n", y, x,
                    x);
    else if (exponent == -0.5)
        nevh__write(a->text, "v%zu = 1 / __builtin_sqrt(%s);\n", y, x);
    else
        nevh__write(a->text, "v%zu = %spow(%s, N[%zu]);\n", y,
                    nevh__elementary_call(a->text, NULL, "pow"), x, number);
    nevh__write(a->text, "const double e%zu = 1 / %s;\n", y, x);
}

static void begin_operation(const author *a, const nevh__batch *b, size_t i) {
    char x[NEVH__NAME], z[NEVH__NAME] = "";
    size_t y = b->first + i;
    name_operands(a, b, i, x, z);
    switch (b->kind) {
    case NEVH__BATCH_SUM:
        write_sum(a, b, i);
        break;
    case NEVH__BATCH_MULTIPLY:
        nevh__write(a->text, "v%zu = %s * %s;\n", y, x, z);
        break;
    case NEVH__BATCH_INVERT:
        nevh__write(a->text, "v%zu = 1 / %s;\nconst double e%zu = -v%zu;\n", y,
                    x, y, y);
        break;
    case NEVH__BATCH_ROOT:
        nevh__write(a->text,
                    "v%zu = __builtin_sqrt(%s);\n"
                    "const double e%zu = 0.5 / v%zu;\n",
                    y, x, y, y);
        break;
    case NEVH__BATCH_POWER:
        write_power(a, y, x, b->number + i);
        break;
    default:
        write_call(a, b, y, x, z);
    }
}

static void next_operation(const author *a, const nevh__batch *b, size_t i) {
    char x[NEVH__NAME], z[NEVH__NAME] = "";
    size_t y = b->first + i, s = lane_of(a, b->lane + i), c = b->number + i;
    name_operands(a, b, i, x, z);
    switch (b->kind) {
    case NEVH__BATCH_SUM:
        write_sum(a, b, i);
        break;
    case NEVH__BATCH_MULTIPLY:
        nevh__write(a->text, "v%zu = s[%zu] + (a0_%zu * %s + %s * b0_%zu);\n",
                    y, s, s, z, x, s);
        break;
    case NEVH__BATCH_INVERT:
        nevh__write(a->text, "v%zu = (s[%zu] + %s * b0_%zu) * e%zu;\n", y, s, x,
                    s, y);
        break;
    case NEVH__BATCH_ROOT:
        nevh__write(a->text, "v%zu = (%s - s[%zu]) * e%zu;\n", y, x, s, y);
        break;
    case NEVH__BATCH_POWER:
        nevh__write(a->text,
                    "v%zu = ((N[%zu] + 1) * (s[%zu] * inverse + %s * b0_%zu) "
                    "- (s[%zu] + %s * b0_%zu)) * e%zu;\n",
                    y, c, s, x, lane_of(a, b->also + i),
                    lane_of(a, b->also + i), x, lane_of(a, b->also + i), y);
        break;
    default:
        nevh__write(a->text,
                    "v%zu = N[%zu] * ((s[%zu] + order * %s * b0_%zu) * "
                    "inverse);\n",
                    y, c, s, x, s);
    }
}

static void each_operation(const author *a,
                           void (*write)(const author *, const nevh__batch *,
                                         size_t)) {
    for (size_t k = 0; k < a->r->n_batches; k++)
        for (size_t i = 0; i < a->r->batches[k].count; i++)
            write(a, &a->r->batches[k], i);
}

static bool is_lane(const author *a, size_t lane) {
    const nevh__recurrence *r = a->r;
    return lane < r->used[0] ||
           (lane >= r->weighted && lane < r->weighted + r->used[1]);
}

/* Lanes of operands, of the present order; padding is 0. */
static void write_rows(const author *a) {
    const nevh__recurrence *r = a->r;
    char x[NEVH__NAME];
    for (int which = 0; which < 2; which++) {
        nevh__write(a->text, "{ double *to = %s + k * LANES;\n",
                    which ? "b" : "a");
        for (size_t from = 0; from < a->lanes; from += a->together) {
            nevh__write(a->text, "LANES_AT(to + %zu) = (series_lanes){", from);
            for (size_t lane = from; lane < from + a->together; lane++) {
                size_t at =
                    lane < r->used[0] ? lane : lane - r->used[0] + r->weighted;
                bool there = is_lane(a, at);
                if (there)
                    name_value(a, which ? r->lane_b[at] : r->lane_a[at], x);
                nevh__write(a->text, "%s%s%s", lane > from ? ", " : "",
                            there && !which && at < r->used[0] ? "order * "
                                                               : "",
                            there ? x : "0");
            }
            nevh__write(a->text, "};\n");
        }
        nevh__write(a->text, "}\n");
    }
}

static void write_outer(const author *a) {
    const nevh__recurrence *r = a->r;
    char x[NEVH__NAME], z[NEVH__NAME];
    for (size_t at = 0; at < r->lanes; at++)
        if (is_lane(a, at)) {
            name_value(a, r->lane_a[at], x);
            name_value(a, r->lane_b[at], z);
            nevh__write(a->text,
                        "const double a0_%zu = %s, b0_%zu = %s;\n"
                        "(void)a0_%zu, (void)b0_%zu;\n",
                        lane_of(a, at), x, lane_of(a, at), z, lane_of(a, at),
                        lane_of(a, at));
        }
}

/* Coefficients of the state, from slopes of the order below. */
static void write_advance(author *a, const char *k) {
    const nevh__recurrence *r = a->r;
    char x[NEVH__NAME];
    for (size_t i = 0; i < 2 * r->n; i++) {
        name_value(a, r->slope[i], x);
        nevh__write(a->text, "const double r%zu = N[%zu] * %s * inverse;\n", i,
                    r->slope_number + i, x);
    }
    for (size_t i = 0; i < 2 * r->n; i++)
        nevh__write(a->text, "v%zu = rows[%s * STATE + %zu] = r%zu;\n", i, k, i,
                    i);
}

/* Writes the series in which edges of domains are searched for. */
static void write_watched(const author *a, const char *k) {
    const nevh__recurrence *r = a->r;
    char x[NEVH__NAME];
    for (size_t i = 0; i < r->n_watched; i++) {
        name_value(a, r->watched[i], x);
        nevh__write(a->text, "watched[%s * %zu + %zu] = %s;\n", k, r->n_watched,
                    i, x);
    }
}

static void write_begin(author *a) {
    const nevh__recurrence *r = a->r;
    a->first = true;
    for (size_t i = 0; i < r->values; i++)
        if (i < r->first_constant || i >= r->first_constant + r->n_constants)
            nevh__write(a->text, "double v%zu = 0;\n", i);
    for (size_t i = 0; i < 2 * r->n; i++)
        nevh__write(a->text, "rows[%zu] = v%zu = state[%zu];\n", i, i, i);
    nevh__write(a->text, "v%zu = t;\n", 2 * r->n);
    each_operation(a, begin_operation);
    write_watched(a, "0");
    write_outer(a);
}

/* Slopes of order 0 may be numbers, later ones of those are 0. */
static void write_order(author *a, bool first) {
    nevh__write(a->text, "{\nconst double order = k, inverse = 1.0 / k;\n"
                         "(void)order, (void)inverse;\n");
    a->first = first;
    write_advance(a, "k");
    a->first = false;
    nevh__write(a->text, "v%zu = %s;\n", 2 * a->r->n, first ? "1" : "0");
    if (!first)
        nevh__write(a->text, "sum_products(k, a, b, s, next);\n");
    each_operation(a, next_operation);
    write_watched(a, "k");
    write_rows(a);
    nevh__write(a->text, "}\n");
}

static void write_last(author *a) {
    nevh__write(a->text, "{\nconst double inverse = 1.0 / ORDER;\n");
    a->first = a->order == 1;
    write_advance(a, "ORDER");
    nevh__write(a->text, "double bad = 0;\n");
    for (size_t i = 0; i < 2 * a->r->n; i++)
        nevh__write(a->text, "bad += r%zu - r%zu;\n", i, i);
    nevh__write(a->text, "return bad == 0;\n}\n}\n");
}

bool nevh__write_series(nevh__writer *text, nevh_work *w) {
    author a = {.text = text};
    a.r = nevh__taylor_recurrence(w, &a.order);
    const nevh__recurrence *r = a.r;
    if (text->readable)
        text->refusal = NEVH__ONLY_FAMILIES;
    else if (r->values > MOST_VALUES || r->lanes > MOST_LANES)
        text->refusal = "H has too many operations for its series to be";
    if (text->refusal)
        return false;
    a.together = nevh__lanes_together();
    a.lanes = (r->used[0] + r->used[1] + WIDE - 1) / WIDE * WIDE;
    for (size_t i = 0; i < r->n_numbers; i++)
        nevh__writer_append(text, (double)r->numbers[i]);
    nevh__write(text,
                "#define ORDER %zu\n#define LANES %zu\n#define STATE %zu\n"
                "#define TOGETHER %zu\n",
                a.order, a.lanes, 2 * r->n, a.together);
    if (a.lanes >= MANY_LANES)
        nevh__write_form(text, "NEVH__TWO_ORDERS");
    nevh__write_lines(text, nevh__series_sums_text);
    nevh__write(text,
                "int nevh_native_series(const double *N, double t, "
                "const double *state, double *rows, double *watched) {\n"
                "(void)watched;\n"
                "double a[ORDER * LANES + 8] __attribute__((aligned(64)));\n"
                "double b[ORDER * LANES + 8] __attribute__((aligned(64)));\n"
                "double s[LANES + 8] __attribute__((aligned(64))) = {0};\n"
                "double next[LANES] __attribute__((aligned(64)));\n");
    write_begin(&a);
    nevh__write(text, "size k = 1;\n");
    write_order(&a, true);
    nevh__write(text, "for (k = 2; k < ORDER; k++)\n");
    write_order(&a, false);
    write_last(&a);
    return !text->failed;
}

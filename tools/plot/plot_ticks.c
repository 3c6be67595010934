/* nevh: plots: marks and numbers along an axis.

   All numbers of an axis are in one notation: a power of 10 that they share,
   and what many digits they have in common, go to the label.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <string.h>

static const double rounding = 1e-9; /* of a step */

/* 1, 2 or 5 times a power of 10. */
static double round_step(double step) {
    double power = pow(10, floor(log10(step))), digits = step / power;
    return power * (digits <= 1 ? 1 : digits <= 2 ? 2 : digits <= 5 ? 5 : 10);
}

static tick *add_tick(axis *a, double at, bool minor) {
    tick *t = &a->tick[a->count];
    if (a->count == PLOT_MOST_TICKS)
        return NULL;
    a->count++;
    *t = (tick){.at = at, .minor = minor};
    return t;
}

/* Numbers on a straight axis. */

static int power_of(double largest) {
    int power = (int)floor(log10(largest) + rounding);
    return power < -2 || power > 4 ? power : 0;
}

static int digits_of(double step) {
    return (int)fmax(ceil(-log10(step) - rounding), 0);
}

/* The offset common to numbers that would be too long otherwise: a round one near
   the middle. */
static double common_part(range r, double step) {
    static const double long_numbers = 1e5; /* steps */
    double largest = fmax(fabs(r.low), fabs(r.high));
    double round = round_step(20 * step);
    double middle = (r.low + r.high) / 2;
    return largest < long_numbers * step ? 0 : floor(middle / round) * round;
}

static double numbers_of(range r, double step) {
    return floor(r.high / step + rounding) - ceil(r.low / step - rounding) + 1;
}

/* About as many numbers as were asked for, and two, which an axis needs. */
static double step_of(range r, double count) {
    double step = round_step((r.high - r.low) / fmax(count, 2));
    for (int i = 0; i < 2 && numbers_of(r, step) < 2; i++)
        step = round_step(0.4 * step);
    return step;
}

static void add_numbers(axis *a, double count) {
    range r = a->shown;
    double step = step_of(r, count);
    a->base = common_part(r, step);
    double low = r.low - a->base, high = r.high - a->base;
    a->power = power_of(fmax(fabs(low), fabs(high)));
    double unit = pow(10, a->power);
    int digits = digits_of(step / unit);
    for (double k = ceil(low / step - rounding);
         k <= high / step + rounding && a->count < PLOT_MOST_TICKS; k++) {
        double number = k * step / unit;
        tick *t = add_tick(a, k * step + a->base, false);
        snprintf(t->text, sizeof t->text, "%.*f", digits,
                 number == 0 ? 0 : number);
    }
}

/* Numbers on a logarithmic axis. */

static void add_power(axis *a, int digit, int decade, bool text) {
    tick *t = add_tick(a, digit * pow(10, decade), false);
    if (!t)
        return;
    if (text)
        snprintf(t->text, sizeof t->text, "%de%d", digit, decade);
    else if (digit == 1)
        snprintf(t->text, sizeof t->text, "10^{%d}", decade);
    else
        snprintf(t->text, sizeof t->text, "%d\303\22710^{%d}", digit, decade);
}

static bool holds(range r, double value) {
    return value >= r.low * (1 - rounding) && value <= r.high * (1 + rounding);
}

static void add_decades(axis *a, double count, bool text) {
    range r = a->shown;
    double decades = log10(r.high / r.low);
    int step = (int)fmax(ceil(decades / fmax(floor(count), 1)), 1);
    int first = (int)floor(log10(r.low) + rounding);
    int last = (int)ceil(log10(r.high) - rounding);
    bool few = decades < 2;
    for (int k = first; k <= last; k++)
        for (int digit = 1; digit < 10; digit++) {
            double at = digit * pow(10, k);
            bool named = digit == 1 ? k % step == 0 || few
                                    : few && (digit == 2 || digit == 5);
            if (!holds(r, at))
                continue;
            if (named)
                add_power(a, digit, k, text);
            else if (digit == 1 || decades <= 8)
                add_tick(a, at, true);
        }
}

axis plot_axis(range shown, bool log, double count, bool text) {
    static const double short_of = 0.5; /* of a decade */
    static const double fewer = 0.6;    /* than powers of 10 */
    axis a = {.shown = shown, .log = log};
    if (log && log10(shown.high / shown.low) >= short_of)
        add_decades(&a, count, text);
    else
        add_numbers(&a, log ? fewer * count : count);
    return a;
}

/* Letters that a number takes: those of enhanced text, braces left out. */
static size_t letters_of(const char *text) {
    size_t count = plot_letters(text);
    for (const char *c = text; *c; c++)
        count -= *c == '{' || *c == '}' || *c == '^';
    return count;
}

size_t plot_axis_letters(const axis *a) {
    size_t longest = 1;
    for (size_t i = 0; i < a->count; i++) {
        size_t letters = letters_of(a->tick[i].text);
        longest = letters > longest ? letters : longest;
    }
    return longest;
}

axis plot_axis_across(range shown, bool log, double letters, bool text) {
    axis a = {.count = 0};
    for (double each = 5; each < 20; each++) {
        a = plot_axis(shown, log, letters / (each + 2), text);
        if ((double)plot_axis_letters(&a) <= each)
            break;
    }
    return a;
}

/* Superscripts are letters, since labels are no more than texts. */
static char *power_text(int power, bool text) {
    static const char *const digit[] = {
        "\342\201\260", "\302\271",     "\302\262",     "\302\263",
        "\342\201\264", "\342\201\265", "\342\201\266", "\342\201\267",
        "\342\201\270", "\342\201\271"};
    char number[16], raised[64] = "";
    if (text)
        return text_print("1e%d", power);
    snprintf(number, sizeof number, "%d", power);
    for (const char *c = number; *c; c++)
        strcat(raised, *c == '-' ? "\342\201\273" : digit[*c - '0']);
    return text_print("10%s", raised);
}

/* "energy (J)" becomes "energy - 1.5 (10^-3 J)". */
char *plot_axis_label(const axis *a, const char *label, bool text) {
    if (!label || (a->power == 0 && a->base == 0))
        return label ? text_print("%s", label) : NULL;
    const char *unit = strrchr(label, '(');
    size_t length = strlen(label);
    bool has_unit =
        unit && unit > label && unit[-1] == ' ' && label[length - 1] == ')';
    char *power = a->power ? power_text(a->power, text) : text_print("%s", "");
    char *base = a->base != 0 ? text_print(" %c %.10g", a->base < 0 ? '+' : '-',
                                           fabs(a->base))
                              : text_print("%s", "");
    char *all;
    if (has_unit)
        all = text_print("%.*s%s (%s%s%s", (int)(unit - 1 - label), label, base,
                         power, a->power ? " " : "", unit + 1);
    else
        all = text_print(a->power ? "%s%s (%s)" : "%s%s%s", label, base, power);
    return all;
}

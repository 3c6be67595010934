/* nevh: order conditions of splittings.
   SPDX-License-Identifier: GPL-3.0-or-later

   Where T is quadratic in p, [B,[B,[B,A]]] = 0, and as far as degree 7 no other
   relation: BBBA = 3 BBAB - 3 BABB + ABBB.  BBBA does not overlap with itself,
   so words without it are independent, and every word is a sum of such. */
#include "kernels/order_private.h"
#include "system/print_private.h"
#include "system/system_private.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Times exp(w letter), up to a degree. */
static void multiply(long double series[], size_t degree, size_t letter,
                     long double w) {
    for (size_t word = ((size_t)2 << degree) - 1; word > 1; word--) {
        long double factor = 1, sum = series[word];
        size_t left = word;
        for (int j = 1; left > 1 && left % 2 == letter; j++) {
            left /= 2;
            factor *= w / j;
            sum += factor * series[left];
        }
        series[word] = sum;
    }
}

/* Words of `degree` letters, by those without BBBA. */
static void reduce(long double series[], size_t degree) {
    for (size_t word = ((size_t)2 << degree) - 1; word >> degree; word--)
        for (size_t i = 0; i + 4 <= degree; i++) {
            if ((word >> i & 15) != 14)
                continue;
            long double c = series[word];
            series[word] = 0;
            series[word - ((size_t)1 << i)] += 3 * c; /* BBAB */
            series[word - ((size_t)3 << i)] -= 3 * c; /* BABB */
            series[word - ((size_t)7 << i)] += c;     /* ABBB */
        }
}

/* True if a word comes before all its rotations. */
static bool is_lyndon(size_t word, size_t degree) {
    size_t mask = ((size_t)1 << degree) - 1, letters = word & mask;
    for (size_t i = 1; i < degree; i++)
        if (((letters << i | letters >> (degree - i)) & mask) <= letters)
            return false;
    return true;
}

/* Looks at the words of a degree, whose coefficients are less what is due. */
static void find_worst(const long double series[], size_t degree,
                       long double due, long double rounding,
                       nevh__conditions *to) {
    size_t worst = 0, first = 0;
    to->excess = 0;
    for (size_t word = (size_t)1 << degree; word >> degree == 1; word++) {
        double excess = (double)fabsl(series[word] / rounding);
        if (!first && excess > 1 && is_lyndon(word, degree))
            first = word;
        if (!worst || excess > to->excess) {
            worst = word;
            to->excess = excess;
        }
    }
    to->which = first ? first : worst;
    to->due = due;
    to->value = series[to->which] + due;
}

static void expand_step(const nevh__operations *x, size_t degree,
                        long double series[], long double size[2]) {
    series[1] = 1;
    for (size_t i = 0; i < x->count; i++) {
        bool kick = (x->first == NEVH_KICK) == (i % 2 == 0);
        multiply(series, degree, kick, x->weights[i]);
        size[kick] += fabsl(x->weights[i]);
    }
}

bool nevh__words_check(const nevh__operations *x, bool quadratic, size_t degree,
                       double digits, nevh__conditions found[]) {
    long double *series = nevh__array((size_t)2 << degree, sizeof *series);
    long double size[2] = {0, 0}, due = 1, rounding = digits;
    if (!series)
        return false;
    expand_step(x, degree, series, size);
    for (size_t k = 1; k <= degree; k++) {
        due /= (long double)k;
        rounding *= fmaxl(size[0], size[1]) / (k > 1 ? (long double)k - 1 : 1);
        for (size_t word = (size_t)1 << k; word >> k == 1; word++)
            series[word] -= due;
        if (quadratic)
            reduce(series, k);
        find_worst(series, k, due, rounding, &found[k]);
    }
    free(series);
    return true;
}

/* "drift drift kick". */
static void list_letters(size_t word, size_t degree, char text[], size_t size) {
    size_t used = 0;
    *text = '\0';
    for (size_t i = degree; i-- > 0 && used < size;)
        used += (size_t)snprintf(text + used, size - used, "%s%s",
                                 i + 1 < degree ? " " : "",
                                 word >> i & 1 ? "kick" : "drift");
}

static size_t degree_of(size_t word) {
    size_t degree = 0;
    while (word >> degree > 1)
        degree++;
    return degree;
}

void nevh__word_text(size_t word, nevh_operation first, nevh__conditions *x,
                     char text[], size_t size) {
    size_t degree = degree_of(word), m = degree - 1;
    long double times = 1;
    char letters[60];
    for (size_t i = 2; i <= m; i++)
        times *= (long double)i;
    bool drifts = word == ((size_t)2 << m | 1); /* A ... A B */
    bool kicks = word == ((size_t)3 << m) - 1;  /* A B ... B */
    if (degree == 2)
        snprintf(text, size, "sum of kick_i * drift_j (j %s i)",
                 first == NEVH_DRIFT ? "<=" : "<");
    else if (drifts)
        snprintf(text, size,
                 "sum of kick_i * c_i^%zu (c_i: the drifts before kick i)", m);
    else if (kicks)
        snprintf(text, size,
                 "sum of drift_i * k_i^%zu (k_i: the kicks after drift i)", m);
    else {
        list_letters(word, degree, letters, sizeof letters);
        snprintf(text, size, "coefficient of %s in the product of exponentials",
                 letters);
        times = 1;
    }
    x->value *= times;
    x->due *= times;
}

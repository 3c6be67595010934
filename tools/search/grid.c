/* nevh: step sizes to choose from, and what errors over them tell.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "study.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int floor_of(int k, int count) {
    return k >= 0 ? k / count : -((-k + count - 1) / count);
}

/* Short decimals, so that a dt can be typed again: whole numbers of thousandths,
   and one division or product. */
static double shortened(const double thousandths[], int count, int k) {
    int decade = floor_of(k, count), power = -decade - 3;
    double digit = thousandths[k - decade * count];
    return power < 0 ? digit / pow(10, -power) : digit * pow(10, power);
}

double grid_dt(double unit, int k) {
    /* Each fourth is Renard's, but for 3.2 and 6.4, so that most are doubled
       in GRID_STRIDE. */
    static const double digits[] = {
        1000, 950, 900, 850, 800, 760, 720, 680, 640, 600, 560, 530, 500, 475,
        450,  420, 400, 380, 360, 340, 320, 300, 280, 265, 250, 240, 225, 210,
        200,  190, 180, 170, 160, 150, 140, 132, 125, 118, 112, 106};
    char text[32];
    snprintf(text, sizeof text, "%.6g", unit * shortened(digits, 40, k));
    return strtod(text, NULL);
}

double grid_tolerance(int k) {
    static const double digits[] = {1000, 850, 700, 600, 500, 400,
                                    320,  250, 200, 170, 140, 120};
    return shortened(digits, 12, k);
}

double grid_between(const double dt[2], const double error[2], double target) {
    double slope = log(error[1] / error[0]) / log(dt[1] / dt[0]);
    return dt[0] * exp(log(target / error[0]) / slope);
}

double grid_digit_factor(const double error[], const double work[],
                         size_t count) {
    double n = (double)count, x = 0, y = 0, xx = 0, xy = 0;
    for (size_t i = 0; i < count; i++) {
        double digits = -log10(error[i]), cost = log10(work[i]);
        x += digits, y += cost, xx += digits * digits, xy += digits * cost;
    }
    double spread = n * xx - x * x;
    return spread > 1e-6 ? pow(10, (n * xy - x * y) / spread) : NAN;
}

size_t grid_cheapest(const double error[], const double work[], size_t count,
                     double target) {
    size_t best = count;
    for (size_t i = 0; i < count; i++)
        if (error[i] <= target && (best == count || work[i] < work[best]))
            best = i;
    return best;
}

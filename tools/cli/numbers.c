/* nevh: numbers in order, and time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

int numbers_compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void numbers_sort(double numbers[], size_t count) {
    qsort(numbers, count, sizeof *numbers, numbers_compare);
}

double numbers_median(double numbers[], size_t count) {
    numbers_sort(numbers, count);
    return count ? numbers[count / 2] : 0;
}

const char *number_text(char text[NUMBER_SIZE], double number) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, NUMBER_SIZE, "%.*g", digits, number);
        if (strtod(text, NULL) == number)
            break;
    }
    return text;
}

static double seconds_by(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The clock of the process counts in ticks under a limit of CPU time. */
double cpu_seconds(void) {
    return seconds_by(CLOCK_THREAD_CPUTIME_ID);
}

double wall_seconds(void) {
    return seconds_by(CLOCK_MONOTONIC);
}

/* FNV-1a, 64 bits [G. Fowler, L. C. Noll, K.-P. Vo; draft-eastlake-fnv]: a
   change of one byte always shows. */
uint64_t digest_begin(void) {
    return 0xCBF29CE484222325u;
}

uint64_t digest_add(uint64_t digest, const void *bytes, size_t count) {
    const unsigned char *at = bytes;
    while (count--)
        digest = (digest ^ *at++) * 0x100000001B3u;
    return digest;
}

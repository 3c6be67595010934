/* nevh: without libquadmath there are no digits that are certain.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/certain_private.h"
#include <float.h>
#include <stdio.h>
#include <stdlib.h>

#ifndef NEVH_QUADMATH
enum { ROOM = 60 };

struct nevh_certain {
    nevh__report report;
};

nevh_certain *nevh__certain_from(const nevh__certain_start *from,
                                 const nevh__certain_start *other, int digits) {
    nevh_certain *c = from->system ? nevh__array(1, sizeof *c) : NULL;
    (void)other, (void)digits;
    if (c)
        nevh__fail(&c->report, NEVH_ESTRUCT,
                   "this nevh was built without libquadmath, which comes with "
                   "GCC, and has no digits beyond those of doubles");
    return c;
}

nevh_certain *nevh_certain_new(const nevh_system *system, double t0,
                               const double q[], const double p[], int digits) {
    (void)t0, (void)q, (void)p;
    nevh__certain_start from = {.system = system};
    return nevh__certain_from(&from, &from, digits);
}

void nevh_certain_free(nevh_certain *c) {
    free(c);
}

void nevh_certain_stop_at(nevh_certain *c,
                          const volatile sig_atomic_t *ending) {
    (void)c, (void)ending;
}

int nevh_certain_go_to(nevh_certain *c, double time, long double rest) {
    (void)time, (void)rest;
    return nevh_certain_status(c);
}

size_t nevh_certain_series(const nevh_certain *c) {
    (void)c;
    return 0;
}

double nevh_certain_value(const nevh_certain *c, size_t k) {
    (void)c, (void)k;
    return NAN;
}

double nevh_certain_error(const nevh_certain *c, size_t k) {
    (void)c, (void)k;
    return NAN;
}

double nevh_certain_size(const nevh_certain *c, size_t k) {
    (void)c, (void)k;
    return NAN;
}

int nevh_certain_digits(const nevh_certain *c, size_t k) {
    (void)c, (void)k;
    return 0;
}

char *nevh_certain_text(const nevh_certain *c, size_t k) {
    (void)c, (void)k;
    return NULL;
}

char *nevh_certain_number(double number, long double rest) {
    char *text = nevh__array(ROOM, 1);
    if (text)
        snprintf(text, ROOM, "%.*Lg", LDBL_DIG, (long double)number + rest);
    return text;
}

NEVH__REPORTS(certain)

int nevh_certain_go(nevh_certain *c, double t) {
    return nevh_certain_go_to(c, t, 0);
}
#endif

/* nevh: poles between two states: by interval arithmetic over parts of the line
   between them, which are halved while a divisor may be zero.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/passage_private.h"
#include <stdlib.h>
#include <string.h>

enum { MOST_LOOKS = 256, MOST_PARTS = 2000 };
static const double shortest = 0x1p-45; /* of the line */

bool nevh__passage_init(nevh__passage *s, const nevh_system *system) {
    *s = (nevh__passage){.system = system};
    s->before = nevh__array(4 * system->n + 2, sizeof *s->before);
    s->now = s->before ? s->before + 2 * system->n + 1 : NULL;
    if (s->before)
        nevh__time_parts_init_between(&s->parts, system, s->before, s->now);
    return s->before;
}

void nevh__passage_clear(nevh__passage *s) {
    nevh__time_parts_clear(&s->parts);
    free(s->before);
}

static void passage_put(const nevh__passage *s, double to[], double t,
                        const double q[], const double p[]) {
    size_t n = s->system->n;
    memcpy(to, q, n * sizeof *q);
    memcpy(to + n, p, n * sizeof *p);
    to[2 * n] = t;
}

void nevh__passage_keep(nevh__passage *s, double t, const double q[],
                        const double p[]) {
    passage_put(s, s->before, t, q, p);
}

/* The first part that may have a pole; SIZE_MAX: none. */
static size_t find_pole(nevh__passage *s, double low, double high) {
    nevh__time_parts_over(&s->parts, low, high);
    for (size_t i = 0; i < s->parts.nodes; i++)
        if (s->parts.range[i].broken & NEVH__POLE)
            return i;
    return SIZE_MAX;
}

static bool has_pole(nevh__passage *s, double low, double high, int *left) {
    size_t part = --*left > 0 ? find_pole(s, low, high) : SIZE_MAX;
    double middle = low + (high - low) / 2;
    if (part == SIZE_MAX)
        return false;
    if (high - low > shortest)
        return has_pole(s, low, middle, left) ||
               has_pole(s, middle, high, left);
    s->effect = s->parts.part[part].effect;
    return true;
}

void nevh__passage_look(nevh__passage *s, double t, const double q[],
                        const double p[]) {
    int left = MOST_PARTS;
    if (s->found || s->looks++ >= MOST_LOOKS)
        return;
    passage_put(s, s->now, t, q, p);
    if (!s->parts.failed && has_pole(s, 0, 1, &left)) {
        s->found = true;
        s->at = t;
    }
}

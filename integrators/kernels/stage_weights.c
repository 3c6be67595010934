/* nevh: a tableau and its weights in a step, as sweeps over stages take them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "stage_sweeps_private.h"
#include "system/system_private.h"
#include <stdlib.h>

static void pad(const nevh__stage_weights *w, size_t rows, const double from[],
                double to[]) {
    for (size_t i = 0; i < rows * w->row; i++) {
        size_t stage = i % w->row;
        to[i] = from[i / w->row * w->stages + (stage < w->stages) * stage];
    }
}

static void lay_out_weights(nevh__arena *a, void *weights) {
    nevh__stage_weights *w = weights;
    size_t matrix = w->stages * w->row, each = sizeof(double);
    w->mu_q = nevh__arena_take(a, matrix, each);
    w->mu_p = nevh__arena_take(a, matrix, each);
    w->guess = nevh__arena_take(a, matrix, each);
    w->long_guess = nevh__arena_take(a, w->steps * matrix, each);
    w->c = nevh__arena_take(a, w->row, each);
    w->hb = nevh__arena_take(a, w->stages, each);
    w->to_q = nevh__arena_take(a, w->stages * NEVH__LANES, each);
    w->to_p = nevh__arena_take(a, w->stages * NEVH__LANES, each);
}

nevh__stage_weights *nevh__stage_weights_new(const nevh__tableau *a) {
    nevh__stage_weights *w = nevh__array(1, sizeof *w);
    if (!w)
        return NULL;
    w->stages = a->stages;
    w->row = nevh__padded(a->stages);
    w->steps = a->steps;
    w->memory = nevh__arena_new(lay_out_weights, w);
    if (!w->memory) {
        free(w);
        return NULL;
    }
    nevh__stage_weights_take(w, a);
    return w;
}

void nevh__stage_weights_free(nevh__stage_weights *w) {
    if (w)
        free(w->memory);
    free(w);
}

void nevh__stage_weights_take(nevh__stage_weights *w, const nevh__tableau *a) {
    pad(w, w->stages, a->mu_q, w->mu_q);
    pad(w, w->stages, a->mu_p, w->mu_p);
    pad(w, w->stages, a->guess, w->guess);
    pad(w, w->steps * w->stages, a->long_guess, w->long_guess);
    pad(w, 1, a->c, w->c);
}

/* nevh cost: time for one more digit, price of gradients, and words.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cost_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

void cost_notes(const costs *c, list *notes) {
    const plan *p = &c->search.plan;
    const char *unit = nevh_scene_label(p->scene, "t");
    list_print(notes,
               "cost: the largest %s error over the run; CPU ms (dt%s%s); * "
               "cheapest",
               c->search.by_state ? "state" : "energy", *unit ? " in " : "",
               unit);
}

void cost_words(costs *c, list *words) {
    (void)c;
    (void)words;
}

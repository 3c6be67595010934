/* nevh cost: what each gradient method costs, and where it ends.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cost_private.h"
#include <math.h>
#include <string.h>

/* The cheapest row with the most digits that are reached. */
static const row *most_digits(const costs *c, const study **l) {
    for (size_t k = COST_TARGETS; k-- > 0;) {
        *l = costs_cheapest(c, k, true);
        if (*l && !cost_is_beyond(c, k))
            return cost_cell(*l, k);
    }
    return NULL;
}

static char *price(const row *best, const row *r) {
    double factor = r->seconds / best->seconds;
    double error = study_error(r);
    if (!r->ran)
        return NULL;
    if (error > 3 * study_error(best))
        return text_print("%s x%.2g, but its error is %.1g", r->gradient,
                          factor, error);
    return text_print("%s x%.2g", r->gradient, factor);
}

/* One after the other, so that nothing but the gradient differs; nothing where there
   was no time for any other. */
void cost_price(costs *c, list *words) {
    const study *l;
    const row *best = most_digits(c, &l);
    if (!best)
        return;
    int k = l->k[best - l->level];
    char *text = text_print("%s 1", l->gradient);
    size_t others = 0;
    for (size_t i = 0; nevh_gradients()[i]; i++) {
        const char *name = nevh_gradient_name(nevh_gradients()[i]);
        study other = study_new(&c->search.plan, l->integrator, name);
        if (strcmp(name, l->gradient) != 0 &&
            !search_out_of_time(&c->search, 1) &&
            gradient_fits(&c->search.plan, name, NULL)) {
            study_run(&c->search, &other, k);
            study_time(&c->search, &other, 0);
            char *more = price(best, &other.level[0]);
            if (more)
                text_extend(&text, ", %s", more);
            others += more != NULL;
        }
    }
    if (others)
        list_print(words,
                   "price of the gradient (%s at dt = %.4g, error %.1g): %s",
                   l->integrator, best->dt, study_error(best), text);
}

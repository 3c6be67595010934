/* nevh: steppers that rows have used, for those that are planned alike: to plan
   one takes longer than many a row.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <stdlib.h>
#include <string.h>

enum { MOST = 256, MOST_DOF = 4096 };

typedef struct {
    const char *integrator, *gradient;
    double tolerance;
    bool balance;
    nevh_stepper *stepper; /* NULL: an empty place */
} place;

struct stepper_cache {
    place places[MOST];
};

stepper_cache *stepper_cache_new(void) {
    return tool_allocate(1, sizeof(stepper_cache));
}

void stepper_cache_free(stepper_cache *s) {
    for (size_t i = 0; s && i < MOST; i++)
        nevh_stepper_free(s->places[i].stepper);
    free(s);
}

static bool is_alike(const place *at, const row *r, bool balance) {
    return at->stepper && strcmp(at->integrator, r->integrator) == 0 &&
           strcmp(at->gradient, r->gradient) == 0 &&
           at->tolerance == r->tolerance && at->balance == balance;
}

static nevh_stepper *plan_new(const plan *p, const row *r, bool balance) {
    nevh_options o = plan_options(p, r->gradient);
    o.transform = plan_transform(p, r->integrator);
    o.tolerance = r->tolerance;
    o.balance = balance;
    /* No steps are foreseen: rows are compared in time, so that none is compiled
       unasked, as long as some schemes have no compiled steps. */
    nevh_stepper *s = nevh_stepper_new(p->system, r->scheme, &o);
    plan_tell_native(s);
    return s;
}

nevh_stepper *row_stepper(const plan *p, const row *r, bool balance) {
    for (size_t i = 0; i < MOST; i++) {
        place *at = &p->steppers->places[i];
        nevh_stepper *s = at->stepper;
        if (!is_alike(at, r, balance))
            continue;
        at->stepper = NULL;
        nevh_stepper_reset(s);
        return s;
    }
    return plan_new(p, r, balance);
}

/* Those that were refused, or failed, keep the message, and are not kept. */
void row_stepper_keep(const plan *p, const row *r, bool balance,
                      nevh_stepper *s) {
    size_t i = 0;
    while (i < MOST && p->steppers->places[i].stepper)
        i++;
    if (i < MOST && p->n <= MOST_DOF && !nevh_stepper_status(s))
        p->steppers->places[i] =
            (place){r->integrator, r->gradient, r->tolerance, balance, s};
    else
        nevh_stepper_free(s);
}

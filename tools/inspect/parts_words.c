/* nevh check: the parts that schemes by parts find, and how large B is.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "parts_words.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The largest forces on each coordinate, along an orbit. */
typedef struct {
    nevh_field *all;    /* gradients of H */
    nevh_stepper *slow; /* and of B */
    size_t n;
    double *whole, *part; /* at one state */
    double *most;         /* of A, and of B behind it */
    size_t states;
    bool bodies; /* some coordinates are those of one body */
} forces;

static int take_forces(void *data, size_t step, double t, const double q[],
                       const double p[]) {
    forces *f = data;
    (void)step;
    if (nevh_field_gradient(f->all, 1, &t, q, p, f->whole, NULL) ||
        nevh_stepper_kick(f->slow, t, q, p, f->part))
        return 1;
    f->states++;
    for (size_t k = 0; k < f->n; k++) {
        f->most[k] = fmax(f->most[k], fabs(f->whole[k] - f->part[k]));
        f->most[f->n + k] = fmax(f->most[f->n + k], fabs(f->part[k]));
    }
    return 0;
}

/* The largest force of A on a coordinate, or on others of its body. */
static double largest_of_a(const forces *f, size_t k) {
    double most = f->most[k];
    size_t body = nevh_stepper_body(f->slow, k);
    for (size_t j = 0; f->bodies && j < f->n; j++)
        if (nevh_stepper_body(f->slow, j) == body)
            most = fmax(most, f->most[j]);
    return most;
}

/* The largest force of B over that of A; infinite where A has none, or B is not finite
   at the start. */
static double ratio_along(const plan *p, nevh_stepper *s) {
    enum { STEPS = 1000 };
    nevh_options o = plan_options(p, p->gradients.item[0]);
    double *room = tool_allocate(6 * p->n, sizeof *room), worst;
    forces f = {.all = nevh_field_new(p->system, &o),
                .slow = s,
                .n = p->n,
                .whole = room,
                .part = room + p->n,
                .most = room + 2 * p->n,
                .bodies = nevh_stepper_hierarchy(s, NULL, 0, NULL) > 0};
    double *q = room + 4 * p->n, *momenta = q + p->n;
    for (size_t k = 0; k < p->n; k++) {
        q[k] = p->q[k];
        momenta[k] = p->p[k];
    }
    double h = p->dt[0], steps = fmin(STEPS, ceil((p->t_end - o.t) / h));
    nevh_observer watch = {take_forces, &f, 1};
    nevh_run(s, o.t, h, (size_t)fmax(1, steps), q, momenta, &watch, 1);
    worst = f.states ? 0 : INFINITY;
    for (size_t k = 0; k < p->n; k++)
        if (f.most[p->n + k] > 0)
            worst = fmax(worst, f.most[p->n + k] / largest_of_a(&f, k));
    nevh_field_free(f.all);
    return worst;
}

static void name_parts(const plan *p, list *fast, list *slow) {
    size_t count = nevh_system_effect_count(p->system);
    size_t *fast_of = tool_allocate(2 * count, sizeof *fast_of);
    size_t *slow_of = fast_of + count;
    nevh_system_effect_parts(p->system, fast_of, slow_of);
    for (size_t i = 0; i < count; i++) {
        const char *name = nevh_system_effect_name(p->system, i);
        size_t forms = fast_of[i], others = slow_of[i];
        if (forms)
            list_print(fast, others ? "%s (%zu of %zu terms)" : "%s", name,
                       forms, forms + others);
        if (others)
            list_print(slow, forms ? "%s (the others)" : "%s", name);
    }
}

static void size_words(const plan *p, double ratio, bool bodies, list *notes) {
    bool empty = plan_parts_are_all(p);
    if (empty && bodies)
        ratio = 0; /* but for rounding */
    if (ratio == 0 && empty && p->friction)
        list_add(notes, "  B is 0, but there is friction: order 2");
    else if (ratio == 0)
        list_add(notes, empty ? "  B is 0: steps of any length are exact"
                              : "  forces of B are 0 at all states that were "
                                "tried on the orbit");
    else
        list_print(notes,
                   "  forces of B are at most %.2g of those of A on the same "
                   "%s%s",
                   ratio, bodies ? "body" : "coordinate",
                   ratio < 0.3 ? "" : ": the parts do not help much here");
}

static void all_words(const plan *p, const nevh_stepper *s, double ratio,
                      list *notes) {
    enum { MOST = 1000 };
    char bodies[MOST];
    list fast = {0}, slow = {0};
    size_t pairs = nevh_stepper_hierarchy(s, bodies, sizeof bodies, NULL);
    name_parts(p, &fast, &slow);
    char *b = list_joined(&slow);
    list_print(notes,
               "Parts of H = A + B for schemes by parts: A, whose flow is "
               "exact: %s; B, which kicks: %s",
               list_joined(&fast), *b ? b : "nothing");
    if (pairs)
        list_print(
            notes,
            "A moves bodies about one another, too, in Jacobi "
            "coordinates: %s%s; B has what their forces differ from that",
            bodies, strlen(bodies) + 1 < MOST ? "" : " ...");
    size_words(p, ratio, pairs > 0, notes);
}

static void attraction_words(const nevh_stepper *s, list *notes) {
    enum { MOST = 200 };
    char why[MOST];
    if (!nevh_stepper_hierarchy(s, why, sizeof why, NULL) && *why)
        list_print(
            notes,
            "Schemes by parts leave attractions of bodies to B, since %s", why);
}

/* Nothing where A has no force: there are other splittings for T(p) + V(q). */
void parts_words(const plan *p, list *notes) {
    nevh_options o = plan_options(p, p->gradients.item[0]);
    nevh_stepper *s = nevh_stepper_new(p->system, nevh_aba864, &o);
    double ratio = nevh_stepper_status(s) ? INFINITY : ratio_along(p, s);
    if (isfinite(ratio))
        all_words(p, s, ratio, notes);
    attraction_words(s, notes);
    nevh_stepper_free(s);
}

/* What a gradient costs, and how good it is: each method on four systems.
   Errors are relative to the largest component, against the exact gradient.
   Look at the price of a digit: two orders more cost one more pair of values a
   variable; at side by side, where SIMD earns the differences back; and at the
   chain, whose cost a mass does not grow, because a spring reads two masses.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient_systems.h"
#include <stdio.h>

typedef struct {
    const char *name;
    nevh_system *(*system)(void); /* NULL: a chain of n masses */
    size_t n, width;
    double q[2], p[2], spread;
} problem;

static gradient_states states_of(const problem *x, size_t width) {
    const double *q = x->system ? x->q : NULL, *p = x->system ? x->p : NULL;
    return gradient_states_new(x->n, width, q, p, x->spread);
}

static nevh_field *field_of(const problem *x, const nevh_system *system,
                            const nevh_gradient *method,
                            const gradient_states *s) {
    nevh_options options = {
        .gradient = method, .q = s->q, .p = s->p, .width = x->width};
    return nevh_field_new(system, &options);
}

/* What errors are measured against. */
static int yardstick(const problem *x, gradient_states *exact) {
    nevh_system *system = x->system ? x->system() : chain_system(x->n);
    *exact = states_of(x, x->width);
    int status = exact->t ? NEVH_OK : NEVH_ENOMEM;
    nevh_field *field = status ? NULL : field_of(x, system, nevh_exact, exact);
    if (!status)
        status = gradient_states_evaluate(field, exact);
    nevh_field_free(field);
    nevh_system_free(system);
    return status;
}

/* Error; ns a gradient, or a mass; the same with orbits side by side. */
static int cell(const problem *x, const nevh_gradient *method,
                const gradient_states *exact) {
    nevh_system *system = x->system ? x->system() : chain_system(x->n);
    gradient_states one = states_of(x, 1), s = states_of(x, x->width);
    nevh_field *field = field_of(x, system, method, &s);
    int status = one.t && s.t ? NEVH_OK : NEVH_ENOMEM;
    if (!status)
        status = gradient_states_evaluate(field, &s);
    if (status)
        fprintf(stderr, "%s: %s\n", x->name, nevh_field_message(field));
    else
        printf("%9.1e%7.0f", gradient_states_error(&s, exact),
               gradient_states_time(field, &one) /
                   (x->system ? 1 : (double)x->n));
    if (!status && x->width > 1)
        printf("%5.0f", gradient_states_time(field, &s) / (double)x->width);
    nevh_field_free(field);
    gradient_states_free(&one);
    gradient_states_free(&s);
    nevh_system_free(system);
    return status;
}

static int table(const problem *problems, const char *title) {
    gradient_states exact[3];
    int status = NEVH_OK;
    for (int i = 0; i < 3; i++)
        status |= yardstick(&problems[i], &exact[i]);
    printf("\n%s\n              ", title);
    for (int i = 0; i < 3; i++)
        printf("%s", problems[i].name);
    for (const nevh_gradient *const *m = nevh_gradients(); !status && *m; m++) {
        printf("\n %-13s", nevh_gradient_name(*m));
        for (int i = 0; i < 3; i++)
            status |= cell(&problems[i], *m, &exact[i]);
    }
    puts("");
    for (int i = 0; i < 3; i++)
        gradient_states_free(&exact[i]);
    return status;
}

int main(void) {
    const problem small[] = {
        {"              pendulum", pendulum_system, 1, 64, {1}, {0.5}, 0.5},
        {"       double pendulum",
         double_pendulum_system,
         2,
         64,
         {1, -1},
         {2, 1},
         0.5},
        {"                Kepler", kepler_system, 2, 64, {1}, {0, 1}, 0.3},
    };
    const problem chains[] = {
        {.name = "        N = 10", .n = 10, .width = 1, .spread = 0.5},
        {.name = "          1000", .n = 1000, .width = 1, .spread = 0.5},
        {.name = "        100000", .n = 100000, .width = 1, .spread = 0.5},
    };
    int status = table(
        small, "Error, ns a gradient, and ns with 64 orbits side by side");
    status |= table(chains, "Chain of N masses and springs: error, ns a mass");
    return status != NEVH_OK;
}

/* nevh: the rows of a plan: each gradient, dt, integrator and tolerance.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>

static void add_row(const plan *p, row_list *r, size_t gradient,
                    const char *name, double dt, double tolerance) {
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(p, name, &transformed);
    bool same = r->count &&
                r->row[r->count - 1].gradient == p->gradients.item[gradient] &&
                r->row[r->count - 1].dt == dt &&
                (r->row[r->count - 1].tolerance > 0) == (tolerance > 0);
    size_t group = r->count ? r->row[r->count - 1].group + !same : 0;
    r->row[r->count++] = (row){.integrator = name,
                               .gradient = p->gradients.item[gradient],
                               .scheme = scheme,
                               .dt = dt,
                               .tolerance = tolerance,
                               .group = group};
}

static bool adapts(const plan *p, const char *name) {
    bool transformed;
    return nevh_integrator_adaptive(plan_scheme(p, name, &transformed));
}

/* Adaptive schemes land on the ends of the longest dt. */
static void add_adaptive(const plan *p, row_list *r, size_t gradient) {
    double longest = plan_longest_dt(p);
    for (size_t i = 0; i < p->integrators.count; i++)
        for (size_t k = 0; k < p->tolerances; k++)
            if (adapts(p, p->integrators.item[i]))
                add_row(p, r, gradient, p->integrators.item[i], longest,
                        p->tolerance[k]);
}

row_list rows_of(const plan *p) {
    size_t most =
        p->gradients.count * p->integrators.count * (p->dts + p->tolerances);
    row_list r = {tool_allocate(most, sizeof *r.row), 0};
    for (size_t g = 0; g < p->gradients.count; g++) {
        for (size_t j = 0; j < p->dts; j++)
            for (size_t i = 0; i < p->integrators.count; i++)
                if (!adapts(p, p->integrators.item[i]))
                    add_row(p, &r, g, p->integrators.item[i], p->dt[j], 0);
        add_adaptive(p, &r, g);
    }
    return r;
}

/* nevh: how large are the energies of an orbit?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/energy_private.h"
#include "gradient/field_private.h"
#include <math.h>
#include <stdlib.h>

/* The last energy over the mean: of growth that has no end, no energy is typical. */
static const double growing = 8;

typedef struct {
    nevh_field *values;
    double *effects, sum, time, last;
} mean;

/* The largest effect, over the time of the step. */
static void add_largest(void *context, double t, double h, const double y[]) {
    mean *m = context;
    nevh_field *f = m->values;
    double most = 0;
    if (nevh__field_moving_effects(f, t, y, y + f->n, m->effects))
        return;
    for (size_t i = 0; i < f->system->n_effects; i++)
        most = fmax(most, fabs(m->effects[i]));
    m->sum += h * most;
    m->time += h;
    m->last = most;
}

double nevh__orbit_energy(nevh_field *values, double t, const double q[],
                          const double p[]) {
    size_t n = values->n;
    nevh_options o = {.gradient = nevh__best_gradient(values->system),
                      .t = t,
                      .q = q,
                      .p = p,
                      .portable = values->portable};
    mean m = {.values = values};
    double *sizes = nevh__array(2 * n, sizeof *sizes);
    bool differences = o.gradient != nevh_exact;
    nevh_field *own = differences ? nevh_field_new(values->system, &o) : NULL;
    m.effects = nevh__array(values->system->n_effects, sizeof *m.effects);
    bool fine = sizes && m.effects &&
                (!differences || (own && !nevh_field_status(own)));
    if (fine && !nevh__follow_orbit(differences ? own : values, t, q, p, sizes,
                                    add_largest, &m))
        m.time = 0;
    nevh_field_free(own);
    free(m.effects);
    free(sizes);
    values->report = (nevh__report){0}; /* where values are not finite */
    double energy = m.time > 0 ? m.sum / m.time : 0;
    return isfinite(energy) && m.last <= growing * energy ? energy : 0;
}

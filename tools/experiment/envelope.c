/* nevh: a long series in few points.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "envelope.h"
#include <math.h>

envelope *envelope_new(double begin, double end) {
    envelope *e = tool_allocate(1, sizeof *e);
    e->begin = begin;
    e->end = end;
    for (size_t i = 0; i < ENVELOPE_PARTS; i++)
        e->part[i].value = -1;
    return e;
}

static void add(envelope *e, double t, double value) {
    double place = (t - e->begin) / (e->end - e->begin) * ENVELOPE_PARTS;
    size_t i = (size_t)fmin(fmax(place, 0), ENVELOPE_PARTS - 1);
    if (fabs(value) > e->part[i].value) {
        e->part[i].value = fabs(value);
        e->part[i].t = t;
    }
}

int energy_trace_observe(void *data, size_t step, double t, const double q[],
                         const double p[]) {
    energy_trace *trace = data;
    (void)step, (void)q, (void)p;
    add(trace->envelope, t, nevh_energy_error(trace->energy, 0));
    return NEVH_OK;
}

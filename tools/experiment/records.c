/* nevh: rows as records: the columns of CSV and JSON.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>

static double when(bool condition, double value) {
    return condition ? value : NAN;
}

static void add_record(table *t, const plan *p, const row *r) {
    const nevh_energy_report *e = &r->energy;
    table_text(t, p->name);
    table_text(t, r->integrator);
    table_number(t, r->order);
    table_text(t, nevh_claim_name(nevh_integrator_symplectic(r->scheme)));
    table_text(t, r->gradient);
    table_number(t, r->dt);
    table_number(t, when(r->ran, (double)r->steps));
    table_text(t, r->status);
    table_number(t, when(r->ran, e->max));
    table_number(t, when(r->ran, e->rms));
    table_number(t, when(r->ran, e->final));
    table_number(t, when(r->ran, e->drift));
    table_number(t, when(r->ran, r->state_error));
    table_number(t, when(r->ran, round(r->counts.hamiltonians)));
    table_number(t, when(r->ran, (double)r->counts.gradients));
    table_number(t, when(r->ran, (double)r->counts.sweeps));
    table_number(t, when(r->ran, r->seconds));
    table_text(t, r->ran ? nevh_verdict_name(e->verdict) : NULL);
    table_number(t, r->observed_order);
    table_number(t, when(r->ran, r->spread));
    diagnostics_record(t, p, r);
    if (p->observable)
        table_number(t, when(r->ran, r->observable_error));
    if (p->error_bounds)
        table_number(t, r->error_bound ? r->error_bound->until : NAN);
    energies_put(t, p, r, false);
    table_text(t, r->native ? "yes" : "no");
    if (p->diagnostics)
        table_number(t, shadow_error(r));
    table_number(t, when(r->tolerance > 0, r->tolerance));
}

table *records(const plan *p, const row rows[], size_t count) {
    table *t = table_new();
    table_titles(t, RECORD_COLUMNS);
    diagnostics_columns(t, p, false);
    if (p->observable)
        table_column(t, "observable_error");
    if (p->error_bounds)
        table_column(t, "holds_until");
    energies_columns(t, p, false);
    table_column(t, "native");
    if (p->diagnostics)
        table_column(t, "shadow_error");
    table_column(t, "tolerance");
    for (size_t i = 0; i < count; i++)
        add_record(t, p, &rows[i]);
    return t;
}

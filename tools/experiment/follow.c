/* nevh: rows whose verdict their run leaves open, followed further.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>

bool row_drifts(const row *r) {
    return r->energy.verdict == NEVH_DRIFTS ||
           (r->energy.verdict == NEVH_UNDECIDED &&
            r->energy.theory == NEVH_THEORY_LOSES &&
            !nevh_energy_passes_over(&r->energy));
}

void row_follow(const plan *p, row *r) {
    nevh_verdict own = r->energy.verdict;
    if (!r->ran || (own != NEVH_UNDECIDED && own != NEVH_BOUNDED) ||
        isfinite(r->stopped) || nevh_energy_passes_over(&r->energy))
        return;
    if (p->jumps && !nevh_timing_whole(p->jumps)) { /* known no further */
        if (!nevh_timing_whole(p->timing))
            r->energy.verdict = NEVH_UNDECIDED;
        return;
    }
    nevh_stepper *s = row_stepper(p, r, p->balance);
    nevh_energy *energy = row_energy(p, r, s);
    stop reached = {.scene = p->scene};
    nevh_observer stops = {stop_observe, &reached, 1};
    nevh_judged_run judged = {
        .t = p->run->t_start,
        .h = r->step,
        .t_end = r->t_end,
        .q = p->q,
        .p = p->p,
        .stop = &stops,
        .stops = nevh_scene_stops(p->scene),
        .seconds = nevh_counts_seconds(&r->counts, p->n, r->scheme, r->order,
                                       r->steps),
        .allowed = p->follow,
        .regular = p->n == 1 && !p->time && !p->friction,
    };
    nevh_energy_report longer = r->energy;
    if (nevh_verdict_settle(s, energy, &judged, &longer))
        tool_owned(NULL);
    r->energy.verdict = longer.verdict;
    r->open = own == NEVH_UNDECIDED;
    if (longer.span > r->energy.span) {
        r->followed = longer.span / (judged.t_end - judged.t);
        r->longer = longer;
    }
    nevh_energy_free(energy);
    row_stepper_keep(p, r, p->balance, s);
}

/* nevh: lanes whose orbits belong to systems of their own.

   The systems have the same terms but for constants.  The stepper of all lanes
   takes those of each; what a lane does alone is done by a stepper of its own
   system, which also says what steps its differences have.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"
#include "gradient/field_private.h"

/* Kernels whose plan holds nothing that constants of H change, where steps are
   fixed. */
static bool plans_nothing(const nevh_stepper *s) {
    const nevh_kernel *kernel = s->work.integrator->kernel;
    if (s->options.tolerance > 0 || s->work.accounts)
        return false;
    return kernel == &nevh_splitting_kernel ||
           kernel == &nevh_runge_kutta_kernel;
}

bool nevh__ensemble_may_vary(const nevh_ensemble *e) {
    return e && e->planned && !e->alone && !e->moving && !e->n_crossings &&
           !e->chaotic && plans_nothing(e->stepper);
}

bool nevh__ensemble_vary(nevh_ensemble *e, nevh__own_fn own,
                         nevh__refused_fn refused) {
    if (!nevh__ensemble_may_vary(e) ||
        e->stepper->work.field->lanes != e->width)
        return false;
    e->own = own;
    e->refused = refused;
    return true;
}

void nevh__own_drop(nevh_ensemble *e, size_t lane) {
    nevh_stepper_free(e->lanes[lane].narrow);
    e->lanes[lane].narrow = NULL;
    e->narrow = e->spare;
}

/* The lane's constants, in all that reads them. */
static bool take(nevh_ensemble *e, size_t lane, const nevh__own *own,
                 const nevh_stepper *narrow) {
    nevh_field *f = e->stepper->work.field;
    if (narrow->rows != e->stepper->rows ||
        !nevh__field_lane_take(f, lane, own->constants, narrow->work.field))
        return false;
    if (e->energy)
        nevh__energy_lane_take(e->energy, lane, own->constants, narrow);
    return true;
}

bool nevh__own_take(nevh_ensemble *e, size_t lane, uint64_t member) {
    const nevh__own *own = e->own(e->data, member);
    nevh_stepper *narrow = NULL;
    nevh__report before = e->report;
    bool made = own && !nevh__ensemble_stepper(e, own->system, own->options, 1,
                                               &narrow);
    e->report = before;
    if (!made || !take(e, lane, own, narrow)) {
        nevh_stepper_free(narrow);
        return false;
    }
    e->lanes[lane].narrow = narrow;
    return true;
}

void nevh__own_copy(nevh_ensemble *e, size_t from, size_t to) {
    nevh__field_lane_copy(e->stepper->work.field, from, to);
    if (e->energy)
        nevh__energy_lane_copy(e->energy, from, to);
}

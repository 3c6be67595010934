/* nevh: lanes whose orbits belong to systems of their own.

   The systems have the same terms but for constants.  The stepper of all lanes
   takes those of each; what a lane does alone is done by a stepper of its own
   system, which also says what steps its differences have.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"
#include "gradient/field_private.h"
#include "kernels/runge_kutta_private.h"
#include "kernels/tableau_private.h"
#include "native/native_private.h"

/* Kernels whose plans hold nothing that constants of H change but scales, or
   take it from the plan of a stepper of their own. */
static const struct {
    const nevh_kernel *kernel;
    bool (*take)(nevh_work *, size_t lane, const nevh_work *own);
    void (*copy)(nevh_work *, size_t from, size_t to);
} kernels[] = {
    {&nevh_splitting_kernel, NULL, NULL},
    {&nevh_runge_kutta_kernel, NULL, NULL},
    {&nevh_nystrom_kernel, nevh__nystrom_lane_take, nevh__nystrom_lane_copy},
    {&nevh_gauss_kernel, NULL, NULL},
    {&nevh_lobatto_kernel, NULL, NULL},
    {&nevh_implicit_euler_kernel, NULL, NULL},
    {&nevh__implicit_kernel, NULL, NULL}};
enum { KERNELS = sizeof kernels / sizeof *kernels };

static size_t kernel_of(const nevh_stepper *s) {
    size_t i = 0;
    while (i < KERNELS && kernels[i].kernel != s->work.integrator->kernel)
        i++;
    return i;
}

bool nevh__ensemble_may_vary(const nevh_ensemble *e) {
    return e && e->planned && !e->alone && !e->moving && !e->n_crossings &&
           !e->chaotic && !e->stepper->work.accounts &&
           kernel_of(e->stepper) < KERNELS;
}

bool nevh__ensemble_may_vary_compiled(const nevh_ensemble *e) {
    return nevh__ensemble_may_vary(e) &&
           nevh__native_by_lane(&e->stepper->work);
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
static bool own_take(nevh_ensemble *e, size_t lane, const nevh__own *own,
                     const nevh_stepper *narrow) {
    nevh_work *w = &e->stepper->work;
    size_t kernel = kernel_of(e->stepper);
    if (narrow->rows != e->stepper->rows ||
        (kernels[kernel].take &&
         !kernels[kernel].take(w, lane, &narrow->work)) ||
        !nevh__field_lane_take(w->field, lane, own->constants,
                               narrow->work.field))
        return false;
    nevh__native_lane_take(w, lane);
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
    if (!made || !own_take(e, lane, own, narrow)) {
        nevh_stepper_free(narrow);
        return false;
    }
    e->lanes[lane].narrow = narrow;
    return true;
}

void nevh__own_copy(nevh_ensemble *e, size_t from, size_t to) {
    nevh_work *w = &e->stepper->work;
    size_t kernel = kernel_of(e->stepper);
    nevh__field_lane_copy(w->field, from, to);
    if (kernels[kernel].copy)
        kernels[kernel].copy(w, from, to);
    nevh__native_lane_take(w, to);
    if (e->energy)
        nevh__energy_lane_copy(e->energy, from, to);
}

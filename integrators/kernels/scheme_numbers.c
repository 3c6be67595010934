/* nevh: the table of a scheme of a family in long double.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/splitting_private.h"
#include "kernels/tableau_private.h"
#include "kernels/scheme_table_private.h"
#include "system/system_private.h"
#include <stdlib.h>

void nevh__numbers_free(nevh__numbers *x) {
    free(x->weights);
    free(x->a);
    free(x->b);
    *x = (nevh__numbers){0};
}

static int take_splitting(const nevh_splitting *table, nevh__numbers *to) {
    to->first = table->first;
    to->operations = nevh__splitting_operations(table);
    to->weights = nevh__array(to->operations, sizeof *to->weights);
    if (!to->weights)
        return NEVH_ENOMEM;
    nevh__splitting_expand_wide(table, to->weights);
    return NEVH_OK;
}

static bool make_room(nevh__numbers *to, size_t stages) {
    to->stages = stages;
    to->a = nevh__array(stages * stages, sizeof *to->a);
    to->b = nevh__array(stages, sizeof *to->b);
    return to->a && to->b;
}

static int take_butcher(const nevh_butcher *table, nevh__numbers *to) {
    size_t s = table->stages;
    if (!make_room(to, s))
        return NEVH_ENOMEM;
    for (size_t i = 0; i < s; i++) {
        to->b[i] = table->b[i];
        for (size_t j = 0; j < i; j++)
            to->a[i * s + j] = table->a[i * s + j];
    }
    return NEVH_OK;
}

/* Columns become rows. */
static int take_tableau(const nevh_integrator *scheme, nevh__numbers *to) {
    nevh__tableau *table = nevh__stage_tableau_new(scheme);
    size_t s = table ? table->stages : 0;
    bool room = table && make_room(to, s);
    for (size_t i = 0; room && i < s; i++) {
        to->b[i] = table->b[i];
        for (size_t j = 0; j < s; j++)
            to->a[i * s + j] = table->a_q[j * s + i];
    }
    nevh__tableau_free(table);
    return room ? NEVH_OK : NEVH_ENOMEM;
}

int nevh__numbers_of(const nevh_integrator *scheme, nevh__numbers *to) {
    *to = (nevh__numbers){0};
    const nevh_kernel *kernel = scheme->kernel;
    if (kernel == &nevh_splitting_kernel)
        return take_splitting(scheme->table, to);
    if (kernel == &nevh_runge_kutta_kernel)
        return take_butcher(scheme->table, to);
    if (kernel == &nevh_gauss_kernel || kernel == &nevh_implicit_euler_kernel ||
        kernel == &nevh__implicit_kernel)
        return take_tableau(scheme, to);
    return NEVH_EINVAL;
}

/* nevh: residuals of an orbit's rows.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "measured.h"
#include <math.h>

void residuals_begin(residuals_of_rows *r, const measured *m, const plan *p) {
    *r = (residuals_of_rows){
        .data = m,
        .columns = columns_new(p),
        .model = tool_allocate(m->columns, sizeof *r->model),
        .squares = tool_allocate(m->columns, sizeof *r->squares)};
    for (size_t k = 0; k < m->columns; k++)
        columns_add(&r->columns, m->names.item[k]);
}

void residuals_end(residuals_of_rows *r) {
    if (!r->data)
        return;
    columns_free(&r->columns);
}

void residuals_take(residuals_of_rows *r, double t, const double q[],
                    const double p[], double residual[]) {
    static const double rounding = 1e-12;
    const measured *m = r->data;
    bool due = r->next < m->points &&
               fabs(t - m->t[r->next]) <= rounding * (1 + fabs(t));
    columns_values(&r->columns, t, q, p, r->model);
    for (size_t k = 0; k < m->columns; k++) {
        residual[k] = due ? measured_residual(m, r->next, k, r->model[k]) : NAN;
        if (due)
            r->squares[k] += residual[k] * residual[k];
    }
    r->next += due;
}

void residuals_words(const residuals_of_rows *r, const plan *p, list *words) {
    const measured *m = r->data;
    for (size_t k = 0; m && r->next && k < m->columns; k++) {
        const char *name = m->names.item[k];
        const char *unit = nevh_scene_label(p->scene, name);
        list_print(words, "rms of the residuals of %s: %.3g%s%s (%zu points)",
                   name, sqrt(r->squares[k] / (double)r->next),
                   *unit ? " " : "", unit, r->next);
    }
}

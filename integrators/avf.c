/* nevh: the averaged vector field.

       D = integral of dH(z + s (z' - z)) over s from 0 to 1,

   by Gauss-Legendre quadrature with as many nodes as there are stages, which is
   exact, and so keeps the energy, for polynomials H of degree 2 * stages.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/discrete_gradient_private.h"
#include "schemes_private.h"

/* Rounding leaves the nodes in symmetry, without which the energy drifts by
   1e-18 a step. */
void nevh__find_nodes(const nevh__gradient_step *s, size_t first, size_t nodes,
                      size_t active, const size_t lanes[], const double x[]) {
    const nevh_work *w = s->work;
    const double *c = s->nodes->c, *mirrored = c + s->nodes->stages - 1;
    double *point = s->points;
    for (size_t k = 0; k < 2 * w->n; k++)
        for (size_t j = first; j < first + nodes; j++) {
            double from_middle = (c[j] - *(mirrored - j)) / 2;
            for (size_t a = 0; a < active; a++) {
                size_t i = k * w->width + lanes[a];
                double way = s->h * x[i];
                *point++ = s->z[i] +
                           ((way / 2 + from_middle * way) + s->compensation[i]);
            }
        }
    for (size_t j = first; j < first + nodes; j++)
        for (size_t a = 0; a < active; a++)
            *point++ = s->t + (c[j] - 0.5) * s->h;
}

int nevh__average_gradient(const nevh__gradient_step *s, size_t active,
                           const size_t lanes[], const double x[],
                           double out[]) {
    nevh_work *w = s->work;
    const nevh__tableau *g = s->nodes;
    size_t count = g->stages * active, half = w->n * count;
    nevh__find_nodes(s, 0, g->stages, active, lanes, x);
    int status =
        nevh_work_gradient(w, count, s->points + 2 * half, s->points,
                           s->points + half, s->slopes, s->slopes + half);
    for (size_t i = 0; i < 2 * w->n * active; i++)
        out[i] = 0;
    for (size_t k = 0; !status && k < 2 * w->n; k++)
        for (size_t m = 0; m < g->stages; m++)
            for (size_t a = 0; a < active; a++) {
                size_t j = g->order[m];
                out[nevh__conjugate(w, k) * active + a] +=
                    g->b[j] * s->slopes[k * count + j * active + a];
            }
    return status;
}

static const nevh__discrete_gradient averaged = {
    .parts = 1, .averages = true, .gradient = nevh__average_gradient};

const nevh_integrator nevh__avf_entry = {
    .name = "avf",
    .aliases = "averaged-vector-field",
    .source = "G. R. W. Quispel, D. I. McLaren, A new class of energy-"
              "preserving numerical integration methods, J. Phys. A 41 (2008) "
              "045206",
    .order = 2,
    .stages = 8,
    .sweep_gradients = 8,
    .symplectic = NEVH_NO,
    .symmetric = NEVH_YES,
    .explicit_form = NEVH_NO,
    .preserves_energy = NEVH_YES,
    .kernel = &nevh__discrete_gradient_kernel,
    .table = &averaged,
};
NEVH__PUBLISH(avf);

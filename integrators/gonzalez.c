/* nevh: Gonzalez' midpoint discrete gradient.

       D = dH(m) + (H(z') - H(z) - dH(m) . dz) / |dz|^2  dz,

   m = (z + z') / 2, dz = z' - z; |.| weighs each variable by how H is curved in
   it, so that nothing depends on the user's units, and that each dH(m)_k is
   changed by as small a part of it as the others are: a light body among heavy
   ones would not survive its part of their energy.  It keeps H however wrong
   dH(m) is.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/discrete_gradient_private.h"
#include "schemes_private.h"
#include "gradient/field_private.h"
#include <float.h>
#include <math.h>

/* The field's; for it, one lane in one piece goes to the room of the ends,
   which is free after a sweep. */
static int gradient_noise(const nevh__gradient_step *s, size_t lane,
                          double noise[]) {
    nevh_work *w = s->work;
    double *q = s->ends, *p = q + w->n;
    for (size_t k = 0; k < 2 * w->n; k++)
        q[k] = s->z[k * w->width + lane];
    int status = nevh__field_noise(w->field, s->t, q, p, noise + w->n, noise);
    if (status)
        nevh_work_fail(w, status, "%s", nevh_field_message(w->field));
    return status;
}

/* The correction adds at most the rounding of H over |dz|. */
static int find_noise(void *step, size_t lane, double noise[]) {
    const nevh__gradient_step *s = step;
    const nevh_work *w = s->work;
    int status = gradient_noise(s, lane, noise);
    double way = 0, rounding = DBL_EPSILON * s->start.size[lane];
    for (size_t k = 0; k < 2 * w->n; k++)
        way = fmax(way, fabs(s->h * s->x[k * w->width + lane]) * s->metric[k]);
    for (size_t k = 0; way > 0 && k < 2 * w->n; k++) {
        double dz = fabs(s->h * s->x[k * w->width + lane]) * s->metric[k];
        noise[nevh__conjugate(w, k)] +=
            rounding * (dz / way) * s->metric[k] / way;
    }
    return status;
}

static const nevh__discrete_gradient midpoint = {
    .parts = 1,
    .averages = true,
    .takes_ends = true,
    .gradient = nevh__average_gradient,
    .noise = find_noise,
};

const nevh_integrator nevh__gonzalez_entry = {
    .name = "gonzalez",
    .aliases = "midpoint-discrete-gradient",
    .source = "O. Gonzalez, Time integration and discrete Hamiltonian systems, "
              "J. Nonlinear Sci. 6 (1996) 449-467; R. I. McLachlan, G. R. W. "
              "Quispel, N. Robidoux, Geometric integration using discrete "
              "gradients, Phil. Trans. R. Soc. A 357 (1999) 1021-1045",
    .order = 2,
    .stages = 1,
    .sweep_gradients = 1,
    .symplectic = NEVH_NO,
    .symmetric = NEVH_YES,
    .explicit_form = NEVH_NO,
    .preserves_energy = NEVH_YES,
    .kernel = &nevh__discrete_gradient_kernel,
    .table = &midpoint,
};
NEVH__PUBLISH(gonzalez);

/* nevh: what a step does to phase space.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include "work/transform_private.h"
#include <math.h>
#include <nevh/diagnose.h>
#include <stdlib.h>
#include <string.h>

/* Sixth-order differences: slopes of three chords, and the half-spread of the
   shortest in units of the scale. */
static const double weights[3] = {1.5, -0.6, 0.1};
static const double spread = 0x1p-8;

/* A step's map and the room to differentiate it; z = (q, p) in units of
   scale. */
typedef struct {
    nevh_stepper *stepper;
    double t, h;
    size_t n;
    const double *q, *p, *scale;
    double *z;      /* 2n */
    double *m;      /* 2n x 2n, column by column */
    double *tilted; /* 2n x 2n */
} probe;

static double scale_of(const probe *b, size_t i) {
    return b->scale ? b->scale[i] : 1;
}

/* A fresh step, of the K of the state probed where time is transformed: its own
   would be another one for each state. */
static int symplecticity_take_step(const probe *b) {
    nevh_stepper *s = b->stepper;
    nevh_work *w = &s->work;
    double *q = b->z, *p = b->z + b->n;
    nevh_stepper_reset(s);
    int status = nevh__begin(s, b->t, b->h, q, p);
    if (!status && w->transform)
        status = nevh__transform_begin(w, w->memory + w->memory_rows * w->width,
                                       b->t, b->q, b->p);
    if (!status)
        status = nevh__advance(s, b->t, b->h, q, p);
    return status;
}

/* Adds weight times the step's image of the state with variable j moved. */
static int add_image(probe *b, size_t j, double move, double weight) {
    size_t n = b->n;
    memcpy(b->z, b->q, n * sizeof *b->z);
    memcpy(b->z + n, b->p, n * sizeof *b->z);
    b->z[j] += move * scale_of(b, j);
    int status = symplecticity_take_step(b);
    for (size_t i = 0; !status && i < 2 * n; i++)
        b->m[j * 2 * n + i] += weight * b->z[i] / scale_of(b, i);
    return status;
}

static int symplecticity_differentiate(probe *b) {
    int status = NEVH_OK;
    for (size_t j = 0; j < 2 * b->n; j++)
        for (size_t c = 0; !status && c < 3; c++) {
            double move = (double)(c + 1) * spread;
            status = add_image(b, j, move, weights[c] / (2 * move));
            if (!status)
                status = add_image(b, j, -move, -weights[c] / (2 * move));
        }
    return status;
}

/* J in units of scale: +s_i at (i, n+i), -s_i at (n+i, i); over the largest. */
static double symplectic_form(const probe *b, size_t i, size_t j,
                              double largest) {
    if (i + b->n == j)
        return scale_of(b, i) * scale_of(b, j) / largest;
    if (j + b->n == i)
        return -scale_of(b, i) * scale_of(b, j) / largest;
    return 0;
}

static double find_defect(const probe *b) {
    size_t n = b->n, m = 2 * n;
    double largest = 0, defect = 0;
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, scale_of(b, i) * scale_of(b, n + i));
    for (size_t j = 0; j < m; j++) /* tilted = J M */
        for (size_t i = 0; i < m; i++) {
            size_t k = i < n ? i + n : i - n;
            b->tilted[j * m + i] =
                symplectic_form(b, i, k, largest) * b->m[j * m + k];
        }
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++) {
            double sum = -symplectic_form(b, i, j, largest);
            for (size_t k = 0; k < m; k++)
                sum += b->m[i * m + k] * b->tilted[j * m + k];
            defect = fmax(defect, fabs(sum));
        }
    return defect;
}

/* The stepper's size, or 0 where it cannot be probed. */
static size_t probed_size(const nevh_stepper *s) {
    return s && s->planned && s->work.width == 1 ? s->work.n : 0;
}

int nevh_symplecticity_defect(nevh_stepper *s, double t, double h,
                              const double q[], const double p[],
                              const double scale[], double *defect) {
    size_t n = probed_size(s), m = 2 * n;
    if (n == 0)
        return nevh_stepper_status(s) ? nevh_stepper_status(s) : NEVH_EINVAL;
    probe b = {
        .stepper = s, .t = t, .h = h, .n = n, .q = q, .p = p, .scale = scale};
    b.z = nevh__array(m, sizeof *b.z);
    b.m = nevh__array(m * m, sizeof *b.m);
    b.tilted = nevh__array(m * m, sizeof *b.tilted);
    int status = b.z && b.m && b.tilted ? symplecticity_differentiate(&b)
                                        : (int)NEVH_ENOMEM;
    if (!status)
        *defect = find_defect(&b);
    nevh_stepper_reset(s);
    free(b.z);
    free(b.m);
    free(b.tilted);
    return status;
}

static double symplecticity_distance(const probe *b) {
    double most = 0;
    for (size_t i = 0; i < b->n; i++) {
        most = fmax(most, fabs(b->z[i] - b->q[i]) / scale_of(b, i));
        most =
            fmax(most, fabs(b->z[b->n + i] - b->p[i]) / scale_of(b, b->n + i));
    }
    return most;
}

int nevh_reversal_defect(nevh_stepper *s, double t, double h, size_t steps,
                         const double q[], const double p[],
                         const double scale[], double *defect) {
    size_t n = probed_size(s);
    if (n == 0)
        return nevh_stepper_status(s) ? nevh_stepper_status(s) : NEVH_EINVAL;
    probe b = {
        .stepper = s, .t = t, .h = h, .n = n, .q = q, .p = p, .scale = scale};
    if (!(b.z = nevh__array(2 * n, sizeof *b.z)))
        return NEVH_ENOMEM;
    memcpy(b.z, q, n * sizeof *q);
    memcpy(b.z + n, p, n * sizeof *p);
    nevh_stepper_reset(s);
    int status = nevh_run(s, t, h, steps, b.z, b.z + n, NULL, 0);
    if (!status)
        status = nevh_run(s, nevh__next_time(s, t, h), -h, steps, b.z, b.z + n,
                          NULL, 0);
    if (!status)
        *defect = symplecticity_distance(&b);
    free(b.z);
    return status;
}

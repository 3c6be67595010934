/* nevh: how firmly Tao's two copies are bound.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tao_private.h"
#include "gradient/explore_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <stdio.h>

/* omega over the largest curvature of H. */
static const double firmness = 1;
/* Of the lengths. */
static const double spread = 0x1p-7;
enum { SWEEPS = 24 };

/* H in the coordinates Q = q sqrt(r), P = p / sqrt(r), in which the binding is
   a circle and the curvature of H a frequency. */
typedef struct {
    nevh__explorer *explorer;
    double *unit;      /* 2n: of each variable, in those coordinates */
    double *direction; /* 2n */
    double *point;     /* 2n */
    double *ahead, *behind; /* 2n: gradients */
    double reach;      /* how far a point is moved */
} curvature;

static double *lengths_of(const nevh_work *w, nevh__explorer *e) { (void)w; return e->length; }

static bool gradient_beside(const curvature *c, size_t at, double move,
                            double out[]) {
    const nevh__samples *s = &c->explorer->samples;
    nevh_field *f = c->explorer->field;
    size_t n = f->n;
    for (size_t i = 0; i < 2 * n; i++)
        c->point[i] = (i < n ? s->q[at * n + i] : s->p[at * n + i - n]) +
                      move * c->direction[i] * c->unit[i];
    return nevh_field_gradient(f, 1, &s->t[at], c->point, c->point + n, out,
                               out + n) == NEVH_OK;
}

static double normalise(size_t count, double v[]) {
    double most = 0, sum = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, fabs(v[i]));
    if (!(most > 0 && most <= DBL_MAX))
        return 0;
    for (size_t i = 0; i < count; i++)
        sum += (v[i] / most) * (v[i] / most);
    for (size_t i = 0; i < count; i++)
        v[i] = v[i] / most / sqrt(sum);
    return most * sqrt(sum);
}

/* The norm of the Hessian at a sample, by the power method; 0 where it cannot be
   evaluated. */
static double curvature_at(const curvature *c, size_t at) {
    size_t m = 2 * c->explorer->field->n;
    double norm = 0;
    uint64_t random = 1;
    for (size_t i = 0; i < m; i++)
        c->direction[i] = nevh__random(&random);
    normalise(m, c->direction);
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        if (!gradient_beside(c, at, c->reach, c->ahead) ||
            !gradient_beside(c, at, -c->reach, c->behind))
            return 0;
        for (size_t i = 0; i < m; i++)
            c->direction[i] =
                (c->ahead[i] - c->behind[i]) * c->unit[i] / (2 * c->reach);
        norm = normalise(m, c->direction);
        if (norm == 0)
            return 0;
    }
    return norm;
}

int nevh__binding_choose(nevh_work *w, nevh__binding *b) {
    nevh__explorer e;
    nevh_field *f = w->field;
    size_t n = w->n;
    int status = nevh__explorer_open(&e, f, w->options);
    if (!status && !nevh__find_samples(&e))
        status = NEVH_ENOMEM;
    double *room = nevh__array(10 * n, sizeof(double));
    curvature c = {&e, room, room+2*n, room+4*n, room+6*n, room+8*n, INFINITY};
    const double *length = getenv("SCALE") ? w->scale : lengths_of(w, &e);
    for (size_t k = 0; k < n; k++) {
        b->ratio[k] = length[n + k] / length[k];
        c.unit[k] = 1 / sqrt(b->ratio[k]);
        c.unit[n + k] = sqrt(b->ratio[k]);
        c.reach = fmin(c.reach, spread * sqrt(length[n+k]) * sqrt(length[k]));
    }
    double start = 0, orbit = 0, beside = 0;
    for (size_t at = 0; at < e.samples.count; at++) {
        double one = curvature_at(&c, at);
        if (at < e.lanes) start = fmax(start, one);
        else if (at < e.neighbours) orbit = fmax(orbit, one);
        else beside = fmax(beside, one);
    }
    if (getenv("SHOW")) {
        fprintf(stderr, "norm: start %g orbit %g beside %g;", start, orbit, beside);
        for (size_t k = 0; k < n; k++) fprintf(stderr, " r%zu %g (L %g %g)", k, b->ratio[k], length[k], length[n+k]);
        fprintf(stderr, "\n");
    }
    b->omega = w->options->binding ? w->options->binding : firmness * start;
    free(room);
    nevh__explorer_close(&e);
    for (size_t i = 0; i < f->n_terms; i++)
        f->terms[i].values = 0;
    f->gradients = 0;
    f->report = (nevh__report){0};
    return status;
}

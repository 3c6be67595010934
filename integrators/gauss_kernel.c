/* nevh: Gauss-Legendre methods for any H.

   With slopes F_j at the stages and increments L_j = h b_j F_j,

       Y_i = y + (sum_j mu_ij L_j + e),   F_i = f(t + c_i h, Y_i),
       y  += sum_j L_j,

   where e is what earlier sums lost to rounding, mu_ij = a_ij / b_j satisfies
   mu_ij + mu_ji = 1 exactly, and the h b_j add up to h exactly: the form of
   Antonana, Makazaga and Murua, in which rounding leaves the map symplectic.
   The sum goes from small weights to large ones with compensation, the
   products' own rounding included.  First guess: the collocation polynomial
   of the previous step, continued.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/extend.h>
#include "gauss_private.h"
#include "work_private.h"
#include "implicit/implicit_private.h"
#include "system/system_private.h"
#include <math.h>
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    nevh__gauss *gauss;
    nevh__stage_solver *solver;
    double *hb; /* h b_j of this step */
} gauss_plan;

/* One step under way. */
typedef struct {
    nevh_work *work;
    double t, h;
    const double *q, *p;
    double *slopes;     /* 2n x stages x width */
    double *increments; /* 2n x stages x width */
    double *points;     /* 2n x stages x width */
    double *times;      /* stages x width */
    double *sum;        /* 2n x width: the new state */
    double *lost;       /* 2n x width: its carry */
} gauss_step;

static void unplan(nevh_work *w) {
    gauss_plan *g = w->plan;
    if (!g)
        return;
    nevh__gauss_free(g->gauss);
    nevh__stage_solver_free(g->solver);
    free(g->hb);
    free(g);
    w->plan = NULL;
}

/* Memory: carry, slopes of the last step, their h (0: there are none). */
static int plan(nevh_work *w) {
    size_t stages = (size_t)w->integrator->stages;
    if (stages < 1 || stages > NEVH__MOST_STAGES)
        return nevh_work_fail(w, NEVH_EINVAL,
                              "%s: %zu stages, where 1 to %d are possible",
                              w->integrator->name, stages, NEVH__MOST_STAGES);
    gauss_plan *g = w->plan = nevh__array(1, sizeof *g);
    if (!g)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    g->gauss = nevh__gauss_new(stages);
    g->hb = nevh__array(stages, sizeof *g->hb);
    g->solver = nevh__stage_solver_new(w, stages);
    if (!g->gauss || !g->hb || !g->solver)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    w->memory_rows = 2 * w->n * (1 + stages) + 1;
    w->scratch_size = (6 * w->n * stages + stages) * w->width + 4 * w->size;
    return NEVH_OK;
}

static gauss_step lay_out(nevh_work *w, double t, double h, const double q[],
                          const double p[]) {
    size_t stages = (size_t)w->integrator->stages;
    size_t all = 2 * w->size * stages;
    gauss_step s = {w, t, h, q, p, .slopes = w->scratch};
    s.increments = s.slopes + all;
    s.points = s.increments + all;
    s.times = s.points + all;
    s.sum = s.times + stages * w->width;
    s.lost = s.sum + 2 * w->size;
    return s;
}

/* h b_j; the outer two share what the rounded others leave of h. */
static void weigh(gauss_plan *g, double h) {
    size_t s = g->gauss->stages;
    double rest = h;
    for (size_t j = 1; j + 1 < s; j++) {
        g->hb[j] = h * g->gauss->b[j];
        rest -= g->hb[j];
    }
    g->hb[0] = g->hb[s - 1] = s > 1 ? rest / 2 : rest;
}

/* The same for one lane, where the stages stand side by side. */
NEVH_SIMD static void multiply_one(size_t stages, const double m[],
                                   const double x[], double out[]) {
    double sum[NEVH__MOST_STAGES];
    for (size_t i = 0; i < stages; i++)
        sum[i] = 0;
    for (size_t j = 0; j < stages; j++)
        for (size_t i = 0; i < stages; i++)
            sum[i] += m[j * stages + i] * x[j];
    for (size_t i = 0; i < stages; i++)
        out[i] = sum[i];
}

/* out[i] = sum_j m[j*stages + i] x[j], for `active` lanes side by side. */
static void multiply(size_t stages, size_t active, const double m[],
                     const double x[], double out[]) {
    if (active == 1) {
        multiply_one(stages, m, x, out);
        return;
    }
    for (size_t i = 0; i < stages * active; i++)
        out[i] = 0;
    for (size_t j = 0; j < stages; j++, m += stages)
        for (size_t i = 0; i < stages; i++)
            for (size_t a = 0; a < active; a++)
                out[i * active + a] += m[i] * x[j * active + a];
}

/* The stage states of variable k at the lanes under way, to points. */
static void find_points(const gauss_step *s, const gauss_plan *g, size_t k,
                        size_t active, const size_t lanes[],
                        const double slopes[]) {
    const nevh_work *w = s->work;
    size_t stages = g->gauss->stages, at = k * stages;
    double *points = s->points + at * active, *x = s->increments + at * active;
    for (size_t j = 0; j < stages; j++)
        for (size_t a = 0; a < active; a++)
            x[j * active + a] =
                g->hb[j] * slopes[(at + j) * w->width + lanes[a]];
    multiply(stages, active, g->gauss->mu, x, points);
    const double *y = k < w->n ? s->q : s->p, *carry = w->memory;
    for (size_t i = 0; i < stages; i++)
        for (size_t a = 0; a < active; a++) {
            size_t lane = lanes[a];
            double *point = points + i * active + a;
            *point = y[k % w->n * w->width + lane] +
                     (*point + carry[k * w->width + lane]);
        }
}

static int map(void *data, size_t active, const size_t lanes[],
               const double slopes[], double out[]) {
    const gauss_step *s = data;
    nevh_work *w = s->work;
    const gauss_plan *g = w->plan;
    size_t stages = g->gauss->stages, half = w->n * stages * active;
    for (size_t k = 0; k < 2 * w->n; k++)
        find_points(s, g, k, active, lanes, slopes);
    for (size_t i = 0; i < stages * active; i++)
        s->times[i] = s->t + g->gauss->c[i / active] * s->h;
    int status = nevh_work_gradient(w, stages * active, s->times, s->points,
                                    s->points + half, out + half, out);
    for (size_t i = half; i < 2 * half; i++)
        out[i] = -out[i];
    return status;
}

/* Continues the last step's polynomial where there is one. */
static void guess(const gauss_step *s, const gauss_plan *g) {
    const nevh_work *w = s->work;
    size_t stages = g->gauss->stages, each = stages * w->width;
    const double *last = w->memory + 2 * w->size;
    const double *last_h = last + 2 * w->n * each;
    for (size_t k = 0; k < 2 * w->n; k++) {
        double *slopes = s->slopes + k * each;
        multiply(stages, w->width, g->gauss->guess, last + k * each, slopes);
        for (size_t i = 0; i < each; i++)
            if (last_h[i % w->width] != s->h)
                slopes[i] = 0;
    }
}

/* sum + lost += x, without loss. */
static void add(double *sum, double *lost, double x) {
    double d = x + *lost, y = *sum, next = y + d, part = next - y;
    *lost = (y - (next - part)) + (d - part);
    *sum = next;
}

static void sum_up(const gauss_step *s, const gauss_plan *g, size_t i,
                   double y) {
    const nevh_work *w = s->work;
    size_t stages = g->gauss->stages, k = i / w->width, lane = i % w->width;
    const double *slopes = s->slopes + k * stages * w->width + lane;
    double sum = y, lost = w->memory[i];
    for (size_t m = 0; m < stages; m++) {
        size_t j = g->gauss->order[m];
        double slope = slopes[j * w->width], x = g->hb[j] * slope;
        add(&sum, &lost, x);
        lost += fma(g->hb[j], slope, -x);
    }
    s->sum[i] = sum;
    s->lost[i] = lost;
}

static int commit(const gauss_step *s, const gauss_plan *g, double q[],
                  double p[]) {
    nevh_work *w = s->work;
    size_t n = w->size;
    double check = 0;
    for (size_t i = 0; i < 2 * n; i++) {
        sum_up(s, g, i, i < n ? q[i] : p[i - n]);
        check += s->sum[i] - s->sum[i];
    }
    if (check != 0)
        return nevh__fail_range(w, s->t, s->h);
    memcpy(q, s->sum, n * sizeof *q);
    memcpy(p, s->sum + n, n * sizeof *p);
    memcpy(w->memory, s->lost, 2 * n * sizeof *w->memory);
    size_t all = 2 * n * g->gauss->stages;
    memcpy(w->memory + 2 * n, s->slopes, all * sizeof *w->memory);
    for (size_t lane = 0; lane < w->width; lane++)
        w->memory[2 * n + all + lane] = s->h;
    return NEVH_OK;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    gauss_plan *g = w->plan;
    gauss_step s = lay_out(w, t, h, q, p);
    weigh(g, h);
    guess(&s, g);
    nevh__stage_problem problem = {t, h, q, p, s.slopes, map, &s, NULL};
    int status = nevh__stage_solve(g->solver, &problem);
    return status ? status : commit(&s, g, q, p);
}

const nevh_kernel nevh_gauss_kernel = {
    .plan = plan, .step = step, .unplan = unplan};

/* nevh: the area of a loop that is stretched beyond what points resolve.

   It is the integral, over what the curve enclosed at first, of the determinant
   of all steps, that is of the product of those of single steps, which never
   loses its digits [Liouville].  The inside is taken for rays from the middle to
   the curve: rings of equal area, and the nodes of panels round them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/loop_private.h"
#include <math.h>
#include <stdlib.h>

enum { RINGS = 16, PANELS = 16, SIDE = 6 };
/* Sixth-order differences, and their shortest half-spread as part of the box. */
static const double weights[3] = {1.5, -0.6, 0.1};
static const double spread = 0x1p-6;

typedef struct {
    nevh_loop *loop;
    double length[2];                       /* of the differences */
    double slope[NEVH__NODES][NEVH__NODES]; /* P_k' at node j: [j][k] */
    double *sum[2]; /* times: of even and of odd rings */
} inside;

static void plan_slopes(inside *x) {
    for (int j = 0; j < NEVH__NODES; j++) {
        double at = x->loop->node[j], before = 1, value = at;
        x->slope[j][1] = 1;
        for (int k = 2; k < NEVH__NODES; k++) {
            double next = ((2 * k - 1) * at * value - (k - 1) * before) / k;
            before = value;
            value = next;
            x->slope[j][k] = x->slope[j][k - 2] + (2 * k - 1) * before;
        }
    }
}

/* The state in the last lanes, moved along q in the first six and along p in the
   six after them. */
static void spread_out(const inside *x, double at_q, double at_p) {
    for (int lane = 0; lane < NEVH__NODES; lane++) {
        bool moved_q = lane < SIDE, moved_p = !moved_q && lane < 2 * SIDE;
        int i = lane % SIDE;
        double move = (i / 2 + 1) * (i % 2 ? -1 : 1);
        x->loop->q[lane] = at_q + (moved_q ? move * x->length[0] : 0);
        x->loop->p[lane] = at_p + (moved_p ? move * x->length[1] : 0);
    }
}

static double loop_inside_slope_of(const double image[], double length) {
    double sum = 0;
    for (int c = 0; c < SIDE / 2; c++)
        sum += weights[c] * (image[2 * c] - image[2 * c + 1]) /
               (2 * (c + 1) * length);
    return sum;
}

static double determinant(const inside *x) {
    const double *q = x->loop->q, *p = x->loop->p;
    return loop_inside_slope_of(q, x->length[0]) *
               loop_inside_slope_of(p + SIDE, x->length[1]) -
           loop_inside_slope_of(p, x->length[0]) *
               loop_inside_slope_of(q + SIDE, x->length[1]);
}

static int carry_point(inside *x, double q, double p, double weight,
                       double sum[]) {
    nevh_loop *l = x->loop;
    double product = weight;
    size_t step = 0;
    for (size_t time = 0; time < l->reach; time++) {
        for (; step < l->steps[time]; step++) {
            double t = l->options.t0 + (double)step * l->options.h;
            spread_out(x, q, p);
            int status =
                nevh_stepper_apply(l->stepper, t, l->options.h, l->q, l->p);
            if (status)
                return status;
            product *= determinant(x);
            q = l->q[NEVH__NODES - 1];
            p = l->p[NEVH__NODES - 1];
        }
        sum[time] += product;
    }
    return NEVH_OK;
}

/* All rings of the nodes of a panel. */
static int carry_panel(inside *x, const nevh__panel *at) {
    nevh_loop *l = x->loop;
    double q[NEVH__NODES], p[NEVH__NODES], a[NEVH__NODES], b[NEVH__NODES];
    double middle_q = (l->low[0] + l->high[0]) / 2;
    double middle_p = (l->low[1] + l->high[1]) / 2;
    int status = nevh__loop_place(l, at);
    nevh__loop_expand(l, l->q, middle_q, a);
    nevh__loop_expand(l, l->p, middle_p, b);
    for (int j = 0; j < NEVH__NODES; j++) {
        q[j] = l->q[j] - middle_q;
        p[j] = l->p[j] - middle_p;
    }
    for (int j = 0; !status && j < NEVH__NODES; j++) {
        double dq = 0, dp = 0;
        for (int k = 1; k < NEVH__NODES; k++) {
            dq += a[k] * x->slope[j][k];
            dp += b[k] * x->slope[j][k];
        }
        double weight = l->legendre[0][j] * (q[j] * dp - p[j] * dq) / RINGS;
        for (int ring = 0; !status && ring < RINGS; ring++) {
            double r = sqrt((ring + 0.5) / RINGS);
            status = carry_point(x, middle_q + r * q[j], middle_p + r * p[j],
                                 weight, x->sum[ring % 2]);
        }
    }
    return status;
}

static int carry_panels(inside *x) {
    nevh_loop *l = x->loop;
    size_t pieces = PANELS / l->options.n_corners + 1;
    int status = NEVH_OK;
    for (size_t c = 0; !status && c < l->options.n_corners; c++)
        for (size_t i = 0; !status && i < pieces; i++) {
            double from = l->corners[c], length = l->corners[c + 1] - from;
            double end = (double)(i + 1) / (double)pieces;
            double begin = (double)i / (double)pieces;
            nevh__panel at = {.from = from + length * begin,
                              .to = from + length * end};
            status = carry_panel(x, &at);
        }
    return status;
}

/* Replaces areas that are not certain to NEVH__LOOP_CERTAIN by those of the inside that
   are more certain. */
static void take_over(inside *x) {
    nevh_loop *l = x->loop;
    for (size_t i = 0; i < l->reach; i++) {
        double area = x->sum[0][i] + x->sum[1][i];
        double error = fabs(x->sum[0][i] - x->sum[1][i]);
        if (!(l->error[i] > error))
            continue;
        l->area[i] = area;
        l->error[i] = error;
        l->noise[i] = 0;
        l->inside[i] = true;
    }
}

/* States are lost where a step fails, or time is out. */
int nevh__loop_look_inside(nevh_loop *l) {
    inside x = {.loop = l};
    bool asked = false;
    for (size_t i = 0; i < l->reach; i++)
        asked =
            asked || !(l->error[i] <= NEVH__LOOP_CERTAIN * fabs(l->area[i]));
    if (!asked || l->n != 1)
        return NEVH_OK;
    x.sum[0] = nevh__array(2 * l->options.times, sizeof *x.sum[0]);
    if (!x.sum[0])
        return nevh__no_memory(&l->report);
    x.sum[1] = x.sum[0] + l->options.times;
    for (int i = 0; i < 2; i++)
        x.length[i] = spread * (l->high[i] - l->low[i]);
    plan_slopes(&x);
    if (!carry_panels(&x))
        take_over(&x);
    free(x.sum[0]);
    return NEVH_OK;
}

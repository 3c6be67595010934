/* nevh: Itoh and Abe's coordinate increments: values of H, and no derivative.

   The way from z to z' goes along one variable after the other; D_k is what H
   gains along z_k, over z'_k - z_k.  So the sum of all D_k dz_k telescopes.
   The order is q1, p1, q2, p2, ..., conjugate pairs together: none is the most
   accurate throughout.  The adjoint goes the way in reverse order, and half a
   step of each is the symmetric scheme.

   Over a short increment rounding of H would drown the quotient.  There it is
   taken over a longer one about the same middle: at the threshold the two are
   the same, below it the quotient is off by a part of the longest increment's
   square, 1/64^2 of what the scheme is off anyway, and the energy is balanced
   by the other increments.

   One sweep takes 2n values of H, and two more for each short increment; a part
   of a step takes one more, two where H reads t.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/discrete_gradient_private.h"
#include "schemes_private.h"
#include "gradient/field_private.h"
#include <float.h>
#include <math.h>

/* Points that are evaluated at once, where there are so many. */
enum { MOST_POINTS = 256, FEWEST_POINTS = 8, ROOM = 65536 };
/* Shorter increments are made longer: parts of the length over which H varies,
   of the longest increment in that unit (up to 1), and of the variable. */
static const double shortest = 0x1p-17, shortest_part = 1. / 64,
                    tiny = 64 * DBL_EPSILON;

/* One sweep's way for the lanes under way, and points on it, at most as many as
   most_points, where H is evaluated. */
typedef struct {
    const nevh__gradient_step *step;
    size_t active;
    const size_t *lanes;
    double *least; /* of each lane, in units of length */
    double *z, *t;
    nevh__values h;
} tour;

static size_t most_points(const nevh_work *w) {
    size_t fit = ROOM / (2 * w->n);
    fit = fit < MOST_POINTS ? fit : MOST_POINTS;
    fit = fit > FEWEST_POINTS ? fit : FEWEST_POINTS;
    return fit > 2 * w->width ? fit : 2 * w->width;
}

static size_t own_size(const nevh_work *w) {
    return w->width + most_points(w) * (2 * w->n + 4);
}

static tour set_out(const nevh__gradient_step *s, size_t active,
                    const size_t lanes[]) {
    size_t capacity = most_points(s->work);
    tour v = {.step = s, .active = active, .lanes = lanes, .least = s->own};
    v.z = v.least + s->work->width;
    v.t = v.z + capacity * 2 * s->work->n;
    v.h =
        (nevh__values){v.t + capacity, v.t + 2 * capacity, v.t + 3 * capacity};
    return v;
}

/* The variable that is visited at a stop. */
static size_t variable_at(const nevh__gradient_step *s, size_t stop) {
    size_t n = s->work->n, i = s->part % 2 ? 2 * n - 1 - stop : stop;
    return i % 2 * n + i / 2;
}

static double start_of(const tour *v, size_t k, size_t a) {
    return v->step->z[k * v->step->work->width + v->lanes[a]];
}

static double end_of(const tour *v, size_t k, size_t a) {
    return v->step->ends[k * v->active + a];
}

static double least_of(double longest) {
    return fmax(shortest, shortest_part * fmin(longest, 1));
}

static void find_least(const tour *v) {
    for (size_t a = 0; a < v->active; a++)
        v->least[a] = 0;
    for (size_t k = 0; k < 2 * v->step->work->n; k++) {
        double unit = v->step->length[k];
        for (size_t a = 0; a < v->active; a++) {
            double way = fabs(end_of(v, k, a) - start_of(v, k, a)) / unit;
            v->least[a] = way > v->least[a] ? way : v->least[a];
        }
    }
    for (size_t a = 0; a < v->active; a++)
        v->least[a] = least_of(v->least[a]);
}

static int evaluate(const tour *v, size_t count) {
    nevh_work *w = v->step->work;
    for (size_t i = 0; i < count; i++)
        v->t[i] = v->step->t;
    int status = nevh__field_moving_values(w->field, count, v->t, v->z,
                                           v->z + w->n * count, v->h.h,
                                           v->h.roundoff, v->h.size);
    if (status)
        nevh_work_fail(w, status, "%s", nevh_field_message(w->field));
    return status;
}

/* The states at some stops: what has been visited is at its end. */
static void put_stops(const tour *v, size_t first, size_t stops) {
    for (size_t i = 0; i < 2 * v->step->work->n; i++) {
        size_t k = variable_at(v->step, i);
        double *z = v->z + k * stops * v->active;
        for (size_t stop = first; stop < first + stops; stop++)
            for (size_t a = 0; a < v->active; a++)
                *z++ = i <= stop ? end_of(v, k, a) : start_of(v, k, a);
    }
}

/* The quotients at some stops; `end` holds H at the stop before, and goes
   along. */
static void divide(const tour *v, size_t first, size_t stops, double out[]) {
    const nevh__values *h = &v->h, *before = &v->step->end;
    for (size_t i = 0; i < stops; i++) {
        size_t k = variable_at(v->step, first + i);
        double *slope = out + nevh__conjugate(v->step->work, k) * v->active;
        for (size_t a = 0; a < v->active; a++) {
            size_t at = i * v->active + a;
            slope[a] = ((h->h[at] - before->h[a]) +
                        (h->roundoff[at] - before->roundoff[a])) /
                       (end_of(v, k, a) - start_of(v, k, a));
            before->h[a] = h->h[at];
            before->roundoff[a] = h->roundoff[at];
        }
    }
}

static int take_quotients(const tour *v, double out[]) {
    const nevh__values *start = &v->step->start, *before = &v->step->end;
    size_t most = most_points(v->step->work) / v->active;
    size_t all = 2 * v->step->work->n;
    int status = NEVH_OK;
    for (size_t a = 0; a < v->active; a++) {
        before->h[a] = start->h[v->lanes[a]];
        before->roundoff[a] = start->roundoff[v->lanes[a]];
    }
    for (size_t first = 0, stops; !status && first < all; first += stops) {
        stops = all - first < most ? all - first : most;
        put_stops(v, first, stops);
        status = evaluate(v, stops * v->active);
        divide(v, first, stops, out);
    }
    return status;
}

/* True if a lane's increment is too short; ends: those of a longer one. */
static bool lengthen(const tour *v, size_t k, size_t a, double ends[2]) {
    double start = start_of(v, k, a), end = end_of(v, k, a);
    double middle = start + (end - start) / 2;
    double way = fmax(v->least[a] * v->step->length[k], tiny * fabs(middle));
    ends[0] = middle - way / 2;
    ends[1] = middle + way / 2;
    return !(fabs(end - start) >= way);
}

/* A lane's state just before a stop, but for that stop's variable. */
static void put_one(const tour *v, size_t count, size_t at, size_t stop,
                    size_t a, double z) {
    for (size_t i = 0; i < 2 * v->step->work->n; i++) {
        size_t k = variable_at(v->step, i);
        v->z[k * count + at] = i < stop    ? end_of(v, k, a)
                               : i == stop ? z
                                           : start_of(v, k, a);
    }
}

static int replace_short(const tour *v, size_t stop, double out[]) {
    const nevh__values *h = &v->h;
    size_t k = variable_at(v->step, stop), count = 0;
    double ends[2];
    double *slope = out + nevh__conjugate(v->step->work, k) * v->active;
    for (size_t a = 0; a < v->active; a++)
        count += lengthen(v, k, a, ends) ? 2 : 0;
    if (count == 0)
        return NEVH_OK;
    for (size_t a = 0, at = 0; at < count; a++)
        for (size_t i = 0; lengthen(v, k, a, ends) && i < 2; i++)
            put_one(v, count, at++, stop, a, ends[i]);
    int status = evaluate(v, count);
    for (size_t a = 0, at = 0; !status && at < count; a++)
        if (lengthen(v, k, a, ends)) {
            slope[a] = ((h->h[at + 1] - h->h[at]) +
                        (h->roundoff[at + 1] - h->roundoff[at])) /
                       (ends[1] - ends[0]);
            at += 2;
        }
    return status;
}

static int increments(const nevh__gradient_step *s, size_t active,
                      const size_t lanes[], const double x[], double out[]) {
    const tour v = set_out(s, active, lanes);
    (void)x;
    find_least(&v);
    int status = take_quotients(&v, out);
    for (size_t stop = 0; !status && stop < 2 * s->work->n; stop++)
        status = replace_short(&v, stop, out);
    return status;
}

static int find_noise(void *step, size_t lane, double noise[]) {
    const nevh__gradient_step *s = step;
    const nevh_work *w = s->work;
    double longest = 0, least;
    for (size_t k = 0; k < 2 * w->n; k++)
        longest = fmax(longest,
                       fabs(s->h * s->x[k * w->width + lane]) / s->length[k]);
    least = least_of(longest);
    for (size_t k = 0; k < 2 * w->n; k++) {
        size_t i = k * w->width + lane;
        double way = fmax(fabs(s->h * s->x[i]), least * s->length[k]);
        noise[nevh__conjugate(w, k)] = DBL_EPSILON * s->start.size[lane] / way;
    }
    return NEVH_OK;
}

#define ITOH_ABE(id, title, other, count, claim)                               \
    static const nevh__discrete_gradient id = {                                \
        .parts = (count),                                                      \
        .takes_ends = true,                                                    \
        .gradient = increments,                                                \
        .noise = find_noise,                                                   \
        .own_size = own_size,                                                  \
    };                                                                         \
    const nevh_integrator nevh__##id##_entry = {                               \
        .name = title,                                                         \
        .aliases = other,                                                      \
        .source = "T. Itoh, K. Abe, Hamiltonian-conserving discrete "          \
                  "canonical equations based on variational difference "       \
                  "quotients, J. Comput. Phys. 76 (1988) 85-102; R. I. "       \
                  "McLachlan, G. R. W. Quispel, N. Robidoux, Phil. Trans. R. " \
                  "Soc. A 357 (1999) 1021-1045",                               \
        .order = (count),                                                      \
        .stages = (count),                                                     \
        .symplectic = NEVH_NO,                                                 \
        .symmetric = (claim),                                                  \
        .explicit_form = NEVH_NO,                                              \
        .preserves_energy = NEVH_YES,                                          \
        .kernel = &nevh__discrete_gradient_kernel,                             \
        .table = &id,                                                          \
    };                                                                         \
    NEVH__PUBLISH(id)

ITOH_ABE(itoh_abe, "itoh-abe", "coordinate-increments", 1, NEVH_NO);
ITOH_ABE(itoh_abe_symmetric, "itoh-abe-symmetric", "", 2, NEVH_YES);

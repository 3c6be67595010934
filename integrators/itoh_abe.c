/* nevh: Itoh and Abe's coordinate increments: values of H, and no derivative.

   The way from z to z' goes along one variable after the other; D_k is what H
   gains along z_k, over z'_k - z_k.  So the sum of all D_k dz_k telescopes.
   The order is q1, p1, q2, p2, ..., as in the paper; the adjoint goes the way
   in reverse order, and half a step of each is the symmetric scheme.

   Where an increment is so short that rounding of H drowns the quotient, it is
   taken over a longer one about the same middle.  At the threshold the two are
   the same; below, the energy is wrong by its cube at most, which is rounding.

   One sweep takes 2n values of H (and two more for each short increment), a
   step one more a part.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "discrete_gradient_private.h"
#include "schemes_private.h"
#include "gradient/field_private.h"
#include <float.h>
#include <math.h>

/* Points that are evaluated at once, where there are so many. */
enum { MOST_POINTS = 256, FEWEST_POINTS = 8, ROOM = 65536 };
/* Shorter increments are made longer: in units of length, and of the longest
   of the step. */
static const double tiny = 64 * DBL_EPSILON; /* of the variable itself */
static const double shortest = 0x1p-17, shortest_part = 1. / 64;

/* Where H is evaluated: `room` points at most. */
typedef struct {
    double *z, *t;
    nevh__values h;
    double *least; /* of each lane, in units of length */
} stand;

static size_t most_points(const nevh_work *w) {
    size_t fit = ROOM / (2 * w->n);
    fit = fit < MOST_POINTS ? fit : MOST_POINTS;
    fit = fit > FEWEST_POINTS ? fit : FEWEST_POINTS;
    return fit > 2 * w->width ? fit : 2 * w->width;
}

static size_t own_size(const nevh_work *w) {
    return most_points(w) * (2 * w->n + 5);
}

static stand find_stand(const nevh__gradient_step *s) {
    size_t room = most_points(s->work);
    stand to = {.z = s->own, .t = s->own + room * 2 * s->work->n};
    to.h = (nevh__values){to.t + room, to.t + 2 * room, to.t + 3 * room};
    to.least = to.h.size + room;
    return to;
}

/* The variable that is visited at a stop. */
static size_t variable_at(const nevh__gradient_step *s, size_t stop) {
    size_t n = s->work->n, i = s->part % 2 ? 2 * n - 1 - stop : stop;
    return i % 2 * n + i / 2;
}

/* The shortest increment of each variable, in units of length. */
static void find_least(const nevh__gradient_step *s, size_t active,
                       const size_t lanes[], double least[]) {
    const nevh_work *w = s->work;
    for (size_t a = 0; a < active; a++)
        least[a] = shortest;
    for (size_t k = 0; k < 2 * w->n; k++)
        for (size_t a = 0; a < active; a++) {
            double dz = s->ends[k * active + a] - s->z[k * w->width + lanes[a]];
            least[a] = fmax(least[a], shortest_part * fabs(dz) / s->length[k]);
        }
}

/* A point with what was visited before the stop at its end, and the stop's own
   variable at z, to column `at` of `count`. */
static void put(const nevh__gradient_step *s, const stand *to, size_t count,
                size_t at, size_t stop, double z, size_t active, size_t a,
                size_t lane) {
    const nevh_work *w = s->work;
    for (size_t i = 0; i < 2 * w->n; i++) {
        size_t k = variable_at(s, i);
        to->z[k * count + at] = i < stop    ? s->ends[k * active + a]
                                : i == stop ? z
                                            : s->z[k * w->width + lane];
    }
    to->t[at] = s->t;
}

static int evaluate(const nevh__gradient_step *s, const stand *to,
                    size_t count) {
    nevh_work *w = s->work;
    int status = nevh__field_moving_values(w->field, count, to->t, to->z,
                                           to->z + w->n * count, to->h.h,
                                           to->h.lost, to->h.size);
    if (status)
        nevh_work_fail(w, status, "%s", nevh_field_message(w->field));
    return status;
}

/* The quotients at the first stops of which there are values; `end` holds H at
   the stop before, and goes along. */
static void divide(const nevh__gradient_step *s, const stand *from,
                   size_t first, size_t stops, size_t active,
                   const size_t lanes[], double out[]) {
    const nevh_work *w = s->work;
    for (size_t i = 0; i < stops; i++)
        for (size_t a = 0; a < active; a++) {
            size_t k = variable_at(s, first + i), at = i * active + a;
            double dz = s->ends[k * active + a] - s->z[k * w->width + lanes[a]];
            double dh = (from->h.h[at] - s->end.h[a]) +
                        (from->h.lost[at] - s->end.lost[a]);
            out[nevh__conjugate(w, k) * active + a] = dh / dz;
            s->end.h[a] = from->h.h[at];
            s->end.lost[a] = from->h.lost[at];
        }
}

static int long_ways(const nevh__gradient_step *s, const stand *to,
                     size_t active, const size_t lanes[], double out[]) {
    size_t most = most_points(s->work) / active, all = 2 * s->work->n;
    int status = NEVH_OK;
    for (size_t a = 0; a < active; a++) {
        s->end.h[a] = s->start.h[lanes[a]];
        s->end.lost[a] = s->start.lost[lanes[a]];
    }
    for (size_t first = 0, stops; !status && first < all; first += stops) {
        stops = all - first < most ? all - first : most;
        for (size_t i = 0; i < stops; i++)
            for (size_t a = 0; a < active; a++) {
                size_t stop = first + i, k = variable_at(s, stop);
                put(s, to, stops * active, i * active + a, stop,
                    s->ends[k * active + a], active, a, lanes[a]);
            }
        status = evaluate(s, to, stops * active);
        divide(s, to, first, stops, active, lanes, out);
    }
    return status;
}

/* Whether the way is short, and then its ends, made longer. */
static bool lengthen(double least, double z, double end, double ends[2]) {
    double middle = z + (end - z) / 2, way = fmax(least, tiny * fabs(middle));
    ends[0] = middle - way / 2;
    ends[1] = middle + way / 2;
    return !(fabs(end - z) >= way);
}

static int short_ways(const nevh__gradient_step *s, const stand *to,
                      size_t stop, size_t active, const size_t lanes[],
                      double out[]) {
    size_t k = variable_at(s, stop), count = 0, width = s->work->width;
    const double *z = s->z + k * width, *end = s->ends + k * active;
    double ends[2], unit = s->length[k];
    double *slope = out + nevh__conjugate(s->work, k) * active;
    for (size_t a = 0; a < active; a++)
        count += 2 * lengthen(unit * to->least[a], z[lanes[a]], end[a], ends);
    for (size_t a = 0, at = 0; a < active; a++)
        if (lengthen(unit * to->least[a], z[lanes[a]], end[a], ends)) {
            put(s, to, count, at++, stop, ends[0], active, a, lanes[a]);
            put(s, to, count, at++, stop, ends[1], active, a, lanes[a]);
        }
    int status = count ? evaluate(s, to, count) : NEVH_OK;
    for (size_t a = 0, at = 0; !status && at < count; a++)
        if (lengthen(unit * to->least[a], z[lanes[a]], end[a], ends)) {
            slope[a] = ((to->h.h[at + 1] - to->h.h[at]) +
                        (to->h.lost[at + 1] - to->h.lost[at])) /
                       (ends[1] - ends[0]);
            at += 2;
        }
    return status;
}

static int increments(const nevh__gradient_step *s, size_t active,
                      const size_t lanes[], const double x[], double out[]) {
    const stand to = find_stand(s);
    (void)x;
    find_least(s, active, lanes, to.least);
    int status = long_ways(s, &to, active, lanes, out);
    for (size_t stop = 0; !status && stop < 2 * s->work->n; stop++)
        status = short_ways(s, &to, stop, active, lanes, out);
    return status;
}

static int find_noise(void *step, size_t lane, double noise[]) {
    const nevh__gradient_step *s = step;
    const nevh_work *w = s->work;
    double least = shortest;
    for (size_t k = 0; k < 2 * w->n; k++)
        least = fmax(least, shortest_part / s->length[k] *
                                fabs(s->h * s->x[k * w->width + lane]));
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
    const nevh_integrator nevh__##id = {                                       \
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

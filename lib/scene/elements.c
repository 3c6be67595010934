/* nevh: starts from orbital elements:

       x, y, z = elements(a, e, inclination, node, pericentre, mean_anomaly, mu)

   semi-major axis, eccentricity, angles in radians, and the sum of masses times
   the constant of gravity.  Coordinates and velocities of an ellipse about the
   origin [C. D. Murray, S. F. Dermott, Solar System Dynamics, section 2.8].
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_private.h"
#include "scene/scene_private.h"
#include <math.h>
#include <string.h>

enum { A, E, INCLINATION, NODE, PERICENTRE, MEAN_ANOMALY, MU, ELEMENTS };
static const char name[] = "elements";
static const double in_plane = 1e-12; /* of a sine */

bool nevh__is_elements(const nevh__piece *value) {
    const char *after = value->text + sizeof name - 1;
    return strncmp(value->text, name, sizeof name - 1) == 0 &&
           after[strspn(after, " \t")] == '(';
}

/* Two axes in the plane of the orbit, towards the pericentre and square to it,
   as far as coordinate k goes. */
static void axes(const double *x, size_t k, double *along, double *across) {
    double cos_w = cos(x[PERICENTRE]), sin_w = sin(x[PERICENTRE]);
    double cos_n = cos(x[NODE]), sin_n = sin(x[NODE]);
    double cos_i = cos(x[INCLINATION]), sin_i = sin(x[INCLINATION]);
    if (k == 0) {
        *along = cos_n * cos_w - sin_n * sin_w * cos_i;
        *across = -cos_n * sin_w - sin_n * cos_w * cos_i;
    } else if (k == 1) {
        *along = sin_n * cos_w + cos_n * sin_w * cos_i;
        *across = -sin_n * sin_w + cos_n * cos_w * cos_i;
    } else {
        *along = sin_w * sin_i;
        *across = cos_w * sin_i;
    }
}

/* 1 - e cos E and cos E - e by the half angle, so that they do not cancel where
   e is near 1. */
static void place(const double *x, size_t k, double *q, double *v) {
    double e = x[E], along, across;
    double anomaly = nevh__operation_value(NEVH__ECCENTRIC, x[MEAN_ANOMALY], e);
    double half = sin(anomaly / 2), sine = sin(anomaly), cosine = cos(anomaly);
    double round = sqrt((1 - e) * (1 + e));
    double speed = sqrt(x[MU] / x[A]) / ((1 - e) + 2 * e * half * half);
    axes(x, k, &along, &across);
    *q = x[A] * (((1 - e) - 2 * half * half) * along + round * sine * across);
    *v = speed * (round * cosine * across - sine * along);
}

static bool check(nevh_scene *s, const nevh__statement *one,
                  const nevh__piece arguments[], const double *x) {
    if (!(x[E] >= 0 && x[E] < 1))
        return nevh__scene_fail(s, NEVH_EINVAL, &arguments[E],
                                "elements are of ellipses, 0 <= e < 1, and e "
                                "is %.9g: give coordinates and velocities",
                                x[E]);
    if (!(x[A] > 0))
        return nevh__scene_fail(s, NEVH_EINVAL, &arguments[A],
                                "the semi-major axis of an ellipse is above "
                                "0, not %.9g",
                                x[A]);
    if (!(x[MU] > 0))
        return nevh__scene_fail(s, NEVH_EINVAL, &arguments[MU],
                                "mu, the constant of gravity times the masses, "
                                "is above 0, not %.9g",
                                x[MU]);
    return one->group > 2 || fabs(sin(x[INCLINATION])) <= in_plane ||
           nevh__scene_fail(s, NEVH_EINVAL, &arguments[INCLINATION],
                            "two coordinates are of an orbit in their plane, "
                            "whose inclination is 0, not %.9g",
                            x[INCLINATION]);
}

bool nevh__elements_values(nevh_scene *s, nevh__scene_model *m,
                           const nevh__statement *one, const nevh__piece *value,
                           size_t count, double q[], double v[]) {
    nevh__piece *arguments = NULL;
    size_t given = 0;
    if (!nevh__piece_call(s, &m->pool, value, name, &arguments, &given))
        return false;
    if (given != ELEMENTS || one->group < 2)
        return nevh__scene_fail(s, NEVH_EINVAL, value,
                                "this is written x, y, z = elements(a, e, "
                                "inclination, node, pericentre, mean_anomaly, "
                                "mu), or with x, y alone");
    double *all = nevh__pool_take(&m->pool, ELEMENTS * count, sizeof *all);
    if (!all)
        return nevh__scene_no_memory(s);
    for (size_t i = 0; i < ELEMENTS; i++)
        if (!nevh__head_values(s, m, one, &arguments[i], count,
                               all + i * count))
            return false;
    for (size_t k = 0; k < count; k++) {
        double x[ELEMENTS];
        for (size_t i = 0; i < ELEMENTS; i++)
            x[i] = all[i * count + k];
        if (!check(s, one, arguments, x))
            return false;
        place(x, one->member, &q[k], &v[k]);
    }
    return true;
}

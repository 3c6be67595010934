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
#ifdef NEVH_QUADMATH
#include <quadmath.h>
#endif

enum { A, E, INCLINATION, NODE, PERICENTRE, MEAN_ANOMALY, MU, ELEMENTS };
static const char name[] = "elements";
static const double in_plane = 1e-12; /* of a sine */

bool nevh__is_elements(const nevh__piece *value) {
    const char *after = value->text + sizeof name - 1;
    return strncmp(value->text, name, sizeof name - 1) == 0 &&
           after[strspn(after, " \t")] == '(';
}

#define real            double
#define NAMED(name)     name
#define FUNCTION(f)     f
#define ECCENTRIC(M, e) nevh__operation_value(NEVH__ECCENTRIC, M, e)
#include "scene/elements_text.h"
#undef real
#undef NAMED
#undef FUNCTION
#undef ECCENTRIC

#define real            nevh__wide
#define NAMED(name)     wide_##name
#define FUNCTION(f)     NEVH__WIDE_FUNCTION(f)
#define ECCENTRIC(M, e) nevh__operation_wide(NEVH__ECCENTRIC, M, e)
#include "scene/elements_text.h"

/* Errors of elements add up; each is rounded when it is used, too. */
static void place_rounded(const nevh__rounded x[], size_t member,
                          nevh__rounded *q, nevh__rounded *v) {
    nevh__wide value[ELEMENTS], q_away, v_away;
    for (size_t i = 0; i < ELEMENTS; i++)
        value[i] = x[i].value;
    wide_place(value, member, &q->value, &v->value);
    q->off = v->off = 0;
    for (size_t i = 0; i < ELEMENTS; i++) {
        value[i] += x[i].off + x[i].value * (4 * NEVH__WIDE_EPSILON);
        wide_place(value, member, &q_away, &v_away);
        q->off += NEVH__WIDE_FUNCTION(fabs)(q_away - q->value);
        v->off += NEVH__WIDE_FUNCTION(fabs)(v_away - v->value);
        value[i] = x[i].value;
    }
}

static bool elements_check(nevh_scene *s, const nevh__statement *one,
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
                           size_t count, nevh__scene_numbers q,
                           nevh__scene_numbers v) {
    nevh__piece *arguments = NULL;
    nevh__scene_numbers all;
    size_t given = 0;
    if (!nevh__piece_call(s, &m->pool, value, name, &arguments, &given))
        return false;
    if (given != ELEMENTS || one->group < 2)
        return nevh__scene_fail(s, NEVH_EINVAL, value,
                                "this is written x, y, z = elements(a, e, "
                                "inclination, node, pericentre, mean_anomaly, "
                                "mu), or with x, y alone");
    if (!nevh__scene_numbers_take(s, m, ELEMENTS * count, &all))
        return false;
    for (size_t i = 0; i < ELEMENTS; i++)
        if (!nevh__head_values(s, m, one, &arguments[i], count,
                               nevh__scene_numbers_from(all, i * count)))
            return false;
    for (size_t k = 0; k < count; k++) {
        double x[ELEMENTS];
        nevh__rounded wide[ELEMENTS];
        for (size_t i = 0; i < ELEMENTS; i++) {
            x[i] = all.near[i * count + k];
            wide[i] =
                all.wide ? all.wide[i * count + k] : (nevh__rounded){0, 0};
        }
        if (!elements_check(s, one, arguments, x))
            return false;
        place(x, one->member, &q.near[k], &v.near[k]);
        if (all.wide)
            place_rounded(wide, one->member, &q.wide[k], &v.wide[k]);
    }
    return true;
}

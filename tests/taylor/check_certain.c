/* nevh tests: references by Taylor series.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "shipped.h"
#include <math.h>
#include <nevh/certain.h>
#include <nevh/reference.h>

/* The states of long doubles are those of quad precision, to what the reference
   says of itself. */
TEST(references_are_as_good_as_they_say) {
    static const struct {
        const char *scene;
        double t_end;
    } runs[] = {{"henon-heiles.nevh", 100},
                {"double-pendulum.nevh", 20},
                {"elastic-pendulum.nevh", 20},
                {"kapitza.nevh", 3}};
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        nevh_scene *scene = read_shipped(runs[i].scene);
        const nevh_system *system = nevh_scene_system(scene);
        size_t n = nevh_scene_dof(scene);
        double q[4], p[4], t_end = runs[i].t_end;
        ck_assert_int_eq(nevh_scene_start(scene, q, p), NEVH_OK);
        nevh_reference *r = nevh_reference_new(system, NULL, 0, t_end, q, p);
        ck_assert_msg(!nevh_reference_status(r), "%s",
                      nevh_reference_message(r));
        assert_says(nevh_reference_text(r), "taylor in");
        ck_assert(nevh_reference_error(r) < 1e-10);
        nevh_certain *c = nevh_certain_new(system, 0, q, p, 18);
        if (nevh_certain_status(c))
            assert_says(nevh_certain_message(c), "libquadmath");
        for (double t = t_end / 3; t <= t_end; t += t_end / 3) {
            ck_assert_int_eq(nevh_reference_state(r, t, q, p), NEVH_OK);
            if (nevh_certain_go(c, t))
                continue;
            for (size_t k = 0; k < 2 * n; k++) {
                double value = k < n ? q[k] : p[k - n];
                double by = fabs(value - nevh_certain_value(c, k));
                double rounded = fabs(value) * 0x1p-52;
                ck_assert_msg(by <= nevh_reference_error(r) *
                                            nevh_reference_range(r, k) +
                                        rounded,
                              "%s, %zu at %g: %g", runs[i].scene, k, t, by);
            }
        }
        nevh_certain_free(c);
        nevh_reference_free(r);
        nevh_scene_free(scene);
    }
}

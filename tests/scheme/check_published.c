/* nevh tests: figures that were published elsewhere.

   The harmonic oscillator k = m = 1 from q = 1, p = 0, with h = 0.2 until
   t = 500: the largest error of the energy, which is 1/2.  All but the last are
   those that Principia's tests of its symplectic integrators expect.  What may
   begin with either begins with a kick.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>

enum { STEPS = 2500 };

static int watch(void *data, size_t step, double t, const double q[],
                 const double p[]) {
    double *most = data;
    (void)step, (void)t;
    *most = fmax(*most, fabs((p[0] * p[0] + q[0] * q[0] - 1) / 2));
    return 0;
}

static double largest_error(const nevh_integrator *scheme) {
    static const nevh_oscillator params = {1, 1};
    nevh_system *s = nevh_oscillator_model->system(&params);
    nevh_stepper *stepper =
        nevh_stepper_new(s, scheme, &(nevh_options){.gradient = nevh_exact});
    double q[] = {1}, p[] = {0}, most = 0;
    nevh_observer observer = {watch, &most, 1};
    ck_assert_int_eq(nevh_run(stepper, 0, 0.2, STEPS, q, p, &observer, 1),
                     NEVH_OK);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return most;
}

static const struct {
    const nevh_integrator *const *scheme;
    double error;
} figures[] = {
    {&nevh_verlet, 5.00e-3},
    {&nevh_forest_ruth, 6.269e-5},
    {&nevh_suzuki4, 5.760e-6},
    {&nevh_mclachlan_atela4, 7.52e-7},
    {&nevh_blanes_moan4, 2.243e-7},
    {&nevh_yoshida6, 1.2825e-7},
    {&nevh_rkn6b, 1.557e-9},
    {&nevh_blanes_moan6, 2.4515e-10},
    {&nevh_suzuki_umeno8, 1.2133e-11},
    {&nevh_rkn11b, 9.149e-12},
    {&nevh_rkn14a, 6.29e-13},
    {&nevh_mclachlan_sb3a4, 2.5264e-6},
    {&nevh_mclachlan_sb3a5, 1.7055e-7},
    {&nevh_kahan_li6, 1.525e-8},
};

TEST_EACH(oscillator, sizeof figures / sizeof *figures) {
    double found = largest_error(*figures[_i].scheme);
    ck_assert_msg(
        fabs(found / figures[_i].error - 1) < 1e-3, "%s: %.6e instead of %.4e",
        nevh_integrator_name(*figures[_i].scheme), found, figures[_i].error);
}

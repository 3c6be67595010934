/* nevh tests: one stepper a thread over one system.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <nevh/scene.h>
#include <pthread.h>
#include <string.h>

enum { THREADS = 2, STEPS = 3000 };

typedef struct {
    const nevh_system *system;
    const problem *problem;
    const nevh_integrator *scheme;
    const nevh_gradient *gradient;
    double q[MOST_DOF], p[MOST_DOF];
    int status;
} job;

static void *run(void *data) {
    job *j = data;
    memcpy(j->q, j->problem->q, sizeof j->q);
    memcpy(j->p, j->problem->p, sizeof j->p);
    nevh_options options = {.gradient = j->gradient,
                            .tolerance = tolerance_for(j->scheme)};
    nevh_stepper *stepper = nevh_stepper_new(j->system, j->scheme, &options);
    j->status = nevh_run(stepper, 0, 0.002, STEPS, j->q, j->p, NULL, 0);
    nevh_stepper_free(stepper);
    return NULL;
}

static void compare_threads(job task) {
    pthread_t thread[THREADS];
    job jobs[THREADS], serial = task;
    run(&serial);
    ck_assert_int_eq(serial.status, NEVH_OK);
    for (int i = 0; i < THREADS; i++) {
        jobs[i] = task;
        ck_assert_int_eq(pthread_create(&thread[i], NULL, run, &jobs[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(thread[i], NULL);
        ck_assert_int_eq(jobs[i].status, NEVH_OK);
        ck_assert_mem_eq(jobs[i].q, serial.q, sizeof serial.q);
        ck_assert_mem_eq(jobs[i].p, serial.p, sizeof serial.p);
    }
}

TEST_EACH(threads_agree_with_serial, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b =
        fits(scheme, &double_pendulum) ? &double_pendulum : &henon_heiles;
    nevh_system *s = b->make();
    compare_threads((job){.system = s, .problem = b, .scheme = scheme});
    nevh_system_free(s);
}

/* Tapes are shared. */
TEST_EACH(scenes, 6) {
    nevh_scene *s =
        nevh_scene_parse("f", "[coordinates]\nx[1..2] = 1\n[effects]\n"
                              "kinetic = sum(i = 1..2, p_x[i]^2/2)\n"
                              "rest = x[1]^2*x[2] - x[2]^3/3 + sum(i = 1..2, "
                              "cosh(x[i])/2)\n");
    compare_threads((job){.system = nevh_scene_system(s),
                          .problem = &henon_heiles,
                          .scheme = nevh_gauss4,
                          .gradient = nevh_gradients()[_i]});
    nevh_scene_free(s);
}

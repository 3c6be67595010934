/* nevh: itself, with exact gradients and with differences of order 4, H being C
   or a text.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "nevh_systems.h"
#include "peer.h"
#include <stdlib.h>
#include <string.h>

typedef struct {
    const problem *problem;
    nevh_system *system;
    nevh_scene *scene; /* whose system it is, of formulas; or NULL */
    nevh_stepper *stepper;
    double h;
    size_t steps;
} run;

static void close_run(void *data) {
    run *r = data;
    nevh_stepper_free(r->stepper);
    nevh_system_free(r->system);
    nevh_scene_free(r->scene);
    free(r);
}

static void *open_with(const method *m, const problem *p, double setting,
                       const nevh_gradient *gradient) {
    const nevh_integrator *integrator =
        *(const nevh_integrator *const *)m->data;
    run *r = calloc(1, sizeof *r);
    if (!r)
        return NULL;
    nevh_options options = {.gradient = gradient,
                            .q = p->start,
                            .p = p->start + p->n,
                            .tolerance = m->adaptive ? setting : 0};
    r->problem = p;
    r->steps = m->adaptive ? 1 : (size_t)setting;
    r->h = p->t_end / (double)r->steps;
    r->system = nevh_system_of(p);
    r->stepper = nevh_stepper_new(r->system, integrator, &options);
    if (nevh_stepper_status(r->stepper) == NEVH_OK)
        return r;
    close_run(r);
    return NULL;
}

static void *open_exact(const method *m, const problem *p, double setting) {
    return open_with(m, p, setting, nevh_exact);
}

static void *open_numerical(const method *m, const problem *p, double setting) {
    return open_with(m, p, setting, nevh_central4);
}

/* A text, compiled where there is a compiler, which is not timed. */
static void *open_text_with(const method *m, const problem *p, double setting,
                            const nevh_gradient *gradient) {
    run *r = calloc(1, sizeof *r);
    if (!r)
        return NULL;
    nevh_options options = {.gradient = gradient,
                            .q = p->start,
                            .p = p->start + p->n,
                            .native = NEVH_NATIVE_ALWAYS,
                            .tolerance = m->adaptive ? setting : 0};
    *r = (run){.problem = p,
               .scene = nevh_scene_of(p),
               .steps = m->adaptive ? 1 : (size_t)setting};
    r->h = p->t_end / (double)r->steps;
    r->stepper =
        nevh_stepper_new(nevh_scene_system(r->scene),
                         *(const nevh_integrator *const *)m->data, &options);
    if (nevh_stepper_status(r->stepper) == NEVH_OK)
        return r;
    close_run(r);
    return NULL;
}

static void *open_text(const method *m, const problem *p, double setting) {
    return open_text_with(m, p, setting, nevh_exact);
}

static void *open_text_numerical(const method *m, const problem *p,
                                 double setting) {
    return open_text_with(m, p, setting, nevh_central4);
}

static bool run_stepper(void *data, double y[], double *seconds) {
    run *r = data;
    (void)seconds;
    memcpy(y, r->problem->start, 2 * r->problem->n * sizeof *y);
    return nevh_run(r->stepper, 0, r->h, r->steps, y, y + r->problem->n, NULL,
                    0) == NEVH_OK;
}

#define METHOD(how, id, adapts, its_order)                                     \
    {                                                                          \
        .scheme = #id, .adaptive = adapts, .open = how, .run = run_stepper,    \
        .close = close_run, .data = &nevh_##id, .order = its_order             \
    }
#define METHODS(how, ...)                                                      \
    {                                                                          \
        METHOD(how, verlet, false, 2),                                         \
            METHOD(how, mclachlan_atela4, false, 4),                           \
            METHOD(how, mclachlan_sb3a4, false, 4),                            \
            METHOD(how, mclachlan_sb3a5, false, 4),                            \
            METHOD(how, pefrl, false, 4), METHOD(how, blanes_moan4, false, 4), \
            METHOD(how, rkn6b, false, 4), METHOD(how, rkn11b, false, 6),       \
            METHOD(how, rkn14a, false, 6), METHOD(how, kahan_li8, false, 8),   \
            METHOD(how, sofroniou_spaletta10, false, 10),                      \
            METHOD(how, gauss8, false, 8), METHOD(how, gauss12, false, 12),    \
            METHOD(how, gauss16, false, 16), METHOD(how, gauss20, false, 20),  \
            METHOD(how, rk4, false, 4), METHOD(how, dopri5, false, 5),         \
            METHOD(how, dop853, false, 8), METHOD(how, dprkn12, false, 12),    \
            {.scheme = "dopri5, adaptive",                                     \
             .adaptive = true,                                                 \
             .open = how,                                                      \
             .run = run_stepper,                                               \
             .close = close_run,                                               \
             .data = &nevh_dopri5,                                             \
             .order = 5},                                                      \
            {.scheme = "dop853, adaptive",                                     \
             .adaptive = true,                                                 \
             .open = how,                                                      \
             .run = run_stepper,                                               \
             .close = close_run,                                               \
             .data = &nevh_dop853,                                             \
             .order = 8},                                                      \
            {.scheme = "dprkn12, adaptive",                                    \
             .adaptive = true,                                                 \
             .open = how,                                                      \
             .run = run_stepper,                                               \
             .close = close_run,                                               \
             .data = &nevh_dprkn12,                                            \
             .order = 12},                                                     \
            __VA_ARGS__                                                        \
    }
static const method exact[] = METHODS(open_exact, );
static const method numerical[] = METHODS(open_numerical, );
static const method text[] = METHODS(open_text, {.scheme = "taylor",
                                                 .adaptive = true,
                                                 .open = open_text,
                                                 .run = run_stepper,
                                                 .close = close_run,
                                                 .data = &nevh_taylor,
                                                 .order = 18});
static const method text_numerical[] = METHODS(open_text_numerical, );

#define NEVH_LIBRARY(its_name, of)                                             \
    {                                                                          \
        .name = its_name, .version = NEVH_BENCH_COMMIT, .ahead = true,         \
        .count = sizeof of / sizeof *of, .methods = of                         \
    }
const library nevh_library = NEVH_LIBRARY("nevh", exact);
const library nevh_numerical_library =
    NEVH_LIBRARY("nevh with differences", numerical);
const library nevh_text_library =
    NEVH_LIBRARY("nevh from text and compiled", text);
const library nevh_text_numerical_library = NEVH_LIBRARY(
    "nevh from text and compiled with differences", text_numerical);

/* nevh: model systems.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_MODELS_H
#define NEVH_MODELS_H

#include <nevh/system.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Parameters.  SI units are meant, but nothing depends on it. */
typedef struct {
    double m, k; /* mass, spring constant */
} nevh_oscillator;
typedef struct {
    double m, l, g; /* mass, length, gravity */
} nevh_pendulum;
typedef struct {
    double m, l, g; /* of both bobs and both rods */
} nevh_double_pendulum;
typedef struct {
    double m, k, l, g; /* mass, spring constant, its rest length, gravity */
} nevh_elastic_pendulum;
typedef struct {
    double m1, m2, k1, k2, coupling; /* masses, springs to the walls, between */
} nevh_coupled_oscillators;

/* A model system: H = sum of its terms, and the same H as one function. */
typedef struct {
    const char *name;
    const char *title;
    size_t n;
    const void *defaults;      /* its parameter structure, filled in */
    const double *q, *p;       /* a state to start from, n each */
    const char *const *coords; /* names of the n coordinates */
    /* A new system made of terms; params is borrowed and outlives it. */
    nevh_system *(*system)(const void *params);
    /* The whole H as one function; params as above. */
    nevh_value_fn hamiltonian;
    /* The state at time t of the orbit that passes (q0, p0) at time 0; NULL
       when there is no closed form.  Returns NEVH_OK or NEVH_EDOM. */
    int (*exact)(const void *params, double t, const double q0[],
                 const double p0[], double q[], double p[]);
} nevh_model;

NEVH_API extern const nevh_model *const nevh_oscillator_model;
NEVH_API extern const nevh_model *const nevh_pendulum_model;
NEVH_API extern const nevh_model *const nevh_double_pendulum_model;
NEVH_API extern const nevh_model *const nevh_double_pendulum_as_printed_model;
NEVH_API extern const nevh_model *const nevh_elastic_pendulum_model;
NEVH_API extern const nevh_model *const nevh_coupled_oscillators_model;

/* All models, ended by NULL. */
NEVH_API const nevh_model *const *nevh_models(void);
/* NULL when there is none of that name. */
NEVH_API const nevh_model *nevh_model_named(const char *name);

#ifdef __cplusplus
}
#endif
#endif

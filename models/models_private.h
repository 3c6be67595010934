/* nevh: what the models share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_MODELS_PRIVATE_H
#define NEVH_MODELS_PRIVATE_H

#include <nevh/body.h>
#include <nevh/models.h>

/* All models, in the order of nevh_models. */
#define NEVH__MODELS(X)                                                        \
    X(oscillator)                                                              \
    X(pendulum)                                                                \
    X(double_pendulum)                                                         \
    X(double_pendulum_as_printed)                                              \
    X(elastic_pendulum)                                                        \
    X(coupled_oscillators)

#define NEVH__MODEL_DECLARE(id) extern const nevh_model nevh__##id##_entry;
NEVH__MODELS(NEVH__MODEL_DECLARE)

/* All numbers a model's term needs are constants of its instances, taken from
   the parameters when the system is made.  So a system of a model does not
   follow later changes of its parameters, and its terms read no params. */

/* Patterns to be copied; `c` remains to be set, and where they are not the
   first ones, the indices.  The effects named are defaults. */
extern const nevh_term nevh__kinetic_term; /* p^2 / (2 c0) */
extern const nevh_term nevh__spring_term;  /* c0/2 (q - c1)^2 */
extern const nevh_term nevh__cosine_term;  /* -c0 cos q, effect "gravity" */

/* A system of these terms; whatever fails stays in its status. */
nevh_system *nevh__model_system(size_t n, const nevh_term terms[],
                                size_t count);

/* Rounds a state to double.  Returns NEVH_OK; NEVH_EDOM when it is not finite,
   and q and p are left as they were. */
int nevh__model_state(size_t n, const long double from_q[],
                      const long double from_p[], double q[], double p[]);

#endif

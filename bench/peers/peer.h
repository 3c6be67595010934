/* nevh: what the bench knows of a library.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_BENCH_PEER_H
#define NEVH_BENCH_PEER_H

#include "problems.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct method {
    const char *scheme;
    bool adaptive; /* the setting is a tolerance, else a number of steps */
    /* A run made ready, which is not timed; NULL: does not fit the problem. */
    void *(*open)(const struct method *, const problem *, double setting);
    /* From problem->start to t_end, as often as one likes; whether it got
       there.  seconds: NULL, or where a library in another process puts the
       time that it took, which the bench else takes itself. */
    bool (*run)(void *, double y[], double *seconds);
    void (*close)(void *);
    const void *data; /* of the library */
    int order;        /* 0: unknown */
} method;

typedef struct {
    const char *name;
    const char *version;
    bool ahead; /* nevh itself: no peer */
    size_t count;
    const method *methods;
    bool outside; /* times itself */
} library;

/* Weak: a library that was not found is not linked. */
#define LIBRARY extern const library __attribute__((weak))
LIBRARY nevh_library, nevh_numerical_library, nevh_text_library,
    nevh_text_numerical_library, gsl_library, boost_library, sundials_library,
    scipy_library, paper_library;

#ifdef __cplusplus
}
#endif
#endif

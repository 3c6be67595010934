/* nevh: effects that are written in C.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_CODE_PRIVATE_H
#define NEVH_CODE_PRIVATE_H

#include "scene/scene_private.h"

/* The functions that a file defines, of one instance, as <nevh/scene.h> says. */
typedef double (*nevh__code_value)(double t, const double q[], const double p[],
                                   const double c[]);
typedef void (*nevh__code_gradient)(double t, const double q[],
                                    const double p[], const double c[],
                                    double dh_dq[], double dh_dp[]);
struct nevh__code {
    void *library;
    nevh__code_value value;
    nevh__code_gradient gradient; /* NULL: none */
    uint64_t digest;              /* of the file's text */
    char *output;                 /* of the compiler, where it failed */
};

/* Compiles and loads a file; no trace stays on disk.
   what     out: what failed, a format with one %s for the file's name
   returns  whether it can be called */
bool nevh__code_load(const char *path, nevh__code *, const char **what);
void nevh__code_unload(nevh__code *);

#endif

/* nevh: inside a stepper.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_STEPPER_PRIVATE_H
#define NEVH_STEPPER_PRIVATE_H

#include "system/system_private.h"
#include <nevh/extend.h>

struct nevh_stepper {
    nevh_work work;
    nevh_options options; /* arrays are the stepper's own */
    nevh__report report;
    bool planned;
    /* What the last step returned. */
    bool has_last;
    double last_t, *last_q, *last_p;
    bool forgot;    /* the last step or run began with less than `before` */
    double *before; /* the memory before that */
    size_t taken;
    double time_lost; /* by the sum of the run's times, where steps vary */
};

/* Why a scheme does not fit the system, or NEVH_OK. */
int nevh__check_structure(nevh_stepper *);
/* A step without looking whether the state is the one last returned. */
int nevh__advance(nevh_stepper *, double t, double h, double q[], double p[]);
/* Forgets what does not belong to the state; NEVH_OK if the step may begin. */
int nevh__begin(nevh_stepper *, double t, double h, const double q[],
                const double p[]);

/* No step was taken: the memory is what it was before nevh__begin. */
void nevh__undo(nevh_stepper *);
/* Keeps the state that a step or run returns. */
void nevh__remember(nevh_stepper *, const double q[], const double p[]);

#endif

/* nevh: areas that integrators carry along.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FLOW_H
#define NEVH_FLOW_H

#include "flow_shape.h"

/* One integrator and dt, at all times. */
typedef struct {
    const char *integrator;
    double dt;
    nevh_loop *loop;           /* planned, carried */
    nevh_loop *eye[FLOW_EYES]; /* of the cat, for pictures; NULL: none */
    char *status;              /* of what is not there; NULL: all is */
    int code;
} flow_row;

typedef struct {
    plan plan;
    shape shape;
    size_t times;
    double *time;
    flow_row *row;
    size_t rows;
} flow_job;

/* True if the panels give the area to 1e-6 of it. */
bool flow_resolved(nevh_loop_area);
/* flow_plot.c: the times up to the last at which the shape of a row is drawn. */
size_t flow_drawn_times(const flow_job *, const flow_row *);
/* flow_plot.c: the shapes at all times, a row of panels an integrator.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int flow_plot(const flow_job *, const options *);

#endif

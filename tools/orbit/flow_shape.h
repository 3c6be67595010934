/* nevh: a shape of starts that is carried along.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FLOW_SHAPE_H
#define NEVH_FLOW_SHAPE_H

#include "experiment/plan.h"
#include <nevh/loop.h>

enum { FLOW_CORNERS = 7, FLOW_EYES = 2 };

typedef enum { FLOW_DISC, FLOW_BOX, FLOW_CAT, FLOW_LOOP } shape_kind;
/* In the plane of a coordinate and its momentum, or anywhere: a loop. */
typedef struct {
    const plan *plan;
    char *text; /* as given, or chosen */
    shape_kind kind;
    size_t k;               /* of the coordinate */
    double x, y;            /* the middle */
    double width, height;   /* half of them */
    list variable, formula; /* of a loop; variable: "x" or "p_x" */
    int eye;                /* 1 or 2: the curve is that eye of the cat; 0 */
    bool failed;            /* a formula; the message was printed */
} shape;

/* "disc(x = 1, p_x = 0, 0.3)", box, cat, loop; NULL: a cat round the start.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int shape_read(shape *, const plan *, const options *, const char *text);
/* A nevh_curve_fn; data is the shape. */
int shape_curve(void *data, size_t count, const double s[], double q[],
                double p[]);
/* The parameters of the corners of the curve; returns their number. */
size_t shape_corners(const shape *, double corner[FLOW_CORNERS]);

#endif

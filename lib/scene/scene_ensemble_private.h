/* nevh: inside [ensemble].
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SCENE_ENSEMBLE_PRIVATE_H
#define NEVH_SCENE_ENSEMBLE_PRIVATE_H

#include "ensemble/outcomes/outcome_private.h"
#include "scene/scene_private.h"
#include <nevh/ensemble.h>

typedef enum {
    NEVH__VARY_LIST,
    NEVH__VARY_RANGE,
    NEVH__VARY_NORMAL,
    NEVH__VARY_UNIFORM,
    NEVH__VARY_SOLVE
} nevh__variation;

/* One varied number: NAME = WHAT. */
typedef struct {
    const nevh__statement *statement;
    const char *name; /* x, p_x, v_x, g or m[2] */
    nevh__meaning is; /* coordinate, momentum, velocity or parameter */
    size_t index;     /* of the coordinate, or of the parameter's element */
    nevh__variation how;
    uint64_t count;  /* of values; 1 of draws */
    uint64_t stride; /* members until the next value, in a product */
    double a, b;     /* of range, normal, uniform */
    double *values;  /* of a list */
    /* The sides of solve(LEFT = RIGHT, from A); LEFT may be H. */
    nevh__piece left, right;
    bool energy; /* it is */
} nevh__varied;

typedef struct {
    const nevh__outcome_type *type;
    nevh__piece piece;       /* the whole */
    nevh__piece left, right; /* LEFT > RIGHT; or the formula on the left */
    bool below;              /* LEFT < RIGHT */
    size_t section;          /* of crossings and period */
} nevh__scene_outcome;

struct nevh__scene_ensemble {
    nevh__varied *varied;
    size_t n_varied;
    bool parameters; /* some are varied */
    bool solves;     /* for some */
    bool zip, draws, counted;
    uint64_t members, each; /* each: draws a grid point */
    uint64_t seed;
    nevh__scene_outcome *outcomes;
    size_t n_outcomes;
    const nevh__piece *where; /* that outcomes are given; NULL: the default */
    bool *by_velocity;        /* n: as the model's, after what is varied */
};

/* [ensemble] and what was asked for from outside. */
bool nevh__model_ensemble(nevh_scene *, nevh__scene_model *);
/* A list of outcomes, into the model's ensemble. */
bool nevh__ensemble_outcomes(nevh_scene *, nevh__scene_model *,
                             const nevh__piece *);
/* The value that a member has of what is varied. */
double nevh__varied_value(const nevh__scene_ensemble *, const nevh__varied *,
                          uint64_t member);

/* The momenta that give the velocities of the model at q, which may be another
   than the scene's.  Returns a status, recorded with what stood in the way. */
int nevh__momenta_find(const nevh__scene_model *, double q[], double p[],
                       nevh__report *);

/* Values that parameters have instead of the scene's, while a model is made. */
struct nevh__overrides {
    const nevh__scene_ensemble *of;
    const double *value; /* one for each of what is varied */
};
void nevh__override(const nevh_scene *, const char *parameter, double values[]);
/* A model with these; NULL after a message.  To be freed. */
nevh__scene_model *nevh__model_with(nevh_scene *,
                                    const struct nevh__overrides *);

#endif

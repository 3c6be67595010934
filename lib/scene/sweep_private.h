/* nevh: inside a sweep.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SWEEP_PRIVATE_H
#define NEVH_SWEEP_PRIVATE_H

#include "ensemble/own_private.h"
#include "scene/scene_ensemble_private.h"
#include <nevh/sweep.h>
#include <pthread.h>
#include <signal.h>

/* The scene with one set of the parameters that are varied. */
typedef struct {
    nevh__scene_model *model;
    bool owned; /* else it is the scene's own */
    nevh_outcome *outcomes;
    nevh_quantity stop;
    nevh__owned tapes;
    double *room;         /* of nevh__effect_not_finite */
    nevh_quantity *sides; /* LEFT - RIGHT, or RIGHT, of what is solved for */
    double *padded;       /* 2n rows of NEVH__LANES */
    nevh_field *energy;   /* values of H; NULL: not asked for */
} nevh__variant;

/* Results that wait for those before them. */
typedef struct {
    bool ready;
    nevh_member_status status;
    char *message; /* NULL: none */
    double *values;
} nevh__waiting;

struct nevh_sweep {
    nevh_scene *scene;
    nevh_sweep_options is;
    const nevh__scene_ensemble *ensemble;
    nevh__scene_outcome default_outcomes[2];
    const nevh__scene_outcome *outcomes;
    size_t n_outcomes, columns;
    char **names;                     /* columns */
    const nevh__outcome_type **types; /* columns; NULL of what is varied */
    nevh__report report;
    bool native; /* steps of the scene as it is are compiled; else why not */
    char why_native[400];

    /* A run. */
    pthread_mutex_t lock;           /* of all below, and of the scene */
    pthread_cond_t moved;           /* next or low */
    uint64_t first, next, end, low; /* low: all before are told */
    nevh_wanted_fn wanted;
    nevh_sweep_fn tell;
    void *data;
    nevh__waiting *waiting; /* NULL: the order does not matter */
    bool stopped, failed;
    uint64_t by_lane;     /* members whose lanes had constants of their own */
    nevh_chunk_fn chunks; /* where next and end come from; NULL: they stay */
    void *chunks_data;
    volatile sig_atomic_t ending;
};

/* As nevh_sweep_new.  own: of the scene's own orbit, where nothing need be varied. */
nevh_sweep *nevh__sweep_make(nevh_scene *, const nevh_sweep_options *,
                             bool own);

/* variant.c.  varied: of a member; NULL: the scene as it is. */
bool nevh__variant_make(nevh_sweep *, const double varied[], nevh__variant *,
                        nevh__report *);
void nevh__variant_free(nevh__variant *);
/* variant_alike.c: whether members of both are orbits of one system, that are run
   and looked at alike: they differ in where they start. */
bool nevh__variants_alike(const nevh_sweep *, const nevh__variant *,
                          const nevh__variant *);
/* True if both have the same run and outcomes, and systems of the same terms,
   except for numbers in formulas and constants of instances. */
bool nevh__variants_differ_in_numbers(const nevh_sweep *, const nevh__variant *,
                                      const nevh__variant *);
/* The options of an ensemble of the variant's members.  room: 2n */
nevh_ensemble_options nevh__variant_options(const nevh_sweep *,
                                            const nevh__variant *,
                                            nevh_options *, double room[]);
/* Finds a member's start from the variant's own start and the varied numbers; those
   to solve for are replaced by the solution.
   returns  NEVH_OK or a status, with a message */
int nevh__variant_start(const nevh_sweep *, const nevh__variant *,
                        double varied[], double q[], double p[], double v[],
                        nevh__report *);

/* variant_lanes.c: a system whose lanes have the numbers of variants. */
typedef struct {
    nevh__variant base; /* one of them */
    nevh_system *system;
    nevh__owned tapes;
    bool **opened;      /* a term: which numbers of its tape differ */
    double **constants; /* a term: count x nc of the system's, of the variant
                           that was asked for last */
    double **of_field;  /* those of the terms that are on */
} nevh__lane_form;
/* base: taken over.  False when memory is out. */
bool nevh__lane_form_begin(nevh__lane_form *, nevh__variant *base);
/* Numbers in which the variant differs from the base are to be those of
   lanes. */
void nevh__lane_form_see(const nevh_sweep *, nevh__lane_form *,
                         const nevh__variant *);
/* Makes the system; false when memory is out. */
bool nevh__lane_form_finish(nevh__lane_form *);
void nevh__lane_form_free(nevh__lane_form *);
/* True if a variant differs from the base only in such numbers; then its constants
   are form->of_field. */
bool nevh__lane_form_fits(const nevh_sweep *, nevh__lane_form *,
                          const nevh__variant *);

/* solve.c: finds the value of varied number i at which its sides are equal, in
   the state.  Returns whether there is one. */
bool nevh__variant_solve(const nevh_sweep *, const nevh__variant *, size_t i,
                         double q[], double p[]);

/* sweep_workers.c: the run. */

#endif

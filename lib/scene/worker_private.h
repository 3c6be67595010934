/* nevh: a thread of a sweep.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SCENE_WORKER_PRIVATE_H
#define NEVH_SCENE_WORKER_PRIVATE_H

#include "scene/sweep_private.h"

enum { NEVH__CHUNK = 256 }; /* members that a thread takes at once */

/* Members whose systems differ in numbers alone: places in the order. */
typedef struct {
    nevh__lane_form form;
    nevh_ensemble *ensemble; /* NULL: there is no such form */
    nevh__variant *own;      /* of the list's members that are under way */
    nevh__own parts;
    nevh_options options; /* of the member that was asked for last */
    double *plan_at;      /* its state to plan at: 2n */
    size_t *queue, n_queue, queue_at;
    size_t *left, n_left; /* those that are to be run apart */
    size_t n_done;        /* of the queue */
} nevh__lane_members;

typedef struct {
    nevh_sweep *sweep;
    pthread_t thread;
    nevh__variant variant;
    uint64_t *list; /* the members of a chunk */
    size_t count, at, group_end;
    double *values; /* columns of one result */
    double *varied; /* n_varied of each member of the list */
    double *q, *p, *v, *room;
    size_t *order; /* of the list, by parameters */
    /* Members that only start elsewhere: places in the list, with starts. */
    nevh__variant scene;
    nevh_ensemble *shared;
    size_t *sharing, n_sharing, shared_at;
    double *starts; /* 2n each */
    nevh__lane_members lanes;
    bool started;
} nevh__worker;

/* A member's result: what is varied, and outcomes or NULL. */
void nevh__worker_finish(nevh__worker *w, uint64_t member,
                         const double varied[], nevh_member_status status,
                         const char *message, const double outcomes[]);

/* sweep_window.c.  Tells a result, or keeps it until those before it are told;
   values: NULL of a member that is missing. */
void nevh__sweep_hand_on(nevh_sweep *, uint64_t member, nevh_member_status,
                         const char *message, const double values[]);
/* False: out of memory. */
bool nevh__sweep_window_open(nevh_sweep *);
void nevh__sweep_window_close(nevh_sweep *);
/* True if one more chunk may wait for members before it. */
bool nevh__sweep_window_has_room(const nevh_sweep *);

/* The variant with these values; NULL: those of the scene. */
bool nevh__sweep_variant(nevh_sweep *s, const double varied[], nevh__variant *x,
                         nevh__report *report);

/* Arrays for a chunk of systems of n coordinates; false: out of memory. */
bool nevh__lane_members_equip(nevh__lane_members *l, size_t n);
void nevh__lane_members_free(nevh__lane_members *l);

/* Makes the ensemble, where the sweep's members have one form. */
void nevh__lane_members_open(nevh__worker *w);

/* True if the group should run by lane, and is large enough for that. */
bool nevh__lane_members_pay(const nevh__worker *w);

/* Adds the group to the queue. */
void nevh__lane_members_add(nevh__worker *w);

/* Runs the queue and empties it; returns how many places are left, to be run
   apart. */
size_t nevh__lane_members_run(nevh__worker *w);

#endif

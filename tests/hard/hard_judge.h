/* nevh tests: hard cases, what came of them, and their judge.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_HARD_JUDGE_H
#define NEVH_HARD_JUDGE_H

#include "experiment/trial_run.h"
#include "hard/hard_cases.h"

/* What is known of a case beforehand, an or. */
enum {
    HARD_MIXED = 1,      /* H is no T(p) + V(q) */
    HARD_BLACK_BOX = 2,  /* H is a C function without derivatives */
    HARD_FRICTION = 4,   /* there is some */
    HARD_EDGE = 8,       /* the orbit meets a singularity, or H's end */
    HARD_NOISE = 16,     /* values of H are not reproducible */
    HARD_ESCAPE = 32,    /* the orbit goes to infinity in finite time, or does
                            so once it is a little off */
    HARD_RETURN = 64,    /* forward and back again */
    HARD_ENDLESS = 128,  /* more steps than the budget allows */
    HARD_ANY_STEP = 256, /* dt is beyond reason */
    HARD_KINK = 512,     /* H has no second derivative somewhere */
    HARD_REST = 1024,    /* nothing moves */
    HARD_SHORT = 2048    /* ends before its slow motion turns */
};

typedef struct {
    hard_case given; /* of nevh hard; without a scene: `make` */
    unsigned facts;
    nevh_system *(*make)(void); /* one degree of freedom, from (1, 0) */
} hard_known;
/* A case of nevh hard, or of the tests alone, by number; given.name is NULL
   after the last. */
hard_known hard_known_at(size_t);

typedef struct hard_orbit hard_orbit;

/* A case made ready, and what its orbit is like. */
typedef struct {
    hard_known known;
    nevh_scene *scene;
    nevh_system *own; /* made by `make` */
    const nevh_system *system;
    size_t n;
    double *q, *p;
    double t, dt, t_end, gradient_step;
    bool balance;
    double frequency, fastest_at; /* the largest along the orbit, and when */
    double pace;       /* the larger of that and of all rates of growth */
    double peak;       /* largest effect over the energy's scale */
    double scale;      /* of the energy */
    double rounding;   /* of the energy, where q, p and t are rounded once */
    hard_orbit *orbit; /* NULL: nobody knows where the orbit leads */
} hard_subject;
/* Of the hard cases, which are beside the scenes, or of the scenes; NULL. */
nevh_scene *hard_scene(const char *name);
int hard_open(hard_subject *, const hard_known *); /* as scene_open */
void hard_close(hard_subject *);

typedef enum {
    HARD_NONE,  /* not explained: there must be no such row, */
    HARD_WRONG, /* nor one that keeps its energy on a wrong orbit */
    HARD_BOUNDED,
    HARD_DRIFTS,
    HARD_UNSTABLE,
    HARD_REFUSED,
    HARD_FAILED,
    HARD_VERDICTS
} hard_verdict;
const char *hard_verdict_name(hard_verdict);

/* What came of one case, scheme and gradient. */
typedef struct {
    const nevh_integrator *scheme;
    const char *gradient;
    int order;           /* to expect */
    int status;          /* of planning, or of the run */
    bool planned, whole; /* whole: all steps that were asked for */
    bool sound;          /* numbers finite, and the state, and a reason given */
    size_t steps;
    double asked; /* steps */
    nevh_energy_report energy;
    double defect; /* HARD_RETURN: distance to the start; NAN */
    double floor;  /* of the energy error, from rounding and gradients */
    double state_error, state_bound, state_at; /* where it is the largest part
                                                  of its bound; NAN: unknown */
    double state_floor; /* from the same, over the time of the orbit */
    double frequency;   /* at the fastest state that this run went through */
    double fastest_at;  /* or the case's */
    double limit;       /* nevh_stability_limit */
    double bound;       /* of the energy error, by theory */
    char *reason;       /* the library's */
    hard_verdict verdict;
    char *happened;
} hard_result;
/* Between these a scheme has so many seconds of computing; then the tool ends with a
   message, since a step that does not return cannot be taken back. */
void hard_begin(const char *name, const nevh_integrator *, double seconds);
void hard_end(void);
/* budget  evaluations of H and its gradient, after which a run ends */
void hard_run(const hard_subject *, double budget, hard_result *);
double hard_work(const nevh_stepper *); /* in these */
/* Whether theory keeps the energy in bounds. */
bool hard_keeps(const hard_result *);
/* How much larger errors are by what the scheme does besides following H. */
double hard_haste(const hard_result *);
void hard_judge(const hard_subject *, hard_result *);
void hard_result_free(hard_result *);

/* hard_state.c: where the orbit of a case leads, and how far a run is off.
   returns  NULL when no reference can be had */
hard_orbit *hard_orbit_new(const hard_subject *);
void hard_orbit_free(hard_orbit *); /* NULL is allowed */
/* By how much the flow enlarges an error at most, over its time; INFINITY before that is
   found, NAN where there is no orbit. */
double hard_orbit_growth(const hard_orbit *);
/* Finds that growth, unless steps are so long that errors have no bound. */
void hard_orbit_follow(const hard_subject *, const nevh_integrator *);
typedef struct hard_state hard_state;
/* To watch a planned run of a scheme, with a tolerance if it adapts.
   returns  NULL where there is no orbit */
hard_state *hard_state_new(const hard_subject *, const hard_result *,
                           nevh_field *, double tolerance);
size_t hard_state_every(const hard_state *); /* steps between looks */
/* A nevh_observe_fn; data is the hard_state. */
int hard_state_observe(void *, size_t step, double t, const double q[],
                       const double p[]);
void hard_state_take(hard_state *, hard_result *); /* frees it */

#endif

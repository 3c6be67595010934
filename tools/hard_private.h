/* nevh hard: cases, what came of them, and the judge.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_HARD_PRIVATE_H
#define NEVH_HARD_PRIVATE_H

#include "pace.h"

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
    HARD_KINK = 512      /* H has no second derivative somewhere */
};

typedef struct {
    const char *name;
    const char *scene;    /* of scenes/ or of the hard cases; NULL: `make` */
    const char *settings; /* "NAME=VALUE; -EFFECT"; NULL: none */
    double dt, t_end;     /* 0: the scene's */
    unsigned facts;
    nevh_system *(*make)(void); /* one degree of freedom, from (1, 0) */
} hard_case;
/* Ended by one without a name. */
extern const hard_case hard_cases[];

/* A case made ready, and what its orbit is like. */
typedef struct {
    const hard_case *is;
    nevh_scene *scene;
    nevh_system *own; /* made by `make` */
    const nevh_system *system;
    size_t n;
    double *q, *p;
    double t, dt, t_end, gradient_step;
    bool balance;
    double frequency, fastest_at; /* the largest along the orbit, and when */
    double peak;                  /* largest effect over the energy's scale */
    double rounding; /* of the energy, where q, p and t are rounded once */
} hard_subject;
int hard_open(hard_subject *, const hard_case *); /* as scene_open */
void hard_close(hard_subject *);

typedef enum {
    HARD_NONE, /* not explained: there must be no such row */
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
    int status;          /* of planning, or of the run */
    bool planned, whole; /* whole: all steps that were asked for */
    bool sound;          /* numbers finite, and the state, and a reason given */
    size_t steps;
    double asked; /* steps */
    nevh_energy_report energy;
    double defect;     /* HARD_RETURN: distance to the start; NAN */
    double floor;      /* of the energy error, from rounding and gradients */
    double frequency;  /* at the fastest state that this run went through */
    double fastest_at; /* or the case's */
    double limit;      /* nevh_stability_limit */
    double bound;      /* of the energy error, by theory */
    double seconds;
    char *reason; /* the library's */
    hard_verdict verdict;
    char *happened;
} hard_result;
void hard_run(const hard_subject *, double budget, hard_result *);
void hard_judge(const hard_subject *, hard_result *);
void hard_result_free(hard_result *);

#endif

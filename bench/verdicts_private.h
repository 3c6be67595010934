/* nevh bench: verdicts on the energy against what longer runs show.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_VERDICTS_PRIVATE_H
#define NEVH_VERDICTS_PRIVATE_H

#include "experiment/row.h"

/* verdicts_run.c: the error of the energy in a run that is several times as
   long as the row's, in windows of equal length.  It steps and takes values
   itself: nothing of what judges is used. */
enum { WINDOWS = 240 };
typedef struct {
    float least, most, mean;
    float met; /* the largest sum of |effects| seen, over the scale */
} window;

typedef struct {
    uint64_t key;   /* of scene, scheme, gradient, dt, t_end and spans */
    double spans;   /* as long as so many of the row's runs */
    double length;  /* the same, or fewer where the scene says so */
    double reached; /* so many of them were run before the scheme failed */
    double
        work; /* as nevh_counts_seconds, of the part that is as long as the row, or of
                      what was run of it */
    double effect;    /* the largest effect at the start over the scale */
    double noise;     /* rounding of one value of H over the scale */
    double wandering; /* by rounding in gradients, over one of the row's runs */
    bool afforded;    /* or the rest says nothing but `work` */
    bool prepared;    /* to be judged by, in memory alone */
    window window[WINDOWS];
    float
        own_allowed; /* of rounding, in as much as the row runs; 0: not known */
} long_run;

typedef struct {
    const plan *plan;
    nevh_stepper *stepper;
    nevh_field *field; /* of exact derivatives */
    const nevh_integrator *scheme;
    uint64_t scene; /* a hash of its text */
    double dt, t_end;
    double scale; /* of the row's errors; 0: that of the start */
} subject;

uint64_t hash_of(uint64_t before, const void *data, size_t size);
/* Of the cache, or run and added to it.
   work  that it may take, as nevh_counts_seconds */
const long_run *long_run_of(const subject *, double spans, double work);
/* Whether it was: else it says nothing. */
bool is_afforded(const long_run *, double work);
/* The file that holds runs, which long_run_of reads and adds to; without it
   they are made anew. */
void runs_open(const char *file);
void runs_close(void);

/* verdicts_label.c: what the run says, and theory of the scheme. */
typedef enum {
    IS_BOUNDED,  /* swings, at most */
    IS_ROUNDING, /* grows, but by no more than rounding does */
    IS_LARGE,    /* above the energy itself, and level, but never back */
    IS_WALKING,  /* grows, not along a line */
    IS_DRIFTING, /* along a line */
    IS_GROWING,  /* either */
    IS_SPENT,    /* lost what there was to lose, or jumped, and stays there */
    IS_SETTLED,  /* the same, and small */
    IS_UNSTABLE, /* above the energy itself within the row's run */
    WILL_BE_SO,  /* later */
    IS_OPEN,     /* cannot be told from the longest run */
    IS_CARRIED,  /* grows as the motion itself does, no faster */
    LABELS
} label;
const char *label_name(label);

/* DRIVEN: of the first two, where H reads t or there is friction. */
typedef enum { SYMPLECTIC, KEEPING, DRIVEN, RUNGE_KUTTA, OTHER, GROUPS } group;
group group_of(const subject *);

typedef struct {
    label is;
    const long_run *run, *shortest; /* that says so: the longest */
} truth;
/* May ask for runs yet longer.
   doubted  asks for them anyway */
truth truth_of(const subject *, double spans, double work, bool doubted);
char *truth_evidence(const truth *);
/* Whether that verdict is right where that is true. */
bool is_right(label, const char *verdict);

#endif

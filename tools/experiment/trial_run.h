/* nevh: the rates of an orbit, and the steps that these allow.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TRIAL_RUN_H
#define NEVH_TRIAL_RUN_H

#include "row.h"
#include <nevh/chaos.h>

/* stability.c: why a run became unstable. */
/* The largest frequency, or rate of growth, that an orbit's states have, and
   when. */
typedef struct {
    nevh_rates *rates;
    double rate, rate_at;
    double frequency, frequency_at; /* of frequencies alone */
} largest_rates;
/* A nevh_observe_fn; data is the largest_rates. */
int largest_rates_observe(void *, size_t step, double t, const double q[],
                          const double p[]);
/* The rates of a run up to its end, its failure, or an energy error above `scale`
   (0: the scale of the energy); with the options of the run, whose q and p are its
   start. `rates` is freed. */
largest_rates stability_rates(const nevh_system *, const nevh_integrator *,
                              const nevh_options *, double scale, double dt,
                              double t_end);
/* True if h w = x is beyond that limit of stability of the scheme. */
bool stability_exceeded(const nevh_integrator *, double limit, double x);
/* The likely cause of trouble at these rates, in a run as long as `span`; NULL where
   none is known. */
char *stability_cause(const nevh_integrator *, double limit, double dt,
                      double span, const largest_rates *);
/* The same of each unstable row of compare. */
void stability_words(const plan *, const row rows[], size_t count, list *words);

/* suggested_step.c: steps with which unstable and drifting rows keep an error of 1 % to
   the end of the run.
   cost  a few seconds an integrator at most, as nevh_counts_seconds */
bool needs_shorter_step(const row *);
void suggested_step_words(const plan *, const row rows[], size_t count,
                          list *words);

/* smoothness.c: whether H is smooth on the way of its orbit, as far as 5000 series
   go. */
typedef enum {
    SMOOTHNESS_UNKNOWN, /* H has no Taylor series */
    SMOOTHNESS_NONE,
    SMOOTHNESS_ALL
} smoothness;
/* why  out, of SMOOTHNESS_NONE: where it is not */
smoothness smoothness_on_way(const plan *, char **why);
/* A note where it is not smooth. */
void smoothness_notes(const plan *, list *notes);

/* A state on the orbit, 2n. */
typedef struct {
    double t;
    const double *z;
} trial_place;

/* trial_run.c: what a short trial run says of a run. */
typedef struct {
    double frequency, frequency_at; /* 0: none is known */
    double rate, rate_at; /* the larger of that and of rates of growth */
    double drive;         /* the largest frequency in t; 0: H reads no time */
    const char *driver;   /* whose */
    bool plane;           /* one degree of freedom, H without time: no chaos */
    nevh_chaos_finding chaos; /* unless that; of a longer time, too */
    double length;            /* time */
    double noise;             /* of the gradient: relative energy error; NAN */
    double wrong, wrong_at;   /* largest error of the gradient, relative to the
                                 largest derivative; when */
    bool rounded;             /* as rounding of H explains */
    double
        lost; /* largest error of a derivative relative to its own largest size */
    size_t lost_variable; /* whose; coordinates first */
    double cancelled,
        cancelled_at; /* the same of the exact one, by rounding alone */
    bool rough; /* H is not smooth on its way; false until somebody looks */
    trial_place *place; /* some, and that of `rate` last */
    size_t places;
    double edge; /* of H: distance in lengths; INFINITY: none is near */
    size_t edge_variable; /* coordinates first */
    double edge_at, edge_time;
    char *failure; /* NULL, or why the orbit could not be followed */
} trial_run;
/* chaos    whether the indicators are asked for
   cost     1e8 evaluations of terms, and two times nevh_chaos_find */
trial_run trial_run_new(const plan *, bool chaos);
/* trial_run_words.c */
void trial_run_words(const plan *, const trial_run *, list *notes);
/* The verdict for a scheme with that limit of stability at steps of dt; NULL: none. */
const char *trial_run_verdict(const trial_run *, double limit, double dt);

#endif

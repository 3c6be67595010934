/* nevh: the same question, asked of finer steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_CONFIRM_H
#define NEVH_CONFIRM_H

#include <nevh/run.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A statement about H holds at finer steps, else it is one about the steps.
   These plan the finer run within a budget.  How the finer run is made: */
typedef enum {
    NEVH_FINER_NONE = 0,
    NEVH_FINER_TAYLOR = 1,   /* by Taylor series */
    NEVH_FINER_ADAPTIVE = 2, /* by dop853 with a tolerance of 1e-12 */
    NEVH_FINER_STEPS = 4     /* by the same scheme at half the step, or at a
                                sixteenth of its tolerance */
} nevh_finer_kind;

/* A run of one orbit whose result is to be confirmed. */
typedef struct {
    const nevh_integrator *integrator;
    const nevh_options *options; /* as its stepper's; q and p, n each, are the
                                    start; width is ignored */
    double t0, dt;
    size_t steps;
    unsigned kinds; /* an or of nevh_finer_kind; 0: all.  Statements about the
                       error of the scheme need NEVH_FINER_STEPS alone */
    double budget;  /* of what the run cost; 0: a half */
} nevh_finer_question;

/* The finer run of a question.  One thread at a time. */
typedef struct nevh_finer nevh_finer;

/* Chooses the first kind, in the order above, that the system allows (formulas
   that are analytic for Taylor series) and that costs no more per time than half
   the step does; else the first that the system allows.  Costs are those of
   nevh_counts_seconds, measured over a thirtieth of the run.  Gradients are exact where all terms bring them.
   returns  to be freed with nevh_finer_free; NULL only when memory is out.
            Carries NEVH_EINVAL (no start, step or count), or the refusal of the
            last kind that was tried
   The system and the options' arrays are borrowed; the system must not be
   changed.
   cost     a thirtieth of the run, some four times */
NEVH_API nevh_finer *nevh_finer_new(const nevh_system *,
                                    const nevh_finer_question *);
NEVH_API void nevh_finer_free(nevh_finer *); /* NULL is allowed */
/* The status of planning; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_finer_status(const nevh_finer *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_finer_message(const nevh_finer *);

NEVH_API nevh_finer_kind nevh_finer_how(const nevh_finer *);
/* "taylor", "dop853", "verlet, dt = 0.05"; "" where there is none. */
NEVH_API const char *nevh_finer_text(const nevh_finer *);
/* Integrator, options and step of the finer run, for callers with steppers of their
   own; NULL and 0 if there is none.  Taylor series take the step of the question;
   dop853, which lands on the end of each step, takes 16 of them, and nevh_run_at
   gives the states between. */
NEVH_API const nevh_integrator *nevh_finer_integrator(const nevh_finer *);
NEVH_API const nevh_options *nevh_finer_options(const nevh_finer *);
NEVH_API double nevh_finer_dt(const nevh_finer *);
/* The part of the question's time that the budget is likely to allow, 0 ... 1. */
NEVH_API double nevh_finer_part(const nevh_finer *);

/* The finer run, from the start of the question: as nevh_run_until of a stepper
   of its own, until t_end, the budget or an observer ends it.
   q, p     in and out, n each
   reached  out: the time of the last state; NULL: not wanted
   returns  as nevh_run_until; NEVH_STOPPED, too, where the budget is spent */
NEVH_API int nevh_finer_run(nevh_finer *, double t_end, double q[], double p[],
                            const nevh_observer observers[], size_t n_observers,
                            double *reached);
/* The stepper that takes it, borrowed; NULL where there is none. */
NEVH_API nevh_stepper *nevh_finer_stepper(nevh_finer *);

/* True if two values with standard errors may be the same: |a - b| is within three
   errors of the difference.  An error that is not finite agrees with nothing.
   Thread-safe. */
NEVH_API bool nevh_agree(double a, double a_error, double b, double b_error);

#ifdef __cplusplus
}
#endif
#endif

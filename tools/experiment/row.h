/* nevh: one run of compare, and what is said of many.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ROW_H
#define NEVH_ROW_H

#include "plan.h"

/* A bound of an error; the run ends if the error passes it. */
typedef struct {
    double most;
    bool by_state;
    double until;         /* out: the last time at which the error kept it */
    bool broken, unknown; /* out: since then; unknown: there is no error */
} error_bound;

/* row.c: one run of compare. */
typedef struct {
    const char *integrator, *gradient;
    const nevh_integrator *scheme;
    double dt, tolerance; /* 0: fixed steps */
    double nominal_dt;    /* before match_row */
    double step;          /* that the run was given, dt being the mean */
    size_t group;         /* rows of one gradient and dt */
    int order, failed;    /* failed: of the exit status */
    size_t steps;
    char *status;
    bool by_state, observable; /* its error that counts is of those */
    bool native;               /* the steps whose time was taken are compiled */
    bool ran, over_limit; /* there are numbers; its work passed work_limit */
    bool broken;          /* ran, as an unstable one, until it failed */
    nevh_energy_report energy;
    double followed; /* lengths of the run that the verdict is from; 0: its own
                        alone */
    nevh_energy_report longer; /* then */
    bool open;                 /* its own leaves the verdict open */
    nevh_counts counts;
    double work;             /* by its counts: the same on every machine */
    double observed_seconds; /* seconds, observers included */
    double seconds, spread; /* median, and half of what the middle half spans */
    double fastest;         /* the shortest of all times */
    double passed;          /* when a pole had been passed; NAN */
    const char *passed_effect; /* whose; NULL */
    double stopped;            /* where the scene's `stop` said; NAN: nowhere */
    double t_end;              /* where it ended */
    double observed_order;     /* NAN: unknown */
    double state_error;        /* NAN: unknown or meaningless */
    double observable_error;   /* the same */
    char state_unknown[300]; /* why; "" where it is known, or no run's fault */
    double symplecticity_error, reversal_error;
    nevh_shadow_report shadow; /* without samples: its scheme has none */
    double *changes; /* of invariants, the largest; NULL: not asked for */
    struct envelope *errors;  /* of the energy; NULL: not asked for */
    error_bound *error_bound; /* NULL: none */
    double *energies; /* errors of the energies of the plan's; NULL: unknown */
} row;
void row_run(const plan *, row *);
/* row_list.c: every integrator with every gradient, and every dt or tolerance. */
typedef struct {
    row *row;
    size_t count;
} row_list;
row_list rows_of(const plan *);
/* Creates the observer of the energy of a row's run. */
nevh_energy *row_energy(const plan *, const row *, const nevh_stepper *);
/* The same, for a caller that sets its scale, which takes an orbit to find. */
nevh_energy *row_energy_unscaled(const plan *, const row *,
                                 const nevh_stepper *);
/* follow.c: where the run leaves the verdict open, from a longer one, as far as
   the budget goes. */
void row_follow(const plan *, row *);
/* True if its energy drifts, as far as is known: a run that is too short to decide
   has the property of its scheme. */
bool row_drifts(const row *);
/* The time at which it will end, by a run without observers; the start if it has no
   numbers. */
double row_end(const plan *, const row *);
/* Finds the time at which a row that ran in a hurry became unstable. */
void row_finish(const plan *, row *);
/* Since those before. */
nevh_counts row_counts(const nevh_stepper *, nevh_counts before);
/* stepper_cache.c: planned for that row, by whom it is given back. */
nevh_stepper *row_stepper(const plan *, const row *, bool balance);
/* Compiles the steps of all rows that allow it, or of none, so that times are
   comparable: as it pays for the rows that are timed first, all together, whatever
   the cache holds.
   alone   true: it has to pay in one run of one row, as in nevh run; else in all
           runs of all */
void rows_choose_native(const plan *, row *const rows[], size_t count,
                        bool alone);
/* As row_stepper, of a row that is to be timed. */
nevh_stepper *row_stepper_to_time(const plan *, const row *);
void row_stepper_keep(const plan *, const row *, bool balance, nevh_stepper *);
/* row_time.c: the seconds of rows that ran, medians of so many rounds, in which
   they are run one after the other, so that what else the machine does falls
   upon all alike.
   whole  else of each a first part that takes long enough, as much longer as
          the whole works more */
enum { ROUNDS = 5 };
void rows_time(const plan *, row *const rows[], size_t count, size_t rounds,
               bool whole);
/* stop.c: of the rows that stopped, how many did, when. */
void stop_notes(const plan *, const row rows[], size_t count, list *notes);
/* The columns that all records begin with. */
#define RECORD_COLUMNS                                                         \
    "scene,integrator,order,symplectic,gradient,dt,steps,status,"              \
    "max_energy_error,rms_energy_error,final_energy_error,"                    \
    "energy_drift,state_error,hamiltonian_evals,gradient_evals,"               \
    "sweeps,seconds,verdict,observed_order,seconds_spread"
/* records.c: rows as the columns of CSV and JSON. */
table *records(const plan *, const row rows[], size_t count);
/* Says on stderr which row failed and why; TOOL_FAILED. */
int row_fails(const plan *, const row *);
/* row_notes.c: whether two slopes of errors over steps are of one order: they differ most
   where an error changes its sign, and next to rounding. */
bool orders_agree(double a, double b);
/* Steps so close that their errors tell of their phases, not of the order. */
bool steps_are_close(double a, double b);
/* observed_order of rows with the same scheme beside each other, where that of a pair of
   steps next to it agrees or there is no other. */
void observe_orders(row rows[], size_t count);
void row_notes(const options *, const plan *, const row rows[], size_t count,
               list *notes);
/* Notes the rows whose steps are compiled. */
void native_notes(const plan *, const row rows[], size_t count, list *notes);
/* time_words.c: rows whose steps pass over what H does in time; and over a
   pole. */
void time_words(const plan *, const row rows[], size_t count, list *words);
void passed_words(const plan *, const row rows[], size_t count, list *words);
/* verdict.c: the table in words. */
void verdict_words(const plan *, const row rows[], size_t count, list *words);

/* state.c: makes the reference of a plan up to some time, after which rows have
   state errors; TOOL_OK, or TOOL_USAGE with the message printed. */
int plan_reference(plan *, double end);
void state_notes(const plan *, list *notes);
#define STATE_OUT_OF_STEP 0.5 /* an error */
bool state_out_of_step(const row *);
void state_show(table *, const plan *, const row *);
void state_words(const plan *, const row rows[], size_t count, list *words);

/* observable.c: what --observable names.  Made ready by a plan that has a
   reference: TOOL_OK, or TOOL_FAILED with the message printed. */
int plan_observe(plan *, const char *formula);
void observable_notes(const plan *, list *notes);
typedef struct {
    const plan *plan;
    double worst; /* error so far */
} observable;
void observable_show(table *, const plan *, const row *);
/* As nevh_pair_fn. */
/* Takes the error of an outcome, by another run of a row that ran. */
void outcome_compare(const plan *, row *);
void observable_compare(observable *, double t, const double q[],
                        const double p[], const double reference[]);

/* energies.c */
void energies_begin(energies *);
void energies_compare(energies *, double t, const double q[], const double p[],
                      const double reference[]); /* as nevh_pair_fn */
double *energies_result(const energies *);
void energies_columns(table *, const plan *, bool is_table);
void energies_put(table *, const plan *, const row *, bool is_table);
void energies_notes(const plan *, list *notes);
/* A sentence on the worst of them where the total energy does not show it;
   NULL: there is none. */
char *energies_unseen(const plan *, const row *);
void energies_words(const plan *, const row rows[], size_t count, list *words);

/* match.c: the dt with which the row costs as much as verlet with its dt, where
   the plan asks for that. */
void match_row(const plan *, row *);
/* True if that is unknown, or no dt is as cheap. */
bool match_unmatched(const plan *, const row *);
bool match_dearer(const plan *, const row *);

/* diagnostics.c: of a plan that asks for them. */
typedef struct invariants invariants;
invariants *invariants_new(const plan *);
int invariants_observe(void *, size_t step, double t, const double q[],
                       const double p[]);
double *invariants_result(invariants *); /* frees it */
void diagnose_row(const plan *, row *);
void diagnostics_columns(table *, const plan *, bool is_table);
void diagnostics_record(table *, const plan *, const row *);
void diagnostics_show(table *, const plan *, const row *);

/* shadow.c: the modified H of rows whose scheme has one; NULL of others. */
nevh_shadow *row_shadow(const plan *, const row *);
/* A nevh_observe_fn that stops no run. */
int shadow_observe(void *, size_t step, double t, const double q[],
                   const double p[]);
double
shadow_error(const row *); /* in units of the scale; NAN: there is none */
void shadow_show(table *, const row *);
void shadow_words(const plan *, const row rows[], size_t count, list *words);
/* compare_plot.c: as plot_write. */
int compare_plot(const options *, const plan *, const row rows[], size_t count);

#endif

/* nevh: what the parts of the command share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TOOL_H
#define NEVH_TOOL_H

#include <nevh/nevh.h>
#include <nevh/scene.h>
#include <stdio.h>

/* Exit statuses. */
enum { TOOL_OK, TOOL_FAILED, TOOL_USAGE };

/* words.c: texts and lists of them.  Where memory is out the program ends. */
typedef struct {
    char **item;
    size_t count;
} list;
void list_add(list *, const char *text); /* a copy */
__attribute__((format(printf, 2, 3))) void list_print(list *,
                                                      const char *format, ...);
void list_split(list *, const char *text); /* at commas */
void list_free(list *);
void *tool_allocate(size_t count, size_t size); /* zeros */
__attribute__((format(printf, 1, 2))) char *text_print(const char *format, ...);
/* The item that `name` may have been meant for; NULL when none is close. */
const char *list_closest(const list *, const char *name);
/* "nevh: " and the message on stderr; returns TOOL_USAGE. */
__attribute__((format(printf, 1, 2))) int tool_refuse(const char *format, ...);
/* The same for a name that is none of the list: "unknown KIND NAME", and the
   closest. */
int tool_unknown(const char *kind, const char *name, const list *known);

/* table.c: rows of texts and numbers. */
typedef enum { FORMAT_TABLE, FORMAT_CSV, FORMAT_JSON } table_format;
typedef struct table table;
table *table_new(void);
void table_free(table *);
/* The next column; lines of the title are separated by \n. */
void table_column(table *, const char *title);
/* The next cell of the row.  NULL, and numbers that are not finite, leave it
   empty. */
void table_text(table *, const char *text);
void table_number(table *, double number); /* all its digits */
/* A number as it is to be shown, set to the right. */
__attribute__((format(printf, 2, 3))) void table_shown(table *,
                                                       const char *format, ...);
/* Begins a group of rows, set off by an empty line. */
void table_group(table *);
/* The whole: lines before and after are set off by "# " in CSV (those after
   are left out there), and called notes and verdict in JSON. */
typedef struct {
    list before, after;
    table *table;
} page;
void page_print(const page *, table_format, FILE *);
void page_free(page *);

/* sample.c */
extern const char scene_sample[];

/* The commands, as bits. */
enum {
    FOR_COMPARE = 1,
    FOR_CHECK = 2,
    FOR_EFFECTS = 4,
    FOR_LIST = 8,
    FOR_RUN = 16,
    FOR_NEW = 32,
    FOR_COST = 64,
    FOR_GRADIENTS = 128,
    FOR_RECOMMEND = 256,
    FOR_SECTION = 512,
    FOR_HARD = 1024
};

/* options.c: the command line. */
typedef enum { MATCH_SCENE, MATCH_STEPS, MATCH_WORK } matching;
typedef enum { PLOT_PHASE, PLOT_ENERGY, PLOT_CONFIGURATION } plot_kind;
typedef struct {
    list operands, settings, integrators, gradients; /* settings: see below */
    list sections;
    double *dt, *at, *tolerance;
    size_t dts, ats, tolerances;
    double t_end;                                    /* NAN: the scene's */
    double gradient_step, energy_error, state_error; /* 0: not given */
    size_t every, samples, repeats;                  /* 0: not given */
    table_format format;
    matching match;
    plot_kind plot_kind;
    const char *file, *plot, *plot_script, *transform, *resume, *from;
    bool formatted; /* --format was given */
    bool quiet, portable, all, by_state, diagnostics, impact, allow_code;
    bool help, version;
    unsigned long long used; /* a bit an option */
} options;
/* A setting is '+', '-' or '=' and an effect to switch on or off, or an
   assignment, in the order given.
   returns  TOOL_OK or TOOL_USAGE, the message being printed */
int options_read(options *, int argc, char **argv);
/* That all options given are for this command. */
int options_check(const options *, unsigned which);
void options_free(options *);
void options_help(FILE *, unsigned which);

/* output.c: a file that is there when it is whole, or stdout. */
typedef struct {
    FILE *stream;
    char *name, *temporary;
} output;
int output_open(output *, const char *name); /* NULL: stdout */
/* That it can be opened, as far as can be told without changing it.  To be
   called while none is open. */
int output_check(const char *name);
/* Renames, or, unless it is to be kept, removes.  Returns `status`, or
   TOOL_USAGE when writing failed. */
int output_close(output *, int status);
/* Opens what -o says, prints, closes. */
int output_page(const options *, const page *, int status);

/* scenes.c: scenes by file or name, changed as the options say. */
/* returns  TOOL_OK, or TOOL_USAGE with the message printed and *scene NULL */
int scene_open(nevh_scene **scene, const options *);
int scene_open_named(nevh_scene **scene, const char *name, const options *);
/* Names of installed scenes, sorted; with their files when `files` is not
   NULL. */
void scenes_installed(list *names, list *files);
/* The file of a scene in a folder given from that of the installed ones; NULL
   when there is none. */
char *scene_file(const char *beside, const char *name);

/* plan.c: the rows to run, from options, scene and defaults. */
typedef struct {
    nevh_scene *scene;
    const nevh_system *system;
    const nevh_scene_run *run;
    const char *name;
    size_t n;
    double *q, *p; /* at t_start */
    double t_end;
    const double *dt, *tolerance;
    size_t dts, tolerances;
    list integrators, gradients;
    double gradient_step;
    const double *gradient_steps; /* as in nevh_options */
    size_t repeats;               /* of timed runs; 0: chosen */
    bool portable, friction, time, balance;
    bool hurried;    /* rows are to be finished later, and timed then */
    double patience; /* work that a row may take; 0: any */
    bool match_work, diagnostics;
    nevh_reference *reference; /* NULL: not asked for, or there is none */
    char *no_reference;        /* why there is none */
} plan;
/* returns  TOOL_OK, or TOOL_USAGE with the message printed */
int plan_make(plan *, const options *);
void plan_free(plan *);
nevh_options plan_options(const plan *, const char *gradient);
/* The scheme of "gauss4" or "gauss4+transform"; NULL for other names. */
const nevh_integrator *plan_scheme(const char *name, bool *transformed);
/* The transform that it is to be planned with: of names with "+transform", and
   of schemes that choose their own times; NULL: none. */
const nevh_system *plan_transform(const plan *, const char *name);
/* The integrator of that name, planned for the first gradient. */
nevh_stepper *plan_stepper(const plan *, const char *name);
/* The first integrator that fits, planned for the first gradient; NULL, with a
   message, when none does. */
nevh_stepper *plan_first(const plan *, const nevh_integrator **);
/* Title, effects, structure of H, span. */
void plan_notes(const plan *, list *notes);
char *plan_structure(const plan *);

/* impact.c */
int impact(const options *, plan *);

/* row.c: one run of compare. */
typedef struct {
    const char *integrator, *gradient;
    const nevh_integrator *scheme;
    double dt, tolerance; /* 0: fixed steps */
    double nominal_dt;    /* before match_row */
    size_t group;         /* rows of one gradient and dt */
    int order, failed;    /* failed: of the exit status */
    size_t steps;
    char *status;
    bool ran, late; /* there are numbers; patience was at its end */
    nevh_energy_report energy;
    nevh_counts counts;
    double work;            /* by its counts: the same on every machine */
    double seconds, spread; /* median, and half of what the middle half spans */
    double observed_order;  /* NAN: unknown */
    double state_error;     /* NAN: unknown or meaningless */
    double symplecticity_error, reversal_error;
    double *changes; /* of invariants, the largest; NULL: not asked for */
    struct envelope *errors; /* of the energy; NULL: not asked for */
} row;
void row_run(const plan *, row *);
/* What that many evaluations and steps cost, in seconds of no machine in
   particular: what is decided by it is decided alike on all. */
double row_work(const plan *, const nevh_counts *, size_t steps);
/* Of a row that ran in a hurry: its time again, and when it became unstable.
   dt       as the row was run with
   repeats  0: chosen */
void row_finish(const plan *, row *, double dt, size_t repeats);
/* The time of one run more of it. */
double row_seconds(const plan *, const row *, double dt);
/* Planned as for that row. */
nevh_stepper *row_stepper(const plan *, const row *, bool balance);
/* records.c: rows as the columns of CSV and JSON. */
table *records(const plan *, const row rows[], size_t count);
/* compare.c: observed_order, of rows with the same scheme beside each other;
   notes of settings, gradients, scale and what holds for some rows. */
void observe_orders(row rows[], size_t count);
void row_notes(const options *, const plan *, const row rows[], size_t count,
               list *notes);
/* compare.c, verdict.c */
void verdict_words(const plan *, const row rows[], size_t count, list *words);

/* state.c: makes the reference of a plan, after which rows have state errors;
   TOOL_OK, or TOOL_USAGE with the message printed. */
int plan_reference(plan *);
void state_notes(const plan *, list *notes);
bool state_out_of_step(const row *);
void state_show(table *, const plan *, const row *);
void state_words(const row rows[], size_t count, list *words);

/* match.c: the dt with which the row costs as much as verlet with its dt, where
   the plan asks for that. */
void match_row(const plan *, row *);
/* Whether that cannot be told, or no dt is as cheap. */
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

/* compare_plot.c, run_plot.c: as plot_write.  The latter makes a run of its
   own, with the first dt and gradient. */
int compare_plot(const options *, const plan *, const row rows[], size_t count);
int run_plot(const options *, const plan *, const char *integrator);
int run_plot_check(const options *, const plan *); /* as plot_check */

/* stability.c: why a run became unstable. */
/* The largest frequency, or rate of growth, that an orbit's states have, and
   when. */
typedef struct {
    nevh_rates *rates;
    double frequency, t;
} pace;
/* A nevh_observe_fn; data is the pace. */
int pace_observe(void *, size_t step, double t, const double q[],
                 const double p[]);
/* That of a run up to its end, its failure, or an energy error above `scale`
   (0: that of the energy); with the options of the run, whose q and p are its
   start.  Its rates are gone. */
pace stability_pace(const nevh_system *, const nevh_integrator *,
                    const nevh_options *, double scale, double dt,
                    double t_end);
/* Whether h w = x is beyond what a scheme of that limit bears. */
bool stability_exceeded(const nevh_integrator *, double limit, double x);
/* The likely cause of trouble at that pace, and a step or schemes to take; NULL
   where none is known. */
char *stability_cause(const nevh_integrator *, double limit, double dt,
                      const pace *);
/* The same of each unstable row of compare. */
void stability_words(const plan *, const row rows[], size_t count, list *words);

/* preflight.c: what a short flight ahead says of a run. */
typedef struct {
    double frequency, fastest_at; /* as a pace; 0: nothing is known */
    double growth;                /* largest Lyapunov exponent; 0: no chaos */
    double flown;                 /* time */
    double noise; /* of the gradient: relative energy error; NAN */
    double edge;  /* of H: distance in lengths; INFINITY: none is near */
    size_t edge_variable; /* coordinates first */
    double edge_at, edge_time;
    char *failure; /* NULL, or why the orbit could not be followed */
} preflight;
/* failure is to be freed.
   cost     about a second at most */
preflight preflight_fly(const plan *);
void preflight_words(const plan *, const preflight *, list *notes);
/* Of a scheme, its limit of stability given, at h w = x; NULL: nothing. */
const char *preflight_verdict(double limit, double x);

typedef int command(const options *);
command compare, list_what, check, effects, run_scene, section, new_scene;
command cost, recommend, gradients, hard;

#endif

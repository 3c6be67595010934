/* nevh: what the parts of nevh run share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TRAJECTORY_H
#define NEVH_TRAJECTORY_H

#include "experiment/plan.h"
#include <signal.h>

/* lines.c: a file that only ever holds whole lines, or stdout.

   Each write(2) ends with a line; where one fails the file is cut back to the
   last whole line.  (A process that is killed in such a write may leave part of
   a line that goes over the end of a page; reopen cuts that off.) */
typedef struct {
    const char *name; /* NULL: stdout */
    int file;
    bool regular; /* it can be cut, and continued */
    bool stuck;   /* writing has failed */
    char *text;   /* not yet written */
    size_t used, capacity;
    uint64_t bytes, digest; /* of what is written */
    output claimed;
    bool waits; /* what was there stays until lines are written */
} line_file;
/* Both return TOOL_OK or, with a message, TOOL_USAGE; another process must not
   be writing the same file.  Open replaces the file when the first lines could be
   written; reopen cuts it back to its first `bytes`, which must have that digest. */
int lines_open(line_file *, const char *name);
int lines_reopen(line_file *, const char *name, uint64_t bytes,
                 uint64_t digest);
__attribute__((format(printf, 2, 3))) void lines_print(line_file *,
                                                       const char *format, ...);
/* Behind "# ", also where the text has several lines. */
void lines_comment(line_file *, const char *text);
/* Writes what there is, which ends with a line. */
int lines_flush(line_file *);
/* At the end of a line: writes when there is much. */
int lines_end(line_file *);
void lines_close(line_file *);

/* resume.c: FILE.state, from which an interrupted run goes on. */
typedef struct {
    uint64_t bytes, digest; /* of the file of lines */
    uint64_t step, row;     /* taken; to be written next */
    double t, written;      /* written: the time of the last row */
} progress_of_run;
typedef struct {
    progress_of_run at;
    size_t n, memory_size;
    double *q, *p; /* n each */
    void *memory;  /* of the stepper */
} run_state;
/* Replaces the file at once.
   lasting  also if the machine stops
   returns  TOOL_OK or, with a message, TOOL_USAGE */
int state_save(const char *name, const char *settings, const run_state *,
               bool lasting);
/* Reads into arrays of the sizes that are given.  A file that is not whole, or
   of other settings, is refused with a message. */
int state_load(const char *name, const char *settings, run_state *);
void state_remove(const char *name);

/* trajectory.c: an orbit, and its rows. */
typedef enum { BY_STEPS, BY_SAMPLES, BY_TIMES } row_choice;
typedef struct {
    row_choice by;
    size_t every, count; /* count: rows, where they are not by steps */
    double *time;        /* BY_TIMES */
} row_times;
/* Columns after those of the scene. */
typedef struct {
    list titles;
    void (*fill)(void *data, double t, const double q[], const double p[],
                 double values[]);
    void *data;
} more_columns;
/* The output of rows and remarks: lines, a page, or a function of states. */
typedef struct {
    line_file *lines;
    page *page; /* NULL: to the lines */
    /* NULL: to the page or the lines; returns TOOL_OK, or what ends the run. */
    int (*take)(void *data, double t, const double q[], const double p[]);
    void *data;
    const more_columns *more; /* NULL: none */
    bool quiet;               /* without remarks on the lines */
    bool mute;                /* failures are not printed */
} row_output;
typedef struct trajectory trajectory;
/* integrator  as plan_scheme takes it
   stepper     of that integrator, and borrowed; plan and times, too */
trajectory *trajectory_new(const plan *, const char *integrator, nevh_stepper *,
                           const row_times *, row_output);
void trajectory_free(trajectory *);
/* All columns' names. */
void trajectory_header(trajectory *);
typedef struct {
    const volatile sig_atomic_t *signal; /* not 0: the run is to end */
    int (*save)(void *data); /* called a few times a second; NULL: none */
    void *data;
    bool progress; /* to be shown on stderr */
} trajectory_watch;
/* Runs until the rows are written, `stop` is reached, a step fails, or a signal
   came.
   returns  TOOL_OK, TOOL_FAILED, TOOL_USAGE; messages are printed */
int trajectory_follow(trajectory *, const trajectory_watch *);
/* True if that was for another reason than a signal. */
bool trajectory_finished(const trajectory *);
/* To and from what is saved; arrays are the trajectory's. */
run_state *trajectory_state(trajectory *);
int trajectory_restore(trajectory *);

/* run_plot.c: as plot_write and plot_check; draws runs of their own, with the
   first dt and gradient unless several are asked for.
   rows     that options ask for
   returns  TOOL_FAILED, too, where a run failed */
int run_plot(const options *, const plan *, const char *integrator,
             const row_times *rows);
int run_plot_check(const options *, const plan *);

#endif

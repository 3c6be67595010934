/* nevh: the members of a scene's [ensemble], and their outcomes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SWEEP_H
#define NEVH_SWEEP_H

#include <nevh/ensemble.h>
#include <nevh/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Adds `count` lines to [ensemble], "NAME = WHAT", or replaces those of that
   name:
   WHAT is a list of formulas, range(A, B, N), normal(MEAN, DEVIATION),
   uniform(A, B) or solve(FORMULA = FORMULA, from A), NAME a coordinate, p_NAME, v_NAME or a parameter; or a setting
   (count, combine, seed).
   returns  as nevh_scene_set */
NEVH_API int nevh_scene_vary(nevh_scene *, const char *const lines[],
                             size_t count);
/* A list of outcomes, instead of the scene's: "state, first(x > 1)".
   returns  as nevh_scene_set */
NEVH_API int nevh_scene_set_outcomes(nevh_scene *, const char *outcomes);

/* The number of members of the scene's [ensemble]; 0: nothing is varied. */
NEVH_API uint64_t nevh_scene_members(const nevh_scene *);
/* True if [ensemble] gives `name`, "x", "p_x", "v_x" or "g", to each member, so that
   what the scene or nevh_scene_set_start says of it has no effect on members.
   cost     a look through a list */
NEVH_API bool nevh_scene_varies(const nevh_scene *, const char *name);
/* The initial state of a member; n each.
   returns  NEVH_OK; NEVH_EINVAL where there is none of that number, or where
            parameters that are varied change more than the start; NEVH_EMAXITER
            or NEVH_EDOM, with a message, where it has
            no start; NEVH_ENOMEM
   cost     as that of making the tapes of what is solved for */
NEVH_API int nevh_scene_member_start(nevh_scene *, uint64_t member, double q[],
                                     double p[]);

/* Options of a sweep; zeros are the defaults, and of the scene's own orbit. */
typedef struct {
    const nevh_integrator *integrator;
    bool transformed;              /* by the scene's transform of time */
    const nevh_gradient *gradient; /* NULL: central4 */
    double gradient_step;          /* as in nevh_options */
    const double *gradient_steps;
    double dt, t_end; /* 0: those of [run], the first dt, with the member's
                         parameters */
    double tolerance;
    bool portable;
    size_t width, threads;    /* 0: chosen; 1 */
    bool ordered;             /* results come in order of members */
    nevh_native_use native;   /* as in nevh_options */
    const char *native_cache; /* the same; borrowed while the sweep lives */
    size_t substeps;          /* of nevh_respa; 0: the scene's */
} nevh_sweep_options;

/* Outcomes of the scene's own orbit, from where it starts.
   values   out, count of them: of the scene's outcomes, or of what
            nevh_scene_set_outcomes has set; NAN where unknown, such as the period
            of what never returns
   returns  NEVH_OK; a status with a message of the scene: NEVH_EINVAL where there
            are not `count` outcomes, the refusal of the scheme, or the status of
            the step that failed
   cost     that of planning two steppers and of one run */
NEVH_API int nevh_scene_own_outcomes(nevh_scene *, const nevh_sweep_options *,
                                     double values[], size_t count);

/* A sweep over the members of a scene.  Member i is a function of the scene's
   text, of what was set from outside, of the seed and of i alone; so is its
   result, to the last bit, whatever the threads, the width and the order. */
typedef struct nevh_sweep nevh_sweep;

/* scene    with an [ensemble], or lines by nevh_scene_vary; borrowed, not to be
            changed or asked meanwhile
   returns  to be freed with nevh_sweep_free; NULL only when memory is out;
            carries NEVH_EINVAL where nothing is varied or there is no dt or
            t_end, or the refusal of the scheme
   cost     that of planning a stepper */
NEVH_API nevh_sweep *nevh_sweep_new(nevh_scene *, const nevh_sweep_options *);
NEVH_API void nevh_sweep_free(nevh_sweep *); /* NULL is allowed */
NEVH_API int nevh_sweep_status(const nevh_sweep *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_sweep_message(const nevh_sweep *);
NEVH_API uint64_t nevh_sweep_members(const nevh_sweep *);
/* The number of columns: varied numbers, then outcomes ("phi", "last(phi)",
   "energy_error"). */
NEVH_API size_t nevh_sweep_columns(const nevh_sweep *);
/* The number of varied columns. */
NEVH_API size_t nevh_sweep_varied(const nevh_sweep *);
/* NULL when k is out of range. */
NEVH_API const char *nevh_sweep_column(const nevh_sweep *, size_t k);
/* True if column k is a nevh_verdict. */
NEVH_API bool nevh_sweep_is_verdict(const nevh_sweep *, size_t k);
/* True if column k is a value of a quantity, such as its mean: for a member that is
   done it is NAN only if the quantity is undefined at some time.  Other columns may
   be NAN for other reasons, such as the time of an event that never happens. */
NEVH_API bool nevh_sweep_is_of_values(const nevh_sweep *, size_t k);

/* True if members whose orbits stand side by side take compiled steps.
   why  out, may be NULL: what is in the way; where steps are compiled, of which
        members, if not of all; else ""; of the sweep */
NEVH_API bool nevh_sweep_native(const nevh_sweep *, const char **why);

typedef enum {
    NEVH_MEMBER_MISSING, /* not yet run */
    NEVH_MEMBER_DONE,
    NEVH_MEMBER_FAILED,  /* refused, or a step failed */
    NEVH_MEMBER_NO_START /* H is not finite there, or no momenta give the
                            velocities */
} nevh_member_status;

typedef struct {
    uint64_t member;
    nevh_member_status status;
    const char *message;  /* why it is not done, or "" */
    const double *values; /* nevh_sweep_columns; NAN where unknown */
} nevh_sweep_result;
/* Is called with each member, by one thread at a time.  A result other than 0
   stops the sweep: orbits under way are left. */
typedef int (*nevh_sweep_fn)(void *data, const nevh_sweep_result *);
/* The output of nevh_sweep_keep: one record a member, as in files of nevh sweep: a
   byte (a nevh_member_status), seven bytes that are 0, and one double a column. */
typedef struct {
    unsigned char *records; /* borrowed */
    uint64_t first, count;  /* the members that they are of: others are left */
    size_t columns;         /* nevh_sweep_columns */
    uint64_t failed;        /* out: how many members told are not done, */
    uint64_t failed_member; /* the first of them that was told, */
    char message[400];      /* and why, cut short */
} nevh_sweep_records;
/* A nevh_sweep_fn; data is a nevh_sweep_records.  It never stops a sweep. */
NEVH_API int nevh_sweep_keep(void *records, const nevh_sweep_result *);
/* Selects the members to run; NULL: all.  Called by several threads at once. */
typedef bool (*nevh_wanted_fn)(void *data, uint64_t member);

/* Runs members first ... first + count - 1.
   returns  NEVH_OK, also where members failed; NEVH_STOPPED where not all were
            told of; NEVH_ENOMEM
   cost     memory does not grow with the number of members.  Where parameters
            are varied, the scene's system is made, and a stepper planned, for
            each set of them that changes more than the start, a millisecond or
            two for a small one */
NEVH_API int nevh_sweep_run(nevh_sweep *, uint64_t first, uint64_t count,
                            nevh_wanted_fn wanted, nevh_sweep_fn tell,
                            void *data);
/* Asks for the next members to be run.
   first, count   out
   returns        whether there are any */
typedef bool (*nevh_chunk_fn)(void *data, uint64_t *first, uint64_t *count);
/* The same of members that are asked for, chunk after chunk: of what several
   processes share, such as a counter of MPI.
   chunks   is called by one thread at a time, and never while `tell` is
   returns  as nevh_sweep_run; NEVH_EINVAL where results are to be in order */
NEVH_API int nevh_sweep_run_chunks(nevh_sweep *, nevh_chunk_fn chunks,
                                   void *chunks_data, nevh_wanted_fn wanted,
                                   nevh_sweep_fn tell, void *data);
/* No member begins any more: nevh_sweep_run leaves those under way and returns
   NEVH_STOPPED, soon.  May be called from a signal handler, from another thread or
   from `tell`; what was asked for before a run begins counts for that run. */
NEVH_API void nevh_sweep_stop(nevh_sweep *);

#ifdef __cplusplus
}
#endif
#endif

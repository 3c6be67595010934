/* nevh: steps as native code: formulas, their gradients and the scheme written
   as one C function, compiled by what compiler there is, and loaded.
   SPDX-License-Identifier: GPL-3.0-or-later

   Native steps give the bits of the steps that they stand for.  They look at
   the state that a step gives, and where that is not finite they leave it, and
   the step to the kernel, which knows what went wrong. */
#ifndef NEVH_NATIVE_PRIVATE_H
#define NEVH_NATIVE_PRIVATE_H

#include "kernels/adaptive_step.h"
#include "native/steps/steps_call.h"
#include "native/writer_private.h"
#include "work/work_private.h"
#include <nevh/extend.h>
#include <nevh/run.h>
#include <stdatomic.h>

/* Takes all steps, or none, and returns how many of them can be taken. */
typedef size_t (*nevh__compiled_steps)(const nevh__steps_call *);

/* Steps in use, which appear once a compiler in the background is done. */
typedef _Atomic(nevh__compiled_steps) nevh__steps_at_work;
typedef struct nevh__background nevh__background;

enum { NEVH__WHY_NATIVE = 400 };
/* Why there are none: "no native steps: ..." or "no program of such steps: ...".
 */
#define NEVH__ONLY_FAMILIES                                                    \
    "only splitting, Tao, Runge-Kutta, Nystroem, Gauss, Lobatto, adaptive "    \
    "Verlet steps and steps by parts can be"

typedef struct nevh__native {
    void *library;
    nevh__background *compiler; /* at work; NULL: none is */
    nevh__steps_at_work steps;  /* NULL: not yet; of series, never: the kernel
                                   takes them */
    char why[NEVH__WHY_NATIVE]; /* why a compiler at work made none */
    double *numbers, *weights, *times;
    nevh__lane_numbers
        *own; /* of lanes: numbers are a table a vector of them */
    size_t own_count, pitch; /* pitch: of the tables */
    size_t together;         /* lanes in a vector of orbits */
    size_t characters;       /* of its text */
    double *room; /* of states that are too long for the stack, or NULL */
    size_t kicks, drifts;   /* of a step */
    bool compared, differs; /* with the kernel's steps, or series */
    bool watches;           /* it writes what is watched */
    bool keeps, kicks_first;
    bool whole;          /* what is kept is dH/dq and dH/dp */
    size_t flags_at;     /* halves of a state before what tells that */
    size_t stages;       /* of an implicit step; 0: it is explicit */
    bool adapts;         /* kicks and drifts are those of a trial */
    bool own_time;       /* a step's length is its own: times[0] */
    size_t first_drifts; /* before the first of a substep's trials */
    uint64_t *kick_values, *drift_values; /* n_terms each, of one of them */
} nevh__native;

/* Text of steps, and of the slopes before them: of a splitting, and of an
   explicit Runge-Kutta method. */
bool nevh__write_splitting(nevh__writer *, nevh_work *);
bool nevh__write_runge_kutta(nevh__writer *, nevh_work *);
bool nevh__write_nystrom(nevh__writer *, nevh_work *);
bool nevh__write_stages(nevh__writer *, nevh_work *);
bool nevh__write_tao(nevh__writer *, nevh_work *);
bool nevh__write_parts(nevh__writer *, nevh_work *);
/* Steps that choose their length, one at a time: it is left in `times`. */
bool nevh__write_adaptive_verlet(nevh__writer *, nevh_work *);
/* Text of steps under a rule, after that of two functions of one orbit,
       double take_first(const double *N, double t, double h, double *y,
                         double *lost, double *first)
       double take_trial(const double *N, double t, double h, double *y,
                         double *lost, double *first, double *ahead,
                         double *change, double *error, double *coarse)
   which return 0 if all is well: the slope at y, and what the other stages come
   to; ahead: the last stage's slope.  For readers both are without N. */
void nevh__write_adaptive(nevh__writer *, const nevh_work *,
                          const nevh__adaptive_rule *);
/* Text of steps, or of steps under a tolerance, by the header of a method of so many
   stages, which keeps no slope. */
void nevh__write_stage_driver(nevh__writer *, const nevh_work *,
                              const char *const header[], size_t stages);
/* True if steps adapt to a tolerance. */
static inline bool nevh__adapts(const nevh_work *w) {
    return w->integrator->adaptive && w->options->tolerance > 0;
}
/* Text of the coefficients of series, a nevh__series_code. */
bool nevh__write_series(nevh__writer *, nevh_work *);
/* Weights of all kicks and drifts, and the times of their slopes; to be freed.
   false when memory is out. */
bool nevh__splitting_tables(const nevh_splitting *, double **weights,
                            double **times);
/* Text of steps, if the scheme has one; else false, and w->refusal. */
bool nevh__native_write(nevh__writer *, nevh_work *);
/* A program, or functions, that take the steps; false: as above. */
bool nevh__write_program(nevh__writer *, nevh_work *, const nevh_program *);

/* program_words.c: names without what they have in the library, in place. */
void nevh__names_shorten(char *text);
/* All but functions and values that nothing else asks for.  Cuts the text into
   lines; false: memory is out. */
bool nevh__write_used(nevh__writer *, char *text);

/* Makes w->native if that is wanted, possible and worth while; `why`: else what
   is in the way, or "". */
void nevh__native_plan(nevh_work *, const nevh__watched *,
                       char why[NEVH__WHY_NATIVE]);
/* Has what nevh__native_plan would compile of all compiled side by side, so that it
   is in the cache.  why: out, of each: what is in the way, or "". */
void nevh__native_prepare(nevh_work *const[], size_t count,
                          char (*why)[NEVH__WHY_NATIVE]);
/* True if there is one, or a compiler is at work, and the steps foreseen make up
   for compiling it. */
bool nevh__native_pays(const nevh_work *);
/* Waits for a compiler at work.
   returns  whether steps are native; NULL is allowed */
bool nevh__native_await(nevh__native *);
/* nevh_stepper_native_saves, of the steps foreseen. */
double nevh__native_saves(nevh_work *);
/* True if steps of orbits that have constants of their own can be compiled. */
bool nevh__native_by_lane(const nevh_work *);
void nevh__native_lane_take(nevh_work *, size_t lane); /* its numbers anew */
void nevh__native_free(nevh__native *);                /* NULL is allowed */
/* Takes up to `steps` steps of h, step i from t0 + i h, and counts them: the
   first is number `from`.
   returns  how many; the next is to be taken by the kernel */
size_t nevh__native_run(nevh_work *, double t0, double h, size_t from,
                        size_t steps, double q[], double p[]);

/* The same, by the times, states and room of a call, where it writes what is watched
   after step i of them: to room + i rows width, a row each; 0 where nothing is watched,
   or was not yet compared. */
size_t nevh__native_watch(nevh_work *, nevh__steps_call);

/* One step, native where it can be. */
static inline int nevh__native_step(nevh_work *w, double t, double h,
                                    double q[], double p[]) {
    if (w->native && nevh__native_run(w, t, h, 0, 1, q, p))
        return NEVH_OK;
    return nevh__work_step(w, t, h, q, p);
}

/* A compiled text, from the cache or made.
   cache    a folder; "": none; NULL: the usual one
   seconds  that a compiler may take; 0: only what is in the cache
   why      out: what is in the way
   returns  a library to be closed with dlclose; NULL: there is none */
void *nevh__native_load(const char *source, const char *cache, double seconds,
                        char why[NEVH__WHY_NATIVE]);

/* Has a text compiled that is not in the cache, while the caller goes on.  A thread
   waits for the compiler, and before that for one that another program has at work at
   the same text; each for so many seconds at most.
   cache, seconds  as above
   steps           set once they are loaded
   returns         to be ended; NULL: there is no cache */
nevh__background *nevh__background_begin(const char *source, const char *cache,
                                         double seconds,
                                         nevh__steps_at_work *steps);
/* True once it has loaded steps, or failed. */
bool nevh__background_is_done(nevh__background *);
/* Waits for it.
   wanted   else other programs are not waited for, and a compiler only if it is at
            work: for the next time
   why      out: what was in the way
   returns  as nevh__native_load */
void *nevh__background_end(nevh__background *, bool wanted,
                           char why[NEVH__WHY_NATIVE]);

/* Compiles those texts that are not in the cache, and keeps them there: as many side
   by side as there are processors.
   cache, seconds, why  as above
   returns  how many were done; the first of the others was in the way */
size_t nevh__native_build(char *const sources[], size_t count,
                          const char *cache, double seconds,
                          char why[NEVH__WHY_NATIVE]);

/* The folder of compiled steps, which is made; to be freed.  NULL: it cannot
   be made, is not a folder, or others may write to it. */
char *nevh__cache_folder(const char *given, char why[NEVH__WHY_NATIVE]);
/* True if a file is as nevh__cache_store wrote it. */
bool nevh__cache_is_whole(const char *path);
/* Copies a file to the cache under its name there; older ones go where it is
   full.  Returns whether it is there. */
bool nevh__cache_store(const char *folder, const char *from, const char *to);

#endif

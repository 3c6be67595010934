/* nevh: scenes: H as text, with everything a run needs.
   SPDX-License-Identifier: GPL-3.0-or-later

   A scene is a text file (UTF-8) of sections [scene], [parameters],
   [coordinates], [definitions], [effects], [friction], [invariants],
   [observables], [picture], [sections], [labels], [ensemble], [run] and
   [integrator NAME], each with lines
   KEY = VALUE; # begins a comment.  [coordinates] and [effects]
   are required.
   All formulas are checked when the scene is read, also those that only some
   commands ask for.

   One thread at a time may use a scene; its system may be shared while the
   scene is not changed. */
#ifndef NEVH_SCENE_H
#define NEVH_SCENE_H

#include <nevh/certain.h>
#include <nevh/gradient.h>
#include <nevh/integrator.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct nevh_scene nevh_scene;

/* Reads a file, or text under a name for its messages.
   returns  the scene, to be freed with nevh_scene_free; NULL only when memory
            is out; carries NEVH_EINVAL or NEVH_EFAILED (not readable)
            otherwise: the message is FILE:LINE:COLUMN: error: ..., the line,
            and a caret under the column, or FILE: error: ... where the file
            cannot be read; NEVH_EINVAL where the path or the text is NULL
   name     instead of FILE; copied, as the text is; NULL: "scene"
   cost     linear in the text and in the instances of all sums */
NEVH_API nevh_scene *nevh_scene_read(const char *path);
NEVH_API nevh_scene *nevh_scene_parse(const char *name, const char *text);
NEVH_API void nevh_scene_free(nevh_scene *); /* NULL is allowed */

/* Effects may be written in C: NAME = file("term.c", WHAT, IT, READS).  That
   file, beside the scene, defines

       double value(double t, const double q[], const double p[],
                    const double c[]);

   and may define derivatives, which the gradient `exact` asks for:

       void gradient(double t, const double q[], const double p[],
                     const double c[], double dh_dq[], double dh_dp[]);

   q, p and c are the coordinates, momenta and parameters that are listed (x,
   x[2], all of an array), each in the order of the list; t is 0 unless it is
   listed.  file("term.c") alone is handed all coordinates and momenta.

   Such an effect runs what the scene's author wrote: it is refused unless the
   reader allows it.  The file is compiled by what the environment's CC says,
   else cc, when its effect is on, or first switched on; a compiler's errors are
   part of the message.  Functions must be thread-safe where steppers of several
   threads share the system. */
typedef struct {
    bool allow_code; /* compile and run C code that the scene names */
    /* Effects to switch before any code is compiled, in that order: "+NAME" on,
       "-NAME" off.  NULL: as the scene says. */
    const char *const *effects;
    size_t n_effects;
} nevh_scene_options;
/* As nevh_scene_read; NULL options are zeros. */
NEVH_API nevh_scene *nevh_scene_read_with(const char *path,
                                          const nevh_scene_options *);
/* The status of reading or of the last call that can fail (set, enable,
   start); NEVH_ENOMEM for NULL. */
NEVH_API int nevh_scene_status(const nevh_scene *);
/* The message to that status, or ""; never NULL.  Lines are separated by
   newlines; none is at the end. */
NEVH_API const char *nevh_scene_message(const nevh_scene *);

/* Changes that make the system anew: a parameter ("NAME=FORMULA"; what depends
   on it follows), and an effect on or off.  An array takes a list, or one value
   for all.
   returns  NEVH_OK; NEVH_EINVAL when there is none of that name or the formula
            is wrong (the message calls the line `assignment`), NEVH_EDOM,
            NEVH_ENOMEM.  On failure the scene is as before and can still be
            used.  A scene that was not read keeps its status.
   cost     of set: as that of reading; all that was borrowed from the scene,
            apart from texts of lines, is made anew */
NEVH_API int nevh_scene_set(nevh_scene *, const char *assignment);
NEVH_API int nevh_scene_enable(nevh_scene *, const char *effect, bool on);
/* Sets the initial state, in place of that of [coordinates]: "x=FORMULA",
   "p_x=FORMULA" or "v_x=FORMULA", where formulas may use parameters; of an array
   "x[2]=...", "x[1..3]=...", "x[i = 1..3]=...", or "x=..." for all, as a list or
   one value for all.  A momentum replaces an initial velocity, and the reverse.
   nevh_scene_write writes the scene without it.
   returns  as nevh_scene_set */
NEVH_API int nevh_scene_set_start(nevh_scene *, const char *assignment);
/* The value of a formula of parameters, as [run] takes them for numbers.
   returns  NEVH_OK; NEVH_EINVAL or NEVH_EDOM with a message (which calls the
            line `assignment`); NEVH_ENOMEM */
NEVH_API int nevh_scene_number(nevh_scene *, const char *formula,
                               double *number);

/* The scene as text: its own lines with their comments, in which parameters
   that were set and effects that were switched have what they have now.  Read
   again it is the same scene, to the last bit of its orbits.
   path     of the file that it is for: names of C files are changed to be found
            from that folder, which must exist; NULL: they stay
   returns  text, to be freed with free(); lines end with newlines; NULL when
            memory is out, or the scene was not read */
NEVH_API char *nevh_scene_write(const nevh_scene *, const char *path);

NEVH_API const char *nevh_scene_title(const nevh_scene *);  /* "" if none */
NEVH_API const char *nevh_scene_source(const nevh_scene *); /* "" if none */
/* 0 when the scene was not read. */
NEVH_API size_t nevh_scene_dof(const nevh_scene *);
/* "phi", "x[3]"; NULL when k is out of range. */
NEVH_API const char *nevh_scene_coordinate(const nevh_scene *, size_t k);
/* Which coordinates are elements of one array: the number of the first of them,
   the same for all; k itself where it is no array's, or out of range. */
NEVH_API size_t nevh_scene_array(const nevh_scene *, size_t k);
/* The text of a label ("t", "energy", a coordinate); "" if there is none.
   x[3] has that of x unless it has one of its own. */
NEVH_API const char *nevh_scene_label(const nevh_scene *, const char *name);
/* The file of the i-th effect that is written in C, whether it is on or not; to
   be freed with free.  NULL: there are no more, or memory is out. */
NEVH_API char *nevh_scene_code_path(const nevh_scene *, size_t i);
/* A number that scenes share which say the same, up to comments and space, with
   the same parameters and transform set, effects on and texts of C code loaded;
   others hardly do. */
NEVH_API uint64_t nevh_scene_digest(const nevh_scene *);

/* The system, effects switched as the scene says, friction included.  Owned by
   the scene and valid until it is changed or freed; NULL when the scene was not
   read.  Every term brings values, blocks and an exact gradient; C code has
   what it defines. */
NEVH_API const nevh_system *nevh_scene_system(nevh_scene *);
/* The same, where numbers that are computed, such as 1/3, pi or G*m[1]*m[2], are
   sums of doubles, which a Taylor series takes with all their digits.  A step
   takes longer than of the other system.
   returns  borrowed until the scene changes; NULL with a status and a message of
            the scene: NEVH_ENOMEM; NEVH_EINVAL where a formula is too long with
            these numbers written out; the scene was not read
   cost     the first time, that of reading the scene anew */
NEVH_API const nevh_system *nevh_scene_exact_system(nevh_scene *);
/* The orbit of that system from the scene's start, for nevh_certain_go.  Numbers
   that are written, as 0.1, are the doubles nearest to them; what is computed of
   them - parameters, starts, momenta of velocities, friction, times - has those of
   quad precision; errors count what rounding leaves of differences.
   cost     the first time, that of reading the scene anew twice
   digits   as of nevh_certain_new
   returns  to be freed with nevh_certain_free, before the scene changes; NULL
            with a status and a message of the scene, as above, or NEVH_EMAXITER
            where momenta of velocities have no more digits than doubles */
NEVH_API nevh_certain *nevh_scene_certain(nevh_scene *, int digits);
/* The number that a formula of parameters is, as number + rest; a NULL formula
   is t_end.
   returns  NEVH_OK, or a status with a message of the scene */
NEVH_API int nevh_scene_exact_number(nevh_scene *, const char *formula,
                                     double *number, long double *rest);
/* The state at t_start, n each; initial velocities are solved for momenta, with
   the effects that are on.
   returns  NEVH_OK; NEVH_EMAXITER when no momenta give these velocities (the
            message says which line asks for them); NEVH_EDOM when an effect
            that is on is not finite there; NEVH_ENOMEM */
NEVH_API int nevh_scene_start(nevh_scene *, double q[], double p[]);

/* [run], with defaults filled in; names are as written.  Lists are empty where
   nothing is given and the default depends on H: dt and integrators. */
typedef struct {
    double t_start, t_end; /* t_end: NAN where none is given */
    size_t dts, integrators, gradients, tolerances;
    const double *dt, *tolerance;
    const char *const *integrator, *const *gradient;
    double gradient_step;         /* 0: auto, or by name: */
    const double *gradient_steps; /* 2n, coordinates first, 0: auto; or NULL */
    double energy_scale;          /* 0: from H */
    nevh_native_use native;
    bool match_work;       /* match = work */
    const char *reference; /* NULL: none named */
    const char *transform; /* formula; NULL: none */
    size_t substeps;       /* of respa; 0: not given */
} nevh_scene_run;
/* Valid as long as the system; NULL when the scene was not read. */
NEVH_API const nevh_scene_run *nevh_scene_run_settings(nevh_scene *);
/* The schemes of [integrator NAME], in their order.  Valid as long as the system;
   NULL: there are no more. */
NEVH_API const nevh_integrator *nevh_scene_integrator(const nevh_scene *,
                                                      size_t i);
/* One of these by its name, else as nevh_integrator_named. */
NEVH_API const nevh_integrator *nevh_scene_integrator_named(const nevh_scene *,
                                                            const char *name);
/* s(q, p) of the transform as a system; NULL if there is none. */
NEVH_API const nevh_system *nevh_scene_transform(nevh_scene *);
/* Another transform than that of the scene, if it has one.
   returns  as nevh_scene_set; all that was borrowed is made anew */
NEVH_API int nevh_scene_set_transform(nevh_scene *, const char *formula);

/* Values that are shown, drawn and monitored, at a state of n coordinates and
   momenta.

   Formulas become tapes when their values are first asked for; that allocates,
   later calls do not.  v_NAME is dH/dp_NAME of the effects that are on.  A
   value outside of a function's domain is NAN.
   returns  NEVH_OK; NEVH_EINVAL where i is out of range, or with a message
            where a formula has more than 2^20 operations; NEVH_ENOMEM; the
            status of a scene that was not read */
typedef enum {
    NEVH_OBSERVABLES,
    NEVH_INVARIANTS /* without those that an effect which is on breaks */
} nevh_shown;
NEVH_API size_t nevh_scene_shown_count(const nevh_scene *, nevh_shown);
/* In the order of the scene; NULL when i is out of range. */
NEVH_API const char *nevh_scene_shown_name(const nevh_scene *, nevh_shown,
                                           size_t i);
/* All of them, as many as nevh_scene_shown_count says. */
NEVH_API int nevh_scene_shown_values(nevh_scene *, nevh_shown, double t,
                                     const double q[], const double p[],
                                     double values[]);

/* One formula more, given from outside, in the names of the scene: what a run is
   judged by.  It reads t, coordinates, momenta, velocities, definitions and
   observables, as [observables] may.
   returns  NEVH_OK; NEVH_EINVAL when it is wrong (the message shows where):
            then the one before stays; NEVH_ENOMEM; the status of a scene that
            was not read
   cost     of setting: parsing; of the first value: making its tape */
NEVH_API int nevh_scene_set_judged(nevh_scene *, const char *formula);
/* Its value at a state, n coordinates and momenta; NAN outside of a function's
   domain, and where none was given. */
NEVH_API int nevh_scene_judged_value(nevh_scene *, double t, const double q[],
                                     const double p[], double *value);

/* The period of coordinate k; 0 where none is declared. */
NEVH_API double nevh_scene_period(const nevh_scene *, size_t k);

/* NAME = when LEFT = RIGHT, rising: ITEM, ..., or NAME = every TIME: ... */
typedef struct {
    const char *name;
    int direction; /* 1: rising, -1: falling, 0: both */
    double every;  /* greater than 0: stroboscopic, from t_start on */
    double period; /* that the crossing value is taken modulo: that of the
                      coordinate that LEFT is, or TIME; 0: none */
    size_t items;
    const char *const *item;  /* their texts */
    const char *left, *right; /* texts; NULL where it is stroboscopic */
} nevh_scene_section;
NEVH_API size_t nevh_scene_section_count(const nevh_scene *);
/* Valid as long as the system; NULL when i is out of range. */
NEVH_API const nevh_scene_section *nevh_scene_section_at(nevh_scene *,
                                                         size_t i);
/* LEFT - RIGHT, or the time since t_start: a crossing is where this goes
   through a multiple of the period, or through 0. */
NEVH_API int nevh_scene_section_cross(nevh_scene *, size_t i, double t,
                                      const double q[], const double p[],
                                      double *value);
NEVH_API int nevh_scene_section_items(nevh_scene *, size_t i, double t,
                                      const double q[], const double p[],
                                      double values[]);

/* [picture]: "rod" from x, y to x, y; "bob" at x, y; "; name TEXT" may follow.
 */
typedef struct {
    const char *kind;        /* NULL: i was out of range */
    size_t count;            /* of its values */
    const char *const *item; /* their texts */
    const char *name;        /* NULL: none is given */
} nevh_scene_part;
NEVH_API size_t nevh_scene_part_count(const nevh_scene *);
NEVH_API nevh_scene_part nevh_scene_part_at(const nevh_scene *, size_t i);
NEVH_API int nevh_scene_part_values(nevh_scene *, size_t i, double t,
                                    const double q[], const double p[],
                                    double values[]);

/* The lines that say what H is, in their order: NAME = VALUE of [parameters],
   [coordinates], [definitions], [effects] and [friction].  Texts belong to the
   scene, and are valid until it is changed; a parameter that was set has the
   value set. */
typedef struct {
    const char *section; /* NULL: i was out of range */
    const char *name, *value;
    bool on; /* false of an effect that is off */
} nevh_scene_equation;
NEVH_API size_t nevh_scene_equation_count(const nevh_scene *);
NEVH_API nevh_scene_equation nevh_scene_equation_at(const nevh_scene *,
                                                    size_t i);
/* The i-th as an element <math> of MathML Core, to be freed with free; sums are
   not written out.  NULL: it is no single formula (a list, an array, C code), i
   is out of range, or memory is out. */
NEVH_API char *nevh_scene_equation_mathml(const nevh_scene *, size_t i);
/* The i-th of the functions that these lines call, other than effects that are off,
   and GSL computes: their last digits may differ between machines.  NULL when i is
   out of range. */
NEVH_API const char *nevh_scene_gsl_function(const nevh_scene *, size_t i);

/* stop = FORMULA < VALUE, or with >: the text as written, or NULL, and whether
   a run is to end at a state. */
NEVH_API bool nevh_scene_stops(nevh_scene *);
NEVH_API const char *nevh_scene_stop_text(const nevh_scene *);
NEVH_API int nevh_scene_stop_reached(nevh_scene *, double t, const double q[],
                                     const double p[], bool *reached);
/* A nevh_observe_fn that ends a run there; data is the nevh_scene.  Where the
   formula cannot be evaluated the scene carries that status, and the run ends,
   too. */
NEVH_API int nevh_scene_stop_observe(void *scene, size_t step, double t,
                                     const double q[], const double p[]);

#ifdef __cplusplus
}
#endif
#endif

/* nevh: scenes: H as text, with everything a run needs.
   SPDX-License-Identifier: GPL-3.0-or-later

   A scene is a text file of sections [scene], [parameters], [coordinates],
   [definitions], [effects], [friction], [invariants], [observables],
   [picture], [sections], [labels], [run]; see scenes/pendulum.nevh. */
#ifndef NEVH_SCENE_H
#define NEVH_SCENE_H

#include <nevh/gradient.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct nevh_scene nevh_scene;

/* Reads a file, or text under a name for its messages.
   returns  the scene, to be freed with nevh_scene_free; NULL only when memory
            is out; carries NEVH_EINVAL or NEVH_EFAILED (not readable)
            otherwise: the message is FILE:LINE:COLUMN: error: ..., the line,
            and a caret under the column */
NEVH_API nevh_scene *nevh_scene_read(const char *path);
NEVH_API nevh_scene *nevh_scene_parse(const char *name, const char *text);
NEVH_API void nevh_scene_free(nevh_scene *); /* NULL is allowed */
NEVH_API int nevh_scene_status(const nevh_scene *);
NEVH_API const char *nevh_scene_message(const nevh_scene *);

/* Changes that make the system anew: a parameter ("NAME=FORMULA"; what depends
   on it follows), and an effect on or off.  NEVH_EINVAL when there is none. */
NEVH_API int nevh_scene_set(nevh_scene *, const char *assignment);
NEVH_API int nevh_scene_enable(nevh_scene *, const char *effect, bool on);

NEVH_API const char *nevh_scene_title(const nevh_scene *);  /* "" if none */
NEVH_API const char *nevh_scene_source(const nevh_scene *); /* "" if none */
NEVH_API size_t nevh_scene_dof(const nevh_scene *);
/* "phi", "x[3]"; NULL when k is out of range. */
NEVH_API const char *nevh_scene_coordinate(const nevh_scene *, size_t k);
/* The text of a label ("t", "energy", a coordinate); "" if there is none. */
NEVH_API const char *nevh_scene_label(const nevh_scene *, const char *name);

/* The system, effects switched as the scene says, friction included.  Owned by
   the scene and valid until it is changed or freed; NULL when it could not be
   made (the scene carries the status). */
NEVH_API const nevh_system *nevh_scene_system(nevh_scene *);
/* The state at t_start, n each; initial velocities are solved for momenta. */
NEVH_API int nevh_scene_start(nevh_scene *, double q[], double p[]);

/* [run], with defaults filled in; names are as written.  Lists may be empty
   where the default depends on H. */
typedef struct {
    double t_start, t_end;
    size_t dts, integrators, gradients, tolerances;
    const double *dt, *tolerance;
    const char *const *integrator, *const *gradient;
    double gradient_step;   /* 0: auto */
    double energy_scale;    /* 0: from H */
    bool match_work;        /* match = work */
    const char *reference;  /* NULL: none named */
    const char *transform;  /* formula; NULL: none */
} nevh_scene_run;
NEVH_API const nevh_scene_run *nevh_scene_run_settings(nevh_scene *);
/* s(q, p) of the transform as a system; NULL if there is none. */
NEVH_API const nevh_system *nevh_scene_transform(nevh_scene *);

#ifdef __cplusplus
}
#endif
#endif

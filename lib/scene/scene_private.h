/* nevh: inside a scene.

   A text is cut into statements (KEY = VALUE under a section) once, by
   nevh__scene_cut.  What they mean is made of them as a whole, the model: when
   the scene is read, and again when a parameter is set.  A scene whose text
   was refused has no model.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SCENE_PRIVATE_H
#define NEVH_SCENE_PRIVATE_H

#include "expression/formula_inside_private.h"
#include <nevh/scene.h>

typedef struct {
    size_t number; /* from 1; 0: an assignment from outside */
    const char *text;
    size_t bytes;
} nevh__line;

/* A part of a line, without space at its ends. */
typedef struct {
    const nevh__line *line;
    const char *at;   /* within the line's text */
    const char *text; /* a copy that ends where the part ends */
} nevh__piece;

typedef enum {
    NEVH__SCENE,
    NEVH__PARAMETERS,
    NEVH__COORDINATES,
    NEVH__DEFINITIONS,
    NEVH__EFFECTS,
    NEVH__FRICTION,
    NEVH__INVARIANTS,
    NEVH__OBSERVABLES,
    NEVH__PICTURE,
    NEVH__SECTIONS,
    NEVH__LABELS,
    NEVH__SPEEDS,
    NEVH__ENSEMBLE,
    NEVH__RUN,
    NEVH__INTEGRATOR,
    NEVH__SECTION_COUNT
} nevh__section_kind;

/* Names that a line may give values to. */
enum { NEVH__GROUP = 3 };

typedef struct {
    nevh__section_kind section;
    nevh__head head;
    nevh__piece key, value;
    size_t group, member;     /* names of the line; which it is, from 0 */
    const nevh__piece *title; /* NAME of [integrator NAME], else NULL */
} nevh__statement;

/* An effect, of terms or friction or both. */
typedef struct {
    const char *name;
    bool on;
    const nevh__statement *by; /* the last that gives it */
} nevh__switch;

/* The values of one coordinate, which may be an array. */
typedef struct {
    const nevh__statement *statement;
    size_t count, first;
} nevh__coordinate;

/* A formula over the whole state, whose tape is made when it is first asked
   for. */
typedef struct {
    nevh__piece piece;
    nevh__tape *tape;
} nevh__formula;

/* An observable or an invariant. */
typedef struct {
    const char *name;
    nevh__formula formula;
    const nevh__piece *without; /* effects that must be off */
    size_t n_without;
} nevh__item;
typedef struct {
    nevh__item *items;
    size_t count;
} nevh__items;

typedef struct {
    nevh_scene_section decl;
    nevh__formula left, right; /* what crosses, and where */
    nevh__formula *items;
} nevh__crossing;

typedef struct {
    nevh_scene_part decl;
    nevh__formula *values;
} nevh__drawn;

typedef struct {
    const char *text; /* NULL: nothing stops a run */
    nevh__formula formula;
    bool below; /* that it is, else above */
    double value;
} nevh__stop;

/* The numbers of a model with all their digits: n each. */
typedef struct {
    nevh__rounded *q, *p, *v, *rates; /* rates: of the friction that is on */
    nevh__rounded t_start, t_end;
    bool away; /* as nevh__names_away */
} nevh__exact_numbers;

typedef struct nevh__scene_ensemble
    nevh__scene_ensemble; /* "scene/scene_ensemble_private.h" */

typedef struct {
    nevh__pool pool;
    nevh__names *names;
    nevh__coordinate *coordinates;
    size_t n_coordinates, n;
    char **coordinate_names;        /* n */
    double *q, *p, *v;              /* n; v: initial velocities */
    nevh__exact_numbers *exact;     /* NULL: of doubles alone */
    double *period;                 /* n; 0: none */
    const nevh__statement **moving; /* n: what gave p[k] or v[k], or NULL */
    bool *by_velocity;              /* n: v[k] is given, p[k] follows */
    nevh_system *system, *transform;
    nevh__owned owned, owned_transform;
    const nevh__piece *fast; /* effects of [parts]; NULL: none */
    size_t n_fast;
    nevh_scene_run run;
    nevh__items shown[2]; /* by nevh_shown */
    nevh__crossing *crossings;
    size_t n_crossings;
    nevh__drawn *drawn;
    size_t n_drawn;
    nevh__stop stop;
    const nevh_integrator **schemes; /* as many as titles; the scene's */
    nevh__scene_ensemble *ensemble;  /* NULL: nothing is varied */
    nevh__formula judged;            /* where the scene has one, from outside */
    nevh__owned owned_shown;
    double *velocities, *velocity_buffer; /* n; NULL until asked for */
} nevh__scene_model;

typedef struct nevh__code nevh__code; /* "scene/code_private.h" */

struct nevh_scene {
    nevh__pool pool;
    bool allow_code;
    nevh__code **codes; /* by statement; NULL, or NULL where there is none */
    const char *name;
    nevh__line *lines;
    size_t n_lines;
    nevh__statement *statements;
    size_t n_statements;
    nevh__piece *titles; /* of [integrator NAME] */
    size_t n_titles;
    struct nevh__scheme *schemes; /* all that were made of them */
    nevh__switch *effects;        /* in order of appearance */
    size_t n_effects;
    nevh__register effect_names;
    bool switched;                 /* from outside */
    nevh__statement **assignments; /* from outside, the newest last */
    size_t n_assignments;
    nevh__statement **starts; /* from outside, the newest last */
    size_t n_starts;
    nevh__statement **varies; /* from outside, the newest last */
    size_t n_varies;
    const nevh__piece *outcomes; /* from outside; NULL: the scene's */
    const struct nevh__overrides *overrides; /* while a model is made */
    const nevh__piece *transform; /* from outside; NULL: the scene's */
    const nevh__piece *judged;    /* from outside; NULL: none */
    nevh__scene_model *model;
    nevh__scene_model *exact, *away; /* the same; NULL until asked for */
    int status;
    char message[2000];
};

/* Messages; each returns false.  The first one stays. */
bool nevh__scene_fail(nevh_scene *, int status, const nevh__piece *,
                      const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* At a column of a line, over `length` characters. */
bool nevh__scene_fail_at(nevh_scene *, int status, const nevh__line *,
                         size_t column, size_t length, const char *text);
/* Reports the error of a formula that is this piece. */
bool nevh__scene_fail_formula(nevh_scene *, const nevh__piece *,
                              const nevh__formula_error *);
bool nevh__scene_no_memory(nevh_scene *);
/* Adds what somebody else said, as further lines. */
void nevh__scene_quote(nevh_scene *, const char *text);
/* False, and a message, where a part of a list is two names side by side. */
bool nevh__scene_one_name(nevh_scene *, const nevh__piece *);
/* Says that a word is none of those that are known, with the closest. */
bool nevh__scene_fail_word(nevh_scene *, const nevh__piece *, const char *what,
                           const char *word, const char *const known[],
                           size_t count);

/* Text to statements. */
bool nevh__scene_cut(nevh_scene *, const char *text, size_t bytes);
/* One KEY = VALUE; the line is the caller's. */
bool nevh__statement_parse(nevh_scene *, const nevh__line *, nevh__statement *);

/* Pieces.  Memory is the pool's. */
bool nevh__piece_take(nevh_scene *, nevh__pool *, const nevh__line *,
                      size_t from, size_t to, nevh__piece *);
/* Takes what is before the first of `stops` outside of parentheses off the
   front of `rest`; what followed it remains.
   stop     out: which one it was; '\0' at the end, then rest is empty */
bool nevh__piece_split(nevh_scene *, nevh__pool *, nevh__piece *rest,
                       const char *stops, nevh__piece *part, char *stop);
/* The parts of a list, separated by commas; NULL on failure. */
nevh__piece *nevh__piece_list(nevh_scene *, nevh__pool *, const nevh__piece *,
                              size_t *count);
size_t nevh__piece_column(const nevh__piece *);

/* Formulas that stand in pieces. */
nevh__tree *nevh__piece_tree(nevh_scene *, const nevh__piece *);
bool nevh__piece_number(nevh_scene *, const nevh__scene_model *,
                        const nevh__piece *, double *value);
bool nevh__piece_wide(nevh_scene *, const nevh__scene_model *,
                      const nevh__piece *, nevh__rounded *value);
bool nevh__piece_check(nevh_scene *, const nevh__scene_model *,
                       const nevh__piece *, unsigned allowed);

/* Formulas of time, state and velocities, and their values at one state. */
typedef struct {
    double t;
    const double *q, *p;
    bool moving; /* the model's velocities are those of this state */
} nevh__state;
bool nevh__formula_check(nevh_scene *, const nevh__scene_model *,
                         const nevh__piece *, nevh__formula *);
bool nevh__formula_value(nevh_scene *, nevh__formula *, nevh__state *,
                         double *value);
bool nevh__formula_values(nevh_scene *, nevh__formula[], size_t count,
                          nevh__state, double values[]);
/* The parts of a list; NULL on failure. */
nevh__formula *nevh__formula_list(nevh_scene *, nevh__scene_model *,
                                  const nevh__piece *, size_t *count);

/* The shape of NAME[...] = ... */
typedef struct {
    bool array;
    size_t count; /* at least 1 */
} nevh__shape;
/* The shape that NAME, NAME[1..N] or NAME[i = 1..N] has. */
bool nevh__head_shape(nevh_scene *, const nevh__scene_model *,
                      const nevh__statement *, nevh__shape *);
/* Numbers, and the same with more digits; NULL where the model is not exact. */
typedef struct {
    double *near;
    nevh__rounded *wide;
} nevh__scene_numbers;
static inline nevh__scene_numbers
nevh__scene_numbers_from(nevh__scene_numbers x, size_t k) {
    return (nevh__scene_numbers){x.near + k, x.wide ? x.wide + k : NULL};
}
/* Room for `count` numbers of the model; false: memory is out. */
bool nevh__scene_numbers_take(nevh_scene *, nevh__scene_model *, size_t count,
                              nevh__scene_numbers *);
/* Values: a list of `count`, one for all, or a formula of the index. */
bool nevh__head_values(nevh_scene *, nevh__scene_model *,
                       const nevh__statement *, const nevh__piece *value,
                       size_t count, nevh__scene_numbers values);
/* The assignment of a parameter from outside, or NULL. */
const nevh__statement *nevh__scene_assignment(const nevh_scene *,
                                              const char *name);
/* A bound of a range. */
bool nevh__head_bound(nevh_scene *, const nevh__scene_model *,
                      const nevh__piece *key, const nevh__tree *, long *);
/* The coordinates that x, x[3], x[2..N] or x[i = 1..N] are, or those of p_x:
   from the first to before the last. */
bool nevh__head_range(nevh_scene *, const nevh__scene_model *,
                      const nevh__statement *, size_t *from, size_t *to);
/* Refuses the name of a column that every table of an orbit has. */
bool nevh__head_column(nevh_scene *, const nevh__statement *);
/* Refuses an index where none belongs. */
bool nevh__head_plain(nevh_scene *, const nevh__statement *);

/* NAME(A, B, ...) as its arguments; *count is 0 where the text is no call of
   that name. */
bool nevh__piece_call(nevh_scene *, nevh__pool *, const nevh__piece *,
                      const char *name, nevh__piece **arguments, size_t *count);

/* elements(...): a coordinate and its velocity, `count` of an array. */
bool nevh__is_elements(const nevh__piece *);
bool nevh__elements_values(nevh_scene *, nevh__scene_model *,
                           const nevh__statement *, const nevh__piece *value,
                           size_t count, nevh__scene_numbers q,
                           nevh__scene_numbers v);

/* Sections, in the order in which the model needs them. */
bool nevh__model_parameters(nevh_scene *, nevh__scene_model *);
bool nevh__model_coordinates(nevh_scene *, nevh__scene_model *);
bool nevh__model_definitions(nevh_scene *, nevh__scene_model *);
bool nevh__model_values(nevh_scene *, nevh__scene_model *);
bool nevh__model_terms(nevh_scene *, nevh__scene_model *);
bool nevh__model_friction(nevh_scene *, nevh__scene_model *);
bool nevh__model_parts(nevh_scene *, nevh__scene_model *);
bool nevh__model_shown(nevh_scene *, nevh__scene_model *); /* and monitored */
bool nevh__model_crossings(nevh_scene *, nevh__scene_model *);
bool nevh__model_labels(nevh_scene *, nevh__scene_model *);
bool nevh__model_run(nevh_scene *, nevh__scene_model *);
bool nevh__model_integrators(nevh_scene *, nevh__scene_model *);
void nevh__scene_forget_integrators(nevh_scene *);
/* The number of a key among those of its section; `count`, with a message, when it is
   none or there already. */
size_t nevh__statement_key(nevh_scene *, const nevh__statement *,
                           const char *const keys[], size_t count);
/* Says that no integrator has that name, the scene's own included. */
bool nevh__scene_fail_integrator(nevh_scene *, const nevh__piece *,
                                 const char *name);
void nevh__model_free(nevh__scene_model *);
/* The model of the scene as it is, whose numbers have all their digits; NULL on
   failure.  The scene owns it until it changes. */
nevh__scene_model *nevh__scene_exact(nevh_scene *);
/* The same, with constants as far away as rounding may have moved them. */
nevh__scene_model *nevh__scene_away(nevh_scene *);

/* v = dH/dp at one state, n each; every term brings its gradient.
   buffer       of nevh__velocity_buffer, to be freed; NULL when memory is out */
double *nevh__velocity_buffer(const nevh_system *);
void nevh__velocities(const nevh_system *, double t, const double q[],
                      const double p[], double buffer[], double v[]);
/* The first effect that is on and has a value that is not finite, or NULL. */
const char *nevh__effect_not_finite(const nevh_system *, double t,
                                    const double q[], const double p[],
                                    double buffer[]);

/* False if a scene cannot be used; else forgets its last failure. */
bool nevh__scene_begin(nevh_scene *);
/* The status where it does not begin: of NULL, too. */
int nevh__scene_fault(const nevh_scene *);

/* Which effects there are and which are on. */
bool nevh__scene_effects(nevh_scene *);
/* As is asked for from outside. */
bool nevh__scene_switch(nevh_scene *, const nevh_scene_options *);
nevh__switch *nevh__scene_effect(const nevh_scene *, const char *name);
/* The folder that a file is in, from the root on, to be freed; NULL when there
   is none.
   returns  whether there was memory */
bool nevh__folder_of(const char *path, char **folder);
/* NAME = file("term.c", ...): adds its term. */
bool nevh__is_code(const nevh__statement *);
bool nevh__model_code(nevh_scene *, nevh__scene_model *,
                      const nevh__statement *);
/* Loads the code of an effect, if it has any, before that is switched on. */
bool nevh__scene_load_code(nevh_scene *, const char *effect);
void nevh__scene_unload_code(nevh_scene *);
/* With the texts of all code that is loaded. */
uint64_t nevh__scene_digest_code(const nevh_scene *, uint64_t digest);

/* FNV-1a, 64 bits [G. Fowler, L. C. Noll, K.-P. Vo; draft-eastlake-fnv]. */
static const uint64_t nevh__digest_begin = 0xCBF29CE484222325u;
static inline uint64_t nevh__digest_byte(uint64_t digest, unsigned char byte) {
    return (digest ^ byte) * 0x100000001B3u;
}
/* Says that there is no effect of that name. */
bool nevh__scene_fail_effect(nevh_scene *, const nevh__piece *);
/* The effect of that name, which a caller asked for; NULL after a message. */
nevh__switch *nevh__scene_find_effect(nevh_scene *, const char *name);

/* Calls visit for each statement of a section, until one fails. */
typedef bool (*nevh__visitor)(nevh_scene *, nevh__scene_model *,
                              const nevh__statement *);
bool nevh__scene_each(nevh_scene *, nevh__scene_model *, nevh__section_kind,
                      nevh__visitor);

#endif

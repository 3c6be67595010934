/* nevh: inside a field.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FIELD_PRIVATE_H
#define NEVH_FIELD_PRIVATE_H

#include "gradient/scatter_map_private.h"
#include "system/parts_private.h"
#include <nevh/gradient.h>

/* The step of one variable, how it was found, and the worst estimates of its
   errors over the states that were tried. */
typedef struct {
    double delta;
    bool given, blind;                 /* by the user; nothing was to be seen */
    bool quadratic;                    /* order 2 is as good as it gets */
    bool noisy;                        /* values are worse than rounded */
    double truncation, rounding, size; /* of the derivative, and its own */
} nevh__step;

/* Variables that are differenced alike. */
typedef struct {
    size_t pairs;      /* points on each side */
    size_t first_p;    /* in vars: coordinates come before momenta */
    size_t begin, end; /* in vars */
} nevh__pass;

/* The addresses of states and of their gradient, n x width each.  Either half of
   the gradient may be NULL. */
typedef struct {
    size_t width; /* the distance between rows */
    const double *t, *q, *p;
    double *dh_dq, *dh_dp;
} nevh__places;

/* The points of the differences of a term; see stencil_plan.c. */
typedef struct nevh__stencil nevh__stencil;
/* Terms that are evaluated as instances of one; see joined_terms.c. */
typedef struct nevh__joint nevh__joint;

typedef struct {
    const nevh__term_entry *term;
    size_t nq, np, nv;    /* variables of an instance: coordinates, momenta */
    nevh__part_role part; /* KICK where H is not divided */
    double *delta;        /* count x nv; NULL without differences */
    nevh__step *steps;    /* nevh__step_rows x nv */
    size_t first_step;    /* steps of the terms before it */
    size_t *vars;         /* nv variables in the order of the passes */
    nevh__pass pass[2];   /* full order; order 2 */
    uint64_t values;
    nevh__stencil *stencil[3]; /* of dH/dq, dH/dp, both; NULL: by blocks */
    struct nevh__constants *constants; /* of evaluations */
    nevh__scatter_map to_q, to_p;      /* of exact_gather, if mapped */
    bool mapped;
    double *gathered; /* constants of a block of all instances and of so many */
    size_t gathered_width; /* states, those that were asked for last */
    bool
        turned; /* pairs in blocks: exact slopes are added instance by instance */
    /* Rows of the field's lanes, where these differ, in place of the term's
       constants and of delta: count x nc and count x nv. */
    double *lane_c, *lane_delta;
    nevh__joint *members; /* NULL: it is a term of the system */
} nevh__planned;

/* Adds a term's gradient at any places, or writes it: nevh__writes. */
typedef int (*nevh__gradient_fn)(nevh_field *, nevh__planned *,
                                 const nevh__places *);

/* Chords of the longest central difference, on which buffers depend. */
enum { NEVH__MOST_OFFSETS = 4 };

struct nevh_gradient {
    const char *name;
    nevh__gradient_fn evaluate;
    int order;      /* 0: without truncation error */
    size_t offsets; /* points x +- delta, ... on each side; 0: exact */
    /* dH/dx = sum of weights[j] times the slope of the chord from
       x - (j+1) delta to x + (j+1) delta. */
    double weights[NEVH__MOST_OFFSETS];
    bool (*has)(const nevh_term *); /* NULL: any term will do */
    const char *wants;              /* what a term then lacks */
};

struct nevh_field {
    const nevh_system *system;
    unsigned long revision;
    const nevh_gradient *gradient;
    bool portable, planned;
    size_t n;
    double *scale;  /* 2n; of an exact gradient after nevh__field_find_scale */
    bool scaled;    /* by that */
    double *length; /* 2n: of an exact gradient of one orbit, found when it was
                       verified; or NULL */
    nevh__planned *terms;
    size_t n_terms, instances, n_steps;
    nevh__planned **pieces; /* what a gradient evaluates: terms, and joints of
                              some */
    size_t n_pieces;
    size_t capacity;   /* columns that the rows below have room for */
    double *workspace; /* holds all below but the Jacobian */
    double *rows;      /* variables and constants of a block */
    double *slopes;    /* exact derivatives of a block */
    double *times;     /* capacity */
    double *zeros;     /* capacity */
    double *h;         /* capacity */
    double *sums;      /* 2 x capacity */
    double *one;       /* one state of a scalar or complex term */
    double *jacobian;  /* 6n, made by nevh_gsl_system */
    uint64_t gradients;
    /* The first term with a share in one half of the gradient, if it has all of it;
       else NULL. */
    const nevh__planned *whole_q, *whole_p;
    unsigned parts;  /* whose terms gradients are of: a bit each */
    size_t n_inner;  /* instances of inner terms */
    uint64_t inner;  /* those that gradients of inner terms were of */
    bool starved;    /* memory was out when an evaluation was planned */
    bool broadcasts; /* one state may as well be repeated over a vector */
    size_t lanes; /* that have constants of their own; 0: all have the same */
    size_t *chosen, n_chosen; /* state i of some side by side has those of lane
                                 chosen[i % n_chosen] */
    size_t alone;             /* the lane whose constants a single state has */
    double *lane_scale;       /* 2n rows of lanes: their scales */
    struct nevh__single
        *single; /* evaluations at one state; see evaluation.c */
    nevh__report report;
};

/* The index of an instance's variable among the system's coordinates (first
   nq of them) or momenta. */
static inline size_t nevh__index(const nevh__planned *term, size_t instance,
                                 size_t k) {
    const nevh_term *decl = &term->term->decl;
    return k < term->nq ? decl->q[instance * term->nq + k]
                        : decl->p[instance * term->np + k - term->nq];
}

/* True if a term that has all of a half writes it, so that the others add. */
static inline bool nevh__writes(const nevh_field *f, const nevh__planned *whole,
                                size_t width) {
    if (!whole || f->gradient != nevh_exact)
        return whole;
    return width % NEVH__LANES == 0 &&
           whole->term->decl.count * width <= f->capacity;
}
/* Which of three: dH/dq, dH/dp, both. */
static inline size_t nevh__part_of(const nevh__places *at) {
    return at->dh_dq && at->dh_dp ? 2 : at->dh_dp ? 1 : 0;
}
/* True if a term has a part in what is requested. */
static inline bool nevh__wanted(const nevh_field *f, const nevh__places *at,
                                const nevh__planned *term) {
    return f->parts >> term->part & 1 &&
           ((at->dh_dq && term->nq) || (at->dh_dp && term->np));
}

/* The lane whose constants a state has, of so many side by side. */
static inline size_t nevh__lane_of(const nevh_field *f, size_t width,
                                   size_t state) {
    return width == 1 ? f->alone
           : f->lanes ? f->chosen[state % f->n_chosen]
                      : 0;
}
/* An instance's constant k, in a lane. */
static inline double nevh__constant(const nevh_field *f,
                                    const nevh__planned *term, size_t instance,
                                    size_t k, size_t lane) {
    size_t at = instance * term->term->decl.nc + k;
    return f->lanes ? term->lane_c[at * f->lanes + lane]
                    : term->term->decl.c[at];
}
/* The step of its difference by variable k, in a lane. */
static inline double nevh__delta(const nevh_field *f, const nevh__planned *term,
                                 size_t instance, size_t k, size_t lane) {
    size_t at = instance * term->nv + k;
    return f->lanes ? term->lane_delta[at * f->lanes + lane] : term->delta[at];
}

/* field_lanes.c: each lane of a field gets constants of its own, those of the
   terms at first.  Evaluations are planned afterwards.
   returns  NEVH_OK or a status, recorded: NEVH_ESTRUCT where there is a term
            whose gradient cannot be taken so */
int nevh__field_lanes_plan(nevh_field *, size_t lanes);
/* A lane takes the constants of each term, count x nc, and, of differences, the
   steps of `own`, a field of the same terms with these constants.
   returns  whether these are differenced alike; else nothing is taken */
bool nevh__field_lane_take(nevh_field *, size_t lane, const double *const c[],
                           const nevh_field *own);
/* A lane takes what another has. */
void nevh__field_lane_copy(nevh_field *, size_t from, size_t to);
/* The lane whose constants single states have from now on. */
void nevh__field_alone(nevh_field *, size_t lane);
/* The field's scale, or that of a lane in room, 2n. */
const double *nevh__field_lane_scale(const nevh_field *, size_t lane,
                                     double room[]);
/* From now on state i of some side by side has the constants of the lane
   lanes[i % count], count at most those of the field, and single states have
   those of the first; until a lane takes others.  Evaluations that were planned
   keep those of all lanes until nevh__evaluation_refresh. */
void nevh__field_choose(nevh_field *, size_t count, const size_t lanes[]);

/* For each method; nevh__gradient_fn. */
int nevh__gradient_central(nevh_field *, nevh__planned *, const nevh__places *);
/* The same of a term without a stencil. */
int nevh__central_blocks(nevh_field *, nevh__planned *, const nevh__places *);
int nevh__gradient_exact(nevh_field *, nevh__planned *, const nevh__places *);
int nevh__gradient_complex(nevh_field *, nevh__planned *, const nevh__places *);

/* As nevh_field_gradient, of the terms that are inner ones. */
int nevh__field_inner_gradient(nevh_field *, const nevh__places *);
/* As nevh_field_gradient, of all terms, also those that are apart. */
int nevh__field_whole_gradient(nevh_field *, size_t width, const double t[],
                               const double q[], const double p[],
                               double dh_dq[], double dh_dp[]);
/* Evaluates all terms, one after another, at any addresses. */
int nevh__field_terms(nevh_field *, const nevh__places *);
/* Plans differences, and exact gradients, at any addresses; false if memory is out. */
bool nevh__central_stencil_plan(nevh_field *);
void nevh__central_stencil_clear(nevh__planned *);
void nevh__central_stencils_clear(nevh_field *); /* those of all terms */
bool nevh__exact_gather_plan(nevh_field *);
/* Lists what a gradient evaluates, of terms whose steps are chosen; false if memory
   is out. */
bool nevh__field_join(nevh_field *);
void nevh__joints_clear(nevh_field *);
/* Counts for the members what was counted for their joint. */
void nevh__joint_count(nevh_field *, nevh__planned *);
/* Records which member it is that fails, if it is a joint; returns the status. */
int nevh__joint_fail(nevh_field *, const nevh__planned *, const nevh__places *,
                     int status);
/* Frees what evaluates a term, or a joint. */
void nevh__planned_clear(nevh__planned *);
/* True if one state may be repeated over a vector at no extra cost. */
bool nevh__exact_block_broadcasts(const nevh_field *);

/* nevh_field_gradient, of which `used` lanes count. */
int nevh__field_gradient_padded(nevh_field *, size_t used,
                                const nevh__places *);

/* The noise of dH/dq and dH/dp from rounding in the values of H at one state (width
   1): the sum of epsilon |h| / delta over all that reads each variable, n each.
   Zeros if gradients are exact. */
int nevh__field_noise(nevh_field *, double t, const double q[],
                      const double p[], double noise_q[], double noise_p[]);

/* As nevh_field_effects, leaving out terms that read nothing. */
int nevh__field_moving_effects(nevh_field *, double t, const double q[],
                               const double p[], double h[]);

/* The same for each term of the field. */
int nevh__field_moving_terms(nevh_field *, double t, const double q[],
                             const double p[], double h[]);

/* H without the terms that read nothing, as h + roundoff: differences of these two
   parts are as accurate as the terms are, however large the sum.  size: the sum
   of the terms' |values|.  Arguments as nevh_field_value. */
int nevh__field_moving_values(nevh_field *, size_t width, const double t[],
                              const double q[], const double p[], double h[],
                              double roundoff[], double size[]);

/* The 2n lengths over which H varies, coordinates first: the user's scales, or
   found by trial as when steps are chosen.  Where all steps are given, planning
   evaluates nothing, and the field's scales have to do. */
int nevh__field_lengths(nevh_field *, const nevh_options *, double length[]);

/* The field's scales as far as planning left them out: differences have found
   theirs, exact gradients need none.  Takes a coarse run from the state to plan
   at, which may cost more than all other planning.  What it evaluates is not
   counted.  Returns a status, recorded in the field. */
int nevh__field_find_scale(nevh_field *, const nevh_options *);
/* Takes the evaluations of planning out of the counts, and clears its failures if
   the status is NEVH_OK; returns the status. */
int nevh__field_forget(nevh_field *, int status);

/* The curvature of H in each variable, 2n: the change of H within the variable's
   length, over the square of the length.  For a quadratic H this is nearly the
   second derivative, however large the other terms are. */
int nevh__field_curvatures(nevh_field *, const nevh_options *,
                           double curvature[]);

/* rest.c: follows an orbit until its scales are seen, without any idea of them:
   by the terms' own gradients, or else those of the field.
   sizes    out, 2n: the largest of each variable
   visit    NULL, or called after each step once these are seen
   returns  whether they are; not where the orbit is a power of the time, ends,
            or is too much work */
typedef void (*nevh__orbit_fn)(void *context, double t, double h,
                               const double y[]);
bool nevh__follow_orbit(nevh_field *, double t, const double q[],
                        const double p[], double sizes[], nevh__orbit_fn visit,
                        void *context);

/* Values only: no gradients are asked for, and none are planned. */
extern const nevh_gradient nevh__no_gradient;
/* Exact where all terms that are on have that, else differences of order 6. */
const nevh_gradient *nevh__best_gradient(const nevh_system *);
/* The difference method for dH/dt of a term; time.c. */
typedef struct {
    const nevh_gradient *method; /* NULL: the term does not read t */
    double delta;
} nevh__time_step;
/* Chooses a step for each of the field's terms, to steps. */
int nevh__field_plan_time(nevh_field *, const nevh_options *,
                          nevh__time_step steps[]);
/* Adds the time derivative of one term to dh_dt, a number a state. */
int nevh__field_time_slope(nevh_field *, size_t term, const nevh__time_step *,
                           size_t width, const double t[], const double q[],
                           const double p[], double dh_dt[]);

/* As nevh_field_new.  part: of each term of the system: gradients are of those that
   kick; NULL: all do. */
nevh_field *nevh__field_of(const nevh_system *, const nevh_options *,
                           const nevh__part_role part[]);
/* NEVH_OK, or why the field cannot be used (again). */
int nevh__field_ready(nevh_field *);
/* True if the field is planned, is not stale and has not failed. */
static inline bool nevh__field_at_hand(const nevh_field *f) {
    return f->planned && !f->report.status &&
           f->system->revision == f->revision;
}

#endif

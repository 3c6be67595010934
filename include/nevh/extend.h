/* nevh: for authors of integrators.
   SPDX-License-Identifier: GPL-3.0-or-later

   A scheme is a descriptor: what it is, and the table that its family's kernel
   runs on.  A descriptor of one's own may be passed to nevh_stepper_new as it
   is; nothing needs to be registered. */
#ifndef NEVH_EXTEND_H
#define NEVH_EXTEND_H

#include <nevh/run.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct nevh_work nevh_work;

/* A family of schemes. */
typedef struct {
    /* Once, before the first step: sets memory_rows and scratch_size, and may
       set `plan` to coefficients made for this integrator.  Returns a status;
       nevh_work_fail gives it a message. */
    int (*plan)(nevh_work *);
    /* One step, q and p in and out.  On failure q, p and memory are left as
       they were: results go to scratch until the step is certain. */
    int (*step)(nevh_work *, double t, double h, double q[], double p[]);
    /* Frees `plan`; NULL when there is nothing to free. */
    void (*clear)(nevh_work *);
    /* Friction has multiplied p by factor[k] (n of them) since the last step:
       memory that depends on p is scaled or dropped.  Called twice between
       steps, for the half behind one and for the half before the next; also
       where memory is all 0.  Where the next step fails, the stepper restores
       the memory.  NULL: none depends on p. */
    void (*apply_friction)(nevh_work *, const double factor[]);
    /* The kernel takes friction into its own slopes, dp/dt = -dH/dq - rate p
       with w->friction; otherwise it is split off and put around the step. */
    bool has_friction;
    /* Takes its gradients around nevh_work_gradient, so that they can neither
       be transformed nor accounted for: a stepper that is asked for a transform
       of time, or for a balance of the energy, refuses. */
    bool opaque;
    /* Effects that are to be fast may be any V(q): it takes these in substeps. */
    bool has_substeps;
    /* Takes no gradients: a transform of time is refused. */
    bool own_slopes;
    /* True if a step of h, of either sign, of one orbit can be evaluated from such
       memory and stays on the orbit that was taken.  Points of sections are then
       found there.  NULL: memory holds no orbit. */
    bool (*holds)(const nevh_work *, const double memory[], double h);
} nevh_kernel;

struct nevh_integrator {
    const char *name, *aliases, *source; /* aliases: NULL or comma-separated */
    int order, stages;
    int gradients; /* dH/dq evaluations a step in a long run; 0: it depends */
    int sweep_gradients;  /* the same, of a sweep of an implicit scheme */
    bool adaptive;        /* with a tolerance, takes its own steps within h */
    bool needs_tolerance; /* it has no steps of its own */
    bool own_time;        /* h is nominal: the step sets w->elapsed */
    bool needs_formulas;  /* refuses terms that are functions in C */
    bool multistep;       /* a step depends on states before the last one */
    nevh_claim symplectic, symmetric, explicit_form, preserves_energy;
    unsigned needs;
    const nevh_kernel *kernel;
    const void *table; /* what the kernel runs on */
};

/* The workspace of a kernel.  Sizes are fixed after `plan`. */
struct nevh_work {
    const nevh_integrator *integrator;
    const nevh_system *system;
    const nevh_options *options;
    nevh_field *field;
    size_t n, width, size; /* size = n * width: elements of q, and of p */
    const double *scale;   /* 2n lengths, coordinates first; NULL before
                              nevh_work_find_scale */

    /* Memory from one step to the next: memory_rows rows of `width` doubles.  A
       lane that starts afresh finds its column all 0. */
    size_t memory_rows;
    double *memory;
    size_t scratch_size; /* doubles */
    double *scratch;
    void *plan;
    int order; /* of the steps, where `plan` chose it; 0: the integrator's */
    uint64_t sweeps, newtons, rescues;
    double elapsed; /* time that the step takes: h, unless own_time sets it */
    const double *friction; /* n rates; NULL: none, or it is split off */
    struct nevh__transform *transform; /* of H; NULL: there is none */
    struct nevh_ledger *ledger;        /* NULL: nobody asked for the balance */
    bool accounts;                     /* nevh_work_account is to be called */
    bool planned; /* nevh's own kernels take gradients as they planned them */

    struct nevh__native *native; /* compiled steps, taken before the kernel's;
                                    NULL: there are none */

    struct nevh__report *report; /* written by nevh_work_fail */
};

/* Records a status with a printf-like message, and returns the status. */
NEVH_API int nevh_work_fail(nevh_work *, int status, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;
/* Sets w->scale, in `plan`: the user's lengths, or typical sizes of the variables
   over a coarse run from the state to plan at.  That run may cost more than all
   other planning, so a kernel that reads no lengths does not call this.  Returns a
   status; a failure is recorded. */
NEVH_API int nevh_work_find_scale(nevh_work *);
/* The gradient at `points` states side by side, as nevh_field_gradient, and
   values, as nevh_field_value: of H, or of K where time is transformed.  A
   failure is recorded. */
NEVH_API int nevh_work_gradient(nevh_work *, size_t points, const double t[],
                                const double q[], const double p[],
                                double dh_dq[], double dh_dp[]);
NEVH_API int nevh_work_value(nevh_work *, size_t points, const double t[],
                             const double q[], const double p[], double h[]);
/* The evaluations that moved the state, for the balance of the energy and for
   transformed time: where w->accounts is set a kernel calls this once for each
   group of `width` points at which it took dH/dq or dH/dp, with the weight (a
   part of h) that the group has in the step.  `parts`: which of the two, an or
   of nevh_part.  The weights of a step add up to the time it takes, of dH/dq
   and of dH/dp.  Terms of V(t, q) and those that read t alone count with dH/dq,
   terms of T(t, p) with dH/dp; of a term that reads both, but was found to be a
   sum, each part with its own.  Friction counts with dH/dp.  Nothing counts
   before the step returns NEVH_OK. */
typedef enum { NEVH_OF_Q = 1, NEVH_OF_P = 2 } nevh_part;
NEVH_API int nevh_work_account(nevh_work *, unsigned parts, double weight,
                               const double t[], const double q[],
                               const double p[]);
/* Adds increments to a state with compensation: y + d + compensation, of which the
   rounded sum goes to y and the rest to compensation; count elements each.  Nothing
   is written when a sum is not finite.  Returns NEVH_OK or NEVH_EDOM. */
NEVH_API int nevh_work_commit(nevh_work *, size_t count, double q[],
                              const double dq[], double compensation_q[],
                              double p[], const double dp[],
                              double compensation_p[]);

/* The kernels that come with nevh, and their tables. */

/* Kicks p -= w h dV/dq and drifts q += w h dT/dp in turn.  A table holds the
   independent weights as they were published, in long double; the others
   follow when a stepper is made, since kicks and drifts sum up to 1 each. */
typedef enum { NEVH_KICK, NEVH_DRIFT } nevh_operation;
typedef enum {
    NEVH_LISTED,     /* given: all operations in turn but the last two */
    NEVH_PALINDROME, /* the first half's, but the two in the middle */
    NEVH_COMPOSITION /* of Verlet steps that begin with `first`, a palindrome
                        in their sizes: the first half's, but the middle one */
} nevh_pattern;
typedef struct {
    nevh_operation first;
    nevh_pattern pattern;
    size_t count;               /* weights given; 0: Verlet, or Euler's */
    const long double *weights; /* count; NULL when there are none */
} nevh_splitting;
NEVH_API extern const nevh_kernel nevh_splitting_kernel;

/* Explicit Runge-Kutta. */
typedef struct {
    size_t stages;
    const double *a; /* stages x stages, row by row; only below the diagonal */
    const double *b; /* stages */
    const double *c; /* stages */
    /* For steps that adapt to a tolerance: h sum_i error[i] k_i is an estimate
       of the step's error; error: stages, b less the embedded weights, or NULL
       where there are none.  With `coarse`, of a second embedded method of
       lower order, or NULL, the norms of the two make one estimate:
       |error|^2 / sqrt(|error|^2 + |coarse|^2 / 100) [E. Hairer, S. P.
       Norsett, G. Wanner, Solving Ordinary Differential Equations I (1993),
       II.10]. */
    const double *error, *coarse;
    int error_power;    /* the power of h with which the estimate falls */
    bool last_is_first; /* the last stage is the next step's first */
} nevh_butcher;
NEVH_API extern const nevh_kernel nevh_runge_kutta_kernel;

/* Explicit Runge-Kutta-Nystroem, for H = T(p) + V(q) with a T that is quadratic
   in p and does not read the time: for p = dq/dt and f = -dV/dq
       q += h p + h^2 sum_i bq[i] f_i,   p += h sum_i bp[i] f_i,
       f_i = f(t + c[i] h, q + c[i] h p + h^2 sum_j a[i][j] f_j). */
typedef struct {
    size_t stages;
    const double *a;  /* stages x stages, row by row; only below the diagonal */
    const double *bq; /* stages */
    const double *bp; /* stages */
    const double *c;  /* stages; c[0] is 0 */
    /* bq and bp less the embedded weights, for steps that adapt; or NULL */
    const double *error_q, *error_p;
    int error_power; /* the power of h with which the estimate falls */
} nevh_nystrom;
NEVH_API extern const nevh_kernel nevh_nystrom_kernel;

/* Gauss-Legendre with `stages` stages from the descriptor; no table. */
NEVH_API extern const nevh_kernel nevh_gauss_kernel;
/* Lobatto IIIA for coordinates with IIIB for momenta, alike; from 2 stages. */
NEVH_API extern const nevh_kernel nevh_lobatto_kernel;
/* The implicit Euler method: 1 stage; no table. */
NEVH_API extern const nevh_kernel nevh_implicit_euler_kernel;

/* A scheme from numbers: a splitting (kick and drift), a Runge-Kutta method (a and
   b), or a composition of steps of another scheme (base and step).  What belongs to
   the others is 0.  Weights are long doubles, so that sums that are 1 are so. */
typedef struct {
    const char *name; /* letters, digits, "-" and "_", at most 60 */
    nevh_operation first;
    size_t kicks, drifts;            /* alike, or one more of the first */
    const long double *kick, *drift; /* each adds up to 1 */
    size_t stages;                   /* at most NEVH_MOST_STAGES */
    const long double *a; /* stages x stages, row by row; where it is not
                             strictly lower triangular the method is
                             implicit */
    const long double *b; /* stages; adds up to 1 */
    const long double *c; /* stages: the sums of a's rows; NULL: they are */
    const nevh_integrator *base; /* a splitting, or a Runge-Kutta method */
    size_t steps;
    const long double *step; /* parts of h, of either sign; adds up to 1 */
} nevh_scheme_table;
enum { NEVH_MOST_STAGES = 64 };

/* The first fault of a table. */
typedef struct {
    int status; /* NEVH_EINVAL or NEVH_ENOMEM */
    char list;  /* the first letter of kick, drift, a, b, c or step; 0: none */
    size_t index; /* an element of that list, a row of a; SIZE_MAX: all of it */
    char text[200];
} nevh_table_error;

/* Makes a scheme, whose order, symmetry and symplecticity follow from the table.
   returns  the scheme, to be freed with nevh_integrator_free when no stepper has
            it any more; NULL where weights do not add up to 1, rows of a not to c,
            a number is not finite or a size is wrong: `error` (NULL-able) says what
   table    copied, with the table of its base
   threads  any number at once; the scheme never changes
   cost     the conditions of orders up to 8: some milliseconds */
NEVH_API nevh_integrator *nevh_integrator_new(const nevh_scheme_table *,
                                              nevh_table_error *error);
NEVH_API void nevh_integrator_free(nevh_integrator *); /* NULL is allowed */

/* Properties of a splitting or a Runge-Kutta method that follow from its table by
   algebra. */
enum { NEVH_MOST_ORDER = 8 };
typedef struct {
    int order;       /* whose conditions hold but for rounding; at most
                        NEVH_MOST_ORDER */
    int any_kinetic; /* the same for H = T(p) + V(q) whose T is not quadratic in p */
    bool symmetric, symplectic;
    /* The first condition that fails: its sum, what it has to be, and for which
       order; "", NAN and 0 where NEVH_MOST_ORDER is reached. */
    char condition[120];
    long double value, due;
    int needed_for;
} nevh_scheme_facts;
/* returns  NEVH_OK; NEVH_EINVAL for schemes of other families; NEVH_ENOMEM */
NEVH_API int nevh_integrator_facts(const nevh_integrator *,
                                   nevh_scheme_facts *);
/* "sum of b_i c_i is 0.49, 1/2 is needed for order 2 ...", with by how much it is off
   where that is little; "" where no condition fails.  Returns text. */
NEVH_API const char *nevh_scheme_shortfall(const nevh_scheme_facts *,
                                           char text[], size_t size);

#ifdef __cplusplus
}
#endif
#endif

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
    void (*unplan)(nevh_work *);
} nevh_kernel;

struct nevh_integrator {
    const char *name, *aliases, *source; /* aliases: NULL or comma-separated */
    int order, stages;
    int gradients; /* dH/dq evaluations a step in a long run; 0: it depends */
    nevh_claim symplectic, symmetric, explicit_form, preserves_energy;
    unsigned needs;
    const nevh_kernel *kernel;
    const void *table; /* what the kernel runs on */
};

/* What a kernel works with.  Sizes are fixed after `plan`. */
struct nevh_work {
    const nevh_integrator *integrator;
    const nevh_system *system;
    const nevh_options *options;
    nevh_field *field;
    size_t n, width, size; /* size = n * width: elements of q, and of p */
    const double *scale;   /* 2n lengths, coordinates first */

    /* What the next step needs to know of this one: memory_rows rows of
       `width` doubles.  A lane that starts afresh finds its column all 0. */
    size_t memory_rows;
    double *memory;
    size_t scratch_size; /* doubles */
    double *scratch;
    void *plan;
    uint64_t sweeps, rescues;

    struct nevh_report *report; /* written by nevh_work_fail */
};

/* Records a status with a printf-like message, and returns the status. */
NEVH_API int nevh_work_fail(nevh_work *, int status, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;
/* The gradient at `points` states side by side, as nevh_field_gradient; a
   failure is recorded. */
NEVH_API int nevh_work_gradient(nevh_work *, size_t points, const double t[],
                                const double q[], const double p[],
                                double dh_dq[], double dh_dp[]);
/* Adds increments to a state with compensation: y + d + carry, of which the
   rounded sum goes to y and the rest to carry; count elements each.  Nothing
   is written when a sum is not finite.  Returns NEVH_OK or NEVH_EDOM. */
NEVH_API int nevh_work_commit(nevh_work *, size_t count, double q[],
                              const double dq[], double carry_q[], double p[],
                              const double dp[], double carry_p[]);

/* The kernels that come with nevh, and their tables. */

/* Kicks p -= c h dV/dq and drifts q += c h dT/dp in turn. */
typedef enum { NEVH_KICK, NEVH_DRIFT } nevh_operation;
typedef struct {
    nevh_operation first;
    size_t count;          /* operations */
    const double *weights; /* count weights, alternating from `first` */
} nevh_splitting;
NEVH_API extern const nevh_kernel nevh_splitting_kernel;

/* Explicit Runge-Kutta. */
typedef struct {
    size_t stages;
    const double *a; /* stages x stages, row by row; only below the diagonal */
    const double *b; /* stages */
    const double *c; /* stages */
} nevh_butcher;
NEVH_API extern const nevh_kernel nevh_runge_kutta_kernel;

/* Gauss-Legendre with `stages` stages from the descriptor; no table. */
NEVH_API extern const nevh_kernel nevh_gauss_kernel;

#ifdef __cplusplus
}
#endif
#endif

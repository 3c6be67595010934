/* nevh: SUNDIALS as a peer: ARKODE's explicit Runge-Kutta methods and CVODE's
   Adams methods.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "peer.h"
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_config.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

typedef struct {
    const method *method;
    const problem *problem;
    double setting;
    SUNContext context;
    N_Vector y;
    SUNNonlinearSolver solver;
    void *memory;
    bool ready;
} run;

#define RIGHT_SIDE(name)                                                       \
    static int name##_slopes(realtype t, N_Vector y, N_Vector dy,              \
                             void *unused) {                                   \
        (void)t, (void)unused;                                                 \
        name##_all(NV_DATA_S(y), NV_DATA_S(dy));                               \
        return 0;                                                              \
    }
RIGHT_SIDE(pendulum)
RIGHT_SIDE(double_pendulum)
RIGHT_SIDE(kepler)
RIGHT_SIDE(henon_heiles)
RIGHT_SIDE(outer_sun)
/* As adaptive steps may fall to nothing. */
enum { MOST_STEPS = 1000000 };

static void ignore(int code, const char *module, const char *function,
                   char *message, void *data) {
    (void)code, (void)module, (void)function, (void)message, (void)data;
}

static const ARKRhsFn right_sides[] = {pendulum_slopes, double_pendulum_slopes,
                                       kepler_slopes, henon_heiles_slopes,
                                       outer_sun_slopes};

static void close_run(void *data) {
    run *r = data;
    if (r->memory && r->method->data)
        ERKStepFree(&r->memory);
    else if (r->memory)
        CVodeFree(&r->memory);
    if (r->solver)
        SUNNonlinSolFree(r->solver);
    if (r->y)
        N_VDestroy(r->y);
    if (r->context)
        SUNContext_Free(&r->context);
    free(r);
}

static run *make_run(const method *m, const problem *p, double setting) {
    run *r = calloc(1, sizeof *r);
    if (!r)
        return NULL;
    *r = (run){.method = m, .problem = p, .setting = setting};
    SUNContext_Create(NULL, &r->context);
    r->y = N_VNew_Serial((sunindextype)(2 * p->n), r->context);
    memcpy(NV_DATA_S(r->y), p->start, 2 * p->n * sizeof(double));
    return r;
}

static void *open_erk(const method *m, const problem *p, double setting) {
    run *r = make_run(m, p, setting);
    if (!r)
        return NULL;
    r->memory = ERKStepCreate(right_sides[p - problems], 0, r->y, r->context);
    r->ready =
        r->memory &&
        !ERKStepSetTableNum(r->memory, *(const ARKODE_ERKTableID *)m->data) &&
        !ERKStepSetErrHandlerFn(r->memory, ignore, NULL) &&
        !ERKStepSetMaxNumSteps(r->memory, MOST_STEPS) &&
        !(m->adaptive
              ? ERKStepSStolerances(r->memory, setting, p->size * setting)
              : ERKStepSetFixedStep(r->memory, p->t_end / setting));
    return r;
}

static bool run_erk(void *data, double y[], double *seconds) {
    run *r = data;
    const problem *p = r->problem;
    double t;
    (void)seconds;
    memcpy(NV_DATA_S(r->y), p->start, 2 * p->n * sizeof *y);
    bool done = r->ready &&
                !ERKStepReInit(r->memory, right_sides[p - problems], 0, r->y) &&
                !ERKStepSetStopTime(r->memory, p->t_end) &&
                ERKStepEvolve(r->memory, p->t_end, r->y, &t, ARK_NORMAL) >= 0;
    memcpy(y, NV_DATA_S(r->y), 2 * p->n * sizeof *y);
    return done;
}

static void *open_adams(const method *m, const problem *p, double setting) {
    run *r = make_run(m, p, setting);
    if (!r)
        return NULL;
    r->memory = CVodeCreate(CV_ADAMS, r->context);
    r->solver = SUNNonlinSol_FixedPoint(r->y, 0, r->context);
    r->ready = r->memory &&
               !CVodeInit(r->memory, right_sides[p - problems], 0, r->y) &&
               !CVodeSStolerances(r->memory, setting, p->size * setting) &&
               !CVodeSetNonlinearSolver(r->memory, r->solver) &&
               !CVodeSetErrHandlerFn(r->memory, ignore, NULL) &&
               !CVodeSetMaxNumSteps(r->memory, MOST_STEPS);
    return r;
}

static bool run_adams(void *data, double y[], double *seconds) {
    run *r = data;
    const problem *p = r->problem;
    double t;
    (void)seconds;
    memcpy(NV_DATA_S(r->y), p->start, 2 * p->n * sizeof *y);
    bool done = r->ready && !CVodeReInit(r->memory, 0, r->y) &&
                !CVodeSetStopTime(r->memory, p->t_end) &&
                CVode(r->memory, p->t_end, r->y, &t, CV_NORMAL) >= 0;
    memcpy(y, NV_DATA_S(r->y), 2 * p->n * sizeof *y);
    return done;
}

static const ARKODE_ERKTableID zonneveld4 = ARKODE_ZONNEVELD_5_3_4,
                               dopri5 = ARKODE_DORMAND_PRINCE_7_4_5,
                               verner6 = ARKODE_VERNER_8_5_6,
                               fehlberg8 = ARKODE_FEHLBERG_13_7_8;
#define ERK(title, table, its_order)                                           \
    {title, false, open_erk, run_erk, close_run, &table, its_order}, {         \
        title ", adaptive", true, open_erk, run_erk, close_run, &table,        \
            its_order                                                          \
    }
static const method methods[] = {
    ERK("erk zonneveld4", zonneveld4, 4),
    ERK("erk dopri5", dopri5, 5),
    ERK("erk verner6", verner6, 6),
    ERK("erk fehlberg8", fehlberg8, 8),
    {"cvode adams", true, open_adams, run_adams, close_run, NULL, 12},
};
const library sundials_library = {.name = "SUNDIALS",
                                  .version = SUNDIALS_VERSION,
                                  .count = sizeof methods / sizeof *methods,
                                  .methods = methods};

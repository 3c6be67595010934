/* nevh: the step and the speed at which a live page opens.

   A scheme that is not symplectic is often far more accurate at first: its energy
   error, which grows, passes the bounded one of a symplectic scheme only later, the
   sooner the longer the step is.  Looked for is the smallest step at which that is
   seen within half a minute, at a speed at which the motion is seen as well; where the
   scene's is one with which the other scheme is unstable, a shorter one.  The
   page's module has this file, too, which therefore uses public functions alone.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "lesson.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SPEEDS = 4, BINS = 480, MOST_TRIALS = 48, MOST_SHORTER = 6 };
static const double watched = 20; /* seconds until the errors have crossed */
static const double away = 1e3;   /* an error of a scheme that is unstable */
static const double fine = 0.1; /* an error that is small beside the energies */
static const double tolerable = 0.5; /* one that is not */
static const double level = 4;       /* by which bounded errors grow */
static const double longest = 64;    /* step tried, in those of the scene */
static const double few = 30;        /* steps that show some of a motion */
static const double many = 2000; /* steps a second, which no picture shows */
static const double stays = 1.5; /* times of crossings, until which they last */

/* Two schemes on one start. */
typedef struct {
    const nevh_system *system;
    const nevh_integrator *kept, *other; /* symplectic, and not */
    nevh_options options;
    double dt, rate, scale; /* as of the scene */
    size_t most_steps;
} question;

enum {
    FOUND,
    LATE, /* the other one's error stays below for too long */
    OPEN, /* the symplectic one's error grows as well, at all steps */
    LONG  /* no more steps were allowed */
};
typedef struct {
    int why;
    double dt, rate;
    int faster;      /* rate is that of the scene times 2^faster */
    double crossing; /* time since the start */
    double reached;  /* the longest such time that was tried */
} lesson;

typedef struct {
    nevh_stepper *stepper;
    nevh_energy *energy;
    double *q, *p;
    double bin, most; /* the largest |error| in the bin, and in the run */
    int status;
} side;

typedef struct {
    double dt, crossing, error; /* crossing NAN: there was none */
    bool lost;                  /* the other one ran away */
} trial;

lesson_pace lesson_usual(nevh_scene *scene) {
    const nevh_scene_run *run = nevh_scene_run_settings(scene);
    const char *unit = nevh_scene_label(scene, "t");
    lesson_pace usual = {run->dts ? run->dt[0] : 0.01, 1};
    for (size_t i = 1; i < run->dts; i++)
        usual.dt = fmin(usual.dt, run->dt[i]);
    double span = (run->t_end - run->t_start) / 400, most = usual.dt;
    for (size_t i = 0; i < run->dts; i++)
        most = fmax(most, run->dt[i]);
    if (!unit || strcmp(unit, "s") != 0 || few * most > watched ||
        many * usual.dt < 1)
        usual.rate = fmax(40 * usual.dt,
                          isfinite(span) ? fmin(600 * usual.dt, span) : 0);
    return usual;
}

static int observe(void *data, size_t step, double t, const double q[],
                   const double p[]) {
    side *s = data;
    int status = nevh_energy_observe(s->energy, step, t, q, p);
    s->bin = fmax(s->bin, fabs(nevh_energy_error(s->energy, 0)));
    return status;
}

static void side_free(side *s) {
    nevh_stepper_free(s->stepper);
    nevh_energy_free(s->energy);
    free(s->q);
}

static void side_open(side *s, const question *x,
                      const nevh_integrator *scheme) {
    size_t n = nevh_system_dof(x->system);
    nevh_options o = x->options;
    *s = (side){.q = calloc(2 * n, sizeof *s->q)};
    if (!s->q) {
        s->status = NEVH_ENOMEM;
        return;
    }
    s->p = s->q + n;
    memcpy(s->q, o.q, n * sizeof *s->q);
    memcpy(s->p, o.p, n * sizeof *s->p);
    s->stepper = nevh_stepper_new(x->system, scheme, &o);
    s->energy = nevh_energy_new(x->system, &o);
    s->status = nevh_stepper_status(s->stepper);
    if (x->scale > 0)
        nevh_energy_set_scale(s->energy, x->scale);
    if (o.balance && !s->status)
        s->status = nevh_energy_follow(s->energy, s->stepper);
}

static void side_advance(side *s, const question *x, double dt, size_t from,
                         size_t steps) {
    nevh_observer watch = {.observe = observe, .data = s};
    double t0 = x->options.t + dt * (double)from;
    s->bin = 0;
    if (!s->status)
        s->status = nevh_run(s->stepper, t0, dt, steps, s->q, s->p, &watch, 1);
    if (s->status)
        s->bin = INFINITY;
    s->most = fmax(s->most, s->bin);
}

/* Runs both until the one has passed the other for good; returns the steps that
   were taken. */
static size_t try_step(const question *x, trial *result) {
    double dt = result->dt, half = 0,
           end = watched * x->rate * (1 << (SPEEDS - 1));
    size_t each = (size_t)fmax(1, rint(end * stays / BINS / dt)), done = 0;
    side kept, other;
    side_open(&kept, x, x->kept);
    side_open(&other, x, x->other);
    result->crossing = NAN;
    while (!kept.status && kept.most <= tolerable &&
           dt * (double)done < stays * end) {
        double t = dt * (double)done;
        side_advance(&kept, x, dt, done, each);
        side_advance(&other, x, dt, done, each);
        done += each;
        if (t < end / 2)
            half = kept.most;
        if (!(other.most > kept.most))
            result->crossing = NAN;
        else if (isnan(result->crossing))
            result->crossing = t;
        if (t > stays * result->crossing + x->rate)
            break;
    }
    bool stayed = !kept.status && kept.most <= fmin(tolerable, level * half);
    result->error = stayed ? kept.most : INFINITY;
    result->lost = !(other.most < away);
    side_free(&kept);
    side_free(&other);
    return 2 * done;
}

/* The next longer one of numbers that are read easily. */
static double next_step(double dt) {
    static const double known[] = {1, 1.25, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10};
    double power = floor(log10(dt) + 1e-9), up = pow(10, fabs(power)),
           next = dt;
    for (size_t i = 0; next <= dt * (1 + 1e-9); i++)
        next = power < 0 ? known[i] / up : known[i] * up;
    return next;
}

/* The slowest speed, and then the shortest step, at which the crossing is seen. */
static bool choose(const question *x, const trial tried[], size_t count,
                   double limit, lesson *found) {
    for (int k = 0; k < SPEEDS; k++)
        for (size_t i = 0; i < count; i++) {
            double rate = x->rate * (1 << k);
            if (tried[i].error <= limit && !tried[i].lost &&
                tried[i].crossing <= watched * rate) {
                *found = (lesson){.why = FOUND,
                                  .dt = tried[i].dt,
                                  .rate = rate,
                                  .faster = k,
                                  .crossing = tried[i].crossing};
                return true;
            }
        }
    return false;
}

static lesson find(const question *x) {
    trial tried[MOST_TRIALS];
    lesson found = {.why = OPEN, .dt = x->dt, .rate = x->rate};
    size_t count = 0, used = 0;
    double dt = next_step(x->dt * (1 - 1e-6));
    bool first = true;
    for (int broken = 0; count < MOST_TRIALS && broken < 2;) {
        trial *one = &tried[count++];
        *one = (trial){.dt = dt};
        used += try_step(x, one);
        first = first && one->lost && count < MOST_SHORTER;
        broken = isfinite(one->error) && !one->lost ? 0 : broken + !first;
        if (!broken && !first)
            found.why = LATE;
        if (!broken && dt < x->dt)
            found.dt = dt;
        dt = next_step(first ? 0.4 * dt : dt);
        if (choose(x, tried, count, fine, &found) && found.faster == 0)
            return found;
        if (used > x->most_steps || dt > longest * x->dt)
            break;
    }
    if (!choose(x, tried, count, fine, &found))
        choose(x, tried, count, tolerable, &found);
    if (found.why && used > x->most_steps)
        found.why = LONG;
    found.reached = watched * x->rate * (1 << (SPEEDS - 1));
    return found;
}

static const nevh_integrator *first_of(nevh_scene *scene,
                                       const char *const name[], size_t count,
                                       nevh_claim claim,
                                       const char *otherwise) {
    for (size_t i = 0; i < count; i++) {
        const nevh_integrator *one =
            nevh_scene_integrator_named(scene, name[i]);
        if (one && lesson_has(nevh_integrator_name(one)) &&
            !nevh_integrator_own_time(one) &&
            nevh_integrator_symplectic(one) == claim)
            return one;
    }
    return nevh_integrator_named(otherwise);
}

/* GSL, which those would need, is not in a page. */
bool lesson_has(const char *name) {
    return strncmp(name, "gsl-", 4) != 0 && strncmp(name, "tao", 3) != 0;
}

static void find_pair(nevh_scene *scene, const char *const name[], size_t count,
                      const nevh_integrator *pair[2]) {
    unsigned has = nevh_system_traits(nevh_scene_system(scene));
    const char *kept = has & NEVH_SEPARABLE ? "verlet" : "midpoint";
    pair[0] = first_of(scene, name, count, NEVH_YES, kept);
    pair[1] = first_of(scene, name, count, NEVH_NO, "rk4");
}

void lesson_find(nevh_scene *scene, const char *const name[], size_t count,
                 const char *gradient, const double start[], lesson_pace usual,
                 size_t most_steps, char text[LESSON_TEXT]) {
    const nevh_scene_run *run = nevh_scene_run_settings(scene);
    const nevh_system *system = nevh_scene_system(scene);
    const nevh_integrator *pair[2];
    if (!gradient)
        gradient = run->gradients ? run->gradient[0] : "central4";
    find_pair(scene, name, count, pair);
    question x = {.system = system,
                  .kept = pair[0],
                  .other = pair[1],
                  .options = {.gradient = nevh_gradient_named(gradient),
                              .gradient_step = run->gradient_step,
                              .gradient_steps = run->gradient_steps,
                              .t = run->t_start,
                              .q = start,
                              .p = start + nevh_system_dof(system),
                              .native = NEVH_NATIVE_NEVER,
                              .portable = true,
                              .balance = !(nevh_system_traits(system) &
                                           NEVH_AUTONOMOUS) ||
                                         nevh_system_friction(system, NULL)},
                  .dt = usual.dt,
                  .rate = usual.rate,
                  .scale = run->energy_scale,
                  .most_steps = most_steps};
    lesson found = find(&x);
    char crossing[40] = "null";
    if (found.why == FOUND)
        snprintf(crossing, sizeof crossing, "%.17g", found.crossing);
    snprintf(text, LESSON_TEXT,
             "{\"why\":%d,\"dt\":%.15g,\"faster\":%d,\"crossing\":%s,"
             "\"reached\":%.17g,\"schemes\":[\"%s\",\"%s\"]}",
             found.why, found.dt, found.faster, crossing, found.reached,
             nevh_integrator_name(pair[0]), nevh_integrator_name(pair[1]));
}

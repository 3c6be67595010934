/* nevh: compiled steps of scenes against loops written by hand, and of 32 orbits
   side by side against those of the tape.

   The loops have formulas, gradient and scheme inlined by the compiler, -O3
   -march=native; once with plain sums, and once with compensated ones, as nevh's
   steps have them: what a step loses to rounding begins the next one.  Runs are
   interleaved; medians.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <nevh/nevh.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

enum { ROUNDS = 9, STEPS = 100000, DOF = 2 };

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct {
    double w[64];
    size_t count;
} scheme;

static inline void pendulum_force(const double q[], double f[]) {
    f[0] = 9.8 * sin(q[0]);
}
static inline void kepler_force(const double q[], double f[]) {
    double r2 = q[0] * q[0] + q[1] * q[1], r3 = r2 * sqrt(r2);
    f[0] = q[0] / r3;
    f[1] = q[1] / r3;
}
static inline void henon_force(const double q[], double f[]) {
    f[0] = q[0] + 2 * q[0] * q[1];
    f[1] = q[1] + q[0] * q[0] - q[1] * q[1];
}

/* Kick first; the last kick's force is the next step's first. */
#define LOOP(name, n, force)                                                   \
    static void name(const scheme *s, double h, size_t steps, double q[],      \
                     double p[]) {                                             \
        double x[n], v[n], f[n];                                               \
        for (int k = 0; k < (n); k++)                                          \
            x[k] = q[k], v[k] = p[k];                                          \
        force(x, f);                                                           \
        for (size_t i = 0; i < steps; i++) {                                   \
            for (int k = 0; k < (n); k++)                                      \
                v[k] -= s->w[0] * h * f[k];                                    \
            for (size_t j = 1; j + 1 < s->count; j += 2) {                     \
                for (int k = 0; k < (n); k++)                                  \
                    x[k] += s->w[j] * h * v[k];                                \
                force(x, f);                                                   \
                for (int k = 0; k < (n); k++)                                  \
                    v[k] -= s->w[j + 1] * h * f[k];                            \
            }                                                                  \
        }                                                                      \
        for (int k = 0; k < (n); k++)                                          \
            q[k] = x[k], p[k] = v[k];                                          \
    }
LOOP(pendulum_loop, 1, pendulum_force)
LOOP(kepler_loop, 2, kepler_force)
LOOP(henon_loop, 2, henon_force)

/* What rounding loses of a + b. */
static inline double roundoff(double sum, double a, double b) {
    return fabs(a) >= fabs(b) ? b - (sum - a) : a - (sum - b);
}

/* The same with compensated sums. */
#define COMPENSATED_LOOP(name, n, force)                                       \
    static void name(const scheme *s, double h, size_t steps, double q[],      \
                     double p[]) {                                             \
        double x[n] = {0}, v[n] = {0}, dx[n] = {0}, dv[n] = {0}, f[n];         \
        force(q, f);                                                           \
        for (size_t i = 0; i < steps; i++) {                                   \
            for (int k = 0; k < (n); k++) {                                    \
                dv[k] -= s->w[0] * h * f[k];                                   \
                v[k] = p[k] + dv[k];                                           \
            }                                                                  \
            for (size_t j = 1; j + 1 < s->count; j += 2) {                     \
                for (int k = 0; k < (n); k++) {                                \
                    dx[k] += s->w[j] * h * v[k];                               \
                    x[k] = q[k] + dx[k];                                       \
                }                                                              \
                force(x, f);                                                   \
                for (int k = 0; k < (n); k++) {                                \
                    dv[k] -= s->w[j + 1] * h * f[k];                           \
                    v[k] = p[k] + dv[k];                                       \
                }                                                              \
            }                                                                  \
            for (int k = 0; k < (n); k++) {                                    \
                dx[k] = roundoff(x[k], q[k], dx[k]);                           \
                dv[k] = roundoff(v[k], p[k], dv[k]);                           \
                q[k] = x[k], p[k] = v[k];                                      \
            }                                                                  \
        }                                                                      \
    }
COMPENSATED_LOOP(pendulum_compensated, 1, pendulum_force)
COMPENSATED_LOOP(kepler_compensated, 2, kepler_force)
COMPENSATED_LOOP(henon_compensated, 2, henon_force)

static const scheme verlet = {{0.5, 1, 0.5}, 3};
/* As many stages as rkn11b has; what they weigh does not change the time. */
static scheme eleven(void) {
    scheme s = {.count = 23};
    for (size_t i = 0; i < 23; i++)
        s.w[i] = i % 2 ? 1.0 / 11 : i == 0 || i == 22 ? 1.0 / 22 : 1.0 / 11;
    return s;
}

typedef void loop(const scheme *, double, size_t, double[], double[]);
typedef struct {
    const char *name, *text;
    loop *by_hand[2];
    double h;
} subject;
static const subject subjects[] = {
    {"pendulum",
     "[coordinates]\nphi = 2\n[effects]\nT = p_phi^2/2\nV = -9.8*cos(phi)\n",
     {pendulum_loop, pendulum_compensated},
     0.01},
    {"kepler",
     "[coordinates]\nx = 0.4, 0\ny = 0, 2\n[effects]\n"
     "T = (p_x^2 + p_y^2)/2\nV = -1/sqrt(x^2 + y^2)\n",
     {kepler_loop, kepler_compensated},
     0.01},
    {"henon-heiles",
     "[coordinates]\nx = 0, 0.3\ny = 0.1, 0\n[effects]\n"
     "T = (p_x^2 + p_y^2)/2\nV = (x^2 + y^2)/2 + x^2*y - y^3/3\n",
     {henon_loop, henon_compensated},
     0.01}};

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double x[]) {
    qsort(x, ROUNDS, sizeof *x, by_size);
    return x[ROUNDS / 2];
}

typedef struct {
    nevh_stepper *s;
    double q[DOF], p[DOF], time[ROUNDS];
} run;

static void begin(run *r, nevh_scene *scene, const char *integrator,
                  const char *gradient, nevh_native_use use) {
    nevh_scene_start(scene, r->q, r->p);
    nevh_options o = {.gradient = nevh_gradient_named(gradient),
                      .q = r->q,
                      .p = r->p,
                      .native = use};
    r->s = nevh_stepper_new(nevh_scene_system(scene),
                            nevh_integrator_named(integrator), &o);
}

static void compare(const subject *x, const char *name, const scheme *hand) {
    static const char *const gradients[] = {"exact", "central2", "central4",
                                            "complex-step"};
    nevh_scene *scene = nevh_scene_parse(x->name, x->text);
    run tape, native[4];
    double q[2][DOF], p[2][DOF], time[2][ROUNDS];
    for (int c = 0; c < 2; c++)
        nevh_scene_start(scene, q[c], p[c]);
    begin(&tape, scene, name, "exact", NEVH_NATIVE_NEVER);
    for (int g = 0; g < 4; g++)
        begin(&native[g], scene, name, gradients[g], NEVH_NATIVE_ALWAYS);
    for (int i = 0; i < ROUNDS; i++) {
        for (int c = 0; c < 2; c++) {
            double t = seconds();
            x->by_hand[c](hand, x->h, STEPS, q[c], p[c]);
            time[c][i] = seconds() - t;
        }
        for (int g = 0; g < 5; g++) {
            run *r = g < 4 ? &native[g] : &tape;
            double t = seconds();
            nevh_run(r->s, 0, x->h, STEPS, r->q, r->p, NULL, 0);
            r->time[i] = seconds() - t;
        }
    }
    double own = median(time[0]), compensated = median(time[1]);
    double exact = median(native[0].time), unit = 1e9 / STEPS;
    printf("%s,%s,%.1f,%.1f,%.1f", x->name, name, own * unit,
           compensated * unit, median(tape.time) * unit);
    for (int g = 0; g < 4; g++)
        printf(",%.1f", median(native[g].time) * unit);
    printf(",%.2f,%.2f,%.2f,%.2f,%s\n", exact / own, exact / compensated,
           median(native[1].time) / exact, median(native[2].time) / exact,
           nevh_stepper_native(native[0].s, NULL) ? "yes" : "no");
    for (int g = 0; g < 4; g++)
        nevh_stepper_free(native[g].s);
    nevh_stepper_free(tape.s);
    nevh_scene_free(scene);
}

/* A step and orbit of LANES side by side, h = 0.005. */
enum { LANES = 32, SHORT = 2000 };
static const char double_pendulum[] =
    "[coordinates]\na = 2, 0\nb = 1, 0\n[effects]\n"
    "T = (p_a^2 - 2*p_a*p_b*cos(a - b) + 2*p_b^2)/(2 + 2*sin(a - b)^2)\n"
    "V = -19.6*cos(a) - 9.8*cos(b)\n";

static double side_by_side(nevh_scene *scene, const char *name,
                           const char *gradient, nevh_native_use use) {
    double q1[DOF], p1[DOF], q[DOF * LANES], p[DOF * LANES], time[ROUNDS];
    size_t n = nevh_scene_dof(scene);
    nevh_scene_start(scene, q1, p1);
    for (size_t i = 0; i < n * LANES; i++) {
        q[i] = q1[i / LANES] * (1 + 0.001 * (double)(i % LANES));
        p[i] = p1[i / LANES];
    }
    nevh_options o = {.gradient = nevh_gradient_named(gradient),
                      .q = q,
                      .p = p,
                      .width = LANES,
                      .native = use};
    nevh_stepper *s = nevh_stepper_new(nevh_scene_system(scene),
                                       nevh_integrator_named(name), &o);
    for (int i = 0; i < ROUNDS; i++) {
        double t = seconds();
        nevh_run(s, 0, 0.005, SHORT, q, p, NULL, 0);
        time[i] = seconds() - t;
    }
    nevh_stepper_free(s);
    return median(time) * 1e9 / SHORT / LANES;
}

static void compare_lanes(const char *name, const char *text,
                          const char *integrator) {
    static const char *const gradients[] = {"exact", "central4"};
    nevh_scene *scene = nevh_scene_parse(name, text);
    for (int g = 0; g < 2; g++)
        printf(
            "%s,%s,%s,%.2f,%.2f\n", name, integrator, gradients[g],
            side_by_side(scene, integrator, gradients[g], NEVH_NATIVE_NEVER),
            side_by_side(scene, integrator, gradients[g], NEVH_NATIVE_ALWAYS));
    nevh_scene_free(scene);
}

/* Implicit steps of one orbit, tape and compiled in turn. */
static void compare_stages(const char *name, const char *text, double h) {
    static const char *const gradients[] = {"exact", "central2", "central4"};
    enum { WAYS = 3, FEWER = STEPS / 10 };
    nevh_scene *scene = nevh_scene_parse(name, text);
    run tape[WAYS], native[WAYS];
    double exact = 0;
    for (int g = 0; g < WAYS; g++) {
        begin(&tape[g], scene, "gauss16", gradients[g], NEVH_NATIVE_NEVER);
        begin(&native[g], scene, "gauss16", gradients[g], NEVH_NATIVE_ALWAYS);
    }
    for (int i = 0; i < ROUNDS; i++)
        for (int g = 0; g < 2 * WAYS; g++) {
            run *r = g % 2 ? &native[g / 2] : &tape[g / 2];
            double t = seconds();
            nevh_run(r->s, 0, h, FEWER, r->q, r->p, NULL, 0);
            r->time[i] = seconds() - t;
        }
    for (int g = 0; g < WAYS; g++) {
        nevh_counts counts = nevh_stepper_counts(native[g].s);
        double own = median(native[g].time);
        exact = g ? exact : own;
        printf("%s,gauss16,%s,%.2f,%.0f,%.0f,%.2f,%s\n", name, gradients[g],
               (double)counts.sweeps / FEWER / ROUNDS,
               median(tape[g].time) * 1e9 / FEWER, own * 1e9 / FEWER,
               own / exact,
               nevh_stepper_native(native[g].s, NULL) ? "yes" : "no");
        nevh_stepper_free(tape[g].s);
        nevh_stepper_free(native[g].s);
    }
    nevh_scene_free(scene);
}

/* Chains of Fermi, Pasta, Ulam and Tsingou. */
static double spring(double r) {
    return r + 0.25 * r * r;
}

static void chain_force(size_t n, const double q[restrict],
                        double f[restrict]) {
    f[0] = spring(q[0]) - spring(q[1] - q[0]);
    for (size_t i = 1; i + 1 < n; i++)
        f[i] = spring(q[i] - q[i - 1]) - spring(q[i + 1] - q[i]);
    f[n - 1] = spring(q[n - 1] - q[n - 2]) - spring(-q[n - 1]);
}

static void chain_loop(size_t n, double h, size_t steps, double q[restrict],
                       double p[restrict], double f[restrict]) {
    chain_force(n, q, f);
    for (size_t s = 0; s < steps; s++) {
        for (size_t i = 0; i < n; i++) {
            p[i] -= h / 2 * f[i];
            q[i] += h * p[i];
        }
        chain_force(n, q, f);
        for (size_t i = 0; i < n; i++)
            p[i] -= h / 2 * f[i];
    }
}

/* With compensated sums: what q and p have lost stands in dq and dp. */
static void chain_compensated(size_t n, double h, size_t steps,
                              double q[restrict], double p[restrict],
                              double f[restrict], double dq[restrict],
                              double dp[restrict]) {
    chain_force(n, q, f);
    for (size_t s = 0; s < steps; s++) {
        for (size_t i = 0; i < n; i++) {
            dp[i] -= h / 2 * f[i];
            double d = dq[i] + h * (p[i] + dp[i]), x = q[i] + d,
                   part = x - q[i];
            dq[i] = (q[i] - (x - part)) + (d - part);
            q[i] = x;
        }
        chain_force(n, q, f);
        for (size_t i = 0; i < n; i++) {
            double d = dp[i] - h / 2 * f[i], v = p[i] + d, part = v - p[i];
            dp[i] = (p[i] - (v - part)) + (d - part);
            p[i] = v;
        }
    }
}

/* Seconds of the processor that compiling took. */
static double compiling(void) {
    struct rusage use;
    getrusage(RUSAGE_CHILDREN, &use);
    return (double)(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
           1e-6 * (double)(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

static nevh_stepper *chain_stepper(nevh_scene *scene, nevh_native_use use,
                                   double z[]) {
    size_t n = nevh_scene_dof(scene);
    nevh_scene_start(scene, z, z + n);
    nevh_options o = {.gradient = nevh_exact,
                      .q = z,
                      .p = z + n,
                      .native = use,
                      .native_cache = ""};
    return nevh_stepper_new(nevh_scene_system(scene), nevh_verlet, &o);
}

/* Nanoseconds of a mass and step: the tape, compiled, the loops.  A run begins and
   ends with copies of its state, which cost as much as ten steps of 1e6 masses. */
enum { TAPE, COMPILED, PLAIN, COMPENSATED, CHAINS };
static void time_chain(size_t n, nevh_stepper *const s[2],
                       double *const z[CHAINS], double time[CHAINS]) {
    size_t most = n < 1000000 ? 2000000 / n : 100;
    size_t few = n < 1000000 ? most : 10;
    double all[CHAINS][ROUNDS], *f = calloc(3 * n, sizeof *f);
    for (int i = 0; i < ROUNDS; i++)
        for (int k = 0; k < CHAINS; k++) {
            size_t steps = k == TAPE ? few : most;
            double t = seconds();
            if (k == PLAIN)
                chain_loop(n, 0.05, steps, z[k], z[k] + n, f);
            else if (k == COMPENSATED)
                chain_compensated(n, 0.05, steps, z[k], z[k] + n, f, f + n,
                                  f + 2 * n);
            else
                nevh_run(s[k], 0, 0.05, steps, z[k], z[k] + n, NULL, 0);
            all[k][i] = (seconds() - t) / (double)steps;
        }
    for (int k = 0; k < CHAINS; k++)
        time[k] = median(all[k]) * 1e9 / (double)n;
    free(f);
}

/* Per mass and step. */
static void compare_chain(size_t n) {
    char text[500];
    double *z[CHAINS], time[CHAINS];
    snprintf(text, sizeof text,
             "[parameters]\nN = %zu\na = 0.25\n[coordinates]\n"
             "x[i = 1..N] = sin(0.6*i)\n[effects]\n"
             "T = sum(i = 1..N, p_x[i]^2/2)\n"
             "V = x[1]^2/2 + sum(i = 1..N-1, (x[i+1] - x[i])^2/2) + x[N]^2/2\n"
             "U = a/3*(x[1]^3 + sum(i = 1..N-1, (x[i+1] - x[i])^3) - x[N]^3)\n",
             n);
    nevh_scene *scene = nevh_scene_parse("chain", text);
    for (int k = 0; k < CHAINS; k++) {
        z[k] = calloc(2 * n, sizeof *z[k]);
        nevh_scene_start(scene, z[k], z[k] + n);
    }
    nevh_stepper *s[2] = {chain_stepper(scene, NEVH_NATIVE_NEVER, z[TAPE])};
    double begun = compiling();
    s[COMPILED] = chain_stepper(scene, NEVH_NATIVE_ALWAYS, z[COMPILED]);
    double compiled = compiling() - begun;
    time_chain(n, s, z, time);
    double own = time[COMPILED];
    printf("%zu,verlet,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.0f,%s\n", n, time[PLAIN],
           time[COMPENSATED], time[TAPE], own, own / time[PLAIN],
           own / time[COMPENSATED], compiled * 1e3,
           nevh_stepper_native(s[COMPILED], NULL) ? "yes" : "no");
    for (int k = 0; k < CHAINS; k++)
        free(z[k]);
    nevh_stepper_free(s[0]);
    nevh_stepper_free(s[1]);
    nevh_scene_free(scene);
}

int main(void) {
    scheme long_one = eleven();
    puts("system,integrator,by_hand_ns,compensated_ns,tape_ns,exact_ns,"
         "central2_ns,central4_ns,complex_ns,exact/by_hand,exact/compensated,"
         "central2/exact,central4/exact,native");
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++) {
        compare(&subjects[i], "verlet", &verlet);
        compare(&subjects[i], "rkn11b", &long_one);
    }
    puts("\none orbit,integrator,gradient,sweeps,tape_ns,native_ns,to exact,"
         "native");
    compare_stages(subjects[0].name, subjects[0].text, 0.1);
    compare_stages("double-pendulum", double_pendulum, 0.02);
    puts("\n32 orbits,integrator,gradient,tape_ns,native_ns");
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++) {
        compare_lanes(subjects[i].name, subjects[i].text, "verlet");
        compare_lanes(subjects[i].name, subjects[i].text, "rk4");
    }
    compare_lanes("double-pendulum", double_pendulum, "rk4");
    compare_lanes(subjects[0].name, subjects[0].text, "gauss16");
    compare_lanes("double-pendulum", double_pendulum, "gauss16");
    puts("\nmasses of a chain,integrator,by_hand_ns,compensated_ns,tape_ns,"
         "exact_ns,exact/by_hand,exact/compensated,compiling_ms,native");
    compare_chain(10);
    compare_chain(1000);
    compare_chain(1000000);
    return 0;
}

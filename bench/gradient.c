/* nevh: what a gradient costs, against one written by hand.

       bench/gradient [commit [results.csv]]

   The double pendulum's gradient is measured for one orbit and for orbits side
   by side, the chain's for one orbit of up to a million masses.  All take
   turns in every round, so that a machine that slows down does so for all;
   printed are medians over the rounds, of times and of ratios within a round.
   Goals are the project's; nothing fails where they are missed.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient_systems.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

enum { ROUNDS = 21, ORBITS = 64, MOST = 32 };
static const double least_time = 0.002; /* seconds of CPU a turn */

typedef struct {
    const char *name;
    double goal;      /* of the ratio; 0: none */
    size_t per;       /* orbits, or masses, in one call */
    size_t yardstick; /* which one the ratio is to */
    nevh_system *system;
    nevh_field *field; /* NULL: by hand */
    gradient_states states[ORBITS];
    size_t count; /* of states */
    size_t turns;
    double planning; /* ms */
    double memory;   /* bytes, at the peak */
    double ns[ROUNDS], ratio[ROUNDS];
} contender;

/* What a physicist would write: the double pendulum, m = l = 1. */
static void by_hand(const double q[], const double p[], double dh_dq[],
                    double dh_dp[]) {
    const double g = 9.8;
    double s = sin(q[0] - q[1]), c = cos(q[0] - q[1]), root = 1 + s * s;
    double form = p[0] * p[0] + 2 * p[1] * p[1] - 2 * p[0] * p[1] * c;
    double both = s * (p[0] * p[1] - form * c / root) / root;
    dh_dq[0] = both + 2 * g * sin(q[0]);
    dh_dq[1] = -both + g * sin(q[1]);
    dh_dp[0] = (p[0] - p[1] * c) / root;
    dh_dp[1] = (2 * p[1] - p[0] * c) / root;
}

/* As a solver would call it. */
static void (*volatile hand_written)(const double[], const double[], double[],
                                     double[]) = by_hand;

/* What a student would write. */
static double hamiltonian(double t, const double q[], const double p[],
                          const void *params) {
    double d = q[0] - q[1], s = sin(d);
    (void)t, (void)params;
    return (p[0] * p[0] + 2 * p[1] * p[1] - 2 * p[0] * p[1] * cos(d)) /
               (2 * (1 + s * s)) -
           9.8 * (2 * cos(q[0]) + cos(q[1]));
}

static nevh_system *plain_system(void) {
    return nevh_system_from(2, hamiltonian, NULL);
}

static nevh_system *model_system(void) {
    const nevh_model *model = nevh_double_pendulum_model;
    return model->system(model->defaults);
}

static void fail(const char *what, const char *why) {
    fprintf(stderr, "%s: %s\n", what, why);
    exit(EXIT_FAILURE);
}

static double now(void) {
    return (double)clock() / CLOCKS_PER_SEC;
}

static double peak_memory(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return 1024. * (double)usage.ru_maxrss; /* Linux counts in KiB */
}

static void plan(contender *c, const nevh_gradient *gradient, double step) {
    const gradient_states *s = &c->states[0];
    nevh_options options = {.gradient = gradient,
                            .gradient_step = step,
                            .q = s->q,
                            .p = s->p,
                            .width = s->width};
    double start = now();
    c->field = nevh_field_new(c->system, &options);
    c->planning = 1000 * (now() - start);
    if (nevh_field_status(c->field))
        fail(c->name, nevh_field_message(c->field));
}

static void turn(contender *c, size_t times) {
    for (size_t i = 0; i < times; i++)
        for (gradient_states *s = c->states; s < c->states + c->count; s++)
            if (!c->field)
                hand_written(s->q, s->p, s->dh_dq, s->dh_dp);
            else if (gradient_states_evaluate(c->field, s))
                fail(c->name, nevh_field_message(c->field));
}

static double time_turn(contender *c) {
    double start = now();
    turn(c, c->turns);
    return now() - start;
}

static void calibrate(contender *c) {
    for (c->turns = 1; time_turn(c) < least_time; c->turns *= 2)
        ;
}

/* ORBITS double pendulums, `width` of them side by side. */
static contender pendulums(const char *name, nevh_system *(*system)(void),
                           const nevh_gradient *gradient, double step,
                           size_t width, double goal) {
    contender c = {.name = name,
                   .goal = goal,
                   .per = width,
                   .system = system ? system() : NULL,
                   .count = ORBITS / width};
    for (size_t i = 0; i < c.count; i++) {
        const double q[] = {1 + 0.1 * (double)i, -1}, p[] = {2, 1};
        c.states[i] = gradient_states_new(2, width, q, p, 0.3);
        if (!c.states[i].t)
            fail(name, "out of memory");
    }
    if (system)
        plan(&c, gradient, step);
    calibrate(&c);
    return c;
}

static contender chain(size_t masses, size_t yardstick) {
    contender c = {.name = "chain",
                   .goal = 1.5,
                   .per = masses,
                   .yardstick = yardstick,
                   .count = 1};
    double before = peak_memory();
    c.system = chain_system(masses);
    c.states[0] = gradient_states_new(masses, 1, NULL, NULL, 0.3);
    if (!c.system || !c.states[0].t)
        fail(c.name, "out of memory");
    plan(&c, nevh_central4, 0);
    calibrate(&c);
    c.memory = peak_memory() - before;
    return c;
}

static void play(contender *all, size_t count) {
    for (size_t round = 0; round < ROUNDS; round++) {
        for (size_t i = 0; i < count; i++)
            all[i].ns[round] =
                1e9 * time_turn(&all[i]) /
                (double)(all[i].turns * all[i].count * all[i].per);
        for (size_t i = 0; i < count; i++)
            all[i].ratio[round] =
                all[i].ns[round] / all[all[i].yardstick].ns[round];
    }
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(const double from[ROUNDS]) {
    double sorted[ROUNDS];
    memcpy(sorted, from, sizeof sorted);
    qsort(sorted, ROUNDS, sizeof *sorted, by_size);
    return sorted[ROUNDS / 2];
}

static void print_pendulums(const contender *all, size_t count) {
    puts("| double pendulum, gradient | orbits | ns an orbit | ratio | goal | "
         "planning, ms |\n|---|---:|---:|---:|---:|---:|");
    for (size_t i = 0; i < count; i++) {
        const contender *c = &all[i];
        char goal[16] = "";
        if (c->goal > 0)
            snprintf(goal, sizeof goal, "%.1f", c->goal);
        printf("| %s | %zu | %.1f | %.2f | %s | %.2f |\n", c->name, c->per,
               median(c->ns), median(c->ratio), goal, c->planning);
    }
}

static void print_chains(const contender *all, size_t count) {
    puts("\n| chain, central4: masses | ns a mass | ratio | goal | planning, "
         "ms | memory, MB | bytes a mass |\n|---:|---:|---:|---:|---:|---:|---:"
         "|");
    for (size_t i = 0; i < count; i++) {
        const contender *c = &all[i];
        printf("| %zu | %.1f | %.2f | %.1f | %.1f | %.2f | %.0f |\n", c->per,
               median(c->ns), median(c->ratio), c->goal, c->planning,
               c->memory / 1e6, c->memory / (double)c->per);
    }
    printf("\nPeak memory of the whole process: %.0f MB\n",
           peak_memory() / 1e6);
}

/* The processor's name, as Linux tells it. */
static const char *processor(void) {
    static char line[200];
    FILE *file = fopen("/proc/cpuinfo", "r");
    char *colon = NULL;
    while (file && !colon && fgets(line, sizeof line, file))
        if (strncmp(line, "model name", 10) == 0)
            colon = strchr(line, ':');
    if (file)
        fclose(file);
    if (!colon)
        return "unknown";
    line[strcspn(line, "\n")] = '\0';
    return colon + 1 + strspn(colon + 1, " ");
}

static void write_results(const char *path, const char *commit,
                          const contender *all, size_t count) {
    FILE *file = fopen(path, "w");
    if (!file)
        fail(path, "cannot be written");
    fprintf(file,
            "# compiler: %s\n# processor: %s\n# commit: %s\n"
            "name,size,ns,ratio,goal,planning_ms,bytes\n",
            __VERSION__, processor(), commit);
    for (size_t i = 0; i < count; i++)
        fprintf(file, "%s,%zu,%.3f,%.4f,%g,%.3f,%.0f\n", all[i].name,
                all[i].per, median(all[i].ns), median(all[i].ratio),
                all[i].goal, all[i].planning, all[i].memory);
    if (fclose(file))
        fail(path, "cannot be written");
}

static void retire(contender *c) {
    nevh_field_free(c->field);
    nevh_system_free(c->system);
    for (size_t i = 0; i < c->count; i++)
        gradient_states_free(&c->states[i]);
}

int main(int argc, char **argv) {
    static contender all[MOST];
    const char *commit = argc > 1 ? argv[1] : "unknown";
    size_t count = 0, chains;
    nevh_system *(*const body)(void) = double_pendulum_system;
    all[count++] = pendulums("by hand", NULL, NULL, 0, 1, 0);
    all[count++] = pendulums("central2", body, nevh_central2, 0, 1, 2);
    all[count++] = pendulums("central2", body, nevh_central2, 0, 8, 1);
    all[count++] = pendulums("central2", body, nevh_central2, 0, ORBITS, 1);
    all[count++] =
        pendulums("central2; step given", body, nevh_central2, 0x1p-17, 1, 2);
    all[count++] =
        pendulums("central2; step given", body, nevh_central2, 0x1p-17, 8, 1);
    all[count++] = pendulums("central4", body, nevh_central4, 0, 1, 0);
    all[count++] = pendulums("central4", body, nevh_central4, 0, 8, 0);
    all[count++] = pendulums("central4", body, nevh_central4, 0, ORBITS, 0);
    all[count++] = pendulums("complex-step", body, nevh_complex_step, 0, 1, 5);
    all[count++] = pendulums("exact", body, nevh_exact, 0, 1, 0);
    all[count++] = pendulums("exact", body, nevh_exact, 0, 8, 0);
    all[count++] = pendulums("exact", body, nevh_exact, 0, ORBITS, 0);
    all[count++] =
        pendulums("central2; plain H", plain_system, nevh_central2, 0, 1, 0);
    all[count++] =
        pendulums("central2; the model", model_system, nevh_central2, 0, 1, 0);
    all[count++] =
        pendulums("central2; the model", model_system, nevh_central2, 0, 8, 1);
    all[count++] = pendulums("central2; the model", model_system, nevh_central2,
                             0, ORBITS, 1);
    chains = count;
    for (size_t masses = 100; masses <= 1000000; masses *= 10)
        all[count++] = chain(masses, chains);
    play(all, count);
    printf("%s; GCC %s; %s; medians of %d rounds\n\n", processor(), __VERSION__,
           commit, ROUNDS);
    print_pendulums(all, chains);
    print_chains(all + chains, count - chains);
    if (argc > 2)
        write_results(argv[2], commit, all, count);
    for (size_t i = 0; i < count; i++)
        retire(&all[i]);
    return 0;
}

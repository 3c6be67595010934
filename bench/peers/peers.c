/* nevh: measured against other libraries at equal state error.

       bench/peers/peers RESULTS.csv RESULTS.md [rounds [longest [problem]]]

   longest: CPU seconds that a run may take, while settings are sought.
   problem: that one alone.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "bench.h"
#include "nevh_systems.h"
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 2000 };

static void fail(const char *what, const char *why) {
    fprintf(stderr, "%s: %s\n", what, why);
    exit(EXIT_FAILURE);
}

typedef struct {
    size_t size, n;
    double least[2 * MOST_N], most[2 * MOST_N];
} extent;

static int widen(void *data, size_t step, double t, const double q[],
                 const double p[]) {
    extent *e = data;
    (void)step, (void)t;
    for (size_t k = 0; k < 2 * e->n; k++) {
        double x = k < e->n ? q[k] : p[k - e->n];
        e->least[k] = fmin(e->least[k], x);
        e->most[k] = fmax(e->most[k], x);
    }
    return 0;
}

/* The range of each variable, 2n, from a run of Gauss' method of order 20,
   whose end must be the reference. */
static void find_ranges(const problem *p, double ranges[]) {
    nevh_options options = {.gradient = nevh_exact};
    nevh_system *system = nevh_system_of(p);
    nevh_stepper *stepper = nevh_stepper_new(system, nevh_gauss20, &options);
    double y[2 * MOST_N];
    extent e = {.n = p->n};
    for (size_t k = 0; k < 2 * p->n; k++) {
        e.least[k] = INFINITY;
        e.most[k] = -INFINITY;
    }
    memcpy(y, p->start, sizeof y);
    if (nevh_run(stepper, 0, p->t_end / SAMPLES, SAMPLES, y, y + p->n,
                 &(nevh_observer){.observe = widen, .data = &e}, 1))
        fail(p->name, nevh_stepper_message(stepper));
    for (size_t k = 0; k < 2 * p->n; k++)
        ranges[k] = e.most[k] - e.least[k];
    double error = problem_error(p, ranges, y);
    printf("%s: gauss20 is %.1e from the reference\n", p->title, error);
    if (!(error < 1e-11))
        fail(p->name, "the reference is not met");
    nevh_stepper_free(stepper);
    nevh_system_free(system);
}

static void enter(contest *c, const library *l, const char *name,
                  char *missing) {
    if (l) {
        c->libraries[c->library_count++] = l;
        return;
    }
    printf("%s was not found and is left out\n", name);
    strcat(strcat(missing, *missing ? ", " : ""), name);
}

static FILE *open_file(const char *path) {
    FILE *file = fopen(path, "w");
    if (!file)
        fail(path, "cannot be written");
    return file;
}

static void close_file(const char *path, FILE *file) {
    if (ferror(file) || fclose(file))
        fail(path, "cannot be written");
}

int main(int argc, char **argv) {
    static contest c;
    static char missing[200];
    if (argc < 3)
        fail("usage",
             "peers RESULTS.csv RESULTS.md [rounds [longest [problem]]]");
    double rounds = argc > 3 ? atof(argv[3]) : 9;
    double longest = argc > 4 ? atof(argv[4]) : 0.1;
    if (!(rounds >= 1 && rounds <= MOST_ROUNDS && longest > 0))
        fail(argv[0], "from 1 to 25 rounds, longest > 0");
    c.rounds = (size_t)rounds;
    enter(&c, &nevh_library, "nevh", missing);
    enter(&c, &nevh_numerical_library, "nevh", missing);
    enter(&c, &nevh_text_library, "nevh", missing);
    enter(&c, &nevh_text_numerical_library, "nevh", missing);
    enter(&c, &gsl_library, "GSL", missing);
    enter(&c, &boost_library, "Boost.odeint", missing);
    enter(&c, &sundials_library, "SUNDIALS", missing);
    enter(&c, &scipy_library, "SciPy", missing);
    if (&paper_library)
        enter(&c, &paper_library, "", missing);
    for (const problem *p = problems; p < problems + problem_count; p++) {
        double ranges[2 * MOST_N];
        if (argc > 5 && strcmp(argv[5], p->name))
            continue;
        find_ranges(p, ranges);
        find_entries(&c, p, ranges, longest);
        play(&c, p);
    }
    circumstances a = {NEVH_BENCH_COMMIT, __VERSION__, NEVH_BENCH_FLAGS,
                       missing};
    FILE *csv = open_file(argv[1]), *markdown = open_file(argv[2]);
    write_csv(csv, &c, &a);
    write_markdown(markdown, &c, &a);
    write_markdown(stdout, &c, &a);
    close_file(argv[1], csv);
    close_file(argv[2], markdown);
    return 0;
}

/* nevh: SciPy as a peer, in a Python process of its own that is asked through
   pipes and takes its own time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _POSIX_C_SOURCE 200809L
#include "peer.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct {
    const method *method;
    const problem *problem;
    double setting;
} run;

static FILE *questions, *answers;
static bool tried, lives;

static void become_python(const int in[2], const int out[2]) {
    const char *python = getenv("PYTHON"), *script = getenv("NEVH_BENCH_PY");
    dup2(in[0], 0);
    dup2(out[1], 1);
    close(in[1]);
    close(out[0]);
    execlp(python, python, script, (char *)NULL);
    _exit(127);
}

static bool start_python(void) {
    int in[2], out[2];
    char version[100];
    if (tried)
        return lives;
    tried = true;
    signal(SIGPIPE, SIG_IGN); /* it may die */
    if (pipe(in) || pipe(out))
        return false;
    if (fork() == 0)
        become_python(in, out);
    close(in[0]);
    close(out[1]);
    questions = fdopen(in[1], "w");
    answers = fdopen(out[0], "r");
    lives = questions && answers && fgets(version, sizeof version, answers);
    return lives;
}

static void *open_run(const method *m, const problem *p, double setting) {
    run *r = start_python() ? calloc(1, sizeof *r) : NULL;
    if (r)
        *r = (run){m, p, setting};
    return r;
}

static bool ask(void *data, double y[], double *seconds) {
    const run *r = data;
    const problem *p = r->problem;
    fprintf(questions, "%s %s %.17g %.17g %g", p->name,
            (const char *)r->method->data, r->setting, p->t_end, p->size);
    for (size_t i = 0; i < 2 * p->n; i++)
        fprintf(questions, " %.17g", p->start[i]);
    fputc('\n', questions);
    fflush(questions);
    if (fscanf(answers, "%lf", seconds) != 1)
        return lives = false;
    for (size_t i = 0; i < 2 * p->n; i++)
        if (fscanf(answers, "%la", &y[i]) != 1)
            return false;
    return true;
}

static const method paper = {"RK45", true, open_run, ask, free, "paper", 5};
static const method by_hand = {"DOP853", true, open_run, ask, free, "hand", 8};
const library paper_library = {.name = "the paper: SciPy, differences",
                               .version = NEVH_BENCH_SCIPY,
                               .count = 1,
                               .methods = &paper,
                               .outside = true};
const library scipy_library = {.name = "SciPy",
                               .version = NEVH_BENCH_SCIPY,
                               .count = 1,
                               .methods = &by_hand,
                               .outside = true};

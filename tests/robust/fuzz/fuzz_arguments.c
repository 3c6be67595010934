/* nevh tests: any command line is a plan, or a message and the status of wrong
   use.  Each line of the bytes is an argument.
   SPDX-License-Identifier: GPL-3.0-or-later

   For libFuzzer; see run.sh. */
#include "fuzz.h"
#include "experiment/plan.h"
#include <getopt.h>
#include <math.h>
#include <string.h>

enum { MOST = 40 };
static const char tiny[] = "[parameters]\n"
                           "k = 2\nc[1..2] = 1, 2\n"
                           "[coordinates]\n"
                           "x[1..2] = 1, 0.5\n"
                           "[effects]\n"
                           "kinetic = sum(i = 1..2, p_x[i]^2/2)\n"
                           "spring = k*sum(i = 1..2, c[i]*x[i]^2)\n"
                           "[run]\n"
                           "dt = 0.1\nt_end = 9\ntransform = 1 + x[1]^2\n";

/* The scene's file. */
static const char *scene(void) {
    static char *path;
    if (!path) {
        path = fuzz_file("arguments.nevh");
        fuzz_write(path, tiny, sizeof tiny - 1);
    }
    return path;
}

static void insist_on_plan(const plan *p) {
    insist(p->n == 2 && p->dts > 0 && p->gradients.count > 0);
    insist(p->integrators.count > 0 && isfinite(p->t_end));
    for (size_t i = 0; i < p->dts; i++)
        insist(p->dt[i] > 0 && (p->t_end - p->run->t_start) / p->dt[i] < 1e16);
    for (size_t i = 0; i < p->integrators.count; i++) {
        nevh_stepper *s = plan_stepper(p, p->integrators.item[i]);
        insist(!nevh_stepper_status(s) || *nevh_stepper_message(s));
        nevh_stepper_free(s);
    }
}

static void use(options *o) {
    plan p;
    const command some = {.name = "some", .options = "SCENE STEPS every"};
    for (size_t i = 0; i < o->given.count; i++) {
        const option_row *row = option_find(o->given.item[i]);
        insist(row && strcmp(row->name, o->given.item[i]) == 0);
        insist(command_takes(&some, row) || row->group == NULL ||
               strcmp(row->group, "SCENE") != 0);
    }
    int status = plan_make(&p, o);
    insist(status == TOOL_OK || status == TOOL_USAGE);
    if (!status)
        insist_on_plan(&p);
    plan_free(&p);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    char *text = fuzz_text(bytes, size), *at = text;
    char *argv[MOST + 4] = {"nevh", "compare", (char *)(uintptr_t)scene()};
    int argc = 3;
    fuzz_hush();
    for (; at && argc < MOST + 3; argc++) {
        argv[argc] = at;
        at = strchr(at, '\n');
        if (at)
            *at++ = '\0';
    }
    options o;
    optind = 0; /* glibc: from the beginning */
    int status = options_read(&o, argc, argv);
    insist(status == TOOL_OK || status == TOOL_USAGE);
    if (!status)
        use(&o);
    tool_release_all();
    free(text);
    return 0;
}

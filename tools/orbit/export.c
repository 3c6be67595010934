/* nevh export: the steps of one integrator as a C program.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "experiment/plan.h"
#include <math.h>

static int write_text(const options *o, const char *text) {
    output out;
    if (output_open(&out, o->file))
        return TOOL_USAGE;
    fputs(text, out.stream);
    return output_close(&out, TOOL_OK);
}

static int export_plan(const options *o, const plan *p) {
    const char *name, **names = tool_allocate(p->n, sizeof *names);
    nevh_stepper *s = plan_first(p, &name);
    nevh_program as = {.names = names,
                       .h = p->dt[0],
                       .t_end = p->t_end,
                       .every = o->every ? o->every : 1,
                       .functions = o->header};
    for (size_t k = 0; k < p->n; k++)
        names[k] = nevh_scene_coordinate(p->scene, k);
    if (!p->friction && !p->balance)
        as.energy_scale = plan_energy_scale(p);
    char *text = s ? text_adopt(nevh_stepper_program(s, &as)) : NULL;
    int status = TOOL_USAGE;
    if (text)
        status = write_text(o, text);
    else if (s)
        tool_refuse("%s: %s", name, nevh_stepper_message(s));
    nevh_stepper_free(s);
    return status;
}

static int export_scene(const options *o) {
    plan p = {0};
    int status = plan_make(&p, o);
    if (!status && !(p.dts && p.dt[0] > 0 && isfinite(p.t_end)))
        status = tool_refuse("a program takes steps of dt up to t_end: give "
                             "both");
    if (!status)
        status = export_plan(o, &p);
    plan_free(&p);
    return status;
}

const command export_command = {
    .name = "export",
    .operand = "SCENE",
    .brief = "the steps as a C program",
    .help =
        "the steps of one integrator as a C program that needs nothing else",
    .examples = "export pendulum -o pendulum.c\n"
                "export kepler --integrators gauss6 --header -o kepler.h",
    .options = "SCENE STEPS tolerance every header output",
    .run = export_scene,
};

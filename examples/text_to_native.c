/* H as text, and steps at the speed of compiled code.
   The library reads formulas as the command nevh does.  With
   nevh_options.native it writes them, their gradient and the scheme as one C
   function, has the compiler that there is compile that, and takes the steps
   with it: the same orbit, to the last bit.  Where there is no compiler, or a
   scheme has no such steps, nevh_stepper_native says why, and all goes on.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/nevh.h>
#include <stdio.h>
#include <time.h>

static const char pendulum[] = "[parameters]\n"
                               "g = 9.8\n"
                               "[coordinates]\n"
                               "phi = 2\n"
                               "[effects]\n"
                               "kinetic = p_phi^2/2\n"
                               "gravity = -g*cos(phi)\n";
enum { STEPS = 100000 };
static const double h = 0.05;

typedef struct {
    double q, p, seconds;
    const char *why; /* "": as asked for */
    int status;
} orbit;

static double now(void) {
    struct timespec t;
    timespec_get(&t, TIME_UTC);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static orbit run(nevh_scene *scene, const char *scheme, nevh_native_use native,
                 char why[400]) {
    orbit o = {.why = why};
    nevh_scene_start(scene, &o.q, &o.p);
    nevh_options options = {.q = &o.q,
                            .p = &o.p,
                            .gradient = nevh_exact,
                            .native = native,
                            .steps_foreseen = STEPS};
    nevh_stepper *s = nevh_stepper_new(nevh_scene_system(scene),
                                       nevh_integrator_named(scheme), &options);
    const char *reason;
    bool compiled = nevh_stepper_native(s, &reason);
    snprintf(why, 400, "%s", compiled ? "" : reason);
    double start = now();
    o.status = nevh_run(s, 0, h, STEPS, &o.q, &o.p, NULL, 0);
    o.seconds = now() - start;
    nevh_stepper_free(s);
    return o;
}

int main(void) {
    static const char *const schemes[] = {"verlet", "rkn11b", "rk4", "gauss8",
                                          "gonzalez"};
    int status = 0;
    nevh_scene *scene = nevh_scene_parse("pendulum", pendulum);
    if (nevh_scene_status(scene)) {
        puts(nevh_scene_message(scene));
        return 1;
    }
    puts(" integrator  ns a step,  ns a step,  the same\n"
         "             formulas    compiled    orbit");
    for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++) {
        char why[400];
        orbit tape = run(scene, schemes[i], NEVH_NATIVE_NEVER, why);
        orbit native = run(scene, schemes[i], NEVH_NATIVE_ALWAYS, why);
        bool same = tape.q == native.q && tape.p == native.p;
        printf(" %-11s %9.0f %11.0f    %-4s %s\n", schemes[i],
               1e9 * tape.seconds / STEPS, 1e9 * native.seconds / STEPS,
               same ? "yes" : "no", native.why);
        status |= tape.status || native.status || !same;
    }
    nevh_scene_free(scene);
    return status;
}

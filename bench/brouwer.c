/* nevh bench: the energy of Kepler's problem over very many periods by Taylor series.

   Errors of rounding walk at random where nothing pushes them one way (Brouwer): the
   energy's grow as the root of the time.  Prints, for numbers of periods that go by
   twos, the root mean square over orbits of the relative error of the energy since
   the start, and at the end the largest, and the power of time that fits.
   Usage: brouwer [PERIODS [ORBITS [TOLERANCE]]]; 1e6, 4, 1e-25
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <nevh/nevh.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <stdlib.h>

static const char scene_text[] =
    "[coordinates]\nx = 0.4\ny = 0\np_y = 2\n[effects]\n"
    "kinetic = (p_x^2 + p_y^2)/2\ngravity = -1/sqrt(x^2 + y^2)\n"
    "[run]\nt_end = 1\n";
/* Eight are 1.006 periods: orbits are looked at in other places each time. */
static const double h = 0.79;
enum { STEPS = 8, SAMPLES = 16 }; /* of a period; the last periods */

/* Rounding of the state alone makes errors of the energy; values add none. */
static long double energy(const double q[], const double p[]) {
    long double x = q[0], y = q[1], px = p[0], py = p[1];
    return (px * px + py * py) / 2 - 1 / sqrtl(x * x + y * y);
}

typedef struct {
    nevh_stepper *stepper;
    double q[2], p[2];
    long double first;
    size_t steps;
    double most;
} orbit;

/* Returns the error after so many steps more. */
static double go(orbit *o, size_t steps) {
    int status = nevh_run(o->stepper, (double)o->steps * h, h, steps, o->q,
                          o->p, NULL, 0);
    if (status) {
        fprintf(stderr, "brouwer: %s\n", nevh_stepper_message(o->stepper));
        exit(1);
    }
    o->steps += steps;
    double error = (double)(energy(o->q, o->p) / o->first - 1);
    o->most = fmax(o->most, fabs(error));
    return error;
}

/* The mean square over orbits, and over the last of so many periods. */
static double square(orbit *all, size_t orbits, size_t periods) {
    double sum = 0;
    for (orbit *o = all; o < all + orbits; o++) {
        size_t last = periods < SAMPLES ? periods : SAMPLES;
        go(o, periods * STEPS - last * STEPS);
        for (size_t i = 0; i < last; i++) {
            double error = go(o, STEPS);
            sum += error * error / (double)(orbits * last);
        }
    }
    return sum;
}

int main(int argc, char *argv[]) {
    double periods = argc > 1 ? atof(argv[1]) : 1e6, sx = 0, sy = 0;
    size_t orbits = argc > 2 ? strtoul(argv[2], NULL, 10) : 4, done = 0;
    nevh_options options = {.tolerance = argc > 3 ? atof(argv[3]) : 1e-25,
                            .steps_foreseen = periods * STEPS};
    double sxx = 0, sxy = 0, count = 0, most = 0;
    nevh_scene *scene = nevh_scene_parse("kepler", scene_text);
    orbit *all = calloc(orbits, sizeof *all);
    if (!all || nevh_scene_status(scene) || !(periods >= 1)) {
        fprintf(stderr, "usage: brouwer [PERIODS [ORBITS [TOLERANCE]]]\n");
        return 2;
    }
    for (size_t i = 0; i < orbits; i++) {
        orbit *o = &all[i];
        nevh_scene_start(scene, o->q, o->p);
        o->q[0] += 1e-3 * (double)i; /* other last digits, nearly that orbit */
        options.q = o->q;
        options.p = o->p;
        o->stepper =
            nevh_stepper_new(nevh_scene_system(scene), nevh_taylor, &options);
        o->first = energy(o->q, o->p);
    }
    printf("   periods  energy error\n");
    for (size_t until = 1; (double)done < periods; until *= 2) {
        until = (double)until < periods ? until : (size_t)periods;
        double root = sqrt(square(all, orbits, until - done));
        done = until;
        printf("%10zu  %.2e\n", done, root);
        fflush(stdout);
        if (done < 1024) /* the rounding of the state that is shown */
            continue;
        double x = log((double)done), y = log(root);
        count++;
        sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    for (size_t i = 0; i < orbits; i++) {
        most = fmax(most, all[i].most);
        nevh_stepper_free(all[i].stepper);
    }
    printf("the largest %.2e", most);
    if (count > 2)
        printf("; grows as the power %.2f of time",
               (count * sxy - sx * sy) / (count * sxx - sx * sx));
    printf("\n");
    free(all);
    nevh_scene_free(scene);
    return most < 1e-13 ? 0 : 1;
}

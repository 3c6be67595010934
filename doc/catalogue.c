/* The catalogue of integrators for the manual, as texinfo: what the registry
   says of each scheme, and error constants measured on two problems.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <nevh/nevh.h>
#include <stdio.h>
#include <string.h>

/* A pendulum over about three periods, and an orbit of Kepler's over three. */
typedef struct {
    const char *name, *text;
    double t_end;
    nevh_scene *scene;
    double q[2], p[2], end[4];
} problem;

static problem problems[] = {
    {.name = "pendulum",
     .text = "[coordinates]\nphi = 1, 0\n"
             "[effects]\nkinetic = p_phi^2/2\ngravity = -cos(phi)\n",
     .t_end = 20},
    {.name = "Kepler",
     .text = "[coordinates]\nx = 0.7, 0\ny = 0, sqrt(1.3/0.7)\n"
             "[effects]\nkinetic = (p_x^2 + p_y^2)/2\n"
             "gravity = -1/sqrt(x^2 + y^2)\n",
     .t_end = 20},
};
enum { PROBLEMS = sizeof problems / sizeof *problems, LONGEST = 65536 };

/* The error of a run is C h^order in the limit of short steps. */
typedef struct {
    double energy, state; /* C of the largest energy error relative to the
                                energy scale, and of the state at the end; NAN
                                where no step shows the order */
    bool kept;            /* the energy is kept to rounding */
} constants;

typedef struct {
    double energy, state;
} errors;

static int run(const problem *x, const nevh_integrator *scheme, size_t steps,
               double tolerance, double end[4], errors *e) {
    size_t n = nevh_scene_dof(x->scene);
    const nevh_system *system = nevh_scene_system(x->scene);
    double q[2] = {x->q[0], x->q[1]}, p[2] = {x->p[0], x->p[1]};
    nevh_options options = {
        .gradient = nevh_exact, .q = q, .p = p, .tolerance = tolerance};
    nevh_stepper *stepper = nevh_stepper_new(system, scheme, &options);
    nevh_energy *energy = nevh_energy_new(system, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    int status =
        nevh_run(stepper, 0, x->t_end / (double)steps, steps, q, p, &watch, 1);
    nevh_energy_report r = nevh_energy_result(energy, 0);
    *e = (errors){.energy = r.max / r.scale};
    for (size_t i = 0; i < n; i++) {
        double dq = q[i] - x->end[2 * i], dp = p[i] - x->end[2 * i + 1];
        e->state = fmax(e->state, fmax(fabs(dq), fabs(dp)));
        if (end)
            end[2 * i] = q[i], end[2 * i + 1] = p[i];
    }
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    return status;
}

/* Whether two errors a factor apart in h show the order. */
static bool shows(double order, int claimed, double smaller) {
    return fabs(order - claimed) <= 0.03 * claimed + 0.02 && smaller > 2e-13;
}

/* The constant of the longest step from which the order is seen twice. */
static constants measure(const problem *x, const nevh_integrator *scheme) {
    constants c = {.energy = NAN, .state = NAN};
    int p = nevh_integrator_order(scheme), energy_seen = 0, state_seen = 0;
    double largest = 0;
    errors last = {0};
    for (size_t steps = 16, before = 0; steps <= LONGEST;
         before = steps, steps = (size_t)((double)steps * 1.25)) {
        errors e;
        if (run(x, scheme, steps, 0, NULL, &e))
            continue;
        double factor = log((double)steps / (double)before);
        double h = x->t_end / (double)steps;
        double by_energy = log(last.energy / e.energy) / factor;
        double by_state = log(last.state / e.state) / factor;
        largest = before ? fmax(largest, e.energy) : e.energy;
        energy_seen =
            before && shows(by_energy, p, e.energy) ? energy_seen + 1 : 0;
        state_seen = before && shows(by_state, p, e.state) ? state_seen + 1 : 0;
        if (energy_seen == 2 && isnan(c.energy))
            c.energy = e.energy / pow(h, p);
        if (state_seen == 2 && isnan(c.state))
            c.state = e.state / pow(h, p);
        last = e;
        if (!isnan(c.energy) && !isnan(c.state))
            break;
    }
    c.kept = largest < 1e-12;
    return c;
}

/* Texinfo of a text: @, { and } are commands there. */
static void print_escaped(const char *text) {
    for (; *text; text++)
        printf(*text == '@' || *text == '{' || *text == '}' ? "@%c" : "%c",
               *text);
}

typedef struct {
    const char *title, *text;
} family;
static const family families[] = {
    {"Explicit, for H = T(p) + V(q)",
     "Each step is a sequence of kicks (p changes by the force) and drifts (q "
     "changes by the velocity).  They are symplectic."},
    {"Implicit and symplectic, for any H",
     "The stage equations are solved to rounding: by fixed-point iteration, and "
     "by simplified Newton iteration where that converges slowly."},
    {"Explicit and symplectic in a doubled phase space, for any H",
     "The state and a copy of it are bound to each other."},
    {"Energy-preserving, for any H",
     "Discrete gradients keep the energy to rounding; they are not symplectic."},
    {"Steps of their own length", "The step @code{dt} is nominal."},
    {"Not symplectic", "They are here for comparison and as references."},
};
enum { FAMILIES = sizeof families / sizeof *families };

static int family_of(const nevh_integrator *scheme) {
    nevh_claim symplectic = nevh_integrator_symplectic(scheme);
    if (nevh_integrator_own_time(scheme))
        return 4;
    if (nevh_integrator_preserves_energy(scheme) == NEVH_YES)
        return 3;
    if (symplectic == NEVH_EXTENDED)
        return 2;
    if (symplectic == NEVH_NO)
        return 5;
    return nevh_integrator_needs(scheme) & (NEVH_SEPARABLE | NEVH_PARTS) ? 0
                                                                         : 1;
}

static const char *needs(const nevh_integrator *scheme) {
    unsigned needs = nevh_integrator_needs(scheme);
    return needs & NEVH_PARTS ? "H = A + V(q), A quadratic or about centres"
           : needs & NEVH_QUADRATIC_KINETIC
               ? "H = T(p) + V(q), T quadratic in p"
           : needs & NEVH_SEPARABLE                 ? "H = T(p) + V(q)"
           : nevh_integrator_needs_formulas(scheme) ? "H from formulas"
                                                    : "any H";
}

static void print_scheme(const nevh_integrator *scheme) {
    int fixed = nevh_integrator_gradients(scheme);
    int sweep = nevh_integrator_sweep_gradients(scheme);
    printf("@item %s\n@cindex @code{%s}\n", nevh_integrator_name(scheme),
           nevh_integrator_name(scheme));
    if (nevh_integrator_needs_tolerance(scheme))
        printf("Order as the tolerance needs");
    else
        printf("Order %d", nevh_integrator_order(scheme));
    printf("; %s; ", needs(scheme));
    if (fixed || sweep)
        printf("%d gradient%s a %s", fixed + sweep,
               fixed + sweep == 1 ? "" : "s", fixed ? "step" : "sweep");
    else
        printf(nevh_integrator_needs_formulas(scheme)
                   ? "no gradients"
                   : "as many evaluations as a step needs");
    printf("; symmetric: %s%s.\n",
           nevh_claim_name(nevh_integrator_symmetric(scheme)),
           nevh_integrator_adaptive(scheme) ? "; takes a tolerance" : "");
    if (*nevh_integrator_aliases(scheme)) {
        printf("Also called ");
        print_escaped(nevh_integrator_aliases(scheme));
        puts(".");
    }
    print_escaped(nevh_integrator_source(scheme));
    puts(".\n");
}

static void print_number(double x) {
    printf(isnan(x) ? "         -" : "  %8.1e", x);
}

static void print_constants(const nevh_integrator *scheme) {
    printf("%-22s %3d", nevh_integrator_name(scheme),
           nevh_integrator_order(scheme));
    for (int i = 0; i < PROBLEMS; i++) {
        constants c = measure(&problems[i], scheme);
        if (c.kept)
            printf("      kept");
        else
            print_number(c.energy);
        print_number(c.state);
    }
    puts("");
}

/* Starts of the problems, and their ends by Taylor series. */
static int prepare(void) {
    for (int i = 0; i < PROBLEMS; i++) {
        problem *x = &problems[i];
        x->scene = nevh_scene_parse(x->name, x->text);
        double end[4] = {0};
        errors e;
        if (nevh_scene_start(x->scene, x->q, x->p) ||
            run(x, nevh_taylor, 20, 1e-16, end, &e))
            return fprintf(stderr, "%s: no reference\n", x->name), 1;
        memcpy(x->end, end, sizeof end);
    }
    return 0;
}

int main(void) {
    const nevh_integrator *const *all = nevh_integrators();
    if (prepare())
        return 1;
    puts("@c Made by doc/catalogue.c: make figures.\n\n@verbatim");
    printf("%48s%20s\n%-22s %3s", "pendulum, 1 rad", "Kepler, e = 0.3",
           "integrator", "p");
    for (int i = 0; i < PROBLEMS; i++)
        printf("%10s%10s", "energy", "state");
    puts("");
    for (int f = 0; f < FAMILIES; f++)
        for (int i = 0; all[i]; i++)
            if (family_of(all[i]) == f &&
                !nevh_integrator_needs_tolerance(all[i]))
                print_constants(all[i]);
    puts("@end verbatim");
    for (int f = 0; f < FAMILIES; f++) {
        printf("\n@section %s\n\n%s\n\n@table @code\n", families[f].title,
               families[f].text);
        for (int i = 0; all[i]; i++)
            if (family_of(all[i]) == f)
                print_scheme(all[i]);
        puts("@end table");
    }
    for (int i = 0; i < PROBLEMS; i++)
        nevh_scene_free(problems[i].scene);
    return 0;
}

/* nevh: a program's run, around `advance` of a family of steps.

   The text needs the run (T0, T_END, STEP, EVERY and, but for steps that take times
   of their own, NEVH__OWN_TIME, STEPS), TITLES of columns in parts and, where
   NEVH__ENERGY is defined, `energy`, ENERGY_SCALE and METHOD, names of the integrator
   and the gradient.  NEVH__WHOLE_STEPS: they end on time; else a shorter one follows.
   lib/native writes it into programs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PROGRAM_MAIN_H
#define NEVH_PROGRAM_MAIN_H

/* Takes the step after so many; *t goes along.  Returns whether it could. */
static bool next_step(size_t taken, double *t, double *q, double *p,
                      double *memory) {
#ifdef NEVH__OWN_TIME
    (void)taken;
    return advance(t, T_END, STEP, 1, q, p, memory) == 1;
#else
#ifdef NEVH__WHOLE_STEPS
    if (advance(T0, STEP, taken, 1, q, p, memory) == 0)
        return false;
    *t = taken + 1 < STEPS ? T0 + (double)(taken + 1) * STEP : T_END;
#else
    if (taken == STEPS ? advance(*t, T_END - *t, 0, 1, q, p, memory) == 0
                       : advance(T0, STEP, taken, 1, q, p, memory) == 0)
        return false;
    *t = taken < STEPS ? T0 + (double)(taken + 1) * STEP : T_END;
#endif
    return true;
#endif
}

static int fail(double t) {
    fprintf(stderr, "the step from t = %.9g ", t);
#ifdef NEVH__STAGES
    fputs("cannot be taken: fixed-point iteration does not get to the stages' "
          "slopes; take a smaller step\n",
          stderr);
#else
#ifdef NEVH__OWN_TIME
    fputs("would take no time, or leads to no finite numbers; take a smaller "
          "step\n",
          stderr);
#else
    fputs("leads to no finite numbers\n", stderr);
#endif
#endif
    return 1;
}

static void print_state(double t, const double *q, const double *p) {
    printf("%.17g", t);
    NEVH__EACH(k, 1, DOF) {
        printf(",%.17g", q[k]);
    }
    NEVH__EACH(k, 1, DOF) {
        printf(",%.17g", p[k]);
    }
    puts("");
}

/* Rows of t, q and p, some steps apart, and the last one. */
static int print_trajectory(double *q, double *p, double *memory) {
    double t = T0;
    for (size_t i = 0; i < sizeof TITLES / sizeof *TITLES; i++)
        fputs(TITLES[i], stdout);
    puts("");
    print_state(t, q, p);
    for (size_t steps = 1; t != T_END; steps++) {
        if (!next_step(steps - 1, &t, q, p, memory))
            return fail(t);
        if (steps % EVERY == 0 || t == T_END)
            print_state(t, q, p);
    }
    return 0;
}

#ifdef NEVH__ENERGY
/* The shortest of 15 to 17 digits that is the number again. */
static void print_number(double x) {
    char text[40];
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, x);
        if (strtod(text, NULL) == x)
            break;
    }
    printf(",%s", text);
}

/* Errors of the energy after each step, relative to a scale: the largest, the root
   of the mean square, the last, and the slope of a straight line through all of
   them, a row as nevh compare prints it. */
static int print_energy(double *q, double *p, double *memory) {
    const double start = energy(T0, q, p);
    double t = T0, error = 0, most = 0, squares = 0;
    double mean_t = 0, mean_error = 0, tt = 0, te = 0;
    size_t steps = 0;
    for (;; steps++) {
        double dt = t - mean_t, count = (double)(steps + 1);
        error = (energy(t, q, p) - start) / ENERGY_SCALE;
        most = fmax(most, fabs(error));
        squares += error * error;
        mean_t += dt / count;
        mean_error += (error - mean_error) / count;
        tt += dt * (t - mean_t);
        te += dt * (error - mean_error);
        if (t == T_END)
            break;
        if (!next_step(steps, &t, q, p, memory))
            return fail(t);
    }
    puts("integrator,gradient,dt,steps,max_energy_error,"
         "rms_energy_error,final_energy_error,energy_drift,sweeps");
    printf("%s", METHOD);
    print_number(STEP);
    printf(",%zu", steps);
    print_number(most);
    print_number(sqrt(squares / (double)(steps + 1)));
    print_number(error);
    print_number(tt > 0 ? te / tt : 0);
#ifdef NEVH__STAGES
    printf(",%.0f\n", memory[SWEEPS_AT]);
#else
    puts(",0");
#endif
    return 0;
}
#endif

#endif

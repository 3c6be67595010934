/* nevh: steps as a program that needs nothing but the C library.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/native_private.h"
#include "system/print_private.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Functions that formulas and steps call, where they do. */
static const struct {
    const char *call, *text;
} helpers[] = {
    {"choose(", "static double choose(int first, double x, double y) "
                "{\n    return first ? x : y;\n}\n"},
    {"real_min(", "static double real_min(double x, double y) {\n"
                  "    return x != x || x < y ? x : y;\n}\n"},
    {"real_max(", "static double real_max(double x, double y) {\n"
                  "    return x != x || x > y ? x : y;\n}\n"},
    {"sign(", "static double sign(double x) {\n"
              "    return x != x ? x : x > 0 ? 1 : x < 0 ? -1 : 0;\n}\n"},
    {"chain(", "static double chain(double x, double y) {\n"
               "    return x * y;\n}\n"},
    {"mod(",
     "static double mod(double x, double y) {\n"
     "    double rest = fmod(x, y);\n"
     "    return rest != 0 && (rest < 0) != (y < 0) ? rest + y : rest;\n}\n"}};

/* Steps from T0 to T_END; where steps choose their own time, the last one is
   shortened, else h fits or a shorter step follows. */
static const char run_of_own_time[] =
    "/* The run. */\n"
    "static const double T0 = $1, T_END = $2, STEP = $3;\n\n"
    "/* Takes the next step; *t goes along.  Returns whether it could. */\n"
    "static bool next_step(size_t taken, double *t, double *q, double *p,\n"
    "                      double *memory) {\n"
    "    (void)taken;\n"
    "    return advance(t, T_END, STEP, 1, q, p, memory) == 1;\n}\n\n";
static const char run_of_steps[] =
    "/* The run: so many steps$4 lead from T0 to T_END. */\n"
    "static const double T0 = $1, T_END = $2, STEP = $3;\n"
    "static const size_t STEPS = $5;\n\n"
    "/* Takes the step after so many; *t goes along.  Returns whether it could. "
    "*/\n"
    "static bool next_step(size_t taken, double *t, double *q, double *p,\n"
    "                      double *memory) {\n";
static const char whole_steps[] =
    "    if (advance(T0, STEP, taken, 1, q, p, memory) == 0)\n"
    "        return false;\n"
    "    *t = taken + 1 < STEPS ? T0 + (double)(taken + 1) * STEP : T_END;\n"
    "    return true;\n}\n\n";
static const char steps_and_rest[] =
    "    if (taken == STEPS ? advance(*t, T_END - *t, 0, 1, q, p, memory) == 0\n"
    "                       : advance(T0, STEP, taken, 1, q, p, memory) == 0)\n"
    "        return false;\n"
    "    *t = taken < STEPS ? T0 + (double)(taken + 1) * STEP : T_END;\n"
    "    return true;\n}\n\n";

/* Columns of nevh's row that the steps alone make: errors of the energy. */
static const char energy_row[] =
    "/* The shortest of 15 to 17 digits that is the number again. */\n"
    "static void print_number(double x) {\n"
    "    char text[40];\n"
    "    for (int digits = 15; digits <= 17; digits++) {\n"
    "        snprintf(text, sizeof text, \"%.*g\", digits, x);\n"
    "        if (strtod(text, NULL) == x)\n"
    "            break;\n"
    "    }\n"
    "    printf(\",%s\", text);\n}\n\n"
    "/* Errors of the energy after each step, relative to a scale: the largest,\n"
    "   the root of the mean square, the last, and the slope of a straight line\n"
    "   through all of them, a row as nevh compare prints it. */\n"
    "static int print_energy(double *q, double *p, double *memory) {\n"
    "    const double scale = $1, start = energy(T0, q, p);\n"
    "    double t = T0, error = 0, most = 0, squares = 0;\n"
    "    double mean_t = 0, mean_error = 0, tt = 0, te = 0;\n"
    "    size_t steps = 0;\n"
    "    for (;; steps++) {\n"
    "        double dt = t - mean_t, count = (double)(steps + 1);\n"
    "        error = (energy(t, q, p) - start) / scale;\n"
    "        most = fmax(most, fabs(error));\n"
    "        squares += error * error;\n"
    "        mean_t += dt / count;\n"
    "        mean_error += (error - mean_error) / count;\n"
    "        tt += dt * (t - mean_t);\n"
    "        te += dt * (error - mean_error);\n"
    "        if (t == T_END)\n"
    "            break;\n"
    "        if (!next_step(steps, &t, q, p, memory))\n"
    "            return fail(t);\n"
    "    }\n"
    "    puts(\"integrator,gradient,dt,steps,max_energy_error,\"\n"
    "         \"rms_energy_error,final_energy_error,energy_drift,sweeps\");\n"
    "    printf(\"$2,$3\");\n"
    "    print_number(STEP);\n"
    "    printf(\",%zu\", steps);\n"
    "    print_number(most);\n"
    "    print_number(sqrt(squares / (double)(steps + 1)));\n"
    "    print_number(error);\n"
    "    print_number(tt > 0 ? te / tt : 0);\n"
    "    printf(\",%.0f\\n\", $4);\n"
    "    return 0;\n}\n\n";

static const char trajectory[] =
    "static void print_state(double t, const double *q, const double *p) {\n"
    "    printf(\"%.17g\", t);\n"
    "    EACH(k, 1, DOF)\n"
    "        printf(\",%.17g\", q[k]);\n"
    "    EACH(k, 1, DOF)\n"
    "        printf(\",%.17g\", p[k]);\n"
    "    puts(\"\");\n}\n\n"
    "/* Rows of t, q and p, some steps apart, and the last one. */\n"
    "static int print_trajectory(double *q, double *p, double *memory) {\n"
    "    const size_t every = $1;\n"
    "    double t = T0;\n"
    "$2"
    "    print_state(t, q, p);\n"
    "    for (size_t steps = 1; t != T_END; steps++) {\n"
    "        if (!next_step(steps - 1, &t, q, p, memory))\n"
    "            return fail(t);\n"
    "        if (steps % every == 0 || t == T_END)\n"
    "            print_state(t, q, p);\n"
    "    }\n"
    "    return 0;\n}\n\n";

static void write_run(nevh__writer *w, const nevh_work *work,
                      const nevh_program *p) {
    double t0 = work->options->t, h = p->h, steps;
    char begin[NEVH__NAME], end[NEVH__NAME], step[NEVH__NAME];
    bool whole = nevh__whole_steps(p->t_end - t0, &h, &steps);
    if (w->own_time)
        h = p->h;
    nevh__number_text(t0, begin);
    nevh__number_text(p->t_end, end);
    nevh__number_text(h, step);
    char count[NEVH__NAME];
    nevh__print(count, sizeof count, "%.0f", steps);
    nevh__write_filled(w, w->own_time ? run_of_own_time : run_of_steps,
                       (const char *const[]){begin, end, step,
                                             whole ? "" : " and a shorter one",
                                             count});
    if (!w->own_time)
        nevh__write(w, "%s", whole ? whole_steps : steps_and_rest);
}

static void write_fail(nevh__writer *w) {
    nevh__write(w,
                "static int fail(double t) {\n"
                "    fprintf(stderr,\n            \"the step from t = %%.9g "
                "%s\\n\",\n            t);\n"
                "    return 1;\n}\n\n",
                w->stages
                    ? "cannot be taken: fixed-point iteration does not \"\n"
                      "            \"get to the stages' slopes; take a "
                      "smaller step"
                : w->own_time
                    ? "would take no time, or leads to no finite numbers; take "
                      "a \"\n            \"smaller step"
                    : "leads to no finite numbers");
}

static void write_energy_row(nevh__writer *w, const nevh_work *work,
                             double energy_scale) {
    char scale[NEVH__NAME];
    nevh__number_text(energy_scale, scale);
    nevh__write_filled(
        w, energy_row,
        (const char *const[]){scale, work->integrator->name,
                              nevh_gradient_name(work->field->gradient),
                              w->stages ? "memory[SWEEPS_AT]" : "0.0"});
}

/* "t,x,p_x", in lines that compilers take and people read. */
static void write_titles(nevh__writer *w, size_t n, const char *const names[]) {
    enum { LINE = 60 };
    size_t begin = w->used;
    nevh__write(w, "    fputs(\"t");
    for (size_t k = 0; k < 2 * n; k++) {
        nevh__write(w, k < n ? "," : ",p_");
        nevh__write_word(w, names[k % n]);
        if (w->used - begin > LINE && k + 1 < 2 * n) {
            nevh__write(w, "\", stdout);\n");
            begin = w->used;
            nevh__write(w, "    fputs(\"");
        }
    }
    nevh__write(w, "\\n\", stdout);\n");
}

static void write_trajectory(nevh__writer *w, size_t n, const nevh_program *p) {
    nevh__writer titles = {0};
    char every[NEVH__NAME];
    snprintf(every, sizeof every, "%zu", p->every);
    write_titles(&titles, n, p->names);
    w->failed |= titles.failed;
    if (!titles.failed)
        nevh__write_filled(w, trajectory,
                           (const char *const[]){every, titles.text});
    nevh__writer_free(&titles);
}

static void write_main(nevh__writer *w, const nevh_work *work,
                       const nevh_program *p) {
    const nevh_options *o = work->options;
    bool energy = p->energy_scale > 0;
    write_run(w, work, p);
    write_fail(w);
    write_trajectory(w, work->n, p);
    if (energy)
        write_energy_row(w, work, p->energy_scale);
    nevh__write(w, "int main(%s) {\n    ",
                energy ? "int arguments, char **argument" : "void");
    nevh__write_numbers(w, w->loops ? "static double q" : "double q", work->n,
                        o->q);
    nevh__write(w, "    ");
    nevh__write_numbers(w, w->loops ? "static double p" : "double p", work->n,
                        o->p);
    nevh__write(w, "    %sdouble memory[MEMORY] = {0};\n",
                w->loops ? "static " : "");
    if (energy)
        nevh__write(w, "    if (arguments > 1 && strcmp(argument[1], "
                       "\"energy\") == 0)\n"
                       "        return print_energy(q, p, memory);\n");
    nevh__write(w, "    return print_trajectory(q, p, memory);\n}\n");
}

/* As a comment of lines that are no longer than those of code. */
static void write_wrapped(nevh__writer *w, const char *text) {
    enum { LINE = 78, INDENT = 3 };
    size_t column = INDENT;
    nevh__write(w, "/* ");
    while (*text) {
        size_t bytes = strcspn(text, " \n"), spaces = strspn(text, " ");
        if (*text == '\n') {
            nevh__write(w, text[1] && text[1] != '\n' ? "\n   " : "\n");
            column = INDENT;
            text++;
            continue;
        }
        if (spaces)
            bytes = spaces + strcspn(text + spaces, " \n");
        if (spaces && column + bytes > LINE) {
            nevh__write(w, "\n   ");
            column = INDENT;
            text += spaces;
            bytes -= spaces;
        }
        nevh__write(w, "%.*s", (int)bytes, text);
        column += bytes;
        text += bytes;
    }
    nevh__write(w, " */\n");
}

static void write_comment(nevh__writer *w, const nevh_work *work,
                          const nevh_program *p) {
    const nevh_integrator *x = work->integrator;
    nevh__writer text = {0};
    nevh__write(&text, "%s: %s\nGradient: %s.\n\nState: ", x->name, x->source,
                nevh_gradient_name(work->field->gradient));
    for (size_t k = 0; k < work->n && k < 8; k++) {
        nevh__write(&text, "%sq[%zu] is ", k ? ", " : "", k);
        nevh__write_word(&text, p->names[k]);
        nevh__write(&text, " and p[%zu] its momentum", k);
    }
    nevh__write(
        &text,
        "%s.  Sums are compensated: what rounding has lost is added to the next "
        "step.\n\n%s",
        work->n > 8 ? " and so on" : "",
        p->functions && work->integrator->own_time
            ? "advance takes up to `steps` steps of h, and returns how many; "
              "time goes its own way, and ends at t_end.\n"
              "double memory[MEMORY] is its memory, zeros at the start."
        : p->functions
            ? "advance takes `steps` steps of h, the first being number `from`, "
              "and returns how many.\n"
              "double memory[MEMORY] is its memory, zeros at the start."
        : p->energy_scale > 0
            ? "cc -O2 -ffp-contract=off -o prog THIS.c -lm\n"
              "./prog prints the trajectory, ./prog energy the errors of the "
              "energy."
            : "cc -O2 -ffp-contract=off -o prog THIS.c -lm");
    w->failed |= text.failed;
    if (!text.failed)
        write_wrapped(w, text.text);
    nevh__writer_free(&text);
}

static const char includes[] = "#include <math.h>\n"
                               "#include <stdbool.h>\n"
                               "#include <stddef.h>\n";

static void write_helpers(nevh__writer *w, const char *text) {
    for (size_t i = 0; i < sizeof helpers / sizeof *helpers; i++)
        if (nevh__text_calls(text, helpers[i].call))
            nevh__write(w, "%s\n", helpers[i].text);
}

/* All that is C: what remains unused is left out. */
static bool write_body(nevh__writer *body, nevh_work *work,
                       const nevh_program *p) {
    if (!nevh__writer_name(body, work->n, p->names) ||
        !nevh__native_write(body, work))
        return false;
    nevh__write(body, "enum { MEMORY = %zu };\n\n",
                work->memory_rows + body->stages + body->own_time);
    if (!p->functions && p->energy_scale > 0 &&
        !nevh__write_energy(body, work->field))
        return false;
    if (!p->functions)
        write_main(body, work, p);
    return !body->failed;
}

bool nevh__write_program(nevh__writer *w, nevh_work *work,
                         const nevh_program *p) {
    nevh__writer body = {.readable = true};
    bool fine = write_body(&body, work, p);
    w->refusal = body.refusal;
    if (fine) {
        nevh__names_shorten(body.text);
        write_comment(w, work, p);
        nevh__write(w, "%s%s#include <string.h>\n\n", includes,
                    p->functions ? ""
                                 : "#include <stdio.h>\n#include <stdlib.h>\n");
        write_helpers(w, body.text);
        fine = nevh__write_used(w, body.text);
    }
    nevh__writer_free(&body);
    return fine && !w->failed;
}

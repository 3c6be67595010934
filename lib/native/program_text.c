/* nevh: steps as a program that needs nothing but the C library.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/native_private.h"
#include "system/print_private.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The run from T0 to T_END; where steps choose their own time, the last one is
   shortened, else STEP fits or a shorter step follows. */
static void write_run(nevh__writer *w, const nevh_work *work,
                      const nevh_program *p) {
    double t0 = work->options->t, h = p->h, steps;
    bool whole = nevh__whole_steps(p->t_end - t0, &h, &steps);
    nevh__write(w, "/* The run%s. */\n",
                w->own_time ? ""
                : whole     ? ": so many steps lead from T0 to T_END"
                            : ": so many steps and a shorter one lead from T0 "
                              "to T_END");
    nevh__write_constant(w, "T0", t0);
    nevh__write_constant(w, "T_END", p->t_end);
    nevh__write_constant(w, "STEP", w->own_time ? p->h : h);
    if (w->own_time)
        nevh__write_form(w, "NEVH__OWN_TIME");
    else
        nevh__write(w, "static const size_t STEPS = %.0f;\n", steps);
    if (whole)
        nevh__write_form(w, "NEVH__WHOLE_STEPS");
}

/* "t,x,p_x", in lines that compilers take and people read. */
static void write_titles(nevh__writer *w, size_t n, const nevh_program *p) {
    enum { LINE = 60 };
    nevh__write(w,
                "static const size_t EVERY = %zu;\n"
                "static const char *const TITLES[] = {\n    \"t",
                p->every);
    size_t begin = w->used;
    for (size_t k = 0; k < 2 * n; k++) {
        nevh__write(w, k < n ? "," : ",p_");
        nevh__write_word(w, p->names[k % n]);
        if (w->used - begin > LINE && k + 1 < 2 * n) {
            nevh__write(w, "\",\n");
            begin = w->used;
            nevh__write(w, "    \"");
        }
    }
    nevh__write(w, "\"};\n");
}

static void write_main(nevh__writer *w, const nevh_work *work,
                       const nevh_program *p) {
    const nevh_options *o = work->options;
    bool energy = p->energy_scale > 0;
    write_run(w, work, p);
    write_titles(w, work->n, p);
    if (energy) {
        nevh__write_form(w, "NEVH__ENERGY");
        nevh__write_constant(w, "ENERGY_SCALE", p->energy_scale);
        nevh__write(w, "static const char METHOD[] = \"%s,%s\";\n",
                    work->integrator->name,
                    nevh_gradient_name(work->field->gradient));
    }
    nevh__write(w, "\n");
    nevh__write_lines(w, nevh__program_main_text);
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

/* Around all functions. */
static const char apart[] =
    "/* gcc 12 contracts a*b - c beside d*e + f, as vectors, even with\n"
    "   -ffp-contract=off. */\n"
    "#if defined __FMA__ && !defined __clang__\n"
    "#pragma GCC push_options\n"
    "#pragma GCC optimize(\"no-tree-vectorize\")\n"
    "#endif\n\n";
static const char as_before[] = "\n#if defined __FMA__ && !defined __clang__\n"
                                "#pragma GCC pop_options\n"
                                "#endif\n";

/* All that is C: what remains unused is left out. */
static bool write_body(nevh__writer *body, nevh_work *work,
                       const nevh_program *p) {
    if (!nevh__writer_name(body, work->n, p->names))
        return false;
    nevh__write_lines(body, nevh__formula_needs_text);
    if (!nevh__native_write(body, work))
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
    nevh__writer body = {.readable = true}, all = {.readable = true};
    bool fine = write_body(&body, work, p);
    w->refusal = body.refusal;
    if (fine) {
        nevh__write_elementary_numbers(&all, &body);
        nevh__write(&all, "%s", body.text);
    }
    fine &= !all.failed;
    if (fine) {
        nevh__names_shorten(all.text);
        write_comment(w, work, p);
        nevh__write(w, "%s%s%s#include <string.h>\n\n%s", includes,
                    *body.calls ? "#include <stdint.h>\n" : "",
                    p->functions ? ""
                                 : "#include <stdio.h>\n#include <stdlib.h>\n",
                    apart);
        fine = nevh__write_used(w, all.text);
        nevh__write(w, "%s", as_before);
    }
    nevh__writer_free(&body);
    nevh__writer_free(&all);
    return fine && !w->failed;
}

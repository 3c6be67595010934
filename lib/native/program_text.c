/* nevh: steps as a program that needs nothing but the C library.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/native_private.h"
#include <ctype.h>
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

static bool is_word(char c) {
    return isalnum((unsigned char)c) || c == '_';
}

/* Whether a line has a word. */
static bool has_word(const char *line, const char *word, size_t length) {
    for (const char *at = line; (at = strchr(at, *word)); at++)
        if (strncmp(at, word, length) == 0 &&
            (at == line || !is_word(at[-1])) && !is_word(at[length]))
            return true;
    return false;
}

/* Names without what they have in the library. */
static void rename_all(char *text) {
    static const struct {
        const char *from, *to;
    } names[] = {{"nevh__number", "double"},
                 {"NEVH__INLINE", "static"},
                 {"nevh__", ""},
                 {"NEVH__", ""},
                 {"NEVH_", ""},
                 {"nevh_", ""}};
    char *to = text;
    bool begins = true;
    while (*text) {
        size_t i = 0, count = sizeof names / sizeof *names;
        while (i < count &&
               strncmp(text, names[i].from, strlen(names[i].from)) != 0)
            i++;
        if (!begins || i == count) {
            begins = !is_word(*text);
            *to++ = *text++;
            continue;
        }
        text += strlen(names[i].from);
        for (const char *c = names[i].to; *c; c++)
            *to++ = *c;
        begins = false;
    }
    *to = '\0';
}

/* Lines become strings. */
static char **split_lines(char *text, size_t *count) {
    size_t lines = 0;
    for (const char *c = text; *c; c++)
        lines += *c == '\n';
    char **all = nevh__array(lines + 1, sizeof *all);
    for (*count = 0; all && *text; (*count)++) {
        size_t bytes = strcspn(text, "\n");
        all[*count] = text;
        if (text[bytes])
            text[bytes++] = '\0';
        text += bytes;
    }
    return all;
}

/* Whether "    double NAME = ...;" is asked for by a line that is left, up to
   the function's end. */
static bool is_of_use(char **lines, size_t i, size_t count) {
    static const char begin[] = "    double ";
    if (!lines[i] || strncmp(lines[i], begin, sizeof begin - 1) != 0)
        return true;
    const char *name = lines[i] + sizeof begin - 1;
    size_t length = 0;
    while (is_word(name[length]))
        length++;
    char word[64];
    if (strncmp(name + length, " = ", 3) != 0 || length >= sizeof word)
        return true;
    memcpy(word, name, length);
    word[length] = '\0';
    for (size_t k = i + 1; k < count && (!lines[k] || lines[k][0] != '}'); k++)
        if (lines[k] && has_word(lines[k], word, length))
            return true;
    return false;
}

/* Where a function ends that begins at line i; i: none does. */
static size_t end_of_function(char **lines, size_t i, size_t count) {
    size_t end = i;
    if (!lines[i] || strncmp(lines[i], "static ", 7) != 0 ||
        !strchr(lines[i], '('))
        return i;
    while (end < count && lines[end] && !strchr(lines[end], '{') &&
           !strchr(lines[end], ';'))
        end++;
    if (end == count || !lines[end] || !strchr(lines[end], '{') ||
        strchr(lines[i], '='))
        return i;
    while (end < count && lines[end][0] != '}')
        end++;
    return end < count ? end : i;
}

/* A function that no other line names goes, and the comment before it. */
static void drop_function(char **lines, size_t i, size_t count) {
    size_t end = end_of_function(lines, i, count);
    const char *name = strchr(lines[i], '('), *after = name;
    if (end == i || strncmp(name, "(double t0", 10) == 0) /* advance */
        return;
    while (name > lines[i] && is_word(name[-1]))
        name--;
    for (size_t k = 0; k < count; k++)
        if ((k < i || k > end) && lines[k] &&
            has_word(lines[k], name, (size_t)(after - name)))
            return;
    while (end + 1 > i)
        lines[end--] = NULL;
    bool comment = i > 0 && lines[i - 1] && strstr(lines[i - 1], "*/");
    while (comment && i-- > 0) {
        comment = strncmp(lines[i], "/*", 2) != 0;
        lines[i] = NULL;
    }
}

/* Values that only other derivatives would need are left out. */
static bool write_used(nevh__writer *w, char *text) {
    size_t count;
    char **lines = split_lines(text, &count);
    if (!lines)
        return false;
    for (size_t i = count; i-- > 0;)
        drop_function(lines, i, count);
    for (size_t i = count; i-- > 0;)
        if (!is_of_use(lines, i, count))
            lines[i] = NULL;
    bool empty = true; /* no two empty lines */
    for (size_t i = 0; i < count; i++)
        if (lines[i] && (lines[i][0] || !empty)) {
            nevh__write(w, "%s\n", lines[i]);
            empty = !lines[i][0];
        }
    free(lines);
    return true;
}

/* Letters, digits and what names of elements have; anything else of a name
   stays out of the text. */
static void write_name(nevh__writer *w, const char *name) {
    for (; *name; name++) {
        unsigned char c = (unsigned char)*name;
        bool plain = isalnum(c) || c == '_' || c == '[' || c == ']' || c > 127;
        nevh__write(w, "%c", plain ? c : '-');
    }
}

static void write_main(nevh__writer *w, const nevh_work *work,
                       const nevh_program *p) {
    const nevh_options *o = work->options;
    char t[NEVH__NAME], h[NEVH__NAME];
    nevh__number_text(o->t, t);
    nevh__number_text(p->h, h);
    nevh__write(w, "int main(void) {\n    ");
    nevh__write_numbers(w, "double q", work->n, o->q);
    nevh__write(w, "    ");
    nevh__write_numbers(w, "double p", work->n, o->p);
    nevh__write(w,
                "    double memory[%zu] = {0};\n    const double t0 = %s, h = "
                "%s;\n    const size_t steps = %zu, every = %zu;\n    puts(\"t",
                work->memory_rows, t, h, p->steps, p->every);
    for (size_t k = 0; k < 2 * work->n; k++) {
        nevh__write(w, k < work->n ? "," : ",p_");
        write_name(w, p->names[k % work->n]);
    }
    nevh__write(
        w,
        "\");\n    for (size_t i = 0;; i += every) {\n"
        "        size_t next = steps - i < every ? steps - i : every;\n"
        "        printf(\"%%.17g\", t0 + (double)i * h);\n"
        "        for (int k = 0; k < %zu; k++)\n"
        "            printf(\",%%.17g\", q[k]);\n"
        "        for (int k = 0; k < %zu; k++)\n"
        "            printf(\",%%.17g\", p[k]);\n"
        "        puts(\"\");\n"
        "        if (next == 0)\n            return 0;\n"
        "        if (advance(t0, h, i, next, q, p, memory) < next)\n"
        "            break;\n"
        "        if (next < every)\n            i -= every - next;\n    }\n"
        "    fputs(\"the state is not finite any more\\n\", stderr);\n"
        "    return 1;\n}\n",
        work->n, work->n);
}

static void write_comment(nevh__writer *w, const nevh_work *work,
                          const nevh_program *p) {
    const nevh_integrator *x = work->integrator;
    nevh__write(w, "/* %s: %s\n   Gradient: %s.\n\n   State: ", x->name,
                x->source, nevh_gradient_name(work->field->gradient));
    for (size_t k = 0; k < work->n && k < 8; k++) {
        nevh__write(w, "%sq[%zu] is ", k ? ", " : "", k);
        write_name(w, p->names[k]);
        nevh__write(w, " and p[%zu] its momentum", k);
    }
    nevh__write(w,
                "%s.  Sums are compensated:\n   lost_q and lost_p are digits "
                "that earlier steps have lost to rounding.\n\n   %s */\n",
                work->n > 8 ? " and so on" : "",
                p->functions
                    ? "advance takes `steps` steps of h, the first "
                      "being number `from`, and returns how many;\n   M "
                      "is its memory, zeros at the start."
                    : "cc -O2 -ffp-contract=off -o prog THIS.c -lm");
}

bool nevh__write_program(nevh__writer *w, nevh_work *work,
                         const nevh_program *p) {
    nevh__writer body = {.readable = true};
    bool fine = nevh__native_write(&body, work) && !body.failed;
    w->refusal = body.refusal;
    if (fine) {
        rename_all(body.text);
        write_comment(w, work, p);
        nevh__write(w,
                    "#include <math.h>\n#include <stdbool.h>\n#include "
                    "<stddef.h>\n%s#include <string.h>\n\n",
                    p->functions ? "" : "#include <stdio.h>\n");
        for (size_t i = 0; i < sizeof helpers / sizeof *helpers; i++)
            if (strstr(body.text, helpers[i].call))
                nevh__write(w, "%s\n", helpers[i].text);
        fine = write_used(w, body.text);
        if (!p->functions)
            write_main(w, work, p);
    }
    nevh__writer_free(&body);
    return fine && !w->failed;
}

/* nevh tests: effects on demand: what is off leaves no trace, what is on is
   seen by every integrator.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "shipped.h"
#include <math.h>

static nevh_scene *scene_of(const char *text) {
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(s), "%s\nin\n%s", nevh_scene_message(s),
                  text);
    return s;
}

/* Deletes the lines of an effect from a scene's text, and its name from the fast
   ones. */

static bool begins(const char *line, const char *word) {
    size_t bytes = strlen(word);
    return strncmp(line, word, bytes) == 0 && strchr(" =", line[bytes]);
}

static bool is_off(const char *name, size_t bytes, const char *const off[]) {
    for (size_t i = 0; off[i]; i++)
        if (strlen(off[i]) == bytes && strncmp(name, off[i], bytes) == 0)
            return true;
    return false;
}

/* "fast = NAME, NAME" without those that are off. */
static char *write_fast(const char *line, const char *const off[], char *to) {
    static const char key[] = "fast = ";
    const char *name = line + strlen(key), *before = key;
    while (*name != '\n') {
        size_t bytes = strcspn(name, ",\n");
        if (!is_off(name, bytes, off)) {
            to += sprintf(to, "%s%.*s", before, (int)bytes, name);
            before = ", ";
        }
        name += bytes;
        name += strspn(name, ", ");
    }
    return to + sprintf(to, "\n");
}

static char *without_lines(const char *text, const char *const off[]) {
    char *kept = calloc(strlen(text) + 2, 1), *to = kept;
    bool effects = false, scene = false;
    for (const char *line = text, *next; *line; line = next) {
        next = strchr(line, '\n') + 1;
        bool drop = scene && begins(line, "effects");
        if (*line == '[') {
            effects = strncmp(line, "[effects]", 9) == 0 ||
                      strncmp(line, "[friction]", 10) == 0;
            scene = strncmp(line, "[scene]", 7) == 0;
        }
        for (size_t i = 0; off[i]; i++)
            drop |= effects && begins(line, off[i]);
        if (strncmp(line, "fast = ", 7) == 0)
            to = write_fast(line, off, to);
        else if (!drop) {
            memcpy(to, line, (size_t)(next - line));
            to += next - line;
        }
    }
    return kept;
}

enum { STEPS = 15, MOST_EFFECTS = 20 };

typedef struct {
    size_t n;
    double *z;
    nevh_counts counts;
    char message[300];
} run;

/* Some steps of the first of the scene's integrators that fits, with gradients
   by differences whose steps are found out. */
static run run_of(nevh_scene *s) {
    run r = {.n = nevh_scene_dof(s)};
    const nevh_scene_run *settings = nevh_scene_run_settings(s);
    nevh_stepper *by = NULL;
    r.z = calloc(2 * r.n, sizeof *r.z);
    int status = nevh_scene_start(s, r.z, r.z + r.n);
    nevh_options o = {.gradient_step = settings->gradient_step,
                      .q = r.z,
                      .p = r.z + r.n,
                      .tolerance = 1e-6,
                      .balance = true};
    for (size_t i = 0; i < settings->integrators; i++) {
        const nevh_integrator *scheme =
            nevh_integrator_named(settings->integrator[i]);
        if (!scheme || nevh_integrator_own_time(scheme))
            continue;
        nevh_stepper_free(by);
        o.tolerance = nevh_integrator_needs_tolerance(scheme) ? 1e-6 : 0;
        by = nevh_stepper_new(nevh_scene_system(s), scheme, &o);
        if (!nevh_stepper_status(by))
            break;
    }
    status |= nevh_run(by, settings->t_start, settings->dt[0], STEPS, r.z,
                       r.z + r.n, NULL, 0);
    snprintf(r.message, sizeof r.message, "%d %s", status,
             nevh_stepper_message(by));
    r.counts = nevh_stepper_counts(by);
    nevh_stepper_free(by);
    return r;
}

/* The scene with effects off, and the text from which they are deleted. */
static void assert_no_trace(nevh_scene *s, const char *const off[]) {
    char *text = nevh_scene_write(s, NULL), *less = without_lines(text, off);
    nevh_scene *other = scene_of(less);
    run a = run_of(s), b = run_of(other);
    ck_assert_str_eq(a.message, b.message);
    ck_assert_msg(!memcmp(a.z, b.z, 2 * a.n * sizeof *a.z), "%s without %s",
                  nevh_scene_title(s), off[0]);
    ck_assert(a.counts.values == b.counts.values &&
              a.counts.gradients == b.counts.gradients &&
              a.counts.sweeps == b.counts.sweeps &&
              a.counts.hamiltonians == b.counts.hamiltonians);
    free(a.z);
    free(b.z);
    free(text);
    free(less);
    nevh_scene_free(other);
}

/* Each effect off, with those that are off already. */
TEST_EACH(off_is_as_if_deleted, find_shipped()) {
    nevh_scene *s = read_shipped(shipped[_i]);
    const nevh_system *system = nevh_scene_system(s);
    size_t count = nevh_system_effect_count(system), n_off = 0;
    const char *off[MOST_EFFECTS + 2] = {0};
    ck_assert_uint_le(count, MOST_EFFECTS);
    for (size_t i = 0; i < count; i++)
        if (!nevh_system_effect_on(system, nevh_system_effect_name(system, i)))
            off[1 + n_off++] = nevh_system_effect_name(system, i);
    for (size_t i = 0; i < count; i++) {
        const char *name = nevh_system_effect_name(system, i);
        if (!nevh_system_effect_on(system, name))
            continue;
        off[0] = name;
        nevh_scene_enable(s, name, false);
        assert_no_trace(s, off);
        nevh_scene_enable(s, name, true);
    }
    if (n_off)
        assert_no_trace(s, off + 1);
    nevh_scene_free(s);
}

/* Problems of every structure, as many effects and as one. */
static const struct {
    const char *coordinates;
    const char *parts[12]; /* of H */
    const char *transform;
} problems_as_text[] = {
    {"x = 0.7, 0.2\ny = -0.4, 0.5\n",
     {"p_x^2/2", "p_y^2/2.6", "x^2/2 + 0.9*y^2", "x^2*y", "-y^3/3",
      "0.3*cos(x - y)"},
     "1 + x^2 + y^2"},
    {"x = 0.7, 0.2\ny = -0.4, 0.5\n",
     {"p_x^2/2", "p_y^2/2.6", "x^2/2 + 0.9*y^2", "0.2*sqrt(1 + p_x^2)",
      "0.3*cos(x - y)"},
     "1 + x^2 + y^2"},
    {"a = 0.9, 0.2\nb = -0.4, 0.5\n",
     {"p_a^2/(2*(1 + sin(a - b)^2))", "p_b^2/(1 + sin(a - b)^2)",
      "-p_a*p_b*cos(a - b)/(1 + sin(a - b)^2)", "-2*cos(a)", "-cos(b)",
      "0.1*(a*p_b - b*p_a)"},
     "1 + a^2"},
    {"x = 0.7, 0.2\ny = -0.4, 0.5\n",
     {"p_x^2/2", "p_y^2/2.6", "x^2/2 + 0.9*y^2", "0.4*x*cos(2*t)",
      "0.2*t*sin(y)"},
     NULL},
    {"x[i = 1..6] = 0.3*i - 1\np_x[1..6] = 0.1\n",
     {"sum(i = 1..6, p_x[i]^2/2)", "sum(i = 1..5, (x[i+1] - x[i])^2/2)",
      "0.25/3*sum(i = 1..5, (x[i+1] - x[i])^3)", "x[1]^2/2 + x[6]^2/2",
      "0.1*sum(i = 1..6, cos(x[i]))"},
     "1 + x[1]^2"},
    /* Separable by its values only. */
    {"x = 0.7, 0.2\ny = -0.4, 0.5\n",
     {"p_x^2/2", "(p_y + x)^2 - 2*x*p_y", "cos(x) + y^2"},
     "1 + x^2"},
};
enum { PROBLEMS = sizeof problems_as_text / sizeof *problems_as_text };

static const char *const frictions[] = {
    "", "[friction]\ndrag = all: 0.02\nair = all: 0.03\n",
    "[friction]\ndrag = all: 0.05\n"};

static nevh_scene *many(int which, const char *friction) {
    char text[3000], *to = text;
    to += sprintf(to, "[coordinates]\n%s[effects]\n",
                  problems_as_text[which].coordinates);
    for (int i = 0; problems_as_text[which].parts[i]; i++)
        to += sprintf(to, "part%d = %s\n", i, problems_as_text[which].parts[i]);
    const char *coordinates = problems_as_text[which].coordinates;
    const char *last = strstr(coordinates, "..") ? "x[1]*p_x[2]"
                       : *coordinates == 'a'     ? "a*p_b"
                                                 : "x*p_y";
    sprintf(to, "trap = log(-1 - t^2)\nmixed = sqrt(1 + (%s)^2)\n%s", last,
            friction);
    nevh_scene *s = scene_of(text);
    ck_assert_int_eq(nevh_scene_enable(s, "trap", false), NEVH_OK);
    ck_assert_int_eq(nevh_scene_enable(s, "mixed", false), NEVH_OK);
    return s;
}

static nevh_scene *one(int which, const char *friction) {
    char text[3000], *to = text;
    to += sprintf(to, "[coordinates]\n%s[effects]\nH = ",
                  problems_as_text[which].coordinates);
    for (int i = 0; problems_as_text[which].parts[i]; i++)
        to += sprintf(to, "%s(%s)", i ? " + " : "",
                      problems_as_text[which].parts[i]);
    sprintf(to, "\n%s", friction);
    return scene_of(text);
}

enum { MOST_SIZE = 12 };

/* NEVH_ESTRUCT where the scheme does not fit.  Scales and binding are given,
   which else are chosen by a look at the terms. */
static int arrive(nevh_scene *s, const nevh_integrator *scheme,
                  const nevh_system *transform, size_t steps, double z[]) {
    static const double scale[MOST_SIZE] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    bool adaptive = nevh_integrator_needs_tolerance(scheme);
    size_t n = nevh_scene_dof(s);
    ck_assert_int_eq(nevh_scene_start(s, z, z + n), NEVH_OK);
    nevh_options o = {.gradient = nevh_exact,
                      .scale = scale,
                      .q = z,
                      .p = z + n,
                      .binding = 3,
                      .transform = transform,
                      .tolerance = adaptive ? 1e-8 : 0};
    nevh_stepper *by = nevh_stepper_new(nevh_scene_system(s), scheme, &o);
    int status = nevh_stepper_status(by);
    if (!status)
        status = nevh_run(by, 0, 0.05, steps, z, z + n, NULL, 0);
    ck_assert_uint_eq(nevh_field_effect_values(nevh_stepper_field(by), "trap"),
                      0);
    nevh_stepper_free(by);
    return status;
}

static nevh_scene *transform_of(int which) {
    char text[300];
    snprintf(text, sizeof text, "[coordinates]\n%s[effects]\ns = %s\n",
             problems_as_text[which].coordinates,
             problems_as_text[which].transform);
    return scene_of(text);
}

static double largest_gap(const double a[], const double b[], size_t count) {
    double most = 0;
    for (size_t k = 0; k < count; k++)
        most = fmax(most, fabs(a[k] - b[k]));
    return most;
}

/* Rounding is enlarged where differences of H are divided by short ways. */
static double rounding(const nevh_integrator *scheme) {
    return nevh_integrator_preserves_energy(scheme) == NEVH_YES ? 1e-8 : 1e-12;
}

static void assert_alike(int which, int friction, bool transformed,
                         int *accepted) {
    nevh_scene *a = many(which, frictions[friction]),
               *b = one(which, frictions[friction ? 2 : 0]),
               *t = transformed ? transform_of(which) : NULL;
    const nevh_system *transform = t ? nevh_scene_system(t) : NULL;
    for (int i = 0; nevh_integrators()[i]; i++) {
        const nevh_integrator *scheme = nevh_integrators()[i];
        double x[MOST_SIZE], y[MOST_SIZE];
        int status = arrive(a, scheme, transform, STEPS, x);
        ck_assert_int_eq(status, arrive(b, scheme, transform, STEPS, y));
        if (status || nevh_integrator_needs(scheme) & NEVH_PARTS)
            continue; /* the parts depend on how H is divided into terms */
        double gap = largest_gap(x, y, 2 * nevh_scene_dof(a));
        ck_assert_msg(gap <= rounding(scheme), "%s on problem %d: %.1e",
                      nevh_integrator_name(scheme), which, gap);
        ++*accepted;
    }
    nevh_scene_free(a);
    nevh_scene_free(b);
    nevh_scene_free(t);
}

TEST_EACH(many_effects_are_one, PROBLEMS) {
    int accepted = 0;
    assert_alike(_i, 0, false, &accepted);
    assert_alike(_i, 1, false, &accepted);
    if (problems_as_text[_i].transform)
        assert_alike(_i, 0, true, &accepted);
    ck_assert_int_ge(accepted, 40);
}

/* An effect that a scheme overlooked would be missed by nobody. */
TEST_EACH(every_effect_is_seen, PROBLEMS) {
    nevh_scene *s = many(_i, frictions[1]);
    const nevh_system *system = nevh_scene_system(s);
    for (int i = 0; nevh_integrators()[i]; i++) {
        const nevh_integrator *scheme = nevh_integrators()[i];
        double with[MOST_SIZE], without[MOST_SIZE];
        if (arrive(s, scheme, NULL, 4, with))
            continue;
        for (size_t k = 0; k < nevh_system_effect_count(system); k++) {
            const char *name = nevh_system_effect_name(system, k);
            if (!nevh_system_effect_on(system, name))
                continue;
            nevh_scene_enable(s, name, false);
            int status = arrive(s, scheme, NULL, 4, without);
            nevh_scene_enable(s, name, true);
            ck_assert_msg(status || largest_gap(with, without,
                                                2 * nevh_scene_dof(s)) > 1e-5,
                          "%s does not see %s", nevh_integrator_name(scheme),
                          name);
        }
    }
    nevh_scene_free(s);
}

/* nevh bench: how often the verdict on the energy is wrong.

       bench/verdicts [-s SHARE] [-w WORK] [-o WRONG] SRCDIR [RUNS]

   Runs every scheme with fixed steps over the scenes of bench/orbits/list,
   steps from h w = 0.1 on, and runs of 5, 50 and 500 periods, asks for the
   verdict of each, and compares it with what a run of 30 times the length
   shows, or 480 where that leaves it open or says otherwise.  RUNS is a file that keeps those,
   which do not depend on the rule: it is to be removed where a scheme changed.
   Prints the table of what was said and what is true; writes wrong rows to
   WRONG, each with the command that shows it.  SHARE is the part of all rows to
   take, by a hash of their names; WORK the seconds that a long run may take on
   a machine in the mean.  Fails where a rate is above its goal.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "verdicts_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double spans = 30;
static const double steps[] = {0.1, 0.2, 0.4, 0.8, 1.2, 1.6, 2, 2.5, 5, 20};
static const double lengths[] = {5, 50, 500};
enum { STEPS = sizeof steps / sizeof *steps, LENGTHS = 3, LEAST_STEPS = 8 };

static const char *const said[] = {"bounded",  "random-walk", "drifts",
                                   "unstable", "undecided",   "other"};
enum { SAID = sizeof said / sizeof *said };
static const char *const group_names[] = {"symplectic, fixed step",
                                          "energy-preserving",
                                          "Runge-Kutta and euler", "other"};

typedef struct {
    const char *srcdir;
    double share, work;
    FILE *wrong;
    size_t table[GROUPS][LABELS][SAID];
    size_t wrongs[LENGTHS + 1], rows[LENGTHS + 1];
    double judging; /* seconds */
} survey;

typedef struct {
    char name[64], file[512];
    double frequency, period, share;
} orbit;

static size_t number_of(const char *verdict) {
    size_t i = 0;
    while (i < SAID - 1 && strcmp(said[i], verdict) != 0)
        i++;
    return i;
}

/* To five digits, so that a command line says it. */
static double rounded(double x) {
    char text[32];
    snprintf(text, sizeof text, "%.4e", x);
    return strtod(text, NULL);
}

static void tell_wrong(survey *v, const orbit *o, const subject *s,
                       const char *verdict, const truth *known) {
    char *evidence = truth_evidence(known);
    const char *scene =
        strncmp(o->name, "scenes/", 7) == 0 ? o->name + 7 : o->file;
    fprintf(v->wrong,
            "nevh compare %s --integrators %s --gradient %s --dt %.9g --t-end "
            "%.9g  # %s; %s; %s\n",
            scene, nevh_integrator_name(s->scheme), s->plan->gradients.item[0],
            s->dt, s->t_end, verdict, label_name(known->is), evidence);
    free(evidence);
}

/* The rule: that of nevh compare. */
static const char *judge(survey *v, const subject *s) {
    row r = {.integrator = nevh_integrator_name(s->scheme),
             .gradient = s->plan->gradients.item[0],
             .scheme = s->scheme,
             .dt = s->dt};
    plan p = *s->plan;
    p.t_end = s->t_end;
    double begin = cpu_seconds();
    row_run(&p, &r);
    v->judging += cpu_seconds() - begin;
    free(r.status);
    return r.ran ? nevh_verdict_name(r.energy.verdict) : NULL;
}

static void survey_row(survey *v, const orbit *o, const subject *s,
                       size_t length) {
    const long_run *run = long_run_of(s, spans, v->work);
    if (!is_afforded(run, v->work) || run->reached < 1)
        return;
    truth known = truth_of(s, spans, v->work, false);
    const char *verdict = judge(v, s);
    if (!verdict)
        return;
    if (!is_right(known.is, verdict))
        known = truth_of(s, spans, v->work, true);
    v->table[group_of(s->scheme)][known.is][number_of(verdict)]++;
    v->rows[length]++;
    if (is_right(known.is, verdict))
        return;
    v->wrongs[length]++;
    tell_wrong(v, o, s, verdict, &known);
}

/* By a hash, alike on all machines: more of Runge-Kutta methods, which are few,
   and less of steps that nobody takes. */
static bool is_taken(const survey *v, const orbit *o, const subject *s) {
    const char *name = nevh_integrator_name(s->scheme);
    uint64_t hash = hash_of(0, o->name, strlen(o->name));
    hash = hash_of(hash, name, strlen(name));
    hash = hash_of(hash, &s->dt, sizeof s->dt);
    hash = hash_of(hash, &s->t_end, sizeof s->t_end);
    double more = group_of(s->scheme) == RUNGE_KUTTA ? 2 : 1;
    double less = s->dt * o->frequency > 2.6 ? 0.25 : 1;
    return (double)(hash >> 11) * 0x1p-53 < more * less * o->share * v->share;
}

static nevh_stepper *new_stepper(const subject *s) {
    nevh_options o = plan_options(s->plan, s->plan->gradients.item[0]);
    o.balance = s->plan->balance;
    return nevh_stepper_new(s->plan->system, s->scheme, &o);
}

static void survey_step(survey *v, const orbit *o, subject *s, double step) {
    double start = s->plan->run->t_start;
    for (size_t k = 0; k < LENGTHS; k++) {
        s->dt = rounded(step / o->frequency);
        double count = round(lengths[k] * o->period / s->dt);
        s->t_end = start + count * s->dt;
        if (count < LEAST_STEPS || !is_taken(v, o, s))
            continue;
        survey_row(v, o, s, k);
        if (nevh_stepper_status(s->stepper)) {
            nevh_stepper_free(s->stepper);
            s->stepper = new_stepper(s);
        }
    }
}

static void survey_scheme(survey *v, const orbit *o, subject *s) {
    s->stepper = new_stepper(s);
    for (size_t i = 0; !nevh_stepper_status(s->stepper) && i < STEPS; i++)
        survey_step(v, o, s, steps[i]);
    nevh_stepper_free(s->stepper);
}

static uint64_t hash_file(const char *name) {
    FILE *f = fopen(name, "r");
    uint64_t hash = 0;
    char line[1024];
    while (f && fgets(line, sizeof line, f))
        hash = hash_of(hash, line, strlen(line));
    if (f)
        fclose(f);
    return hash;
}

static bool has_fixed_steps(const nevh_integrator *scheme) {
    return !nevh_integrator_adaptive(scheme) &&
           !nevh_integrator_own_time(scheme);
}

static void survey_plan(survey *v, const orbit *o, const plan *p) {
    nevh_options exact = plan_options(p, "exact");
    exact.gradient_step = 0, exact.gradient_steps = NULL;
    subject s = {.plan = p,
                 .field = nevh_field_new(p->system, &exact),
                 .scene = hash_file(o->file)};
    for (size_t i = 0; nevh_integrators()[i]; i++) {
        s.scheme = nevh_integrators()[i];
        if (has_fixed_steps(s.scheme))
            survey_scheme(v, o, &s);
    }
    nevh_field_free(s.field);
}

static int survey_scene(survey *v, const orbit *o) {
    char *words[] = {"nevh", "compare", (char *)o->file, "--dt", "1e-6", NULL};
    options given;
    plan p;
    optind = 1;
    int status = options_read(&given, 5, words);
    if (!status)
        status = plan_make(&p, &given);
    if (!status)
        survey_plan(v, o, &p);
    if (!status)
        plan_free(&p);
    options_free(&given);
    return status;
}

static int survey_all(survey *v) {
    char *name = text_print("%s/bench/orbits/list", v->srcdir);
    FILE *f = fopen(name, "r");
    char line[256];
    int status = f ? TOOL_OK : tool_refuse("%s cannot be read", name);
    while (f && !status && fgets(line, sizeof line, f)) {
        orbit o = {.share = 1};
        if (*line == '#' || sscanf(line, "%63s %lf %lf %lf", o.name,
                                   &o.frequency, &o.period, &o.share) < 3)
            continue;
        snprintf(o.file, sizeof o.file, "%s/%s.nevh", v->srcdir, o.name);
        double begin = cpu_seconds();
        status = survey_scene(v, &o);
        fprintf(stderr, "%s: %.1f s\n", o.name, cpu_seconds() - begin);
    }
    if (f)
        fclose(f);
    free(name);
    return status;
}

static void add_table(size_t sum[LABELS][SAID], size_t part[LABELS][SAID]) {
    for (size_t i = 0; i < LABELS; i++)
        for (size_t k = 0; k < SAID; k++)
            sum[i][k] += part[i][k];
}

static size_t all_of(size_t counts[LABELS][SAID]) {
    size_t sum = 0;
    for (size_t i = 0; i < LABELS; i++)
        for (size_t k = 0; k < SAID; k++)
            sum += counts[i][k];
    return sum;
}

static size_t wrong_of(size_t counts[LABELS][SAID]) {
    size_t sum = 0;
    for (size_t i = 0; i < LABELS; i++)
        for (size_t k = 0; k < SAID; k++)
            if (!is_right((label)i, said[k]))
                sum += counts[i][k];
    return sum;
}

static void print_table(const char *title, size_t counts[LABELS][SAID]) {
    printf("\n%s: %zu rows, %zu wrong (*)\n%-14s", title, all_of(counts),
           wrong_of(counts), "true \\ said");
    for (size_t k = 0; k < SAID - 1; k++)
        printf(" %11s ", said[k]);
    puts("");
    for (size_t i = 0; i < LABELS; i++) {
        size_t sum = 0;
        for (size_t k = 0; k < SAID; k++)
            sum += counts[i][k];
        if (!sum)
            continue;
        printf("%-14s", label_name((label)i));
        for (size_t k = 0; k < SAID - 1; k++)
            printf(" %11zu%c", counts[i][k],
                   counts[i][k] && !is_right((label)i, said[k]) ? '*' : ' ');
        puts("");
    }
}

static bool goal(const char *what, size_t part, size_t of, double most) {
    double percent = of ? 100 * (double)part / (double)of : 0;
    printf("%-48s %5zu of %5zu %6.2f %%  %3.1f%s\n", what, part, of, percent,
           most, percent <= most ? "" : " missed");
    return percent <= most;
}

static size_t sum_of(size_t counts[LABELS][SAID], const char *truths,
                     const char *verdicts) {
    size_t sum = 0;
    for (size_t i = 0; i < LABELS; i++)
        for (size_t k = 0; k < SAID; k++)
            if (strchr(truths, 'a' + (int)i) && strstr(verdicts, said[k]))
                sum += counts[i][k];
    return sum;
}

static bool goals(const survey *v, size_t all[LABELS][SAID]) {
    size_t symplectic[LABELS][SAID] = {0}, kutta[LABELS][SAID] = {0};
    memcpy(symplectic, v->table[SYMPLECTIC], sizeof symplectic);
    memcpy(kutta, v->table[RUNGE_KUTTA], sizeof kutta);
    const char bounded[] = {'a' + IS_BOUNDED, 'a' + IS_ROUNDING, 0};
    const char drifting[] = {'a' + IS_DRIFTING, 'a' + IS_GROWING,
                             'a' + IS_SPENT,    'a' + IS_UNSTABLE,
                             'a' + WILL_BE_SO,  0};
    const char every[] = "abcdefghijk";
    size_t false_drifts = sum_of(symplectic, bounded, "drifts unstable");
    size_t false_bounds = sum_of(kutta, drifting, "bounded");
    size_t rest = wrong_of(all) - false_drifts - false_bounds;
    size_t rows = all_of(all);
    bool met = true;
    printf("\n%-48s %14s %8s  goal\n", "", "rows", "");
    met &= goal("symplectic, bounded: said to drift, or unstable", false_drifts,
                all_of(symplectic), 0.2);
    met &= goal("Runge-Kutta, not bounded: said to be", false_bounds,
                all_of(kutta), 0.5);
    met &= goal("undecided", sum_of(all, every, "undecided"), rows, 5);
    met &= goal("all others that are wrong", rest, rows, 1);
    printf("%-48s %5zu of %5zu %6.2f %%\n", "wrong in all", wrong_of(all), rows,
           100 * (double)wrong_of(all) / fmax(1, (double)rows));
    for (size_t k = 0; k < LENGTHS; k++)
        printf("  runs of %3g periods %-28s %5zu of %5zu %6.2f %%\n",
               lengths[k], "", v->wrongs[k], v->rows[k],
               100 * (double)v->wrongs[k] / fmax(1, (double)v->rows[k]));
    return met;
}

static bool survey_report(survey *v) {
    size_t all[LABELS][SAID] = {0};
    for (size_t g = 0; g < GROUPS; g++) {
        add_table(all, v->table[g]);
        if (all_of(v->table[g]))
            print_table(group_names[g], v->table[g]);
    }
    print_table("all", all);
    return goals(v, all);
}

static int usage(void) {
    fputs("Usage: verdicts [-s SHARE] [-w WORK] [-o WRONG] SRCDIR [RUNS]\n",
          stderr);
    return TOOL_USAGE;
}

int main(int argc, char **argv) {
    survey v = {.share = 1, .work = 0.4, .wrong = stdout};
    for (int c; (c = getopt(argc, argv, "s:w:o:")) != -1;) {
        if (c == 's')
            v.share = strtod(optarg, NULL);
        else if (c == 'w')
            v.work = strtod(optarg, NULL);
        else if (c != 'o' || !(v.wrong = fopen(optarg, "w")))
            return usage();
    }
    if (argc - optind != 1 && argc - optind != 2)
        return usage();
    v.srcdir = argv[optind];
    if (argv[optind + 1])
        runs_open(argv[optind + 1]);
    int status = survey_all(&v);
    if (!status && !survey_report(&v))
        status = TOOL_FAILED;
    fprintf(stderr, "verdicts took %.1f s\n", v.judging);
    runs_close();
    if (v.wrong != stdout)
        fclose(v.wrong);
    return status;
}

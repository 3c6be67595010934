/* nevh bench: how often the verdict on the energy is wrong.

       bench/verdicts [-n] [-s SHARE] [-w WORK] [-o WRONG] [-r RUNS] SRCDIR LIST...

   Runs every scheme with fixed steps over the scenes of each list, such as
   bench/orbits/list, with the steps h w and the lengths in periods that stand
   there, asks for the verdict of each, and compares it with what a run of 30 times the length
   shows, or 480 where that leaves it open, or 1920 where it says otherwise.  RUNS is a file that keeps those,
   which do not depend on the rule: it is to be removed where a scheme changed.
   Prints the tables of what was said and what is true, list by list and of all;
   writes wrong and undecided rows to WRONG, each with the command that shows it.  SHARE is the part of all rows to
   take, by a hash of their names; -n makes long runs and asks for no verdicts; WORK the seconds that a long run may take on
   a machine in the mean.  Fails where a rate is above its goal.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "verdicts_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double spans = 30;
enum { MOST_STEPS = 16, MOST_LENGTHS = 4, LEAST_STEPS = 8 };

static const char *const said[] = {"bounded",  "random-walk", "drifts",
                                   "unstable", "undecided",   "other"};
enum { SAID = sizeof said / sizeof *said };
static const char *const group_names[] = {
    "symplectic, fixed step", "energy-preserving", "either, H of t or friction",
    "Runge-Kutta and euler", "other"};

typedef size_t tally[GROUPS][LABELS][SAID];

typedef struct {
    const char *srcdir;
    double share, list_share, work;
    bool runs_alone;
    FILE *wrong;
    double step[MOST_STEPS], length[MOST_LENGTHS]; /* of the list */
    size_t steps, lengths;
    tally seen; /* of the list */
    size_t wrongs[MOST_LENGTHS], rows[MOST_LENGTHS];
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
    fflush(v->wrong);
    tool_release(evidence);
}

/* The rule: that of nevh compare. */
static const char *judge(survey *v, subject *s) {
    row r = {.integrator = nevh_integrator_name(s->scheme),
             .gradient = s->plan->gradients.item[0],
             .scheme = s->scheme,
             .dt = s->dt};
    plan p = *s->plan;
    p.t_end = s->t_end;
    double begin = cpu_seconds();
    row_run(&p, &r);
    v->judging += cpu_seconds() - begin;
    tool_release(r.status);
    s->scale = r.energy.scale;
    return r.ran ? nevh_verdict_name(r.energy.verdict) : NULL;
}

static void survey_row(survey *v, const orbit *o, subject *s, size_t length) {
    s->scale = 0;
    const long_run *run = long_run_of(s, spans, v->work);
    if (!is_afforded(run, v->work) || run->reached < 1)
        return;
    const char *verdict = v->runs_alone ? NULL : judge(v, s);
    truth known = truth_of(s, spans, v->work, false);
    if (!verdict)
        return;
    if (!is_right(known.is, verdict))
        known = truth_of(s, spans, v->work, true);
    v->seen[group_of(s)][known.is][number_of(verdict)]++;
    v->rows[length]++;
    bool right = is_right(known.is, verdict);
    v->wrongs[length] += !right;
    if (!right || strcmp(verdict, "undecided") == 0)
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
    double more = group_of(s) == RUNGE_KUTTA ? 2 : 1;
    double less = s->dt * o->frequency > 2.6 ? 0.25 : 1;
    return (double)(hash >> 11) * 0x1p-53 <
           more * less * o->share * v->list_share * v->share;
}

static nevh_stepper *new_stepper(const subject *s) {
    nevh_options o = plan_options(s->plan, s->plan->gradients.item[0]);
    o.balance = s->plan->balance;
    return nevh_stepper_new(s->plan->system, s->scheme, &o);
}

static void survey_step(survey *v, const orbit *o, subject *s, double step) {
    double start = s->plan->run->t_start;
    for (size_t k = 0; k < v->lengths; k++) {
        s->dt = rounded(step / o->frequency);
        double count = round(v->length[k] * o->period / s->dt);
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
    for (size_t i = 0; !nevh_stepper_status(s->stepper) && i < v->steps; i++)
        survey_step(v, o, s, v->step[i]);
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
    char *words[] = {"nevh", "compare",  (char *)o->file, "--dt",
                     "1e-6", "--native", "never",         NULL};
    options given;
    plan p;
    optind = 1;
    int status = options_read(&given, 7, words);
    if (!status)
        status = plan_make(&p, &given);
    if (!status)
        survey_plan(v, o, &p);
    if (!status)
        plan_free(&p);
    return status;
}

static size_t read_numbers(const char *text, double numbers[], size_t most) {
    size_t count = 0;
    for (char *end; count < most; text = end) {
        double x = strtod(text, &end);
        if (end == text)
            break;
        numbers[count++] = x;
    }
    return count;
}

/* A line of a list: numbers for all its scenes, or a scene. */
static int survey_line(survey *v, const char *line) {
    orbit o = {.share = 1};
    if (strncmp(line, "steps ", 6) == 0)
        v->steps = read_numbers(line + 6, v->step, MOST_STEPS);
    else if (strncmp(line, "lengths ", 8) == 0)
        v->lengths = read_numbers(line + 8, v->length, MOST_LENGTHS);
    else if (strncmp(line, "share ", 6) == 0)
        v->list_share = strtod(line + 6, NULL);
    if (*line == '#' ||
        sscanf(line, "%63s %lf %lf %lf", o.name, &o.frequency, &o.period,
               &o.share) < 3 ||
        !strchr(o.name, '/'))
        return TOOL_OK;
    if (*o.name == '/')
        snprintf(o.file, sizeof o.file, "%s.nevh", o.name);
    else
        snprintf(o.file, sizeof o.file, "%s/%s.nevh", v->srcdir, o.name);
    double begin = cpu_seconds();
    int status = survey_scene(v, &o);
    fprintf(stderr, "%s: %.1f s\n", o.name, cpu_seconds() - begin);
    return status;
}

static int survey_list(survey *v, const char *name) {
    FILE *f = fopen(name, "r");
    char line[256];
    int status = f ? TOOL_OK : tool_refuse("%s cannot be read", name);
    v->list_share = 1;
    memset(v->seen, 0, sizeof v->seen);
    memset(v->rows, 0, sizeof v->rows);
    memset(v->wrongs, 0, sizeof v->wrongs);
    while (f && !status && fgets(line, sizeof line, f))
        status = survey_line(v, line);
    if (f)
        fclose(f);
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

/* What grows in a longer run. */
static const char growing[] = {
    'a' + IS_WALKING,  'a' + IS_DRIFTING, 'a' + IS_GROWING, 'a' + IS_SPENT,
    'a' + IS_UNSTABLE, 'a' + WILL_BE_SO,  'a' + IS_CARRIED, 0};
static const char still[] = {'a' + IS_BOUNDED, 'a' + IS_ROUNDING, 0};
static const char every[] = "abcdefghijklm";

static bool goals(tally seen, size_t all[LABELS][SAID]) {
    size_t(*keeping)[SAID] = seen[SYMPLECTIC], (*driven)[SAID] = seen[DRIVEN];
    size_t(*kutta)[SAID] = seen[RUNGE_KUTTA];
    size_t rows = all_of(all);
    bool met = true;
    printf("\n%-48s %14s %8s  goal\n", "", "rows", "");
    met &=
        goal("symplectic, level: said to drift, or unstable",
             sum_of(keeping, still, "drifts unstable"), all_of(keeping), 0.2);
    met &= goal("symplectic: said bounded, a longer run grows",
                sum_of(keeping, growing, "bounded"), all_of(keeping), 0.5);
    met &= goal("H of t, friction: said bounded, and grows",
                sum_of(driven, growing, "bounded"), all_of(driven), 1);
    met &= goal("grows as its motion does: called anything",
                sum_of(driven, (char[]){'a' + IS_CARRIED, 0},
                       "bounded random-walk drifts unstable"),
                sum_of(driven, (char[]){'a' + IS_CARRIED, 0}, "undecided ") +
                    sum_of(driven, (char[]){'a' + IS_CARRIED, 0},
                           "bounded random-walk drifts unstable"),
                100);
    met &= goal("Runge-Kutta, not bounded: said to be",
                sum_of(kutta, growing, "bounded"), all_of(kutta), 0.5);
    met &= goal("undecided", sum_of(all, every, "undecided"), rows, 6);
    met &= goal("wrong in all", wrong_of(all), rows, 0.5);
    return met;
}

static void print_lengths(const survey *v) {
    for (size_t k = 0; k < v->lengths; k++)
        printf("  runs of %3g periods %-28s %5zu of %5zu %6.2f %%\n",
               v->length[k], "", v->wrongs[k], v->rows[k],
               100 * (double)v->wrongs[k] / fmax(1, (double)v->rows[k]));
}

static bool print_report(const char *title, tally seen) {
    size_t all[LABELS][SAID] = {0};
    for (size_t g = 0; g < GROUPS; g++) {
        add_table(all, seen[g]);
        if (all_of(seen[g]))
            print_table(group_names[g], seen[g]);
    }
    print_table(title, all);
    return goals(seen, all);
}

static int usage(void) {
    fputs(
        "Usage: verdicts [-n] [-s SHARE] [-w WORK] [-o WRONG] [-r RUNS] SRCDIR "
        "LIST...\n",
        stderr);
    return TOOL_USAGE;
}

int main(int argc, char **argv) {
    survey v = {.share = 1, .work = 0.4, .wrong = stdout};
    tally seen = {0};
    for (int c; (c = getopt(argc, argv, "ns:w:o:r:")) != -1;) {
        if (c == 's')
            v.share = strtod(optarg, NULL);
        else if (c == 'w')
            v.work = strtod(optarg, NULL);
        else if (c == 'r')
            runs_open(optarg);
        else if (c == 'n')
            v.runs_alone = true;
        else if (c != 'o' || !(v.wrong = fopen(optarg, "w")))
            return usage();
    }
    int first = optind + 1, lists = argc - first, status = TOOL_OK;
    if (lists < 1)
        return usage();
    v.srcdir = argv[optind];
    for (int i = 0; !status && i < lists; i++) {
        char *name = argv[first + i];
        status = survey_list(&v, name);
        for (size_t g = 0; g < GROUPS; g++)
            add_table(seen[g], v.seen[g]);
        if (lists > 1 || status)
            print_report(name, v.seen);
        print_lengths(&v);
    }
    if (!status && !print_report("all", seen))
        status = TOOL_FAILED;
    fprintf(stderr, "verdicts took %.1f s\n", v.judging);
    runs_close();
    if (v.wrong != stdout)
        fclose(v.wrong);
    return status;
}

/* nevh: what is written of a contest.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "bench.h"
#include <string.h>

const char *processor(void) {
    static char line[200];
    FILE *file = fopen("/proc/cpuinfo", "r");
    char *colon = NULL;
    while (file && !colon && fgets(line, sizeof line, file))
        if (strncmp(line, "model name", 10) == 0)
            colon = strchr(line, ':');
    if (file)
        fclose(file);
    if (!colon)
        return "unknown";
    line[strcspn(line, "\n")] = '\0';
    return colon + 1 + strspn(colon + 1, " ");
}

void write_csv(FILE *file, const contest *c, const circumstances *a) {
    fprintf(file, "# compiler: %s %s\n# processor: %s\n# commit: %s\n",
            a->compiler, a->flags, processor(), a->commit);
    for (size_t i = 0; i < c->library_count; i++)
        fprintf(file, "# %s: %s\n", c->libraries[i]->name,
                c->libraries[i]->version);
    fprintf(file,
            "# missing: %s\nproblem,library,scheme,target,setting,"
            "adaptive,state_error,seconds,spread,to_nevh\n",
            *a->missing ? a->missing : "none");
    for (const entry *e = c->entries; e < c->entries + c->count; e++) {
        const entry *ours = fastest(c, c->libraries[0], e->problem, e->target);
        fprintf(file, "%s,%s,\"%s\",%g,%.9g,%d,%.3g,%.6g,%.3f,",
                e->problem->name, e->library->name, e->method->scheme,
                targets[e->target], e->setting, e->method->adaptive, e->error,
                e->median, e->spread);
        if (ours)
            fprintf(file, "%.4f", ratio(e, ours));
        fputc('\n', file);
    }
}

static void write_cell(FILE *file, const contest *c, const problem *p,
                       const library *l, size_t target) {
    const entry *e = fastest(c, l, p, target);
    const entry *ours = fastest(c, c->libraries[0], p, target);
    if (!e) {
        fputs(" - |", file);
        return;
    }
    fprintf(file, " %.3g us, %s", 1e6 * e->median, e->method->scheme);
    if (ours && ours != e)
        fprintf(file, " (%.2g)", ratio(e, ours));
    fputs(" |", file);
}

static void write_problem(FILE *file, const contest *c, const problem *p) {
    bool any = false;
    for (const entry *e = c->entries; e < c->entries + c->count; e++)
        any |= e->problem == p;
    if (!any)
        return;
    fprintf(file, "\n## %s, t = 0 ... %g\n\n| state error |", p->title,
            p->t_end);
    for (size_t i = 0; i < c->library_count; i++)
        fprintf(file, " %s |", c->libraries[i]->name);
    fputs("\n|---:|", file);
    for (size_t i = 0; i < c->library_count; i++)
        fputs("---|", file);
    fputc('\n', file);
    for (size_t k = 0; k < TARGETS; k++) {
        fprintf(file, "| %.0e |", targets[k]);
        for (size_t i = 0; i < c->library_count; i++)
            write_cell(file, c, p, c->libraries[i], k);
        fputc('\n', file);
    }
}

/* The best peer's time over that of one way to use nevh. */
static void write_summary(FILE *file, const contest *c, const library *nevh) {
    size_t cells = 0, ahead = 0, twice = 0;
    fprintf(file, "\n## The best peer's time over that of %s\n\n", nevh->name);
    fputs("| problem |", file);
    for (size_t k = 0; k < TARGETS; k++)
        fprintf(file, " %.0e |", targets[k]);
    fputs("\n|---|---:|---:|---:|---:|\n", file);
    for (const problem *p = problems; p < problems + problem_count; p++) {
        fprintf(file, "| %s |", p->title);
        for (size_t k = 0; k < TARGETS; k++) {
            const entry *ours = fastest(c, nevh, p, k);
            const entry *theirs = fastest_peer(c, p, k);
            double times = ours && theirs ? ratio(theirs, ours) : 0;
            if (times > 0)
                fprintf(file, " %.2g, %s |", times, theirs->library->name);
            else
                fputs(ours     ? " nevh alone |"
                      : theirs ? " out of reach |"
                               : " - |",
                      file);
            cells += ours || theirs;
            ahead += ours && (!theirs || times >= 1);
            twice += ours && (!theirs || times >= 2);
        }
        fputc('\n', file);
    }
    fprintf(file, "\nAhead in %zu of %zu, at least twice as fast in %zu.\n",
            ahead, cells, twice);
}

void write_markdown(FILE *file, const contest *c, const circumstances *a) {
    fputs("# nevh against its peers\n\n"
          "Written by `make bench`: CPU time of one run, from the initial "
          "state to the end,\nat equal error of the final state (the largest "
          "difference from a reference in\n113-bit arithmetic, each variable "
          "in units of its range). Each library enters\nwith its best method "
          "and the coarsest setting that is good enough; all took\nturns in "
          "every round. Peers have derivatives written by hand, as nevh has "
          "in its first row;\nin the others it takes differences of order 4, "
          "or H as text, compiled when it is run.\nMaking ready is not counted "
          "(for differences some milliseconds, for compiling a\ntext a tenth "
          "of a second the first time, then a millisecond). Seconds are this\n"
          "machine's, ratios carry over better.\n\n",
          file);
    fprintf(file, "- %s; %s, %s\n- nevh %s; medians of %zu rounds\n",
            processor(), a->compiler, a->flags, a->commit, c->rounds);
    for (size_t i = 0; i < c->library_count; i++)
        if (!c->libraries[i]->ahead)
            fprintf(file, "- %s %s\n", c->libraries[i]->name,
                    c->libraries[i]->version);
    if (*a->missing)
        fprintf(file, "- not found, left out: %s\n", a->missing);
    for (size_t i = 0; i < c->library_count; i++)
        if (c->libraries[i]->ahead)
            write_summary(file, c, c->libraries[i]);
    fputs("\nIn the tables below, in brackets: times that of nevh with "
          "derivatives by hand.\n",
          file);
    for (const problem *p = problems; p < problems + problem_count; p++)
        write_problem(file, c, p);
}

/* How much of the phase space of Henon and Heiles is chaotic at three energies?
   Starts fill the section x = 0 in equal cells of y and p_y; each is judged by
   the alignment of two displacements, SALI, which falls below 1e-8 in chaos.

   What to look for: the share rises from nothing at E = 1/12 to nearly all at
   E = 1/6.  So it does in Figure 7 of M. Henon, C. Heiles, Astron. J. 69 (1964)
   73-79, who had 25 points of some orbits at each energy: curves cover all of
   the area up to E = 0.11, and hardly any of it at 1/6. */
#include <math.h>
#include <nevh/nevh.h>
#include <stdio.h>
#include <string.h>

enum { ROWS = 12, COLUMNS = 61 };
static const double least_y = -0.55, most_y = 1, most_p = 0.6;
static const char henon_heiles[] = "[coordinates]\n"
                                   "x = 0\n"
                                   "y = 0.1, 0\n"
                                   "p_x = 0.4\n"
                                   "[effects]\n"
                                   "kinetic = (p_x^2 + p_y^2)/2\n"
                                   "springs = (x^2 + y^2)/2\n"
                                   "cubic = x^2*y - y^3/3\n";

typedef struct {
    double energy;
    uint64_t next;
    char map[ROWS][COLUMNS + 1];
    int chaotic, all;
} job;

/* Whether the energy reaches the middle of a cell. */
static bool start(double energy, uint64_t cell, double q[2], double p[2]) {
    double row = (double)(cell / COLUMNS), column = (double)(cell % COLUMNS);
    q[0] = 0;
    q[1] = least_y + (most_y - least_y) * (column + 0.5) / COLUMNS;
    p[1] = most_p * (1 - (row + 0.5) / ROWS);
    double potential = q[1] * q[1] / 2 - q[1] * q[1] * q[1] / 3;
    double square = 2 * (energy - potential) - p[1] * p[1];
    p[0] = sqrt(fmax(0, square));
    return square > 0;
}

static bool next(void *data, uint64_t *member, double q[], double p[]) {
    job *j = data;
    while (j->next < ROWS * COLUMNS && !start(j->energy, j->next, q, p))
        j->next++;
    *member = j->next++;
    return *member < ROWS * COLUMNS;
}

static int done(void *data, const nevh_member_result *r) {
    job *j = data;
    bool chaotic = r->values[0] < 1e-8;
    j->all++;
    j->chaotic += chaotic;
    j->map[r->member / COLUMNS][r->member % COLUMNS] = r->status ? '?'
                                                       : chaotic ? '*'
                                                                 : '-';
    return r->status;
}

static int find_share(nevh_ensemble *e, job *j) {
    memset(j->map, ' ', sizeof j->map);
    for (int i = 0; i < ROWS; i++)
        j->map[i][COLUMNS] = '\0';
    return nevh_ensemble_run(e, next, done, j);
}

static nevh_ensemble *ensemble_of(const nevh_system *system) {
    static const double q[] = {0, 0.1}, p[] = {0.4, 0};
    static const nevh_outcome sali = {.kind = NEVH_OUTCOME_SALI};
    nevh_options how = {.gradient = nevh_exact, .q = q, .p = p};
    return nevh_ensemble_new(
        system, &(nevh_ensemble_options){.integrator = nevh_forest_ruth,
                                         .options = &how,
                                         .t_end = 1000,
                                         .dt = 0.2,
                                         .outcomes = &sali,
                                         .n_outcomes = 1});
}

int main(void) {
    job jobs[] = {{.energy = 1. / 12}, {.energy = 1. / 8}, {.energy = 1. / 6}};
    nevh_scene *scene = nevh_scene_parse("Henon-Heiles", henon_heiles);
    nevh_ensemble *e = ensemble_of(nevh_scene_system(scene));
    for (int i = 0; i < 3; i++)
        if (find_share(e, &jobs[i])) {
            fprintf(stderr, "%s\n", nevh_ensemble_message(e));
            return 1;
        }
    puts("E = 1/8: p_y from 0.6 (top) to 0, y from -0.55 (left) to 1;\n"
         "* chaotic, - regular\n");
    for (int i = 0; i < ROWS; i++)
        puts(jobs[1].map[i]);
    puts("\n energy  orbits  chaotic, %");
    for (int i = 0; i < 3; i++)
        printf("%7.4f %7d %11.1f\n", jobs[i].energy, jobs[i].all,
               100. * jobs[i].chaotic / jobs[i].all);
    nevh_ensemble_free(e);
    nevh_scene_free(scene);
    return 0;
}

/* When does a double pendulum, released at rest from two angles, first flip its
   second bob?  Orbits side by side: as soon as one has flipped, another takes its
   place.

   What to look for: the lens in the middle, where nothing ever flips, since the
   energy does not suffice: 2 cos(phi1) + cos(phi2) > 1.  Around it quick flips
   (1, 2, ...) and slow ones (letters) lie side by side: chaos. */
#include <math.h>
#include <nevh/nevh.h>
#include <stdio.h>

enum { ROWS = 31, COLUMNS = 61 };
static const double pi = 3.14159265358979323846;

typedef struct {
    uint64_t next;
    char map[ROWS][COLUMNS + 1];
    int within[6], forbidden; /* flips: before 1, 2, ... 32 s */
} job;

static void start(uint64_t member, double q[]) {
    q[0] = pi * (1 - 2. * (double)(member / COLUMNS) / (ROWS - 1));
    q[1] = pi * (2. * (double)(member % COLUMNS) / (COLUMNS - 1) - 1);
}

static bool next(void *data, uint64_t *member, double q[], double p[]) {
    job *j = data;
    if (j->next == ROWS * COLUMNS)
        return false;
    *member = j->next++;
    start(*member, q);
    p[0] = p[1] = 0;
    return true;
}

/* Above 0 once the second bob has gone round. */
static void beyond_pi(const void *data, size_t width, const double t[],
                      const double q[], const double p[], const double v[],
                      double values[]) {
    (void)data, (void)t, (void)p, (void)v;
    for (size_t lane = 0; lane < width; lane++)
        values[lane] = fabs(q[width + lane]) - (pi + 1e-9);
}

static int done(void *data, const nevh_member_result *r) {
    static const char digits[] = "123456789abcdefghijklmnopqrstuvwxyz";
    job *j = data;
    double q[2], t = r->values[0];
    start(r->member, q);
    bool forbids = 2 * cos(q[0]) + cos(q[1]) > 1;
    j->forbidden += forbids && !isnan(t);
    for (int k = 0; k < 6; k++)
        j->within[k] += t < 1 << k;
    j->map[r->member / COLUMNS][r->member % COLUMNS] =
        r->status  ? '?'
        : isnan(t) ? (forbids ? ' ' : '.')
                   : digits[(int)t];
    return 0;
}

int main(void) {
    job j = {0};
    const nevh_model *model = nevh_double_pendulum_model;
    nevh_system *system = model->system(model->defaults);
    nevh_options how = {.gradient = nevh_exact, .q = model->q, .p = model->p};
    nevh_outcome flip = {.kind = NEVH_OUTCOME_FIRST,
                         .quantity = {.value = beyond_pi}};
    nevh_ensemble *e = nevh_ensemble_new(
        system, &(nevh_ensemble_options){.integrator = nevh_rk4,
                                         .options = &how,
                                         .t_end = 32,
                                         .dt = 0.02,
                                         .outcomes = &flip,
                                         .n_outcomes = 1});
    if (nevh_ensemble_run(e, next, done, &j)) {
        fprintf(stderr, "%s\n", nevh_ensemble_message(e));
        return 1;
    }
    puts("phi1 from pi (top) to -pi, phi2 from -pi (left) to pi;\n"
         "seconds until phi2 passes pi: 1 below one, 2 below two, ...");
    for (int i = 0; i < ROWS; i++)
        puts(j.map[i]);
    puts("\nseconds  flipped before, %");
    for (int k = 0; k < 6; k++)
        printf("%7d %18.1f\n", 1 << k, 100. * j.within[k] / (ROWS * COLUMNS));
    printf("flips where the energy forbids them: %d\n", j.forbidden);
    nevh_ensemble_free(e);
    nevh_system_free(system);
    return 0;
}

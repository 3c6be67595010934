/* Processes of MPI share the members of a sweep: when a pendulum, started from
   many angles and momenta, turns over.

       mpirun -n 4 ./sweep_mpi

   What to look for: the line does not depend on the number of processes,
   although who takes which members does.  A counter of process 0 gives them out, by
   one-sided operations, so that nobody waits for a slow one. */
#include <mpi.h>
#include <nevh/nevh.h>
#include <stdio.h>

static const char text[] = "[coordinates]\n"
                           "phi = 0\n"
                           "[effects]\n"
                           "kinetic = p_phi^2/2\n"
                           "gravity = -cos(phi)\n"
                           "[run]\n"
                           "t_end = 20\n"
                           "dt = 0.05\n"
                           "[ensemble]\n"
                           "phi = range(-3, 3, 200)\n"
                           "p_phi = range(-3, 3, 200)\n"
                           "outcomes = first(abs(phi) > pi)\n";
enum { CHUNK = 500, TURNED = 2 }; /* the column, after phi and p_phi */

typedef struct {
    MPI_Win counter;
    uint64_t members;
    long sums[2]; /* members done, turned over */
    double latest;
} job;

static bool take(void *data, uint64_t *first, uint64_t *count) {
    job *j = data;
    const uint64_t more = CHUNK;
    MPI_Fetch_and_op(&more, first, MPI_UINT64_T, 0, 0, MPI_SUM, j->counter);
    MPI_Win_flush(0, j->counter);
    *count = CHUNK;
    return *first < j->members;
}

static int keep(void *data, const nevh_sweep_result *r) {
    job *j = data;
    j->sums[0] += r->status == NEVH_MEMBER_DONE;
    j->sums[1] += r->values[TURNED] >= 0; /* else it is NAN */
    if (r->values[TURNED] > j->latest)
        j->latest = r->values[TURNED];
    return 0;
}

int main(int argc, char **argv) {
    int rank, ranks, had;
    uint64_t *next;
    job j = {0};
    long sums[2];
    double latest;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &had);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    MPI_Win_allocate(rank ? 0 : sizeof *next, sizeof *next, MPI_INFO_NULL,
                     MPI_COMM_WORLD, &next, &j.counter);
    MPI_Win_lock_all(0, j.counter);
    if (!rank)
        *next = 0;
    MPI_Win_sync(j.counter);
    MPI_Barrier(MPI_COMM_WORLD);

    nevh_scene *scene = nevh_scene_parse("pendulum", text);
    nevh_sweep *sweep =
        nevh_sweep_new(scene, &(nevh_sweep_options){.integrator = nevh_verlet,
                                                    .gradient = nevh_exact});
    j.members = nevh_sweep_members(sweep);
    if (nevh_sweep_run_chunks(sweep, take, &j, NULL, keep, &j)) {
        fprintf(stderr, "%s\n", nevh_sweep_message(sweep));
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
    MPI_Reduce(j.sums, sums, 2, MPI_LONG, MPI_SUM, 0, MPI_COMM_WORLD);
    MPI_Reduce(&j.latest, &latest, 1, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
    if (!rank)
        printf("members %ld, turned over %ld, the last one at t = %.6f; "
               "processes %d\n",
               sums[0], sums[1], latest, ranks);
    nevh_sweep_free(sweep);
    nevh_scene_free(scene);
    MPI_Win_unlock_all(j.counter);
    MPI_Win_free(&j.counter);
    MPI_Finalize();
    return 0;
}

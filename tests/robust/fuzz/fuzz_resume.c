/* nevh tests: any bytes are a state to resume, or a message.  Bytes that begin
   with s get what makes a file whole, so that the checks after it are met;
   those that begin with r are the numbers of a whole state, and run on.
   SPDX-License-Identifier: GPL-3.0-or-later

   For libFuzzer; see run.sh. */
#include "fuzz.h"
#include "orbit/trajectory.h"
#include <getopt.h>

enum { N = 2, MEMORY = 24, FIXED = 16 + 5 * 8 };
static const char settings[] = "nevh = 1\nscene = 01\nintegrator = verlet\n"
                               "dt = 0.1\nrows = after every step\n";

static run_state state_in(double q[N], double p[N], char memory[MEMORY]) {
    return (run_state){
        .n = N, .memory_size = MEMORY, .q = q, .p = p, .memory = memory};
}

/* What is saved is what is loaded. */
static void save_and_load(const char *path, const uint8_t *bytes, size_t size) {
    double q[N] = {1, 2}, p[N] = {3, 4}, other_q[N], other_p[N];
    char memory[MEMORY] = {0}, other_memory[MEMORY];
    run_state saved = state_in(q, p, memory),
              found = state_in(other_q, other_p, other_memory);
    memcpy(memory, bytes, size < MEMORY ? size : MEMORY);
    memcpy(&saved.at, bytes, size < sizeof saved.at ? size : sizeof saved.at);
    insist(state_save(path, settings, &saved, false) == TOOL_OK);
    insist(state_load(path, settings, &found) == TOOL_OK);
    insist(!memcmp(&saved.at, &found.at, sizeof saved.at));
    insist(!memcmp(q, other_q, sizeof q) && !memcmp(p, other_p, sizeof p));
    insist(!memcmp(memory, other_memory, sizeof memory));
    insist(state_load(path, "nevh = 2\n", &found) == TOOL_USAGE);
}

/* A copy with a header that has the right size, and with the right digest; the
   numbers of its parts are those of the bytes, each below 256. */
static char *make_whole(const uint8_t *bytes, size_t size) {
    size_t total = size + FIXED + sizeof(progress_of_run) + sizeof(uint64_t);
    uint64_t order = 0x0102030405060708u, parts[3] = {0}, digest;
    char *all = calloc(total, 1);
    insist(all != NULL);
    for (size_t i = 0; i < 3 && i < size; i++)
        parts[i] = bytes[i];
    if (size > 3 && bytes[3] == 's') /* that they add up */
        parts[2] = size - 16 * parts[0] - parts[1];
    memcpy(all, "nevh run, 1\n", 12);
    memcpy(all + 16, &order, 8);
    memcpy(all + 24, &total, 8);
    memcpy(all + 32, parts, sizeof parts);
    memcpy(all + FIXED + sizeof(progress_of_run), bytes, size);
    digest = digest_add(digest_begin(), all, total - sizeof digest);
    memcpy(all + total - sizeof digest, &digest, sizeof digest);
    return all;
}

static void load(const char *path) {
    double q[N], p[N];
    char memory[MEMORY];
    run_state found = state_in(q, p, memory);
    int status = state_load(path, settings, &found);
    insist(status == TOOL_OK || status == TOOL_USAGE);
}

static const char tiny[] = "[coordinates]\n"
                           "x = 1\n"
                           "[effects]\n"
                           "T = p_x^2/2\nV = x^4/4\n"
                           "[run]\n"
                           "dt = 0.1\nt_end = 2\nstop = x < -0.99\n";
static const double times[] = {0, 0.1, 0.15, 0.7, 2};

/* The options, too, are the plan's as long as it lives. */
static plan plan_of(const char *integrator, options *o) {
    static char *scene;
    if (!scene) {
        scene = fuzz_file("resume.nevh");
        fuzz_write(scene, tiny, sizeof tiny - 1);
    }
    char *argv[] = {
        "nevh", "run", scene, "--integrators", (char *)(uintptr_t)integrator,
        NULL};
    plan p;
    optind = 0; /* glibc: from the beginning */
    insist(options_read(o, 5, argv) == TOOL_OK);
    insist(plan_make(&p, o) == TOOL_OK);
    return p;
}

static void take(run_state *s, const uint8_t *bytes, size_t size) {
    size_t n = s->n * sizeof *s->q, numbers = sizeof s->at;
    memcpy(&s->at, bytes, size < numbers ? size : numbers);
    if (size >= numbers + 2 * n + s->memory_size) {
        memcpy(s->q, bytes + numbers, n);
        memcpy(s->p, bytes + numbers + n, n);
        memcpy(s->memory, bytes + numbers + 2 * n, s->memory_size);
    }
}

/* how  of rows, two bits; of times, one; of the scheme, one */
static void go_on(unsigned how, const uint8_t *bytes, size_t size) {
    static const char *const schemes[] = {"rkn14a", "adaptive-verlet"};
    const char *name = schemes[how >> 3 & 1];
    const row_times rows = {.by = (row_choice)((how & 3) % 3),
                            .every = 3,
                            .count = sizeof times / sizeof *times,
                            .time = (double *)(uintptr_t)times};
    static const volatile sig_atomic_t never;
    static plan plans[2]; /* making these takes long */
    static nevh_stepper *steppers[2];
    static options given[2];
    plan *p = &plans[how >> 3 & 1];
    nevh_stepper **stepper = &steppers[how >> 3 & 1];
    if (!*stepper) {
        *p = plan_of(name, &given[how >> 3 & 1]);
        *stepper = plan_stepper(p, name);
    }
    nevh_stepper_reset(*stepper);
    line_file lines;
    insist(lines_open(&lines, "/dev/null") == TOOL_OK);
    trajectory *r =
        trajectory_new(p, name, *stepper, &rows, (row_output){.lines = &lines});
    run_state *s = trajectory_state(r);
    take(s, bytes, size);
    if (how >> 2 & 1) /* the time of that step */
        s->at.t = s->at.step == 20 ? 2 : (double)s->at.step * 0.1;
    if (trajectory_restore(r) == TOOL_OK)
        trajectory_follow(r, &(trajectory_watch){.signal = &never});
    trajectory_free(r);
    lines_close(&lines);
    tool_release(lines.text);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static char *path;
    fuzz_hush();
    if (!path)
        path = fuzz_file("resume.state");
    fuzz_write(path, bytes, size);
    load(path);
    if (size && *bytes == 's') {
        char *all = make_whole(bytes + 1, size - 1);
        fuzz_write(path, all, size - 1 + FIXED + sizeof(progress_of_run) + 8);
        load(path);
        free(all);
        save_and_load(path, bytes, size);
    }
    if (size > 1 && *bytes == 'r')
        go_on(bytes[1], bytes + 2, size - 2);
    return 0;
}

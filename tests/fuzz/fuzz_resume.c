/* nevh tests: any bytes are a state to resume, or a message.  Bytes that begin
   with s get what makes a file whole, so that the checks after it are met.
   SPDX-License-Identifier: GPL-3.0-or-later

   For libFuzzer; see run.sh. */
#include "fuzz.h"
#include "trajectory.h"

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
    return 0;
}

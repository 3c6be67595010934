/* nevh: FILE.state, from which an interrupted run goes on.

   A header with all sizes, the state, the stepper's memory, the settings, and
   a digest of all that, which tells a whole file from others.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "trajectory.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <nevh/body.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* `order` tells the machine's order of bytes. */
typedef struct {
    char magic[16];
    uint64_t order, size, n, memory_size, settings_size;
    progress_of_run at;
} header;
static const off_t most_bytes = (off_t)1 << 31; /* of a file */
static const char magic[16] = "nevh run, 1\n";
static const uint64_t order = 0x0102030405060708u;

static header describe(const char *settings, const run_state *s) {
    header h = {.order = order,
                .n = s->n,
                .memory_size = s->memory_size,
                .settings_size = strlen(settings),
                .at = s->at};
    memcpy(h.magic, magic, sizeof magic);
    h.size = sizeof h + 2 * s->n * sizeof(double) + s->memory_size +
             h.settings_size + sizeof(uint64_t);
    return h;
}

static char *append(char *to, const void *from, size_t bytes) {
    memcpy(to, from, bytes);
    return to + bytes;
}

/* The whole file. */
static char *pack(const char *settings, const run_state *s, size_t *size) {
    header h = describe(settings, s);
    char *all = tool_allocate(h.size, 1), *to = all;
    *size = h.size;
    to = append(to, &h, sizeof h);
    to = append(to, s->q, s->n * sizeof *s->q);
    to = append(to, s->p, s->n * sizeof *s->p);
    to = append(to, s->memory, s->memory_size);
    to = append(to, settings, h.settings_size);
    uint64_t digest = digest_add(digest_begin(), all, (size_t)(to - all));
    append(to, &digest, sizeof digest);
    return all;
}

static bool write_all(const char *name, const char *bytes, size_t count,
                      bool lasting) {
    int file = open(name, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0)
        return false;
    bool whole = write(file, bytes, count) == (ssize_t)count;
    if (whole && lasting)
        whole = fsync(file) == 0;
    return close(file) == 0 && whole;
}

int state_save(const char *name, const char *settings, const run_state *s,
               bool lasting) {
    size_t size;
    char *all = pack(settings, s, &size);
    char *next = text_print("%s.new", name);
    int status = TOOL_OK;
    if (!write_all(next, all, size, lasting) || rename(next, name)) {
        status = tool_refuse("%s cannot be written: %s", name, strerror(errno));
        unlink(next);
    }
    tool_release(all);
    tool_release(next);
    return status;
}

/* True if the parts fill the file; each is compared alone, since a sum of wrong
   sizes may overflow. */
static bool adds_up(const header *h, size_t size) {
    const size_t fixed = sizeof *h + sizeof(uint64_t), state = sizeof(double);
    return h->size == size && h->n <= size / (2 * state) &&
           h->memory_size <= size && h->settings_size <= INT_MAX &&
           size == fixed + 2 * state * h->n + h->memory_size + h->settings_size;
}

static bool is_whole(const char *all, size_t size) {
    header h;
    uint64_t digest;
    if (size < sizeof h + sizeof digest)
        return false;
    memcpy(&h, all, sizeof h);
    memcpy(&digest, all + size - sizeof digest, sizeof digest);
    return memcmp(h.magic, magic, sizeof magic) == 0 && h.order == order &&
           adds_up(&h, size) &&
           digest_add(digest_begin(), all, size - sizeof digest) == digest;
}

/* Settings are lines NAME = VALUE, in the same order: the first that differs.
   returns  TOOL_OK when none does */
static int compare_settings(const char *name, const char *saved,
                            const char *now) {
    while (*saved || *now) {
        int a = (int)strcspn(saved, "\n"), b = (int)strcspn(now, "\n");
        if (a == b && strncmp(saved, now, (size_t)a) == 0) {
            saved += a + (saved[a] == '\n');
            now += b + (now[b] == '\n');
        } else if (strncmp(now, "scene", 5) == 0) {
            return tool_refuse("%s belongs to another scene, or to other "
                               "parameters, effects or code",
                               name);
        } else {
            return tool_refuse("%s belongs to a run with %.*s, not %.*s", name,
                               a, saved, b, now);
        }
    }
    return TOOL_OK;
}

/* Reads the state from a complete file. */
static int take(const char *name, const char *all, const char *settings,
                run_state *s) {
    header h;
    memcpy(&h, all, sizeof h);
    const char *q = all + sizeof h, *p = q + h.n * sizeof(double),
               *memory = p + h.n * sizeof(double);
    char *saved =
        text_print("%.*s", (int)h.settings_size, memory + h.memory_size);
    int status = compare_settings(name, saved, settings);
    tool_release(saved);
    if (!status && (h.n != s->n || h.memory_size != s->memory_size))
        status = tool_refuse("%s belongs to another version of nevh", name);
    if (status)
        return status;
    s->at = h.at;
    memcpy(s->q, q, s->n * sizeof *s->q);
    memcpy(s->p, p, s->n * sizeof *s->p);
    memcpy(s->memory, memory, s->memory_size);
    return TOOL_OK;
}

int state_load(const char *name, const char *settings, run_state *s) {
    size_t size;
    struct stat found;
    if (stat(name, &found) == 0 &&
        !(S_ISREG(found.st_mode) && found.st_size <= most_bytes))
        return tool_refuse("%s is no state of a run", name);
    char *all = file_read(regular_open(name), &size);
    int status;
    if (!all)
        status = tool_refuse("there is nothing to resume: %s: %s", name,
                             strerror(errno));
    else if (!is_whole(all, size))
        status = tool_refuse("%s is damaged, or no state of a run", name);
    else
        status = take(name, all, settings, s);
    tool_release(all);
    return status;
}

void state_remove(const char *name) {
    unlink(name);
}

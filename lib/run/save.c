/* nevh: copies of a stepper's memory.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include "gradient/field_private.h"
#include <string.h>

/* The header of a saved memory; memory, last q and last p follow. */
typedef struct {
    char magic[8];
    char integrator[32];
    uint64_t n, width, rows, has_last;
    double last_t, time_roundoff;
} header;

static header save_describe(const nevh_stepper *s) {
    header h = {.magic = "nevh-2", .has_last = s->has_last || s->now_q};
    strncpy(h.integrator, s->work.integrator->name, sizeof h.integrator - 1);
    h.n = s->work.n;
    h.width = s->work.width;
    h.rows = s->rows;
    h.last_t = s->last_t;
    h.time_roundoff = s->time_roundoff;
    return h;
}

/* The three arrays of doubles behind the header, and their sizes. */
static void list_parts(const nevh_stepper *s, double *part[3], size_t size[3]) {
    part[0] = s->work.memory;
    part[1] = s->last_q;
    part[2] = s->last_p;
    size[0] = s->rows * s->work.width * sizeof(double);
    size[1] = size[2] = s->work.size * sizeof(double);
}

/* In a run the last state is not the one that a call returned. */
static void take_state_under_way(const nevh_stepper *s, double *part[3]) {
    if (!s->now_q)
        return;
    part[1] = s->now_q;
    part[2] = s->now_p;
}

size_t nevh_stepper_save_size(const nevh_stepper *s) {
    if (!s)
        return 0;
    double *part[3];
    size_t size[3];
    list_parts(s, part, size);
    return sizeof(header) + size[0] + size[1] + size[2];
}

void nevh_stepper_save(const nevh_stepper *s, void *buffer) {
    if (!s)
        return;
    double *part[3];
    size_t size[3];
    char *to = buffer;
    memset(to, 0, nevh_stepper_save_size(s));
    if (!s->planned)
        return;
    header h = save_describe(s);
    memcpy(to, &h, sizeof h);
    to += sizeof h;
    list_parts(s, part, size);
    take_state_under_way(s, part);
    for (int i = 0; i < 3; to += size[i++])
        memcpy(to, part[i], size[i]);
}

int nevh_stepper_load(nevh_stepper *s, const void *buffer, size_t size) {
    if (!s)
        return NEVH_EINVAL;
    if (!s->planned)
        return s->report.status;
    header own = save_describe(s), h;
    if (size != nevh_stepper_save_size(s))
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "a saved memory of %zu bytes, where %s has %zu", size,
                          own.integrator, nevh_stepper_save_size(s));
    memcpy(&h, buffer, sizeof h);
    own.has_last = h.has_last;
    own.last_t = h.last_t;
    own.time_roundoff = h.time_roundoff;
    if (memcmp(&own, &h, sizeof h) != 0)
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "the memory was saved by another scheme or system");
    double *part[3];
    size_t each[3];
    const char *from = (const char *)buffer + sizeof h;
    list_parts(s, part, each);
    for (int i = 0; i < 3; from += each[i++])
        memcpy(part[i], from, each[i]);
    s->has_last = h.has_last != 0;
    s->last_t = h.last_t;
    s->time_roundoff = h.time_roundoff;
    return NEVH_OK;
}

nevh_stepper *nevh_stepper_copy(const nevh_stepper *s) {
    if (!s)
        return NULL;
    nevh_stepper *copy =
        nevh_stepper_new(s->work.system, s->work.integrator, &s->options);
    if (!copy || !s->planned || !copy->planned)
        return copy;
    /* If the system has changed, memory may have another size and is of no use. */
    bool stale = s->work.field->revision != copy->work.field->revision;
    copy->work.field->revision = s->work.field->revision;
    copy->revision = s->revision;
    double *to[3], *from[3];
    size_t size[3];
    list_parts(copy, to, size);
    list_parts(s, from, size);
    take_state_under_way(s, from);
    for (int i = 0; !stale && i < 3; i++)
        memcpy(to[i], from[i], size[i]);
    copy->has_last = s->has_last || s->now_q;
    copy->last_t = s->last_t;
    copy->time_roundoff = s->time_roundoff;
    return copy;
}

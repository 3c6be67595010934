/* nevh: the window of a sweep's results that wait for those of members before them.
   Where the order does not matter there is none, and results are told at once.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/worker_private.h"
#include <stdlib.h>
#include <string.h>

enum { WINDOW = 1 << 14 }; /* members that may wait */

/* Under the lock. */
static void tell(nevh_sweep *s, uint64_t member, nevh_member_status status,
                 const char *message, const double values[]) {
    nevh_sweep_result result = {member, status, message, values};
    if (!s->stopped)
        s->stopped = s->tell(s->data, &result) != 0;
}

/* The result of a member that waits, if it does. */
static bool tell_kept(nevh_sweep *s, uint64_t member) {
    nevh__waiting *w = &s->waiting[member % WINDOW];
    bool ready = w->ready;
    if (ready && w->status != NEVH_MEMBER_MISSING)
        tell(s, member, w->status, w->message ? w->message : "", w->values);
    free(w->message);
    w->message = NULL;
    w->ready = false;
    return ready;
}

static void tell_waiting(nevh_sweep *s) {
    uint64_t before = s->low;
    while (tell_kept(s, s->low))
        s->low++;
    if (s->low > before)
        pthread_cond_broadcast(&s->moved);
}

void nevh__sweep_hand_on(nevh_sweep *s, uint64_t member,
                         nevh_member_status status, const char *message,
                         const double values[]) {
    pthread_mutex_lock(&s->lock);
    if (!s->waiting) {
        if (status != NEVH_MEMBER_MISSING)
            tell(s, member, status, message, values);
    } else {
        nevh__waiting *w = &s->waiting[member % WINDOW];
        w->ready = true;
        w->status = status;
        w->message = *message ? nevh__text("%s", message) : NULL;
        if (values)
            memcpy(w->values, values, s->columns * sizeof *values);
        tell_waiting(s);
    }
    pthread_mutex_unlock(&s->lock);
}

bool nevh__sweep_window_open(nevh_sweep *s) {
    if (!s->is.ordered)
        return true;
    s->waiting = nevh__array(WINDOW, sizeof *s->waiting);
    double *all = nevh__array(WINDOW * s->columns, sizeof *all);
    if (!s->waiting || !all) {
        free(all);
        return false;
    }
    for (size_t i = 0; i < WINDOW; i++)
        s->waiting[i].values = all + i * s->columns;
    return true;
}

/* After a sweep that was stopped some wait for members that never came. */
void nevh__sweep_window_close(nevh_sweep *s) {
    for (uint64_t i = 0; s->waiting && i < WINDOW; i++)
        tell_kept(s, s->low + i);
    if (s->waiting)
        free(s->waiting[0].values);
    free(s->waiting);
    s->waiting = NULL;
}

bool nevh__sweep_window_has_room(const nevh_sweep *s) {
    return !s->waiting || s->next + NEVH__CHUNK <= s->low + WINDOW;
}

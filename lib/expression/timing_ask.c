/* nevh: what is known of how H changes with time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/timing_stretch_private.h"

size_t nevh_timing_breaks(const nevh_timing *m) {
    return m ? m->n_breaks : 0;
}

nevh_time_break nevh_timing_break(const nevh_timing *m, size_t i) {
    return m && i < m->n_breaks ? m->breaks[i] : (nevh_time_break){0};
}

double nevh_timing_shortest(const nevh_timing *m, double *t,
                            const char **effect) {
    bool any = m && m->shortest < INFINITY;
    if (any && t)
        *t = m->shortest_at;
    if (any && effect)
        *effect = nevh_system_effect_name(m->parts.system, m->shortest_effect);
    return any ? m->shortest : INFINITY;
}

double nevh_timing_frequency(const nevh_timing *m, const char **effect) {
    bool any = m && m->frequency > 0;
    if (any && effect)
        *effect = nevh_system_effect_name(m->parts.system, m->frequency_effect);
    return any ? m->frequency : 0;
}

bool nevh_timing_whole(const nevh_timing *m) {
    return m && m->whole;
}

/* The stretch that holds a time. */
static size_t timing_ask_find(const nevh_timing *m, double t) {
    size_t from = 0, until = m->cells;
    while (until - from > 1) {
        size_t middle = from + (until - from) / 2;
        *(m->cell[middle].low <= t ? &from : &until) = middle;
    }
    return from;
}

double nevh__timing_reach(const nevh_timing *m, double t) {
    if (!m || !m->cells)
        return INFINITY;
    size_t i = timing_ask_find(m, t);
    const nevh__time_stretch *c = &m->cell[i];
    double from = fmax(t - c->low, 0), to = fmax(c->high - t, 0);
    return fmin(nevh__stretch_reach(c),
                fmin(m->bound[2 * i] + nevh__reach_slower * from,
                     m->bound[2 * i + 1] + nevh__reach_slower * to));
}

const nevh_time_break *nevh__timing_next(const nevh_timing *m, double t,
                                         bool forward) {
    size_t from = 0, until = m ? m->n_breaks : 0;
    while (from < until) {
        size_t middle = from + (until - from) / 2;
        bool later = forward ? m->breaks[middle].after > t
                             : m->breaks[middle].before >= t;
        *(later ? &until : &from) = later ? middle : middle + 1;
    }
    if (forward)
        return m && from < m->n_breaks ? &m->breaks[from] : NULL;
    return from > 0 ? &m->breaks[from - 1] : NULL;
}

double nevh__timing_edge(const nevh_timing *m, double t, bool forward) {
    if (!m || !m->cells)
        return forward ? INFINITY : -INFINITY;
    size_t last = m->cells - 1, i = timing_ask_find(m, t);
    if (forward && t < m->cell[0].low)
        return m->cell[0].low;
    if (!forward && t > m->cell[last].high)
        return m->cell[last].high;
    if (forward)
        i += i < last && m->cell[i].high <= t;
    else
        i -= i > 0 && m->cell[i].low >= t;
    bool inside = forward ? m->cell[i].high > t : m->cell[i].low < t;
    double edge = forward ? m->cell[i].high : m->cell[i].low;
    return inside ? edge : forward ? INFINITY : -INFINITY;
}

bool nevh__timing_is_fast(const nevh_timing *m, double from, double to) {
    static const double passed = 0.5; /* the reach, over the step */
    double low = fmin(from, to), high = fmax(from, to);
    for (size_t i = m && m->cells ? timing_ask_find(m, low) : 0;
         m && i < m->cells && m->cell[i].low < high; i++)
        if (m->cell[i].high > low &&
            nevh__stretch_reach(&m->cell[i]) < passed * (high - low))
            return true;
    return false;
}
